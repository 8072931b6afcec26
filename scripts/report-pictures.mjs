// node scripts/report-pictures.mjs PACKAGES PAGE.html: takes the pictures of docs/report.md from compensate's page of
// sample 01. PACKAGES: the folder of report/web in the build folder, whose node_modules hold playwright-core.
import { createRequire } from 'node:module';
import { existsSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const [packages, file] = process.argv.slice(2);
const { chromium } = createRequire(resolve(packages, 'package.json'))('playwright-core');
const executablePath = ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find(existsSync);
const docs = join(import.meta.dirname ?? new URL('.', import.meta.url).pathname, '../docs');

const browser = await chromium.launch({
  executablePath, args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader']
});
const page = await browser.newPage({ viewport: { width: 1040, height: 830 } });
await page.goto(pathToFileURL(resolve(file)).href);
await page.waitForSelector('#scene canvas');
const take = name => page.screenshot({ path: join(docs, name) });
const pause = () => page.waitForTimeout(500);

await pause();
await take('report-before.png');
await page.click('button[data-value=after]');
await page.getByLabel('Scale').selectOption('5');
const box = await page.locator('#scene canvas').boundingBox();
await page.mouse.move(box.x + 0.5 * box.width, box.y + 0.6 * box.height);
await pause();
await take('report-after.png');
await page.click('button[data-value=plain]');
await page.getByLabel('Path').selectOption('force');
const plot = page.locator('[data-quantity=force] .u-over');
const { width, height } = await plot.boundingBox();
await plot.click({ position: { x: 0.7 * width, y: 0.5 * height } });
await pause();
await page.locator('#scene').scrollIntoViewIfNeeded();
await page.evaluate(() => window.scrollTo(0, 330));
await pause();
await take('report-path.png');
await browser.close();
