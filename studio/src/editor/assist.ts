// The engine's help in the editor: findings with their repairs, completion, hovers, signatures, formatting, and names in
// the colours of what they are.

import {
  autocompletion,
  snippet,
  type Completion,
  type CompletionContext,
  type CompletionResult,
} from "@codemirror/autocomplete";
import { forEachDiagnostic, forceLinting, linter, type Diagnostic } from "@codemirror/lint";
import { RangeSetBuilder, StateEffect, StateField, type Extension, type Text } from "@codemirror/state";
import {
  Decoration,
  EditorView,
  hoverTooltip,
  keymap,
  ViewPlugin,
  type DecorationSet,
  type ViewUpdate,
} from "@codemirror/view";

import { markdown } from "./markdown.ts";
import type { LanguageFinding, LanguageService, TextEdit } from "./service.ts";

/** Time without typing before findings of values are asked for, ms. */
const PAUSE = 700;

/** The names under which the editor has icons for kinds. */
const ICONS: Record<string, string> = {
  mode: "method",
  variable: "variable",
  instance: "variable",
  entity: "class",
  behavior: "interface",
  space: "namespace",
  property: "property",
  group: "enum",
  keyword: "keyword",
  function: "function",
  snippet: "text",
  file: "text",
  value: "constant",
  constant: "constant",
  input: "property",
};

/** Tells the service of the newest text before anything else is asked about it. */
class Documents {
  private known: Text | null = null;
  private sent: Promise<LanguageFinding[]> = Promise.resolve([]);

  constructor(
    private readonly service: LanguageService,
    private readonly path: () => string,
  ) {}

  /** The findings of the compiler for a text. */
  findings(text: Text): Promise<LanguageFinding[]> {
    if (this.known !== text) {
      this.known = text;
      this.sent = this.service.ask({ ask: "document", path: this.path(), text: text.toString() }).then(found);
    }
    return this.sent;
  }

  /** Findings of the analysis of values as well. */
  async all(text: Text): Promise<LanguageFinding[]> {
    await this.findings(text);
    return found(await this.service.ask({ ask: "analyze", path: this.path() }));
  }
}

function found(answer: Awaited<ReturnType<LanguageService["ask"]>>): LanguageFinding[] {
  return answer.answer === "findings" ? answer.findings : [];
}

function apply(view: EditorView, edits: TextEdit[], name: string): void {
  const changes = edits.map(({ from, to, text }) => ({ from, to, insert: text }));
  view.dispatch({ changes, userEvent: name });
}

/** A finding as the editor shows it. */
function diagnostic(of: LanguageFinding, length: number): Diagnostic {
  const [from, to] = [Math.min(of.from, length), Math.min(of.to, length)];
  const { fix } = of;
  return {
    from,
    to,
    severity: of.severity,
    source: of.code,
    message: of.message,
    ...(of.is_unnecessary ? { markClass: "unnecessary" } : {}),
    ...(fix === null
      ? {}
      : { actions: [{ name: fix.title.replaceAll("`", ""), apply: (view: EditorView) => apply(view, fix.edits, "input.fix") }] }),
  };
}

/** Findings, at once those of the compiler, after a pause those of the analysis of values. */
function findings(documents: Documents, path: () => string): Extension {
  let pause: ReturnType<typeof setTimeout> | undefined;
  let analyzed: Text | null = null;
  const source = async (view: EditorView): Promise<Diagnostic[]> => {
    const text = view.state.doc;
    const isQuiet = analyzed === text;
    const all = isQuiet ? await documents.all(text) : await documents.findings(text);
    if (!isQuiet) {
      clearTimeout(pause);
      pause = setTimeout(() => {
        analyzed = view.state.doc;
        forceLinting(view);
      }, PAUSE);
    }
    const own = all.filter((of) => of.path === path());
    // What another file has is shown at the start of this one.
    const elsewhere = all.filter((of) => of.path !== path() && of.severity === "error");
    const there = elsewhere.map((of): LanguageFinding => ({ ...of, from: 0, to: 0, message: `${of.path}: ${of.message}`, fix: null }));
    return [...own, ...there].map((of) => diagnostic(of, text.length));
  };
  // Findings are shown with the help of the word that they are about.
  return linter(source, { delay: 120, needsRefresh: () => analyzed !== null, tooltipFilter: () => [] });
}

function completion(documents: Documents, service: LanguageService, path: () => string): Extension {
  const source = async (context: CompletionContext): Promise<CompletionResult | null> => {
    const between = context.matchBefore(/[\p{L}\p{N}_]+|\.|->\s*/u) === null && !context.explicit;
    // Between words a list is opened only where one of its first items is likely.
    if (between && context.matchBefore(/\S.*[ (,:]/u) === null) return null;
    await documents.findings(context.state.doc);
    const answer = await service.ask({ ask: "completion", path: path(), at: context.pos });
    if (answer.answer !== "completion" || context.aborted || (between && !answer.likely)) return null;
    const options = answer.items.map((item): Completion => ({
      label: item.label,
      type: ICONS[item.kind] ?? "text",
      detail: item.detail,
      boost: -item.rank,
      ...(item.snippet === null ? {} : { apply: snippet(item.snippet.replace(/\$(\d+)/g, "${$1}")) }),
    }));
    return { from: answer.from, to: Math.max(answer.to, context.pos), options, validFor: /^[\p{L}\p{N}_]*$/u };
  };
  return autocompletion({ override: [source], icons: true, activateOnTyping: true });
}

function hovers(documents: Documents, service: LanguageService, path: () => string): Extension {
  return hoverTooltip(async (view, at) => {
    await documents.findings(view.state.doc);
    const answer = await service.ask({ ask: "hover", path: path(), at });
    const here: { of: Diagnostic; from: number; to: number }[] = [];
    forEachDiagnostic(view.state, (of, from, to) => {
      if (from <= at && at <= Math.max(to, from + 1)) here.push({ of, from, to });
    });
    const help = answer.answer === "hover" ? answer : null;
    const [first] = here;
    if (help === null && first === undefined) return null;
    const create = (): { dom: HTMLElement } => {
      const dom = document.createElement("div");
      dom.append(...here.map(({ of, from, to }) => finding(view, of, from, to)));
      if (help !== null) dom.append(markdown(help.markdown));
      return { dom };
    };
    const [pos, end] = help === null ? [first?.from ?? at, first?.to ?? at] : [help.from, help.to];
    return { pos, end, above: true, create };
  });
}

/** A finding, with buttons for its repairs. */
function finding(view: EditorView, of: Diagnostic, from: number, to: number): HTMLElement {
  const dom = document.createElement("div");
  dom.className = `finding ${of.severity}`;
  dom.append(`${of.source ?? ""}: ${of.message} `);
  for (const { name, apply: run } of of.actions ?? []) {
    const repair = document.createElement("button");
    repair.type = "button";
    repair.className = "small";
    repair.textContent = name;
    repair.addEventListener("click", () => run(view, from, to));
    dom.append(repair);
  }
  return dom;
}

/** Formats the text; a text with errors stays as it is. */
export async function format(view: EditorView, service: LanguageService, path: string): Promise<boolean> {
  const text = view.state.doc;
  await service.ask({ ask: "document", path, text: text.toString() });
  const answer = await service.ask({ ask: "format", path });
  if (answer.answer !== "edits" || view.state.doc !== text) return false;
  apply(view, answer.edits, "format");
  return true;
}

const setNames = StateEffect.define<DecorationSet>();
const names = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(old, transaction) {
    const set = transaction.effects.find((effect) => effect.is(setNames));
    return set === undefined ? old.map(transaction.changes) : (set.value as DecorationSet);
  },
  provide: (field) => EditorView.decorations.from(field),
});

/** Kinds of tokens that the highlighting of words knows without the engine. */
const LEXICAL: ReadonlySet<string> = new Set(["comment", "string", "number", "keyword", "operator"]);

/** Colours names by what they are. */
function semantic(documents: Documents, service: LanguageService, path: () => string): Extension {
  const plugin = ViewPlugin.define((view) => {
    let timer: ReturnType<typeof setTimeout> | undefined;
    const refresh = async (): Promise<void> => {
      const text = view.state.doc;
      await documents.findings(text);
      const answer = await service.ask({ ask: "tokens", path: path() });
      if (answer.answer !== "tokens" || view.state.doc !== text) return;
      const marks = answer.kinds.map((kind) => Decoration.mark({ class: `sem-${kind}` }));
      const set = new RangeSetBuilder<Decoration>();
      for (const [from, to, kind] of answer.tokens) {
        const mark = marks[kind];
        if (mark !== undefined && to <= text.length && !LEXICAL.has(answer.kinds[kind] ?? "")) set.add(from, to, mark);
      }
      view.dispatch({ effects: setNames.of(set.finish()) });
    };
    const later = (delay: number): void => {
      clearTimeout(timer);
      timer = setTimeout(() => void refresh(), delay);
    };
    later(0);
    return {
      update(update: ViewUpdate) {
        if (update.docChanged) later(150);
      },
      destroy: () => clearTimeout(timer),
    };
  });
  return [names, plugin];
}

/** All of it for an editor. `path` is the file that it shows. */
export function assistance(service: LanguageService, path: () => string): Extension {
  const documents = new Documents(service, path);
  return [
    findings(documents, path),
    completion(documents, service, path),
    hovers(documents, service, path),
    semantic(documents, service, path),
    keymap.of([{ key: "Shift-Alt-f", run: (view) => (void format(view, service, path()), true) }]),
  ];
}
