// The first panel: the keys, what the colours mean, what is shown on request, and the run as a script.

import type { Paint } from "../draw/colors.ts";
import type { Stage } from "../draw/stage.ts";
import type { Game } from "../game.ts";
import { type Action, keyName } from "../input/actions.ts";
import type { Inputs } from "../input/keys.ts";
import { recall, remember } from "../memory.ts";
import { button, h, section, toggle } from "./dom.ts";
import type { Panel } from "./sidebar.ts";
import type { Toasts } from "./toasts.ts";

export class PlayPanel implements Panel {
  readonly id = "play";
  readonly title = "Play";
  readonly element = h("div");
  private readonly world = h("select", { "aria-label": "World" });
  private readonly worldRow = h("label", { class: "row", hidden: true }, "World ", this.world);
  private readonly keys = h("div", { class: "keys" });
  private readonly legend = h("ul", { class: "legend" });

  constructor(
    private readonly game: Game,
    private readonly stage: Stage,
    private readonly inputs: Inputs,
    private readonly toasts: Toasts,
  ) {
    const shows = stage.shows;
    const shown = (text: string, name: keyof typeof shows, key?: string): HTMLElement =>
      toggle(text, shows[name], (isOn) => {
        shows[name] = isOn;
        stage.onShows.emit();
      }, key);
    this.element.append(
      this.worldRow,
      section("Keys", this.keys),
      section("Legend", this.legend),
      section(
        "Show",
        shown("Contacts and their sides", "contacts"),
        shown("Sensors", "sensors"),
        shown("Names", "names"),
        shown("Grid", "grid"),
      ),
      section("This run", this.run()),
      section("After a change of the text", this.afterChange()),
    );
    this.world.addEventListener("change", () => void game.open(this.world.value));
    game.onOpened.on((opened) => {
      this.worldRow.hidden = opened.worlds.length < 2;
      this.world.replaceChildren(...opened.worlds.map((name) => h("option", { value: name, selected: name === opened.scene?.world }, name)));
    });
    inputs.onActions.on(() => this.showKeys());
    stage.onColors.on(() => this.showLegend());
  }

  /** What goes on when the program is another one. */
  private afterChange(): HTMLElement {
    const keeps = recall("keep") === "state";
    if (keeps) void this.game.keep(true);
    const radio = (value: string, text: string, isChecked: boolean): HTMLElement => {
      const input = h("input", { type: "radio", name: "keep", value, checked: isChecked, onchange: () => {
        remember("keep", value);
        void this.game.keep(value === "state");
      } });
      return h("label", { class: "radio" }, input, text);
    };
    return h(
      "div",
      { class: "choices", role: "radiogroup", "aria-label": "After a change of the text" },
      radio("inputs", "play the inputs again, with the run before as a ghost", !keeps),
      radio("state", "go on from this state, by names", keeps),
    );
  }

  private showKeys(): void {
    const { inputs } = this;
    const players = [...new Set(inputs.actions.map((action) => action.player))];
    const row = (action: Action): HTMLElement => {
      const keys = action.keys.map(keyName).join(" or ") || "none";
      const key = h(
        "button",
        { type: "button", class: "key", "aria-label": `${action.label}: ${keys}. Change`, title: "Change the key" },
        ...(action.keys.length > 0 ? action.keys.map((code) => h("kbd", {}, keyName(code))) : [h("kbd", {}, "–")]),
      );
      key.addEventListener("click", () => this.capture(action, key));
      return h("div", { class: "key-row" }, h("span", {}, action.label), key);
    };
    const table = (player: number): HTMLElement => {
      const number = this.game.scene?.players[player]?.number ?? player + 1;
      const rows = inputs.actions.filter((action) => action.player === player).map(row);
      return h("div", {}, players.length > 1 ? h("h3", {}, `Player ${number}`) : null, ...rows);
    };
    const none = inputs.actions.length === 0 ? h("p", { class: "quiet" }, "This world has no inputs: it runs by itself.") : null;
    this.keys.replaceChildren(
      ...players.map(table),
      none ?? button("Reset keys", () => inputs.reset(), "small"),
      h("p", { class: "quiet" }, "Gamepads work, too. Other keys: ", h("kbd", {}, "P"), " pause, ", h("kbd", {}, ","), " ", h("kbd", {}, "."), " steps, ", h("kbd", {}, "R"), " start again, ", h("kbd", {}, "T"), " take over, ", h("kbd", {}, "M"), " map."),
    );
  }

  /** The next key is that of the action. */
  private capture(action: Action, element: HTMLButtonElement): void {
    element.replaceChildren("press a key");
    element.classList.add("capturing");
    const done = (): void => {
      removeEventListener("keydown", take, true);
      element.removeEventListener("blur", cancel);
    };
    const cancel = (): void => {
      done();
      this.showKeys();
    };
    const take = (event: KeyboardEvent): void => {
      if (event.code === "Tab") return;
      event.preventDefault();
      event.stopPropagation();
      done();
      if (event.code === "Escape") return this.showKeys();
      this.inputs.assign(action, event.code);
    };
    addEventListener("keydown", take, true);
    element.addEventListener("blur", cancel);
  }

  private showLegend(): void {
    const { colors } = this.stage;
    const scene = this.game.scene;
    if (!colors || !scene) return;
    const words = { solid: "solid", one_way: "solid from above", sensed: "sensed", scenery: "no contact" };
    const used = new Set(scene.slots.map((slot) => slot.entity));
    const swatch = (paint: Paint, kind: string): HTMLElement => {
      const picture = colors.picture(paint);
      if (picture) return h("img", { class: "swatch picture", src: picture.src, alt: "" });
      const element = h("span", { class: `swatch ${kind}${paint.isLook ? " look" : ""}` });
      element.style.setProperty("--color", paint.fill);
      return element;
    };
    this.legend.replaceChildren(
      ...colors.kinds.map((kind) =>
        h("li", {}, swatch(kind.paint, kind.role), kind.name, h("span", { class: "quiet" }, ` ${words[kind.role]}`)),
      ),
      ...[...used].map((entity) =>
        h("li", {}, swatch(colors.entity(entity), "body"), scene.entities[entity]!.name),
      ),
    );
  }

  private run(): HTMLElement {
    const { game, toasts } = this;
    const file = h("input", { type: "file", accept: ".inputs,text/plain", hidden: true, "aria-label": "Script of inputs", tabindex: -1 });
    file.addEventListener("change", () => {
      const chosen = file.files?.[0];
      file.value = "";
      if (!chosen) return;
      void chosen.text().then(async (text) => {
        if (await game.load(text)) toasts.show(`${chosen.name}: ${game.length} steps`, "good");
      });
    });
    const name = (): string => (game.scene?.path.split(/[\\/]/).pop() ?? "game").replace(/\.hyped$/, ".inputs");
    const save = async (): Promise<void> => {
      const text = `${await game.script()}\n`;
      if (!game.carrier.canSave) return download(name(), text);
      const why = await game.carrier.save(name(), text);
      toasts.show(why ?? `Saved as ${name()} beside the program`, why ? "bad" : "good");
    };
    const copy = async (): Promise<void> => {
      const scene = game.scene;
      if (!scene) return;
      const held = game.marks.filter((mark) => mark.kind === "goal").map((mark) => mark.name);
      const goals = [...new Set(held)].map((goal) => ` --expect ${quote(goal)}`).join("");
      const world = (game.opened?.worlds.length ?? 0) > 1 ? ` --world ${quote(scene.world)}` : "";
      const command = `hypedc sim ${quote(scene.path)}${world} --inputs ${quote(await game.script())}${goals}`;
      try {
        await navigator.clipboard.writeText(command);
        toasts.show("The command is in the clipboard", "good");
      } catch {
        const text = h("textarea", { class: "copy", readonly: true, "aria-label": "The command" }, command);
        this.element.append(text);
        text.select();
      }
    };
    return h(
      "div",
      { class: "buttons-row" },
      button("Save as .inputs", () => void save()),
      button("Download", () => void game.script().then((text) => download(name(), `${text}\n`))),
      button("Load…", () => file.click()),
      button("Copy as command", () => void copy()),
      file,
    );
  }
}

/** A word of a shell's command. */
function quote(text: string): string {
  return /^[\w@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;
}

/** Gives a text to the browser's downloads. */
export function download(name: string, text: string): void {
  const url = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
  h("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}
