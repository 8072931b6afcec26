// The page of a machine with rotary axes: two pictures, a slider over time, and the position of every axis.
import { Chain } from './chain.js';
import { bytesOf, inflate, read } from './data.js';
import { JointPlots } from './joint_plots.js';
import { MachineScene } from './machine_scene.js';
import { choice, element, fixed, menu } from './text.js';

const byId = id => document.getElementById(id);
const BEYOND = 1e-4;  // what rounding to a float leaves
const MOMENTS = 400, PLAY_S = 20;

function triples(bytes, arrays) {
  const parts = arrays.map(a => read(bytes, a)), out = new Float32Array(3 * parts[0].length);
  for (let i = 0; i < parts[0].length; i++) parts.forEach((p, k) => { out[3 * i + k] = p[i]; });
  return out;
}

function partOf(bytes, part) {
  const corners = part.corner.map(a => read(bytes, a)), triangles = new Uint32Array(3 * corners[0].length);
  for (let i = 0; i < corners[0].length; i++) corners.forEach((c, k) => { triangles[3 * i + k] = c[i]; });
  return { place: triples(bytes, part.place), triangles };
}

async function readMachine() {
  const index = JSON.parse(byId('index').textContent), bytes = await inflate(bytesOf('arrays'));
  const axes = index.axes.map(a => {
    const values = read(bytes, a.values), [low, high] = a.travel;
    return { ...a, values, beyond: Array.from(values, v => (low !== null && v < low - BEYOND) || (high !== null && v > high + BEYOND)) };
  });
  const time = read(bytes, index.time);
  return {
    chain: new Chain(index.chain), work: index.work, diameter: index.diameter, label: index.time_label, axes, time,
    line: read(bytes, index.line), length: read(bytes, index.length), tip: triples(bytes, index.tip), axis: triples(bytes, index.axis),
    part: index.part && partOf(bytes, index.part), beyond: Array.from(time, (_, i) => axes.some(a => a.beyond[i])),
  };
}

class MachinePage {
  constructor(page) {
    Object.assign(this, { page, t: 0, playing: false, end: page.time[page.time.length - 1] });
    page.moments = Array.from({ length: MOMENTS + 1 }, (_, k) => this.stateAt(k / MOMENTS * this.end));  // at equal times
    this.plots = new JointPlots(byId('plots'), page, t => this.go(t));
    this.startScenes();
    this.controls();
    this.go(0);
  }

  startScenes() {
    this.scenes = [];
    const boxes = ['scene', 'part-scene'].map(byId);
    if (!document.createElement('canvas').getContext('webgl2')) {
      for (const box of boxes) {
        box.replaceChildren(element('p', { className: 'missing', textContent: 'This browser shows no 3-D picture (WebGL 2 is missing or switched off). The plots and tables are complete without it.' }));
        box.classList.add('empty');
      }
      return;
    }
    this.scenes = boxes.map((box, k) => new MachineScene(box, this.page, k === 1));
  }

  controls() {
    const views = element('span', { className: 'choice' }, element('span', { className: 'label', textContent: 'View' }));
    for (const name of ['oblique', 'top', 'front', 'right']) {
      const button = element('button', { type: 'button', textContent: name[0].toUpperCase() + name.slice(1) });
      button.addEventListener('click', () => this.scenes.forEach(s => s.look(name)));
      views.append(button);
    }
    if (this.scenes.length) byId('machine-controls').append(views);
    this.button = element('button', { type: 'button', textContent: 'Play' });
    this.slider = element('input', { type: 'range', min: 0, max: 1, step: 'any', value: 0, ariaLabel: 'Time' });
    this.clock = element('span');
    this.button.addEventListener('click', () => this.playing ? this.pause() : this.play());
    this.slider.addEventListener('input', () => { this.pause(); this.go(this.slider.value * this.end); });
    const speeds = [['', `whole program in ${PLAY_S} s`], ['1', 'real time'], ['10', '10 times'], ['100', '100 times']];
    const speed = menu('Speed', speeds, value => { this.speed = Number(value) || 0; });
    byId('time').append(this.button, this.slider, this.clock);
    byId('machine-controls').append(speed.box);
  }

  play() {
    if (this.t >= this.end) this.go(0);
    this.playing = true;
    this.button.textContent = 'Pause';
    let last = performance.now();
    const step = now => {
      if (!this.playing) return;
      this.go(Math.min(this.end, this.t + (now - last) / 1000 * (this.speed || this.end / PLAY_S)));
      last = now;
      if (this.t >= this.end) this.pause();
      else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  pause() {
    this.playing = false;
    this.button.textContent = 'Play';
  }

  // The last sample at or before `t`.
  indexAt(t) {
    const { time } = this.page;
    let low = 0, high = time.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (time[middle] <= t + 1e-9) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  // Positions between two samples are on the straight line between them.
  stateAt(t) {
    const { time, axes, length, line, beyond } = this.page, i = this.indexAt(t), k = Math.min(i + 1, time.length - 1);
    const u = time[k] > time[i] ? Math.min(1, Math.max(0, (t - time[i]) / (time[k] - time[i]))) : 0, values = {};
    for (const a of axes) values[a.axis] = a.values[i] + u * (a.values[k] - a.values[i]);
    const out = new Set(axes.filter(a => a.beyond[u > 0.5 ? k : i]).map(a => a.axis));
    return { values, length: length[i], line: line[u > 1e-6 ? k : i], index: u > 0.5 ? k : i, out, beyond: beyond[u > 0.5 ? k : i] };
  }

  go(t) {
    this.t = Math.max(0, Math.min(this.end, t));
    const state = this.stateAt(this.t);
    this.scenes.forEach(s => s.show(state));
    this.slider && (this.slider.value = this.end > 0 ? this.t / this.end : 0);
    this.clock && (this.clock.textContent = `${fixed(this.t, 2)} of ${fixed(this.end, 2)} s`);
    this.plots.select(this.t);
    this.describe(state);
  }

  describe(state) {
    const { axes, axis, tip, work } = this.page, i = 3 * state.index, box = byId('selected');
    const fact = (name, text, beyond) => element('span', { className: beyond ? 'beyond' : '' }, element('i', { textContent: `${name} ` }), text);
    const facts = element('div', { className: 'facts' },
      ...axes.map(a => fact(a.axis, fixed(state.values[a.axis], 3) + (a.rotary ? '\u00b0' : ' mm') + (state.out.has(a.axis) ? ' beyond travel' : ''), state.out.has(a.axis))));
    const lean = Math.acos(Math.max(-1, Math.min(1, axis[i + 2]))) * 180 / Math.PI;
    const tool = element('div', { className: 'facts' },
      fact('tip on the part', [0, 1, 2].map(k => 'XYZ'[k] + fixed(tip[i + k] - work[k], 3)).join(' ')),
      fact('tool axis', `(${[0, 1, 2].map(k => fixed(axis[i + k], 4)).join(', ')})`), fact('tilt', `${fixed(lean, 2)}\u00b0`));
    box.dataset.line = state.line;
    box.replaceChildren(element('div', { className: 'nc', textContent: `line ${state.line}` }), facts, tool);
  }
}

readMachine().then(page => {
  window.machinePage = new MachinePage(page);
  requestAnimationFrame(() => requestAnimationFrame(() => { document.documentElement.dataset.ready = 'yes'; }));
});
