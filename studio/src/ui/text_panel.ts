// The text of the program beside the game: what is typed is played at once, errors are marked at their place.

import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { bracketMatching, HighlightStyle, indentUnit, syntaxHighlighting } from "@codemirror/language";
import { type Diagnostic, lintGutter, setDiagnostics } from "@codemirror/lint";
import { Compartment, EditorState, type Extension, type Text } from "@codemirror/state";
import { drawSelection, EditorView, highlightActiveLine, keymap, lineNumbers } from "@codemirror/view";
import { tags } from "@lezer/highlight";

import { ask } from "../carrier.ts";
import type { Stage } from "../draw/stage.ts";
import type { Theme } from "../draw/colors.ts";
import type { Game } from "../game.ts";
import type { Finding, Opened, Place } from "../protocol.ts";
import { button, h } from "./dom.ts";
import { hyped } from "./language.ts";
import { Paint } from "./paint.ts";
import { download } from "./play_panel.ts";
import type { Panel } from "./sidebar.ts";
import type { Toasts } from "./toasts.ts";

/** Time after the last key before a text is played, ms. */
const REST = 120;

const COLORS = HighlightStyle.define([
  { tag: tags.keyword, color: "var(--code-keyword)" },
  { tag: tags.number, color: "var(--code-number)" },
  { tag: tags.string, color: "var(--code-string)" },
  { tag: tags.comment, color: "var(--code-comment)", fontStyle: "italic" },
  { tag: tags.typeName, color: "var(--code-type)" },
  { tag: tags.variableName, color: "var(--code-variable)" },
]);

export class TextPanel implements Panel {
  readonly id = "text";
  readonly title = "Edit";
  readonly width = "wide";
  readonly element = h("div", { class: "text-panel" });
  /** Errors, over the running last good version. */
  readonly problems = h("div", { class: "problems", hidden: true });
  readonly painter: Paint;
  /** Path of the file that is shown; none before the first. */
  path: string | null = null;
  /** Whether the editor marks what the session finds; otherwise something that extends it does. */
  isMarked = true;
  private readonly tools: HTMLElement;
  private readonly file = h("select", { "aria-label": "File" });
  private readonly saveButton: HTMLButtonElement;
  private readonly view: EditorView;
  private readonly dark = new Compartment();
  private readonly more = new Compartment();
  private isShown = false;
  private isFilling = false;
  private timer = 0;
  /** Shows places in another editor, if the page is beside one. */
  elsewhere: ((place: Place) => void) | null = null;
  /** The files whose texts differ from the disk. */
  unsaved: string[] = [];
  /** When a file was last saved from here, ms. */
  savedAt = 0;
  private hadUnsaved = false;

  constructor(
    private readonly game: Game,
    stage: Stage,
    private readonly toasts: Toasts,
    private readonly show: () => void,
  ) {
    this.painter = new Paint(game, stage, () => void this.fill());
    this.saveButton = button(game.carrier.canSave ? "Save" : "Download", () => void this.save(), "small");
    this.view = new EditorView({ state: EditorState.create({ extensions: this.extensions() }) });
    const discard = button("Discard changes", () => void this.discard(), "small link");
    this.tools = h("div", { class: "row" }, this.file, this.saveButton, discard);
    this.element.append(
      this.painter.element,
      this.tools,
      this.view.dom,
      h("p", { class: "quiet" }, "Escape leaves the editor for the game; Tab indents."),
    );
    // Its text can have the focus; the box around it need not.
    this.view.scrollDOM.removeAttribute("tabindex");
    this.file.addEventListener("change", () => void this.open(this.file.value));
    game.onOpened.on((opened) => this.take(opened));
  }

  private extensions(): Extension[] {
    const leave = (): boolean => {
      document.querySelector<HTMLElement>(".stage canvas")?.focus();
      return true;
    };
    return [
      lineNumbers(),
      history(),
      drawSelection(),
      bracketMatching(),
      highlightActiveLine(),
      indentUnit.of("    "),
      lintGutter(),
      hyped,
      syntaxHighlighting(COLORS),
      keymap.of([
        { key: "Mod-s", run: () => (void this.save(), true), preventDefault: true },
        { key: "Escape", run: leave },
        indentWithTab,
        ...defaultKeymap,
        ...historyKeymap,
      ]),
      EditorView.contentAttributes.of({ "aria-label": "Program text", tabindex: "0" }),
      EditorView.updateListener.of((update) => {
        if (update.docChanged && !this.isFilling) this.typed();
      }),
      this.dark.of([]),
      this.more.of([]),
    ];
  }

  /** Adds to the editor: completion and hover where there is a language server. */
  extend(extensions: Extension): void {
    this.view.dispatch({ effects: this.more.reconfigure(extensions) });
  }

  /** Adds a button above the text. */
  addTool(tool: HTMLElement): void {
    this.tools.append(tool);
  }

  get editor(): EditorView {
    return this.view;
  }

  setTheme(theme: Theme): void {
    this.view.dispatch({ effects: this.dark.reconfigure(EditorView.theme({}, { dark: theme === "dark" })) });
  }

  shown(isShown: boolean): void {
    if (isShown && !this.isShown) void this.fill();
    this.isShown = isShown;
    if (!isShown) this.painter.choose(null);
  }

  private take(opened: Opened): void {
    this.path ??= opened.scene?.path ?? opened.files[0] ?? null;
    this.hadUnsaved = this.unsaved.length > 0;
    this.unsaved = opened.unsaved;
    const files = opened.files.length > 0 ? opened.files : [this.path ?? ""];
    const star = (path: string): string => `${path.split(/[\\/]/).pop() ?? path}${this.unsaved.includes(path) ? " •" : ""}`;
    this.file.replaceChildren(...files.map((path) => h("option", { value: path, selected: path === this.path }, star(path))));
    this.saveButton.disabled = this.unsaved.length === 0;
    this.mark(opened.findings);
    this.report(opened);
  }

  /** Errors over the stage, each with its place. */
  private report(opened: Opened): void {
    const errors = opened.findings.filter((finding) => finding.severity === "error");
    this.problems.hidden = opened.is_current || errors.length === 0;
    if (this.problems.hidden) return;
    const row = (finding: Finding): HTMLElement => {
      const place = finding.place;
      const name = place ? `${place.path.split(/[\\/]/).pop() ?? ""}:${place.line}` : "";
      return h(
        "li",
        {},
        place ? button(name, () => void this.goTo(place), "link") : null,
        h("span", {}, finding.message),
        h("span", { class: "quiet" }, ` ${finding.code}`),
        ...finding.helps.slice(0, 1).map((help) => h("span", { class: "quiet help" }, help)),
      );
    };
    const head = opened.scene ? "The text has errors; the last good version goes on." : "The text has errors.";
    this.problems.replaceChildren(h("strong", {}, head), h("ul", {}, ...errors.slice(0, 4).map(row)));
    if (errors.length > 4) this.problems.append(h("span", { class: "quiet" }, `and ${errors.length - 4} more`));
  }

  private mark(findings: Finding[]): void {
    if (!this.isMarked) return;
    const doc = this.view.state.doc;
    const marks: Diagnostic[] = [];
    for (const finding of findings) {
      const place = finding.place;
      if (place?.path !== this.path || !place) continue;
      const [from, to] = [offset(doc, place.line, place.column), offset(doc, place.end_line, place.end_column)];
      const message = [finding.message, ...finding.helps].join("\n");
      marks.push({ from, to: Math.max(from, to), severity: finding.severity === "error" ? "error" : "warning", message, source: finding.code });
    }
    this.view.dispatch(setDiagnostics(this.view.state, marks));
  }

  /** Reads the text from the session, unless it is being typed. */
  async fill(): Promise<void> {
    if (this.timer !== 0) return;
    try {
      const { text } = await ask(this.game.carrier, "text", { ask: "text", path: this.path, written: true });
      if (this.timer !== 0 || text === this.view.state.doc.toString()) return;
      this.isFilling = true;
      const doc = this.view.state.doc.toString();
      // Only what differs is replaced, so that the cursor stays.
      let [from, end] = [0, 0];
      while (from < Math.min(doc.length, text.length) && doc[from] === text[from]) from++;
      while (end < Math.min(doc.length, text.length) - from && doc[doc.length - 1 - end] === text[text.length - 1 - end]) end++;
      this.view.dispatch({ changes: { from, to: doc.length - end, insert: text.slice(from, text.length - end) } });
      this.isFilling = false;
      if (this.game.opened) this.mark(this.game.opened.findings);
    } catch {
      // The file cannot be read: its error is among the findings.
    }
  }

  private async open(path: string): Promise<void> {
    await this.flush();
    this.path = path;
    await this.fill();
  }

  private typed(): void {
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.flush(), REST);
  }

  /** Plays the text as it is typed. */
  private async flush(): Promise<void> {
    if (this.timer === 0) return;
    clearTimeout(this.timer);
    this.timer = 0;
    await this.game.change({ ask: "edit", path: this.path, text: this.view.state.doc.toString() });
  }

  /** Writes all changed files. */
  async save(): Promise<void> {
    await this.flush();
    const { carrier } = this.game;
    for (const path of this.unsaved) {
      const { text } = await ask(carrier, "text", { ask: "text", path, written: true });
      if (!carrier.canSave) {
        download(path.split(/[\\/]/).pop() ?? "game.hyped", text);
        continue;
      }
      const why = await carrier.save(path, text);
      this.savedAt = Date.now();
      if (why) return this.toasts.show(why, "bad");
      // From now on, the file is read again.
      await this.game.change({ ask: "edit", path, text: null });
      this.toasts.show(`${path} is saved`, "good");
    }
  }

  /** A number was written into a file: it is saved at once, unless something else in it is not. */
  async written(path: string): Promise<void> {
    const isAlone = this.unsaved.length === 1 && this.unsaved[0] === path && !this.hadUnsaved;
    await this.fill();
    if (isAlone && this.game.carrier.canSave) await this.save();
    else this.toasts.show("Written into the text", "good", { text: "Undo", run: () => void this.game.change({ ask: "undo" }).then(() => this.fill()) });
  }

  /** Goes back to the files as they are on the disk. */
  private async discard(): Promise<void> {
    clearTimeout(this.timer);
    this.timer = 0;
    for (const path of this.unsaved) await this.game.change({ ask: "edit", path, text: null });
    await this.fill();
  }

  /** Shows a place of the text. */
  async goTo(place: Place): Promise<void> {
    if (this.elsewhere) return this.elsewhere(place);
    if (place.path !== this.path) {
      await this.flush();
      this.path = place.path;
      this.file.value = place.path;
    }
    this.show();
    await this.fill();
    const doc = this.view.state.doc;
    const [anchor, head] = [offset(doc, place.line, place.column), offset(doc, place.end_line, place.end_column)];
    this.view.dispatch({ selection: { anchor, head }, effects: EditorView.scrollIntoView(anchor, { y: "center" }) });
    this.view.focus();
  }
}

/** The offset of a line and column, both from 1. */
function offset(doc: Text, line: number, column: number): number {
  if (line > doc.lines) return doc.length;
  const of = doc.line(Math.max(1, line));
  return Math.min(of.to, of.from + Math.max(0, column - 1));
}
