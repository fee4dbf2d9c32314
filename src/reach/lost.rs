//! What is lost for good: a number that the goal needs to be at least so large, and that only decreases, or the other way
//! round, such as fuel; a mode that the goal needs, and to which no edges lead from the one an instance is in; a place, if
//! the instance is elsewhere and stays there (`settled.rs`). Trees go on from no state in which that has happened. It is no
//! part of any proof.

use crate::analysis::ConfigurationSpace;
use crate::ir::{
    CompareOp, Entity, Expr, ExprId, GroupId, Id, IdVec, LeafId, ModeId, Origin, Place, SlotId, Subject, VarId, compare,
};
use crate::sim::Simulator;

use super::problem::Problem;
use super::settled::{Settled, asked_place, settled};
use super::why_not::hops;

/// The conditions of a goal that never hold again once they do not.
#[derive(Debug, Default)]
pub(super) struct Lost {
    conditions: Vec<(SlotId, VarId, CompareOp, f64)>,
    /// A group of an instance, and the leaves from which edges lead to what the goal needs.
    modes: Vec<(SlotId, GroupId, Vec<bool>)>,
    /// What it needs of the place of an instance, and where that never changes again.
    places: Vec<(ExprId, Settled)>,
}

impl Lost {
    /// Of the target of a question.
    pub fn new(problem: &Problem<'_>, space: &ConfigurationSpace) -> Lost {
        let program = problem.sim.program();
        let (mut open, mut conditions, mut modes) = (vec![problem.predicate()], Vec::new(), Vec::new());
        let mut places = Vec::new();
        while let Some(id) = open.pop() {
            if let Some((slot, axes)) = asked_place(problem, space, id) {
                places.extend(settled(problem, slot, axes).into_iter().map(|of| (id, of)));
            }
            match program.exprs[id] {
                Expr::And(a, b) => open.extend([a, b]),
                Expr::Compare(op, a, b) => {
                    let found = condition(problem, (op, a, b)).or_else(|| condition(problem, (op.mirrored(), b, a)));
                    conditions.extend(found.filter(|condition| only_worsens(problem, space, *condition)));
                }
                Expr::InMode(Subject::Slot(slot), mode) if problem.sim.world().slots[slot].origin == Origin::Named => {
                    let entity = &program.entities[problem.sim.world().slots[slot].entity];
                    modes.push((slot, entity.modes[mode].group, leading_to(entity, mode)));
                }
                _ => {}
            }
        }
        Lost { conditions, modes, places }
    }

    /// Whether a condition is lost in a state.
    #[inline]
    pub fn is_in(&self, sim: &Simulator, state: &[u8]) -> bool {
        let layouts = &sim.world().layout.slots;
        let is_number = |&(slot, var, op, bound): &(SlotId, VarId, CompareOp, f64)| {
            !layouts[slot].alive(state) || !compare(op, layouts[slot].var(state, var, 0), bound)
        };
        let is_mode = |(slot, group, leads): &(SlotId, GroupId, Vec<bool>)| {
            !layouts[*slot].alive(state) || !leads[layouts[*slot].leaf(state, *group).index()]
        };
        // A fault is told where the target is judged.
        let is_elsewhere = |id: ExprId| sim.holds(state, id).is_ok_and(|holds| !holds);
        let is_place = |(id, of): &(ExprId, Settled)| of.is_in(sim, state) && is_elsewhere(*id);
        self.conditions.iter().any(is_number) || self.modes.iter().any(is_mode) || self.places.iter().any(is_place)
    }
}

/// For each leaf, whether it is in a mode or edges lead from it there.
fn leading_to(entity: &Entity, mode: ModeId) -> Vec<bool> {
    let is_in = |leaf: usize| entity.is_active_in(mode, LeafId::from_index(leaf));
    let after = |leaf: usize, hops: &[u32]| {
        let targets =
            entity.leaves[LeafId::from_index(leaf)].edges.iter().filter_map(|edge| entity.edges[*edge].target);
        targets.flat_map(|to| entity.enterable(to).ids()).map(|leaf| hops[leaf.index()]).min().unwrap_or(u32::MAX)
    };
    hops(entity.leaves.len(), is_in, after).into_iter().map(|left| left < u32::MAX).collect()
}

/// A comparison of a variable of an instance that is there once with a number.
fn condition(
    problem: &Problem<'_>,
    (op, a, b): (CompareOp, ExprId, ExprId),
) -> Option<(SlotId, VarId, CompareOp, f64)> {
    let (program, world) = (problem.sim.program(), problem.sim.world());
    let Expr::Var(Subject::Slot(slot), var, 0) = program.exprs[a] else { return None };
    let bound = program.constant(b, &IdVec::new(), world.step)?;
    (world.slots[slot].origin == Origin::Named && !var.is_position()).then_some((slot, var, op, bound))
}

/// Whether the variable only moves away from what a condition asks for: no velocity leads towards it, and nothing else
/// writes it but clamps that leave the condition as it is.
fn only_worsens(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    (slot, var, op, bound): (SlotId, VarId, CompareOp, f64),
) -> bool {
    let (program, world) = (problem.sim.program(), problem.sim.world());
    let entity = &program.entities[world.slots[slot].entity];
    let is_least = match op {
        CompareOp::Greater | CompareOp::AtLeast => true,
        CompareOp::Less | CompareOp::AtMost => false,
        CompareOp::Equal | CompareOp::Unequal => return false,
    };
    let known = &space.slots[slot];
    let mut velocities = known.configurations.iter().flat_map(|c| c.vars[var][1].intervals());
    let leads_away = velocities.all(|v| if is_least { v.high <= 0.0 } else { v.low >= 0.0 });
    let mut updates = entity.action_lists().flat_map(|actions| &actions.updates);
    let is_written = updates.any(|update| matches!(update.place, Place::Var(of, _) if of == var));
    let spoils = |id: ExprId| {
        program.constant(id, &world.slots[slot].params, world.step).is_none_or(|to| compare(op, to, bound))
    };
    let mut clamps = entity.clamps.iter().filter(|clamp| clamp.var == var && clamp.degree == 0);
    let is_clamped = clamps.any(|clamp| if is_least { clamp.low } else { clamp.high }.is_some_and(spoils));
    !known.is_given_up && leads_away && !is_written && !is_clamped
}
