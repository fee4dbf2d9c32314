// A program with looks, for tests: a hero and grass from pictures, coins with a colour.
import { mkdir, mkdtemp, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";

import { png } from "./png.mjs";

const TEXT = `entity Hero {
    look "pictures/hero.png"
    param speed = 60
    axis horizontal
    collider body: rect(0, 0, 16, 16)
    x' = speed * horizontal
}

world Meadow {
    look coin: #ffd040
    look grass: "pictures/grass.png"
    collide body with grass: block
    collide body with coin: sense
    tiles land 16 x 16 {
        '.': empty
        '#': grass
        'o': coin
    }
    space main {
        map land "
            ..........
            ....o.....
            ##########
        "
        place hero: Hero at (32, 16)
    }
    player 1: hero
    goal over: hero.x > 100
}
`;

export const HERO = [10, 20, 230];
export const GRASS = [20, 160, 30];
export const COIN = [0xff, 0xd0, 0x40];

/** Writes the program and its pictures into a folder of its own; returns the path of the program. */
export async function meadow() {
  const folder = await mkdtemp(join(tmpdir(), "studio-"));
  await mkdir(join(folder, "pictures"));
  await writeFile(join(folder, "meadow.hyped"), TEXT);
  await writeFile(join(folder, "pictures/hero.png"), png(4, 4, () => [...HERO, 255]));
  await writeFile(join(folder, "pictures/grass.png"), png(4, 4, () => [...GRASS, 255]));
  await writeFile(join(folder, "pictures/other.png"), png(4, 4, () => [1, 2, 3, 255]));
  return join(folder, "meadow.hyped");
}

/** The colour of the stage at a place of the level. */
export function colorAt(page, x, y) {
  return page.evaluate(
    ([x, y]) => {
      const { camera, canvas } = globalThis.studio.stage;
      // By a canvas of its own: reading often from the stage makes it slow, and Chromium warns.
      const own = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
      own.drawImage(canvas, -Math.round(camera.toX(x)), -Math.round(camera.toY(y)));
      return [...own.getImageData(0, 0, 1, 1).data.slice(0, 3)];
    },
    [x, y],
  );
}

/** Waits until a place of the level has a colour. */
export async function untilColor(page, x, y, color) {
  const end = Date.now() + 20_000;
  for (;;) {
    const found = await colorAt(page, x, y);
    if (found.join() === color.join()) return;
    if (Date.now() > end) throw new Error(`(${x}, ${y}) is ${found}, not ${color}`);
    await new Promise((done) => setTimeout(done, 30));
  }
}
