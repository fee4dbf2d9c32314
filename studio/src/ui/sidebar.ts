// The panel beside the stage: tabs that are reached with arrow keys, as WAI-ARIA describes them.

import { recall, remember } from "../memory.ts";
import { h, iconButton } from "./dom.ts";

/** A page of the panel. */
export interface Panel {
  id: string;
  title: string;
  element: HTMLElement;
  /** Called when it is shown or hidden. */
  shown?(isShown: boolean): void;
  /** How much width it needs, if more than usual. */
  width?: "roomy" | "wide";
}

export class Sidebar {
  readonly element: HTMLElement;
  private readonly tabs: HTMLButtonElement[];
  private readonly list: HTMLElement;
  current = "";
  isOpen = true;

  constructor(
    private readonly panels: Panel[],
    private readonly resized: () => void,
  ) {
    this.tabs = panels.map((panel) =>
      h(
        "button",
        {
          type: "button",
          role: "tab",
          id: `tab-${panel.id}`,
          "aria-controls": `panel-${panel.id}`,
          onclick: () => this.show(panel.id),
        },
        panel.title,
      ),
    );
    for (const panel of panels) {
      panel.element.id = `panel-${panel.id}`;
      panel.element.classList.add("panel");
      panel.element.setAttribute("role", "tabpanel");
      panel.element.setAttribute("aria-labelledby", `tab-${panel.id}`);
      panel.element.tabIndex = 0;
    }
    this.list = h("div", { class: "tabs", role: "tablist", "aria-label": "Panels", onkeydown: (event: KeyboardEvent) => this.move(event) }, ...this.tabs);
    this.element = h(
      "aside",
      { class: "sidebar", "aria-label": "Side panel" },
      h("div", { class: "tab-row" }, this.list, iconButton("close", "Close the panel", () => this.open(false))),
      ...panels.map((panel) => panel.element),
    );
    const stored = recall("panel");
    const first = panels.find((panel) => panel.id === stored) ?? panels[0]!;
    this.show(first.id);
    // On a phone, the game comes first.
    this.open(!matchMedia("(max-width: 760px)").matches);
  }

  open(isOpen: boolean): void {
    this.isOpen = isOpen;
    document.body.classList.toggle("no-sidebar", !isOpen);
    for (const panel of this.panels) panel.shown?.(isOpen && panel.id === this.current);
    this.resized();
  }

  show(id: string): void {
    this.current = id;
    remember("panel", id);
    this.panels.forEach((panel, at) => {
      const isCurrent = panel.id === id;
      const tab = this.tabs[at]!;
      tab.setAttribute("aria-selected", String(isCurrent));
      tab.tabIndex = isCurrent ? 0 : -1;
      panel.element.hidden = !isCurrent;
      if (isCurrent) this.element.className = `sidebar ${panel.width ?? ""}`;
    });
    this.open(true);
  }

  private move(event: KeyboardEvent): void {
    const at = this.tabs.findIndex((tab) => tab === document.activeElement);
    const to = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: this.tabs.length - 1 }[event.key];
    if (at < 0 || to === undefined) return;
    event.preventDefault();
    const next = (to + this.tabs.length) % this.tabs.length;
    this.show(this.panels[next]!.id);
    this.tabs[next]!.focus();
  }
}
