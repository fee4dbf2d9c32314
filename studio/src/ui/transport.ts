// The controls of time: play, steps, speed, the timeline with its marks, a loop.

import type { Game } from "../game.ts";
import { h, icon, iconButton } from "./dom.ts";

/** Time between two changes of the time and of the timeline in live play, ms: its end is shown all the while. */
const PAUSE = 250;
const LONG_PAUSE = 1000;
const SPEEDS = [0.25, 0.5, 1, 2];
const SPEED_NAMES: Record<number, string> = { 0.25: "¼×", 0.5: "½×", 1: "1×", 2: "2×" };

export class Transport {
  readonly element: HTMLElement;
  private readonly play: HTMLButtonElement;
  private readonly take: HTMLButtonElement;
  private readonly loop: HTMLButtonElement;
  private readonly slider: HTMLInputElement;
  private readonly marks: HTMLCanvasElement;
  private readonly time: HTMLElement;
  private loopStart: number | null = null;
  private drawn = "";
  private last = 0;
  private lastTime = 0;

  constructor(private readonly game: Game) {
    this.play = iconButton("play", "Play", () => game.toggle(), "P");
    this.play.classList.add("primary");
    this.take = iconButton("hand", "Take over from this frame", () => void game.takeOver(), "T");
    this.loop = iconButton("loop", "Loop a part: mark its start", () => this.markLoop(), "L");
    this.slider = h("input", {
      type: "range",
      class: "timeline",
      min: 0,
      max: 0,
      step: 1,
      value: 0,
      "aria-label": "Frame",
      oninput: () => void game.seek(Number(this.slider.value)),
    });
    this.marks = h("canvas", { class: "marks", "aria-hidden": "true" });
    this.time = h("output", { class: "time", "aria-label": "Time" });
    const speed = h(
      "select",
      {
        class: "speed",
        "aria-label": "Speed",
        title: "Speed",
        onchange: () => {
          game.speed = Number(speed.value);
        },
      },
      ...SPEEDS.map((of) => h("option", { value: of, selected: of === 1 }, SPEED_NAMES[of]!)),
    );
    this.element = h(
      "footer",
      { class: "transport", "aria-label": "Time" },
      h(
        "div",
        { class: "buttons" },
        iconButton("restart", "Start again", () => void game.restart(), "R"),
        iconButton("back", "One step back", () => void game.stepBy(-1), ","),
        this.play,
        iconButton("ahead", "One step ahead", () => void game.stepBy(1), "."),
        this.take,
        this.loop,
      ),
      h("div", { class: "track" }, this.slider, this.marks),
      this.time,
      speed,
    );
    game.onShown.on(() => {
      // While time passes, fewer changes of the page leave more time for the game.
      const passed = performance.now() - this.last;
      if (game.mode !== "live" || passed > LONG_PAUSE) this.update();
      else if (performance.now() - this.lastTime > PAUSE) this.showTime();
    });
    game.onMode.on(() => this.update());
    game.onOpened.on(() => this.update());
    new ResizeObserver(() => this.update()).observe(this.marks);
  }

  /** Marks the start of a loop, then its end, then ends it. */
  markLoop(): void {
    const at = this.game.frame?.at ?? 0;
    if (this.game.loop) {
      this.game.loop = null;
    } else if (this.loopStart === null || this.loopStart === at) {
      this.loopStart = this.loopStart === null ? at : null;
    } else {
      this.game.loop = [Math.min(at, this.loopStart), Math.max(at, this.loopStart)];
      this.loopStart = null;
      void this.game.seek(this.game.loop[0]).then(() => this.game.resume());
    }
    this.update();
  }

  private update(): void {
    const { game } = this;
    this.last = performance.now();
    const at = game.frame?.at ?? 0;
    const isRunning = game.mode !== "paused";
    if (this.play.getAttribute("aria-label") !== (isRunning ? "Pause" : "Play")) {
      this.play.replaceChildren(icon(isRunning ? "pause" : "play"));
      this.play.setAttribute("aria-label", isRunning ? "Pause" : "Play");
      this.play.title = isRunning ? "Pause (P)" : "Play (P)";
    }
    const loopLabel = game.loop
      ? "End the loop"
      : this.loopStart === null
        ? "Loop a part: mark its start"
        : "Loop a part: mark its end";
    if (this.loop.getAttribute("aria-label") !== loopLabel) {
      this.loop.setAttribute("aria-label", loopLabel);
      this.loop.title = `${loopLabel} (L)`;
    }
    this.loop.classList.toggle("on", game.loop !== null || this.loopStart !== null);
    this.take.disabled = game.mode === "live" || (game.frame !== null && at >= game.length && game.ended !== null);
    this.slider.max = String(Math.max(1, game.length));
    this.slider.value = String(at);
    this.slider.style.setProperty("--part", `${(100 * at) / Math.max(1, game.length)}%`);
    this.showTime();
    this.drawMarks();
  }

  private showTime(): void {
    const { frame, length, scene } = this.game;
    const at = frame?.at ?? 0;
    this.lastTime = performance.now();
    this.time.textContent = `${(at * (scene?.step ?? 0)).toFixed(2)} s · ${at}/${length}`;
  }

  private drawMarks(): void {
    const { game, marks } = this;
    const rect = [marks.clientWidth, marks.clientHeight] as const;
    // While the run only grows, marks move slowly: they are drawn again when a pixel changes.
    const key = `${rect} ${game.marks.length} ${Math.floor(game.length / 8)} ${game.loop} ${this.loopStart}`;
    if (key === this.drawn) return;
    this.drawn = key;
    const ratio = window.devicePixelRatio || 1;
    marks.width = Math.round(rect[0] * ratio);
    marks.height = Math.round(rect[1] * ratio);
    const context = marks.getContext("2d");
    if (!context) return;
    const style = getComputedStyle(marks);
    const inset = 8 * ratio;
    const toX = (frame: number): number => inset + ((marks.width - 2 * inset) * frame) / Math.max(1, game.length);
    const color: Record<string, string> = {
      goal: style.getPropertyValue("--good"),
      never: style.getPropertyValue("--bad"),
      destroyed: style.getPropertyValue("--mute"),
      spawned: style.getPropertyValue("--link"),
      entered: style.getPropertyValue("--accent"),
    };
    if (game.loop || this.loopStart !== null) {
      const [from, to] = game.loop ?? [this.loopStart!, this.loopStart!];
      context.fillStyle = style.getPropertyValue("--accent");
      context.globalAlpha = 0.3;
      context.fillRect(toX(from) - ratio, 0, Math.max(2 * ratio, toX(to) - toX(from)), marks.height);
      context.globalAlpha = 1;
    }
    const order = ["spawned", "destroyed", "entered", "never", "goal"];
    for (const kind of order) {
      context.fillStyle = color[kind] ?? "";
      const isLarge = kind === "goal" || kind === "never";
      for (const mark of game.marks) {
        if (mark.kind !== kind) continue;
        context.beginPath();
        context.arc(toX(mark.frame), marks.height / 2, (isLarge ? 4 : 2) * ratio, 0, 2 * Math.PI);
        context.fill();
      }
    }
  }
}
