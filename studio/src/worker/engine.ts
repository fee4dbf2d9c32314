// The engine as a WebAssembly module: requests and answers as JSON, through its memory. See bindings/web/src/lib.rs.

/** What the engine tells while it answers. */
export type Report = (kind: "search" | "panic", text: string) => void;

interface Exports {
  memory: WebAssembly.Memory;
  start(): void;
  reserve(bytes: number): number;
  answer(): number;
  output(): number;
}

const encoder = new TextEncoder();
const decoder = new TextDecoder();

/** An instance of the engine. After a trap it is not used again. */
export class Engine {
  private constructor(private readonly exports: Exports) {}

  static async of(module: WebAssembly.Module, report: Report): Promise<Engine> {
    let engine: Engine | null = null;
    const told = (kind: number, text: number, bytes: number): void => {
      if (engine !== null) report(kind === 0 ? "search" : "panic", engine.read(text, bytes));
    };
    const instance = await WebAssembly.instantiate(module, { host: { report: told } });
    engine = new Engine(instance.exports as unknown as Exports);
    engine.exports.start();
    return engine;
  }

  /** Answers a request. */
  ask(request: string): string {
    const bytes = encoder.encode(request);
    const at = this.exports.reserve(bytes.length);
    new Uint8Array(this.exports.memory.buffer, at, bytes.length).set(bytes);
    const length = this.exports.answer();
    return this.read(this.exports.output(), length);
  }

  /** Bytes of its memory. */
  get memory(): number {
    return this.exports.memory.buffer.byteLength;
  }

  private read(at: number, bytes: number): string {
    return decoder.decode(new Uint8Array(this.exports.memory.buffer, at, bytes));
  }
}

/** The bytes of a file that may be packed by gzip. */
export async function unpacked(bytes: Uint8Array<ArrayBuffer>): Promise<Uint8Array<ArrayBuffer>> {
  if (bytes[0] !== 0x1f || bytes[1] !== 0x8b) return bytes;
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
