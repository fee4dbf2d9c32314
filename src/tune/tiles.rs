//! The fewest tiles to add or remove so that a goal is reached, or is not any more.
//!
//! So that it is reached, single tiles are tried in the order in which they lie between what a search covers and the goal;
//! then pairs that begin with the most promising ones, and so on. So that it is not reached, a set of tiles has to stop
//! every way that is known: only tiles beside such a way can, and each new way gives the next tile.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use crate::analysis::watched_space;
use crate::ir::{Bounds, Extremes, Origin, Program, Push, SlotId, SpaceId, TagId, TagSet, TileKind, VarId, World};
use crate::reach::query::{Query, Session};
use crate::reach::{Conclusion, Limits, Luck, Problem, Settings, Verdict, Visited, distance_to_goal, search};
use crate::sim::{Script, Simulator};
use crate::watch::Watch;

use super::{Built, Wanted};

/// Number of nodes of the search for one set of tiles.
const QUICK_NODES: u64 = 3_000;
/// Number of nodes of the search that shows what is covered.
const COVER_NODES: u64 = 6_000;
/// Maximum number of single tiles that are tried.
const MAX_SINGLES: usize = 400;
/// Number of sets of tiles to which another one is added, and of tiles that are added to each.
const BEAM: usize = 8;
const NEXT: usize = 40;
/// Maximum number of single tiles of which each is proven not to be enough.
const MAX_PROVEN: usize = 400;
/// Maximum number of tiles beside a way, and of sets of tiles that are judged.
const MAX_BESIDE: usize = 80;
const MAX_JUDGED: usize = 150;
/// How far from a body a tile can be that it touches, px.
const NEAR: f64 = 2.0;

/// A tile that becomes another one.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct TileEdit {
    /// The space.
    pub space: String,
    /// The column, from the left, the first is 1.
    pub column: usize,
    /// The row, from the top, the first is 1.
    pub row: usize,
    /// The character as it is.
    pub from: char,
    /// The character that it becomes.
    pub to: char,
}

/// What the search for tiles needs from outside.
pub trait LevelHost {
    /// The program with some tiles changed.
    ///
    /// What is wrong with it.
    fn build(&self, edits: &[TileEdit]) -> Result<Built, String>;

    /// Runs work under a watch.
    fn watched(&self, what: &str, work: &mut dyn FnMut(&dyn Watch));

    /// Whether all work should end.
    fn is_stopped(&self) -> bool;
}

/// What may be done to tiles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TileChange {
    /// An empty tile becomes a solid one.
    Add,
    /// A solid tile becomes an empty one.
    Remove,
    /// Either.
    Change,
}

/// What is asked.
#[derive(Debug, Clone)]
pub struct TileQuestion {
    /// The goal, and how levels are judged; the first target is the goal.
    pub query: Query,
    /// The wanted answer.
    pub wanted: Wanted,
    /// The tiles that may be changed.
    pub edits: Vec<TileEdit>,
    /// Maximum number of tiles.
    pub most: usize,
}

/// What came of a level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct LevelTrial {
    /// The verdict about the goal.
    pub verdict: Conclusion,
    /// The number of steps of the path; null if there is none.
    pub steps: Option<u64>,
    /// The duration of the path in the world, s; null if there is none.
    pub seconds_of_play: Option<f64>,
    /// The path, as an input script that was replayed in this level; null if there is none.
    pub inputs: Option<String>,
    /// The luck that the path needs; left out in a world without chances.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub luck: Option<Luck>,
    /// Why there is no way, a sentence each.
    pub reasons: Vec<String>,
}

/// Tiles that turn the answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct TileSet {
    /// The tiles.
    pub edits: Vec<TileEdit>,
    /// What came of the level with them.
    pub trial: LevelTrial,
    /// Whether it is certain that fewer of the allowed tiles do not turn the answer.
    pub is_fewest: bool,
}

/// What is known of a question about tiles.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TilesFound {
    /// What came of the level as it is.
    pub base: Option<LevelTrial>,
    /// The fewest tiles that were found; none if there are none, or if none are needed.
    pub set: Option<TileSet>,
    /// The number of sets of tiles that were tried.
    pub tried: u64,
    /// Where the goal should not be reached: the first set of tiles with which it was not found, without a proof.
    pub not_found: Option<Vec<TileEdit>>,
    /// Whether it was stopped before its end.
    pub is_stopped: bool,
}

/// The fewest tiles that turn the answer, as far as they are found.
pub fn tune_tiles(host: &dyn LevelHost, question: &TileQuestion) -> Result<TilesFound, String> {
    let mut tiles = Tiles { host, question, found: TilesFound::default(), ways: Vec::new(), judged: 0 };
    let base = tiles.judge(&[])?;
    let is_wanted = tiles.is_wanted(&base);
    let verdict = base.verdict;
    tiles.found.base = Some(base);
    if is_wanted || tiles.stops() {
        return Ok(tiles.found);
    }
    match question.wanted {
        Wanted::Reached => tiles.open(verdict),
        Wanted::Prevented if verdict == Conclusion::Reached => tiles.close(),
        // There is no way that could be stopped.
        Wanted::Prevented => {}
    }
    Ok(tiles.found)
}

struct Tiles<'h> {
    host: &'h dyn LevelHost,
    question: &'h TileQuestion,
    found: TilesFound,
    /// The ways to the goal that are known, in whatever level.
    ways: Vec<Script>,
    judged: usize,
}

/// What a short search says of a level.
struct Quick {
    way: Option<(Script, String, Option<Luck>)>,
    /// How near it comes to the goal, px, and how much it covers.
    score: (f64, u64),
    places: Vec<Visited>,
}

impl Tiles<'_> {
    fn stops(&mut self) -> bool {
        self.found.is_stopped |= self.host.is_stopped();
        self.found.is_stopped
    }

    fn is_wanted(&self, trial: &LevelTrial) -> bool {
        match self.question.wanted {
            Wanted::Reached => trial.verdict == Conclusion::Reached,
            Wanted::Prevented => trial.verdict == Conclusion::ProvenUnreachable,
        }
    }

    /// Judges a level as `hypedc reach` does.
    fn judge(&mut self, edits: &[TileEdit]) -> Result<LevelTrial, String> {
        let built = self.host.build(edits)?;
        let target = *self.question.query.targets.first().ok_or("no goal")?;
        let (query, mut out) = (self.question.query.clone(), Err("stopped".to_string()));
        let mut way = None;
        self.host.watched(&label(edits), &mut |watch| {
            let session = Session::new(&built.program, built.world, query.clone(), watch);
            out = match session.find(target, watch) {
                Ok(mut found) => {
                    let answer = session.answer(&mut found, &built.sources);
                    if let Verdict::Reached(plan) = &found.outcome.verdict {
                        way = Some(plan.script.clone());
                    }
                    Ok(LevelTrial {
                        verdict: answer.verdict,
                        steps: answer.steps,
                        seconds_of_play: answer.seconds_of_play,
                        inputs: answer.inputs,
                        luck: answer.luck,
                        reasons: answer.reasons,
                    })
                }
                Err(_) => Err("the run cannot begin".to_string()),
            };
        });
        self.ways.extend(way);
        out
    }

    /// A short search in a level.
    fn quick(&mut self, edits: &[TileEdit], nodes: u64) -> Option<Quick> {
        let built = self.host.build(edits).ok()?;
        self.found.tried += 1;
        let (question, mut out) = (self.question, None);
        self.host.watched(&label(edits), &mut |watch| out = quick(question, &built, nodes, watch));
        out.filter(|_| !self.host.is_stopped())
    }

    /// Tiles with which the goal is reached.
    fn open(&mut self, base: Conclusion) {
        let Some(first) = self.quick(&[], COVER_NODES) else { return };
        let Ok(plain) = self.host.build(&[]) else { return };
        // The most promising sets, with what their searches covered.
        let mut beam: Vec<(Vec<TileEdit>, Vec<Visited>)> = vec![(Vec::new(), first.places)];
        for count in 1..=self.question.most {
            let mut next: Vec<(Vec<TileEdit>, Quick)> = Vec::new();
            let most = if count == 1 { MAX_SINGLES } else { NEXT };
            let mut tried: BTreeSet<Vec<TileEdit>> = BTreeSet::new();
            for (edits, places) in std::mem::take(&mut beam) {
                for edit in self.by_promise(&plain, &places).into_iter().filter(|edit| !edits.contains(edit)).take(most)
                {
                    let mut set = edits.clone();
                    set.push(edit);
                    set.sort();
                    if self.stops() {
                        return;
                    }
                    if !tried.insert(set.clone()) {
                        continue;
                    }
                    let Some(quick) = self.quick(&set, QUICK_NODES) else { continue };
                    if quick.way.is_some() {
                        self.accept(set, quick, base);
                        return;
                    }
                    next.push((set, quick));
                }
            }
            next.sort_by(|(_, a), (_, b)| a.score.0.total_cmp(&b.score.0).then(b.score.1.cmp(&a.score.1)));
            beam = next.into_iter().take(BEAM).map(|(set, quick)| (set, quick.places)).collect();
        }
    }

    /// Keeps tiles with which the goal is reached.
    fn accept(&mut self, edits: Vec<TileEdit>, quick: Quick, base: Conclusion) {
        let Some((way, inputs, luck)) = quick.way else { return };
        let Ok(built) = self.host.build(&edits) else { return };
        let steps = way.len();
        let is_fewest = base == Conclusion::ProvenUnreachable
            && match edits.len() {
                1 => true,
                2 => self.question.edits.len() <= MAX_PROVEN && self.no_single_is_enough(),
                _ => false,
            };
        let trial = LevelTrial {
            verdict: Conclusion::Reached,
            steps: Some(steps),
            seconds_of_play: Some(steps as f64 * built.program.worlds[built.world].step.seconds()),
            inputs: Some(inputs),
            luck,
            reasons: Vec::new(),
        };
        self.found.set = Some(TileSet { edits, trial, is_fewest });
    }

    /// Whether of each single tile it is proven that it is not enough.
    fn no_single_is_enough(&mut self) -> bool {
        let question = self.question;
        question.edits.iter().all(|edit| {
            let judged = self.judge(std::slice::from_ref(edit));
            !self.stops() && judged.is_ok_and(|trial| trial.verdict == Conclusion::ProvenUnreachable)
        })
    }

    /// The allowed tiles, first those that lie between what was covered and the goal.
    fn by_promise(&self, built: &Built, places: &[Visited]) -> Vec<TileEdit> {
        let sim = Simulator::new(&built.program, built.world);
        let world = sim.world();
        let Some(&target) = self.question.query.targets.first() else { return Vec::new() };
        let problem = Problem::asking(&sim, target);
        let mut order: Vec<(f64, &TileEdit)> = Vec::new();
        for edit in &self.question.edits {
            let Some((space, tile)) = place(world, edit) else { continue };
            let middle = [((tile.left + tile.right) / 2.0) as f32, ((tile.bottom + tile.top) / 2.0) as f32];
            let there = places.iter().filter(|place| place.space == space);
            let far = there.map(|place| {
                let [x, y] = [0, 1].map(|axis| f64::from(place.at[axis] - middle[axis]));
                x.hypot(y)
            });
            let far = far.fold(f64::INFINITY, f64::least);
            let left = distance_to_goal(&problem, &[Visited { parent: 0, space, at: middle }]).unwrap_or(0.0);
            if far.is_finite() {
                order.push((far + left, edit));
            }
        }
        order.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        order.into_iter().map(|(_, edit)| edit.clone()).collect()
    }

    /// Tiles with which the goal is not reached any more.
    fn close(&mut self) {
        for count in 1..=self.question.most {
            let set = self.stopped_by(&mut Vec::new(), count);
            if let Some((edits, trial)) = set {
                // One is the fewest, as the goal is reached without any.
                let is_fewest = match edits.len() {
                    1 => true,
                    2 => self.every_single_leaves_a_way(),
                    _ => false,
                };
                self.found.set = Some(TileSet { edits, trial, is_fewest });
                return;
            }
            if self.found.is_stopped || self.judged >= MAX_JUDGED {
                return;
            }
        }
    }

    /// Some tiles with up to `more` others, with which the goal is proven unreachable.
    fn stopped_by(&mut self, edits: &mut Vec<TileEdit>, more: usize) -> Option<(Vec<TileEdit>, LevelTrial)> {
        if self.stops() || self.judged >= MAX_JUDGED {
            return None;
        }
        let built = self.host.build(edits).ok()?;
        self.found.tried += 1;
        let way = match self.known_way(&built) {
            Some(way) => way,
            None => {
                self.judged += 1;
                let before = self.ways.len();
                let trial = self.judge(edits).ok()?;
                match trial.verdict {
                    Conclusion::ProvenUnreachable => return Some((edits.clone(), trial)),
                    Conclusion::Reached => self.ways.get(before)?.clone(),
                    _ => {
                        self.found.not_found.get_or_insert_with(|| edits.clone());
                        return None;
                    }
                }
            }
        };
        if more == 0 {
            return None;
        }
        for edit in self.beside(&built, &way) {
            // Only in one order.
            if edits.contains(&edit) {
                continue;
            }
            edits.push(edit);
            let found = self.stopped_by(edits, more - 1);
            edits.pop();
            if found.is_some() {
                return found;
            }
        }
        None
    }

    /// The beginning of a known way that leads to the goal in a level.
    fn known_way(&self, built: &Built) -> Option<Script> {
        let sim = Simulator::new(&built.program, built.world);
        let query = &self.question.query;
        let mut found = None;
        self.host.watched("", &mut |watch| {
            let target = query.targets.first().copied();
            let problem = target.and_then(|target| query.problem(&sim, target, watch).ok().flatten());
            found = problem.and_then(|problem| {
                self.ways.iter().rev().find_map(|way| query.plan_of(&problem, way, watch)).map(|plan| plan.script)
            });
        });
        found
    }

    /// The allowed tiles beside a way of the players, those at its end first.
    fn beside(&self, built: &Built, way: &Script) -> Vec<TileEdit> {
        let sim = Simulator::new(&built.program, built.world);
        let world = sim.world();
        let mut scratch = sim.scratch();
        let Ok(mut state) = sim.initial(&mut scratch) else { return Vec::new() };
        let mut bodies: Vec<(SpaceId, Bounds)> = Vec::new();
        for (step, input) in (1..).zip(way.inputs()) {
            if sim.step(&mut state, &sim.draw(0, step, input), &mut scratch).is_err() {
                break;
            }
            for player in world.players.iter() {
                let at = sim.position(&state, player.slot);
                let space = sim.space(&state, player.slot);
                bodies.extend(boxes(&built.program, world, player.slot).map(|body| (space, body.placed(at))));
            }
        }
        let mut found: Vec<(usize, &TileEdit)> = Vec::new();
        for edit in &self.question.edits {
            let Some((space, tile)) = place(world, edit) else { continue };
            let meets = |body: &Bounds| {
                body.left - NEAR < tile.right
                    && tile.left < body.right + NEAR
                    && body.bottom - NEAR < tile.top
                    && tile.bottom < body.top + NEAR
            };
            let last = bodies.iter().rposition(|(of, body)| *of == space && meets(body));
            found.extend(last.map(|last| (last, edit)));
        }
        found.sort_by(|(a, one), (b, other)| b.cmp(a).then(one.cmp(other)));
        found.into_iter().take(MAX_BESIDE).map(|(_, edit)| edit.clone()).collect()
    }

    /// Whether a way is known in the level with each single tile.
    fn every_single_leaves_a_way(&mut self) -> bool {
        let question = self.question;
        question.edits.iter().all(|edit| match self.host.build(std::slice::from_ref(edit)) {
            Ok(built) => !self.host.is_stopped() && self.known_way(&built).is_some(),
            // A level that does not compile is none.
            Err(_) => true,
        })
    }
}

/// A short search in a level, if the analysis does not rule the goal out.
fn quick(question: &TileQuestion, built: &Built, nodes: u64, watch: &dyn Watch) -> Option<Quick> {
    let query = &question.query;
    let sim = Simulator::new(&built.program, built.world);
    let problem = query.problem(&sim, *query.targets.first()?, watch).ok()??;
    let space = watched_space(&built.program, built.world, &query.rules(sim.world()), watch);
    let settings = Settings { records: true, ..query.settings };
    let limits = Limits { nodes: nodes.min(query.limits.nodes), ..query.limits };
    let outcome = search(&problem, &space, &settings, &limits, watch).ok()?;
    let way = match &outcome.verdict {
        Verdict::Reached(plan) => {
            let text = plan.script.text(&built.program, built.world);
            Some((plan.script.clone(), text, Luck::chosen(&problem, &plan.script, plan.after)))
        }
        _ => None,
    };
    let far = distance_to_goal(&problem, &outcome.record).unwrap_or(0.0);
    Some(Quick { way, score: (far, outcome.covered.all.places), places: outcome.record })
}

/// `column 8, row 5`
fn label(edits: &[TileEdit]) -> String {
    let one = |edit: &TileEdit| format!("column {}, row {}", edit.column, edit.row);
    edits.iter().map(one).collect::<Vec<_>>().join("; ")
}

/// The space and the rectangle of a tile.
fn place(world: &World, edit: &TileEdit) -> Option<(SpaceId, Bounds)> {
    let (id, space) = world.spaces.pairs().find(|(_, space)| space.name == edit.space)?;
    let map = space.map.as_ref()?;
    let row = map.rows.checked_sub(edit.row)?;
    Some((id, Bounds::new(map.rectangle(row * map.columns + edit.column.checked_sub(1)?))))
}

/// The constant boxes of the colliders of a slot, relative to its position.
fn boxes<'p>(program: &'p Program, world: &'p World, slot: SlotId) -> impl Iterator<Item = Bounds> + use<'p> {
    let slot = &world.slots[slot];
    let number = move |id| program.constant(id, &slot.params, world.step);
    let colliders = program.entities[slot.entity].colliders.iter();
    colliders.filter_map(move |collider| collider.shape.sides(number).map(Bounds::new))
}

/// The tiles of a world that may be changed: empty ones become solid, or the other way round. `symbol` is the solid tile;
/// without it, any tile that blocks players can be removed, and the most frequent one is added.
///
/// Why there are none.
pub fn tile_edits(built: &Built, change: TileChange, symbol: Option<char>) -> Result<Vec<TileEdit>, String> {
    let (program, world) = (&built.program, &built.program.worlds[built.world]);
    let tags = |kind: &TileKind<TagId>| kind.tags.iter().copied().collect::<TagSet>();
    let push = |kind: &TileKind<TagId>| world.strongest_push(program, world.player_entities(), tags(kind));
    let blocks = |kind: &TileKind<TagId>| kind.lasts() && push(kind) == Some(Push::Block);
    // No player meets it, whatever it is called.
    let is_empty = |kind: &TileKind<TagId>| kind.lasts() && push(kind).is_none();
    let mut edits = Vec::new();
    for space in world.spaces.iter() {
        let Some(map) = &space.map else { continue };
        let count = |at: usize| map.cells.iter().filter(|kind| usize::from(**kind) == at).count();
        let most = |is: &dyn Fn(&TileKind<TagId>) -> bool| {
            (0..map.kinds.len()).filter(|at| is(&map.kinds[*at])).max_by_key(|at| (count(*at), usize::MAX - at))
        };
        let Some(empty) = most(&is_empty) else { continue };
        let solid = match symbol {
            Some(symbol) => map.kinds.iter().position(|kind| kind.symbol == symbol),
            None => most(&blocks),
        };
        let Some(solid) = solid.filter(|solid| *solid != empty) else { continue };
        let taken: Vec<Bounds> = world
            .slots
            .pairs()
            .filter(|(_, slot)| slot.origin != Origin::Free && world.spaces[slot.space].name == space.name)
            .flat_map(|(id, slot)| {
                let at = VarId::XY.map(|var| slot.vars[var][0]);
                boxes(program, world, id).map(move |body| body.placed((at[0], at[1]))).collect::<Vec<_>>()
            })
            .collect();
        for (cell, kind) in map.cells.iter().enumerate() {
            let kind = usize::from(*kind);
            let tile = Bounds::new(map.rectangle(cell));
            let is_taken = taken.iter().any(|body| {
                body.left < tile.right && tile.left < body.right && body.bottom < tile.top && tile.bottom < body.top
            });
            let can_add = kind == empty && !is_taken;
            let can_remove = if symbol.is_some() { kind == solid } else { blocks(&map.kinds[kind]) };
            let to = match change {
                TileChange::Add | TileChange::Change if can_add => solid,
                TileChange::Remove | TileChange::Change if can_remove => empty,
                _ => continue,
            };
            edits.push(TileEdit {
                space: space.name.clone(),
                column: cell % map.columns + 1,
                row: map.rows - cell / map.columns,
                from: map.kinds[kind].symbol,
                to: map.kinds[to].symbol,
            });
        }
    }
    match (edits.is_empty(), symbol) {
        (false, _) => Ok(edits),
        (true, Some(symbol)) => Err(format!("no tile can be changed: is there a `{symbol}`, and an empty tile?")),
        (true, None) => Err("no tile can be changed: no map has both empty tiles and tiles that block a player".into()),
    }
}
