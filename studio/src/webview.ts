// The carrier in a webview of an editor: the editor passes requests on to its language server, whose session plays the texts
// as they are in the editor.

import type { Carrier } from "./carrier.ts";
import type { Answer, Place, Request } from "./protocol.ts";

/** What an editor gives to its webviews. */
interface Editor {
  postMessage(message: unknown): void;
}
declare function acquireVsCodeApi(): Editor;

/** What the editor says. */
type Message =
  | { answer: unknown; id: number }
  | { changed: string[] }
  | { seek: number }
  | { lost: string };

/** Whether the page is a webview of an editor. */
export function isWebview(): boolean {
  return "acquireVsCodeApi" in globalThis;
}

export class WebviewCarrier implements Carrier {
  readonly canWatch = true;
  readonly canSave = false;
  private readonly editor = acquireVsCodeApi();
  private readonly waiting = new Map<number, (answer: unknown) => void>();
  private readonly lost: ((why: string) => void)[] = [];
  private files: string[] = [];
  private wake: (() => void) | null = null;
  private count = 0;
  /** Called when the editor wants another frame. */
  onSeek: (frame: number) => void = () => undefined;

  constructor() {
    addEventListener("message", ({ data }: MessageEvent<Message>) => this.receive(data));
  }

  ask(request: Request): Promise<Answer> {
    return this.send({ request }) as Promise<Answer>;
  }

  /** Waits until texts have changed. */
  async changed(): Promise<string[]> {
    if (this.files.length === 0) await new Promise<void>((done) => (this.wake = done));
    return this.files.splice(0);
  }

  save(): Promise<string | null> {
    return Promise.resolve("the editor saves files");
  }

  async picture(path: string): Promise<string> {
    const address = await this.send({ picture: path });
    if (typeof address === "string") return address;
    throw new Error(`cannot show \`${path}\``);
  }

  onLost(listener: (why: string) => void): void {
    this.lost.push(listener);
  }

  /** Shows a place of a text in the editor. */
  goTo(place: Place): void {
    this.editor.postMessage({ goTo: place });
  }

  private send(what: object): Promise<unknown> {
    const id = ++this.count;
    return new Promise((done) => {
      this.waiting.set(id, done);
      this.editor.postMessage({ id, ...what });
    });
  }

  private receive(message: Message): void {
    if ("answer" in message) {
      this.waiting.get(message.id)?.(message.answer);
      this.waiting.delete(message.id);
    } else if ("changed" in message) {
      this.files.push(...message.changed);
      this.wake?.();
      this.wake = null;
    } else if ("seek" in message) {
      this.onSeek(message.seek);
    } else if ("lost" in message) {
      for (const listener of this.lost) listener(message.lost);
    }
  }
}

/** The theme of the editor, as a media query is asked for it. */
export class EditorTheme {
  get matches(): boolean {
    const { classList } = document.body;
    return classList.contains("vscode-dark") || (classList.contains("vscode-high-contrast") && !classList.contains("vscode-high-contrast-light"));
  }

  addEventListener(_: "change", listener: (event: { matches: boolean }) => void): void {
    new MutationObserver(() => listener(this)).observe(document.body, { attributes: true, attributeFilter: ["class"] });
  }
}
