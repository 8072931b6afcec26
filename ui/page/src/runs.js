// Commands on the job, and what runs and waits.
import { get, optionsOf, post } from './api.js';
import { clear, clock, h, select } from './dom.js';
import { stepText, text } from './texts.js';

// Names of options as the command line has them.
const OPTIONS = {
  predict: [['trace', 'file', /\.(csv|txt)$/i], ['meshes', 'flag']],
  compensate: [['time-budget', 'number', '%'], ['measured', 'file', /\.csv$/i], ['uncertainty', 'text', '%'], ['keep-anyway', 'flag'], ['header', 'flag']],
  adapt: [['time-limit', 'number', 's'], ['sweep', 'flag'], ['keep-anyway', 'flag']],
  feed: [], time: [['trace', 'file', /\.csv$/i]],
  compress: [['tolerance-mm', 'number', 'mm', '0.002'], ['lines-only', 'flag'], ['helices', 'flag']],
  'fit-feed': [['trace', 'file', /\.(csv|txt|xml)$/i], ['columns', 'file', /\.toml$/i], ['update', 'flag']],
};

export const stateText = state => text('state_' + state);

export class Runs {
  constructor(about, { said, showResults }) {
    Object.assign(this, { about, said, showResults, runs: [] });
    this.form = h('div', {});
    this.list = h('div', { id: 'runs' });
    this.box = h('div', { className: 'runs' }, h('section', { className: 'card' }, this.form), h('section', { className: 'card' }, h('h2', {}, text('queue')), this.list));
    this.command = 'predict';
    this.opened = new Map();
  }

  show(job) {
    this.job = job;
    this.showForm();
    this.showRuns(this.runs);
  }

  showForm() {
    const folder = this.job.job.slice(0, this.job.job.lastIndexOf('/') + 1);
    this.inputs = OPTIONS[this.command].map(([name, kind, unit, value]) => {
      const input = kind === 'flag' ? h('input', { type: 'checkbox' })
        : kind === 'file' ? h('select', {}, h('option', { value: '' }, '–'), this.job.files.filter(f => unit.test(f)).map(f => h('option', { value: folder + f }, f)))
        : h('input', { type: 'text', size: 8, value: value || '' });
      input.dataset.option = name;
      const says = `${text('option_' + name)}${kind === 'number' ? `, ${unit}` : ''}`;
      return { name, kind, input, row: h('label', { className: `option ${kind}` }, h('span', {}, says, ' ', h('code', {}, '--' + name)), input) };
    });
    clear(this.form, select(text('command'), this.about.commands.map(c => [c, text('command_' + c)]), this.command, c => { this.command = c; this.showForm(); }),
      h('div', { className: 'options' }, this.inputs.map(i => i.row)),
      h('button', { type: 'button', className: 'main', id: 'start', onclick: () => this.start() }, text('start')));
  }

  async start() {
    const options = {};
    for (const { name, kind, input } of this.inputs) {
      if (kind === 'flag' ? input.checked : input.value) options[name] = kind === 'flag' ? '' : input.value;
    }
    // An empty value is no option of the address; flags say so with a blank.
    for (const name of Object.keys(options)) if (options[name] === '') options[name] = ' ';
    try { await post('api/run', { job: this.job.job, command: this.command, ...optionsOf(options) }); } catch (e) { this.said(e.message, true); }
  }

  showRuns(runs) {
    this.runs = runs;
    if (runs.length === 0) return clear(this.list, h('p', { className: 'note' }, text('no_runs')));
    clear(this.list, [...runs].reverse().slice(0, 60).map(r => this.row(r)));
  }

  row(run) {
    const on = run.state === 'running', waits = run.state === 'queued', over = !on && !waits;
    const out = h('div', { className: `run ${run.state}`, data: { run: run.id, state: run.state } },
      h('span', { className: `state ${run.state}` }, stateText(run.state)), h('span', { className: 'what' }, `${text('command_' + run.command)} · ${run.job}`),
      over && run.begun ? h('span', { className: 'note' }, clock(run.ended - run.begun)) : null,
      on || waits ? h('button', { type: 'button', className: 'small', onclick: () => post(`api/runs/${run.id}/cancel`).catch(e => this.said(e.message, true)) }, text('cancel')) : null,
      over && run.state !== 'cancelled' ? h('button', { type: 'button', className: 'small', onclick: () => this.showResults(run.job, run.command) }, text('show_results')) : null);
    if (on) out.append(h('span', { className: 'progress' }, h('progress', { max: 1, value: run.share ?? undefined }), ' ', stepText(run.step || ''), run.left_s !== null && run.left_s !== undefined ? ` · ${text('left', clock(run.left_s))}` : ''));
    if (run.message_count > 0) out.append(this.messages(run));
    return out;
  }

  // Fetched when there are more of them.
  messages(run) {
    const known = this.opened.get(run.id), box = known?.box ?? h('ul', { className: 'messages' });
    if (known?.count !== run.message_count) {
      this.opened.set(run.id, { box, count: run.message_count });
      get(`api/runs/${run.id}`).then(r => clear(box, r.messages.map(m => h('li', { className: m.severity }, `${m.line ? `${m.file}:${m.line}: ` : ''}${m.message}`)))).catch(() => {});
    }
    return box;
  }
}
