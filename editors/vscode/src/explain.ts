// The pages that explain the codes of findings: virtual documents, shown as Markdown beside the text.

import * as vscode from 'vscode';
import type { HypedServer } from './server';

const SCHEME = 'hypedc-explain';

export class Explanations {
  constructor(private readonly server: HypedServer) {}

  get disposables(): vscode.Disposable[] {
    return [
      vscode.workspace.registerTextDocumentContentProvider(SCHEME, {
        provideTextDocumentContent: async ({ path }) => (await this.server.explain(path.replace(/\.md$/, ''))).markdown,
      }),
      vscode.commands.registerCommand('hypedc.explain', (code?: string) => this.show(code)),
    ];
  }

  /** Shows the page of a code: a given one, or those of the findings at the cursor. */
  private async show(given?: string): Promise<void> {
    const codes = given ? [given] : codesAtCursor();
    if (codes.length === 0) {
      await vscode.window.showInformationMessage('No finding is at the cursor.');
      return;
    }
    const code = codes.length > 1 ? await vscode.window.showQuickPick(codes, { title: 'Which finding?' }) : codes[0];
    if (!code) return;
    try {
      await this.server.explain(code);
      await vscode.commands.executeCommand('markdown.showPreviewToSide', vscode.Uri.from({ scheme: SCHEME, path: `${code}.md` }));
    } catch (error) {
      await vscode.window.showErrorMessage(error instanceof Error ? error.message : String(error));
    }
  }
}

/** The codes of the findings at the cursor, or in its line. */
function codesAtCursor(): string[] {
  const editor = vscode.window.activeTextEditor;
  if (!editor) return [];
  const { document, selection } = editor;
  const all = vscode.languages.getDiagnostics(document.uri).filter(({ source }) => source === 'hypedc');
  const here = all.filter(({ range }) => range.contains(selection.active));
  const found = here.length > 0 ? here : all.filter(({ range }) => range.start.line === selection.active.line);
  const code = ({ code }: vscode.Diagnostic) => String(typeof code === 'object' ? code.value : (code ?? ''));
  return [...new Set(found.map(code))].filter((code) => /^[EW]\d+$/.test(code));
}
