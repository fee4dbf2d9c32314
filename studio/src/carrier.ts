// Carries requests to a session and its answers back: over a WebSocket to `hypedc play`, or to a worker of the page.

import type { Answer, Request } from "./protocol.ts";

/** What the kinds of answers are called. */
export type AnswerOf<Kind extends Answer["answer"]> = Extract<Answer, { answer: Kind }>;

/** The way to a session. Requests are answered in the order in which they are asked. */
export interface Carrier {
  /** Asks; fails only if the connection is lost. */
  ask(request: Request): Promise<Answer>;
  /** Whether files on a disk are watched. */
  readonly canWatch: boolean;
  /** Whether files can be written. */
  readonly canSave: boolean;
  /** The files that have changed on the disk since the last call. */
  changed(): Promise<string[]>;
  /** Writes a file; says why if it cannot be written. */
  save(path: string, text: string): Promise<string | null>;
  /** A picture that the program names, as an address that holds the whole file. Fails if it cannot be read. */
  picture(path: string): Promise<string>;
  /** Called once if the connection is lost. */
  onLost(listener: (why: string) => void): void;
}

/** Asks for one kind of answer; a refusal is thrown as an error. */
export async function ask<Kind extends Answer["answer"]>(
  carrier: Carrier,
  kind: Kind,
  request: Request,
): Promise<AnswerOf<Kind>> {
  const answer = await carrier.ask(request);
  if (answer.answer === kind) return answer as AnswerOf<Kind>;
  throw new Error(answer.answer === "refused" ? answer.message : `the answer is ${answer.answer}, not ${kind}`);
}
