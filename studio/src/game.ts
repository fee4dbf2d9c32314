// The game that is played: what the session has told, and how time passes. At most one request to step is under way.

import { BodyIndex } from "./bodies.ts";
import { ask, type Carrier } from "./carrier.ts";
import type { EventInfo, Frame, Held, Opened, Scene, Shown, Target } from "./protocol.ts";
import { Signal } from "./signal.ts";

/** A position of a player: space, x, y. */
export type Place = [number, number, number];
/** The positions of each player over some frames. */
export type Paths = Place[][];

/** Whether time stands, passes with new steps, or shows the history again. */
export type Mode = "paused" | "live" | "replay";

/** Maximum number of steps that are made up for after the page was slow. */
const MAX_STEPS = 8;
/** Maximum number of marks on the timeline. */
const MAX_MARKS = 5000;

export class Game {
  scene: Scene | null = null;
  opened: Opened | null = null;
  frame: Frame | null = null;
  before: Frame | null = null;
  readonly now = new BodyIndex();
  readonly then = new BodyIndex();
  length = 0;
  ended: string | null = null;
  /** Whether the first frame is a state from before a change: no inputs lead there from the start of the world. */
  isCarried = false;
  marks: EventInfo[] = [];
  mode: Mode = "paused";
  speed = 1;
  /** The part of the history that is shown again and again. */
  loop: [number, number] | null = null;
  /** Where the run before the last change went. */
  ghost: Paths = [];
  /** The frame at which the ghost begins. */
  ghostStart = 0;
  /** The script before a take-over, so that it can be undone. */
  dropped: string | null = null;
  /** The inputs that are held now. */
  sample: () => Held[] = () => [];

  /** A program was opened, or changed. */
  readonly onOpened = new Signal<Opened>();
  /** Another scene: its bodies, tiles and players may differ. */
  readonly onScene = new Signal<Scene>();
  readonly onShown = new Signal();
  readonly onMode = new Signal();
  readonly onTrouble = new Signal<string>();
  /** The file of a picture has changed. */
  readonly onPictures = new Signal();

  private owed = 0;
  /** The request to step that is under way. */
  private asking: Promise<void> | null = null;
  private last = 0;

  constructor(readonly carrier: Carrier) {}

  /** How far time is between the frame before and the frame that is shown, from 0 to 1. */
  get between(): number {
    if (this.mode === "paused" || !this.scene) return 1;
    return Math.min(1, this.owed / this.scene.step);
  }

  /** Opens a world, from its first state. */
  async open(world: string | null = null): Promise<void> {
    await this.attempt(async () => {
      const opened = await ask(this.carrier, "opened", { ask: "open", world });
      this.ghost = [];
      this.marks = [];
      this.pause();
      this.takeOpened(opened);
    });
  }

  /** Asks for a change after which the program is another. */
  async change(request: Parameters<Carrier["ask"]>[0]): Promise<Opened | null> {
    let result: Opened | null = null;
    await this.attempt(async () => {
      result = await ask(this.carrier, "opened", request);
      this.takeOpened(result);
    });
    return result;
  }

  /** A program was opened, or changed. */
  takeOpened(opened: Opened): void {
    this.opened = opened;
    const isNew = JSON.stringify(opened.scene) !== JSON.stringify(this.scene);
    this.scene = opened.scene;
    if (opened.is_current && (opened.ghost.length > 0 || opened.shown?.is_carried)) {
      this.ghost = opened.ghost;
      this.ghostStart = 0;
    }
    if (opened.shown) {
      if (opened.is_current) this.marks = [];
      this.take(opened.shown);
    }
    if (opened.scene && isNew) this.onScene.emit(opened.scene);
    this.onOpened.emit(opened);
  }

  private take(shown: Shown): void {
    this.frame = shown.frame;
    this.before = shown.before;
    const slots = this.scene?.slots.length ?? 0;
    this.now.read(this.frame, slots);
    this.then.read(this.before, slots);
    this.length = shown.length;
    this.ended = shown.ended;
    this.isCarried = shown.is_carried;
    for (const event of shown.events) if (this.marks.length < MAX_MARKS) this.marks.push(event);
    if (this.ended && this.mode === "live") this.pause();
    this.onShown.emit();
  }

  /** Lets time pass: steps with what is held now. Called once for each frame of the display. */
  tick(now: number): void {
    const passed = Math.min(0.25, Math.max(0, (now - this.last) / 1000));
    this.last = now;
    if (this.mode === "paused" || !this.scene || !this.frame) return;
    this.owed = Math.min(this.owed + passed * this.speed, MAX_STEPS * this.scene.step);
    const steps = Math.floor(this.owed / this.scene.step + 1e-6);
    if (steps < 1 || this.asking) return;
    if (this.mode === "live") void this.step(steps);
    else void this.again(steps);
  }

  private async step(count: number): Promise<void> {
    const held = this.sample();
    const inputs = Array.from({ length: count }, () => held);
    await this.passing(count, async () => this.take(await ask(this.carrier, "shown", { ask: "play", inputs })));
  }

  private async again(count: number): Promise<void> {
    const at = this.frame?.at ?? 0;
    const end = this.loop ? this.loop[1] : this.length;
    let next = at + count;
    if (at >= end && this.loop) next = this.loop[0];
    next = Math.min(next, Math.max(end, at));
    await this.passing(count, async () => this.take(await ask(this.carrier, "shown", { ask: "seek", frame: next })));
    if (!this.loop && next >= this.length && this.mode === "replay") this.pause();
  }

  private async passing(steps: number, work: () => Promise<void>): Promise<void> {
    this.asking = this.attempt(work);
    await this.asking;
    this.asking = null;
    this.owed = Math.max(0, this.owed - steps * (this.scene?.step ?? 1));
  }

  private async attempt(work: () => Promise<void>): Promise<void> {
    try {
      await work();
    } catch (error) {
      this.pause();
      this.onTrouble.emit(error instanceof Error ? error.message : String(error));
    }
  }

  pause(): void {
    if (this.mode === "paused") return;
    this.mode = "paused";
    this.owed = 0;
    this.onMode.emit();
  }

  /** Goes on: with new steps at the end of the history, else by showing what comes. */
  resume(): void {
    if (!this.scene || !this.frame) return;
    if (this.frame.at >= this.length && !this.loop) {
      if (this.ended) return this.onTrouble.emit(`The run is over: ${this.ended}. Go back in time, or start again.`);
      return this.live();
    }
    this.mode = "replay";
    this.owed = 0;
    this.onMode.emit();
  }

  toggle(): void {
    if (this.mode === "paused") this.resume();
    else this.pause();
  }

  /** Plays on from the frame that is shown; what the history has after it becomes a ghost. */
  async takeOver(): Promise<void> {
    if (!this.scene || !this.frame || this.mode === "live") return;
    const at = this.frame.at;
    this.dropped = null;
    if (at < this.length && !this.isCarried) {
      await this.attempt(async () => {
        this.dropped = (await ask(this.carrier, "text", { ask: "script" })).text;
      });
      this.marks = this.marks.filter((mark) => mark.frame <= at);
    }
    this.loop = null;
    this.live();
  }

  private live(): void {
    this.mode = "live";
    this.owed = 0;
    this.onMode.emit();
  }

  /** Shows another frame. */
  async seek(frame: number): Promise<void> {
    this.pause();
    await this.show(frame);
  }

  private wanted: number | null = null;

  /** Shows the latest frame that was asked for; those in between are left out while the session is busy. */
  private async show(frame: number): Promise<void> {
    const isWaiting = this.wanted !== null;
    this.wanted = Math.max(0, Math.min(this.length, Math.round(frame) || 0));
    if (isWaiting) return;
    while (this.wanted !== null) {
      const next: number = this.wanted;
      await this.attempt(async () => this.take(await ask(this.carrier, "shown", { ask: "seek", frame: next })));
      if (this.wanted === next) this.wanted = null;
    }
  }

  /** One step ahead or back; at the end, ahead is a new step with what is held. */
  async stepBy(count: number): Promise<void> {
    this.pause();
    while (this.asking) await this.asking;
    if (!this.frame) return;
    if (count > 0 && this.frame.at >= this.length) {
      if (!this.ended) await this.step(count);
    } else {
      await this.show((this.wanted ?? this.frame.at) + count);
    }
  }

  /** Goes back to the start of the world. */
  async restart(): Promise<void> {
    this.loop = null;
    // The history begins with another state.
    if (this.isCarried) await this.load("");
    else await this.seek(0);
  }

  /** Says whether the state goes on after a change; otherwise the inputs are played again. */
  async keep(state: boolean): Promise<void> {
    await this.attempt(async () => {
      await ask(this.carrier, "done", { ask: "keep", state });
    });
  }

  /** The inputs so far as a script. */
  async script(): Promise<string> {
    return (await ask(this.carrier, "text", { ask: "script" })).text;
  }

  /** Replaces the history by a script and shows the frame that is wanted of it; the first one if none is. */
  async load(script: string, frame = 0): Promise<boolean> {
    let isLoaded = false;
    await this.attempt(async () => {
      this.pause();
      this.loop = null;
      const shown = await ask(this.carrier, "shown", { ask: "load", script });
      this.marks = [];
      this.take(shown);
      isLoaded = true;
    });
    if (isLoaded) await this.show(frame);
    return isLoaded;
  }

  /** The positions to come, if an input is held; none if the session does not say. */
  async predict(input: Held[], steps: number): Promise<Paths> {
    const answer = await this.carrier.ask({ ask: "predict", input, steps });
    return answer.answer === "predicted" ? answer.paths : [];
  }

  async search(target: Target, nodes: number): Promise<string | null> {
    const answer = await this.carrier.ask({ ask: "search", target, nodes, seed: 1 });
    return answer.answer === "refused" ? answer.message : null;
  }
}
