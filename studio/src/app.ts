// Puts the page together over a carrier: stage, time, panels, keys. The playground and exported games use it, too.

import type { Carrier } from "./carrier.ts";
import { watchContacts } from "./contacts.ts";
import type { Theme } from "./draw/colors.ts";

import { Overlays } from "./draw/overlays.ts";
import { Stage } from "./draw/stage.ts";
import { Game } from "./game.ts";
import { keyName } from "./input/actions.ts";
import { Inputs } from "./input/keys.ts";
import { recall, remember } from "./memory.ts";
import { AskPanel } from "./ui/ask_panel.ts";
import { h, icon, iconButton } from "./ui/dom.ts";
import { Goals } from "./ui/goals.ts";
import { KnowPanel } from "./ui/know_panel.ts";
import type { Place as TextPlace } from "./protocol.ts";
import type { Report } from "./report.ts";
import { Pointer } from "./ui/pointer.ts";
import { PlayPanel } from "./ui/play_panel.ts";
import { ReportPanel } from "./ui/report_panel.ts";
import { Sidebar } from "./ui/sidebar.ts";
import { TextPanel } from "./ui/text_panel.ts";
import { Toasts } from "./ui/toasts.ts";
import { Touch } from "./ui/touch.ts";
import { Transport } from "./ui/transport.ts";
import { TunePanel } from "./ui/tune_panel.ts";
import { Watcher } from "./watcher.ts";

/** What the page is made with. */
export interface StudioOptions {
  carrier: Carrier;
  /** Where it goes; the whole page if it is the body. */
  host?: HTMLElement;
  /** The world that is opened. */
  world?: string | null;
  /** A script that is loaded first. */
  script?: string | null;
  /** Answers that are shown beside the game. */
  report?: Report | null;
  /** Shows a place of a text elsewhere: the page is beside an editor, and has no text of its own. */
  goTo?: (place: TextPlace) => void;
  /** Whether the theme is dark at first, and whenever that changes. */
  prefersDark?: Pick<MediaQueryList, "matches"> & { addEventListener(type: "change", listener: (event: { matches: boolean }) => void): void };
}

/** The parts of a running page, for pages that add to it. */
export interface Studio {
  game: Game;
  stage: Stage;
  toasts: Toasts;
  text: TextPanel;
  sidebar: Sidebar;
  bar: HTMLElement;
}

/** Builds the page and opens the program. */
export async function startStudio(options: StudioOptions): Promise<Studio> {
  const host = options.host ?? document.body;
  const game = new Game(options.carrier);
  const stage = new Stage(game);
  const inputs = new Inputs();
  const toasts = new Toasts();
  const overlays = new Overlays(game, stage);
  const transport = new Transport(game);
  const goals = new Goals(game, (text, isGood) => toasts.show(text, isGood ? "good" : "bad"));
  const { goTo } = options;
  const text = new TextPanel(game, stage, toasts, () => sidebar.show("text"));
  if (goTo) text.elsewhere = goTo;
  const know = new KnowPanel(game, stage, (place) => text.goTo(place));
  const ask = new AskPanel(game, overlays, toasts);
  const tune = new TunePanel(game, stage, overlays, inputs, toasts);
  tune.onWrite = (path) => void text.written(path);
  const report = options.report ? new ReportPanel(options.report, game, overlays, toasts) : null;
  const panels = [...(report ? [report] : []), new PlayPanel(game, stage, inputs, toasts), know, tune, ask, ...(goTo ? [] : [text])];
  const stageBox = h("main", { class: "stage" });
  const sidebar = new Sidebar(panels, () => requestAnimationFrame(resize));
  const hint = h("div", { class: "hint" });
  const touch = new Touch(inputs, () => undefined);
  const ended = h("div", { class: "ended", role: "status" });
  stageBox.append(stage.canvas, hint, ended, touch.element, toasts.element, text.problems);

  const title = h("h1", {}, "hypedc");
  const themeButton = iconButton("moon", "Dark theme", () => setTheme(theme === "dark" ? "light" : "dark"));
  const map = iconButton("map", "Map of all spaces", () => toggleMap(), "M");
  map.setAttribute("aria-pressed", "false");
  const bar = h(
    "header",
    { class: "bar" },
    title,
    goals.element,
    h("span", { class: "grow" }),
    map,
    iconButton("pad", "Touch controls", () => showTouch(touch.element.hidden)),
    themeButton,
    iconButton("panel", "Panel", () => sidebar.open(!sidebar.isOpen)),
  );
  host.classList.add("studio");
  host.append(bar, h("div", { class: "middle" }, stageBox, sidebar.element), transport.element);

  let theme: Theme = "light";
  function setTheme(next: Theme, isChosen = true): void {
    theme = next;
    document.documentElement.dataset.theme = next;
    themeButton.replaceChildren(icon(next === "dark" ? "sun" : "moon"));
    const label = next === "dark" ? "Light theme" : "Dark theme";
    themeButton.setAttribute("aria-label", label);
    themeButton.title = label;
    if (isChosen) remember("theme", next);
    stage.setTheme(next);
    text.setTheme(next);
  }
  const prefersDark = options.prefersDark ?? matchMedia("(prefers-color-scheme: dark)");
  const chosen = recall("theme");
  setTheme(chosen === "dark" || chosen === "light" ? chosen : prefersDark.matches ? "dark" : "light", false);
  prefersDark.addEventListener("change", (event) => {
    if (recall("theme") === undefined) setTheme(event.matches ? "dark" : "light", false);
  });

  function resize(): void {
    stage.resize(stage.canvas.clientWidth, stage.canvas.clientHeight);
  }
  new ResizeObserver(resize).observe(stage.canvas);

  function toggleMap(): void {
    stage.isOverview = !stage.isOverview;
    map.setAttribute("aria-pressed", String(stage.isOverview));
    update();
  }

  function showTouch(isShown: boolean): void {
    touch.element.hidden = !isShown;
  }
  // Beside a report there is no room for them at first.
  if (!report && matchMedia("(pointer: coarse)").matches) showTouch(true);

  // The game has the keys unless something else that takes them has the focus.
  const takesKeys = (event: KeyboardEvent): boolean => {
    const target = event.target;
    if (!(target instanceof Element)) return true;
    if (target.closest("input:not([type=checkbox]):not([type=range]), textarea, select, [contenteditable], .cm-editor")) return false;
    if (target.closest("[role=tab], input[type=range]") && event.code.startsWith("Arrow")) return false;
    return !(target.closest("button, a, input, summary") && (event.code === "Space" || event.code === "Enter"));
  };
  inputs.listen(takesKeys);
  game.sample = () => inputs.sample();
  // A key of the game starts it, and takes over where one looks at the past.
  inputs.onPress.on(() => {
    if (game.mode === "live" || !game.frame) return;
    if (game.frame.at >= game.length) {
      if (game.mode === "paused" && !game.ended) game.resume();
    } else {
      const had = game.length;
      void game.takeOver().then(() => {
        const script = game.dropped;
        if (had > 0 && script) {
          toasts.show("Taken over from here", "note", { text: "Undo", run: () => void game.load(script, had) });
        }
      });
    }
  });
  const shortcuts: Record<string, () => void> = {
    KeyP: () => game.toggle(),
    Comma: () => void game.stepBy(-1),
    Period: () => void game.stepBy(1),
    KeyR: () => void game.restart(),
    KeyT: () => void game.takeOver(),
    KeyM: toggleMap,
    KeyL: () => transport.markLoop(),
    Escape: () => stage.canvas.focus(),
  };
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented || !takesKeys(event)) return;
    const run = inputs.uses(event.code) ? undefined : shortcuts[event.code];
    if (!run) return;
    event.preventDefault();
    run();
  });

  watchContacts(game, stage, overlays);
  new Pointer(game, stage, overlays, {
    pick: (slot) => {
      know.select(slot);
      if (slot !== null && sidebar.isOpen) sidebar.show("know");
    },
    place: (place) => ask.setPlace(place),
    wantsPlace: () => sidebar.isOpen && sidebar.current === "ask" && ask.picksPlace,
    paint: text.painter,
    leaveMap: toggleMap,
  });

  game.onScene.on((scene) => {
    inputs.setScene(scene);
    const file = scene.path.split(/[\\/]/).pop() ?? "";
    title.textContent = file.replace(/\.hyped$/, "");
    document.title = `${scene.world} – ${file}`;
    map.hidden = scene.spaces.length < 2;
    stage.canvas.setAttribute("aria-label", `The game: world ${scene.world}`);
  });
  game.onTrouble.on((message) => toasts.show(message, "bad"));
  game.onOpened.on((opened) => {
    if (opened.lost) toasts.show(`After the change, ${opened.lost}.`, "bad");
  });
  const update = (): void => {
    const isNew = game.mode === "paused" && game.length === 0 && game.scene !== null;
    if (isNew) hint.replaceChildren(...startHint(inputs, !touch.element.hidden));
    hint.hidden = !isNew || stage.isOverview || game.opened?.is_current === false;
    const isOver = game.ended !== null && game.mode === "paused" && game.frame?.at === game.length;
    ended.hidden = !isOver;
    if (isOver && ended.childElementCount === 0) {
      ended.append(h("span", {}, `The run is over: ${game.ended ?? ""}`), h("button", { type: "button", class: "button", onclick: () => void game.restart() }, "Start again"));
    } else if (!isOver) {
      ended.replaceChildren();
    }
  };
  game.onShown.on(update);
  game.onMode.on(update);
  inputs.onActions.on(update);
  game.onOpened.on(update);

  options.carrier.onLost((why) => {
    game.pause();
    toasts.show(why, "bad");
  });
  const frame = (now: number): void => {
    if (game.mode === "paused") inputs.watchGamepads();
    game.tick(now);
    stage.draw(now);
    requestAnimationFrame(frame);
  };
  await game.open(options.world ?? null);
  if (options.script) await game.load(options.script);
  if (report) {
    sidebar.show(report.id);
    await report.start();
  }
  requestAnimationFrame(frame);
  new Watcher(game, text, toasts).start();
  stage.canvas.focus({ preventScroll: true });
  return { game, stage, toasts, text, sidebar, bar };
}

/** What starts a game, with the names of its first keys. */
function startHint(inputs: Inputs, isTouch: boolean): (Node | string)[] {
  if (isTouch) return ["Touch a control to start"];
  const first = inputs.actions.filter((action) => action.player === 0 && action.keys.length > 0);
  if (first.length === 0) return ["Press ", h("kbd", {}, "P"), " to start"];
  // Directions come last among the actions, but first to the hand.
  const chosen = [...first.slice(-1), ...first.slice(0, first.length > 1 ? 1 : 0)];
  const keys = chosen.flatMap((action, at) => [at > 0 ? " or " : "", h("kbd", {}, keyName(action.keys[0]!))]);
  return ["Press ", ...keys, " to start"];
}
