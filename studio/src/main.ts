// The page of `hypedc play`: connects to the server that it comes from, or runs the engine that it carries.

import "./style.css";
import { startStudio } from "./app.ts";
import { h } from "./ui/dom.ts";
import { WebSocketCarrier } from "./websocket.ts";
import { embedded } from "./worker/embedded.ts";
import { startInBrowser } from "./worker/studio.ts";

/** What tests and measurements look at. */
declare global {
  interface Window {
    studio?: Awaited<ReturnType<typeof startStudio>>;
  }
}

async function main(): Promise<void> {
  try {
    const own = await embedded();
    window.studio =
      own === null
        ? await startStudio({ carrier: await WebSocketCarrier.open() })
        : await startInBrowser(own.parts, own.project);
  } catch (error) {
    document.body.append(h("main", { class: "failed", role: "alert" }, error instanceof Error ? error.message : String(error)));
  }
}

void main();
