// What runs in the editor: a failing test at its line, the page that plays the text, the statechart, code actions.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

/** A walk to the right over a gap, with tests of which one fails. */
const WALK = `/// Walks, and leaps.
entity Walker {
    param speed = 90
    button leap
    axis horizontal

    collider body: rect(0, 0, 12, 16)

    mode walking {
        x' = speed * horizontal
        y'' = -900
        when pressed(leap) -> leaping { y' := 260 }
    }
    mode leaping {
        x' = speed * horizontal
        y'' = -900
        when y' < 0 and touching(body, ground, below) -> walking
    }
}

world Gap {
    step 1/60

    collide body with ground: block

    tiles land 16 x 16 {
        '.': empty
        '#': ground
    }

    space main {
        map land "
            ........................................
            ........................................
            ########...#############################
        "
        place hero: Walker at (16, 16)
    }
    player 1: hero

    goal over: hero.x > 200
    never fell: hero.y < 0

    test "a walk" {
        inputs "right*30"
        expect hero.x > 40 at end
    }
    test "a leap" {
        inputs "right*10 right+leap right*20"
        expect hero.y > 400 at end
    }
}
`;

/** The same in a level of 200 tiles. */
const WIDE = WALK.replace(/^( +)([.#]{40})$/gm, (_, blank, row) => `${blank}${row}${row.at(-1).repeat(160)}`);

/** A program with four mistakes, each to be mended in its own way, and a number without a name; what it can import. */
const [MISTAKES, GEM] = ['ball', 'gem'].map((name) => readFileSync(join(import.meta.dirname, '../../test/repairs', `${name}.hyped`), 'utf8'));

/** Where the cursor is put, the action that is chosen, and what the text has then. */
const ACTIONS = [
  { line: 'touching(body, wall)', at: 'sliding', action: 'declare `mode sliding`', makes: 'mode sliding {' },
  { line: 'discrete lives', at: '= 3', action: 'write `int 0..9`', makes: 'int 0..9 = 3' },
  { line: 'place gem', at: 'Gem', action: 'import `0gem.hyped`', makes: 'import "0gem.hyped"' },
  { line: 'param weight', at: 'weight', action: 'remove the parameter', removes: 'param weight' },
  { line: 'pressed(leap)', at: '120', action: 'extract a parameter', removes: 'x < 120' },
];

/** The text of a line of the editor, with its inlay hints. */
const lineText = async (page, has) => (await page.locator('.view-line', { hasText: has }).first().innerText()).replaceAll('\u00a0', ' ');

/** Waits until something holds. */
async function until(what, holds) {
  for (let end = Date.now() + 20_000; Date.now() < end; ) {
    if (await holds()) return;
    await new Promise((done) => setTimeout(done, 100));
  }
  assert.fail(`never: ${what}`);
}

async function tour({ page, keyboard, see, gone, look, command, row, open, go, work, hypedc }) {
  await command('View: Close All Editors');
  await open('0walk.hyped');
  await see('.view-line', 'Walks, and leaps');

  // A test fails at its line, with its values.
  await page.locator('.activitybar [aria-label^="Testing"]').first().click();
  await see('.test-explorer .monaco-list-row', '0walk.hyped');
  await page.locator('.view-line', { hasText: 'Walks, and leaps' }).click();
  await command('Test: Run Tests in Current File');
  await see('.test-explorer', '2/4');
  await go(52, 1);
  await see('.monaco-editor', 'does not hold after step 31 (0.52 s): 49.25 and 400');
  await look('test-failed');
  await go(1, 1);

  // The page plays the text: keys play, the slider goes back; the modes of the frame are lit, guards show their values.
  await page.locator('.view-line', { hasText: 'Walks, and leaps' }).click();
  await command('Hyped: Play and Scrub');
  const shown = page.frameLocator('iframe.webview').frameLocator('#active-frame');
  await shown.locator('canvas').first().waitFor();
  await shown.getByText('0walk').first().waitFor();
  const lit = () =>
    page.evaluate(() => {
      const top = (row) => row.style.top;
      const numbers = [...document.querySelectorAll('.margin-view-overlays > div')].map((row) => [top(row), row.querySelector('.line-numbers')?.textContent]);
      const lines = new Map(numbers);
      const rows = [...document.querySelectorAll('.view-overlays > div')].filter((row) => row.querySelector('[class*="ced-"]'));
      return rows.map((row) => lines.get(top(row))).filter(Boolean).join();
    });
  await until('the first mode is lit', async () => (await lit()) === '9');
  await shown.locator('canvas').first().click();
  await keyboard.down('ArrowRight');
  await page.waitForTimeout(500);
  await keyboard.press('Space', { delay: 150 });
  await keyboard.up('ArrowRight');
  await until('a leap is lit', async () => (await lit()).split(',').includes('14'));
  await keyboard.press('KeyP');
  await look('timeline');
  const time = shown.locator('input[type=range]').first();
  await time.fill('5');
  await until('the first mode is lit again', async () => (await lit()) === '9');
  await until('the guard has its value', async () => (await lineText(page, 'when pressed')).includes('✗'));
  await look('timeline-scrubbed');

  // Taken over there: other keys, and another run. Its inputs are saved beside the program.
  await shown.locator('canvas').first().click();
  await keyboard.down('ArrowLeft');
  await page.waitForTimeout(300);
  await keyboard.up('ArrowLeft');
  await keyboard.press('KeyP');
  await shown.getByText('Taken over from here').waitFor();
  await command('Hyped: Save the Inputs of the Run');
  await see('.quick-input-widget input');
  await keyboard.press('Enter');
  await gone('.quick-input-widget');
  const saved = join(work, '0walk.inputs');
  await until('the inputs are saved', () => existsSync(saved) && readFileSync(saved, 'utf8').endsWith('\n'));
  const inputs = readFileSync(saved, 'utf8');
  assert.match(inputs, /left/);
  assert.doesNotMatch(inputs, /leap/);
  // They can be run.
  execFileSync(hypedc, ['sim', join(work, '0walk.hyped'), '--inputs-file', saved]);

  // What is typed is played at once: faster, the same inputs lead further.
  const where = () => shown.locator('canvas').first().evaluate(() => window.studio.game.now.x?.[0] ?? JSON.stringify(window.studio.game.frame.bodies.slice(0, 4)));
  const before = await where();
  await page.locator('.view-line', { hasText: 'param speed' }).click({ position: { x: 60, y: 8 } });
  await go(3, 19);
  await keyboard.type('5');
  await until('the run is another', async () => (await where()) !== before);
  await keyboard.press('Backspace');
  await until('the run is as before', async () => (await where()) === before);

  // The statechart follows the cursor, and shows the mode of the frame.
  await go(15, 10);
  await command('Hyped: Show the Statechart');
  const marked = async (name) => {
    const all = await Promise.all(page.frames().map((frame) => frame.locator(`#chart rect.${name}`).count().catch(() => 0)));
    return all.reduce((sum, count) => sum + count);
  };
  await until('the mode of the frame is marked', async () => (await marked('active')) === 1 && (await marked('cursor')) === 1);
  await look('chart');
  await command('View: Close All Editors');

  // A level that is wider than the page: its tiles are large enough to be seen, and the view goes with the player.
  await page.locator('.activitybar [aria-label^="Explorer"]').first().click();
  // The file that was saved moves the rows below it.
  await row('0walk.inputs').waitFor();
  await page.waitForTimeout(1000);
  await open('0wide.hyped');
  await see('.view-line', 'Walks, and leaps');
  await command('Hyped: Play and Scrub');
  await shown.getByText('0wide').first().waitFor();
  const canvas = shown.locator('canvas').first();
  await canvas.waitFor();
  const view = () =>
    canvas.evaluate(() => {
      const { camera, ratio } = window.studio.stage;
      return { left: camera.x - camera.width / camera.scale / 2, width: camera.width / camera.scale, tile: (16 * camera.scale) / ratio };
    });
  await until('the start is in view', async () => (await view()).left <= 16);
  const first = await view();
  assert.ok(first.tile >= 12 && first.width < 3200, JSON.stringify(first));
  await canvas.click();
  await keyboard.down('ArrowRight');
  // Over the gap, and on.
  await page.waitForTimeout(900);
  for (let leaps = 0; leaps < 6; leaps++) await keyboard.press('Space', { delay: 600 });
  await keyboard.up('ArrowRight');
  await keyboard.press('KeyP');
  await until('the view has moved', async () => (await view()).left > first.left + 32);
  await look('timeline-wide');
  await command('View: Close All Editors');

  // Five code actions: a mode that is missing, a range, an import, what nothing reads, a number that gets a name.
  await open('0ball.hyped');
  await see('.squiggly-error');
  const rows = (hasText) => page.locator('.view-line', { hasText });
  for (const { line, at, action, makes, removes } of ACTIONS) {
    await rows(line).first().click();
    // To the first character of the line, and from there to the place.
    const text = (await lineText(page, line)).trim();
    await keyboard.press('End');
    await keyboard.press('Home');
    for (let step = 0; step < text.indexOf(at); step++) await keyboard.press('ArrowRight');
    // Findings of the text of before have no fixes.
    await until(action, async () => {
      await keyboard.press('Control+.');
      const row = page.locator('.action-widget .monaco-list-row', { hasText: action }).first();
      const isSeen = await row.waitFor({ timeout: 2000 }).then(() => true, () => false);
      if (!isSeen) await keyboard.press('Escape');
      return isSeen;
    });
    await look(`action-${action.split(' ')[0]}`);
    const focused = page.locator('.action-widget .monaco-list-row.focused');
    for (let tries = 0; tries < 20 && !(await focused.innerText()).includes(action); tries++) await keyboard.press('ArrowDown');
    await keyboard.press('Enter');
    if (makes) await rows(makes).first().waitFor();
    if (removes) await until(`no ${removes}`, async () => (await rows(removes).count()) === 0);
  }
  await gone('.squiggly-error');
  await look('fixed');
}

export const play = { files: { '0walk.hyped': WALK, '0wide.hyped': WIDE, '0ball.hyped': MISTAKES, '0gem.hyped': GEM }, tour };
