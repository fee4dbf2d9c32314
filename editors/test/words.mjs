// Writes the keywords and names that the tree-sitter parser finds in all valid programs of the repository: the
// reference for editors that only match patterns. One line each, with tabs between the fields:
//
//     path  line  first byte  end byte  word|name  text           (lines and bytes from 1, the end is exclusive)
//
// node editors/test/words.mjs OUT        (needs tree-sitter on the PATH)
// Names of called functions are omitted: editors highlight only the built-in functions.

import { execFileSync } from 'node:child_process';
import { mkdtempSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';

const editors = resolve(import.meta.dirname, '..');
const root = resolve(editors, '..');
const grammar = join(editors, 'tree-sitter-hyped');

function programs(folder) {
  return readdirSync(folder, { withFileTypes: true, recursive: true })
    .filter((entry) => entry.isFile() && entry.name.endsWith('.hyped'))
    .map((entry) => join(entry.parentPath ?? entry.path, entry.name))
    .sort();
}

// Keywords are the anonymous tokens, and the nodes that consist of one keyword.
const types = JSON.parse(readFileSync(join(grammar, 'src/node-types.json'), 'utf8'));
const anonymous = types.filter(({ type, named }) => !named && /^[a-z]+$/.test(type)).map(({ type }) => `"${type}"`);
const query = `
[${anonymous.join(' ')}] @word
[(timer) (true) (false) (none) (self) (instant) (hold) (end) (bool_domain)] @word
(identifier) @name
(call function: (identifier) @called)
`;

const scratch = mkdtempSync(join(tmpdir(), 'hyped-words-'));
const paths = ['examples', 'benches/worlds', 'tests/conformance', 'tests/verdicts', 'tests/maps'].flatMap((folder) => programs(join(root, folder)));
paths.push(join(import.meta.dirname, 'names.hyped'));
writeFileSync(join(scratch, 'query.scm'), query);
writeFileSync(join(scratch, 'paths'), paths.join('\n'));
const out = execFileSync('tree-sitter', ['query', '--captures', join(scratch, 'query.scm'), '--paths', join(scratch, 'paths')], {
  cwd: grammar,
  encoding: 'utf8',
  maxBuffer: 1 << 28,
  stdio: ['ignore', 'pipe', 'inherit'],
});

const rows = new Map();
let path = '';
for (const line of out.split('\n')) {
  const capture = /- (word|name|called), start: \((\d+), (\d+)\), end: \(\d+, (\d+)\), text: `(.*)`/.exec(line);
  if (!capture) {
    if (line !== '') path = line.trim();
    continue;
  }
  const [, kind, row, start, end, text] = capture;
  const place = `${path}\t${Number(row) + 1}\t${Number(start) + 1}\t${Number(end) + 1}`;
  // A token with several captures: a keyword or a call takes precedence over a name.
  if (kind !== 'name' || !rows.has(place)) rows.set(place, { kind, text });
}
const lines = [...rows].filter(([, { kind }]) => kind !== 'called').map(([place, { kind, text }]) => `${place}\t${kind}\t${text}`);
writeFileSync(process.argv[2], `${lines.join('\n')}\n`);
console.log(`${lines.length} words and names in ${paths.length} files`);
