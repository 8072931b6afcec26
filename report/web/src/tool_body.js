// The tool as a body that turns about its axis: cutter, shank and holder.
import { DoubleSide, Group, LatheGeometry, Mesh, ShaderMaterial, Vector2, Vector3, Color } from 'three';

const VERTEX = `
varying vec3 eye;
void main() {
  vec4 at = modelViewMatrix * vec4(position, 1.0);
  eye = at.xyz;
  gl_Position = projectionMatrix * at;
}`;
// The holder hides much of the part: it is seen through.
const FRAGMENT = `
uniform vec3 base;
uniform float alpha;
varying vec3 eye;
void main() {
  vec3 n = normalize(cross(dFdx(eye), dFdy(eye)));
  float light = 0.62 + 0.38 * max(0.0, dot(n.z < 0.0 ? -n : n, normalize(vec3(0.35, 0.55, 0.75))));
  gl_FragColor = vec4(base * light, alpha);
}`;
const PARTS = [['#e0a030', 0.9], ['#9aa5b1', 0.75], ['#76818f', 0.45]];

function piece(rings, [colour, alpha]) {
  const geometry = new LatheGeometry(rings.map(([, radius, height]) => new Vector2(radius, height)), 48);
  return new Mesh(geometry, new ShaderMaterial({
    vertexShader: VERTEX, fragmentShader: FRAGMENT, side: DoubleSide, transparent: true, depthWrite: alpha > 0.8,
    uniforms: { base: { value: new Color(colour).convertLinearToSRGB() }, alpha: { value: alpha } },
  }));
}

export class ToolBody {
  // `tools`: by number, circles [part, radius, height] from the tip upwards.
  constructor(tools) {
    this.body = new Group();
    this.body.visible = false;
    this.tools = Object.fromEntries(Object.entries(tools).map(([number, rings]) => {
      const tool = new Group();
      PARTS.forEach((look, part) => {
        const of = rings.filter(r => r[0] === part);
        if (of.length > 1) tool.add(piece(of, look));
      });
      this.body.add(tool);
      return [number, tool];
    }));
  }

  // {tool, tip, axis}, axis from the tip towards the spindle; null hides it.
  show(pose) {
    this.body.visible = Boolean(pose && this.tools[pose.tool]);
    if (!this.body.visible) return;
    for (const [number, tool] of Object.entries(this.tools)) tool.visible = number === String(pose.tool);
    this.body.position.set(...pose.tip);
    this.body.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), new Vector3(...pose.axis).normalize());
  }
}
