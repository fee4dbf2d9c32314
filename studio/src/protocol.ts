// What the page asks and what it is answered: the types of src/studio/protocol.rs.
// Written by `UPDATE=1 cargo test --test runtime protocol`; do not edit.

export type Request =
  | { ask: "open"; world?: string | null }
  | { ask: "reload" }
  | { ask: "play"; inputs: Held[][] }
  | { ask: "seek"; frame: number }
  | { ask: "predict"; input: Held[]; steps: number }
  | { ask: "inspect"; slot: number }
  | { ask: "bounds"; slot: number }
  | { ask: "chart"; entity: string }
  | { ask: "script" }
  | { ask: "load"; script: string }
  | { ask: "sliders" }
  | { ask: "set"; slider: number; value: number }
  | { ask: "write"; slider: number }
  | { ask: "text"; path?: string | null; written?: boolean }
  | { ask: "edit"; path?: string | null; text?: string | null }
  | { ask: "paint"; space: number; cell: number; symbol: string }
  | { ask: "undo" }
  | { ask: "search"; target: Target; nodes: number; seed?: number }
  | { ask: "poll" }
  | { ask: "stop" };

export type Target = { goal: string } | { never: string } | { predicate: string } | { place: [number, number, number] };

export type Answer =
  | ({ answer: "opened" } & Opened)
  | ({ answer: "shown" } & Shown)
  | { answer: "predicted"; paths: [number, number, number][][] }
  | ({ answer: "inspected" } & Inspected)
  | { answer: "bounds"; is_ready: boolean; values: Value[] }
  | { answer: "chart"; entity: string; svg: string }
  | { answer: "text"; text: string }
  | { answer: "sliders"; sliders: Slider[] }
  | ({ answer: "searching" } & Searching)
  | { answer: "done" }
  | { answer: "refused"; message: string };

export interface Held { axes?: number[]; buttons?: number[] }

export interface Opened {
  files: string[];
  findings: Finding[];
  ghost: [number, number, number][][];
  is_current: boolean;
  lost: string | null;
  scene: Scene | null;
  shown: Shown | null;
  unsaved: string[];
  worlds: string[];
}

export interface Finding {
  code: string;
  helps: string[];
  labels: [Place, string][];
  message: string;
  place: Place | null;
  severity: string;
}

export interface Place { column: number; end_column: number; end_line: number; line: number; path: string }

export interface Scene {
  entities: EntityInfo[];
  goals: string[];
  nevers: string[];
  path: string;
  players: PlayerInfo[];
  slots: SlotInfo[];
  spaces: SpaceInfo[];
  step: number;
  tags: string[];
  world: string;
}

export interface PlayerInfo { axes: string[]; buttons: string[]; number: number; slot: number }

export type Role = "scenery" | "sensed" | "one_way" | "solid";

export interface SpaceInfo {
  extent: [number, number, number, number];
  links: LinkInfo[];
  map: MapInfo | null;
  name: string;
  solids: SolidInfo[];
  wraps: [boolean, boolean];
}

export interface LinkInfo { area: [number, number, number, number]; space: number }

export interface SolidInfo { area: [number, number, number, number]; role: Role; tags: number[] }

export interface MapInfo {
  cells: number[];
  columns: number;
  is_painted: boolean;
  kinds: TileInfo[];
  rows: number;
  tile: [number, number];
}

export interface TileInfo {
  breakable: boolean;
  label: string;
  role: Role;
  slope: [number, number, number, number] | null;
  symbol: string;
  tags: number[];
}

export interface EntityInfo { colliders: ColliderInfo[]; doc: string | null; modes: string[]; name: string }

export interface ColliderInfo { is_round: boolean; is_solid: boolean; tags: number[] }

export interface SlotInfo { entity: number; name: string; player: number | null }

export interface Shown { before: Frame | null; ended: string | null; events: EventInfo[]; frame: Frame; length: number }

export interface Frame { at: number; bodies: number[]; broken: [number, number][]; goals: number[]; nevers: number[] }

export interface EventInfo { frame: number; kind: string; name: string }

export interface Inspected {
  contacts: string[];
  edges: EdgeState[];
  is_alive: boolean;
  modes: number[];
  slot: number;
  values: Value[];
}

export interface Value { kind: string; name: string; value: string }

export interface EdgeState {
  atoms: Atom[];
  edge: number;
  from: number;
  held: boolean;
  place: Place | null;
  taken: boolean;
  to: number | null;
}

export interface Atom { held: boolean | null; sides: [number, number] | null; text: string }

export interface Slider {
  entity: string | null;
  name: string;
  place: Place;
  unit: string;
  value: number;
  written: number;
}

export interface Searching {
  budget: number;
  conclusion: string | null;
  ghost: [number, number, number][][];
  is_running: boolean;
  nodes: number;
  places: number;
  points: [number, number, number][];
  script: string | null;
  verdict: string | null;
}
