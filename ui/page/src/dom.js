// Elements and numbers.
export function h(tag, properties = {}, ...children) {
  const out = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null) continue;
    if (name.startsWith('on')) out.addEventListener(name.slice(2), value);
    else if (name === 'data') Object.assign(out.dataset, value);
    else if (name in out && name !== 'list' && name !== 'form') out[name] = value;
    else out.setAttribute(name, value);
  }
  out.append(...children.flat(9).filter(c => c !== null && c !== undefined && c !== false));
  return out;
}

export function select(label, options, value, changed) {
  const list = h('select', { 'aria-label': label, onchange: () => changed(list.value) }, options.map(([v, t]) => h('option', { value: v }, t)));
  list.value = value;
  return h('label', { className: 'choice' }, h('span', {}, label), list);
}

// What a click does, Enter on the focused element does too.
export const clickable = act => ({ tabIndex: 0, role: 'button', onclick: act, onkeydown: e => { if (e.key === 'Enter') act(); } });

// In groups of three, apart by a narrow space: a point stands before decimals in every language.
export const grouped = n => String(n).replace(/\B(?=(\d{3})+$)/g, '\u202f');

export function clock(seconds) {
  const s = Math.round(seconds);
  if (s < 100) return `${s} s`;
  return s < 6000 ? `${Math.floor(s / 60)} min ${s % 60} s` : `${Math.floor(s / 3600)} h ${Math.round(s / 60) % 60} min`;
}

export const baseName = path => path.slice(path.lastIndexOf('/') + 1);
export const folderName = path => path.slice(0, path.lastIndexOf('/') + 1);
export const clear = (box, ...children) => { box.replaceChildren(...children.flat(9).filter(Boolean)); return box; };
