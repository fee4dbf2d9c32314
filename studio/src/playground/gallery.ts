// The gallery: all examples with pictures, and the start of a program of one's own.

import { h } from "../ui/dom.ts";
import type { Project } from "../worker/project.ts";

/** An example. */
export interface Entry {
  /** Its name in links. */
  id: string;
  title: string;
  /** The comment at the head of its text. */
  about: string;
  /** Names of its files in {@link Gallery.files}. */
  files: string[];
  root: string;
  map: string | null;
  /** Whether there are pictures of it. */
  hasPicture: boolean;
}

/** All examples: what the build writes into gallery.json. */
export interface Gallery {
  entries: Entry[];
  files: Record<string, string>;
}

/** The files of an example. */
export function projectOf(gallery: Gallery, entry: Entry): Project {
  const files = Object.fromEntries(entry.files.map((name) => [name, gallery.files[name] ?? ""]));
  return { files, root: entry.root, map: entry.map };
}

/** What a new program begins with. */
export const FIRST: Project = {
  root: "game.hyped",
  files: {
    "game.hyped": `// Change a number or the map: the game goes on with it at once.
entity Hero {
    param run = 90
    param jump = 260
    param gravity = 700

    axis horizontal
    button up

    collider body: rect(0, 0, 12, 14)

    x' = run * horizontal

    initial mode ground {
        y' = 0
        when pressed(up) -> air { y' := jump }
        when not touching(body, rock, below) -> air
    }
    mode air {
        y'' = -gravity
        when touching(body, rock, below) -> ground
    }
}

world Garden {
    step 1/60

    collide body with rock: block

    tiles land 16 x 16 {
        '.': empty
        '#': rock
    }

    space main {
        map land "
            ....................
            ....................
            ....................
            ...............###..
            ....................
            .........###........
            ....................
            .....##.............
            ####################
        "
        place hero: Hero at (16, 16)
    }

    player 1: hero

    goal top: hero.x > 240 and hero.y > 75
}
`,
  },
};

/** The gallery as a page. */
export function galleryPage(gallery: Gallery): HTMLElement {
  const picture = (entry: Entry, theme: string): HTMLElement =>
    h("img", { src: `pictures/${entry.id}-${theme}.svg`, alt: "", class: theme, loading: "lazy", width: 320, height: 200 });
  const card = (entry: Entry): HTMLElement =>
    h(
      "li",
      {},
      h(
        "a",
        { href: `#game=${encodeURIComponent(entry.id)}`, class: "card" },
        h("span", { class: "picture" }, ...(entry.hasPicture ? [picture(entry, "light"), picture(entry, "dark")] : [])),
        h("strong", {}, entry.title),
        h("span", { class: "quiet" }, entry.about),
      ),
    );
  return h(
    "main",
    { class: "gallery" },
    h(
      "header",
      {},
      h("h1", {}, "hypedc playground"),
      h(
        "p",
        {},
        "Games as hybrid automata, in a few lines of text: play them, change them while they run, and ask what a player " +
          "can reach. All of it runs in this page.",
      ),
      h("a", { href: "#new", class: "button primary" }, "Write a game"),
    ),
    h("ul", { class: "cards" }, ...gallery.entries.map(card)),
  );
}
