// The page over an engine in the browser: without a server, with the editor's help.

import "../editor/editor.css";
import { startStudio, type Studio, type StudioOptions } from "../app.ts";
import { assistance, format } from "../editor/assist.ts";
import { WorkerLanguageService } from "../editor/service.ts";
import { button } from "../ui/dom.ts";
import { WorkerCarrier } from "./carrier.ts";
import type { EngineParts } from "./client.ts";
import type { Project } from "./project.ts";

/** Builds the page over the files of a program. */
export async function startInBrowser(
  parts: EngineParts,
  project: Project,
  options: Omit<StudioOptions, "carrier"> = {},
): Promise<Studio> {
  const carrier = new WorkerCarrier(parts, project);
  const { world = null, script = null } = project;
  const studio = await startStudio({ world, script, ...options, carrier });
  carrier.onTrap = (why, reopened) => {
    const first = why.split("\n")[0] ?? "";
    const then = reopened ? "It goes on from before the last request." : "The program was opened again.";
    studio.toasts.show(`The engine failed: ${first}. ${then}`, "bad");
    if (!reopened) void studio.game.restart();
  };
  const { text } = studio;
  const service = new WorkerLanguageService(parts, project);
  const path = (): string => text.path ?? project.root;
  text.isMarked = false;
  text.extend(assistance(service, path));
  text.addTool(button("Format", () => void format(text.editor, service, path()), "small"));
  return studio;
}
