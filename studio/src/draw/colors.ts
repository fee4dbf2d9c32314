// The colours of the stage, for light and dark: by the role of a thing first, then by words in its tags, then in order.

import type { EntityInfo, Look, Role, Scene, SlotInfo, TileInfo } from "../protocol.ts";
import type { Pictures } from "./pictures.ts";

export type Theme = "light" | "dark";

/** A colour with what is drawn around and on it. */
export interface Paint {
  /** A name for the cache of drawn bodies. */
  id: number;
  fill: string;
  light: string;
  dark: string;
  /** Whether the program says it. */
  isLook: boolean;
  /** The path of a picture that is drawn in its place. */
  picture: string | null;
}

/** Colours of the stage itself. */
export interface Backdrop {
  sky: [string, string];
  outside: string;
  border: string;
  grid: string;
  text: string;
  halo: string;
  ghost: string;
  arc: string;
  link: string;
  sensor: string;
  good: string;
  bad: string;
}

export const BACKDROPS: Record<Theme, Backdrop> = {
  light: {
    sky: ["#e3edfa", "#f8fafd"],
    outside: "#d6dde8",
    border: "#9aa8bb",
    grid: "rgba(60, 80, 110, .13)",
    text: "#1d2736",
    halo: "rgba(255, 255, 255, .9)",
    ghost: "#7c4dd6",
    arc: "#d9480f",
    link: "#7c4dd6",
    sensor: "#57657a",
    good: "#1f9d57",
    bad: "#d1343f",
  },
  dark: {
    sky: ["#17202f", "#1d2839"],
    outside: "#0d131c",
    border: "#4a5a70",
    grid: "rgba(170, 190, 220, .1)",
    text: "#e8eef7",
    halo: "rgba(13, 19, 28, .85)",
    ghost: "#b794f6",
    arc: "#ff9a5c",
    link: "#b794f6",
    sensor: "#93a3b8",
    good: "#4cc38a",
    bad: "#f2727c",
  },
};

/** Hues that words of games have everywhere. */
const WORDS: [RegExp, number, number][] = [
  [/water|sea|pool|swim/i, 208, 70],
  [/lava|fire|flame|heat|hot/i, 16, 85],
  [/spike|hazard|danger|deadly|kill|thorn|saw|enemy|foe|poison|hurt/i, 354, 70],
  [/coin|gold|key|treasure|star|ring|pellet|gem/i, 44, 85],
  [/ice|snow|glass/i, 192, 55],
  [/grass|leaf|plant|bush|tree|vine/i, 135, 40],
  [/ladder|wood|bridge|crate|rope|bar/i, 30, 45],
  [/goal|flag|exit|finish|target|home/i, 150, 60],
  [/door|gate|portal|stair/i, 270, 45],
  [/brick|dig|soft/i, 18, 42],
  [/sand|dirt|mud|earth/i, 36, 42],
];
/** Hues and saturations of solid ground without a telling word. */
const GROUNDS: [number, number][] = [
  [216, 22],
  [24, 26],
  [160, 20],
  [276, 18],
];
/** Hues of what is only sensed. */
const ACCENTS: [number, number][] = [
  [262, 55],
  [186, 55],
  [48, 65],
  [322, 50],
  [96, 40],
];
/** Hues of players. */
const PLAYERS: [number, number, number][] = [
  [20, 88, 57],
  [214, 78, 58],
  [142, 52, 47],
  [328, 68, 60],
];
/** Hues of other entities. */
const ENTITIES: [number, number, number][] = [
  [262, 52, 62],
  [352, 62, 60],
  [178, 48, 44],
  [42, 78, 52],
  [228, 48, 60],
  [104, 38, 47],
  [312, 44, 58],
  [12, 42, 50],
];

const hsl = (hue: number, saturation: number, light: number): string => `hsl(${hue} ${saturation}% ${light}%)`;

let paints = 0;
function paint(hue: number, saturation: number, light: number, theme: Theme): Paint {
  const shift = theme === "dark" ? -4 : 0;
  const at = (more: number): string => hsl(hue, saturation, Math.max(4, Math.min(96, light + shift + more)));
  return { id: ++paints, fill: at(0), light: at(13), dark: at(-16), isLook: false, picture: null };
}

/** A look; until a picture is there, it has the colour that the thing has without a look. */
function lookPaint(look: Look | null, plain: () => Paint): Paint {
  if (look === null) return plain();
  if ("picture" in look) return { ...plain(), id: ++paints, isLook: true, picture: look.picture };
  const parts = [1, 3, 5].map((at) => parseInt(look.color.slice(at, at + 2), 16));
  const mixed = (toward: number, part: number): string => `rgb(${parts.map((of) => Math.round(of + (toward - of) * part)).join(" ")})`;
  return { id: ++paints, fill: look.color, light: mixed(255, 0.28), dark: mixed(0, 0.3), isLook: true, picture: null };
}

function byWord(name: string): [number, number] | null {
  const found = WORDS.find(([word]) => word.test(name));
  return found ? [found[1], found[2]] : null;
}

/** Scenery that covers more of a map than this is its air. */
const AIR = 0.55;

/** Whether a kind of tile is not drawn: without tags, or scenery nearly everywhere that has no look. */
export function isAir(kind: TileInfo, count: number, of: number): boolean {
  return kind.tags.length === 0 || (kind.look === null && kind.role === "scenery" && count > AIR * of);
}

/** What the look of a static thing depends on. */
export interface Thing {
  tags: number[];
  role: Role;
  look: Look | null;
}

/** A kind of static thing as the legend shows it. */
export interface Kind {
  name: string;
  role: Role;
  paint: Paint;
}

/** The colours of a scene. */
export class Colors {
  readonly backdrop: Backdrop;
  readonly kinds: Kind[] = [];
  private readonly entities: Paint[];
  private readonly players: Paint[];

  constructor(
    private readonly scene: Scene,
    readonly theme: Theme,
    private readonly pictures: Pictures | null = null,
  ) {
    this.backdrop = BACKDROPS[theme];
    this.players = PLAYERS.map(([hue, saturation, light]) => paint(hue, saturation, light, theme));
    let next = 0;
    this.entities = scene.entities.map((entity) => {
      const word = byWord(this.entityWords(entity));
      const [hue, saturation, light] = word ? [word[0], word[1] * 0.9, 56] : ENTITIES[next++ % ENTITIES.length]!;
      return lookPaint(entity.look, () => paint(hue, saturation, light, theme));
    });
    for (const space of scene.spaces) {
      // Only what is in a map, the most frequent first.
      const counts = new Map<number, number>();
      for (const cell of space.map?.cells ?? []) counts.set(cell, (counts.get(cell) ?? 0) + 1);
      const used = [...counts].filter(([kind]) => kind >= 0).sort((a, b) => b[1] - a[1]);
      for (const [kind] of used) {
        const info = space.map?.kinds[kind];
        if (info && !isAir(info, counts.get(kind) ?? 0, space.map?.cells.length ?? 0)) this.kind(info);
      }
      for (const solid of space.solids) this.kind(solid);
    }
  }

  private entityWords(entity: EntityInfo): string {
    return `${entity.name} ${entity.colliders.flatMap((of) => of.tags.map((tag) => this.scene.tags[tag])).join(" ")}`;
  }

  /** The picture that is drawn in place of a colour, once it is loaded. */
  picture(of: Paint): HTMLImageElement | null {
    return of.picture === null ? null : this.pictureOf(of.picture);
  }

  /** The picture of a path, once it is loaded. */
  pictureOf(path: string): HTMLImageElement | null {
    return this.pictures?.get(path) ?? null;
  }

  /** What tiles and solids with some tags look like. */
  kind({ tags, role, look }: Thing): Kind {
    const name = tags.map((tag) => this.scene.tags[tag] ?? "").join(", ");
    const known = this.kinds.find((kind) => kind.name === name && kind.role === role);
    if (known) return known;
    const isSolid = role === "solid" || role === "one_way";
    const word = byWord(name);
    const alike = this.kinds.filter((kind) => (kind.role === "solid" || kind.role === "one_way") === isSolid).length;
    const list = isSolid ? GROUNDS : ACCENTS;
    const [hue, saturation] = word ?? list[alike % list.length]!;
    const light = role === "scenery" ? (this.theme === "dark" ? 34 : 76) : isSolid ? 44 : 58;
    const muted = role === "scenery" ? saturation * 0.5 : isSolid ? Math.min(saturation, 46) : saturation;
    const kind = { name, role, paint: lookPaint(look, () => paint(hue, muted, light, this.theme)) };
    this.kinds.push(kind);
    return kind;
  }

  body(slot: SlotInfo): Paint {
    const own = this.entities[slot.entity]!;
    if (slot.player === null || own.isLook) return own;
    return this.players[slot.player % this.players.length]!;
  }

  entity(index: number): Paint {
    const player = this.scene.slots.find((slot) => slot.entity === index && slot.player !== null);
    return player ? this.body(player) : this.entities[index]!;
  }
}
