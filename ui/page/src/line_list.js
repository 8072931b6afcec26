// A program's lines: only those that are seen are elements, so that a million of them are no burden.
import { h } from './dom.js';

const HEIGHT = 20, MARGIN = 20, MAX_PIXELS = 15e6;  // browsers draw no taller elements

export class LineList {
  constructor({ picked, label }) {
    this.picked = picked;
    this.rows = h('div', { className: 'rows' });
    this.space = h('div', { className: 'space' }, this.rows);
    this.box = h('div', { className: 'lines', tabIndex: 0, role: 'listbox', 'aria-label': label, onscroll: () => this.draw() }, this.space);
    this.box.addEventListener('keydown', e => {
      const step = { ArrowDown: 1, ArrowUp: -1, PageDown: 20, PageUp: -20 }[e.key];
      if (!step || !this.count) return;
      e.preventDefault();
      this.select(Math.min(this.count, Math.max(1, this.selected + step)), true);
      this.picked(this.selected);
    });
    this.marks = new Map();
    this.setText('');
    new ResizeObserver(() => this.draw()).observe(this.box);
  }

  setText(text) {
    this.text = text;
    const starts = [0];
    for (let at = text.indexOf('\n'); at >= 0; at = text.indexOf('\n', at + 1)) starts.push(at + 1);
    if (starts.at(-1) === text.length && starts.length > 1) starts.pop();
    this.starts = Uint32Array.from(starts);
    this.count = text.length ? starts.length : 0;
    this.selected = 0;
    this.pixels = Math.min(this.count * HEIGHT, MAX_PIXELS);
    this.space.style.height = this.pixels + 'px';
    this.box.scrollTop = 0;
    this.draw();
  }

  line(number) {
    const end = number < this.count ? this.starts[number] : this.text.length;
    return this.text.slice(this.starts[number - 1], end).replace(/[\r\n]+$/, '');
  }

  // The next line below the selected one, or the first of all, with this text; 0: none.
  find(words) {
    const low = this.text.toLowerCase(), what = words.toLowerCase(), from = this.selected < this.count ? this.starts[this.selected] : 0;
    const at = [low.indexOf(what, from), low.indexOf(what)].find(i => i >= 0);
    if (at === undefined) return 0;
    let first = 0, end = this.count;
    while (end - first > 1) {
      const middle = (first + end) >> 1;
      if (this.starts[middle] <= at) first = middle;
      else end = middle;
    }
    return first + 1;
  }

  // Map of line to {severity, texts}; or to a class of its own.
  setMarks(marks) {
    this.marks = marks;
    this.draw();
  }

  select(number, scroll) {
    this.selected = number;
    if (scroll) {
      const shown = Math.floor(this.box.clientHeight / HEIGHT), first = this.first();
      if (number - 1 < first || number > first + shown - 1) this.box.scrollTop = this.topOf(Math.max(0, number - 1 - Math.floor(shown / 2)));
    }
    this.draw();
  }

  // Where the whole list is too tall the bar's way is shared out among the lines.
  range() { return Math.max(1, this.pixels - this.box.clientHeight); }
  hiddenLines() { return Math.max(0, this.count - Math.floor(this.box.clientHeight / HEIGHT)); }
  first() {
    if (this.pixels < MAX_PIXELS) return Math.floor(this.box.scrollTop / HEIGHT);
    return Math.round(this.box.scrollTop / this.range() * this.hiddenLines());
  }
  topOf(index) { return this.pixels < MAX_PIXELS ? index * HEIGHT : index / Math.max(1, this.hiddenLines()) * this.range(); }

  draw() {
    const first = this.first(), shown = Math.ceil(this.box.clientHeight / HEIGHT) + MARGIN, rows = [];
    for (let i = first; i < Math.min(this.count, first + shown); i++) {
      const number = i + 1, mark = this.marks.get(number);
      rows.push(h('div', {
        className: `row${mark ? ' ' + mark.severity : ''}${number === this.selected ? ' selected' : ''}`, data: { line: number }, title: mark ? mark.texts.join('\n') : '',
        onclick: () => { this.select(number); this.picked(number); },
      }, h('span', { className: 'number' }, String(number)), h('code', {}, this.line(number)), mark?.texts.length ? h('span', { className: 'said' }, mark.texts[0]) : null));
    }
    this.rows.style.transform = `translateY(${this.pixels < MAX_PIXELS ? first * HEIGHT : this.box.scrollTop}px)`;
    this.rows.replaceChildren(...rows);
  }
}
