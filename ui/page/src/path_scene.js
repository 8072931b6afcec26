// The path in three dimensions: one buffer of points, one of pairs; colours say kind, tool, feed or message.
import {
  BufferAttribute, BufferGeometry, Color, DoubleSide, EdgesGeometry, GLSL3, LineBasicMaterial, LineSegments, Mesh, MeshLambertMaterial, OrthographicCamera,
  Plane, RawShaderMaterial, Raycaster, Scene, Vector2, Vector3, WebGLRenderer, AmbientLight, DirectionalLight, Group,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { SEQUENTIAL, colourAt } from '../../../report/web/src/colours.js';
import { RAPID } from './path_data.js';

// Each way has the colour of the point that it leads to.
const VERTEX = `
in vec3 position;
in vec3 colour;
uniform mat4 modelViewMatrix, projectionMatrix;
flat out vec3 shown;
void main() {
  shown = colour;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;
const FRAGMENT = `
precision mediump float;
flat in vec3 shown;
out vec4 pixel;
void main() { pixel = vec4(shown, 1.0); }`;

const VIEWS = { oblique: [-0.6, -1, 1.1], top: [0, -1e-4, 1], front: [0, -1, 0], right: [1, 0, 0] };
export const VIEW_NAMES = Object.keys(VIEWS);
// Ways drawn while the picture turns, at most and at least; the rest follows when it rests. Frames that are longer apart
// are too slow: the next one draws half as many.
const MOVING = 120000, FEWEST = 10000, SLOW_MS = 40, REST_MS = 160, REACH_PX = 8, CLICK_PX = 4;
const EDGES = 60000;  // triangles whose edges are looked for
const PLACE_mm = 0.01;  // a part that is dragged stands at whole multiples of it
export const TOOL_COLOURS = [[31, 119, 180], [214, 110, 20], [44, 140, 60], [190, 50, 60], [130, 95, 180], [130, 85, 70], [210, 110, 180], [110, 115, 30], [20, 160, 175]];
const CUT = [40, 118, 190], FAST = [217, 98, 43], QUIET = [140, 150, 162], WARNED = [217, 144, 43], WRONG = [200, 45, 40];

function pairs(path, keep, every) {
  const out = new Uint32Array(2 * (Math.floor((path.count - 1) / every) + 1));
  let n = 0;
  for (let i = every; i < path.count; i += every) {
    if (path.kind[i] === 0 || !keep(i)) continue;
    out[n++] = i - every;
    out[n++] = i;
  }
  return out.subarray(0, n);
}

export class PathScene {
  constructor(box, { picked, label }) {
    Object.assign(this, { box, picked, path: null, hidden: new Set() });
    this.renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.renderer.outputColorSpace = 'srgb-linear';
    this.scene = new Scene();
    this.things = new Group();
    this.scene.add(this.things, new AmbientLight(0xffffff, 1.6));
    const light = new DirectionalLight(0xffffff, 1.8);
    light.position.set(0.4, -0.6, 1);
    this.scene.add(light);
    this.camera = new OrthographicCamera();
    this.camera.up.set(0, 0, 1);
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute('aria-label', label);
    box.append(canvas);
    this.marker = box.appendChild(document.createElement('div'));
    this.marker.className = 'marker';
    this.marker.hidden = true;
    this.tip = box.appendChild(document.createElement('div'));
    this.tip.className = 'tip';
    this.tip.hidden = true;
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.zoomToCursor = true;
    this.controls.addEventListener('change', () => this.moving());
    this.listen(canvas);
    new ResizeObserver(() => this.resize()).observe(box);
    this.view = 'oblique';
    this.extents = {};
    this.fit();
  }

  setBackground(colour) {
    this.scene.background = new Color(colour).convertLinearToSRGB();
    this.render();
  }

  // Nothing is left of the program that was shown.
  clear() {
    if (this.lines) { this.things.remove(this.lines, this.coarse); this.lines.geometry.dispose(); this.coarse.geometry.dispose(); }
    this.lines = this.coarse = this.path = this.extents.path = null;
    this.tip.hidden = true;
    this.mark(null);
    this.setBox(null);
    this.setPart(null);
    this.setBlank(null);
  }

  // same: the path of the program that is shown; the eye stays where it is.
  setPath(path, same) {
    if (this.lines) { this.things.remove(this.lines, this.coarse); this.lines.geometry.dispose(); this.coarse.geometry.dispose(); }
    this.path = path;
    this.mark(null);
    const place = this.place = new Float32Array(3 * path.count);
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity], cuts = i => path.kind[i] !== 0 && path.kind[i] !== RAPID;
    for (let i = 0; i < path.count; i++)
      [path.x[i], path.y[i], path.z[i]].forEach((v, k) => {
        place[3 * i + k] = v + path.origin[k];
        if (!cuts(i) && !cuts(i + 1)) return;  // neither end of a cut
        low[k] = Math.min(low[k], v + path.origin[k]);
        high[k] = Math.max(high[k], v + path.origin[k]);
      });
    this.positions = new BufferAttribute(place, 3);
    this.colours = new BufferAttribute(new Uint8Array(3 * path.count), 3, true);
    const material = new RawShaderMaterial({ vertexShader: VERTEX, fragmentShader: FRAGMENT, glslVersion: GLSL3 });
    const lines = every => {
      const geometry = new BufferGeometry();
      geometry.setAttribute('position', this.positions);
      geometry.setAttribute('colour', this.colours);
      geometry.setIndex(this.ways(every));
      const out = new LineSegments(geometry, material);
      out.frustumCulled = false;
      return out;
    };
    this.lines = lines(1);
    this.every = Math.ceil(path.count / MOVING);
    this.coarse = this.every > 1 ? lines(this.every) : this.lines;
    this.things.add(this.lines);
    if (this.coarse !== this.lines) this.things.add(this.coarse);
    this.coarse.visible = this.coarse === this.lines;
    this.extents.path = { low, high };
    if (same) this.render();
    else this.fit();
  }

  // Path, blank and part in the picture.
  fit() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const e of Object.values(this.extents))
      if (e && Number.isFinite(e.low[0])) for (let k = 0; k < 3; k++) { low[k] = Math.min(low[k], e.low[k]); high[k] = Math.max(high[k], e.high[k]); }
    this.middle = low.map((v, k) => Number.isFinite(v) ? (v + high[k]) / 2 : 0);
    this.radius = Math.hypot(...low.map((v, k) => (high[k] - v) / 2)) || 1;
    if (!Number.isFinite(this.radius)) this.radius = 1;
    this.look(this.view);
  }

  ofTool(i) { return this.tool === undefined || this.tool === '' || this.path.tool[i] === Number(this.tool); }

  // What is drawn of the path when only every n-th place counts.
  ways(every) { return new BufferAttribute(pairs(this.path, i => !this.hidden.has(this.path.kind[i]) && this.ofTool(i), every), 1); }

  // Which kinds and tools are drawn.
  show({ rapids, tool }) {
    this.hidden = new Set(rapids ? [] : [RAPID]);
    this.tool = tool;
    if (!this.path) return;
    this.lines.geometry.setIndex(this.ways(1));
    if (this.coarse !== this.lines) this.coarse.geometry.setIndex(this.ways(this.every));
    this.render();
  }

  // by: kind, tool, feed, message; severities: of lines. Returns the greatest feed.
  colour(by, severities) {
    if (!this.path) return 0;
    const { path, colours } = this, { kind, tool, line } = path, feed = path.feed_mm_per_min, out = colours.array;
    let most = 0;
    if (by === 'feed') for (let i = 0; i < path.count; i++) if (feed[i] > most) most = feed[i];
    const stops = Array.from({ length: 65 }, (_, k) => colourAt(SEQUENTIAL, k / 64));
    for (let i = 0, k = 0; i < path.count; i++, k += 3) {
      let c = kind[i] === RAPID ? (by === 'kind' ? FAST : QUIET) : CUT;
      if (by === 'tool' && kind[i] !== RAPID) c = TOOL_COLOURS[tool[i] % TOOL_COLOURS.length];
      else if (by === 'feed' && kind[i] !== RAPID) c = stops[Math.round(64 * Math.min(1, feed[i] / (most || 1))) || 0];
      else if (by === 'message') {
        const severity = severities.get(line[i]);
        c = severity === 'error' ? WRONG : severity ? WARNED : QUIET;
      }
      out[k] = c[0]; out[k + 1] = c[1]; out[k + 2] = c[2];
    }
    colours.needsUpdate = true;
    this.render();
    return most;
  }

  // [[x, y, z], [x, y, z]] or null.
  setBox(corners) {
    if (JSON.stringify(corners) === JSON.stringify(this.corners)) return;
    this.corners = corners;
    if (this.boxLines) this.things.remove(this.boxLines);
    this.boxLines = this.extents.box = null;
    if (corners) {
      const [a, b] = corners, at = [];
      for (let axis = 0; axis < 3; axis++)
        for (let c = 0; c < 4; c++) {
          const ends = [a, b].map(end => [0, 1, 2].map(k => k === axis ? end[k] : (c >> (k > axis ? k - 1 : k) & 1 ? b[k] : a[k])));
          at.push(...ends[0], ...ends[1]);
        }
      const geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(new Float32Array(at), 3));
      this.boxLines = new LineSegments(geometry, new LineBasicMaterial({ color: new Color('#7a8794').convertLinearToSRGB() }));
      this.things.add(this.boxLines);
      this.extents.box = { low: a.map((v, k) => Math.min(v, b[k])), high: a.map((v, k) => Math.max(v, b[k])) };
    }
    this.fit();
  }

  // Geometries or null. A part that is shown with the move `at` is moved from there by movePart().
  setPart(geometry, at = [0, 0, 0]) {
    this.part = this.solid('part', this.part, geometry, { color: new Color('#b9c3cf').convertLinearToSRGB(), polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2 });
    this.partAt = at;
    this.fit();
  }
  setBlank(geometry) {
    this.blank = this.solid('blank', this.blank, geometry, { color: new Color('#8b94a0').convertLinearToSRGB(), transparent: true, opacity: 0.28, depthWrite: false });
    this.fit();
  }
  solid(name, old, geometry, material) {
    if (old) { this.things.remove(old); old.geometry.dispose(); }
    this.extents[name] = null;
    if (!geometry) return null;
    geometry.computeVertexNormals();
    geometry.computeBoundingBox();
    this.extents[name] = { low: geometry.boundingBox.min.toArray(), high: geometry.boundingBox.max.toArray() };
    const out = new Mesh(geometry, new MeshLambertMaterial({ side: DoubleSide, ...material }));
    if (geometry.attributes.position.count < 3 * EDGES)
      out.add(new LineSegments(new EdgesGeometry(geometry, 25), new LineBasicMaterial({ color: new Color('#6d7886').convertLinearToSRGB() })));
    this.things.add(out);
    return out;
  }

  movePart(to) {
    if (!this.part) return;
    this.part.position.set(...to.map((v, k) => v - this.partAt[k]));
    const { min, max } = this.part.geometry.boundingBox;
    this.extents.part = { low: min.clone().add(this.part.position).toArray(), high: max.clone().add(this.part.position).toArray() };
    this.render();
  }
  placeOfPart() { return this.part.position.toArray().map((v, k) => v + this.partAt[k]); }

  showSolids(shown) {
    this.shown = shown;
    for (const [name, things] of [['part', [this.part]], ['blank', [this.blank, this.boxLines]]]) for (const t of things) if (t) t.visible = shown[name];
    this.render();
  }

  // While the part is moved: the pointer drags it across the axis that points most to the eye; arrow keys and Page Up and
  // Down step along the axes that point to the right, upwards and to the eye. moved(place, done) says where it stands.
  setMoving(moved) { this.moved = moved; }
  axisAlong(direction) {
    const v = direction.toArray(), axis = [0, 1, 2].reduce((a, b) => Math.abs(v[b]) > Math.abs(v[a]) ? b : a, 0);
    return { axis, sign: Math.sign(v[axis]) };
  }
  ray(e) {
    const out = new Raycaster();
    out.setFromCamera(new Vector2(2 * e.offsetX / this.box.clientWidth - 1, 1 - 2 * e.offsetY / this.box.clientHeight), this.camera);
    return out;
  }
  grab(e) {
    if (!this.moved || !this.part?.visible || e.button !== 0) return null;
    this.part.updateMatrixWorld();
    const hit = this.ray(e).intersectObject(this.part, false)[0];
    if (!hit) return null;
    const { axis } = this.axisAlong(this.camera.getWorldDirection(new Vector3())), normal = new Vector3().setComponent(axis, 1);
    return { from: hit.point, place: this.placeOfPart(), plane: new Plane(normal, -hit.point.getComponent(axis)) };
  }
  drag(e, { from, place, plane }, done) {
    const to = this.ray(e).ray.intersectPlane(plane, new Vector3());
    if (!to) return;
    const now = place.map((v, k) => Math.round((v + to.getComponent(k) - from.getComponent(k)) / PLACE_mm) * PLACE_mm);
    this.movePart(now);
    this.moved(now, done);
  }
  step(key, mm) {
    const along = { ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowUp: [1, 1], ArrowDown: [1, -1], PageUp: [2, 1], PageDown: [2, -1] }[key];
    if (!along || !this.moved || !this.part) return false;
    const x = new Vector3(), y = new Vector3(), z = new Vector3(), place = this.placeOfPart();
    this.camera.matrixWorld.extractBasis(x, y, z);
    const eye = this.axisAlong(z), right = this.axisAlong(x), used = [eye.axis, right.axis], up = 3 - eye.axis - right.axis;
    const { axis, sign } = along[0] === 2 ? eye : along[0] === 0 ? right : { axis: up, sign: Math.sign(y.getComponent(up)) || 1 };
    if (used[0] === used[1]) return false;
    place[axis] += sign * along[1] * mm;
    this.movePart(place);
    this.moved(place, true);
    return true;
  }

  look(name = 'oblique') {
    this.view = name;
    const direction = VIEWS[name], size = Math.hypot(...direction), far = 40 * this.radius;
    this.controls.target.set(...this.middle);
    this.camera.position.set(...this.middle.map((v, k) => v + direction[k] / size * far / 2));
    Object.assign(this.camera, { near: 0, far, zoom: 0.92 });
    this.resize();
    this.controls.update();
    this.rest();
  }

  resize() {
    const w = Math.max(1, this.box.clientWidth), height = Math.max(1, this.box.clientHeight), r = this.radius;
    this.renderer.setSize(w, height);
    const k = Math.max(1, height / w);
    Object.assign(this.camera, { left: -r * k * w / height, right: r * k * w / height, top: r * k, bottom: -r * k });
    this.camera.updateProjectionMatrix();
    this.render();
  }

  moving() {
    if (this.path && this.coarse !== this.lines) {
      this.lines.visible = false;
      this.coarse.visible = true;
      clearTimeout(this.resting);
    }
    this.render();
  }
  // A frame has been drawn that is not the last one of a motion.
  moved() {
    const now = performance.now(), gap_ms = now - this.drawn;
    this.drawn = now;
    if (gap_ms > SLOW_MS && this.path.count / this.every > 2 * FEWEST) this.coarse.geometry.setIndex(this.ways(this.every *= 2));
    clearTimeout(this.resting);
    this.resting = setTimeout(() => this.rest(), REST_MS);
  }
  rest() {
    this.drawn = NaN;
    if (this.path && this.coarse !== this.lines) { this.lines.visible = true; this.coarse.visible = false; }
    this.render();
  }

  listen(canvas) {
    let down = null, asked = null, held = null;
    // Before the controls hear of it.
    this.box.addEventListener('pointerdown', e => { if (e.target === canvas && (held = this.grab(e))) { this.controls.enabled = false; canvas.setPointerCapture(e.pointerId); } }, true);
    canvas.addEventListener('keydown', e => { if (this.step(e.key, e.shiftKey ? 10 : e.altKey ? 0.1 : 1)) { e.preventDefault(); e.stopPropagation(); } });
    canvas.addEventListener('pointerdown', e => { down = [e.clientX, e.clientY]; this.tip.hidden = true; });
    canvas.addEventListener('pointerup', e => {
      if (held) {
        this.drag(e, held, true);
        held = down = null;
        this.controls.enabled = true;
        return;
      }
      if (down && Math.hypot(e.clientX - down[0], e.clientY - down[1]) < CLICK_PX) {
        const i = this.nearest(e.offsetX, e.offsetY);
        if (i >= 0) { this.mark(i); this.picked(i); }
      }
      down = null;
    });
    canvas.addEventListener('pointermove', e => {
      if (held) return this.drag(e, held, false);
      if (down || !this.path || this.path.count > 3e5) return;
      if (!asked) requestAnimationFrame(() => { this.hover(asked); asked = null; });
      asked = { x: e.offsetX, y: e.offsetY };
    });
    canvas.addEventListener('pointerleave', () => { this.tip.hidden = true; });
    canvas.addEventListener('dblclick', () => this.fit());
  }

  hover({ x, y }) {
    const i = this.nearest(x, y);
    this.tip.hidden = i < 0;
    if (i < 0) return;
    this.tip.textContent = this.describe(i);
    this.tip.style.left = Math.max(4, Math.min(x + 14, this.box.clientWidth - 300)) + 'px';
    this.tip.style.top = Math.max(4, y - 34) + 'px';
  }

  // Index of the point whose way passes nearest to a place on the screen, or -1.
  nearest(px, py) {
    const { path, place } = this;
    if (!path) return -1;
    this.camera.updateMatrixWorld();
    const m = this.camera.projectionMatrix.clone().multiply(this.camera.matrixWorldInverse).elements;
    const w = this.box.clientWidth / 2, height = this.box.clientHeight / 2;
    let best = -1, least = REACH_PX ** 2, ax = 0, ay = 0;
    for (let i = 0, k = 0; i < path.count; i++, k += 3) {
      const x = place[k], y = place[k + 1], z = place[k + 2];
      const bx = w * (1 + m[0] * x + m[4] * y + m[8] * z + m[12]) - px, by = height * (1 - (m[1] * x + m[5] * y + m[9] * z + m[13])) - py;
      if (path.kind[i] !== 0 && !this.hidden.has(path.kind[i]) && this.ofTool(i)) {
        const dx = bx - ax, dy = by - ay, l = dx * dx + dy * dy, t = l > 0 ? Math.min(1, Math.max(0, -(ax * dx + ay * dy) / l)) : 1;
        const d = (ax + t * dx) ** 2 + (ay + t * dy) ** 2;
        if (d < least) { least = d; best = i; }
      }
      ax = bx; ay = by;
    }
    return best;
  }

  mark(i) {
    this.marked = i;
    this.render();
  }
  // The end of the first way of a line; false: the line moves nothing.
  markLine(line) {
    const { path } = this;
    if (!path) return false;
    let i = -1;
    for (let k = 0; k < path.count; k++) if (path.line[k] === line && path.kind[k] !== 0) { i = k; if (path.kind[k + 1] === 0 || path.line[k + 1] !== line) break; }
    this.mark(i >= 0 ? i : null);
    return i >= 0;
  }

  render() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.renderer.render(this.scene, this.camera);
      this.frames = (this.frames || 0) + 1;
      if (this.path && this.coarse !== this.lines && this.coarse.visible) this.moved();
      this.marker.hidden = this.marked === null || this.marked === undefined;
      if (this.marker.hidden) return;
      const p = new Vector3(...this.place.subarray(3 * this.marked, 3 * this.marked + 3)).project(this.camera);
      this.marker.style.left = `${(p.x + 1) * 50}%`;
      this.marker.style.top = `${(1 - p.y) * 50}%`;
    });
  }
}
