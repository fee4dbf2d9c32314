//! Subgoals: what has to come about before a goal can hold, such as a key in one's hands, and where a player makes it so.
//! The distance field (`distance.rs`) leads to one after the other.
//!
//! They are landmarks, facts that hold on the way to a goal, in the order in which one is needed for the next: Hoffmann,
//! Porteous and Sebastia, *Ordered Landmarks in Planning*, 2004; led by as in Richter and Westphal, *The LAMA Planner*,
//! 2010. They only guide: what is wrongly taken for one costs time, and no proof reads them.

use crate::ir::{
    CompareOp, DiscreteId, EdgeId, Entity, Expr, ExprId, Function, IdVec, LeafId, ModeId, Origin, ParamId, Place,
    SlotId, Subject, TagSet, arithmetic, call, compare,
};
use crate::sim::Simulator;

use super::goal_positions::{Finder, PositionBox};
use super::problem::Problem;

/// Maximum number of subgoals, and of facts in a row of which each needs the next.
pub(super) const MAX_SUBGOALS: usize = 6;
const MAX_DEPTH: usize = 4;

/// A fact about an instance that is there at first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fact {
    slot: SlotId,
    what: What,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum What {
    /// A comparison of a discrete variable with a number.
    Discrete(DiscreteId, CompareOp, f64),
    /// A mode is active, or it is not.
    Mode(ModeId, bool),
}

impl Fact {
    /// That a mode of an instance is active, or not.
    pub fn of_mode(slot: SlotId, mode: ModeId, is_active: bool) -> Fact {
        Fact { slot, what: What::Mode(mode, is_active) }
    }

    /// Whether it holds when the world begins.
    pub fn holds_at_first(&self, problem: &Problem<'_>) -> bool {
        let slot = &problem.sim.world().slots[self.slot];
        let entity = &problem.sim.program().entities[slot.entity];
        match self.what {
            What::Discrete(id, op, number) => {
                slot.discretes.get(id).is_some_and(|value| compare(op, f64::from(*value), number))
            }
            What::Mode(mode, is_active) => {
                let group = &entity.groups[entity.modes[mode].group];
                let mut first = entity.enterable(group.first).ids();
                group.choices.is_empty() && first.all(|leaf| entity.is_active_in(mode, leaf) == is_active)
            }
        }
    }

    /// Whether it holds in a state.
    pub fn holds(&self, sim: &Simulator, state: &[u8]) -> bool {
        let (world, program) = (sim.world(), sim.program());
        let layout = &world.layout.slots[self.slot];
        let is_there = layout.alive(state);
        match self.what {
            What::Discrete(id, op, number) => is_there && compare(op, f64::from(layout.discrete(state, id)), number),
            What::Mode(mode, is_active) => {
                let entity = &program.entities[world.slots[self.slot].entity];
                let leaf = layout.leaf(state, entity.modes[mode].group);
                (is_there && entity.is_active_in(mode, leaf)) == is_active
            }
        }
    }
}

/// What has to come about, and where.
#[derive(Debug, Clone)]
pub(super) struct Subgoal {
    /// What has to hold.
    pub fact: Fact,
    /// What it is needed for: where one of them holds, it is not needed any more.
    pub needed_for: Vec<Fact>,
    /// The positions from which a player makes it so; empty if that is not known.
    pub boxes: Vec<PositionBox>,
}

impl Subgoal {
    /// Whether the goal asks itself for a mode: the positions for that are those of the goal.
    pub fn is_last_mode(&self) -> bool {
        self.needed_for.is_empty() && matches!(self.fact.what, What::Mode(..))
    }
}

impl Finder<'_> {
    /// The subgoals of an expression, in the order in which they are to come about.
    pub(super) fn subgoals(&self, id: ExprId) -> Vec<Subgoal> {
        let mut all = Vec::new();
        self.add_subgoals(id, &[], &mut all);
        all
    }

    /// The subgoals of a fact, itself the last one.
    pub(super) fn subgoals_of(&self, fact: Fact) -> Vec<Subgoal> {
        let mut all = Vec::new();
        self.add_fact(fact, &[], &mut all);
        all
    }

    fn add_subgoals(&self, id: ExprId, needed_for: &[Fact], all: &mut Vec<Subgoal>) {
        let mut facts = Vec::new();
        self.facts(id, true, &mut facts);
        for fact in facts {
            // How players move changes all the time.
            let is_passing = fact.slot == self.player && matches!(fact.what, What::Mode(..));
            if !is_passing && !fact.holds_at_first(self.problem) {
                self.add_fact(fact, needed_for, all);
            }
        }
    }

    /// Adds a fact, after what it needs itself.
    fn add_fact(&self, fact: Fact, needed_for: &[Fact], all: &mut Vec<Subgoal>) {
        let is_known = all.iter().any(|known| known.fact == fact) || needed_for.contains(&fact);
        // With enough of them, nothing is looked for any more: each fact may need many others.
        if is_known || needed_for.len() >= MAX_DEPTH || all.len() >= MAX_SUBGOALS {
            return;
        }
        let edges = self.edges_to(fact);
        let entity = self.entity(fact.slot);
        let of_fact = Finder { owner: Some(fact.slot), ..*self };
        if let [only] = edges[..] {
            let needed_for: Vec<Fact> = needed_for.iter().copied().chain([fact]).collect();
            of_fact.add_subgoals(entity.edges[only].guard, &needed_for, all);
        }
        let boxes: Option<Vec<Vec<PositionBox>>> = edges.iter().map(|edge| of_fact.places_of_edge(*edge)).collect();
        let boxes = boxes.into_iter().flatten().flatten().collect();
        if !edges.is_empty() && all.len() < MAX_SUBGOALS {
            all.push(Subgoal { fact, needed_for: needed_for.to_vec(), boxes });
        }
    }

    /// Where a player has to be for an edge of the owner to be taken: for its guard, or else to come to its source.
    fn places_of_edge(&self, edge: EdgeId) -> Option<Vec<PositionBox>> {
        let (slot, guards) = (self.owner?, self.back?.guards);
        let entity = self.entity(slot);
        guards.set(guards.get().checked_sub(1)?);
        self.places(entity.edges[edge].guard).or_else(|| {
            let has = |leaf: &LeafId| {
                entity.leaves[*leaf].edges.contains(&edge) || entity.leaves[*leaf].internal.contains(&edge)
            };
            let leaves: Vec<LeafId> = entity.leaves.ids().filter(has).collect();
            self.leading_into(slot, &leaves)
        })
    }

    /// The edges of an instance by which a fact may come about.
    fn edges_to(&self, fact: Fact) -> Vec<EdgeId> {
        let entity = self.entity(fact.slot);
        let makes = |edge: &EdgeId| {
            let edge = &entity.edges[*edge];
            match fact.what {
                What::Discrete(id, op, number) => {
                    let entered = edge.target.into_iter().flat_map(|to| entity.enterable(to).ids());
                    let entries =
                        entered.flat_map(|leaf| &entity.leaves[leaf].path).map(|mode| &entity.modes[*mode].entry);
                    let updates = [&edge.actions].into_iter().chain(entries).flat_map(|actions| &actions.updates);
                    let mut updates = updates.filter(|update| update.place == Place::Discrete(id));
                    let may_be = |value: Option<f64>| value.is_none_or(|value| compare(op, value, number));
                    updates.any(|update| may_be(self.first_value(fact.slot, update.value)))
                }
                What::Mode(mode, is_active) => {
                    let is_in = |leaf: LeafId| entity.is_active_in(mode, leaf) == is_active;
                    let leads = edge.target.is_some_and(|to| {
                        entity.modes[to].group == entity.modes[mode].group && entity.enterable(to).ids().any(is_in)
                    });
                    leads && entity.modes[edge.source].leaves.ids().any(|leaf| !is_in(leaf))
                }
            }
        };
        entity.edges.ids().filter(makes).collect()
    }

    /// The facts about instances that have to hold for an expression to be true, or false.
    fn facts(&self, id: ExprId, is_true: bool, out: &mut Vec<Fact>) {
        match self.problem.sim.program().exprs[id] {
            Expr::Not(a) => self.facts(a, !is_true, out),
            Expr::And(a, b) | Expr::Or(a, b) => {
                let needs_both = matches!(self.problem.sim.program().exprs[id], Expr::And(..)) == is_true;
                let [a_is, b_is] = [a, b].map(|side| self.constant(side).map(|value| (value != 0.0) == is_true));
                if needs_both || b_is == Some(false) {
                    self.facts(a, is_true, out);
                }
                if needs_both || a_is == Some(false) {
                    self.facts(b, is_true, out);
                }
            }
            Expr::Call(Function::If, [condition, a, b]) => {
                if let Some(holds) = self.constant(condition) {
                    self.facts(if holds != 0.0 { a } else { b }, is_true, out);
                }
            }
            Expr::Discrete(of, id) => {
                let op = if is_true { CompareOp::Unequal } else { CompareOp::Equal };
                out.extend(self.one(of).map(|slot| Fact { slot, what: What::Discrete(id, op, 0.0) }));
            }
            Expr::Compare(op, a, b) => {
                let found = self.compared(op, a, b).or_else(|| self.compared(op.mirrored(), b, a));
                out.extend(found.map(|(slot, id, op, number)| {
                    let op = if is_true { op } else { op.negated() };
                    Fact { slot, what: What::Discrete(id, op, number) }
                }));
            }
            Expr::InMode(of, mode) => out.extend(self.one(of).map(|slot| Fact::of_mode(slot, mode, is_true))),
            _ => {}
        }
    }

    fn compared(&self, op: CompareOp, a: ExprId, b: ExprId) -> Option<(SlotId, DiscreteId, CompareOp, f64)> {
        let Expr::Discrete(of, id) = self.problem.sim.program().exprs[a] else { return None };
        Some((self.one(of)?, id, op, self.constant(b)?))
    }

    /// The instance of a subject; of one that is touched, the player, if it may be, else the only one that may.
    fn one(&self, subject: Subject) -> Option<SlotId> {
        let Subject::Touched(touch) = subject else {
            return self.slot(subject).filter(|slot| self.problem.sim.world().slots[*slot].origin != Origin::Free);
        };
        let wanted = TagSet::of(self.entity(self.owner?).touches.get(touch)?.other);
        let may_be = |slot: &SlotId| self.entity(*slot).colliders.iter().any(|collider| collider.tags.meets(wanted));
        let mut all = self.problem.sim.world().slots.ids().filter(may_be);
        let first = all.next()?;
        let is_only = all.next().is_none();
        if may_be(&self.player) { Some(self.player) } else { is_only.then_some(first) }
    }

    fn entity(&self, slot: SlotId) -> &Entity {
        &self.problem.sim.program().entities[self.problem.sim.world().slots[slot].entity]
    }

    /// The value of an expression that reads parameters of the owner alone.
    fn constant(&self, id: ExprId) -> Option<f64> {
        let (world, none) = (self.problem.sim.world(), IdVec::<ParamId, f64>::new());
        let params = self.owner.map_or(&none, |slot| &world.slots[slot].params);
        self.problem.sim.program().constant(id, params, world.step)
    }

    /// The value of an expression of an instance that reads its first discrete variables and its parameters at most.
    fn first_value(&self, slot: SlotId, id: ExprId) -> Option<f64> {
        let world = self.problem.sim.world();
        let value = |id| self.first_value(slot, id);
        match self.problem.sim.program().exprs[id] {
            Expr::Discrete(Subject::Me, id) => world.slots[slot].discretes.get(id).map(|value| f64::from(*value)),
            Expr::Not(a) => value(a).map(|a| f64::from(u8::from(a == 0.0))),
            Expr::Negate(a) => value(a).map(|a| -a),
            Expr::Arithmetic(op, a, b) => Some(arithmetic(op, value(a)?, value(b)?)),
            Expr::Call(function, [a, b, c]) => Some(call(function, [value(a)?, value(b)?, value(c)?])),
            _ => self.problem.sim.program().constant(id, &world.slots[slot].params, world.step),
        }
    }
}
