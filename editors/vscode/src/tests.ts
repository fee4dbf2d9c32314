// The test explorer: the worlds of the workspace with their goals, `never`s and tests. They are run by the language server, on
// the texts of the editor.

import { basename } from 'node:path';
import * as vscode from 'vscode';
import { type Atom, type HypedServer, type Levels, locationOf, type Named, type Place, rangeOf, type Runnable, type World } from './server';

/** Time after the last key before the list is read again, ms. */
const REST = 400;

type Kind = 'file' | 'world' | 'goal' | 'never' | 'test';

/** What an item stands for. */
interface About {
  kind: Kind;
  uri: vscode.Uri;
  world: World;
  name: string;
}

/** What came of a claim of a test. */
interface Claim {
  claim: string;
  place: Place;
  passed: boolean;
  answer: string;
  reasons: string[];
  parts: Atom[];
  inputs: string | null;
}

interface TestResult {
  test: string;
  place: Place;
  passed: boolean;
  problems: string[];
  claims: Claim[];
  seconds: number;
}

interface Part {
  text: string;
  held: number;
  failed: number;
}

interface SuiteResult {
  tests: TestResult[];
  coverage?: {
    modes: { entity: string; mode: string; place: Place; entered: number }[];
    edges: { entity: string; from: string; to: string | null; place: Place; tried: number; taken: number; parts: Part[] }[];
  };
}

interface GoalAnswer {
  kind: string;
  goal: string;
  verdict: string;
  is_expected: boolean;
  steps: number | null;
  seconds_of_play: number | null;
  reasons?: string[];
  inputs: string | null;
  seconds: number;
}

/** The details of a file's coverage, which VS Code asks for when it shows the file. */
const details = new WeakMap<vscode.FileCoverage, vscode.StatementCoverage[]>();

export class Tests {
  private readonly controller = vscode.tests.createTestController('hypedc', 'Hyped');
  private readonly about = new WeakMap<vscode.TestItem, About>();
  private timer: NodeJS.Timeout | undefined;
  /** The documents whose lists are to be read again. */
  private readonly changed = new Map<string, vscode.Uri>();
  /** Whether all lists are. */
  private isStale = true;

  constructor(
    private readonly server: HypedServer,
    private readonly levels: Levels,
  ) {
    this.controller.refreshHandler = () => this.list();
    const { Run, Coverage } = vscode.TestRunProfileKind;
    this.controller.createRunProfile('Run', Run, (request, token) => this.run(request, token, false), true);
    const coverage = this.controller.createRunProfile('Coverage', Coverage, (request, token) => this.run(request, token, true), true);
    coverage.loadDetailedCoverage = async (_, file) => details.get(file) ?? [];
  }

  /** What is to be disposed of. */
  get disposables(): vscode.Disposable[] {
    const of = (document: vscode.TextDocument) => document.languageId === 'hyped' && this.listSoon(document.uri);
    const files = vscode.workspace.createFileSystemWatcher('**/*.hyped');
    return [
      this.controller,
      files,
      files.onDidCreate((uri) => this.listSoon(uri)),
      files.onDidChange((uri) => this.listSoon(uri)),
      files.onDidDelete((uri) => this.controller.items.delete(uri.toString())),
      vscode.workspace.onDidChangeTextDocument(({ document }) => of(document)),
      vscode.workspace.onDidOpenTextDocument(of),
    ];
  }

  /** Reads the list of a document, or of all, once nobody types. */
  listSoon(uri?: vscode.Uri): void {
    if (uri) this.changed.set(uri.toString(), uri);
    else this.isStale = true;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => void this.update().catch(() => undefined), REST);
  }

  private async update(): Promise<void> {
    const changed = [...this.changed.values()];
    this.changed.clear();
    if (this.isStale) return this.list();
    for (const uri of changed) {
      const [found] = await this.server.runnable(uri);
      if (found && found.worlds.length > 0) this.controller.items.add(this.file(found));
      else this.controller.items.delete(uri.toString());
    }
  }

  /** Reads the whole list. */
  async list(): Promise<void> {
    if (!this.server.isRunning) return;
    const found = await this.server.runnable();
    this.isStale = false;
    this.controller.items.replace(found.map((document) => this.file(document)));
  }

  private file({ uri, worlds }: Runnable): vscode.TestItem {
    const at = vscode.Uri.parse(uri);
    // The editor writes URIs in its own way.
    const id = at.toString();
    const file = this.controller.createTestItem(id, basename(at.path), at);
    file.children.replace(worlds.map((world) => this.world(at, id, world)));
    return file;
  }

  private world(uri: vscode.Uri, id: string, world: World): vscode.TestItem {
    const item = this.item(uri, `${id}#${world.name}`, world, { kind: 'world', uri, world, name: world.name });
    const all = (kind: Kind, of: Named[]) =>
      of.map((named) => {
        const child = this.item(uri, `${id}#${world.name}/${kind} ${named.name}`, named, { kind, uri, world, name: named.name });
        if (kind !== 'test') child.description = kind;
        return child;
      });
    item.children.replace([...all('test', world.tests), ...all('goal', world.goals), ...all('never', world.nevers)]);
    return item;
  }

  private item(uri: vscode.Uri, id: string, { name, selectionRange }: Named, about: About): vscode.TestItem {
    const item = this.controller.createTestItem(id, name, uri);
    item.range = rangeOf(selectionRange);
    this.about.set(item, about);
    return item;
  }

  /** The items that are run for some: those without children, in order. */
  private leaves(request: vscode.TestRunRequest): vscode.TestItem[] {
    const leaves: vscode.TestItem[] = [];
    const excluded = new Set(request.exclude?.map(({ id }) => id));
    const collect = (item: vscode.TestItem) => {
      if (excluded.has(item.id)) return;
      if (item.children.size === 0) leaves.push(item);
      else item.children.forEach(collect);
    };
    if (request.include) request.include.forEach(collect);
    else this.controller.items.forEach(collect);
    return leaves.filter((item) => this.about.get(item)?.kind !== 'world');
  }

  private async run(request: vscode.TestRunRequest, token: vscode.CancellationToken, covers: boolean): Promise<void> {
    const run = this.controller.createTestRun(request);
    const leaves = this.leaves(request).filter((item) => !covers || this.about.get(item)?.kind === 'test');
    leaves.forEach((item) => run.enqueued(item));
    const covered = new Map<string, Map<string, vscode.StatementCoverage>>();
    await vscode.window.withProgress({ location: vscode.ProgressLocation.Window, title: 'Hyped' }, async (progress) => {
      for (const [index, item] of leaves.entries()) {
        if (token.isCancellationRequested) {
          run.skipped(item);
          continue;
        }
        run.started(item);
        const report = (message: string, percentage: number) =>
          progress.report({ message: `${index + 1} of ${leaves.length}, ${item.label}: ${percentage} % ${message}` });
        try {
          await this.runOne(run, item, token, report, covers ? covered : undefined);
        } catch (error) {
          if (token.isCancellationRequested) run.skipped(item);
          else run.errored(item, new vscode.TestMessage(error instanceof Error ? error.message : String(error)));
        }
      }
    });
    for (const [path, statements] of covered) {
      const file = vscode.FileCoverage.fromDetails(vscode.Uri.file(path), [...statements.values()]);
      details.set(file, [...statements.values()]);
      run.addCoverage(file);
    }
    run.end();
  }

  private async runOne(
    run: vscode.TestRun,
    item: vscode.TestItem,
    token: vscode.CancellationToken,
    report: (message: string, percentage: number) => void,
    covered?: Map<string, Map<string, vscode.StatementCoverage>>,
  ): Promise<void> {
    const about = this.about.get(item);
    if (!about) return;
    const level = await this.levels.of(about.uri.toString(), about.world);
    if (level === null) return run.skipped(item);
    const target = { uri: about.uri.toString(), world: about.world.name, ...(level ? { level } : {}) };
    if (about.kind === 'test') {
      const coverage = covered !== undefined;
      const suite = await this.server.execute<SuiteResult>('hypedc.test', { ...target, tests: [about.name], coverage }, token, report);
      const [result] = suite.tests;
      if (!result) return run.skipped(item);
      if (covered && suite.coverage) addCoverage(covered, suite.coverage);
      const line = `${result.passed ? 'ok' : 'FAILED'}  ${about.world.name}: ${about.name}`;
      run.appendOutput(`${line}\r\n`, undefined, item);
      if (result.passed) run.passed(item, result.seconds * 1000);
      else run.failed(item, messages(item, result), result.seconds * 1000);
      return;
    }
    const asked = about.kind === 'goal' ? { goals: [about.name] } : { nevers: [about.name] };
    const { goals } = await this.server.execute<{ goals: GoalAnswer[] }>('hypedc.reach', { ...target, ...asked }, token, report);
    const [answer] = goals;
    if (!answer) return run.skipped(item);
    const words = wordsOf(answer);
    run.appendOutput(`${words}\r\n`, undefined, item);
    if (answer.is_expected) return run.passed(item, answer.seconds * 1000);
    const message = new vscode.TestMessage([words, ...(answer.inputs ? [`inputs: ${answer.inputs}`] : [])].join('\n'));
    message.location = item.uri && item.range ? new vscode.Location(item.uri, item.range) : undefined;
    run.failed(item, message, answer.seconds * 1000);
  }
}

/** An answer in a sentence. */
function wordsOf({ kind, goal, verdict, steps, seconds_of_play, reasons }: GoalAnswer): string {
  const when = steps === null ? '' : ` in ${(seconds_of_play ?? 0).toFixed(2)} s, step ${steps}`;
  const why = reasons?.length ? `: ${reasons.join('; ')}` : '';
  return `${kind} ${goal}: ${verdict.replaceAll(/[_-]/g, ' ')}${when}${why}`;
}

/** `hero.x > 3: 2 and 3` */
function valuesOf({ text, held, sides }: Atom): string {
  const holds = held === null ? 'cannot be evaluated' : held ? 'holds' : 'does not hold';
  return `${text} ${holds}${sides ? `: ${sides.map(short).join(' and ')}` : ''}`;
}

function short(value: number): string {
  return String(Number(value.toFixed(4)));
}

/** Why a test failed, at the lines of its claims. */
function messages(item: vscode.TestItem, result: TestResult): vscode.TestMessage[] {
  const at = (message: vscode.TestMessage, place: Place) => {
    // The item has the URI of the editor, the place a path.
    const { uri, range } = locationOf(place);
    message.location = new vscode.Location(item.uri && item.uri.fsPath === uri.fsPath ? item.uri : uri, range);
    return message;
  };
  const found = result.problems.map((problem) => at(new vscode.TestMessage(problem), result.place));
  for (const claim of result.claims.filter(({ passed }) => !passed)) {
    const values = claim.parts.map(valuesOf);
    // The editor shows the first line beside the claim.
    const first = claim.parts.find(({ held, sides }) => held === false && sides);
    const value = first?.sides ? `: ${first.sides.map(short).join(' and ')}` : '';
    found.push(at(new vscode.TestMessage([`${claim.answer}${value}`, ...claim.reasons, ...values].join('\n')), claim.place));
  }
  return found;
}

/** Adds what a test covers: modes that were entered, edges that were taken, both sides of the parts of their guards. */
function addCoverage(all: Map<string, Map<string, vscode.StatementCoverage>>, coverage: NonNullable<SuiteResult['coverage']>): void {
  const add = (place: Place, count: number, branches: [string, number][] = []) => {
    const { range } = locationOf(place);
    const file = all.get(place.path) ?? new Map<string, vscode.StatementCoverage>();
    all.set(place.path, file);
    const key = `${place.line}:${place.column}`;
    const known = file.get(key);
    const executed = count + Number(known?.executed ?? 0);
    const sums = branches.map(([label, n], index) => {
      const before = Number(known?.branches[index]?.executed ?? 0);
      return new vscode.BranchCoverage(n + before, range, label);
    });
    file.set(key, new vscode.StatementCoverage(executed, range, sums));
  };
  for (const { place, entered } of coverage.modes) add(place, entered);
  for (const { place, taken, parts } of coverage.edges) {
    add(place, taken, parts.flatMap(({ text, held, failed }): [string, number][] => [[`${text} is true`, held], [`${text} is false`, failed]]));
  }
}
