//! Questions about a step of a run, with instances, modes and edges by name, and the answers as records.

use std::path::Path;

use serde::Serialize;

use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::similar;
use crate::ir::{EdgeId, Entity, EntityId, Id, ModeId, SlotId, WorldId};
use crate::sim::{Script, Simulator};
use crate::why::{Nearly, Place, RunError, Why, nearly, place, why};

use super::Loaded;
use super::refusal::Refusal;

/// The version of the JSON result.
const RESULT_VERSION: u32 = 1;
/// Maximum number of names that a finding lists.
const MAX_LISTED: usize = 24;

/// The answer.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct WhyResult {
    /// The version of this format.
    pub version: u32,
    /// The path of the program.
    pub file: String,
    /// The world.
    pub world: String,
    /// What happened in the step; null with `--not`.
    pub why: Option<Why>,
    /// How near the guards came; null without `--not`.
    pub nearly: Option<Nearly>,
}

/// The schema of the JSON result.
#[cfg(feature = "testing")]
pub fn why_schema() -> schemars::Schema {
    schemars::schema_for!(WhyResult)
}

/// The edges that are asked about, and the mode that they lead to.
pub struct Asked {
    /// The mode.
    pub mode: Option<ModeId>,
    /// The edges.
    pub edges: Vec<EdgeId>,
}

/// A question about a step of a run, or about all of it.
#[derive(Debug, Clone, Default)]
pub struct WhyQuestion {
    /// The instance; that of player 1 if none is named.
    pub instance: Option<String>,
    /// Only edges that lead to this mode.
    pub mode: Option<String>,
    /// Only the edges on this line: `24`, or `FILE:24`.
    pub edge: Option<String>,
    /// Why the mode was never entered, or the edge never taken.
    pub not: bool,
    /// The step, or the last one of the run.
    pub at: Option<u64>,
}

/// Answers a question about a run of a script and a seed of what nature draws; also returns the instance and the edges
/// that were asked about.
///
/// # Errors
/// A name that the world does not have, a step that the run does not have.
pub fn answer_why(
    loaded: &Loaded,
    world: WorldId,
    file: &Path,
    (script, seed): (&Script, u64),
    question: &WhyQuestion,
) -> Result<(WhyResult, SlotId, Option<Asked>), Refusal> {
    let slot = slot(question, loaded, world).map_err(Refusal::of)?;
    let asked = edges(question, loaded, world, slot).map_err(Refusal::of)?;
    let sim = Simulator::new(&loaded.program, world);
    let inputs = (script, seed);
    let steps = question.at.unwrap_or(script.len());
    let answer = match &asked {
        Some(asked) if question.not => nearly(&sim, &loaded.sources, inputs, steps, slot, (asked.mode, &asked.edges))
            .map(|found| (None, Some(found))),
        _ => why(&sim, &loaded.sources, inputs, steps, slot).map(|found| (Some(found), None)),
    };
    let (mut of_step, of_run) = answer.map_err(|error| refusal(loaded, world, error, (steps, script)))?;
    if let (Some(why), Some(asked)) = (&mut of_step, &asked) {
        why.edges.retain(|edge| asked.edges.iter().any(|id| id.index() == edge.edge));
    }
    let result = WhyResult {
        version: RESULT_VERSION,
        file: file.display().to_string(),
        world: sim.world().name.clone(),
        why: of_step,
        nearly: of_run,
    };
    Ok((result, slot, asked))
}

/// Why a run has no such step.
fn refusal(loaded: &Loaded, world: WorldId, error: RunError, (steps, script): (u64, &Script)) -> Refusal {
    match error {
        RunError::Fault(fault, step) => Refusal::of(fault.fact(&loaded.program, world, step)),
        RunError::Over(slot, step) => {
            let name = &loaded.program.worlds[world].slots[slot].name;
            let why =
                format!("there is no step {steps}: `{name}` leaves the bounds in step {step}, which ends the run");
            let help = match script.len() {
                length if length > step => format!("the script has {length} steps; give `--at {step}` or less"),
                _ => format!("give `--at {step}` or less"),
            };
            Refusal::of(NoQuestion { why, near: None, help: Some(help) })
        }
    }
}

/// Names, as a finding lists them.
fn listed(names: &[&str]) -> Option<String> {
    let mut list: Vec<String> = names.iter().take(MAX_LISTED).map(|name| format!("`{name}`")).collect();
    if names.len() > MAX_LISTED {
        list.push(format!("{} more", names.len() - MAX_LISTED));
    }
    (!list.is_empty()).then(|| format!("there is {}", list.join(", ")))
}

/// The instance that is asked about.
fn slot(asked: &WhyQuestion, loaded: &Loaded, world: WorldId) -> Result<SlotId, NoQuestion> {
    let table = &loaded.program.worlds[world];
    let names: Vec<&str> = table.slots.iter().map(|slot| slot.name.as_str()).collect();
    match &asked.instance {
        Some(name) => table.slot_named(name).ok_or_else(|| NoQuestion {
            why: format!("no instance `{name}` in `{}`", table.name),
            near: similar(name, names.iter().copied()),
            help: listed(&names),
        }),
        None => table.players.iter().next().map(|player| player.slot).ok_or_else(|| NoQuestion {
            why: format!("`{}` has no player", table.name),
            near: None,
            help: listed(&names).map(|list| format!("choose an instance with `--instance NAME`; {list}")),
        }),
    }
}

/// The edges that are asked about; none if all of them are.
fn edges(question: &WhyQuestion, loaded: &Loaded, world: WorldId, slot: SlotId) -> Result<Option<Asked>, NoQuestion> {
    let id = loaded.program.worlds[world].slots[slot].entity;
    let entity = &loaded.program.entities[id];
    if let Some(name) = &question.mode {
        let mode = mode_named(entity, name)?;
        let leads = |edge: &EdgeId| entity.edges[*edge].target.is_some_and(|target| entity.is_inside(target, mode));
        // An edge to a mode around it leads to it, too, if it is what is entered first.
        let around = |edge: &EdgeId| {
            let target = entity.edges[*edge].target;
            target.is_some_and(|target| target != mode && entity.is_inside(mode, target))
        };
        let edges = entity.edges.ids().filter(|edge| leads(edge) || around(edge)).collect();
        return Ok(Some(Asked { mode: Some(mode), edges }));
    }
    if let Some(line) = &question.edge {
        return edges_on(loaded, id, line).map(|edges| Some(Asked { mode: None, edges }));
    }
    if question.not {
        return Err(NoQuestion {
            why: "`--not` asks about a mode or an edge".to_string(),
            near: None,
            help: Some("add `--mode NAME` or `--edge LINE`".to_string()),
        });
    }
    Ok(None)
}

/// A mode by its path, or by its last part if no other mode ends in it.
fn mode_named(entity: &Entity, name: &str) -> Result<ModeId, NoQuestion> {
    let paths: Vec<&str> = entity.modes.iter().map(|mode| mode.path.as_str()).collect();
    if let Some(mode) = entity.mode_named(name) {
        return Ok(mode);
    }
    let ends = |path: &str| path.strip_suffix(name).is_some_and(|rest| rest.ends_with('.'));
    let found: Vec<ModeId> = entity.modes.pairs().filter(|(_, mode)| ends(&mode.path)).map(|(id, _)| id).collect();
    match found.as_slice() {
        [mode] => Ok(*mode),
        _ => {
            let several: Vec<&str> = found.iter().map(|mode| entity.modes[*mode].path.as_str()).collect();
            let why = match several.is_empty() {
                true => format!("`{}` has no mode `{name}`", entity.name),
                false => format!("`{}` has several modes `{name}`", entity.name),
            };
            let list = if several.is_empty() { &paths } else { &several };
            Err(NoQuestion { why, near: similar(name, paths.iter().copied()), help: listed(list) })
        }
    }
}

/// The edges of an entity that begin on a line.
fn edges_on(loaded: &Loaded, id: EntityId, text: &str) -> Result<Vec<EdgeId>, NoQuestion> {
    let (file, line) = text.rsplit_once(':').map_or((None, text), |(file, line)| (Some(file), line));
    let entity = &loaded.program.entities[id];
    let spans = loaded.program.spans.entities[id].edges.pairs().filter(|(_, span)| loaded.sources.holds(**span));
    let places: Vec<_> = spans.map(|(edge, span)| (edge, place(&loaded.sources, *span))).collect();
    let is_there = |at: &Place| {
        line.trim().parse() == Ok(at.line)
            && file.is_none_or(|file| at.path == file || at.path.ends_with(&format!("/{file}")))
    };
    let found: Vec<EdgeId> = places.iter().filter(|(_, at)| is_there(at)).map(|(edge, _)| *edge).collect();
    if !found.is_empty() {
        return Ok(found);
    }
    let mut lines: Vec<String> = places.iter().map(|(_, at)| format!("{}:{}", at.path, at.line)).collect();
    lines.dedup();
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    let why = format!("no edge of `{}` is on line {text}", entity.name);
    Err(NoQuestion { why, near: None, help: listed(&lines) })
}
