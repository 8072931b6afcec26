// The part and the path in 3-D.
import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, Group, LineBasicMaterial, LineSegments, Matrix4, Mesh, OrthographicCamera,
  Points, Raycaster, Scene, ShaderMaterial, Vector2, Vector3, Vector4, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
import { LineSegments2 } from 'three/examples/jsm/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/examples/jsm/lines/LineSegmentsGeometry.js';
import { DIVERGING, DIVERGING_GLSL, SEQUENTIAL, colourAt } from './colours.js';
import { element } from './text.js';
import { ToolBody } from './tool_body.js';

export const MODES = ['before', 'after', 'change', 'plain', 'deflection', 'contour'];

const VERTEX = `
attribute float error0;
attribute float error1;
attribute float contour;
uniform int mode;
uniform vec4 cut;
varying float value, beyond;
varying vec3 turned;
void main() {
  beyond = dot(position, cut.xyz) - cut.w;
  value = mode == 0 ? error0 : mode == 1 ? error1 : mode == 2 ? error1 - error0 : mode == 4 ? error0 - contour : contour;
  turned = normalize(normalMatrix * normal);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

// Colours are to be read off, so the light is mild.
const FRAGMENT = `
uniform int mode;
uniform float limit;
varying float value, beyond;
varying vec3 turned;
${DIVERGING_GLSL}
void main() {
  if (beyond > 0.0) discard;
  vec3 n = normalize(turned);
  vec3 base = mode == 3 ? vec3(0.80, 0.83, 0.87) : diverging(0.5 + 0.5 * value / limit);
  float light = 0.70 + 0.30 * max(0.0, dot(n, normalize(vec3(0.35, 0.55, 0.75))));
  if (n.z < 0.0) { base = vec3(0.62, 0.66, 0.71); light = 0.85; }
  gl_FragColor = vec4(base * light, 1.0);
}`;

// The stock around is coarse: it lies a cell farther away than it is, so that it hides nothing of the surface.
const STOCK_VERTEX = `
uniform float back;
uniform vec4 cut;
varying vec3 eye;
varying float beyond;
void main() {
  beyond = dot(position, cut.xyz) - cut.w;
  vec4 at = modelViewMatrix * vec4(position, 1.0);
  eye = at.xyz;
  at.z -= back;
  gl_Position = projectionMatrix * at;
}`;

// Flat, and darker than white, which is an error of nothing.
const STOCK_FRAGMENT = `
varying vec3 eye;
varying float beyond;
void main() {
  if (beyond > 0.0) discard;
  vec3 n = normalize(cross(dFdx(eye), dFdy(eye)));
  float light = 0.72 + 0.28 * max(0.0, dot(n.z < 0.0 ? -n : n, normalize(vec3(0.35, 0.55, 0.75))));
  gl_FragColor = vec4(vec3(0.66, 0.69, 0.73) * light, 1.0);
}`;

// Measured points: discs in the colours of the map, ringed, and a little before the surface.
const POINT_VERTEX = `
attribute float error;
uniform float size;
uniform vec4 cut;
varying float value, beyond;
void main() {
  value = error;
  beyond = dot(position, cut.xyz) - cut.w;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_Position.z -= 0.001 * gl_Position.w;
  gl_PointSize = size;
}`;
const POINT_FRAGMENT = `
uniform float limit;
varying float value, beyond;
${DIVERGING_GLSL}
void main() {
  float r = length(2.0 * gl_PointCoord - 1.0);
  if (r > 1.0 || beyond > 0.0) discard;
  gl_FragColor = vec4(r > 0.7 ? vec3(0.1) : diverging(0.5 + 0.5 * value / limit), 1.0);
}`;

const VIEWS = { oblique: [-0.6, -1, 1.25], top: [0, -1e-4, 1], front: [0, -1, 0], right: [1, 0, 0] };
const CLICK_PX = 4, PATH_PX = 6, POINT_PX = 11;
// Up to this many times the size of what is judged, the stock decides how large the picture is.
const WHOLE_STOCK = 2.5;

function bounds(arrays) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const a of arrays)
    for (let i = 0; i < a.length; i++) {
      low[i % 3] = Math.min(low[i % 3], a[i]);
      high[i % 3] = Math.max(high[i % 3], a[i]);
    }
  return { middle: low.map((v, k) => (v + high[k]) / 2), radius: Math.hypot(...low.map((v, k) => (high[k] - v) / 2)) || 1 };
}

export class PartScene {
  // `hover` and `click` get {vertex} or {row} or null.
  constructor(box, page, { hover, click, drawn }) {
    Object.assign(this, { box, page, drawn });
    this.renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.scene = new Scene();
    this.scene.background = new Color('#f3f5f8').convertLinearToSRGB();
    this.renderer.outputColorSpace = 'srgb-linear';  // colours are given as they are shown
    this.run = 0;
    this.cut = { value: new Vector4(0, 0, 0, 0) };  // what lies beyond the plane is not drawn: x, y, z of its normal, and how far along it
    this.camera = new OrthographicCamera();
    this.camera.up.set(0, 0, 1);
    // What is fixed to the part, and turns with it.
    this.part = new Group();
    this.part.matrixAutoUpdate = false;
    this.scene.add(this.part);
    const { surface, stock, runs } = page;
    const cutting = runs.map(r => r.place.filter((_, i) => r.cutting[Math.floor(i / 3)] > 0.5));
    this.shown = surface ? [surface.place] : cutting.some(c => c.length) ? cutting : runs.map(r => r.place);
    Object.assign(this, bounds(this.shown), { deep: bounds(this.shown).radius });
    if (surface) this.part.add(this.surface = this.meshOf(surface));
    if (page.measured) this.addMeasured(page.measured);
    if (stock) this.addStock(stock);
    if (page.machine) this.part.add((this.tool = new ToolBody(page.machine.tools)).body);
    this.renderer.domElement.tabIndex = 0;
    this.renderer.domElement.setAttribute('aria-label', 'The part in three dimensions');
    box.append(this.renderer.domElement);
    this.triad = box.appendChild(element('div', { className: 'triad' }));
    this.bar = box.appendChild(element('div', { className: 'scalebar' }));
    this.marker = box.appendChild(element('div', { className: 'marker', hidden: true }));
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.zoomToCursor = true;
    this.controls.addEventListener('change', () => this.render());
    this.listen(hover, click);
    this.look('oblique');
    new ResizeObserver(() => this.resize()).observe(box);
    this.resize();
  }

  meshOf(surface) {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(surface.place, 3));
    geometry.setAttribute('normal', new BufferAttribute(surface.normal, 3));
    geometry.setAttribute('error0', new BufferAttribute(surface.error[0], 1));
    geometry.setAttribute('error1', new BufferAttribute(surface.error[1] || surface.error[0], 1));
    geometry.setAttribute('contour', new BufferAttribute(surface.contour || surface.error[0], 1));
    geometry.setIndex(new BufferAttribute(surface.triangles, 1));
    return new Mesh(geometry, new ShaderMaterial({
      vertexShader: VERTEX, fragmentShader: FRAGMENT, side: DoubleSide,
      uniforms: { mode: { value: 0 }, limit: { value: this.page.scales[0] }, cut: this.cut },
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2,  // the path lies on it
    }));
  }

  addMeasured({ place, error }) {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(place, 3));
    geometry.setAttribute('error', new BufferAttribute(error, 1));
    this.measured = new Points(geometry, new ShaderMaterial({
      vertexShader: POINT_VERTEX, fragmentShader: POINT_FRAGMENT,
      uniforms: { limit: { value: this.page.scales[0] }, size: { value: POINT_PX * this.renderer.getPixelRatio() }, cut: this.cut },
    }));
    this.part.add(this.measured);
  }

  showMeasured(shown) {
    this.measured.visible = shown;
    this.render();
  }

  addStock(stock) {
    const geometry = new BufferGeometry(), whole = bounds([...this.shown, stock.place]);
    geometry.setAttribute('position', new BufferAttribute(stock.place, 3));
    geometry.setIndex(new BufferAttribute(stock.triangles, 1));
    this.stock = new Mesh(geometry, new ShaderMaterial({
      vertexShader: STOCK_VERTEX, fragmentShader: STOCK_FRAGMENT, side: DoubleSide, uniforms: { back: { value: stock.cell }, cut: this.cut },
    }));
    this.part.add(this.stock);
    this.deep = Math.hypot(...whole.middle.map((v, k) => v - this.middle[k])) + whole.radius;
    if (whole.radius > WHOLE_STOCK * this.radius) return;
    this.shown = [...this.shown, stock.place];
    Object.assign(this, whole);
  }

  showStock(shown) {
    this.stock.visible = shown;
    this.render();
  }

  listen(hover, click) {
    const canvas = this.renderer.domElement;
    let down = null, asked = null;
    canvas.addEventListener('pointerdown', e => { down = [e.clientX, e.clientY]; });
    canvas.addEventListener('pointerup', e => {
      if (down && Math.hypot(e.clientX - down[0], e.clientY - down[1]) < CLICK_PX) click(this.at(e));
      down = null;
    });
    canvas.addEventListener('pointermove', e => {
      if (down) return;
      if (!asked) requestAnimationFrame(() => { hover(this.at(asked), asked); asked = null; });
      asked = e;
    });
    canvas.addEventListener('pointerleave', () => hover(null));
    canvas.addEventListener('dblclick', () => this.look('oblique'));
  }

  look(name) {
    const [x, y, z] = name === 'oblique' && this.page.view || VIEWS[name], length = Math.hypot(x, y, z), far = 20 * this.deep;
    this.controls.target.set(...this.middle);
    this.camera.position.set(...this.middle.map((v, k) => v + [x, y, z][k] / length * far / 2));
    Object.assign(this.camera, { near: 0, far, zoom: 1 });
    this.resize();
    this.controls.update();
    this.fit();
  }

  // As large as the box allows.
  fit() {
    this.camera.updateMatrixWorld();
    let most = 0;
    for (const places of this.shown)
      for (let i = 0; i < places.length; i += 3) {
        const p = this.projected(places, i);
        most = Math.max(most, Math.abs(p.x), Math.abs(p.y));
      }
    this.fitted = this.camera.zoom = 0.88 / (most || 1);
    this.camera.updateProjectionMatrix();
    this.render();
  }

  resize() {
    const w = Math.max(1, this.box.clientWidth), h = Math.max(1, this.box.clientHeight), r = this.radius;
    if (matchMedia('print').matches) return;  // paper shows the picture of the window, smaller
    this.renderer.setSize(w, h);
    this.box.style.setProperty('--ratio', w / h);
    Object.assign(this.camera, { left: -r * w / h, right: r * w / h, top: r, bottom: -r });
    this.camera.updateProjectionMatrix();
    if (this.path) this.path.material.resolution = new Vector2(w, h);
    this.render();
  }

  mmPerPixel() { return 2 * this.radius / this.camera.zoom / this.box.clientHeight; }

  projected(places, i) {
    return new Vector3(places[i], places[i + 1], places[i + 2]).applyMatrix4(this.part.matrix).project(this.camera);
  }

  // Turns the part about the middle of the picture.
  turn(rotation) {
    const [x, y, z] = this.middle;
    this.part.matrix.makeTranslation(x, y, z).multiply(rotation).multiply(new Matrix4().makeTranslation(-x, -y, -z));
    this.part.matrixWorldNeedsUpdate = true;
    // Who has zoomed keeps that.
    this.camera.zoom === this.fitted ? this.fit() : this.render();
  }

  // The tool in the part's frame; null: none.
  showTool(pose) {
    this.tool.show(pose);
    this.render();
  }

  setSurface(mode, limit) {
    if (!this.surface) return;
    const { uniforms } = this.surface.material;
    uniforms.mode.value = MODES.indexOf(mode);
    uniforms.limit.value = limit;
    if (this.measured) this.measured.material.uniforms.limit.value = limit;
    this.render();
  }

  // axis: 0, 1, 2 or null for none; share: of the surface's extent along it that stays. Returns the place of the cut, mm.
  setCut(axis, share) {
    if (axis === null) this.cut.value.set(0, 0, 0, 0);
    else {
      let low = Infinity, high = -Infinity;
      const { place } = this.page.surface;
      for (let i = axis; i < place.length; i += 3) { low = Math.min(low, place[i]); high = Math.max(high, place[i]); }
      this.cut.value.set(Number(axis === 0), Number(axis === 1), Number(axis === 2), low + share * (high - low));
    }
    this.render();
    return this.cut.value.w;
  }

  isCutAway(x, y, z) {
    const c = this.cut.value;
    return c.x * x + c.y * y + c.z * z - c.w > 0;
  }

  // quantity: null hides the path; range: [low, high] of the colours.
  setPath(run, quantity, range, diverging) {
    for (const old of [this.path, this.rapids]) if (old) { this.part.remove(old); old.geometry.dispose(); }
    this.path = this.rapids = null;
    this.run = run;
    if (!quantity) return this.render();
    const { place, cutting, [quantity]: values } = this.page.runs[run], stops = diverging ? DIVERGING : SEQUENTIAL;
    const lines = [], colours = [], rapids = [], colour = i =>
      Number.isFinite(values[i]) ? colourAt(stops, (values[i] - range[0]) / (range[1] - range[0])).map(v => v / 255) : [0.55, 0.58, 0.62];
    for (let i = 0; i + 1 < values.length; i++) {
      const ends = place.subarray(3 * i, 3 * i + 6);
      if (cutting[i] < 0.5 || cutting[i + 1] < 0.5) rapids.push(...ends);
      else { lines.push(...ends); colours.push(...colour(i), ...colour(i + 1)); }
    }
    this.path = new LineSegments2(new LineSegmentsGeometry().setPositions(lines).setColors(colours),
      new LineMaterial({ vertexColors: true, linewidth: 2.2 }));
    this.path.material.resolution = new Vector2(this.box.clientWidth, this.box.clientHeight);
    this.path.frustumCulled = false;
    const thin = new BufferGeometry();
    thin.setAttribute('position', new BufferAttribute(new Float32Array(rapids), 3));
    this.rapids = new LineSegments(thin, new LineBasicMaterial({ color: new Color('#aab4c0').convertLinearToSRGB(), transparent: true, opacity: 0.5 }));
    this.part.add(this.path, this.rapids);
    this.render();
  }

  // What lies under the pointer: a row of the path where it is shown and near, else a point of the surface.
  at(event) {
    const area = this.renderer.domElement.getBoundingClientRect();
    const x = event.clientX - area.left, y = event.clientY - area.top;
    if (this.path) {
      const row = this.nearestRow(x, y, area);
      if (row >= 0) return { row };
    }
    const point = this.measured?.visible ? this.nearestPoint(x, y, area) : -1;
    if (point >= 0) return { point, vertex: this.vertexBeside(this.page.measured.place, 3 * point) };
    const vertex = this.page.surface ? this.nearestVertex(x / area.width * 2 - 1, 1 - y / area.height * 2) : -1;
    return vertex >= 0 ? { vertex } : null;
  }

  nearestRow(x, y, area) {
    const { place, cutting } = this.page.runs[this.run];
    let best = -1, least = PATH_PX ** 2;
    for (let i = 0; i < cutting.length; i++) {
      if (cutting[i] < 0.5) continue;
      const p = this.projected(place, 3 * i);
      const d = ((p.x + 1) / 2 * area.width - x) ** 2 + ((1 - p.y) / 2 * area.height - y) ** 2;
      if (d < least) { least = d; best = i; }
    }
    return best;
  }

  // Of the measured points under the pointer the one nearest to the eye.
  nearestPoint(x, y, area) {
    const { place } = this.page.measured;
    let best = -1, least = Infinity;
    for (let i = 0; i < place.length; i += 3) {
      const p = this.projected(place, i);
      if (this.isCutAway(place[i], place[i + 1], place[i + 2]) || p.z >= least) continue;
      if (Math.hypot((p.x + 1) / 2 * area.width - x, (1 - p.y) / 2 * area.height - y) < POINT_PX / 2 + 1) { least = p.z; best = i / 3; }
    }
    return best;
  }

  // The vertex of the surface beside a place.
  vertexBeside(places, at) {
    const { place } = this.page.surface;
    let best = 0, least = Infinity;
    for (let i = 0; i < place.length; i += 3) {
      const d = (place[i] - places[at]) ** 2 + (place[i + 1] - places[at + 1]) ** 2 + (place[i + 2] - places[at + 2]) ** 2;
      if (d < least) { least = d; best = i / 3; }
    }
    return best;
  }

  // How far from the plane of the screen the stock is hit, or Infinity.
  stockDepth(x, y) {
    if (!this.stock?.visible || this.cut.value.lengthSq() > 0) return Infinity;
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2(x, y), this.camera);
    this.part.updateMatrixWorld();
    const hit = ray.intersectObject(this.stock)[0];
    return hit ? hit.distance : Infinity;
  }

  // The vertex nearest to the eye of those within a cell or a few pixels of the ray; none behind the stock.
  nearestVertex(x, y) {
    const { place, cell } = this.page.surface, back = this.part.matrix.clone().invert();
    const from = new Vector3(x, y, -1).unproject(this.camera).applyMatrix4(back);
    const along = this.camera.getWorldDirection(new Vector3()).transformDirection(back), reach = Math.max(cell, 3 * this.mmPerPixel()) ** 2;
    let best = -1, least = Infinity;
    for (let i = 0; i < place.length; i += 3) {
      if (this.isCutAway(place[i], place[i + 1], place[i + 2])) continue;
      const dx = place[i] - from.x, dy = place[i + 1] - from.y, dz = place[i + 2] - from.z;
      const depth = dx * along.x + dy * along.y + dz * along.z, off = dx * dx + dy * dy + dz * dz - depth * depth;
      if (off < reach && depth + 2 * Math.sqrt(off) < least) { least = depth + 2 * Math.sqrt(off); best = i / 3; }
    }
    return best >= 0 && least > this.stockDepth(x, y) + 2 * (this.page.stock?.cell || 0) ? -1 : best;
  }

  mark(place) {
    this.marked = place;
    this.render();
  }

  render() {
    if (!this.controls) return;
    this.renderer.render(this.scene, this.camera);
    this.placeMarker();
    this.drawTriad();
    this.drawBar();
    this.drawn?.();
  }

  placeMarker() {
    this.marker.hidden = !this.marked;
    if (!this.marked) return;
    const p = this.projected(this.marked, 0);
    this.marker.style.left = `${(p.x + 1) * 50}%`;
    this.marker.style.top = `${(1 - p.y) * 50}%`;
  }

  drawTriad() {
    const turn = this.camera.matrixWorldInverse.clone().multiply(this.part.matrix), size = 26;
    this.triad.innerHTML = '<svg width="84" height="84" viewBox="-42 -42 84 84">' +
      [['X', '#b3382c', 0], ['Y', '#2d7d3a', 4], ['Z', '#2456a6', 8]].map(([name, colour, at]) => {
        const x = turn.elements[at] * size, y = -turn.elements[at + 1] * size, far = Math.hypot(x, y) > 5;
        return `<path d="M0 0L${x.toFixed(1)} ${y.toFixed(1)}" stroke="${colour}" stroke-width="2"/>` +
          (far ? `<text x="${(x * 1.4).toFixed(1)}" y="${(y * 1.4 + 4).toFixed(1)}" fill="${colour}">${name}</text>` : '');
      }).join('') + '</svg>';
  }

  drawBar() {
    const mm = this.mmPerPixel(), raw = 110 * mm, decade = 10 ** Math.floor(Math.log10(raw));
    const length = decade * [5, 2, 1].find(s => s * decade <= raw);
    this.bar.style.width = `${100 * length / mm / this.box.clientWidth}%`;
    this.bar.textContent = `${+length.toPrecision(3)} mm`;
  }
}
