// The shapes of static things: walls, planks, tints and slopes, each in a rectangle of the canvas.

import type { SpaceInfo, TilePicture } from "../protocol.ts";
import type { Colors, Kind } from "./colors.ts";

/** What of a context is needed to draw into it. */
export type Context = CanvasRenderingContext2D;

/** A rectangle of the canvas: its upper left corner and its size. */
export interface Rect {
  x: number;
  y: number;
  w: number;
  h: number;
}

/** On which sides of a rectangle the same shape goes on. */
export interface Joins {
  left: boolean;
  right: boolean;
  above: boolean;
  below: boolean;
}

export const ALONE: Joins = { left: false, right: false, above: false, below: false };

/** The radii of a rectangle's corners, clockwise from the upper left one: round where nothing goes on. */
function corners({ left, right, above, below }: Joins, round: number): number[] {
  const corner = (a: boolean, b: boolean): number => (a || b ? 0 : round);
  return [corner(left, above), corner(right, above), corner(right, below), corner(left, below)];
}

/** The height of the lit edge of a wall. */
export const edgeOf = (w: number, h: number): number => Math.max(1, Math.round(Math.min(w, h) * 0.14));

/** Fills a rectangle with a picture. */
export function drawPicture(context: Context, picture: CanvasImageSource, { x, y, w, h }: Rect): void {
  context.imageSmoothingEnabled = false;
  context.drawImage(picture, x, y, w, h);
  context.imageSmoothingEnabled = true;
}

/** Draws a tile of a level editor: larger ones stand on the lower left corner of their cell. */
export function drawTile(
  context: Context,
  picture: CanvasImageSource,
  { part: [left, top, width, height], mirrored = 0 }: TilePicture,
  { x, y, w, h }: Rect,
  tile: [number, number],
): void {
  const [across, down] = width === tile[0] && height === tile[1] ? [w, h] : [(w * width) / tile[0], (h * height) / tile[1]];
  context.imageSmoothingEnabled = false;
  if (mirrored === 0) {
    context.drawImage(picture, left, top, width, height, x, y + h - down, across, down);
  } else {
    context.save();
    context.translate(x + across / 2, y + h - down / 2);
    // The diagonal is mirrored first, so it is the last transformation.
    context.scale(mirrored & 1 ? -1 : 1, mirrored & 2 ? -1 : 1);
    if (mirrored & 4) context.transform(0, 1, 1, 0, 0, 0);
    context.drawImage(picture, left, top, width, height, -across / 2, -down / 2, across, down);
    context.restore();
  }
  context.imageSmoothingEnabled = true;
}

/** A wall: round where it ends, lit from above. */
export function drawWall(context: Context, kind: Kind, rect: Rect, joins: Joins, round: number, edge: number): void {
  const { x, y, w, h } = rect;
  context.fillStyle = kind.paint.fill;
  context.beginPath();
  context.roundRect(x, y, w, h, corners(joins, round));
  context.fill();
  context.save();
  context.clip();
  if (!joins.below) {
    context.fillStyle = kind.paint.dark;
    context.globalAlpha = 0.55;
    context.fillRect(x, y + h - edge, w, edge);
  }
  context.globalAlpha = 1;
  if (!joins.above) {
    context.fillStyle = kind.paint.light;
    context.fillRect(x, y, w, edge);
  }
  context.restore();
}

/** A fine line between two kinds of walls. */
export function drawBorder(context: Context, kind: Kind, { x, y, w, h }: Rect): void {
  context.fillStyle = kind.paint.dark;
  context.globalAlpha = 0.6;
  context.fillRect(x, y, w, h);
  context.globalAlpha = 1;
}

export function drawCracks(context: Context, kind: Kind, { x, y, w, h }: Rect): void {
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
export function drawOneWay(context: Context, kind: Kind, { x, y, w, h }: Rect, { left, right, above }: Joins): void {
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
export function drawSensed(context: Context, kind: Kind, { x, y, w, h }: Rect, joins: Joins): void {
  const isScenery = kind.role === "scenery";
  context.fillStyle = kind.paint.fill;
  // A colour that the program says is shown as it is.
  context.globalAlpha = kind.paint.isLook ? 1 : isScenery ? 0.35 : 0.42;
  context.beginPath();
  context.roundRect(x, y, w, h, corners(joins, Math.min(w, h) * 0.26));
  context.fill();
  if (isScenery) {
    context.globalAlpha = 1;
    return;
  }
  context.save();
  context.clip();
  context.globalAlpha = 0.85;
  const rim = Math.max(1, Math.round(Math.min(w, h) * 0.07));
  if (kind.paint.isLook) context.fillStyle = kind.paint.dark;
  if (!joins.left) context.fillRect(x, y, rim, h);
  if (!joins.right) context.fillRect(x + w - rim, y, rim, h);
  if (!joins.above) context.fillRect(x, y, w, rim);
  if (!joins.below) context.fillRect(x, y + h - rim, w, rim);
  context.restore();
  context.globalAlpha = 1;
}

/** The upper side of a slope on the canvas, from left to right. */
export interface SlopeLine {
  x1: number;
  y1: number;
  x2: number;
  y2: number;
}

/** The upper side of a slope whose ends are given from the lower left corner of a tile, px of the world. */
export function slopeLine({ x, y, w, h }: Rect, [x1, y1, x2, y2]: [number, number, number, number], tile: [number, number]): SlopeLine {
  // In parts of the rectangle: the ends of neighbours meet, however the rectangles are rounded.
  return { x1: x + (w * x1) / tile[0], y1: y + h - (h * y1) / tile[1], x2: x + (w * x2) / tile[0], y2: y + h - (h * y2) / tile[1] };
}

/** The outline of what is below the line of a slope. */
export function slopePath(context: Context, line: SlopeLine, bottom: number): void {
  context.beginPath();
  context.moveTo(line.x1, bottom);
  context.lineTo(line.x1, line.y1);
  context.lineTo(line.x2, line.y2);
  context.lineTo(line.x2, bottom);
  context.closePath();
}

/** The lit edge of a slope, as high as that of level ground: it goes on into what is below the tile. */
export function drawSlopeEdge(context: Context, kind: Kind, line: SlopeLine, edge: number): void {
  context.fillStyle = kind.paint.light;
  context.beginPath();
  context.moveTo(line.x1, line.y1);
  context.lineTo(line.x2, line.y2);
  context.lineTo(line.x2, line.y2 + edge);
  context.lineTo(line.x1, line.y1 + edge);
  context.closePath();
  context.fill();
}

/** Draws the free-standing rectangles of a space. */
export function drawSolids(
  context: Context,
  space: SpaceInfo,
  colors: Colors,
  toX: (x: number) => number,
  toY: (y: number) => number,
  scale: number,
): void {
  for (const solid of space.solids) {
    const kind = colors.kind(solid);
    const [left, bottom, right, top] = solid.area;
    const [x, y] = [Math.round(toX(left)), Math.round(toY(top))];
    const rect = { x, y, w: Math.max(1, Math.round(toX(right)) - x), h: Math.max(1, Math.round(toY(bottom)) - y) };
    const picture = colors.picture(kind.paint);
    const small = Math.min(rect.w, rect.h);
    if (picture) {
      drawPicture(context, picture, rect);
    } else if (kind.role === "sensed" || kind.role === "scenery") {
      drawSensed(context, kind, rect, ALONE);
    } else if (kind.role === "one_way") {
      drawOneWay(context, kind, rect, ALONE);
    } else {
      const edge = Math.max(1, Math.min(2.2 * scale, small * 0.14));
      drawWall(context, kind, rect, ALONE, Math.min(4 * scale, small * 0.24), edge);
    }
  }
}
