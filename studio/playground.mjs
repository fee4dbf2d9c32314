// Builds the playground, a static site, into dist/playground: the page, the engine of bindings/web/dist, and a gallery of
// all examples with pictures that the engine draws. `node playground.mjs [ENGINE]`
import { build } from "esbuild";
import { copyFile, mkdir, readFile, rm, stat, writeFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { gunzipSync } from "node:zlib";

import { WebEngine } from "../bindings/web/test/engines.mjs";
import { games, inputs } from "../bindings/web/test/games.mjs";
import { define } from "./bundle.mjs";

const folder = new URL(".", import.meta.url);
const target = new URL("dist/playground/", folder);
const engine = process.argv[2] ?? fileURLToPath(new URL("../bindings/web/dist/hypedc.wasm.gz", folder));

await rm(target, { recursive: true, force: true });
await mkdir(new URL("pictures/", target), { recursive: true });
await build({
  absWorkingDir: fileURLToPath(folder),
  entryPoints: { playground: "src/playground/main.ts" },
  outdir: fileURLToPath(target),
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  charset: "utf8",
  legalComments: "none",
  define,
});
await copyFile(new URL("src/playground/page.html", folder), new URL("index.html", target));
await copyFile(new URL("dist/play.html", folder), new URL("play.html", target));
await copyFile(engine, new URL("hypedc.wasm.gz", target));

/** The module that draws pictures, for this process. */
const drawing = await build({
  absWorkingDir: fileURLToPath(folder),
  entryPoints: ["src/playground/thumbnail.ts"],
  bundle: true,
  format: "esm",
  write: false,
});
const { thumbnail } = await import(`data:text/javascript,${encodeURIComponent(drawing.outputFiles[0].text)}`);

/** The part of the way to the goal that a picture shows. */
const MOMENT = 0.45;

/** A frame of a game as pictures, light and dark. */
function pictures(of, project) {
  const ask = (request) => JSON.parse(of.ask(request));
  ask({ ask: "files", ...project });
  const opened = ask({ ask: "open" });
  if (!opened.scene) throw new Error(`${project.root} has errors: ${JSON.stringify(opened.findings)}`);
  const script = inputs(project.root);
  let { shown } = opened;
  if (script !== null) {
    const end = ask({ ask: "load", script });
    if (end.answer === "shown") shown = ask({ ask: "seek", frame: Math.round(end.length * MOMENT) });
  }
  return ["light", "dark"].map((theme) => [theme, thumbnail(opened.scene, shown.frame, theme)]);
}

/** The comment at the head of a program, in one paragraph. */
function about(text) {
  const lines = text.split("\n");
  const end = lines.findIndex((line) => !line.startsWith("//"));
  const words = lines.slice(0, end < 0 ? lines.length : end).map((line) => line.replace(/^\/+ ?/, ""));
  // The lines that show commands or draw a plan say nothing here.
  return words.filter((line) => !/^\s*(hypedc|\$) |·/.test(line)).join(" ").replace(/\s+/g, " ").trim();
}

const module = new URL("engine.wasm", target);
await writeFile(module, gunzipSync(await readFile(engine)));
const web = new WebEngine(fileURLToPath(module));
await rm(module);

const gallery = { entries: [], files: {} };
const title = (name) =>
  name.replace(/^.*\//, "").replaceAll("_", " ").replace(/([a-z])(\d)/, "$1 $2").replace(/^./, (c) => c.toUpperCase());
for (const { name, project } of games()) {
  const map = project.map ?? null;
  const id = name.replaceAll(/[^\w-]+/g, "-").replace(/-txt$/, "");
  Object.assign(gallery.files, project.files);
  for (const [theme, svg] of pictures(web, project)) await writeFile(new URL(`pictures/${id}-${theme}.svg`, target), svg);
  const level = map === null ? "" : `: ${map.replace(/^.*\//, "").replace(/\.txt$/, "")}`;
  gallery.entries.push({
    id,
    title: title(name.split(",")[0]) + level,
    about: about(project.files[project.root]),
    files: Object.keys(project.files),
    root: project.root,
    map,
    hasPicture: true,
  });
}
await writeFile(new URL("gallery.json", target), JSON.stringify(gallery));
for (const file of ["playground.js", "playground.css", "gallery.json", "hypedc.wasm.gz"]) {
  console.log(`dist/playground/${file}: ${Math.round((await stat(new URL(file, target))).size / 1024)} KiB`);
}
console.log(`dist/playground: ${gallery.entries.length} games`);
