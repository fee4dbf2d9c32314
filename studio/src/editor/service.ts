// What the engine knows about texts, for the editor: the types of src/lsp/service/types.rs. Offsets count UTF-16 code
// units, as those of the editor do.

import { sessionUrl } from "../websocket.ts";
import { EngineWorker, type EngineParts } from "../worker/client.ts";
import type { Project } from "../worker/project.ts";

export type LanguageRequest =
  | { ask: "document"; path: string; text: string }
  | { ask: "analyze"; path: string }
  | { ask: "completion" | "hover" | "signature" | "definition"; path: string; at: number }
  | { ask: "format" | "symbols" | "tokens"; path: string };

export type LanguageAnswer =
  | { answer: "findings"; findings: LanguageFinding[] }
  | { answer: "completion"; from: number; to: number; items: CompletionItem[]; likely: boolean }
  | { answer: "hover"; from: number; to: number; markdown: string }
  | { answer: "signatures"; signatures: Signature[]; active: number; argument: number }
  | { answer: "definition"; path: string; from: number; to: number }
  | { answer: "edits"; edits: TextEdit[] }
  | { answer: "symbols"; symbols: TextSymbol[] }
  | { answer: "tokens"; kinds: string[]; tokens: [number, number, number][] }
  | { answer: "nothing" }
  | { answer: "refused"; message: string };

export interface LanguageFinding {
  path: string;
  from: number;
  to: number;
  severity: "error" | "warning";
  code: string;
  message: string;
  is_unnecessary: boolean;
  fix: { title: string; edits: TextEdit[] } | null;
}

export interface TextEdit { from: number; to: number; text: string }

export interface CompletionItem { label: string; kind: string; detail: string; rank: number; snippet: string | null }

export interface Signature { name: string; parameters: string[]; doc: string }

export interface TextSymbol {
  name: string;
  detail: string | null;
  from: number;
  to: number;
  name_from: number;
  name_to: number;
  children: TextSymbol[];
}

/** Answers the editor. */
export interface LanguageService {
  ask(request: LanguageRequest): Promise<LanguageAnswer>;
}

/** A service in a worker of its own: what it takes its time for does not hold up the play. */
export class WorkerLanguageService implements LanguageService {
  private readonly worker: EngineWorker;

  constructor(parts: EngineParts, project: Project) {
    this.worker = new EngineWorker(parts, project);
  }

  async ask(request: LanguageRequest): Promise<LanguageAnswer> {
    return JSON.parse(await this.worker.ask(request)) as LanguageAnswer;
  }

  close(): void {
    this.worker.end();
  }
}

/** The service of `hypedc play`: a connection of its own. */
export class WebSocketLanguageService implements LanguageService {
  private readonly waiting: ((answer: LanguageAnswer) => void)[] = [];

  private constructor(private readonly socket: WebSocket) {
    socket.addEventListener("message", (event) => this.waiting.shift()?.(JSON.parse(event.data as string) as LanguageAnswer));
    socket.addEventListener("close", () => {
      // The page says that the connection is lost: here nothing more is known.
      for (const done of this.waiting.splice(0)) done({ answer: "nothing" });
    });
  }

  static open(): Promise<WebSocketLanguageService> {
    const socket = new WebSocket(sessionUrl("language"));
    return new Promise((done, failed) => {
      socket.addEventListener("open", () => done(new WebSocketLanguageService(socket)), { once: true });
      socket.addEventListener("error", () => failed(new Error("hypedc does not answer")), { once: true });
    });
  }

  ask(request: LanguageRequest): Promise<LanguageAnswer> {
    if (this.socket.readyState !== WebSocket.OPEN) return Promise.resolve({ answer: "nothing" });
    return new Promise((done) => {
      this.waiting.push(done);
      this.socket.send(JSON.stringify(request));
    });
  }
}
