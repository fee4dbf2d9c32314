// What an exported page carries: the files of a program, and the engine.

import type { Report } from "../report.ts";
import type { Project } from "./project.ts";
import type { EngineParts } from "./client.ts";
import { unpacked } from "./engine.ts";

/** The text of worker.ts as a script; the build puts it here. */
declare const WORKER_SCRIPT: string;

/** What a page carries, ready to run. */
export interface Embedded {
  parts: EngineParts;
  project: Project;
  /** What a command reports about the program. */
  report: Report | null;
}

/** What this page carries; null if `hypedc play` serves it. */
export async function embedded(): Promise<Embedded | null> {
  const text = (id: string): string | null => document.getElementById(id)?.textContent ?? null;
  const [project, engine] = [text("project"), text("engine")];
  if (project === null || engine === null) return null;
  const report = JSON.parse(text("report") ?? "null") as Report | null;
  return { parts: await partsOf(decoded(engine)), project: JSON.parse(project) as Project, report };
}

/** The bytes of Base64. */
function decoded(text: string): Uint8Array<ArrayBuffer> {
  return Uint8Array.from(atob(text.trim()), (c) => c.charCodeAt(0));
}

/** Compiles the engine, which may be packed by gzip. */
export async function partsOf(bytes: Uint8Array<ArrayBuffer>): Promise<EngineParts> {
  return { script: WORKER_SCRIPT, module: await WebAssembly.compile(await unpacked(bytes)) };
}
