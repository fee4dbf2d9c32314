// Tests of the TextMate grammar: snapshots of all examples (test/snapshots, updated with UPDATE=1), and single
// constructs.

import assert from 'node:assert/strict';
import { existsSync, mkdirSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join, relative } from 'node:path';
import { test } from 'node:test';
import * as source from '../syntaxes/hyped.tmLanguage.mjs';
import { tokenize } from './tokenize.mjs';

const root = join(import.meta.dirname, '../../..');
const snapshots = join(import.meta.dirname, 'snapshots');

function programs(folder) {
  return readdirSync(folder, { withFileTypes: true, recursive: true })
    .filter((entry) => entry.isFile() && entry.name.endsWith('.hyped'))
    .map((entry) => join(entry.parentPath ?? entry.path, entry.name))
    .sort();
}

/** One line per line, with the innermost scope of each token that has its own. */
function picture(text) {
  return tokenize(text)
    .map((tokens, index) => {
      const shown = tokens
        .filter(({ text, scopes }) => text.trim() !== '' && !/^(source|meta\.|punctuation\.(?!definition))/.test(scopes.at(-1)))
        .map(({ text, scopes }) => `${text.trim()} ‹${scopes.at(-1)}›`);
      return `${index + 1}: ${shown.join('  ')}`.trimEnd();
    })
    .join('\n') + '\n';
}

test('the grammar is what its source makes', () => {
  assert.ok(readFileSync(source.path, 'utf8') === source.text, 'write it anew: npm run grammar');
});

test('every example looks as it did', () => {
  const paths = programs(join(root, 'examples'));
  assert.ok(paths.length > 10, 'the examples are there');
  const names = paths.map((path) => `${relative(root, path).replaceAll('/', '__')}.txt`);
  mkdirSync(snapshots, { recursive: true });
  for (const [index, path] of paths.entries()) {
    const seen = picture(readFileSync(path, 'utf8'));
    const snapshot = join(snapshots, names[index]);
    if (process.env.UPDATE) writeFileSync(snapshot, seen);
    assert.ok(existsSync(snapshot), `${snapshot} is missing: write it with UPDATE=1 and read it`);
    assert.equal(seen, readFileSync(snapshot, 'utf8'), `${path} looks different`);
  }
  assert.deepEqual(readdirSync(snapshots).sort(), names.sort(), 'no snapshot of a file that is gone');
});

test('every program is left where it was entered', () => {
  const paths = ['examples', 'benches/worlds', 'tests/conformance', 'tests/verdicts', 'tests/maps'].flatMap((folder) => programs(join(root, folder)));
  for (const path of paths) {
    const after = tokenize(`${readFileSync(path, 'utf8').trimEnd()}\nconst last = 1`).at(-1);
    assert.deepEqual(after[0], { start: 0, text: 'const', scopes: ['source', 'storage.type'] }, path);
  }
});

test('lines are indented as they stand in the examples', () => {
  const { indentationRules } = JSON.parse(readFileSync(join(import.meta.dirname, '../language-configuration.json'), 'utf8'));
  const more = new RegExp(indentationRules.increaseIndentPattern);
  const less = new RegExp(indentationRules.decreaseIndentPattern);
  let compared = 0;
  for (const path of ['examples', 'benches/worlds'].flatMap((folder) => programs(join(root, folder)))) {
    const lines = readFileSync(path, 'utf8').split('\n').filter((line) => line.trim() !== '');
    for (const [index, line] of lines.slice(1).entries()) {
      const before = lines[index];
      // Statements over several lines are indented by hand; the rows of a map are all alike.
      if ([line, before].some((text) => /^\s*(and|or|->)/.test(text))) continue;
      const depth = (text) => text.search(/\S/);
      const wanted = depth(before) + (more.test(before) ? 4 : 0) - (less.test(line) ? 4 : 0);
      assert.equal(depth(line), wanted, `${path}:\n${before}\n${line}`);
      compared += 1;
    }
  }
  assert.ok(compared > 1000);
});

/** Checks the innermost scope of the first token with each given text, in order of position. */
function looks(text, expected) {
  const tokens = tokenize(text).flat().map(({ text, scopes }) => ({ text: text.trim(), scope: scopes.at(-1) }));
  let from = 0;
  for (const [wanted, scope] of expected) {
    const at = tokens.findIndex((token, index) => index >= from && token.text === wanted);
    assert.ok(at >= 0, `no token ${wanted} in ${JSON.stringify(tokens.slice(from), null, 1)}`);
    assert.equal(tokens[at].scope, scope, `${wanted} in\n${text}`);
    from = at + 1;
  }
}

test('words within words are names', () => {
  looks('entity A {\n    param modeled = 1\n    x = modeled + android + inner\n    order = 2\n}', [
    ['param', 'storage.type'], ['modeled', 'variable.parameter'], ['modeled', 'variable.other'],
    ['android', 'variable.other'], ['inner', 'variable.other'], ['order', 'variable.other'],
  ]);
});

test('words that mean something elsewhere are names', () => {
  looks("entity A {\n    continuous goal = step\n    goal' = to + level * goal''\n    follow = 1\n    initial' = 2\n    map = links\n}", [
    ['goal', 'variable.other.member'], ['step', 'variable.other'],
    ['goal', 'variable.other'], ["'", 'keyword.operator.prime'], ['to', 'variable.other'], ['level', 'variable.other'],
    ['goal', 'variable.other'], ["''", 'keyword.operator.prime'],
    ['follow', 'variable.other'], ['initial', 'variable.other'], ['map', 'variable.other'], ['links', 'variable.other'],
  ]);
  looks('world W {\n    goal goal: goal.goal > 3\n        and never.x < step\n    never step: any Slime touching goal\n}', [
    ['goal', 'storage.type'], ['goal', 'entity.name.label'], ['goal', 'variable.other'], ['goal', 'variable.other.member'],
    ['never', 'variable.other'], ['step', 'variable.other'],
    ['never', 'storage.type'], ['step', 'entity.name.label'], ['any', 'keyword.operator.word'], ['Slime', 'entity.name.type'],
    ['touching', 'keyword.operator.word'], ['goal', 'entity.name.tag'],
  ]);
});

test('chances have names', () => {
  looks('entity A {\n    chance chance: 1..6\n    x := chance\n    chance := 3\n}\n', [
    ['chance', 'storage.type'], ['chance', 'variable.other.member'], [':', 'punctuation.separator'],
    ['x', 'variable.other'], ['chance', 'variable.other'], ['chance', 'variable.other'],
  ]);
});

test('conditions have names', () => {
  looks('entity A {\n    condition condition = condition_ > 3\n    condition = 3\n    mode m { condition warm = x == 2 }\n}\nworld W {\n    condition up = a.x > 3\n    goal g: up\n}', [
    ['condition', 'storage.type'], ['condition', 'entity.name.label'], ['=', 'keyword.operator.assignment'],
    ['condition_', 'variable.other'], ['condition', 'variable.other'],
    ['condition', 'storage.type'], ['warm', 'entity.name.label'], ['x', 'variable.other'],
    ['condition', 'storage.type'], ['up', 'entity.name.label'], ['a', 'variable.other'],
    ['goal', 'storage.type'], ['g', 'entity.name.label'], ['up', 'variable.other'],
  ]);
});

test('words where they mean something', () => {
  looks("entity A {\n    initial when level > 2 mode m {\n        follow links when horizontal > 0 { doors := 1 }\n        when lost(prey) -> a.b { prey := spawn Key(x = 1); destroy self }\n    }\n}", [
    ['initial', 'storage.modifier'], ['when', 'keyword.control'], ['level', 'variable.other'], ['mode', 'storage.type'],
    ['m', 'entity.name.label'], ['follow', 'keyword.control'], ['links', 'keyword.control'], ['when', 'keyword.control'],
    ['when', 'keyword.control'], ['lost', 'support.function'], ['->', 'keyword.operator.arrow'], ['a.b', 'entity.name.label'],
    ['spawn', 'keyword.control'], ['Key', 'entity.name.type'], ['destroy', 'keyword.control'], ['self', 'variable.language'],
  ]);
  looks("entity A {\n    envelope (x', y') by (by, fixed) directions any {\n        attack over 0.2s to to\n        sustain for 1\n        release to 0\n        while x < hold\n    }\n    envelope attack fixed { sustain attack }\n}", [
    ['envelope', 'storage.type'], ['x', 'variable.other'], ['by', 'keyword.control'], ['by', 'variable.other'], ['fixed', 'variable.other'],
    ['directions', 'keyword.control'], ['any', 'variable.other.constant'], ['attack', 'keyword.control'], ['over', 'keyword.control'],
    ['to', 'keyword.control'], ['to', 'variable.other'], ['sustain', 'keyword.control'], ['for', 'keyword.control'],
    ['release', 'keyword.control'], ['to', 'keyword.control'], ['while', 'keyword.control'], ['hold', 'variable.other'],
    ['envelope', 'storage.type'], ['attack', 'variable.other'], ['fixed', 'keyword.control'], ['sustain', 'keyword.control'],
    ['attack', 'variable.other'],
  ]);
});

test('tags, in quotes, too', () => {
  looks('entity A {\n    collider body, "question block": rect(0, 0, 16, 16) when in big\n    mode m { when touching(body, "question block", below) as e and e is Slime { x := 1 } }\n}', [
    ['collider', 'storage.type'], ['body', 'entity.name.tag'], ['"question block"', 'string.quoted.double.tag'], ['when', 'keyword.control'],
    ['touching', 'support.function'], ['"question block"', 'string.quoted.double'], ['as', 'keyword.operator.word'], ['e', 'variable.other'],
    ['is', 'keyword.operator.word'], ['Slime', 'entity.name.type'],
  ]);
  looks('world W {\n    collide a, body with "question block": block from above, keep velocity\n    collide a with above: block, carry\n}', [
    ['collide', 'keyword.control'], ['body', 'entity.name.tag'], ['with', 'keyword.control'], ['"question block"', 'string.quoted.double.tag'],
    ['block', 'storage.modifier'], ['from', 'storage.modifier'], ['above', 'storage.modifier'], ['keep', 'storage.modifier'],
    ['velocity', 'storage.modifier'], ['collide', 'keyword.control'], ['above', 'entity.name.tag'], ['carry', 'storage.modifier'],
  ]);
});

test('maps are strings, whatever their tiles are', () => {
  looks('world W {\n    space s {\n        map level "// why\n            when}{//\n            goal\'\'\n        "\n        place a: A at (0, 0)\n    }\n}', [
    ['map', 'keyword.control'], ['level', 'entity.name.namespace'], ['"', 'string.quoted.double.map'], ['// why', 'comment.line.double-slash'],
    ['when}{//', 'string.quoted.double.map'], ["goal''", 'string.quoted.double.map'], ['"', 'string.quoted.double.map'],
    ['place', 'keyword.control'], ['a', 'variable.other'], ['A', 'entity.name.type'], ['at', 'keyword.control'],
  ]);
});

test('settings of what tiles spawn', () => {
  looks("world W {\n    tiles t 16 x 16 {\n        'G': spawn Ghost as g { pac = hero; x' = 3 } // why\n        'B': spawn Ghost\n        {\n            speed = 40\n        }\n        '#': wall\n    }\n    space s {\n        map tiled \"a.tmx\" {\n            blob: spawn Slime {\n                speed = 2\n            }\n            rock: wall\n        }\n    }\n}", [
    ['spawn', 'keyword.control'], ['Ghost', 'entity.name.type'], ['as', 'keyword.control'], ['g', 'variable.other'],
    ['pac', 'variable.other'], ['=', 'keyword.operator.assignment'], ['hero', 'variable.other'], ['x', 'variable.other'],
    ["'", 'keyword.operator.prime'], ['3', 'constant.numeric'], ['// why', 'comment.line.double-slash'],
    ['Ghost', 'entity.name.type'], ['speed', 'variable.other'], ['40', 'constant.numeric'], ['#', 'constant.character.tile'],
    ['wall', 'entity.name.tag'], ['blob', 'entity.name.tag'], ['Slime', 'entity.name.type'], ['speed', 'variable.other'],
    ['2', 'constant.numeric'], ['rock', 'entity.name.tag'], ['wall', 'entity.name.tag'],
  ]);
});

test('characters of tiles', () => {
  looks("world W {\n    tiles x tile x (2 * x) {\n        '}': wall; ''': \"a b\"\n        'S': spawn Slime as as_it_is\n    }\n    limit Slime 3\n}", [
    ['tiles', 'storage.type'], ['x', 'entity.name.namespace'], ['tile', 'variable.other'], ['x', 'keyword.control'], ['x', 'variable.other'],
    ['}', 'constant.character.tile'], ['wall', 'entity.name.tag'], ["'", 'punctuation.definition.character'],
    ["'", 'constant.character.tile'], ['"a b"', 'string.quoted.double.tag'], ['S', 'constant.character.tile'],
    ['spawn', 'keyword.control'], ['Slime', 'entity.name.type'], ['as', 'keyword.control'], ['as_it_is', 'variable.other'],
    ['limit', 'keyword.control'],
  ]);
});

test('maps from files, links, rectangles', () => {
  looks("world W {\n    space s {\n        map vglc \"a.txt\" legend \"b.json\" tile 16 x 16 { 'E': spawn Slime }\n        bounds rect(0, 0, 1, 1)\n        wrap vertical\n        rect wall, ice (0, 0, 1, 1)\n        link rect(0, 0, 1, 1) -> t at rect(0, 0, 1, 1) when hero.keys > 0\n    }\n    space t { map level legend \"b.json\" tile 8 x 8 }\n    space u { map level from \"a.txt\" }\n    space v { map level cave }\n}", [
    ['map', 'keyword.control'], ['vglc', 'keyword.control'], ['"a.txt"', 'string.quoted.double'], ['legend', 'keyword.control'],
    ['tile', 'keyword.control'], ['16', 'constant.numeric'], ['x', 'keyword.control'], ['E', 'constant.character.tile'], ['Slime', 'entity.name.type'],
    ['bounds', 'keyword.control'], ['rect', 'storage.type'], ['wrap', 'keyword.control'], ['rect', 'storage.type'], ['wall', 'entity.name.tag'], ['ice', 'entity.name.tag'],
    ['link', 'keyword.control'], ['t', 'entity.name.namespace'], ['at', 'keyword.control'], ['when', 'keyword.control'],
    ['keys', 'variable.other.member'], ['space', 'storage.type'], ['level', 'keyword.control'], ['legend', 'keyword.control'],
    ['level', 'entity.name.namespace'], ['from', 'keyword.control'], ['level', 'keyword.control'], ['cave', 'entity.name.namespace'],
  ]);
});

test('maps from editors, and what their names stand for', () => {
  looks("world W {\n    space s {\n        map ldtk \"a.ldtk\" level \"Cave\" {\n            level: spawn Slime as ldtk\n            \"a b\": wall,\n                tiled // why\n            'E': spike\n        }\n        map level\n        map tiled \"b.tmx\"\n        map tiled from \"c.txt\"\n        place a: A at (0, 0) { level = tiled }\n    }\n}", [
    ['map', 'keyword.control'], ['ldtk', 'keyword.control'], ['"a.ldtk"', 'string.quoted.double'], ['level', 'keyword.control'],
    ['"Cave"', 'string.quoted.double'], ['level', 'entity.name.tag'], ['spawn', 'keyword.control'], ['Slime', 'entity.name.type'],
    ['as', 'keyword.control'], ['ldtk', 'variable.other'], ['"a b"', 'string.quoted.double.tag'], ['wall', 'entity.name.tag'],
    ['tiled', 'entity.name.tag'], ['// why', 'comment.line.double-slash'], ['E', 'constant.character.tile'], ['spike', 'entity.name.tag'],
    ['map', 'keyword.control'], ['level', 'keyword.control'], ['map', 'keyword.control'], ['tiled', 'keyword.control'],
    ['"b.tmx"', 'string.quoted.double'], ['map', 'keyword.control'], ['tiled', 'entity.name.namespace'], ['from', 'keyword.control'],
    ['place', 'keyword.control'], ['level', 'variable.other'], ['tiled', 'variable.other'],
  ]);
});

test('numbers, units, dimensions', () => {
  looks('entity A {\n    param speed: px/s^2 = 1.5s\n    discrete n: int -1..9 = 0\n    mode m { when timer > 250ms or timer > 12frames and ms > 3 { x := 1 } }\n}', [
    ['px/s^2', 'support.type.dimension'], ['1.5', 'constant.numeric'], ['s', 'keyword.other.unit'],
    ['int', 'support.type'], ['-', 'keyword.operator.arithmetic'], ['1', 'constant.numeric'], ['..', 'keyword.operator.range'],
    ['timer', 'variable.language'], ['250', 'constant.numeric'], ['ms', 'keyword.other.unit'], ['12', 'constant.numeric'],
    ['frames', 'keyword.other.unit'], ['ms', 'variable.other'],
  ]);
});

test('comments and documentation', () => {
  looks('/// documentation\n//// a comment\nconst a = 1 // after', [
    ['/// documentation', 'comment.line.documentation'], ['//// a comment', 'comment.line.double-slash'], ['// after', 'comment.line.double-slash'],
  ]);
});
