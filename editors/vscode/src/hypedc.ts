// Runs hypedc: command lines, processes, and the pictures that a search writes. Independent of VS Code.

import { spawn } from 'node:child_process';
import { mkdtemp, readFile, rm } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { basename, dirname, join } from 'node:path';

/** The target of a command. */
export interface Target {
  /** The path of the program. */
  file: string;
  /** The world; optional if the program has only one. */
  world?: string;
  /** The goal; by default, all goals of the world. */
  goal?: string;
  /** The `never` to break, instead of a goal. */
  never?: string;
  /** The level of a world that leaves its map open. */
  level?: { map: string; legend?: string; tile?: [number, number] };
}

/** The result of a command. */
export interface Outcome {
  /** The exit code: 0 success, 1 the answer is no, 2 the command could not run; null if it was stopped. */
  code: number | null;
  /** Its standard output, then its standard error. */
  text: string;
}

/** The drawing of a search. */
export interface Picture {
  /** The goal, or the program if there is only one picture. */
  title: string;
  svg: string;
}

/** The worlds of a program, in order. Matches only at line starts, to skip maps and comments that contain `world`. */
export function worldsOf(text: string): string[] {
  return [...text.matchAll(/^[ \t]*world[ \t]+([\p{L}_][\p{L}\p{M}\p{N}_]*)/gmu)].map(([, name]) => name);
}

function targetArguments({ file, world, goal, never, level }: Target): string[] {
  const option = (name: string, value?: string) => (value ? [name, value] : []);
  return [
    basename(file),
    ...option('--world', world),
    ...option('--goal', goal),
    ...option('--never', never),
    ...option('--map', level?.map),
    ...option('--legend', level?.legend),
    ...option('--tile', level?.tile?.join('x')),
  ];
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
    // Like ctrl-C: the search ends and prints its results so far.
    const interrupt = () => child.kill('SIGINT');
    if (stop?.aborted) interrupt();
    stop?.addEventListener('abort', interrupt, { once: true });
  });
}

/** Searches, and reads the pictures: one per goal. */
export async function reach(
  command: string,
  target: Target,
  extra: string[],
  stop?: AbortSignal,
): Promise<Outcome & { pictures: Picture[] }> {
  const folder = await mkdtemp(join(tmpdir(), 'hypedc-'));
  try {
    const args = ['reach', ...targetArguments(target), ...extra, '--svg', join(folder, 'reach.svg')];
    const outcome = await run(command, args, target.file, stop);
    // Read the pictures, in the order of the goals, and drop the lines with their temporary paths.
    const pictures: Picture[] = [];
    const lines: string[] = [];
    for (const line of outcome.text.split('\n')) {
      const path = /^ +drawn +(.*\.svg)$/.exec(line)?.[1];
      if (path && dirname(path) === folder) {
        // With several goals, the file name contains the goal before the extension.
        const goal = basename(path, '.svg').split('.').slice(1).join('.');
        pictures.push({ title: goal || target.goal || basename(target.file), svg: await readFile(path, 'utf8') });
      } else {
        lines.push(line);
      }
    }
    return { ...outcome, text: lines.join('\n'), pictures };
  } finally {
    await rm(folder, { recursive: true, force: true });
  }
}

function escaped(text: string): string {
  return text.replace(/[&<>"']/g, (sign) => `&#${sign.charCodeAt(0)};`);
}

/** A line of output. Wrapped lines align below the text after the label; inputs such as `-*10` are not broken. */
function line(text: string): string {
  const indent = /^ *(?:[a-z]+ {2,})?/.exec(text)?.[0].length ?? 0;
  const words = escaped(text).replace(/\S*-\S*/g, '<span>$&</span>');
  return `<div style="padding-left: ${indent}ch; text-indent: -${indent}ch">${words || ' '}</div>`;
}

/** A page with the output and the pictures of a search, without scripts or requests. A click enlarges a picture. */
export function page(title: string, { text, pictures }: { text: string; pictures: Picture[] }): string {
  const drawings = pictures.map(({ title, svg }) => {
    const data = Buffer.from(svg, 'utf8').toString('base64');
    return `<h2>${escaped(title)}</h2>
<label><input type="checkbox"><img alt="${escaped(title)}" src="data:image/svg+xml;base64,${data}"></label>`;
  });
  return `<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
<title>${escaped(title)}</title>
<style>
  pre { white-space: pre-wrap; }
  span { white-space: nowrap; }
  label { display: block; overflow-x: auto; }
  input { position: absolute; opacity: 0; }
  input:focus-visible + img { outline: 2px solid var(--vscode-focusBorder, currentColor); }
  img { max-width: 100%; background: #fff; cursor: zoom-in; }
  input:checked + img { max-width: none; cursor: zoom-out; }
</style>
</head>
<body>
<pre>${text.trimEnd().split('\n').map(line).join('')}</pre>
${drawings.join('\n')}
</body>
</html>
`;
}
