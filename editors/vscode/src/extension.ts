// The extension: the client of the language server, and the commands that run hypedc and show its output.

import { readFile } from 'node:fs/promises';
import { basename, dirname } from 'node:path';
import { setTimeout } from 'node:timers/promises';
import * as vscode from 'vscode';
import {
  type ClientCapabilities,
  CloseAction,
  ErrorAction,
  ErrorCodes,
  LanguageClient,
  type LanguageClientOptions,
  type ServerOptions,
  type StaticFeature,
  TransportKind,
} from 'vscode-languageclient/node';
import { Charts } from './chart';
import { Explanations } from './explain';
import { picturesOf, type RunRecord, runText, type SearchRecord, searchText } from './answers';
import { page, reach, worldsOf } from './hypedc';
import { HypedServer, type Level, Levels, type World } from './server';
import { Paints } from './paint';
import { Tests } from './tests';
import { Timelines } from './timeline';
import { OutdatedVerdicts, type Verdicts } from './verdicts';

/** A client without error messages of its own until the server has responded: `startServer` reports a failed start. */
class Client extends LanguageClient {
  /** Whether the server has ever responded. */
  answered = false;

  override async start(): Promise<void> {
    await super.start();
    this.answered = true;
  }

  /** Ignores errors: a client that failed to start cannot be stopped. */
  override async stop(timeout?: number): Promise<void> {
    await super.stop(timeout).catch(() => undefined);
  }

  override error(message: string, data?: unknown, show?: boolean | 'force'): void {
    super.error(message, data, this.answered ? show : false);
  }
}

/** Announces the commands of the editor that the server may name in its answers. */
const commandsOfEditor: StaticFeature = {
  fillClientCapabilities(capabilities: ClientCapabilities): void {
    capabilities.experimental = { ...capabilities.experimental, commands: { commands: ['editor.action.triggerSuggest', 'hypedc.tile'] } };
  },
  initialize: () => undefined,
  getState: () => ({ kind: 'static' }),
  clear: () => undefined,
};

let client: Client | undefined;
/** The log of the server. */
let log: vscode.OutputChannel;
/** What is told when the server has started. */
const started: (() => void)[] = [];
/** What is out of date of the verdicts that the server told. */
let outdated: OutdatedVerdicts;
/** The prefixes of the snippets in `contributes.snippets`. */
let prefixes: Set<string>;

export async function activate(context: vscode.ExtensionContext): Promise<void> {
  const output = vscode.window.createOutputChannel('Hyped');
  log = vscode.window.createOutputChannel('Hyped Language Server');
  const snippets: Record<string, { prefix: string }> = JSON.parse(await readFile(context.asAbsolutePath('snippets/hyped.json'), 'utf8'));
  prefixes = new Set(Object.values(snippets).map(({ prefix }) => prefix));
  const server = new HypedServer(() => client);
  const levels = new Levels(server);
  const tests = new Tests(server, levels);
  const timelines = new Timelines(server, levels);
  const charts = new Charts(server, timelines);
  const paints = new Paints(server);
  const explanations = new Explanations(server);
  outdated = new OutdatedVerdicts();
  started.push(
    () => tests.listSoon(),
    () => timelines.restarted(),
  );
  const withWorld = async (uri: string | undefined, world: string | undefined, run: (at: vscode.Uri, world: World) => Promise<unknown>) => {
    const found = await worldOf(server, uri, world);
    if (found) await run(...found);
  };
  context.subscriptions.push(
    ...tests.disposables,
    ...timelines.disposables,
    ...charts.disposables,
    ...paints.disposables,
    ...explanations.disposables,
    ...outdated.disposables,
    vscode.commands.registerCommand('hypedc.paint', (uri?: string, world?: string) =>
      withWorld(uri, world, async (at, of) => {
        // An open map has nothing to paint without a level.
        if ((await levels.of(at.toString(), of)) !== null) await paints.toggle(at.toString(), of.name);
      }),
    ),
    vscode.commands.registerCommand('hypedc.timeline', (uri?: string, world?: string) =>
      withWorld(uri, world, (at, of) => timelines.open(at, of)),
    ),
    vscode.commands.registerCommand('hypedc.level', (uri?: string, world?: string) =>
      withWorld(uri, world, (at, of) => levels.choose(at.toString(), of.name)),
    ),
    vscode.commands.registerCommand('hypedc.saveTest', () => timelines.active?.saveTest()),
    vscode.commands.registerCommand('hypedc.saveInputs', () => timelines.active?.saveInputs()),
    vscode.commands.registerCommand('hypedc.chart', () => charts.open()),
    output,
    log,
    // Code lenses of the server call `sim` and `reach` with a URI, the name of a world and, for a search, of a goal.
    // The server does not announce these commands: the client would register them a second time.
    vscode.commands.registerCommand('hypedc.check', (uri?: string) => check(uri)),
    vscode.commands.registerCommand('hypedc.sim', (uri?: string, world?: string, level?: GivenLevel) =>
      simulateCommand(context, output, server, levels, { uri, world, level }),
    ),
    vscode.commands.registerCommand('hypedc.reach', (uri?: string, world?: string, name?: string, level?: GivenLevel, kind?: string) =>
      reachCommand(server, levels, { uri, world, level, [kind === 'never' ? 'never' : 'goal']: name }),
    ),
    vscode.commands.registerCommand('hypedc.play', (uri: string, world: string, goal: string, level: GivenLevel, inputs: string) =>
      playCommand(server, levels, { uri, world, level, goal }, inputs),
    ),
    vscode.commands.registerCommand('hypedc.restart', restart),
    vscode.workspace.onDidChangeConfiguration((change) => (change.affectsConfiguration('hypedc.path') || change.affectsConfiguration('hypedc.workspaceDiagnostics')) && restart()),
    vscode.workspace.onDidChangeConfiguration((change) => change.affectsConfiguration('hypedc.verdicts') && configure()),
  );
  await restart();
}

export async function deactivate(): Promise<void> {
  await restarts;
  await stopServer();
}

async function stopServer(): Promise<void> {
  const old = client;
  client = undefined;
  outdated.forget();
  await old?.dispose();
}

function command(): string {
  return vscode.workspace.getConfiguration('hypedc').get<string>('path') || 'hypedc';
}

function wantsVerdicts(): boolean {
  return vscode.workspace.getConfiguration('hypedc').get<boolean>('verdicts', true);
}

/** Tells the server whether verdicts are wanted. */
async function configure(): Promise<void> {
  await client?.sendNotification('workspace/didChangeConfiguration', { settings: { hypedc: { verdicts: wantsVerdicts() } } });
}

async function startServer(): Promise<void> {
  const server: ServerOptions = { command: command(), args: ['lsp'], transport: TransportKind.stdio };
  const options: LanguageClientOptions = {
    documentSelector: [{ scheme: 'file', language: 'hyped' }, { scheme: 'untitled', language: 'hyped' }],
    // The problem matcher has the same owner, so that a finding of both is shown once.
    diagnosticCollectionName: 'hypedc',
    outputChannel: log,
    // The commands of the server have the names of the extension's own.
    initializationOptions: {
      ownCommands: true,
      verdicts: wantsVerdicts(),
      workspaceDiagnostics: vscode.workspace.getConfiguration('hypedc').get<boolean>('workspaceDiagnostics', true),
      // The code of a finding is a link to its page.
      explainUri: 'command:hypedc.explain?%5B%22{code}%22%5D',
    },
    // Hovers of tiles ask about them.
    markdown: { isTrusted: { enabledCommands: ['hypedc.tile'] } },
    middleware: {
      // VS Code already offers the extension's snippets: drop the server's duplicates.
      provideCompletionItem: async (document, position, context, token, next) => {
        const found = await next(document, position, context, token);
        const items = Array.isArray(found) ? found : (found?.items ?? []);
        return items.filter(({ kind, label }) => kind !== vscode.CompletionItemKind.Snippet || !prefixes.has(wordOf(label)));
      },
    },
    // No restart of a server that ends before its first response: `startServer` reports it, once.
    initializationFailedHandler: () => false,
    errorHandler: {
      error: (...what) => (starting.answered ? usual.error(...what) : { action: ErrorAction.Shutdown, handled: true }),
      closed: async () => {
        // The client drops its pending start once this handler returns: wait for it first.
        await startup.catch(() => undefined);
        return starting.answered ? usual.closed() : { action: CloseAction.DoNotRestart, handled: true };
      },
    },
  };
  const starting = new Client('hypedc', 'Hyped', server, options);
  starting.registerFeature(commandsOfEditor);
  starting.onNotification('hypedc/verdicts', (told: Verdicts) => outdated.show(told));
  const usual = starting.createDefaultErrorHandler();
  client = starting;
  const startup = starting.start();
  try {
    await startup;
    started.forEach((tell) => tell());
  } catch (error) {
    // Not awaited: highlighting and snippets work without the server.
    void showError(`The language server could not be started with \`${command()} lsp\`: ${reason(error)}`);
  }
}

/** Why a server does not start. Two errors of the connection mean that it has ended. */
function reason(error: unknown): string {
  const { code } = error as { code?: unknown };
  const hasEnded = code === ErrorCodes.PendingResponseRejected || code === ErrorCodes.MessageWriteError;
  return hasEnded ? 'it ends without an answer' : String(error);
}

/** The first word of a completion label. */
function wordOf(label: string | vscode.CompletionItemLabel): string {
  return (typeof label === 'string' ? label : label.label).split(' ')[0];
}

let restarts = Promise.resolve();

/** Restarts the server, after any restart in progress, so that there is never more than one. */
function restart(): Promise<void> {
  restarts = restarts.then(stopServer).then(startServer);
  return restarts;
}

async function showError(message: string): Promise<void> {
  const settings = 'Open Settings';
  const showLog = 'Show Log';
  const answer = await vscode.window.showErrorMessage(message, settings, showLog);
  if (answer === settings) await vscode.commands.executeCommand('workbench.action.openSettings', 'hypedc.path');
  if (answer === showLog) log.show();
}

/** The document of a URI, or else of the active editor. */
async function program(uri?: string | vscode.Uri): Promise<vscode.TextDocument | undefined> {
  const given = typeof uri === 'string' ? vscode.Uri.parse(uri) : uri;
  const document = given ? await vscode.workspace.openTextDocument(given) : vscode.window.activeTextEditor?.document;
  if (document?.languageId === 'hyped') return document;
  await vscode.window.showErrorMessage('Open a .hyped file first.');
  return undefined;
}

/** A document as a file, for the command line: it is saved first. */
async function saved(document: vscode.TextDocument): Promise<boolean> {
  if (document.uri.scheme !== 'file') {
    await vscode.window.showErrorMessage('Save the program in a file first.');
    return false;
  }
  return !document.isDirty || document.save();
}

/** The world to run: undefined if the program has at most one, null if the user chose none. */
async function chooseWorld(document: vscode.TextDocument, world?: string): Promise<string | undefined | null> {
  const worlds = worldsOf(document.getText());
  if (world || worlds.length < 2) return world;
  return (await vscode.window.showQuickPick(worlds, { title: 'Which world?' })) ?? null;
}

/** A world of a document, or of the active editor; asks which one where there are several. */
async function worldOf(server: HypedServer, uri?: string, name?: string): Promise<[vscode.Uri, World] | undefined> {
  const at = typeof uri === 'string' ? vscode.Uri.parse(uri) : vscode.window.activeTextEditor?.document.uri;
  const [document] = at ? await server.runnable(at) : [];
  if (!at || !document) {
    await vscode.window.showErrorMessage('Open a .hyped file first.');
    return undefined;
  }
  const { worlds } = document;
  if (worlds.length === 0) {
    await vscode.window.showErrorMessage('The program has no world.');
    return undefined;
  }
  const names = worlds.map((world) => world.name);
  const chosen = name ?? (names.length > 1 ? await vscode.window.showQuickPick(names, { title: 'Which world?' }) : names[0]);
  const world = worlds.find((world) => world.name === chosen);
  return world && [at, world];
}

async function check(uri?: string): Promise<void> {
  const document = await program(uri);
  if (!document || !(await saved(document))) return;
  const folder = vscode.workspace.getWorkspaceFolder(document.uri);
  const task = new vscode.Task(
    { type: 'hypedc', file: document.uri.fsPath },
    folder ?? vscode.TaskScope.Workspace,
    `check ${basename(document.uri.fsPath)}`,
    'hypedc',
    new vscode.ProcessExecution(command(), ['check', '--format', 'short', document.uri.fsPath], { cwd: dirname(document.uri.fsPath) }),
    '$hypedc',
  );
  task.presentationOptions = { clear: true, reveal: vscode.TaskRevealKind.Always };
  await vscode.tasks.executeTask(task);
}

/** How far work is, for a person. */
type Tell = (message: string, percentage: number) => void;

/** Runs a task. If it takes long, shows a progress notification whose button cancels it. */
async function withProgress<T>(title: string, work: (token: vscode.CancellationToken, tell: Tell) => Promise<T>): Promise<T | undefined> {
  const options = { location: vscode.ProgressLocation.Notification, title, cancellable: true };
  const stop = new vscode.CancellationTokenSource();
  let show: Tell = () => undefined;
  try {
    const working = work(stop.token, (message, percentage) => show(message, percentage));
    // No notification for a quick task: it would only flash.
    const isQuick = await Promise.race([working.then(() => true), setTimeout(500, false)]);
    if (isQuick) return await working;
    return await vscode.window.withProgress(options, (progress, token) => {
      token.onCancellationRequested(() => stop.cancel());
      let last = 0;
      show = (message, percentage) => {
        progress.report({ message, increment: Math.max(0, percentage - last) });
        last = Math.max(last, percentage);
      };
      return working;
    });
  } catch (error) {
    if (!stop.token.isCancellationRequested) await vscode.window.showErrorMessage(error instanceof Error ? error.message : String(error));
    return undefined;
  } finally {
    stop.dispose();
  }
}

/** What the lenses of the server give to a command. */
interface Given {
  uri?: string;
  world?: string;
  level?: GivenLevel;
  goal?: string;
  never?: string;
}

/** The level of a lens: one that was chosen, or `ask` if none was. */
type GivenLevel = Level | 'ask' | null;

/** What a command of the server is about. */
interface About {
  uri: string;
  world?: string;
  level?: Level;
}

/** What a command is about: asks for what is not given. Undefined if the user chose none. */
async function targetOf(levels: Levels, given: Given): Promise<{ document: vscode.TextDocument; about: About } | undefined> {
  const document = await program(given.uri);
  if (!document) return undefined;
  const world = await chooseWorld(document, given.world);
  if (world === null) return undefined;
  const named = world ?? worldsOf(document.getText())[0];
  const uri = document.uri.toString();
  const level = named ? await levels.for(uri, named, given.level).catch(() => undefined) : undefined;
  if (level === null) return undefined;
  return { document, about: { uri, ...(named ? { world: named } : {}), ...(level ? { level } : {}) } };
}

async function simulateCommand(context: vscode.ExtensionContext, output: vscode.OutputChannel, server: HypedServer, levels: Levels, given: Given): Promise<void> {
  const target = await targetOf(levels, given);
  if (!target) return;
  const key = `inputs ${target.about.uri} ${target.about.world ?? ''}`;
  const inputs = await vscode.window.showInputBox({
    title: 'Which inputs?',
    prompt: 'Steps separated by blanks: right*40 right+jump*12 -*10',
    value: context.workspaceState.get<string>(key, '-*60'),
  });
  if (inputs === undefined) return;
  await context.workspaceState.update(key, inputs);
  const run = await withProgress('Simulating', (token, tell) => server.execute<RunRecord>('hypedc.sim', { ...target.about, inputs }, token, tell));
  if (!run) return;
  output.appendLine(runText(run));
  output.show(true);
}

/** Shows the run of inputs that were found. */
async function playCommand(server: HypedServer, levels: Levels, given: Given, inputs: string): Promise<void> {
  const target = await targetOf(levels, given);
  if (!target) return;
  const { uri, world } = target.about;
  const title = `Play ${given.goal ?? world ?? ''}`;
  const about = { ...target.about, inputs, picture: true };
  const run = await withProgress(title, (token, tell) => server.execute<RunRecord>('hypedc.sim', about, token, tell));
  if (!run) return;
  const text = `${runText(run)}\n\ninputs  ${inputs}`;
  show(JSON.stringify([uri, world, 'play', given.goal]), title, page(title, { text, pictures: picturesOf(run) }));
}

/** The open panels, by document, world and goal. */
const panels = new Map<string, vscode.WebviewPanel>();

/** Shows a page beside the editor; reuses the open panel with the same key. */
function show(key: string, title: string, html: string): void {
  let panel = panels.get(key);
  if (panel) {
    panel.reveal(undefined, true);
  } else {
    panel = vscode.window.createWebviewPanel('hypedc.reach', title, { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true }, {});
    panel.onDidDispose(() => panels.delete(key));
    panels.set(key, panel);
  }
  panel.webview.html = html;
}

/** Searches in the texts of the editor; with additional arguments of the command line, in the saved file. */
async function reachCommand(server: HypedServer, levels: Levels, given: Given): Promise<void> {
  const target = await targetOf(levels, given);
  if (!target) return;
  const { document, about } = target;
  const { goal, never } = given;
  const extra = vscode.workspace.getConfiguration('hypedc', document).get<string[]>('reach.arguments', []);
  const title = `Reach ${goal ?? never ?? about.world ?? basename(document.uri.path)}`;
  if (extra.length > 0 && !(await saved(document))) return;
  const found = await withProgress(title, async (token, tell) => {
    if (extra.length > 0) {
      const stop = new AbortController();
      token.onCancellationRequested(() => stop.abort());
      return reach(command(), { file: document.uri.fsPath, goal, never, ...about }, extra, stop.signal);
    }
    const asked = { ...about, picture: true, ...(goal ? { goals: [goal] } : {}), ...(never ? { nevers: [never] } : {}) };
    const record = await server.execute<SearchRecord>('hypedc.reach', asked, token, tell);
    return { text: searchText(record), pictures: picturesOf(record) };
  });
  if (found) show(JSON.stringify([about.uri, about.world, goal ?? never]), title, page(title, found));
}
