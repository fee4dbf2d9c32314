//! The result of `hypedc reach --skill` as a record, from which JSON, text and picture are made.

use std::collections::BTreeSet;
use std::time::Duration;

use serde::Serialize;

use crate::ask::{TopResult, joined_tops};
use crate::corpus;
use crate::ir::{SpaceId, World, WorldId};
use crate::reach::query::layers::{Cell, Layer, LayerAnswer, STEP, Skill};
use crate::reach::query::{Kind, Query};
use crate::reach::{Conclusion, End, Explored, Luck, PLACE, Top};

use super::super::question::recorded_settings;
use crate::cli::args::ReachArgs;
use crate::cli::report::{Loaded, program_sha256};

/// The version of the JSON result.
const RESULT_VERSION: u32 = 1;

/// Who gets where.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub(super) struct SkillResult {
    /// The version of this format.
    pub version: u32,
    /// The path of the program.
    pub file: String,
    /// A hash of what the compiled program means.
    pub program_sha256: String,
    /// The world.
    pub world: String,
    /// How each layer was searched.
    #[serde(flatten)]
    pub settings: corpus::Settings,
    /// The duration of all searches, s.
    pub seconds: f64,
    /// Whether it was interrupted; then layers are missing, and the last one is not whole.
    pub stopped: bool,
    /// How a search has shown that the analysis is wrong about the world, a mistake of `hypedc`; null if none has.
    pub refuted: Option<String>,
    /// Upper sides of tiles and of free-standing geometry on which players can stand.
    pub tops: u64,
    /// The side of a place, px.
    pub place: f64,
    /// The layers, from the fewest inputs to all.
    pub layers: Vec<LayerResult>,
    /// The tops on which nobody stood.
    pub nobody: Vec<TopsResult>,
}

/// What players with some inputs do.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub(super) struct LayerResult {
    /// `holds of 20 steps`
    pub name: String,
    /// The minimum number of steps of an input; null for other layers.
    pub hold: Option<u16>,
    /// The predicate that never holds; null for other layers.
    pub without: Option<String>,
    /// What ended the search that went wherever it could.
    pub end: End,
    /// Its nodes.
    pub nodes: u64,
    /// Number of places that a player was in, those of layers with fewer inputs among them.
    pub places: u64,
    /// Number of those in which nobody was in the layers before.
    pub new_places_count: u64,
    /// Those, side by side ones together.
    pub new_places: Vec<PlacesResult>,
    /// Number of tops on which a player stood.
    pub tops_stood_on: u64,
    /// Those on which nobody stood in the layers before.
    pub new_tops: Vec<TopsResult>,
    /// Their number.
    pub new_tops_count: u64,
    /// The spaces that a player was in and nobody in the layers before.
    pub new_rooms: Vec<String>,
    /// The answer to each question.
    pub answers: Vec<AnswerResult>,
}

/// The answer to a question.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub(super) struct AnswerResult {
    /// What kind of thing is asked for.
    pub kind: Kind,
    /// Its name.
    pub goal: String,
    /// The verdict.
    pub verdict: Conclusion,
    /// Whether the author wants this verdict.
    pub is_expected: bool,
    /// The layer of which it is the answer: a way of players with fewer inputs, or a proof about those with more.
    pub of: String,
    /// The number of steps of the path; null if there is none.
    pub steps: Option<u64>,
    /// Its duration, s.
    pub seconds_of_play: Option<f64>,
    /// The path, as an input script.
    pub inputs: Option<String>,
    /// The luck that it needs; left out in a world without chances.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub luck: Option<Luck>,
}

/// Places of a space, side by side.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub(super) struct PlacesResult {
    /// The space.
    pub space: String,
    /// The left end, px.
    pub left: f64,
    /// The right end, px.
    pub right: f64,
    /// The lower end, px.
    pub bottom: f64,
}

/// Upper sides of a space at one height, side by side.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub(super) struct TopsResult {
    /// The space.
    pub space: String,
    /// Where they are.
    #[serde(flatten)]
    pub tops: TopResult,
}

/// The schema of the result.
#[cfg(feature = "testing")]
pub(in crate::cli) fn json_schema() -> schemars::Schema {
    schemars::schema_for!(SkillResult)
}

/// The place of a cell.
fn place((space, column, row): Cell) -> Cell {
    let side = (PLACE / STEP) as i32;
    (space, column.div_euclid(side), row.div_euclid(side))
}

/// Places that are side by side, as one.
fn place_runs<'c>(world: &World, places: impl Iterator<Item = &'c Cell>) -> Vec<PlacesResult> {
    let mut places: Vec<Cell> = places.copied().collect();
    places.sort_unstable_by_key(|&(space, column, row)| (space, row, column));
    let runs = places.chunk_by(|a, b| (a.0, a.2) == (b.0, b.2) && a.1 + 1 == b.1);
    let record = |run: &[Cell]| {
        let ((space, from, row), (_, to, _)) = (*run.first()?, *run.last()?);
        let [left, right, bottom] = [from, to + 1, row].map(|at| f64::from(at) * PLACE);
        Some(PlacesResult { space: world.spaces[space].name.clone(), left, right, bottom })
    };
    runs.filter_map(record).collect()
}

/// Tops of all spaces of which something is so.
fn tops(world: &World, explored: &Explored, is: impl Fn(SpaceId, usize, &Top) -> bool) -> (Vec<TopsResult>, u64) {
    let (mut all, mut count) = (Vec::new(), 0);
    for ((id, space), covered) in world.spaces.pairs().zip(&explored.spaces) {
        let found = covered.tops.iter().enumerate().filter(|(index, top)| is(id, *index, top)).map(|(_, top)| top);
        let found: Vec<&Top> = found.collect();
        count += found.len() as u64;
        all.extend(
            joined_tops(found.into_iter()).into_iter().map(|tops| TopsResult { space: space.name.clone(), tops }),
        );
    }
    (all, count)
}

impl SkillResult {
    /// Of layers with their names.
    pub fn new(
        args: &ReachArgs,
        (loaded, world, query): (&Loaded, WorldId, &Query),
        (layers, names): (&[Layer], &[&str]),
        (elapsed, stopped, refuted): (Duration, bool, Option<String>),
    ) -> Self {
        let table = &loaded.program.worlds[world];
        let name = |index: usize| names.get(index).map_or(String::new(), ToString::to_string);
        let mut before: Option<(Explored, BTreeSet<Cell>)> = None;
        let mut results = Vec::new();
        for (index, layer) in layers.iter().enumerate() {
            let explored = &layer.seen.explored;
            let places: BTreeSet<Cell> = layer.seen.cells.iter().map(|cell| place(*cell)).collect();
            let new = |place: &&Cell| before.as_ref().is_none_or(|(_, known)| !known.contains(*place));
            let stood = |space: SpaceId, at: usize| {
                let known = before.as_ref().and_then(|(known, _)| known.spaces.get(space.0 as usize)?.tops.get(at));
                known.is_some_and(|top| top.is_covered)
            };
            let (new_tops, new_tops_count) =
                tops(table, explored, |space, at, top| top.is_covered && !stood(space, at));
            let rooms = table.spaces.pairs().zip(&explored.spaces).filter(|((id, _), covered)| {
                let known = before.as_ref().and_then(|(known, _)| known.spaces.get(id.0 as usize));
                covered.is_entered && !known.is_some_and(|known| known.is_entered)
            });
            let answer = |LayerAnswer { answer, of }: &LayerAnswer| AnswerResult {
                kind: answer.kind,
                goal: answer.goal.clone(),
                verdict: answer.verdict,
                is_expected: answer.is_expected,
                of: name(*of),
                steps: answer.steps,
                seconds_of_play: answer.seconds_of_play,
                inputs: answer.inputs.clone(),
                luck: answer.luck,
            };
            results.push(LayerResult {
                name: name(index),
                hold: if let Skill::Hold(steps) = layer.skill { Some(steps) } else { None },
                without: match &layer.skill {
                    Skill::Without(id) => Some(table.nevers[*id].name.clone()),
                    Skill::Unpressed(_) => Some(name(index).trim_start_matches("without ").to_string()),
                    Skill::Hold(_) | Skill::Any => None,
                },
                end: layer.exploration.end,
                nodes: layer.exploration.statistics.nodes,
                places: places.len() as u64,
                new_places_count: places.iter().filter(new).count() as u64,
                new_places: place_runs(table, places.iter().filter(new)),
                tops_stood_on: explored.spaces.iter().map(|space| space.stood().1 as u64).sum(),
                new_tops,
                new_tops_count,
                new_rooms: rooms.map(|((_, space), _)| space.name.clone()).collect(),
                answers: layer.answers.iter().map(answer).collect(),
            });
            match &mut before {
                Some((known, cells)) => {
                    known.add(explored);
                    cells.extend(places);
                }
                None => before = Some((explored.clone(), places)),
            }
        }
        let known = before.map(|(known, _)| known);
        let nobody = known.as_ref().map(|known| tops(table, known, |_, _, top| !top.is_covered).0);
        SkillResult {
            version: RESULT_VERSION,
            file: args.file.display().to_string(),
            program_sha256: program_sha256(&loaded.program),
            world: table.name.clone(),
            settings: recorded_settings(args, &query.settings),
            seconds: elapsed.as_secs_f64(),
            stopped,
            refuted,
            tops: known.map_or(0, |known| known.spaces.iter().map(|space| space.tops.len() as u64).sum()),
            place: PLACE,
            layers: results,
            nobody: nobody.unwrap_or_default(),
        }
    }

    /// Whether those with all inputs get what the author wants.
    pub fn is_yes(&self) -> bool {
        let all = self.layers.last().is_some_and(|layer| layer.answers.iter().all(|answer| answer.is_expected));
        all && !self.stopped && self.refuted.is_none()
    }
}
