// A slider for each number of the text. A change is played at once; the text is written only on request.

import { ask } from "../carrier.ts";
import type { Overlays } from "../draw/overlays.ts";
import type { Stage } from "../draw/stage.ts";
import type { Game } from "../game.ts";
import type { Inputs } from "../input/keys.ts";
import type { Held, Slider } from "../protocol.ts";
import { button, h, section, short, toggle } from "./dom.ts";
import type { Panel } from "./sidebar.ts";
import type { Toasts } from "./toasts.ts";

/** Number of steps that are predicted: two seconds at 60 steps a second. */
const PREDICTED = 120;
/** Time between two predictions while time passes, ms. */
const PAUSE = 50;

export class TunePanel implements Panel {
  readonly id = "tune";
  readonly title = "Tune";
  readonly element = h("div");
  private readonly list = h("div", { class: "sliders" });
  private readonly button = h("select", { "aria-label": "Button of the jump" });
  private readonly arcToggle: HTMLLabelElement;
  private sliders: Slider[] = [];
  private rows: { number: HTMLInputElement; range: HTMLInputElement; write: HTMLButtonElement; row: HTMLElement }[] = [];
  private isShown = false;
  private isSetting = false;
  private next: [number, number] | null = null;
  private isPredicting = false;
  private last = 0;
  private touched = 0;

  constructor(
    private readonly game: Game,
    private readonly stage: Stage,
    private readonly overlays: Overlays,
    private readonly inputs: Inputs,
    private readonly toasts: Toasts,
  ) {
    this.arcToggle = toggle("Draw the coming jump", true, (isOn) => {
      stage.shows.arc = isOn;
      void this.predict(true);
    });
    this.element.append(
      section("Jump", this.arcToggle, h("label", { class: "row" }, "with the button ", this.button)),
      section("Numbers", h("p", { class: "quiet" }, "Changes are played at once, over the same inputs; the run before is the dotted line. They are in the text only once written."), this.list),
    );
    this.button.addEventListener("change", () => void this.predict(true));
    game.onScene.on((scene) => {
      const player = scene.players[0];
      this.button.replaceChildren(...(player?.buttons ?? []).map((name, at) => h("option", { value: at }, name)), h("option", { value: -1 }, "as held"));
    });
    game.onOpened.on(() => {
      if (this.isShown && !this.isSetting) void this.refresh();
      void this.predict(true);
    });
    game.onShown.on(() => void this.predict(game.mode === "paused"));
    game.onMode.on(() => void this.predict(true));
  }

  shown(isShown: boolean): void {
    if (isShown === this.isShown) return;
    this.isShown = isShown;
    this.stage.shows.arc = isShown && (this.arcToggle.querySelector("input")?.checked ?? true);
    if (isShown) void this.refresh();
    void this.predict(true);
  }

  /** Reads the numbers of the text. */
  private async refresh(): Promise<void> {
    try {
      const answer = await ask(this.game.carrier, "sliders", { ask: "sliders" });
      const isSame = answer.sliders.length === this.sliders.length && answer.sliders.every((slider, at) => slider.name === this.sliders[at]!.name && slider.entity === this.sliders[at]!.entity);
      this.sliders = answer.sliders;
      if (!isSame) this.build();
      this.fill();
    } catch {
      // The text has errors: the numbers stay.
    }
  }

  private build(): void {
    const groups = new Map<string, HTMLElement[]>();
    this.rows = this.sliders.map((slider, at) => {
      const name = slider.entity ? `${slider.entity}.${slider.name}` : slider.name;
      const range = h("input", { type: "range", "aria-label": name, oninput: () => this.set(at, Number(range.value)) });
      const number = h("input", { type: "number", step: "any", "aria-label": `${name}, exact`, onchange: () => this.set(at, Number(number.value)) });
      const write = button("Write", () => void this.write(at), "small");
      write.title = "Write this number into the text";
      const row = h("div", { class: "slider" }, h("span", { class: "name" }, slider.name), number, h("span", { class: "unit quiet" }, slider.unit.trim()), range, write);
      const group = slider.entity ?? "Constants";
      groups.set(group, [...(groups.get(group) ?? []), row]);
      return { number, range, write, row };
    });
    const parts = [...groups].map(([name, rows]) => h("div", { class: "slider-group" }, h("h3", {}, name), ...rows));
    if (parts.length === 0) parts.push(h("p", { class: "quiet" }, "No `param` or `const` of the text is a plain number."));
    this.list.replaceChildren(...parts);
  }

  private fill(): void {
    this.sliders.forEach((slider, at) => {
      const row = this.rows[at]!;
      // The range is around the written value; it stays while the value is changed.
      const size = Math.abs(slider.written) || 1;
      const [low, high] = slider.written < 0 ? [-2 * size, 0] : [0, 2 * size];
      row.range.min = String(Math.min(low, slider.value));
      row.range.max = String(Math.max(high, slider.value));
      const isWhole = Number.isInteger(slider.written) && size >= 10;
      row.range.step = String(isWhole ? 1 : size / 200);
      if (document.activeElement !== row.range || Number(row.range.value) !== slider.value) row.range.value = String(slider.value);
      if (document.activeElement !== row.number) row.number.value = short(slider.value, 6);
      const isChanged = slider.value !== slider.written;
      row.row.classList.toggle("changed", isChanged);
      row.write.hidden = !isChanged;
      row.row.title = isChanged ? `Written: ${slider.written}${slider.unit}` : "";
    });
  }

  /** Sets a number; of several changes in a row, the last one counts. */
  private set(at: number, value: number): void {
    this.next = [at, Number(value.toPrecision(10))];
    if (!this.isSetting) void this.setNext();
  }

  private async setNext(): Promise<void> {
    this.isSetting = true;
    while (this.next) {
      const [slider, value] = this.next;
      this.next = null;
      await this.game.change({ ask: "set", slider, value });
      await this.refresh();
    }
    this.isSetting = false;
  }

  /** Writes one number into the text, and leaves the others as they were. */
  private async write(at: number): Promise<void> {
    const { game, toasts } = this;
    const slider = this.sliders[at];
    if (!slider) return;
    const answer = await game.carrier.ask({ ask: "write", slider: at });
    if (answer.answer === "refused") return toasts.show(answer.message, "bad");
    if (answer.answer === "opened") game.takeOpened(answer);
    this.onWrite(slider.place.path);
    await this.refresh();
  }

  /** A file has a new text. */
  onWrite: (path: string) => void = () => undefined;

  /** What is held, with the button of the jump. */
  private held(): Held[] {
    // While time stands, the direction of the last step counts.
    const isLive = this.game.mode === "live" || this.inputs.last.length === 0;
    const held = isLive ? this.inputs.peek() : this.inputs.last.map((of) => ({ ...of, buttons: [...(of.buttons ?? [])] }));
    const at = Number(this.button.value);
    const first = held[0];
    if (first && at >= 0 && !first.buttons?.includes(at)) first.buttons = [...(first.buttons ?? []), at];
    return held;
  }

  /** Asks where the players go from here. */
  private async predict(isUrgent: boolean): Promise<void> {
    if (!this.stage.shows.arc || !this.game.scene?.players.length) {
      this.overlays.arcs = [];
      return;
    }
    const now = performance.now();
    if (this.isPredicting || (!isUrgent && now - this.last < PAUSE)) return;
    this.isPredicting = true;
    this.last = now;
    this.touched++;
    this.overlays.arcs = await this.game.predict(this.held(), PREDICTED);
    this.isPredicting = false;
  }
}
