// Draws the pictures of the page in docs/pictures/studio: node test/screenshots.mjs [NAME]…
// Needs Chromium and pngquant; for reports the engine of `bindings/web/build`.
import { execFileSync, spawnSync } from "node:child_process";
import { mkdirSync, mkdtempSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

import { browser, hypedc, open, play, root } from "./browser.mjs";

const FOLDER = `${root}docs/pictures/studio`;
const DESK = { width: 1200, height: 760 };
const PHONE = { width: 390, height: 780 };

/** Holds keys for some time. */
async function hold(page, keys, time) {
  for (const key of keys) await page.keyboard.down(key);
  await page.waitForTimeout(time);
  for (const key of keys) await page.keyboard.up(key);
}
const pause = (page) => page.evaluate("globalThis.studio.game.pause()");
const tab = (page, name) => page.getByRole("tab", { name, exact: true }).click();
const close = (page) => page.evaluate("globalThis.studio.sidebar.open(false)");
/** Loads the inputs of a file and shows a part of them. */
async function load(page, file, part) {
  const { readFile } = await import("node:fs/promises");
  const script = await readFile(`${root}${file}`, "utf8");
  await page.evaluate(
    async ([script, part]) => {
      const { game } = globalThis.studio;
      await game.load(script);
      await game.seek(game.length * part);
    },
    [script, part],
  );
  await page.waitForTimeout(900);
}
const search = async (page) => {
  await page.getByRole("button", { name: "Reach from here" }).click();
  await page.locator(".verdict").waitFor({ timeout: 120_000 });
};

/** Writes the page of a command; returns its address. */
function report(args) {
  const path = join(mkdtempSync(join(tmpdir(), "hypedc-report-")), "report.html");
  spawnSync(hypedc, [...args, "--html", path, "--engine", "bindings/web/dist/hypedc.wasm.gz"], { cwd: root });
  return { url: pathToFileURL(path).href, stop: async () => {} };
}

const PICTURES = {
  report: [
    "reach examples/platforms.hyped",
    "light",
    DESK,
    async (page) => {
      await page.locator(".moment").first().waitFor();
      await page.evaluate("globalThis.studio.game.seek(430)");
    },
  ],
  mario: ["examples/mario.hyped", "light", DESK, (page) => load(page, "examples/inputs/mario.inputs", 0.45)],
  tune: [
    "examples/mario.hyped",
    "dark",
    DESK,
    async (page) => {
      await hold(page, ["ArrowRight"], 900);
      await pause(page);
      await tab(page, "Tune");
      const number = page.getByLabel("Mario.jump_speed, exact");
      await number.fill("240");
      await number.press("Enter");
      await page.waitForTimeout(500);
      await page.locator(".slider.changed").evaluate((row) => row.scrollIntoView({ block: "center" }));
      await page.locator(".stage canvas").focus();
    },
  ],
  know: [
    "examples/balloon.hyped",
    "light",
    DESK,
    async (page) => {
      await tab(page, "Know");
      await page.locator(".stage canvas").focus();
      await hold(page, ["Space"], 1100);
      await pause(page);
      await page.getByRole("button", { name: "Show what each value can be" }).click();
      await page.locator("td.can-be").first().waitFor({ timeout: 60_000 });
    },
  ],
  ask: [
    "examples/platforms.hyped",
    "light",
    DESK,
    async (page) => {
      await tab(page, "Ask");
      await search(page);
    },
  ],
  edit: [
    "examples/cavern.hyped",
    "dark",
    DESK,
    async (page) => {
      await tab(page, "Edit");
      await load(page, "examples/inputs/cavern.inputs", 0.3);
    },
  ],
  smb: [
    "examples/smb/smb.hyped --map examples/smb/mario-1-1.txt",
    "dark",
    DESK,
    async (page) => {
      await close(page);
      await hold(page, ["ArrowRight"], 2200);
      await hold(page, ["ArrowRight", "Space"], 350);
      await pause(page);
    },
  ],
  map: ["examples/zelda/tloz1_1.hyped", "dark", DESK, (page) => page.keyboard.press("m")],
  rooms: ["examples/metroidvania.hyped", "light", DESK, (page) => load(page, "examples/inputs/metroidvania.inputs", 0.6)],
  shmup: ["examples/shmup.hyped", "dark", DESK, (page) => load(page, "examples/inputs/shmup.inputs", 0.5)],
  maze: ["examples/pac_man.hyped", "dark", DESK, (page) => load(page, "examples/inputs/pac_man.inputs", 0.5)],
  pong: [
    "examples/pong.hyped",
    "light",
    DESK,
    async (page) => {
      await load(page, "examples/inputs/pong.inputs", 0.5);
    },
  ],
  phone: ["examples/hills.hyped", "light", PHONE, (page) => load(page, "examples/inputs/hills.inputs", 0.4)],
};

mkdirSync(FOLDER, { recursive: true });
const chromium = await browser();
const wanted = process.argv.slice(2);
for (const [name, [args, colorScheme, viewport, steps]] of Object.entries(PICTURES)) {
  if (wanted.length > 0 && !wanted.includes(name)) continue;
  const words = args.split(" ");
  const server = words[0] === "reach" ? report(words) : await play(...words);
  const isPhone = viewport === PHONE;
  const options = { viewport, colorScheme, hasTouch: isPhone, isMobile: isPhone, deviceScaleFactor: isPhone ? 2 : 1 };
  const { page, context } = await open(chromium, server.url, options);
  await steps(page);
  await page.waitForTimeout(400);
  const path = `${FOLDER}/${name}.png`;
  await page.screenshot({ path });
  execFileSync("pngquant", ["--force", "--output", path, "--speed", "1", "128", path]);
  console.log(name);
  await context.close();
  await server.stop();
}
await chromium.close();
