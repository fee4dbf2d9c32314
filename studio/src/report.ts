// What a page reports that `hypedc reach --html` or `hypedc sim --html` has written: the types of src/cli/page.rs.

import type { Paths } from "./game.ts";

export type Tone = "good" | "bad" | "proof" | "open";

/** A frame that is worth a look. */
export interface Moment {
  frame: number;
  text: string;
  tone: Tone;
}

/** Inputs that were run from the first state. */
export interface Witness {
  script: string;
  steps: number;
  /** For each player its space and position after each step. */
  ghost: Paths;
}

/** An answer or a run. */
export interface Way {
  kind: "goal" | "never" | "run";
  name: string;
  verdict: string;
  tone: Tone;
  /** The lines below the verdict, as the command prints them. */
  lines: string[];
  witness: Witness | null;
  /** The frame from which the search went. */
  start: number;
  moments: Moment[];
  /** Where a search was: cells of 8 px as space, column, row, number of nodes. */
  covered: [number, number, number, number][];
  /** A picture as SVG. */
  picture: string | null;
}

export interface Report {
  kind: "reach" | "sim";
  title: string;
  notes: string[];
  ways: Way[];
  command: string;
  hypedc: string;
  program_sha256: string;
}
