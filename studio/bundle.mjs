// What the bundles of the page and of the playground are made with: words of the grammar, and the script of workers.
import { build } from "esbuild";
import { readFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";

const folder = new URL(".", import.meta.url);

/** The keywords of the grammar: rules named `kw_…` are reserved words, `word_…` are keywords only in context. */
async function keywords() {
  const grammar = await readFile(new URL("../grammar/hyped.pest", folder), "utf8");
  return grammar.split("\n").flatMap((line) => (/^(?:kw|word)_.*?"([^"]+)"/.exec(line) ?? []).slice(1));
}

/** The script of workers: a page from a file cannot load one. */
async function workerScript() {
  const { outputFiles } = await build({
    absWorkingDir: fileURLToPath(folder),
    entryPoints: ["src/worker/worker.ts"],
    bundle: true,
    minify: true,
    format: "iife",
    target: "es2022",
    write: false,
    charset: "utf8",
    legalComments: "none",
  });
  return outputFiles[0].text.trim();
}

/** What the build knows and the sources do not. */
export const define = {
  HYPED_KEYWORDS: JSON.stringify(await keywords()),
  WORKER_SCRIPT: JSON.stringify(await workerScript()),
};
