//! What each part of a world can be: abstract interpretation of the flat program (Cousot and Cousot, *Abstract
//! interpretation: a unified lattice model*, POPL 1977), per slot and per combination of active leaves.
//!
//! For each combination that can be active it finds what each variable and its derivatives can be: a constant, a few
//! values, or intervals. A state that a run can reach is never outside, as long as the run stops where a search does:
//! when a player leaves the bounds of its space.
//!
//! What is lost: variables are not related to each other, but for speed and height under a constant acceleration
//! (`energy.rs`); references can refer to any instance of their entity; contacts can happen wherever the tags allow them.

mod energy;
mod evaluate;
mod findings;
mod step;
mod surroundings;
mod values;

pub use evaluate::Configuration;
pub use findings::{InvariantVerdict, findings, invariants};
pub use values::{Interval, Values};

use std::collections::{BTreeMap, BTreeSet};

use crate::ir::{
    Entity, GoalId, Id, IdVec, LeafId, Origin, ParamId, Program, RefValue, SlotId, SpawnId, Subject, VarId, World,
    WorldId,
};

use energy::Fall;
use evaluate::{Overall, Reader};
use step::Stepper;
use surroundings::Surroundings;

/// More combinations of leaves than that are not told apart.
const MOST_CONFIGURATIONS: usize = 1_024;
/// After so many changes of a configuration its ends are moved to where they stay.
const PATIENCE: u32 = 16;
/// How often the result is cut to what follows from it.
const NARROWINGS: usize = 3;
/// After so many rounds the rest is given up: everything can be anything.
const MOST_ROUNDS: usize = 400;

/// What a slot can be.
#[derive(Debug, Clone)]
pub struct SlotSpace {
    /// What it can be while there is an instance, one for each combination of leaves; none if there never is one.
    pub configurations: Vec<Configuration>,
    /// Whether there can be no instance.
    pub can_be_absent: bool,
    /// Whether there was too much to tell, so that everything is possible.
    pub is_given_up: bool,
}

/// What a world can be.
#[derive(Debug, Clone)]
pub struct ConfigurationSpace {
    /// Of each slot.
    pub slots: IdVec<SlotId, SlotSpace>,
    overall: IdVec<SlotId, Overall>,
    surroundings: Surroundings,
}

/// Finds what a world can be.
pub fn configuration_space(program: &Program, world: WorldId) -> ConfigurationSpace {
    let mut analysis = Analysis::new(program, &program.worlds[world]);
    analysis.run();
    analysis.finish()
}

impl ConfigurationSpace {
    /// Whether a goal can hold in some state; if not, it is proven that it cannot be reached.
    pub fn can_hold(&self, program: &Program, world: WorldId, goal: GoalId) -> bool {
        let world = &program.worlds[world];
        self.reader(program, world, None).truth(world.goals[goal].holds).can_hold
    }

    /// What expressions are read against: those of an instance in one of its configurations, or those of the world.
    fn reader<'a>(
        &'a self,
        program: &'a Program,
        world: &'a World,
        me: Option<(SlotId, &'a Configuration)>,
    ) -> Reader<'a> {
        Reader { program, world, slots: &self.overall, surroundings: &self.surroundings, me }
    }
}

/// A configuration that is still growing.
#[derive(Debug, Clone)]
struct Growing {
    at: Configuration,
    changes: u32,
    is_new: bool,
}

#[derive(Debug, Default, Clone)]
struct Slot {
    configurations: BTreeMap<Vec<LeafId>, Growing>,
    can_be_absent: bool,
    is_given_up: bool,
    params: IdVec<ParamId, Values>,
}

struct Analysis<'a> {
    program: &'a Program,
    world: &'a World,
    slots: IdVec<SlotId, Slot>,
    overall: IdVec<SlotId, Overall>,
    /// Numbers that the program compares with or writes, in order: where growing ends may stay.
    thresholds: Vec<f64>,
}

impl<'a> Analysis<'a> {
    fn new(program: &'a Program, world: &'a World) -> Self {
        let constants = program.exprs.ids().flat_map(|id| {
            let of = |params: &IdVec<ParamId, f64>| program.constant(id, params, world.step);
            world.slots.iter().filter_map(|s| of(&s.params)).chain(of(&IdVec::new())).collect::<Vec<f64>>()
        });
        let mut thresholds: Vec<f64> = constants.flat_map(|c| [c, -c]).chain([0.0]).collect();
        thresholds.sort_by(f64::total_cmp);
        thresholds.dedup();
        let slots: IdVec<SlotId, Slot> = world
            .slots
            .iter()
            .map(|s| Slot {
                can_be_absent: s.origin == Origin::Free,
                params: s.params.iter().map(|p| Values::point(*p)).collect(),
                ..Slot::default()
            })
            .collect();
        let mut analysis = Analysis { program, world, overall: IdVec::new(), slots, thresholds };
        analysis.overall = world.slots.ids().map(|s| analysis.overall(s)).collect();
        for slot in world.slots.ids().filter(|s| world.slots[*s].origin != Origin::Free) {
            analysis.begin(slot);
        }
        analysis
    }

    fn entity(&self, slot: SlotId) -> &'a Entity {
        &self.program.entities[self.world.slots[slot].entity]
    }

    /// The first configurations of an instance that is there from the start.
    fn begin(&mut self, slot: SlotId) {
        let s = &self.world.slots[slot];
        let at = Configuration {
            leaves: Vec::new(),
            vars: s.vars.iter().map(|v| v.map(Values::point)).collect(),
            discretes: s.discretes.iter().map(|d| Values::point(f64::from(*d))).collect(),
            timers: s.timer_limits.iter().map(|_| Interval::point(0.0)).collect(),
            spaces: [s.space].into(),
            energy: s.vars.iter().map(|_| None).collect(),
        };
        self.enter(slot, at);
        self.overall[slot] = self.overall(slot);
    }

    /// Adds a configuration in all the leaves in which an instance can begin.
    fn enter(&mut self, slot: SlotId, at: Configuration) -> bool {
        let entity = self.entity(slot);
        let mut combinations: Vec<Vec<LeafId>> = vec![Vec::new()];
        for group in entity.groups.iter() {
            // Choices read parameters, which may be several: all of them are possible.
            let (first, after) = group.modes;
            let simple = group.choices.is_empty() && !entity.modes[group.first].chooses;
            let leaves: Vec<LeafId> = match simple {
                true => vec![entity.modes[group.first].initial],
                false => {
                    let leaves = entity.leaves.pairs().filter(|(_, l)| first <= l.mode && l.mode < after);
                    leaves.map(|(id, _)| id).collect()
                }
            };
            combinations = combinations
                .into_iter()
                .flat_map(|c| {
                    leaves.iter().map(move |l| c.iter().copied().chain([*l]).collect::<Vec<_>>()).collect::<Vec<_>>()
                })
                .take(MOST_CONFIGURATIONS + 1)
                .collect();
        }
        let mut changed = false;
        for leaves in combinations {
            changed |= self.grow(slot, Configuration { leaves, ..at.clone() });
        }
        changed
    }

    /// Adds what an instance can be; gives whether that is more than before.
    fn grow(&mut self, slot: SlotId, found: Configuration) -> bool {
        let thresholds = &self.thresholds;
        let known = &mut self.slots[slot];
        if known.is_given_up {
            return false;
        }
        let mut found = within_bounds(self.world, slot, found);
        found.sharpen();
        if found.is_impossible() {
            return false;
        }
        match known.configurations.get_mut(&found.leaves) {
            None => {
                known.configurations.insert(found.leaves.clone(), Growing { at: found, changes: 0, is_new: true });
                known.is_given_up |= known.configurations.len() > MOST_CONFIGURATIONS;
                true
            }
            Some(growing) => {
                let mut joined = growing.at.or(&found);
                joined.sharpen();
                if joined == growing.at {
                    return false;
                }
                growing.changes += 1;
                if growing.changes > PATIENCE {
                    joined = widened(&growing.at, &joined, thresholds, growing.changes > 2 * PATIENCE);
                }
                joined.sharpen();
                growing.at = within_bounds(self.world, slot, joined);
                growing.is_new = true;
                true
            }
        }
    }

    fn overall(&self, slot: SlotId) -> Overall {
        let known = &self.slots[slot];
        let entity = self.entity(slot);
        let all = |c: &dyn Fn(&Configuration) -> Values| {
            Values::any(known.configurations.values().flat_map(|g| c(&g.at).intervals().to_vec()))
        };
        if known.is_given_up {
            return Overall {
                can_live: true,
                can_be_absent: true,
                params: known.params.clone(),
                vars: entity.vars.iter().map(|_| [Values::all(), Values::all(), Values::all()]).collect(),
                discretes: entity.discretes.iter().map(|d| range(d.range)).collect(),
                spaces: self.world.spaces.ids().collect(),
                leaves: entity.leaves.ids().collect(),
            };
        }
        Overall {
            can_live: !known.configurations.is_empty(),
            can_be_absent: known.can_be_absent,
            params: known.params.clone(),
            vars: entity.vars.ids().map(|v| [0, 1, 2].map(|d| all(&|c| c.vars[v][d].clone()))).collect(),
            discretes: entity.discretes.ids().map(|id| all(&|c| c.discretes[id].clone())).collect(),
            spaces: known.configurations.values().flat_map(|g| g.at.spaces.iter().copied()).collect(),
            leaves: known.configurations.keys().flatten().copied().collect(),
        }
    }

    /// Steps until nothing new is found.
    fn run(&mut self) {
        let mut others_changed = true;
        for round in 0.. {
            let surroundings = Surroundings::new(self.program, self.world, &self.overall);
            let mut found: Vec<(SlotId, step::Outcome)> = Vec::new();
            for slot in self.world.slots.ids() {
                let due: Vec<Configuration> = self.slots[slot]
                    .configurations
                    .values_mut()
                    .filter(|g| g.is_new || others_changed)
                    .map(|g| {
                        g.is_new = false;
                        g.at.clone()
                    })
                    .collect();
                for at in due {
                    match self.stepper(slot, &surroundings).run(&at) {
                        Some(outcome) => found.push((slot, outcome)),
                        None => self.slots[slot].is_given_up = true,
                    }
                }
            }
            let mut changed = false;
            for (slot, outcome) in found {
                changed |= self.take(slot, outcome);
            }
            changed |= self.ends();
            let overall: IdVec<SlotId, Overall> = self.world.slots.ids().map(|s| self.overall(s)).collect();
            others_changed = overall != self.overall;
            self.overall = overall;
            if !changed && !others_changed {
                break;
            }
            if round > MOST_ROUNDS {
                for slot in self.slots.iter_mut() {
                    slot.is_given_up = true;
                }
                self.overall = self.world.slots.ids().map(|s| self.overall(s)).collect();
                break;
            }
        }
        for _ in 0..NARROWINGS {
            self.narrow();
        }
    }

    fn stepper<'s>(&'s self, slot: SlotId, surroundings: &'s Surroundings) -> Stepper<'s> {
        let reader = Reader { program: self.program, world: self.world, slots: &self.overall, surroundings, me: None };
        Stepper { reader, slot, step: self.world.step.seconds() }
    }

    fn take(&mut self, slot: SlotId, outcome: step::Outcome) -> bool {
        let mut changed = false;
        for next in outcome.next {
            changed |= self.grow(slot, next);
        }
        if outcome.can_end && !self.slots[slot].can_be_absent {
            self.slots[slot].can_be_absent = true;
            changed = true;
        }
        for (spawn, at) in outcome.spawns {
            changed |= self.spawn(slot, spawn, &at);
        }
        changed
    }

    /// What a spawn can make of each slot that it can take.
    fn spawn(&mut self, spawner: SlotId, spawn: SpawnId, at: &Configuration) -> bool {
        let spawn = &self.entity(spawner).spawns[spawn];
        let mut changed = false;
        for slot in self.world.slots.ids() {
            let s = &self.world.slots[slot];
            if s.entity != spawn.entity || s.origin == Origin::Named {
                continue;
            }
            let entity = self.entity(slot);
            let surroundings = Surroundings::new(self.program, self.world, &self.overall);
            let theirs = |id| {
                let me = Some((spawner, at));
                Reader {
                    program: self.program,
                    world: self.world,
                    slots: &self.overall,
                    surroundings: &surroundings,
                    me,
                }
                .number(id)
            };
            let mut params = IdVec::new();
            for (id, param) in entity.params.pairs() {
                let given = spawn.params.iter().find(|(p, _)| *p == id);
                let value = match given {
                    Some((_, value)) => theirs(*value),
                    // Defaults read parameters that are known by now; what is not constant can be anything.
                    None => {
                        let known: IdVec<ParamId, f64> =
                            params.iter().map(|v: &Values| v.constant().unwrap_or(f64::NAN)).collect();
                        let value = self.program.constant(param.default, &known, self.world.step);
                        value.map_or(Values::all(), Values::point)
                    }
                };
                params.push(value);
            }
            let known: IdVec<ParamId, f64> = params.iter().map(|v| v.constant().unwrap_or(f64::NAN)).collect();
            let first = |id, otherwise: Values| {
                self.program.constant(id, &known, self.world.step).map_or(otherwise, Values::point)
            };
            let zero = || Values::point(0.0);
            let mut born = Configuration {
                leaves: Vec::new(),
                vars: entity
                    .first
                    .pairs()
                    .map(|(var, value)| {
                        let position = match value {
                            Some(value) => first(*value, Values::all()),
                            None if var.index() < 2 => at.vars[VarId(var.0)][0].clone(),
                            None => zero(),
                        };
                        [position, zero(), zero()]
                    })
                    .collect(),
                discretes: entity.discretes.iter().map(|d| first(d.first, range(d.range))).collect(),
                timers: entity.timers.iter().map(|_| Interval::point(0.0)).collect(),
                spaces: at.spaces.clone(),
                energy: entity.vars.iter().map(|_| None).collect(),
            };
            for update in &spawn.updates {
                match update.place {
                    crate::ir::Place::Var(var, degree) => born.vars[var][usize::from(degree)] = theirs(update.value),
                    crate::ir::Place::Discrete(id) => born.discretes[id] = theirs(update.value),
                    crate::ir::Place::Ref(_) => {}
                }
            }
            let known = &mut self.slots[slot].params;
            for (id, value) in params.pairs() {
                let joined = known[id].or(value);
                changed |= joined != known[id];
                known[id] = joined;
            }
            changed |= self.enter(slot, born);
        }
        changed
    }

    /// Notes which instances others can destroy.
    fn ends(&mut self) -> bool {
        let mut changed = false;
        for me in self.world.slots.ids().filter(|s| self.overall[*s].can_live) {
            let entity = self.entity(me);
            let actions = entity.edges.iter().map(|e| &e.actions);
            let actions = actions.chain(entity.modes.iter().map(|m| &m.entry));
            let destroys = actions.chain(entity.follows.iter().map(|f| &f.actions)).flat_map(|a| &a.destroys);
            for what in destroys {
                let of = match what {
                    RefValue::None | RefValue::Of(Subject::Me) => continue,
                    RefValue::Of(Subject::Ref(id)) => entity.refs[*id].entity,
                    RefValue::Of(_) => None,
                };
                for slot in self.world.slots.ids() {
                    if of.is_none_or(|e| self.world.slots[slot].entity == e) && !self.slots[slot].can_be_absent {
                        self.slots[slot].can_be_absent = true;
                        changed = true;
                    }
                }
            }
        }
        changed
    }

    /// Steps once from all that was found, and keeps of it only what comes of that or is there from the start.
    fn narrow(&mut self) {
        let before = self.slots.clone();
        let surroundings = Surroundings::new(self.program, self.world, &self.overall);
        let mut found: Vec<(SlotId, step::Outcome)> = Vec::new();
        for slot in self.world.slots.ids().filter(|s| !self.slots[*s].is_given_up) {
            for growing in self.slots[slot].configurations.values() {
                if let Some(outcome) = self.stepper(slot, &surroundings).run(&growing.at) {
                    found.push((slot, outcome));
                }
            }
        }
        for slot in self.slots.iter_mut() {
            slot.configurations.clear();
        }
        for slot in self.world.slots.ids().filter(|s| self.world.slots[*s].origin != Origin::Free) {
            self.begin(slot);
        }
        for (slot, outcome) in found {
            self.take(slot, outcome);
        }
        for (slot, known) in before.pairs() {
            let narrowed = &mut self.slots[slot];
            narrowed.is_given_up = known.is_given_up;
            if known.is_given_up {
                narrowed.configurations = known.configurations.clone();
            }
            for (leaves, growing) in &mut narrowed.configurations {
                if let Some(known) = known.configurations.get(leaves) {
                    growing.at = both(&growing.at, &known.at);
                    growing.at.sharpen();
                }
                growing.changes = 0;
            }
        }
        self.overall = self.world.slots.ids().map(|s| self.overall(s)).collect();
    }

    fn finish(self) -> ConfigurationSpace {
        let slots = self.slots.iter().map(|s| SlotSpace {
            configurations: s.configurations.values().map(|g| g.at.clone()).collect(),
            can_be_absent: s.can_be_absent,
            is_given_up: s.is_given_up,
        });
        let slots = slots.collect();
        let surroundings = Surroundings::new(self.program, self.world, &self.overall);
        ConfigurationSpace { slots, overall: self.overall, surroundings }
    }
}

fn range((low, high): (i32, i32)) -> Values {
    Values::from(Interval { low: f64::from(low), high: f64::from(high) })
}

/// Without the states at which a search stops: a player below or beside the bounds of its space.
fn within_bounds(world: &World, slot: SlotId, mut at: Configuration) -> Configuration {
    if world.slots[slot].player.is_none() {
        return at;
    }
    let bounds: Option<Vec<_>> = at.spaces.iter().map(|s| world.spaces[*s].bounds).collect();
    if let Some(all) = bounds.as_deref().and_then(|b| {
        b.iter().copied().reduce(|a, b| crate::ir::Bounds {
            left: a.left.min(b.left),
            right: a.right.max(b.right),
            bottom: a.bottom.min(b.bottom),
            top: a.top.max(b.top),
        })
    }) {
        let cut = |values: &Values, low: f64, high: f64| values.within(Interval { low, high });
        at.vars[VarId(0)][0] = cut(&at.vars[VarId(0)][0], all.left, all.right);
        at.vars[VarId(1)][0] = cut(&at.vars[VarId(1)][0], all.bottom, f64::INFINITY);
    }
    at
}

/// What grows goes to the next number that the program knows, or on for ever.
fn widened(old: &Configuration, new: &Configuration, thresholds: &[f64], at_once: bool) -> Configuration {
    let interval = |old: Interval, new: Interval| {
        let low = match new.low < old.low {
            true if at_once => f64::NEG_INFINITY,
            true => thresholds.iter().rev().copied().find(|t| *t <= new.low).unwrap_or(f64::NEG_INFINITY),
            false => new.low,
        };
        let high = match new.high > old.high {
            true if at_once => f64::INFINITY,
            true => thresholds.iter().copied().find(|t| *t >= new.high).unwrap_or(f64::INFINITY),
            false => new.high,
        };
        Interval { low, high }
    };
    let values = |old: &Values, new: &Values| match (old.hull(), new.hull()) {
        (Some(a), Some(b)) if !new.is_within(old) => Values::from(interval(a, b)),
        _ => new.clone(),
    };
    type Energy = Option<(Fall, Interval)>;
    let energy = |(old, new): (&Energy, &Energy)| match (old, new) {
        // It grows by what comes in from other modes alone, so that it is left more time.
        (Some((before, old)), Some((fall, new))) if before == fall && at_once => {
            Some((*fall, wider_energy(*old, *new)))
        }
        _ => *new,
    };
    let mut out = new.clone();
    out.vars = old.vars.iter().zip(new.vars.iter()).map(|(a, b)| [0, 1, 2].map(|d| values(&a[d], &b[d]))).collect();
    out.discretes = old.discretes.iter().zip(new.discretes.iter()).map(|(a, b)| values(a, b)).collect();
    out.timers = old.timers.iter().zip(new.timers.iter()).map(|(a, b)| interval(*a, *b)).collect();
    out.energy = old.energy.iter().zip(new.energy.iter()).map(energy).collect();
    out
}

/// Energies have no numbers of the program to stay at; they grow to powers of two.
fn wider_energy(old: Interval, new: Interval) -> Interval {
    let up = |x: f64| if x.abs() > 1e12 { f64::INFINITY } else { x.abs().max(1.0).log2().ceil().exp2() };
    let low = match new.low < old.low {
        true if new.low < 0.0 => -up(new.low),
        true => 0.0,
        false => new.low,
    };
    let high = match new.high > old.high {
        true if new.high > 0.0 => up(new.high),
        true => 0.0,
        false => new.high,
    };
    Interval { low, high }
}

/// What is in both; both enclose all that can be.
fn both(a: &Configuration, b: &Configuration) -> Configuration {
    let mut out = a.clone();
    out.vars = a.vars.iter().zip(b.vars.iter()).map(|(a, b)| [0, 1, 2].map(|d| a[d].and(&b[d]))).collect();
    out.discretes = a.discretes.iter().zip(b.discretes.iter()).map(|(a, b)| a.and(b)).collect();
    out.timers = a.timers.iter().zip(b.timers.iter()).map(|(a, b)| a.and(*b).unwrap_or(*a)).collect();
    out.spaces = a.spaces.intersection(&b.spaces).copied().collect::<BTreeSet<_>>();
    out
}
