// A tour through the packaged extension in a real VS Code, with pictures to look at. Each step waits for what it expects, and
// fails if that does not appear.
//
// npm run package && HYPEDC=PATH npm run look [FOLDER [PART]…]    the pictures go to FOLDER, by default to dist/look
//
// The parts are `basics`, `live` and `play`; without any, all of them. `.ci/code` runs them. Needs Node.js 20, a C++ compiler,
// Chromium ($CHROMIUM), and `npm ci` in studio/.

import { join } from 'node:path';
import { live } from './live.mjs';
import { play } from './play.mjs';
import { start } from './workbench.mjs';

const here = join(import.meta.dirname, '..');
const files = { '0new.hyped': '', ...live.files, ...play.files };
const bench = await start(join(here, '../../examples'), files, process.argv[2] ?? join(here, 'dist/look'));
const { page, keyboard, see, gone, look, command, row, open, go, type, begin, run } = bench;

async function tour() {
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

  await row('paper').click();
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

  // What imports a file follows when it is renamed.
  await row('robot.hyped').click();
  await keyboard.press('F2');
  await see('.explorer-folders-view .monaco-inputbox input');
  await keyboard.press('Control+a');
  await type('walker.hyped');
  await keyboard.press('Enter');
  await page.locator('.monaco-dialog-box', { hasText: 'refactoring changes' }).getByRole('button', { name: 'OK' }).click();
  await row('walker.hyped').waitFor();
  await open('test1.hyped');
  await see('.view-line', 'import "walker.hyped"');
  await gone('.squiggly-error');
  await look('renamed-file');
}

const parts = { basics: { tour }, live, play };
const chosen = process.argv.length > 3 ? process.argv.slice(3) : Object.keys(parts);
await run(async () => {
  await begin();
  for (const part of chosen) await parts[part].tour(bench);
});
