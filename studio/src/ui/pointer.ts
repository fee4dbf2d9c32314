// The mouse and fingers on the stage: looks at instances, picks places, paints tiles, drags and zooms the view.

import type { Overlays } from "../draw/overlays.ts";
import type { Stage } from "../draw/stage.ts";
import type { Game, Place } from "../game.ts";

/** How far the pointer may move in a click, CSS pixels. */
const CLICK = 5;

/** Paints tiles into the text. */
export interface Painter {
  /** The symbol that is painted; null if the mouse does not paint. */
  symbol: string | null;
  paint(space: number, cell: number): void;
}

/** What the pointer does. */
export interface PointerActions {
  pick(slot: number | null): void;
  place(place: Place): void;
  wantsPlace(): boolean;
  paint: Painter;
  leaveMap(): void;
}

export class Pointer {
  private down: { x: number; y: number; dragX: number; dragY: number; moved: boolean } | null = null;
  private cell = -1;

  constructor(
    private readonly game: Game,
    private readonly stage: Stage,
    private readonly overlays: Overlays,
    private readonly actions: PointerActions,
  ) {
    const { canvas, camera } = stage;
    canvas.addEventListener("pointerdown", (event) => this.press(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.release(event));
    canvas.addEventListener("pointercancel", () => (this.down = null));
    canvas.addEventListener("pointerleave", () => (stage.hovered = null));
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        camera.zoom = Math.max(0.4, Math.min(6, camera.zoom * Math.exp(-event.deltaY * 0.0015)));
      },
      { passive: false },
    );
    canvas.addEventListener("dblclick", () => camera.recenter());
    canvas.addEventListener("keydown", (event) => {
      if (event.key === "+" || event.key === "=") camera.zoom = Math.min(6, camera.zoom * 1.25);
      else if (event.key === "-") camera.zoom = Math.max(0.4, camera.zoom / 1.25);
      else if (event.key === "0") camera.recenter();
    });
  }

  /** The place under the pointer. */
  private place(event: PointerEvent): Place {
    const { camera, ratio } = this.stage;
    return [camera.space, camera.worldX(event.offsetX * ratio), camera.worldY(event.offsetY * ratio)];
  }

  private press(event: PointerEvent): void {
    const { camera, canvas } = this.stage;
    canvas.setPointerCapture(event.pointerId);
    this.down = { x: event.offsetX, y: event.offsetY, dragX: camera.dragX, dragY: camera.dragY, moved: false };
    this.cell = -1;
    if (this.actions.paint.symbol !== null && event.button === 0) this.paint(event);
  }

  private move(event: PointerEvent): void {
    const { camera, canvas, ratio } = this.stage;
    const { down } = this;
    if (!down) {
      const slot = this.stage.slotAt(event.offsetX, event.offsetY);
      this.stage.hovered = slot;
      const isPicking = this.actions.paint.symbol !== null || this.actions.wantsPlace();
      canvas.style.cursor = isPicking ? "crosshair" : slot === null ? "default" : "pointer";
      return;
    }
    if (this.actions.paint.symbol !== null) return this.paint(event);
    const [dx, dy] = [event.offsetX - down.x, event.offsetY - down.y];
    down.moved ||= Math.hypot(dx, dy) > CLICK;
    if (!down.moved || this.stage.isOverview) return;
    camera.dragX = down.dragX - (dx * ratio) / camera.scale;
    camera.dragY = down.dragY + (dy * ratio) / camera.scale;
  }

  private release(event: PointerEvent): void {
    const { down } = this;
    this.down = null;
    if (!down || down.moved || this.actions.paint.symbol !== null) return;
    if (this.stage.isOverview) {
      this.actions.leaveMap();
    } else if (this.actions.wantsPlace()) {
      this.overlays.target = this.place(event);
      this.actions.place(this.overlays.target);
    } else {
      this.actions.pick(this.stage.slotAt(event.offsetX, event.offsetY));
    }
  }

  private paint(event: PointerEvent): void {
    const [space, x, y] = this.place(event);
    const map = this.game.scene?.spaces[space]?.map;
    if (!map || this.stage.isOverview) return;
    const [column, row] = [Math.floor(x / map.tile[0]), map.rows - 1 - Math.floor(y / map.tile[1])];
    if (column < 0 || row < 0 || column >= map.columns || row >= map.rows) return;
    const cell = row * map.columns + column;
    if (cell === this.cell) return;
    this.cell = cell;
    this.actions.paint.paint(space, cell);
  }
}
