// The job as a form: its settings by table, with their sources; what is guessed is marked until it is confirmed. Every
// change goes to the server, which writes it into job.toml where the job can be read then.
import { Pause, fileAddress, fileText, get, optionsOf, post } from './api.js';
import { baseName, clear, folderName, h, select } from './dom.js';
import { text } from './texts.js';
import { givenValue, isInch, shownValue, unitOf } from './units.js';

const WAIT_MS = 450;
const TOOL_TYPES = ['ball', 'flat', 'bull', 'drill', 'tapered_ball', 'chamfer', 'general'];
const TOOL_KEYS = ['type', 'diameter_mm', 'flutes', 'helix_deg', 'overhang_mm', 'flute_length_mm', 'shank_diameter_mm', 'root_stiffness_N_per_um'];

const plain = value => /^"(.*)"$/s.test(value) ? value.slice(1, -1) : value;
const quoted = value => `"${value.replace(/["\\\n]/g, '')}"`;

export class Setup {
  // about: presets; changed(job, messages): a new state of the job; busy(text).
  constructor(about, { changed, said, picked }) {
    Object.assign(this, { about, changed, said, picked });
    this.box = h('div', { className: 'setup' });
    this.waiting = new Map();
  }

  show(job) {
    // Somebody may be typing.
    const focused = document.activeElement, focus = job.job === this.job?.job && this.box.contains(focused) && focused.dataset.path;
    this.job = job;
    const fields = job.fields, guesses = fields.filter(f => f.guessed && !f.is_default).length;
    const tables = [...new Set(fields.map(f => f.table))].filter(t => !t.startsWith('tool.'));
    clear(this.box,
      h('p', { className: guesses ? 'banner guess' : 'banner good', id: 'guesses' }, guesses ? text('guesses', guesses) : text('no_guesses')),
      this.tools(), tables.map(t => this.table(t)), this.filesCard());
    this.box.append(h('datalist', { id: 'materials' }, this.about.materials.map(m => h('option', { value: m.name }, m.what))));
    const again = focus && this.box.querySelector(`[data-path="${CSS.escape(focus)}"]`);
    if (again) {
      again.value = focused.value;
      again.focus();
      if (again.setSelectionRange) again.setSelectionRange(focused.selectionStart, focused.selectionEnd);
    }
    this.placeDrawings();
  }

  // The setting that stands in this line of job.toml, or the last one above it.
  goTo(line) {
    const field = this.job.fields.filter(f => f.line <= line).sort((a, b) => a.line - b.line).at(-1);
    const input = field && this.box.querySelector(`[data-path="${CSS.escape(`${field.table}|${field.key}`)}"]`);
    const more = input?.closest('details');
    if (more) more.open = true;
    input?.focus();
    input?.scrollIntoView({ block: 'center' });
  }

  field(table, key) { return this.job.fields.find(f => f.table === table && f.key === key); }

  async edit(...edits) {
    this.said(text('checking'));
    try {
      const answer = await post('api/edit', { job: this.job.job }, edits.map(e => e.join('\t')).join('\n'));
      if (answer.saved) { this.said(text('saved')); this.changed(answer); return true; }
      this.said(text('not_saved', answer.messages.map(m => m.message).join('; ')), true);
      return answer.messages;
    } catch (e) { this.said(e.message, true); return [{ message: e.message }]; }
  }

  // While somebody types: once he pauses.
  typed(input, field) {
    const path = `${field.table}|${field.key}`;
    if (!this.waiting.has(path)) this.waiting.set(path, new Pause(WAIT_MS));
    this.waiting.get(path).then(async () => {
      const value = givenValue(field.key, input.dataset.text === 'yes' ? quoted(input.value) : input.value.replace(/\n/g, ' ').trim());
      if (value === field.value && !field.is_default) return;
      const result = await this.edit(['set', field.table, field.key, value]);
      const wrong = result === true ? '' : result.map(m => m.message).join('\n');
      input.setCustomValidity(wrong);
      input.classList.toggle('wrong', wrong !== '');
      const says = input.closest('.field')?.querySelector('.wrong-text');
      if (says) says.textContent = wrong;
    });
  }

  input(field) {
    const { table, key, value } = field, path = `${table}|${key}`, isText = /^"/.test(value);
    if (key === 'machine' && table === '') return this.choice(field, [...this.about.machines.map(m => [m.name, `${m.name}: ${m.what}`]), ...this.job.files.filter(f => f.endsWith('.toml') && f !== baseName(this.job.job)).map(f => [f, f])]);
    if (key === 'type' && table.startsWith('tool.')) return this.choice(field, TOOL_TYPES.map(t => [t, t]));
    const input = h('input', {
      value: shownValue(key, isText ? plain(value) : value.replace(/\n/g, ' ')), spellcheck: false, data: { path, text: isText ? 'yes' : 'no' }, 'aria-label': `${table} ${key}`,
      oninput: e => this.typed(e.target, field),
    });
    if (key === 'preset' && table === 'material') input.setAttribute('list', 'materials');
    return input;
  }

  choice(field, options) {
    const value = plain(field.value), known = options.some(([v]) => v === value) ? options : [[value, value], ...options];
    const list = h('select', { data: { path: `${field.table}|${field.key}` }, 'aria-label': `${field.table} ${field.key}`, onchange: e => this.edit(['set', field.table, field.key, quoted(e.target.value)]) },
      known.map(([v, t]) => h('option', { value: v }, t)));
    list.value = value;
    return list;
  }

  // short: in a table, where the colour says that the value is a guess.
  marks(field, short) {
    if (field.is_default) return [h('span', { className: 'badge' }, text('not_set'))];
    if (!field.guessed) return [];
    return [h('span', { className: 'badge guess' }, text('guess')),
      h('button', { type: 'button', className: 'small', title: text('confirm_title'), 'aria-label': `${text('confirm')} ${field.table} ${field.key}`, onclick: () => this.edit(['confirm', field.table, field.key]) }, short ? '\u2713' : text('confirm'))];
  }

  row(field) {
    const long = /[[{]/.test(field.value) || (field.key === 'machine' && field.table === '');
    return h('div', { className: `field${field.guessed ? ' guessed' : ''}${field.is_default ? ' default' : ''}${long ? ' long' : ''}` },
      field.note ? h('p', { className: 'note' }, field.note) : null,
      h('label', {}, h('span', { className: 'key' }, field.key), this.input(field), h('span', { className: 'unit' }, unitOf(field.key))),
      h('span', { className: 'marks' }, this.marks(field)), h('span', { className: 'source' }, field.comment), h('span', { className: 'wrong-text', role: 'alert' }));
  }

  table(name) {
    const fields = this.job.fields.filter(f => f.table === name);
    return h('section', { className: 'card', data: { table: name } }, h('h2', {}, name || text('top')), fields.map(f => this.row(f)),
      name === 'stock' ? this.stockChoice() : null, name === 'material' ? this.materialRange() : null);
  }

  tools() {
    const names = [...new Set(this.job.fields.map(f => f.table))].filter(t => t.startsWith('tool.'));
    if (names.length === 0) return null;
    const cell = (name, key) => {
      const field = this.field(name, key);
      if (!field) return h('td', {});
      return h('td', { className: field.guessed ? 'guessed' : '', title: field.comment }, h('span', { className: 'field inline' }, this.input(field), field.guessed ? this.marks(field, true).slice(-1) : null, h('span', { className: 'wrong-text', role: 'alert' })));
    };
    this.drawings = h('div', { className: 'drawings', 'aria-label': text('drawings') });
    const others = names.flatMap(n => this.job.fields.filter(f => f.table === n && !TOOL_KEYS.includes(f.key)).map(f => h('div', {}, h('b', {}, 'T' + n.slice(5)), this.row(f))));
    return h('section', { className: 'card', id: 'tools' }, h('h2', {}, text('tools')),
      h('div', { className: 'wide' }, h('table', { className: 'tools' },
        h('thead', {}, h('tr', {}, h('th', {}, ''), TOOL_KEYS.map(k => h('th', {}, k.replace(/_(mm|deg|N_per_um)$/, ''), ' ', h('small', {}, unitOf(k)))))),
        h('tbody', {}, names.map(n => h('tr', { data: { tool: n.slice(5) } }, h('th', {}, 'T' + n.slice(5)), TOOL_KEYS.map(k => cell(n, k))))))),
      this.drawings, isInch() ? h('p', { className: 'note' }, text('drawings_mm')) : null, this.more = h('details', { open: Boolean(this.more?.open) }, h('summary', {}, text('tools_more')), others));
  }

  // The drawings of the set-up sheet, which the check has just written.
  async setSheet(name) {
    this.sheet = name;
    if (!name) return;
    try {
      const page = new DOMParser().parseFromString(await fileText(name), 'text/html');
      this.figures = [...page.querySelectorAll('.tools figure, .views figure')].map(f => document.importNode(f, true));
      for (const f of this.figures) f.querySelectorAll('script').forEach(s => s.remove());
    } catch { this.figures = []; }
    this.placeDrawings();
  }
  placeDrawings() { if (this.drawings && this.figures) clear(this.drawings, this.figures.map(f => f.cloneNode(true))); }

  stockChoice() {
    const stl = this.job.files.filter(f => /\.(stl|step|stp)$/i.test(f)), kinds = ['box_mm', 'cylinder', 'mesh', 'vdb'];
    const left = this.job.results.flatMap(r => r.files.filter(f => f.endsWith('/stock.vdb')).map(f => [r.command, f.slice(folderName(this.job.job).length)]));
    const options = [['', '–'], ...stl.map(f => ['mesh|' + f, `${text('stock_is_file')}: ${f}`]), ...left.map(([c, f]) => ['vdb|' + f, text('stock_is_left', c)])];
    if (options.length === 1) return null;
    return select(text('stock_from'), options, '', chosen => {
      const [key, file] = chosen.split('|');
      if (!file) return;
      const old = kinds.filter(k => k !== key && this.field('stock', k) && !this.field('stock', k).is_default);
      this.edit(['set', 'stock', key, quoted(file)], ...old.map(k => ['remove', 'stock', k]));
    });
  }

  materialRange() {
    const name = plain(this.field('material', 'preset')?.value ?? ''), found = this.about.materials.find(m => m.name === name);
    if (!found) return null;
    const number = v => String(+v.toPrecision(3));
    return h('div', { className: 'material' }, h('p', { className: 'note' }, `${found.what}; ${found.range}; ${found.source}`),
      h('table', {}, h('caption', {}, text('material_range')), h('tbody', {}, found.coefficients.filter(c => c.value !== 0).map(c =>
        h('tr', {}, h('th', {}, c.key), h('td', {}, number(c.value)), h('td', {}, c.low === c.high ? '' : `${number(c.low)} … ${number(c.high)}`), h('td', {}, c.unit === '1' ? '' : c.unit))))));
  }

  filesCard() {
    const choose = h('input', { type: 'file', hidden: true, onchange: () => this.upload(choose.files[0]) });
    const meshes = this.job.files.filter(f => /\.(stl|step|stp)$/i.test(f));
    const libraries = this.job.files.filter(f => /\.(json|tools|csv|hsmlib|fctl|vtdb|tbl)$/i.test(f));
    return this.filesBox = h('section', { className: 'card', id: 'files-beside' }, h('h2', {}, text('files')), h('ul', {}, this.job.files.map(f => h('li', {}, h('a', { href: fileAddress(folderName(this.job.job) + f, true) }, f)))),
      h('p', {}, choose, h('button', { type: 'button', onclick: () => choose.click() }, text('upload_file')), ' ', h('span', { className: 'note' }, text('upload_help'))),
      meshes.length ? select(text('part'), [['', '–'], ...meshes.map(f => [f, f])], plain(this.field('part', 'mesh')?.value ?? ''), f => f ? this.edit(['set', 'part', 'mesh', quoted(f)]) : this.edit(['remove', 'part', 'mesh'])) : null,
      h('p', {}, this.library = select(text('tool_library'), [['', text('from_program')], ...libraries.map(f => [f, f])], '', () => {}), ' ',
        h('button', { type: 'button', title: text('propose_help'), onclick: () => this.propose() }, text('propose')), ' ', h('span', { className: 'note' }, text('propose_help'))));
  }

  async upload(file) {
    if (!file) return;
    if (file.size > this.about.max_upload_bytes) return this.said(text('too_large', (file.size / 1e6).toFixed(0), (this.about.max_upload_bytes / 1e6).toFixed(0)), true);
    try {
      await post('api/files', { job: this.job.job, name: file.name }, file);
      this.changed(await get('api/job', { job: this.job.job }));
    } catch (e) { this.said(e.message, true); }
  }

  async propose() {
    if (!confirm(text('propose_sure'))) return;
    const library = this.library.querySelector('select').value, options = { machine: plain(this.field('', 'machine')?.value ?? '') };
    if (!options.machine.startsWith('preset:') && options.machine) options.machine = folderName(this.job.job) + options.machine;
    if (library) options.tools = folderName(this.job.job) + library;
    try {
      const job = await post('api/init', { job: this.job.job, ...optionsOf(options) });
      if (job.job) this.changed(job);
      else this.said(job.messages.map(m => m.message).join('; '), true);
    } catch (e) { this.said(e.message, true); }
  }
}
