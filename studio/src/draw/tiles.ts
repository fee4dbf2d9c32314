// What does not move in a space, drawn into pieces of canvas that are kept: a wall is one shape with rounded corners and
// a lit edge.

import type { MapInfo, SpaceInfo, TileInfo } from "../protocol.ts";
import { type Colors, isAir, type Kind } from "./colors.ts";

/** Side of a piece, pixels of the device. */
const PIECE = 512;
/** Maximum number of pieces that are kept. */
const MAX_PIECES = 64;

interface Piece {
  canvas: HTMLCanvasElement;
  used: number;
}

/** What of a context is needed to draw into it. */
export type Context = CanvasRenderingContext2D;

/** Draws what does not move in a space: the sky, tiles, free-standing rectangles. */
export class Scenery {
  private readonly pieces = new Map<number, Piece>();
  private scale = 0;
  private clock = 0;
  private readonly map: MapInfo;
  /** The kinds of the cells as they look; null for air. */
  private readonly kinds: (Kind | null)[];
  private readonly isBroken: Uint8Array;
  private broken: number[] = [];

  constructor(
    private readonly space: SpaceInfo,
    private readonly colors: Colors,
  ) {
    this.map = space.map ?? { cells: [], columns: 0, is_painted: false, kinds: [], rows: 0, tile: [16, 16] };
    const { cells, kinds } = this.map;
    const counts = kinds.map(() => 0);
    for (const cell of cells) if (cell >= 0) counts[cell] = counts[cell]! + 1;
    const look = (kind: TileInfo, at: number): Kind | null =>
      isAir(kind, counts[at]!, cells.length) ? null : colors.kind(kind.tags, kind.role);
    this.kinds = kinds.map(look);
    this.isBroken = new Uint8Array(cells.length);
  }

  /** Sets which cells are broken; pieces around changed ones are drawn again. */
  setBroken(cells: number[]): void {
    if (cells.length === this.broken.length && cells.every((cell, at) => cell === this.broken[at])) return;
    const changed = new Set(this.broken);
    for (const cell of cells) if (!changed.delete(cell)) changed.add(cell);
    for (const cell of this.broken) this.isBroken[cell] = 0;
    for (const cell of cells) this.isBroken[cell] = 1;
    this.broken = [...cells];
    for (const cell of changed) this.forget(cell);
  }

  private forget(cell: number): void {
    const [columns, width, height] = [this.map.columns, this.map.tile[0] * this.scale, this.map.tile[1] * this.scale];
    const [column, row] = [cell % columns, Math.floor(cell / columns)];
    const [left, top] = this.origin();
    for (const dx of [-1, 2]) {
      for (const dy of [-1, 2]) {
        const x = Math.floor((left + (column + dx) * width) / PIECE);
        const y = Math.floor((top + (row + dy) * height) / PIECE);
        this.pieces.delete(y * 4096 + x);
      }
    }
  }

  /** The upper left corner of the map in the picture of the space, pixels. */
  private origin(): [number, number] {
    const [left, , , top] = this.space.extent;
    const { rows, tile } = this.map;
    return [Math.round(-left * this.scale), Math.round((top - rows * tile[1]) * this.scale)];
  }

  /** Draws what is in view. (x, y) is where the upper left corner of the space is in the view. */
  draw(context: Context, x: number, y: number, scale: number, width: number, height: number): void {
    if (scale !== this.scale) {
      this.pieces.clear();
      this.scale = scale;
    }
    this.clock++;
    const [left, bottom, right, top] = this.space.extent;
    const [across, down] = [Math.ceil((right - left) * scale), Math.ceil((top - bottom) * scale)];
    const fromX = Math.max(0, Math.floor(-x / PIECE));
    const fromY = Math.max(0, Math.floor(-y / PIECE));
    const toX = Math.min(Math.ceil(across / PIECE), Math.ceil((width - x) / PIECE));
    const toY = Math.min(Math.ceil(down / PIECE), Math.ceil((height - y) / PIECE));
    for (let row = fromY; row < toY; row++) {
      for (let column = fromX; column < toX; column++) {
        // Of the last pieces, only what belongs to the space.
        const w = Math.min(PIECE, across - column * PIECE);
        const h = Math.min(PIECE, down - row * PIECE);
        const [atX, atY] = [x + column * PIECE, y + row * PIECE];
        context.drawImage(this.piece(column, row, down), 0, 0, w, h, atX, atY, w, h);
      }
    }
  }

  private piece(column: number, row: number, down: number): HTMLCanvasElement {
    const key = row * 4096 + column;
    let piece = this.pieces.get(key);
    if (!piece) {
      piece = { canvas: document.createElement("canvas"), used: 0 };
      piece.canvas.width = PIECE;
      piece.canvas.height = PIECE;
      // Without transparency, it is copied faster.
      const context = piece.canvas.getContext("2d", { alpha: false });
      if (context) this.drawPiece(context, column * PIECE, row * PIECE, down);
      if (this.pieces.size >= MAX_PIECES) this.dropOldest();
      this.pieces.set(key, piece);
    }
    piece.used = this.clock;
    return piece.canvas;
  }

  private dropOldest(): void {
    let oldest = -1;
    let used = Infinity;
    for (const [key, piece] of this.pieces) if (piece.used < used) [oldest, used] = [key, piece.used];
    this.pieces.delete(oldest);
  }

  private drawPiece(context: Context, left: number, top: number, down: number): void {
    const { map, scale, space } = this;
    const [sky, haze] = this.colors.backdrop.sky;
    const shade = context.createLinearGradient(0, -top, 0, down - top);
    shade.addColorStop(0, sky);
    shade.addColorStop(1, haze);
    context.fillStyle = shade;
    context.fillRect(0, 0, PIECE, PIECE);
    const [width, height] = [map.tile[0] * scale, map.tile[1] * scale];
    const [mapX, mapY] = this.origin();
    context.save();
    context.translate(mapX - left, mapY - top);
    const fromColumn = Math.max(0, Math.floor((left - mapX) / width) - 1);
    const toColumn = Math.min(map.columns - 1, Math.ceil((left - mapX + PIECE) / width));
    const fromRow = Math.max(0, Math.floor((top - mapY) / height) - 1);
    const toRow = Math.min(map.rows - 1, Math.ceil((top - mapY + PIECE) / height));
    for (let row = fromRow; row <= toRow; row++) {
      for (let column = fromColumn; column <= toColumn; column++) {
        const kind = this.at(column, row);
        if (kind) this.drawCell(context, kind, column, row);
      }
    }
    context.restore();
    const toX = (x: number): number => (x - space.extent[0]) * scale - left;
    const toY = (y: number): number => (space.extent[3] - y) * scale - top;
    drawSolids(context, space, this.colors, toX, toY, scale);
  }

  /** How a cell looks; null for air, and for what is broken. */
  private at(column: number, row: number): Kind | null {
    const { map } = this;
    if (column < 0 || row < 0 || column >= map.columns || row >= map.rows) return null;
    const cell = row * map.columns + column;
    return this.isBroken[cell] ? null : (this.kinds[map.cells[cell]!] ?? null);
  }

  /** Whether the neighbour of a cell goes on with the same shape; beyond the map everything goes on. */
  private joins(kind: Kind, column: number, row: number): boolean {
    const { map } = this;
    if (column < 0 || row < 0 || column >= map.columns || row >= map.rows) return kind.role === "solid";
    const other = this.at(column, row);
    // What breaks tile by tile is drawn tile by tile.
    if (kind.role === "solid" && map.kinds[map.cells[row * map.columns + column]!]?.breakable) return false;
    return other === kind || (kind.role === "solid" && other?.role === "solid");
  }

  private drawCell(context: Context, kind: Kind, column: number, row: number): void {
    const { map, scale } = this;
    const [width, height] = [map.tile[0] * scale, map.tile[1] * scale];
    const [x, y] = [Math.round(column * width), Math.round(row * height)];
    const [w, h] = [Math.round((column + 1) * width) - x, Math.round((row + 1) * height) - y];
    const info = map.kinds[map.cells[row * map.columns + column]!]!;
    if (info.slope) return drawSlope(context, kind, info.slope, x, y, w, h, scale);
    const isAlone = info.breakable && kind.role === "solid";
    const left = !isAlone && this.joins(kind, column - 1, row);
    const right = !isAlone && this.joins(kind, column + 1, row);
    const above = !isAlone && this.joins(kind, column, row - 1);
    const below = !isAlone && this.joins(kind, column, row + 1);
    if (kind.role === "one_way") return drawOneWay(context, kind, x, y, w, h, left, right, above);
    if (kind.role === "sensed" || kind.role === "scenery") {
      return drawSensed(context, kind, x, y, w, h, [left, right, above, below]);
    }
    const round = Math.min(w, h) * (info.breakable ? 0.16 : 0.24);
    const corner = (a: boolean, b: boolean): number => (a || b ? 0 : round);
    context.fillStyle = kind.paint.fill;
    context.beginPath();
    context.roundRect(x, y, w, h, [corner(left, above), corner(right, above), corner(right, below), corner(left, below)]);
    context.fill();
    const edge = Math.max(1, Math.round(Math.min(w, h) * 0.14));
    context.save();
    context.clip();
    if (!below) {
      context.fillStyle = kind.paint.dark;
      context.globalAlpha = 0.55;
      context.fillRect(x, y + h - edge, w, edge);
    }
    context.globalAlpha = 1;
    if (!above) {
      context.fillStyle = kind.paint.light;
      context.fillRect(x, y, w, edge);
    }
    if (info.breakable) drawCracks(context, kind, x, y, w, h);
    context.restore();
    // Another kind of wall beside it: a fine line between both.
    if (above && this.at(column, row - 1) !== kind && row > 0) line(context, kind, x, y, w, 1);
    if (left && this.at(column - 1, row) !== kind && column > 0) line(context, kind, x, y, 1, h);
  }
}

function line(context: Context, kind: Kind, x: number, y: number, w: number, h: number): void {
  context.fillStyle = kind.paint.dark;
  context.globalAlpha = 0.6;
  context.fillRect(x, y, w, h);
  context.globalAlpha = 1;
}

function drawCracks(context: Context, kind: Kind, x: number, y: number, w: number, h: number): void {
  context.strokeStyle = kind.paint.dark;
  context.globalAlpha = 0.6;
  context.lineWidth = Math.max(1, w / 18);
  context.beginPath();
  context.moveTo(x + w * 0.18, y + h * 0.42);
  context.lineTo(x + w * 0.45, y + h * 0.55);
  context.lineTo(x + w * 0.6, y + h * 0.35);
  context.moveTo(x + w * 0.45, y + h * 0.55);
  context.lineTo(x + w * 0.52, y + h * 0.82);
  context.stroke();
  context.globalAlpha = 1;
}

/** Solid from above only: a plank with light beneath it. */
function drawOneWay(
  context: Context,
  kind: Kind,
  x: number,
  y: number,
  w: number,
  h: number,
  left: boolean,
  right: boolean,
  above: boolean,
): void {
  const plank = Math.max(2, Math.round(h * 0.3));
  const round = plank * 0.5;
  context.fillStyle = kind.paint.fill;
  context.globalAlpha = 0.22;
  context.fillRect(x, y + (above ? 0 : plank * 0.5), w, h - (above ? 0 : plank * 0.5));
  context.globalAlpha = 1;
  if (above) return;
  context.beginPath();
  context.roundRect(x, y, w, plank, [left ? 0 : round, right ? 0 : round, right ? 0 : round, left ? 0 : round]);
  context.fill();
  context.fillStyle = kind.paint.light;
  context.fillRect(x + (left ? 0 : round), y, w - (left ? 0 : round) - (right ? 0 : round), Math.max(1, plank * 0.3));
}

/** What does not hold anything back: a tint with a rim where it ends. */
function drawSensed(
  context: Context,
  kind: Kind,
  x: number,
  y: number,
  w: number,
  h: number,
  [left, right, above, below]: [boolean, boolean, boolean, boolean],
): void {
  const isScenery = kind.role === "scenery";
  const round = Math.min(w, h) * 0.26;
  const corner = (a: boolean, b: boolean): number => (a || b ? 0 : round);
  context.fillStyle = kind.paint.fill;
  context.globalAlpha = isScenery ? 0.35 : 0.42;
  context.beginPath();
  context.roundRect(x, y, w, h, [corner(left, above), corner(right, above), corner(right, below), corner(left, below)]);
  context.fill();
  if (isScenery) {
    context.globalAlpha = 1;
    return;
  }
  context.save();
  context.clip();
  context.globalAlpha = 0.85;
  const rim = Math.max(1, Math.round(Math.min(w, h) * 0.07));
  if (!left) context.fillRect(x, y, rim, h);
  if (!right) context.fillRect(x + w - rim, y, rim, h);
  if (!above) context.fillRect(x, y, w, rim);
  if (!below) context.fillRect(x, y + h - rim, w, rim);
  context.restore();
  context.globalAlpha = 1;
}

/** A tile that is solid below a line. */
function drawSlope(
  context: Context,
  kind: Kind,
  [x1, y1, x2, y2]: [number, number, number, number],
  x: number,
  y: number,
  w: number,
  h: number,
  scale: number,
): void {
  const [leftX, rightX] = [x + x1 * scale, x + Math.min(w, x2 * scale)];
  const [leftY, rightY] = [y + h - y1 * scale, y + h - y2 * scale];
  context.fillStyle = kind.paint.fill;
  context.beginPath();
  context.moveTo(leftX, y + h);
  context.lineTo(leftX, leftY);
  context.lineTo(rightX, rightY);
  context.lineTo(rightX, y + h);
  context.closePath();
  context.fill();
  // The lit edge is as high as that of level ground.
  const edge = Math.max(1, Math.round(Math.min(w, h) * 0.14));
  context.fillStyle = kind.paint.light;
  context.beginPath();
  context.moveTo(leftX, leftY);
  context.lineTo(rightX, rightY);
  context.lineTo(rightX, Math.min(y + h, rightY + edge));
  context.lineTo(leftX, Math.min(y + h, leftY + edge));
  context.closePath();
  context.fill();
}

/** Draws the free-standing rectangles of a space. */
function drawSolids(
  context: Context,
  space: SpaceInfo,
  colors: Colors,
  toX: (x: number) => number,
  toY: (y: number) => number,
  scale: number,
): void {
  for (const solid of space.solids) {
    const kind = colors.kind(solid.tags, solid.role);
    const [left, bottom, right, top] = solid.area;
    const [x, y] = [Math.round(toX(left)), Math.round(toY(top))];
    const [w, h] = [Math.max(1, Math.round(toX(right)) - x), Math.max(1, Math.round(toY(bottom)) - y)];
    const isFlat = kind.role === "sensed" || kind.role === "scenery";
    if (isFlat) {
      drawSensed(context, kind, x, y, w, h, [false, false, false, false]);
    } else if (kind.role === "one_way") {
      drawOneWay(context, kind, x, y, w, h, false, false, false);
    } else {
      const round = Math.min(4 * scale, Math.min(w, h) * 0.24);
      const edge = Math.max(1, Math.min(2.2 * scale, Math.min(w, h) * 0.14));
      context.fillStyle = kind.paint.fill;
      context.beginPath();
      context.roundRect(x, y, w, h, round);
      context.fill();
      context.save();
      context.clip();
      context.fillStyle = kind.paint.light;
      context.fillRect(x, y, w, edge);
      context.restore();
    }
  }
}
