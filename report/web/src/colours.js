// Colour maps that colour-blind people can tell apart.

// ColorBrewer RdBu: blue (too deep) over white (exact) to red (material left).
export const DIVERGING = [[33, 102, 172], [103, 169, 207], [209, 229, 240], [255, 255, 255], [253, 219, 199], [239, 138, 98], [178, 24, 43]];
// Viridis.
export const SEQUENTIAL = [[68, 1, 84], [65, 68, 135], [42, 120, 142], [34, 168, 132], [122, 209, 81], [253, 231, 37]];

export function colourAt(stops, share) {
  const s = Math.min(Math.max(share, 0), 1) * (stops.length - 1), i = Math.min(Math.floor(s), stops.length - 2), u = s - i;
  return stops[i].map((v, k) => v + u * (stops[i + 1][k] - v));
}

export const gradient = stops => `linear-gradient(to right, ${stops.map(c => `rgb(${c.join(',')})`).join(', ')})`;

// GLSL: vec3 diverging(float share).
export const DIVERGING_GLSL = `
vec3 diverging(float share) {
  vec3 stops[7];
  ${DIVERGING.map((c, i) => `stops[${i}] = vec3(${c.map(v => (v / 255).toFixed(4)).join(', ')});`).join('\n  ')}
  float s = clamp(share, 0.0, 1.0) * 6.0;
  vec3 colour = stops[0];
  for (int i = 0; i < 6; i++) colour = mix(colour, stops[i + 1], clamp(s - float(i), 0.0, 1.0));
  return colour;
}`;
