// Tests of the commands with a real hypedc.
//
// HYPEDC=PATH npm run test:hypedc

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { page, reach, run, worldsOf } from '../dist/hypedc.mjs';

const hypedc = process.env.HYPEDC ?? 'hypedc';
const root = join(import.meta.dirname, '../../..');
const file = join(root, 'examples/link.hyped');
const { contributes } = JSON.parse(readFileSync(join(import.meta.dirname, '../package.json'), 'utf8'));

test('worlds of a program', () => {
  assert.deepEqual(worldsOf('world A { }\n// world B { }\n  world Élan\n{ goal world_x: a }\nentity world_ { }'), ['A', 'Élan']);
});

test('a search shows what it says and draws a picture', async () => {
  const found = await reach(hypedc, { file, world: 'Dungeon', goal: 'unlocked' }, ['--nodes', '100000']);
  assert.equal(found.code, 0, found.text);
  assert.match(found.text, /goal unlocked: reached/);
  assert.deepEqual(found.pictures.map(({ title }) => title), ['unlocked']);
  assert.match(found.pictures[0].svg, /^<svg|<\?xml/);
  const html = page('Reach <unlocked>', found);
  assert.match(html, /<title>Reach &#60;unlocked&#62;<\/title>/);
  assert.match(html, /<img alt="unlocked" src="data:image\/svg\+xml;base64,[A-Za-z0-9+/=]{100,}">/);
});

test('several goals have a picture each', async () => {
  const found = await reach(hypedc, { file: join(root, 'examples/homing.hyped') }, ['--nodes', '20000']);
  assert.deepEqual(found.pictures.map(({ title }) => title), ['open', 'out'], found.text);
});

test('a search can be stopped, and tells what it has', { timeout: 60_000 }, async () => {
  const stop = new AbortController();
  setTimeout(() => stop.abort(), 1000);
  // The exhaustive planner proves that there is no path here.
  const endless = ['--after', '-*100 right*97', '--planner', 'rrt', '--nodes', '1000000000'];
  const found = await reach(hypedc, { file: join(root, 'examples/paper/test1.hyped') }, endless, stop.signal);
  assert.equal(found.code, 1, found.text);
  assert.match(found.text, /stopped before the budget of nodes was spent/);
});

test('a command that is not there is told', async () => {
  await assert.rejects(run(join(root, 'no/such/command'), [], file), /ENOENT/);
});

test('the problem matcher reads what check prints', async () => {
  const wrong = join(root, 'tests/ui/dimensions.hyped');
  const { text } = await run(hypedc, ['check', '--format', 'short', wrong], wrong);
  const [{ pattern }] = contributes.problemMatchers;
  const found = text.trimEnd().split('\n').map((line) => {
    const match = new RegExp(pattern.regexp).exec(line);
    assert.ok(match, line);
    return { file: match[pattern.file], line: Number(match[pattern.line]), severity: match[pattern.severity], code: match[pattern.code] };
  });
  assert.ok(found.length > 0);
  assert.ok(found.every(({ file, line, severity }) => file === wrong && line > 0 && severity === 'error'), text);
  assert.ok(found.some(({ code }) => code === 'E0302'), text);
});

test('code lenses find their commands', () => {
  const commands = contributes.commands.map(({ command }) => command);
  assert.ok(commands.includes('hypedc.reach') && commands.includes('hypedc.sim'), commands);
});
