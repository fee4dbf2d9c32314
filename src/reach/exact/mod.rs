//! Exhaustion of whole levels: visits every state that inputs lead to, in few bytes each, and so proves that there is
//! no way. It begins where a search has found none.
//!
//! Instances that cannot act on those that take part in the question, except by contacts, are left out
//! (`independence.rs`). Contacts with them may then hold or not (`free.rs`), where they can be: that is found out by
//! visiting what they do by themselves, whatever touches them (`occupied.rs`). This is rely-guarantee reasoning with
//! one thread for each instance (Flanagan and Qadeer, *Thread-modular model checking*, 2003). What is left out adds
//! ways and removes none, so "no way" holds for the world as it is; a way that is found is replayed there.

mod classes;
mod conclude;
mod free;
mod generations;
mod independence;
mod occupied;
mod rests;
mod states;

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::ir::{EntityId, Expr, ExprId, SlotId, Subject, TagSet, TouchId};
use crate::sim::{Fault, Input, Placed, Simulator, State};
use crate::watch::Watch;

use super::controls::ControlSets;
use super::exchange::plan_from_script;
use super::outcome::Plan;
use super::problem::{Problem, Start, StateStatus, Target, Termination};
use super::window::Windows;
#[cfg(feature = "ask")]
pub(super) use conclude::conclude;
pub use conclude::exhaust;
use free::{FreeTouch, FreeTouches, MAX_FREE, Where};
use generations::{Choice, Ended, Limits, Question, Visit};
use independence::{Independence, Renumbered, without_others};
use occupied::Occupied;
use rests::{in_whole, rests};

/// Maximum number of states of instances that are left out, of one kind.
const MAX_OTHERS: u64 = 1 << 20;
/// Maximum number of steps that are simulated for each state of the budget.
const STEPS: u64 = 32;

/// What was visited.
#[derive(Debug, Clone, PartialEq)]
struct Exhausted {
    pub ending: Ending,
    /// Number of different states.
    pub states: u64,
    /// Number of steps within which all states were visited.
    pub within: u32,
    /// Number of instances that were left out.
    pub left_out: u32,
    /// If nothing was reached and that is to be explained: states in which the first player stands, one for each place.
    pub rests: Vec<Vec<u8>>,
}

/// How it ended.
#[derive(Debug, Clone, PartialEq)]
enum Ending {
    /// All states were visited, without the target.
    All,
    /// This way leads to the target, and none is shorter.
    Reached(Plan),
    /// A limit was reached, or something that ends a proof: a search window, a run-time error, a way that needs a
    /// contact which did not happen.
    Open,
    /// The watch stopped it.
    Stopped,
}

/// Budget of an exhaustion.
#[derive(Debug, Clone, Copy)]
struct Budget {
    pub states: u64,
    /// Bytes.
    pub memory: u64,
    pub threads: usize,
    /// Whether it is to be explained that there is no way.
    pub explains: bool,
}

/// Visits all states; `None` if the question is not of a kind for which that is possible.
fn visit_all(
    problem: &Problem<'_>,
    starts: &[Start],
    windows: &Windows,
    budget: &Budget,
    watch: &dyn Watch,
) -> Option<Exhausted> {
    let [start] = starts else { return None };
    let whole = problem.sim;
    let (program, world) = (whole.program(), whole.world());
    if problem.restriction().is_some() || world.open.is_some() || start.is_by_luck {
        return None;
    }
    let questions = questions(problem);
    let read = Independence::read_by(program, world, questions.clone());
    let roots = problem.players().iter().copied().chain(read);
    let mut independence = Independence::new(program, world, roots);
    // Where the search begins elsewhere than the world, all instances are where the start says.
    if !start.script.is_empty() || world.spaces.iter().any(crate::ir::Space::wraps) {
        independence.takes_part = world.slots.iter().map(|_| true).collect();
    }
    let left_out = independence.takes_part.iter().filter(|takes| !**takes).count() as u32;
    if left_out == 0 {
        let part = Part { sim: whole, free: FreeTouches::default(), rules: problem.rules(), left_out };
        return part.visit(problem, (start, &start.state), windows, budget, watch);
    }
    let (smaller, ids) = without_others(program, whole.world_id(), &independence.takes_part);
    let sim = Simulator::new(&Arc::new(smaller), whole.world_id());
    let free = Others { sim: whole, budget, watch, regions: BTreeMap::new(), occupied: Occupied::new(world) };
    let free = free.touches(&independence, &sim, &ids)?;
    let is_free = |slot: SlotId, touch: TouchId| {
        let slot = ids.get(slot);
        free.all.iter().any(|free| Some(free.slot) == slot && free.touch == touch)
    };
    // A predicate about others, or about contacts with them, is not known here.
    let is_known = |predicate: &ExprId| {
        let reads_free = program.with_operands(vec![*predicate]).into_iter().any(|id| match program.exprs[id] {
            Expr::Touching(Subject::Slot(slot), touch) => is_free(slot, touch),
            _ => false,
        });
        let read = Independence::read_by(program, world, vec![*predicate]);
        !reads_free && read.iter().all(|slot| independence.takes_part[*slot])
    };
    if !questions.iter().all(is_known) {
        return None;
    }
    // Rules that are not known end no run here, which only adds ways.
    let rules = problem.rules().into_iter().filter(is_known).collect();
    let mut scratch = sim.scratch();
    let mut first = sim.initial(&mut scratch).ok()?;
    free.set_possible(&sim, &mut first, &scratch);
    let part = Part { sim: &sim, free, rules, left_out };
    let mut visited = part.visit(problem, (start, &first), windows, budget, watch)?;
    let (of_whole, of_part) = (&world.layout.slots, &sim.world().layout);
    let whole = visited.rests.iter().filter_map(|state| in_whole(&start.state, of_whole, of_part, &ids, state));
    visited.rests = whole.collect();
    Some(visited)
}

/// The predicates that decide whether the target is reached: what is left out must not matter to them.
fn questions(problem: &Problem<'_>) -> Vec<ExprId> {
    let links = problem.sim.world().spaces.iter().flat_map(|space| &space.links);
    let guards = links.filter_map(|link| link.guard);
    guards.chain(problem.avoided().iter().copied()).chain([problem.predicate()]).collect()
}

/// The part of a world that is visited.
struct Part<'p> {
    sim: &'p Simulator,
    free: FreeTouches,
    /// The predicates that end a run.
    rules: Vec<ExprId>,
    left_out: u32,
}

impl Part<'_> {
    fn visit(
        &self,
        problem: &Problem<'_>,
        (start, first): (&Start, &[u8]),
        windows: &Windows,
        budget: &Budget,
        watch: &dyn Watch,
    ) -> Option<Exhausted> {
        // What nature draws is no part of an input here; and where nothing takes part, nothing happens.
        if !self.sim.draws().is_empty() || self.sim.world().layout.size == 0 {
            return None;
        }
        let part = problem.in_part(self.sim);
        let mut controls = ControlSets::complete();
        let set = controls.of(&part, first);
        if controls.truncated {
            return None;
        }
        let inputs: Vec<Input> = (0..controls.count(set)).map(|index| controls.input(set, index).clone()).collect();
        let last = start.script.steps.last().map(|step| controls.relevant(&part, &step.input));
        let held = last.and_then(|last| inputs.iter().position(|input| *input == last)).map(|index| index as u16);
        let question = Question {
            sim: self.sim,
            inputs: &inputs,
            min_hold: problem.min_hold(),
            within: problem.time().map(|most| most.saturating_sub(start.steps())),
            judge: &|state| self.judge(problem, state),
            left: &|state| windows.left(&part, state),
            free: &self.free,
        };
        let limits =
            Limits { states: budget.states, steps: budget.states.saturating_mul(STEPS), memory: budget.memory };
        let mut visit = Visit::new(question, &[(first, held)], (budget.threads, watch), None).ok()?;
        let ended = visit.run(&limits);
        // What others drew in a way is not known.
        let is_certain = problem.sim.draws().is_empty();
        let ending = match ended {
            Ended::Exhausted => Ending::All,
            Ended::Stopped => Ending::Stopped,
            Ended::Cut(_) | Ended::Fault | Ended::Full => Ending::Open,
            Ended::Goal(state, choice) => {
                let (_, mut choices) = visit.way(state);
                choices.push(choice);
                let mut script = start.script.clone();
                choices.iter().for_each(|Choice { input, .. }| script.push(&inputs[usize::from(*input)], 1));
                let plan = plan_from_script(problem, &script, start.after, watch);
                match plan.filter(|plan| is_certain && plan.steps == script.len()) {
                    Some(plan) => Ending::Reached(Plan { is_shortest: true, ..plan }),
                    None => Ending::Open,
                }
            }
        };
        let states = visit.states.len() as u64;
        let is_explained = budget.explains && matches!(ending, Ending::All | Ending::Open);
        let rests = if is_explained { rests(&visit, self.sim) } else { Vec::new() };
        Some(Exhausted { ending, states, within: visit.generations, left_out: self.left_out, rests })
    }

    /// As [`Problem::judge`], in the part.
    fn judge(&self, problem: &Problem<'_>, state: &[u8]) -> Result<StateStatus, Fault> {
        let over = |termination| Ok(StateStatus::Dead(termination));
        for &predicate in problem.avoided() {
            if self.sim.holds(state, predicate)? {
                return over(Termination::Avoided);
            }
        }
        let is_goal = matches!(problem.target, Target::Goal(_));
        if !is_goal && self.sim.holds(state, problem.predicate())? {
            return Ok(StateStatus::Goal);
        }
        for &rule in &self.rules {
            if self.sim.holds(state, rule)? {
                return over(Termination::Avoided);
            }
        }
        if self.sim.left_bounds(state).is_some() {
            return over(Termination::Outside);
        }
        Ok(match is_goal && self.sim.holds(state, problem.predicate())? {
            true => StateStatus::Goal,
            false => StateStatus::Open,
        })
    }
}

/// Instances that are left out.
struct Others<'o> {
    sim: &'o Simulator,
    budget: &'o Budget,
    watch: &'o dyn Watch,
    /// For each entity that was looked at, whether it is known where its instances can be.
    regions: BTreeMap<EntityId, bool>,
    occupied: Occupied,
}

impl Others<'_> {
    /// The contact queries of a part of the world that others may satisfy; `None` if there are too many.
    fn touches(mut self, of: &Independence<'_>, part: &Simulator, ids: &Renumbered) -> Option<FreeTouches> {
        let (world, colliders) = (self.sim.world(), part.moving_colliders());
        let mut all = Vec::new();
        for (old, slot) in world.slots.pairs() {
            let Some(me) = ids.get(old) else { continue };
            for (touch, asked, by) in of.touched_by(slot.entity, |other| !of.takes_part[other]) {
                let are_known = by.iter().all(|entity| self.is_known(of, *entity));
                let with = match (are_known, self.occupied.layer_of(asked.other)) {
                    (false, _) => Where::Anywhere,
                    (true, Some(layer)) => Where::In(layer),
                    // No such collider was ever there.
                    (true, None) => continue,
                };
                all.push(free_touch(part, &colliders, (me, touch), asked.mine, with));
            }
        }
        (all.len() <= MAX_FREE).then(|| FreeTouches { all, occupied: Some(Arc::new(self.occupied)) })
    }

    /// Finds out where the instances of an entity can be; returns whether that is known.
    fn is_known(&mut self, of: &Independence<'_>, entity: EntityId) -> bool {
        if let Some(known) = self.regions.get(&entity) {
            return *known;
        }
        let (program, world) = (self.sim.program(), self.sim.world());
        // Tiles that others break, and links that depend on others, are not as they are for an instance by itself.
        let mut links = world.spaces.iter().flat_map(|space| &space.links);
        let is_led = !program.entities[entity].follows.is_empty() && links.any(|link| link.guard.is_some());
        let is_by_itself = world.layout.tiles.is_none() && !is_led && !of.is_spawned(entity);
        let is_known = is_by_itself && self.visit(of, entity).is_some();
        self.regions.insert(entity, is_known);
        is_known
    }

    /// Visits what the instances of an entity do by themselves, whatever touches them.
    fn visit(&mut self, of: &Independence<'_>, entity: EntityId) -> Option<()> {
        let (program, world) = (self.sim.program(), self.sim.world());
        let slots = world.slots.pairs().filter(|(id, slot)| slot.entity == entity && !of.takes_part[*id]);
        // Instances with the same parameters are one kind: only their states differ.
        let mut kinds: BTreeMap<Vec<u64>, Vec<SlotId>> = BTreeMap::new();
        for (id, slot) in slots {
            let params = slot.params.iter().map(|value| value.to_bits()).collect();
            kinds.entry(params).or_default().push(id);
        }
        for slots in kinds.values() {
            let mut first: Option<(Simulator, FreeTouches, Occupied)> = None;
            let mut starts: Vec<State> = Vec::new();
            for &slot in slots {
                let alone = Independence::new(program, world, [slot].into_iter());
                if alone.takes_part.iter().filter(|takes| **takes).count() > 1 {
                    return None;
                }
                let (smaller, ids) = without_others(program, self.sim.world_id(), &alone.takes_part);
                let sim = Simulator::new(&Arc::new(smaller), self.sim.world_id());
                if !sim.draws().is_empty() {
                    return None;
                }
                let (me, mut scratch) = (ids.get(slot)?, sim.scratch());
                let mut state = sim.initial(&mut scratch).ok()?;
                if first.as_ref().is_some_and(|(known, ..)| known.world().layout != sim.world().layout) {
                    return None;
                }
                let (sim, free, occupied) = first.get_or_insert_with(|| {
                    let colliders = sim.moving_colliders();
                    let touched = alone.touched_by(entity, |other| other != slot);
                    let all = touched.into_iter().map(|(touch, asked, _)| {
                        free_touch(&sim, &colliders, (me, touch), asked.mine, Where::Anywhere)
                    });
                    let free = FreeTouches { all: all.collect(), occupied: None };
                    let occupied = self.occupied.clone().recording(&sim);
                    (sim, free, occupied)
                });
                if free.all.len() > MAX_FREE {
                    return None;
                }
                occupied.mark(&scratch);
                free.set_possible(sim, &mut state, &scratch);
                starts.push(state);
            }
            let (sim, free, occupied) = first?;
            let question = Question {
                sim: &sim,
                inputs: &[Input::default()],
                min_hold: 1,
                within: None,
                judge: &|_| Ok(StateStatus::Open),
                left: &|_| None,
                free: &free,
            };
            let starts: Vec<(&[u8], Option<u16>)> = starts.iter().map(|state| (&**state, None)).collect();
            let states = MAX_OTHERS.min(self.budget.states);
            let limits = Limits { states, steps: states.saturating_mul(STEPS), memory: self.budget.memory };
            let mut visit = Visit::new(question, &starts, (self.budget.threads, self.watch), Some(&occupied)).ok()?;
            if visit.run(&limits) != Ended::Exhausted {
                return None;
            }
            self.occupied = visit.into_occupied()?;
        }
        Some(())
    }
}

/// A contact query that may hold while one of its colliders is there.
fn free_touch(
    sim: &Simulator,
    colliders: &[Placed],
    (slot, touch): (SlotId, TouchId),
    mine: TagSet,
    with: Where,
) -> FreeTouch {
    let entity = &sim.program().entities[sim.world().slots[slot].entity];
    let is_by = |collider: &&Placed| collider.slot == slot && entity.colliders[collider.collider].tags.meets(mine);
    let by: Vec<Placed> = colliders.iter().filter(is_by).copied().collect();
    let may_move = colliders.iter().any(|collider| collider.slot == slot);
    FreeTouch { slot, touch, by: may_move.then_some(by), with }
}
