// The kinematic chain of a machine, as kinematics/chain.h has it: each axis moves the tool relative to the part.
import { Matrix4, Vector3 } from 'three';

const vector = v => new Vector3(...v);

// The relative motion of one axis, at its position in mm or degrees.
function motion(link, value) {
  if (!link.rotary) return new Matrix4().makeTranslation(...link.direction.map(d => d * value));
  const at = vector(link.point), turn = new Matrix4().makeRotationAxis(vector(link.direction), value * Math.PI / 180);
  return new Matrix4().makeTranslation(...link.point).multiply(turn).multiply(new Matrix4().makeTranslation(...at.negate().toArray()));
}

export class Chain {
  constructor({ links, gauge, tool }) {
    Object.assign(this, { links, gauge: vector(gauge), tool: vector(tool) });
  }

  // Where every body stands in the frame of the machine's bed: the one that link i moves, by its index; the last one
  // holds the tool. `values`: positions by letter.
  bodies(values) {
    const { links } = this, out = new Array(links.length), table = links.filter(l => l.table).length;
    let at = new Matrix4();
    for (let i = table - 1; i >= 0; i--) out[i] = at = motion(links[i], values[links[i].axis]).invert().premultiply(at.clone());
    at = new Matrix4();
    for (let i = table; i < links.length; i++) out[i] = at = at.clone().multiply(motion(links[i], values[links[i].axis]));
    const none = new Matrix4();
    return { links: out, part: table > 0 ? out[0] : none, spindle: table < links.length ? out[links.length - 1] : none };
  }
}
