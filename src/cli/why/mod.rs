//! `hypedc why`: why an instance did what it did in a step of a run, or why it never entered a mode.
//! [`crate::why`] finds out; this part reads the question, and shows the answer.

mod text;

use std::io::{self, IsTerminal, Write};

use serde::Serialize;

use crate::compile::Changes;
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::similar;
use crate::ir::{EdgeId, Entity, EntityId, ModeId, SlotId, WorldId};
use crate::json::{self, Layout};
use crate::sim::{Script, Simulator};
use crate::why::{Nearly, RunError, Why, nearly, place, why};

use super::Exit;
use super::args::{ResultFormat, WhyArgs};
use super::report::{Loaded, choose_world, colored, load_changed, plain_error, show_fact};
use super::sim::script_of;
use text::{Paint, nearly_text, why_text};

/// The version of the JSON result.
const RESULT_VERSION: u32 = 1;
/// Maximum number of names that a finding lists.
const MAX_LISTED: usize = 24;

/// The answer.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct WhyResult {
    /// The version of this format.
    version: u32,
    /// The path of the program.
    file: String,
    /// The world.
    world: String,
    /// What happened in the step; null with `--not`.
    why: Option<Why>,
    /// How near the guards came; null without `--not`.
    nearly: Option<Nearly>,
}

/// The schema of the JSON result.
#[cfg(feature = "testing")]
pub(super) fn json_schema() -> schemars::Schema {
    schemars::schema_for!(WhyResult)
}

/// The edges that are asked about, and the mode that they lead to.
struct Asked {
    mode: Option<ModeId>,
    edges: Vec<EdgeId>,
}

pub(super) fn run(args: &WhyArgs) -> io::Result<Exit> {
    if let Some(why) = args.numbers.refusal() {
        plain_error(&why)?;
        return Ok(Exit::Refused);
    }
    let numbers = args.numbers.fixed();
    let changes = Changes { numbers: &numbers, ..Changes::default() };
    let Some(mut loaded) = load_changed(&args.file, args.level.file(), &changes)? else { return Ok(Exit::Refused) };
    let Some(world) = choose_world(&loaded, &args.file, args.world.as_deref())? else { return Ok(Exit::Refused) };
    let steps = (args.at.is_some(), "--at STEP");
    let Some(script) = script_of(&args.script, steps, &mut loaded, world)? else {
        return Ok(Exit::Refused);
    };
    let asked = slot(args, &loaded, world).and_then(|slot| Ok((slot, asked(args, &loaded, world, slot)?)));
    let (slot, asked) = match asked {
        Ok(asked) => asked,
        Err(fact) => {
            show_fact(&loaded.sources, fact)?;
            return Ok(Exit::Refused);
        }
    };
    let sim = Simulator::new(&loaded.program, world);
    let inputs = (&script, args.chance.unwrap_or_default());
    let steps = args.at.unwrap_or(script.len());
    let answer = match &asked {
        Some(asked) if args.not => nearly(&sim, &loaded.sources, inputs, steps, slot, (asked.mode, &asked.edges))
            .map(|found| (None, Some(found))),
        _ => why(&sim, &loaded.sources, inputs, steps, slot).map(|found| (Some(found), None)),
    };
    let (mut of_step, of_run) = match answer {
        Ok(answer) => answer,
        Err(error) => return refused(&loaded, world, error, (steps, &script)),
    };
    let was_entered = of_run.as_ref().is_some_and(|found| found.entered.is_some());
    if let (Some(why), Some(asked)) = (&mut of_step, &asked) {
        why.edges.retain(|edge| asked.edges.iter().any(|id| crate::ir::Id::index(*id) == edge.edge));
    }
    let result = WhyResult {
        version: RESULT_VERSION,
        file: args.file.display().to_string(),
        world: sim.world().name.clone(),
        why: of_step,
        nearly: of_run,
    };
    let mut out = io::stdout().lock();
    match args.format {
        ResultFormat::Json => {
            json::write(&result, Layout::Indented, &mut out)?;
            writeln!(out)?;
        }
        ResultFormat::Human => {
            let paint = Paint(colored(io::stdout().is_terminal()));
            let head = format!("{}, world {}", result.file, result.world);
            if let Some(why) = &result.why {
                let others = asked.as_ref().map(|asked| starts(&loaded, world, slot, asked));
                write!(out, "{}", why_text(&head, why, others.as_deref(), sim.world().spaces.len() > 1, paint))?;
            }
            if let Some(nearly) = &result.nearly {
                write!(out, "{}", nearly_text(&head, nearly, paint))?;
            }
        }
    }
    Ok(if was_entered { Exit::No } else { Exit::Yes })
}

/// Reports why a run has no such step.
fn refused(loaded: &Loaded, world: WorldId, error: RunError, (steps, script): (u64, &Script)) -> io::Result<Exit> {
    match error {
        RunError::Fault(fault, step) => show_fact(&loaded.sources, fault.fact(&loaded.program, world, step))?,
        RunError::Over(slot, step) => {
            let name = &loaded.program.worlds[world].slots[slot].name;
            let why =
                format!("there is no step {steps}: `{name}` leaves the bounds in step {step}, which ends the run");
            let help = match script.len() {
                length if length > step => format!("the script has {length} steps; give `--at {step}` or less"),
                _ => format!("give `--at {step}` or less"),
            };
            show_fact(&loaded.sources, NoQuestion { why, near: None, help: Some(help) })?;
        }
    }
    Ok(Exit::Refused)
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
fn slot(args: &WhyArgs, loaded: &Loaded, world: WorldId) -> Result<SlotId, NoQuestion> {
    let table = &loaded.program.worlds[world];
    let names: Vec<&str> = table.slots.iter().map(|slot| slot.name.as_str()).collect();
    match &args.instance {
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
fn asked(args: &WhyArgs, loaded: &Loaded, world: WorldId, slot: SlotId) -> Result<Option<Asked>, NoQuestion> {
    let id = loaded.program.worlds[world].slots[slot].entity;
    let entity = &loaded.program.entities[id];
    if let Some(name) = &args.mode {
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
    if let Some(line) = &args.edge {
        return edges_on(loaded, id, line).map(|edges| Some(Asked { mode: None, edges }));
    }
    if args.not {
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
    let is_there = |at: &crate::why::Place| {
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

/// The modes whose edges are asked about, for an answer about a step in which none of them was active.
fn starts(loaded: &Loaded, world: WorldId, slot: SlotId, asked: &Asked) -> Vec<String> {
    let entity = &loaded.program.entities[loaded.program.worlds[world].slots[slot].entity];
    let mut from: Vec<String> =
        asked.edges.iter().map(|edge| entity.modes[entity.edges[*edge].source].path.clone()).collect();
    from.dedup();
    from
}
