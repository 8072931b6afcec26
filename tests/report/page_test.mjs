// page_test.mjs PACKAGES CHECK PAGE [JSON]: opens a report page in headless Chromium, as a shop would without a network.
// Prints what went wrong and ends with status 1, or ends with 0.
import { createRequire } from 'node:module';
import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';

const [packages, check, file, json] = process.argv.slice(2);
const { chromium } = createRequire(join(packages, 'package.json'))('playwright-core');
const executablePath = ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find(existsSync);

const problems = [];
let opened_ms = 0;  // until the page is ready
function expect(condition, sentence) {
  if (!condition) problems.push(sentence);
}

// How many of the picture's pixels are not the background, and how many are red or blue.
const pixels = page => page.evaluate(() => {
  const canvas = document.querySelector('#scene canvas'), gl = canvas.getContext('webgl2');
  const { drawingBufferWidth: w, drawingBufferHeight: h } = gl, px = new Uint8Array(4 * w * h);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, px);
  const out = { drawn: 0, red: 0, blue: 0, all: w * h };
  for (let i = 0; i < px.length; i += 4) {
    const [r, g, b] = [px[i], px[i + 1], px[i + 2]];
    if (r !== px[0] || g !== px[1] || b !== px[2]) out.drawn++;
    if (r > b + 40) out.red++;
    if (b > r + 40) out.blue++;
  }
  return out;
});

// Share of the picture that has the colour of the stock.
const GREY = `(() => {
  const canvas = document.querySelector('#scene canvas'), gl = canvas.getContext('webgl2');
  const { drawingBufferWidth: w, drawingBufferHeight: h } = gl, px = new Uint8Array(4 * w * h);
  gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, px);
  let grey = 0;
  for (let i = 0; i < px.length; i += 4)
    if (px[i] > 100 && px[i] < 180 && px[i + 2] - px[i] > 8 && px[i + 2] - px[i] < 26 && px[i + 1] > px[i] && px[i + 1] < px[i + 2]) grey++;
  return grey / (w * h);
})()`;

// Every number that names its place in the JSON is the JSON's.
async function expectNumbersOfJson(page) {
  const figures = JSON.parse(readFileSync(json, 'utf8'));
  const shown = await page.$$eval('[data-key]', all => all.map(e => [e.dataset.key, e.textContent]));
  expect(shown.length >= 9, `only ${shown.length} numbers name their place`);
  for (const [key, text] of shown) {
    const value = key.split('.').reduce((at, name) => at?.[name], figures);
    const decimals = (text.split('.')[1] || '').length;
    const expected = typeof value === 'number' ? value.toFixed(decimals).replace(/^-(?=.*[1-9])/, '\u2212').replace(/^-/, '') : `nothing (${value})`;
    expect(text === expected, `${key} is ${text} on the page and ${expected} in the JSON`);
  }
}

// Of the path's canvas: how many pixels have the colour of lines and how many that of arcs.
const strokes = page => page.evaluate(() => {
  const canvas = document.querySelector('#scene canvas'), { width, height } = canvas;
  const px = canvas.getContext('2d').getImageData(0, 0, width, height).data, out = { drawn: 0, lines: 0, arcs: 0 };
  for (let i = 0; i < px.length; i += 4) {
    if (px[i + 3] < 128) continue;
    out.drawn++;
    if (px[i + 2] > px[i] + 60) out.lines++;
    if (px[i] > px[i + 2] + 60) out.arcs++;
  }
  return out;
});

// Colours of the canvas that many pixels have, greys left out.
const hues = page => page.evaluate(() => {
  const canvas = document.querySelector('#scene canvas'), { width, height } = canvas, count = new Map();
  const px = canvas.getContext('2d').getImageData(0, 0, width, height).data;
  for (let i = 0; i < px.length; i += 4) {
    if (px[i + 3] < 250 || Math.max(px[i], px[i + 1], px[i + 2]) - Math.min(px[i], px[i + 1], px[i + 2]) < 40) continue;
    const colour = px[i] << 16 | px[i + 1] << 8 | px[i + 2];
    count.set(colour, (count.get(colour) || 0) + 1);
  }
  return [...count.values()].filter(n => n > 20).length;
});

// How often lines are crossed down a column of the canvas, a third from the left, and how many pixels show the part.
const rowsDown = page => page.evaluate(() => {
  const canvas = document.querySelector('#scene canvas'), { width, height } = canvas, out = { lines: 0, part: 0 };
  const px = canvas.getContext('2d').getImageData(0, 0, width, height).data, column = Math.floor(width / 3);
  const isLine = i => px[i + 3] >= 100 && px[i + 2] > px[i] + 60;
  for (let i = 0; i < px.length; i += 4)
    if (px[i + 3] >= 128 && px[i] < 110 && px[i + 2] < 130) out.part++;
  for (let y = 1; y < height; y++)
    if (isLine(4 * (y * width + column)) && !isLine(4 * ((y - 1) * width + column))) out.lines++;
  return out;
});

const painted = page => page.evaluate(() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))));

const near = (a, b, by) => a.every((v, k) => Math.abs(v - b[k]) < by);

// Held still, the part is drawn in another place, and the tool along its axis in the part. numbers(name): of a data attribute.
async function expectTurningPart(page, axis, numbers) {
  const turned = await page.locator('#scene canvas').screenshot();
  await page.click('button[data-value=still]');
  await painted(page);
  expect(near(await numbers('shown'), axis, 1e-3), 'at rest the tool is not shown along its axis in the part');
  expect(!turned.equals(await page.locator('#scene canvas').screenshot()), 'the part does not turn');
  await page.click('button[data-value=turned]');
}

async function selected(page) {
  const box = page.locator('#selected');
  await box.locator('.facts').waitFor();
  return { line: await box.getAttribute('data-line'), text: await box.locator('.nc').textContent(), facts: await box.locator('.facts').textContent() };
}

const CHECKS = {
  // A page with both programs: pictures, switches, clicks both ways, the download.
  async compared(page) {
    const before = await pixels(page);
    expect(before.drawn > 0.05 * before.all, `the picture is blank: ${JSON.stringify(before)}`);
    expect(before.red > 0.02 * before.all && before.blue > 0.02 * before.all, `before is neither red nor blue: ${JSON.stringify(before)}`);
    await page.click('button[data-value=after]');
    const after = await pixels(page);
    expect(after.red + after.blue < 0.1 * (before.red + before.blue), `after is as coloured as before: ${JSON.stringify(after)}`);
    await page.click('button[data-value=before]');
    const slider = page.getByLabel('Place of the cut'), cutAt = share => slider.evaluate((e, v) => { e.value = v; e.dispatchEvent(new Event('input')); }, share);
    await page.getByLabel('Cut', { exact: true }).selectOption('0');
    await cutAt(0.25);
    const cut = await pixels(page);
    expect(cut.red + cut.blue < 0.5 * (before.red + before.blue) && cut.red + cut.blue > 0.05 * (before.red + before.blue), `of ${JSON.stringify(before)} a cut at a quarter leaves ${JSON.stringify(cut)}`);
    await cutAt(1);
    const uncut = await pixels(page);
    expect(Math.abs(uncut.red + uncut.blue - before.red - before.blue) < 0.05 * (before.red + before.blue), 'a cut at the end takes something away');
    await page.getByLabel('Cut', { exact: true }).selectOption('');
    await page.click('button[data-value=plain]');
    await page.getByLabel('Path').selectOption('force');
    const path = await pixels(page);
    expect(path.drawn > 0.05 * path.all, 'the path does not appear');
    await page.getByLabel('Path').selectOption('margin');
    expect((await page.locator('#legends').innerText()).startsWith('path: chatter margin\n0\n'), `the legend reads "${await page.locator('#legends').innerText()}"`);
    await page.click('button[data-value=before]');
    await page.getByLabel('Path').selectOption('');

    // The test's path spends a second on each line from line 3 on; plots run to the last second.
    const plot = page.locator('[data-quantity=feed] .u-over');
    const { width, height } = await plot.boundingBox();
    await plot.click({ position: { x: width * 10.5 / 30, y: height / 2 } });
    const chosen = await selected(page);
    expect(chosen.line === '13', `a click at 10.5 s selects line ${chosen.line}, not 13`);
    expect(chosen.text === 'line 13 before N13 G1 X10.', `the line reads "${chosen.text}"`);
    expect(/feed 600 of 900 mm\/min/.test(chosen.facts), `its facts are "${chosen.facts}"`);
    expect(/chatter margin 0\.30(?! ?[\d.])/.test(chosen.facts), `its facts are "${chosen.facts}"`);
    const heads = await page.locator('.plot-title').allInnerTexts();
    expect(heads.includes('depth over critical depth, above 1 chatter'), `the plots are "${heads}"`);
    expect(await page.locator('.marker').isVisible(), 'the place is not marked on the part');

    // Back from the part: its middle is at X15, where lines 17 and 18 meet.
    const scene = page.locator('#scene canvas');
    await page.getByRole('button', { name: 'Top', exact: true }).click();
    const box = await scene.boundingBox();
    await scene.hover({ position: { x: box.width / 2 + 3, y: box.height / 2 } });
    await page.locator('.tip').waitFor();
    const tip = await page.locator('.tip').textContent();
    expect(/^[+\u2212][\d.]+ \u00b5m before, .*\u00b5m after.*X15\.\d+.*line \d+:\s+N\d+ G1 X/.test(tip), `the cursor reads "${tip}"`);
    await scene.click({ position: { x: box.width / 2 + 3, y: box.height / 2 } });
    await page.waitForFunction(() => document.querySelector('#selected').dataset.line !== '13');
    const found = await selected(page);
    expect(['17', '18'].includes(found.line), `a click on the part selects line ${found.line}, not 17 or 18`);

    const [download] = await Promise.all([page.waitForEvent('download'), page.click('#download')]);
    expect(download.suggestedFilename() === 'out.nc', `the download is called ${download.suggestedFilename()}`);
    const text = readFileSync(await download.path(), 'utf8');
    expect(text.startsWith('%\r\nO1\r\n') && text.endsWith('N32 G1 X29.001\r\nM30\r\n%\r\n'), `the download holds ${JSON.stringify(text.slice(0, 40))} ...`);
  },

  // A program with rotary motion: A turns by a degree a second, C is at 20 degrees, on a table-table machine.
  async tilted(page) {
    await page.click('button[data-value=plain]');
    const amber = async () => (await pixels(page)).red, without = await amber();
    expect(without === 0, `the tool is seen before a place is selected: ${without} pixels`);
    const plot = page.locator('[data-quantity=feed] .u-over'), scene = page.locator('#scene');
    const { width, height } = await plot.boundingBox();
    const numbers = async name => (await scene.getAttribute(`data-${name}`)).split(' ').map(Number);
    for (const at of [5.5, 25.5]) {
      await plot.click({ position: { x: width * at / 30, y: height / 2 } });
      await painted(page);
      const { facts } = await selected(page), a = Number(/A([\d.]+) C20.000/.exec(facts)?.[1]);
      expect(Math.abs(a - at) < 0.3, `at ${at} s the facts are "${facts}"`);
      // A table that turns by A about X, and carries C: the tool leans in the part's frame as the table does not.
      const [s, c] = [Math.sin(a * Math.PI / 180), Math.cos(a * Math.PI / 180)], turn = 20 * Math.PI / 180;
      const axis = await numbers('axis'), shown = await numbers('shown');
      expect(near(axis, [s * Math.sin(turn), s * Math.cos(turn), c], 1e-3), `at ${at} s the axis is ${axis}`);
      expect(near(shown, [0, 0, 1], 1e-3), `on the table the tool is shown along ${shown}`);
      expect(near(await numbers('tip'), [at, 5, 0.513], 0.2), `the tip is at ${await numbers('tip')}`);
      expect(await amber() > 200, `the tool has ${await amber()} pixels`);
      await expectTurningPart(page, axis, numbers);
    }
    // A click on the turned part finds the line made there.
    await page.getByRole('button', { name: 'Top', exact: true }).click();
    const box = await page.locator('#scene canvas').boundingBox();
    await page.locator('#scene canvas').click({ position: { x: box.width / 2 + 3, y: box.height / 2 } });
    await painted(page);
    const { line } = await selected(page);
    expect(['16', '17', '18', '19'].includes(line), `a click on the part's middle selects line ${line}`);
  },

  // The top of samples/13-dome: a ball of 3 mm on a dome of 8 mm about (0, 0, -8), on a table-table machine.
  async dome(page) {
    const plot = page.locator('[data-quantity=feed] .u-over'), scene = page.locator('#scene');
    const { width, height } = await plot.boundingBox();
    const numbers = async name => (await scene.getAttribute(`data-${name}`)).replaceAll('\u2212', '-').split(' ').map(Number);
    const axes = [];
    for (const share of [0.4, 0.43, 0.55]) {
      await plot.click({ position: { x: width * share, y: height / 2 } });
      await painted(page);
      const { facts } = await selected(page), words = /A([\u2212-]?[\d.]+) C([\u2212-]?[\d.]+)/.exec(facts);
      expect(words, `the facts are "${facts}"`);
      const [a, c] = words.slice(1).map(v => v.replace('\u2212', '-') * Math.PI / 180);
      const axis = await numbers('axis'), tip = await numbers('tip');
      expect(near(axis, [Math.sin(a) * Math.sin(c), -Math.sin(a) * Math.cos(c), Math.cos(a)], 1e-3), `at A${a} C${c} rad the axis is ${axis}`);
      const centre = tip.map((v, k) => v + 3 * axis[k] + (k === 2 ? 8 : 0));
      expect(Math.abs(Math.hypot(...centre) - 11) < 0.02, `the ball is ${Math.hypot(...centre)} mm from the dome's centre`);
      expect(near(await numbers('shown'), [0, 0, 1], 1e-3), `on the table the tool is shown along ${await numbers('shown')}`);
      await expectTurningPart(page, axis, numbers);
      axes.push(axis);
    }
    expect(!near(axes[0], axes[1], 0.05) && !near(axes[1], axes[2], 0.05), `the axis hardly turns: ${axes.join('; ')}`);
  },

  // A wall of the stock in front of the surface.
  async stock(page) {
    const grey = await page.evaluate(GREY);
    expect(grey > 0.05, `the stock covers ${grey} of the picture`);
    const colours = await pixels(page);
    expect(colours.red > 0.005 * colours.all && colours.blue > 0.005 * colours.all, `the surface is not seen beside it: ${JSON.stringify(colours)}`);
    expect(/Grey is the remaining stock, in cells of 0.5 mm/.test(await page.locator('.notes').innerText()), 'the page does not say what is grey');
    await page.getByRole('button', { name: 'Front', exact: true }).click();
    expect((await pixels(page)).red === 0, 'the surface is seen through the stock');
    const box = await page.locator('#scene canvas').boundingBox(), tip = page.locator('.tip');
    // The slope's upper half, behind the wall's.
    const seen = async () => {
      for (let y = 0.3; y < 0.7; y += 0.02) {
        await page.locator('#scene canvas').hover({ position: { x: box.width / 2, y: box.height * y } });
        await painted(page);
        if (await tip.isVisible()) return true;
      }
      return false;
    };
    expect(!await seen(), 'the cursor reads through the stock');
    await page.click('button[data-value=hidden]');
    expect(await page.evaluate(GREY) === 0, 'the hidden stock is seen');
    expect(await seen(), 'the cursor does not read the surface where the stock is hidden');
  },

  async numbers(page) {
    await expectNumbersOfJson(page);
    expect((await pixels(page)).drawn > 0, 'the picture is blank');
  },

  // A page of compress: rows of lines before, lines and arcs after; of resegment (no arcs): lines.
  async path(page) {
    await expectNumbersOfJson(page);
    const figures = JSON.parse(readFileSync(json, 'utf8'));
    await page.getByRole('button', { name: 'Top', exact: true }).click();
    await painted(page);
    const after = await strokes(page);
    expect(after.lines > 100, `no lines after: ${JSON.stringify(after)}`);
    expect(figures.arcs > 0 ? after.arcs > 100 : after.arcs === 0, `${figures.arcs} arcs after are ${JSON.stringify(after)}`);
    await page.click('button[data-value=before]');
    await painted(page);
    const before = await strokes(page);
    expect(before.lines > 100 && before.arcs === 0, `before: ${JSON.stringify(before)}`);
    const box = await page.locator('#scene canvas').boundingBox();
    let tip = '';
    for (let y = 4; y < box.height && !tip; y += 6) {
      await page.locator('#scene canvas').hover({ position: { x: box.width / 2, y } });
      if (await page.locator('.tip').isVisible()) tip = await page.locator('.tip').textContent();
    }
    expect(/^line \d+ before: line to X-?[\d.]+ Y-?[\d.]+ Z-?[\d.]+$/.test(tip), `the cursor reads "${tip}"`);
    await page.mouse.wheel(0, -2000);
    await painted(page);
    expect((await strokes(page)).drawn > 0, 'nothing is seen after zooming in');
    await page.locator('#scene canvas').dblclick();
    await painted(page);
    expect(await page.locator('svg.histogram path').count() > 3, 'the histogram is missing');
  },

  // A raster: opens from the top, rows on the part's outline, two histograms.
  async raster(page) {
    await expectNumbersOfJson(page);
    const figures = JSON.parse(readFileSync(json, 'utf8'));
    const after = await strokes(page), rows = await rowsDown(page);
    expect(after.lines > 100 && after.arcs === 0, `no rows: ${JSON.stringify(after)}`);
    expect(rows.lines > 0.8 * figures.rows && rows.lines < 1.3 * figures.rows, `${figures.rows} rows are drawn as ${JSON.stringify(rows)}`);
    expect(rows.part > 500, `the part is drawn as ${JSON.stringify(rows)}`);
    await page.click('button[data-value=before]');
    await painted(page);
    expect((await strokes(page)).lines > 100, 'the raster of constant steps is missing');
    expect(await page.locator('svg.histogram').count() === 2, 'not two histograms');
    expect(/part/.test(await page.locator('#path-legend').innerText()), 'the legend does not name the part');
    expect(/every 0.1 mm/.test(await page.locator('.notes').innerText()), 'the page does not say what before is');
  },

  // A page of check or time: rapids orange, cutting blue, feeds as further views; a rapid, then cutting at two feeds.
  async program(page) {
    if (json) await expectNumbersOfJson(page);
    await page.getByRole('button', { name: 'Top', exact: true }).click();
    await painted(page);
    const motion = await strokes(page);
    expect(motion.lines > 100 && motion.arcs > 50, `rapid and cutting are ${JSON.stringify(motion)}`);
    expect(/rapid/.test(await page.locator('#path-legend').innerText()), 'the legend does not name rapids');
    await page.click('button[data-value=cutting]');
    await painted(page);
    const cutting = await strokes(page);
    expect(cutting.lines > 100 && cutting.arcs === 0, `cutting alone is ${JSON.stringify(cutting)}`);
    for (const feed of ['feed', 'speed']) {
      const button = page.locator(`button[data-value=${feed}]`);
      if (await button.count() === 0) {
        expect(feed === 'speed' && /Without a machine file/.test(await page.locator('.notes').innerText()), `no view of ${feed}`);
        continue;
      }
      await button.click();
      await painted(page);
      expect(await hues(page) >= 2, `${feed} has ${await hues(page)} colours`);
      expect(/mm\/min/.test(await page.locator('#path-legend').innerText()), 'the legend has no unit');
    }
    await page.click('button[data-value=motion]');
    const box = await page.locator('#scene canvas').boundingBox();
    const tips = new Set();
    for (let y = 4; y < box.height; y += 12) {
      await page.locator('#scene canvas').hover({ position: { x: box.width / 2, y } });
      if (await page.locator('.tip').isVisible()) tips.add(await page.locator('.tip').textContent());
    }
    expect([...tips].some(t => /^line \d+: cutting to X-?[\d.]+ Y-?[\d.]+ Z-?[\d.]+, F\d+/.test(t)), `the cursor reads ${JSON.stringify([...tips])}`);
    if (await page.getByLabel('Tool').count() > 0) {
      await page.getByLabel('Tool').selectOption('2');
      await painted(page);
      const one = await strokes(page);
      expect(one.drawn > 20 && one.drawn < 0.8 * motion.drawn, `one tool is ${JSON.stringify(one)} of ${JSON.stringify(motion)}`);
    }
  },

  // The same on a phone: nothing wider than the screen, print large enough, a pinch zooms.
  async phone(page) {
    await page.setViewportSize({ width: 390, height: 844 });
    await painted(page);
    const { wide, small } = await page.evaluate(() => {
      const scale = svg => svg.getBoundingClientRect().width / svg.viewBox.baseVal.width;
      const small = [...document.querySelectorAll('svg.fixed text')].map(t => 12 * scale(t.ownerSVGElement));
      for (const e of document.querySelectorAll('main *:not(svg *)'))
        if (e.childNodes.length && [...e.childNodes].some(n => n.nodeType === 3 && n.textContent.trim())) small.push(parseFloat(getComputedStyle(e).fontSize));
      return { wide: document.documentElement.scrollWidth - document.documentElement.clientWidth, small: Math.min(...small) };
    });
    expect(wide <= 0, `the page is ${wide} pixels wider than the phone`);
    expect(small >= 9, `the smallest print has ${small} pixels`);
    const before = await strokes(page);
    expect(before.drawn > 100, `the picture is blank: ${JSON.stringify(before)}`);
    await page.evaluate(() => {
      const canvas = document.querySelector('#scene canvas');
      canvas.setPointerCapture = () => {};
      const at = canvas.getBoundingClientRect();
      const send = (type, id, x) => canvas.dispatchEvent(new PointerEvent(type, { pointerId: id, pointerType: 'touch', clientX: at.x + x, clientY: at.y + 150, bubbles: true }));
      send('pointerdown', 1, 150);
      send('pointerdown', 2, 200);
      send('pointermove', 1, 50);
      send('pointermove', 2, 300);
      send('pointerup', 1, 50);
      send('pointerup', 2, 300);
    });
    await painted(page);
    const after = await strokes(page);
    expect(after.drawn !== before.drawn, 'two fingers do not zoom');
  },

  // A machine with rotary axes: two pictures that follow the slider, the plots and the play button.
  async machine(page) {
    if (json) await expectNumbersOfJson(page);
    const whole = async () => {
      const out = [];
      for (const id of ['scene', 'part-scene'])
        out.push(await page.evaluate(name => {
          const canvas = document.querySelector(`#${name} canvas`), gl = canvas.getContext('webgl2');
          const { drawingBufferWidth: w, drawingBufferHeight: h } = gl, px = new Uint8Array(4 * w * h);
          gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, px);
          let drawn = 0, sum = 0;
          for (let i = 0; i < px.length; i += 4) if (px[i] !== px[0] || px[i + 1] !== px[1]) { drawn++; sum = (sum * 31 + px[i] + i) >>> 0; }
          return { share: drawn / (w * h), sum };
        }, id));
      return out;
    };
    const start = await whole(), box = page.locator('#selected'), facts = await box.innerText();
    for (const picture of start) expect(picture.share > 0.03, `a picture is blank: ${JSON.stringify(start)}`);
    const axes = await page.locator('#plots [data-axis]').count();
    expect(axes >= 4, `${axes} plots`);
    for (const name of ['tip on the part', 'tool axis', 'tilt']) expect(facts.includes(name), `"${name}" is missing: ${facts}`);
    const line = await box.getAttribute('data-line');
    await page.getByLabel('Time').evaluate(slider => { slider.value = 0.6; slider.dispatchEvent(new Event('input')); });
    await painted(page);
    const later = await whole();
    expect(await box.getAttribute('data-line') !== line, 'the slider does not change the line');
    start.forEach((picture, i) => expect(picture.sum !== later[i].sum, `picture ${i} does not follow the slider`));
    const plot = page.locator('#plots .u-over').first(), { width, height } = await plot.boundingBox();
    await plot.click({ position: { x: width / 4, y: height / 2 } });
    const at = Number((await page.locator('#time span').innerText()).split(' ')[0]);
    const end = Number((await page.locator('#time span').innerText()).split(' ')[2]);
    expect(Math.abs(at / end - 0.25) < 0.02, `a click at a quarter shows ${at} of ${end} s`);
    await page.getByRole('button', { name: 'Play' }).click();
    await page.waitForFunction(t => Number(document.querySelector('#time span').textContent.split(' ')[0]) > t, at);
    await page.getByRole('button', { name: 'Pause' }).click();
    await page.getByRole('button', { name: 'Top', exact: true }).click();
    expect((await whole())[0].share > 0.02, 'the view from the top is blank');
  },

  // samples/12-five-axis/faces.nc on a page of feed or time: two tilted planes, A tilts about X and carries C.
  async faces(page) {
    const rad = degrees => degrees * Math.PI / 180, number = text => Number(text.replaceAll('\u2212', '-'));
    const at = line => page.evaluate(wanted => {
      const { page: shown } = window.machinePage, first = shown.line.indexOf(wanted), last = shown.line.lastIndexOf(wanted);
      window.machinePage.pause();
      window.machinePage.go(shown.time[(first + last) >> 1]);
      const bodies = window.machinePage.scenes.map(s => ({ part: s.partBody.matrix.toArray(), tool: s.toolBody.matrix.toArray() }));
      return { bodies, gauge: shown.chain.gauge.toArray(), work: shown.work };
    }, line);
    const apply = (m, [x, y, z]) => [0, 1, 2].map(k => m[k] * x + m[4 + k] * y + m[8 + k] * z + m[12 + k]);
    // Z of the plane of G68.2 with the Euler angles I J, and a point of it.
    const planes = [{ lines: [22, 26, 30], i: 110, j: 30, origin: [14.095, 5.13, -14.019] }, { lines: [53, 57, 61], i: 230, j: 60, origin: [-19.902, 16.7, -25] }];
    for (const { lines, i, j, origin } of planes)
      for (const line of lines) {
        const { bodies: [inBed, onPart], work } = await at(line);
        await painted(page);
        const text = await page.locator('#selected').innerText(), fact = name => number(new RegExp(`\\b${name} ([\u2212-]?[\\d.]+)`).exec(text)?.[1] ?? 'none');
        const [a, c] = [rad(fact('A')), rad(fact('C'))];
        const axis = /tool axis \(([^)]*)\)/.exec(text)[1].split(',').map(number);
        const normal = [Math.sin(rad(i)) * Math.sin(rad(j)), -Math.cos(rad(i)) * Math.sin(rad(j)), Math.cos(rad(j))];
        expect(near(axis, normal, 1e-3), `on line ${line} the tool is along ${axis}, not ${normal}`);
        const tip = /tip on the part X(\S+) Y(\S+) Z(\S+)/.exec(text).slice(1).map(number);
        const height = tip.reduce((sum, v, k) => sum + (v - origin[k]) * normal[k], 0);
        expect(Math.abs(height) < 0.01, `on line ${line} the tip is ${height} mm from the plane`);
        // The table turns by -C about Z and then by -A about X at Z-360.
        const place = ([x, y, z]) => {
          const [u, v, w] = [Math.cos(c) * x + Math.sin(c) * y, Math.cos(c) * y - Math.sin(c) * x, z + 360];
          return [u, Math.cos(a) * v + Math.sin(a) * w, Math.cos(a) * w - Math.sin(a) * v - 360];
        };
        for (const point of [[0, 0, 0], [50, 0, -300], [0, 40, -320]])
          expect(near(apply(inBed.part, point), place(point), 1e-3), `on line ${line} the part is at ${apply(inBed.part, point)}, not ${place(point)}`);
        expect(near(inBed.tool.slice(12, 15), ['X', 'Y', 'Z'].map(fact), 2e-3), `on line ${line} the spindle is at ${inBed.tool.slice(12, 15)}`);
        // The tip of a tool of 120 mm meets its place on the part.
        const there = apply(inBed.tool, [0, 0, -120]), here = apply(inBed.part, tip.map((v, k) => v + work[k]));
        expect(near(there, here, 0.05), `on line ${line} the tip is at ${there} and its place on the part at ${here}`);
        expect(near(onPart.part, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], 1e-9), 'the part of the second picture moves');
        expect(near(onPart.tool.slice(8, 11), normal, 1e-3), `around the part the tool is along ${onPart.tool.slice(8, 11)}`);
      }
  },

  // A plan: the slider machines one primitive after the other, in each of the plans.
  async plan(page) {
    const drawn = () => page.evaluate(() => {
      const { data } = document.getElementById('view').getContext('2d').getImageData(0, 0, 900, 440);
      let share = 0, sum = 0;
      for (let i = 0; i < data.length; i += 4) if (data[i + 3]) { share++; sum = (sum * 31 + data[i] + i) >>> 0; }
      return { share: 4 * share / data.length, sum };
    });
    const choices = await page.locator('#plans option').count();
    expect(choices === 3, `${choices} plans`);
    for (let k = 0; k < choices; k++) {
      await page.locator('#plans').selectOption({ index: k });
      const step = page.locator('#step'), last = Number(await step.getAttribute('max')), seen = new Set();
      expect(last >= 2, `plan ${k} has ${last} primitives`);
      for (let n = 0; n <= last; n++) {
        await step.evaluate((slider, value) => { slider.value = value; slider.dispatchEvent(new Event('input')); }, n);
        const picture = await drawn(), name = await page.locator('#step-name').innerText();
        expect(picture.share > 0.02, `plan ${k} is blank at ${n}`);
        expect(n === 0 || name.startsWith(`${n}: `), `at ${n} the label says "${name}"`);
        seen.add(picture.sum);
      }
      expect(seen.size === last + 1, `plan ${k} has ${seen.size} pictures of ${last + 1}`);
    }
    const text = await page.locator('main').innerText();
    for (const word of ['Operations of the plan that is taken', 'limit', 'taken', 'largest']) expect(text.includes(word), `"${word}" is missing`);
  },

  // A copied program: still pictures of the path and of feed and load over time.
  async copy(page) {
    const lines = await page.$$eval('svg.fixed', all => all.map(s => s.querySelectorAll('path, polyline, line').length));
    expect(lines.length >= 2 && lines.every(n => n > 0), `pictures with ${lines} lines`);
    expect((await page.locator('main').innerText()).includes('min'), 'no units');
  },

  async large_program(page) {
    expect(opened_ms < 5000, `the page took ${opened_ms} ms`);
    expect((await strokes(page)).drawn > 1000, 'the picture is blank');
    await page.click('button[data-value=feed]');
    await painted(page);
    expect(await hues(page) >= 2, 'the feeds have one colour');
  },

  async large_path(page) {
    expect((await strokes(page)).drawn > 1000, 'the picture is blank');
    expect(/omitted points lie within/.test(await page.locator('.notes').innerText()), 'the page does not say that points were left out');
  },

  async large(page) {
    expect((await pixels(page)).drawn > 1000, 'the picture is blank');
    expect(await page.locator('.u-over').count() >= 5, 'plots are missing');
  },

  async without_webgl(page) {
    const text = await page.locator('#scene').textContent();
    expect(/WebGL 2 is missing/.test(text), `the page says "${text}"`);
    expect(await page.locator('.u-over').count() >= 3, 'the plots are missing as well');
    expect(await page.locator('#figures tr').count() > 3, 'the figures are missing');
  },

  async without_script(page) {
    expect(/The pictures need JavaScript/.test(await page.locator('#part').innerText()), 'the page does not say what it needs');
    expect(await page.locator('#figures tr').count() > 3, 'the figures are missing');
    expect(await page.locator('svg.histogram path').count() > 3, 'the histogram is missing');
  },
};

// Pages with a path alone are drawn on a plain canvas, which an emulated graphics card slows down.
const PLAIN = ['path', 'raster', 'large_path', 'program', 'phone', 'large_program'];
const webgl = PLAIN.includes(check) ? ['--disable-gpu'] : check === 'without_webgl' ? ['--disable-gpu', '--disable-3d-apis'] : ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
const browser = await chromium.launch({ executablePath, args: ['--no-sandbox', ...webgl] });
try {
  const context = await browser.newContext({ offline: true, viewport: { width: 900, height: 700 }, javaScriptEnabled: check !== 'without_script' });
  const page = await context.newPage();
  page.setDefaultTimeout(60000);
  page.on('console', m => { if (m.type() === 'error') problems.push(`console: ${m.text()}`); });
  page.on('pageerror', e => problems.push(`error on the page: ${e.message}`));
  page.on('request', r => { if (!/^(file|blob|data):/.test(r.url())) problems.push(`asks for ${r.url()}`); });
  const asked = Date.now();
  await page.goto(pathToFileURL(file).href);
  if (check !== 'without_script' && check !== 'copy') await page.waitForFunction(() => document.documentElement.dataset.ready === 'yes');
  opened_ms = Date.now() - asked;
  await CHECKS[check](page);
} catch (e) {
  problems.push(e.message);
} finally {
  await browser.close();
}
for (const p of problems) console.log(p);
process.exit(problems.length ? 1 : 0);
