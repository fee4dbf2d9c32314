// The game as one HTML file, byte for byte as `hypedc play --export` writes it: the page, the engine and the files of the
// program. See src/cli/play/export.rs.

import type { Project } from "../worker/project.ts";

/** As in src/cli/play/export.rs. */
const POLICY =
  "default-src 'none'; script-src 'unsafe-inline' 'wasm-unsafe-eval'; style-src 'unsafe-inline'; " +
  "img-src data: blob:; worker-src blob:; base-uri 'none'; form-action 'none'";

/** A path as it is named from a folder; both are relative, without `.` and `..`. */
export function relative(folder: string[], path: string): string {
  const parts = path.split("/");
  let shared = 0;
  while (shared < folder.length && shared < parts.length && folder[shared] === parts[shared]) shared += 1;
  return [...folder.slice(shared).map(() => ".."), ...parts.slice(shared)].join("/");
}

/** The files that a program is made of, named from its folder. */
export function packedProject(project: Project, used: readonly string[]): object {
  const folder = project.root.split("/").slice(0, -1);
  const name = (path: string): string => relative(folder, path);
  const levels = [project.map, project.legend].filter((path): path is string => typeof path === "string");
  const names = [...new Set([...used, ...levels])].filter((path) => project.files[path] !== undefined);
  const files = names.map((path): [string, string] => [name(path), project.files[path]!]);
  files.sort(([a], [b]) => (a < b ? -1 : a > b ? 1 : 0));
  const pictures = Object.entries(project.pictures ?? {}).sort(([a], [b]) => (a < b ? -1 : a > b ? 1 : 0));
  return {
    files: Object.fromEntries(files),
    pictures: Object.fromEntries(pictures),
    root: name(project.root),
    map: project.map ? name(project.map) : null,
    legend: project.legend ? name(project.legend) : null,
    tile: project.tile ?? null,
  };
}

/** The page with what it carries, before its script. */
export function exportedPage(page: string, project: object, engine: string): string {
  const head = "<head>";
  const at = page.indexOf(head);
  if (at < 0) throw new Error("the page has no head");
  // A `<` in a string could end the script.
  const json = JSON.stringify(project).replaceAll("<", "\\u003c");
  return (
    `${page.slice(0, at + head.length)}\n<meta http-equiv="Content-Security-Policy" content="${POLICY}">\n` +
    `<script type="application/json" id="project">${json}</script>\n` +
    `<script type="text/plain" id="engine">${engine}</script>${page.slice(at + head.length)}`
  );
}

/** Bytes as Base64. */
export async function base64(bytes: Blob): Promise<string> {
  const reader = new FileReader();
  const done = new Promise((resolve, reject) => {
    reader.onload = resolve;
    reader.onerror = () => reject(reader.error);
  });
  reader.readAsDataURL(bytes);
  await done;
  return String(reader.result).replace(/^[^,]*,/, "");
}
