// The extension: the language server's client, and the commands that show what hypedc says.

import { readFile } from 'node:fs/promises';
import { basename, dirname } from 'node:path';
import { setTimeout } from 'node:timers/promises';
import * as vscode from 'vscode';
import { CloseAction, ErrorAction, ErrorCodes, LanguageClient, type LanguageClientOptions, type ServerOptions, TransportKind } from 'vscode-languageclient/node';
import { page, reach, simulate, worldsOf } from './hypedc';

/** A client that leaves it to `start` to say that there is no server. */
class Client extends LanguageClient {
  /** Whether the server has ever answered. */
  answered = false;

  override async start(): Promise<void> {
    await super.start();
    this.answered = true;
  }

  /** A client that could not be started cannot be stopped, either, which nobody needs to be told. */
  override async stop(timeout?: number): Promise<void> {
    await super.stop(timeout).catch(() => undefined);
  }

  override error(message: string, data?: unknown, show?: boolean | 'force'): void {
    super.error(message, data, this.answered ? show : false);
  }
}

let client: Client | undefined;
/** What the server says beside its answers. */
let log: vscode.OutputChannel;
/** The snippets of `contributes.snippets`, by their prefixes. */
let prefixes: Set<string>;

export async function activate(context: vscode.ExtensionContext): Promise<void> {
  const output = vscode.window.createOutputChannel('Hyped');
  log = vscode.window.createOutputChannel('Hyped Language Server');
  const snippets: Record<string, { prefix: string }> = JSON.parse(await readFile(context.asAbsolutePath('snippets/hyped.json'), 'utf8'));
  prefixes = new Set(Object.values(snippets).map(({ prefix }) => prefix));
  context.subscriptions.push(
    output,
    log,
    // Code lenses of the server call `sim` and `reach` with a URI, a world's name and, for a search, a goal's. They are
    // commands of the client: a server that said it executes them would have them registered twice.
    vscode.commands.registerCommand('hypedc.check', (uri?: string) => check(uri)),
    vscode.commands.registerCommand('hypedc.sim', (uri?: string, world?: string) => simulateCommand(context, output, uri, world)),
    vscode.commands.registerCommand('hypedc.reach', (uri?: string, world?: string, goal?: string) => reachCommand(uri, world, goal)),
    vscode.commands.registerCommand('hypedc.restart', restart),
    vscode.workspace.onDidChangeConfiguration((change) => change.affectsConfiguration('hypedc.path') && restart()),
  );
  await restart();
}

export async function deactivate(): Promise<void> {
  await turn;
  await end();
}

async function end(): Promise<void> {
  const old = client;
  client = undefined;
  await old?.dispose();
}

function command(): string {
  return vscode.workspace.getConfiguration('hypedc').get<string>('path') || 'hypedc';
}

async function start(): Promise<void> {
  const server: ServerOptions = { command: command(), args: ['lsp'], transport: TransportKind.stdio };
  const options: LanguageClientOptions = {
    documentSelector: [{ scheme: 'file', language: 'hyped' }, { scheme: 'untitled', language: 'hyped' }],
    // The owner of what the problem matcher finds, too: a finding of both is shown once.
    diagnosticCollectionName: 'hypedc',
    outputChannel: log,
    middleware: {
      // The editor itself offers the extension's snippets, with or without a server: the server's are not to come twice.
      provideCompletionItem: async (document, position, context, token, next) => {
        const found = await next(document, position, context, token);
        const items = Array.isArray(found) ? found : (found?.items ?? []);
        return items.filter(({ kind, label }) => kind !== vscode.CompletionItemKind.Snippet || !prefixes.has(wordOf(label)));
      },
    },
    // A server that ends before it has answered at all will not do better the next time: `start` says so, once.
    initializationFailedHandler: () => false,
    errorHandler: {
      error: (...what) => (starting.answered ? usual.error(...what) : { action: ErrorAction.Shutdown, handled: true }),
      closed: async () => {
        // The client forgets its promise to start as soon as this is answered.
        await begun.catch(() => undefined);
        return starting.answered ? usual.closed() : { action: CloseAction.DoNotRestart, handled: true };
      },
    },
  };
  const starting = new Client('hypedc', 'Hyped', server, options);
  const usual = starting.createDefaultErrorHandler();
  client = starting;
  const begun = starting.start();
  try {
    await begun;
  } catch (error) {
    // Highlighting and snippets work without it, so nothing waits for an answer.
    void complain(`The language server could not be started with \`${command()} lsp\`: ${reason(error)}`);
  }
}

/** Why a server does not start. That it has ended shows in two errors of the connection. */
function reason(error: unknown): string {
  const { code } = error as { code?: unknown };
  const hasEnded = code === ErrorCodes.PendingResponseRejected || code === ErrorCodes.MessageWriteError;
  return hasEnded ? 'it ends without an answer' : String(error);
}

/** The word that a completion begins with. */
function wordOf(label: string | vscode.CompletionItemLabel): string {
  return (typeof label === 'string' ? label : label.label).split(' ')[0];
}

let turn = Promise.resolve();

/** Starts the server anew; after what was begun before, so that there is never more than one. */
function restart(): Promise<void> {
  turn = turn.then(end).then(start);
  return turn;
}

async function complain(message: string): Promise<void> {
  const settings = 'Open Settings';
  const showLog = 'Show Log';
  const answer = await vscode.window.showErrorMessage(message, settings, showLog);
  if (answer === settings) await vscode.commands.executeCommand('workbench.action.openSettings', 'hypedc.path');
  if (answer === showLog) log.show();
}

/** The document that is meant, saved: the one of the URI, or the one in front. */
async function program(uri?: string | vscode.Uri): Promise<vscode.TextDocument | undefined> {
  const given = typeof uri === 'string' ? vscode.Uri.parse(uri) : uri;
  const document = given ? await vscode.workspace.openTextDocument(given) : vscode.window.activeTextEditor?.document;
  if (document?.languageId !== 'hyped' || document.uri.scheme !== 'file') {
    await vscode.window.showErrorMessage('Open a .hyped file first.');
    return undefined;
  }
  if (document.isDirty && !(await document.save())) return undefined;
  return document;
}

/** The world that is meant: undefined if the program has no choice, null if none was chosen. */
async function chooseWorld(document: vscode.TextDocument, world?: string): Promise<string | undefined | null> {
  const worlds = worldsOf(document.getText());
  if (world || worlds.length < 2) return world;
  return (await vscode.window.showQuickPick(worlds, { title: 'Which world?' })) ?? null;
}

async function check(uri?: string): Promise<void> {
  const document = await program(uri);
  if (!document) return;
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

/** Does some work; where it is not done at once, progress is shown, and cancelling it aborts the signal. */
async function withProgress<T>(title: string, work: (stop: AbortSignal) => Promise<T>): Promise<T | undefined> {
  const options = { location: vscode.ProgressLocation.Notification, title, cancellable: true };
  const stop = new AbortController();
  try {
    const working = work(stop.signal);
    // A notification that comes and goes in a blink is only a nuisance.
    const isQuick = await Promise.race([working.then(() => true), setTimeout(500, false)]);
    if (isQuick) return await working;
    return await vscode.window.withProgress(options, (_, token) => {
      token.onCancellationRequested(() => stop.abort());
      return working;
    });
  } catch (error) {
    await complain(`\`${command()}\` could not be run: ${String(error)}`);
    return undefined;
  }
}

async function simulateCommand(context: vscode.ExtensionContext, output: vscode.OutputChannel, uri?: string, world?: string): Promise<void> {
  const document = await program(uri);
  if (!document) return;
  const chosen = await chooseWorld(document, world);
  if (chosen === null) return;
  const key = `inputs ${document.uri.toString()} ${chosen ?? ''}`;
  const script = await vscode.window.showInputBox({
    title: 'Which inputs?',
    prompt: 'Steps separated by blanks: right*40 right+jump*12 -*10',
    value: context.workspaceState.get<string>(key, '-*60'),
  });
  if (script === undefined) return;
  await context.workspaceState.update(key, script);
  const file = document.uri.fsPath;
  const outcome = await withProgress('Simulating', (stop) => simulate(command(), { file, world: chosen }, script, stop));
  if (!outcome) return;
  output.appendLine(outcome.text);
  output.show(true);
}

/** The panels that are open, by what was asked. */
const panels = new Map<string, vscode.WebviewPanel>();

/** Shows a page beside the text: in the panel that has answered the question before, if there is one. */
function show(question: string, title: string, html: string): void {
  let panel = panels.get(question);
  if (panel) {
    panel.reveal(undefined, true);
  } else {
    panel = vscode.window.createWebviewPanel('hypedc.reach', title, { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true }, {});
    panel.onDidDispose(() => panels.delete(question));
    panels.set(question, panel);
  }
  panel.webview.html = html;
}

async function reachCommand(uri?: string, world?: string, goal?: string): Promise<void> {
  const document = await program(uri);
  if (!document) return;
  const chosen = await chooseWorld(document, world);
  if (chosen === null) return;
  const file = document.uri.fsPath;
  const more = vscode.workspace.getConfiguration('hypedc', document).get<string[]>('reach.arguments', []);
  const title = goal ? `Reach ${goal}` : `Reach ${chosen ?? basename(file)}`;
  const found = await withProgress(title, (stop) => reach(command(), { file, world: chosen, goal }, more, stop));
  if (!found) return;
  show(JSON.stringify([document.uri.toString(), chosen, goal]), title, page(title, found));
}
