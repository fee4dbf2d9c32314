// Painted maps: the tiles of a world, shaded in the text by what a search and the known ways saw of them. A hover tells of a
// tile, plays the inputs that lead there, or asks whether one can get there.

import * as vscode from 'vscode';
import type { HypedServer, Level } from './server';

/** The map of a space, at its places in a text: tiles row by row from the highest. */
export interface PaintedSpace {
  space: string;
  uri: string;
  columns: number;
  rows: ({ line: number; columns: number[] } | null)[];
  kinds: { symbol: string; tags: string[] }[];
  kind: number[];
  first: (number | null)[];
  visits: number[];
  onWay: boolean[];
  stoodOn: boolean[];
}

export interface Painted {
  world: string;
  nodes: number;
  secondsPerStep: number;
  spaces: PaintedSpace[];
}

/** The answer about a tile. */
export interface TileAnswer {
  title: string;
  verdict: string;
  details: string[];
  steps: number | null;
  seconds: number | null;
  inputs: string | null;
  level: Level | null;
}

/** A tile of a painted map. */
export interface Tile {
  space: PaintedSpace;
  column: number;
  row: number;
  index: number;
}

/** How tiles are shaded: by when they were reached first, in four parts of the time; and apart from that, the ways. */
const SHADES = ['soon', 'later', 'late', 'last'] as const;
export type Shade = (typeof SHADES)[number] | 'way' | 'stood' | 'unseen';

/** The shade of a tile that players can be in or stand on; none of the inside of walls. */
export function shadeOf(space: PaintedSpace, index: number): Shade | undefined {
  if (space.onWay[index]) return 'way';
  const first = space.first[index];
  if (first !== null) {
    const last = space.first.reduce<number>((most, steps) => Math.max(most, steps ?? 0), 1);
    return SHADES[Math.min(3, Math.floor((4 * first) / (last + 1)))];
  }
  if (space.stoodOn[index]) return 'stood';
  return space.kinds[space.kind[index]]?.tags.length ? undefined : 'unseen';
}

/** The range of a tile in its text. */
export function rangeOf(space: PaintedSpace, index: number): vscode.Range | undefined {
  const row = space.rows[Math.floor(index / space.columns)];
  const column = index % space.columns;
  const [from, to] = [row?.columns[column], row?.columns[column + 1]];
  return row && from !== undefined && to !== undefined ? new vscode.Range(row.line, from, row.line, to) : undefined;
}

/** The tile at a position. */
export function tileAt(space: PaintedSpace, at: vscode.Position): Tile | undefined {
  const row = space.rows.findIndex((row) => row?.line === at.line);
  const columns = space.rows[row]?.columns ?? [];
  const column = columns.findIndex((from, column) => from <= at.character && at.character < (columns[column + 1] ?? -1));
  return row < 0 || column < 0 || column >= space.columns ? undefined : { space, column, row, index: row * space.columns + column };
}

/** What is told of a tile. */
export function tileText({ nodes, secondsPerStep }: Painted, { space, column, row, index }: Tile): string {
  const kind = space.kinds[space.kind[index]];
  const tags = kind?.tags.length ? kind.tags.join(', ') : 'empty';
  const lines = [`\`${kind?.symbol ?? '?'}\` ${tags}; column ${column + 1}, row ${row + 1} of \`${space.space}\``];
  const first = space.first[index];
  if (first !== null) {
    const on = space.onWay[index] ? ', on a way that was found' : '';
    lines.push(`first reached at step ${first} (${(first * secondsPerStep).toFixed(2)} s)${on}; ${space.visits[index]} visits`);
  } else {
    lines.push(`not reached with ${nodes} nodes of a search, which proves nothing`);
  }
  if (space.stoodOn[index]) lines.push('a player stood on it');
  return lines.join('  \n');
}

// Colours of the theme, so that light and dark ones are readable.
const decorate = (color: string, opacity?: string) =>
  vscode.window.createTextEditorDecorationType({ backgroundColor: new vscode.ThemeColor(color), opacity });
const decorations: Record<Shade, () => vscode.TextEditorDecorationType> = {
  soon: () => decorate('hyped.painted.soon'),
  later: () => decorate('hyped.painted.later'),
  late: () => decorate('hyped.painted.late'),
  last: () => decorate('hyped.painted.last'),
  way: () => decorate('hyped.painted.way'),
  stood: () =>
    vscode.window.createTextEditorDecorationType({ textDecoration: 'overline', color: new vscode.ThemeColor('hyped.painted.stood') }),
  unseen: () => decorate('hyped.painted.unseen'),
};

/** The painted maps of the open programs. */
export class Paints {
  private readonly shades = new Map<Shade, vscode.TextEditorDecorationType>();
  /** By the URI of the program: its document, and what was painted. */
  private readonly all = new Map<string, Painted>();
  private timer: NodeJS.Timeout | undefined;
  /** Tells of tiles, while something is painted. */
  private hovers: vscode.Disposable | undefined;

  constructor(private readonly server: HypedServer) {}

  get disposables(): vscode.Disposable[] {
    return [
      { dispose: () => this.shades.forEach((shade) => shade.dispose()) },
      vscode.commands.registerCommand('hypedc.tile', (uri: string, world: string, space: string, column: number, row: number, level?: Level | null) =>
        this.ask({ uri, world, space, column, row, level }),
      ),
      vscode.window.onDidChangeVisibleTextEditors(() => this.draw()),
      vscode.workspace.onDidChangeTextDocument(({ document, contentChanges }) => {
        if (contentChanges.length > 0) this.changed(document.uri.toString());
      }),
      { dispose: () => this.hovers?.dispose() },
    ];
  }

  /** Paints the maps of a world, or takes the paint away. */
  async toggle(uri: string, world: string): Promise<void> {
    const key = `${uri}#${world}`;
    if (this.all.delete(key)) return this.draw();
    await this.paint(uri, world);
  }

  /** Paints the maps of a world. */
  async paint(uri: string, world: string): Promise<void> {
    const title = `Painting the maps of ${world}`;
    try {
      const painted = await vscode.window.withProgress({ location: vscode.ProgressLocation.Window, title }, () => this.server.paint(uri, world));
      this.all.set(`${uri}#${world}`, painted);
    } catch (error) {
      // A newer text is painted once it is at rest.
      if ((error as { code?: number }).code !== -32801) {
        this.all.delete(`${uri}#${world}`);
        void vscode.window.showErrorMessage(`The maps of ${world} cannot be painted: ${error instanceof Error ? error.message : String(error)}`);
      }
    }
    this.draw();
  }

  /** A text has changed: what is painted is about an older one. It is painted again when the text is at rest. */
  private changed(uri: string): void {
    const affected = [...this.all].filter(([key, { spaces }]) => key.startsWith(`${uri}#`) || spaces.some((space) => space.uri === uri));
    if (affected.length === 0) return;
    for (const [key, painted] of affected) this.all.set(key, { ...painted, spaces: [] });
    this.draw();
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      for (const [key] of affected) {
        const at = key.lastIndexOf('#');
        if (this.all.has(key)) void this.paint(key.slice(0, at), key.slice(at + 1));
      }
    }, 1000);
  }

  private draw(): void {
    if (this.all.size === 0) {
      this.hovers?.dispose();
      this.hovers = undefined;
    } else {
      // In programs, the hovers of the server tell of tiles.
      this.hovers ??= vscode.languages.registerHoverProvider([{ pattern: '**/*.txt' }], {
        provideHover: (document, position) => this.hover(document, position),
      });
    }
    for (const editor of vscode.window.visibleTextEditors) {
      const ranges = new Map<Shade, vscode.Range[]>();
      for (const { spaces } of this.all.values()) {
        for (const space of spaces.filter(({ uri }) => uri === editor.document.uri.toString())) {
          space.kind.forEach((_, index) => {
            const [shade, range] = [shadeOf(space, index), rangeOf(space, index)];
            if (shade && range) ranges.set(shade, [...(ranges.get(shade) ?? []), range]);
          });
        }
      }
      for (const shade of Object.keys(decorations) as Shade[]) {
        if (ranges.has(shade) || this.shades.has(shade)) editor.setDecorations(this.decoration(shade), ranges.get(shade) ?? []);
      }
    }
  }

  private decoration(shade: Shade): vscode.TextEditorDecorationType {
    const known = this.shades.get(shade) ?? decorations[shade]();
    this.shades.set(shade, known);
    return known;
  }

  private hover(document: vscode.TextDocument, position: vscode.Position): vscode.Hover | undefined {
    for (const [key, painted] of this.all) {
      for (const space of painted.spaces.filter(({ uri }) => uri === document.uri.toString())) {
        const tile = tileAt(space, position);
        if (!tile) continue;
        const program = key.slice(0, key.lastIndexOf('#'));
        const about = encodeURIComponent(JSON.stringify([program, painted.world, space.space, tile.column, tile.row]));
        const action = space.first[tile.index] === null ? 'Can one get here?' : 'Play the inputs that lead here';
        const text = new vscode.MarkdownString(`${tileText(painted, tile)}\n\n[${action}](command:hypedc.tile?${about})`);
        text.isTrusted = { enabledCommands: ['hypedc.tile'] };
        return new vscode.Hover(text, rangeOf(space, tile.index));
      }
    }
    return undefined;
  }

  /** Asks for the inputs that lead to a tile, and plays them. */
  private async ask(about: { uri: string; world: string; space: string; column: number; row: number; level?: Level | null }): Promise<TileAnswer | undefined> {
    const { uri, world, space, column, row } = about;
    const options = { location: vscode.ProgressLocation.Window, title: `Searching for a way to column ${column + 1}, row ${row + 1}` };
    try {
      const found = await vscode.window.withProgress(options, () => this.server.wayTo({ uri, world, space, column, row }));
      if (found.inputs) {
        await vscode.commands.executeCommand('hypedc.play', uri, world, `column ${column + 1}, row ${row + 1}`, found.level, found.inputs);
      } else {
        void vscode.window.showInformationMessage([`Column ${column + 1}, row ${row + 1}: ${found.title}`, ...found.details].join('; '));
      }
      return found;
    } catch (error) {
      void vscode.window.showErrorMessage(error instanceof Error ? error.message : String(error));
      return undefined;
    }
  }
}
