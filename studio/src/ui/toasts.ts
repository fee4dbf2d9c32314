// Short messages over the stage; screen readers say them.

import { button, h, iconButton } from "./dom.ts";

/** How long a message stays, ms. */
const STAY = 6000;

export class Toasts {
  readonly element = h("div", { class: "toasts", role: "status", "aria-live": "polite" });

  /** Shows a message; with an action, it has a button. */
  show(text: string, kind: "note" | "good" | "bad" = "note", action?: { text: string; run: () => void }): void {
    const known = [...this.element.children].find((of) => (of as HTMLElement).dataset.text === text);
    known?.remove();
    const toast = h("div", { class: `toast ${kind}`, "data-text": text }, h("span", {}, text));
    const close = (): void => toast.remove();
    if (action) {
      toast.append(
        button(action.text, () => {
          action.run();
          close();
        }),
      );
    }
    toast.append(iconButton("close", "Dismiss", close));
    this.element.append(toast);
    while (this.element.children.length > 3) this.element.firstElementChild?.remove();
    setTimeout(close, action ? 2 * STAY : STAY);
  }
}
