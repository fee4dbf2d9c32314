//! `hypedc diff`: what a change of a program broke. [`crate::diff`] compares; this part reads both programs and their
//! levels, asks, and shows the result.

pub(in crate::cli) mod args;
mod figure_words;
mod markdown;
mod result;
mod text;
mod words;

#[cfg(feature = "testing")]
pub(in crate::cli) use result::json_schema;

use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use crate::compile::{
    Asked, Changes, Compilation, ExtraQuestion, NumberSetting, compile_changed, is_name, question_name, written_number,
};
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::{Severity, render, similar};
use crate::diff::{
    Budget, Change, ChangeKind, Class, Compared, Version, changes, compare, level_changes, measure, outline,
    player_changes,
};
use crate::ir::{World, WorldId};
use crate::json::{self, Layout};
use crate::parallel::{self, TaskContext};
use crate::reach::Limits;
use crate::reach::query::Kind;
use crate::watch::{Meter, Watch};

use crate::cli::Exit;
use crate::cli::corpus::{all_levels, bar};
use crate::cli::disk::Disk;
use crate::cli::reach::ScriptDetail;
use crate::cli::reach::question::{NEVER, asked_only};
use crate::cli::refusal::Refusal;
use crate::cli::report::{Loaded, load_changed, plain_error, program_sha256, show_fact};
use crate::cli::watches::{Interrupt, TaskWatch, interrupted};
use args::{DeniedChange, DiffArgs, DiffFormat};
use result::{DiffResult, LevelResult, ProgramOf, RESULT_VERSION, WorldFigures};

pub(in crate::cli) fn run(args: &DiffArgs) -> io::Result<Exit> {
    if let Some(why) = args.numbers.refusal() {
        plain_error(&why)?;
        return Ok(Exit::Refused);
    }
    let (questions, numbers) = (questions(args), args.numbers.fixed());
    // Predicates about what only levels hold cannot be read without one: questions are read with each level.
    let load = |path: &Path, numbers: &[NumberSetting<'_>]| {
        load_changed(path, args.reading.of(None), &Changes { numbers, ..Changes::default() })
    };
    let levels = match levels(args) {
        Ok(levels) => levels,
        Err(why) => {
            plain_error(&why)?;
            return Ok(Exit::Refused);
        }
    };
    let (Some(old), Some(new)) = (load(&args.old, &[])?, load(args.after(), &numbers)?) else {
        return Ok(Exit::Refused);
    };
    let worlds = match world_pairs(args, (&old, &new)) {
        Ok(worlds) => worlds,
        Err(fact) => {
            show_fact(&new.sources, fact)?;
            return Ok(Exit::Refused);
        }
    };
    let comparison = Run { args, questions: &questions, numbers: &numbers, old: &old, new: &new, worlds, levels };
    if let Err(refusal) = comparison.check() {
        refusal.show(&new.sources)?;
        return Ok(Exit::Refused);
    }
    let result = comparison.go();
    let mut out = io::stdout().lock();
    match args.format {
        DiffFormat::Human => write!(out, "{}", text::result_text(&result, ScriptDetail::on_terminal(args.verbose)))?,
        DiffFormat::Markdown => write!(out, "{}", markdown::result_markdown(&result))?,
        DiffFormat::Json => {
            json::write(&result, Layout::Indented, &mut out)?;
            writeln!(out)?;
        }
    }
    let is_denied = match args.deny {
        None => false,
        Some(DeniedChange::Lost) => result.count(Class::Lost) > 0,
        Some(DeniedChange::Changes) => !result.is_same || result.levels.iter().any(|level| !level.is_same),
    };
    let is_refuted = result.levels.iter().any(|level| level.is_refuted);
    Ok(if result.is_worse || result.stopped || is_denied || is_refuted { Exit::No } else { Exit::Yes })
}

/// The questions of the arguments.
fn questions(args: &DiffArgs) -> Vec<ExtraQuestion<'_>> {
    let world = args.world.as_deref();
    let mut all = Vec::new();
    for text in &args.goal {
        all.push(ExtraQuestion { asked: Asked::Goal, world, text, origin: "--goal" });
    }
    for text in &args.never {
        all.push(ExtraQuestion { asked: Asked::Never, world, text, origin: NEVER });
    }
    all
}

/// One of the two versions.
#[derive(Debug, Clone, Copy)]
enum Side {
    Old,
    New,
}

/// A level in both versions; none for what only one of them has.
struct LevelPair {
    old: Option<PathBuf>,
    new: Option<PathBuf>,
}

impl LevelPair {
    fn name(&self) -> Option<String> {
        self.new.as_ref().or(self.old.as_ref()).map(|path| path.display().to_string())
    }
}

/// The levels; with `--old-map`, paired by the names of their files.
fn levels(args: &DiffArgs) -> Result<Vec<LevelPair>, String> {
    let paths = |map: &[PathBuf]| -> Result<Vec<PathBuf>, String> {
        Ok(all_levels(map)?.into_iter().filter_map(|level| level.path).collect())
    };
    let (new, old) = (paths(&args.map)?, paths(&args.old_map)?);
    if args.old_map.is_empty() {
        return Ok(new.into_iter().map(|path| LevelPair { old: Some(path.clone()), new: Some(path) }).collect());
    }
    let is_same_name = |a: &Path, b: &Path| a.file_name() == b.file_name();
    let mut pairs = Vec::new();
    let gone = old.iter().filter(|path| !new.iter().any(|other| is_same_name(path, other)));
    let gone: Vec<LevelPair> = gone.map(|path| LevelPair { old: Some(path.clone()), new: None }).collect();
    for path in new {
        let partner = old.iter().find(|other| is_same_name(other, &path)).cloned();
        pairs.push(LevelPair { old: partner, new: Some(path) });
    }
    pairs.extend(gone);
    Ok(pairs)
}

/// The names of the worlds that both programs have, old and new; the only ones are paired whatever their names are.
fn world_pairs(args: &DiffArgs, (old, new): (&Loaded, &Loaded)) -> Result<Vec<(String, String)>, NoQuestion> {
    let names = |loaded: &Loaded| loaded.program.worlds.iter().map(|world| world.name.clone()).collect::<Vec<_>>();
    let (before, now) = (names(old), names(new));
    if let Some(name) = &args.world {
        for (known, file) in [(&before, args.old.as_path()), (&now, args.after())] {
            if !known.contains(name) {
                let list: Vec<String> = known.iter().map(|name| format!("`{name}`")).collect();
                return Err(NoQuestion {
                    why: format!("no world `{name}` in `{}`", file.display()),
                    near: similar(name, known.iter().map(String::as_str)),
                    help: (!list.is_empty()).then(|| format!("there is {}", list.join(", "))),
                });
            }
        }
        return Ok(vec![(name.clone(), name.clone())]);
    }
    match (before.as_slice(), now.as_slice()) {
        ([before], [now]) => Ok(vec![(before.clone(), now.clone())]),
        _ => Ok(now.into_iter().filter(|name| before.contains(name)).map(|name| (name.clone(), name)).collect()),
    }
}

/// A comparison.
struct Run<'r> {
    args: &'r DiffArgs,
    questions: &'r [ExtraQuestion<'r>],
    /// The numbers of the new program that are set.
    numbers: &'r [NumberSetting<'r>],
    old: &'r Loaded,
    new: &'r Loaded,
    worlds: Vec<(String, String)>,
    levels: Vec<LevelPair>,
}

impl Run<'_> {
    /// Whether the questions can be asked at all.
    fn check(&self) -> Result<(), Refusal> {
        let all = || self.old.program.worlds.iter().chain(self.new.program.worlds.iter());
        for question in self.questions.iter().filter(|question| is_name(question.text)) {
            let known = |world: &World| match question.asked {
                Asked::Never => world.nevers.iter().map(|never| never.name.clone()).collect::<Vec<_>>(),
                Asked::Goal | Asked::Either => world.goals.iter().map(|goal| goal.name.clone()).collect(),
            };
            let known: Vec<String> = all().flat_map(|world| known(world)).collect();
            if !known.iter().any(|name| name == question.text) {
                let word = question.origin.trim_start_matches('-');
                let near = similar(question.text, known.iter().map(String::as_str));
                let why = format!("no {word} `{}` in any of the programs", question.text);
                return Err(Refusal::of(NoQuestion { why, near, help: None }));
            }
        }
        if !self.questions.is_empty() {
            let first = self.levels.first().map(|level| (level.old.as_ref(), level.new.as_ref()));
            let (old, new) = first.unwrap_or_default();
            for (side, level) in [(Side::Old, old), (Side::New, new)] {
                self.compiled(side, level).map_err(Refusal::Plain)?;
            }
        }
        let is_open = all().any(|world| world.open.is_some());
        if !self.levels.is_empty() && !is_open {
            let why = "`--map` is for worlds with an open map, and the programs have none".to_string();
            let help = Some("write `map level` in a space, or leave `--map` out".to_string());
            return Err(Refusal::of(NoQuestion { why, near: None, help }));
        }
        Ok(())
    }

    fn go(self) -> DiffResult {
        let args = self.args;
        let shas = [program_sha256(&self.old.program), program_sha256(&self.new.program)];
        let is_same = shas[0] == shas[1];
        let [old, new] = [(args.old.as_path(), &shas[0]), (args.after(), &shas[1])]
            .map(|(file, sha)| ProgramOf { file: file.display().to_string(), program_sha256: sha.clone() });
        let parts = |path: &Path| outline(path, &Disk);
        let mut found = if is_same { Vec::new() } else { changes(&parts(&args.old), &parts(args.after())) };
        if !is_same {
            found.extend(self.numbers.iter().map(|number| self.set_number(number)));
        }
        let mut result = DiffResult {
            version: RESULT_VERSION,
            hypedc: env!("CARGO_PKG_VERSION"),
            old,
            new,
            set: args.numbers.texts(),
            seed: args.seed,
            nodes_limit: args.nodes,
            is_same,
            stopped: false,
            is_worse: false,
            changes: found,
            maps: Vec::new(),
            figures: Vec::new(),
            levels: Vec::new(),
        };
        if !is_same {
            self.moves(&mut result);
        }
        self.answers(&mut result);
        let is_worse = |level: &LevelResult| level.is_broken || level.class() == Class::Worse;
        result.is_worse = result.levels.iter().any(is_worse);
        result
    }

    /// A number that is set, as a change of the program.
    fn set_number(&self, NumberSetting { path, value }: &NumberSetting<'_>) -> Change {
        let written = written_number(self.args.after(), &Disk, path).ok();
        let what = if path.contains('.') { "param" } else { "const" };
        let old = written.and_then(|written| Some(format!("{}{}", written.literal?, written.unit)));
        Change {
            change: ChangeKind::Changed,
            what,
            name: path.to_string(),
            old,
            new: Some(value.to_string()),
            place: "--set".to_string(),
        }
    }

    /// The tiles of the programs' own maps, and how players move.
    fn moves(&self, result: &mut DiffResult) {
        // An open world has no ground without a level.
        let level = self.levels.iter().find_map(|level| level.old.as_ref().zip(level.new.as_ref()));
        let with_level = level.and_then(|(old, new)| {
            let old = self.compiled(Side::Old, Some(old)).ok()?;
            Some((old, self.compiled(Side::New, Some(new)).ok()?))
        });
        let interrupt = Interrupt::new();
        let meter = Meter::new(&interrupt);
        for (before, now) in &self.worlds {
            let (Some(old), Some(new)) = (self.old.program.world_named(before), self.new.program.world_named(now))
            else {
                continue;
            };
            let is_open = |loaded: &Loaded, id: WorldId| loaded.program.worlds[id].open.is_some();
            let (first, second) = match &with_level {
                Some((first, second)) if is_open(self.old, old) || is_open(self.new, new) => (first, second),
                _ => {
                    let [was, is] = [(self.old, old), (self.new, new)]
                        .map(|(loaded, id)| (&*loaded.program, &*loaded.program.worlds[id]));
                    result.maps.extend(level_changes(was, is));
                    (self.old, self.new)
                }
            };
            let (Some(was), Some(is)) = (measure(&first.program, old, &meter), measure(&second.program, new, &meter))
            else {
                result.stopped = true;
                return;
            };
            let changes = player_changes(&was, &is);
            if !was.is_empty() || !is.is_empty() {
                result.figures.push(WorldFigures { world: now.clone(), old: was, new: is, changes });
            }
        }
    }

    /// Asks both programs, level by level.
    fn answers(&self, result: &mut DiffResult) {
        let own = [LevelPair { old: None, new: None }];
        let levels: Vec<&LevelPair> = own.iter().chain(&self.levels).collect();
        let flag = interrupted();
        let stop = || flag.load(Ordering::SeqCst);
        let bar = bar(levels.len());
        let mut all: Vec<Option<Vec<LevelResult>>> = levels.iter().map(|_| None).collect();
        let task = |at: usize, context: &TaskContext<'_, Vec<LevelResult>>| {
            let watch = TaskWatch::new(context, None);
            let found = self.level(levels[at], &watch);
            if !watch.stop() {
                context.submit(found);
            }
        };
        parallel::work(levels.len(), parallel::threads(self.args.threads), &stop, &task, &mut |level, found| {
            bar.inc(1);
            all[level] = Some(found);
            ControlFlow::Continue(())
        });
        bar.finish_and_clear();
        result.stopped |= all.iter().any(Option::is_none);
        result.levels = all.into_iter().flatten().flatten().collect();
    }

    /// A program with a level.
    fn compiled(&self, side: Side, level: Option<&PathBuf>) -> Result<Loaded, String> {
        let given = self.args.reading.of(level.map(PathBuf::as_path));
        let (file, numbers) = match side {
            Side::Old => (self.args.old.as_path(), &[][..]),
            Side::New => (self.args.after(), self.numbers),
        };
        let changes = Changes { questions: self.questions, numbers, ..Changes::default() };
        let Compilation { sources, program, diagnostics, .. } = compile_changed(file, given, &changes, &Disk);
        program.map(|program| Loaded { sources: sources.clone(), program }).ok_or_else(|| {
            let errors = diagnostics.iter().filter(|finding| finding.severity == Severity::Error);
            render::short(&sources, errors).trim_end().to_string()
        })
    }

    /// Whether a world leaves its map open.
    fn takes_level(&self, old: &str, new: &str) -> bool {
        let is_open = |loaded: &Loaded, name| {
            loaded.program.world_named(name).is_some_and(|id| loaded.program.worlds[id].open.is_some())
        };
        is_open(self.old, old) || is_open(self.new, new)
    }

    /// The worlds that a level is for; without a level, those that have their maps.
    fn level(&self, level: &LevelPair, watch: &dyn Watch) -> Vec<LevelResult> {
        let name = level.name();
        if name.is_none() && self.worlds.iter().all(|(old, new)| self.takes_level(old, new)) {
            return Vec::new();
        }
        let versions = [(Side::Old, &level.old), (Side::New, &level.new)].map(|(side, path)| match path {
            Some(_) => self.compiled(side, path.as_ref()),
            None if name.is_none() => self.compiled(side, None),
            None => Err("there is no such level".to_string()),
        });
        match versions {
            [Ok(old), Ok(new)] => self.worlds(name.as_deref(), &old, &new, watch),
            [old, new] => {
                let is_broken = old.is_ok() && new.is_err();
                let what = |version: Result<Loaded, String>, word| version.err().map(|why| format!("{word}: {why}"));
                let errors = [what(old, "old"), what(new, "new")].into_iter().flatten().collect::<Vec<_>>();
                let world = self.worlds.first().map_or(String::new(), |(_, world)| world.clone());
                let mut row = blank(name, world);
                (row.error, row.is_broken) = (Some(errors.join("; ")), is_broken && level.new.is_some());
                vec![row]
            }
        }
    }

    fn worlds(&self, level: Option<&str>, old: &Loaded, new: &Loaded, watch: &dyn Watch) -> Vec<LevelResult> {
        let is_same = program_sha256(&old.program) == program_sha256(&new.program);
        let mut all = Vec::new();
        for (before, now) in &self.worlds {
            let (Some(was), Some(is)) = (old.program.world_named(before), new.program.world_named(now)) else {
                continue;
            };
            let open = |loaded: &Loaded, id: WorldId| loaded.program.worlds[id].open.is_some();
            // With levels, only worlds that take them; the others are compared once.
            if self.takes_level(before, now) != level.is_some() || open(old, was) || open(new, is) {
                continue;
            }
            let mut row = blank(level.map(str::to_string), now.clone());
            row.is_same = is_same;
            if level.is_some() && !self.args.old_map.is_empty() {
                let (before, now) = (&old.program.worlds[was], &new.program.worlds[is]);
                row.maps = level_changes((&old.program, before), (&new.program, now));
            }
            if !is_same && !self.args.no_search {
                let asked = [(old, was), (new, is)].map(|(loaded, world)| asked_only(loaded, world));
                let questions = self.names(&old.program.worlds[was], &new.program.worlds[is]);
                let limits = Limits { nodes: self.args.nodes, memory: self.args.memory << 20 };
                let budget = Budget { limits, seed: self.args.seed };
                let sides = (
                    Version { program: &old.program, sources: &old.sources, world: was, asked: &asked[0] },
                    Version { program: &new.program, sources: &new.sources, world: is, asked: &asked[1] },
                );
                let Compared { comparisons, is_refuted } = compare(sides.0, sides.1, &questions, budget, watch);
                (row.questions, row.is_refuted) = (comparisons, is_refuted);
            }
            all.push(row);
        }
        all
    }

    /// The questions that are asked of a world: those of the arguments, or all.
    fn names(&self, before: &World, now: &World) -> Vec<(Kind, String)> {
        if !self.questions.is_empty() {
            let kind = |asked| if asked == Asked::Never { Kind::Never } else { Kind::Goal };
            return self.questions.iter().map(|of| (kind(of.asked), question_name(of.text))).collect();
        }
        let goals = now.goals.iter().filter(|goal| before.goal_named(&goal.name).is_some());
        let nevers = now.nevers.iter().filter(|never| before.never_named(&never.name).is_some());
        let goals = goals.map(|goal| (Kind::Goal, goal.name.clone()));
        goals.chain(nevers.map(|never| (Kind::Never, never.name.clone()))).collect()
    }
}

/// A row without answers.
fn blank(level: Option<String>, world: String) -> LevelResult {
    LevelResult {
        level,
        world,
        is_same: false,
        error: None,
        is_broken: false,
        is_refuted: false,
        maps: Vec::new(),
        questions: Vec::new(),
    }
}
