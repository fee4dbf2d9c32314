// The answers of a command: one is chosen, its way is shown in the level, to be played, scrubbed and taken over.

import type { Overlays } from "../draw/overlays.ts";
import type { Game } from "../game.ts";
import type { Report, Way } from "../report.ts";
import { button, h, section, toggle } from "./dom.ts";
import type { Panel } from "./sidebar.ts";
import type { Toasts } from "./toasts.ts";

/** What stands before a verdict. */
const SIGNS = { good: "✓", bad: "✗", proof: "∎", open: "?" } as const;

export class ReportPanel implements Panel {
  readonly id = "report";
  readonly title = "Report";
  readonly element = h("div", { class: "report" });
  readonly width = "roomy" as const;
  private readonly choices: HTMLButtonElement[];
  private readonly details = h("div", { class: "way-details" });
  private readonly changed = h("p", { class: "reason bad", role: "status", hidden: true }, "The program or its world was changed on this page: the report is about it as it was. ", button("Open it again", () => location.reload(), "small"));
  private showsHeat = true;
  private chosen = -1;
  /** How often a program was opened; after the first time it may be another one. */
  private opens = 0;

  constructor(
    private readonly report: Report,
    private readonly game: Game,
    private readonly overlays: Overlays,
    private readonly toasts: Toasts,
  ) {
    this.choices = report.ways.map((way, at) =>
      h(
        "button",
        { type: "button", class: `way ${way.tone}`, onclick: () => void this.choose(at) },
        h("span", { class: "sign", "aria-hidden": "true" }, SIGNS[way.tone]),
        h("span", { class: "what" }, way.kind === "run" ? "The run" : `${way.kind} ${way.name}`),
        h("span", { class: "said" }, way.verdict),
      ),
    );
    const list = h("ul", { class: "ways", "aria-label": "Answers" }, ...this.choices.map((choice) => h("li", {}, choice)));
    this.element.append(
      h("p", { class: "quiet report-title" }, report.title),
      ...report.notes.map((note) => h("p", { class: "reason" }, note)),
      this.changed,
      report.ways.length > 1 ? section(report.kind === "reach" ? "Answers" : "Run", list) : "",
      this.details,
      h(
        "details",
        { class: "made" },
        h("summary", {}, "How this was made"),
        h("pre", { tabindex: "0" }, report.command),
        h("p", { class: "quiet" }, `hypedc ${report.hypedc}; SHA-256 of the program ${report.program_sha256.slice(0, 16)}…`),
        h("p", { class: "quiet" }, "The page carries the program, the inputs and the engine: it plays the inputs again, step by step."),
      ),
    );
    game.onOpened.on(() => {
      this.changed.hidden = this.opens++ === 0;
    });
  }

  /** Shows the first way that there is one for. */
  async start(): Promise<void> {
    const first = this.report.ways.findIndex((way) => way.witness !== null);
    await this.choose(Math.max(0, first));
  }

  private async choose(at: number): Promise<void> {
    const way = this.report.ways[at];
    if (!way || this.chosen === at) return;
    this.chosen = at;
    this.choices.forEach((choice, of) => {
      if (of === at) choice.setAttribute("aria-current", "true");
      else choice.removeAttribute("aria-current");
    });
    this.details.replaceChildren(...this.describe(way));
    this.drawHeat(way);
    this.overlays.found = [];
    const { game } = this;
    if (way.witness === null) {
      await game.load("");
      return;
    }
    const { script, steps, ghost } = way.witness;
    if (!(await game.load(script, steps)) || this.chosen !== at) return;
    if (!this.leads(way)) this.toasts.show("These inputs do not lead there on this page.", "bad");
    await game.seek(way.start);
    if (this.chosen !== at) return;
    this.overlays.found = ghost.map((path) => path.slice(way.start));
    this.overlays.foundStart = way.start;
  }

  /** Whether what is claimed of the last frame holds in it. */
  private leads(way: Way): boolean {
    const { frame, scene } = this.game;
    if (!frame || !scene || frame.at !== way.witness?.steps) return false;
    const [names, held] = way.kind === "never" ? [scene.nevers, frame.nevers] : [scene.goals, frame.goals];
    const index = names.indexOf(way.name);
    return way.kind === "run" || index < 0 || held.includes(index);
  }

  private drawHeat(way: Way): void {
    this.overlays.clearHeat();
    if (this.showsHeat) this.overlays.addCells(way.covered);
  }

  private describe(way: Way): (Node | string)[] {
    const { game } = this;
    const parts: (Node | string)[] = [
      h("p", { class: `verdict ${way.tone}` }, way.kind === "run" ? way.verdict : `${way.kind} ${way.name}: ${way.verdict}`),
    ];
    const { witness } = way;
    const { picture } = way;
    const look = picture === null ? null : button("Whole level", () => showPicture(picture, `${way.name}: ${way.verdict}`));
    if (witness !== null) {
      const play = (): void => {
        void game.seek(way.start).then(() => game.resume());
      };
      parts.push(h("div", { class: "buttons-row" }, button(way.kind === "run" ? "Play the run" : "Play the way", play, "primary"), look));
    } else if (look !== null) {
      parts.push(h("div", { class: "buttons-row" }, look));
    }
    if (way.moments.length > 0 && witness !== null) {
      const jump = (frame: number, text: string, tone: string): HTMLElement =>
        h("li", {}, h("button", { type: "button", class: `moment ${tone}`, onclick: () => void game.seek(frame) }, h("span", {}, text), h("span", { class: "quiet" }, `step ${frame}`)));
      const first = way.start > 0 ? [jump(way.start, "the search begins", "")] : [];
      parts.push(h("ul", { class: "moments" }, ...first, ...way.moments.map((of) => jump(of.frame, of.text, of.tone))));
    }
    if (way.lines.length > 0) parts.push(h("ul", { class: "said-lines" }, ...way.lines.map((line) => h("li", {}, line))));
    if (way.covered.length > 0) {
      parts.push(
        toggle("Where the search was", this.showsHeat, (isOn) => {
          this.showsHeat = isOn;
          this.drawHeat(way);
        }),
        h("p", { class: "quiet" }, "Violet: states that the search kept, darker where there are more. Red lines: ground with none of them on it."),
      );
    }
    if (witness !== null) {
      const text = h("textarea", { class: "copy", readonly: true, rows: 3, "aria-label": "The inputs as a script" });
      text.value = witness.script;
      parts.push(h("details", {}, h("summary", {}, `Inputs, ${witness.steps} steps`), text));
      parts.push(h("p", { class: "quiet" }, "A key of the game takes over at the frame that is shown."));
    }
    return parts;
  }
}

/** Shows a picture over the page. */
function showPicture(svg: string, label: string): void {
  const url = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
  const dialog = h("dialog", { class: "picture", "aria-label": label });
  const close = button("Close", () => dialog.close(), "small");
  dialog.append(h("div", { class: "picture-head" }, close), h("div", { class: "picture-scroll", tabindex: "0" }, h("img", { src: url, alt: label })));
  dialog.addEventListener("close", () => {
    URL.revokeObjectURL(url);
    dialog.remove();
  });
  document.body.append(dialog);
  dialog.showModal();
}
