// The eyes of players: they look where the player goes, and close now and then.

/** Draws eyes into a body with its upper left corner at (x, y). */
export function drawFace(
  context: CanvasRenderingContext2D,
  slot: number,
  x: number,
  y: number,
  w: number,
  h: number,
  dx: number,
  dy: number,
  isThere: boolean,
): void {
  const small = Math.min(w, h);
  if (small < 9) return;
  const size = Math.max(1.5, small * 0.13);
  const length = Math.hypot(dx, dy);
  const [lookX, lookY] = length > 0.02 ? [dx / length, -dy / length] : [0, 0];
  const [middleX, middleY] = [x + w / 2 + lookX * w * 0.14, y + Math.min(h * 0.4, w * 0.55) + lookY * h * 0.05];
  const apart = w * 0.19;
  const isShut = (performance.now() + slot * 700) % 4200 < 130;
  context.globalAlpha = isThere ? 1 : 0.5;
  for (const side of [-1, 1]) {
    const eye = middleX + side * apart;
    context.fillStyle = "#fff";
    context.beginPath();
    context.ellipse(eye, middleY, size * 1.15, isShut ? size * 0.2 : size * 1.35, 0, 0, 2 * Math.PI);
    context.fill();
    if (isShut) continue;
    context.fillStyle = "#222831";
    context.beginPath();
    context.arc(eye + lookX * size * 0.45, middleY + lookY * size * 0.5, size * 0.7, 0, 2 * Math.PI);
    context.fill();
  }
  context.globalAlpha = 1;
}
