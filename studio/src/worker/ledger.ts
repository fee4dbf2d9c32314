// The requests that lead to the state of a session, kept short: after a trap a new engine takes them, and so does the
// engine of a search.

import type { Answer, Request } from "../protocol.ts";

/** Requests that change a session. */
export const CHANGES: ReadonlySet<Request["ask"]> =
  new Set(["open", "reload", "edit", "set", "write", "paint", "undo", "play", "seek", "load", "keep"]);
/** Maximum number of requests before they are replaced by what they led to. */
const MAX_LENGTH = 1_500;
/** As well, characters of texts in them. */
const MAX_TEXT = 1 << 20;

/** Asks the engine, for what the ledger needs to know. */
export type Ask = (request: Request | { ask: "paths" }) => Answer | { answer: "paths"; paths: string[] };

export class Ledger {
  private requests: Request[] = [];
  private text = 0;
  /** Texts of edits that the compiler takes; a text with errors leaves the last good program running. */
  private isCurrent = true;

  constructor(private readonly files: Record<string, string>) {}

  /** Notes a request of {@link CHANGES} that was answered. */
  note(request: Request, answer: Answer, ask: Ask): void {
    if (answer.answer === "refused") return;
    if (request.ask === "open") this.forgetPlay();
    // What one sought is forgotten by the next seek.
    if (request.ask === "seek" && this.requests.at(-1)?.ask === "seek") this.requests.pop();
    // A text with errors leaves the game as it is: the next text of its file takes its place.
    const last = this.requests.at(-1);
    if (!this.isCurrent && request.ask === "edit" && last?.ask === "edit" && last.path === request.path) {
      this.requests.pop();
      this.text -= last.text?.length ?? 0;
    }
    if (answer.answer === "opened") this.isCurrent = answer.is_current;
    this.requests.push(request);
    if (request.ask === "edit") this.text += request.text?.length ?? 0;
    if (request.ask === "load") this.text += request.script.length;
    if (this.isCurrent && (this.requests.length > MAX_LENGTH || this.text > MAX_TEXT)) this.shorten(ask);
  }

  /** The requests, in order. */
  path(): Request[] {
    return [...this.requests];
  }

  /** Opening a world keeps the texts alone. */
  private forgetPlay(): void {
    if (this.requests.some(({ ask }) => ask === "write" || ask === "paint" || ask === "undo")) return;
    const last = new Map<string | null | undefined, Request>();
    for (const request of this.requests) if (request.ask === "edit") last.set(request.path, request);
    this.requests = [...this.kept(), ...last.values()];
  }

  /** What was last said to go on after a change. */
  private kept(): Request[] {
    return this.requests.filter(({ ask }) => ask === "keep").slice(-1);
  }

  /** Replaces the requests by others that lead to the same texts, world, inputs and frame. */
  private shorten(ask: Ask): void {
    const paths = ask({ ask: "paths" });
    const script = ask({ ask: "script" });
    const opened = this.requests.find((request) => request.ask === "open");
    if (paths.answer !== "paths" || script.answer !== "text") return;
    const next: Request[] = [...this.kept(), { ask: "open", world: opened?.ask === "open" ? (opened.world ?? null) : null }];
    let text = script.text.length;
    for (const path of paths.paths) {
      const now = ask({ ask: "text", path });
      if (now.answer !== "text" || now.text === this.files[path]) continue;
      next.push({ ask: "edit", path, text: now.text });
      text += now.text.length;
    }
    const shown = ask({ ask: "play", inputs: [] });
    if (shown.answer !== "shown") return;
    next.push({ ask: "load", script: script.text }, { ask: "seek", frame: shown.frame.at });
    this.requests = next;
    this.text = text;
  }
}
