// Checks that tree-sitter and hypedc accept the same texts: every `.hyped` file of the repository and every example of
// grammar/README.md has syntax errors in both or in neither.
//
// HYPEDC=PATH node test/agreement.mjs        (needs tree-sitter on the PATH)

import { spawnSync } from 'node:child_process';
import { mkdtempSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';

const here = resolve(import.meta.dirname, '..');
const root = resolve(here, '../..');
const hypedc = process.env.HYPEDC ?? 'hypedc';

/** The codes of syntax errors: no rule matches, an unmatched brace, an unclosed map. */
const SYNTAX_CODES = ['E0101', 'E0102', 'E0103'];

function programs(folder) {
  return readdirSync(folder, { withFileTypes: true, recursive: true })
    .filter((entry) => entry.isFile() && entry.name.endsWith('.hyped'))
    .map((entry) => join(entry.parentPath ?? entry.path, entry.name));
}

/** Writes the examples of the reference to files, each wrapped in the block that its info string names. */
function reference() {
  const folder = mkdtempSync(join(tmpdir(), 'hyped-reference-'));
  const around = {
    entity: (text) => `entity Hero {\n${text}\n}\n`,
    mode: (text) => `entity Hero {\nmode ground {\n${text}\n}\n}\n`,
    world: (text) => `world Room {\n${text}\n}\n`,
  };
  const text = readFileSync(join(root, 'grammar/README.md'), 'utf8');
  return [...text.matchAll(/^```hyped *(.*)\n([^]*?)^```$/gm)].map(([, info, example], index) => {
    const kind = info.replace('wrapper ', 'whole ').split(' ')[0];
    const path = join(folder, `example-${index}.hyped`);
    writeFileSync(path, (around[kind] ?? ((whole) => whole))(example));
    return path;
  });
}

function run(command, args) {
  const { error, stdout, stderr } = spawnSync(command, args, { cwd: here, encoding: 'utf8', maxBuffer: 1 << 28 });
  if (error) throw error;
  return { stdout, stderr };
}

/** The files in which hypedc finds syntax errors; every file is checked, also those that others import. */
function wrongForHypedc(paths) {
  const { stdout } = run(hypedc, ['check', '--format', 'json', ...paths]);
  const wrong = new Set();
  for (const finding of JSON.parse(stdout).findings) {
    if (SYNTAX_CODES.includes(finding.code)) wrong.add(resolve(here, finding.primary.file));
  }
  return wrong;
}

/** The files in which tree-sitter finds errors: it prints a line for each, which starts with the path. */
function wrongForTreeSitter(paths) {
  const list = join(mkdtempSync(join(tmpdir(), 'hyped-paths-')), 'paths');
  writeFileSync(list, paths.join('\n'));
  const { stdout, stderr } = run('tree-sitter', ['parse', '--quiet', '--stat', '--paths', list]);
  const total = /Total parses: (\d+);/.exec(stdout);
  if (Number(total?.[1]) !== paths.length) throw new Error(`not all files were parsed:\n${stdout}${stderr}`);
  return new Set(paths.filter((path) => stdout.split('\n').some((line) => line.startsWith(`${path} `) || line.startsWith(`${path}\t`))));
}

const folders = ['examples', 'benches/worlds', 'tests', 'src'].map((folder) => join(root, folder));
const paths = [...folders.flatMap(programs), ...reference()];
const [one, other] = [wrongForHypedc(paths), wrongForTreeSitter(paths)];
let failed = 0;
for (const path of paths) {
  if (one.has(path) === other.has(path)) continue;
  failed += 1;
  console.error(`${path}: hypedc finds ${one.has(path) ? 'a' : 'no'} syntax error, tree-sitter finds ${other.has(path) ? 'one' : 'none'}`);
}
console.log(`${paths.length - failed} passed, ${failed} failed`);
process.exit(failed === 0 && one.size > 0 ? 0 : 1);
