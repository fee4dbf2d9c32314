// Paints the tiles of a level: each stroke changes one character of the map, in the text or in the file of the level.

import type { Stage } from "../draw/stage.ts";
import type { Game } from "../game.ts";
import { button, h } from "./dom.ts";
import type { Painter } from "./pointer.ts";

export class Paint implements Painter {
  readonly element = h("div", { class: "paint" });
  symbol: string | null = null;
  private readonly choices = h("div", { class: "tiles", role: "radiogroup", "aria-label": "Tile to paint" });
  private readonly how = h("p", { class: "quiet" });
  private readonly undoButton = button("Undo", () => void this.undo(), "small");
  private isPainting = false;
  private readonly queue: [number, number, string][] = [];

  constructor(
    private readonly game: Game,
    private readonly stage: Stage,
    private readonly changed: () => void,
  ) {
    this.element.append(
      h("h2", {}, "Tiles"),
      this.how,
      this.choices,
      this.undoButton,
    );
    stage.onColors.on(() => this.build());
  }

  /** Chooses what is painted; null looks at things again. */
  choose(symbol: string | null): void {
    this.symbol = symbol;
    for (const input of this.choices.querySelectorAll("input")) input.checked = input.value === (symbol ?? "");
  }

  private build(): void {
    const { game, stage } = this;
    const all = (game.scene?.spaces ?? []).map((space) => space.map).filter((map) => map !== null);
    const maps = all.filter((map) => map.is_painted);
    const seen = new Map<string, { label: string; color: string }>();
    for (const map of maps) {
      for (const kind of map.kinds) {
        const paint = kind.tags.length > 0 ? stage.colors?.kind(kind).paint.fill : undefined;
        if (!seen.has(kind.symbol)) seen.set(kind.symbol, { label: kind.label, color: paint ?? "transparent" });
      }
    }
    this.element.hidden = all.length === 0;
    this.choices.hidden = seen.size === 0;
    this.undoButton.hidden = seen.size === 0;
    const others = maps.length < all.length ? "Maps of a level editor are not painted here: change them in the editor, and save. They are played at once." : "";
    this.how.textContent = seen.size === 0 ? others : `Choose a tile and paint into the level with the mouse. Each cell is one character of the map in the text. ${others}`;
    const choice = (value: string, label: string, color: string): HTMLElement => {
      const swatch = h("span", { class: "swatch solid" });
      swatch.style.setProperty("--color", color);
      const input = h("input", { type: "radio", name: "tile", value, checked: value === (this.symbol ?? ""), onchange: () => this.choose(value || null) });
      return h("label", { class: "tile" }, input, value ? swatch : null, value ? h("code", {}, value) : null, label);
    };
    this.choices.replaceChildren(choice("", "Look only", ""), ...[...seen].map(([symbol, of]) => choice(symbol, of.label, of.color)));
    if (this.symbol !== null && !seen.has(this.symbol)) this.choose(null);
  }

  paint(space: number, cell: number): void {
    if (this.symbol === null) return;
    this.queue.push([space, cell, this.symbol]);
    if (!this.isPainting) void this.work();
  }

  private async work(): Promise<void> {
    this.isPainting = true;
    for (let next = this.queue.shift(); next; next = this.queue.shift()) {
      const [space, cell, symbol] = next;
      await this.game.change({ ask: "paint", space, cell, symbol });
    }
    this.isPainting = false;
    this.changed();
  }

  private async undo(): Promise<void> {
    await this.game.change({ ask: "undo" });
    this.changed();
  }
}
