// The requests that lead to the state of a session, kept short: after a trap a new engine takes them, and so does the
// engine of a search.

import type { Answer, Held, Request } from "../protocol.ts";

/** Requests that change a session. */
export const CHANGES: ReadonlySet<Request["ask"]> =
  new Set(["open", "reload", "edit", "set", "write", "paint", "undo", "play", "seek", "load", "keep"]);
/** Maximum number of requests before they are replaced by what they led to. */
const MAX_LENGTH = 1_500;
/** As well, characters of texts in them. */
const MAX_TEXT = 1 << 20;
/** Maximum number of steps of one request to play, as the session has it. */
const MAX_STEPS = 3_600;

/** Asks the engine, for what the ledger needs to know. */
export type Ask = (request: Request | { ask: "paths" }) => Answer | { answer: "paths"; paths: string[] };

/** The number of frames of a history, and which one is shown. */
type Frames = WeakMap<Request, { length: number; at: number }>;

export class Ledger {
  private requests: Request[] = [];
  private text = 0;
  /** Texts of edits that the compiler takes; a text with errors leaves the last good program running. */
  private isCurrent = true;

  /** What requests that change more than the time led to. */
  private readonly frames: Frames = new WeakMap();

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
    const shown = answer.answer === "opened" ? answer.shown : answer.answer === "shown" ? answer : null;
    if (shown && request.ask !== "play" && request.ask !== "seek") {
      this.frames.set(request, { length: shown.length, at: shown.frame.at });
    }
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
    // Where a state goes on after a change, no script leads to it.
    const isCarried = script.answer !== "text";
    if (isCarried && this.mergePlay()) return;
    if (paths.answer !== "paths") return;
    const next: Request[] = [...this.kept(), { ask: "open", world: opened?.ask === "open" ? (opened.world ?? null) : null }];
    let text = isCarried ? 0 : script.text.length;
    for (const path of paths.paths) {
      const now = ask({ ask: "text", path });
      if (now.answer !== "text" || now.text === this.files[path]) continue;
      next.push({ ask: "edit", path, text: now.text });
      text += now.text.length;
    }
    // After too many changes, a run that goes on from a state is forgotten: after a trap the world begins again.
    if (!isCarried) {
      const shown = ask({ ask: "play", inputs: [] });
      if (shown.answer !== "shown") return;
      next.push({ ask: "load", script: script.text }, { ask: "seek", frame: shown.frame.at });
    }
    this.requests = next;
    this.text = text;
  }

  /** Joins what was played between two changes; returns false if that leaves too much. */
  private mergePlay(): boolean {
    this.requests = merged(this.requests, this.frames);
    return this.requests.length <= MAX_LENGTH / 2 && this.text <= MAX_TEXT;
  }
}

/** The same requests with fewer that play and seek: those between two others lead to one history and one frame in it. */
function merged(requests: Request[], frames: Frames): Request[] {
  const next: Request[] = [];
  // Equal inputs are kept once.
  const known = new Map<string, Held[]>();
  const shared = (of: Held[]): Held[] => {
    const key = JSON.stringify(of);
    const same = known.get(key) ?? of;
    known.set(key, same);
    return same;
  };
  // The frames that the last request but these led to, those played after them, and the one that is shown.
  let base = 0;
  let inputs: Held[][] = [];
  let at = 0;
  let isKnown = false;
  const flush = (): void => {
    if (inputs.length > 0) next.push({ ask: "seek", frame: base });
    for (let from = 0; from < inputs.length; from += MAX_STEPS) {
      next.push({ ask: "play", inputs: inputs.slice(from, from + MAX_STEPS) });
    }
    base += inputs.length;
    inputs = [];
    if (isKnown) next.push({ ask: "seek", frame: at });
  };
  for (const request of requests) {
    if (isKnown && request.ask === "play") {
      if (request.inputs.length === 0) continue;
      if (at < base) {
        base = at;
        inputs = [];
      }
      inputs.length = at - base;
      for (const of of request.inputs) inputs.push(shared(of));
      at = base + inputs.length;
    } else if (isKnown && request.ask === "seek") {
      at = Math.min(request.frame, base + inputs.length);
    } else {
      flush();
      next.push(request);
      const led = frames.get(request);
      if (request.ask === "keep" && isKnown) continue;
      isKnown = led !== undefined;
      if (led) [base, at] = [led.length, led.at];
    }
  }
  flush();
  return next;
}
