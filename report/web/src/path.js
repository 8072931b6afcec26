// The page of compress, resegment and rasters: the path before and after on a plain canvas, lines and arcs in two colours.
import { bytesOf, inflate, read } from './data.js';
import { choice, element } from './text.js';

const RAPID = 1, LINE = 2, ARC = 3, KEPT_LINE = 4, KEPT_ARC = 5;  // report/path_picture.h
const STYLES = {
  [RAPID]: { name: 'rapid', colour: '#b4bcc6', width: 0.7, dash: [4, 4] },
  [KEPT_LINE]: { name: 'line, left as it was', colour: '#8fb4d8', width: 1 },
  [KEPT_ARC]: { name: 'arc, left as it was', colour: '#eab393', width: 1 },
  [LINE]: { name: 'line', colour: '#1668b8', width: 1.3 },
  [ARC]: { name: 'arc', colour: '#d9622b', width: 1.3 },
};
const PART_COLOUR = '#3b4652';
const MOST_DOTS = 6000, DOT_PIXELS = 5, REACH = 12;
const VIEWS = { oblique: [-0.6, 1.0], top: [0, 0], front: [0, Math.PI / 2], right: [-Math.PI / 2, Math.PI / 2] };

class PathView {
  constructor(box, paths, worst, part) {
    Object.assign(this, { box, paths, worst, part, path: paths[1], drag: null });
    this.canvas = element('canvas', { tabIndex: 0 });
    this.tip = element('div', { className: 'tip', hidden: true });
    box.append(this.canvas, this.tip);
    this.bounds();
    this.look(part ? 'top' : 'oblique');
    this.listen();
    new ResizeObserver(() => { this.resize(); this.draw(); }).observe(box);
    this.resize();
    this.draw();
  }

  // Of all cutting moves of both paths, and the part.
  bounds() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const { place: [x, y, z], kind } of this.part ? [...this.paths, this.part] : this.paths)
      for (let i = 0; i < x.length; i++) {
        if (kind[i] <= RAPID) continue;
        for (const j of i > 0 ? [i - 1, i] : [i])
          [x[j], y[j], z[j]].forEach((v, a) => { low[a] = Math.min(low[a], v); high[a] = Math.max(high[a], v); });
      }
    if (!(low[0] <= high[0])) low.fill(0), high.fill(1);
    this.middle = low.map((v, a) => (v + high[a]) / 2);
    this.corners = [0, 1, 2, 3, 4, 5, 6, 7].map(c => [0, 1, 2].map(a => (c >> a & 1 ? high : low)[a]));
  }

  resize() {
    const { clientWidth: w, clientHeight: h } = this.box, ratio = window.devicePixelRatio || 1;
    Object.assign(this.canvas, { width: w * ratio, height: h * ratio });
    this.canvas.style.width = w + 'px';
    this.canvas.style.height = h + 'px';
    Object.assign(this, { width: w, height: h, ratio });
    if (!this.zoomed) this.fit();
  }

  look(name) {
    [this.turn, this.tilt] = VIEWS[name];
    this.zoomed = false;
    if (this.width) this.fit();
  }

  // Rows of the rotation that lead to right and up on the screen: turned about Z, then tilted about the right.
  axes() {
    const [c, s, ct, st] = [Math.cos(this.turn), Math.sin(this.turn), Math.cos(this.tilt), Math.sin(this.tilt)];
    return [[c, -s, 0], [s * ct, c * ct, st]];
  }

  fit() {
    const axes = this.axes();
    let [w, h] = [0, 0];
    for (const p of this.corners) {
      const v = p.map((x, a) => x - this.middle[a]);
      w = Math.max(w, Math.abs(axes[0][0] * v[0] + axes[0][1] * v[1] + axes[0][2] * v[2]));
      h = Math.max(h, Math.abs(axes[1][0] * v[0] + axes[1][1] * v[1] + axes[1][2] * v[2]));
    }
    this.scale = 0.46 * Math.min(this.width / Math.max(w, 1e-3), this.height / Math.max(h, 1e-3));
    this.shift = [this.width / 2, this.height / 2];
  }

  // Screen places of all points.
  project({ place: [x, y, z] } = this.path) {
    const [[a, b, c], [d, e, f]] = this.axes(), [mx, my, mz] = this.middle;
    const sx = new Float32Array(x.length), sy = new Float32Array(x.length), k = this.scale, [px, py] = this.shift;
    for (let i = 0; i < x.length; i++) {
      const [vx, vy, vz] = [x[i] - mx, y[i] - my, z[i] - mz];
      sx[i] = px + k * (a * vx + b * vy + c * vz);
      sy[i] = py - k * (d * vx + e * vy + f * vz);
    }
    return [sx, sy];
  }

  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => { this.waiting = false; this.paint(); });
  }

  paint() {
    const g = this.canvas.getContext('2d'), { kind, ends } = this.path, [x, y] = this.screen = this.project();
    g.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    g.clearRect(0, 0, this.width, this.height);
    g.lineJoin = 'miter';
    if (this.part) this.outline(g);
    const away = i => Math.max(x[i - 1], x[i]) < 0 || Math.min(x[i - 1], x[i]) > this.width || Math.max(y[i - 1], y[i]) < 0 || Math.min(y[i - 1], y[i]) > this.height;
    for (const k of [RAPID, KEPT_LINE, KEPT_ARC, LINE, ARC]) {
      const { colour, width, dash = [] } = STYLES[k];
      Object.assign(g, { strokeStyle: colour, lineWidth: width });
      g.setLineDash(dash);
      g.beginPath();
      for (let i = 1, joined = false; i < x.length; i++) {
        if (kind[i] !== k || away(i)) { joined = false; continue; }
        if (!joined) g.moveTo(x[i - 1], y[i - 1]);
        g.lineTo(x[i], y[i]);
        joined = true;
      }
      g.stroke();
    }
    g.setLineDash([]);
    this.dots(g, x, y, kind, ends);
    if (this.worst) this.ring(g);
  }

  outline(g) {
    const [x, y] = this.project(this.part), { kind } = this.part;
    Object.assign(g, { strokeStyle: PART_COLOUR, lineWidth: 1.2 });
    g.setLineDash([]);
    g.beginPath();
    for (let i = 0; i < x.length; i++) kind[i] === 0 ? g.moveTo(x[i], y[i]) : g.lineTo(x[i], y[i]);
    g.stroke();
  }

  // Ends of blocks, where they are few enough and far enough apart to be told from each other.
  dots(g, x, y, kind, ends) {
    if (this.path.thinned) return;
    const seen = [];
    let far = 0, last = -1;
    for (let i = 0; i < x.length && seen.length <= MOST_DOTS; i++) {
      if (!ends[i] || kind[i] <= RAPID || x[i] < 0 || x[i] > this.width || y[i] < 0 || y[i] > this.height) continue;
      if (last >= 0 && Math.hypot(x[i] - x[last], y[i] - y[last]) >= DOT_PIXELS) far++;
      seen.push(last = i);
    }
    if (seen.length > MOST_DOTS || far < 0.5 * seen.length) return;
    for (const i of seen) {
      g.fillStyle = STYLES[kind[i]].colour;
      g.fillRect(x[i] - 1.6, y[i] - 1.6, 3.2, 3.2);
    }
  }

  ring(g) {
    const axes = this.axes(), v = this.worst.map((p, a) => p - this.middle[a]);
    const at = axes.map(r => this.scale * (r[0] * v[0] + r[1] * v[1] + r[2] * v[2]));
    Object.assign(g, { strokeStyle: '#111', lineWidth: 2 });
    g.beginPath();
    g.arc(this.shift[0] + at[0], this.shift[1] - at[1], 8, 0, 2 * Math.PI);
    g.stroke();
  }

  listen() {
    const c = this.canvas;
    c.addEventListener('contextmenu', e => e.preventDefault());
    c.addEventListener('pointerdown', e => {
      c.setPointerCapture(e.pointerId);
      this.drag = { x: e.offsetX, y: e.offsetY, moves: e.button === 2 || e.shiftKey || e.ctrlKey };
    });
    c.addEventListener('pointerup', () => { this.drag = null; });
    c.addEventListener('pointermove', e => {
      if (!this.drag) return this.hover(e);
      const [dx, dy] = [e.offsetX - this.drag.x, e.offsetY - this.drag.y];
      Object.assign(this.drag, { x: e.offsetX, y: e.offsetY });
      this.zoomed = true;
      if (this.drag.moves) this.shift = [this.shift[0] + dx, this.shift[1] + dy];
      else {
        this.turn += 0.008 * dx;
        this.tilt = Math.min(Math.PI, Math.max(0, this.tilt - 0.008 * dy));
      }
      this.draw();
    });
    c.addEventListener('pointerleave', () => { this.tip.hidden = true; });
    c.addEventListener('wheel', e => {
      e.preventDefault();
      const k = Math.exp(-0.0015 * e.deltaY);
      this.shift = [e.offsetX + k * (this.shift[0] - e.offsetX), e.offsetY + k * (this.shift[1] - e.offsetY)];
      this.scale *= k;
      this.zoomed = true;
      this.draw();
    }, { passive: false });
    c.addEventListener('dblclick', () => { this.zoomed = false; this.fit(); this.draw(); });
  }

  hover(e) {
    const [x, y] = this.screen || [[], []], { place, kind, block } = this.path;
    let found = -1, least = REACH;
    for (let i = 1; i < x.length; i++) {
      if (kind[i] === 0) continue;
      const [ax, ay, bx, by] = [x[i - 1], y[i - 1], x[i] - x[i - 1], y[i] - y[i - 1]], l = bx * bx + by * by;
      const t = l > 0 ? Math.min(1, Math.max(0, ((e.offsetX - ax) * bx + (e.offsetY - ay) * by) / l)) : 0;
      const d = Math.hypot(ax + t * bx - e.offsetX, ay + t * by - e.offsetY);
      if (d < least) [least, found] = [d, i];
    }
    this.tip.hidden = found < 0;
    if (found < 0) return;
    this.tip.textContent = `line ${block[found] + 1} ${this.path.name}: ${STYLES[kind[found]].name} to ` +
      'XYZ'.split('').map((a, k) => a + place[k][found].toFixed(3)).join(' ');
    this.tip.style.left = Math.min(e.offsetX + 14, this.width - 260) + 'px';
    this.tip.style.top = Math.max(4, e.offsetY - 34) + 'px';
  }
}

function legend(paths, part) {
  const used = new Set(paths.flatMap(p => [...new Set(p.kind)]));
  const styles = Object.entries(STYLES).filter(([k]) => used.has(Number(k))).reverse().map(([, style]) => style);
  if (part) styles.push({ name: 'part', colour: PART_COLOUR });
  return styles.map(style => {
    const line = element('i');
    line.style.background = style.colour;
    return element('span', { className: 'key' }, line, style.name);
  });
}

async function start() {
  const index = JSON.parse(document.getElementById('index').textContent), bytes = await inflate(bytesOf('arrays'));
  const picture = p => {
    const packed = read(bytes, p.kind);
    return { name: p.name, thinned: p.thinned, place: p.place.map(a => read(bytes, a)), block: read(bytes, p.block), kind: packed.map(v => v >> 1), ends: packed.map(v => v & 1) };
  };
  const paths = index.paths.map(picture), part = index.part && picture(index.part);
  const view = new PathView(document.getElementById('scene'), paths, index.worst, part);
  const program = choice('Program', [['after', 'After'], ['before', 'Before']], which => { view.path = paths[which === 'after' ? 1 : 0]; view.draw(); });
  const looks = element('span', { className: 'choice' }, element('span', { className: 'label', textContent: 'View' }));
  for (const name of Object.keys(VIEWS)) {
    const button = element('button', { type: 'button', textContent: name[0].toUpperCase() + name.slice(1) });
    button.addEventListener('click', () => { view.look(name); view.draw(); });
    looks.append(button);
  }
  document.getElementById('path-controls').append(program.box, looks);
  document.getElementById('path-legend').append(...legend(paths, part));
  requestAnimationFrame(() => requestAnimationFrame(() => { document.documentElement.dataset.ready = 'yes'; }));
}

start();
