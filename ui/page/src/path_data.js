// The file of camber check --path: one line of JSON, then arrays (report/path_arrays.h).
const TYPES = { f4: Float32Array, u4: Uint32Array, u2: Uint16Array, u1: Uint8Array };

export function readPath(buffer) {
  const bytes = new Uint8Array(buffer), end = bytes.indexOf(10);
  const head = JSON.parse(new TextDecoder().decode(bytes.subarray(0, end)));
  const out = { count: head.points, origin: head.origin_mm, chord_mm: head.chord_mm, thinned: head.thinned, inPart: head.in_part };
  let at = end + 1;
  for (const [name, type] of head.arrays) {
    out[name] = new TYPES[type](buffer, at, head.points);
    at += Math.ceil(head.points * TYPES[type].BYTES_PER_ELEMENT / 4) * 4;
  }
  return out;
}

export const RAPID = 1;
