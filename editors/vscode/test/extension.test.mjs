// The extension in a stand-in for VS Code, with a stand-in for the language client and a real hypedc.
//
// HYPEDC=PATH npm run test:hypedc

import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import Module, { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';

const hypedc = process.env.HYPEDC ?? 'hypedc';
const root = join(import.meta.dirname, '../../..');
const manifest = JSON.parse(readFileSync(join(import.meta.dirname, '../package.json'), 'utf8'));

/** What was seen, and what the stand-ins answer. */
const seen = { commands: new Map(), clients: [], errors: [], panels: [], tasks: [], output: '', picks: [], listeners: [] };
const answers = { settings: { path: hypedc }, input: '-*2', pick: undefined, start: async () => {} };

const uriOf = (path) => ({ scheme: 'file', fsPath: path, toString: () => pathToFileURL(path).href });
const documentOf = (path) => ({ uri: uriOf(path), languageId: 'hyped', isDirty: false, getText: () => readFileSync(path, 'utf8') });

const vscode = {
  Task: class {
    constructor(definition, scope, name, source, execution, matchers) {
      Object.assign(this, { definition, scope, name, source, execution, matchers });
    }
  },
  ProcessExecution: class {
    constructor(process, args, options) {
      Object.assign(this, { process, args, options });
    }
  },
  ProgressLocation: { Notification: 15 },
  TaskRevealKind: { Always: 1 },
  TaskScope: { Workspace: 2 },
  Uri: { parse: (text) => uriOf(decodeURIComponent(new URL(text).pathname)) },
  ViewColumn: { Beside: -2 },
  commands: {
    registerCommand: (name, body) => (seen.commands.set(name, body), { dispose() {} }),
    executeCommand: async () => {},
  },
  tasks: { executeTask: async (task) => seen.tasks.push(task) },
  window: {
    activeTextEditor: undefined,
    createOutputChannel: () => ({ appendLine: (text) => (seen.output += text), show() {}, dispose() {} }),
    createWebviewPanel: (kind, title, where) => {
      const panel = { kind, title, where, webview: { html: '' } };
      seen.panels.push(panel);
      return panel;
    },
    showErrorMessage: async (message) => void seen.errors.push(message),
    showInputBox: async () => answers.input,
    showQuickPick: async (choices) => (seen.picks.push(choices), answers.pick),
    withProgress: (_, work) => work({}, { onCancellationRequested() {} }),
  },
  workspace: {
    getConfiguration: () => ({ get: (name, otherwise) => answers.settings[name] ?? otherwise }),
    getWorkspaceFolder: () => undefined,
    onDidChangeConfiguration: (listener) => (seen.listeners.push(listener), { dispose() {} }),
    openTextDocument: async (uri) => documentOf(uri.fsPath),
  },
};

const client = {
  TransportKind: { stdio: 0 },
  LanguageClient: class {
    constructor(id, name, server, options) {
      Object.assign(this, { id, name, server, options, stopped: false });
      seen.clients.push(this);
    }
    start() {
      return answers.start();
    }
    async stop() {
      this.stopped = true;
    }
    async dispose() {}
  },
};

const load = Module._load;
Module._load = (name, ...more) => ({ vscode, 'vscode-languageclient/node': client })[name] ?? load(name, ...more);
const extension = createRequire(import.meta.url)('../dist/extension.test.cjs');
const state = new Map();
const context = { subscriptions: [], workspaceState: { get: (key, otherwise) => state.get(key) ?? otherwise, update: async (key, value) => state.set(key, value) } };
await extension.activate(context);

const link = join(root, 'examples/link.hyped');
const call = (name, ...args) => seen.commands.get(name)(...args);

test('all commands are there, and the server is started', () => {
  assert.deepEqual([...seen.commands.keys()].sort(), manifest.contributes.commands.map(({ command }) => command).sort());
  assert.deepEqual(seen.clients.map(({ server }) => [server.command, server.args]), [[hypedc, ['lsp']]]);
  assert.ok(seen.clients[0].options.documentSelector.every(({ language }) => language === 'hyped'));
});

test('a code lens searches, and the picture opens beside the text', async () => {
  await call('hypedc.reach', pathToFileURL(link).href, 'Dungeon', 'unlocked');
  const [panel] = seen.panels.splice(0);
  assert.equal(panel.title, 'Reach unlocked');
  assert.equal(panel.where.viewColumn, vscode.ViewColumn.Beside);
  assert.match(panel.webview.html, /goal unlocked: reached/);
  assert.match(panel.webview.html, /data:image\/svg\+xml;base64/);
  assert.deepEqual(seen.errors, []);
});

test('a code lens simulates what is typed, which is remembered', async () => {
  await call('hypedc.sim', pathToFileURL(link).href, 'Dungeon');
  assert.match(seen.output, /world Dungeon: 2 steps/);
  assert.deepEqual([...state.values()], ['-*2']);
});

test('without a world one is asked for where there are several', async () => {
  const several = join(mkdtempSync(join(tmpdir(), 'hyped-worlds-')), 'several.hyped');
  writeFileSync(several, `${readFileSync(link, 'utf8')}\nworld Void { }\n`);
  vscode.window.activeTextEditor = { document: documentOf(several) };
  seen.output = '';
  await call('hypedc.sim');
  assert.equal(seen.output, '', 'nothing was chosen');
  answers.pick = 'Void';
  await call('hypedc.sim');
  assert.match(seen.output, /world Void: 2 steps/);
  assert.deepEqual(seen.picks.splice(0), [['Dungeon', 'Void'], ['Dungeon', 'Void']]);
  vscode.window.activeTextEditor = { document: documentOf(link) };
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
  answers.settings.path = join(root, 'no/such/command');
  await call('hypedc.reach', pathToFileURL(link).href, 'Dungeon', 'unlocked');
  assert.match(seen.errors.splice(0).join(), /could not be run: .*ENOENT/);
  answers.start = async () => {
    throw new Error('no such command');
  };
  await Promise.all(seen.listeners.map((listener) => listener({ affectsConfiguration: (name) => name === 'hypedc.path' })));
  assert.equal(seen.clients.length, 2);
  assert.ok(seen.clients[0].stopped);
  assert.equal(seen.clients[1].server.command, answers.settings.path);
  assert.match(seen.errors.splice(0).join(), /could not be started.*no such command/);
});
