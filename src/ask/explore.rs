//! What a search without a question covered, as a record: rooms, tiles that players stood on, cells, modes, edges. What
//! was not found may still be there: it never says that something cannot be reached.

use std::path::Path;

use serde::Serialize;

use crate::corpus;
use crate::ir::{EdgeId, Entity, EntityId, World, WorldId};
use crate::reach::query::Counterexample;
use crate::reach::{CoveredSpace, End, Explored, Outcome, Top};

use super::Loaded;
use super::hash::program_sha256;

/// The version of the JSON result.
const RESULT_VERSION: u32 = 1;

/// What a search covered.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Exploration {
    /// The version of this format.
    pub version: u32,
    /// The path of the program.
    pub file: String,
    /// A hash of what the compiled program means.
    pub program_sha256: String,
    /// The world.
    pub world: String,
    /// How it was searched.
    #[serde(flatten)]
    pub settings: corpus::Settings,
    /// Nodes of all trees.
    pub nodes: u64,
    /// What ended the search.
    pub end: End,
    /// The duration of the search, s.
    pub seconds: f64,
    /// The spaces.
    pub spaces: Vec<SpaceResult>,
    /// The modes of all entities that the world has instances of.
    pub modes: Vec<ModeResult>,
    /// Their edges.
    pub edges: Vec<EdgeResult>,
    /// A way to break each `never` that was met.
    pub violations: Vec<Counterexample>,
}

/// What was covered of a space.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct SpaceResult {
    /// Its name.
    pub name: String,
    /// Whether a player was in it.
    pub entered: bool,
    /// Upper sides of tiles and of free-standing geometry on which players can stand.
    pub tops: usize,
    /// Those on which a player stood.
    pub tops_stood_on: usize,
    /// The others, side by side ones together.
    pub never_stood_on: Vec<TopResult>,
    /// Cells of the map that are open to players.
    pub cells: usize,
    /// Those that a player was in.
    pub cells_entered: usize,
}

/// Upper sides at one height, side by side.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct TopResult {
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
pub struct ModeResult {
    /// The entity.
    pub entity: String,
    /// Its path.
    pub mode: String,
    /// Whether an instance was in it.
    pub entered: bool,
}

/// An edge.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct EdgeResult {
    /// The entity.
    pub entity: String,
    /// The mode whose edge it is.
    pub from: String,
    /// The target; null if it stays.
    pub to: Option<String>,
    /// The file and the line in it, from 1.
    pub place: String,
    /// Whether an instance took it.
    pub taken: bool,
}

/// The schema of the result.
#[cfg(feature = "testing")]
pub fn exploration_schema() -> schemars::Schema {
    schemars::schema_for!(Exploration)
}

impl Exploration {
    /// What a search without a question covered, `seconds` long.
    pub fn new(
        (file, loaded, world): (&Path, &Loaded, WorldId),
        settings: corpus::Settings,
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
        let never = |covered: &CoveredSpace| joined_tops(covered.tops.iter().filter(|top| !top.is_covered));
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
            file: file.display().to_string(),
            program_sha256: program_sha256(program),
            world: table.name.clone(),
            settings,
            nodes: outcome.statistics.nodes,
            end: outcome.end,
            seconds,
            spaces: spaces.collect(),
            modes,
            edges,
            violations: violations.collect(),
        }
    }
}

/// `FILE:LINE` of an edge.
fn place(loaded: &Loaded, entity: EntityId, edge: EdgeId) -> String {
    let span = loaded.program.spans.entities[entity].edges[edge];
    if !loaded.sources.holds(span) {
        return String::new();
    }
    let file = loaded.sources.file(span.file());
    format!("{}:{}", file.path.display(), file.line_column_utf16(span.start() as usize).0)
}

/// Tops that are side by side at one height, as one.
pub fn joined_tops<'t>(tops: impl Iterator<Item = &'t Top>) -> Vec<TopResult> {
    let mut runs: Vec<TopResult> = Vec::new();
    for &Top { from: left, to: right, y, .. } in tops {
        match runs.last_mut().filter(|run| run.y == y && run.right == left) {
            Some(run) => run.right = right,
            None => runs.push(TopResult { left, right, y }),
        }
    }
    runs
}
