// build.mjs SOURCES PACKAGES OUT SCRIPT...: bundles scripts with their style and packages into the folder OUT. PACKAGES: a folder whose node_modules hold what package-lock.json names. scripts/bundle-page calls it.
import { createRequire } from 'node:module';
import { writeFileSync } from 'node:fs';
import { basename, join, resolve } from 'node:path';

const [sources, packages, out] = process.argv.slice(2, 5).map(path => resolve(path));
const scripts = process.argv.slice(5);
const esbuild = createRequire(join(packages, 'package.json'))('esbuild');
const result = await esbuild.build({
  entryPoints: scripts.map(script => join(sources, script)),
  bundle: true,
  minify: true,
  format: 'iife',
  target: ['chrome90', 'firefox113', 'safari16.4'],
  charset: 'utf8',
  legalComments: 'inline',
  nodePaths: [join(packages, 'node_modules')],
  outdir: out,
  write: false,
  logLevel: 'warning',
});

for (const file of result.outputFiles) {
  // esbuild writes <\/script where a text holds one.
  if (/<\/(script|style)/i.test(file.text)) throw new Error(`${basename(file.path)} holds an end tag`);
  writeFileSync(join(out, basename(file.path)), file.text);
}
