// page_test.mjs PACKAGES CHECK URL [FOLDER] [FILE]: opens the workbench at URL in headless Chromium, without any other
// network. Prints what went wrong and ends with status 1, or ends with 0. With CAMBER_PICTURES=FOLDER the pictures of
// docs/guide/workbench.md are taken into that folder.
import { createRequire } from 'node:module';
import { existsSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const [packages, check, url, folder, file] = process.argv.slice(2);
const { chromium } = createRequire(join(packages, 'package.json'))('playwright-core');
const executablePath = ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find(existsSync);
const pictures = process.env.CAMBER_PICTURES;

const problems = [];
function expect(condition, sentence) {
  if (!condition) problems.push(sentence);
}

// Until the picture of the path, if there is one, has been drawn and shown. Of a frame too.
const painted = page => page.evaluate(async () => {
  do { for (let k = 0; k < 2; k++) await new Promise(requestAnimationFrame); } while (window.camberScene?.asked);
});
const picture = async (page, name) => { if (pictures) { await painted(page); await page.screenshot({ path: join(pictures, name) }); } };
const ready = page => page.waitForFunction(() => document.documentElement.dataset.ready === 'all');
// Until everything that the page has been told is written, checked and shown: the page counts it before an event's handler ends.
const settled = page => page.waitForFunction(() => document.documentElement.dataset.busy === '0', null, { timeout: 300000 });
const tab = (page, name) => page.click(`nav [data-tab=${name}]`);
// act makes the page load anew.
async function reloaded(page, act) {
  await page.evaluate(() => { window.isOld = true; });
  await act();
  await page.waitForFunction(() => !window.isOld && document.documentElement.dataset.ready === 'all');
  await settled(page);
}

// How many pixels of the path's picture have each colour that is neither grey nor the background's.
const hues = page => page.evaluate(() => {
  const canvas = document.querySelector('#scene canvas'), gl = canvas.getContext('webgl2');
  const { drawingBufferWidth: w, drawingBufferHeight: h } = gl, px = new Uint8Array(4 * w * h), count = {};
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, px);
  for (let i = 0; i < px.length; i += 4) {
    if (Math.max(px[i], px[i + 1], px[i + 2]) - Math.min(px[i], px[i + 1], px[i + 2]) < 60) continue;
    const colour = `${px[i] >> 4},${px[i + 1] >> 4},${px[i + 2] >> 4}`;
    count[colour] = (count[colour] || 0) + 1;
  }
  return count;
});
const drawn = async page => Object.values(await hues(page)).reduce((a, b) => a + b, 0);

// Drops a file on the page as the desktop would.
async function drop(page, name, bytes) {
  const data = await page.evaluateHandle(({ name, text }) => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([Uint8Array.from(text, c => c.charCodeAt(0))], name));
    return transfer;
  }, { name, text: bytes.toString('latin1') });
  await page.dispatchEvent('body', 'drop', { dataTransfer: data });
  await settled(page);
}

async function run(page, command, options = {}) {
  await tab(page, 'run');
  await page.locator('.runs select').first().selectOption(command);
  for (const [name, value] of Object.entries(options)) {
    const input = page.locator(`[data-option="${name}"]`);
    if (value === true) await input.check();
    else await input.fill(value);
  }
  const before = await page.locator('.run').count();
  await page.click('#start');
  await page.waitForFunction(n => document.querySelectorAll('.run').length > n, before);
}
// Until `count` runs have ended and their results are shown.
async function over(page, count = 1) {
  await page.waitForFunction(n => {
    const states = document.documentElement.dataset.runs?.split(' ') ?? [];
    return states.length >= n && !states.some(s => ['', 'queued', 'running'].includes(s));
  }, count, { timeout: 900000 });
  await settled(page);
}

// The frame with the report of a run of this command, once it has drawn itself: an iframe is in the page before it has its address.
async function shownReport(page, command) {
  const find = () => page.frames().find(f => f.url().includes(`/${command}/report.html`));
  for (let k = 0; k < 1200 && !find(); k++) await page.waitForTimeout(50);
  expect(find(), `no report of ${command} is shown`);
  await find().waitForFunction(() => document.documentElement.dataset.ready === 'yes');
  return find();
}

async function setField(page, path, value) {
  await page.locator(`[data-path="${path}"]`).fill(value);
  await settled(page);
}

const job = name => readFileSync(join(folder, name, 'job.toml'), 'utf8');
const extents = (page, name) => page.evaluate(n => { const e = window.camberScene.extents[n]; return e && [...e.low, ...e.high]; }, name);
const near = (a, b, within) => a?.length === b.length && a.every((v, k) => Math.abs(v - b[k]) <= within);

// Of the controls above the picture; they must not take its height.
async function inOneRow(page) {
  const middles = await page.locator('#scene-bar > *:visible').evaluateAll(all => all.map(e => e.getBoundingClientRect()).filter(b => b.width).map(b => b.top + b.height / 2));
  expect(Math.max(...middles) - Math.min(...middles) < 8, `the controls stand in several rows: ${middles}`);
}

// Nothing is cut off at the right.
async function fits(page, where) {
  const beyond = await page.locator('main').evaluate(e => e.scrollWidth - e.clientWidth);
  expect(beyond <= 0, `${where}: the page is ${beyond} pixels too wide`);
}

// Whether the picture has changed when the box of this label is switched off; it is switched on again.
async function hides(page, label) {
  const box = page.locator('#scene-bar label', { hasText: label }).locator('input[type=checkbox]').first(), shot = async () => { await painted(page); return page.locator('#scene canvas').screenshot(); };
  const before = await shot();
  await box.uncheck();
  const without = await shot();
  await box.check();
  expect(before.equals(await shot()), `the picture is another one once ${label} is shown again`);
  return !before.equals(without);
}

// Its cycle needs the radius of the tool, which the job alone knows.
const POCKET = `0 BEGIN PGM K MM
1 BLK FORM 0.1 Z X-20 Y-20 Z-10
2 BLK FORM 0.2 X20 Y20 Z0
3 TOOL CALL 2 Z S3000
4 L Z20 R0 FMAX M3
5 CYCL DEF 5.0 KREISTASCHE
6 CYCL DEF 5.1 ABST2
7 CYCL DEF 5.2 TIEFE-4
8 CYCL DEF 5.3 ZUSTLG2 F100
9 CYCL DEF 5.4 RADIUS12
10 CYCL DEF 5.5 F300 DR+
11 L X0 Y0 FMAX M99
12 L Z20 FMAX M30 ; Gru\xdf
13 END PGM K MM
`;

const SOURCES = join(dirname(fileURLToPath(import.meta.url)), '../../ui/page/src');
const TEXTS = import('data:text/javascript,' + encodeURIComponent(readFileSync(join(SOURCES, 'texts.js'), 'utf8')));
const SAME_IN_GERMAN = ['tab_text'];
// Names of keys, values, programs, and what commands say.
const OF_COMMANDS = '.lines, .messages li, .drawings figure, .key, .source, .field .note, .field option, .unit, .comparison b, .tools th, .tools option, .material, .files, .result table, .result a, .job b, .head, #text, .progress, h2, code, #files-beside li, #files-beside option';

// What the page shows in words that are not of the table of texts, whose German ones stand between brackets.
const untranslated = page => page.evaluate(skipped => {
  const out = [], word = /\p{L}{3}/u, names = ['Camber', 'job.toml', 'English', 'Deutsch', 'inch'];
  const look = (element, words) => {
    const shown = element.closest('select') ?? element;
    if (shown.offsetParent && word.test(words) && !words.includes('\u27e6') && !names.includes(words.trim()) && !element.closest(skipped)) out.push(words.trim());
  };
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) look(walker.currentNode.parentElement, walker.currentNode.data);
  for (const element of document.body.querySelectorAll('[aria-label], [title]'))
    if (!element.dataset.path) for (const name of ['aria-label', 'title']) look(element, element.getAttribute(name) ?? '');
  return out;
}, OF_COMMANDS);

const CHECKS = {
  // From an empty folder and a dropped program to a downloaded compensated one.
  async whole_way(page) {
    expect(/Drop an NC program/.test(await page.locator('main').innerText()), 'an empty folder does not say what to do');
    await picture(page, 'workbench-empty.png');
    await drop(page, 'ball.nc', readFileSync(file));
    expect(existsSync(join(folder, 'ball/job.toml')), 'no job was made');
    expect(readFileSync(join(folder, 'ball/ball.nc')).equals(readFileSync(file)), 'the program arrived with other bytes');
    await painted(page);
    expect(await drawn(page) > 3000, `the path has ${await drawn(page)} pixels`);
    await picture(page, 'workbench-path.png');

    await tab(page, 'setup');
    expect(/guessed/.test(await page.locator('#guesses').innerText()), 'nothing is marked as guessed');
    expect(await page.locator('.drawings figure svg polygon.cutter').count() >= 1, 'no drawing of the tool');
    expect(await page.locator('.material table tr').count() >= 2, 'no range of the coefficients');
    const source = page.locator('.field', { has: page.locator('[data-path="stock|box_mm"]') });
    expect(/Its top/.test(await source.innerText()), 'the blank does not say where it comes from');
    await picture(page, 'workbench-setup.png');
    // What finishing needs: an allowance instead of a full blank; and, for a test, coarse cells and few rounds.
    await setField(page, 'stock|allowance_mm', '0.1');
    await setField(page, 'simulation|voxel_mm', '0.6');
    const guesses = Number((await page.locator('#guesses').innerText()).match(/\d+/)[0]);
    await page.getByRole('button', { name: 'Confirm tool.3 flutes', exact: true }).click();
    await settled(page);
    expect(Number((await page.locator('#guesses').innerText()).match(/\d+/)[0]) === guesses - 1, 'a confirmed value is still marked');
    await tab(page, 'text');
    const text = page.locator('#text');
    await text.fill((await text.inputValue()).replace('[compensation]\n', '[compensation]\nmax_rounds = 1\nlevers = ["shift"]\n').replace('[simulation]\n', '[simulation]\ncoupling = "rigid"\n'));
    await page.getByRole('button', { name: 'Save', exact: true }).click();
    await settled(page);
    const job = readFileSync(join(folder, 'ball/job.toml'), 'utf8');
    for (const line of ['\nallowance_mm = 0.1\n', 'voxel_mm = 0.6 ', 'max_rounds = 1\n', 'coupling = "rigid"\n', 'flutes = 2\n'])
      expect(job.includes(line), `job.toml lacks "${line.trim()}":\n${job}`);

    await run(page, 'compensate', { 'keep-anyway': true });
    await page.waitForSelector('.run.running progress', { timeout: 60000 });
    await picture(page, 'workbench-run.png');
    // Who closes the tab and comes back finds the run.
    await page.goto('about:blank');
    await page.goto(url.replace(/\?.*/, ''));
    await ready(page);
    await over(page);
    await tab(page, 'results');
    const report = await shownReport(page, 'compensate');
    expect(await report.locator('#scene canvas').count() === 1, 'the report has no error map');
    await report.locator('#scene').scrollIntoViewIfNeeded();
    await picture(page, 'workbench-results.png');
    const [download] = await Promise.all([page.waitForEvent('download'), page.click('.results a.download')]);
    await download.saveAs(join(folder, 'downloaded.nc'));
    expect(download.suggestedFilename() === 'ball_compensated.nc', `the download is called ${download.suggestedFilename()}`);

    await tab(page, 'compare');
    await settled(page);
    expect(/[1-9]\d* places differ/.test(await page.locator('#changed').innerText()), 'no difference is shown');
    await page.getByRole('button', { name: 'Next', exact: true }).click();
    expect(await page.locator('.comparison .row.changed.selected').count() >= 1, 'Next selects no changed line');
    await picture(page, 'workbench-compare.png');
  },

  // Lines and moves lead to each other; colours; messages at their lines; keys. FILE: a program with a warning.
  async path(page) {
    await painted(page);
    const kinds = await hues(page);
    expect(Object.keys(kinds).length >= 2, `rapid and cutting have the colours ${JSON.stringify(kinds)}`);
    await page.locator('.row[data-line="9"]').click();
    await painted(page);
    expect(await page.locator('#scene .marker').isVisible(), 'a click on a line marks no move');
    const at = await page.locator('#scene .marker').boundingBox(), box = await page.locator('#scene canvas').boundingBox();
    await page.locator('.row[data-line="1"]').click();
    await page.mouse.click(at.x + at.width / 2, at.y + at.height / 2);
    const selected = Number(await page.locator('.row.selected').getAttribute('data-line'));
    expect(selected === 9 || selected === 10, `a click on the end of line 9 selects line ${selected}`);
    expect(box.width > 400, 'the picture is small');
    await page.locator('#scene-bar select').first().selectOption('feed');
    await painted(page);
    expect(/mm\/min/.test(await page.locator('#legend').innerText()), 'feeds have no scale');
    await page.locator('#scene-bar select').first().selectOption('tool');
    expect(/T1/.test(await page.locator('#legend').innerText()), 'tools have no key');
    await page.keyboard.press('Escape');
    await page.locator('#scene canvas').focus();
    await page.keyboard.press('2');
    expect(await page.locator('.setup').isVisible(), 'the key 2 does not open the set-up');
    await page.locator('nav [data-tab=setup]').focus();
    await page.keyboard.press('ArrowLeft');
    expect(await page.locator('.path').isVisible(), 'the left arrow key does not open the tab at the left');
    const asked = async answer => { page.once('dialog', d => d.accept(answer)); await page.keyboard.press('/'); return page.locator('.row.selected').getAttribute('data-line'); };
    expect(await asked('8') === '8', 'no line is found by its number');
    expect(await asked('x12') === '10', 'no line is found by its text');
    expect(!await page.getByLabel('part', { exact: true }).isVisible(), 'a part is offered where there is none');
    expect(await page.getByLabel('blank', { exact: true }).isVisible(), 'the blank cannot be hidden');
  },

  // A job whose value is wrong: its message leads to the setting.
  async wrong_job(page) {
    await page.locator('#messages .error').first().press('Enter');
    expect(await page.evaluate(() => document.activeElement.dataset.path) === 'tool.1|flutes', 'the message does not lead to its setting');
  },

  // A program that the job alone can draw, in letters of Windows.
  async pocket(page) {
    await drop(page, 'k.h', Buffer.from(POCKET, 'latin1'));
    await painted(page);
    expect(await drawn(page) > 300, 'the path is not drawn');
    expect(/Gru\xdf/.test(await page.locator('.row[data-line="13"]').innerText()), 'letters of Windows are not read');
  },

  // FOLDER/wall has a job: nothing of it is shown with the program that no job can be made of.
  async wrong_program(page) {
    await painted(page);
    expect(await drawn(page) > 300, 'the path of the job is not drawn');
    await drop(page, 'bad.nc', Buffer.from('G21 G90\nT1 M6\nS100 M3\nG0 X0 Y0 Z0\nG1 X1 F0\n'));
    await painted(page);
    expect(await drawn(page) === 0, 'the path of the job before is shown');
    expect(await page.locator('nav button:disabled').count() === 5, 'the job before can be set up and run');
    expect(await page.locator('.job[aria-current=true]').count() === 0, 'the job before is marked');
    expect(await page.locator('.row.error[data-line="5"]').count() === 1, 'the error does not stand at its line');
    expect(/the feed must be greater than zero/.test(await page.locator('#messages').innerText()), 'the message is missing');
    await page.locator('#messages .error').first().click();
    expect(await page.locator('.row.selected').getAttribute('data-line') === '5', 'the message does not lead to its line');
    await page.locator('.job').first().click();
    await settled(page);
    await painted(page);
    expect(await drawn(page) > 300, 'the path of the job is not drawn again');
  },

  // What is typed is judged by the commands, and only what can be read is written.
  async typing(page) {
    await tab(page, 'setup');
    const before = readFileSync(join(folder, 'wall/job.toml'), 'utf8');
    await setField(page, 'tool.1|flutes', '0');
    expect(/a whole number from 1 to 100/.test(await page.locator('tr[data-tool="1"]').innerText()), 'a wrong value is not explained at its field');
    expect(readFileSync(join(folder, 'wall/job.toml'), 'utf8') === before, 'a wrong value was written');
    await setField(page, 'tool.1|flutes', '3');
    expect(readFileSync(join(folder, 'wall/job.toml'), 'utf8') === before.replace('flutes = 2', 'flutes = 3'), 'more than the value has changed');
    // Who types on while the answer comes.
    let answered = 0;
    const slowly = async route => { await new Promise(done => setTimeout(done, 700)); await route.continue(); answered++; };
    await page.route('**/api/edit*', slowly);
    const overhang = page.locator('[data-path="tool.1|overhang_mm"]');
    const asked = page.waitForRequest(/api.edit/), answer = page.waitForResponse(/api.edit/);
    await overhang.fill('3');
    await asked;
    await page.keyboard.type('1');
    await answer;
    await page.keyboard.type('.5');
    await settled(page);
    await page.unroute('**/api/edit*', slowly);
    expect(answered >= 2 && await overhang.inputValue() === '31.5' && job('wall').includes('overhang_mm = 31.5\n'), `31.5 was typed, ${await overhang.inputValue()} is shown`);
    await setField(page, 'tool.1|overhang_mm', '30.0');
    await reloaded(page, () => page.getByLabel('Lengths').selectOption('inch'));
    expect(await page.locator('.setup').isVisible(), 'another unit leads to another tab');
    expect(await page.locator('[data-path="tool.1|overhang_mm"]').inputValue() === '1.181102', `30 mm are ${await page.locator('[data-path="tool.1|overhang_mm"]').inputValue()} in`);
    await setField(page, 'tool.1|overhang_mm', '1');
    expect(readFileSync(join(folder, 'wall/job.toml'), 'utf8').includes('overhang_mm = 25.4\n'), '1 in was not written as 25.4');
    await reloaded(page, () => page.getByLabel('Language').selectOption('de'));
    expect(/Einrichten/.test(await page.locator('nav').innerText()), 'there is no German');
    await page.getByLabel('Farben').selectOption('dark');
    const dark = await page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).map(Number));
    expect(Math.max(...dark) < 60, `dark is ${dark}`);
    await picture(page, 'workbench-dark.png');
  },

  // The part stands where the job says, and is moved by the pointer, by keys and by numbers.
  async part(page) {
    const place = () => /\nmove_mm = \[(.*)\]/.exec(job('wall'))?.[1].split(',').map(Number);
    const start = await extents(page, 'part');
    expect(near(start, [20, 0, -2, 28, 2, 0], 1e-4), `the part lies at ${start}`);
    expect(await hides(page, 'part'), 'the part is not in the picture');
    const moved = async act => {
      await act();
      await settled(page);
      const at = place() ?? [0, 0, 0], e = await extents(page, 'part');
      expect(near(e, start.map((v, k) => v + at[k % 3]), 1e-3), `the job moves the part by ${at}, the picture shows it at ${e}`);
      return at;
    };
    await page.locator('[data-view=top]').click();
    await page.locator('#mover').check();
    await painted(page);
    const canvas = await page.locator('#scene canvas').boundingBox();
    const { x, y, mm } = await page.evaluate(() => {
      const { camera, controls, box, extents: { part } } = window.camberScene, mm = (camera.right - camera.left) / camera.zoom / box.clientWidth;
      return { mm, x: box.clientWidth / 2 + ((part.low[0] + part.high[0]) / 2 - controls.target.x) / mm, y: box.clientHeight / 2 - ((part.low[1] + part.high[1]) / 2 - controls.target.y) / mm };
    });
    const dragged = await moved(async () => {
      await page.mouse.move(canvas.x + x, canvas.y + y);
      await page.mouse.down();
      await page.mouse.move(canvas.x + x - 100, canvas.y + y + 40, { steps: 5 });
      await page.mouse.up();
    });
    expect(near(dragged, [-100 * mm, -40 * mm, 0], 0.02), `100 pixels of ${mm} mm to the left and 40 down moved the part by ${dragged}`);
    await picture(page, 'workbench-part.png');
    await page.locator('#scene canvas').focus();
    const stepped = await moved(async () => { for (const key of ['ArrowRight', 'Shift+ArrowUp', 'Alt+PageDown']) await page.keyboard.press(key); });
    expect(near(stepped, [dragged[0] + 1, dragged[1] + 10, -0.1], 1e-6), `the keys moved the part from ${dragged} to ${stepped}`);
    for (const [axis, value] of Object.entries({ X: '-20', Y: '0', Z: '0' })) {
      await moved(() => page.locator(`[data-move=${axis}]`).fill(value));
    }
    expect(job('wall').includes('\nmove_mm = [-20, 0, 0]\n'), `the job has ${place()}`);
    expect(near(await extents(page, 'part'), [0, 0, -2, 8, 2, 0], 1e-4), 'the part is not in its place');
    await page.locator('#mover').uncheck();
    const rest = place();
    await page.mouse.move(canvas.x + x, canvas.y + y);
    await page.mouse.down();
    await page.mouse.move(canvas.x + x + 50, canvas.y + y);
    await page.mouse.up();
    await settled(page);
    expect(near(place(), rest, 0), 'the pointer moves the part without being asked to');
  },

  // Blanks that are no box. FOLDER/left/r/stock.vdb is what a job has left of the wall's box.
  async blanks(page) {
    const where = { left: [0, -0.5, -2, 8, 2, 0], mesh: [0, -0.5, -2, 8, 2, 0], round: [-2, -3, -2, 10, 9, 0] };
    for (const [name, box] of Object.entries(where)) {
      await page.locator(`.job[data-job="${name}/job.toml"]`).click();
      await settled(page);
      const e = await extents(page, 'blank');
      expect(near(e, box, 0.21), `the blank of ${name} lies at ${e}`);
      expect(await hides(page, 'blank'), `the blank of ${name} is not in the picture`);
    }
  },

  // FILE: the program that FOLDER/dome/p.nc was posted from: its X, Y and Z are the tip on the part.
  async rotary(page) {
    expect(/tip on the part/.test(await page.locator('#legend').innerText()), 'it is not said that the tip is drawn');
    const places = await page.evaluate(() => Array.from(window.camberScene.place)), wanted = [];
    const now = { X: NaN, Y: NaN, Z: NaN };
    for (const line of readFileSync(file, 'latin1').split('\n')) {
      if (/G10|G54|G53/.test(line) || !/[XYZ]-?\d/.test(line)) continue;
      for (const [, axis, value] of line.matchAll(/([XYZ])(-?[\d.]+)/g)) now[axis] = Number(value);
      if (/G1 |^X/.test(line)) wanted.push(Object.values(now));
    }
    expect(wanted.length > 300, `${wanted.length} places`);
    const farthest = Math.max(...wanted.map(w => {
      let least = Infinity;
      for (let i = 0; i < places.length; i += 3) least = Math.min(least, Math.hypot(places[i] - w[0], places[i + 1] - w[1], places[i + 2] - w[2]));
      return least;
    }));
    expect(farthest < 0.01, `a place of the tip is ${farthest} mm from the picture's path`);
  },

  // Points of FOLDER/wall/points.csv over the error map of a compensation.
  async measured(page) {
    const rows = readFileSync(join(folder, 'wall/points.csv'), 'utf8').trim().split('\n').slice(1).map(l => l.split(',').map(Number));
    await tab(page, 'run');
    await page.locator('.runs select').first().selectOption('compensate');
    await page.locator('[data-option=measured]').selectOption('wall/points.csv');
    await page.locator('[data-option=keep-anyway]').check();
    await page.click('#start');
    await over(page);
    await tab(page, 'results');
    const report = await shownReport(page, 'compensate');
    const scene = report.locator('#scene'), canvas = scene.locator('canvas');
    await scene.scrollIntoViewIfNeeded();
    await painted(report);
    const { x, y, width, height } = await canvas.boundingBox(), with_points = await canvas.screenshot();
    let said = '';
    for (let k = 0; k < 900 && !/measured/.test(said); k++) {
      await page.mouse.move(x + width * (k % 45 + 0.5) / 45, y + height * (Math.floor(k / 45) + 0.5) / 20);
      await painted(report);
      said = await report.locator('.tip').innerText();
    }
    const value = Number(/measured ([+\u2212-]?[\d.]+) \u00b5m/.exec(said)?.[1].replace('\u2212', '-'));
    const at = [...said.matchAll(/[XYZ](\u2212|-)?([\d.]+)/g)].slice(0, 3).map(m => Number((m[1] ? '-' : '') + m[2]));
    expect(rows.some(r => near(at, r.slice(0, 3), 2e-3) && Math.abs(r[6] - value) < 0.02), `no row of the file says "${said}"`);
    expect(/predicted/.test(said), `the prediction beside it is missing: "${said}"`);
    await picture(page, 'workbench-measured.png');
    await page.mouse.move(5, 5);
    await report.locator('#part-controls').getByText('Hidden').first().click();
    await painted(report);
    expect(!with_points.equals(await canvas.screenshot()), 'measured points are not in the picture');
  },

  // Both languages have every text, each of them is used, and the page shows no other words. FOLDER/wall has two tools
  // and a part.
  async german(page) {
    const { TABLES: { en, de } } = await TEXTS, sources = readdirSync(SOURCES).filter(f => f.endsWith('.js')).map(f => readFileSync(join(SOURCES, f), 'utf8')).join('\n');
    const prefixes = [...sources.matchAll(/text\('(\w+_)' \+/g)].map(m => m[1]), values = words => (words.match(/\{\d\}/g) ?? []).sort().join();
    for (const [, key] of sources.matchAll(/\btext\('([\w-]+)'[,)]/g)) expect(key in en, `the page asks for the text ${key}, which is not there`);
    for (const key of Object.keys(de)) expect(key in en, `${key} has no English text`);
    for (const key of Object.keys(en)) {
      const english = en[key], german = de[key] ?? (SAME_IN_GERMAN.includes(key) ? english : undefined);
      expect(german !== undefined, `${key} has no German text`);
      expect(german !== english || SAME_IN_GERMAN.includes(key), `${key} is "${english}" in German too`);
      expect(values(german ?? english) === values(english), `${key} has other values in German`);
      expect(prefixes.some(p => key.startsWith(p)) || sources.replace(`  ${key}: '`, '').includes(`'${key}'`), `no text ${key} is asked for`);
    }
    await page.route('**/page/workbench.js', async route => {
      let script = await (await route.fetch()).text();
      for (const words of new Set(Object.values(de))) script = ['"', "'", '`'].reduce((s, q) => s.replaceAll(q + words + q, `${q}\u27e6${words}\u27e7${q}`), script);
      await route.fulfill({ body: script, contentType: 'text/javascript' });
    });
    await reloaded(page, () => page.getByLabel('Language').selectOption('de'));
    await page.unroute('**/page/workbench.js');
    const look = async where => {
      await fits(page, where);
      for (const words of await untranslated(page)) expect(false, `${where}: "${words}" is in no language's table`);
    };
    expect(/\u27e6Einrichten\u27e7/.test(await page.locator('nav').innerText()), 'the German texts are not marked');
    for (const name of ['path', 'setup', 'run', 'results', 'compare', 'text']) { await tab(page, name); await settled(page); await look(name); }
    await run(page, 'compensate', { 'keep-anyway': true });
    await over(page);
    for (const name of ['run', 'results', 'compare']) { await tab(page, name); await settled(page); await look(`${name}, after a run`); }
    await tab(page, 'path');
    await reloaded(page, () => page.reload());
    for (const name of ['Werkzeug', 'Fertigteil', 'Rohteil']) expect(await page.locator('#scene-bar').getByLabel(name, { exact: true }).isVisible(), `${name} is not offered`);
    await inOneRow(page);
  },

  // Several jobs: all run, two results side by side; the job that was clicked last is shown.
  async shop(page) {
    await page.route('**/api/job?job=b*', async route => { await new Promise(done => setTimeout(done, 500)); await route.continue(); });
    for (const name of ['b', 'c', 'b', 'a']) await page.locator(`.job[data-job="${name}/job.toml"]`).click();
    await settled(page);
    expect(/^a.job/.test(await page.locator('.head').innerText()), `a was clicked last, ${await page.locator('.head').innerText()} is shown`);
    expect(await page.locator('.job').count() === 3, `${await page.locator('.job').count()} jobs`);
    await page.getByLabel('Run all').selectOption('time');
    await over(page, 3);
    expect(await page.locator('.job .state.done').count() === 3, 'not all jobs are done');
    await run(page, 'predict');
    await over(page, 4);
    await page.locator('.run').first().getByRole('button', { name: 'Results' }).click();
    await page.getByLabel('Beside it').selectOption('time');
    await page.waitForFunction(() => document.querySelectorAll('iframe.report').length === 2);
    expect(/µm/.test(await page.locator('.job[aria-current=true] .figures').innerText()), 'the job does not show its error');
    for (const name of ['predict', 'time']) await painted(await shownReport(page, name));
    await fits(page, 'two results');
    await picture(page, 'workbench-shop.png');
  },

  // FILE: a program of a million blocks. How quickly it is shown and turned is printed.
  async large(page, begun) {
    await page.waitForFunction(() => document.documentElement.dataset.shown, null, { timeout: 60000 });
    await painted(page);
    const shown_s = (Date.now() - begun) / 1000, rows = await page.evaluate(() => document.querySelectorAll('.row').length);
    expect(rows > 10 && rows < 200, `${rows} rows are elements`);
    expect(await drawn(page) > 3000, 'the path is blank');
    const frames_per_s = await page.evaluate(async () => {
      const scene = window.camberScene, begin = performance.now(), first = scene.frames;
      while (performance.now() - begin < 3000) {
        scene.controls._rotateLeft(0.02);
        scene.controls.update();
        await new Promise(requestAnimationFrame);
      }
      return (scene.frames - first) / 3;
    });
    const session = await browser.newBrowserCDPSession(), { processInfo } = await session.send('SystemInfo.getProcessInfo');
    // Of the process that has the page: everything, buffers of the picture included.
    const memory = processInfo.filter(p => p.type === 'renderer').map(p => Number(/VmHWM:\s+(\d+)/.exec(readFileSync(`/proc/${p.id}/status`, 'utf8'))[1]) / 1000);
    writeFileSync(join(folder, 'large.json'), JSON.stringify({ shown_s, frames_per_s, page_MB: Math.max(...memory) }));
  },

  // Until something is seen, and until everything is there.
  // Measured by bench/ui/run.
  async first_paint(page) {
    // In a browser that runs already: its own start is not the page's.
    await reloaded(page, () => page.reload());
    await page.waitForFunction(() => performance.getEntriesByName('first-contentful-paint').length);
    const paint_ms = await page.evaluate(() => performance.getEntriesByName('first-contentful-paint')[0].startTime);
    writeFileSync(join(folder, 'paint.json'), JSON.stringify({ paint_ms }));
  },
};

const browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--enable-precise-memory-info'] });
try {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, locale: 'en-GB', acceptDownloads: true });
  const page = await context.newPage();
  page.setDefaultTimeout(60000);
  page.on('console', m => { if (m.type() === 'error') problems.push(`console: ${m.text()}`); });
  page.on('pageerror', e => problems.push(`error on the page: ${e.message}`));
  page.on('request', r => { if (!r.url().startsWith(new URL(url).origin) && !/^(blob|data|about):/.test(r.url())) problems.push(`asks for ${r.url()}`); });
  const begun = Date.now();
  await page.goto(url);
  if (check !== 'large') { await ready(page); await settled(page); }
  expect(!page.url().includes('token'), `the token stays in the address: ${page.url()}`);
  expect(await page.evaluate(() => document.cookie) === '', 'scripts see the cookie');
  await CHECKS[check](page, begun);
} catch (e) {
  problems.push(e.message);
} finally {
  await browser.close();
}
for (const p of problems) console.log(p);
process.exit(problems.length ? 1 : 0);
