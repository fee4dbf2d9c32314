//! `hypedc reach --explore`: a search without a question, and what it covered: rooms, tiles that players stood on, cells,
//! modes, edges. What was not found may still be there: the report never says that something cannot be reached.

use std::fs::write;
use std::io::{self, Write};

use crate::ask::{Exploration, SpaceResult};
use crate::ir::WorldId;
use crate::json::{self, Layout};
use crate::reach::query::{Counterexample, Session};
use crate::reach::{End, Explorer, Outcome, Visited};
use crate::view::{Node, Picture, Run, picture_svg};

use super::question::{recorded_settings, refusal};
use super::text::{Detail, counted};
use crate::cli::Exit;
use crate::cli::args::{ReachArgs, ResultFormat};
use crate::cli::pictures::images;
use crate::cli::report::{Loaded, plain_error, show_fact};
use crate::cli::watches::CommandWatch;

/// Maximum number of things that a line of the report lists.
const MAX_LISTED: usize = 12;

pub(super) fn run(
    args: &ReachArgs,
    loaded: &Loaded,
    world: WorldId,
    session: &Session,
    analysis_seconds: f64,
) -> io::Result<Exit> {
    let explorer = Explorer::new(session.simulator());
    let left = args.seconds.map(|seconds| seconds - analysis_seconds);
    let watch = CommandWatch::new("exploring", left);
    let outcome = session.explore(&explorer, &watch);
    watch.finish();
    let outcome = match outcome {
        Ok(outcome) => outcome,
        Err(error) => {
            refusal(args, loaded, world, &error).show(&loaded.sources)?;
            return Ok(Exit::Refused);
        }
    };
    if let Some((fault, step)) = outcome.fault {
        show_fact(&loaded.sources, fault.fact(&loaded.program, world, step))?;
    }
    let settings = recorded_settings(args, &session.query().settings);
    let covered = (&outcome, &explorer.explored());
    let result = Exploration::new((&args.file, loaded, world), settings, covered, watch.seconds());
    if let Some(path) = &args.svg {
        let drawn = images(&loaded.program, &args.file).map(|images| picture(&result, session, &outcome, &images));
        let written = drawn.and_then(|svg| write(path, svg).map_err(|error| error.to_string()));
        if let Err(why) = written {
            plain_error(&format!("cannot write `{}`: {why}", path.display()))?;
            return Ok(Exit::Refused);
        }
    }
    let mut out = io::stdout().lock();
    match args.format {
        ResultFormat::Human => write!(out, "{}", text(&result, args))?,
        ResultFormat::Json => {
            json::write(&result, Layout::Indented, &mut out)?;
            writeln!(out)?;
        }
    }
    Ok(if result.violations.is_empty() { Exit::Yes } else { Exit::No })
}

/// Some of many things, with the number of the others.
pub(super) fn listed(mut all: Vec<String>, is_whole: bool) -> String {
    let more = if is_whole { 0 } else { all.len().saturating_sub(MAX_LISTED) };
    all.truncate(all.len() - more);
    if more > 0 {
        all.push(format!("{more} more"));
    }
    all.join(", ")
}

fn text(result: &Exploration, args: &ReachArgs) -> String {
    let Exploration { spaces, modes, edges, settings, .. } = result;
    let set: String = settings.set.iter().map(|set| format!(", {set}")).collect();
    let mut out = format!("{}, world {}, seed {}{set}: explored\n", result.file, result.world, settings.seed);
    let is_whole = args.verbose;
    let mut line = |what: &str, (found, all): (usize, usize), verb: &str, missing: Vec<String>| {
        if all == 0 {
            return;
        }
        let not = if missing.is_empty() { String::new() } else { format!("; not: {}", listed(missing, is_whole)) };
        out.push_str(&format!("  {what:7} {found} of {all} {verb}{not}\n"));
    };
    let not = |space: &&SpaceResult| !space.entered;
    let missing: Vec<String> = spaces.iter().filter(not).map(|space| format!("`{}`", space.name)).collect();
    if spaces.len() > 1 {
        line("rooms", (spaces.len() - missing.len(), spaces.len()), "entered", missing);
    }
    let sum = |of: fn(&SpaceResult) -> usize| spaces.iter().map(of).sum::<usize>();
    let (tops, stood) = (sum(|space| space.tops), sum(|space| space.tops_stood_on));
    let of_room = |space: &SpaceResult| if spaces.len() > 1 { format!(" in `{}`", space.name) } else { String::new() };
    let entered = spaces.iter().filter(|space| space.entered);
    let never = entered.flat_map(|space| space.never_stood_on.iter().map(move |top| (space, top)));
    let never = never.map(|(space, top)| format!("x {} to {} at y {}{}", top.left, top.right, top.y, of_room(space)));
    let never: Vec<String> = never.collect();
    line("floors", (stood, tops), "tiles stood on", never);
    line("cells", (sum(|space| space.cells_entered), sum(|space| space.cells)), "entered", Vec::new());
    let missing: Vec<String> =
        modes.iter().filter(|mode| !mode.entered).map(|mode| format!("{}.{}", mode.entity, mode.mode)).collect();
    line("modes", (modes.len() - missing.len(), modes.len()), "entered", missing);
    let missing = edges.iter().filter(|edge| !edge.taken).map(|edge| {
        let to = edge.to.as_deref().unwrap_or("(stays)");
        format!("{}.{} -> {to} ({})", edge.entity, edge.from, edge.place)
    });
    let missing: Vec<String> = missing.collect();
    line("edges", (edges.len() - missing.len(), edges.len()), "taken", missing);
    let detail = Detail::of(args);
    for Counterexample { never, steps, inputs, .. } in &result.violations {
        out.push_str(&format!("  never {never}: can be violated, counterexample: {}\n", counted(*steps, "step")));
        if detail != Detail::Quiet {
            out.push_str(&format!("    inputs  {}\n", detail.script(inputs)));
        }
    }
    if let Some(path) = &args.svg {
        out.push_str(&format!("  drawn   {}\n", path.display()));
    }
    let budget = match result.end {
        End::Nodes => "; `--nodes N` and `--seconds S` give more",
        End::Answered => ", with nothing more to try for this planner",
        End::Memory => ", where the memory is full; `--memory MIB` gives more",
        End::Stopped => ", where it was stopped",
    };
    out.push_str(&format!(
        "  search  {} in {:.3} s ({}){budget}\n  what was not found may still be reachable: `--goal 'PREDICATE'` asks for one \
         thing\n",
        counted(result.nodes, "node"),
        result.seconds,
        settings.planner,
    ));
    out
}

fn picture(result: &Exploration, session: &Session, outcome: &Outcome, images: &crate::view::Images) -> String {
    let node = |v: &Visited| Node { parent: v.parent, space: v.space, at: v.at };
    let nodes: Vec<Node> = outcome.record.iter().map(node).collect();
    let sum = |of: fn(&SpaceResult) -> usize| result.spaces.iter().map(of).sum::<usize>();
    let (found, all) = (result.modes.iter().filter(|mode| mode.entered).count(), result.modes.len());
    let notes = [
        format!("{} of {} floor tiles stood on", sum(|s| s.tops_stood_on), sum(|s| s.tops)),
        format!("{found} of {all} modes entered"),
        format!("{} ({})", counted(result.nodes, "node"), result.settings.planner),
    ];
    let picture = Picture {
        title: "what there is",
        result: "explored",
        is_good: true,
        goals: &[],
        nodes: &nodes,
        traps: &[],
        layers: &[],
        run: &Run::default(),
        notes: &notes,
        images,
    };
    let sim = session.simulator();
    picture_svg(sim.program(), sim.world_id(), &picture)
}
