// Runs the packaged extension in a real VS Code (of code-server) in a headless browser, and takes screenshots.
//
// npm run package && HYPEDC=PATH npm run look [FOLDER]    the screenshots go to FOLDER, by default to dist/look
//
// Each step waits for an expected element, and fails if it does not appear. Needs Node.js 20, a C++ compiler and
// Chromium ($CHROMIUM, or `chromium` on the PATH); npm installs the rest into dist/code-server, once. Not part of CI:
// people look at the screenshots.

import { execFileSync, spawn } from 'node:child_process';
import { cpSync, existsSync, mkdirSync, mkdtempSync, realpathSync, rmSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { delimiter, join, resolve } from 'node:path';

const here = join(import.meta.dirname, '..');
const which = (name) => process.env.PATH.split(delimiter).map((folder) => join(folder, name)).find(existsSync) ?? name;
const hypedc = realpathSync(process.env.HYPEDC ?? which('hypedc'));
const shots = resolve(process.argv[2] ?? join(here, 'dist/look'));
mkdirSync(shots, { recursive: true });

/** Installs both packages without their scripts, which build unused parts; except for the one for output channels. */
function install(folder) {
  const npm = (cwd, ...what) => execFileSync('npm', [...what, '--silent'], { cwd, stdio: 'inherit' });
  const fetch = ['install', '--ignore-scripts', '--no-audit', '--no-fund'];
  const code = join(folder, 'node_modules/code-server/lib/vscode');
  if (!existsSync(join(code, 'node_modules/@vscode/spdlog/build'))) {
    mkdirSync(folder, { recursive: true });
    writeFileSync(join(folder, 'package.json'), '{ "private": true }');
    npm(folder, ...fetch, 'code-server@4.100.3', 'playwright-core@1.65.1');
    npm(code, ...fetch, '--omit=dev');
    npm(code, 'rebuild', '@vscode/spdlog');
  }
  return { main: join(code, 'out/server-main.js'), browser: createRequire(join(folder, 'package.json'))('playwright-core').chromium };
}
const { main, browser: chromium } = install(join(here, 'dist/code-server'));

const home = mkdtempSync(join(tmpdir(), 'hyped-look-'));
const work = join(home, 'examples');
cpSync(join(here, '../../examples'), work, { recursive: true });
writeFileSync(join(work, '0new.hyped'), '');
for (const [name, settings] of Object.entries({
  Machine: { 'hypedc.path': hypedc },
  User: { 'workbench.startupEditor': 'none', 'security.workspace.trust.enabled': false, 'workbench.tips.enabled': false, 'editor.cursorBlinking': 'solid' },
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

const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? which('chromium'), args: ['--no-sandbox', '--disable-gpu'] });
const page = await browser.newPage({ viewport: { width: 1400, height: 900 } });
page.setDefaultTimeout(30_000);
const { keyboard } = page;
let taken = 0;

/** Waits until an element is visible, with a text if one is given. */
const see = (what, hasText) => page.locator(what, { hasText }).first().waitFor();
const gone = (what) => page.locator(what).first().waitFor({ state: 'hidden' });
/** Takes a screenshot once the page is stable. */
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
/** Opens a file or a folder in the explorer. */
const open = (name) => page.locator('.explorer-folders-view .monaco-list-row', { hasText: name }).first().dblclick();
const go = (line, column) => pick('Control+g', `${line}:${column}`);
const type = (text) => keyboard.type(text, { delay: 40 });

async function tour() {
  await page.goto(`http://127.0.0.1:${port}/?folder=${encodeURIComponent(work)}`);
  await see('.explorer-folders-view', 'link.hyped');

  await open('link.hyped');
  await see('.view-line', ': px/s = 80');
  await see('.view-line', 'is 0..14');
  await look('colours-and-hints');

  await go(33, 40);
  await command('Show or Focus Hover');
  await see('.monaco-hover', 'mode strike');
  await look('hover');
  await keyboard.press('Escape');

  await keyboard.press('End');
  await keyboard.press('Enter');
  await type('when pressed(sword) -> ');
  await see('.suggest-widget.visible .monaco-list-row', 'fallen');
  await look('completion');
  await keyboard.press('Escape');
  await type('strikee');
  await keyboard.press('Escape');
  await see('.squiggly-error');
  await command('Problems: Focus on Problems View');
  await see('.markers-panel', 'no mode named `strikee`');
  await look('problems');
  await command('View: Toggle Panel Visibility');
  await go(34, 40);
  await keyboard.press('Control+.');
  await see('.action-widget', 'write `strike`');
  await look('fix');
  await keyboard.press('Enter');
  await gone('.squiggly-error');

  await command('Outline: Focus on Outline View');
  await see('.outline-tree', 'walk_speed');
  await look('outline');

  await page.locator('.explorer-folders-view .monaco-list-row', { hasText: 'paper' }).click();
  await open('test1.hyped');
  const lens = (text) => page.locator('.codelens-decoration a', { hasText: text }).first();
  await lens('simulate').waitFor();
  await look('lenses');
  await lens('search for this goal').click();
  const shown = page.frameLocator('iframe.webview').frameLocator('#active-frame');
  await shown.getByText('goal arrive: reached').waitFor();
  await shown.locator('img').waitFor();
  await look('reach');
  await shown.locator('img').click();
  await look('reach-larger');

  await lens('simulate').click();
  await see('.quick-input-widget', 'Which inputs?');
  await keyboard.press('Control+a');
  await type('right*40 -*10');
  await keyboard.press('Enter');
  await see('.output-view-content, .output-view', '50 steps');
  await look('simulate');
  await command('View: Toggle Panel Visibility');

  await command('Preferences: Toggle between Light/Dark Themes');
  await open('0new.hyped');
  await page.locator('.editor-group-container.active .view-lines').click();
  await type('ent');
  const snippet = page.locator('.suggest-widget.visible .monaco-list-row:has(.codicon-symbol-snippet)').first();
  await snippet.waitFor();
  await look('snippets');
  await snippet.click();
  await see('.view-line', 'collider body');
  await keyboard.press('Escape');
  await keyboard.press('Escape');
  await go(7, 1);
  await type('      ');
  await see('.statusbar', 'Ln 7, Col 7');
  await command('Format Document');
  await see('.statusbar', 'Ln 7, Col 5');
  await look('format');
}

let failure;
try {
  await tour();
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
