// What runs have left: the report page in its place, two of them side by side, figures and files; and the new program
// beside the given one.
import { fileAddress, fileText, get } from './api.js';
import { baseName, clear, h, select } from './dom.js';
import { LineList } from './line_list.js';
import { stateText } from './runs.js';
import { text } from './texts.js';

const frame = (name, title) => h('iframe', { src: fileAddress(name), title, sandbox: 'allow-scripts allow-downloads', className: 'report' });

export class Results {
  constructor({ said }) {
    this.said = said;
    this.box = h('div', { className: 'results' });
    this.beside = '';
  }

  show(job, command) {
    this.job = job;
    const results = job.results;
    if (results.length === 0) return clear(this.box, h('p', { className: 'note' }, text('no_results')));
    this.command = results.some(r => r.command === command) ? command : results.some(r => r.command === this.command) ? this.command : results.at(-1).command;
    if (this.beside === this.command || !results.some(r => r.command === this.beside)) this.beside = '';
    const names = results.map(r => [r.command, `${text('command_' + r.command)} · ${stateText(r.run.state)}`]);
    const shown = results.find(r => r.command === this.command), other = results.find(r => r.command === this.beside);
    clear(this.box, h('div', { className: 'bar' },
      select(text('result'), names, this.command, c => this.show(this.job, c)),
      names.length > 1 ? select(text('beside'), [['', text('nothing')], ...names.filter(([c]) => c !== this.command)], this.beside, c => { this.beside = c; this.show(this.job); }) : null,
      shown.run.program && shown.files.includes(shown.run.program) ? h('a', { className: 'download', href: fileAddress(shown.run.program, true), download: baseName(shown.run.program) }, text('download', baseName(shown.run.program))) : null),
    h('div', { className: other ? 'two' : '' }, [shown, other].filter(Boolean).map(r => this.one(r))));
  }

  one(result) {
    const { run, files, figures } = result;
    return h('div', { className: 'result', data: { command: result.command } },
      run.messages?.length ? h('ul', { className: 'messages' }, run.messages.map(m => h('li', { className: m.severity }, `${m.line ? `${m.file}:${m.line}: ` : ''}${m.message}`))) : null,
      files.includes(run.report) ? frame(run.report, text('command_' + result.command)) : h('p', { className: 'note' }, text('no_report')),
      figures ? h('details', {}, h('summary', {}, text('figures')), h('table', {}, Object.entries(figures).flatMap(([k, v]) => typeof v === 'object' && v ? Object.entries(v).map(([n, x]) => [`${k}.${n}`, x]) : [[k, v]])
        .map(([k, v]) => h('tr', {}, h('th', {}, k), h('td', {}, typeof v === 'object' ? JSON.stringify(v) : String(v)))))) : null,
      h('ul', { className: 'files' }, files.map(f => h('li', {}, h('a', { href: fileAddress(f, true) }, baseName(f))))));
  }
}

export class Comparison {
  constructor({ said }) {
    this.said = said;
    this.before = new LineList({ label: text('before'), picked: n => this.follow(n, true) });
    this.after = new LineList({ label: text('after'), picked: n => this.follow(n, false) });
    this.head = h('div', { className: 'bar' });
    this.lists = h('div', { className: 'two' }, h('div', {}, h('h2', {}, text('before')), this.before.box), h('div', {}, h('h2', {}, text('after')), this.after.box));
    this.box = h('div', { className: 'comparison' }, this.head, this.lists);
  }

  async show(job) {
    this.hunks = [];
    const programs = job.results.map(r => r.run.program).filter(p => p && job.results.some(r => r.files.includes(p)));
    this.lists.hidden = programs.length === 0 || job.programs.length !== 1;
    if (this.lists.hidden) return clear(this.head, h('p', { className: 'note' }, text(job.programs.length > 1 ? 'several_programs' : 'no_new_program')));
    if (!programs.includes(this.program)) this.program = programs[0];
    const asked = this.asked = Symbol('comparison');
    try {
      const [hunks, before, after] = await Promise.all([get('api/difference', { before: job.programs[0], after: this.program }), fileText(job.programs[0]), fileText(this.program)]);
      if (asked !== this.asked) return;
      this.before.setText(before);
      this.after.setText(after);
      this.setHunks(hunks);
    } catch (e) { return this.said(e.message, true); }
    const sum = k => this.hunks.reduce((s, hunk) => s + hunk[k], 0);
    clear(this.head, programs.length > 1 ? select(text('after'), programs.map(p => [p, baseName(p)]), this.program, p => { this.program = p; this.show(job); }) : h('b', {}, baseName(this.program)),
      h('span', { id: 'changed' }, text('changed_lines', this.hunks.length, sum(1), sum(3))),
      h('button', { type: 'button', onclick: () => this.step(-1) }, text('previous')), h('button', { type: 'button', onclick: () => this.step(1) }, text('next')),
      h('a', { className: 'download', href: fileAddress(this.program, true), download: baseName(this.program) }, text('download', baseName(this.program))));
  }

  setHunks(hunks) {
    this.hunks = hunks;
    this.at = -1;
    const before = new Map(), after = new Map();
    for (const [b, bn, a, an] of hunks) {
      for (let i = 0; i < bn; i++) before.set(b + i + 1, { severity: an ? 'changed' : 'removed', texts: [] });
      for (let i = 0; i < an; i++) after.set(a + i + 1, { severity: bn ? 'changed' : 'added', texts: [] });
    }
    this.before.setMarks(before);
    this.after.setMarks(after);
  }

  step(by) {
    if (this.hunks.length === 0) return;
    this.at = (this.at + by + this.hunks.length) % this.hunks.length;
    const [b, , a] = this.hunks[this.at];
    this.before.select(Math.min(b + 1, this.before.count), true);
    this.after.select(Math.min(a + 1, this.after.count), true);
  }

  // The line of the other program that stands in this one's place.
  follow(number, fromBefore) {
    const [own, ownCount, other, otherCount] = fromBefore ? [0, 1, 2, 3] : [2, 3, 0, 1];
    let shift = 0, target = null;
    for (const hunk of this.hunks) {
      if (number - 1 < hunk[own]) break;
      if (number - 1 < hunk[own] + hunk[ownCount]) {
        target = hunk[other] + Math.min(Math.max(0, hunk[otherCount] - 1), Math.floor((number - 1 - hunk[own]) * hunk[otherCount] / Math.max(1, hunk[ownCount]))) + 1;
        break;
      }
      shift = hunk[other] + hunk[otherCount] - hunk[own] - hunk[ownCount];
    }
    const list = fromBefore ? this.after : this.before;
    list.select(Math.max(1, Math.min(target ?? number + shift, list.count)), true);
  }
}
