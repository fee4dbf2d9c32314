// What the page asks and what it is answered: the types of src/studio/protocol.
// Written by `UPDATE=1 cargo test --test runtime studio_protocol`.

export type Request =
  | { ask: "open"; world?: string | null }
  | { ask: "reload" }
  | { ask: "keep"; state: boolean }
  | { ask: "play"; inputs: Held[][] }
  | { ask: "seek"; frame: number }
  | { ask: "predict"; input: Held[]; steps: number }
  | { ask: "inspect"; slot: number }
  | { ask: "bounds"; slot: number }
  | { ask: "chart"; entity: string }
  | { ask: "script" }
  | { ask: "trace"; count: number; from: number }
  | { ask: "load"; script: string }
  | { ask: "sliders" }
  | { ask: "set"; slider: number; value: number }
  | { ask: "write"; slider: number }
  | { ask: "text"; path?: string | null; written?: boolean }
  | { ask: "edit"; path?: string | null; text?: string | null }
  | { ask: "paint"; cell: number; space: number; symbol: string }
  | { ask: "undo" }
  | { ask: "search"; nodes: number; seed?: number; target: Target }
  | { ask: "poll" }
  | { ask: "stop" };

export type Answer =
  | ({ answer: "opened" } & Opened)
  | ({ answer: "shown" } & Shown)
  | { answer: "predicted"; paths: [number, number, number][][] }
  | ({ answer: "inspected" } & Inspected)
  | { answer: "bounds"; in_modes: BoundsInModes[]; is_ready: boolean; values: Value[] }
  | { answer: "chart"; entity: string; svg: string }
  | { answer: "text"; text: string }
  | { answer: "sliders"; sliders: Slider[] }
  | ({ answer: "searching" } & Searching)
  | { answer: "done" }
  | { answer: "refused"; message: string };

export interface Atom {
  /** Whether it held; none if it could not be evaluated. */
  held: boolean | null;
  /** Of a comparison, both sides. */
  sides: [number, number] | null;
  /** Its text. */
  text: string;
}

export interface BoundsInModes {
  /** The modes, sorted: all that are active, as in [`Inspected::modes`]. */
  modes: number[];
  /** The values in the order of [`Answer::Bounds`](super::Answer::Bounds). */
  values: string[];
}

export interface BrushInfo {
  /** The kind of tile that it is, if the map has one with its tags. */
  kind: number | null;
  /** What it is, in a few words. */
  label: string;
  /** Its tile in the level editor: a part of a picture of [`MapInfo::art`]. */
  picture: TilePicture | null;
  /** How [`Request::Paint`](super::Request::Paint) names it: a character, or a tile of a level editor. */
  symbol: string;
}

export interface ColliderInfo {
  /** Whether it is a circle (its box is a square). */
  is_round: boolean;
  /** Whether a contact of it with anything can push; otherwise it only senses. */
  is_solid: boolean;
  /** Its tags. */
  tags: number[];
}

export interface Contact {
  /** The side that it asks for: `left`, `right`, `above` or `below`. */
  side: string | null;
  /** The query as it is written, or the condition that it is in. */
  text: string;
}

export interface EdgeState {
  /** The parts of its guard that `and` and `or` join, with their values. */
  atoms: Atom[];
  /** Its index in the entity. */
  edge: number;
  /** The mode whose edge it is, and the target. */
  from: number;
  /** Whether its guard held. */
  held: boolean;
  /** Its line in the text. */
  place: Place | null;
  /** Whether it was taken. */
  taken: boolean;
  /** The target; none if it stays. */
  to: number | null;
}

export interface EntityInfo {
  /** Its colliders. */
  colliders: ColliderInfo[];
  /** Its documentation. */
  doc: string | null;
  /** Its look, if the program says one: that of a tag of its colliders counts as well. */
  look: Look | null;
  /** The paths of its modes, such as `ground.walk`. */
  modes: string[];
  /** Its name. */
  name: string;
}

export interface EventInfo {
  /** The frame after the step in which it happened. */
  frame: number;
  /** `goal`, `never`, `spawned`, `destroyed`, `entered`. */
  kind: string;
  /** Of what: the name of the goal, the `never` or the instance. */
  name: string;
}

export interface Finding {
  /** Its code. */
  code: string;
  /** Ways out. */
  helps: string[];
  /** Other places, with what they say. */
  labels: [Place, string][];
  /** What was found. */
  message: string;
  /** The place of the mistake, if it has one. */
  place: Place | null;
  /** `error` or `warning`. */
  severity: string;
}

export interface Frame {
  /** Its number: that of the steps before it. */
  at: number;
  /** For each living instance: slot, space, x, y, number of active colliders, and of each its index in the entity and its box relative to the position: left, bottom, right, top (px). */
  bodies: number[];
  /** The tiles that are broken: space and cell, as in [`MapInfo::cells`]. */
  broken: [number, number][];
  /** The goals that hold. */
  goals: number[];
  /** The `never`s that hold. */
  nevers: number[];
}

export interface Held {
  /** The axes, from -1 to 1; missing ones are 0. */
  axes?: number[];
  /** Indices of the buttons that are down. */
  buttons?: number[];
}

export interface Inspected {
  /** The contact queries that hold. */
  contacts: Contact[];
  /** The edges that were considered in the step that led to this frame. */
  edges: EdgeState[];
  /** Whether it is there. */
  is_alive: boolean;
  /** Indices of its active modes, outer ones included. */
  modes: number[];
  /** Its slot. */
  slot: number;
  /** Variables, discrete variables and parameters with their values as text, and for how long. */
  values: Value[];
}

export interface LinkInfo {
  /** Where it begins: `[left, bottom, right, top]`, px. */
  area: [number, number, number, number];
  /** The space it leads to. */
  space: number;
}

export type Look = { color: string } | { picture: string };

export interface MapArt {
  /** For each cell, as in [`MapInfo::cells`], its stack. */
  cells: number[];
  /** The paths of pictures. */
  pictures: string[];
  /** What cells show, the lowest tile first. The first one is nothing. */
  stacks: number[][];
  /** Tiles: parts of pictures. */
  tiles: TilePicture[];
}

export interface MapInfo {
  /** What the cells show in the level editor that the map was made with, if that is known. */
  art: MapArt | null;
  /** What its cells can be painted with. */
  brushes: BrushInfo[];
  /** The number of brushes that are too many to show. */
  brushes_left_out: number;
  /** For each cell, from the upper left one row by row, its kind, or -1. */
  cells: number[];
  /** Number of columns. */
  columns: number;
  /** Whether the level editor draws cells by rules: it draws a cell that is painted here when it saves the level. */
  is_drawn_by_rules: boolean;
  /** The kinds of tiles. */
  kinds: TileInfo[];
  /** Number of rows. */
  rows: number;
  /** Width and height of a tile, px. */
  tile: [number, number];
  /** Why a map of a level editor is not painted. */
  unpainted: string | null;
}

export interface Opened {
  /** The paths of the files that the program is made of, the main one first. */
  files: string[];
  /** Errors and warnings of the texts as they are now. */
  findings: Finding[];
  /** Of the same inputs with the program before: the positions of the players at each step, as in [`Answer::Predicted`]; empty if nothing was played. */
  ghost: [number, number, number][][];
  /** Whether the program is the one of these texts; otherwise they have errors, and the last good one goes on. */
  is_current: boolean;
  /** What could not be kept of the history or of the state, in a sentence. */
  lost: string | null;
  /** What does not change while the world runs; none if there was no program without errors yet. */
  scene: Scene | null;
  /** The frame that is shown. */
  shown: Shown | null;
  /** The paths of those that differ from the disk. */
  unsaved: string[];
  /** The names of the worlds. */
  worlds: string[];
}

export interface Place {
  /** Column of its first character. */
  column: number;
  /** Column after its last character. */
  end_column: number;
  /** Last line. */
  end_line: number;
  /** First line. */
  line: number;
  /** The path of the file. */
  path: string;
}

export interface PlayerInfo {
  /** The names of its axes. */
  axes: string[];
  /** The names of its buttons. */
  buttons: string[];
  /** Its number as written. */
  number: number;
  /** The slot that it controls. */
  slot: number;
}

export type Role = "scenery" | "sensed" | "one_way" | "solid";

export interface Scene {
  /** The entities. */
  entities: EntityInfo[];
  /** The names of the goals. */
  goals: string[];
  /** The names of the `never`s. */
  nevers: string[];
  /** The path of the main file. */
  path: string;
  /** The players in the order in which inputs name them. */
  players: PlayerInfo[];
  /** The slots of instances. */
  slots: SlotInfo[];
  /** The spaces. */
  spaces: SpaceInfo[];
  /** The length of a step, s. */
  step: number;
  /** The names of all tags. */
  tags: string[];
  /** The name of the world. */
  world: string;
}

export interface Searching {
  /** The budget. */
  budget: number;
  /** `reached`, `not_found`, `unreachable`, … */
  conclusion: string | null;
  /** The positions of the players along it, as in `Answer::Predicted`, from where the search began. */
  ghost: [number, number, number][][];
  /** Whether it still runs. */
  is_running: boolean;
  /** Nodes so far. */
  nodes: number;
  /** Places covered. */
  places: number;
  /** The new nodes since the last answer: `[space, x, y, x before, y before]`, with the position in the node before, or the same one again if that is in another space. */
  points: [number, number, number, number, number][];
  /** The script that leads there from the first frame: the history up to where the search began, and what was found. */
  script: string | null;
  /** The verdict in a sentence, once it has ended. */
  verdict: string | null;
}

export interface Shown {
  /** The frame before it, to draw between both; none at the start. */
  before: Frame | null;
  /** Why the run cannot go on: a player left the bounds, or a rule of the language was broken. */
  ended: string | null;
  /** What happened in the last steps that were played. */
  events: EventInfo[];
  /** The frame that is shown. */
  frame: Frame;
  /** Whether the first frame is a state that was carried over from the program before a change: no inputs lead there from the start of the world. */
  is_carried: boolean;
  /** Number of frames of the history: the greatest number that can be sought. */
  length: number;
}

export interface Slider {
  /** The entity; none of a `const`. */
  entity: string | null;
  /** The name. */
  name: string;
  /** Where the literal is. */
  place: Place;
  /** The unit that is written after it. */
  unit: string;
  /** The value, in the unit in which it is written. */
  value: number;
  /** The value that is written in the file. */
  written: number;
}

export interface SlotInfo {
  /** Its entity. */
  entity: number;
  /** The name of the instance. */
  name: string;
  /** The index of its player. */
  player: number | null;
}

export interface SolidInfo {
  /** `[left, bottom, right, top]`, px. */
  area: [number, number, number, number];
  /** Its look, if the program says one. */
  look: Look | null;
  /** What it is for the players. */
  role: Role;
  /** Its tags. */
  tags: number[];
}

export interface SpaceInfo {
  /** What it covers: written bounds, or map, geometry and first positions; `[left, bottom, right, top]`, px. */
  extent: [number, number, number, number];
  /** Ways out. */
  links: LinkInfo[];
  /** Its tiles. */
  map: MapInfo | null;
  /** Its name. */
  name: string;
  /** Free-standing geometry. */
  solids: SolidInfo[];
  /** Whether it repeats horizontally and vertically. */
  wraps: [boolean, boolean];
}

export type Target = { goal: string } | { never: string } | { predicate: string } | { place: [number, number, number] };

export interface TileInfo {
  /** Whether it can be broken. */
  breakable: boolean;
  /** What it is, in a few words. */
  label: string;
  /** Its look, if the program says one. */
  look: Look | null;
  /** What it is for the players. */
  role: Role;
  /** The ends of its slope within the tile, px: `[x1, y1, x2, y2]`. */
  slope: [number, number, number, number] | null;
  /** Its symbol in the map. */
  symbol: string;
  /** Its tags. */
  tags: number[];
}

export interface TilePicture {
  /** How it is mirrored: 4 along the diagonal from the upper left corner, then 1 horizontally, then 2 vertically; or a sum of these. */
  mirrored?: number;
  /** The part: left, top, width and height, pixels. */
  part: [number, number, number, number];
  /** The index of the picture. */
  picture: number;
}

export interface Value {
  /** `variable`, `discrete`, `parameter`, `reference` or `timer`. */
  kind: string;
  /** Its name. */
  name: string;
  /** Its value with its unit, as the language writes it. */
  value: string;
}
