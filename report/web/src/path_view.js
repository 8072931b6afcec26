// A path on a plain canvas: turned, moved, zoomed; the cursor reads out what is below it.
import { element } from './text.js';

export const RAPID = 1, LINE = 2, ARC = 3, KEPT_LINE = 4, KEPT_ARC = 5;  // report/path_picture.h
export const PART_COLOUR = '#3b4652', QUIET = '#c3cad3';
export const VIEWS = { oblique: [-0.6, 1.0], top: [0, 0], front: [0, Math.PI / 2], right: [-Math.PI / 2, Math.PI / 2] };
const MOST_DOTS = 6000, DOT_PIXELS = 5, REACH = 12;
const STROKED_AT_ONCE = 500;  // a stroke's time grows faster than its length

export class PathView {
  // styles: how each kind is drawn; describe(path, i): what the cursor reads of point i.
  constructor(box, { paths, worst, part, styles, describe }) {
    Object.assign(this, { box, paths, worst, part, styles, describe, path: paths[paths.length - 1], fingers: new Map() });
    this.shown = () => true;  // of a point's index
    this.bins = null;         // {of: bin of each point, colours}: instead of a style's colour
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
    const stroke = chosen => {
      g.beginPath();
      for (let i = 1, joined = false, pieces = 0; i < x.length; i++) {
        if (!chosen(i) || !this.shown(i) || away(i)) { joined = false; continue; }
        if (!joined) g.moveTo(x[i - 1], y[i - 1]);
        g.lineTo(x[i], y[i]);
        joined = true;
        if (++pieces % STROKED_AT_ONCE === 0) {
          g.stroke();
          g.beginPath();
          joined = false;
        }
      }
      g.stroke();
    };
    for (const k of [RAPID, KEPT_LINE, KEPT_ARC, LINE, ARC]) {
      if (this.bins && k !== RAPID) continue;
      const { colour, width, dash = [] } = this.styles[k];
      Object.assign(g, { strokeStyle: this.bins ? QUIET : colour, lineWidth: width });
      g.setLineDash(dash);
      stroke(i => kind[i] === k);
    }
    g.setLineDash([]);
    this.bins?.colours.forEach((colour, bin) => {
      Object.assign(g, { strokeStyle: colour, lineWidth: 1.5 });
      stroke(i => kind[i] > RAPID && this.bins.of[i] === bin);
    });
    if (!this.bins) this.dots(g, x, y, kind, ends);
    if (this.worst) this.ring(g);
    this.triad(g);
  }

  // Which way X, Y and Z lead; an axis that points at the reader is left out.
  triad(g) {
    const [right, up] = this.axes(), [x, y] = [34, this.height - 34];
    Object.assign(g, { strokeStyle: '#5c6877', fillStyle: '#5c6877', lineWidth: 1.5, font: '12px system-ui, sans-serif', textAlign: 'center', textBaseline: 'middle' });
    for (const a of [0, 1, 2]) {
      const [dx, dy] = [right[a], -up[a]];
      if (Math.hypot(dx, dy) < 0.2) continue;
      g.beginPath();
      g.moveTo(x, y);
      g.lineTo(x + 20 * dx, y + 20 * dy);
      g.stroke();
      g.fillText('XYZ'[a], x + 28 * dx, y + 28 * dy);
    }
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
      if (!ends[i] || kind[i] <= RAPID || !this.shown(i) || x[i] < 0 || x[i] > this.width || y[i] < 0 || y[i] > this.height) continue;
      if (last >= 0 && Math.hypot(x[i] - x[last], y[i] - y[last]) >= DOT_PIXELS) far++;
      seen.push(last = i);
    }
    if (seen.length > MOST_DOTS || far < 0.5 * seen.length) return;
    for (const i of seen) {
      g.fillStyle = this.styles[kind[i]].colour;
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
    const lift = e => this.fingers.delete(e.pointerId);
    c.addEventListener('pointerdown', e => {
      c.setPointerCapture(e.pointerId);
      this.fingers.set(e.pointerId, { x: e.offsetX, y: e.offsetY, moves: e.button === 2 || e.shiftKey || e.ctrlKey });
    });
    c.addEventListener('pointerup', lift);
    c.addEventListener('pointercancel', lift);
    c.addEventListener('pointermove', e => {
      const finger = this.fingers.get(e.pointerId);
      if (!finger) return this.hover(e);
      const before = this.grip(), [dx, dy] = [e.offsetX - finger.x, e.offsetY - finger.y];
      Object.assign(finger, { x: e.offsetX, y: e.offsetY });
      const after = this.grip();
      this.zoomed = true;
      if (this.fingers.size > 1) {
        this.zoom(after.x, after.y, after.apart / Math.max(before.apart, 1));
        this.shift = [this.shift[0] + after.x - before.x, this.shift[1] + after.y - before.y];
      } else if (finger.moves) this.shift = [this.shift[0] + dx, this.shift[1] + dy];
      else {
        this.turn += 0.008 * dx;
        this.tilt = Math.min(Math.PI, Math.max(0, this.tilt - 0.008 * dy));
      }
      this.draw();
    });
    c.addEventListener('pointerleave', () => { this.tip.hidden = true; });
    c.addEventListener('wheel', e => {
      e.preventDefault();
      this.zoom(e.offsetX, e.offsetY, Math.exp(-0.0015 * e.deltaY));
      this.draw();
    }, { passive: false });
    c.addEventListener('dblclick', () => { this.zoomed = false; this.fit(); this.draw(); });
  }

  // The middle of the first two fingers and how far they are apart.
  grip() {
    const [a, b = a] = this.fingers.values();
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, apart: Math.hypot(a.x - b.x, a.y - b.y) };
  }

  zoom(x, y, k) {
    this.shift = [x + k * (this.shift[0] - x), y + k * (this.shift[1] - y)];
    this.scale *= k;
    this.zoomed = true;
  }

  hover(e) {
    const [x, y] = this.screen || [[], []], { kind } = this.path;
    let found = -1, least = REACH;
    for (let i = 1; i < x.length; i++) {
      if (kind[i] === 0 || !this.shown(i)) continue;
      const [ax, ay, bx, by] = [x[i - 1], y[i - 1], x[i] - x[i - 1], y[i] - y[i - 1]], l = bx * bx + by * by;
      const t = l > 0 ? Math.min(1, Math.max(0, ((e.offsetX - ax) * bx + (e.offsetY - ay) * by) / l)) : 0;
      const d = Math.hypot(ax + t * bx - e.offsetX, ay + t * by - e.offsetY);
      if (d < least) [least, found] = [d, i];
    }
    this.tip.hidden = found < 0;
    if (found < 0) return;
    this.tip.textContent = this.describe(this.path, found);
    this.tip.style.left = Math.max(4, Math.min(e.offsetX + 14, this.width - 260)) + 'px';
    this.tip.style.top = Math.max(4, e.offsetY - 34) + 'px';
  }
}
