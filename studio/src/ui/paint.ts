// Paints the tiles of a level: each stroke changes one character of the map, in the text or in the file of the level, or
// one number in the file of a level editor.

import type { Stage } from "../draw/stage.ts";
import type { Game } from "../game.ts";
import type { BrushInfo, MapInfo } from "../protocol.ts";
import { button, h } from "./dom.ts";
import type { Painter } from "./pointer.ts";

/** Side of the picture of a brush, CSS pixels. */
const SIDE = 24;

/** A brush, with the map that it is of. */
interface Choice {
  brush: BrushInfo;
  map: MapInfo;
}

/** Whether two brushes of different maps are the same. */
const isSame = (a: BrushInfo, b: BrushInfo): boolean => a.symbol === b.symbol && a.label === b.label;

export class Paint implements Painter {
  readonly element = h("div", { class: "paint" });
  private brush: BrushInfo | null = null;
  private readonly choices = h("div", { class: "tiles", role: "radiogroup", "aria-label": "Tile to paint" });
  private readonly how = h("p", { class: "quiet" });
  private readonly undoButton = button("Undo", () => void this.undo(), "small");
  private readonly radios = new Map<HTMLInputElement, BrushInfo | null>();
  private isPainting = false;
  /** What the choices show. */
  private shown = "";
  private readonly queue: [number, number, BrushInfo][] = [];

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

  get symbol(): string | null {
    return this.brush?.symbol ?? null;
  }

  /** Chooses what is painted; null looks at things again. */
  choose(brush: BrushInfo | null): void {
    this.brush = brush;
    for (const [input, of] of this.radios) {
      input.checked = of === brush || (of !== null && brush !== null && isSame(of, brush));
    }
  }

  private build(): void {
    const maps = (this.game.scene?.spaces ?? []).map((space) => space.map).filter((map) => map !== null);
    const all: Choice[] = [];
    for (const map of maps) {
      for (const brush of map.brushes) if (!all.some((of) => isSame(of.brush, brush))) all.push({ brush, map });
    }
    this.element.hidden = maps.length === 0;
    this.choices.hidden = all.length === 0;
    this.undoButton.hidden = all.length === 0;
    this.how.textContent = this.explain(maps, all);
    // Choices that stay the same keep the focus.
    const shown = JSON.stringify(all.map(({ brush, map }) => [brush, this.color({ brush, map }), this.picture({ brush, map })?.src]));
    if (shown !== this.shown) {
      this.shown = shown;
      this.radios.clear();
      this.choices.replaceChildren(this.choice(null), ...this.groups(all));
    }
    const now = all.find(({ brush }) => this.brush !== null && isSame(brush, this.brush));
    this.choose(now?.brush ?? null);
  }

  private explain(maps: MapInfo[], all: Choice[]): string {
    const text: string[] = [];
    if (all.length > 0) {
      text.push("Choose a tile and paint into the level with the mouse.");
      const isNumber = ({ brush, map }: Choice): boolean => map.kinds[brush.kind ?? -1]?.symbol !== brush.symbol;
      if (all.some((of) => !isNumber(of))) text.push("Each cell is one character of the map in the text.");
      if (all.some(isNumber)) text.push("Each cell is one number in the file of the level editor.");
      if (all.some((of) => isNumber(of) && !of.map.is_drawn_by_rules)) text.push("A mirrored tile is replaced as a whole.");
      const leftOut = Math.max(...maps.map((map) => map.brushes_left_out));
      if (leftOut > 0) text.push(`Its tilesets have ${leftOut} more tiles: paint one of them in the level editor, and it is here, too.`);
      if (maps.some((map) => map.is_drawn_by_rules)) text.push("LDtk draws the tiles of its rules when it next saves the level.");
    }
    return [...text, ...new Set(maps.flatMap((map) => map.unpainted ?? []))].join(" ");
  }

  /** Brushes that are the same thing in the game are beside each other. */
  private groups(all: Choice[]): HTMLElement[] {
    const groups = new Map<string, Choice[]>();
    for (const of of all) {
      const label = of.brush.picture ? of.brush.label : `${of.brush.label} ${of.brush.symbol}`;
      groups.set(label, [...(groups.get(label) ?? []), of]);
    }
    return [...groups].flatMap(([label, group]) => {
      const [first] = group;
      if (first && group.length === 1) return [this.choice(first)];
      return [h("div", { class: "alike" }, label, ...group.map((of) => this.choice(of, true)))];
    });
  }

  private choice(of: Choice | null, isBare = false): HTMLElement {
    const { label, symbol } = of?.brush ?? { label: "Look only", symbol: "" };
    // Characters say which one they are; the numbers of a level editor say nothing.
    const isCharacter = of !== null && [...symbol].length === 1 && of.map.kinds[of.brush.kind ?? -1]?.symbol === symbol;
    const input = h("input", {
      type: "radio",
      name: "tile",
      value: symbol,
      "aria-label": isBare ? `${label}, tile ${symbol}` : undefined,
      onchange: () => this.choose(of?.brush ?? null),
    });
    this.radios.set(input, of?.brush ?? null);
    const attributes = { class: isBare ? "tile bare" : "tile", title: isBare ? `${label}, tile ${symbol}` : undefined };
    return h("label", attributes, input, of && this.swatch(of), isCharacter ? h("code", {}, symbol) : null, isBare ? null : label);
  }

  private swatch(of: Choice): HTMLElement {
    const picture = this.picture(of);
    if (!picture || !of.brush.picture) {
      const swatch = h("span", { class: "swatch solid" });
      swatch.style.setProperty("--color", this.color(of));
      return swatch;
    }
    const [left, top, width, height] = of.brush.picture.part;
    const side = SIDE * devicePixelRatio;
    const canvas = h("canvas", { class: "swatch picture", width: side, height: side });
    const context = canvas.getContext("2d");
    const scale = side / Math.max(width, height);
    if (context) {
      context.imageSmoothingEnabled = false;
      context.drawImage(picture, left, top, width, height, (side - width * scale) / 2, (side - height * scale) / 2, width * scale, height * scale);
    }
    return canvas;
  }

  private color({ brush, map }: Choice): string {
    const kind = map.kinds[brush.kind ?? -1];
    return (kind && kind.tags.length > 0 && this.stage.colors?.kind(kind).paint.fill) || "transparent";
  }

  /** The picture that a brush is a part of, once it is loaded. */
  private picture({ brush, map }: Choice): HTMLImageElement | null {
    const path = brush.picture && map.art?.pictures[brush.picture.picture];
    return path ? this.stage.pictures.get(path) : null;
  }

  paint(space: number, cell: number): void {
    const { brush } = this;
    const map = this.game.scene?.spaces[space]?.map;
    // Another map may mean something else by the same symbol.
    if (brush === null || !map?.brushes.some((of) => isSame(of, brush))) return;
    this.queue.push([space, cell, brush]);
    if (!this.isPainting) void this.work();
  }

  private async work(): Promise<void> {
    this.isPainting = true;
    for (let next = this.queue.shift(); next; next = this.queue.shift()) {
      const [space, cell, { symbol }] = next;
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
