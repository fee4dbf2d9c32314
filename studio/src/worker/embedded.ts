// What an exported page carries: the files of a program, and the engine.

import type { Project } from "./project.ts";
import { unpacked } from "./engine.ts";
import { WorkerCarrier } from "./carrier.ts";

/** The text of worker.ts as a script; the build puts it here. */
declare const WORKER_SCRIPT: string;

/** The carrier of a page that carries its engine; null if `hypedc play` serves the page. */
export async function embeddedCarrier(): Promise<WorkerCarrier | null> {
  const text = (id: string): string | null => document.getElementById(id)?.textContent ?? null;
  const [project, engine] = [text("project"), text("engine")];
  if (project === null || engine === null) return null;
  const module = await moduleOf(decoded(engine));
  return new WorkerCarrier({ script: WORKER_SCRIPT, module }, JSON.parse(project) as Project);
}

/** The bytes of Base64. */
function decoded(text: string): Uint8Array<ArrayBuffer> {
  return Uint8Array.from(atob(text.trim()), (c) => c.charCodeAt(0));
}

/** Compiles the engine. */
export async function moduleOf(packed: Uint8Array<ArrayBuffer>): Promise<WebAssembly.Module> {
  return WebAssembly.compile(await unpacked(packed));
}

/** The engine and its worker's script. */
export const workerScript = (): string => WORKER_SCRIPT;
