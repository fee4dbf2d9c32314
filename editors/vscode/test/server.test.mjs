// Tests of the packaged extension with its client, vscode-languageclient, and the real server, with a mock of VS Code.
//
// HYPEDC=PATH npm run test:server

import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, test } from 'node:test';
import { answers, ask, edit, open, place, seen, set, standIn, type, until, vscode } from './vscode.mjs';

standIn();
const extension = createRequire(import.meta.url)('../dist/extension.js');
const here = join(import.meta.dirname, '..');
const folder = mkdtempSync(join(tmpdir(), 'hyped-server-'));
const write = (name, text) => (writeFileSync(join(folder, name), text), join(folder, name));

const slime = write('slime.hyped', `/// Creeps along.
entity Slime {
    param speed = 20

    collider enemy: rect(0, 0, 16, 16)

    mode creeping {
        x' = speed
        when x > 50 -> resting
    }
    mode resting {
        x' = 0
    }
}
`);
const game = write('game.hyped', `import "slime.hyped"

world Cave {
    step 1/60

    space main {
        bounds rect(0, 0, 320, 32)
        place first: Slime at (0, 0)
        place second: Slim at (32, 0) { speed = 40 }
    }

      goal over: first.x > 40
}
`);

const closed = write('closed.hyped', 'entity A { mode a { when true -> nowhere } }\n');

vscode.workspace.workspaceFolders = [{ uri: vscode.Uri.file(folder), name: 'slimes', index: 0 }];
answers.settings.path = process.env.HYPEDC ?? 'hypedc';
// What the server remembers stays here.
process.env.XDG_CACHE_HOME = join(folder, 'cache');
const context = {
  subscriptions: [],
  workspaceState: { get: (_, otherwise) => otherwise, update: async () => {} },
  asAbsolutePath: (path) => join(here, path),
};
await extension.activate(context);
after(() => extension.deactivate());

const document = await open(game);
const other = await open(slime);
const errors = () => (seen.diagnostics.get(document.uri.toString()) ?? []).filter(({ severity }) => severity === vscode.DiagnosticSeverity.Error);
/** Repeats a request until it has a result: the server responds with its current state. */
const answer = (what, ...about) => until(what, async () => (await ask(what, ...about)) ?? undefined);
const labels = (items) => items.map(({ label }) => (typeof label === 'string' ? label : label.label));

test('findings of an opened document are shown', async () => {
  await until('a finding', () => errors().length === 1);
  const [found] = errors();
  assert.equal(found.code.value, 'E0201');
  assert.equal(found.source, 'hypedc');
  assert.match(found.message, /Slim/);
  assert.deepEqual(found.range, new vscode.Range(8, 22, 8, 26));
});

test('the code of a finding is a link to its page, which opens as Markdown', async () => {
  const [found] = errors();
  assert.equal(found.code.target.toString(true), 'command:hypedc.explain?["E0201"]');
  await vscode.commands.executeCommand('hypedc.explain', 'E0201');
  const [name, uri] = seen.executed.splice(0).find(([name]) => name.startsWith('markdown'));
  assert.equal(name, 'markdown.showPreviewToSide');
  const [, , provider] = seen.providers.find(([what]) => what === 'TextDocumentContent');
  assert.match(await provider.provideTextDocumentContent(uri), /^# E0201: /);
  vscode.window.activeTextEditor = { document, selection: { active: found.range.start } };
  await vscode.commands.executeCommand('hypedc.explain');
  assert.equal(seen.executed.splice(0).find(([name]) => name.startsWith('markdown'))[1].path, 'E0201.md');
  vscode.window.activeTextEditor = undefined;
});

test('findings of programs that are not open are shown', async () => {
  const uri = vscode.Uri.file(closed).toString();
  await until('a finding', () => seen.diagnostics.get(uri)?.length > 0);
  assert.equal(seen.diagnostics.get(uri)[0].code.value, 'E0201');
});

test('a finding has its fix, and goes with it', async () => {
  const [found] = errors();
  const about = { diagnostics: [found], only: undefined, triggerKind: 1 };
  const actions = await answer('CodeActions', document, found.range, about);
  const [[uri, edits]] = actions.find(({ isPreferred }) => isPreferred).edit.entries();
  assert.equal(uri.toString(), document.uri.toString());
  await edit(document, edits);
  assert.match(document.getText(), /place second: Slime at/);
  await until('no finding', () => errors().length === 0);
});

test('findings follow what is typed', async () => {
  await type(document, 'first.x > 40', 'firs.x > 40');
  await until('a finding', () => errors().length === 1);
  await type(document, 'firs.x > 40', 'first.x > 40');
  await until('no finding', () => errors().length === 0);
});

test('one goes to where an entity is defined, in another file', async () => {
  const found = [await answer('Definition', document, place(document, 'Slime at'))].flat();
  assert.deepEqual(found.map(({ uri, range }) => [uri.fsPath, range.start]), [[slime, new vscode.Position(1, 7)]]);
});

test('what is pointed at is told', async () => {
  const { contents } = await answer('Hover', document, place(document, 'Slime at'));
  const text = [contents].flat().map(({ value }) => value).join('\n');
  assert.match(text, /entity Slime/);
  assert.match(text, /Creeps along/);
});

test('modes are offered after an arrow, and no snippet comes twice', async () => {
  const modes = await answer('CompletionItem', other, place(other, 'resting'));
  assert.deepEqual(labels(modes).sort(), ['creeping', 'resting']);

  const offered = await answer('CompletionItem', other, new vscode.Position(0, 0));
  assert.ok(labels(offered).includes('entity'), labels(offered));
  const own = Object.values(JSON.parse(readFileSync(join(here, 'snippets/hyped.json'), 'utf8'))).map(({ prefix }) => prefix);
  const twice = offered.filter(({ kind, label }) => kind === vscode.CompletionItemKind.Snippet && own.includes(label.split(' ')[0]));
  assert.deepEqual(labels(twice), []);
});

test('an item that opens a bracket asks the editor for the list again', async () => {
  const items = await answer('CompletionItem', other, place(other, 'x > 50'));
  const touching = items.find(({ label }) => labels([{ label }])[0].startsWith('touching'));
  assert.equal(touching.command.command, 'editor.action.triggerSuggest');
});

test('an entity is renamed in both files', async () => {
  const changes = await answer('Rename', document, place(document, 'Slime at'), 'Ooze');
  for (const [uri, edits] of changes.entries()) await edit(await vscode.workspace.openTextDocument(uri), edits);
  assert.match(document.getText(), /first: Ooze at[\s\S]*second: Ooze at/);
  assert.match(other.getText(), /entity Ooze \{/);
  await until('no finding', () => errors().length === 0);
});

test('the document gets its layout', async () => {
  await edit(document, await answer('DocumentFormattingEdit', document, { tabSize: 4, insertSpaces: true }));
  assert.match(document.getText(), /\n    goal over/);
});

test('the lenses of the server are commands of the extension', async () => {
  const lenses = await until('lenses', async () => {
    const found = await ask('CodeLens', document);
    return found?.length === 3 && found;
  });
  assert.deepEqual(lenses.map(({ command }) => command.command), ['hypedc.sim', 'hypedc.play', 'hypedc.reach']);
  assert.match(lenses[1].command.title, /^✓ [\d.]+ s · play$/);
  // The commands read the documents, not the files.
  assert.notEqual(readFileSync(game, 'utf8'), document.getText());
  answers.input = '-*3';
  for (const { command } of lenses) await vscode.commands.executeCommand(command.command, ...command.arguments);
  assert.match(seen.output.get('Hyped'), /world Cave: 3 steps/);
  assert.deepEqual(seen.errors, []);
  assert.match(seen.panels[0]?.webview.html, /goal over: reached[\s\S]*data:image\/svg/);
  assert.match(seen.panels[1]?.webview.html, /goal over: reached[\s\S]*data:image\/svg/);
});

const walk = write('walk.hyped', `entity Walker { param speed = 60
    axis horizontal

    mode walking {
        x' = speed * horizontal
        when x > 10 -> far
    }
    mode far {
        x' = speed * horizontal
    }
}

world Road {
    step 1/60

    space main {
        bounds rect(0, 0, 320, 32)
        place hero: Walker at (0, 0)
    }
    player 1: hero

    goal there: hero.x > 20
    never back: hero.x < 0

    test "it goes" {
        inputs "right*30"
        expect hero.x > 20 at end
    }
}
`);

/** Runs some items of the test explorer. */
async function runTests(kind, ...include) {
  const profile = seen.tests.profiles.find((profile) => profile.kind === kind);
  await profile.run({ include, exclude: [] }, new vscode.CancellationTokenSource().token);
  return seen.tests.runs.at(-1);
}

test('the test explorer runs the text of the editor, and shows a failure at its line with its values', async () => {
  const document = await open(walk);
  await seen.tests.refreshHandler?.();
  const file = await until('the tests of the file', async () => seen.tests.items.get(document.uri.toString()));
  const world = [...file.children.values()][0];
  assert.deepEqual([...world.children.values()].map(({ label, description }) => [label, description]), [['it goes', undefined], ['there', 'goal'], ['back', 'never']]);
  let run = await runTests(vscode.TestRunProfileKind.Run, file);
  const states = () => [...run.results].map(([id, { state }]) => [id.split('#')[1], state]);
  assert.deepEqual(states(), [['Road/test it goes', 'passed'], ['Road/goal there', 'passed'], ['Road/never back', 'failed']]);
  assert.match(run.results.get(`${document.uri}#Road/never back`).messages[0].message, /inputs: left/);

  await type(document, 'expect hero.x > 20', 'expect hero.x > 20.5 and hero.x > 400');
  run = await runTests(vscode.TestRunProfileKind.Run, [...world.children.values()][0]);
  const [message] = run.results.get(`${document.uri}#Road/test it goes`).messages;
  assert.equal(message.location.uri.toString(), document.uri.toString());
  assert.equal(message.location.range.start.line, 26);
  assert.match(message.message, /hero.x > 400 does not hold: 30 and 400/);
  assert.ok(run.isOver);

  run = await runTests(vscode.TestRunProfileKind.Coverage, file);
  const [covered] = run.coverage;
  assert.equal(covered.uri.fsPath, walk);
  assert.deepEqual(covered.details.map(({ executed, location }) => [location.start.line, executed > 0]), [[3, true], [7, true], [5, true]]);
  await type(document, 'hero.x > 20.5 and hero.x > 400', 'hero.x > 20');
});

test('the page plays the text of the editor, lights the modes of a frame, and shows the values of guards', async () => {
  const document = await open(walk);
  const editor = { document, decorations: new Map(), setDecorations: (type, places) => editor.decorations.set(type.options, places) };
  vscode.window.visibleTextEditors.push(editor);
  seen.panels.length = 0;
  await vscode.commands.executeCommand('hypedc.timeline', document.uri.toString(), 'Road');
  const [panel] = seen.panels;
  assert.match(panel.webview.html, /<html lang="en" data-world="Road">[\s\S]*Content-Security-Policy/);
  const asked = async (request) => {
    const id = panel.said.length + 1000;
    await panel.receive({ id, request });
    return panel.said.find((said) => said.id === id).answer;
  };
  assert.equal((await asked({ ask: 'open', world: 'Road' })).scene.world, 'Road');
  await asked({ ask: 'load', script: 'right*20' });
  /** The lines that are lit. */
  const lines = () => [...editor.decorations.values()].flat().map(({ range }) => range?.start.line).filter((line) => line !== undefined);
  await asked({ ask: 'seek', frame: 5 });
  await until('the first mode', () => lines().join() === '3');
  const whole = new vscode.Range(0, 0, 99, 0);
  const providers = seen.providers.filter(([what]) => what === 'InlayHints').map(([, , provider]) => provider);
  const values = async () => {
    const all = await Promise.all(providers.map((provider) => provider.provideInlayHints(document, whole, new vscode.CancellationTokenSource().token)));
    return all.flat().flatMap(({ position, label }) => (/[✓✗]/.test(String(label)) ? [[position.line, label]] : []));
  };
  await until('the values of the guard', async () => JSON.stringify(await values()) === '[[5,"✗ 4 > 10"]]');
  await asked({ ask: 'seek', frame: 15 });
  await until('the second mode', () => lines().join() === '7');
  // The text is played as it is typed.
  await type(document, 'x > 10', 'x > 18');
  await until('the change', () => panel.said.some(({ changed }) => changed?.includes(walk)));
  await asked({ ask: 'reload' });
  await until('the first mode again', () => lines().join() === '3');
  // The run becomes a test.
  answers.pick = 'there';
  answers.input = 'by hand';
  await asked({ ask: 'load', script: 'right*30' });
  vscode.workspace.applyEdit = async (changes) => {
    for (const [uri, edits] of changes.entries()) await edit(await vscode.workspace.openTextDocument(uri), edits);
    return true;
  };
  vscode.WorkspaceEdit.prototype.replace = function (uri, range, newText) {
    this.set(uri, [{ range, newText }]);
  };
  await vscode.commands.executeCommand('hypedc.saveTest');
  assert.match(document.getText(), /test "by hand" \{\n {8}inputs "right\*30"\n {8}expect there at end/);
  panel.dispose();
  assert.deepEqual(lines(), []);
  vscode.window.visibleTextEditors.pop();
});

const map = write('map.hyped', `entity Hero {
    button right
    collider body: rect(0, 0, 8, 8)
    mode still {
        x' = 0
        when held(right) -> going
    }
    mode going {
        x' = 60
        when not held(right) -> still
    }
}
world Land {
    step 1/60
    collide body with wall: block
    tiles land 16 x 16 {
        '.': empty
        '#': wall
    }
    space main {
        map level land
        place hero: Hero at (0, 16)
    }
    player 1: hero
    goal over: hero.x > 40
}
`);
const level = write('level.txt', '........\n.....#..\n########\n');

test('an open map asks for its level, an edit turns a verdict, and what it breaks is found', async () => {
  const document = await open(map);
  const titles = async () => ((await ask('CodeLens', document)) ?? []).map(({ command }) => command.title);
  await until('a lens that asks', async () => (await titles()).includes('choose a level'));
  answers.pick = (items) => items.find(({ label }) => label === 'level.txt');
  await vscode.commands.executeCommand('hypedc.level', document.uri.toString(), 'Land');
  const offered = seen.picks.at(-1).map(({ label, description }) => [label, Boolean(description)]);
  assert.deepEqual(offered, [['level.txt', false]]);
  await until('a verdict', async () => (await titles()).some((title) => /^✓ [\d.]+ s · play$/.test(title)));
  assert.ok((await titles()).includes('level: level.txt'));
  await type(document, "x' = 60", "x' = 0");
  await until('another verdict', async () => (await titles()).some((title) => title.startsWith('✗ proven: ')));
  const broken = () => (seen.diagnostics.get(document.uri.toString()) ?? []).filter(({ code }) => code === 'broken-goal');
  await until('what is broken', () => broken().length === 1);
  assert.match(broken()[0].message, /this edit broke `goal over`[\s\S]*from before: they come nearest/);
  await type(document, "x' = 0\n        when not", "x' = 60\n        when not");
  await until('nothing broken', () => broken().length === 0);
});

test('maps are painted in the text of the level, and a tile tells of itself', async () => {
  const document = await open(map);
  const text = await open(level);
  const editor = { document: text, decorations: new Map(), setDecorations: (type, places) => editor.decorations.set(type.options, places) };
  vscode.window.visibleTextEditors.push(editor);
  await vscode.commands.executeCommand('hypedc.paint', document.uri.toString(), 'Land');
  const painted = ({ backgroundColor }) => backgroundColor?.id === 'hyped.painted.way';
  const ranges = [...editor.decorations].filter(([options]) => painted(options)).flatMap(([, ranges]) => ranges);
  assert.deepEqual(ranges[0], new vscode.Range(1, 0, 1, 1));
  // The extension's own hovers come beside those of the client.
  const [, , tiles] = seen.providers.filter(([what]) => what === 'Hover').at(-1);
  const hover = async (line, column) => tiles.provideHover(text, new vscode.Position(line, column))?.contents;
  assert.match((await hover(1, 1)).value, /`\.` empty; column 2, row 2 of `main`[\s\S]*first reached at step \d+[\s\S]*Play the inputs that lead here/);
  assert.match((await hover(0, 7)).value, /not reached with \d+ nodes of a search, which proves nothing[\s\S]*Can one get here\?/);
  // The inputs are played.
  seen.panels.length = 0;
  const found = await vscode.commands.executeCommand('hypedc.tile', document.uri.toString(), 'Land', 'main', 1, 1);
  assert.match(found.inputs, /right/);
  assert.match(seen.panels[0].webview.html, /data:image\/svg/);
  const other = await vscode.commands.executeCommand('hypedc.tile', document.uri.toString(), 'Land', 'main', 7, 1);
  assert.match(other.title, /^✗ proven/);
  await vscode.commands.executeCommand('hypedc.paint', document.uri.toString(), 'Land');
  assert.deepEqual([...editor.decorations.values()].flat(), [], 'the paint is taken away');
  vscode.window.visibleTextEditors.pop();
});

test('the server starts anew, with all that is open', async () => {
  await type(document, 'first.x', 'firs.x');
  await until('a finding', () => errors().length === 1);
  await vscode.commands.executeCommand('hypedc.restart');
  await until('a finding of the new server', () => errors().length === 1);
  const providers = seen.providers.filter(([what]) => what === 'Hover');
  assert.equal(providers.length, 1, 'the old one is gone');
});

test('a command that is no server is told of once, and the next one serves', async () => {
  const path = answers.settings.path;
  // Ends immediately.
  await set('path', process.execPath);
  assert.equal(seen.errors.length, 1, seen.errors.join('\n'));
  assert.match(seen.errors.splice(0)[0], /could not be started with `.*node lsp`: it ends without an answer/);
  await set('path', path);
  await until('a finding', () => errors().length === 1);
  assert.deepEqual(seen.errors, []);
});
