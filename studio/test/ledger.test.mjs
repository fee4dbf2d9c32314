// The requests that a page keeps of a run that goes on from a state: few, and they lead to the same frame.
import assert from "node:assert/strict";
import { test } from "node:test";
import { fileURLToPath } from "node:url";

import { build } from "esbuild";

const entry = fileURLToPath(new URL("../src/worker/ledger.ts", import.meta.url));
const { outputFiles } = await build({ entryPoints: [entry], bundle: true, format: "esm", write: false });
const { Ledger } = await import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].contents).toString("base64")}`);

/** As an engine: a history is what was played in each program; a change goes on from the state that is shown. */
class Engine {
  start = "";
  inputs = [];
  at = 0;
  isCarried = false;

  get state() {
    return [this.start, ...this.inputs.slice(0, this.at)].join("|");
  }

  get frame() {
    return { answer: "shown", length: this.inputs.length, frame: { at: this.at }, is_carried: this.isCarried };
  }

  ask(request) {
    switch (request.ask) {
      case "open":
        [this.start, this.inputs, this.at, this.isCarried] = ["opened", [], 0, false];
        return { answer: "opened", is_current: true, shown: this.frame };
      case "edit":
        [this.start, this.inputs, this.at, this.isCarried] = [`(${this.state})${request.text}`, [], 0, true];
        return { answer: "opened", is_current: true, shown: this.frame };
      case "play":
        if (request.inputs.length > 0) this.inputs.length = this.at;
        for (const input of request.inputs) this.inputs.push(JSON.stringify(input));
        this.at += request.inputs.length;
        return this.frame;
      case "seek":
        this.at = Math.min(request.frame, this.inputs.length);
        return this.frame;
      case "paths":
        return { answer: "paths", paths: ["game.hyped"] };
      case "text":
        return { answer: "text", text: "now" };
      case "script":
        return this.isCarried ? { answer: "refused", message: "carried" } : { answer: "text", text: "-" };
      default:
        return { answer: "done" };
    }
  }
}

/** Random numbers below `below`, the same ones each time. */
function random(seed) {
  let state = seed;
  return (below) => {
    state = (state * 1103515245 + 12345) % 2147483648;
    return Math.floor((state / 2147483648) * below);
  };
}

const playing = () => {
  const [engine, ledger] = [new Engine(), new Ledger({ "game.hyped": "" })];
  const ask = (request) => {
    const answer = engine.ask(request);
    ledger.note(request, answer, (of) => engine.ask(of));
  };
  return { engine, ledger, ask };
};

/** The engine that the kept requests lead to. */
const followed = (ledger) => {
  const engine = new Engine();
  for (const request of ledger.path()) engine.ask(request);
  return engine;
};

test("a run that goes on from a state is kept in few requests that lead there", () => {
  const { engine, ledger, ask } = playing();
  const next = random(7);
  ask({ ask: "keep", state: true });
  ask({ ask: "open" });
  let longest = 0;
  for (let step = 0; step < 40_000; step++) {
    const dice = next(1000);
    if (dice < 1) ask({ ask: "edit", path: "game.hyped", text: `t${step}` });
    else if (dice < 4) ask({ ask: "keep", state: true });
    else if (dice < 60) ask({ ask: "seek", frame: next(engine.inputs.length + 20) });
    else ask({ ask: "play", inputs: [[{ buttons: [next(3)], axes: [] }]] });
    longest = Math.max(longest, ledger.path().length);
    if (step % 997 === 0) {
      const again = followed(ledger);
      assert.equal(again.state, engine.state, `step ${step}`);
      assert.deepEqual(again.inputs, engine.inputs, `step ${step}`);
    }
  }
  assert.ok(engine.isCarried);
  assert.ok(longest <= 1_501, `${longest} requests`);
});

test("equal inputs are kept once", () => {
  const { ledger, ask } = playing();
  ask({ ask: "open" });
  ask({ ask: "edit", path: "game.hyped", text: "t" });
  for (let step = 0; step < 9_000; step++) ask({ ask: "play", inputs: [[{ buttons: [1], axes: [0] }]] });
  const inputs = ledger.path().filter((of) => of.ask === "play").flatMap((of) => of.inputs);
  assert.equal(inputs.length, 9_000);
  assert.ok(new Set(inputs).size <= 1_501, `${new Set(inputs).size} objects`);
});

test("after too many changes the texts alone are kept", () => {
  const { ledger, ask } = playing();
  ask({ ask: "open" });
  for (let step = 0; step < 5_000; step++) {
    ask({ ask: "edit", path: "game.hyped", text: `t${step}` });
    ask({ ask: "play", inputs: [[{ buttons: [], axes: [] }]] });
    assert.ok(ledger.path().length <= 1_501, `${ledger.path().length} requests`);
  }
  assert.ok(ledger.path().some((of) => of.ask === "edit"));
});
