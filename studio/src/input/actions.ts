// The actions of the players and the keys they get: by the names of axes and buttons first, then in order.

import type { PlayerInfo, Scene } from "../protocol.ts";

/** An action of a player: a button, or one end of an axis. */
export interface Action {
  player: number;
  kind: "button" | "axis";
  /** Index of the button or axis. */
  index: number;
  /** -1 or 1 for an axis; 1 for a button. */
  sign: number;
  /** Its name for people. */
  label: string;
  /** The codes of its keys, as in KeyboardEvent.code. */
  keys: string[];
}

type Direction = "left" | "right" | "up" | "down";

const HORIZONTAL = /^(x|h|horizontal|horiz|side|sideways|walk|run|steer|turn|move|direction|left_right|dx)$/i;
const VERTICAL = /^(y|v|vertical|vert|climb|up_down|pitch|throttle|dy)$/i;

/** The keys of the directions for each player. */
const DIRECTIONS: Record<Direction, string[]>[] = [
  { left: ["ArrowLeft", "KeyA"], right: ["ArrowRight", "KeyD"], up: ["ArrowUp", "KeyW"], down: ["ArrowDown", "KeyS"] },
  { left: ["KeyJ"], right: ["KeyL"], up: ["KeyI"], down: ["KeyK"] },
  { left: ["Numpad4"], right: ["Numpad6"], up: ["Numpad8"], down: ["Numpad5"] },
];
/** The keys of other buttons for each player, in order. */
const BUTTONS = [
  ["Space", "KeyZ", "KeyX", "KeyC", "KeyV", "KeyB", "KeyQ", "KeyE", "KeyF"],
  ["KeyU", "KeyO", "KeyH", "KeyY", "KeyN", "Semicolon"],
  ["Numpad7", "Numpad9", "Numpad1", "Numpad3", "Numpad0"],
];

/** The direction that a button means by its name. */
function direction(name: string): Direction | null {
  const match = /(?:^|_)(left|right|up|down)$/i.exec(name);
  return match ? (match[1]!.toLowerCase() as Direction) : null;
}

function ofPlayer(player: PlayerInfo, index: number): Action[] {
  const directions = DIRECTIONS[index];
  const spare = [...(BUTTONS[index] ?? [])];
  const actions: Action[] = [];
  const used = new Set<string>();
  const keysOf = (towards: Direction): string[] => {
    const keys = (directions?.[towards] ?? []).filter((key) => !used.has(key));
    for (const key of keys) used.add(key);
    return keys;
  };
  const horizontal = player.axes.findIndex((name) => HORIZONTAL.test(name));
  const vertical = player.axes.findIndex((name) => VERTICAL.test(name));
  // Axes without a telling name: the first is horizontal, the second vertical.
  const rest = player.axes.map((_, axis) => axis).filter((axis) => axis !== horizontal && axis !== vertical);
  const x = horizontal >= 0 ? horizontal : rest.shift();
  const y = vertical >= 0 ? vertical : rest.shift();
  player.axes.forEach((name, axis) => {
    const ends: [Direction, Direction] | null = axis === x ? ["left", "right"] : axis === y ? ["down", "up"] : null;
    for (const sign of [-1, 1]) {
      const end = ends?.[sign < 0 ? 0 : 1];
      const keys = end ? keysOf(end) : spare.splice(-1, 1);
      const arrow = end ? { left: "←", right: "→", up: "↑", down: "↓" }[end] : sign < 0 ? "−" : "+";
      actions.push({ player: index, kind: "axis", index: axis, sign, label: `${name} ${arrow}`, keys });
    }
  });
  const buttons = player.buttons.map((name, button): Action => {
    const towards = direction(name);
    return { player: index, kind: "button", index: button, sign: 1, label: name, keys: towards ? keysOf(towards) : [] };
  });
  for (const action of buttons) {
    if (action.keys.length > 0) continue;
    const key = spare.shift();
    if (key) action.keys.push(key);
    // A jump is also the key up, where that key is free.
    if (/jump|hop|flap|fly/i.test(action.label)) action.keys.push(...keysOf("up").slice(0, 1));
  }
  return [...buttons, ...actions];
}

/** All actions of a scene with their keys as they are at first. */
export function defaultActions(scene: Scene): Action[] {
  return scene.players.flatMap(ofPlayer);
}

/** The name under which the keys of a game are remembered: games with the same inputs share them. */
export function signature(scene: Scene): string {
  return scene.players.map((player) => [...player.buttons, "|", ...player.axes].join(",")).join(";");
}

const NAMES: Record<string, string> = {
  ArrowLeft: "←",
  ArrowRight: "→",
  ArrowUp: "↑",
  ArrowDown: "↓",
  Space: "Space",
  Semicolon: ";",
  ShiftLeft: "Shift",
  ControlLeft: "Ctrl",
};

/** A key's name for people. */
export function keyName(code: string): string {
  return NAMES[code] ?? code.replace(/^(Key|Digit)/, "").replace(/^Numpad/, "Num ");
}
