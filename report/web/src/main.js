// The report page: pictures, and what ties them together.
import 'uplot/dist/uPlot.min.css';
import './report.css';
import { Matrix4, Vector3 } from 'three';
import { Chain } from './chain.js';
import { DIVERGING, SEQUENTIAL, gradient } from './colours.js';
import { programBytes, readPage } from './data.js';
import { Plots } from './plots.js';
import { QUANTITIES, present, withUnit } from './quantities.js';
import { PartScene } from './scene.js';
import { choice, element, fixed, menu, niceLimit, signed } from './text.js';

const byId = id => document.getElementById(id);

function say(sentence) {
  byId('scene').replaceChildren(element('p', { className: 'missing', textContent: sentence }));
  byId('scene').classList.add('empty');
}

const capital = word => word[0].toUpperCase() + word.slice(1);

const LEGENDS = {
  deflection: 'due to tool deflection, \u00b5m',
  contour: 'due to servo lag and corner rounding, \u00b5m',
};

class Page {
  constructor(page) {
    Object.assign(this, { page, lines: [], mode: page.surface ? 'before' : 'plain', quantity: null });
    this.limit = page.scales[0];
    this.names = page.names || ['before', 'after'];
    LEGENDS.change = `change of the form error (${this.names[1]} \u2212 ${this.names[0]}), \u00b5m`;
    this.compared = Boolean(page.surface && page.surface.error[1]) || page.runs.length > 1;
    if (page.runs.length && byId('plots')) {
      this.plots = new Plots(byId('plots'), page.runs, t => this.selectTime(t));
      this.show(null);
    }
    this.startScene();
  }

  run() { return this.mode === 'after' || (this.mode !== 'before' && this.lastRun === 1) ? this.page.runs.length - 1 : 0; }

  startScene() {
    if (!document.createElement('canvas').getContext('webgl2'))
      return say('This browser shows no 3-D picture (WebGL 2 is missing or switched off). The plots and tables are complete without it.');
    const tip = element('div', { className: 'tip', hidden: true });
    byId('scene').classList.add('live');
    this.scene = new PartScene(byId('scene'), this.page, {
      hover: (found, event) => this.hover(tip, found, event), click: found => found && this.selectPlace(found),
    });
    byId('scene').append(tip);
    this.controls();
    this.update();
  }

  controls() {
    const box = byId('part-controls'), { surface, stock, runs, scales } = this.page;
    if (surface) {
      const modes = surface.error[1] ? [['before', capital(this.names[0])], ['after', capital(this.names[1])], ['change', this.names[1] === 'after' ? 'Change' : 'Difference']] : [['before', 'Form error']];
      if (surface.contour) modes.push(...(surface.error[1] ? [] : [['deflection', 'Deflection']]), ['contour', 'Contour']);
      modes.push(['plain', 'Plain']);
      box.append(choice('Surface', modes, mode => {
        this.mode = mode;
        if (mode === 'before' || mode === 'after') this.lastRun = mode === 'after' ? 1 : 0;
        this.update();
      }).box);
      const values = new Set([...scales, ...[1, 2, 5, 10, 20, 50, 100, 200].filter(v => v < scales[0] * 2.5 && v > scales[0] / 60)]);
      const scale = menu('Scale', [...values].sort((a, b) => a - b).map(v => [String(v), `\u00b1 ${v} \u00b5m`]), v => { this.limit = Number(v); this.update(); });
      scale.list.value = String(scales[0]);
      box.append(scale.box);
    }
    if (surface) box.append(this.cutControl());
    if (this.page.measured) box.append(choice('Measured', [['shown', 'Shown'], ['hidden', 'Hidden']], shown => this.scene.showMeasured(shown === 'shown')).box);
    if (stock) box.append(choice('Stock', [['shown', 'Shown'], ['hidden', 'Hidden']], shown => this.scene.showStock(shown === 'shown')).box);
    if (runs.length)
      box.append(menu('Path', [['', 'hidden'], ...present(runs).map(q => [q, 'by ' + QUANTITIES[q].name])], q => { this.quantity = q || null; this.update(); }).box);
    const views = element('span', { className: 'choice' }, element('span', { className: 'label', textContent: 'View' }));
    for (const name of ['oblique', 'top', 'front', 'right']) {
      const button = element('button', { type: 'button', textContent: name[0].toUpperCase() + name.slice(1) });
      button.addEventListener('click', () => this.scene.look(name));
      views.append(button);
    }
    box.append(views);
    if (this.page.machine) this.machineControls(box);
  }

  // A plane across an axis that takes away what lies beyond it.
  cutControl() {
    const where = element('input', { type: 'range', min: 0, max: 1, step: 0.005, value: 0.5, ariaLabel: 'Place of the cut', hidden: true }), at = element('span');
    const axes = menu('Cut', [['', 'none'], ['0', 'across X'], ['1', 'across Y'], ['2', 'across Z']], () => show());
    const show = () => {
      where.hidden = axes.list.value === '';
      const mm = this.scene.setCut(where.hidden ? null : Number(axes.list.value), Number(where.value));
      at.textContent = where.hidden ? '' : `${'XYZ'[axes.list.value]} ${fixed(mm, 2)} mm`;
    };
    where.addEventListener('input', show);
    return element('span', { className: 'choice' }, axes.box, where, at);
  }

  // Of a program with rotary motion: how the table turns the part.
  machineControls(box) {
    this.chain = new Chain(this.page.machine.chain);
    this.letters = this.page.machine.chain.links.filter(l => l.rotary).map(l => l.axis).sort();
    this.turning = true;
    box.append(choice('Part', [['turned', 'As on the table'], ['still', 'At rest']], how => {
      this.turning = how === 'turned';
      this.pose();
    }).box);
  }

  rotary(row) {
    const r = this.page.runs[row.run];
    return Object.fromEntries(this.letters.map(l => [l, r[l.toLowerCase()][row.row]]));
  }

  // Part and tool as they are at the selected place.
  pose() {
    const { selected, scene } = this;
    if (!this.chain || !scene || !selected) return;
    const r = this.page.runs[selected.run], i = selected.row, of = a => Array.from(a.slice(3 * i, 3 * i + 3));
    const rotation = new Matrix4(), pose = { tool: r.tool[i], tip: of(r.place), axis: of(r.axis) };
    if (this.turning) rotation.extractRotation(this.chain.bodies({ X: 0, Y: 0, Z: 0, ...this.rotary(selected) }).part);
    scene.turn(rotation);
    scene.showTool(pose);
    const shown = new Vector3(...pose.axis).transformDirection(rotation);
    Object.assign(byId('scene').dataset, { tip: pose.tip.map(v => fixed(v, 3)).join(' '), tool: pose.tool, axis: pose.axis.map(v => v.toFixed(4)).join(' '), shown: shown.toArray().map(v => v.toFixed(4)).join(' ') });
  }

  // Ranges of the path's colours: the greatest of all runs, so that before and after compare.
  range(quantity) {
    if (QUANTITIES[quantity].diverging) return [-this.limit, this.limit];
    let most = QUANTITIES[quantity].border ?? 0;
    for (const r of this.page.runs)
      for (let i = 0; r[quantity] && i < r.t.length; i++) if (r.cutting[i] > 0.5 && r[quantity][i] > most) most = r[quantity][i];
    return [0, niceLimit(most)];
  }

  update() {
    const { mode, limit, quantity, scene } = this, run = this.run();
    scene.setSurface(mode, limit);
    const known = quantity && this.page.runs[run][quantity] ? quantity : null;
    scene.setPath(run, known, known && this.range(known), known && QUANTITIES[known].diverging);
    const legends = [];
    if (mode !== 'plain') legends.push(this.legend(LEGENDS[mode] || 'form error, \u00b5m', DIVERGING, [-limit, limit]));
    if (known) legends.push(this.legend('path: ' + withUnit(QUANTITIES[known].name, QUANTITIES[known]), QUANTITIES[known].diverging ? DIVERGING : SEQUENTIAL, this.range(known)));
    if (quantity && !known) legends.push(element('span', { textContent: `${QUANTITIES[quantity].name} is not known for this program` }));
    byId('legends').replaceChildren(...legends);
  }

  legend(name, stops, [low, high]) {
    const bar = element('div', { className: 'gradient' });
    bar.style.background = gradient(stops);
    const ticks = element('div', { className: 'ticks' });
    for (let i = 0; i <= 4; i++) {
      const v = +(low + i / 4 * (high - low)).toPrecision(3);
      ticks.append(element('span', { textContent: low < 0 ? signed(v, v % 1 ? 2 : 0) : fixed(v, v % 1 ? 1 : 0) }));
    }
    return element('div', { className: 'legend' }, element('div', { className: 'legend-name', textContent: name }), bar, ticks);
  }

  async line(run, number) {
    if (!this.lines[run]) {
      const bytes = await programBytes(run);
      this.lines[run] = bytes ? new TextDecoder().decode(bytes).split(/\r\n|\n|\r/) : [];
    }
    return this.lines[run][number - 1] ?? '';
  }

  // 'before +12.3 um, after -0.4 um' of a vertex.
  errors(vertex) {
    const { error } = this.page.surface;
    return error[1] ? `${signed(error[0][vertex], 2)} \u00b5m ${this.names[0]}, ${signed(error[1][vertex], 2)} \u00b5m ${this.names[1]}` : `${signed(error[0][vertex], 2)} \u00b5m`;
  }

  async hover(tip, found, event) {
    tip.hidden = !found;
    if (!found) return;
    const run = this.run(), { vertex, point } = found, at = 3 * (point ?? vertex ?? found.row);
    const place = (point !== undefined ? this.page.measured : vertex !== undefined ? this.page.surface : this.page.runs[run]).place;
    const block = vertex !== undefined ? (this.page.surface.block[run] || this.page.surface.block[0])[vertex] : this.page.runs[run].block[found.row];
    const what = point !== undefined ? `measured ${signed(this.page.measured.error[point], 2)} \u00b5m; predicted ${this.errors(vertex)}` : vertex !== undefined ? this.errors(vertex)
      : `${QUANTITIES[this.quantity].name} ${fixed(this.page.runs[run][this.quantity][found.row], QUANTITIES[this.quantity].decimals)} ${QUANTITIES[this.quantity].unit}`.trim();
    const text = block ? await this.line(run, block) : '';
    tip.replaceChildren(element('b', { textContent: what }),
      element('div', { textContent: ['X', 'Y', 'Z'].map((n, k) => n + fixed(place[at + k], 3)).join('  ') }),
      ...(block ? [element('div', { className: 'nc', textContent: `line ${block}${text ? ':  ' + text : ''}` })] : []));
    const area = byId('scene').getBoundingClientRect(), x = event.clientX - area.left, y = event.clientY - area.top;
    tip.style.left = `${Math.min(x + 16, area.width - tip.offsetWidth - 6)}px`;
    tip.style.top = `${y + 20 + tip.offsetHeight > area.height ? y - tip.offsetHeight - 12 : y + 20}px`;
  }

  selectTime(t) {
    const run = this.run(), times = this.page.runs[run].t;
    let low = 0, high = times.length - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      times[middle] < t ? low = middle + 1 : high = middle;
    }
    if (low > 0 && t - times[low - 1] < times[low] - t) low--;
    this.select(run, low);
  }

  selectPlace({ vertex, row }) {
    const run = this.run(), r = this.page.runs[run];
    if (!r) return;
    if (row !== undefined) return this.select(run, row);
    const { place, block } = this.page.surface, line = (block[run] || block[0])[vertex];
    let best = -1, least = Infinity;
    for (let i = 0; i < r.t.length; i++) {
      if (!(r.cutting[i] > 0.5) || (line && r.block[i] !== line)) continue;
      const d = [0, 1, 2].reduce((s, k) => s + (r.place[3 * i + k] - place[3 * vertex + k]) ** 2, 0);
      if (d < least) { least = d; best = i; }
    }
    if (best >= 0) this.select(run, best);
    this.scene.mark(place.slice(3 * vertex, 3 * vertex + 3));
  }

  select(run, row) {
    const r = this.page.runs[run];
    this.plots.select(r.t[row]);
    this.scene?.mark(r.place.slice(3 * row, 3 * row + 3));
    this.selected = { run, row };
    this.pose();
    this.show(this.selected);
  }

  async show(selected) {
    const box = byId('selected');
    if (!selected) return box.replaceChildren(element('span', { className: 'hint', textContent: 'Nothing selected: click a curve or the part.' }));
    const r = this.page.runs[selected.run], i = selected.row, line = r.block[i];
    const facts = [['time', `${fixed(r.t[i], 3)} s`], ['at', ['X', 'Y', 'Z'].map((n, k) => n + fixed(r.place[3 * i + k], 3)).join(' ')],
      ['feed', `${fixed(r.feed[i], 0)} of ${fixed(r.command[i], 0)} mm/min`]];
    for (const q of present([r])) if (q !== 'feed' && Number.isFinite(r[q][i])) facts.push([QUANTITIES[q].name, `${q === 'error' ? signed(r[q][i], 2) : fixed(r[q][i], QUANTITIES[q].decimals)} ${QUANTITIES[q].unit}`.trim()]);
    if (this.chain) facts.splice(2, 0, ['axes', Object.entries(this.rotary(selected)).map(([l, v]) => l + fixed(v, 3)).join(' ')]);
    const text = await this.line(selected.run, line);
    box.replaceChildren(
      element('div', { className: 'nc' }, element('b', { textContent: `line ${line}${r.name ? ' ' + r.name : ''}` }), ' ' + text),
      element('div', { className: 'facts' }, ...facts.map(([name, value]) => element('span', {}, element('i', { textContent: name }), ' ' + value))));
    box.dataset.line = line;
    box.dataset.run = r.name;
  }
}

async function offerDownload(page) {
  const link = byId('download'), last = byId('index') && JSON.parse(byId('index').textContent).runs.length - 1;
  const bytes = link && page.download ? await programBytes(last) : null;
  if (!bytes) return;
  link.href = URL.createObjectURL(new Blob([bytes], { type: 'application/octet-stream' }));
  link.hidden = false;
}

async function start() {
  if (typeof DecompressionStream === 'undefined')
    return say('This browser is too old for the pictures. The tables are complete without them.');
  const page = await readPage(), shown = new Page(page);
  await offerDownload(page);
  // Paper has another width than the window.
  addEventListener('beforeprint', () => shown.plots?.resize(680));
  addEventListener('afterprint', () => shown.plots?.resize(shown.plots.width()));
  document.documentElement.dataset.ready = 'yes';
}

start().catch(problem => {
  say(`The pictures could not be drawn (${problem.message}). The tables are complete without them.`);
  throw problem;
});
