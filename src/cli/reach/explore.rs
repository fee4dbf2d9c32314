//! `hypedc reach --explore`: a search without a question, and what it covered: rooms, tiles that players stood on, cells,
//! modes, edges. What was not found may still be there: the report never says that something cannot be reached.

use std::fs::write;
use std::io::{self, Write};

use serde::Serialize;

use crate::corpus;
use crate::ir::{EdgeId, Entity, World, WorldId};
use crate::json::{self, Layout};
use crate::reach::query::{Counterexample, Session};
use crate::reach::{CoveredSpace, End, Explored, Explorer, Outcome, Top, Visited};
use crate::view::{Node, Picture, Run, picture_svg};

use super::question::{recorded_settings, refusal};
use super::text::{Detail, counted};
use crate::cli::Exit;
use crate::cli::args::{ReachArgs, ResultFormat};
use crate::cli::pictures::images;
use crate::cli::report::{Loaded, plain_error, program_sha256, show_fact};
use crate::cli::watches::CommandWatch;

/// The version of the JSON result.
const RESULT_VERSION: u32 = 1;
/// Maximum number of things that a line of the report lists.
const MAX_LISTED: usize = 12;

/// What a search covered.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Exploration {
    /// The version of this format.
    version: u32,
    /// The path of the program.
    file: String,
    /// A hash of what the compiled program means.
    program_sha256: String,
    /// The world.
    world: String,
    /// How it was searched.
    #[serde(flatten)]
    settings: corpus::Settings,
    /// Nodes of all trees.
    nodes: u64,
    /// What ended the search.
    end: End,
    /// The duration of the search, s.
    seconds: f64,
    /// The spaces.
    spaces: Vec<SpaceResult>,
    /// The modes of all entities that the world has instances of.
    modes: Vec<ModeResult>,
    /// Their edges.
    edges: Vec<EdgeResult>,
    /// A way to break each `never` that was met.
    violations: Vec<Counterexample>,
}

/// What was covered of a space.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct SpaceResult {
    /// Its name.
    name: String,
    /// Whether a player was in it.
    entered: bool,
    /// Upper sides of tiles and of free-standing geometry on which players can stand.
    tops: usize,
    /// Those on which a player stood.
    tops_stood_on: usize,
    /// The others, side by side ones together.
    never_stood_on: Vec<TopResult>,
    /// Cells of the map that are open to players.
    cells: usize,
    /// Those that a player was in.
    cells_entered: usize,
}

/// Upper sides at one height, side by side.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub(super) struct TopResult {
    /// The left end, px.
    pub left: f64,
    /// The right end, px.
    pub right: f64,
    /// The height, px.
    pub y: f64,
}

/// A mode.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct ModeResult {
    /// The entity.
    entity: String,
    /// Its path.
    mode: String,
    /// Whether an instance was in it.
    entered: bool,
}

/// An edge.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct EdgeResult {
    /// The entity.
    entity: String,
    /// The mode whose edge it is.
    from: String,
    /// The target; null if it stays.
    to: Option<String>,
    /// The file and the line in it, from 1.
    place: String,
    /// Whether an instance took it.
    taken: bool,
}

/// The schema of the result.
#[cfg(feature = "testing")]
pub(in crate::cli) fn json_schema() -> schemars::Schema {
    schemars::schema_for!(Exploration)
}

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
    let result = result(args, (loaded, world), session, (&outcome, &explorer.explored()), watch.seconds());
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

fn result(
    args: &ReachArgs,
    (loaded, world): (&Loaded, WorldId),
    session: &Session,
    (outcome, explored): (&Outcome, &Explored),
    seconds: f64,
) -> Exploration {
    let (program, table): (_, &World) = (&loaded.program, &loaded.program.worlds[world]);
    let (mut modes, mut edges) = (Vec::new(), Vec::new());
    for covered in &explored.entities {
        let entity: &Entity = &program.entities[covered.entity];
        for mode in entity.modes.iter() {
            let entered = entity.leaves.ids().any(|leaf| mode.leaves.contains(leaf) && covered.has(leaf));
            modes.push(ModeResult { entity: entity.name.to_string(), mode: mode.path.clone(), entered });
        }
        for (id, edge) in entity.edges.pairs() {
            edges.push(EdgeResult {
                entity: entity.name.to_string(),
                from: entity.modes[edge.source].path.clone(),
                to: edge.target.map(|mode| entity.modes[mode].path.clone()),
                place: place(loaded, covered.entity, id),
                taken: covered.took(id),
            });
        }
    }
    let never = |covered: &CoveredSpace| runs(covered.tops.iter().filter(|top| !top.is_covered));
    let spaces = explored.spaces.iter().zip(table.spaces.iter()).map(|(covered, space)| {
        let ((tops, tops_stood_on), (cells, cells_entered)) = (covered.stood(), covered.cells());
        SpaceResult {
            name: space.name.clone(),
            entered: covered.is_entered,
            tops,
            tops_stood_on,
            never_stood_on: never(covered),
            cells,
            cells_entered,
        }
    });
    let violations = outcome.violations.iter().map(|(never, script)| Counterexample {
        never: table.nevers[*never].name.clone(),
        steps: script.len(),
        inputs: script.text(program, world),
        luck: None,
    });
    Exploration {
        version: RESULT_VERSION,
        file: args.file.display().to_string(),
        program_sha256: program_sha256(program),
        world: table.name.clone(),
        settings: recorded_settings(args, &session.query().settings),
        nodes: outcome.statistics.nodes,
        end: outcome.end,
        seconds,
        spaces: spaces.collect(),
        modes,
        edges,
        violations: violations.collect(),
    }
}

/// `FILE:LINE` of an edge.
fn place(loaded: &Loaded, entity: crate::ir::EntityId, edge: EdgeId) -> String {
    let span = loaded.program.spans.entities[entity].edges[edge];
    if !loaded.sources.holds(span) {
        return String::new();
    }
    let file = loaded.sources.file(span.file());
    format!("{}:{}", file.path.display(), file.line_column_utf16(span.start() as usize).0)
}

/// Tops that are side by side at one height, as one.
pub(super) fn runs<'t>(tops: impl Iterator<Item = &'t Top>) -> Vec<TopResult> {
    let mut runs: Vec<TopResult> = Vec::new();
    for &Top { from: left, to: right, y, .. } in tops {
        match runs.last_mut().filter(|run| run.y == y && run.right == left) {
            Some(run) => run.right = right,
            None => runs.push(TopResult { left, right, y }),
        }
    }
    runs
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
