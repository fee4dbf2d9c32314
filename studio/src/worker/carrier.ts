// The carrier to a worker of the page: the engine runs in the browser, nothing is on a disk. A search has a worker of its
// own, so that play goes on; it is stopped by ending that worker.

import type { Carrier } from "../carrier.ts";
import type { Answer, Request, Searching } from "../protocol.ts";
import { EngineWorker, type EngineParts } from "./client.ts";
import type { Project } from "./project.ts";

type SearchRequest = Extract<Request, { ask: "search" }>;

/** Requests after which the program may be another one. */
const CHANGES_PROGRAM: ReadonlySet<Request["ask"]> =
  new Set(["open", "reload", "edit", "set", "write", "paint", "undo"]);
/** Requests whose answers depend on the program alone, and take long. */
const MOVES_IN_TIME: ReadonlySet<Request["ask"]> = new Set(["play", "seek", "load"]);

const NOT_YET: Searching = {
  is_running: true,
  nodes: 0,
  budget: 0,
  places: 0,
  points: [],
  verdict: null,
  conclusion: null,
  script: null,
  ghost: [],
};

/** A search in a worker. */
class Search {
  private readonly worker: EngineWorker;
  private latest: Searching;
  private refusal: string | null = null;

  constructor(parts: EngineParts, project: Project, path: Request[], request: SearchRequest) {
    this.latest = { ...NOT_YET, budget: request.nodes };
    this.worker = new EngineWorker(parts, project);
    this.worker.onReport = (text) => this.take(JSON.parse(text) as Answer);
    this.worker.onFailure = (why) => this.take({ answer: "refused", message: why });
    this.worker.follow(path);
    void this.worker.ask(request).then(async (text) => {
      const started = JSON.parse(text) as Answer;
      this.take(started);
      // Where the search ended before the answer, that is the result already.
      if (started.answer === "searching" && started.is_running) {
        this.take(JSON.parse(await this.worker.ask({ ask: "poll" })) as Answer);
      }
      this.worker.end();
    });
  }

  /** How far it is; its points are told once. */
  poll(): Answer {
    if (this.refusal !== null) return { answer: "refused", message: this.refusal };
    const now = this.latest;
    this.latest = { ...now, points: [] };
    return { answer: "searching", ...now };
  }

  stop(): void {
    this.worker.end();
    if (!this.latest.is_running) return;
    const verdict = `not found; the search was stopped after ${this.latest.nodes} nodes`;
    this.latest = { ...this.latest, is_running: false, verdict, conclusion: "not-found" };
  }

  private take(answer: Answer): void {
    if (answer.answer === "refused") this.refusal = answer.message;
    if (answer.answer !== "searching") return;
    const { answer: _, ...found } = answer;
    this.latest = { ...found, points: [...this.latest.points, ...found.points] };
  }
}

/** What the analysis tells about a program, in a worker of its own: it takes up to seconds. */
class Analysis {
  private readonly worker: EngineWorker;
  private isReady = false;

  constructor(parts: EngineParts, project: Project, path: Request[], first: Request) {
    this.worker = new EngineWorker(parts, project);
    this.worker.follow(path.filter((request) => !MOVES_IN_TIME.has(request.ask)));
    void this.worker.ask(first).then(() => (this.isReady = true));
  }

  async ask(request: Request): Promise<Answer> {
    if (!this.isReady) return { answer: "bounds", is_ready: false, values: [], in_modes: [] };
    return JSON.parse(await this.worker.ask(request)) as Answer;
  }

  end(): void {
    this.worker.end();
  }
}

export class WorkerCarrier implements Carrier {
  readonly canWatch = false;
  readonly canSave = false;
  private readonly worker: EngineWorker;
  private search: Search | null = null;
  private analysis: Analysis | null = null;
  private readonly lost: ((why: string) => void)[] = [];
  /** Told of a bug of the engine, after which the page goes on. */
  onTrap: (why: string, reopened: boolean) => void = () => {};

  constructor(
    private readonly parts: EngineParts,
    private readonly project: Project,
  ) {
    this.worker = new EngineWorker(parts, project);
    this.worker.onTrap = (why, reopened) => this.onTrap(why, reopened);
    this.worker.onFailure = (why) => {
      for (const listener of this.lost) listener(`The engine stopped: ${why}`);
    };
  }

  async ask(request: Request): Promise<Answer> {
    if (request.ask === "search") return this.start(request);
    if (request.ask === "poll") return this.search?.poll() ?? { answer: "refused", message: "there is no search" };
    if (request.ask === "stop") {
      this.search?.stop();
      return { answer: "done" };
    }
    if (request.ask === "bounds") {
      this.analysis ??= new Analysis(this.parts, this.project, await this.worker.path(), request);
      return this.analysis.ask(request);
    }
    if (CHANGES_PROGRAM.has(request.ask)) this.end();
    return JSON.parse(await this.worker.ask(request)) as Answer;
  }

  async changed(): Promise<string[]> {
    return [];
  }

  async save(): Promise<string | null> {
    return "This page has no files on a disk.";
  }

  async picture(path: string): Promise<string> {
    const address = this.project.pictures?.[path];
    if (address !== undefined) return address;
    throw new Error(`cannot show \`${path}\`: this page holds no such picture`);
  }

  onLost(listener: (why: string) => void): void {
    this.lost.push(listener);
  }

  /** Ends its workers. */
  close(): void {
    this.end();
    this.worker.end();
  }

  private end(): void {
    this.search?.stop();
    this.search = null;
    this.analysis?.end();
    this.analysis = null;
  }

  private async start(request: SearchRequest): Promise<Answer> {
    this.search?.stop();
    const path = await this.worker.path();
    this.search = new Search(this.parts, this.project, path, request);
    return this.search.poll();
  }
}
