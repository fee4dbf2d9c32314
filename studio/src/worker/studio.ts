// The page over an engine in the browser: without a server, with the editor's help.

import { startStudio, type Studio, type StudioOptions } from "../app.ts";
import { help } from "../editor/help.ts";
import { WorkerLanguageService } from "../editor/service.ts";
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
  help(studio, new WorkerLanguageService(parts, project), project.root);
  return studio;
}
