//! What runs cover of a program: modes that were entered, edges that were taken, and of each part of a guard whether it was
//! seen true and false. A part counts in each step in which its edge is tried.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use serde::Serialize;

use crate::ir::{Edge, EdgeId, Entity, EntityId, Expr, ExprId, Id, LeafId, ModeId, Program, WorldId};
use crate::sim::{Inspection, Script, Simulator};
use crate::source::{SourceMap, Span};

use super::record::Place;
use super::run::{Inputs, Step, play};
use super::step::{Guards, Moved, atom_text, atoms_of, place};

/// Counts over runs of a program, by entity.
#[derive(Debug, Clone, Default)]
pub struct Covered {
    entities: Vec<EntityCount>,
    /// Number of runs.
    pub runs: u64,
    /// Number of steps of all of them.
    pub steps: u64,
}

#[derive(Debug, Clone, Default)]
struct EntityCount {
    /// How often each mode was entered.
    modes: Vec<u64>,
    edges: Vec<EdgeCount>,
}

#[derive(Debug, Clone, Default)]
struct EdgeCount {
    tried: u64,
    taken: u64,
    /// Each part of its guard: how often it did not hold, and how often it did.
    parts: Vec<(ExprId, [u64; 2])>,
}

impl Covered {
    /// No runs of a program.
    pub fn new(program: &Program) -> Self {
        let edge = |edge: &Edge| EdgeCount {
            parts: parts(program, edge.guard).map(|part| (part, [0; 2])).collect(),
            ..EdgeCount::default()
        };
        let entity = |entity: &Arc<Entity>| EntityCount {
            modes: vec![0; entity.modes.len()],
            edges: entity.edges.iter().map(edge).collect(),
        };
        Covered { entities: program.entities.iter().map(entity).collect(), runs: 0, steps: 0 }
    }

    /// Adds a run; what nature draws comes from a seed where the script leaves it open. A run that ends before its last
    /// step counts as far as it goes.
    pub fn add_run(&mut self, sim: &Simulator, sources: &SourceMap, (script, seed): (&Script, u64), steps: u64) {
        self.runs += 1;
        let mut leaves: Vec<Vec<Option<LeafId>>> = Vec::new();
        for slot in sim.world().slots.iter() {
            leaves.push(vec![None; sim.program().entities[slot.entity].groups.len()]);
        }
        // The test that gave the run says why it ended.
        let _ = play(sim, Inputs { script, seed }, steps, &mut |_, led, state| {
            if let Some(step) = led {
                self.steps += 1;
                self.add_edges(sim, sources, step, state);
            }
            self.add_modes(sim, state, &mut leaves);
        });
    }

    fn add_modes(&mut self, sim: &Simulator, state: &[u8], leaves: &mut [Vec<Option<LeafId>>]) {
        for (slot, known) in sim.world().slots.ids().zip(leaves) {
            let instance = sim.instance(state, slot);
            let entity = instance.entity();
            let counts = &mut self.entities[sim.world().slots[slot].entity.index()].modes;
            for (group, before) in entity.groups.ids().zip(known) {
                let leaf = instance.is_alive().then(|| instance.leaf(group));
                if leaf == *before {
                    continue;
                }
                let of = |leaf: Option<LeafId>| leaf.map_or(&[][..], |leaf| &entity.leaves[leaf].path);
                for mode in of(leaf).iter().filter(|mode| !of(*before).contains(mode)) {
                    counts[mode.index()] += 1;
                }
                *before = leaf;
            }
        }
    }

    fn add_edges(&mut self, sim: &Simulator, sources: &SourceMap, (before, input, taken): Step<'_>, after: &[u8]) {
        let program = sim.program();
        let inspection = Inspection::new(sim, before, input);
        for slot in sim.world().slots.ids() {
            let instance = sim.instance(before, slot);
            if !instance.is_alive() {
                continue;
            }
            let entity = instance.entity();
            let moved = Some(Moved { sim, before, after, taken });
            let guards = Guards { program, sources, step: &inspection, slot, moved };
            let counts = &mut self.entities[sim.world().slots[slot].entity.index()].edges;
            for group in entity.groups.ids() {
                let leaf = &entity.leaves[instance.leaf(group)];
                let is_taken = |edge: EdgeId| taken.contains(&(slot, edge));
                // Of the edges that lead somewhere, those after the one that is taken are not tried.
                let tried = leaf.edges.iter().position(|edge| is_taken(*edge)).map_or(leaf.edges.len(), |at| at + 1);
                for &edge in leaf.edges.iter().take(tried).chain(&leaf.internal) {
                    let count = &mut counts[edge.index()];
                    count.tried += 1;
                    count.taken += u64::from(is_taken(edge));
                    for (part, seen) in &mut count.parts {
                        if let Some(held) = guards.truth(*part) {
                            seen[usize::from(held)] += 1;
                        }
                    }
                }
            }
        }
    }

    /// Adds the counts of other runs of the same program.
    pub fn add(&mut self, other: &Covered) {
        self.runs += other.runs;
        self.steps += other.steps;
        for (mine, other) in self.entities.iter_mut().zip(&other.entities) {
            mine.modes.iter_mut().zip(&other.modes).for_each(|(mine, other)| *mine += other);
            for (mine, other) in mine.edges.iter_mut().zip(&other.edges) {
                mine.tried += other.tried;
                mine.taken += other.taken;
                let pairs = mine.parts.iter_mut().zip(&other.parts);
                pairs.for_each(|((_, mine), (_, other))| *mine = [mine[0] + other[0], mine[1] + other[1]]);
            }
        }
    }

    /// The counts by place in the text, of the entities that some worlds have instances of.
    pub fn places(&self, program: &Program, sources: &SourceMap, worlds: &BTreeSet<WorldId>) -> PlaceCoverage {
        let slots = worlds.iter().flat_map(|world| program.worlds[*world].slots.iter());
        let entities: BTreeSet<EntityId> = slots.map(|slot| slot.entity).collect();
        let mut places = PlaceCoverage { runs: self.runs, steps: self.steps, ..PlaceCoverage::default() };
        for id in entities {
            places.add_entity(program, sources, id, &self.entities[id.index()]);
        }
        places
    }
}

/// The parts of a guard that can be true or false.
fn parts(program: &Program, guard: ExprId) -> impl Iterator<Item = ExprId> {
    atoms_of(program, guard).into_iter().filter(|part| !matches!(program.exprs[*part], Expr::Bool(_)))
}

/// A mode in the text.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct ModeCoverage {
    /// Its entity.
    pub entity: String,
    /// Its path.
    pub mode: String,
    /// Its name in the text.
    pub place: Place,
    /// How often it was entered, starts and spawns included.
    pub entered: u64,
}

/// An edge in the text.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct EdgeCoverage {
    /// Its entity.
    pub entity: String,
    /// The mode whose edge it is.
    pub from: String,
    /// The target; null if it stays.
    pub to: Option<String>,
    /// Its place in the text.
    pub place: Place,
    /// In how many steps of instances it was tried.
    pub tried: u64,
    /// How often it was taken.
    pub taken: u64,
    /// The parts of its guard; none of an `else`.
    pub parts: Vec<PartCoverage>,
}

/// A part of a guard.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct PartCoverage {
    /// The part as it is written.
    pub text: String,
    /// How often it held.
    pub held: u64,
    /// How often it did not.
    pub failed: u64,
}

/// The places that runs covered, in the order of the text. Equal places of several programs, or of several uses of a
/// behaviour, are one.
#[derive(Debug, Clone, Default)]
pub struct PlaceCoverage {
    /// Number of runs.
    pub runs: u64,
    /// Number of steps of all of them.
    pub steps: u64,
    modes: BTreeMap<PlaceKey, ModeCoverage>,
    edges: BTreeMap<PlaceKey, EdgeCoverage>,
}

type PlaceKey = (String, usize, usize, usize, usize);

fn key(place: &Place) -> PlaceKey {
    (place.path.clone(), place.line, place.column, place.end_line, place.end_column)
}

impl PlaceCoverage {
    fn add_entity(&mut self, program: &Program, sources: &SourceMap, id: EntityId, count: &EntityCount) {
        let (entity, spans) = (&program.entities[id], &program.spans.entities[id]);
        let path = |mode: ModeId| entity.modes[mode].path.clone();
        for (mode, entered) in entity.modes.ids().zip(&count.modes) {
            let Some(place) = spans.modes.get(mode).and_then(|span| original(sources, *span)) else { continue };
            // An entity without modes has one, which stands for the whole.
            let is_written = sources.slice(spans.modes[mode]) == path(mode).rsplit('.').next().unwrap_or_default();
            if is_written {
                let new = ModeCoverage { entity: entity.name.to_string(), mode: path(mode), place, entered: *entered };
                self.add_mode(new);
            }
        }
        for (edge, count) in entity.edges.ids().zip(&count.edges) {
            let Some(place) = spans.edges.get(edge).and_then(|span| original(sources, *span)) else { continue };
            let of = &entity.edges[edge];
            let is_else = sources.slice(spans.edges[edge]).starts_with("else");
            let part = |(part, [failed, held]): &(ExprId, [u64; 2])| PartCoverage {
                text: atom_text(program, sources, *part),
                held: *held,
                failed: *failed,
            };
            self.add_edge(EdgeCoverage {
                entity: entity.name.to_string(),
                from: path(of.source),
                to: of.target.map(path),
                place,
                tried: count.tried,
                taken: count.taken,
                parts: count.parts.iter().filter(|_| !is_else).map(part).collect(),
            });
        }
    }

    fn add_mode(&mut self, new: ModeCoverage) {
        let entered = new.entered;
        match self.modes.get_mut(&key(&new.place)) {
            Some(known) => known.entered += entered,
            None => drop(self.modes.insert(key(&new.place), new)),
        }
    }

    fn add_edge(&mut self, new: EdgeCoverage) {
        let Some(known) = self.edges.get_mut(&key(&new.place)) else {
            self.edges.insert(key(&new.place), new);
            return;
        };
        known.tried += new.tried;
        known.taken += new.taken;
        for (at, part) in new.parts.into_iter().enumerate() {
            match known.parts.get_mut(at) {
                Some(known) => (known.held, known.failed) = (known.held + part.held, known.failed + part.failed),
                None => known.parts.push(part),
            }
        }
    }

    /// Adds the places of other runs, possibly of another program.
    pub fn add(&mut self, other: PlaceCoverage) {
        self.runs += other.runs;
        self.steps += other.steps;
        other.modes.into_values().for_each(|mode| self.add_mode(mode));
        other.edges.into_values().for_each(|edge| self.add_edge(edge));
    }

    /// The modes.
    pub fn modes(&self) -> impl Iterator<Item = &ModeCoverage> {
        self.modes.values()
    }

    /// The edges.
    pub fn edges(&self) -> impl Iterator<Item = &EdgeCoverage> {
        self.edges.values()
    }
}

/// A span as a place of the text that was written; none of a text that is not known.
fn original(sources: &SourceMap, span: Span) -> Option<Place> {
    sources.holds(span).then(|| place(sources, sources.trace(span).0))
}
