// The machine as plain bodies on the axes of its chain, with part, path and tool; seen from the bed or from the part.
import {
  BoxGeometry, BufferAttribute, BufferGeometry, Color, CylinderGeometry, DoubleSide, Group, LineBasicMaterial, LineSegments,
  Matrix4, Mesh, OrthographicCamera, Quaternion, Scene, ShaderMaterial, SphereGeometry, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { element } from './text.js';

const VERTEX = `
varying vec3 eye;
void main() {
  vec4 at = modelViewMatrix * vec4(position, 1.0);
  eye = at.xyz;
  gl_Position = projectionMatrix * at;
}`;
const FRAGMENT = `
uniform vec3 base;
uniform float alpha;
varying vec3 eye;
void main() {
  vec3 n = normalize(cross(dFdx(eye), dFdy(eye)));
  float light = 0.62 + 0.38 * max(0.0, dot(n.z < 0.0 ? -n : n, normalize(vec3(0.35, 0.55, 0.75))));
  gl_FragColor = vec4(base * light, alpha);
}`;

const VIEWS = { oblique: [-0.75, -1, 0.75], top: [0, -1e-4, 1], front: [0, -1, 0], right: [1, 0, 0] };
const RED = '#c0392b', ASIDE = 0.05, FITTED = 25;
const shown = colour => new Color(colour).convertLinearToSRGB();

function material(colour, alpha = 1) {
  return new ShaderMaterial({
    vertexShader: VERTEX, fragmentShader: FRAGMENT, side: DoubleSide, transparent: alpha < 1, depthWrite: alpha === 1,
    uniforms: { base: { value: shown(colour) }, alpha: { value: alpha } },
  });
}

// A cylinder from one point to another.
function cylinder(from, to, radius, colour, alpha, top = radius) {
  const along = to.clone().sub(from), mesh = new Mesh(new CylinderGeometry(top, radius, along.length(), 72), material(colour, alpha));
  mesh.position.copy(from).addScaledVector(along, 0.5);
  mesh.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), along.normalize()));
  return mesh;
}

// A bar with a square section.
function bar(from, to, width, colour, alpha) {
  const along = to.clone().sub(from), mesh = new Mesh(new BoxGeometry(width, along.length() + width, width), material(colour, alpha));
  mesh.position.copy(from).addScaledVector(along, 0.5);
  mesh.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), along.normalize()));
  return mesh;
}

function lines(places, colour, opacity = 1) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(places), 3));
  const out = new LineSegments(geometry, new LineBasicMaterial({ color: shown(colour), transparent: opacity < 1, opacity }));
  out.frustumCulled = false;
  return out;
}

export class MachineScene {
  // `inPart`: the part stands still; else the bed does.
  constructor(box, page, inPart, changed) {
    Object.assign(this, { box, page, inPart, changed });
    this.renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.renderer.outputColorSpace = 'srgb-linear';
    this.scene = new Scene();
    this.scene.background = shown('#f3f5f8');
    this.camera = new OrthographicCamera();
    this.camera.up.set(0, 0, 1);
    this.renderer.domElement.tabIndex = 0;
    this.renderer.domElement.setAttribute('aria-label', inPart ? 'The tool around the part' : 'The machine');
    box.append(this.renderer.domElement);
    this.triad = box.appendChild(element('div', { className: 'triad' }));
    this.build();
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.zoomToCursor = true;
    this.controls.addEventListener('change', () => this.render());
    this.renderer.domElement.addEventListener('dblclick', () => this.look('oblique'));
    this.look('oblique');
    new ResizeObserver(() => { this.resize(); this.render(); }).observe(box);
  }

  build() {
    const { page } = this, { chain } = page;
    this.bodies = chain.links.map(() => this.scene.add(new Group()).children.at(-1));
    this.partBody = this.scene.add(new Group()).children.at(-1);
    this.toolBody = this.scene.add(new Group()).children.at(-1);
    this.marks = [];  // points of bodies that the picture must hold
    this.measure();
    if (page.part) this.addPart(page.part);
    this.addPath();
    chain.links.forEach((link, i) => { if (link.rotary) link.table ? this.addTable(link, i) : this.addHead(link, i); });
    this.addTool();
    for (const body of [...this.bodies, this.partBody, this.toolBody]) body.matrixAutoUpdate = false;
  }

  // Middle and radius of what is cut, in the part's frame.
  measure() {
    const { tip, part, work } = this.page, low = new Vector3(Infinity, Infinity, Infinity), high = low.clone().negate();
    const add = (x, y, z) => { const p = new Vector3(x, y, z); low.min(p); high.max(p); };
    // Approaches and retracts are short and far: they do not count.
    const ends = [0, 1, 2].map(k => {
      const sorted = Float64Array.from(this.page.moments, m => tip[3 * m.index + k]).sort();
      return [sorted[Math.floor(ASIDE * (sorted.length - 1))], sorted[Math.ceil((1 - ASIDE) * (sorted.length - 1))]];
    });
    for (const k of [0, 1]) add(ends[0][k], ends[1][k], ends[2][k]);
    if (part) for (let i = 0; i < part.place.length; i += 3) add(part.place[i] + work[0], part.place[i + 1] + work[1], part.place[i + 2] + work[2]);
    this.middle = low.clone().add(high).multiplyScalar(0.5);
    this.radius = Math.max(low.distanceTo(high) / 2, 5);
    this.toolRadius = this.page.diameter / 2 || 0.05 * this.radius + 1;
  }

  addPart(part) {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(part.place, 3));
    geometry.setIndex(new BufferAttribute(part.triangles, 1));
    const mesh = new Mesh(geometry, material('#b9c4d0'));
    mesh.position.set(...this.page.work);
    this.partBody.add(mesh);
  }

  // The tip's way on the part; red where an axis is beyond its travel.
  addPath() {
    const { tip, beyond, work } = this.page, good = [], bad = [];
    for (let i = 0; i + 3 < tip.length; i += 3) (beyond[i / 3 + 1] ? bad : good).push(...tip.subarray(i, i + 6));
    this.partBody.add(lines(good, '#1668b8', 0.85));
    if (bad.length) this.partBody.add(lines(bad, RED));
    const arm = 0.3 * this.radius;
    ['#b3382c', '#2d7d3a', '#2456a6'].forEach((colour, k) => {
      const end = [...work];
      end[k] += arm;
      this.partBody.add(lines([...work, ...end], colour));
    });
  }

  // A disc below the part; on the axis next to the bed a cradle.
  addTable(link, i) {
    const way = new Vector3(...link.direction), at = new Vector3(...link.point), { links } = this.page.chain;
    const centre = at.clone().addScaledVector(way, this.middle.clone().sub(at).dot(way));
    const out = this.middle.distanceTo(centre) + this.radius;
    const first = links.findIndex(l => l.rotary && l.table) === i, body = this.bodies[i];
    this.reach = Math.max(this.reach || 0, out);
    if (first && Math.abs(way.dot(this.page.chain.tool)) > 0.5) {
      const up = way.dot(this.page.chain.tool) > 0 ? way : way.clone().negate();
      const depth = this.lowest(up) - 0.04 * this.radius, top = at.clone().addScaledVector(up, depth - at.dot(up));
      this.disc = { top, up, radius: 1.05 * out };
      body.add(cylinder(top.clone().addScaledVector(up, -0.12 * out), top, 1.05 * out, '#8d9aa9'));
      const mark = top.clone().add(up.clone().cross(new Vector3(1, 0.3, 0.2)).normalize().multiplyScalar(0.9 * out));
      body.add(bar(mark, mark.clone().lerp(top, 0.25), 0.07 * out, '#5c6877'));
    } else {
      this.addCradle(way, centre, out, body);
    }
  }

  // The rim of a round end is to be seen.
  mark(body, centre, way, radius) {
    const side = Math.abs(way.z) < 0.9 ? new Vector3(0, 0, 1) : new Vector3(1, 0, 0), across = side.clone().cross(way).normalize().multiplyScalar(radius);
    side.copy(way).cross(across);
    for (const rim of [across, side]) for (const s of [1, -1]) this.marks.push([this.bodies.indexOf(body), centre.clone().addScaledVector(rim, s)]);
  }

  // Bearings on the axis and a beam under the disc that they carry.
  addCradle(way, centre, out, body) {
    const size = this.disc ? this.disc.radius : out, far = 1.25 * size, wide = 0.16 * size;
    const ends = [1, -1].map(s => centre.clone().addScaledVector(way, s * far));
    for (const end of ends) this.mark(body, end.clone().addScaledVector(way, 0.3 * size * Math.sign(end.clone().sub(centre).dot(way))), way, 0.3 * size);
    ends.forEach((end, k) => body.add(cylinder(end, end.clone().addScaledVector(way, (k ? -1 : 1) * 0.3 * size), 0.3 * size, '#a98f6b')));
    if (!this.disc) return body.add(bar(...ends, 0.5 * wide, '#c3ad8c', 0.6));
    const { top, up } = this.disc, below = top.clone().addScaledVector(up, -0.25 * size), rise = up.clone().multiplyScalar(below.clone().sub(centre).dot(up));
    const feet = ends.map(end => end.clone().add(rise));
    ends.forEach((end, k) => { if (end.distanceTo(feet[k]) > wide / 4) body.add(bar(end, feet[k], wide, '#c3ad8c')); });
    body.add(bar(...feet, wide, '#c3ad8c'));
  }

  // How low part and path reach along `up`.
  lowest(up) {
    const { tip, part, work } = this.page, p = new Vector3();
    const heights = Float64Array.from(this.page.moments, ({ index: i }) => p.set(tip[3 * i], tip[3 * i + 1], tip[3 * i + 2]).dot(up)).sort();
    let low = heights[Math.floor(0.01 * (heights.length - 1))];
    if (part) for (let i = 0; i < part.place.length; i += 3) low = Math.min(low, p.set(part.place[i] + work[0], part.place[i + 1] + work[1], part.place[i + 2] + work[2]).dot(up));
    return low;
  }

  // A drum on the axis where the spindle is nearest to it.
  addHead(link, i) {
    const way = new Vector3(...link.direction), at = new Vector3(...link.point), { gauge, tool } = this.page.chain;
    const centre = at.clone().addScaledVector(way, gauge.clone().sub(at).dot(way)), size = this.spindleSize();
    const parallel = Math.abs(way.dot(tool)) > 0.99;
    const from = parallel ? gauge.clone().addScaledVector(tool, 3.2 * size) : centre;
    const half = way.clone().multiplyScalar(parallel ? 0.5 * size : 1.5 * size);
    for (const end of [from.clone().sub(half), from.clone().add(half)]) this.mark(this.bodies[i], end, way, size);
    this.bodies[i].add(cylinder(from.clone().sub(half), from.clone().add(half), parallel ? 1.5 * size : 0.9 * size, '#a98f6b', 0.75));
    const top = gauge.clone().addScaledVector(tool, 2.4 * size);
    if (!parallel && centre.distanceTo(top) > 0.5 * size) this.bodies[i].add(bar(top, centre, 0.5 * size, '#c3ad8c', 0.9));
  }

  spindleSize() { return Math.max(2.2 * this.toolRadius, 0.16 * this.radius); }

  addTool() {
    const { gauge, tool } = this.page.chain, size = this.spindleSize();
    this.toolBody.add(cylinder(gauge, gauge.clone().addScaledVector(tool, 2.4 * size), size, '#76818f', 1));
    this.stick = this.toolBody.add(new Group()).children.at(-1);
    this.length = null;
  }

  // The tool is as long as the sample says.
  setLength(length) {
    if (this.length !== null && Math.abs(length - this.length) < 1e-3) return;
    this.length = length;
    this.stick.clear();
    const { gauge, tool } = this.page.chain, tip = gauge.clone().addScaledVector(tool, -length), r = this.toolRadius;
    const cut = tip.clone().addScaledVector(tool, Math.min(length, Math.max(4 * r, 0.2 * length)));
    if (length > 0) {
      this.stick.add(cylinder(tip, cut, r, '#e0a030'));
      if (cut.distanceTo(gauge) > 1e-6) this.stick.add(cylinder(cut, gauge, r, '#9aa5b1'));
    }
    const dot = new Mesh(new SphereGeometry(0.35 * r + 0.006 * this.radius, 16, 12), material('#1d2733'));
    dot.position.copy(tip);
    this.stick.add(dot);
  }

  // `state`: {values, length, beyond}.
  pose(state) {
    const { links, part, spindle } = this.page.chain.bodies(state.values), from = this.inPart ? part.clone().invert() : new Matrix4();
    const place = (body, matrix) => { body.matrix.copy(from).multiply(matrix); body.matrixWorldNeedsUpdate = true; };
    this.bodies.forEach((body, i) => place(body, links[i]));
    place(this.partBody, part);
    place(this.toolBody, spindle);
    this.setLength(state.length);
    this.toolBody.children[0].material.uniforms.base.value = shown(state.beyond ? RED : '#76818f');
  }

  show(state) {
    this.pose(state);
    this.render();
  }

  // Points that the picture must hold, at some moments of the program.
  outline() {
    const out = [], { middle, radius, page } = this;
    const corners = [];
    for (const x of [-1, 1]) for (const y of [-1, 1]) for (const z of [-1, 1]) corners.push(middle.clone().add(new Vector3(x, y, z).multiplyScalar(0.6 * radius)));
    if (this.disc) for (let k = 0; k < 8; k++) {
      const side = new Vector3(Math.cos(k * Math.PI / 4), Math.sin(k * Math.PI / 4), 0).applyQuaternion(new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), this.disc.up));
      corners.push(this.disc.top.clone().addScaledVector(side, this.disc.radius));
    }
    const top = page.chain.gauge.clone().addScaledVector(page.chain.tool, 2.4 * this.spindleSize());
    for (let m = 0; m < page.moments.length; m += Math.ceil(page.moments.length / FITTED)) {
      const state = page.moments[m];
      const { links, part, spindle } = page.chain.bodies(state.values), from = this.inPart ? part.clone().invert() : new Matrix4();
      if (!this.inPart) for (const [body, point] of this.marks) out.push(point.clone().applyMatrix4(links[body]));
      const ofPart = from.clone().multiply(part), ofTool = from.clone().multiply(spindle);
      for (const c of corners) out.push(c.clone().applyMatrix4(ofPart));
      out.push(top.clone().applyMatrix4(ofTool), page.chain.gauge.clone().applyMatrix4(ofTool),
        page.chain.gauge.clone().addScaledVector(page.chain.tool, -state.length).applyMatrix4(ofTool));
    }
    return out;
  }

  look(name) {
    this.points ||= this.outline();
    const low = this.points.reduce((a, p) => a.min(p), this.points[0].clone()), high = this.points.reduce((a, p) => a.max(p), this.points[0].clone());
    this.target = low.clone().add(high).multiplyScalar(0.5);
    this.size = low.distanceTo(high) / 2 || 1;
    const far = 40 * this.size, way = new Vector3(...VIEWS[name]).normalize();
    this.controls?.target.copy(this.target);
    this.camera.position.copy(this.target).addScaledVector(way, far / 2);
    Object.assign(this.camera, { near: 0, far, zoom: 1 });
    this.resize();
    this.camera.lookAt(this.target);
    this.controls?.update();
    this.fit();
  }

  fit() {
    this.camera.updateMatrixWorld();
    let most = 0;
    for (const point of this.points) {
      const p = point.clone().project(this.camera);
      most = Math.max(most, Math.abs(p.x), Math.abs(p.y));
    }
    this.camera.zoom = 0.92 / (most || 1);
    this.camera.updateProjectionMatrix();
    this.render();
  }

  resize() {
    if (matchMedia('print').matches) return;
    const w = Math.max(1, this.box.clientWidth), h = Math.max(1, this.box.clientHeight), r = this.size || 1;
    this.renderer.setSize(w, h);
    this.box.style.setProperty('--ratio', w / h);
    Object.assign(this.camera, { left: -r * w / h, right: r * w / h, top: r, bottom: -r });
    this.camera.updateProjectionMatrix();
  }

  render() {
    this.renderer.render(this.scene, this.camera);
    const turn = this.camera.matrixWorldInverse, size = 26;
    this.triad.innerHTML = '<svg width="84" height="84" viewBox="-42 -42 84 84">' +
      [['X', '#b3382c', 0], ['Y', '#2d7d3a', 4], ['Z', '#2456a6', 8]].map(([name, colour, at]) => {
        const x = turn.elements[at] * size, y = -turn.elements[at + 1] * size, far = Math.hypot(x, y) > 5;
        return `<path d="M0 0L${x.toFixed(1)} ${y.toFixed(1)}" stroke="${colour}" stroke-width="2"/>` +
          (far ? `<text x="${(x * 1.4).toFixed(1)}" y="${(y * 1.4 + 4).toFixed(1)}" fill="${colour}">${name}</text>` : '');
      }).join('') + '</svg>';
  }
}
