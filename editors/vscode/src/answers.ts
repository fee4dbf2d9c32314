// The records of the server's `reach` and `sim` in words, as the command line shows them.

import { basename } from 'node:path';
import type { Picture } from './hypedc';

/** A goal or a `never`, and what came of it. */
export interface Answer {
  kind: string;
  goal: string;
  verdict: string;
  is_expected: boolean;
  is_withdrawn: boolean;
  is_shortest: boolean | null;
  least_steps: number | null;
  reasons: string[];
  assumptions: string[];
  steps: number | null;
  seconds_of_play: number | null;
  inputs: string | null;
  nodes: number;
  reads_between: boolean;
  luck?: { probability: number; is_exact: boolean } | null;
  why_not?: { nearest?: { parts: { holds: boolean; text: string; words: string }[] } | null } | null;
}

export interface SearchRecord {
  file: string;
  world: string;
  seed: number;
  given_up: string[];
  goals: Answer[];
  refuted: object | null;
  pictures?: { name: string; svg: string }[];
}

export interface RunRecord {
  file: string;
  world: string;
  inputs: string;
  steps: number;
  seconds_of_play: number;
  end: string | null;
  instances: {
    name: string;
    is_alive: boolean;
    modes: string[];
    variables: { name: string; value: number; rate: number }[];
    others: { name: string; value: string }[];
  }[];
  goals: { name: string; step: number | null }[];
  nevers: { name: string; step: number | null }[];
  broken: { instance: string; step: number } | null;
  pictures?: { name: string; svg: string }[];
}

/** The pictures of a record. */
export function picturesOf({ pictures }: { pictures?: { name: string; svg: string }[] }): Picture[] {
  return (pictures ?? []).map(({ name, svg }) => ({ title: name, svg }));
}

function counted(count: number, what: string): string {
  return `${count} ${what}${count === 1 ? '' : 's'}`;
}

function short(value: number): string {
  return String(Number(value.toPrecision(3)));
}

/** What is exhausted is so only for the inputs that were tried. */
function verdictText({ verdict }: Answer): string {
  return verdict === 'exhausted' ? 'no way with axes at -1, 0 and 1, which is no proof' : verdict.replaceAll(/[-_]/g, ' ');
}

function shortestText({ is_shortest, reads_between, steps, least_steps }: Answer): string {
  if (!is_shortest) {
    const least = least_steps !== null && steps !== null && 2 * least_steps >= steps ? `: it takes at least ${least_steps}` : '';
    return `not proven shortest${least}`;
  }
  return reads_between ? 'shortest with axes at -1, 0 and 1' : 'shortest';
}

/** The answers of a search. */
export function searchText({ file, world, seed, given_up, goals, refuted }: SearchRecord): string {
  const lines = [`${basename(file)}, world ${world}, seed ${seed}`];
  for (const answer of goals) {
    const when = answer.steps === null ? '' : ` in ${(answer.seconds_of_play ?? 0).toFixed(2)} s`;
    const luck = answer.luck && answer.luck.probability < 1 ? `, with luck: ${answer.luck.is_exact ? '' : 'about '}${short(100 * answer.luck.probability)} %` : '';
    lines.push(`  ${answer.kind} ${answer.goal}: ${verdictText(answer)}${when}${luck}`);
    const add = (label: string, text: string) => lines.push(`    ${label.padEnd(8)}${text}`);
    if (answer.steps !== null) add('path', `${counted(answer.steps, 'step')}, ${shortestText(answer)}`);
    if (answer.inputs !== null) add('inputs', answer.inputs);
    answer.reasons.forEach((reason) => add('because', reason));
    answer.assumptions.forEach((assumed) => add('assumes', assumed));
    if (answer.is_withdrawn) add('note', 'a run refuted the analysis: its proof is withdrawn');
    const near = answer.why_not?.nearest?.parts.filter(({ holds }) => !holds) ?? [];
    near.forEach(({ text, words }) => add('nearest', `${text} ${words}`));
    if (answer.nodes > 0) add('search', counted(answer.nodes, 'node'));
  }
  given_up.forEach((what) => lines.push(`  not analysed: ${what}`));
  if (refuted) lines.push('  a run contradicts the analysis: this is a bug of hypedc; `hypedc reach` tells more');
  return lines.join('\n');
}

/** What came of a run. */
export function runText({ file, world, steps, seconds_of_play, end, instances, goals, nevers, broken }: RunRecord): string {
  const lines = [`${basename(file)}, world ${world}: ${counted(steps, 'step')} (${seconds_of_play.toFixed(2)} s)`];
  for (const { name, is_alive, modes, variables, others } of instances) {
    const numbers = variables.map(({ name, value, rate }) => `${name} = ${value.toFixed(3)}, ${name}' = ${rate.toFixed(3)}`);
    const values = [...numbers, ...others.map(({ name, value }) => `${name} = ${value}`)];
    lines.push(`  ${name}   ${is_alive ? `${modes.join(', ')}  ${values.join(', ')}` : 'not there'}`);
  }
  if (end) lines.push(`  the run ends: ${end}`);
  for (const { name, step } of goals) lines.push(`  goal ${name}: ${step === null ? 'not reached' : `reached at step ${step}`}`);
  for (const { name, step } of nevers) if (step !== null) lines.push(`  never ${name}: violated at step ${step}`);
  if (broken) lines.push(`  an invariant of ${broken.instance} is broken at step ${broken.step}`);
  return lines.join('\n');
}
