// Starts `hypedc play` and Chromium for the tests.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { readFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

/** By how much limits of time are stretched: other work on a machine takes its share. With HYPEDC_TIMES=1, not at all. */
export const PATIENCE = process.env.HYPEDC_TIMES ? 1 : 10;
/** The folder of the repository. */
export const root = fileURLToPath(new URL("../..", import.meta.url));
/** The binary that is tested. */
export const hypedc = process.env.HYPEDC ?? `${root}target/debug/hypedc`;

const ARGUMENTS = [
  "--headless",
  "--no-sandbox",
  "--disable-gpu",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  // A page that a test puts in place of the server's counts as one from elsewhere.
  ...(process.env.PAGE ? ["--disable-features=LocalNetworkAccessChecks"] : []),
];

/** Starts Chromium. */
export function browser() {
  return chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ARGUMENTS });
}

/** Serves a program; `url` is the address of its page. */
export async function play(...args) {
  const server = spawn(hypedc, ["play", "--no-open", ...args], { cwd: root, stdio: ["ignore", "pipe", "ignore"] });
  const [line] = await Promise.race([
    once(server.stdout, "data"),
    once(server, "exit").then(() => Promise.reject(new Error(`hypedc play ${args.join(" ")} has ended`))),
  ]);
  return {
    url: String(line).trim(),
    stop: async () => {
      server.kill();
      if (server.exitCode === null) await once(server, "exit");
    },
  };
}

/** With PAGE, the path of a bundle, pages are that bundle instead of the one in the binary. */
export async function freshPage(page) {
  const path = process.env.PAGE;
  if (!path) return;
  await page.route(
    (url) => url.pathname === "/",
    async (route) => route.fulfill({ response: await route.fetch(), body: await readFile(path, "utf8") }),
  );
}

/** Opens a page; `errors` are what its console has said. */
export async function open(of, url, options = {}) {
  const context = await of.newContext({ viewport: { width: 1280, height: 800 }, ...options });
  const page = await context.newPage();
  const errors = [];
  page.on("console", (message) => {
    if (message.type() === "error" || message.type() === "warning") errors.push(message.text());
  });
  page.on("pageerror", (error) => errors.push(String(error)));
  await freshPage(page);
  await page.goto(url);
  await page.waitForFunction(() => globalThis.studio?.game.frame, null, { timeout: 20_000 });
  return { page, context, errors };
}

/** Serves a program and opens its page for a test. */
export async function playing(of, t, args, options) {
  const server = await play(...args);
  t.after(() => server.stop());
  const opened = await open(of, server.url, options);
  t.after(() => opened.context.close());
  return { ...opened, url: server.url };
}

/** A value of the game of a page. */
export const game = (page, what) => page.evaluate(`globalThis.studio.game.${what}`);

/** Whether a condition holds; it does not where the page left for another while it was asked. */
async function holds(page, condition) {
  try {
    return await page.evaluate(`Boolean(${condition})`);
  } catch (error) {
    if (/context was destroyed/.test(error.message)) return false;
    throw error;
  }
}

/** Waits for a condition. It is asked from here: the page's policy lets nothing in it evaluate a text. */
export async function until(page, condition, timeout = 20_000) {
  const end = Date.now() + timeout;
  while (!(await holds(page, condition))) {
    assert.ok(Date.now() < end, `not after ${timeout} ms: ${condition}`);
    await new Promise((done) => setTimeout(done, 10));
  }
}

/** Waits until a game stands still: it is paused, and the last steps that it asked for are shown. */
export const stopped = (page) =>
  until(page, "globalThis.studio.game.mode === 'paused' && globalThis.studio.game.asking === null");
