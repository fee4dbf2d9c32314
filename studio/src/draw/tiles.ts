// What does not move in a space, drawn into pieces of canvas that are kept: a wall is one shape with rounded corners and
// a lit edge.

import type { MapInfo, SpaceInfo, TileInfo } from "../protocol.ts";
import { type Colors, isAir, type Kind } from "./colors.ts";
import {
  type Context,
  drawBorder,
  drawCracks,
  drawOneWay,
  drawPicture,
  drawSensed,
  drawSlopeEdge,
  drawSolids,
  drawTile,
  drawWall,
  edgeOf,
  type Joins,
  type Rect,
  slopeLine,
  slopePath,
} from "./shapes.ts";

/** Side of a piece, pixels of the device. */
const PIECE = 512;
/** Maximum number of pieces that are kept. */
const MAX_PIECES = 64;

interface Piece {
  canvas: HTMLCanvasElement;
  used: number;
}

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
    this.map = space.map ?? {
      art: null,
      brushes: [],
      brushes_left_out: 0,
      cells: [],
      columns: 0,
      is_drawn_by_rules: false,
      kinds: [],
      rows: 0,
      tile: [16, 16],
      unpainted: null,
    };
    const { cells, kinds } = this.map;
    const counts = kinds.map(() => 0);
    for (const cell of cells) if (cell >= 0) counts[cell] = counts[cell]! + 1;
    const look = (kind: TileInfo, at: number): Kind | null =>
      isAir(kind, counts[at]!, cells.length) ? null : colors.kind(kind);
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
    // Edges of slopes reach into the cells below them: they come last.
    for (const isLast of [false, true]) {
      for (let row = fromRow; row <= toRow; row++) {
        for (let column = fromColumn; column <= toColumn; column++) {
          if (!this.isBroken[row * map.columns + column] && map.art) {
            if (isLast ? this.hasArt(column, row) : this.drawArt(context, column, row)) continue;
          }
          const kind = this.at(column, row);
          if (!kind) continue;
          if (isLast) this.drawEdge(context, kind, column, row);
          else this.drawCell(context, kind, column, row);
        }
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

  private info(column: number, row: number): TileInfo {
    return this.map.kinds[this.map.cells[row * this.map.columns + column]!]!;
  }

  /** The rectangle of a cell, from the upper left corner of the map. */
  private rect(column: number, row: number): Rect {
    const [width, height] = [this.map.tile[0] * this.scale, this.map.tile[1] * this.scale];
    const [x, y] = [Math.round(column * width), Math.round(row * height)];
    return { x, y, w: Math.round((column + 1) * width) - x, h: Math.round((row + 1) * height) - y };
  }

  /** Whether a cell shows something of the level editor. */
  private hasArt(column: number, row: number): boolean {
    const { art } = this.map;
    const stack = art?.stacks[art.cells[row * this.map.columns + column] ?? 0] ?? [];
    return stack.length > 0 && stack.every((index) => this.colors.pictureOf(art!.pictures[art!.tiles[index]!.picture]!));
  }

  /** Draws what a cell shows in the level editor; returns false if that is nothing, or is not loaded. */
  private drawArt(context: Context, column: number, row: number): boolean {
    const { art } = this.map;
    const stack = art?.stacks[art.cells[row * this.map.columns + column] ?? 0] ?? [];
    if (!art || stack.length === 0) return false;
    const rect = this.rect(column, row);
    for (const index of stack) {
      const tile = art.tiles[index]!;
      const picture = this.colors.pictureOf(art.pictures[tile.picture]!);
      if (!picture) return false;
      drawTile(context, picture, tile, rect, this.map.tile);
    }
    return true;
  }

  private drawCell(context: Context, kind: Kind, column: number, row: number): void {
    const info = this.info(column, row);
    const rect = this.rect(column, row);
    const { x, y, w, h } = rect;
    const picture = this.colors.picture(kind.paint);
    if (info.slope) {
      slopePath(context, slopeLine(rect, info.slope, this.map.tile), y + h);
      if (picture) {
        context.save();
        context.clip();
        drawPicture(context, picture, rect);
        context.restore();
      } else {
        context.fillStyle = kind.paint.fill;
        context.fill();
      }
      return;
    }
    if (picture) return drawPicture(context, picture, rect);
    const isAlone = info.breakable && kind.role === "solid";
    const joins: Joins = {
      left: !isAlone && this.joins(kind, column - 1, row),
      right: !isAlone && this.joins(kind, column + 1, row),
      above: !isAlone && this.joins(kind, column, row - 1),
      below: !isAlone && this.joins(kind, column, row + 1),
    };
    if (kind.role === "one_way") return drawOneWay(context, kind, rect, joins);
    if (kind.role === "sensed" || kind.role === "scenery") return drawSensed(context, kind, rect, joins);
    drawWall(context, kind, rect, joins, Math.min(w, h) * (info.breakable ? 0.16 : 0.24), edgeOf(w, h));
    if (info.breakable) drawCracks(context, kind, rect);
    // Another kind of wall beside it: a fine line between both, but a slope belongs to the ground that it is on.
    if (joins.above && this.isOther(kind, column, row - 1)) drawBorder(context, kind, { x, y, w, h: 1 });
    if (joins.left && this.isOther(kind, column - 1, row)) drawBorder(context, kind, { x, y, w: 1, h });
  }

  /** Whether a cell of the map is another kind of wall. */
  private isOther(kind: Kind, column: number, row: number): boolean {
    if (column < 0 || row < 0 || this.at(column, row) === kind) return false;
    return !this.info(column, row).slope;
  }

  /** The lit edge of a slope. */
  private drawEdge(context: Context, kind: Kind, column: number, row: number): void {
    const { slope } = this.info(column, row);
    if (!slope || this.colors.picture(kind.paint)) return;
    const rect = this.rect(column, row);
    const line = slopeLine(rect, slope, this.map.tile);
    const below = this.at(column, row + 1);
    context.save();
    // Where nothing solid is below it, the slope ends with its tile.
    if (below?.role !== "solid" && row + 1 < this.map.rows) {
      slopePath(context, line, rect.y + rect.h);
      context.clip();
    }
    drawSlopeEdge(context, kind, line, edgeOf(rect.w, rect.h));
    context.restore();
  }
}
