// Requests to the language server beside those of the protocol: commands that run a program, what can be run, play sessions.

import * as vscode from 'vscode';
import type { LanguageClient } from 'vscode-languageclient/node';
import type { Painted, TileAnswer } from './paint';

/** A place in a file: lines and columns from 1. */
export interface Place {
  path: string;
  line: number;
  column: number;
  end_line: number;
  end_column: number;
}

/** A name in a document. */
export interface Named {
  name: string;
  range: LspRange;
  selectionRange: LspRange;
}

export interface LspRange {
  start: { line: number; character: number };
  end: { line: number; character: number };
}

/** What can be run of a world. */
export interface World extends Named {
  /** Whether a map is left open: it needs a level. */
  isOpen: boolean;
  goals: Named[];
  nevers: Named[];
  tests: Named[];
}

/** The worlds of a document. */
export interface Runnable {
  uri: string;
  worlds: World[];
}

/** A part of a predicate, with its values. */
export interface Atom {
  text: string;
  held: boolean | null;
  sides: [number, number] | null;
}

/** A range of VS Code. */
export function rangeOf({ start, end }: LspRange): vscode.Range {
  return new vscode.Range(start.line, start.character, end.line, end.character);
}

/** The location of a place. */
export function locationOf({ path, line, column, end_line, end_column }: Place): vscode.Location {
  return new vscode.Location(vscode.Uri.file(path), new vscode.Range(line - 1, column - 1, end_line - 1, end_column - 1));
}

/** A level: the options of the command line, with paths. */
export interface Level {
  map: string;
  legend?: string;
  tile?: [number, number];
}

/** What is known about the levels of a world. */
export interface KnownLevels {
  /** Whether the world leaves its map open. */
  isOpen: boolean;
  chosen: Level | null;
  /** Files that may be levels; `why` tells why one does not fit. */
  levels: { map: string; name: string; fits: boolean; why: string | null }[];
}

/** The levels of worlds that leave their map open. The server keeps what was chosen. */
export class Levels {
  constructor(private readonly server: HypedServer) {}

  /** The URI of the level of a world; asks for one if none was chosen. Undefined if none is needed, null if none was chosen. */
  async of(uri: string, world: World, isAsked = true): Promise<string | undefined | null> {
    if (!world.isOpen) return undefined;
    const { chosen } = await this.server.levels(uri, world.name, false);
    if (chosen) return vscode.Uri.file(chosen.map).toString();
    return isAsked ? this.choose(uri, world.name) : null;
  }

  /** The level for a command about a world, which may be given; undefined if none is needed, null if none was chosen. */
  async for(uri: string, world: string, given?: Level | 'ask' | null): Promise<Level | undefined | null> {
    if (given && given !== 'ask') return given;
    const { isOpen, chosen } = await this.server.levels(uri, world, false);
    if (!isOpen) return undefined;
    if (chosen) return chosen;
    const map = await this.choose(uri, world);
    return map === null ? null : { map: vscode.Uri.parse(map).fsPath };
  }

  /** Asks for a level of a world; the server remembers it. */
  async choose(uri: string, world: string): Promise<string | null> {
    const { levels } = await this.server.levels(uri, world, true);
    const items = levels.map(({ map, name, why }) => ({ label: name, description: why ?? undefined, map }));
    if (items.length === 0) {
      await vscode.window.showErrorMessage(`The world ${world} leaves its map open, and there is no level beside the program.`);
      return null;
    }
    const chosen = await vscode.window.showQuickPick(items, { title: `Which level for ${world}?`, matchOnDescription: true });
    if (!chosen) return null;
    await this.server.chooseLevel(uri, world, { map: chosen.map });
    return vscode.Uri.file(chosen.map).toString();
  }
}

/** The server, while it runs. */
export class HypedServer {
  constructor(private readonly client: () => LanguageClient | undefined) {}

  private running(): LanguageClient {
    const client = this.client();
    if (!client?.isRunning()) throw new Error('the language server does not run');
    return client;
  }

  get isRunning(): boolean {
    return this.client()?.isRunning() ?? false;
  }

  /** Runs a command on the texts of the editor; `report` is told how far it is. */
  async execute<T>(command: string, about: object, token?: vscode.CancellationToken, report?: (message: string, percentage: number) => void): Promise<T> {
    const client = this.running();
    const workDoneToken = `hypedc-editor-${++tokens}`;
    const progress = client.onProgress(workDone, workDoneToken, (value) => report?.(value.message ?? '', value.percentage ?? 0));
    try {
      const params = { command, arguments: [about], workDoneToken };
      // An undefined token would count as a parameter.
      return await client.sendRequest<T>('workspace/executeCommand', params, ...(token ? [token] : []));
    } finally {
      progress.dispose();
    }
  }

  /** What can be run in a document, or in all programs of the workspace. */
  runnable(uri?: vscode.Uri): Promise<Runnable[]> {
    const params = uri ? { textDocument: { uri: uri.toString() } } : {};
    return this.running().sendRequest<Runnable[]>('hypedc/tests', params);
  }

  /** The level that was chosen for a world; with all files that may be levels, if they are wanted. */
  levels(uri: string, world: string, all: boolean): Promise<KnownLevels> {
    return this.running().sendRequest<KnownLevels>('hypedc/levels', { textDocument: { uri }, world, all });
  }

  /** Chooses a level for a world. */
  chooseLevel(uri: string, world: string, level: Level | null): Promise<void> {
    return this.running().sendRequest('hypedc/chooseLevel', { textDocument: { uri }, world, level });
  }

  /** What was seen of the tiles of a world. */
  paint(uri: string, world: string): Promise<Painted> {
    return this.running().sendRequest<Painted>('hypedc/paint', { textDocument: { uri }, world });
  }

  /** Whether one can get to a tile. */
  wayTo({ uri, ...about }: { uri: string; world: string; space: string; column: number; row: number }): Promise<TileAnswer> {
    return this.running().sendRequest<TileAnswer>('hypedc/wayTo', { textDocument: { uri }, ...about });
  }

  /** The page of a code. */
  explain(code: string): Promise<{ code: string; title: string; markdown: string }> {
    return this.running().sendRequest('hypedc/explain', { code });
  }

  /** The page of a play session. */
  page(): Promise<string> {
    return this.running().sendRequest<string>('hypedc/page');
  }

  /** Asks a play session. */
  play<T>(params: object): Promise<T> {
    return this.running().sendRequest<T>('hypedc/play', params);
  }

  /** The text of a document with a new test. */
  record(params: object): Promise<{ uri: string; text: string }> {
    return this.running().sendRequest('hypedc/record', params);
  }
}

let tokens = 0;

/** The type of work-done progress. */
const workDone = { _: undefined } as unknown as import('vscode-languageclient').ProgressType<{ kind: string; message?: string; percentage?: number }>;
