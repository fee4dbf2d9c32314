// Live verdicts: the server shows them as code lenses; this part plays the inputs that were found.

import { draw, page, type Target } from './hypedc';

/** The page with the run of some inputs. */
export async function play(command: string, target: Target, inputs: string, title: string, stop?: AbortSignal): Promise<string> {
  const found = await draw(command, target, inputs, stop);
  return page(title, { ...found, text: `${found.text.trimEnd()}\n\ninputs  ${inputs}` });
}
