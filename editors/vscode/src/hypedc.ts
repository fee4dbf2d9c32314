// Runs hypedc: command lines, processes, and the pictures that a search leaves. Knows nothing of VS Code.

import { spawn } from 'node:child_process';
import { mkdtemp, readdir, readFile, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { basename, dirname, join } from 'node:path';

/** What a command is run on. */
export interface Question {
  /** The path of the program. */
  file: string;
  /** The world; may be left out where the program has only one. */
  world?: string;
  /** The goal; all of the world's goals if it is left out. */
  goal?: string;
}

/** How a command ended. */
export interface Outcome {
  /** 0 as wished, 1 the answer is no, 2 the question could not be asked; null if it was stopped. */
  code: number | null;
  /** What it printed, on standard output and then on standard error. */
  text: string;
}

/** A drawing of what a search found. */
export interface Picture {
  /** The goal, or the program if there is only one picture. */
  title: string;
  svg: string;
}

/** The worlds of a program, in order. Maps and comments may say `world`, too, but not at the beginning of a line. */
export function worldsOf(text: string): string[] {
  return [...text.matchAll(/^[ \t]*world[ \t]+([\p{L}_][\p{L}\p{M}\p{N}_]*)/gmu)].map(([, name]) => name);
}

function asked({ file, world, goal }: Question): string[] {
  return [basename(file), ...(world ? ['--world', world] : []), ...(goal ? ['--goal', goal] : [])];
}

/**
 * Runs a command in the folder of the program, until it ends or `stop` is aborted. Rejects if it cannot be started.
 */
export function run(command: string, args: string[], file: string, stop?: AbortSignal): Promise<Outcome> {
  return new Promise((resolve, reject) => {
    const child = spawn(command, args, { cwd: dirname(file), stdio: ['ignore', 'pipe', 'pipe'] });
    let out = '';
    let errors = '';
    child.stdout.setEncoding('utf8').on('data', (text: string) => (out += text));
    child.stderr.setEncoding('utf8').on('data', (text: string) => (errors += text));
    child.on('error', reject);
    child.on('close', (code) => resolve({ code, text: out + errors }));
    // As ctrl-C does: the search ends and tells what it has.
    const interrupt = () => child.kill('SIGINT');
    if (stop?.aborted) interrupt();
    stop?.addEventListener('abort', interrupt, { once: true });
  });
}

/** Runs the inputs of a script. */
export function simulate(command: string, { file, world }: Question, script: string, stop?: AbortSignal): Promise<Outcome> {
  return run(command, ['sim', ...asked({ file, world }), '--inputs', script], file, stop);
}

/** Searches, and reads the pictures that were drawn: one for each goal. */
export async function reach(
  command: string,
  question: Question,
  more: string[],
  stop?: AbortSignal,
): Promise<Outcome & { pictures: Picture[] }> {
  const folder = await mkdtemp(join(tmpdir(), 'hypedc-'));
  try {
    const name = 'reach';
    const args = ['reach', ...asked(question), ...more, '--svg', join(folder, `${name}.svg`)];
    const outcome = await run(command, args, question.file, stop);
    const drawn = (await readdir(folder)).filter((entry) => entry.endsWith('.svg')).sort();
    const pictures = await Promise.all(
      drawn.map(async (entry) => ({
        // With several goals, each name stands before the extension.
        title: entry.slice(0, -'.svg'.length).slice(name.length).replace(/^[^\p{L}_]+/u, '') || question.goal || basename(question.file),
        svg: await readFile(join(folder, entry), 'utf8'),
      })),
    );
    return { ...outcome, pictures };
  } finally {
    await rm(folder, { recursive: true, force: true });
  }
}

function escaped(text: string): string {
  return text.replace(/[&<>"']/g, (sign) => `&#${sign.charCodeAt(0)};`);
}

/** A page with what a search said and drew. It runs no scripts and loads nothing. */
export function page(title: string, { text, pictures }: { text: string; pictures: Picture[] }): string {
  const drawings = pictures.map(({ title, svg }) => {
    const data = Buffer.from(svg, 'utf8').toString('base64');
    return `<h2>${escaped(title)}</h2>\n<img alt="${escaped(title)}" src="data:image/svg+xml;base64,${data}">`;
  });
  return `<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
<title>${escaped(title)}</title>
<style>
  img { max-width: 100%; background: #fff; }
  pre { white-space: pre-wrap; }
</style>
</head>
<body>
<pre>${escaped(text)}</pre>
${drawings.join('\n')}
</body>
</html>
`;
}
