// Plays the program beside its text, as it is in the editor: the page of `hypedc play` in a webview, whose requests the
// language server answers. The modes that are active in the frame that is shown are lit in the text; guards show their values.

import { readFile, writeFile } from 'node:fs/promises';
import { basename, dirname, join } from 'node:path';
import * as vscode from 'vscode';
import { type Atom, type HypedServer, type Levels, locationOf, type Place, type World } from './server';

/** Time after the last change before the page plays the new text, ms. */
const REST = 120;
/** Time between two looks at the modes while time passes, ms. */
const GLANCE = 100;
/** Maximum number of characters of the values of a guard. */
const MAX_LABEL = 90;
/** What pictures the page may show. */
const PICTURES: Record<string, string> = { png: 'image/png' };

/** An edge that was tried. */
interface Tried {
  place: Place | null;
  held: boolean;
  taken: boolean;
  atoms: Atom[];
}

/** Where a frame is in the texts. */
interface Lit {
  frame: number;
  modes: { instance: string; entity: string; mode: string; place: Place }[];
  edges: Tried[];
}

/** What the page says. */
type Message =
  | { id: number; request: { ask: string; slot?: number; [more: string]: unknown } }
  | { id: number; picture: string }
  | { goTo: Place };

/** What the page is answered, as far as this part reads it. */
interface Answer {
  answer: string;
  message?: string;
  text?: string;
  files?: string[];
  scene?: { world: string; goals: string[] } | null;
}

const lit = vscode.window.createTextEditorDecorationType({
  isWholeLine: true,
  backgroundColor: new vscode.ThemeColor('editor.wordHighlightStrongBackground'),
  overviewRulerColor: new vscode.ThemeColor('charts.orange'),
  overviewRulerLane: vscode.OverviewRulerLane.Left,
  borderWidth: '0 0 0 3px',
  borderStyle: 'solid',
  borderColor: new vscode.ThemeColor('charts.orange'),
});
const taken = vscode.window.createTextEditorDecorationType({
  isWholeLine: true,
  backgroundColor: new vscode.ThemeColor('diffEditor.insertedLineBackground'),
});

export class Timelines {
  private readonly all = new Map<string, Timeline>();
  private readonly hints = new vscode.EventEmitter<void>();
  private sessions = 0;

  constructor(
    private readonly server: HypedServer,
    private readonly levels: Levels,
  ) {}

  /** What is to be disposed of. */
  get disposables(): vscode.Disposable[] {
    const isAnyOf = ({ uri }: vscode.TextDocument) => /\.(hyped|txt|json|tmx|tmj|tsx|ldtk)$/.test(uri.path) || uri.scheme === 'untitled';
    return [
      this.hints,
      { dispose: () => this.all.forEach((timeline) => timeline.close()) },
      vscode.workspace.onDidChangeTextDocument(({ document, contentChanges }) => {
        if (contentChanges.length > 0 && isAnyOf(document)) this.all.forEach((timeline) => timeline.changed(document.uri));
      }),
      vscode.window.onDidChangeVisibleTextEditors(() => this.all.forEach((timeline) => timeline.paint())),
      vscode.languages.registerInlayHintsProvider(
        { language: 'hyped' },
        {
          onDidChangeInlayHints: this.hints.event,
          provideInlayHints: (document, range) => [...this.all.values()].flatMap((timeline) => timeline.hintsIn(document, range)),
        },
      ),
    ];
  }

  /** Opens the page of a world, or shows it if it is open. */
  async open(uri: vscode.Uri, world: World): Promise<void> {
    const key = `${uri.toString()}#${world.name}`;
    const known = this.all.get(key);
    if (known) return known.show();
    const level = await this.levels.of(uri.toString(), world);
    if (level === null) return;
    const html = await this.server.page();
    const timeline = new Timeline(this.server, uri, world.name, level, ++this.sessions, html);
    this.all.set(key, timeline);
    const tell = () => vscode.commands.executeCommand('setContext', 'hypedc.plays', this.all.size > 0);
    void tell();
    timeline.onChange = () => {
      this.hints.fire();
      this.onFrame();
    };
    timeline.onClose = () => {
      this.all.delete(key);
      void tell();
      this.hints.fire();
    };
  }

  /** The page that the user looks at, or the only one. */
  get active(): Timeline | undefined {
    const all = [...this.all.values()];
    return all.find((timeline) => timeline.isActive) ?? (all.length === 1 ? all[0] : all.find((timeline) => timeline.isVisible));
  }

  /** The modes that are active in the pages of a document: the paths of those of each entity. */
  activeModes(): Map<string, Set<string>> {
    const found = new Map<string, Set<string>>();
    for (const timeline of this.all.values()) {
      for (const { entity, mode } of timeline.modes) found.set(entity, (found.get(entity) ?? new Set()).add(mode));
    }
    return found;
  }

  /** Called when another frame is shown. */
  onFrame: () => void = () => undefined;

  /** A restarted server has no sessions. */
  restarted(): void {
    this.all.forEach((timeline) => timeline.lose());
  }
}

/** The page of one world. */
export class Timeline {
  onChange: () => void = () => undefined;
  onClose: () => void = () => undefined;
  private readonly panel: vscode.WebviewPanel;
  /** The instance whose guards are shown. */
  private slot: number | null = null;
  private shown: Lit | null = null;
  private files: string[] = [];
  private goals: string[] = [];
  private timer: NodeJS.Timeout | undefined;
  private readonly changes = new Set<string>();
  private isLooking = false;
  private looksAgain = false;
  private isClosed = false;

  constructor(
    private readonly server: HypedServer,
    readonly uri: vscode.Uri,
    readonly world: string,
    private readonly level: string | undefined,
    private readonly session: number,
    html: string,
  ) {
    const where = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: false };
    this.panel = vscode.window.createWebviewPanel('hypedc.timeline', `Play ${world}`, where, { enableScripts: true, retainContextWhenHidden: true });
    this.panel.onDidDispose(() => this.close());
    this.panel.webview.onDidReceiveMessage((message: Message) => this.receive(message));
    this.panel.webview.html = pageOf(html, world);
  }

  /** The modes that are active in the frame that is shown. */
  get modes(): { entity: string; mode: string }[] {
    return this.shown?.modes ?? [];
  }

  get isActive(): boolean {
    return this.panel.active;
  }

  get isVisible(): boolean {
    return this.panel.visible;
  }

  show(): void {
    this.panel.reveal(undefined, false);
  }

  /** Ends the session. */
  close(): void {
    if (this.isClosed) return;
    this.isClosed = true;
    clearTimeout(this.timer);
    this.shown = null;
    this.paint();
    if (this.server.isRunning) void this.ask({ close: {} }).catch(() => undefined);
    this.panel.dispose();
    this.onClose();
  }

  /** The server that had the session has ended: the new one plays from the start. */
  lose(): void {
    this.changes.add(this.uri.fsPath);
    this.panel.webview.html = this.panel.webview.html.replace(/<!-- \d+ -->$|$/, `<!-- ${Date.now()} -->`);
  }

  private ask<T>(what: object): Promise<T> {
    return this.server.play<T>({ session: this.session, uri: this.uri.toString(), level: this.level ?? null, ...what });
  }

  /** Asks as the page does; a refusal is thrown. */
  async request(request: object): Promise<Answer> {
    const answer = await this.ask<Answer>({ request });
    if (answer.answer === 'refused') throw new Error(answer.message);
    return answer;
  }

  private async receive(message: Message): Promise<void> {
    if ('goTo' in message) {
      const { uri, range } = locationOf(message.goTo);
      const of = this.uri.fsPath === uri.fsPath ? this.uri : uri;
      await vscode.window.showTextDocument(of, { selection: range, viewColumn: vscode.ViewColumn.One });
      return;
    }
    const { id } = message;
    let answer: unknown;
    try {
      answer = 'picture' in message ? await this.picture(message.picture) : await this.answer(message.request);
    } catch (error) {
      answer = { answer: 'refused', message: error instanceof Error ? error.message : String(error) };
    }
    await this.panel.webview.postMessage({ id, answer });
  }

  private async answer(request: { ask: string; slot?: number }): Promise<Answer> {
    if (request.ask === 'inspect') this.slot = request.slot ?? null;
    const answer = await this.ask<Answer>({ request });
    if (answer.answer === 'opened') {
      this.files = answer.files ?? [];
      this.goals = answer.scene?.goals ?? [];
      // What the page writes into the text goes into the editor.
      if (request.ask === 'write' || request.ask === 'paint' || request.ask === 'undo') await this.takeTexts();
    }
    if (answer.answer === 'opened' || answer.answer === 'shown' || request.ask === 'inspect') this.look();
    return answer;
  }

  /** Takes the texts of the session into the editor, and lets the session read those of the editor again. */
  private async takeTexts(): Promise<void> {
    for (const path of this.files) {
      const { text } = await this.request({ ask: 'text', path, written: true });
      const uri = this.uri.fsPath === path ? this.uri : vscode.Uri.file(path);
      const document = await vscode.workspace.openTextDocument(uri);
      if (text !== undefined && text !== document.getText()) await replaceText(document, text);
    }
    // The server has the changes of the editor before the next request.
    for (const path of this.files) await this.ask({ request: { ask: 'edit', path, text: null } });
  }

  /** A picture that the program names. */
  private async picture(name: string): Promise<string> {
    const kind = PICTURES[name.split('.').pop()?.toLowerCase() ?? ''];
    if (!kind) throw new Error(`\`${name}\` is no picture`);
    const bytes = await readFile(join(dirname(this.uri.fsPath), name));
    return `data:${kind};base64,${bytes.toString('base64')}`;
  }

  /** A text has changed. */
  changed(uri: vscode.Uri): void {
    this.changes.add(uri.fsPath);
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      void this.panel.webview.postMessage({ changed: [...this.changes] });
      this.changes.clear();
    }, REST);
  }

  /** Shows another frame. */
  seek(frame: number): void {
    void this.panel.webview.postMessage({ seek: frame });
  }

  /** Looks where the frame is in the texts; while time passes, now and then. */
  private look(): void {
    if (this.isLooking) {
      this.looksAgain = true;
      return;
    }
    this.isLooking = true;
    this.looksAgain = false;
    void this.ask<Lit | null>({ lit: this.slot })
      .then((found) => {
        if (this.isClosed) return;
        this.shown = found;
        this.paint();
        this.onChange();
      })
      .catch(() => undefined)
      .finally(() => {
        setTimeout(() => {
          this.isLooking = false;
          if (this.looksAgain && !this.isClosed) this.look();
        }, GLANCE);
      });
  }

  /** Lights the modes in the editors that are visible. */
  paint(): void {
    const isOf = (document: vscode.TextDocument, { path }: Place) => document.uri.fsPath === path || document.uri.toString() === path;
    for (const editor of vscode.window.visibleTextEditors) {
      if (editor.document.languageId !== 'hyped') continue;
      const places = this.shown?.modes.filter(({ place }) => isOf(editor.document, place)) ?? [];
      const lines = new Map<number, vscode.DecorationOptions>();
      for (const { instance, mode, place } of places) {
        const { range } = locationOf(place);
        const before = lines.get(place.line)?.hoverMessage;
        const hoverMessage = `${before ? `${String(before)}, ` : ''}\`${instance}\` is in \`${mode}\``;
        lines.set(place.line, { range, hoverMessage });
      }
      editor.setDecorations(lit, [...lines.values()]);
      const edges = this.shown?.edges.filter((edge) => edge.taken && edge.place && isOf(editor.document, edge.place)) ?? [];
      editor.setDecorations(taken, edges.map(({ place }) => locationOf(place as Place).range));
    }
  }

  /** The values of guards at the frame. */
  hintsIn(document: vscode.TextDocument, within: vscode.Range): vscode.InlayHint[] {
    const edges = this.shown?.edges ?? [];
    return edges.flatMap(({ place, held, atoms }) => {
      if (!place || (document.uri.fsPath !== place.path && document.uri.toString() !== place.path)) return [];
      const line = place.line - 1;
      if (line < within.start.line || line > within.end.line || line >= document.lineCount) return [];
      const hint = new vscode.InlayHint(new vscode.Position(line, guardEnd(document.lineAt(line).text)), labelOf(held, atoms));
      hint.paddingLeft = true;
      hint.paddingRight = true;
      hint.tooltip = atoms.map(({ text, held, sides }) => `${held ? '✓' : '✗'} ${text}${sides ? ` (${sides.map(short).join(', ')})` : ''}`).join('\n');
      return [hint];
    });
  }

  /** The inputs of the run. */
  async script(): Promise<string> {
    return (await this.request({ ask: 'script' })).text ?? '';
  }

  /** Saves the inputs of the run in a file. */
  async saveInputs(): Promise<void> {
    const script = await this.script();
    const defaultUri = vscode.Uri.joinPath(this.uri, '..', `${basename(this.uri.path, '.hyped')}.inputs`);
    const target = await vscode.window.showSaveDialog({ defaultUri, filters: { Inputs: ['inputs'] } });
    if (target) await writeFile(target.fsPath, `${script}\n`);
  }

  /** Writes the run as a test into the text. */
  async saveTest(): Promise<void> {
    const inputs = await this.script();
    const other = 'Another predicate…';
    const picked = this.goals.length > 0 ? await vscode.window.showQuickPick([...this.goals, other], { title: 'What holds at the end of the run?' }) : other;
    const prompt = 'What holds at the end of the run, such as hero.x > 100';
    const predicate = picked === other ? await vscode.window.showInputBox({ title: 'Save as a test', prompt }) : picked;
    if (!predicate) return;
    const test = await vscode.window.showInputBox({ title: 'The name of the test', value: predicate });
    if (!test) return;
    try {
      const level = this.level ? { level: this.level } : {};
      const { uri, text } = await this.server.record({ uri: this.uri.toString(), world: this.world, ...level, test, inputs, predicate });
      const document = await vscode.workspace.openTextDocument(vscode.Uri.parse(uri));
      await replaceText(document, text);
      await vscode.window.showTextDocument(document, vscode.ViewColumn.One);
    } catch (error) {
      await vscode.window.showErrorMessage(error instanceof Error ? error.message : String(error));
    }
  }
}

/** Replaces a text by another one, where they differ: cursors and folds elsewhere stay. */
async function replaceText(document: vscode.TextDocument, text: string): Promise<void> {
  const old = document.getText();
  let start = 0;
  while (start < old.length && start < text.length && old[start] === text[start]) start++;
  let end = 0;
  while (end < old.length - start && end < text.length - start && old[old.length - 1 - end] === text[text.length - 1 - end]) end++;
  const edit = new vscode.WorkspaceEdit();
  const range = new vscode.Range(document.positionAt(start), document.positionAt(old.length - end));
  edit.replace(document.uri, range, text.slice(start, text.length - end));
  await vscode.workspace.applyEdit(edit);
}

function short(value: number): string {
  return String(Number(value.toFixed(2)));
}

/** Where the guard of an edge ends in its line: before the arrow or the block, or else at the end. */
export function guardEnd(line: string): number {
  const end = /\s*(->|\{|\/\/|$)/.exec(line.replace(/^\s*/, (blank) => '_'.repeat(blank.length)));
  return end?.index ?? line.length;
}

/** `✗ 12 > 48`: the values in place of names. */
export function labelOf(held: boolean, atoms: Atom[]): string {
  const values = atoms.map(({ text, held, sides }) => {
    const sign = / (<=|>=|==|!=|<|>) /.exec(text)?.[1];
    return sides && sign ? `${short(sides[0])} ${sign} ${short(sides[1])}` : `${held ? '✓' : '✗'} ${text}`;
  });
  const label = `${held ? '✓' : '✗'} ${atoms.length === 1 && !atoms[0].sides ? '' : values.join(', ')}`.trimEnd();
  return label.length > MAX_LABEL ? `${label.slice(0, MAX_LABEL)}…` : label;
}

/** The page for a webview: it opens a world, and loads nothing from elsewhere. */
export function pageOf(html: string, world: string): string {
  const policy = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; worker-src blob:";
  const name = world.replace(/[&<>"']/g, (sign) => `&#${sign.charCodeAt(0)};`);
  return html
    .replace(/<html([^>]*)>/, (_, rest: string) => `<html${rest} data-world="${name}">`)
    .replace('<head>', () => `<head>\n<meta http-equiv="Content-Security-Policy" content="${policy}">\n<style>html body { padding: 0; }</style>`);
}
