#include "report/page_parts.h"

namespace camber::report {

const std::string_view kPageScript = R"js(
const data = JSON.parse(document.getElementById('data').textContent);

function floats(base64) {
  const text = atob(base64), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  const view = new DataView(bytes.buffer), out = new Float32Array(bytes.length / 4);
  for (let i = 0; i < out.length; i++) out[i] = view.getFloat32(4 * i, true);
  return out;
}

function startMaps() {
  const read = data.maps.map(m => ({ xyz: m.xyz && floats(m.xyz), normal: m.normal && floats(m.normal), error: floats(m.error) }));
  const shared = read.length > 1 && !read[1].xyz;
  if (shared) Object.assign(read[1], { xyz: read[0].xyz, normal: read[0].normal });
  const view = new View(read[0].xyz);
  const maps = read.map((m, i) => new MapCanvas(document.getElementById('map' + i), m, data.maps[i].spacing, view));
  let limit = data.scales[0], asked = false;
  const redraw = () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => { asked = false; maps.forEach(m => m.draw(limit)); });
  };
  const line = document.getElementById('read'), idle = line.textContent;
  const show = v => (v > 0 ? '+' : v < 0 ? '\u2212' : '') + Math.abs(v).toFixed(2) + ' \u00b5m';
  const hover = (map, i) => {
    if (i < 0) { line.textContent = idle; return; }
    const p = [0, 1, 2].map(k => 'XYZ'[k] + ' ' + map.map.xyz[3 * i + k].toFixed(2)).join('  ');
    line.textContent = p + ' mm:  ' + (shared ? 'before ' + show(read[0].error[i]) + ', after ' + show(read[1].error[i])
                                              : show(map.map.error[i]));
  };
  steer(maps, view, redraw, hover);
  const legend = document.getElementById('legend');
  const setLimit = value => {
    limit = value;
    document.querySelectorAll('[data-scale]').forEach(b => b.setAttribute('aria-pressed', String(+b.dataset.scale === value)));
    drawLegend(legend, limit);
    redraw();
  };
  document.querySelectorAll('[data-scale]').forEach(b => b.addEventListener('click', () => setLimit(+b.dataset.scale)));
  document.querySelectorAll('[data-view]').forEach(b => b.addEventListener('click', () => {
    view.reset(...b.dataset.view.split(',').map(Number));
    redraw();
  }));
  window.addEventListener('resize', () => { drawLegend(legend, limit); redraw(); });
  setLimit(limit);
}

function startPlots() {
  const histogram = document.getElementById('histogram'), feed = document.getElementById('feed');
  const runs = (data.feed || []).map(r => ({ t: floats(r.t), command: floats(r.command), feed: floats(r.feed) }));
  const plot = feed && runs.length ? new FeedPlot(feed, runs) : null;
  const draw = () => {
    if (histogram) drawHistogram(histogram, data.histogram);
    if (plot) plot.draw();
  };
  window.addEventListener('resize', draw);
  draw();
}

if (data.maps.length) startMaps();
startPlots();
)js";

}  // namespace camber::report
