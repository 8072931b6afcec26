// The pages with a path alone. Of compress, resegment and rasters: before and after, lines and arcs in two colours. Of
// check and time: one program, rapid and cutting in two colours, feeds as further views.
import { SEQUENTIAL, colourAt, gradient } from './colours.js';
import { bytesOf, inflate, read } from './data.js';
import { ARC, KEPT_ARC, KEPT_LINE, LINE, PART_COLOUR, PathView, QUIET, RAPID, VIEWS } from './path_view.js';
import { choice, element, menu, niceLimit } from './text.js';

const REWRITTEN = {
  [RAPID]: { name: 'rapid', colour: '#b4bcc6', width: 0.7, dash: [4, 4] },
  [KEPT_LINE]: { name: 'line, unchanged', colour: '#8fb4d8', width: 1 },
  [KEPT_ARC]: { name: 'arc, unchanged', colour: '#eab393', width: 1 },
  [LINE]: { name: 'line', colour: '#1668b8', width: 1.3 },
  [ARC]: { name: 'arc', colour: '#d9622b', width: 1.3 },
};
const CUTTING = { name: 'cutting', colour: '#1668b8', width: 1.2 };
const MOTION = { [RAPID]: { name: 'rapid', colour: '#d9622b', width: 1 }, [KEPT_LINE]: CUTTING, [KEPT_ARC]: CUTTING, [LINE]: CUTTING, [ARC]: CUTTING };
const FEEDS = { feed: 'programmed feed', speed: 'actual feed' };
const BINS = 24;

const placeOf = (path, i) => 'XYZ'.split('').map((a, k) => a + path.place[k][i].toFixed(3)).join(' ');

function key(name, colour) {
  const line = element('i');
  line.style.background = colour;
  return element('span', { className: 'key' }, line, name);
}

function views(view) {
  const looks = element('span', { className: 'choice' }, element('span', { className: 'label', textContent: 'View' }));
  for (const name of Object.keys(VIEWS)) {
    const button = element('button', { type: 'button', textContent: name[0].toUpperCase() + name.slice(1) });
    button.addEventListener('click', () => { view.look(name); view.draw(); });
    looks.append(button);
  }
  return looks;
}

// Before and after.
function rewritten({ paths, worst, part, box, controls, legend }) {
  const describe = (path, i) => `line ${path.block[i] + 1} ${path.name}: ${REWRITTEN[path.kind[i]].name} to ${placeOf(path, i)}`;
  const view = new PathView(box, { paths, worst, part, styles: REWRITTEN, describe });
  const program = choice('Program', [['after', 'After'], ['before', 'Before']], which => { view.path = paths[which === 'after' ? 1 : 0]; view.draw(); });
  controls.append(program.box, views(view));
  const used = new Set(paths.flatMap(p => [...new Set(p.kind)]));
  const styles = Object.entries(REWRITTEN).filter(([k]) => used.has(Number(k))).reverse().map(([, style]) => style);
  if (part) styles.push({ name: 'part', colour: PART_COLOUR });
  legend.append(...styles.map(style => key(style.name, style.colour)));
}

function scale(name, most) {
  const ticks = [0, 0.5, 1].map(share => element('span', { textContent: String(+(share * most).toPrecision(3)) }));
  const bar = element('div', { className: 'gradient' });
  bar.style.background = gradient(SEQUENTIAL);
  return element('div', { className: 'legend' }, element('div', { className: 'legend-name', textContent: `${name}, mm/min` }), bar, element('div', { className: 'ticks' }, ...ticks));
}

// One program: what is shown and in which colours.
class ProgramPicture {
  constructor({ paths, box, controls, legend }) {
    Object.assign(this, { path: paths[0], legend, quantity: 'motion', tool: '' });
    this.view = new PathView(box, { paths, styles: MOTION, describe: (path, i) => this.describe(path, i) });
    const feeds = Object.keys(FEEDS).filter(q => this.path[q]).reverse();
    const shows = choice('Show', [['motion', 'Rapid and cutting'], ['cutting', 'Cutting'], ...feeds.map(q => [q, FEEDS[q][0].toUpperCase() + FEEDS[q].slice(1)])],
      q => { this.quantity = q; this.show(); });
    controls.append(shows.box, views(this.view));
    this.tools = [...new Set(this.path.tool)].sort((a, b) => a - b);
    if (this.tools.length > 1)
      controls.append(menu('Tool', [['', 'all'], ...this.tools.map(t => [t, 'T' + t])], t => { this.tool = t; this.show(); }).box);
    this.show();
  }

  show() {
    const { kind, tool } = this.path, q = this.quantity;
    const ofTool = i => this.tool === '' || tool[i] === Number(this.tool);
    this.view.shown = i => ofTool(i) && (q !== 'cutting' || kind[i] !== RAPID);
    this.view.bins = FEEDS[q] ? this.binsOf(this.path[q], ofTool) : null;
    const keys = q === 'motion' ? [RAPID, LINE].map(k => key(MOTION[k].name, MOTION[k].colour)) : [key(CUTTING.name, CUTTING.colour)];
    this.legend.replaceChildren(...(FEEDS[q] ? [scale(FEEDS[q], this.most), key('rapid', QUIET)] : keys));
    this.view.draw();
  }

  // Both feeds share a scale, so that they compare: that of what is shown.
  binsOf(values, ofTool) {
    let most = 0;
    for (const q of Object.keys(FEEDS))
      this.path[q]?.forEach((v, i) => { if (v > most && this.path.kind[i] > RAPID && ofTool(i)) most = v; });
    this.most = niceLimit(most);
    const of = Uint8Array.from(values, v => Math.min(BINS - 1, Math.floor(BINS * v / this.most) || 0));
    return { of, colours: Array.from({ length: BINS }, (_, b) => `rgb(${colourAt(SEQUENTIAL, (b + 0.5) / BINS).map(Math.round).join(',')})`) };
  }

  describe(path, i) {
    const rapid = path.kind[i] === RAPID;
    let out = `line ${path.block[i] + 1}: ${MOTION[path.kind[i]].name} to ${placeOf(path, i)}`;
    if (!rapid && path.feed) out += `, F${path.feed[i].toFixed(0)}`;
    if (!rapid && path.speed) out += `, actual ${path.speed[i].toFixed(0)} mm/min`;
    if (this.tools.length > 1) out += `, T${path.tool[i]}`;
    return out;
  }
}

async function start() {
  const index = JSON.parse(document.getElementById('index').textContent), bytes = await inflate(bytesOf('arrays'));
  const picture = p => {
    const packed = read(bytes, p.kind), out = { name: p.name, thinned: p.thinned, place: p.place.map(a => read(bytes, a)), block: read(bytes, p.block) };
    for (const name of ['tool', 'feed', 'speed']) if (p[name]) out[name] = read(bytes, p[name]);
    return { ...out, kind: packed.map(v => v >> 1), ends: packed.map(v => v & 1) };
  };
  const parts = {
    paths: index.paths.map(picture), worst: index.worst, part: index.part && picture(index.part), box: document.getElementById('scene'),
    controls: document.getElementById('path-controls'), legend: document.getElementById('path-legend'),
  };
  if (index.motion) new ProgramPicture(parts);
  else rewritten(parts);
  requestAnimationFrame(() => requestAnimationFrame(() => { document.documentElement.dataset.ready = 'yes'; }));
}

start();
