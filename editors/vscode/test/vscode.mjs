// A mock of the module `vscode`: documents that can be edited, providers that can be called, and a record of the
// output.
//
// It has the parts that the extension and its client, vscode-languageclient, use. Positions, ranges, documents and URIs
// behave as in VS Code; classes that the client only constructs and passes on, such as `Hover`, store their arguments.

import { readFileSync } from 'node:fs';
import Module from 'node:module';
import { setTimeout as pause } from 'node:timers/promises';
import { TextDocument } from 'vscode-languageserver-textdocument';
import { URI as Uri } from 'vscode-uri';

/** The recorded output. */
export const seen = {
  commands: new Map(),
  /** The diagnostics of each document, by its URI. */
  diagnostics: new Map(),
  errors: [],
  /** The commands that were run and are not the extension's: their names and arguments. */
  executed: [],
  /** The written text, by the name of the channel. */
  output: new Map(),
  panels: [],
  /** The test controller. */
  tests: undefined,
  picks: [],
  /** `[what, selector, provider]`, `what` being such as `Hover`. */
  providers: [],
  tasks: [],
  told: [],
};

/** The answers of the user, and the settings. */
export const answers = { settings: {}, input: undefined, pick: undefined };

class Emitter {
  #listeners = new Set();
  event = (listener, self) => {
    const bound = listener.bind(self);
    this.#listeners.add(bound);
    return { dispose: () => this.#listeners.delete(bound) };
  };
  fire(what) {
    return Promise.all([...this.#listeners].map((listener) => listener(what)));
  }
  dispose() {}
}

class Position {
  constructor(line, character) {
    Object.assign(this, { line, character });
  }
}

class Range {
  constructor(start, end, ...more) {
    if (more.length > 0) [start, end] = [new Position(start, end), new Position(...more)];
    Object.assign(this, { start, end });
  }
  contains({ line, character }) {
    const { start, end } = this;
    const isAfter = line > start.line || (line === start.line && character >= start.character);
    return isAfter && (line < end.line || (line === end.line && character <= end.character));
  }
}

/** A class whose objects store the constructor arguments under these names. */
const record = (...names) =>
  class {
    constructor(...values) {
      names.forEach((name, index) => values[index] !== undefined && (this[name] = values[index]));
    }
  };

/** An enumeration with values from `first`. */
const counted = (first, names) => Object.fromEntries(names.split(' ').map((name, index) => [name, first + index]));

class WorkspaceEdit {
  #edits = new Map();
  set(uri, edits) {
    this.#edits.set(uri.toString(), edits);
  }
  entries() {
    return [...this.#edits].map(([uri, edits]) => [Uri.parse(uri), edits]);
  }
}

class CancellationTokenSource {
  token = { isCancellationRequested: false, onCancellationRequested: new Emitter().event };
  cancel() {}
  dispose() {}
}

/** Kinds are paths with dots; VS Code's own kinds also have names. */
class CodeActionKind {
  static Empty = new this('');
  static QuickFix = new this('quickfix');
  static Source = new this('source');
  static SourceFixAll = new this('source.fixAll');
  constructor(value) {
    this.value = value;
  }
  append(part) {
    return new CodeActionKind(this.value ? `${this.value}.${part}` : part);
  }
}

const documents = new Map();
const events = new Map();
/** The emitter behind an event such as `onDidOpenTextDocument`. */
const emitter = (name) => events.get(name) ?? events.set(name, new Emitter()).get(name);
/** An object with every event, and the given members. */
const withEvents = (given) =>
  new Proxy(given, { get: (target, name) => (/^on(Did|Will)/.test(String(name)) ? emitter(name).event : target[name]) });

/** A text document. */
class Document {
  isDirty = false;
  constructor(uri, text) {
    this.uri = uri;
    this.fileName = uri.fsPath;
    this.text = TextDocument.create(uri.toString(), 'hyped', 1, text);
  }
  get languageId() {
    return this.text.languageId;
  }
  get version() {
    return this.text.version;
  }
  lineAt(line) {
    const text = this.getText().split('\n')[line];
    return { text, range: new Range(line, 0, line, text.length) };
  }
  positionAt(offset) {
    const { line, character } = this.text.positionAt(offset);
    return new Position(line, character);
  }
  get lineCount() {
    return this.text.lineCount;
  }
  getText(range) {
    return this.text.getText(range);
  }
  async save() {
    this.isDirty = false;
    return true;
  }
}

/** Opens a file in the active editor. */
export async function open(path) {
  const document = await vscode.workspace.openTextDocument(Uri.file(path));
  vscode.window.activeTextEditor = { document };
  return document;
}

/** Replaces the first occurrence of a text, as typing does. */
export async function type(document, old, text) {
  const offset = document.getText().indexOf(old);
  if (offset < 0) throw new Error(`no \`${old}\` in the document`);
  const range = new Range(...[offset, offset + old.length].map((at) => document.text.positionAt(at)));
  await change(document, [{ range, text }]);
}

async function change(document, changes) {
  const contentChanges = changes.map(({ range, text }) => ({
    range,
    rangeOffset: document.text.offsetAt(range.start),
    rangeLength: document.text.offsetAt(range.end) - document.text.offsetAt(range.start),
    text,
  }));
  TextDocument.update(document.text, contentChanges, document.version + 1);
  await emitter('onDidChangeTextDocument').fire({ document, contentChanges, reason: undefined });
}

/** Applies the edits of one document, from the last to the first, so that their ranges stay valid. */
export async function edit(document, edits) {
  const at = ({ range }) => document.text.offsetAt(range.start);
  await change(document, edits.toSorted((a, b) => at(b) - at(a)).map(({ range, newText }) => ({ range, text: newText })));
}

/** The position `offset` characters after the start of the first occurrence of a text. */
export function place(document, text, offset = 0) {
  const found = document.getText().indexOf(text);
  if (found < 0) throw new Error(`no \`${text}\` in the document`);
  const { line, character } = document.text.positionAt(found + offset);
  return new Position(line, character);
}

/** The method names of providers that differ from the name of the provider. */
const provided = { CodeLens: 'CodeLenses', CompletionItem: 'CompletionItems', DocumentFormattingEdit: 'DocumentFormattingEdits', Rename: 'RenameEdits' };

/** Calls the registered provider of a document: `ask('Hover', document, position)`. */
export async function ask(what, document, ...about) {
  const [, , provider] = seen.providers.find(([name, selector]) => name === what && vscode.languages.match(selector, document)) ?? [];
  if (!provider) throw new Error(`nobody provides: ${what}`);
  const invoked = { triggerKind: vscode.CompletionTriggerKind.Invoke, triggerCharacter: undefined };
  return provider[`provide${provided[what] ?? what}`](document, ...about, new CancellationTokenSource().token, invoked);
}

/** Waits until a condition holds. */
export async function until(what, holds) {
  for (const end = Date.now() + 20_000; Date.now() < end; await pause(20)) {
    const found = await holds();
    if (found) return found;
  }
  throw new Error(`never: ${what}`);
}

/** Changes a setting, and notifies the listeners. */
export function set(name, value) {
  answers.settings[name] = value;
  return emitter('onDidChangeConfiguration').fire({ affectsConfiguration: (section) => `hypedc.${name}`.startsWith(section) });
}

const channel = (name) => {
  const append = (text) => seen.output.set(name, (seen.output.get(name) ?? '') + text);
  return { name, append, appendLine: (text) => append(`${text}\n`), show() {}, clear() {}, dispose() {} };
};

/** The items of a test controller, or of an item. */
class TestItems extends Map {
  replace(items) {
    this.clear();
    for (const item of items) this.set(item.id, item);
  }
  add(item) {
    this.set(item.id, item);
  }
  forEach(each) {
    for (const item of this.values()) each(item);
  }
}

/** A test run that records what comes of its items. */
class TestRun {
  results = new Map();
  coverage = [];
  output = '';
  isOver = false;
  enqueued(item) {
    this.results.set(item.id, { state: 'queued' });
  }
  started(item) {
    this.results.set(item.id, { state: 'started' });
  }
  passed(item) {
    this.results.set(item.id, { state: 'passed' });
  }
  failed(item, messages) {
    this.results.set(item.id, { state: 'failed', messages: [messages].flat() });
  }
  errored(item, message) {
    this.results.set(item.id, { state: 'errored', messages: [message] });
  }
  skipped(item) {
    this.results.set(item.id, { state: 'skipped' });
  }
  appendOutput(text) {
    this.output += text;
  }
  addCoverage(file) {
    this.coverage.push(file);
  }
  end() {
    this.isOver = true;
  }
}

const api = {
  CancellationTokenSource,
  CodeActionKind,
  CodeLens: record('range', 'command'),
  CompletionItem: record('label', 'kind'),
  CompletionItemKind: counted(
    0,
    'Text Method Function Constructor Field Variable Class Interface Module Property Unit Value Enum Keyword Snippet Color File Reference Folder EnumMember Constant Struct Event Operator TypeParameter',
  ),
  CompletionTriggerKind: counted(0, 'Invoke TriggerCharacter TriggerForIncompleteCompletions'),
  Diagnostic: record('range', 'message', 'severity'),
  DiagnosticRelatedInformation: record('location', 'message'),
  DiagnosticSeverity: counted(0, 'Error Warning Information Hint'),
  Disposable: class {
    constructor(dispose) {
      this.dispose = dispose;
    }
  },
  EventEmitter: Emitter,
  Hover: record('contents', 'range'),
  Location: record('uri', 'range'),
  MarkdownString: class {
    constructor(value = '') {
      this.value = value;
    }
    appendCodeblock(code, language) {
      this.value += `\n\`\`\`${language}\n${code}\n\`\`\`\n`;
    }
  },
  Position,
  ProcessExecution: record('process', 'args', 'options'),
  ProgressLocation: { Notification: 15, Window: 10 },
  Range,
  SnippetString: record('value'),
  Task: record('definition', 'scope', 'name', 'source', 'execution', 'matchers'),
  TaskRevealKind: { Always: 1 },
  TaskScope: { Workspace: 2 },
  FileCoverage: class {
    static fromDetails = (uri, details) => ({ uri, details });
  },
  OverviewRulerLane: { Left: 1 },
  BranchCoverage: record('executed', 'location', 'label'),
  InlayHint: record('position', 'label', 'kind'),
  StatementCoverage: record('executed', 'location', 'branches'),
  TestMessage: record('message'),
  ThemeColor: record('id'),
  TestRunProfileKind: { Run: 1, Debug: 2, Coverage: 3 },
  TextEdit: class extends record('range', 'newText') {
    static replace = (range, text) => new this(range, text);
    static insert = (position, text) => new this(new Range(position, position), text);
    static delete = (range) => new this(range, '');
  },
  Uri,
  ViewColumn: { Beside: -2 },
  WorkspaceEdit,
  commands: {
    registerCommand: (name, body) => {
      if (seen.commands.has(name)) throw new Error(`command '${name}' already exists`);
      seen.commands.set(name, body);
      return { dispose: () => seen.commands.delete(name) };
    },
    executeCommand: async (name, ...about) => {
      if (!seen.commands.has(name)) seen.executed.push([name, ...about]);
      return seen.commands.get(name)?.(...about);
    },
  },
  env: { appName: 'a stand-in', language: 'en' },
  languages: new Proxy(
    {
      createDiagnosticCollection: () => ({
        set: (uri, list) => seen.diagnostics.set(uri.toString(), list),
        delete: (uri) => seen.diagnostics.delete(uri.toString()),
        clear: () => seen.diagnostics.clear(),
        dispose: () => seen.diagnostics.clear(),
      }),
      getDiagnostics: (uri) => seen.diagnostics.get(uri.toString()) ?? [],
      match: (selector, { languageId, uri }) =>
        [selector].flat().some(({ language = languageId, scheme = uri.scheme }) => language === languageId && scheme === uri.scheme) ? 10 : 0,
    },
    {
      get(known, name) {
        const what = /^register(.*)Provider$/.exec(String(name))?.[1];
        if (!what) return known[name];
        return (...given) => {
          // Workspace-wide providers have no selector.
          const [selector, provider] = given.length > 1 ? given : [[], ...given];
          const entry = [what, selector, provider];
          seen.providers.push(entry);
          return { dispose: () => (seen.providers = seen.providers.filter((other) => other !== entry)) };
        };
      },
    },
  ),
  tests: {
    createTestController: (id, label) => {
      const controller = {
        id,
        label,
        items: new TestItems(),
        profiles: [],
        runs: [],
        createTestItem: (id, label, uri) => ({ id, label, uri, children: new TestItems() }),
        createRunProfile: (label, kind, run) => {
          const profile = { label, kind, run };
          controller.profiles.push(profile);
          return profile;
        },
        createTestRun: () => {
          const run = new TestRun();
          controller.runs.push(run);
          return run;
        },
        dispose() {},
      };
      seen.tests = controller;
      return controller;
    },
  },
  tasks: { executeTask: async (task) => seen.tasks.push(task) },
  version: '1.91.0',
  window: withEvents({
    activeTextEditor: undefined,
    visibleTextEditors: [],
    tabGroups: withEvents({ all: [] }),
    createOutputChannel: channel,
    createTextEditorDecorationType: (options) => ({ options, dispose() {} }),
    createWebviewPanel: (kind, title, where) => {
      const ends = [];
      const panel = {
        ...{ kind, title, where, revealed: 0, reveal: () => panel.revealed++ },
        /** What the page was told. */
        said: [],
        /** The page says something. */
        receive: async () => {},
        webview: {
          html: '',
          postMessage: async (message) => panel.said.push(message),
          onDidReceiveMessage: (listener) => (panel.receive = listener),
        },
        onDidDispose: (listener) => ends.push(listener),
        dispose: () => ends.splice(0).forEach((end) => end()),
      };
      seen.panels.push(panel);
      return panel;
    },
    showTextDocument: async (document) => ({ document }),
    showErrorMessage: async (message) => void seen.errors.push(message),
    showInformationMessage: async (message) => void seen.told.push(message),
    showInputBox: async () => answers.input,
    showQuickPick: async (choices) => (seen.picks.push(choices), typeof answers.pick === 'function' ? answers.pick(choices) : answers.pick),
    withProgress: (_, work) => work({ report() {} }, new CancellationTokenSource().token),
  }),
  workspace: withEvents({
    workspaceFolders: undefined,
    get textDocuments() {
      return [...documents.values()];
    },
    getConfiguration: () => ({ get: (name, otherwise) => answers.settings[name] ?? otherwise }),
    findFiles: async () => [],
    registerTextDocumentContentProvider: (scheme, provider) => {
      seen.providers.push(['TextDocumentContent', scheme, provider]);
      return { dispose() {} };
    },
    getWorkspaceFolder: () => undefined,
    createFileSystemWatcher: () => withEvents({ dispose() {} }),
    openTextDocument: async (uri) => {
      const known = documents.get(uri.toString());
      if (known) return known;
      const document = new Document(uri, readFileSync(uri.fsPath, 'utf8'));
      documents.set(uri.toString(), document);
      await emitter('onDidOpenTextDocument').fire(document);
      return document;
    },
  }),
};

// Any other class of the module: the client only passes it on, or can do without it.
export const vscode = new Proxy(api, {
  get: (known, name) => (known[name] ??= /^[A-Z]/.test(String(name)) ? class extends record('first', 'second', 'third') {} : undefined),
});

/** Replaces modules in `require`; `vscode` is always this one. */
export function standIn(modules = {}) {
  const load = Module._load;
  Module._load = (name, ...more) => ({ vscode, ...modules })[name] ?? load(name, ...more);
}
