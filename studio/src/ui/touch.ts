// Controls for fingers: a stick for the axes or directions of a player, round buttons for the rest.

import type { Action } from "../input/actions.ts";
import type { Inputs } from "../input/keys.ts";
import { h } from "./dom.ts";

/** How far the knob moves, CSS pixels. */
const REACH = 38;

type Direction = "left" | "right" | "up" | "down";
const SIGNS: Record<Direction, [number, number]> = { left: [-1, 0], right: [1, 0], up: [0, 1], down: [0, -1] };

/** The direction of an action, by its arrow or its name. */
function towards(action: Action): Direction | null {
  if (action.kind === "axis") {
    const end = { "←": "left", "→": "right", "↑": "up", "↓": "down" }[action.label.slice(-1)];
    return (end as Direction | undefined) ?? (action.sign < 0 ? "left" : "right");
  }
  return (/(?:^|_)(left|right|up|down)$/i.exec(action.label)?.[1]?.toLowerCase() as Direction | undefined) ?? null;
}

export class Touch {
  readonly element = h("div", { class: "touch", hidden: true });

  constructor(
    private readonly inputs: Inputs,
    private readonly begin: () => void,
  ) {
    inputs.onActions.on(() => this.build());
  }

  private build(): void {
    // Fingers play the first player.
    const actions = this.inputs.actions.filter((action) => action.player === 0);
    const directed = actions.filter((action) => towards(action) !== null);
    const others = actions.filter((action) => towards(action) === null);
    this.element.replaceChildren(
      directed.length > 0 ? this.stick(directed) : h("span"),
      h("div", { class: "pads" }, ...others.map((action) => this.pad(action))),
    );
  }

  private press(action: Action, strength: number): void {
    const was = this.inputs.touched.get(action) ?? 0;
    if (strength > 0) this.inputs.touched.set(action, strength);
    else this.inputs.touched.delete(action);
    if (was === 0 && strength > 0) {
      this.begin();
      this.inputs.onPress.emit(action);
    }
  }

  private pad(action: Action): HTMLElement {
    const pad = h("button", { type: "button", class: "pad", tabindex: -1 }, action.label);
    const set = (isDown: boolean) => (event: PointerEvent) => {
      event.preventDefault();
      if (isDown) pad.setPointerCapture(event.pointerId);
      pad.classList.toggle("down", isDown);
      this.press(action, isDown ? 1 : 0);
    };
    pad.addEventListener("pointerdown", set(true));
    pad.addEventListener("pointerup", set(false));
    pad.addEventListener("pointercancel", set(false));
    pad.addEventListener("contextmenu", (event) => event.preventDefault());
    return pad;
  }

  private stick(actions: Action[]): HTMLElement {
    const knob = h("div", { class: "knob" });
    const stick = h("div", { class: "stick", "aria-hidden": "true" }, knob);
    const hasX = actions.some((action) => SIGNS[towards(action)!][0] !== 0);
    const hasY = actions.some((action) => SIGNS[towards(action)!][1] !== 0);
    const move = (x: number, y: number): void => {
      knob.style.transform = `translate(${x * REACH}px, ${-y * REACH}px)`;
      for (const action of actions) {
        const [signX, signY] = SIGNS[towards(action)!];
        const part = x * signX + y * signY;
        const isAnalog = action.kind === "axis";
        this.press(action, part > 0.35 ? (isAnalog && part < 0.8 ? part : 1) : 0);
      }
    };
    const drag = (event: PointerEvent): void => {
      const box = stick.getBoundingClientRect();
      let x = hasX ? (event.clientX - box.left - box.width / 2) / REACH : 0;
      let y = hasY ? -(event.clientY - box.top - box.height / 2) / REACH : 0;
      const length = Math.hypot(x, y);
      if (length > 1) [x, y] = [x / length, y / length];
      move(x, y);
    };
    stick.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      stick.setPointerCapture(event.pointerId);
      drag(event);
    });
    stick.addEventListener("pointermove", (event) => {
      if (stick.hasPointerCapture(event.pointerId)) drag(event);
    });
    for (const end of ["pointerup", "pointercancel"] as const) stick.addEventListener(end, () => move(0, 0));
    return stick;
  }
}
