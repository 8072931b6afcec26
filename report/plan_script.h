#pragma once
// The script of the page of camber plan: boxes, cylinders and triangles on a canvas, sorted by depth.
#include <string_view>

namespace camber::report {

inline constexpr std::string_view kPlanScript = R"js(
'use strict';
const data = JSON.parse(document.getElementById('plan-data').textContent);
const canvas = document.getElementById('view'), slider = document.getElementById('step'), label = document.getElementById('step-name');
const plans = document.getElementById('plans'), shown = document.getElementById('shown'), pen = canvas.getContext('2d');
let turn = -0.6, tilt = 0.9, zoom = 1;
const middle = [0, 1, 2].map(a => (data.low[a] + data.high[a]) / 2);
const size = Math.hypot(...[0, 1, 2].map(a => data.high[a] - data.low[a]));
const colours = ['#1668b8', '#2c9a5b', '#d9622b', '#8a4fbf', '#c9a227', '#b83a52', '#3aa6a6', '#6b7d2f', '#7a5a43'];

function project(p) {
  const [x, y, z] = p.map((v, a) => v - middle[a]);
  const c = Math.cos(turn), s = Math.sin(turn), u = c * x - s * y, v = s * x + c * y;
  const scale = zoom * Math.min(canvas.width, canvas.height) / size;
  return [canvas.width / 2 + scale * u, canvas.height / 2 - scale * (Math.sin(tilt) * z + Math.cos(tilt) * v),
          Math.sin(tilt) * -v + Math.cos(tilt) * z];
}

function boxFaces(a, b) {
  const c = i => [i & 1 ? b[0] : a[0], i & 2 ? b[1] : a[1], i & 4 ? b[2] : a[2]];
  return [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]].map(f => f.map(c));
}

function cylinderFaces(a, b) {
  const n = 20, x = (a[0] + b[0]) / 2, y = (a[1] + b[1]) / 2, r = (b[0] - a[0]) / 2, faces = [];
  const at = (i, z) => [x + r * Math.cos(2 * Math.PI * i / n), y + r * Math.sin(2 * Math.PI * i / n), z];
  for (let i = 0; i < n; ++i) faces.push([at(i, a[2]), at(i + 1, a[2]), at(i + 1, b[2]), at(i, b[2])]);
  for (const z of [b[2], a[2]]) faces.push(Array.from({length: n}, (_, i) => at(i, z)));
  return faces;
}

function shade(colour, points) {
  const [a, b, c] = points, u = b.map((v, i) => v - a[i]), w = c.map((v, i) => v - a[i]);
  const n = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]], l = Math.hypot(...n) || 1;
  const light = 0.62 + 0.38 * Math.abs((0.3 * n[0] + 0.5 * n[1] + 0.8 * n[2]) / l);
  return '#' + [1, 3, 5].map(i => Math.round(parseInt(colour.slice(i, i + 2), 16) * light).toString(16).padStart(2, '0')).join('');
}

function draw() {
  const plan = data.plans[plans.selectedIndex], step = +slider.value, what = shown.value, faces = [];
  const add = (points, colour, alpha) => {
    const flat = points.map(project);
    faces.push({flat, colour: shade(colour, points), alpha, depth: flat.reduce((s, p) => s + p[2], 0) / flat.length});
  };
  if (what !== 'removal') for (const t of data.part) add(t.map(i => data.points[i]), '#aab4c0', 1);
  if (what === 'blank') for (const f of boxFaces(data.low, data.high)) add(f, '#c7b58a', 0.25);
  plan.primitives.forEach((p, i) => {
    if (what === 'part' || (what !== 'removal' && i < step)) return;
    if (what === 'removal' && i >= step && step > 0) return;
    const colour = i === step - 1 && what === 'removal' ? '#ff2d55' : colours[p.feature];
    for (const box of p.boxes) for (const f of (p.hole ? cylinderFaces : boxFaces)(box[0], box[1])) add(f, colour, what === 'removal' ? 0.92 : 0.55);
  });
  faces.sort((a, b) => a.depth - b.depth);
  pen.clearRect(0, 0, canvas.width, canvas.height);
  for (const f of faces) {
    pen.globalAlpha = f.alpha;
    pen.beginPath();
    f.flat.forEach((p, i) => i ? pen.lineTo(p[0], p[1]) : pen.moveTo(p[0], p[1]));
    pen.closePath();
    pen.fillStyle = pen.strokeStyle = f.colour;
    pen.fill();
    pen.stroke();
  }
  pen.globalAlpha = 1;
  const p = plan.primitives[step - 1];
  label.textContent = p ? `${step}: ${p.name}` : 'nothing is machined yet';
}

function choose() {
  slider.max = data.plans[plans.selectedIndex].primitives.length;
  slider.value = Math.min(+slider.value, +slider.max);
  draw();
}

function fit() {
  canvas.width = canvas.clientWidth * devicePixelRatio;
  canvas.height = canvas.clientHeight * devicePixelRatio;
  draw();
}

let last = null;
canvas.addEventListener('pointerdown', e => { last = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
canvas.addEventListener('pointerup', () => { last = null; });
canvas.addEventListener('pointermove', e => {
  if (!last) return;
  turn += (e.clientX - last[0]) * 0.01;
  tilt = Math.max(0.05, Math.min(1.52, tilt - (e.clientY - last[1]) * 0.01));
  last = [e.clientX, e.clientY];
  draw();
});
canvas.addEventListener('wheel', e => { e.preventDefault(); zoom *= Math.exp(-e.deltaY * 0.001); draw(); }, {passive: false});
plans.addEventListener('change', choose);
shown.addEventListener('change', draw);
slider.addEventListener('input', draw);
addEventListener('resize', fit);
plans.selectedIndex = data.best;
choose();
fit();
document.documentElement.dataset.ready = 'yes';
)js";

}  // namespace camber::report
