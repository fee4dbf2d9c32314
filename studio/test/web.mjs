// The engine in a real browser: exported games from a file with the network off, and the playground. HYPEDC names the
// binary, HYPEDC_ENGINE the packed engine.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { mkdtemp, readFile, stat, writeFile } from "node:fs/promises";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";

import { games, inputs } from "../../bindings/web/test/games.mjs";
import { PATIENCE, browser, game, hypedc, open, root, stopped, until } from "./browser.mjs";
import { GRASS, HERO, meadow, untilColor } from "./meadow.mjs";

const engine = process.env.HYPEDC_ENGINE ?? join(root, "bindings/web/dist/hypedc.wasm.gz");
const axe = createRequire(import.meta.url).resolve("axe-core/axe.min.js");
const all = games();
let chromium;
let folder;
before(async () => {
  chromium = await browser();
  folder = await mkdtemp(join(tmpdir(), "hypedc-web-"));
});
after(() => chromium.close());

/** Runs the binary; says what it says if it fails. */
function run(args, codes = [0]) {
  const { status, stderr } = spawnSync(hypedc, args, { cwd: root, encoding: "utf8" });
  assert.ok(codes.includes(status), `${status}: ${args.join(" ")}: ${stderr}`);
}

/** Exports a game as one file; returns its address. */
async function exported({ name, project }) {
  const path = join(folder, `${name.replaceAll(/[^\w]+/g, "-")}.html`);
  const level = project.map ? ["--map", project.map] : [];
  run(["play", project.root, ...level, "--export", path, "--engine", engine]);
  return pathToFileURL(path).href;
}

/** Opens an exported game without a network. */
async function playing(t, name, options = {}) {
  const opened = await open(chromium, await exported(all.find((game) => game.name === name)), { offline: true, ...options });
  t?.after(() => opened.context.close());
  return opened;
}

/** Keeps all frames that the page gets. */
const recording = (page) =>
  page.evaluate(() => {
    globalThis.frames = new Map();
    const { carrier } = globalThis.studio.game;
    const ask = carrier.ask.bind(carrier);
    carrier.ask = async (request) => {
      const answer = await ask(request);
      for (const frame of [answer.frame, answer.before]) if (frame?.bodies) globalThis.frames.set(frame.at, frame);
      return answer;
    };
  });

/** Asks for the frames that the page was not shown: it steps several times at once if the machine is slow. */
const complete = (page) =>
  page.evaluate(async () => {
    const { carrier, length } = globalThis.studio.game;
    for (let frame = 0; frame <= length; frame += 1) {
      if (!globalThis.frames.has(frame)) await carrier.ask({ ask: "seek", frame });
    }
  });

/** Compares the frames of a page with the trace of `hypedc sim` for its inputs. Returns the number of equal positions. */
async function compared(page, { project }) {
  const script = await page.evaluate("globalThis.studio.game.script()");
  const frames = new Map(await page.evaluate("[...globalThis.frames]"));
  const scene = await game(page, "scene");
  const [file, trace] = [join(folder, "run.inputs"), join(folder, "run.jsonl")];
  await writeFile(file, script);
  const level = project.map ? ["--map", project.map] : [];
  const world = ["--world", scene.world];
  // What is played draws by seed 0.
  const chance = /^\s*chance /m.test(project.files[project.root]) ? ["--chance", "seed=0"] : [];
  // Random play may violate a `never`: that is exit code 1.
  run(["sim", project.root, ...level, ...world, ...chance, "--inputs-file", file, "--trace", trace], [0, 1]);
  const [, ...lines] = (await readFile(trace, "utf8")).trim().split("\n");
  // All that a state is made of, frame by frame.
  const { text } = await page.evaluate((count) => globalThis.studio.game.carrier.ask({ ask: "trace", from: 0, count }), lines.length);
  assert.deepEqual(text.trim().split("\n"), lines, project.root);
  let equal = 0;
  for (const line of lines) {
    const { step, instances } = JSON.parse(line);
    const bodies = frames.get(step)?.bodies ?? [];
    for (let at = 0; at < bodies.length; at += 5 + 5 * bodies[at + 4]) {
      const of = instances[scene.slots[bodies[at]].name];
      assert.deepEqual([of.x[0], of.y[0]], [bodies[at + 2], bodies[at + 3]], `${project.root}, step ${step}`);
      equal += 1;
    }
  }
  return { equal, steps: lines.length - 1 };
}

test("every example plays from one file without a network, with the steps of `hypedc sim`", async (t) => {
  assert.ok(all.length > 25, `${all.length} games`);
  let positions = 0;
  for (const one of all) {
    const { page, context, errors } = await open(chromium, await exported(one), { offline: true });
    await recording(page);
    // Held for some steps each, 2,000 in all; where a run ends, it begins again.
    await page.evaluate(async () => {
      const { game } = globalThis.studio;
      let seed = 11;
      const random = (below) => (seed = (seed * 48271) % 2147483647) % below;
      for (let steps = 0; steps < 2000; ) {
        const held = game.scene.players.map(({ buttons, axes }) => ({
          buttons: buttons.flatMap((_, at) => (random(3) === 0 ? [at] : [])),
          axes: axes.map(() => random(3) - 1),
        }));
        const count = 1 + random(24);
        for (let step = 0; step < count; step += 1, steps += 1) {
          const answer = await game.carrier.ask({ ask: "play", inputs: [held] });
          if (answer.answer !== "shown") throw new Error(JSON.stringify(answer));
          if (answer.ended === null) continue;
          await game.carrier.ask({ ask: "seek", frame: Math.floor(answer.length / 2) });
          break;
        }
      }
    });
    const { equal, steps } = await compared(page, one);
    assert.ok(equal > 0 && steps > 0, `${one.name}: ${equal} positions in ${steps} steps`);
    positions += equal;
    assert.deepEqual(errors, [], one.name);
    await context.close();
  }
  t.diagnostic(`${all.length} games, ${positions} positions`);
});

test("keys give the steps of `hypedc sim`, to the bit", async (t) => {
  const { page, errors } = await playing(t, "car");
  await recording(page);
  await page.evaluate("globalThis.studio.game.speed = 2");
  const keys = ["ArrowUp", "ArrowLeft", "ArrowRight", "ArrowDown", "Space"];
  let seed = 7;
  const random = (below) => (seed = (seed * 48271) % 2147483647) % below;
  while ((await game(page, "length")) < 2000) {
    const key = keys[random(keys.length)];
    await page.keyboard.down(key);
    await page.waitForTimeout(20 + random(250));
    if (random(3) > 0) await page.keyboard.up(key);
    if (await game(page, "ended")) {
      await page.evaluate(async () => {
        const { game } = globalThis.studio;
        await game.seek(game.length / 2);
        await game.takeOver();
      });
    }
  }
  await page.keyboard.press("KeyP");
  await stopped(page);
  const shown = await page.evaluate("globalThis.frames.size");
  await complete(page);
  const { equal, steps } = await compared(page, all.find(({ name }) => name === "car"));
  assert.ok(shown >= 500, `${shown} frames were shown`);
  assert.ok(equal >= 2000 && steps >= 2000, `${equal} positions in ${steps} steps`);
  assert.deepEqual(errors, []);
});

/** Opens the report of a command without a network. */
async function reported(t, args, options = {}) {
  const path = join(folder, `report-${args.join("-").replaceAll(/[^\w]+/g, "-")}.html`);
  run([...args, "--html", path, "--engine", engine], [0, 1]);
  const opened = await open(chromium, pathToFileURL(path).href, { offline: true, ...options });
  t.after(() => opened.context.close());
  return opened;
}

test("the report of a search: verdicts, their ways, where the search was", async (t) => {
  const { page, errors } = await reported(t, ["reach", "examples/platforms.hyped"]);
  assert.equal(await page.getByRole("tab", { name: "Report" }).getAttribute("aria-selected"), "true");
  const answers = page.locator(".ways button");
  await answers.first().waitFor();
  const count = await answers.count();
  assert.ok(count >= 3, `${count} answers`);
  for (let at = 0; at < count; at += 1) {
    await answers.nth(at).click();
    await until(page, "globalThis.studio.game.length > 0 && globalThis.studio.game.frame.at === 0");
    const [kind, name] = (await answers.nth(at).locator(".what").textContent()).split(" ");
    // The last frame is that of the claim.
    await page.locator(".moment").last().click();
    await until(page, "globalThis.studio.game.frame.at === globalThis.studio.game.length");
    const scene = await game(page, "scene");
    const frame = await game(page, "frame");
    const [names, held] = kind === "never" ? [scene.nevers, frame.nevers] : [scene.goals, frame.goals];
    assert.ok(held.map((of) => names[of]).includes(name), `${kind} ${name}`);
  }
  await answers.first().click();
  await until(page, "globalThis.studio.game.frame.at === 0");
  await page.getByRole("button", { name: "Play the way" }).click();
  await until(page, "globalThis.studio.game.mode === 'replay' && globalThis.studio.game.frame.at > 20");
  await page.getByRole("button", { name: "Whole level" }).click();
  await page.locator("dialog img").waitFor();
  assert.ok((await page.evaluate("document.querySelector('dialog img').naturalWidth")) > 400, "the picture is there");
  await page.getByRole("button", { name: "Close", exact: true }).click();
  // A key takes over.
  await page.locator(".stage canvas").focus();
  await page.keyboard.press("KeyP");
  await page.keyboard.down("ArrowLeft");
  await until(page, "globalThis.studio.game.mode === 'live'");
  await page.keyboard.up("ArrowLeft");
  assert.equal(await page.locator(".toast.bad").count(), 0);
  assert.deepEqual(errors, []);
});

test("the report of a proof, and of a run", async (t) => {
  const proof = ["reach", "tests/verdicts/axis_and_button.hyped", "--goal", "lift", "--without", "car.x > 190"];
  const { page, errors } = await reported(t, proof);
  await page.locator(".verdict.proof").getByText("proven unreachable").waitFor();
  await page.getByText("never holds").waitFor();
  assert.equal(await page.getByRole("button", { name: "Play the way" }).count(), 0);
  assert.deepEqual(errors, []);
  const run = ["sim", "examples/mario.hyped", "--inputs-file", "examples/inputs/mario.inputs"];
  const second = await reported(t, run);
  await until(second.page, "globalThis.studio.game.length > 1000");
  await second.page.getByRole("button", { name: /goal fiery/ }).click();
  await until(second.page, "globalThis.studio.game.frame.goals.includes(globalThis.studio.game.scene.goals.indexOf('fiery'))");
  assert.deepEqual(second.errors, []);
});

for (const colorScheme of ["light", "dark"]) {
  test(`axe finds nothing in a report, ${colorScheme}`, async (t) => {
    const { page } = await reported(t, ["reach", "examples/paper/test2.hyped"], { colorScheme, bypassCSP: true });
    await page.locator(".moment").first().waitFor();
    await page.addScriptTag({ path: axe });
    const { violations } = await page.evaluate("axe.run(document)");
    assert.deepEqual(violations.map((of) => `${of.id}: ${of.nodes.map((node) => node.html).slice(0, 3).join(" ")}`), []);
  });
}

test("an exported game holds its pictures", async (t) => {
  const path = join(folder, "meadow.html");
  run(["play", await meadow(), "--export", path, "--engine", engine]);
  const { page, context, errors } = await open(chromium, pathToFileURL(path).href, { offline: true });
  t.after(() => context.close());
  await untilColor(page, 40, 24, HERO);
  await untilColor(page, 100, 8, GRASS);
  assert.deepEqual(errors, []);
});

test("a search runs beside the play", async (t) => {
  const { page, errors } = await playing(t, "paper/test2");
  const asked = (request) => page.evaluate((of) => globalThis.studio.game.carrier.ask(of), request);
  const goal = (await game(page, "scene.goals"))[0];
  await page.evaluate("globalThis.studio.game.resume()");
  const started = await asked({ ask: "search", target: { goal }, nodes: 400_000, seed: 1 });
  assert.equal(started.is_running, true);
  const [length, first] = [await game(page, "length"), await asked({ ask: "poll" })];
  let found = first;
  const points = [...first.points];
  for (let polls = 0; found.is_running && polls < 400; polls += 1) {
    await page.waitForTimeout(25);
    found = await asked({ ask: "poll" });
    points.push(...found.points);
  }
  assert.ok(points.length > 0, "the tree is reported");
  assert.ok((await game(page, "length")) >= length, "the play goes on");
  assert.equal(found.conclusion, "reached", found.verdict);
  const shown = await asked({ ask: "load", script: found.script });
  assert.ok(shown.frame.goals.length > 0, "the path leads to the goal");
  assert.deepEqual(errors, []);
});

test("a search is stopped, and says after how many nodes", async (t) => {
  const { page, errors } = await playing(t, "smb/smb, mario-8-1.txt");
  const asked = (request) => page.evaluate((of) => globalThis.studio.game.carrier.ask(of), request);
  await asked({ ask: "search", target: { goal: "end" }, nodes: 5_000_000, seed: 1 });
  let running = await asked({ ask: "poll" });
  for (let polls = 0; running.nodes === 0 && polls < 600; polls += 1) {
    await page.waitForTimeout(50);
    running = await asked({ ask: "poll" });
  }
  assert.ok(running.is_running && running.nodes > 0, JSON.stringify({ ...running, points: [] }));
  await asked({ ask: "stop" });
  const { is_running: isRunning, verdict } = await asked({ ask: "poll" });
  assert.equal(isRunning, false);
  assert.ok(Number(/after (\d+) nodes/.exec(verdict)?.[1]) >= running.nodes, verdict);
  // Another one starts from there.
  await asked({ ask: "play", inputs: Array.from({ length: 30 }, () => []) });
  assert.equal((await asked({ ask: "search", target: { goal: "end" }, nodes: 100, seed: 1 })).is_running, true);
  assert.deepEqual(errors, []);
});

test("a text is changed while it runs, with the engine's help", async (t) => {
  const { page, errors } = await playing(t, "mario");
  await page.keyboard.down("ArrowRight");
  await until(page, "globalThis.studio.game.length > 40");
  await page.keyboard.up("ArrowRight");
  await page.getByRole("tab", { name: "Edit" }).click();
  await until(page, "globalThis.studio.text.editor.state.doc.length > 500");
  const edited = (from, to) =>
    page.evaluate(
      ([old, put]) => {
        const view = globalThis.studio.text.editor;
        const at = view.state.doc.toString().indexOf(old);
        const changes = { from: at, to: at + old.length, insert: put };
        view.dispatch({ changes, selection: { anchor: at }, scrollIntoView: true });
      },
      [from, to],
    );
  await edited("run_speed = 100", "run_speed = 160");
  await until(page, "globalThis.studio.game.ghost[0]?.length > 40");
  assert.equal(await game(page, "opened.is_current"), true);
  // A mistake is marked at its place; the last good version goes on.
  await edited("y'' = gravity", "y'' = gravitty");
  await page.locator(".cm-lintRange-error").first().waitFor();
  assert.equal(await game(page, "opened.is_current"), false);
  // Findings that come in meanwhile close a tooltip.
  const tooltip = page.locator(".cm-tooltip .finding").getByText(/gravitty/);
  for (let tries = 0; tries < 8 && (await tooltip.count()) === 0; tries += 1) {
    await page.mouse.move(5, 5);
    await page.locator(".cm-lintRange-error").first().hover();
    await page.waitForTimeout(900);
  }
  assert.ok((await tooltip.count()) > 0, "the finding is shown under the mouse");
  await edited("gravitty", "gravity");
  await page.locator(".cm-lintRange-error").first().waitFor({ state: "detached" });
  // Completion: names of this program.
  await page.evaluate(() => {
    const view = globalThis.studio.text.editor;
    const at = view.state.doc.toString().indexOf("run_speed = 160");
    const line = view.state.doc.lineAt(at);
    view.dispatch({ changes: { from: line.to, insert: "\n    x' = run" }, selection: { anchor: line.to + 13 } });
    view.focus();
  });
  await page.keyboard.press("Control+Space");
  await page.locator(".cm-tooltip-autocomplete").getByText("run_speed").first().waitFor();
  await page.keyboard.press("Escape");
  assert.ok((await page.locator(".cm-content [class*='sem-']").count()) > 10, "names have colours of their own");
  assert.deepEqual(errors, []);
});

test("after a trap of the engine the page goes on", async (t) => {
  const { page } = await playing(t, "balloon");
  await page.keyboard.down("Space");
  await until(page, "globalThis.studio.game.length > 30");
  await page.keyboard.up("Space");
  await page.keyboard.press("KeyP");
  await stopped(page);
  const before = await page.evaluate("JSON.stringify(globalThis.studio.game.frame)");
  const trapped = await page.evaluate(() => globalThis.studio.game.carrier.ask({ ask: "trap" }));
  assert.equal(trapped.answer, "refused");
  assert.match(trapped.message, /bug of hypedc.*on request/);
  const after = await page.evaluate(() => globalThis.studio.game.carrier.ask({ ask: "play", inputs: [] }));
  assert.equal(JSON.stringify(after.frame), before, "the state before the request");
  await page.locator(".toasts").getByText("The engine failed").waitFor();
});

/** Serves the playground. */
async function playground(t) {
  const types = { html: "text/html", js: "text/javascript", css: "text/css", json: "application/json", svg: "image/svg+xml", gz: "application/gzip" };
  const server = createServer(async (request, response) => {
    const name = new URL(request.url, "http://localhost").pathname.replace(/\/$/, "/index.html");
    try {
      const body = await readFile(join(root, "studio/dist/playground", name));
      response.writeHead(200, { "content-type": types[name.split(".").pop()] ?? "text/plain" }).end(body);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  t.after(() => server.close());
  return `http://127.0.0.1:${server.address().port}/`;
}

test("the playground: a gallery, games, links", async (t) => {
  assert.ok((await stat(join(root, "studio/dist/playground/index.html"))).size > 0);
  const url = await playground(t);
  const context = await chromium.newContext({ viewport: { width: 1280, height: 800 } });
  t.after(() => context.close());
  const page = await context.newPage();
  const errors = [];
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) errors.push(message.text());
  });
  page.on("pageerror", (error) => errors.push(String(error)));
  await page.goto(url);
  await page.locator(".card").first().waitFor();
  assert.equal(await page.locator(".card").count(), all.length);
  await page.getByRole("link", { name: /^Mario/ }).first().click();
  await until(page, "globalThis.studio?.game.frame");
  // A change goes into the link.
  await page.evaluate(() => {
    const view = globalThis.studio.text.editor;
    const at = view.state.doc.toString().indexOf("run_speed = 100");
    view.dispatch({ changes: { from: at, to: at + 15, insert: "run_speed = 123" } });
  });
  await until(page, "globalThis.studio.game.opened.unsaved.length > 0");
  await page.getByRole("button", { name: "Share" }).click();
  await until(page, "location.hash.startsWith('#code=')");
  const link = page.url();
  const other = await context.newPage();
  await other.goto(link);
  await until(other, "globalThis.studio?.game.frame");
  const text = await other.evaluate(() => globalThis.studio.game.carrier.ask({ ask: "text", written: true }));
  assert.match(text.text, /run_speed = 123/);
  await other.goto("about:blank");
  await other.goto(`${url}#code=AAAA`);
  await other.getByRole("alert").getByText("damaged").waitFor();
  await other.goto("about:blank");
  await other.goto(`${url}#new`);
  await until(other, "globalThis.studio?.game.frame");
  assert.deepEqual(await other.evaluate("globalThis.studio.game.opened.findings"), []);
  assert.deepEqual(errors, []);
});

test("the playground exports what `hypedc play --export` writes, and it plays from a file", async (t) => {
  const url = await playground(t);
  for (const [id, name, args] of [
    ["mario", "mario", ["examples/mario.hyped"]],
    ["smb-smb-mario-1-1", "smb", ["examples/smb/smb.hyped", "--map", "examples/smb/mario-1-1.txt"]],
    ["paper-test1", "test1", ["examples/paper/test1.hyped"]],
  ]) {
    const context = await chromium.newContext({ acceptDownloads: true });
    t.after(() => context.close());
    const page = await context.newPage();
    await page.goto(`${url}#game=${id}`);
    await until(page, "globalThis.studio?.game.frame");
    const download = page.waitForEvent("download");
    await page.getByRole("button", { name: "Export" }).click();
    const path = join(folder, `exported-${name}.html`);
    await (await download).saveAs(path);
    const native = join(folder, `native-${name}.html`);
    run(["play", ...args, "--export", native, "--engine", engine]);
    assert.ok((await readFile(path, "utf8")) === (await readFile(native, "utf8")), `${id} is another file`);
    const { page: game, errors, context: other } = await open(chromium, pathToFileURL(path).href, { offline: true });
    await game.keyboard.down("ArrowRight");
    await until(game, "globalThis.studio.game.length > 20");
    assert.deepEqual(errors, []);
    await other.close();
  }
});

for (const colorScheme of ["light", "dark"]) {
  test(`axe finds nothing in the gallery, ${colorScheme}`, async (t) => {
    const context = await chromium.newContext({ colorScheme, bypassCSP: true });
    t.after(() => context.close());
    const page = await context.newPage();
    await page.goto(await playground(t));
    await page.locator(".card").first().waitFor();
    await page.addScriptTag({ path: axe });
    const { violations } = await page.evaluate("axe.run(document)");
    assert.deepEqual(violations.map((of) => `${of.id}: ${of.nodes.map((node) => node.html).slice(0, 3).join(" ")}`), []);
  });
}

test("the first frame of the playground is there within 2 s", async (t) => {
  const url = await playground(t);
  const times = [];
  for (let round = 0; round < 3; round += 1) {
    const context = await chromium.newContext();
    const page = await context.newPage();
    await page.goto(`${url}#game=mario`);
    await until(page, "globalThis.studio?.game.frame");
    times.push(Math.round(await page.evaluate("performance.now()")));
    await context.close();
  }
  t.diagnostic(`${times.join(", ")} ms`);
  assert.ok(Math.min(...times) < 2000 * PATIENCE, `${times} ms`);
});

test("inputs of examples lead to their goals in the browser", async (t) => {
  for (const name of ["balloon", "switch_door", "paper/test1"]) {
    const { page, context } = await playing(null, name);
    const script = inputs(all.find((one) => one.name === name).project.root);
    const end = await page.evaluate((script) => globalThis.studio.game.carrier.ask({ ask: "load", script }), script);
    assert.ok(end.frame.goals.length > 0, name);
    await context.close();
  }
  t.diagnostic("3 games");
});
