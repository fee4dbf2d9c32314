// Programs in links: JSON, packed by deflate, in Base64 for URLs. Nothing is stored anywhere else.

import type { Project } from "../worker/project.ts";

/** Maximum size of an unpacked program, bytes: what a link brings is not trusted. */
const MAX_BYTES = 4 << 20;

async function through(bytes: Uint8Array<ArrayBuffer>, stream: ReadableWritablePair): Promise<Uint8Array<ArrayBuffer>> {
  const reader = new Blob([bytes]).stream().pipeThrough(stream as TransformStream<Uint8Array, Uint8Array>).getReader();
  const parts: Uint8Array[] = [];
  let size = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    size += value.length;
    if (size > MAX_BYTES) {
      await reader.cancel();
      throw new Error("the program in the link is too large");
    }
    parts.push(value);
  }
  const all = new Uint8Array(size);
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all;
}

/** The program as the part of a URL after `#code=`. */
export async function packed(project: Project): Promise<string> {
  const bytes = new TextEncoder().encode(JSON.stringify(project));
  const small = await through(bytes, new CompressionStream("deflate-raw"));
  let text = "";
  for (const byte of small) text += String.fromCharCode(byte);
  return btoa(text).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

/** The program of such a part. */
export async function unpackedProject(text: string): Promise<Project> {
  let project: unknown;
  try {
    const small = Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0));
    const bytes = await through(small, new DecompressionStream("deflate-raw"));
    project = JSON.parse(new TextDecoder().decode(bytes));
  } catch (error) {
    throw new Error(`the link is damaged or incomplete (${error instanceof Error ? error.message : String(error)})`);
  }
  return checked(project);
}

/** What is read from a link, if it is a program. */
function checked(value: unknown): Project {
  const of = (value ?? {}) as Record<string, unknown>;
  const isText = (text: unknown): boolean => text === undefined || text === null || typeof text === "string";
  const files = of["files"];
  const isFiles = typeof files === "object" && files !== null && Object.values(files).every((text) => typeof text === "string");
  const pictures = of["pictures"] ?? {};
  const isPicture = (address: unknown): boolean => typeof address === "string" && address.startsWith("data:image/png;base64,");
  const isPictures = typeof pictures === "object" && pictures !== null && Object.values(pictures).every(isPicture);
  const tile = of["tile"] ?? null;
  const isTile = tile === null || (Array.isArray(tile) && tile.length === 2 && tile.every((side) => typeof side === "number"));
  if (!isFiles || typeof of["root"] !== "string" || !isText(of["map"]) || !isText(of["legend"]) || !isTile || !isPictures) {
    throw new Error("the link holds no program");
  }
  const { root, map, legend } = of as unknown as Project;
  const held = { files: files as Record<string, string>, pictures: pictures as Record<string, string> };
  return { ...held, root, map: map ?? null, legend: legend ?? null, tile: tile as [number, number] | null };
}
