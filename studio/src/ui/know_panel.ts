// What is known about an instance: its modes, values, contacts, and of each edge whether its guard holds, part by part.

import { ask } from "../carrier.ts";
import type { Stage } from "../draw/stage.ts";
import type { Game } from "../game.ts";
import type { Atom, EdgeState, Inspected, Place, Value } from "../protocol.ts";
import { button, h, section, short } from "./dom.ts";
import type { Panel } from "./sidebar.ts";

/** Time between two questions while time passes, ms. */
const PAUSE = 120;

/** A set of modes as a key. */
const modesKey = (modes: number[]): string => [...modes].sort((a, b) => a - b).join();

export class KnowPanel implements Panel {
  readonly id = "know";
  readonly title = "Know";
  readonly width = "roomy";
  readonly element = h("div");
  private readonly choice = h("select", { "aria-label": "Instance" });
  private readonly modes = h("ul", { class: "chips", "aria-label": "Active modes" });
  private readonly values = h("table", { class: "values" });
  private readonly contacts = h("ul", { class: "chips" });
  private readonly chart = h("div", { class: "chart", tabindex: 0, role: "region", "aria-label": "Statechart" });
  private readonly edges = h("div", { class: "edges" });
  private readonly bounds = new Map<string, string>();
  /** For each set of modes that can be active together, what values can be then. */
  private readonly boundsInModes = new Map<string, Map<string, string>>();
  private readonly boundsButton = button("Show what each value can be", () => void this.askBounds(), "small");
  private chartOf = "";
  private isShown = false;
  private isAsking = false;
  private last = 0;
  private edge: number | null = null;
  /** The last answer, for the overlay of contacts. */
  inspected: Inspected | null = null;

  constructor(
    private readonly game: Game,
    private readonly stage: Stage,
    private readonly goTo: (place: Place) => void,
  ) {
    this.element.append(
      h("label", { class: "row" }, "Instance ", this.choice),
      this.modes,
      section("Values", this.values, this.boundsButton),
      section("Touches", this.contacts),
      section("Statechart", this.chart),
      section("Edges tried in this step", this.edges),
    );
    this.choice.addEventListener("change", () => this.select(Number(this.choice.value)));
    this.chart.addEventListener("click", (event) => this.clickChart(event));
    game.onScene.on((scene) => {
      this.chartOf = "";
      this.bounds.clear();
      this.boundsInModes.clear();
      this.boundsButton.hidden = false;
      this.choice.replaceChildren(...scene.slots.map((slot, at) => h("option", { value: at }, slot.name)));
      if (stage.selected === null || stage.selected >= scene.slots.length) stage.selected = null;
      this.update(true);
    });
    game.onShown.on(() => this.update(game.mode === "paused"));
    game.onMode.on(() => this.update(true));
  }

  shown(isShown: boolean): void {
    this.isShown = isShown;
    if (isShown) this.update(true);
  }

  /** The instance that is looked at: the chosen one, else the first player. */
  slot(): number {
    return this.stage.selected ?? this.game.scene?.players[0]?.slot ?? 0;
  }

  select(slot: number | null): void {
    this.stage.selected = slot;
    this.edge = null;
    this.checkBounds();
    this.update(true);
  }

  private wantsAgain = false;

  private update(isUrgent: boolean): void {
    if (!this.isShown || !this.game.scene?.slots.length) return;
    if (this.isAsking) {
      this.wantsAgain ||= isUrgent;
      return;
    }
    if (!isUrgent && performance.now() - this.last < PAUSE) return;
    void this.refresh();
  }

  private async refresh(): Promise<void> {
    this.isAsking = true;
    do {
      this.wantsAgain = false;
      this.last = performance.now();
      try {
        const of = await ask(this.game.carrier, "inspected", { ask: "inspect", slot: this.slot() });
        this.inspected = of;
        this.render(of);
        await this.showChart(of);
      } catch {
        // The program has errors, or the slot is of another scene.
      }
    } while (this.wantsAgain);
    this.isAsking = false;
  }

  private render(of: Inspected): void {
    const scene = this.game.scene;
    const info = scene?.slots[of.slot];
    const entity = info && scene?.entities[info.entity];
    if (!entity) return;
    this.choice.value = String(of.slot);
    const active = of.is_alive ? of.modes.map((mode) => entity.modes[mode] ?? "") : ["not there"];
    // Modes inside of active modes say their outer ones.
    const inner = active.filter((path) => !active.some((other) => other.startsWith(`${path}.`)));
    this.modes.replaceChildren(...inner.map((path) => h("li", { class: "chip mode" }, path)));
    this.renderValues(of.values, of.is_alive ? modesKey(of.modes) : "");
    this.contacts.replaceChildren(
      ...(of.contacts.length > 0 ? of.contacts.map(({ text, side }) => h("li", { class: "chip" }, side && !text.includes(side) ? `${text} (${side})` : text)) : [h("li", { class: "quiet" }, "nothing")]),
    );
    this.renderEdges(of.edges, entity.modes);
  }

  private renderValues(values: Value[], modes: string): void {
    const hasBounds = this.bounds.size > 0;
    // With one set of modes alone, both columns would be the same.
    const here = this.boundsInModes.size > 1 ? this.boundsInModes.get(modes) : undefined;
    const names: Record<string, string> = { variable: "", discrete: "", timer: "time in ", reference: "", parameter: "" };
    const row = (value: Value): HTMLElement =>
      h(
        "tr",
        { class: value.kind },
        h("th", { scope: "row" }, `${names[value.kind] ?? ""}${value.name}`),
        h("td", {}, value.value),
        here ? h("td", { class: "can-be" }, here.get(`${value.kind} ${value.name}`) ?? "") : null,
        hasBounds ? h("td", { class: "can-be" }, this.bounds.get(`${value.kind} ${value.name}`) ?? "") : null,
      );
    this.values.replaceChildren(
      hasBounds && this.game.isCarried ? h("caption", { class: "quiet" }, "What values can be from the start of the world. This run goes on from a state of the program before.") : "",
      h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "Name"), h("th", { scope: "col" }, "Is"), here ? h("th", { scope: "col" }, "Can be in these modes") : null, hasBounds ? h("th", { scope: "col" }, here ? "At all" : "Can be") : null)),
      h("tbody", {}, ...values.map(row)),
    );
  }

  private renderEdges(edges: EdgeState[], modes: string[]): void {
    const shown = this.edge === null ? edges : edges.filter((edge) => edge.edge === this.edge);
    const atom = (of: Atom): HTMLElement => {
      const state = of.held === null ? "unknown" : of.held ? "true" : "false";
      const sides = of.sides ? h("span", { class: "quiet" }, ` ${short(of.sides[0], 3)} | ${short(of.sides[1], 3)}`) : null;
      return h("li", { class: `atom ${state}` }, h("span", { class: "truth" }, of.held ? "✓" : of.held === null ? "?" : "✗"), h("code", {}, of.text), sides, h("span", { class: "sr" }, state));
    };
    const item = (edge: EdgeState): HTMLElement => {
      const target = edge.to === null ? "stays" : `→ ${modes[edge.to] ?? ""}`;
      const state = edge.taken ? "taken" : edge.held ? "held, an earlier edge came first" : "guard false";
      return h(
        "div",
        { class: `edge ${edge.taken ? "taken" : edge.held ? "held" : ""}` },
        h("div", { class: "edge-head" }, h("strong", {}, `${modes[edge.from] ?? ""} ${target}`), h("span", { class: "quiet" }, ` ${state}`), edge.place ? button(`line ${edge.place.line}`, () => this.goTo(edge.place!), "link") : null),
        h("ul", { class: "atoms" }, ...edge.atoms.map(atom)),
      );
    };
    const all = this.edge === null ? null : button("Show all edges", () => this.pickEdge(null), "small");
    const none = shown.length > 0 ? null : h("p", { class: "quiet" }, this.edge === null ? "No step led to this frame, or no edge leaves the active modes." : "Its mode was not active before this step, so that it was not tried.");
    this.edges.replaceChildren(...[all, none, ...shown.map(item)].filter((of): of is HTMLElement => of !== null));
  }

  private pickEdge(edge: number | null): void {
    this.edge = edge;
    this.update(true);
  }

  private clickChart(event: MouseEvent): void {
    const target = (event.target as Element).closest("[data-edge]");
    if (!target) return;
    this.pickEdge(Number(target.getAttribute("data-edge")));
    this.edges.scrollIntoView({ block: "nearest" });
  }

  private async showChart(of: Inspected): Promise<void> {
    const scene = this.game.scene;
    const entity = scene && scene.entities[scene.slots[of.slot]?.entity ?? -1];
    if (!entity) return;
    if (this.chartOf !== entity.name) {
      const answer = await ask(this.game.carrier, "chart", { ask: "chart", entity: entity.name });
      const svg = new DOMParser().parseFromString(answer.svg, "image/svg+xml").documentElement;
      this.chart.replaceChildren(document.importNode(svg, true));
      this.chartOf = entity.name;
    }
    const active = new Set(of.is_alive ? of.modes : []);
    for (const element of this.chart.querySelectorAll("[data-mode]")) {
      element.classList.toggle("active", active.has(Number(element.getAttribute("data-mode"))));
    }
    const states = new Map(of.edges.map((edge) => [edge.edge, edge]));
    for (const element of this.chart.querySelectorAll("[data-edge]")) {
      const edge = states.get(Number(element.getAttribute("data-edge")));
      element.classList.toggle("taken", edge?.taken ?? false);
      element.classList.toggle("tried", edge !== undefined);
    }
  }

  private async askBounds(): Promise<void> {
    this.boundsButton.disabled = true;
    this.boundsButton.textContent = "Analysing…";
    const scene = this.game.scene;
    try {
      for (;;) {
        const answer = await ask(this.game.carrier, "bounds", { ask: "bounds", slot: this.slot() });
        if (this.game.scene !== scene) break;
        if (answer.is_ready) {
          this.bounds.clear();
          this.boundsInModes.clear();
          const names = answer.values.map((of) => `${of.kind} ${of.name}`);
          answer.values.forEach((of, at) => this.bounds.set(names[at]!, of.value));
          for (const { modes, values } of answer.in_modes) {
            this.boundsInModes.set(modesKey(modes), new Map(values.map((value, at) => [names[at]!, value])));
          }
          this.boundsFor = this.slot();
          break;
        }
        await new Promise((done) => setTimeout(done, 150));
      }
    } catch {
      // Nothing is known.
    }
    this.boundsButton.disabled = false;
    this.boundsButton.textContent = "Show what each value can be";
    this.boundsButton.hidden = this.bounds.size > 0;
    this.update(true);
  }

  private boundsFor = -1;

  /** Forgets the bounds of another instance. */
  private checkBounds(): void {
    if (this.boundsFor >= 0 && this.boundsFor !== this.slot()) {
      this.bounds.clear();
      this.boundsInModes.clear();
      this.boundsFor = -1;
      this.boundsButton.hidden = false;
    }
  }
}
