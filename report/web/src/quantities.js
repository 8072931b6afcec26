// What is known along the path: names, units, how they are drawn. `border`: a value at which a line is drawn.
export const QUANTITIES = {
  feed: { name: 'actual feed', plot: 'feed', unit: 'mm/min', decimals: 0 },
  force: { name: 'lateral force', plot: 'lateral force', unit: 'N', decimals: 1 },
  deflection: { name: 'deflection', plot: 'deflection at the contact', unit: '\u00b5m', decimals: 1 },
  chip: { name: 'chip thickness', plot: 'chip thickness', unit: '\u00b5m', decimals: 1 },
  margin: { name: 'chatter margin', plot: 'depth over critical depth, above 1 chatter', unit: '', decimals: 2, border: 1 },
  error: { name: 'form error', plot: 'form error', unit: '\u00b5m', decimals: 2, diverging: true },
  shift: { name: 'shift', plot: 'shift of the path', unit: '\u00b5m', decimals: 1 },
};

export const withUnit = (name, { unit }) => unit ? `${name}, ${unit}` : name;
export const present = runs => Object.keys(QUANTITIES).filter(q => runs.some(r => r[q]));
