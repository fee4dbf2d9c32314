// The goals and `never`s of the world as badges: they light up when they hold, and keep a mark once they did.

import type { Game } from "../game.ts";
import { h } from "./dom.ts";

export class Goals {
  readonly element = h("ul", { class: "badges", "aria-label": "Goals" });
  private badges: { kind: "goal" | "never"; index: number; name: string; element: HTMLElement; state: string }[] = [];

  constructor(
    private readonly game: Game,
    private readonly tell: (text: string, isGood: boolean) => void,
  ) {
    game.onScene.on((scene) => {
      const badge = (kind: "goal" | "never", name: string, index: number): (typeof this.badges)[number] => ({
        kind,
        index,
        name,
        element: h("li", { class: `badge ${kind}`, title: `${kind} ${name}` }, name),
        state: "",
      });
      this.badges = [
        ...scene.goals.map((name, index) => badge("goal", name, index)),
        ...scene.nevers.map((name, index) => badge("never", name, index)),
      ];
      this.element.replaceChildren(...this.badges.map((of) => of.element));
      this.element.hidden = this.badges.length === 0;
    });
    game.onShown.on(() => this.update());
    game.onOpened.on(() => this.update());
  }

  private update(): void {
    const { frame, marks, mode } = this.game;
    if (!frame) return;
    for (const badge of this.badges) {
      const holds = (badge.kind === "goal" ? frame.goals : frame.nevers).includes(badge.index);
      let state = holds ? "holds" : "open";
      if (!holds) {
        for (const mark of marks) {
          if (mark.kind === badge.kind && mark.name === badge.name && mark.frame <= frame.at) state = "held";
        }
      }
      if (state === badge.state) continue;
      const isNew = state === "holds" && badge.state === "open" && mode === "live";
      badge.state = state;
      badge.element.dataset.state = state;
      const words = badge.kind === "goal" ? { holds: "reached", held: "reached before", open: "not reached" } : { holds: "violated", held: "violated before", open: "kept" };
      badge.element.setAttribute("aria-label", `${badge.kind} ${badge.name}: ${words[state as keyof typeof words]}`);
      if (isNew && badge.kind === "goal") this.tell(`Goal ${badge.name} reached`, true);
      if (isNew && badge.kind === "never") this.tell(`Never ${badge.name}: violated`, false);
    }
  }
}
