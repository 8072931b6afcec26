// The workbench: jobs at the left, one of them at the right, in tabs.
import { STLLoader } from 'three/examples/jsm/loaders/STLLoader.js';
import { Pause, fileBytes, fileText, get, optionsOf, post, watchRuns } from './api.js';
import { baseName, clear, clickable, clock, folderName, grouped, h, select } from './dom.js';
import { LineList } from './line_list.js';
import { readPath } from './path_data.js';
import { PathScene, TOOL_COLOURS, VIEW_NAMES } from './path_scene.js';
import { Comparison, Results } from './results.js';
import { Runs, stateText } from './runs.js';
import { Setup } from './setup.js';
import { LANGUAGES, currentLanguage, setLanguage, text } from './texts.js';
import { givenValue, isInch, length, setInch, shownValue, speed, unitOf } from './units.js';
import './workbench.css';

// What the user has chosen stays in the browser; it changes no result.
const chosen = {
  get: (name, otherwise) => { try { return localStorage.getItem('camber.' + name) ?? otherwise; } catch { return otherwise; } },
  set: (name, value) => { try { localStorage.setItem('camber.' + name, value); } catch { /* a private window */ } },
};

const TABS = ['path', 'setup', 'run', 'results', 'compare', 'text'];

class Workbench {
  moving = new Pause(400);

  async start() {
    // The token is in the cookie by now: it does not stay in the address.
    if (location.search) history.replaceState(null, '', location.pathname + location.hash);
    setLanguage(chosen.get('language', navigator.language?.startsWith('de') ? 'de' : 'en'));
    setInch(chosen.get('unit', 'mm') === 'inch');
    this.theme(chosen.get('theme', 'auto'));
    this.skeleton();
    document.documentElement.dataset.ready = 'yes';
    try { this.about = await get('api/about'); } catch (e) { return this.said(e.message, true); }
    this.parts();
    this.listen();
    watchRuns(runs => this.runsChanged(runs), () => {});
    await this.readJobs();
    if (this.jobs.length) await this.openJob(chosen.get('job') && this.jobs.some(j => j.job === chosen.get('job')) ? chosen.get('job') : this.jobs[0].job);
    document.documentElement.dataset.ready = 'all';
  }

  theme(name) {
    chosen.set('theme', name);
    if (name === 'auto') delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = name;
    this.scene?.setBackground(getComputedStyle(document.documentElement).getPropertyValue('--scene').trim());
  }

  skeleton() {
    this.jobList = h('div', { id: 'jobs' });
    this.status = h('p', { id: 'status', role: 'status', title: text('close'), onclick: () => this.said('') });
    this.main = h('main', {});
    this.choose = h('input', { type: 'file', hidden: true, id: 'choose', onchange: () => this.begin(this.choose.files[0]) });
    const again = (name, value) => { chosen.set(name, value); location.reload(); };
    clear(document.body,
      h('aside', {}, h('h1', {}, 'Camber'), this.choose,
        h('button', { type: 'button', className: 'main drop', onclick: () => this.choose.click() }, h('span', {}, text('drop')), h('small', {}, text('open'))),
        h('h2', {}, text('jobs')), this.jobList, this.all = h('div', { hidden: true, title: text('run_all_help') }),
        h('div', { className: 'settings' },
          select(text('unit'), [['mm', 'mm'], ['inch', 'inch']], isInch() ? 'inch' : 'mm', v => again('unit', v)),
          select(text('language'), Object.entries(LANGUAGES), currentLanguage(), v => again('language', v)),
          select(text('theme'), ['auto', 'light', 'dark'].map(t => [t, text('theme_' + t)]), chosen.get('theme', 'auto'), v => this.theme(v)))),
      this.main, this.status);
    clear(this.main, h('p', { className: 'note empty' }, text('loading')));
  }

  parts() {
    const said = (sentence, wrong) => this.said(sentence, wrong);
    this.setup = new Setup(this.about, { said, changed: job => this.jobChanged(job) });
    this.runs = new Runs(this.about, { said, showResults: (job, command) => this.showResults(job, command) });
    this.results = new Results({ said });
    this.comparison = new Comparison({ said });
    this.lines = new LineList({ label: text('program'), picked: n => this.scene?.markLine(n) });
    this.sceneTools = h('div', { className: 'over' });
    this.sceneBox = h('div', { className: 'scene', id: 'scene' }, this.sceneTools);
    this.sceneBar = h('div', { className: 'bar', id: 'scene-bar' });
    this.legend = h('div', { className: 'legend', id: 'legend' });
    this.messageList = h('ul', { className: 'messages', id: 'messages' });
    this.textArea = h('textarea', { id: 'text', spellcheck: false, 'aria-label': 'job.toml' });
    this.pages = {
      path: h('div', { className: 'path' }, h('div', { className: 'left' }, this.sceneBar, this.sceneBox, this.legend), h('div', { className: 'right' }, this.lines.box, this.messageList)),
      setup: this.setup.box, run: this.runs.box, results: this.results.box, compare: this.comparison.box,
      text: h('div', {}, this.textArea, h('p', {}, h('button', { type: 'button', className: 'main', onclick: () => this.saveText() }, text('save')))),
    };
    this.tabs = h('nav', { role: 'tablist', onkeydown: e => this.nextTab(e) }, TABS.map(t => h('button', { type: 'button', role: 'tab', data: { tab: t }, onclick: () => this.tab(t) }, text('tab_' + t))));
    this.head = h('div', { className: 'head' });
    clear(this.all, select(text('run_all'), [['', text('run_all')], ...this.about.commands.filter(c => !['compress', 'fit-feed'].includes(c)).map(c => [c, text('command_' + c)])], '', c => c && this.runAll(c)));
  }

  frame() {
    if (this.main.contains(this.tabs)) return;
    clear(this.main, this.head, this.tabs, TABS.map(t => this.pages[t]), h('p', { className: 'note keys' }, text('keys')));
    try {
      this.scene = new PathScene(this.sceneBox, { label: text('path'), picked: i => this.lines.select(this.scene.path.line[i], true) });
      this.scene.describe = i => this.describe(i);
      window.camberScene = this.scene;
    } catch { this.sceneBox.append(h('p', { className: 'note' }, text('no_webgl'))); }
    this.theme(chosen.get('theme', 'auto'));
    this.by = 'kind';
    clear(this.sceneBar,
      select(text('colour_by'), ['kind', 'tool', 'feed', 'message'].map(b => [b, text('by_' + b)]), 'kind', b => { this.by = b; this.colour(); }),
      this.toolChoice = h('span', {}),
      h('label', {}, this.rapids = h('input', { type: 'checkbox', checked: true, onchange: () => this.showKinds() }), ' ', text('rapids')),
      this.solidControls());
    clear(this.sceneTools, this.moveControls(),
      h('span', { className: 'choice views' }, VIEW_NAMES.map(v => h('button', { type: 'button', className: 'small', data: { view: v }, onclick: () => this.scene?.look(v) }, text('view_' + v))),
        h('button', { type: 'button', className: 'small', onclick: () => this.savePicture() }, text('save_picture'))));
    this.tab(TABS.find(t => location.hash === '#' + t) ?? 'path');
  }

  // Without a job, of a program that none could be made of, there is the program alone. The address keeps the tab.
  tab(name) {
    if (!this.pages) return;
    this.current = name = this.job ? name : 'path';
    if (this.job) history.replaceState(null, '', `${location.pathname}#${name}`);
    for (const t of TABS) this.pages[t].hidden = t !== name;
    this.tabs.querySelectorAll('button').forEach(b => {
      b.setAttribute('aria-selected', String(b.dataset.tab === name));
      b.disabled = !this.job && b.dataset.tab !== 'path';
    });
    if (name === 'compare' && this.job) this.comparison.show(this.job);
    if (name === 'path') { this.scene?.resize(); this.lines.draw(); }
  }

  nextTab(e) {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[e.key];
    if (!step) return;
    this.tab(TABS.at((TABS.indexOf(this.current) + step) % TABS.length));
    this.tabs.querySelector('[aria-selected=true]').focus();
  }

  said(sentence, wrong) {
    this.status.textContent = sentence;
    this.status.classList.toggle('wrong', Boolean(wrong));
    clearTimeout(this.quiet);
    // A check may take long, and ends with a sentence of its own.
    if (!wrong && sentence !== text('checking')) this.quiet = setTimeout(() => { this.status.textContent = ''; }, 2500);
  }

  async readJobs() {
    this.jobs = await get('api/jobs');
    this.drawJobs();
    if (this.jobs.length === 0 && !this.job && !this.program) clear(this.main, h('p', { className: 'note empty' }, text('no_jobs')));
  }

  stateOf(job) {
    const going = (this.runs?.runs ?? []).filter(r => r.job === job.job && ['queued', 'running'].includes(r.state)).at(-1);
    const last = job.results.map(r => r.run).sort((a, b) => a.ended - b.ended).at(-1);
    return { state: going?.state ?? last?.state ?? 'none', last };
  }

  // The figures that a shop looks for first.
  figuresOf(job) {
    const of = name => job.results.find(r => r.command === name)?.figures;
    const compensated = of('compensate'), predicted = of('predict'), rms = f => f?.rms?.toFixed(1);
    const before = rms(compensated?.before_um) ?? rms(predicted?.form_error_um), after = rms(compensated?.after_um);
    const time = compensated?.machine_time_s?.after ?? predicted?.machine_time_s ?? of('time')?.total_s ?? of('feed')?.time_s;
    return [before && `${before}${after ? ` → ${after}` : ''} µm`, typeof time === 'number' && clock(time)].filter(Boolean).join(' · ');
  }

  drawJobs() {
    this.all.hidden = this.jobs.length === 0;
    clear(this.jobList, this.jobs.map(job => {
      const { state, last } = this.stateOf(job), name = baseName(job.job) === 'job.toml' && folderName(job.job) ? folderName(job.job).slice(0, -1) : job.job;
      return h('button', { type: 'button', className: 'job', data: { job: job.job, state }, 'aria-current': String(job.job === this.job?.job), onclick: () => this.openJob(job.job) },
        h('b', {}, name), h('span', { className: `state ${state}` }, stateText(state)), h('span', { className: 'note figures', title: `${text('error_rms')}, ${text('machine_time')}` }, this.figuresOf(job)),
        last?.ended ? h('span', { className: 'note' }, new Date(1000 * last.ended).toLocaleString(navigator.languages.find(l => l.startsWith(currentLanguage())) ?? currentLanguage())) : null);
    }));
  }

  async begin(file) {
    if (!file || !this.about) return;
    if (file.size > this.about.max_upload_bytes) return this.said(text('too_large', (file.size / 1e6).toFixed(0), (this.about.max_upload_bytes / 1e6).toFixed(0)), true);
    this.said(text('checking'));
    try {
      const made = await post('api/programs', { name: file.name }, file);
      await this.readJobs();
      if (made.job) return await this.openJob(made.job);
      await this.openProgram(made.program);
      this.said(`${text('no_job')} ${made.messages.find(m => m.severity === 'error')?.message ?? ''}`, true);
    } catch (e) { this.said(e.message, true); }
  }

  // A mesh, a library or a trace belongs to the job that is open; all else is a program.
  async dropped(file) {
    if (!this.job || !/\.(stl|step|stp|csv|json|toml|tools|xml)$/i.test(file?.name ?? '')) return this.begin(file);
    await this.setup.upload(file);
    this.tab('setup');
    this.setup.filesBox.scrollIntoView();
  }

  // A program that no job could be made of: its lines and its messages.
  async openProgram(program) {
    this.opening = Symbol('program');
    this.frame();
    this.job = null;
    this.begun(program);
    this.head.textContent = program;
    this.tab('path');
    this.drawJobs();
    await this.showProgram(program, {});
  }

  // Nothing of the program before is shown as if it were of this one.
  begun(program) {
    this.program = program;
    this.meshes = {};
    this.marks = new Map();
    this.scene?.clear();
    this.lines.setText('');
    this.lines.setMarks(this.marks);
    clear(this.messageList);
    clear(this.legend);
    clear(this.toolChoice);
    this.offerSolids();
  }

  async openJob(name) {
    const opening = this.opening = Symbol('job');
    try {
      const job = await get('api/job', { job: name });
      if (opening !== this.opening) return;
      this.job = job;
      this.frame();
      chosen.set('job', name);
      this.begun(job.programs[0]);
      clear(this.head, h('b', {}, job.job), ' ', h('span', { className: 'note' }, job.programs.join(', ')));
      this.setup.figures = null;
      this.showJob(job);
      this.tab(this.current || 'path');
      this.drawJobs();
      const units = job.fields.find(f => f.table === '' && f.key === 'units' && !f.is_default)?.value.slice(1, -1);
      // The path is there long before the job is checked.
      await Promise.all([this.program && this.showProgram(this.program, optionsOf({ units: units ?? '' })), this.check({ job: name })]);
    } catch (e) { this.said(e.message, true); }
  }

  showJob(job) {
    this.job = job;
    this.setup.show(job);
    this.runs.show(job);
    this.results.show(job);
    if (document.activeElement !== this.textArea) this.textArea.value = job.text;
    this.showSettings();
  }

  // A setting was changed: the commands' own check says what they think of it.
  async jobChanged(job) {
    this.showJob(job);
    await this.check({ job: job.job });
  }

  async showProgram(program, options) {
    const [lines, checked] = await Promise.all([fileText(program), get('api/check', { program, ...options })]);
    if (program !== this.program) return;
    this.lines.setText(lines);
    this.lines.setMarks(this.marks);
    if (!this.job) this.showMessages(checked);
    if (checked.path && this.scene && !this.scene.path) await this.showPath(checked.path, program);
    document.documentElement.dataset.shown = program;
  }

  async saveText() {
    try {
      const answer = await post('api/text', { job: this.job.job }, this.textArea.value);
      if (!answer.saved) return this.said(text('not_saved', answer.messages.map(m => `${m.line}: ${m.message}`).join('; ')), true);
      this.textArea.blur();
      this.said(text('saved'));
      await this.jobChanged(answer);
    } catch (e) { this.said(e.message, true); }
  }

  async check(what) {
    const asked = this.asked = Symbol('check'), { job, program } = this, move = this.numbers('part', 'move_mm') ?? [0, 0, 0];
    this.said(text('checking'));
    let checked;
    try { checked = await get('api/check', what); } catch (e) { return this.said(e.message, true); }
    if (asked !== this.asked || checked.stopped || this.job?.job !== job.job) return;
    if (this.scene) {
      // The job knows what the program alone does not say: kinematics, tool radii.
      if (checked.path && (checked.path_in_part || !this.scene.path)) await this.showPath(checked.path, program, this.scene.path?.inPart);
      await this.showMeshes(checked, job, move);
    }
    this.showMessages(checked);
    this.setup.setSheet(checked.sheet);
  }

  // At their lines and in the list.
  showMessages(checked) {
    const messages = [...checked.messages].sort((a, b) => (b.severity === 'error') - (a.severity === 'error'));
    const assumed = checked.figures?.assumed ?? [];
    this.said(checked.status === 0 ? text('checked') : `${text('check_failed')}: ${checked.messages.find(m => m.severity === 'error')?.message ?? ''}`, checked.status !== 0);
    this.marks = new Map();
    for (const m of checked.messages) {
      if (!m.line || m.file !== this.program) continue;
      const mark = this.marks.get(m.line) ?? { severity: m.severity, texts: [] };
      if (m.severity === 'error') mark.severity = 'error';
      mark.texts.push(m.message);
      this.marks.set(m.line, mark);
    }
    this.lines.setMarks(this.marks);
    clear(this.messageList, checked.messages.length + assumed.length === 0 ? h('li', {}, text('no_messages')) : null,
      messages.map(m => h('li', { className: m.severity, ...this.leadsTo(m) }, m.line ? h('b', {}, `${baseName(m.file)}:${m.line} `) : null, m.message)),
      assumed.map(a => h('li', { className: 'note', ...clickable(() => this.tab('setup')) }, `${text('guess')}: ${a}`)));
    if (this.by === 'message') this.colour();
  }

  // To its line of the program, or to its setting.
  leadsTo(message) {
    if (!message.line) return {};
    if (message.file === this.program) return clickable(() => this.goTo(message.line));
    return message.file === this.job?.job ? clickable(() => { this.tab('setup'); this.setup.goTo(message.line); }) : {};
  }

  async showPath(name, program, same) {
    const path = readPath(await fileBytes(name));
    if (program !== this.program || (this.scene.path?.inPart && !path.inPart)) return;
    this.scene.setPath(path, same);
    const tools = [...new Set(path.tool)].sort((a, b) => a - b);
    this.toolNumber = '';
    clear(this.toolChoice, tools.length > 1 ? select(text('tool'), [['', text('tool_all')], ...tools.map(t => [t, 'T' + t])], '', t => { this.toolNumber = t; this.showKinds(); }) : null);
    this.colour();
    this.showSettings();
  }

  savePicture() {
    this.sceneBox.querySelector('canvas')?.toBlob(blob => {
      const address = URL.createObjectURL(blob);
      h('a', { href: address, download: `${baseName(this.program)}.png` }).click();
      URL.revokeObjectURL(address);
    });
  }

  showKinds() { this.scene?.show({ rapids: this.rapids.checked, tool: this.toolNumber }); }

  colour() {
    if (!this.scene?.path) return;
    const { path } = this.scene, most = this.scene.colour(this.by, new Map([...this.marks ?? []].map(([n, m]) => [n, m.severity])));
    const key = (name, colour) => h('span', { className: 'key' }, h('i', { style: `background: ${colour}` }), name);
    const rgb = c => `rgb(${c.join(',')})`;
    const legends = {
      kind: () => [key(text('kind_rapid'), 'rgb(217,98,43)'), key(text('kind_cutting'), 'rgb(40,118,190)')],
      tool: () => [...new Set(path.tool)].sort((a, b) => a - b).map(t => key('T' + t, rgb(TOOL_COLOURS[t % TOOL_COLOURS.length]))),
      feed: () => [h('span', {}, speed(0)), h('i', { className: 'ramp' }), h('span', {}, speed(most))],
      message: () => [key(text('messages'), 'rgb(200,45,40)')],
    };
    clear(this.legend, legends[this.by](), h('span', { className: 'note' }, `${grouped(path.count)} ${text('points')}. `, path.thinned ? text('thinned', length(path.chord_mm)) : '', path.inPart ? ' ' + text('path_in_part') : ''));
  }

  describe(i) {
    const { path, place } = this.scene, at = [0, 1, 2].map(k => 'XYZ'[k] + length(place[3 * i + k]).replace(/ .*/, '')).join(' ');
    const feed = path.feed_mm_per_min[i];
    return `${text('line')} ${path.line[i]} · ${at} · T${path.tool[i]}${Number.isFinite(feed) ? ' · ' + speed(feed) : ''}`;
  }

  // The value of a setting; null: it is not set, or no list of numbers.
  numbers(table, key) {
    const value = this.job.fields.find(f => f.table === table && f.key === key && !f.is_default)?.value;
    try { return JSON.parse(value ?? 'null'); } catch { return null; /* the check says so */ }
  }

  showSettings() {
    if (!this.scene || !this.job) return;
    const corners = this.numbers('stock', 'box_mm');
    this.scene.setBox(Array.isArray(corners) && corners.length === 2 ? corners : null);
    this.placePart(this.numbers('part', 'move_mm') ?? [0, 0, 0]);
    this.offerSolids();
    this.showSolids();
  }

  // Of what there is.
  offerSolids() {
    this.moveBox.hidden = this.partBox.hidden = !this.scene?.part;
    this.blankBox.hidden = !this.scene?.blank && !this.scene?.boxLines;
  }

  showSolids() { this.scene?.showSolids({ part: this.partShown.checked, blank: this.blankShown.checked }); }

  // Part and blank as the check has read them; move: of the job that was checked.
  async showMeshes(checked, job, move) {
    const read = async name => name ? new STLLoader().parse(await fileBytes(name)) : null;
    const settings = table => JSON.stringify([job.job, job.fields.filter(f => f.table === table && f.key !== 'move_mm' && !f.is_default).map(f => [f.key, f.value])]);
    for (const name of ['part', 'blank']) {
      const made = settings(name === 'part' ? 'part' : 'stock') + Boolean(checked[name]);
      if (this.meshes?.[name] === made) continue;
      this.meshes = { ...this.meshes, [name]: made };
      try {
        const geometry = await read(checked[name]);
        if (job.job !== this.job?.job) return;
        if (name === 'part') this.scene.setPart(geometry, move);
        else this.scene.setBlank(geometry);
      } catch (e) { this.said(e.message, true); }
    }
    this.showSettings();
  }

  // Where the part stands, in fields and in the picture.
  placePart(place) {
    this.place = place;
    this.scene.movePart(place);
    this.placeInputs.forEach((input, k) => { if (document.activeElement !== input) input.value = shownValue('move_mm', String(+place[k].toFixed(3))); });
  }

  // Into the job, once it stands still.
  partMoved(place, done) {
    this.placePart(place);
    if (done) this.moving.then(() => this.setup.edit(['set', 'part', 'move_mm', `[${place.map(v => +v.toFixed(6)).join(', ')}]`]));
  }

  moveControls() {
    this.placeInputs = [0, 1, 2].map(k => h('input', {
      size: 7, 'aria-label': `${text('move_part')} ${'XYZ'[k]}`, data: { move: 'XYZ'[k] },
      oninput: e => {
        const value = Number(givenValue('move_mm', e.target.value));
        if (e.target.value.trim() && Number.isFinite(value)) this.partMoved(this.place.map((v, a) => a === k ? value : v), true);
      },
    }));
    this.mover = h('input', { type: 'checkbox', id: 'mover', onchange: () => this.scene.setMoving(this.mover.checked ? (place, done) => this.partMoved(place, done) : null) });
    this.moveBox = h('span', { className: 'choice move', hidden: true, title: text('move_part_help') },
      h('label', {}, this.mover, ' ', text('move_part')), this.placeInputs.map((input, k) => h('label', {}, 'XYZ'[k], ' ', input)), unitOf('move_mm'));
    return this.moveBox;
  }

  solidControls() {
    const box = () => h('input', { type: 'checkbox', checked: true, onchange: () => this.showSolids() });
    return [this.partBox = h('label', { hidden: true }, this.partShown = box(), ' ', text('part')), this.blankBox = h('label', { hidden: true }, this.blankShown = box(), ' ', text('stock_box'))];
  }

  goTo(line) {
    this.lines.select(line, true);
    this.scene?.markLine(line);
  }

  async runsChanged(runs) {
    const over = r => !['queued', 'running'].includes(r.state), before = new Map(this.runs.runs.map(r => [r.id, r]));
    const ended = runs.filter(r => over(r) && before.has(r.id) && !over(before.get(r.id)));
    this.runs.showRuns(runs);
    document.documentElement.dataset.runs = runs.map(r => r.state).join(' ');
    if (!ended.length && this.jobs) return this.drawJobs();
    await this.readJobs();
    if (this.job && ended.some(r => r.job === this.job.job)) {
      this.job = await get('api/job', { job: this.job.job });
      this.runs.job = this.job;
      this.results.show(this.job, ended.at(-1).command);
      if (this.current === 'compare') this.comparison.show(this.job);
    }
  }

  // Of a run that may have ended just now.
  async showResults(job, command) {
    if (this.job?.job !== job) await this.openJob(job);
    else this.job = await get('api/job', { job });
    if (this.job?.job !== job) return;
    this.results.show(this.job, command);
    this.tab('results');
  }

  async runAll(command) {
    this.all.querySelector('select').value = '';
    for (const job of this.jobs)
      try { await post('api/run', { job: job.job, command, ...optionsOf({}) }); } catch (e) { this.said(`${job.job}: ${e.message}`, true); }
  }

  listen() {
    const over = on => document.body.classList.toggle('dragged', on);
    addEventListener('dragover', e => { e.preventDefault(); over(true); });
    addEventListener('dragleave', e => { if (!e.relatedTarget) over(false); });
    addEventListener('drop', e => { e.preventDefault(); over(false); this.dropped(e.dataTransfer.files[0]); });
    addEventListener('keydown', e => this.key(e));
  }

  key(e) {
    if (/^(INPUT|SELECT|TEXTAREA)$/.test(e.target.tagName) || e.ctrlKey || e.metaKey || e.altKey || !this.job) return;
    if (TABS[Number(e.key) - 1]) return this.tab(TABS[Number(e.key) - 1]);
    if (e.key === 'f') this.scene?.fit();
    if (e.key === 't') this.scene?.look('top');
    if (e.key === '/') {
      e.preventDefault();
      const asked = prompt(text('go_to_line'))?.trim();
      if (!asked) return;
      const line = /^\d+$/.test(asked) ? Number(asked) : this.lines.find(asked);
      if (line < 1 || line > this.lines.count) return this.said(text('not_found', asked), true);
      this.tab('path');
      this.goTo(line);
    }
    if (e.key === 'n' || e.key === 'p') {
      const lines = [...this.marks?.keys() ?? []].sort((a, b) => a - b), now = this.lines.selected;
      const next = e.key === 'n' ? lines.find(l => l > now) ?? lines[0] : lines.filter(l => l < now).at(-1) ?? lines.at(-1);
      if (next) this.goTo(next);
    }
  }
}

new Workbench().start();
