#include "report/page_parts.h"

namespace camber::report {

const std::string_view kPlotScript = R"js(
const GREY = '#8b95a3', BLUE = '#1668b8', ORANGE = '#d9622b', INK = '#5c6877', RULE = '#e3e8ee';

function ticks(low, high, count) {
  const raw = (high - low) / count || 1, decade = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(s => s * decade).find(s => s >= raw * 0.999), out = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) out.push(+(i * step).toPrecision(12));
  return out;
}

// A plot's frame: scales, rules and labels. Gives back the context and the two mappings.
function frame(canvas, xs, ys, xName, yName) {
  const ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight, g = canvas.getContext('2d');
  canvas.width = w * ratio;
  canvas.height = h * ratio;
  g.scale(ratio, ratio);
  const left = 62, right = w - 12, top = 26, bottom = h - 40;
  const x = v => left + (v - xs[0]) / (xs[1] - xs[0]) * (right - left);
  const y = v => bottom - (v - ys[0]) / (ys[1] - ys[0]) * (bottom - top);
  g.font = '12px system-ui, sans-serif';
  g.fillStyle = INK;
  g.strokeStyle = RULE;
  g.lineWidth = 1;
  g.textAlign = 'right';
  g.textBaseline = 'middle';
  for (const v of ticks(ys[0], ys[1], 5)) {
    g.beginPath();
    g.moveTo(left, y(v));
    g.lineTo(right, y(v));
    g.stroke();
    g.fillText(v, left - 8, y(v));
  }
  g.textAlign = 'center';
  g.textBaseline = 'top';
  for (const v of ticks(xs[0], xs[1], Math.max(3, w / 110))) g.fillText(String(v).replace('-', '\u2212'), x(v), bottom + 6);
  g.fillText(xName, (left + right) / 2, bottom + 22);
  g.textAlign = 'left';
  g.fillText(yName, 4, 4);
  return { g, x, y, left, right, top, bottom };
}

function key(f, entries) {
  const { g } = f;
  let at = f.right;
  g.textBaseline = 'top';
  g.textAlign = 'right';
  for (const [name, colour] of [...entries].reverse()) {
    g.fillStyle = INK;
    g.fillText(name, at, 4);
    at -= g.measureText(name).width + 18;
    g.fillStyle = colour;
    g.fillRect(at, 8, 13, 4);
    at -= 14;
  }
}

function drawHistogram(canvas, data) {
  const { limit, before, after } = data, n = before.length, width = 2 * limit / n;
  const most = Math.max(...before, ...(after || []), 1e-9);
  const f = frame(canvas, [-limit, limit], [0, most * 1.06], 'form error, \u00b5m', '% of the surface');
  const bars = (values, fill, stroke) => values.forEach((v, i) => {
    const x0 = f.x(-limit + i * width), x1 = f.x(-limit + (i + 1) * width);
    f.g.fillStyle = fill;
    f.g.fillRect(x0, f.y(v), Math.max(1, x1 - x0 - 0.5), f.bottom - f.y(v));
  });
  bars(before, after ? 'rgba(139,149,163,0.85)' : BLUE);
  if (after) bars(after, 'rgba(22,104,184,0.72)');
  key(f, after ? [['before', GREY], ['after', BLUE]] : [['all points', BLUE]]);
}

class FeedPlot {
  constructor(canvas, runs) {
    Object.assign(this, { canvas, runs });
    this.end = Math.max(...runs.map(r => r.t[r.t.length - 1]));
    this.most = Math.max(...runs.map(r => r.feed.reduce((a, b) => Math.max(a, b), 1)));
    // Rapids go far above the cutting feed, which is what the picture is for: they are cut off where cutting takes
    // most of the time.
    const usual = Float32Array.from(runs[0].command).sort()[Math.floor(runs[0].command.length / 2)];
    if (usual > 0 && this.most > 2 * usual) this.most = 1.5 * usual;
    this.reset();
    canvas.addEventListener('wheel', e => this.zoom(e), { passive: false });
    canvas.addEventListener('dblclick', () => { this.reset(); this.draw(); });
    canvas.addEventListener('pointerdown', e => { this.from = e.clientX; canvas.setPointerCapture(e.pointerId); });
    canvas.addEventListener('pointerup', () => { this.from = null; });
    canvas.addEventListener('pointermove', e => this.pan(e));
  }
  reset() { this.range = [0, this.end]; }
  zoom(e) {
    e.preventDefault();
    const box = this.canvas.getBoundingClientRect(), share = Math.min(1, Math.max(0, (e.clientX - box.left - 62) / (box.width - 74)));
    const [a, b] = this.range, length = Math.min(this.end, Math.max(0.02, (b - a) * Math.exp(e.deltaY * 0.0015)));
    this.moveTo(a + share * (b - a) - share * length, length);
  }
  pan(e) {
    if (this.from == null) return;
    const length = this.range[1] - this.range[0];
    const shift = (this.from - e.clientX) / (this.canvas.clientWidth - 74) * length;
    this.from = e.clientX;
    this.moveTo(this.range[0] + shift, length);
  }
  moveTo(start, length) {
    const a = Math.min(Math.max(0, start), this.end - length);
    this.range = [a, a + length];
    this.draw();
  }
  draw() {
    const f = frame(this.canvas, this.range, [0, this.most * 1.06], 'time, s', 'feed, mm/min');
    const { g } = f;
    g.save();
    g.beginPath();
    g.rect(f.left, f.top, f.right - f.left, f.bottom - f.top);
    g.clip();
    const [before, after] = this.runs;
    this.line(f, before.t, before.command, GREY, 1);
    if (after) this.line(f, after.t, after.feed, ORANGE, 2.6);
    this.line(f, before.t, before.feed, BLUE, 1.1);
    g.restore();
    key(f, [['commanded', GREY], ['actual', BLUE], ...(this.runs.length > 1 ? [['actual, compensated program', ORANGE]] : [])]);
  }
  line(f, t, v, colour, width) {
    const { g } = f, [a, b] = this.range;
    g.strokeStyle = colour;
    g.lineWidth = width;
    g.beginPath();
    let open = false;
    for (let i = 0; i < t.length; i++) {
      if (i + 1 < t.length && t[i + 1] < a) continue;
      open ? g.lineTo(f.x(t[i]), f.y(v[i])) : g.moveTo(f.x(t[i]), f.y(v[i]));
      open = true;
      if (t[i] > b) break;
    }
    g.stroke();
  }
}
)js";

}  // namespace camber::report
