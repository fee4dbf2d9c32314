// The extension: the language server's client, and the commands that show what hypedc says.

import { basename, dirname } from 'node:path';
import * as vscode from 'vscode';
import { LanguageClient, type LanguageClientOptions, type ServerOptions, TransportKind } from 'vscode-languageclient/node';
import { page, reach, simulate, worldsOf } from './hypedc';

let client: LanguageClient | undefined;

export async function activate(context: vscode.ExtensionContext): Promise<void> {
  const output = vscode.window.createOutputChannel('Hyped');
  context.subscriptions.push(
    output,
    // Code lenses of the server call `sim` and `reach` with a URI, a world's name and, for a search, a goal's. They are
    // commands of the client: a server that said it executes them would have them registered twice.
    vscode.commands.registerCommand('hypedc.check', (uri?: string) => check(uri)),
    vscode.commands.registerCommand('hypedc.sim', (uri?: string, world?: string) => simulateCommand(context, output, uri, world)),
    vscode.commands.registerCommand('hypedc.reach', (uri?: string, world?: string, goal?: string) => reachCommand(uri, world, goal)),
    vscode.commands.registerCommand('hypedc.restart', restart),
    vscode.workspace.onDidChangeConfiguration((change) => change.affectsConfiguration('hypedc.path') && restart()),
  );
  await start();
}

export async function deactivate(): Promise<void> {
  await end(client);
}

/** Stops a client; one that could not be started refuses, which is as well. */
async function end(old?: LanguageClient): Promise<void> {
  await old?.stop().catch(() => undefined);
  await old?.dispose().catch(() => undefined);
}

function command(): string {
  return vscode.workspace.getConfiguration('hypedc').get<string>('path') || 'hypedc';
}

async function start(): Promise<void> {
  const server: ServerOptions = { command: command(), args: ['lsp'], transport: TransportKind.stdio };
  const options: LanguageClientOptions = {
    documentSelector: [{ scheme: 'file', language: 'hyped' }, { scheme: 'untitled', language: 'hyped' }],
  };
  client = new LanguageClient('hypedc', 'Hyped', server, options);
  try {
    await client.start();
  } catch (error) {
    // Highlighting and snippets work without it, so nothing waits for an answer.
    void complain(`The language server could not be started with \`${command()} lsp\`: ${String(error)}`);
  }
}

async function restart(): Promise<void> {
  const old = client;
  client = undefined;
  await end(old);
  await start();
}

async function complain(message: string): Promise<void> {
  const settings = 'Open Settings';
  if ((await vscode.window.showErrorMessage(message, settings)) === settings) {
    await vscode.commands.executeCommand('workbench.action.openSettings', 'hypedc.path');
  }
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

/** Shows progress until `work` is done; cancelling it aborts the signal. */
async function withProgress<T>(title: string, work: (stop: AbortSignal) => Promise<T>): Promise<T | undefined> {
  const options = { location: vscode.ProgressLocation.Notification, title, cancellable: true };
  try {
    return await vscode.window.withProgress(options, (_, token) => {
      const stop = new AbortController();
      token.onCancellationRequested(() => stop.abort());
      return work(stop.signal);
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
  const panel = vscode.window.createWebviewPanel('hypedc.reach', title, { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true }, {});
  panel.webview.html = page(title, found);
}
