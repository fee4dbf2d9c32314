// What the engine knows about texts, for the editor: the types of src/lsp/service/types.rs. Offsets count UTF-16 code
// units, as those of the editor do.

import { EngineWorker, type EngineParts } from "../worker/client.ts";
import type { Project } from "../worker/project.ts";

export type LanguageRequest =
  | { ask: "document"; path: string; text: string }
  | { ask: "analyze"; path: string }
  | { ask: "completion" | "hover" | "signature" | "definition"; path: string; at: number }
  | { ask: "format" | "symbols" | "tokens"; path: string };

export type LanguageAnswer =
  | { answer: "findings"; findings: LanguageFinding[] }
  | { answer: "completion"; from: number; to: number; items: CompletionItem[] }
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
