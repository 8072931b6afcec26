// Positions of the axes over time, one plot each, with the limits of travel.
import uPlot from 'uplot';
import { MINUS, element, fixed } from './text.js';

const HEIGHT = 104, AXIS_HEIGHT = 46, MARK = '#1d2733', RED = '#c0392b';
// A limit is shown where the axis comes within this share of its way of it.
const NEAR = 0.35;

function rangeOf({ range, travel }) {
  let [low, high] = range;
  const way = Math.max(high - low, 1);
  if (travel[0] !== null && travel[0] > low - NEAR * way) low = Math.min(low, travel[0]);
  if (travel[1] !== null && travel[1] < high + NEAR * way) high = Math.max(high, travel[1]);
  return [low - 0.08 * way, high + 0.08 * way];
}

export class JointPlots {
  // `chosen(t)`: a click at that time.
  constructor(box, { time, axes, label }, chosen) {
    Object.assign(this, { box, axes, chosen, selected: 0, end: Math.max(time[time.length - 1], 1e-6) });
    this.plots = axes.map((axis, i) => this.plot(axis, Array.from(time), i + 1 === axes.length ? label : ''));
    new ResizeObserver(() => this.plots.forEach(p => { if (Math.abs(p.width - this.width()) > 1) p.setSize({ width: this.width(), height: p.height }); })).observe(box);
  }

  width() { return Math.max(240, this.box.clientWidth); }

  plot(axis, time, label) {
    const live = element('b'), { travel } = axis, limit = v => v === null ? 'unlimited' : fixed(v, 1).replace(/\.0$/, '');
    const head = element('div', { className: 'plot-head' },
      element('span', { className: 'plot-title', textContent: `${axis.axis}, ${axis.rotary ? 'degrees' : 'mm'}` }),
      element('span', { className: 'key' }, live),
      element('span', { className: 'key', textContent: travel[0] === null && travel[1] === null ? 'no limits of travel' : `travel ${limit(travel[0])} to ${limit(travel[1])}` }));
    const holder = element('div', { className: 'plot' });
    holder.dataset.axis = axis.axis;
    this.box.append(head, holder);
    const style = { stroke: '#5c6877', grid: { stroke: '#e3e8ee', width: 1 }, ticks: { show: false }, font: '12px system-ui, sans-serif' };
    const u = new uPlot({
      width: this.width(), height: HEIGHT + (label ? AXIS_HEIGHT : 0), legend: { show: false },
      cursor: { sync: { key: 'joints' }, y: false, drag: { x: true, y: false }, points: { size: 6 }, focus: { prox: -1 } },
      scales: { x: { time: false }, y: { range: rangeOf(axis) } },
      axes: [{ ...style, size: label ? AXIS_HEIGHT - 18 : 4, values: label ? undefined : () => [],
        ...(label ? { label, labelSize: 18, labelFont: '12px system-ui, sans-serif' } : {}) },
        { ...style, size: 56, values: (_, values) => values.map(v => String(v).replace('-', MINUS)) }],
      series: [{}, { stroke: '#1668b8', width: 1.4, points: { show: false } }],
      hooks: {
        setCursor: [p => { live.textContent = p.cursor.idx == null ? '' : fixed(axis.values[p.cursor.idx], 3); }],
        setScale: [(p, key) => { if (key === 'x') this.zoom(p); }],
        draw: [p => this.draw(p, axis)],
      },
    }, [time, Array.from(axis.values)], holder);
    let down = null;
    u.over.addEventListener('mousedown', e => { down = e.clientX; });
    u.over.addEventListener('click', e => {
      if (down !== null && Math.abs(e.clientX - down) < 4) this.chosen(u.posToVal(e.clientX - u.over.getBoundingClientRect().left, 'x'));
    });
    u.over.addEventListener('dblclick', () => this.plots.forEach(p => p.setScale('x', { min: 0, max: this.end })));
    return u;
  }

  zoom(from) {
    if (this.zooming || !this.plots) return;
    this.zooming = true;
    for (const p of this.plots) if (p !== from) p.setScale('x', { min: from.scales.x.min, max: from.scales.x.max });
    this.zooming = false;
  }

  select(t) {
    this.selected = t;
    this.plots?.forEach(p => p.redraw(false));
  }

  // Limits, what is beyond them, and the moment shown.
  draw(u, axis) {
    const { left, top, width, height } = u.bbox, g = u.ctx, dpr = devicePixelRatio;
    g.save();
    g.beginPath();
    g.rect(left, top, width, height);
    g.clip();
    axis.travel.forEach((limit, k) => {
      if (limit === null) return;
      const y = u.valToPos(limit, 'y', true);
      if (y < top - 1 || y > top + height + 1) return;
      g.fillStyle = 'rgba(192, 57, 43, 0.12)';
      k ? g.fillRect(left, top, width, y - top) : g.fillRect(left, y, width, top + height - y);
      g.strokeStyle = RED;
      g.lineWidth = dpr;
      g.setLineDash([6 * dpr, 4 * dpr]);
      g.beginPath();
      g.moveTo(left, y);
      g.lineTo(left + width, y);
      g.stroke();
      g.setLineDash([]);
    });
    g.strokeStyle = RED;
    g.lineWidth = 2.2 * dpr;
    g.beginPath();
    for (let i = 1; i < u.data[0].length; i++) {
      if (!axis.beyond[i]) continue;
      g.moveTo(u.valToPos(u.data[0][i - 1], 'x', true), u.valToPos(u.data[1][i - 1], 'y', true));
      g.lineTo(u.valToPos(u.data[0][i], 'x', true), u.valToPos(u.data[1][i], 'y', true));
    }
    g.stroke();
    const x = Math.round(u.valToPos(this.selected, 'x', true));
    g.strokeStyle = MARK;
    g.lineWidth = dpr;
    g.beginPath();
    g.moveTo(x, top);
    g.lineTo(x, top + height);
    g.stroke();
    g.restore();
  }
}
