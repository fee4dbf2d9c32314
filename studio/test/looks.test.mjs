// What the program says that things look like: colours and pictures, on the stage and in the legend.
import assert from "node:assert/strict";
import { mkdtemp, readFile, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";

import { browser, playing, until } from "./browser.mjs";
import { COIN, GRASS, HERO, meadow, untilColor } from "./meadow.mjs";
import { png } from "./png.mjs";

let chromium;
before(async () => {
  chromium = await browser();
});
after(() => chromium.close());

test("things look as the program says", async (t) => {
  const path = await meadow();
  const { page, errors } = await playing(chromium, t, [path]);
  await untilColor(page, 40, 24, HERO);
  await untilColor(page, 100, 8, GRASS);
  await untilColor(page, 72, 24, COIN);
  assert.equal(await page.locator(".legend img").count(), 2, "the legend shows the pictures");
  // A picture that is painted anew is shown at once.
  await writeFile(join(dirname(path), "pictures/hero.png"), png(8, 8, () => [200, 10, 90, 255]));
  await untilColor(page, 40, 24, [200, 10, 90]);
  assert.deepEqual(errors, []);
});

test("a page gets only pictures that the program names", async (t) => {
  const { page } = await playing(chromium, t, [await meadow()]);
  const asked = (path) =>
    page.evaluate((path) => globalThis.studio.game.carrier.picture(path).then((of) => of.slice(0, 22), (error) => error.message), path);
  assert.equal(await asked("pictures/hero.png"), "data:image/png;base64,");
  for (const path of ["pictures/other.png", "../pictures/hero.png", "/etc/passwd", "meadow.hyped"]) {
    assert.match(await asked(path), /the program has no picture/, path);
  }
});

test("a level shows the tiles of its editor, and is painted", async (t) => {
  const folder = await mkdtemp(join(tmpdir(), "studio-"));
  // Two tiles: the first is red on the left and blue on the right, the second green.
  const [RED, BLUE, GREEN] = [[200, 30, 30], [30, 30, 200], [30, 180, 60]];
  const pixel = (x) => [...(x >= 16 ? GREEN : x < 8 ? RED : BLUE), 255];
  await writeFile(join(folder, "tiles.png"), png(32, 16, pixel));
  const mirrored = 2 ** 31 + 1;
  const level = {
    type: "map", orientation: "orthogonal", width: 4, height: 3, tilewidth: 16, tileheight: 16,
    layers: [{ type: "tilelayer", name: "ground", width: 4, height: 3, data: [0, 0, 0, 0, 0, 0, 0, 2, 1, mirrored, 1, 1] }],
    tilesets: [{ firstgid: 1, name: "t", tilewidth: 16, tileheight: 16, tilecount: 2, columns: 2, image: "tiles.png", imagewidth: 32, imageheight: 16 }],
  };
  await writeFile(join(folder, "room.tmj"), JSON.stringify(level));
  const text = `entity Hero {
    collider body: rect(0, 0, 8, 8)
    param speed = 10
    x' = speed
}
world Room {
    collide body with ground: block
    space main {
        map tiled "room.tmj" { ground: ground }
        place hero: Hero at (0, 16)
    }
    player 1: hero
    goal far: hero.x > 20
}
`;
  await writeFile(join(folder, "room.hyped"), text);
  const { page, errors } = await playing(chromium, t, [join(folder, "room.hyped")]);
  await untilColor(page, 4, 8, RED);
  await untilColor(page, 12, 8, BLUE);
  await untilColor(page, 20, 8, BLUE);
  await untilColor(page, 28, 8, RED);
  await untilColor(page, 56, 24, GREEN);
  await page.getByRole("tab", { name: "Edit" }).click();
  // The mirrored tile is painted over: one number of the file changes.
  await page.locator('.paint input[value="0/2"]').check();
  assert.equal(await page.locator(".paint .alike canvas").count(), 2, "the choice shows the tiles");
  const spot = await page.evaluate(() => {
    const { camera, ratio } = globalThis.studio.stage;
    return { x: camera.toX(24) / ratio, y: camera.toY(8) / ratio };
  });
  await page.locator(".stage canvas").click({ position: spot });
  await untilColor(page, 24, 8, GREEN);
  await page.getByLabel("File", { exact: true }).selectOption({ label: "room.tmj" }).catch(() => undefined);
  await page.getByRole("button", { name: "Save" }).click();
  await until(page, "document.querySelector('.toasts')?.textContent.includes('saved')");
  const before = JSON.stringify(level);
  assert.equal(await readFile(join(folder, "room.tmj"), "utf8"), before.replace(String(mirrored), "2"));
  // What the map cannot be painted for is said.
  const packed = JSON.stringify({ ...level, layers: [{ ...level.layers[0], encoding: "base64", data: "" }] });
  const bytes = Buffer.alloc(48);
  level.layers[0].data.forEach((number, at) => bytes.writeUInt32LE(number, 4 * at));
  await writeFile(join(folder, "room.tmj"), packed.replace('"data":""', `"data":"${bytes.toString("base64")}"`));
  await page.getByText("The tiles of the layer `ground` are packed").waitFor();
  // A level that is saved in its editor is shown at once.
  level.layers[0].data[0] = 2;
  await writeFile(join(folder, "room.tmj"), JSON.stringify(level));
  await untilColor(page, 8, 40, GREEN);
  assert.deepEqual(errors, []);
});
