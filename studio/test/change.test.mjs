// Changes while a world is played: the state that goes on, levels that are painted; and other ways to play: a gamepad,
// fingers.
import assert from "node:assert/strict";
import { cp, mkdtemp, readFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";

import { browser, game, play, playing, root, stopped, until } from "./browser.mjs";

let chromium;
before(async () => {
  chromium = await browser();
});
after(() => chromium.close());

/** Replaces a part of the text in the editor. */
const edited = (page, from, to) =>
  page.evaluate(
    ([old, put]) => {
      const view = globalThis.studio.text.editor;
      const at = view.state.doc.toString().indexOf(old);
      if (at < 0) throw new Error(`the text has no ${old}`);
      view.dispatch({ changes: { from: at, to: at + old.length, insert: put } });
    },
    [from, to],
  );

test("the state goes on after a change, and the choice is remembered", async (t) => {
  const { page, url, errors } = await playing(chromium, t, ["examples/mario.hyped"]);
  await page.getByRole("radio", { name: /go on from this state/ }).check();
  await page.getByRole("tab", { name: "Edit" }).click();
  await until(page, "globalThis.studio.text.editor.state.doc.length > 500");
  await page.locator(".stage canvas").focus();
  await page.keyboard.down("ArrowRight");
  await until(page, "globalThis.studio.game.length > 40");
  await page.keyboard.up("ArrowRight");
  await page.keyboard.press("KeyP");
  await stopped(page);
  const bodies = await game(page, "frame.bodies");
  await edited(page, "run_speed = 100", "run_speed = 160");
  await until(page, "globalThis.studio.game.isCarried");
  assert.deepEqual(await game(page, "frame.bodies"), bodies, "everything is where it was");
  assert.equal(await game(page, "length"), 0);
  // What has no name any more is said.
  await page.evaluate(() => {
    const view = globalThis.studio.text.editor;
    const text = view.state.doc.toString();
    view.dispatch({ changes: { from: 0, to: text.length, insert: text.replaceAll(/\bcoins\b/g, "money") } });
  });
  await page.locator(".toasts").getByText(/exists no longer: .*\.coins/).waitFor();
  // Back at the start, the inputs are recorded again.
  await page.evaluate("globalThis.studio.game.restart()");
  await until(page, "!globalThis.studio.game.isCarried");
  assert.equal(await page.evaluate("globalThis.studio.game.script()"), "");
  await page.goto("about:blank");
  await page.goto(url);
  await until(page, "globalThis.studio?.game.frame");
  await page.getByRole("tab", { name: "Play", exact: true }).click();
  assert.ok(await page.getByRole("radio", { name: /go on from this state/ }).isChecked(), "it is remembered");
  assert.deepEqual(errors, []);
});

test("an edge that stays is clicked in the chart", async (t) => {
  const { page } = await playing(chromium, t, ["examples/mario.hyped"]);
  await page.getByRole("tab", { name: "Know" }).click();
  await page.locator(".chart svg").waitFor();
  await page.evaluate("globalThis.studio.game.stepBy(1)");
  await page.locator(".edge").first().waitFor();
  const edge = page.locator(".chart svg text[data-edge]").first();
  await edge.click();
  await page.getByRole("button", { name: "Show all edges" }).waitFor();
  const shown = await page.locator(".edge strong").allTextContents();
  assert.ok(shown.length === 0 || shown.every((text) => text.endsWith("stays")), shown.join());
});

test("a level of the command line is painted into its file", async (t) => {
  const folder = await mkdtemp(join(tmpdir(), "studio-"));
  await cp(join(root, "examples/smb"), folder, { recursive: true });
  const level = join(folder, "mario-1-1.txt");
  const before = await readFile(level, "utf8");
  const { page } = await playing(chromium, t, [join(folder, "smb.hyped"), "--map", level]);
  await page.getByRole("tab", { name: "Edit" }).click();
  const map = await page.evaluate(() => {
    const { columns, cells, kinds, rows, tile } = globalThis.studio.game.scene.spaces[0].map;
    return { columns, cells, kinds, rows, tile };
  });
  // The fourth column of the third row is air.
  const cell = 2 * map.columns + 3;
  const solid = map.kinds.find((kind) => kind.role === "solid");
  const isSolid = `globalThis.studio.game.scene.spaces[0].map.cells[${cell}] === ${map.kinds.indexOf(solid)}`;
  assert.equal(await page.evaluate(isSolid), false);
  await page.locator(`.paint input[value="${solid.symbol}"]`).check();
  const spot = await page.evaluate(
    ([x, y]) => {
      const { camera, ratio } = globalThis.studio.stage;
      return { x: camera.toX(x) / ratio, y: camera.toY(y) / ratio };
    },
    [3.5 * map.tile[0], (map.rows - 2.5) * map.tile[1]],
  );
  await page.locator(".stage canvas").click({ position: spot });
  await until(page, isSolid);
  await page.getByLabel("File", { exact: true }).selectOption(level).catch(() => undefined);
  await page.getByRole("button", { name: "Save" }).click();
  await until(page, "document.querySelector('.toasts')?.textContent.includes('saved')");
  const rows = before.split("\n");
  rows[2] = rows[2].slice(0, 3) + solid.symbol + rows[2].slice(4);
  assert.equal(await readFile(level, "utf8"), rows.join("\n"), "one character has changed");
});

/** Puts gamepads into a page before it is loaded. */
const withGamepads = (context) =>
  context.addInitScript(() => {
    const pad = (index) => ({
      index,
      id: `pad ${index}`,
      connected: true,
      mapping: "standard",
      axes: [0, 0, 0, 0],
      buttons: Array.from({ length: 17 }, () => ({ pressed: false, touched: false, value: 0 })),
    });
    globalThis.pads = [null, pad(1), pad(2)];
    navigator.getGamepads = () => globalThis.pads;
  });

/** The page of a program, opened with gamepads. */
async function withPads(t, program) {
  const server = await play(program);
  t.after(() => server.stop());
  const context = await chromium.newContext();
  t.after(() => context.close());
  await withGamepads(context);
  const page = await context.newPage();
  await page.goto(server.url);
  await until(page, "globalThis.studio?.game.frame");
  return page;
}

test("gamepads play: sticks, crosses and buttons, each for a player", async (t) => {
  const page = await withPads(t, "examples/mario.hyped");
  const held = () => page.evaluate("globalThis.studio.game.sample()");
  const set = (changes) =>
    page.evaluate((changes) => {
      const [, pad] = globalThis.pads;
      pad.axes = changes.axes ?? [0, 0, 0, 0];
      pad.buttons = pad.buttons.map((_, at) => ({ pressed: (changes.buttons ?? []).includes(at) }));
    }, changes);
  const { buttons, axes } = (await game(page, "scene.players"))[0];
  const [x, jump] = [axes.indexOf("horizontal"), buttons.indexOf("jump")];
  assert.ok(x >= 0 && jump >= 0, `${axes} ${buttons}`);
  // Something held on a gamepad starts the game.
  await set({ axes: [0.75, 0, 0, 0] });
  await until(page, "globalThis.studio.game.mode === 'live' && globalThis.studio.game.length > 5");
  assert.equal((await held())[0].axes[x], 0.75, "a stick is as far as it is");
  assert.match(await page.evaluate("globalThis.studio.game.script()"), /horizontal=0\.75/);
  await set({ axes: [0.1, 0.1, 0, 0] });
  assert.equal((await held())[0].axes[x], 0, "a stick at rest is never quite in the middle");
  await set({ buttons: [14] });
  assert.equal((await held())[0].axes[x], -1, "the cross is the left end");
  const pressed = [];
  for (let button = 0; button < buttons.length; button += 1) {
    await set({ buttons: [button] });
    pressed.push((await held())[0].buttons);
  }
  assert.deepEqual(pressed.flat().sort(), buttons.map((_, at) => at), "each button of the game has one of the gamepad");
  // A gamepad that is unplugged holds nothing.
  await page.evaluate("globalThis.pads[1].connected = false");
  assert.deepEqual((await held())[0].buttons, []);
});

test("a second gamepad is the second player's", async (t) => {
  const page = await withPads(t, "examples/pong.hyped");
  const players = await game(page, "scene.players");
  assert.equal(players.length, 2);
  await page.evaluate("globalThis.pads[2].buttons[12].pressed = true");
  const [first, second] = await page.evaluate("globalThis.studio.game.sample()");
  const holds = (of) => of.buttons.length > 0 || of.axes.some((value) => value !== 0);
  assert.ok(!holds(first) && holds(second), JSON.stringify([first, second]));
});

test("two fingers steer and jump at phone width", async (t) => {
  const viewport = { width: 390, height: 780 };
  const { page, context, errors } = await playing(chromium, t, ["examples/mario.hyped"], { viewport, hasTouch: true, isMobile: true });
  const fingers = await context.newCDPSession(page);
  const touch = (type, points) =>
    fingers.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([id, x, y]) => ({ id, x, y })) });
  const stick = await page.locator(".stick").boundingBox();
  const jump = await page.locator(".pad", { hasText: "jump" }).boundingBox();
  const right = [0, stick.x + stick.width - 4, stick.y + stick.height / 2];
  const press = [1, jump.x + jump.width / 2, jump.y + jump.height / 2];
  await touch("touchStart", [right]);
  await until(page, "globalThis.studio.game.length > 10");
  await touch("touchStart", [right, press]);
  await until(page, "globalThis.studio.game.sample()[0].buttons.length > 0");
  const held = await page.evaluate("globalThis.studio.game.sample()[0]");
  assert.ok(held.axes[0] > 0.9 && held.buttons.length === 1, JSON.stringify(held));
  const length = await game(page, "length");
  await until(page, `globalThis.studio.game.length > ${length + 5}`);
  await touch("touchEnd", []);
  await until(page, "globalThis.studio.game.sample()[0].buttons.length === 0");
  assert.equal((await page.evaluate("globalThis.studio.game.sample()[0]")).axes[0], 0, "nothing is held");
  await touch("touchStart", [[0, stick.x + 4, stick.y + stick.height / 2]]);
  await until(page, "globalThis.studio.game.sample()[0].axes[0] < -0.9");
  await touch("touchEnd", []);
  await until(page, "globalThis.studio.game.sample()[0].axes[0] === 0");
  assert.match(await page.evaluate("globalThis.studio.game.script()"), /jump/);
  assert.deepEqual(errors, []);
});
