// A real VS Code (of code-server) with the packaged extension, in a headless browser.
//
// The first call installs code-server with npm into dist/code-server. Needs the packages of studio/, whose tests start the
// same browser, and a C++ compiler.

import { execFileSync, spawn } from 'node:child_process';
import { cpSync, existsSync, mkdirSync, mkdtempSync, realpathSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { delimiter, join, resolve } from 'node:path';
import { browser as launch } from '../../../studio/test/browser.mjs';

const here = join(import.meta.dirname, '..');
const which = (name) => process.env.PATH.split(delimiter).map((folder) => join(folder, name)).find(existsSync) ?? name;

/** Installs code-server without scripts, which build unused parts; except for the one for output channels. */
function install(folder) {
  const npm = (cwd, ...what) => execFileSync('npm', [...what, '--silent'], { cwd, stdio: 'inherit' });
  const fetch = ['install', '--ignore-scripts', '--no-audit', '--no-fund'];
  const code = join(folder, 'node_modules/code-server/lib/vscode');
  if (!existsSync(join(code, 'node_modules/@vscode/spdlog/build'))) {
    mkdirSync(folder, { recursive: true });
    writeFileSync(join(folder, 'package.json'), '{ "private": true }');
    npm(folder, ...fetch, 'code-server@4.100.3');
    npm(code, ...fetch, '--omit=dev');
    npm(code, 'rebuild', '@vscode/spdlog');
  }
  return join(code, 'out/server-main.js');
}

/** Starts it on a copy of a folder with further files; pictures go to another folder. */
export async function start(folder, files, pictures) {
  const hypedc = realpathSync(process.env.HYPEDC ?? which('hypedc'));
  const shots = resolve(pictures);
  mkdirSync(shots, { recursive: true });
  const main = install(join(here, 'dist/code-server'));
  const home = mkdtempSync(join(tmpdir(), 'hyped-look-'));
  const work = join(home, 'work');
  if (folder) cpSync(folder, work, { recursive: true });
  mkdirSync(work, { recursive: true });
  for (const [name, text] of Object.entries(files)) writeFileSync(join(work, name), text);
  for (const [name, settings] of Object.entries({
    Machine: { 'hypedc.path': hypedc },
    User: { 'workbench.startupEditor': 'none', 'security.workspace.trust.enabled': false, 'workbench.tips.enabled': false, 'editor.cursorBlinking': 'solid', 'testing.automaticallyOpenTestResults': 'neverOpen' },
  })) {
    mkdirSync(join(home, name));
    writeFileSync(join(home, name, 'settings.json'), JSON.stringify(settings));
  }
  const folders = ['--extensions-dir', join(home, 'extensions'), '--user-data-dir', home, '--server-data-dir', home];
  execFileSync(process.execPath, [main, ...folders, '--install-extension', join(here, 'hyped.vsix')], { stdio: 'pipe' });

  const server = spawn(process.execPath, [main, ...folders, '--host', '127.0.0.1', '--port', '0', '--without-connection-token', '--accept-server-license-terms', '--telemetry-level', 'off']);
  const port = await new Promise((found, never) => {
    let said = '';
    server.stdout.on('data', (text) => {
      const [, port] = /Server bound to [^:]+:(\d+)/.exec((said += text)) ?? [];
      if (port) found(port);
    });
    server.stderr.resume();
    server.on('exit', () => never(new Error(`VS Code has ended:\n${said}`)));
  });

  const browser = await launch();
  const page = await browser.newPage({ viewport: { width: 1400, height: 900 } });
  page.setDefaultTimeout(30_000);
  const { keyboard } = page;
  let taken = 0;

  /** Waits until an element is visible, with a text if one is given. */
  const see = (what, hasText) => page.locator(what, { hasText }).first().waitFor();
  const gone = (what) => page.locator(what).first().waitFor({ state: 'hidden' });
  /** Takes a picture once the page is stable. */
  async function look(name) {
    await page.waitForTimeout(500);
    taken += 1;
    await page.screenshot({ path: join(shots, `${String(taken).padStart(2, '0')}-${name}.png`) });
    console.log(name);
  }
  /** Enters a line into the input that a key opens, for commands and positions. */
  async function pick(key, text) {
    await keyboard.press(key);
    await see('.quick-input-widget input');
    await keyboard.type(text);
    await see('.quick-input-list .monaco-list-row.focused');
    await page.waitForTimeout(300);
    await keyboard.press('Enter');
    await gone('.quick-input-widget');
  }
  const command = (title) => pick('F1', title);
  /** A file or a folder in the explorer. */
  const row = (name) => page.locator('.explorer-folders-view .monaco-list-row', { hasText: name }).first();
  const open = (name) => row(name).dblclick();
  const go = (line, column) => pick('Control+g', `${line}:${column}`);
  const type = (text) => keyboard.type(text, { delay: 40 });
  /** Opens the folder. */
  async function begin() {
    await page.goto(`http://127.0.0.1:${port}/?folder=${encodeURIComponent(work)}`);
    await see('.explorer-folders-view .monaco-list-row');
  }

  /** Runs something, takes a picture if it fails, and ends everything. */
  async function run(what) {
    let failure;
    try {
      await what();
    } catch (error) {
      failure = error;
      await look('failed').catch(() => undefined);
    }
    await browser.close();
    server.removeAllListeners('exit');
    server.kill();
    rmSync(home, { recursive: true, force: true, maxRetries: 5, retryDelay: 200 });
    if (failure) throw failure;
    console.log(`${taken} pictures are in ${shots}`);
  }
  return { page, keyboard, see, gone, look, pick, command, row, open, go, type, begin, run, work, hypedc };
}
