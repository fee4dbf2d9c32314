// Verdicts that are out of date. A lens has one colour, so the goal or `never` below it fades until it is asked again.

import * as vscode from 'vscode';

/** The parameters of `hypedc/verdicts`, as far as they are read. */
export interface Verdicts {
  uri: string;
  verdicts: { world: string; kind: 'goal' | 'never'; name: string; isCurrent: boolean }[];
}

/** The line of a question in a text that may have changed since it was asked. */
export function lineOf(lines: string[], { world, kind, name }: Verdicts['verdicts'][number]): number | undefined {
  const begins = lines.findIndex((line) => new RegExp(`^\\s*world\\s+${world}\\b`).test(line));
  const asks = new RegExp(`^\\s*${kind}\\s+${name}\\b`);
  const line = lines.findIndex((text, at) => at > begins && asks.test(text));
  return begins < 0 || line < 0 ? undefined : line;
}

export class OutdatedVerdicts {
  private readonly faded = vscode.window.createTextEditorDecorationType({ opacity: '0.5' });
  /** By the URI of the document. */
  private readonly told = new Map<string, Verdicts>();

  get disposables(): vscode.Disposable[] {
    return [this.faded, vscode.window.onDidChangeVisibleTextEditors(() => this.draw())];
  }

  /** Takes what the server tells. */
  show(told: Verdicts): void {
    this.told.set(vscode.Uri.parse(told.uri).toString(), told);
    this.draw();
  }

  /** Forgets all, as a server does that ends. */
  forget(): void {
    this.told.clear();
    this.draw();
  }

  private draw(): void {
    for (const editor of vscode.window.visibleTextEditors) {
      const old = this.told.get(editor.document.uri.toString())?.verdicts.filter(({ isCurrent }) => !isCurrent) ?? [];
      const texts = old.length > 0 ? editor.document.getText().split(/\r?\n/) : [];
      const lines = old.flatMap((verdict) => lineOf(texts, verdict) ?? []);
      editor.setDecorations(this.faded, lines.map((line) => editor.document.lineAt(line).range));
    }
  }
}
