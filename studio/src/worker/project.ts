// The files of a program in the page, and the messages between the page and its workers.

import type { Request } from "../protocol.ts";

/** The files of a program: texts by name, as the engine's request `files` takes them. */
export interface Project {
  files: Record<string, string>;
  /** The pictures that the program names, as addresses that hold the whole files. The engine needs none of them. */
  pictures?: Record<string, string>;
  root: string;
  map?: string | null;
  legend?: string | null;
  tile?: [number, number] | null;
  /** The world that is opened; the first one if there is none. */
  world?: string | null;
  /** Inputs that are loaded first. */
  script?: string | null;
}

/** What the page sends to a worker. */
export type ToWorker =
  | { kind: "start"; module: WebAssembly.Module; project: Project }
  | { kind: "ask"; id: number; request: string }
  /** Asks for the requests that lead to the current state. */
  | { kind: "path"; id: number }
  /** Takes requests first whose answers nobody waits for. */
  | { kind: "follow"; requests: Request[] };

/** What a worker sends to the page. */
export type FromWorker =
  | { kind: "answer"; id: number; answer: string }
  | { kind: "path"; id: number; requests: Request[] }
  | { kind: "report"; answer: string }
  /** The engine had a bug. `reopened` says whether it goes on from the state before the request. */
  | { kind: "trapped"; id: number; why: string; reopened: boolean };
