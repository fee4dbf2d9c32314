// The engine twice: as WebAssembly in this process, and natively in another one. Both take requests as JSON.
import { spawn } from "node:child_process";
import { readFileSync } from "node:fs";
import { createInterface } from "node:readline";

/** The engine as WebAssembly. */
export class WebEngine {
  /** Reports while requests are answered: [kind, text]. */
  reports = [];

  constructor(path) {
    const bytes = readFileSync(path);
    const host = {
      report: (kind, at, length) => this.reports.push([kind, this.#read(at, length)]),
    };
    this.instance = new WebAssembly.Instance(new WebAssembly.Module(bytes), { host });
    this.instance.exports.start();
  }

  /** The text of an answer. */
  ask(request) {
    const { memory, reserve, answer, output } = this.instance.exports;
    const bytes = new TextEncoder().encode(typeof request === "string" ? request : JSON.stringify(request));
    // Making room may replace the buffer.
    const at = reserve(bytes.length);
    new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
    const length = answer();
    return this.#read(output(), length);
  }

  #read(at, length) {
    return new TextDecoder().decode(new Uint8Array(this.instance.exports.memory.buffer, at, length));
  }
}

/** The engine of `cargo build --package hypedc-web --bin native`. */
export class NativeEngine {
  #waiting = [];

  constructor(path) {
    this.process = spawn(path, { stdio: ["pipe", "pipe", "inherit"] });
    createInterface({ input: this.process.stdout }).on("line", (line) => {
      const space = line.indexOf(" ");
      this.seconds = Number(line.slice(0, space));
      this.#waiting.shift()?.(line.slice(space + 1));
    });
  }

  /** The text of an answer; afterwards `seconds` is the time that it took. */
  ask(request) {
    this.process.stdin.write(`${JSON.stringify(request)}\n`);
    return new Promise((done) => this.#waiting.push(done));
  }

  end() {
    this.process.stdin.end();
  }
}
