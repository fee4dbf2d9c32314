// Tests of the extension with a mock of VS Code, a mock of the language client and a real hypedc.
//
// HYPEDC=PATH npm run test:hypedc

import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { answers, open, seen, set, standIn, vscode } from './vscode.mjs';

const hypedc = process.env.HYPEDC ?? 'hypedc';
const root = join(import.meta.dirname, '../../..');
const here = join(import.meta.dirname, '..');
const manifest = JSON.parse(readFileSync(join(here, 'package.json'), 'utf8'));

const clients = [];
/** The requests to the server. */
const asked = [];
let begin = async () => {};
const client = {
  CloseAction: { DoNotRestart: 1 },
  ErrorAction: { Shutdown: 2 },
  ErrorCodes: { PendingResponseRejected: -32097, MessageWriteError: -32099 },
  TransportKind: { stdio: 0 },
  LanguageClient: class {
    constructor(id, name, server, options) {
      Object.assign(this, { id, name, server, options, stopped: false });
      clients.push(this);
    }
    start() {
      return begin();
    }
    async stop() {
      this.stopped = true;
    }
    dispose() {
      return this.stop();
    }
    createDefaultErrorHandler() {}
    onNotification(method, tell) {
      this.told = { ...this.told, [method]: tell };
    }
    registerFeature(feature) {
      this.features = [...(this.features ?? []), feature];
    }
    isRunning() {
      return !this.stopped;
    }
    onProgress() {
      return { dispose() {} };
    }
    async sendRequest(method, about) {
      asked.push([method, about]);
      if (method === 'hypedc/levels') return { isOpen: false, chosen: null, levels: [] };
      const [{ uri, world }] = about.arguments;
      const run = { file: new URL(uri).pathname, world, inputs: '', steps: 2, seconds_of_play: 2 / 60, end: null };
      return { ...run, instances: [], goals: [], nevers: [], broken: null };
    }
  },
};

answers.settings.path = hypedc;
answers.input = '-*2';
standIn({ 'vscode-languageclient/node': client });
const extension = createRequire(import.meta.url)('../dist/extension.test.cjs');
const state = new Map();
const context = {
  subscriptions: [],
  workspaceState: { get: (key, otherwise) => state.get(key) ?? otherwise, update: async (key, value) => state.set(key, value) },
  asAbsolutePath: (path) => join(here, path),
};
await extension.activate(context);

const link = join(root, 'examples/link.hyped');
const call = (name, ...args) => seen.commands.get(name)(...args);

test('all commands are there, and the server is started', () => {
  assert.deepEqual([...seen.commands.keys()].sort(), manifest.contributes.commands.map(({ command }) => command).sort());
  assert.deepEqual(clients.map(({ server }) => [server.command, server.args]), [[hypedc, ['lsp']]]);
  assert.ok(clients[0].options.documentSelector.every(({ language }) => language === 'hyped'));
});

test('the client announces the commands that the server may name', () => {
  const capabilities = {};
  clients[0].features.forEach((feature) => feature.fillClientCapabilities(capabilities));
  assert.deepEqual(capabilities.experimental.commands.commands, ['editor.action.triggerSuggest', 'hypedc.tile']);
  const { workspaceDiagnostics, ownCommands, explainUri } = clients[0].options.initializationOptions;
  assert.deepEqual([workspaceDiagnostics, ownCommands], [true, true]);
  // What VS Code makes of a link to a command.
  const { path, query } = vscode.Uri.parse(explainUri.replace('{code}', 'E0201'));
  assert.deepEqual([path, JSON.parse(query)], ['hypedc.explain', ['E0201']]);
  assert.equal(manifest.contributes.configurationDefaults['[hyped]']['editor.formatOnType'], true);
});

test('with arguments of its own a search runs on the command line, and the picture opens beside the text', async () => {
  answers.settings['reach.arguments'] = ['--nodes', '100000'];
  await call('hypedc.reach', pathToFileURL(link).href, 'Dungeon', 'unlocked');
  const [panel] = seen.panels.splice(0);
  assert.equal(panel.title, 'Reach unlocked');
  assert.equal(panel.where.viewColumn, vscode.ViewColumn.Beside);
  assert.match(panel.webview.html, /goal unlocked: reached/);
  assert.doesNotMatch(panel.webview.html, /drawn/, 'the picture is shown, and its file is gone');
  assert.match(panel.webview.html, /data:image\/svg\+xml;base64/);
  assert.deepEqual(seen.errors, []);

  panel.webview.html = '';
  await call('hypedc.reach', pathToFileURL(link).href, 'Dungeon', 'unlocked');
  assert.deepEqual(seen.panels, [], 'the panel is taken again');
  assert.deepEqual([panel.revealed, panel.webview.html !== ''], [1, true]);
});

test('a code lens simulates what is typed, which is remembered', async () => {
  await call('hypedc.sim', pathToFileURL(link).href, 'Dungeon');
  assert.match(seen.output.get('Hyped'), /world Dungeon: 2 steps/);
  assert.deepEqual([...state.values()], ['-*2']);
  // The server is asked, which has the text of the editor.
  const [method, { command, arguments: [about] }] = asked.at(-1);
  assert.deepEqual([method, command, about], ['workspace/executeCommand', 'hypedc.sim', { uri: pathToFileURL(link).href, world: 'Dungeon', inputs: '-*2' }]);
});

test('without a world one is asked for where there are several', async () => {
  const several = join(mkdtempSync(join(tmpdir(), 'hyped-worlds-')), 'several.hyped');
  writeFileSync(several, `${readFileSync(link, 'utf8')}\nworld Void { }\n`);
  await open(several);
  seen.output.clear();
  await call('hypedc.sim');
  assert.equal(seen.output.get('Hyped'), undefined, 'nothing was chosen');
  answers.pick = 'Void';
  await call('hypedc.sim');
  assert.match(seen.output.get('Hyped'), /world Void: 2 steps/);
  assert.deepEqual(seen.picks.splice(0), [['Dungeon', 'Void'], ['Dungeon', 'Void']]);
  await open(link);
  await call('hypedc.sim');
  assert.deepEqual(seen.picks, [], 'one world is no choice');
});

test('checking is a task with the problem matcher', async () => {
  await call('hypedc.check', pathToFileURL(link).href);
  const [task] = seen.tasks.splice(0);
  assert.equal(task.matchers, `$${manifest.contributes.problemMatchers[0].name}`);
  assert.deepEqual([task.execution.process, ...task.execution.args], [hypedc, 'check', '--format', 'short', link]);
});

test('no program, no question', async () => {
  vscode.window.activeTextEditor = undefined;
  await call('hypedc.reach');
  assert.deepEqual(seen.errors.splice(0), ['Open a .hyped file first.']);
  assert.deepEqual(seen.panels, []);
});

test('a path that is not there is told, and a new one starts the server anew', async () => {
  const path = join(root, 'no/such/command');
  answers.settings.path = path;
  await call('hypedc.reach', pathToFileURL(link).href, 'Dungeon', 'unlocked');
  assert.match(seen.errors.splice(0).join(), /ENOENT/);
  begin = async () => {
    throw new Error('no such command');
  };
  await set('path', path);
  assert.equal(clients.length, 2);
  assert.ok(clients[0].stopped);
  assert.equal(clients[1].server.command, path);
  assert.match(seen.errors.splice(0).join(), /could not be started.*no such command/);
});

test('a goal whose verdict is out of date fades until it is asked again', async () => {
  const document = await open(join(root, 'examples/car.hyped'));
  const editor = { document, faded: [], setDecorations: (type, ranges) => (editor.faded = type.options.opacity ? ranges : editor.faded) };
  vscode.window.visibleTextEditors = [editor];
  const of = (name, isCurrent) => ({ world: 'Speedway', kind: 'goal', name, isCurrent });
  const tell = (verdicts) => clients.at(-1).told['hypedc/verdicts']({ uri: document.uri.toString(), verdicts });
  const lines = () => editor.faded.map(({ start }) => document.lineAt(start.line).text.trim().slice(0, 8));
  tell([of('half', true), of('lap', false), of('gone', false)]);
  assert.deepEqual(lines(), ['goal lap']);
  tell([of('half', true), of('lap', true)]);
  assert.deepEqual(lines(), []);
  vscode.window.visibleTextEditors = [];
});
