// The page of `hypedc play`: connects to the server that it comes from.

import "./style.css";
import { startStudio } from "./app.ts";
import { h } from "./ui/dom.ts";
import { WebSocketCarrier } from "./websocket.ts";

/** What tests and measurements look at. */
declare global {
  interface Window {
    studio?: Awaited<ReturnType<typeof startStudio>>;
  }
}

async function main(): Promise<void> {
  try {
    window.studio = await startStudio({ carrier: await WebSocketCarrier.open() });
  } catch (error) {
    document.body.append(h("main", { class: "failed", role: "alert" }, error instanceof Error ? error.message : String(error)));
  }
}

void main();
