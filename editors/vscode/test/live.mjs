// What the text shows of itself: a verdict above a goal, which an edit turns, with what it breaks; a map that is painted;
// findings of programs that are not open, the page of a code, a list that opens again, a layout while one types.

const CAVE = `/// Walks, and jumps.
entity Walker {
    param speed = 90
    button jump
    axis horizontal

    collider body: rect(0, 0, 12, 14)

    mode falling {
        x' = speed * horizontal
        y'' = -900
        when touching(body, ground, below) -> standing
    }
    mode standing {
        x' = speed * horizontal
        y' = 0
        when pressed(jump) -> falling { y' := 330 }
        when not touching(body, ground, below) -> falling
    }
}

world Cave {
    step 1/60

    collide body with ground: block

    tiles land 16 x 16 {
        '.': empty
        '#': ground
    }

    space main {
        bounds rect(0, 0, 480, 160)
        map land "
            ..............................
            ..............................
            ..............................
            ..............####............
            ..........................####
            ........####..........####....
            .....................##.......
            ....##.......####...###......#
            ..............................
            #########..########.##########
        "
        place hero: Walker at (16, 16)
    }
    player 1: hero

    goal ledge: hero.x > 420 and hero.y > 90
    never fell: hero.y < 2
}
`;

/** Whether a word of the text is faded, as it is wanted to be. */
const FADED = ([word, wanted]) =>
  [...document.querySelectorAll('.view-line span span')].some((span) => span.textContent.includes(word) && getComputedStyle(span).opacity < 1) === wanted;

async function tour(bench) {
  const { page, keyboard, see, look, command, open, go, type } = bench;
  await command('View: Close All Editors');
  await open('0cave.hyped');
  const lens = (text) => page.locator('.codelens-decoration a', { hasText: text }).first();

  // A verdict, an edit that turns it, what it breaks, and the way back.
  await go(49, 1);
  await lens(/^✓ [\d.]+ s · play$/).waitFor();
  await lens(/^✗ broken in/).waitFor();
  await look('verdicts');
  await page.locator('.view-line', { hasText: 'goal ledge' }).first().click();
  // Until it is asked again, the verdict is out of date, and the line of its goal faded.
  const faded = page.waitForFunction(FADED, ['ledge', true], { polling: 'raf' });
  await keyboard.press('End');
  await type(' ');
  await faded;
  await keyboard.press('Backspace');
  await go(17, 47);
  for (const _ of '330') await keyboard.press('Delete');
  await type('90');
  await go(49, 1);
  await lens(/^✗ proven/).waitFor();
  await page.waitForFunction(FADED, ['ledge', false]);
  await see('.squiggly-warning');
  await command('Problems: Focus on Problems View');
  await see('.markers-panel', 'this edit broke');
  await look('verdict-broken');
  await command('View: Toggle Panel Visibility');
  await page.locator('.view-line', { hasText: 'goal ledge' }).first().click();
  await keyboard.press('Control+z');
  await keyboard.press('Control+z');
  await lens(/^✓ [\d.]+ s · play$/).waitFor();

  // The map is shaded, in dark and light themes; a tile tells of itself.
  await command('Hyped: Paint the Maps of a World');
  await go(38, 1);
  await see('.view-overlays [class*="ced-"]');
  await look('painted');
  await go(40, 25);
  await command('Show or Focus Hover');
  await see('.monaco-hover', 'First reached at step');
  await see('.monaco-hover', 'Play the inputs that lead here');
  await look('painted-tile');
  await keyboard.press('Escape');
  await command('Preferences: Toggle between Light/Dark Themes');
  await look('painted-other-theme');
  await command('Preferences: Toggle between Light/Dark Themes');
  await command('Hyped: Paint the Maps of a World');

  // The way that was found.
  await lens('play').click();
  const shown = page.frameLocator('iframe.webview').frameLocator('#active-frame');
  await shown.getByText('goal ledge: reached').waitFor();
  await look('verdict-played');
  await announced(bench);
}

const BROKEN = `entity Ghost {
    button boo
    mode calm {
        when pressed(boo) -> nowhere
    }
}
`;

/** What VS Code gets from the server only since the extension asks for it. */
async function announced({ page, keyboard, see, look, command, open, go, type }) {
  await command('View: Close All Editors');
  // The finding of a program that was never opened.
  await command('Problems: Focus on Problems View');
  await see('.markers-panel', 'no mode named `nowhere`');
  await look('closed');
  // Its code is a link to its page.
  const code = page.locator('.markers-panel .monaco-list-row', { hasText: 'nowhere' }).locator('a', { hasText: 'E0201' }).first();
  await code.click({ modifiers: ['Control'] });
  const shown = page.frameLocator('iframe.webview').frameLocator('#active-frame');
  await shown.getByRole('heading', { name: 'E0201' }).waitFor();
  await look('explained');
  await command('View: Close All Editors');
  await command('View: Toggle Panel Visibility');

  // The list of buttons opens once `pressed(` is accepted.
  await open('0broken.hyped');
  await go(4, 37);
  await keyboard.press('Enter');
  await type('when pres');
  const offered = page.locator('.suggest-widget.visible .monaco-list-row', { hasText: 'pressed' }).first();
  // On a machine that is busy, the list of a letter before may have been given up.
  const isOffered = () => offered.waitFor({ timeout: 5000 }).then(() => true, () => false);
  for (let tries = 0; tries < 5 && !(await isOffered()); tries++) await keyboard.press('Control+Space');
  await keyboard.press('Tab');
  await page.locator('.suggest-widget.visible .monaco-list-row', { hasText: 'boo' }).first().waitFor();
  await look('list-again');
  await keyboard.press('Escape');
  await keyboard.press('Escape');
  // A closing brace puts its block into its layout.
  await keyboard.press('Control+End');
  await type('entity Other {\nmode   only   {\n}');
  await see('.view-line', 'mode only {');
}

export const live = { files: { '0cave.hyped': CAVE, '0broken.hyped': BROKEN }, tour };
