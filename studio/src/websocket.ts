// The carrier of `hypedc play`: one JSON request, one JSON answer, in order.

import type { Carrier } from "./carrier.ts";
import type { Answer, Request } from "./protocol.ts";

/** Requests that are for the server, not for the session. */
type FileRequest = { ask: "watch" } | { ask: "save"; path: string; text: string } | { ask: "picture"; path: string };
type FileAnswer = { answer: "changed"; files: string[] } | { answer: "picture"; address: string };

export class WebSocketCarrier implements Carrier {
  readonly canWatch = true;
  readonly canSave = true;
  private readonly waiting: ((answer: Answer | FileAnswer) => void)[] = [];
  private readonly lost: ((why: string) => void)[] = [];

  private constructor(private readonly socket: WebSocket) {
    socket.addEventListener("message", (event) => {
      this.waiting.shift()?.(JSON.parse(event.data as string) as Answer | FileAnswer);
    });
    socket.addEventListener("close", () => {
      for (const listener of this.lost) listener("The connection to hypedc is closed: start `hypedc play` again.");
    });
  }

  /** Connects to the server of this page. */
  static open(): Promise<WebSocketCarrier> {
    const socket = new WebSocket(sessionUrl());
    return new Promise((done, failed) => {
      socket.addEventListener("open", () => done(new WebSocketCarrier(socket)), { once: true });
      socket.addEventListener("error", () => failed(new Error("hypedc does not answer")), { once: true });
    });
  }

  ask(request: Request): Promise<Answer> {
    return this.send(request) as Promise<Answer>;
  }

  async changed(): Promise<string[]> {
    const answer = await this.send({ ask: "watch" });
    return answer.answer === "changed" ? answer.files : [];
  }

  async save(path: string, text: string): Promise<string | null> {
    const answer = await this.send({ ask: "save", path, text });
    return answer.answer === "refused" ? answer.message : null;
  }

  async picture(path: string): Promise<string> {
    const answer = await this.send({ ask: "picture", path });
    if (answer.answer === "picture") return answer.address;
    throw new Error(answer.answer === "refused" ? answer.message : `cannot show \`${path}\``);
  }

  onLost(listener: (why: string) => void): void {
    this.lost.push(listener);
  }

  private send(request: Request | FileRequest): Promise<Answer | FileAnswer> {
    return new Promise((done) => {
      this.waiting.push(done);
      this.socket.send(JSON.stringify(request));
    });
  }
}

/** The address of a session of the server that this page comes from, or of another service. */
export function sessionUrl(service?: "language"): URL {
  const url = new URL("session", location.href);
  url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  url.search = location.search + (service === undefined ? "" : `&for=${service}`);
  url.hash = "";
  return url;
}
