// What C++ packed (report/packed_arrays.h): base64 of deflated bytes, arrays described by {at, n, kind, from, step}.

export function bytesOf(id) {
  const text = atob(document.getElementById(id).textContent), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}

export async function inflate(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// Values of `size` bytes whose bytes stand apart: all least significant ones first.
function whole(bytes, { at, n }, size) {
  const out = new Uint32Array(n);
  for (let b = 0; b < size; b++)
    for (let i = 0, from = at + b * n; i < n; i++) out[i] |= bytes[from + i] << (8 * b);
  return out;
}

const READERS = {
  f4: (bytes, a) => new Float32Array(whole(bytes, a, 4).buffer),
  q2: (bytes, a) => Float32Array.from(whole(bytes, a, 2), q => q === 65535 ? NaN : a.from + a.step * q),
  d4: (bytes, a) => {
    const out = whole(bytes, a, 4);
    for (let i = 0, sum = 0; i < out.length; i++) out[i] = sum = (sum + ((out[i] >>> 1) ^ -(out[i] & 1))) >>> 0;
    return out;
  },
};

export const read = (bytes, a) => READERS[a.kind](bytes, a);

function triples(bytes, arrays) {
  const [x, y, z] = arrays.map(a => read(bytes, a)), out = new Float32Array(3 * x.length);
  for (let i = 0; i < x.length; i++) out.set([x[i], y[i], z[i]], 3 * i);
  return out;
}

// Two triangles a quadrangle; one where its last corner is its first.
function triangles(bytes, arrays) {
  const [first, ...steps] = arrays.map(a => read(bytes, a)), out = [];
  for (let i = 0; i < first.length; i++) {
    const [a, b, c, d] = [first[i], ...steps.map(s => (first[i] + s[i]) >>> 0)];
    out.push(a, b, c);
    if (d !== a) out.push(a, c, d);
  }
  return new Uint32Array(out);
}

const meshOf = (bytes, m) => ({ place: triples(bytes, m.place), triangles: triangles(bytes, m.quad), cell: m.cell });

function surfaceOf(bytes, s) {
  return {
    ...meshOf(bytes, s), normal: triples(bytes, s.normal),
    error: s.error.map(a => read(bytes, a)), contour: s.contour && read(bytes, s.contour), block: s.block.map(a => read(bytes, a)), points: s.points,
  };
}

function runOf(bytes, run) {
  const out = { name: run.name, place: triples(bytes, run.place) };
  for (const [name, value] of Object.entries(run)) if (value.kind) out[name] = read(bytes, value);
  if (run.axis) out.axis = triples(bytes, run.axis);
  return out;
}

// {scales, view, download, machine, surface, measured, stock, runs}; runs without rows are left out.
export async function readPage() {
  const index = JSON.parse(document.getElementById('index').textContent), bytes = await inflate(bytesOf('arrays'));
  return {
    scales: index.scales, view: index.view, download: index.download, machine: index.machine,
    surface: index.surface && surfaceOf(bytes, index.surface),
    measured: index.measured && { place: triples(bytes, index.measured.place), error: read(bytes, index.measured.error) },
    stock: index.stock && meshOf(bytes, index.stock),
    runs: index.runs.filter(r => r.t.n > 0).map(r => runOf(bytes, r)),
  };
}

// The bytes of a run's program; null where the page does not hold it.
export async function programBytes(run) {
  return document.getElementById('program' + run) ? inflate(bytesOf('program' + run)) : null;
}
