// What the page asks the server for.
import { text } from './texts.js';

export const query = parameters => Object.entries(parameters)
  .filter(([, v]) => v !== undefined && v !== null && v !== '')
  .map(([k, v]) => `${encodeURIComponent(k)}=${encodeURIComponent(v)}`).join('&');

// What the page waits for, on the root element: questions to the server, and what is typed until it is written.
let waiting = 0;
function count(by) {
  waiting += by;
  document.documentElement.dataset.busy = String(waiting);
}
async function counted(work) {
  count(1);
  try { return await work(); } finally { count(-1); }
}

// Does what was asked for last, once nothing more was asked for a while.
export class Pause {
  constructor(ms) { this.ms = ms; }
  then(what) {
    if (this.timer) clearTimeout(this.timer);
    else count(1);
    this.timer = setTimeout(async () => {
      this.timer = null;
      try { await what(); } finally { count(-1); }
    }, this.ms);
  }
}

const answer = promise => counted(() => answerOf(promise));
async function answerOf(promise) {
  let response;
  try { response = await promise; } catch { throw new Error(text('lost')); }
  const value = await response.json().catch(() => ({ error: text('lost') }));
  if (!response.ok) throw new Error(value.error || String(response.status));
  return value;
}

export const get = (path, parameters = {}) => answer(fetch(`${path}?${query(parameters)}`));
export const post = (path, parameters = {}, body = '') => answer(fetch(`${path}?${query(parameters)}`, { method: 'POST', body }));
export const fileAddress = (name, download) => 'files/' + name.split('/').map(encodeURIComponent).join('/') + (download ? '?download=1' : '');

const file = (name, read) => counted(async () => {
  const response = await fetch(fileAddress(name)).catch(() => { throw new Error(text('lost')); });
  if (!response.ok) throw new Error((await response.json()).error);
  return read(response);
});
// NC programs of older systems have letters of Windows' code page.
export const fileText = name => file(name, async response => {
  const bytes = await response.arrayBuffer();
  try { return new TextDecoder('utf-8', { fatal: true }).decode(bytes); } catch { return new TextDecoder('windows-1252').decode(bytes); }
});
export const fileBytes = name => file(name, response => response.arrayBuffer());

// Options of commands go with "o." before their names.
export const optionsOf = options => Object.fromEntries(Object.entries(options).map(([k, v]) => ['o.' + k, v]));

// Every change of the runs, also after the connection was lost for a while.
export function watchRuns(changed, lost) {
  const source = new EventSource('api/events');
  source.addEventListener('runs', e => changed(JSON.parse(e.data)));
  source.addEventListener('error', () => lost());
}
