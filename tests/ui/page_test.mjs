// page_test.mjs PACKAGES CHECK URL [FOLDER] [FILE]: opens the workbench at URL in headless Chromium, without any other
// network. Prints what went wrong and ends with status 1, or ends with 0. With CAMBER_PICTURES=FOLDER the pictures of
// docs/guide/workbench.md are taken into that folder.
import { createRequire } from 'node:module';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const [packages, check, url, folder, file] = process.argv.slice(2);
const { chromium } = createRequire(join(packages, 'package.json'))('playwright-core');
const executablePath = ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find(existsSync);
const pictures = process.env.CAMBER_PICTURES;

const problems = [];
function expect(condition, sentence) {
  if (!condition) problems.push(sentence);
}

const painted = page => page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));
const picture = async (page, name) => { if (pictures) { await painted(page); await page.screenshot({ path: join(pictures, name) }); } };
const checks = page => page.evaluate(() => Number(document.documentElement.dataset.checked ?? 0));
const shown = page => page.waitForFunction(() => document.documentElement.dataset.shown, null, { timeout: 60000 });
const ready = page => page.waitForFunction(() => document.documentElement.dataset.ready === 'all');
const tab = (page, name) => page.click(`nav [data-tab=${name}]`);

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
    transfer.items.add(new File([text], name));
    return transfer;
  }, { name, text: bytes.toString('latin1') });
  await page.dispatchEvent('body', 'drop', { dataTransfer: data });
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
const over = (page, timeout = 240000) => page.waitForFunction(() => {
  const states = document.documentElement.dataset.runs?.split(' ') ?? [];
  return states.length && !states.some(s => s === 'queued' || s === 'running');
}, null, { timeout });

async function setField(page, path, value) {
  const before = await checks(page);
  await page.locator(`[data-path="${path}"]`).fill(value);
  await page.waitForFunction(n => Number(document.documentElement.dataset.checked) > n, before, { timeout: 60000 });
}

const CHECKS = {
  // From an empty folder and a dropped program to a downloaded compensated one.
  async whole_way(page) {
    expect(/Drop an NC program/.test(await page.locator('main').innerText()), 'an empty folder does not say what to do');
    await picture(page, 'workbench-empty.png');
    await drop(page, 'ball.nc', readFileSync(file));
    await page.waitForFunction(() => document.documentElement.dataset.checked === '1', null, { timeout: 60000 });
    await shown(page);
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
    const before = await checks(page);
    await page.getByRole('button', { name: 'Confirm tool.3 flutes', exact: true }).click();
    await page.waitForFunction(n => Number(document.documentElement.dataset.checked) > n, before, { timeout: 60000 });
    expect(Number((await page.locator('#guesses').innerText()).match(/\d+/)[0]) === guesses - 1, 'a confirmed value is still marked');
    await tab(page, 'text');
    const text = page.locator('#text');
    await text.fill((await text.inputValue()).replace('[compensation]\n', '[compensation]\nmax_rounds = 1\n').replace('[simulation]\n', '[simulation]\ncoupling = "rigid"\n'));
    await page.getByRole('button', { name: 'Save', exact: true }).click();
    await page.waitForFunction(n => Number(document.documentElement.dataset.checked) > n, before + 1, { timeout: 60000 });
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
    await page.waitForFunction(() => document.documentElement.dataset.runs);
    await over(page);
    await tab(page, 'results');
    await page.waitForSelector('iframe.report');
    const report = page.frames().find(f => /report\.html/.test(f.url()));
    await report.waitForFunction(() => document.documentElement.dataset.ready === 'yes');
    expect(await report.locator('#scene canvas').count() === 1, 'the report has no error map');
    await report.locator('#scene').scrollIntoViewIfNeeded();
    await picture(page, 'workbench-results.png');
    const [download] = await Promise.all([page.waitForEvent('download'), page.click('.results a.download')]);
    await download.saveAs(join(folder, 'downloaded.nc'));
    expect(download.suggestedFilename() === 'ball_compensated.nc', `the download is called ${download.suggestedFilename()}`);

    await tab(page, 'compare');
    await page.waitForSelector('#changed');
    expect(/[1-9]\d* places differ/.test(await page.locator('#changed').innerText()), 'no difference is shown');
    await page.getByRole('button', { name: 'Next', exact: true }).click();
    expect(await page.locator('.comparison .row.changed.selected').count() >= 1, 'Next selects no changed line');
    await picture(page, 'workbench-compare.png');
  },

  // Lines and moves lead to each other; colours; messages at their lines; keys. FILE: a program with a warning.
  async path(page) {
    await page.waitForFunction(() => document.documentElement.dataset.checked === '1');
    await shown(page);
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
  },

  async wrong_program(page) {
    await drop(page, 'bad.nc', Buffer.from('G21 G90\nT1 M6\nS100 M3\nG0 X0 Y0 Z0\nG1 X1 F0\n'));
    await page.waitForFunction(() => document.documentElement.dataset.checked === '1');
    await shown(page);
    expect(await page.locator('.row.error[data-line="5"]').count() === 1, 'the error does not stand at its line');
    expect(/the feed must be greater than zero/.test(await page.locator('#messages').innerText()), 'the message is missing');
    await page.locator('#messages .error').first().click();
    expect(await page.locator('.row.selected').getAttribute('data-line') === '5', 'the message does not lead to its line');
  },

  // What is typed is judged by the commands, and only what can be read is written.
  async typing(page) {
    await page.waitForFunction(() => document.documentElement.dataset.checked === '1');
    await tab(page, 'setup');
    const before = readFileSync(join(folder, 'wall/job.toml'), 'utf8');
    await page.locator('[data-path="tool.1|flutes"]').fill('0');
    await page.waitForFunction(() => /a whole number from 1 to 100/.test(document.body.innerText));
    expect(readFileSync(join(folder, 'wall/job.toml'), 'utf8') === before, 'a wrong value was written');
    await setField(page, 'tool.1|flutes', '3');
    expect(readFileSync(join(folder, 'wall/job.toml'), 'utf8') === before.replace('flutes = 2', 'flutes = 3'), 'more than the value has changed');
    await page.getByLabel('Lengths').selectOption('inch');
    await page.waitForLoadState();
    await ready(page);
    await tab(page, 'setup');
    expect(await page.locator('[data-path="tool.1|overhang_mm"]').inputValue() === '1.181102', `30 mm are ${await page.locator('[data-path="tool.1|overhang_mm"]').inputValue()} in`);
    await setField(page, 'tool.1|overhang_mm', '1');
    expect(readFileSync(join(folder, 'wall/job.toml'), 'utf8').includes('overhang_mm = 25.4\n'), '1 in was not written as 25.4');
    await page.getByLabel('Language').selectOption('de');
    await page.waitForLoadState();
    await ready(page);
    expect(/Einrichten/.test(await page.locator('nav').innerText()), 'there is no German');
    await page.getByLabel('Farben').selectOption('dark');
    const dark = await page.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).map(Number));
    expect(Math.max(...dark) < 60, `dark is ${dark}`);
    await picture(page, 'workbench-dark.png');
  },

  // Several jobs: all run, two results side by side, one cancelled.
  async shop(page) {
    await page.waitForFunction(() => document.documentElement.dataset.checked === '1');
    expect(await page.locator('.job').count() === 3, `${await page.locator('.job').count()} jobs`);
    await page.getByLabel('Run all').selectOption('time');
    await page.waitForFunction(() => document.documentElement.dataset.runs?.split(' ').length === 3);
    await over(page);
    const done = () => document.querySelectorAll('.job .state.done').length === 3;
    expect(await page.waitForFunction(done, null, { timeout: 20000 }).then(() => true, () => false), 'not all jobs are done');
    await run(page, 'predict');
    await page.waitForFunction(() => document.documentElement.dataset.runs.split(' ').length === 4);
    await over(page);
    await page.locator('.run').first().getByRole('button', { name: 'Results' }).click();
    await page.getByLabel('Beside it').selectOption('time');
    await page.waitForFunction(() => document.querySelectorAll('iframe.report').length === 2);
    await page.waitForFunction(() => /µm/.test(document.querySelector('.job[aria-current=true] .figures').textContent));
    for (const name of ['predict', 'time']) {
      const find = () => page.frames().find(f => f.url().includes(`/${name}/report.html`));
      for (let k = 0; k < 100 && !find(); k++) await page.waitForTimeout(50);
      const frame = find();
      await frame.waitForFunction(() => document.documentElement.dataset.ready === 'yes');
    }
    await picture(page, 'workbench-shop.png');
  },

  // FILE: a program of a million blocks. How quickly it is shown and turned is printed.
  async large(page, begun) {
    await shown(page);
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
    await page.reload();
    await ready(page);
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
  if (check !== 'large') await ready(page);
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
