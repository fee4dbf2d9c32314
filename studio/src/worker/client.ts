// A worker with an engine, as the page sees it.

import type { Request } from "../protocol.ts";
import type { FromWorker, Project, ToWorker } from "./project.ts";

/** Makes a worker from its script: a page from a file may load none by URL. */
function workerOf(script: string): Worker {
  const url = URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
  try {
    return new Worker(url);
  } finally {
    // The worker has begun to load it.
    setTimeout(() => URL.revokeObjectURL(url), 10_000);
  }
}

/** What the worker needs. */
export interface EngineParts {
  /** The text of worker.ts as a script. */
  script: string;
  module: WebAssembly.Module;
}

export class EngineWorker {
  private readonly worker: Worker;
  private readonly waiting = new Map<number, (answer: FromWorker) => void>();
  private next = 0;
  /** Told of what the engine reports. */
  onReport: (answer: string) => void = () => {};
  /** Told of a bug of the engine. */
  onTrap: (why: string, reopened: boolean) => void = () => {};
  /** Told if the worker itself fails. */
  onFailure: (why: string) => void = () => {};

  constructor(parts: EngineParts, project: Project) {
    this.worker = workerOf(parts.script);
    this.worker.addEventListener("message", (event: MessageEvent<FromWorker>) => this.take(event.data));
    this.worker.addEventListener("error", (event) => this.onFailure(event.message));
    const { pictures: _, ...texts } = project;
    this.send({ kind: "start", module: parts.module, project: texts });
  }

  /** Asks; the answer is JSON. A request on which the engine fails is refused. */
  async ask(request: object): Promise<string> {
    const id = this.next++;
    const answer = await this.answered(id, { kind: "ask", id, request: JSON.stringify(request) });
    if (answer.kind === "answer") return answer.answer;
    const why = answer.kind === "trapped" ? answer.why : "no answer";
    const message = `The engine failed on this request, which is a bug of hypedc: ${why.split("\n").slice(0, 2).join(" ")}`;
    return JSON.stringify({ answer: "refused", message });
  }

  /** The requests that lead to the state of its session. */
  async path(): Promise<Request[]> {
    const id = this.next++;
    const answer = await this.answered(id, { kind: "path", id });
    return answer.kind === "path" ? answer.requests : [];
  }

  follow(requests: Request[]): void {
    this.send({ kind: "follow", requests });
  }

  end(): void {
    this.worker.terminate();
  }

  private send(message: ToWorker): void {
    this.worker.postMessage(message);
  }

  private answered(id: number, message: ToWorker): Promise<FromWorker> {
    return new Promise((done) => {
      this.waiting.set(id, done);
      this.send(message);
    });
  }

  private take(message: FromWorker): void {
    if (message.kind === "report") return this.onReport(message.answer);
    if (message.kind === "trapped") this.onTrap(message.why, message.reopened);
    this.waiting.get(message.id)?.(message);
    this.waiting.delete(message.id);
  }
}
