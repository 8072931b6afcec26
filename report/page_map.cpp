#include "report/page_parts.h"

namespace camber::report {

const std::string_view kMapScript = R"js(
// Colours from blue (too much removed) over white to red (material left).
const STOPS = [[33, 102, 172], [146, 197, 222], [247, 247, 247], [244, 165, 130], [178, 24, 43]];
function colour(share) {  // 0 .. 1
  const s = Math.min(Math.max(share, 0), 1) * (STOPS.length - 1), i = Math.min(Math.floor(s), STOPS.length - 2), u = s - i;
  return [0, 1, 2].map(k => STOPS[i][k] + u * (STOPS[i + 1][k] - STOPS[i][k]));
}
const COLOURS = Array.from({ length: 256 }, (_, i) => colour(i / 255));

// The surface's points, all views alike: turned by yaw and elevation, seen in parallel.
class View {
  constructor(xyz) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < xyz.length; i++) {
      low[i % 3] = Math.min(low[i % 3], xyz[i]);
      high[i % 3] = Math.max(high[i % 3], xyz[i]);
    }
    this.middle = low.map((v, k) => (v + high[k]) / 2);
    this.radius = Math.hypot(...low.map((v, k) => (high[k] - v) / 2)) || 1;
    this.reset(-0.5, 0.75);
  }
  reset(yaw, elevation) { Object.assign(this, { yaw, elevation, zoom: 1, panX: 0, panY: 0 }); }
  axes() {
    const a = this.yaw, e = this.elevation, c = Math.cos, s = Math.sin;
    return { right: [c(a), s(a), 0], up: [-s(a) * s(e), c(a) * s(e), c(e)], out: [s(a) * c(e), -c(a) * c(e), s(e)] };
  }
}

class MapCanvas {
  constructor(canvas, map, spacing, view) {
    Object.assign(this, { canvas, map, spacing, view, context: canvas.getContext('2d') });
  }
  resize() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const w = Math.max(1, Math.round(this.canvas.clientWidth * ratio)), h = Math.round(this.canvas.clientHeight * ratio);
    if (this.image && this.image.width === w && this.image.height === h) return;
    this.canvas.width = w;
    this.canvas.height = h;
    this.image = this.context.createImageData(w, h);
    this.depth = new Float32Array(w * h);
    this.owner = new Int32Array(w * h);
  }
  pixelsPerMm() {
    return Math.min(this.image.width, this.image.height * 1.35) * 0.5 / this.view.radius * this.view.zoom;
  }
  draw(limit) {
    this.resize();
    const { image, depth, owner, view, map } = this, w = image.width, h = image.height, px = image.data;
    depth.fill(-Infinity);
    owner.fill(-1);
    px.fill(0);
    const { right: r, up: u, out: o } = view.axes(), [mx, my, mz] = view.middle, scale = this.pixelsPerMm();
    const ox = w / 2 + view.panX * scale, oy = h / 2 - view.panY * scale, xyz = map.xyz, nrm = map.normal;
    const half = Math.min(24, Math.max(0.6, this.spacing * scale));
    for (let i = 0; i < map.error.length; i++) {
      const x = xyz[3 * i] - mx, y = xyz[3 * i + 1] - my, z = xyz[3 * i + 2] - mz;
      const a = nrm[3 * i], b = nrm[3 * i + 1], c = nrm[3 * i + 2];
      const nr = a * r[0] + b * r[1], nu = a * u[0] + b * u[1] + c * u[2], no = a * o[0] + b * o[1] + c * o[2];
      const sx = ox + (x * r[0] + y * r[1]) * scale, sy = oy - (x * u[0] + y * u[1] + z * u[2]) * scale;
      const sd = (x * o[0] + y * o[1] + z * o[2]) * scale;
      const x0 = Math.max(0, Math.round(sx - half)), x1 = Math.min(w, Math.round(sx + half));
      const y0 = Math.max(0, Math.round(sy - half)), y1 = Math.min(h, Math.round(sy + half));
      if (x0 >= x1 || y0 >= y1) continue;
      const steep = Math.max(0.25, Math.abs(no)) * Math.sign(no || 1), tx = -nr / steep, ty = nu / steep;
      const light = no > 0 ? 0.5 + 0.5 * Math.max(0, 0.87 * no + 0.4 * nu - 0.28 * nr) : 0.4;
      const [cr, cg, cb] = COLOURS[Math.min(255, Math.max(0, Math.round(127.5 * (1 + map.error[i] / limit))))];
      for (let yy = y0; yy < y1; yy++)
        for (let xx = x0; xx < x1; xx++) {
          const at = yy * w + xx, d = sd + tx * (xx + 0.5 - sx) + ty * (yy + 0.5 - sy);
          if (d <= depth[at]) continue;
          depth[at] = d;
          owner[at] = i;
          px[4 * at] = cr * light;
          px[4 * at + 1] = cg * light;
          px[4 * at + 2] = cb * light;
          px[4 * at + 3] = 255;
        }
    }
    this.context.putImageData(image, 0, 0);
    this.triad(r, u);
  }
  triad(r, u) {
    const g = this.context, ratio = this.image.width / Math.max(1, this.canvas.clientWidth), size = 34 * ratio;
    const x0 = 46 * ratio, y0 = this.image.height - 46 * ratio;
    g.lineWidth = 1.6 * ratio;
    g.font = `${12 * ratio}px system-ui, sans-serif`;
    g.textAlign = 'center';
    g.textBaseline = 'middle';
    ['X', 'Y', 'Z'].forEach((name, k) => {
      const dx = r[k] * size, dy = -u[k] * size;
      g.strokeStyle = g.fillStyle = ['#b3382c', '#2d7d3a', '#2456a6'][k];
      g.beginPath();
      g.moveTo(x0, y0);
      g.lineTo(x0 + dx, y0 + dy);
      g.stroke();
      if (Math.hypot(dx, dy) > 8 * ratio) g.fillText(name, x0 + dx * 1.28, y0 + dy * 1.28);
    });
  }
  pointAt(event) {
    if (!this.image) return -1;
    const box = this.canvas.getBoundingClientRect();
    const x = Math.floor((event.clientX - box.left) / box.width * this.image.width);
    const y = Math.floor((event.clientY - box.top) / box.height * this.image.height);
    if (x < 0 || y < 0 || x >= this.image.width || y >= this.image.height) return -1;
    return this.owner[y * this.image.width + x];
  }
}

// Drag turns, drag with shift or the right button moves, the wheel zooms, a double click goes back.
function steer(maps, view, redraw, hover) {
  for (const map of maps) {
    const c = map.canvas;
    let drag = null;
    c.addEventListener('contextmenu', e => e.preventDefault());
    c.addEventListener('pointerdown', e => {
      drag = { x: e.clientX, y: e.clientY, move: e.shiftKey || e.button === 2 };
      c.setPointerCapture(e.pointerId);
    });
    c.addEventListener('pointerup', () => { drag = null; });
    c.addEventListener('pointermove', e => {
      if (!drag) return hover(map, map.pointAt(e));
      const dx = e.clientX - drag.x, dy = e.clientY - drag.y;
      drag.x = e.clientX;
      drag.y = e.clientY;
      if (drag.move) {
        const mm = map.image.width / c.clientWidth / map.pixelsPerMm();
        view.panX += dx * mm;
        view.panY -= dy * mm;
      } else {
        view.yaw -= dx * 0.01;
        view.elevation = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, view.elevation + dy * 0.01));
      }
      redraw();
    });
    c.addEventListener('wheel', e => {
      e.preventDefault();
      view.zoom = Math.min(60, Math.max(0.3, view.zoom * Math.exp(-e.deltaY * 0.0015)));
      redraw();
    }, { passive: false });
    c.addEventListener('dblclick', () => { view.reset(-0.5, 0.75); redraw(); });
  }
}

function drawLegend(canvas, limit) {
  const ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight, g = canvas.getContext('2d');
  canvas.width = w * ratio;
  canvas.height = h * ratio;
  g.scale(ratio, ratio);
  const left = 26, right = w - 26, strip = right - left;
  for (let x = 0; x < strip; x++) {
    g.fillStyle = `rgb(${colour(x / strip).map(Math.round).join(',')})`;
    g.fillRect(left + x, 2, 1.5, 14);
  }
  g.fillStyle = '#5c6877';
  g.font = '12px system-ui, sans-serif';
  g.textAlign = 'center';
  for (const s of [-1, -0.5, 0, 0.5, 1]) {
    const text = (s > 0 ? '+' : s < 0 ? '\u2212' : '') + +Math.abs(s * limit).toPrecision(3);
    g.fillText(text, left + (s + 1) / 2 * strip, 31);
  }
}
)js";

}  // namespace camber::report
