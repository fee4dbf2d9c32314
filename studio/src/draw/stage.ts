// The stage: draws the frame that is shown into a canvas, between the frame before and it, and follows the players.

import { type Box, boxAround, HEAD, PART } from "../bodies.ts";
import type { Game } from "../game.ts";
import type { SpaceInfo } from "../protocol.ts";
import { Signal } from "../signal.ts";
import { Camera } from "./camera.ts";
import { Colors, type Theme } from "./colors.ts";
import { drawFace } from "./face.ts";
import { Overview } from "./overview.ts";
import { Pictures } from "./pictures.ts";
import { Sprites } from "./sprites.ts";
import { Scenery } from "./tiles.ts";

/** Bodies that move further than this in a step have jumped, px. */
const JUMP = 48;
/** Size of a thing on a map without tiles, px. */
const UNIT = 16;

/** What is shown on request. */
export interface Shows {
  grid: boolean;
  sensors: boolean;
  contacts: boolean;
  names: boolean;
  arc: boolean;
}

/** Draws over the bodies of a space. */
export type Overlay = (context: CanvasRenderingContext2D, camera: Camera, space: number) => void;

export class Stage {
  readonly canvas = document.createElement("canvas");
  readonly camera = new Camera();
  readonly shows: Shows = { grid: false, sensors: false, contacts: false, names: false, arc: false };
  /** What is drawn below the bodies, and above them. */
  readonly underlays: Overlay[] = [];
  readonly overlays: Overlay[] = [];
  readonly onColors = new Signal();
  /** Something else is shown on request. */
  readonly onShows = new Signal();
  /** The instance that is looked at. */
  selected: number | null = null;
  /** The instance under the mouse. */
  hovered: number | null = null;
  isOverview = false;
  colors: Colors | null = null;
  ratio = 1;
  private readonly context: CanvasRenderingContext2D;
  private readonly sprites = new Sprites();
  private readonly overview = new Overview();
  readonly pictures: Pictures;
  private layers: Scenery[] = [];
  private theme: Theme = "light";
  private last = 0;
  private readonly box: Box = [0, 0, 0, 0];
  /** The last box of each slot, for bodies that have no collider at the moment: four numbers each. */
  private lastBoxes = new Float64Array(0);
  private brokenCells: number[][] = [];
  /** Times of the work of the last frames, ms; for measurements. */
  readonly work = new Float64Array(600);
  frames = 0;

  constructor(private readonly game: Game) {
    const context = this.canvas.getContext("2d", { alpha: false });
    if (!context) throw new Error("This browser has no canvas.");
    this.context = context;
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "application");
    this.canvas.setAttribute("aria-label", "The game");
    this.pictures = new Pictures(game.carrier);
    this.pictures.onLoaded.on(() => this.rebuild());
    this.pictures.onTrouble.on((why) => game.onTrouble.emit(why));
    game.onPictures.on(() => this.pictures.forget());
    game.onScene.on(() => this.refresh());
    game.onShown.on(() => this.readBroken());
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    this.refresh();
  }

  private refresh(): void {
    this.rebuild();
    this.camera.jump();
  }

  /** Makes what is kept of the scene anew. */
  private rebuild(): void {
    const scene = this.game.scene;
    if (!scene) return;
    const colors = new Colors(scene, this.theme, this.pictures);
    this.colors = colors;
    this.sprites.clear();
    this.layers = scene.spaces.map((space) => new Scenery(space, colors));
    this.brokenCells = scene.spaces.map(() => []);
    if (this.lastBoxes.length !== 4 * scene.slots.length) this.lastBoxes = new Float64Array(4 * scene.slots.length);
    if (this.camera.space >= scene.spaces.length) this.camera.space = 0;
    this.overview.layout(scene, colors);
    this.readBroken();
    this.onColors.emit();
  }

  private readBroken(): void {
    const broken = this.game.frame?.broken ?? [];
    for (let space = 0; space < this.layers.length; space++) {
      const cells = this.brokenCells[space]!;
      cells.length = 0;
      for (const [of, cell] of broken) if (of === space) cells.push(cell);
      this.layers[space]?.setBroken(cells);
    }
  }

  /** The canvas has another size, in CSS pixels. */
  resize(width: number, height: number): void {
    this.ratio = Math.min(3, window.devicePixelRatio || 1);
    this.canvas.width = Math.max(1, Math.round(width * this.ratio));
    this.canvas.height = Math.max(1, Math.round(height * this.ratio));
    this.camera.resize(this.canvas.width, this.canvas.height);
    this.camera.jump();
  }

  space(): SpaceInfo | null {
    return this.game.scene?.spaces[this.camera.space] ?? null;
  }

  /** Draws; called once for each frame of the display. */
  draw(now: number): void {
    const begin = performance.now();
    const seconds = Math.min(0.1, (now - this.last) / 1000);
    this.last = now;
    if (this.game.scene && this.game.frame && this.colors) {
      if (this.isOverview) this.overview.draw(this.context, this.game, this.colors, this.ratio);
      else this.drawSpace(seconds);
    } else {
      this.context.fillStyle = this.theme === "dark" ? "#0d131c" : "#d6dde8";
      this.context.fillRect(0, 0, this.canvas.width, this.canvas.height);
    }
    this.work[this.frames++ % this.work.length] = performance.now() - begin;
  }

  private drawSpace(seconds: number): void {
    const { camera, context, game } = this;
    const scene = game.scene!;
    this.aim(seconds);
    const space = scene.spaces[camera.space]!;
    const { backdrop } = this.colors!;
    const { width, height } = this.canvas;
    const [left, bottom, right, top] = space.extent;
    const [x1, y1] = [Math.round(camera.toX(left)), Math.round(camera.toY(top))];
    const [x2, y2] = [Math.round(camera.toX(right)), Math.round(camera.toY(bottom))];
    // Around the room; all of it is drawn over.
    context.fillStyle = backdrop.outside;
    if (y1 > 0) context.fillRect(0, 0, width, y1);
    if (y2 < height) context.fillRect(0, y2, width, height - y2);
    if (x1 > 0) context.fillRect(0, 0, x1, height);
    if (x2 < width) context.fillRect(x2, 0, width - x2, height);
    this.layers[camera.space]?.draw(context, x1, y1, camera.scale, width, height);
    if (this.shows.grid) this.drawGrid(space);
    this.drawLinks(space);
    for (const underlay of this.underlays) underlay(context, camera, camera.space);
    this.drawBodies();
    for (const overlay of this.overlays) overlay(context, camera, camera.space);
    context.strokeStyle = backdrop.border;
    context.lineWidth = Math.max(1, this.ratio);
    context.setLineDash(space.wraps[0] || space.wraps[1] ? [6 * this.ratio, 5 * this.ratio] : []);
    context.strokeRect(x1 - 0.5, y1 - 0.5, x2 - x1 + 1, y2 - y1 + 1);
    context.setLineDash([]);
  }

  /** Chooses the space and the point to look at. */
  private aim(seconds: number): void {
    const { camera, game } = this;
    const scene = game.scene!;
    const bodies = game.frame!.bodies;
    let [x, y, count] = [0, 0, 0];
    let space = -1;
    for (const player of scene.players) {
      const at = game.now.start(player.slot);
      if (at < 0) continue;
      if (space < 0) space = bodies[at + 1]!;
      if (bodies[at + 1] !== space) continue;
      const place = this.place(at);
      x += place[0];
      y += place[1];
      count++;
    }
    if (space >= 0 && space !== camera.space) {
      camera.space = space;
      camera.jump();
    }
    const info = scene.spaces[camera.space]!;
    const [left, bottom, right, top] = info.extent;
    const unit = info.map ? Math.min(...info.map.tile) : UNIT;
    camera.fit(info, unit, this.ratio);
    const [toX, toY] = count > 0 ? [x / count, y / count] : [(left + right) / 2, (bottom + top) / 2];
    camera.follow(info, toX, toY, seconds);
  }

  private readonly spot: [number, number] = [0, 0];

  /** Where a body is drawn: between the frame before and this one, unless it has jumped. */
  private place(at: number): [number, number] {
    const { game, spot } = this;
    const bodies = game.frame!.bodies;
    const [x, y] = [bodies[at + 2]!, bodies[at + 3]!];
    spot[0] = x;
    spot[1] = y;
    const part = game.between;
    const from = game.then.start(bodies[at]!);
    if (part >= 1 || from < 0) return spot;
    const before = game.before!.bodies;
    const [dx, dy] = [x - before[from + 2]!, y - before[from + 3]!];
    if (before[from + 1] !== bodies[at + 1] || Math.abs(dx) > JUMP || Math.abs(dy) > JUMP) return spot;
    spot[0] = x - dx * (1 - part);
    spot[1] = y - dy * (1 - part);
    return spot;
  }

  private drawGrid(space: SpaceInfo): void {
    const { camera, context } = this;
    const [width, height] = space.map?.tile ?? [UNIT, UNIT];
    const [left, bottom, right, top] = space.extent;
    context.strokeStyle = this.colors!.backdrop.grid;
    context.lineWidth = 1;
    context.beginPath();
    for (let x = Math.ceil(left / width) * width; x <= right; x += width) {
      const at = Math.round(camera.toX(x)) + 0.5;
      context.moveTo(at, camera.toY(top));
      context.lineTo(at, camera.toY(bottom));
    }
    for (let y = Math.ceil(bottom / height) * height; y <= top; y += height) {
      const at = Math.round(camera.toY(y)) + 0.5;
      context.moveTo(camera.toX(left), at);
      context.lineTo(camera.toX(right), at);
    }
    context.stroke();
  }

  private drawLinks(space: SpaceInfo): void {
    const { camera, context } = this;
    const { link } = this.colors!.backdrop;
    for (const { area } of space.links) {
      const [x, y] = [camera.toX(area[0]), camera.toY(area[3])];
      const [w, h] = [(area[2] - area[0]) * camera.scale, (area[3] - area[1]) * camera.scale];
      context.fillStyle = link;
      context.globalAlpha = 0.16;
      context.beginPath();
      context.roundRect(x, y, w, h, Math.min(w, h, 12) / 3);
      context.fill();
      context.globalAlpha = 0.7;
      context.strokeStyle = link;
      context.lineWidth = 1.5 * this.ratio;
      context.setLineDash([4 * this.ratio, 3 * this.ratio]);
      context.stroke();
      context.setLineDash([]);
      context.globalAlpha = 1;
    }
  }

  private drawBodies(): void {
    const { camera, game } = this;
    const scene = game.scene!;
    const bodies = game.frame!.bodies;
    // Players are on top.
    for (const wantsPlayers of [false, true]) {
      for (let at = 0; at < bodies.length; at += HEAD + PART * bodies[at + 4]!) {
        if (bodies[at + 1] !== camera.space) continue;
        const isPlayer = scene.slots[bodies[at]!]!.player !== null;
        if (isPlayer === wantsPlayers) this.drawBody(at, isPlayer);
      }
    }
  }

  private drawBody(at: number, isPlayer: boolean): void {
    const { box, camera, context, game } = this;
    const scene = game.scene!;
    const bodies = game.frame!.bodies;
    const slot = bodies[at]!;
    const info = scene.slots[slot]!;
    const entity = scene.entities[info.entity]!;
    const paint = this.colors!.body(info);
    const [worldX, worldY] = this.place(at);
    const [x, y, scale] = [camera.toX(worldX), camera.toY(worldY), camera.scale];
    const isMarked = slot === this.selected || slot === this.hovered;
    const count = bodies[at + 4]!;
    let hasSolid = false;
    for (let part = 0; part < count; part++) hasSolid ||= entity.colliders[bodies[at + HEAD + part * PART]!]!.is_solid;
    const picture = this.colors!.picture(paint);
    for (let part = 0; part < count; part++) {
      const from = at + HEAD + part * PART;
      const collider = entity.colliders[bodies[from]!]!;
      const [left, bottom, right, top] = [bodies[from + 1]!, bodies[from + 2]!, bodies[from + 3]!, bodies[from + 4]!];
      // What only senses is the body of a thing that has no other; else it is shown on request.
      const isBody = collider.is_solid || (!hasSolid && !this.isWide(left, bottom, right, top));
      const [px, py] = [x + left * scale, y - top * scale];
      const [w, h] = [(right - left) * scale, (top - bottom) * scale];
      if (isBody && picture) {
        continue;
      } else if (isBody) {
        this.sprites.draw(context, paint, collider.is_round, collider.is_solid, px, py, w, h);
      } else if (this.shows.sensors || isMarked) {
        this.outline(px, py, w, h, collider.is_round);
      }
    }
    const hasBox = boxAround(bodies, at, (of) => !hasSolid || entity.colliders[of]!.is_solid, box);
    if (hasBox) this.lastBoxes.set(box, 4 * slot);
    else for (let side = 0; side < 4; side++) box[side] = this.lastBoxes[4 * slot + side]!;
    if (!hasBox) this.drawGone(paint.fill, x, y);
    if (picture && hasBox) {
      context.imageSmoothingEnabled = false;
      context.drawImage(picture, Math.round(x + box[0] * scale), Math.round(y - box[3] * scale), Math.round((box[2] - box[0]) * scale), Math.round((box[3] - box[1]) * scale));
      context.imageSmoothingEnabled = true;
    }
    if (isPlayer && !picture) {
      const from = game.then.start(slot);
      const before = game.before?.bodies;
      const [dx, dy] = from >= 0 && before ? [bodies[at + 2]! - before[from + 2]!, bodies[at + 3]! - before[from + 3]!] : [0, 0];
      drawFace(context, slot, x + box[0] * scale, y - box[3] * scale, (box[2] - box[0]) * scale, (box[3] - box[1]) * scale, dx, dy, hasBox);
    }
    if (isMarked) this.mark(x, y);
    if (isMarked || this.shows.names) this.label(info.name, x + ((box[0] + box[2]) / 2) * scale, y - box[3] * scale);
  }

  /** Whether a sensor covers much of the room: such a one is no body. */
  private isWide(left: number, bottom: number, right: number, top: number): boolean {
    const [l, b, r, t] = this.space()!.extent;
    return (right - left) * (top - bottom) > 0.12 * (r - l) * (t - b) && right - left > 3 * UNIT;
  }

  private outline(x: number, y: number, w: number, h: number, isRound: boolean): void {
    const { context, ratio } = this;
    context.strokeStyle = this.colors!.backdrop.sensor;
    context.globalAlpha = 0.75;
    context.lineWidth = ratio;
    context.setLineDash([4 * ratio, 3 * ratio]);
    context.beginPath();
    if (isRound) context.ellipse(x + w / 2, y + h / 2, w / 2, h / 2, 0, 0, 2 * Math.PI);
    else context.rect(x, y, w, h);
    context.stroke();
    context.setLineDash([]);
    context.globalAlpha = 1;
  }

  /** An instance without colliders: where it was, faintly. */
  private drawGone(color: string, x: number, y: number): void {
    const { box, camera, context, ratio } = this;
    const { scale } = camera;
    const [w, h] = [(box[2] - box[0]) * scale, (box[3] - box[1]) * scale];
    context.globalAlpha = 0.35;
    context.fillStyle = color;
    context.beginPath();
    if (w > 0 && h > 0) context.roundRect(x + box[0] * scale, y - box[3] * scale, w, h, Math.min(w, h) * 0.3);
    else context.arc(x, y, 3 * ratio, 0, 2 * Math.PI);
    context.fill();
    context.globalAlpha = 1;
  }

  private mark(x: number, y: number): void {
    const { box, camera, context, ratio } = this;
    const pad = 4 * ratio;
    context.strokeStyle = this.colors!.backdrop.text;
    context.lineWidth = 1.5 * ratio;
    context.globalAlpha = 0.8;
    context.beginPath();
    context.roundRect(
      x + box[0] * camera.scale - pad,
      y - box[3] * camera.scale - pad,
      (box[2] - box[0]) * camera.scale + 2 * pad,
      (box[3] - box[1]) * camera.scale + 2 * pad,
      6 * ratio,
    );
    context.stroke();
    context.globalAlpha = 1;
  }

  /** The middle of a slot's body as it was last seen, and its lower side, relative to its position. */
  anchor(slot: number): { x: number; y: number; bottom: number } {
    const box = this.lastBoxes;
    const at = 4 * slot;
    return { x: (box[at]! + box[at + 2]!) / 2, y: (box[at + 1]! + box[at + 3]!) / 2, bottom: box[at + 1]! };
  }

  /** Writes a text above a point. */
  label(text: string, x: number, y: number, color?: string): void {
    const { context, ratio } = this;
    const { halo, text: ink } = this.colors!.backdrop;
    context.font = `600 ${12 * ratio}px system-ui, sans-serif`;
    context.textAlign = "center";
    context.textBaseline = "bottom";
    context.lineJoin = "round";
    context.lineWidth = 4 * ratio;
    context.strokeStyle = halo;
    context.strokeText(text, x, y - 6 * ratio);
    context.fillStyle = color ?? ink;
    context.fillText(text, x, y - 6 * ratio);
  }

  /** The instance at a point of the canvas, in CSS pixels. */
  slotAt(x: number, y: number): number | null {
    const { box, camera, game } = this;
    if (!game.frame || !game.scene || this.isOverview) return null;
    const [worldX, worldY] = [camera.worldX(x * this.ratio), camera.worldY(y * this.ratio)];
    const reach = (5 * this.ratio) / camera.scale;
    const bodies = game.frame.bodies;
    let best: number | null = null;
    let least = Infinity;
    for (let at = 0; at < bodies.length; at += HEAD + PART * bodies[at + 4]!) {
      if (bodies[at + 1] !== camera.space) continue;
      const entity = game.scene.entities[game.scene.slots[bodies[at]!]!.entity]!;
      let hasSolid = false;
      const count = bodies[at + 4]!;
      for (let part = 0; part < count; part++) hasSolid ||= entity.colliders[bodies[at + HEAD + part * PART]!]!.is_solid;
      if (!boxAround(bodies, at, (of) => !hasSolid || entity.colliders[of]!.is_solid, box)) box.fill(0);
      const [dx, dy] = [worldX - bodies[at + 2]!, worldY - bodies[at + 3]!];
      const isIn = dx >= box[0] - reach && dx <= box[2] + reach && dy >= box[1] - reach && dy <= box[3] + reach;
      const size = (box[2] - box[0]) * (box[3] - box[1]);
      // Of several, the smallest.
      if (isIn && size < least) [best, least] = [bodies[at]!, size];
    }
    return best;
  }

  /** The space at a point of the overview, in CSS pixels. */
  spaceAt(x: number, y: number): number | null {
    return this.overview.spaceAt(x * this.ratio, y * this.ratio);
  }
}
