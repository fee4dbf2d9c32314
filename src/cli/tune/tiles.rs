//! `hypedc tune --tiles`: the fewest tiles of maps of text to add or to remove. [`crate::tune`] finds them; this part
//! changes the text, compiles and shows.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use serde::Serialize;

use crate::compile::{Compilation, compile_changed};
use crate::ir::WorldId;
use crate::json::{self, Layout};
use crate::reach::Conclusion;
use crate::reach::query::Query;
use crate::studio::Written;
use crate::tune::{
    Built, Host, LevelHost, LevelTrial, TileChange, TileEdit, TileQuestion, TileSet, TilesFound, Wanted, tile_edits,
    tune_tiles,
};
use crate::watch::Watch;

use super::Disked;
use super::args::{TilesName, TuneArgs};
use super::text::{limits, timed_verdict};
use crate::cli::Exit;
use crate::cli::args::ResultFormat;
use crate::cli::disk::Changed;
use crate::cli::reach::{ScriptDetail, counted};
use crate::cli::refusal::Refusal;
use crate::cli::report::{Loaded, find_world, plain_error, program_sha256, written};

/// The version of the JSON result.
const RESULT_VERSION: u32 = 1;

/// The fewest tiles that turn an answer.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct TilesResult {
    /// The version of this format.
    version: u32,
    /// The path of the program.
    file: String,
    /// The world.
    world: String,
    /// A hash of what the program as it is means.
    program_sha256: String,
    /// Numbers of the program that were set.
    set: Vec<String>,
    /// The goal.
    goal: String,
    /// Whether tiles are sought with which the goal is proven unreachable.
    prevent: bool,
    /// What must never hold on a path; null if anything may.
    without: Option<String>,
    /// The scripts in whose last states the paths begin; if empty, in the initial state.
    after: Vec<String>,
    /// The number of tiles that may be changed.
    allowed: u64,
    /// What came of the level as it is.
    base: LevelTrial,
    /// The fewest tiles that were found; null if there are none, or if none are needed.
    change: Option<TileSet>,
    /// Where the goal should not be reached: tiles with which it was not found, without a proof.
    not_found: Option<Vec<TileEdit>>,
    /// The number of sets of tiles that were tried.
    tried: u64,
    /// The rows that change, as they become.
    rows: Vec<MapRow>,
    /// Whether it was stopped before its end.
    stopped: bool,
}

/// A row of a map.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct MapRow {
    /// The space.
    space: String,
    /// The row, from the top, the first is 1.
    row: usize,
    /// Its characters.
    text: String,
}

/// The schema of the result.
#[cfg(feature = "testing")]
pub(in crate::cli) fn json_schema() -> schemars::Schema {
    schemars::schema_for!(TilesResult)
}

/// Compiles levels with some tiles changed.
struct Levels<'a> {
    host: &'a Disked<'a>,
    args: &'a TuneArgs,
    world: &'a str,
}

impl Levels<'_> {
    /// The files with some tiles changed.
    fn edited(&self, edits: &[TileEdit]) -> Result<Changed, String> {
        let mut files = Changed::default();
        for edit in edits {
            let written = Written::read(&self.args.file, self.args.level.map.as_deref(), &files);
            let cell = (edit.column.saturating_sub(1), edit.row.saturating_sub(1));
            let stroke = written.stroke((self.world, &edit.space), cell, &edit.to.to_string());
            let replaced = stroke.and_then(|(path, span, text)| Some((path, written.replaced(span, &text)?)));
            let (path, text) = replaced.ok_or_else(|| {
                format!("the map of `{}` cannot be changed: tiles of maps of text can be", edit.space)
            })?;
            files.texts.insert(path, text);
        }
        Ok(files)
    }
}

impl LevelHost for Levels<'_> {
    fn build(&self, edits: &[TileEdit]) -> Result<Built, String> {
        let files = self.edited(edits)?;
        let numbers = self.args.numbers.fixed();
        let Compilation { sources, program, .. } =
            compile_changed(&self.args.file, self.args.level.file(), &self.host.changes(&numbers), &files);
        let program = program.ok_or("the program does not compile with these tiles")?;
        let world = find_world(&program, &self.args.file, self.args.world.as_deref());
        let world = world.map_err(|why| Refusal::of(why).text(&sources))?;
        Ok(Built { sources, program, world })
    }

    fn watched(&self, what: &str, work: &mut dyn FnMut(&dyn Watch)) {
        self.host.watched(what, work);
    }

    fn is_stopped(&self) -> bool {
        self.host.is_stopped()
    }
}

pub(super) fn run(
    args: &TuneArgs,
    (host, loaded, world): (&Disked<'_>, Loaded, WorldId),
    query: Query,
    change: TilesName,
) -> io::Result<Exit> {
    let change = match change {
        TilesName::Add => TileChange::Add,
        TilesName::Remove => TileChange::Remove,
        TilesName::Change => TileChange::Change,
    };
    let name = loaded.program.worlds[world].name.clone();
    let goal = query.targets.first().map_or("", |target| target.name(&loaded.program.worlds[world])).to_string();
    let built = Built { sources: loaded.sources, program: loaded.program, world };
    let levels = Levels { host, args, world: &name };
    let wanted = if args.prevent { Wanted::Prevented } else { Wanted::Reached };
    let found = tile_edits(&built, change, args.symbol).and_then(|edits| {
        let allowed = edits.len() as u64;
        // That the text can be changed at all.
        levels.edited(edits.get(..1).unwrap_or_default())?;
        let question = TileQuestion { query, wanted, edits, most: usize::from(args.max) };
        Ok((allowed, tune_tiles(&levels, &question)?))
    });
    let (allowed, found) = match found {
        Ok(found) => found,
        Err(why) => {
            plain_error(&why)?;
            return Ok(Exit::Refused);
        }
    };
    let TilesFound { base: Some(base), set, tried, not_found, is_stopped } = found else { return Ok(Exit::No) };
    let edits: &[TileEdit] = set.as_ref().map_or(&[], |set| &set.edits);
    let rows = rows(&levels, edits);
    if let (Some(path), false) = (&args.save_map, edits.is_empty())
        && let Err(why) = saved(&levels, edits, path)
    {
        plain_error(&why)?;
        return Ok(Exit::Refused);
    }
    let inputs = set.as_ref().and_then(|set| set.trial.inputs.as_ref());
    if let (Some(path), Some(inputs)) = (&args.save_inputs, inputs)
        && !written(path, &format!("{inputs}\n"))?
    {
        return Ok(Exit::Refused);
    }
    let result = TilesResult {
        version: RESULT_VERSION,
        file: args.file.display().to_string(),
        program_sha256: program_sha256(&built.program),
        set: args.numbers.texts(),
        goal,
        prevent: args.prevent,
        without: args.without.clone(),
        after: args.after.clone(),
        allowed,
        base,
        change: set,
        not_found,
        tried,
        rows,
        stopped: is_stopped,
        world: name.clone(),
    };
    let mut out = io::stdout().lock();
    match args.format {
        ResultFormat::Human => write!(out, "{}", text(&result, args))?,
        ResultFormat::Json => {
            json::write(&result, Layout::Indented, &mut out)?;
            writeln!(out)?;
        }
    }
    let is_yes = (result.change.is_some() || is_wanted(&result)) && !result.stopped;
    Ok(if is_yes { Exit::Yes } else { Exit::No })
}

/// Whether the level as it is has the wanted answer.
fn is_wanted(result: &TilesResult) -> bool {
    match result.prevent {
        true => result.base.verdict == Conclusion::ProvenUnreachable,
        false => result.base.verdict == Conclusion::Reached,
    }
}

/// Writes the file that holds the map; if several change, an error.
fn saved(levels: &Levels<'_>, edits: &[TileEdit], path: &Path) -> Result<(), String> {
    let files = levels.edited(edits)?;
    let mut texts = files.texts.values();
    match (texts.next(), texts.next()) {
        (Some(text), None) => {
            fs::write(path, text).map_err(|error| format!("cannot write `{}`: {error}", path.display()))
        }
        _ => Err("the changed tiles are in several files: `--save-map` writes one".to_string()),
    }
}

/// The rows of maps in which tiles change, as they become.
fn rows(levels: &Levels<'_>, edits: &[TileEdit]) -> Vec<MapRow> {
    let Ok(built) = levels.build(edits) else { return Vec::new() };
    let world = &built.program.worlds[built.world];
    let mut rows: Vec<MapRow> = Vec::new();
    for edit in edits {
        let is_known = rows.iter().any(|row| (&row.space, row.row) == (&edit.space, edit.row));
        let map = world.spaces.iter().find(|space| space.name == edit.space).and_then(|space| space.map.as_ref());
        let Some(map) = map.filter(|_| !is_known) else { continue };
        let Some(row) = map.rows.checked_sub(edit.row) else { continue };
        let cells = map.cells.iter().skip(row * map.columns).take(map.columns);
        let text = cells.map(|kind| map.kinds[usize::from(*kind)].symbol).collect();
        rows.push(MapRow { space: edit.space.clone(), row: edit.row, text });
    }
    rows.sort_by(|a, b| (&a.space, a.row).cmp(&(&b.space, b.row)));
    rows
}

fn text(result: &TilesResult, args: &TuneArgs) -> String {
    let TilesResult { file, world, goal, base, .. } = result;
    let set: String = result.set.iter().map(|set| format!(", {set}")).collect();
    let tiles = counted(result.allowed, "tile");
    let mut out = format!("{file}, world {world}{set}{}: {tiles} may be changed\n", limits(args));
    match &result.change {
        Some(change) => {
            out.push_str(&format!(
                "  goal {goal}: {} with {} changed\n",
                verdict(&change.trial),
                counted(change.edits.len() as u64, "tile")
            ));
            for edit in &change.edits {
                let TileEdit { space, column, row, from, to } = edit;
                out.push_str(&format!(
                    "    tile      column {column}, row {row} of {space}: `{from}` becomes `{to}`\n"
                ));
            }
            for row in &result.rows {
                out.push_str(&format!("    {:>8}  {}\n", format!("row {}", row.row), row.text));
                let marks = change.edits.iter().filter(|edit| (&edit.space, edit.row) == (&row.space, row.row));
                let mut under = vec![' '; row.text.chars().count()];
                marks.for_each(|edit| under[edit.column - 1] = '^');
                let under: String = under.into_iter().collect();
                out.push_str(&format!("              {}\n", under.trim_end()));
            }
            let script =
                |inputs: &String| format!("    inputs    {}\n", ScriptDetail::on_terminal(args.verbose).script(inputs));
            out.extend(change.trial.inputs.as_ref().map(script));
            out.extend(change.trial.reasons.iter().map(|reason| format!("    why       {reason}\n")));
            out.push_str(&format!("    as it is  {}\n", verdict(base)));
            out.push_str(match (change.is_fewest, change.edits.len()) {
                (true, _) => "    fewest    it is certain that fewer of these tiles are not enough\n",
                (false, 1) => "    fewest    not proven: perhaps nothing needs to change, as no search found out\n",
                (false, _) => "    fewest    of what was tried; fewer tiles may be enough\n",
            });
        }
        None if is_wanted(result) => {
            out.push_str(&format!("  goal {goal}: {} as it is, nothing needs to change\n", verdict(base)));
        }
        None => {
            out.push_str(&format!("  goal {goal}: {} as it is\n", verdict(base)));
            let most = counted(args.max.into(), "tile");
            out.push_str(&match (result.prevent, base.verdict) {
                (true, Conclusion::Reached) => {
                    format!("    no way to change up to {most} was found so that it is proven unreachable\n")
                }
                (true, _) => "    no way is known that could be stopped; `--nodes N` searches for longer\n".to_string(),
                (false, _) => format!("    no way to change up to {most} was found so that it is reached\n"),
            });
            if let Some(edits) = &result.not_found {
                let one = |edit: &TileEdit| format!("column {}, row {} of {}", edit.column, edit.row, edit.space);
                let all: Vec<String> = edits.iter().map(one).collect();
                out.push_str(&format!("    with {} it was not found, which is no proof\n", all.join(" and ")));
            }
        }
    }
    out.push_str(&format!("    tried     {} sets of tiles\n", result.tried));
    let is_saved = result.change.is_some();
    for (path, what) in [(&args.save_map, "map"), (&args.save_inputs, "inputs")] {
        out.extend(
            path.as_ref().filter(|_| is_saved).map(|path| format!("    saved     {what}: {}\n", path.display())),
        );
    }
    if result.stopped {
        out.push_str("    stopped before all was tried\n");
    }
    out
}

/// The verdict of a level.
fn verdict(trial: &LevelTrial) -> String {
    timed_verdict(trial.verdict, (trial.seconds_of_play, trial.steps), trial.luck.as_ref())
}
