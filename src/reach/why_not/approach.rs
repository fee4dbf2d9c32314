//! How near an instance is to a mode, or to a value of a discrete variable: the number of edges that have to be taken, and
//! what the guard of the next one lacks.

use crate::ir::{
    Arithmetic, DiscreteId, EdgeId, Entity, Expr, ExprId, Extremes, GroupId, Id, LeafId, ModeId, Place, SlotId, Subject,
};
use crate::sim::Simulator;

use super::super::problem::Problem;
use super::lack::{Parts, Term};
use super::rooms::hops;

/// What the guard of the next edge counts as at most, in tiles: less than any distance that the goal itself asks for.
const GUARD: f64 = 1.0 / 64.0;

/// The ways of an instance to a mode or a value.
#[derive(Debug)]
pub(super) struct Approach {
    /// The instance.
    pub slot: SlotId,
    ways: Vec<Way>,
}

/// The ways through the modes of a group.
#[derive(Debug)]
struct Way {
    group: GroupId,
    /// For each leaf, the number of edges to take; `u32::MAX` if none lead there.
    left: Vec<u32>,
    /// For each leaf, the next edges on the shortest ways, each with the parts of its guard.
    next: Vec<Vec<(EdgeId, Vec<Term>)>>,
}

impl Approach {
    /// To a mode of an instance.
    pub fn to_mode(problem: &Problem<'_>, slot: SlotId, mode: ModeId) -> Approach {
        let entity = entity(problem, slot);
        let leaves = &entity.modes[mode].leaves;
        let enters = |edge: EdgeId| {
            let target = entity.edges[edge].target;
            target.is_some_and(|target| entity.enterable(target).ids().any(|leaf| leaves.contains(leaf)))
        };
        let way = Way::new(problem, slot, entity.modes[mode].group, &enters);
        Approach { slot, ways: vec![way] }
    }

    /// To a value of a discrete variable; `None` if not only edges write it.
    pub fn to_value(problem: &Problem<'_>, slot: SlotId, variable: DiscreteId, value: f64) -> Option<Approach> {
        let (program, params) = (problem.sim.program(), &problem.sim.world().slots[slot].params);
        let is_value = |id: ExprId| {
            program.constant(id, params, problem.sim.world().step).is_none_or(|constant| constant == value)
        };
        Approach::to_write(problem, slot, variable, &is_value)
    }

    /// To a change of a whole number upwards (true) or downwards; `None` if not only edges write it, and if none does.
    pub fn to_change(problem: &Problem<'_>, slot: SlotId, variable: DiscreteId, upwards: bool) -> Option<Approach> {
        let program = problem.sim.program();
        let (params, step) = (&problem.sim.world().slots[slot].params, problem.sim.world().step);
        let is_it = |id: ExprId| matches!(program.exprs[id], Expr::Discrete(Subject::Me, read) if read == variable);
        let is_other_way = |id: ExprId| {
            let by = match program.exprs[id] {
                Expr::Arithmetic(Arithmetic::Add, a, b) if is_it(a) => program.constant(b, params, step),
                Expr::Arithmetic(Arithmetic::Add, a, b) if is_it(b) => program.constant(a, params, step),
                Expr::Arithmetic(Arithmetic::Subtract, a, b) if is_it(a) => {
                    program.constant(b, params, step).map(|by| -by)
                }
                _ => None,
            };
            by.is_some_and(|by| by == 0.0 || (by > 0.0) != upwards)
        };
        let approach = Approach::to_write(problem, slot, variable, &|value| !is_other_way(value))?;
        (!approach.ways.is_empty()).then_some(approach)
    }

    /// To an update of a discrete variable that counts; `None` if not only edges write it.
    fn to_write(
        problem: &Problem<'_>,
        slot: SlotId,
        variable: DiscreteId,
        counts: &dyn Fn(ExprId) -> bool,
    ) -> Option<Approach> {
        let entity = entity(problem, slot);
        let written = |updates: &[crate::ir::Update]| -> Vec<ExprId> {
            let updates = updates.iter().filter(|update| matches!(update.place, Place::Discrete(id) if id == variable));
            updates.map(|update| update.value).collect()
        };
        let count = |lists: &mut dyn Iterator<Item = &crate::ir::Actions>| -> usize {
            lists.map(|actions| written(&actions.updates).len()).sum()
        };
        if count(&mut entity.action_lists()) > count(&mut entity.edges.iter().map(|edge| &edge.actions)) {
            return None;
        }
        let writes = |edge: EdgeId| written(&entity.edges[edge].actions.updates).into_iter().any(counts);
        let groups = entity.groups.ids();
        let ways: Vec<Way> = groups.map(|group| Way::new(problem, slot, group, &writes)).collect();
        Some(Approach { slot, ways: ways.into_iter().filter(Way::leads).collect() })
    }

    /// Moves out the parts of the guards of the last edges.
    pub fn take_last(&mut self) -> Vec<Term> {
        let mut all = Vec::new();
        for way in &mut self.ways {
            let last = way.left.iter().zip(&mut way.next).filter(|(left, _)| **left == 1);
            all.extend(last.flat_map(|(_, next)| std::mem::take(next)).flat_map(|(_, parts)| parts));
        }
        all
    }

    /// By how much less a state of a living instance counts, the nearer it is to the next edge; less than [`GUARD`].
    pub fn bonus(&self, sim: &Simulator, state: &[u8]) -> f64 {
        self.left(sim, state).map_or(0.0, |(_, cost)| GUARD / (1.0 + cost))
    }

    /// The nearest next edge in a state of a living instance, with the parts of its guard.
    pub fn nearest(&self, sim: &Simulator, state: &[u8]) -> Option<(EdgeId, &[Term])> {
        let mut least: Option<((u32, f64), EdgeId, &[Term])> = None;
        for way in &self.ways {
            let leaf = self.leaf(way, sim, state);
            let left = way.left.get(leaf).copied().unwrap_or(u32::MAX);
            for (edge, parts) in way.next.get(leaf).map_or(&[][..], Vec::as_slice) {
                let lack = lack(parts, sim, state);
                if least.as_ref().is_none_or(|(known, ..)| (left, lack) < *known) {
                    least = Some(((left, lack), *edge, parts));
                }
            }
        }
        least.map(|(_, edge, parts)| (edge, parts))
    }

    /// The number of edges to take in a state of a living instance, and what they count as; `None` if none lead there.
    pub fn left(&self, sim: &Simulator, state: &[u8]) -> Option<(u32, f64)> {
        let of = |way: &Way| {
            let leaf = self.leaf(way, sim, state);
            let left = way.left.get(leaf).copied().filter(|left| *left < u32::MAX)?;
            let lacks = way.next.get(leaf)?.iter().map(|(_, parts)| lack(parts, sim, state));
            let least = lacks.fold(f64::INFINITY, f64::least);
            let share = if least.is_finite() { least / (1.0 + least) } else { 1.0 };
            Some((left, f64::from(left) - GUARD * (1.0 - share)))
        };
        self.ways.iter().filter_map(of).min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The next edges in a state of a living instance.
    pub fn next(&self, sim: &Simulator, state: &[u8]) -> Vec<EdgeId> {
        let of = |way: &Way| {
            let leaf = self.leaf(way, sim, state);
            way.next.get(leaf).map_or(Vec::new(), |next| next.iter().map(|(edge, _)| *edge).collect())
        };
        self.ways.iter().flat_map(of).collect()
    }

    /// The index of the active leaf of a way's group.
    fn leaf(&self, way: &Way, sim: &Simulator, state: &[u8]) -> usize {
        sim.world().layout.slots[self.slot].leaf(state, way.group).index()
    }
}

/// What the parts of a guard lack together.
fn lack(parts: &[Term], sim: &Simulator, state: &[u8]) -> f64 {
    parts.iter().map(|part| part.cost(sim, state, f64::INFINITY)).sum()
}

impl Way {
    /// To what some edges of a group do.
    fn new(problem: &Problem<'_>, slot: SlotId, group: GroupId, is_last: &dyn Fn(EdgeId) -> bool) -> Way {
        let entity = entity(problem, slot);
        let edges = |at: usize| {
            let leaf = &entity.leaves[LeafId::from_index(at)];
            let of_group = entity.modes[leaf.mode].group == group;
            leaf.edges.iter().chain(&leaf.internal).copied().filter(move |_| of_group)
        };
        let ends = |at: usize| edges(at).any(is_last);
        let after = |edge: EdgeId, hops: &[u32]| -> u32 {
            let leaves = entity.edges[edge].target.into_iter().flat_map(|target| entity.enterable(target).ids());
            leaves.filter_map(|leaf| hops.get(leaf.index()).copied()).min().unwrap_or(u32::MAX)
        };
        let least = |at: usize, hops: &[u32]| edges(at).map(|edge| after(edge, hops)).min().unwrap_or(u32::MAX);
        let before = hops(entity.leaves.len(), ends, least);
        let next = |at: usize| -> Vec<(EdgeId, Vec<Term>)> {
            let leads = |edge: &EdgeId| match before[at] {
                0 => is_last(*edge),
                u32::MAX => false,
                left => after(*edge, &before) < left,
            };
            let edges = edges(at).filter(leads);
            edges.map(|edge| (edge, Parts::of_guard(problem, slot, entity.edges[edge].guard).terms)).collect()
        };
        let next = (0..entity.leaves.len()).map(next).collect();
        Way { group, left: before.iter().map(|left| left.saturating_add(1)).collect(), next }
    }

    fn leads(&self) -> bool {
        self.left.iter().any(|left| *left < u32::MAX)
    }
}

fn entity<'p>(problem: &'p Problem<'_>, slot: SlotId) -> &'p Entity {
    &problem.sim.program().entities[problem.sim.world().slots[slot].entity]
}

/// Whether an expression reads what is not part of a state: inputs, what nature draws, modes that are entered in the step.
pub(super) fn is_free(problem: &Problem<'_>, id: ExprId) -> bool {
    let program = problem.sim.program();
    let is_free = |id: &ExprId| {
        let expr = &program.exprs[*id];
        matches!(expr, Expr::Axis(_) | Expr::Chance(_) | Expr::Button(..) | Expr::Joint(..))
    };
    program.with_operands(vec![id]).iter().any(is_free)
}
