// Curves along the program's time, one below the other with one time axis.
import uPlot from 'uplot';
import { QUANTITIES, present, withUnit } from './quantities.js';
import { MINUS, element, fixed, niceLimit } from './text.js';

const COLOURS = ['#1668b8', '#d9622b'], GREY = '#9aa5b1', MARK = '#1d2733';
const HEIGHT = 132, AXIS_HEIGHT = 46;

// No line where nothing is cut. Where a cutting tooth has left no surface of its own, the line goes on.
const holes = (values, cutting) => Array.from(values, (v, i) => Number.isFinite(v) ? v : cutting[i] > 0.5 ? undefined : null);

// Rapids go far above the cutting feed, which is what the picture is for.
function feedTop(runs) {
  let top = 1;
  for (const r of runs) for (let i = 0; i < r.t.length; i++) if (r.cutting[i] > 0.5) top = Math.max(top, r.feed[i], r.command[i]);
  return niceLimit(top);
}

function seriesOf(runs, quantity) {
  const several = runs.length > 1, out = [];
  runs.forEach((r, i) => {
    if (quantity === 'feed' && i === 0) out.push({ run: 0, name: 'commanded', colour: GREY, values: Array.from(r.command) });
    if (!r[quantity]) return;
    const name = quantity === 'feed' ? (several ? 'actual ' + r.name : 'actual') : several ? r.name : '';
    out.push({ run: i, name, colour: COLOURS[i], values: holes(r[quantity], quantity === 'error' ? r.cutting : []) });
  });
  return out;
}

// One x axis for runs whose times differ.
function table(runs, series) {
  const parts = runs.map((r, i) => [Array.from(r.t), ...series.filter(s => s.run === i).map(s => s.values)]).filter(p => p.length > 1);
  return parts.length > 1 ? uPlot.join(parts) : parts[0];
}

// From the first to the last moment at which something is cut, a little wider.
function busyTime(runs, end) {
  let from = Infinity, to = -Infinity;
  for (const r of runs) for (let i = 0; i < r.t.length; i++) if (r.cutting[i] > 0.5) {
    from = Math.min(from, r.t[i]);
    to = Math.max(to, r.t[i]);
  }
  const aside = 0.02 * (to - from);
  return to > from ? { min: Math.max(0, from - aside), max: Math.min(end, to + aside) } : null;
}

export class Plots {
  // `chosen(t)`: a click at that time.
  constructor(box, runs, chosen) {
    Object.assign(this, { box, runs, chosen, selected: null });
    const names = present(runs);
    this.end = Math.max(...runs.map(r => r.t[r.t.length - 1]));
    this.plots = names.map((q, i) => this.plot(q, i + 1 === names.length));
    const busy = busyTime(runs, this.end);
    if (busy && busy.max - busy.min < 0.95 * this.end) this.plots.forEach(p => p.setScale('x', busy));
    new ResizeObserver(() => this.resize(box.clientWidth)).observe(box);
  }

  plot(quantity, last) {
    const { plot: title, decimals, border } = QUANTITIES[quantity], { runs } = this;
    const series = seriesOf(runs, quantity).sort((a, b) => a.run - b.run);
    const live = series.map(s => element('b'));
    const head = element('div', { className: 'plot-head' }, element('span', { className: 'plot-title', textContent: withUnit(title, QUANTITIES[quantity]) }),
      ...series.map((s, i) => {
        if (!s.name) return element('span', { className: 'key' }, live[i]);
        const swatch = element('i');
        swatch.style.background = s.colour;
        return element('span', { className: 'key' }, swatch, s.name + ' ', live[i]);
      }));
    const holder = element('div', { className: 'plot' });
    holder.dataset.quantity = quantity;
    this.box.append(head, holder);
    const top = quantity === 'feed' ? feedTop(runs) : null;
    const axis = { stroke: '#5c6877', grid: { stroke: '#e3e8ee', width: 1 }, ticks: { show: false }, font: '12px system-ui, sans-serif' };
    const u = new uPlot({
      width: this.width(), height: HEIGHT + (last ? AXIS_HEIGHT : 0), legend: { show: false },
      cursor: { sync: { key: 'path' }, y: false, drag: { x: true, y: false }, points: { size: 6 }, focus: { prox: -1 } },
      scales: { x: { time: false }, y: { range: top ? [0, top] : (_, low, high) => uPlot.rangeNum(Math.min(low, 0), Math.max(high, border ?? 0), 0.08, true) } },
      axes: [{ ...axis, show: true, size: last ? AXIS_HEIGHT - 18 : 4, values: last ? undefined : () => [],
        ...(last ? { label: 'machine time, s', labelSize: 18, labelFont: '12px system-ui, sans-serif' } : {}) },
        { ...axis, size: 56, values: (_, values) => values.map(v => String(v).replace('-', MINUS)) }],
      series: [{}, ...series.map(s => ({ stroke: s.colour, width: s.name === 'commanded' ? 1 : 1.4, points: { show: false }, spanGaps: false }))],
      hooks: {
        setCursor: [p => series.forEach((s, i) => { live[i].textContent = this.valueAt(p, i + 1, decimals); })],
        setScale: [(p, key) => { if (key === 'x') this.zoom(p); }],
        draw: [p => this.drawSelected(p), p => this.drawBorder(p, border)],
      },
    }, table(runs, series), holder);
    this.listen(u);
    return u;
  }

  // The value of the nearest point that the series has.
  valueAt(u, series, decimals) {
    const { idx } = u.cursor, values = u.data[series];
    if (idx == null) return '';
    for (let step = 0; step < 50; step++)
      for (const i of [idx - step, idx + step]) {
        if (values[i] === null) return '\u2013';
        if (values[i] !== undefined) return fixed(values[i], decimals);
      }
    return '\u2013';
  }

  listen(u) {
    let down = null;
    u.over.addEventListener('mousedown', e => { down = e.clientX; });
    u.over.addEventListener('click', e => {
      if (down !== null && Math.abs(e.clientX - down) < 4) this.chosen(u.posToVal(e.clientX - u.over.getBoundingClientRect().left, 'x'));
    });
    u.over.addEventListener('dblclick', () => this.plots.forEach(p => p.setScale('x', { min: 0, max: this.end })));
  }

  zoom(from) {
    if (this.zooming || !this.plots) return;
    this.zooming = true;
    const { min, max } = from.scales.x;
    for (const p of this.plots) if (p !== from) p.setScale('x', { min, max });
    this.zooming = false;
  }

  width() { return Math.max(240, this.box.clientWidth); }

  resize(width) {
    for (const p of this.plots) if (Math.abs(p.width - width) > 1) p.setSize({ width, height: p.height });
  }

  select(t) {
    this.selected = t;
    const { min, max } = this.plots[0].scales.x;
    if (t < min || t > max) this.plots.forEach(p => p.setScale('x', { min: t - (max - min) / 2, max: t + (max - min) / 2 }));
    this.plots.forEach(p => p.redraw(false));
  }

  drawSelected(u) {
    if (this.selected === null) return;
    const x = Math.round(u.valToPos(this.selected, 'x', true)), { left, top, width, height } = u.bbox, g = u.ctx;
    if (x >= left && x <= left + width) this.drawLine(g, x, top, x, top + height);
  }

  drawBorder(u, value) {
    if (value === undefined) return;
    const y = Math.round(u.valToPos(value, 'y', true)), { left, width } = u.bbox;
    this.drawLine(u.ctx, left, y, left + width, y, [6, 4]);
  }

  drawLine(g, ...[fromX, fromY, toX, toY, dashes = []]) {
    g.save();
    g.strokeStyle = MARK;
    g.lineWidth = devicePixelRatio;
    g.setLineDash(dashes);
    g.beginPath();
    g.moveTo(fromX, fromY);
    g.lineTo(toX, toY);
    g.stroke();
    g.restore();
  }
}
