// What the page asks the server for.
import { text } from './texts.js';

export const query = parameters => Object.entries(parameters)
  .filter(([, v]) => v !== undefined && v !== null && v !== '')
  .map(([k, v]) => `${encodeURIComponent(k)}=${encodeURIComponent(v)}`).join('&');

async function answer(promise) {
  let response;
  try { response = await promise; } catch { throw new Error(text('lost')); }
  const value = await response.json().catch(() => ({ error: text('lost') }));
  if (!response.ok) throw new Error(value.error || String(response.status));
  return value;
}

export const get = (path, parameters = {}) => answer(fetch(`${path}?${query(parameters)}`));
export const post = (path, parameters = {}, body = '') => answer(fetch(`${path}?${query(parameters)}`, { method: 'POST', body }));
export const fileAddress = (name, download) => 'files/' + name.split('/').map(encodeURIComponent).join('/') + (download ? '?download=1' : '');

export async function fileText(name) {
  const response = await fetch(fileAddress(name));
  if (!response.ok) throw new Error((await response.json()).error);
  return response.text();
}
export async function fileBytes(name) {
  const response = await fetch(fileAddress(name));
  if (!response.ok) throw new Error((await response.json()).error);
  return response.arrayBuffer();
}

// Options of commands go with "o." before their names.
export const optionsOf = options => Object.fromEntries(Object.entries(options).map(([k, v]) => ['o.' + k, v]));

// Every change of the runs, also after the connection was lost for a while.
export function watchRuns(changed, lost) {
  const source = new EventSource('api/events');
  source.addEventListener('runs', e => changed(JSON.parse(e.data)));
  source.addEventListener('error', () => lost());
}
