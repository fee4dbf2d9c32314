// What is drawn over the bodies: ghosts, coming paths with their height and length, what a search covered, contacts.

import type { Game, Paths, Place } from "../game.ts";
import type { Camera } from "./camera.ts";
import type { Stage } from "./stage.ts";

/** Two places of a path that are further apart belong to a jump: no line is drawn between them, px. */
const JUMP = 48;
/** Side of a cell of the heat map, px. */
const CELL = 8;

/** As well, two nodes of a search: an input is held over several steps. */
const LEAP = 200;
/** Maximum number of lines of a tree that are drawn: the latest ones. */
const MAX_LINES = 2_000;

/** A node of a search: its space, its place, and the place of the node before it. */
export type TreeLine = [number, number, number, number, number];

/** Draws the parts of a path that are in a space. */
export function drawPath(
  context: CanvasRenderingContext2D,
  camera: Camera,
  space: number,
  path: Place[],
  from: number,
  to: number,
  dx: number,
  dy: number,
): void {
  context.beginPath();
  let before: Place | null = null;
  for (let at = from; at < to; at++) {
    const place = path[at]!;
    if (place[0] !== space) {
      before = null;
      continue;
    }
    const joins = before && Math.abs(place[1] - before[1]) < JUMP && Math.abs(place[2] - before[2]) < JUMP;
    if (joins) context.lineTo(camera.toX(place[1] + dx), camera.toY(place[2] + dy));
    else context.moveTo(camera.toX(place[1] + dx), camera.toY(place[2] + dy));
    before = place;
  }
  context.stroke();
}

/** The height and length of a jump: from its start to where it comes down to the same height, or where it ends. */
export interface Arc {
  path: Place[];
  /** Number of places up to the landing. */
  count: number;
  apex: number;
  height: number;
  length: number;
}

/** Finds the jump at the begin of a path; null if it does not rise. */
export function arcOf(path: Place[]): Arc | null {
  const first = path[0];
  if (!first) return null;
  let [apex, end] = [0, path.length];
  for (let at = 1; at < path.length; at++) {
    const [space, x, y] = path[at]!;
    const before = path[at - 1]!;
    if (space !== first[0] || Math.abs(x - before[1]) > JUMP || Math.abs(y - before[2]) > JUMP) {
      end = at;
      break;
    }
    if (y > path[apex]![2]) apex = at;
    // It has landed: below the start again, or at rest on something.
    const isAtRest = apex > 0 && at > apex + 2 && y === before[2] && before[2] === path[at - 2]![2];
    if ((apex > 0 && y <= first[2]) || isAtRest) {
      end = at + 1;
      break;
    }
  }
  const height = path[apex]![2] - first[2];
  if (height < 1) return null;
  const last = path[end - 1]!;
  return { path, count: end, apex, height, length: Math.abs(last[1] - first[1]) };
}

/** The overlays of a stage, and what they show. */
export class Overlays {
  /** The coming path of each player. */
  arcs: Paths = [];
  /** What a search found. */
  found: Paths = [];
  foundStart = 0;
  /** Where one wants to be, from a click into the level. */
  target: Place | null = null;
  /** Contacts of the players: slot and the side, as written. */
  contacts: { slot: number; text: string; side: string | null }[] = [];
  private heat: Map<number, number>[] = [];
  /** Lines of the tree in each space: from x and y, to x and y. */
  private tree: number[][] = [];
  /** Number of points that were added. */
  points = 0;

  constructor(
    private readonly game: Game,
    private readonly stage: Stage,
  ) {
    stage.underlays.push((context, camera, space) => {
      if (this.points > 0) this.drawHeat(context, camera, space);
    });
    stage.overlays.push((context, camera, space) => this.draw(context, camera, space));
    game.onScene.on(() => {
      this.clearHeat();
      this.found = [];
      this.arcs = [];
      this.target = null;
    });
  }

  private anchor(player: number): { x: number; y: number; bottom: number } {
    const slot = this.game.scene?.players[player]?.slot;
    return slot === undefined ? { x: 0, y: 0, bottom: 0 } : this.stage.anchor(slot);
  }

  clearHeat(): void {
    this.heat = (this.game.scene?.spaces ?? []).map(() => new Map<number, number>());
    this.tree = this.heat.map(() => []);
    this.points = 0;
  }

  /** Adds nodes of a search: their places, and those of the nodes before them. */
  addHeat(points: TreeLine[]): void {
    const { x: dx, y: dy } = this.anchor(0);
    for (const [space, left, bottom, fromX, fromY] of points) {
      const [x, y] = [left + dx, bottom + dy];
      const lines = this.tree[space];
      const isLine = Math.abs(left - fromX) < LEAP && Math.abs(bottom - fromY) < LEAP && (left !== fromX || bottom !== fromY);
      if (lines && isLine) {
        lines.push(fromX + dx, fromY + dy, x, y);
        if (lines.length > 4 * MAX_LINES) lines.splice(0, 4 * (lines.length / 4 - MAX_LINES));
      }
      const key = Math.floor(y / CELL) * 65536 + Math.floor(x / CELL);
      const map = this.heat[space];
      if (map) map.set(key, (map.get(key) ?? 0) + 1);
    }
    this.points += points.length;
  }

  /** Adds cells of 8 px that were counted elsewhere: space, column, row, count. */
  addCells(cells: [number, number, number, number][]): void {
    for (const [space, column, row, count] of cells) {
      const [map, key] = [this.heat[space], row * 65536 + column];
      if (map) map.set(key, (map.get(key) ?? 0) + count);
      this.points += count;
    }
  }

  private draw(context: CanvasRenderingContext2D, camera: Camera, space: number): void {
    const { colors, ratio, shows } = this.stage;
    if (!colors) return;
    const { backdrop } = colors;
    context.lineJoin = "round";
    context.lineCap = "round";
    this.drawGhost(context, camera, space, this.game.ghost, this.game.ghostStart, backdrop.ghost);
    this.drawGhost(context, camera, space, this.found, this.foundStart, backdrop.good);
    if (shows.arc) this.arcs.forEach((path, player) => this.drawArc(context, camera, space, path, player));
    if (this.target && this.target[0] === space) {
      const [x, y] = [camera.toX(this.target[1]), camera.toY(this.target[2])];
      context.strokeStyle = backdrop.good;
      context.lineWidth = 2.5 * ratio;
      context.beginPath();
      context.arc(x, y, 10 * ratio, 0, 2 * Math.PI);
      context.moveTo(x - 15 * ratio, y);
      context.lineTo(x + 15 * ratio, y);
      context.moveTo(x, y - 15 * ratio);
      context.lineTo(x, y + 15 * ratio);
      context.stroke();
    }
    if (shows.contacts) {
      this.drawOneWays(context, camera, space);
      this.drawContacts(context, camera, space);
    }
  }

  /** A path with the place on it at the frame that is shown. */
  private drawGhost(context: CanvasRenderingContext2D, camera: Camera, space: number, paths: Paths, start: number, color: string): void {
    const { ratio } = this.stage;
    const at = (this.game.frame?.at ?? 0) - start;
    for (const [player, path] of paths.entries()) {
      if (path.length < 2) continue;
      const { x, y } = this.anchor(player);
      context.strokeStyle = color;
      context.globalAlpha = 0.65;
      context.lineWidth = 2.5 * ratio;
      context.setLineDash([1, 6 * ratio]);
      drawPath(context, camera, space, path, 0, path.length, x, y);
      context.setLineDash([]);
      context.globalAlpha = 1;
      const place = path[Math.max(0, Math.min(path.length - 1, at))]!;
      if (place[0] !== space || at < 0) continue;
      context.fillStyle = color;
      context.globalAlpha = 0.85;
      context.beginPath();
      context.arc(camera.toX(place[1] + x), camera.toY(place[2] + y), 5 * ratio, 0, 2 * Math.PI);
      context.fill();
      context.globalAlpha = 1;
    }
  }

  private drawArc(context: CanvasRenderingContext2D, camera: Camera, space: number, path: Place[], player: number): void {
    const { colors, ratio } = this.stage;
    const color = colors!.backdrop.arc;
    const arc = arcOf(path);
    const { x: dx, bottom: dy } = this.anchor(player);
    context.strokeStyle = color;
    context.lineWidth = 2.5 * ratio;
    context.globalAlpha = 0.9;
    drawPath(context, camera, space, path, 0, arc ? arc.count : Math.min(path.length, 45), dx, dy);
    context.globalAlpha = 1;
    if (!arc || path[0]![0] !== space) return;
    const [x, y] = [camera.toX(path[arc.apex]![1] + dx), camera.toY(path[arc.apex]![2] + dy)];
    const ground = camera.toY(path[0]![2] + dy);
    const [left, right] = [camera.toX(path[0]![1] + dx), camera.toX(path[arc.count - 1]![1] + dx)];
    context.lineWidth = ratio;
    context.setLineDash([3 * ratio, 3 * ratio]);
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x, ground);
    context.moveTo(left, ground);
    context.lineTo(right, ground);
    context.stroke();
    context.setLineDash([]);
    context.fillStyle = color;
    context.beginPath();
    context.arc(x, y, 3.5 * ratio, 0, 2 * Math.PI);
    context.arc(right, camera.toY(path[arc.count - 1]![2] + dy), 3.5 * ratio, 0, 2 * Math.PI);
    context.fill();
    this.stage.label(`↑ ${Math.round(arc.height * 10) / 10} px`, x, y, color);
    const isLong = Math.abs(right - left) > 40 * ratio;
    if (isLong) this.stage.label(`↔ ${Math.round(arc.length * 10) / 10} px`, (left + right) / 2, ground + 24 * ratio, color);
  }

  private drawHeat(context: CanvasRenderingContext2D, camera: Camera, space: number): void {
    const map = this.heat[space];
    if (!map) return;
    const size = CELL * camera.scale;
    const { width, height } = context.canvas;
    context.fillStyle = this.stage.colors!.backdrop.ghost;
    for (const [key, count] of map) {
      const row = Math.floor(key / 65536 + 0.5);
      const column = key - row * 65536;
      const [x, y] = [Math.round(camera.toX(column * CELL)), Math.round(camera.toY((row + 1) * CELL))];
      if (x > width || y > height || x < -size || y < -size) continue;
      const [right, bottom] = [Math.round(camera.toX((column + 1) * CELL)), Math.round(camera.toY(row * CELL))];
      context.globalAlpha = Math.min(0.62, 0.2 + 0.09 * Math.log2(1 + count));
      context.fillRect(x, y, right - x, bottom - y);
    }
    context.globalAlpha = 1;
    this.drawTree(context, camera, space);
    this.drawUnvisited(context, camera, space, map);
  }

  /** The tree of the search: how each place was reached. */
  private drawTree(context: CanvasRenderingContext2D, camera: Camera, space: number): void {
    const lines = this.tree[space] ?? [];
    context.strokeStyle = this.stage.colors!.backdrop.ghost;
    // Fewer lines are stronger; many are a veil, under which the level and a path that is found stay visible.
    context.globalAlpha = Math.max(0.16, Math.min(0.6, 60 / Math.max(1, lines.length / 4)));
    context.lineWidth = this.stage.ratio;
    context.beginPath();
    for (let at = 0; at < lines.length; at += 4) {
      context.moveTo(camera.toX(lines[at]!), camera.toY(lines[at + 1]!));
      context.lineTo(camera.toX(lines[at + 2]!), camera.toY(lines[at + 3]!));
    }
    context.stroke();
    context.globalAlpha = 1;
  }

  /** Tops of solid tiles above which no place of the search lies; the steps between two places are not looked at. */
  private drawUnvisited(context: CanvasRenderingContext2D, camera: Camera, space: number, heat: Map<number, number>): void {
    const map = this.game.scene?.spaces[space]?.map;
    if (!map) return;
    const { bad } = this.stage.colors!.backdrop;
    const isSolid = (column: number, row: number): boolean => {
      const kind = map.kinds[map.cells[row * map.columns + column] ?? -1];
      return kind !== undefined && (kind.role === "solid" || kind.role === "one_way");
    };
    context.fillStyle = bad;
    context.globalAlpha = 0.8;
    const [width, height] = map.tile;
    for (let row = 1; row < map.rows; row++) {
      for (let column = 0; column < map.columns; column++) {
        if (!isSolid(column, row) || isSolid(column, row - 1)) continue;
        const x = camera.toX(column * width);
        const y = camera.toY((map.rows - row) * height);
        if (x < -width * camera.scale || x > context.canvas.width || y < 0 || y > context.canvas.height) continue;
        if (!visited(heat, column * width, (map.rows - row) * height, width, height)) {
          context.fillRect(x, y, width * camera.scale, Math.max(2, 2 * this.stage.ratio));
        }
      }
    }
    context.globalAlpha = 1;
  }

  /** Marks the side from which one-way tiles and rectangles are solid. */
  private drawOneWays(context: CanvasRenderingContext2D, camera: Camera, space: number): void {
    const info = this.game.scene?.spaces[space];
    const { colors, ratio } = this.stage;
    if (!info || !colors) return;
    const size = 4 * ratio;
    context.strokeStyle = colors.backdrop.good;
    context.lineWidth = 2 * ratio;
    context.beginPath();
    const mark = (worldX: number, worldY: number): void => {
      const [x, y] = [camera.toX(worldX), camera.toY(worldY)];
      if (x < 0 || y < 0 || x > context.canvas.width || y > context.canvas.height) return;
      context.moveTo(x - size, y - 2 * size);
      context.lineTo(x, y - size);
      context.lineTo(x + size, y - 2 * size);
    };
    for (const solid of info.solids) {
      if (solid.role === "one_way") mark((solid.area[0] + solid.area[2]) / 2, solid.area[3]);
    }
    const { map } = info;
    for (let cell = 0; map && cell < map.cells.length; cell++) {
      if (map.kinds[map.cells[cell]!]?.role !== "one_way") continue;
      const [column, row] = [cell % map.columns, Math.floor(cell / map.columns)];
      mark((column + 0.5) * map.tile[0], (map.rows - row) * map.tile[1]);
    }
    context.stroke();
  }

  private drawContacts(context: CanvasRenderingContext2D, camera: Camera, space: number): void {
    const { game, stage } = this;
    const bodies = game.frame!.bodies;
    // One above the other, over the name if it is shown.
    const seen = new Map<number, number>();
    for (const { slot, text, side } of this.contacts) {
      const at = game.now.start(slot);
      if (at < 0 || bodies[at + 1] !== space) continue;
      const of = bodies.slice(at + 6, at + 10);
      if (of.length < 4) continue;
      const [x, y] = [bodies[at + 2]!, bodies[at + 3]!];
      const [left, bottom, right, top] = [x + of[0]!, y + of[1]!, x + of[2]!, y + of[3]!];
      context.strokeStyle = stage.colors!.backdrop.good;
      context.lineWidth = 4 * stage.ratio;
      context.beginPath();
      const line = { left: [left, bottom, left, top], right: [right, bottom, right, top], above: [left, top, right, top], below: [left, bottom, right, bottom] }[side ?? "below"] ?? [];
      if (side) {
        context.moveTo(camera.toX(line[0]!), camera.toY(line[1]!));
        context.lineTo(camera.toX(line[2]!), camera.toY(line[3]!));
        context.stroke();
      }
      const hasName = stage.shows.names || slot === stage.selected || slot === stage.hovered;
      const order = seen.get(slot) ?? (hasName ? 1 : 0);
      seen.set(slot, order + 1);
      stage.label(text, camera.toX((left + right) / 2), camera.toY(top) - order * 15 * stage.ratio);
    }
  }
}

function visited(heat: Map<number, number>, x: number, y: number, width: number, height: number): boolean {
  for (let row = Math.floor(y / CELL) - 1; row * CELL < y + height; row++) {
    for (let column = Math.floor(x / CELL) - 1; column * CELL < x + width; column++) {
      if (heat.has(row * 65536 + column)) return true;
    }
  }
  return false;
}
