// The work of the page: what the main thread does for each frame of a large level, and what memory does over long play.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";

import { PATIENCE, browser, open, play } from "./browser.mjs";

/** Maximum work for a frame, 95 of 100 times, ms. */
const MAX_WORK = 4;

let chromium;
before(async () => {
  chromium = await browser();
});
after(() => chromium.close());

const LEVEL = ["examples/smb/smb.hyped", "--map", "examples/smb/mario-1-1.txt"];

test("a frame of a large level is little work", async (t) => {
  const server = await play(...LEVEL);
  t.after(() => server.stop());
  const { page, context } = await open(chromium, server.url);
  t.after(() => context.close());
  await page.keyboard.down("ArrowRight");
  await page.waitForTimeout(500);
  // Other programs on the machine only add to the work: the best of three measurements counts.
  const all = [];
  while (all.length < (PATIENCE > 1 ? 1 : 3) && !all.some((work) => work < MAX_WORK)) {
    const works = await measured(page);
    const part = (share) => works[Math.floor(share * (works.length - 1))];
    t.diagnostic(`${works.length} frames; work per frame: median ${part(0.5).toFixed(2)} ms, p95 ${part(0.95).toFixed(2)} ms`);
    assert.ok(works.length > 100 && part(0.5) > 0.05, "the work is measured");
    all.push(part(0.95));
  }
  assert.ok(Math.min(...all) < MAX_WORK * PATIENCE, `${all.map((work) => work.toFixed(2)).join(", ")} ms`);
});

/** The work of the thread that draws, for each frame of some seconds of play: from one frame to the next, ms, sorted. */
async function measured(page) {
  await chromium.startTracing(page, { categories: ["toplevel", "devtools.timeline", "disabled-by-default-devtools.timeline"] });
  for (let jump = 0; jump < 12; jump++) {
    await page.keyboard.down("Space");
    await page.waitForTimeout(250);
    await page.keyboard.up("Space");
    await page.waitForTimeout(250);
    if (await page.evaluate("globalThis.studio.game.ended")) await page.keyboard.press("KeyR");
  }
  const { traceEvents } = JSON.parse((await chromium.stopTracing()).toString());
  const frames = traceEvents.filter((event) => event.name === "FireAnimationFrame");
  assert.ok(frames.length > 0, "frames are drawn");
  const { tid, pid } = frames[0];
  const starts = frames.filter((event) => event.tid === tid && event.pid === pid).map((event) => event.ts);
  const works = new Float64Array(starts.length);
  for (const event of traceEvents) {
    if (event.tid !== tid || event.pid !== pid || event.name !== "RunTask") continue;
    let at = starts.findIndex((start) => start > event.ts + event.dur) - 1;
    if (at === -2) at = starts.length - 1;
    if (at >= 0) works[at] += (event.tdur ?? event.dur) / 1000;
  }
  return works.sort();
}

test("memory is bounded over an hour of play", async (t) => {
  const server = await play("examples/car.hyped");
  t.after(() => server.stop());
  const { page, context } = await open(chromium, server.url);
  t.after(() => context.close());
  const session = await context.newCDPSession(page);
  const used = async () => {
    await session.send("HeapProfiler.collectGarbage");
    return (await session.send("Runtime.getHeapUsage")).usedSize / 1e6;
  };
  // An hour at 60 steps a second, as fast as it goes: the inputs change every second.
  const hour = (from, to) =>
    page.evaluate(
      async ([from, to]) => {
        const { game } = globalThis.studio;
        const players = game.scene.players;
        for (let second = from; second < to; second++) {
          const held = players.map((of) => ({ buttons: [], axes: of.axes.map((_, axis) => Math.sin(second * (axis + 1))) }));
          game.take(await game.carrier.ask({ ask: "play", inputs: Array.from({ length: 60 }, () => held) }));
        }
        return game.length;
      },
      [from, to],
    );
  await hour(0, 300);
  const early = await used();
  const length = await hour(300, 3600);
  const late = await used();
  t.diagnostic(`${length} steps: ${early.toFixed(1)} MB after five minutes, ${late.toFixed(1)} MB after an hour`);
  assert.equal(length, 216_000);
  assert.ok(late < early + 8, `${early} MB, then ${late} MB`);
  // Any frame of it is shown soon.
  const times = await page.evaluate(async () => {
    const times = [];
    for (const part of [0.1, 0.77, 0.33, 0.99, 0]) {
      const begin = performance.now();
      await globalThis.studio.game.seek(part * 216_000);
      times.push(performance.now() - begin);
    }
    return times;
  });
  t.diagnostic(`seeks: ${times.map((time) => time.toFixed(0)).join(", ")} ms`);
  assert.ok(Math.max(...times) < 1000 * PATIENCE);
});
