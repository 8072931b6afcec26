// Lengths as the user wants them. Files have millimetres.
const INCH = 25.4;
let inch = false;

export const setInch = on => { inch = on; };
export const isInch = () => inch;

const isLength = key => /_mm(_|$)/.test(key) && !/_um(_|$)/.test(key);
const perLength = key => /_per_mm/.test(key);

export function unitOf(key) {
  const names = [[/_mm_per_min$/, inch ? 'in/min' : 'mm/min'], [/_N_per_um$/, 'N/µm'], [/_N_per_mm$/, 'N/mm'], [/_mm_per_s2$/, inch ? 'in/s²' : 'mm/s²'],
    [/_mm_per_s$/, inch ? 'in/s' : 'mm/s'], [/_mm3?$/, inch ? 'in' : 'mm'], [/_um$/, 'µm'], [/_deg$/, '°'], [/_percent$/, '%'], [/_GPa$/, 'GPa'], [/_MPa$/, 'MPa'],
    [/_N$/, 'N'], [/_s$/, 's'], [/_rpm$/, 'rpm'], [/_HB$/, 'HB']];
  return names.find(([ending]) => ending.test(key))?.[1] ?? '';
}

const converts = key => inch && isLength(key) && !perLength(key);
const NUMBER = /(?<![\w"])-?\d+(\.\d+)?([eE][-+]?\d+)?/g;
const trimmed = value => {
  const out = String(+value.toFixed(6));
  return out.includes('.') || out.includes('e') ? out : out + '.0';
};

// A value of a job's file as it is shown, and back.
export const shownValue = (key, value) => converts(key) ? value.replace(NUMBER, n => trimmed(Number(n) / INCH)) : value;
export const givenValue = (key, value) => converts(key) ? value.replace(NUMBER, n => trimmed(Number(n) * INCH)) : value;

export const length = (mm, decimals = 3) => inch ? `${(mm / INCH).toFixed(decimals + 1)} in` : `${mm.toFixed(decimals)} mm`;
export const speed = mm_per_min => inch ? `${(mm_per_min / INCH).toFixed(1)} in/min` : `${mm_per_min.toFixed(0)} mm/min`;
