// Compares the TextMate grammar with the tree-sitter grammar: the same keywords and names in every program.
//
// WORDS=FILE node --test test/words.test.mjs        (FILE is the output of editors/test/words.mjs)

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { tokenize } from './tokenize.mjs';

const WORD = /^(keyword\.(control|operator\.word)|storage\.|support\.type$|constant\.language|variable\.language)/;

/** The scope at a byte of a line. */
function scopeAt(tokens, byte) {
  let before = 0;
  for (const { text, scopes } of tokens) {
    before += Buffer.byteLength(text);
    if (byte < before) return scopes.at(-1);
  }
  return '';
}

test('words are words and names are names', () => {
  const rows = readFileSync(process.env.WORDS, 'utf8').trimEnd().split('\n').map((row) => row.split('\t'));
  assert.ok(rows.length > 10_000, 'there is much to compare');
  const wrong = [];
  let path, lines;
  for (const [file, line, start, , kind, text] of rows) {
    if (file !== path) [path, lines] = [file, tokenize(readFileSync(file, 'utf8'))];
    const scope = scopeAt(lines[line - 1], start - 1);
    if (WORD.test(scope) !== (kind === 'word')) wrong.push(`${file}:${line}:${start}: ${kind} ${text} is ${scope}`);
  }
  assert.deepEqual(wrong, []);
});
