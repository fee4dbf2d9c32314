// Gives the text pane the engine's help: in the browser and over a connection alike.

import "./editor.css";
import type { Studio } from "../app.ts";
import { button } from "../ui/dom.ts";
import { assistance, format } from "./assist.ts";
import type { LanguageService } from "./service.ts";

/** `root` is the main file, before another one is shown. */
export function help(studio: Studio, service: LanguageService, root: string): void {
  const { text } = studio;
  const path = (): string => text.path ?? root;
  text.isMarked = false;
  text.extend(assistance(service, path));
  text.addTool(button("Format", () => void format(text.editor, service, path()), "small"));
}
