// Asks for the contacts of the players while they are shown on the stage.

import { ask } from "./carrier.ts";
import type { Overlays } from "./draw/overlays.ts";
import type { Stage } from "./draw/stage.ts";
import type { Game } from "./game.ts";

/** Time between two questions while time passes, ms. */
const PAUSE = 60;

/** Keeps the contacts of an overlay up to date. */
export function watchContacts(game: Game, stage: Stage, overlays: Overlays): void {
  let isAsking = false;
  let last = 0;
  const update = async (): Promise<void> => {
    const scene = game.scene;
    if (!stage.shows.contacts || isAsking || !scene) return;
    if (game.mode !== "paused" && performance.now() - last < PAUSE) return;
    isAsking = true;
    last = performance.now();
    try {
      const found: typeof overlays.contacts = [];
      const slots = [...scene.players.map((player) => player.slot), ...(stage.selected === null ? [] : [stage.selected])];
      for (const slot of new Set(slots)) {
        const of = await ask(game.carrier, "inspected", { ask: "inspect", slot });
        for (const contact of of.contacts) found.push({ slot, ...contact });
      }
      overlays.contacts = found;
    } catch {
      overlays.contacts = [];
    }
    isAsking = false;
  };
  game.onShown.on(() => void update());
  stage.onShows.on(() => void update());
}
