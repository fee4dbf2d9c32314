// A small picture of a frame as SVG, for the gallery. It is drawn when the playground is built.

import { Colors, type Kind, type Theme } from "../draw/colors.ts";
import type { Frame, MapInfo, Scene } from "../protocol.ts";

/** Width and height of a picture, px of the screen. */
const SIZE: [number, number] = [320, 200];
/** Maximum width of the part of a space that it shows, px of the world. */
const MAX_WIDTH = 420;

interface Box { left: number; bottom: number; right: number; top: number }

const number = (value: number): string => String(Math.round(value * 100) / 100);

/** The picture of the space that player 1 is in. */
export function thumbnail(scene: Scene, frame: Frame, theme: Theme): string {
  const colors = new Colors(scene, theme);
  const player = scene.players[0]?.slot ?? 0;
  const bodies = bodiesOf(frame);
  const hero = bodies.find((body) => body.slot === player) ?? bodies[0];
  const index = hero?.space ?? 0;
  const space = scene.spaces[index];
  if (space === undefined) return "";
  const view = viewOf(space.extent, hero?.x ?? 0, hero?.y ?? 0);
  const scale = SIZE[0] / (view.right - view.left);
  const x = (at: number): number => (at - view.left) * scale;
  const y = (at: number): number => (view.top - at) * scale;
  const parts: string[] = [];
  const broken = new Set(frame.broken.filter(([of]) => of === index).map(([, cell]) => cell));
  if (space.map !== null) parts.push(...tiles(space.map, broken, colors, view, x, y, scale));
  for (const solid of space.solids) {
    const [left, bottom, right, top] = solid.area;
    const kind = colors.kind(solid);
    parts.push(rect({ left, bottom, right, top }, x, y, scale, kind.paint.fill, look(kind), 3));
  }
  for (const body of bodies) {
    const slot = scene.slots[body.slot];
    if (body.space !== index || slot === undefined) continue;
    const entity = scene.entities[slot.entity];
    const paint = colors.body(slot);
    // Sensors of a body are not shown, unless it has nothing else.
    const isSolid = ({ collider }: { collider: number }): boolean => entity?.colliders[collider]?.is_solid !== false;
    const shown = body.colliders.some(isSolid) ? body.colliders.filter(isSolid) : body.colliders.slice(0, 1);
    for (const { collider, box } of shown) {
      const info = entity?.colliders[collider];
      const style = info?.is_solid === false
        ? `fill="${paint.fill}" fill-opacity=".5" stroke="${paint.fill}"`
        : `fill="${paint.fill}" stroke="${paint.dark}" stroke-width="1.5"`;
      const [cx, cy] = [x((box.left + box.right) / 2), y((box.bottom + box.top) / 2)];
      if (info?.is_round === true) {
        parts.push(`<circle cx="${number(cx)}" cy="${number(cy)}" r="${number(((box.right - box.left) / 2) * scale)}" ${style}/>`);
      } else {
        const [w, h] = [(box.right - box.left) * scale, (box.top - box.bottom) * scale];
        const round = number(Math.min(w, h) * 0.28);
        parts.push(`<rect x="${number(x(box.left))}" y="${number(y(box.top))}" width="${number(w)}" height="${number(h)}" rx="${round}" ${style}/>`);
      }
      const small = Math.min(box.right - box.left, box.top - box.bottom) * scale;
      if (slot.player !== null && collider === shown[0]?.collider && small >= 7) parts.push(eyes(cx, cy, small));
    }
  }
  const [from, to] = colors.backdrop.sky;
  return (
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${SIZE[0]} ${SIZE[1]}">` +
    `<linearGradient id="s" x2="0" y2="1"><stop stop-color="${from}"/><stop offset="1" stop-color="${to}"/></linearGradient>` +
    `<rect width="100%" height="100%" fill="url(#s)"/>${parts.join("")}</svg>`
  );
}

/** The eyes of a player, as on the stage. */
function eyes(x: number, y: number, size: number): string {
  const [apart, radius] = [size * 0.17, size * 0.13];
  const eye = (side: number): string =>
    `<circle cx="${number(x + side * apart)}" cy="${number(y - size * 0.05)}" r="${number(radius)}" fill="#fff"/>` +
    `<circle cx="${number(x + side * apart + radius * 0.25)}" cy="${number(y - size * 0.05)}" r="${number(radius * 0.55)}" fill="#1d2736"/>`;
  return eye(-1) + eye(1);
}

interface Body {
  slot: number;
  space: number;
  x: number;
  y: number;
  colliders: { collider: number; box: Box }[];
}

function bodiesOf(frame: Frame): Body[] {
  const all: Body[] = [];
  const of = frame.bodies;
  for (let at = 0; at < of.length; ) {
    const [slot = 0, space = 0, x = 0, y = 0, count = 0] = of.slice(at, at + 5);
    const body: Body = { slot, space, x, y, colliders: [] };
    at += 5;
    for (let nth = 0; nth < count; nth += 1, at += 5) {
      const [collider = 0, left = 0, bottom = 0, right = 0, top = 0] = of.slice(at, at + 5);
      body.colliders.push({ collider, box: { left: x + left, bottom: y + bottom, right: x + right, top: y + top } });
    }
    all.push(body);
  }
  return all;
}

/** The part of a space around a position; all of a small space. */
function viewOf([left, bottom, right, top]: [number, number, number, number], x: number, y: number): Box {
  const ratio = SIZE[0] / SIZE[1];
  const [all, high] = [right - left, top - bottom];
  const width = Math.min(MAX_WIDTH, Math.max(all, high * ratio));
  const height = width / ratio;
  const clamped = (at: number, size: number, low: number, room: number): number =>
    room <= size ? low + (room - size) / 2 : Math.min(Math.max(at - size / 2, low), low + room - size);
  const from = clamped(x, width, left, all);
  // Of a space that is less high than the picture, the ground is at the bottom.
  const low = high <= height ? bottom - (height - high) * 0.5 : clamped(y, height, bottom, high);
  return { left: from, bottom: low, right: from + width, top: low + height };
}

function look(kind: Kind): string {
  if (kind.role === "solid" || kind.role === "one_way") return "";
  return kind.role === "scenery" ? ' opacity=".4"' : ' opacity=".6"';
}

type Scale = (at: number) => number;

function rect(box: Box, x: Scale, y: Scale, scale: number, fill: string, more: string, round: number): string {
  const [w, h] = [(box.right - box.left) * scale, (box.top - box.bottom) * scale];
  return `<rect x="${number(x(box.left))}" y="${number(y(box.top))}" width="${number(w)}" height="${number(h)}" rx="${round}" fill="${fill}"${more}/>`;
}

/** The tiles in view: of each kind one shape, with its rows as rectangles. */
function tiles(map: MapInfo, broken: Set<number>, colors: Colors, view: Box, x: Scale, y: Scale, scale: number): string[] {
  const [width, height] = map.tile;
  const paths = new Map<Kind, string>();
  // Upper edges of walls are lit.
  const lit = new Map<Kind, string>();
  const isWall = (cell: number): boolean => {
    const info = map.kinds[map.cells[cell] ?? -1];
    return cell >= 0 && info !== undefined && info.role === "solid" && !broken.has(cell);
  };
  const [from, to] = [Math.max(0, Math.floor(view.left / width)), Math.min(map.columns, Math.ceil(view.right / width))];
  for (let row = 0; row < map.rows; row += 1) {
    const top = (map.rows - row) * height;
    if (top <= view.bottom || top - height >= view.top) continue;
    for (let column = from; column < to; ) {
      const cell = row * map.columns + column;
      const kind = map.cells[cell] ?? -1;
      const info = map.kinds[kind];
      let end = column + 1;
      if (kind < 0 || info === undefined || broken.has(cell)) {
        column = end;
        continue;
      }
      const look = colors.kind(info);
      const before = paths.get(look) ?? "";
      if (info.slope !== null) {
        const [x1, y1, x2, y2] = info.slope;
        const at = column * width;
        const low = top - height;
        const points = [[at + x1, low + y1], [at + x2, low + y2], [at + width, low], [at, low]];
        const line = points.map(([px, py]) => `${number(x(px ?? 0))} ${number(y(py ?? 0))}`).join("L");
        paths.set(look, `${before}M${line}Z`);
      } else {
        while (end < to && map.cells[row * map.columns + end] === kind && !broken.has(row * map.columns + end)) end += 1;
        const [w, h] = [(end - column) * width * scale, height * scale];
        paths.set(look, `${before}M${number(x(column * width))} ${number(y(top))}h${number(w)}v${number(h)}h-${number(w)}Z`);
        for (let at = column; look.role === "solid" && at < end; at += 1) {
          if (row > 0 && isWall((row - 1) * map.columns + at)) continue;
          const edge = `M${number(x(at * width))} ${number(y(top) + 1)}h${number(width * scale)}`;
          lit.set(look, (lit.get(look) ?? "") + edge);
        }
      }
      column = end;
    }
  }
  const shapes = [...paths].map(([kind, path]) =>
    `<path d="${path}" fill="${kind.paint.fill}" stroke="${kind.paint.fill}" stroke-width="1.2" stroke-linejoin="round"${look(kind)}/>`,
  );
  const edges = [...lit].map(([kind, path]) => `<path d="${path}" stroke="${kind.paint.light}" stroke-width="2.5"/>`);
  return [...shapes, ...edges];
}
