// What is held on the keyboard, on gamepads and on the touch controls, as the inputs of the players.

import type { Held, Scene } from "../protocol.ts";
import { recall, remember } from "../memory.ts";
import { Signal } from "../signal.ts";
import { type Action, defaultActions, signature } from "./actions.ts";

/** How far a stick must be moved. */
const DEAD_ZONE = 0.25;

export class Inputs {
  actions: Action[] = [];
  readonly onActions = new Signal();
  /** An action begins. */
  readonly onPress = new Signal<Action>();
  /** What the touch controls hold: the strength of each action. */
  readonly touched = new Map<Action, number>();
  /** The inputs of the last steps. */
  last: Held[] = [];
  private scene: Scene | null = null;
  private readonly down = new Set<string>();
  /** Keys that went down since the last sample: a short tap counts for one step. */
  private readonly tapped = new Set<string>();

  /** Reads the keyboard unless a text field has it. */
  listen(takesKeys: (event: KeyboardEvent) => boolean): void {
    addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || !takesKeys(event)) return;
      const action = this.actions.find((action) => action.keys.includes(event.code));
      if (!action) return;
      event.preventDefault();
      if (event.repeat) return;
      this.down.add(event.code);
      this.tapped.add(event.code);
      this.onPress.emit(action);
    });
    addEventListener("keyup", (event) => this.down.delete(event.code));
    addEventListener("blur", () => this.release());
  }

  release(): void {
    this.down.clear();
    this.tapped.clear();
    this.touched.clear();
  }

  /** Whether a key is one of the game's. */
  uses(code: string): boolean {
    return this.actions.some((action) => action.keys.includes(code));
  }

  setScene(scene: Scene): void {
    const isSame = this.scene && signature(this.scene) === signature(scene);
    this.scene = scene;
    if (isSame) return;
    this.actions = defaultActions(scene);
    const stored = recall(`keys.${signature(scene)}`);
    if (Array.isArray(stored) && stored.length === this.actions.length) {
      this.actions.forEach((action, at) => {
        const keys: unknown = stored[at];
        if (Array.isArray(keys)) action.keys = keys.filter((key): key is string => typeof key === "string");
      });
    }
    this.release();
    this.last = [];
    this.onActions.emit();
  }

  /** Gives a key to an action and takes it from the one that had it. */
  assign(action: Action, code: string): void {
    for (const other of this.actions) other.keys = other.keys.filter((key) => key !== code);
    action.keys = [code];
    this.store(this.actions.map((of) => of.keys));
  }

  /** Forgets changed keys. */
  reset(): void {
    if (this.scene) this.actions = defaultActions(this.scene);
    this.store(undefined);
  }

  private store(keys: string[][] | undefined): void {
    if (this.scene) remember(`keys.${signature(this.scene)}`, keys);
    this.release();
    this.onActions.emit();
  }

  /** What is held now, without taking note of taps: for predictions. */
  peek(): Held[] {
    return this.held(this.down);
  }

  /** The inputs of the next steps. */
  sample(): Held[] {
    for (const code of this.down) this.tapped.add(code);
    const held = this.held(this.tapped);
    this.tapped.clear();
    this.last = held;
    return held;
  }

  private held(codes: ReadonlySet<string>): Held[] {
    const players = this.scene?.players ?? [];
    const held = players.map((player) => ({ buttons: [] as number[], axes: player.axes.map(() => 0) }));
    for (const action of this.actions) {
      const of = held[action.player];
      const strength = action.keys.some((key) => codes.has(key)) ? 1 : (this.touched.get(action) ?? 0);
      if (!of || strength === 0) continue;
      if (action.kind === "axis") of.axes[action.index] = (of.axes[action.index] ?? 0) + action.sign * strength;
      else of.buttons.push(action.index);
    }
    this.addGamepads(held);
    return held;
  }

  private wasHeld = false;

  /** Tells when something begins to be held on a gamepad, as a key does. */
  watchGamepads(): void {
    const held = (this.scene?.players ?? []).map((player) => ({ buttons: [] as number[], axes: player.axes.map(() => 0) }));
    this.addGamepads(held);
    const player = held.findIndex((of) => of.buttons.length > 0 || of.axes.some((value) => value !== 0));
    const action = this.actions.find((of) => of.player === player);
    if (action && !this.wasHeld) this.onPress.emit(action);
    this.wasHeld = player >= 0;
  }

  /** Adds the gamepads: the first to the first player, and so on. Sticks and crosses are axes or directions. */
  private addGamepads(held: { buttons: number[]; axes: number[] }[]): void {
    if (typeof navigator.getGamepads !== "function") return;
    let player = 0;
    for (const pad of navigator.getGamepads()) {
      const of = held[player];
      if (!pad?.connected) continue;
      if (!of) return;
      const cross = (plus: number, minus: number): number =>
        Number(pad.buttons[plus]?.pressed ?? false) - Number(pad.buttons[minus]?.pressed ?? false);
      const stick = (axis: number): number => (Math.abs(pad.axes[axis] ?? 0) > DEAD_ZONE ? pad.axes[axis]! : 0);
      const x = cross(15, 14) || stick(0);
      const y = cross(12, 13) || -stick(1);
      let next = 0;
      for (const action of this.actions) {
        if (action.player !== player) continue;
        if (action.kind === "axis") {
          const value = action.label.endsWith("↑") || action.label.endsWith("↓") ? y : x;
          if (value * action.sign > 0) of.axes[action.index] = value;
          continue;
        }
        const end = /(?:^|_)(left|right|up|down)$/i.exec(action.label)?.[1]?.toLowerCase();
        const isDown = end
          ? { left: x < 0, right: x > 0, up: y > 0, down: y < 0 }[end]
          : pad.buttons[next++]?.pressed;
        if (isDown && !of.buttons.includes(action.index)) of.buttons.push(action.index);
      }
      player++;
    }
  }
}
