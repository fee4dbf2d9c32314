// The playground: a gallery, and for each of its games and each link the page with editor and engine.

import "../style.css";
import "../editor/editor.css";
import "./playground.css";
import { ask } from "../carrier.ts";
import type { Studio } from "../app.ts";
import { recall } from "../memory.ts";
import { button, h } from "../ui/dom.ts";
import { download } from "../ui/play_panel.ts";
import type { EngineParts } from "../worker/client.ts";
import { partsOf } from "../worker/embedded.ts";
import type { Project } from "../worker/project.ts";
import { startInBrowser } from "../worker/studio.ts";
import { base64, exportedPage, packedProject } from "./export.ts";
import { FIRST, galleryPage, projectOf, type Gallery } from "./gallery.ts";
import { packed, unpackedProject } from "./share.ts";

declare global {
  interface Window {
    studio?: Studio;
  }
}

/** Width of the window from which the text is shown beside the game, px. */
const WIDE = 1000;

const fetched = async (name: string): Promise<Response> => {
  const response = await fetch(name);
  if (!response.ok) throw new Error(`${name}: ${response.status} ${response.statusText}`);
  return response;
};

/** The engine, from the same place as the page. */
async function engine(): Promise<EngineParts> {
  return partsOf(new Uint8Array(await (await fetched("hypedc.wasm.gz")).arrayBuffer()));
}

/** The program that the address names; null for the gallery. */
async function named(gallery: Promise<Gallery>): Promise<Project | null> {
  const [kind, value = ""] = location.hash.slice(1).split("=", 2);
  if (kind === "new") return FIRST;
  if (kind === "code") return unpackedProject(value);
  if (kind !== "game") return null;
  const all = await gallery;
  const entry = all.entries.find(({ id }) => id === decodeURIComponent(value));
  if (entry === undefined) throw new Error("there is no such game in the gallery");
  return projectOf(all, entry);
}

/** The program as it is now. */
async function current(studio: Studio, project: Project): Promise<Project> {
  const files = { ...project.files };
  for (const path of studio.game.opened?.files ?? []) {
    const { text } = await ask(studio.game.carrier, "text", { ask: "text", path, written: true });
    files[path] = text;
  }
  return { ...project, files };
}

async function share(studio: Studio, project: Project): Promise<void> {
  const url = new URL(location.href);
  const now = await current(studio, project);
  // Only the files that the program is made of.
  const used = studio.game.opened?.files ?? [];
  const files = Object.fromEntries(Object.entries(now.files).filter(([name]) => used.includes(name)));
  url.hash = `code=${await packed({ ...now, files })}`;
  history.replaceState(null, "", url);
  try {
    await navigator.clipboard.writeText(url.href);
    studio.toasts.show(`The link is copied: it holds the whole program, in ${url.href.length} characters`, "good");
  } catch {
    studio.toasts.show("The address of this page is the link now: it holds the whole program", "good");
  }
}

/** Gives the game to the browser's downloads, as one file. */
async function exportGame(studio: Studio, project: Project): Promise<void> {
  try {
    const [page, engine] = await Promise.all([
      fetched("play.html").then((response) => response.text()),
      fetched("hypedc.wasm.gz").then((response) => response.blob()).then(base64),
    ]);
    const used = studio.game.opened?.files ?? [];
    const html = exportedPage(page, packedProject(await current(studio, project), used), engine);
    const name = (project.root.split("/").pop() ?? "game").replace(/\.hyped$/, ".html");
    download(name, html);
    studio.toasts.show(`${name}: one file that plays without a network, ${Math.ceil(html.length / 1000)} kB`, "good");
  } catch (error) {
    studio.toasts.show(`The game cannot be exported: ${error instanceof Error ? error.message : String(error)}`, "bad");
  }
}

async function play(project: Project, parts: Promise<EngineParts>): Promise<void> {
  const host = h("div", { class: "page" });
  document.body.replaceChildren(host);
  const studio = await startInBrowser(await parts, project, { host });
  studio.bar.prepend(h("a", { href: "#", class: "button small back" }, "Gallery"));
  const theme = studio.bar.querySelector(".grow");
  theme?.after(
    button("Share", () => void share(studio, project), "small"),
    button("Export", () => void exportGame(studio, project), "small export"),
  );
  if (innerWidth >= WIDE) studio.sidebar.show("text");
  window.studio = studio;
}

async function main(): Promise<void> {
  // Everything is asked for at once.
  const gallery = fetched("gallery.json").then((response) => response.json() as Promise<Gallery>);
  const parts = engine();
  gallery.catch(() => undefined);
  parts.catch(() => undefined);
  try {
    const project = await named(gallery);
    if (project !== null) return await play(project, parts);
    const chosen = recall("theme");
    const isDark = chosen === "dark" || (chosen !== "light" && matchMedia("(prefers-color-scheme: dark)").matches);
    document.documentElement.dataset["theme"] = isDark ? "dark" : "light";
    document.body.replaceChildren(galleryPage(await gallery));
  } catch (error) {
    const why = error instanceof Error ? error.message : String(error);
    const back = h("p", {}, h("a", { href: "#" }, "To the gallery"));
    document.body.replaceChildren(h("main", { class: "failed", role: "alert" }, `This cannot be played: ${why}.`, back));
  }
}

addEventListener("hashchange", () => location.reload());
void main();
