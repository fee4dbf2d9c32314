// Runs hypedc: command lines, processes, and the pictures that a search leaves. Knows nothing of VS Code.

import { spawn } from 'node:child_process';
import { mkdtemp, readFile, rm } from 'node:fs/promises';
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
    const args = ['reach', ...asked(question), ...more, '--svg', join(folder, 'reach.svg')];
    const outcome = await run(command, args, question.file, stop);
    // Where the pictures are is of no use to anybody: they go. Their order is that of the goals.
    const pictures: Picture[] = [];
    const lines: string[] = [];
    for (const line of outcome.text.split('\n')) {
      const path = /^ +drawn +(.*\.svg)$/.exec(line)?.[1];
      if (path && dirname(path) === folder) {
        // With several goals, each name stands before the extension.
        const goal = basename(path, '.svg').split('.').slice(1).join('.');
        pictures.push({ title: goal || question.goal || basename(question.file), svg: await readFile(path, 'utf8') });
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

/** A line; where it is too long, it goes on below its first word that is no label, and a step such as `-*10` is not broken. */
function line(text: string): string {
  const indent = /^ *(?:[a-z]+ {2,})?/.exec(text)?.[0].length ?? 0;
  const words = escaped(text).replace(/\S*-\S*/g, '<span>$&</span>');
  return `<div style="padding-left: ${indent}ch; text-indent: -${indent}ch">${words || ' '}</div>`;
}

/** A page with what a search said and drew. It runs no scripts and loads nothing; a picture that is clicked is as large as it was drawn. */
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
