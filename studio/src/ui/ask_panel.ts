// Reach from here: a goal, a `never`, a predicate or a place; the search is drawn over the level while it runs.

import { ask } from "../carrier.ts";
import type { Overlays } from "../draw/overlays.ts";
import type { Game, Place } from "../game.ts";
import type { Searching, Target } from "../protocol.ts";
import { button, h, section } from "./dom.ts";
import type { Panel } from "./sidebar.ts";
import type { Toasts } from "./toasts.ts";

/** Time between two looks at a search, ms. */
const PAUSE = 80;
const BUDGETS = [2_000, 20_000, 100_000, 500_000];

export class AskPanel implements Panel {
  readonly id = "ask";
  readonly title = "Ask";
  readonly element = h("div");
  picksPlace = false;
  private readonly choices = h("div", { class: "choices", role: "radiogroup", "aria-label": "What to reach" });
  private readonly predicate = h("input", { type: "text", class: "predicate", "aria-label": "Predicate", spellcheck: "false" });
  private readonly budget = h("select", { "aria-label": "Nodes" }, ...BUDGETS.map((of) => h("option", { value: of, selected: of === 20_000 }, `${of.toLocaleString("en")} nodes`)));
  private readonly start = button("Reach from here", () => void this.search(), "primary");
  private readonly stop = button("Stop", () => void this.game.carrier.ask({ ask: "stop" }));
  private readonly bar = h("progress", { max: 1, value: 0, "aria-label": "Progress of the search" });
  private readonly state = h("p", { class: "quiet", role: "status" });
  private readonly result = h("div", { class: "result" });
  private choice = "";
  private place: Place | null = null;
  private run = 0;

  constructor(
    private readonly game: Game,
    private readonly overlays: Overlays,
    private readonly toasts: Toasts,
  ) {
    this.stop.hidden = true;
    this.bar.hidden = true;
    this.predicate.addEventListener("focus", () => this.choose("predicate"));
    this.element.append(
      section("What can be reached from this frame?", this.choices, h("div", { class: "buttons-row" }, this.budget, this.start, this.stop)),
      this.bar,
      this.state,
      this.result,
    );
    game.onScene.on(() => this.build());
  }

  private build(): void {
    const scene = this.game.scene;
    if (!scene) return;
    const radio = (id: string, ...label: (Node | string)[]): HTMLElement =>
      h("label", { class: "radio" }, h("input", { type: "radio", name: "target", value: id, onchange: () => this.choose(id) }), ...label);
    const player = scene.slots[scene.players[0]?.slot ?? 0]?.name ?? "hero";
    this.predicate.placeholder = `${player}.x > 100`;
    this.choices.replaceChildren(
      ...scene.goals.map((name) => radio(`goal ${name}`, `goal ${name}`)),
      ...scene.nevers.map((name) => radio(`never ${name}`, `violation of never ${name}`)),
      radio("place", "a place: click into the level"),
      radio("predicate", "when ", this.predicate),
    );
    this.choose(scene.goals[0] !== undefined ? `goal ${scene.goals[0]}` : "place");
  }

  private choose(id: string): void {
    this.choice = id;
    this.picksPlace = id === "place";
    for (const input of this.choices.querySelectorAll<HTMLInputElement>("input[type=radio]")) input.checked = input.value === id;
    if (!this.picksPlace) this.overlays.target = null;
  }

  /** A place in the level was clicked. */
  setPlace(place: Place): void {
    this.place = place;
    void this.search();
  }

  private target(): Target | string {
    const [kind, ...rest] = this.choice.split(" ");
    const name = rest.join(" ");
    if (kind === "goal") return { goal: name };
    if (kind === "never") return { never: name };
    if (kind === "place") return this.place ? { place: this.place } : "Click into the level to choose a place.";
    const predicate = this.predicate.value.trim() || this.predicate.placeholder;
    return { predicate };
  }

  private async search(): Promise<void> {
    const { game, overlays } = this;
    const target = this.target();
    if (typeof target === "string") return this.toasts.show(target);
    const run = ++this.run;
    game.pause();
    overlays.clearHeat();
    overlays.found = [];
    this.result.replaceChildren();
    const refusal = await game.search(target, Number(this.budget.value));
    if (refusal !== null) {
      this.state.textContent = "";
      this.result.replaceChildren(h("p", { class: "verdict bad" }, refusal));
      return;
    }
    const from = game.frame?.at ?? 0;
    this.start.disabled = true;
    this.stop.hidden = false;
    this.bar.hidden = false;
    let searching: Searching | null = null;
    do {
      await new Promise((done) => setTimeout(done, PAUSE));
      try {
        searching = await ask(game.carrier, "searching", { ask: "poll" });
      } catch (error) {
        // The program has changed meanwhile.
        this.state.textContent = error instanceof Error ? error.message : "";
        break;
      }
      if (run !== this.run) return;
      overlays.addHeat(searching.points);
      this.bar.value = Math.min(1, searching.nodes / Math.max(1, searching.budget));
      this.state.textContent = `${searching.nodes.toLocaleString("en")} nodes, ${searching.places.toLocaleString("en")} places`;
    } while (searching.is_running);
    this.start.disabled = false;
    this.stop.hidden = true;
    this.bar.hidden = true;
    if (searching?.verdict) this.show(searching, from);
  }

  private show(found: Searching, from: number): void {
    const { game, overlays } = this;
    const isReached = found.script !== null;
    const [first, ...reasons] = (found.verdict ?? "").split("; ");
    const isProof = found.conclusion?.includes("unreachable") ?? false;
    this.result.replaceChildren(
      h("p", { class: `verdict ${isReached ? "good" : isProof ? "proof" : ""}` }, first ?? ""),
      ...reasons.map((reason) => h("p", { class: "reason" }, reason)),
    );
    overlays.found = found.ghost;
    overlays.foundStart = from;
    const { script } = found;
    if (script !== null) {
      this.result.append(
        h(
          "div",
          { class: "buttons-row" },
          button("Play the path", () => void game.load(script, from).then((isLoaded) => isLoaded && game.resume()), "primary"),
          button("Load it", () => void game.load(script, from)),
        ),
      );
    }
    if (overlays.points > 0) {
      this.result.append(
        h("p", { class: "quiet" }, "Violet: the tree of the search and its places, darker where there are more. Red lines: ground with none of them on it."),
        button("Clear the drawing", () => {
          overlays.clearHeat();
          overlays.found = [];
        }, "small"),
      );
    }
  }
}
