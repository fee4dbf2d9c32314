// The page of `hypedc play`: connects to the server that it comes from, or runs the engine that it carries. In a webview of an
// editor it asks the editor.

import "./style.css";
import { startStudio } from "./app.ts";
import { help } from "./editor/help.ts";
import { WebSocketLanguageService } from "./editor/service.ts";
import type { Place } from "./protocol.ts";
import { h } from "./ui/dom.ts";
import { WebSocketCarrier } from "./websocket.ts";
import { EditorTheme, isWebview, WebviewCarrier } from "./webview.ts";
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
    if (own !== null) {
      window.studio = await startInBrowser(own.parts, own.project, { report: own.report });
      return;
    }
    if (isWebview()) {
      const carrier = new WebviewCarrier();
      const goTo = (place: Place): void => carrier.goTo(place);
      const world = document.documentElement.dataset.world ?? null;
      const studio = await startStudio({ carrier, world, goTo, prefersDark: new EditorTheme() });
      carrier.onSeek = (frame) => void studio.game.seek(frame);
      window.studio = studio;
      return;
    }
    const studio = await startStudio({ carrier: await WebSocketCarrier.open() });
    window.studio = studio;
    help(studio, await WebSocketLanguageService.open(), studio.game.scene?.path ?? "");
  } catch (error) {
    document.body.append(h("main", { class: "failed", role: "alert" }, error instanceof Error ? error.message : String(error)));
  }
}

void main();
