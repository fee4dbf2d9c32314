// The map of all spaces: each as a small picture, placed by where its links lead, with arrows for the links.

import { HEAD, PART } from "../bodies.ts";
import type { Game } from "../game.ts";
import type { Scene, SpaceInfo } from "../protocol.ts";
import type { Colors } from "./colors.ts";
import { Scenery } from "./tiles.ts";

/** Longest side of the picture of a space, pixels. */
const PICTURE = 1400;
/** Space between rooms, in parts of the mean room. */
const GAP = 0.22;

interface Room {
  column: number;
  row: number;
  /** Where it is on the map, in the units of the world. */
  left: number;
  top: number;
  width: number;
  height: number;
  picture: HTMLCanvasElement | null;
}

export class Overview {
  private rooms: Room[] = [];
  private width = 1;
  private height = 1;
  private scale = 1;
  private offsetX = 0;
  private offsetY = 0;
  private scene: Scene | null = null;
  private colors: Colors | null = null;

  /** Places the rooms. Their pictures are drawn when they are first needed. */
  layout(scene: Scene, colors: Colors): void {
    this.scene = scene;
    this.colors = colors;
    const places = cells(scene);
    const sizes = scene.spaces.map((space) => [space.extent[2] - space.extent[0], space.extent[3] - space.extent[1]]);
    const columns = Math.max(...places.map((place) => place[0])) + 1;
    const rows = Math.max(...places.map((place) => place[1])) + 1;
    const widths = Array.from({ length: columns }, () => 0);
    const heights = Array.from({ length: rows }, () => 0);
    places.forEach(([column, row], at) => {
      widths[column] = Math.max(widths[column]!, sizes[at]![0]!);
      heights[row] = Math.max(heights[row]!, sizes[at]![1]!);
    });
    const mean = (all: number[]): number => all.reduce((sum, one) => sum + one, 0) / Math.max(1, all.length);
    const gap = GAP * Math.min(mean(widths), mean(heights));
    const before = (all: number[], count: number): number => all.slice(0, count).reduce((sum, one) => sum + one + gap, 0);
    this.rooms = places.map(([column, row], at) => {
      const [width, height] = [sizes[at]![0]!, sizes[at]![1]!];
      const left = before(widths, column) + (widths[column]! - width) / 2;
      const top = before(heights, row) + (heights[row]! - height) / 2;
      return { column, row, left, top, width, height, picture: null };
    });
    this.width = before(widths, columns) - gap;
    this.height = before(heights, rows) - gap;
  }

  draw(context: CanvasRenderingContext2D, game: Game, colors: Colors, ratio: number): void {
    const scene = this.scene;
    if (!scene) return;
    const { width, height } = context.canvas;
    const pad = 36 * ratio;
    this.scale = Math.min((width - 2 * pad) / this.width, (height - 2.6 * pad) / this.height, 6 * ratio);
    this.offsetX = (width - this.width * this.scale) / 2;
    this.offsetY = (height - this.height * this.scale) / 2 + pad * 0.3;
    context.fillStyle = colors.backdrop.outside;
    context.fillRect(0, 0, width, height);
    const current = this.spaceOfPlayer(game);
    this.rooms.forEach((room, at) => this.drawRoom(context, room, at, at === current, ratio));
    this.drawLinks(context, ratio);
    this.drawBodies(context, game, ratio);
  }

  private spaceOfPlayer(game: Game): number {
    const first = this.scene!.players[0];
    const start = first ? game.now.start(first.slot) : -1;
    return start < 0 ? 0 : game.frame!.bodies[start + 1]!;
  }

  private drawRoom(context: CanvasRenderingContext2D, room: Room, at: number, isCurrent: boolean, ratio: number): void {
    const { backdrop } = this.colors!;
    room.picture ??= this.picture(this.scene!.spaces[at]!);
    const [x, y] = [this.offsetX + room.left * this.scale, this.offsetY + room.top * this.scale];
    const [w, h] = [room.width * this.scale, room.height * this.scale];
    context.drawImage(room.picture, x, y, w, h);
    context.strokeStyle = isCurrent ? backdrop.arc : backdrop.border;
    context.lineWidth = (isCurrent ? 3 : 1.5) * ratio;
    context.strokeRect(x, y, w, h);
    context.font = `600 ${12 * ratio}px system-ui, sans-serif`;
    context.textAlign = "left";
    context.textBaseline = "bottom";
    context.fillStyle = backdrop.text;
    context.fillText(this.scene!.spaces[at]!.name, x, y - 5 * ratio);
  }

  private picture(space: SpaceInfo): HTMLCanvasElement {
    const [left, bottom, right, top] = space.extent;
    const colors = this.colors!;
    const canvas = document.createElement("canvas");
    let scale = Math.min(3, PICTURE / Math.max(right - left, top - bottom));
    if (space.map && scale * space.map.tile[0] > 1) {
      scale = Math.round(scale * space.map.tile[0]) / space.map.tile[0];
    }
    canvas.width = Math.max(1, Math.round((right - left) * scale));
    canvas.height = Math.max(1, Math.round((top - bottom) * scale));
    const context = canvas.getContext("2d");
    if (!context) return canvas;
    new Scenery(space, colors).draw(context, 0, 0, scale, canvas.width, canvas.height);
    return canvas;
  }

  private x(space: number, x: number): number {
    return this.offsetX + (this.rooms[space]!.left + x - this.scene!.spaces[space]!.extent[0]) * this.scale;
  }

  private y(space: number, y: number): number {
    return this.offsetY + (this.rooms[space]!.top + this.scene!.spaces[space]!.extent[3] - y) * this.scale;
  }

  private drawLinks(context: CanvasRenderingContext2D, ratio: number): void {
    context.strokeStyle = this.colors!.backdrop.link;
    context.fillStyle = this.colors!.backdrop.link;
    context.lineWidth = 2 * ratio;
    this.scene!.spaces.forEach((space, at) => {
      for (const link of space.links) {
        const [fromX, fromY] = [
          this.x(at, (link.area[0] + link.area[2]) / 2),
          this.y(at, (link.area[1] + link.area[3]) / 2),
        ];
        const room = this.rooms[link.space]!;
        const [left, top] = [this.offsetX + room.left * this.scale, this.offsetY + room.top * this.scale];
        const inset = 7 * ratio;
        const clamp = (value: number, low: number, high: number): number => Math.max(low, Math.min(high, value));
        const toX = clamp(fromX, left + inset, left + room.width * this.scale - inset);
        const toY = clamp(fromY, top + inset, top + room.height * this.scale - inset);
        const angle = Math.atan2(toY - fromY, toX - fromX);
        if (Math.hypot(toX - fromX, toY - fromY) < 3 * inset && link.space === at) continue;
        context.globalAlpha = 0.85;
        context.beginPath();
        context.arc(fromX, fromY, 3 * ratio, 0, 2 * Math.PI);
        context.fill();
        context.beginPath();
        context.moveTo(fromX, fromY);
        context.lineTo(toX, toY);
        context.stroke();
        context.beginPath();
        context.moveTo(toX, toY);
        context.lineTo(toX - 9 * ratio * Math.cos(angle - 0.45), toY - 9 * ratio * Math.sin(angle - 0.45));
        context.lineTo(toX - 9 * ratio * Math.cos(angle + 0.45), toY - 9 * ratio * Math.sin(angle + 0.45));
        context.fill();
        context.globalAlpha = 1;
      }
    });
  }

  private drawBodies(context: CanvasRenderingContext2D, game: Game, ratio: number): void {
    const bodies = game.frame!.bodies;
    for (let at = 0; at < bodies.length; at += HEAD + PART * bodies[at + 4]!) {
      const info = this.scene!.slots[bodies[at]!]!;
      const isPlayer = info.player !== null;
      context.fillStyle = this.colors!.body(info).fill;
      context.strokeStyle = this.colors!.backdrop.halo;
      context.lineWidth = 2 * ratio;
      context.beginPath();
      const radius = (isPlayer ? 6 : 3) * ratio;
      context.arc(this.x(bodies[at + 1]!, bodies[at + 2]!), this.y(bodies[at + 1]!, bodies[at + 3]!), radius, 0, 2 * Math.PI);
      if (isPlayer) context.stroke();
      context.fill();
    }
  }

  /** The space at a point of the picture. */
  spaceAt(x: number, y: number): number | null {
    const [mapX, mapY] = [(x - this.offsetX) / this.scale, (y - this.offsetY) / this.scale];
    const isIn = (room: Room): boolean =>
      mapX >= room.left && mapX <= room.left + room.width && mapY >= room.top && mapY <= room.top + room.height;
    const found = this.rooms.findIndex(isIn);
    return found < 0 ? null : found;
  }
}

/** A column and a row for each space: beside the spaces that it is linked with, on the side of the link. */
function cells(scene: Scene): [number, number][] {
  const places: ([number, number] | undefined)[] = scene.spaces.map(() => undefined);
  const taken = new Map<string, number>();
  const put = (space: number, column: number, row: number): void => {
    places[space] = [column, row];
    taken.set(`${column},${row}`, space);
  };
  let bottomRow = -1;
  scene.spaces.forEach((_, first) => {
    if (places[first]) return;
    put(first, 0, bottomRow + 1 + (bottomRow >= 0 ? 1 : 0));
    const queue = [first];
    for (let space = queue.shift(); space !== undefined; space = queue.shift()) {
      const info = scene.spaces[space]!;
      for (const link of info.links) {
        if (places[link.space]) continue;
        const [dx, dy] = side(info, link.area);
        let [column, row] = places[space]!;
        do {
          column += dx;
          row += dy;
        } while (taken.has(`${column},${row}`));
        put(link.space, column, row);
        queue.push(link.space);
      }
    }
    bottomRow = Math.max(...places.map((place) => place?.[1] ?? bottomRow));
  });
  const known = places.map((place) => place ?? ([0, 0] as [number, number]));
  const least = [0, 1].map((axis) => [...new Set(known.map((place) => place[axis]!))].sort((a, b) => a - b));
  // Empty columns and rows are left out.
  return known.map(([column, row]) => [least[0]!.indexOf(column), least[1]!.indexOf(row)]);
}

/** The side of a space on which a rectangle lies. */
function side(space: SpaceInfo, [left, bottom, right, top]: [number, number, number, number]): [number, number] {
  const [l, b, r, t] = space.extent;
  const x = ((left + right) / 2 - l) / Math.max(1, r - l) - 0.5;
  const y = ((bottom + top) / 2 - b) / Math.max(1, t - b) - 0.5;
  if (Math.abs(x) >= Math.abs(y)) return [x < 0 ? -1 : 1, 0];
  return [0, y < 0 ? 1 : -1];
}
