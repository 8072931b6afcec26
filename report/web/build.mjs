// build.mjs SOURCES PACKAGES OUT.cpp: bundles main.js, path.js and machine.js and writes scripts and style as C++ text.
import { createRequire } from 'node:module';
import { renameSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';

const [sources, packages, out] = process.argv.slice(2).map(path => resolve(path));
const esbuild = createRequire(join(packages, 'package.json'))('esbuild');
const result = await esbuild.build({
  entryPoints: [join(sources, 'main.js'), join(sources, 'path.js'), join(sources, 'machine.js')],
  bundle: true,
  minify: true,
  format: 'iife',
  target: ['chrome90', 'firefox113', 'safari16.4'],
  charset: 'utf8',
  legalComments: 'inline',
  nodePaths: [join(packages, 'node_modules')],
  outdir: packages,
  write: false,
  logLevel: 'warning',
});

// Compilers take pieces of a literal, not half a megabyte at once.
function literal(text) {
  const delimiter = 'camber-page';
  if (text.includes(`)${delimiter}"`)) throw new Error('the bundle holds the end of its own C++ literal');
  const pieces = [];
  for (let at = 0; at < text.length;) {
    let to = Math.min(text.length, at + 12000);
    if (to < text.length && (text.charCodeAt(to) & 0xfc00) === 0xdc00) ++to;  // a pair stays whole
    pieces.push(`R"${delimiter}(${text.slice(at, to)})${delimiter}"`);
    at = to;
  }
  return pieces.join('\n');
}

const file = name => result.outputFiles.find(f => f.path.endsWith(`/${name}`)).text;
const script = file('main.js');
const path = file('path.js');
const machine = file('machine.js');
const style = file('main.css');
for (const text of [script, path, machine, style])  // esbuild writes <\/script where a text holds one
  if (/<\/(script|style)/i.test(text)) throw new Error('the bundle holds an end tag');
writeFileSync(`${out}.part`, `// Made by report/web/build.mjs.
#include "report/page_parts.h"

namespace camber::report {

const std::string_view kReportScript = ${literal(script)};

const std::string_view kReportStyle = ${literal(style)};

const std::string_view kPathScript = ${literal(path)};

const std::string_view kMachineScript = ${literal(machine)};

}  // namespace camber::report
`);
renameSync(`${out}.part`, out);
console.log(`report page: script ${Math.round(script.length / 1024)} kB, of paths ${Math.round(path.length / 1024)} kB, of machines ${Math.round(machine.length / 1024)} kB, style ${Math.round(style.length / 1024)} kB`);
