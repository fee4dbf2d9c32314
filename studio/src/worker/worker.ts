// The worker: an engine that answers the page's requests in order. If the engine traps, a new one goes on from the state
// before the request that did it.

import type { Answer, Request } from "../protocol.ts";
import { Engine } from "./engine.ts";
import { CHANGES, Ledger, type Ask } from "./ledger.ts";
import type { FromWorker, Project, ToWorker } from "./project.ts";

const post = (message: FromWorker): void => postMessage(message);

class Host {
  private readonly ledger: Ledger;
  /** Why the last trap happened, as the engine said. */
  private panic = "";

  private constructor(
    private readonly module: WebAssembly.Module,
    private readonly project: Project,
    private engine: Engine,
  ) {
    this.ledger = new Ledger(project.files);
  }

  static async start(module: WebAssembly.Module, project: Project): Promise<Host> {
    const host: Host = new Host(module, project, await Host.engine(module, project, (why) => (host.panic = why)));
    return host;
  }

  private static async engine(
    module: WebAssembly.Module,
    project: Project,
    panicked: (why: string) => void,
  ): Promise<Engine> {
    const engine = await Engine.of(module, (kind, text) => {
      if (kind === "panic") panicked(text);
      else post({ kind: "report", answer: text });
    });
    engine.ask(JSON.stringify({ ask: "files", ...project }));
    return engine;
  }

  /** Takes requests whose answers nobody waits for. */
  follow(requests: Request[]): void {
    for (const request of requests) this.noted(request, this.engine.ask(JSON.stringify(request)));
  }

  path(): Request[] {
    return this.ledger.path();
  }

  /** Answers a request. */
  async answer(id: number, text: string): Promise<void> {
    let answer: string;
    try {
      answer = this.engine.ask(text);
    } catch (trap) {
      const why = this.panic || String(trap);
      this.panic = "";
      post({ kind: "trapped", id, why, reopened: await this.reopen() });
      return;
    }
    post({ kind: "answer", id, answer });
    this.noted(JSON.parse(text) as Request, answer);
  }

  private noted(request: Request, answer: string): void {
    if (!CHANGES.has(request.ask)) return;
    const ask: Ask = (of) => JSON.parse(this.engine.ask(JSON.stringify(of))) as Answer;
    // Frames are the most frequent answers: only those with the state of the text are read.
    const isFrame = request.ask === "play" || request.ask === "seek";
    const isRead = !isFrame || !answer.startsWith('{"answer":"shown"');
    const read = isRead ? (JSON.parse(answer) as Answer) : ({ answer: "done" } as Answer);
    this.ledger.note(request, read, ask);
  }

  /** A new engine in the state of the old one; returns false if it does not get there. */
  private async reopen(): Promise<boolean> {
    try {
      this.engine = await Host.engine(this.module, this.project, (why) => (this.panic = why));
      for (const request of this.ledger.path()) this.engine.ask(JSON.stringify(request));
      return true;
    } catch {
      this.engine = await Host.engine(this.module, this.project, (why) => (this.panic = why));
      return false;
    }
  }
}

let host: Promise<Host> | null = null;
// Messages are taken one after the other.
let turn: Promise<unknown> = Promise.resolve();

addEventListener("message", (event: MessageEvent<ToWorker>) => {
  const message = event.data;
  if (message.kind === "start") host = Host.start(message.module, message.project);
  turn = turn.then(async () => {
    const of = await host;
    if (of === null) return;
    if (message.kind === "ask") await of.answer(message.id, message.request);
    if (message.kind === "path") post({ kind: "path", id: message.id, requests: of.path() });
    if (message.kind === "follow") of.follow(message.requests);
  });
});
