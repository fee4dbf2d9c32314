// Watches the files of the program, and plays them again when one is saved in any editor.

import type { Game } from "./game.ts";
import type { TextPanel } from "./ui/text_panel.ts";
import type { Toasts } from "./ui/toasts.ts";

/** Time between two looks at the files, ms. */
const PAUSE = 40;

export class Watcher {
  private isOver = false;

  constructor(
    private readonly game: Game,
    private readonly text: TextPanel,
    private readonly toasts: Toasts,
  ) {
    game.carrier.onLost(() => (this.isOver = true));
  }

  start(): void {
    if (this.game.carrier.canWatch) void this.watch();
  }

  private async watch(): Promise<void> {
    while (!this.isOver) {
      const changed = await this.game.carrier.changed();
      if (changed.length > 0) {
        await this.game.change({ ask: "reload" });
        if (changed.some((path) => path.toLowerCase().endsWith(".png"))) this.game.onPictures.emit();
        // Beside an editor, the text that was typed is no news.
        if (this.text.elsewhere) continue;
        await this.text.fill();
        const names = changed.map((path) => path.split(/[\\/]/).pop() ?? path).join(", ");
        if (this.text.unsaved.some((path) => changed.includes(path))) {
          this.toasts.show(`${names} has changed on the disk; the text of the editor is played until it is saved or discarded`);
        } else if (this.game.opened?.is_current && Date.now() - this.text.savedAt > 1000) {
          this.toasts.show(`${names}: reloaded`);
        }
      }
      await new Promise((done) => setTimeout(done, document.hidden ? 10 * PAUSE : PAUSE));
    }
  }
}
