// The pictures that a program names: each is fetched once, and drawn from then on.

import type { Carrier } from "../carrier.ts";
import { Signal } from "../signal.ts";

export class Pictures {
  /** A picture was loaded: what shows it is drawn again. */
  readonly onLoaded = new Signal();
  /** A picture cannot be shown. */
  readonly onTrouble = new Signal<string>();
  /** Those that are loaded; null while they are not. */
  private readonly known = new Map<string, HTMLImageElement | null>();

  constructor(private readonly carrier: Carrier) {}

  /** The picture of a path; null until it is loaded. */
  get(path: string): HTMLImageElement | null {
    const known = this.known.get(path);
    if (known !== undefined) return known;
    this.known.set(path, null);
    void this.load(path);
    return null;
  }

  /** Loads all pictures again when they are next drawn: a file has changed. */
  forget(): void {
    this.known.clear();
    this.onLoaded.emit();
  }

  private async load(path: string): Promise<void> {
    try {
      const image = new Image();
      image.src = await this.carrier.picture(path);
      await image.decode();
      this.known.set(path, image);
      this.onLoaded.emit();
    } catch (error) {
      this.onTrouble.emit(error instanceof Error ? error.message : String(error));
    }
  }
}
