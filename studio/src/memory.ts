// What the browser remembers between visits: keys, theme, size of the side panel. Without storage, nothing is remembered.

const PREFIX = "hypedc.";

/** Reads a remembered value; undefined if there is none. */
export function recall(name: string): unknown {
  try {
    const text = localStorage.getItem(PREFIX + name);
    return text === null ? undefined : (JSON.parse(text) as unknown);
  } catch {
    // Pages from files and private windows may have no storage.
    return undefined;
  }
}

/** Remembers a value; forgets it if it is undefined. */
export function remember(name: string, value: unknown): void {
  try {
    if (value === undefined) localStorage.removeItem(PREFIX + name);
    else localStorage.setItem(PREFIX + name, JSON.stringify(value));
  } catch {
    // Not remembered.
  }
}
