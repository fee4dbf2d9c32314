// Where one looks: a space, a point of it, and the scale. It follows the players smoothly and stays in the room.

import type { SpaceInfo } from "../protocol.ts";

/** How fast the camera follows: the part of the way in a second is 1 - e^-SPEED. */
const SPEED = 7;
/** The size that a tile should have at least, in CSS pixels. */
const COMFORT = 30;

export class Camera {
  space = 0;
  /** The point in the middle of the view, in the units of the world. */
  x = 0;
  y = 0;
  /** Pixels of the device for each pixel of the world. */
  scale = 1;
  /** How much nearer one looks than usual. */
  zoom = 1;
  /** How far the view was dragged away from what it follows. */
  dragX = 0;
  dragY = 0;
  width = 1;
  height = 1;
  private isSet = false;

  resize(width: number, height: number): void {
    this.width = Math.max(1, width);
    this.height = Math.max(1, height);
  }

  /** The camera jumps to what it follows instead of moving there. */
  jump(): void {
    this.isSet = false;
  }

  recenter(): void {
    this.zoom = 1;
    this.dragX = 0;
    this.dragY = 0;
  }

  /** Chooses the scale: the whole room if things are large enough in it, else so that it fills the view. */
  fit(space: SpaceInfo, unit: number, ratio: number): void {
    const [left, bottom, right, top] = space.extent;
    const across = this.width / Math.max(1, right - left);
    const up = this.height / Math.max(1, top - bottom);
    const [whole, cover] = [Math.min(across, up), Math.max(across, up)];
    const comfort = (COMFORT * ratio) / unit;
    let scale = whole >= comfort * 0.62 ? Math.min(whole, comfort * 4) : Math.min(cover, comfort * 1.5);
    scale = Math.max(scale, comfort * 0.62) * this.zoom;
    // Tiles have whole numbers of pixels, so that there are no seams between them.
    if (space.map) scale = Math.max(1, Math.round(scale * space.map.tile[0])) / space.map.tile[0];
    this.scale = scale;
  }

  /** Moves towards a point; not beyond the room. */
  follow(space: SpaceInfo, x: number, y: number, seconds: number): void {
    const [left, bottom, right, top] = space.extent;
    const [halfWidth, halfHeight] = [this.width / this.scale / 2, this.height / this.scale / 2];
    const within = (at: number, low: number, high: number, half: number): number =>
      high - low <= 2 * half ? (low + high) / 2 : Math.max(low + half, Math.min(high - half, at));
    const goalX = within(x + this.dragX, left, right, halfWidth);
    const goalY = within(y + this.dragY, bottom, top, halfHeight);
    // Dragging does not go on beyond the border.
    if (this.dragX !== 0) this.dragX = goalX - x;
    if (this.dragY !== 0) this.dragY = goalY - y;
    const part = this.isSet ? 1 - Math.exp(-SPEED * seconds) : 1;
    this.x += (goalX - this.x) * part;
    this.y += (goalY - this.y) * part;
    this.isSet = true;
  }

  /** From the world to the view, in pixels of the device. */
  toX(x: number): number {
    return (x - this.x) * this.scale + this.width / 2;
  }

  toY(y: number): number {
    return this.height / 2 - (y - this.y) * this.scale;
  }

  /** From the view to the world. */
  worldX(x: number): number {
    return (x - this.width / 2) / this.scale + this.x;
  }

  worldY(y: number): number {
    return (this.height / 2 - y) / this.scale + this.y;
  }
}
