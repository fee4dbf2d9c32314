// What the program says that things look like: colours and pictures, on the stage and in the legend.
import assert from "node:assert/strict";
import { writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { after, before, test } from "node:test";

import { browser, open, play } from "./browser.mjs";
import { COIN, GRASS, HERO, meadow, untilColor } from "./meadow.mjs";
import { png } from "./png.mjs";

let chromium;
before(async () => {
  chromium = await browser();
});
after(() => chromium.close());

/** Serves a program and opens its page for a test. */
async function playing(t, ...args) {
  const server = await play(...args);
  t.after(() => server.stop());
  const opened = await open(chromium, server.url);
  t.after(() => opened.context.close());
  return opened;
}

test("things look as the program says", async (t) => {
  const path = await meadow();
  const { page, errors } = await playing(t, path);
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
  const { page } = await playing(t, await meadow());
  const asked = (path) =>
    page.evaluate((path) => globalThis.studio.game.carrier.picture(path).then((of) => of.slice(0, 22), (error) => error.message), path);
  assert.equal(await asked("pictures/hero.png"), "data:image/png;base64,");
  for (const path of ["pictures/other.png", "../pictures/hero.png", "/etc/passwd", "meadow.hyped"]) {
    assert.match(await asked(path), /the program has no picture/, path);
  }
});
