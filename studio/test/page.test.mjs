// The page in a real browser: every example, the same steps as `hypedc sim`, time, changes, questions, keyboard, security.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtemp, readdir, readFile, writeFile } from "node:fs/promises";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";

import { PATIENCE, browser, freshPage, game, hypedc, open, play, playing, root, stopped, until } from "./browser.mjs";

const axe = createRequire(import.meta.url).resolve("axe-core/axe.min.js");
let chromium;
before(async () => {
  chromium = await browser();
});
after(() => chromium.close());

/** A copy of an example that a test may change. */
async function copied(example) {
  const folder = await mkdtemp(join(tmpdir(), "studio-"));
  const path = join(folder, example.split("/").pop());
  await writeFile(path, await readFile(join(root, example), "utf8"));
  return path;
}

/** Arguments for each example with a world; an open world gets the first level beside it. */
async function examples() {
  const all = [];
  for (const name of await readdir(join(root, "examples"), { recursive: true })) {
    if (!name.endsWith(".hyped")) continue;
    const path = `examples/${name}`;
    const text = await readFile(join(root, path), "utf8");
    if (!/^world /m.test(text)) continue;
    const level = /map level/.test(text);
    const folder = path.slice(0, path.lastIndexOf("/"));
    const beside = level ? (await readdir(join(root, folder))).filter((file) => file.endsWith(".txt")).sort() : [];
    all.push(level ? [path, "--map", `${folder}/${beside[0]}`] : [path]);
  }
  return all;
}

test("every example loads, moves and says nothing on the console", async (t) => {
  const all = await examples();
  assert.ok(all.length > 25, `${all.length} examples`);
  for (const args of all) {
    const server = await play(...args);
    t.after(() => server.stop());
    const { page, context, errors } = await open(chromium, server.url);
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("KeyP");
    await page.evaluate(async () => {
      for (let step = 0; step < 5; step++) await globalThis.studio.game.stepBy(1);
    });
    const drawn = await page.evaluate(() => {
      const { canvas } = globalThis.studio.stage;
      const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
      const colors = new Set();
      for (let at = 0; at < pixels.length; at += 4 * 97) colors.add(pixels[at] * 65536 + pixels[at + 1] * 256 + pixels[at + 2]);
      return colors.size;
    });
    assert.ok(drawn > 3, `${args[0]}: ${drawn} colours`);
    assert.ok((await game(page, "length")) > 0, `${args[0]} does not move`);
    assert.deepEqual(errors, [], args[0]);
    await context.close();
    await server.stop();
  }
  t.diagnostic(`${all.length} examples`);
});

test("keys give the steps of `hypedc sim`, to the bit", async (t) => {
  const server = await play("examples/car.hyped");
  t.after(() => server.stop());
  const context = await chromium.newContext();
  t.after(() => context.close());
  const page = await context.newPage();
  const frames = new Map();
  let scene;
  page.on("websocket", (socket) =>
    socket.on("framereceived", ({ payload }) => {
      const answer = JSON.parse(payload);
      scene = answer.scene ?? scene;
      for (const frame of [answer.frame, answer.before]) if (frame) frames.set(frame.at, frame);
    }),
  );
  await freshPage(page);
  await page.goto(server.url);
  await until(page, "globalThis.studio?.game.frame");
  await page.evaluate("globalThis.studio.game.speed = 2");
  const keys = ["ArrowUp", "ArrowLeft", "ArrowRight", "ArrowDown", "Space", "KeyZ"];
  let seed = 7;
  const random = (below) => (seed = (seed * 48271) % 2147483647) % below;
  while ((await game(page, "length")) < 2000) {
    const key = keys[random(keys.length)];
    await page.keyboard.down(key);
    await page.waitForTimeout(20 + random(250));
    if (random(3) > 0) await page.keyboard.up(key);
    // A run that is over begins again from the middle.
    if (await game(page, "ended")) await page.evaluate(async () => {
      const { game } = globalThis.studio;
      await game.seek(game.length / 2);
      await game.takeOver();
    });
  }
  await page.keyboard.press("KeyP");
  await stopped(page);
  const script = await page.evaluate("globalThis.studio.game.script()");
  const length = await game(page, "length");
  const folder = await mkdtemp(join(tmpdir(), "studio-"));
  await writeFile(join(folder, "run.inputs"), script);
  const trace = join(folder, "run.jsonl");
  execFileSync(hypedc, ["sim", "examples/car.hyped", "--inputs-file", join(folder, "run.inputs"), "--trace", trace], { cwd: root });
  const [, ...lines] = (await readFile(trace, "utf8")).trim().split("\n");
  assert.equal(lines.length, length + 1);
  const live = frames.size;
  assert.ok(live > 500, `${live} frames came while it was played`);
  // The display has left frames out: they are shown now.
  const missing = lines.map((_, step) => step).filter((step) => !frames.has(step));
  await page.evaluate(async (missing) => {
    for (const step of missing) await globalThis.studio.game.seek(step);
  }, missing);
  let compared = 0;
  for (const line of lines) {
    const { step, instances } = JSON.parse(line);
    const { bodies } = frames.get(step);
    for (let at = 0; at < bodies.length; at += 5 + 5 * bodies[at + 4]) {
      const of = instances[scene.slots[bodies[at]].name];
      assert.equal(of.x[0], bodies[at + 2], `step ${step}`);
      assert.equal(of.y[0], bodies[at + 3], `step ${step}`);
      compared++;
    }
  }
  assert.ok(compared >= 2000, `${compared} positions compared`);
  // All that a state is made of, frame by frame.
  const { text } = await page.evaluate((count) => globalThis.studio.game.carrier.ask({ ask: "trace", from: 0, count }), length + 1);
  assert.deepEqual(text.trim().split("\n"), lines);
  t.diagnostic(`${length} steps, ${live} frames while it was played, ${compared} positions`);
});

test("one scrubs back, takes over, and takes that back", async (t) => {
  const { page } = await playing(chromium, t, ["examples/mario.hyped"]);
  await page.keyboard.down("ArrowRight");
  await until(page, "globalThis.studio.game.length > 60");
  await page.keyboard.up("ArrowRight");
  await page.keyboard.press("KeyP");
  await stopped(page);
  const length = await game(page, "length");
  const slider = page.getByLabel("Frame", { exact: true });
  await slider.fill("20");
  await until(page, "globalThis.studio.game.frame.at === 20");
  assert.equal(await game(page, "length"), length, "the history stays");
  await page.keyboard.press("Comma");
  await until(page, "globalThis.studio.game.frame.at === 19");
  await page.locator(".stage canvas").focus();
  await page.keyboard.press("ArrowLeft");
  await until(page, "globalThis.studio.game.mode === 'live' && globalThis.studio.game.length < 40");
  await page.getByRole("button", { name: "Undo" }).first().click();
  await until(page, `globalThis.studio.game.length === ${length}`);
  // A loop shows the same part again and again.
  await page.evaluate(() => {
    globalThis.studio.game.loop = [5, 15];
    globalThis.studio.game.resume();
  });
  await page.waitForTimeout(700);
  const at = await game(page, "frame.at");
  assert.ok(at >= 5 && at <= 15, `frame ${at}`);
  assert.equal(await game(page, "length"), length);
});

test("a saved file is played within 200 ms", async (t) => {
  const path = await copied("examples/mario.hyped");
  const { page, errors } = await playing(chromium, t, [path]);
  await page.keyboard.down("ArrowRight");
  await until(page, "globalThis.studio.game.length > 60");
  await page.keyboard.up("ArrowRight");
  await page.keyboard.press("KeyP");
  const text = await readFile(path, "utf8");
  await page.evaluate(() => {
    globalThis.opened = [];
    globalThis.studio.game.onOpened.on((opened) => globalThis.opened.push({ at: Date.now(), current: opened.is_current }));
  });
  const times = [];
  for (const speed of [150, 60, 90]) {
    await page.waitForTimeout(300);
    const count = await page.evaluate("globalThis.opened.length");
    const saved = Date.now();
    await writeFile(path, text.replace("run_speed = 100", `run_speed = ${speed}`));
    await until(page, `globalThis.opened.length > ${count}`);
    times.push((await page.evaluate("globalThis.opened.at(-1).at")) - saved);
  }
  t.diagnostic(`${times.join(", ")} ms`);
  assert.ok(Math.min(...times) < 200 * PATIENCE, `${times} ms`);
  assert.ok((await page.evaluate("globalThis.studio.game.ghost[0].length")) > 60, "the run before is a ghost");
  // With a mistake, the last good version goes on, and its place leads into the text.
  await writeFile(path, text.replace("y'' = gravity", "y'' = gravitty"));
  const problem = page.locator(".problems");
  await problem.getByText("gravitty").first().waitFor();
  await problem.getByRole("button").first().click();
  // The text is opened before it has the focus.
  await page.locator(".cm-editor.cm-focused").waitFor();
  await page.keyboard.press("Escape");
  await page.keyboard.press("KeyP");
  const before = await game(page, "length");
  await until(page, `globalThis.studio.game.length > ${before}`);
  await writeFile(path, text);
  await problem.waitFor({ state: "hidden" });
  assert.deepEqual(errors, []);
});

test("a slider changes the run, and only its literal is written", async (t) => {
  const path = await copied("examples/mario.hyped");
  const { page } = await playing(chromium, t, [path]);
  await page.getByRole("tab", { name: "Tune" }).click();
  const slider = page.getByLabel("Mario.jump_speed", { exact: true });
  await slider.waitFor();
  await page.locator(".stage canvas").focus();
  await page.keyboard.down("ArrowRight");
  await until(page, "globalThis.studio.game.length > 30");
  await page.keyboard.up("ArrowRight");
  await page.keyboard.press("KeyP");
  await page.getByLabel("Mario.run_speed, exact").fill("140");
  await page.getByLabel("Mario.run_speed, exact").press("Enter");
  const x = "globalThis.studio.game.ghost[0]?.at(-1)[1]";
  await until(page, x);
  const moved = await page.evaluate(`[${x}, ...studio.game.frame.bodies.slice(studio.game.now.start(studio.game.scene.players[0].slot) + 2, studio.game.now.start(studio.game.scene.players[0].slot) + 3)]`);
  assert.ok(moved[1] > moved[0] + 1, `${moved}: faster than before`);
  await page.getByLabel("Mario.jump_speed, exact").fill("260");
  await page.getByLabel("Mario.jump_speed, exact").press("Enter");
  const row = page.locator(".slider", { has: page.getByLabel("Mario.jump_speed", { exact: true }) });
  await row.getByRole("button", { name: "Write" }).click();
  const text = await readFile(join(root, "examples/mario.hyped"), "utf8");
  await until(page, "document.querySelector('.toasts')?.textContent.includes('saved')");
  assert.equal(await readFile(path, "utf8"), text.replace("jump_speed = 200", "jump_speed = 260"));
});

test("tiles are painted into the text", async (t) => {
  const path = await copied("examples/balloon.hyped");
  const { page } = await playing(chromium, t, [path]);
  await page.getByRole("tab", { name: "Edit" }).click();
  await page.getByRole("radio", { name: "# rock" }).check();
  const cell = await page.evaluate(() => {
    const { camera, ratio } = globalThis.studio.stage;
    return { x: camera.toX(16) / ratio, y: camera.toY(16 + 4 * 32) / ratio };
  });
  await page.locator(".stage canvas").click({ position: cell });
  await until(page, "globalThis.studio.game.scene.spaces[0].map.cells[0] >= 0");
  await page.getByRole("button", { name: "Save" }).click();
  await until(page, "document.querySelector('.toasts')?.textContent.includes('saved')");
  const text = await readFile(join(root, "examples/balloon.hyped"), "utf8");
  assert.equal(await readFile(path, "utf8"), text.replace('"\n            ..', '"\n            #.'));
});

test("what is reached from here is a path that is played", async (t) => {
  const { page, errors } = await playing(chromium, t, ["examples/balloon.hyped"]);
  await page.getByRole("tab", { name: "Ask" }).click();
  await page.getByRole("button", { name: "Reach from here" }).click();
  await page.locator(".verdict").waitFor({ timeout: 60_000 });
  assert.match(await page.locator(".verdict").textContent(), /^reached/);
  await page.getByRole("button", { name: "Play the path" }).click();
  await until(page, "globalThis.studio.game.frame.goals.length === 1", 60_000);
  // A place in the level.
  await page.getByRole("radio", { name: /a place/ }).check();
  const spot = await page.evaluate(() => {
    const { camera, ratio } = globalThis.studio.stage;
    return { x: camera.toX(120) / ratio, y: camera.toY(100) / ratio };
  });
  await page.evaluate("globalThis.studio.game.seek(0)");
  await page.waitForTimeout(600);
  await page.locator(".stage canvas").click({ position: spot });
  await page.getByRole("button", { name: "Play the path" }).waitFor({ timeout: 60_000 });
  assert.deepEqual(errors, []);
});

test("a search draws where it is, and is stopped", async (t) => {
  const { page } = await playing(chromium, t, ["examples/metroidvania.hyped"]);
  await page.getByRole("tab", { name: "Ask" }).click();
  await page.getByRole("radio", { name: "goal relic" }).check();
  await page.getByLabel("Nodes").selectOption("500000");
  await page.getByRole("button", { name: "Reach from here" }).click();
  const nodes = "Number(document.querySelector('#panel-ask [role=status]').textContent.split(' ')[0].replaceAll(',', ''))";
  await until(page, `${nodes} > 1000`, 60_000);
  const drawn = await page.evaluate(nodes);
  await page.getByRole("button", { name: "Stop" }).click();
  await page.locator(".verdict").waitFor({ timeout: 10_000 });
  assert.match(await page.locator("#panel-ask .result").textContent(), /stopped/);
  assert.ok((await page.evaluate(nodes)) < 500_000, `stopped after ${drawn} nodes`);
});

test("what is known of an instance is what is there", async (t) => {
  const { page } = await playing(chromium, t, ["examples/balloon.hyped"]);
  await page.getByRole("tab", { name: "Know" }).click();
  await page.locator(".chart svg").waitFor();
  await until(page, "document.querySelector('.chips')?.textContent.includes('sinking')");
  await page.locator(".stage canvas").focus();
  await page.keyboard.down("ArrowUp");
  await page.keyboard.down("Space");
  await until(page, "document.querySelector('.chips')?.textContent.includes('rising')");
  await page.keyboard.press("KeyP");
  await until(page, "document.querySelectorAll('.chart .active').length > 0");
  await page.getByRole("button", { name: "Show what each value can be" }).click();
  await page.locator("td.can-be").first().waitFor({ timeout: 30_000 });
  const atoms = await page.locator(".atom").allTextContents();
  assert.ok(atoms.some((text) => text.includes("held(heat)")), atoms.join());
  // A click on an edge of the chart says why it was not taken: here, its mode was not active.
  await page.locator(".chart circle[data-edge]").nth(1).click();
  await page.getByText("Its mode was not active before this step").waitFor();
  await page.getByRole("button", { name: "Show all edges" }).click();
  await page.locator(".edge").first().waitFor();
});

test("fingers play on a phone", async (t) => {
  const viewport = { width: 390, height: 780 };
  const { page } = await playing(chromium, t, ["examples/mario.hyped"], { viewport, hasTouch: true, isMobile: true });
  const stick = await page.locator(".stick").boundingBox();
  const pad = await page.locator(".pad", { hasText: "jump" }).boundingBox();
  assert.ok(stick && pad && pad.y + pad.height < viewport.height, "the controls are in view");
  await page.evaluate(
    ([stick, pad]) => {
      const touch = (selector, type, x, y) => {
        const of = document.querySelector(selector);
        of.setPointerCapture = () => undefined;
        of.hasPointerCapture = () => true;
        of.dispatchEvent(new PointerEvent(type, { pointerId: 5, clientX: x, clientY: y, bubbles: true }));
      };
      touch(".stick", "pointerdown", stick.x + stick.width - 4, stick.y + stick.height / 2);
      touch(".pad", "pointerdown", pad.x + 10, pad.y + 10);
    },
    [stick, pad],
  );
  await until(page, "globalThis.studio.game.length > 30");
  const script = await page.evaluate("globalThis.studio.game.script()");
  assert.match(script, /jump|fire/);
  const wide = await page.evaluate("document.documentElement.scrollWidth");
  assert.equal(wide, viewport.width, "nothing is wider than the phone");
});

test("another origin gets nothing", async (t) => {
  const server = await play("examples/balloon.hyped");
  t.after(() => server.stop());
  const other = createServer((_, response) => response.writeHead(200, { "content-type": "text/html" }).end("<title>other</title>"));
  await new Promise((done) => other.listen(0, "127.0.0.1", done));
  t.after(() => other.close());
  const context = await chromium.newContext();
  t.after(() => context.close());
  const page = await context.newPage();
  await page.goto(`http://127.0.0.1:${other.address().port}/`);
  const tried = await page.evaluate(async (url) => {
    const socket = new Promise((done) => {
      const of = new WebSocket(url.replace("http", "ws").replace("/?", "/session?"));
      of.onopen = () => done("open");
      of.onerror = () => done("refused");
    });
    const text = await fetch(url).then((answer) => answer.text(), () => "refused");
    const frame = document.createElement("iframe");
    frame.src = url;
    document.body.append(frame);
    await new Promise((done) => (frame.onload = done));
    let inside = "hidden";
    try {
      inside = frame.contentDocument?.title ?? "hidden";
    } catch {
      // As it should be.
    }
    return { socket: await socket, text, inside };
  }, server.url);
  assert.deepEqual(tried, { socket: "refused", text: "refused", inside: "hidden" });
  const guess = await fetch(server.url.replace(/token=.*/, "token=00")).then((answer) => answer.status);
  assert.equal(guess, 403);
});

test("everything is reached by the keyboard", async (t) => {
  const { page } = await playing(chromium, t, ["examples/balloon.hyped"]);
  const focus = () => page.evaluate(() => {
    const of = document.activeElement;
    return of?.getAttribute("aria-label") ?? of?.textContent?.trim() ?? "";
  });
  const to = async (name) => {
    for (let tabs = 0; tabs < 60; tabs++) {
      if ((await focus()) === name) return;
      await page.keyboard.press("Tab");
    }
    assert.fail(`${name} is not reached`);
  };
  await to("Play");
  await page.keyboard.press("ArrowRight");
  assert.equal(await focus(), "Know");
  await page.keyboard.press("End");
  await page.keyboard.press("ArrowLeft");
  assert.equal(await focus(), "Ask");
  await to("Reach from here");
  await page.keyboard.press("Enter");
  await page.locator(".verdict").waitFor({ timeout: 60_000 });
  await to("Play the path");
  await page.keyboard.press("Enter");
  await until(page, "globalThis.studio.game.mode === 'replay'");
  await to("Pause");
  await page.keyboard.press("Space");
  await stopped(page);
  await to("Frame");
  const at = await game(page, "frame.at");
  await page.keyboard.press("ArrowLeft");
  await until(page, `globalThis.studio.game.frame.at === ${at - 1}`);
});

for (const colorScheme of ["light", "dark"]) {
  test(`axe finds nothing, ${colorScheme}`, async (t) => {
    // The page's policy allows no script from elsewhere: axe comes in by the test.
    const { page } = await playing(chromium, t, ["examples/mario.hyped"], { colorScheme, bypassCSP: true });
    await page.addScriptTag({ path: axe });
    for (const tab of ["Play", "Know", "Tune", "Ask", "Edit"]) {
      await page.getByRole("tab", { name: tab, exact: true }).click();
      await page.waitForTimeout(400);
      const { violations } = await page.evaluate("axe.run(document)");
      const found = violations.map((of) => `${of.id}: ${of.nodes.map((node) => node.html).slice(0, 3).join(" ")}`);
      assert.deepEqual(found, [], `${tab}, ${colorScheme}`);
    }
  });
}
