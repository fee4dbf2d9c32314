// Bodies as small pictures that are drawn once and kept: by colour, size and shape.

import type { Paint } from "./colors.ts";

/** Space around a body in its picture, for its rim. */
const RIM = 2;
/** Maximum number of pictures that are kept. */
const MAX_SPRITES = 400;

export class Sprites {
  private readonly kept = new Map<number, HTMLCanvasElement>();

  clear(): void {
    this.kept.clear();
  }

  /** Draws a body whose upper left corner is at (x, y). */
  draw(
    context: CanvasRenderingContext2D,
    paint: Paint,
    isRound: boolean,
    isSolid: boolean,
    x: number,
    y: number,
    width: number,
    height: number,
  ): void {
    const [w, h] = [Math.max(2, Math.round(width)), Math.max(2, Math.round(height))];
    // Large bodies are not worth a picture of their own.
    if (w * h > 512 * 512) {
      context.save();
      context.translate(x - RIM, y - RIM);
      drawBody(context, paint, isRound, isSolid, w, h);
      context.restore();
      return;
    }
    const key = ((paint.id * 1024 + w) * 1024 + h) * 4 + (isRound ? 2 : 0) + (isSolid ? 1 : 0);
    let sprite = this.kept.get(key);
    if (!sprite) {
      sprite = document.createElement("canvas");
      sprite.width = w + 2 * RIM;
      sprite.height = h + 2 * RIM;
      const own = sprite.getContext("2d");
      if (own) drawBody(own, paint, isRound, isSolid, w, h);
      if (this.kept.size >= MAX_SPRITES) this.kept.clear();
      this.kept.set(key, sprite);
    }
    context.drawImage(sprite, Math.round(x) - RIM, Math.round(y) - RIM);
  }
}

function drawBody(
  context: CanvasRenderingContext2D,
  paint: Paint,
  isRound: boolean,
  isSolid: boolean,
  w: number,
  h: number,
): void {
  const small = Math.min(w, h);
  const shape = (inset: number): void => {
    context.beginPath();
    if (isRound) {
      context.ellipse(RIM + w / 2, RIM + h / 2, Math.max(0.5, w / 2 - inset), Math.max(0.5, h / 2 - inset), 0, 0, 2 * Math.PI);
    } else {
      const round = Math.min(small * 0.3, 18);
      const [iw, ih] = [Math.max(1, w - 2 * inset), Math.max(1, h - 2 * inset)];
      context.roundRect(RIM + inset, RIM + inset, iw, ih, Math.max(0, round - inset));
    }
  };
  const rim = Math.max(1, Math.min(2.5, small / 12));
  shape(0);
  if (!isSolid) {
    context.globalAlpha = 0.62;
    context.fillStyle = paint.fill;
    context.fill();
    context.globalAlpha = 1;
    shape(rim / 2);
    context.strokeStyle = paint.fill;
    context.lineWidth = rim * 1.3;
    context.stroke();
    return;
  }
  const shade = context.createLinearGradient(0, RIM, 0, RIM + h);
  shade.addColorStop(0, paint.light);
  shade.addColorStop(0.45, paint.fill);
  shade.addColorStop(1, paint.fill);
  context.fillStyle = shade;
  context.fill();
  shape(rim / 2);
  context.strokeStyle = paint.dark;
  context.globalAlpha = 0.75;
  context.lineWidth = rim;
  context.stroke();
  context.globalAlpha = 1;
}
