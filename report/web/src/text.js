// Numbers and elements as the page shows them.

export const MINUS = '\u2212';

export function fixed(value, decimals) {
  if (!Number.isFinite(value)) return '\u2013';
  const text = Math.abs(value).toFixed(decimals);
  return (value < 0 && /[1-9]/.test(text) ? MINUS : '') + text;
}

export const signed = (value, decimals) => (value > 0 && /[1-9]/.test(value.toFixed(decimals)) ? '+' : '') + fixed(value, decimals);

// The smallest of 1, 1.5, 2, 3, 5, 7.5 times a power of ten that is not less.
export function niceLimit(value) {
  if (!(value > 0)) return 1;
  const decade = 10 ** Math.floor(Math.log10(value));
  return decade * [1, 1.5, 2, 3, 5, 7.5, 10].find(s => value <= s * decade * (1 + 1e-9));
}

export function element(tag, properties = {}, ...children) {
  const out = document.createElement(tag);
  for (const [name, value] of Object.entries(properties))
    name in out ? out[name] = value : out.setAttribute(name, value);
  out.append(...children);
  return out;
}

// A row of buttons of which one is pressed. Gives back the element and a function that presses one.
export function choice(label, options, chosen) {
  const buttons = options.map(([value, text]) => {
    const button = element('button', { type: 'button', textContent: text });
    button.dataset.value = value;
    button.addEventListener('click', () => { press(value); chosen(value); });
    return button;
  });
  const press = value => buttons.forEach(b => b.setAttribute('aria-pressed', String(b.dataset.value === value)));
  press(options[0][0]);
  const box = element('span', { className: 'choice', role: 'group' }, element('span', { className: 'label', textContent: label }), ...buttons);
  box.setAttribute('aria-label', label);
  return { box, press };
}

export function menu(label, options, chosen) {
  const list = element('select', { ariaLabel: label });
  for (const [value, text] of options) list.append(element('option', { value, textContent: text }));
  list.addEventListener('change', () => chosen(list.value));
  return { box: element('label', { className: 'choice' }, element('span', { className: 'label', textContent: label }), list), list };
}
