// The same bits natively and as WebAssembly: random play of every example, play sessions, searches, findings.
// HYPEDC_WASM and HYPEDC_NATIVE name the module and the native engine.
import assert from "node:assert/strict";
import { after, test } from "node:test";

import { NativeEngine, WebEngine } from "./engines.mjs";
import { games, inputs, repository } from "./games.mjs";

const wasm = process.env.HYPEDC_WASM ?? `${repository}/bindings/web/dist/hypedc.wasm`;
const native = new NativeEngine(process.env.HYPEDC_NATIVE ?? `${repository}/target/release/native`);
after(() => native.end());

/** Asks both engines, and returns the one answer. */
async function both(web, request, what) {
  const answers = [web.ask(request), await native.ask(request)];
  assert.equal(answers[0], answers[1], what);
  return JSON.parse(answers[0]);
}

const all = games();

test("there are examples", () => assert.ok(all.length > 25, `${all.length}`));

for (const { name, project } of all) {
  test(`${name}: states of 100,000 random steps`, async () => {
    const web = new WebEngine(wasm);
    await both(web, { ask: "files", ...project });
    const played = await both(web, { ask: "random_steps", seed: 7, steps: 100_000, hash: true }, name);
    assert.match(played.hash ?? JSON.stringify(played), /^[0-9a-f]{16}$/);
  });

  test(`${name}: a session`, async () => {
    const web = new WebEngine(wasm);
    await both(web, { ask: "files", ...project });
    const opened = await both(web, { ask: "open" }, "open");
    assert.ok(opened.scene, JSON.stringify(opened.findings));
    const held = opened.scene.players.map(({ buttons, axes }) => ({
      buttons: buttons.length > 0 ? [0] : [],
      axes: axes.map((_, axis) => (axis === 0 ? 0.75 : -1)),
    }));
    for (let second = 0; second < 4; second += 1) {
      const inputs = Array.from({ length: 30 }, (_, step) => (step % 20 < 15 ? held : []));
      await both(web, { ask: "play", inputs }, "play");
    }
    await both(web, { ask: "seek", frame: 37 }, "seek");
    await both(web, { ask: "predict", input: held, steps: 60 }, "predict");
    for (const { slot } of opened.scene.players) await both(web, { ask: "inspect", slot }, "inspect");
    for (const { name: entity } of opened.scene.entities) await both(web, { ask: "chart", entity }, "chart");
    await both(web, { ask: "sliders" }, "sliders");
    await both(web, { ask: "script" }, "script");
    const script = inputs(project.root);
    if (script !== null) {
      const end = await both(web, { ask: "load", script }, "load");
      assert.equal(end.answer, "shown", end.message);
    }
  });
}

test("five searches", async () => {
  // So many nodes that the verdict does not depend on luck.
  const questions = [
    ["paper/test1", 20_000, "reached"],
    ["mario", 6_000, "reached"],
    ["balloon", 2_000, "reached"],
    ["switch_door", 2_000, "reached"],
    ["link", 1_000, "not-found"],
  ];
  for (const [name, nodes, verdict] of questions) {
    const web = new WebEngine(wasm);
    const { project } = all.find((game) => game.name === name);
    await both(web, { ask: "files", ...project });
    const { scene } = await both(web, { ask: "open" }, name);
    const search = { ask: "search", target: { goal: scene.goals[0] }, nodes, seed: 3 };
    await both(web, search, name);
    // Verdict, nodes, inputs and every point of the tree.
    const found = await both(web, { ask: "poll" }, name);
    assert.equal(found.is_running ?? false, false);
    assert.equal(found.conclusion, verdict, name);
    if (found.nodes > 500) assert.ok(web.reports.length > 0, `${name}: no progress is reported`);
  }
});

test("findings, completions and hovers", async () => {
  const web = new WebEngine(wasm);
  const { project } = all.find((game) => game.name === "mario");
  await both(web, { ask: "files", ...project });
  const path = project.root;
  const text = project.files[path];
  const clean = await both(web, { ask: "document", path, text });
  assert.deepEqual(clean.findings, []);
  const broken = text.replace(/-> \w+/, "-> nowhere");
  const { findings } = await both(web, { ask: "document", path, text: broken });
  assert.ok(findings.some((found) => found.severity === "error"), JSON.stringify(findings));
  const at = broken.indexOf("nowhere");
  assert.ok(findings.some(({ from, to }) => from <= at + 4 && to >= at), JSON.stringify(findings));
  await both(web, { ask: "document", path, text });
  await both(web, { ask: "analyze", path });
  const { markdown } = await both(web, { ask: "hover", path, at: text.indexOf("entity Mario") + 8 });
  assert.match(markdown, /Mario/);
  const start = text.indexOf("\n    mode ") + 5;
  const { items } = await both(web, { ask: "completion", path, at: start });
  assert.ok(items.some(({ label }) => label === "mode"), JSON.stringify(items));
  const { keywords } = await both(web, { ask: "keywords" });
  assert.ok(keywords.includes("entity"));
  const { tokens } = await both(web, { ask: "tokens", path });
  assert.ok(tokens.length > 100);
  const loose = text.replace("    ", "       ");
  await both(web, { ask: "document", path, text: loose });
  const { edits } = await both(web, { ask: "format", path });
  const formatted = edits.reduceRight((all, { from, to, text: put }) => all.slice(0, from) + put + all.slice(to), loose);
  assert.equal(formatted, text);
});

test("what is no request is refused", async () => {
  const web = new WebEngine(wasm);
  for (const request of ["", "{", "null", '{"ask":"fly"}', '{"ask":"play"}', '{"ask":"open"}', '"\\ud800"']) {
    assert.equal(JSON.parse(web.ask(request)).answer, "refused", request);
  }
  const { project } = all[0];
  web.ask({ ask: "files", ...project });
  assert.equal(JSON.parse(web.ask({ ask: "open" })).answer, "opened");
  const missing = { files: { "a.hyped": 'import "b.hyped"\n' }, root: "a.hyped" };
  web.ask({ ask: "files", ...missing });
  const { findings } = JSON.parse(web.ask({ ask: "open" }));
  assert.ok(findings.some(({ message }) => message.includes("b.hyped")), JSON.stringify(findings));
});
