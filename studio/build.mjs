// Bundles the page into one HTML file, dist/play.html, which the binary embeds. With `--watch`, again after each change.
import { build, context } from "esbuild";
import { readFile, writeFile } from "node:fs/promises";

import { define } from "./bundle.mjs";

const folder = new URL(".", import.meta.url);
const file = (path) => new URL(path, folder);

/** Puts script and style into the page. */
const intoPage = {
  name: "into-page",
  setup(of) {
    of.onEnd(async (result) => {
      if (result.errors.length > 0) return;
      const output = (ending) => result.outputFiles.find((out) => out.path.endsWith(ending)).text;
      const page = await readFile(file("src/page.html"), "utf8");
      // `</script` in a string would end the script.
      const script = output(".js").replaceAll("</script", "<\\/script");
      const parts = { "/*style*/": output(".css"), "/*script*/": script };
      const html = Object.entries(parts).reduce((text, [mark, part]) => text.replace(mark, () => part.trim()), page);
      // The same bundle keeps its time: the binary, which embeds it, is not built again.
      const known = await readFile(file("dist/play.html"), "utf8").catch(() => null);
      if (known !== html) await writeFile(file("dist/play.html"), html);
      console.log(`dist/play.html: ${Math.round(html.length / 1024)} KiB`);
    });
  },
};

const options = {
  absWorkingDir: folder.pathname,
  entryPoints: ["src/main.ts"],
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  outdir: "dist",
  write: false,
  charset: "utf8",
  legalComments: "none",
  loader: { ".css": "css" },
  define,
  plugins: [intoPage],
};

if (process.argv.includes("--watch")) {
  await (await context(options)).watch();
} else {
  await build(options);
}
