// Reads the flat list of bodies in a frame: slot, space, x, y, number of colliders, and of each its index and its box.

import type { Frame } from "./protocol.ts";

/** Numbers before the colliders of a body. */
export const HEAD = 5;
/** Numbers of a collider: index, left, bottom, right, top. */
export const PART = 5;

/** Where each slot's body begins in the list of a frame. The table is used again for each frame. */
export class BodyIndex {
  private starts = new Int32Array(0);
  frame: Frame | null = null;

  read(frame: Frame | null, slots: number): void {
    if (this.starts.length !== slots) this.starts = new Int32Array(slots);
    this.starts.fill(-1);
    this.frame = frame;
    if (!frame) return;
    const bodies = frame.bodies;
    for (let at = 0; at < bodies.length; at += HEAD + PART * bodies[at + 4]!) this.starts[bodies[at]!] = at;
  }

  /** Where the body of a slot begins; -1 if it is not there. */
  start(slot: number): number {
    return this.starts[slot] ?? -1;
  }
}

/** A box of a body: left, bottom, right, top relative to its position. */
export type Box = [number, number, number, number];

/** The box around all colliders of a body that a test accepts; false if there is none. */
export function boxAround(bodies: number[], start: number, accepts: (collider: number) => boolean, into: Box): boolean {
  let found = false;
  const count = bodies[start + 4]!;
  for (let part = 0; part < count; part++) {
    const at = start + HEAD + part * PART;
    if (!accepts(bodies[at]!)) continue;
    const [left, bottom, right, top] = [bodies[at + 1]!, bodies[at + 2]!, bodies[at + 3]!, bodies[at + 4]!];
    into[0] = found ? Math.min(into[0], left) : left;
    into[1] = found ? Math.min(into[1], bottom) : bottom;
    into[2] = found ? Math.max(into[2], right) : right;
    into[3] = found ? Math.max(into[3], top) : top;
    found = true;
  }
  return found;
}
