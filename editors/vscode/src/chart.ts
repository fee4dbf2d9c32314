// The statechart of an entity beside its text: it follows the cursor, and shows which modes are active in the frame that is
// played.

import * as vscode from 'vscode';
import type { HypedServer } from './server';
import type { Timelines } from './timeline';

/** Time after the last move of the cursor, ms. */
const REST = 150;
/** The session that draws: none of those that are played. */
const SESSION = 1_000_000_000;

interface Answer {
  answer: string;
  message?: string;
  svg?: string;
  scene?: { entities: { name: string; modes: string[] }[] } | null;
}

export class Charts {
  private panel: vscode.WebviewPanel | undefined;
  private timer: NodeJS.Timeout | undefined;
  /** What is drawn: an entity of a document as of a version. */
  private drawn = '';
  private entity = '';
  private modes: string[] = [];
  private session = SESSION;

  constructor(
    private readonly server: HypedServer,
    private readonly timelines: Timelines,
  ) {
    timelines.onFrame = () => this.light();
  }

  /** What is to be disposed of. */
  get disposables(): vscode.Disposable[] {
    return [
      { dispose: () => this.panel?.dispose() },
      vscode.window.onDidChangeTextEditorSelection(({ textEditor }) => textEditor.document.languageId === 'hyped' && this.follow()),
      vscode.workspace.onDidChangeTextDocument(({ document }) => document.languageId === 'hyped' && this.follow()),
    ];
  }

  /** Opens the chart. */
  async open(): Promise<void> {
    const editor = vscode.window.activeTextEditor;
    if (!this.panel) {
      const where = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
      this.panel = vscode.window.createWebviewPanel('hypedc.chart', 'Statechart', where, { enableScripts: true, retainContextWhenHidden: true });
      this.panel.onDidDispose(() => (this.panel = undefined));
      this.panel.webview.html = PAGE;
    }
    this.drawn = '';
    if (editor) await this.draw(editor).catch((error: unknown) => this.say(String(error)));
  }

  private follow(): void {
    if (!this.panel) return;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => {
      const editor = vscode.window.activeTextEditor;
      if (editor) void this.draw(editor).catch(() => undefined);
    }, REST);
  }

  private say(text: string): void {
    void this.panel?.webview.postMessage({ text });
  }

  /** Draws the entity at the cursor. */
  private async draw(editor: vscode.TextEditor): Promise<void> {
    const { document, selection } = editor;
    if (document.languageId !== 'hyped') return;
    const symbols = await vscode.commands.executeCommand<vscode.DocumentSymbol[] | undefined>('vscode.executeDocumentSymbolProvider', document.uri);
    const path = symbolsAt(symbols ?? [], selection.active);
    const entity = path.find(({ detail }) => detail === 'entity')?.name;
    if (!entity) {
      if (this.drawn === '') this.say('Put the cursor into an entity.');
      return;
    }
    const key = `${document.uri.toString()} ${document.version} ${entity}`;
    if (key !== this.drawn) {
      // A session of the text as it is now.
      const session = ++this.session;
      const ask = (request: object) => this.server.play<Answer>({ session, uri: document.uri.toString(), level: null, request });
      const opened = await ask({ ask: 'open', world: null });
      const found = await ask({ ask: 'chart', entity });
      await this.server.play({ session, uri: document.uri.toString(), level: null, close: {} });
      // With errors the chart of before stays.
      if (!found.svg) return;
      this.drawn = key;
      this.entity = entity;
      this.modes = opened.scene?.entities.find(({ name }) => name === entity)?.modes ?? [];
      if (this.panel) this.panel.title = `Statechart of ${entity}`;
      await this.panel?.webview.postMessage({ svg: found.svg });
    }
    const names = path.map(({ name }) => name);
    const isAt = (mode: string) => mode.split('.').every((part) => names.includes(part)) && mode.split('.').pop() === names.filter((name) => this.modes.some((of) => of.split('.').pop() === name)).pop();
    const at = this.modes.findIndex(isAt);
    await this.panel?.webview.postMessage({ cursor: at });
    this.light();
  }

  /** Lights the modes that are active in the frame that is played. */
  private light(): void {
    const active = this.timelines.activeModes().get(this.entity) ?? new Set();
    void this.panel?.webview.postMessage({ active: this.modes.flatMap((mode, index) => (active.has(mode) ? [index] : [])) });
  }
}

/** The symbols that contain a position, outermost first. */
export function symbolsAt(symbols: vscode.DocumentSymbol[], at: vscode.Position): vscode.DocumentSymbol[] {
  const around = symbols.find(({ range }) => range.contains(at));
  return around ? [around, ...symbolsAt(around.children, at)] : [];
}

/** The page: it shows what it is told, and loads nothing. */
const PAGE = `<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'">
<style>
  body { padding: 8px; }
  svg { max-width: none; }
  svg .paper { fill: transparent !important; }
  svg text { fill: var(--vscode-editor-foreground) !important; }
  svg text.number { fill: #fff !important; }
  svg .quiet { fill: var(--vscode-descriptionForeground) !important; }
  svg .first { fill: var(--vscode-editor-foreground) !important; }
  svg .line { stroke: var(--vscode-editor-foreground) !important; }
  svg .cursor { stroke: var(--vscode-focusBorder) !important; stroke-width: 2.5; }
  svg .active { fill: var(--vscode-charts-orange, #d18616) !important; fill-opacity: .35 !important; }
</style>
</head>
<body>
<p id="text"></p>
<div id="chart"></div>
<script>
  const chart = document.getElementById('chart');
  const mark = (name, modes) => {
    for (const rect of chart.querySelectorAll('rect[data-mode]')) rect.classList.toggle(name, modes.includes(Number(rect.dataset.mode)));
  };
  addEventListener('message', ({ data }) => {
    if (data.svg !== undefined) {
      chart.innerHTML = data.svg;
      document.getElementById('text').textContent = '';
    }
    if (data.text !== undefined) document.getElementById('text').textContent = data.text;
    if (data.cursor !== undefined) mark('cursor', [data.cursor]);
    if (data.active !== undefined) mark('active', data.active);
  });
</script>
</body>
</html>`;
