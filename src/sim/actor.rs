//! Per-slot data prepared for the step: entity, state layout, and code with constant parameters folded in.

use std::collections::BTreeMap;
use std::ops;
use std::sync::Arc;

use crate::ir::{
    ButtonId, CompareOp, Drive, EdgeId, Entity, EntityId, Expr, ExprId, Extremes, GroupId, Id, IdVec, LeafId, ParamId,
    Press, Program, RefValue, Rest, Shape, SlotId, SlotLayout, Step, Subject, TimerId, TouchId, VarId, World,
};

use super::state::one_zero;

/// The flow of a variable in a step: degree and value, which is never negative zero.
pub(super) type Flow = (u8, f64);

/// A closed range of values.
pub(super) type Range = (f64, f64);

/// The flow for "no flow".
pub(super) const COAST: Flow = (3, 0.0);

/// An entity's code, specialised to its constant parameters.
#[derive(Debug)]
pub(super) struct Code {
    pub exprs: Box<[Expr]>,
    /// The actions of a step while a leaf is active.
    pub plans: IdVec<LeafId, Plan>,
    /// For each variable, its flow if it is constant.
    pub steady: Vec<Flow>,
    /// The other drives outside of groups.
    pub free: Vec<Drive>,
    /// For each variable, the bounds of its value and velocity, if there are clamps and all of them are constant.
    pub limits: Option<Vec<[Range; 2]>>,
    /// Whether a group reads transitions of another group in the same step.
    pub is_joint: bool,
    /// Whether there is a single group.
    pub has_one_group: bool,
    /// Whether there is a single group, which drives everything that changes.
    pub is_single: bool,
    /// Whether its actions read nothing of other instances, change nothing but itself, and call for nothing else.
    pub is_apart: bool,
}

/// The actions of a step while a leaf is active.
#[derive(Debug)]
pub(super) struct Plan {
    /// Edges with a target, by their guards.
    pub edges: Vec<(Guard, EdgeId)>,
    /// The guards of edges without a target.
    pub internal: Vec<Guard>,
    /// Whether there may be more to run in the discrete phase, whatever these are.
    pub is_busy: bool,
    /// What holds where any of these guards does.
    pub filter: Filter,
    /// Flows that are constant while the leaf is active, each with the index of its variable.
    pub steady: Vec<(usize, Flow)>,
    /// The other drives.
    pub drives: Vec<Drive>,
    /// The flows of all variables while the leaf is active, as far as they are constant.
    pub row: Vec<Flow>,
    /// Whether these are all drives of the entity.
    pub is_steady: bool,
    /// The same flows without branches, if these are all drives, no clamp has variable bounds and no envelope records its
    /// peak.
    pub straight: Option<Box<[Straight]>>,
    /// Whether what has neither velocity nor acceleration stays where it is.
    pub rests: bool,
    /// The timers that run.
    pub timers: Vec<TimerId>,
}

/// A constant flow of degree 1, 2 or 3 as one formula: `a' = a * keeps[0] + adds[0]`, `v' = v * keeps[1] + (a' * dt +
/// adds[1])`. A product with 0 and a sum with 0 are exact, so it gives the same bits as the flow.
#[derive(Debug, Clone, Copy)]
pub(super) struct Straight {
    /// What is kept of the acceleration and of the velocity, 0 or 1.
    pub keeps: [f64; 2],
    /// What is added to them.
    pub adds: [f64; 2],
}

impl Straight {
    fn new((degree, value): Flow) -> Option<Straight> {
        match degree {
            1 => Some(Straight { keeps: [0.0, 0.0], adds: [0.0, value] }),
            2 => Some(Straight { keeps: [0.0, 1.0], adds: [value, 0.0] }),
            3 => Some(Straight { keeps: [1.0, 1.0], adds: [0.0, 0.0] }),
            _ => None,
        }
    }
}

/// The guard of an edge. Most guards are one of few forms, which are decided without a look at the expressions.
#[derive(Debug, Clone, Copy)]
pub(super) enum Guard {
    /// A contact query of the instance itself, and whether it must hold.
    Touching(TouchId, bool),
    /// A button, and whether it must be so.
    Button(Press, ButtonId, bool),
    /// A variable of the instance itself, or a derivative: the least and the greatest value, and whether it must be among
    /// them.
    Within(VarId, u8, Range, bool),
    /// Any other expression.
    Expr(ExprId),
}

/// Conditions at least one of which holds where any of some guards does. They are decided without a reader, and in most
/// steps none holds, so that no guard need be read.
#[derive(Debug, Default)]
pub(super) struct Filter {
    /// Whether a guard has no such condition.
    pub is_open: bool,
    /// Of the first eight contact queries, those that hold, and those that do not.
    pub touches: [u8; 2],
    /// The buttons, by [`Press`], that are so, and those that are not.
    pub buttons: [[u64; 2]; 3],
    /// Whether there are any of the latter.
    pub reads_buttons: bool,
    /// Variables and derivatives, the range of each, and whether it is in it.
    pub ranges: Vec<(VarId, u8, Range, bool)>,
}

impl Filter {
    /// Adds what holds where a guard does, or with `wanted` false where it does not. Of operands that must all hold it is
    /// the one that is read first: if it does not hold, no other is read, so that no rule is broken.
    fn add(&mut self, id: ExprId, at: &impl Fn(ExprId) -> Expr, wanted: bool) {
        match (at(id), wanted) {
            (Expr::Not(a), _) => self.add(a, at, !wanted),
            (Expr::Or(a, b), true) | (Expr::And(a, b), false) => {
                self.add(a, at, wanted);
                self.add(b, at, wanted);
            }
            (Expr::And(a, _), true) | (Expr::Or(a, _), false) => self.add(a, at, wanted),
            (Expr::Bool(holds), _) => self.is_open |= holds == wanted,
            _ => match Guard::new(id, at) {
                Guard::Touching(touch, so) if touch.index() < 8 => {
                    self.touches[usize::from(so != wanted)] |= 1 << touch.index();
                }
                Guard::Button(press, button, so) => {
                    self.buttons[press as usize][usize::from(so != wanted)] |= 1 << button.index();
                    self.reads_buttons = true;
                }
                Guard::Within(var, degree, range, so) => self.ranges.push((var, degree, range, so == wanted)),
                Guard::Touching(..) | Guard::Expr(_) => self.is_open = true,
            },
        }
    }
}

impl Guard {
    fn new(id: ExprId, at: impl Fn(ExprId) -> Expr) -> Guard {
        match at(id) {
            Expr::Touching(Subject::Me, touch) => Guard::Touching(touch, true),
            Expr::Button(press, button) => Guard::Button(press, button, true),
            Expr::Not(a) => match at(a) {
                Expr::Touching(Subject::Me, touch) => Guard::Touching(touch, false),
                Expr::Button(press, button) => Guard::Button(press, button, false),
                _ => Guard::Expr(id),
            },
            Expr::Compare(op, a, b) => match (at(a), at(b)) {
                (Expr::Var(Subject::Me, var, degree), Expr::Number(n)) if !n.is_nan() => {
                    let (range, wanted) = within(op, n);
                    Guard::Within(var, degree, range, wanted)
                }
                _ => Guard::Expr(id),
            },
            _ => Guard::Expr(id),
        }
    }
}

/// The numbers that compare so with another, as a closed range, and whether they are those inside of it.
fn within(op: CompareOp, n: f64) -> (Range, bool) {
    match op {
        CompareOp::Equal => ((n, n), true),
        CompareOp::Unequal => ((n, n), false),
        CompareOp::AtMost => ((f64::NEG_INFINITY, n), true),
        CompareOp::Greater => ((f64::NEG_INFINITY, n), false),
        CompareOp::AtLeast => ((n, f64::INFINITY), true),
        CompareOp::Less => ((n, f64::INFINITY), false),
    }
}

impl Code {
    fn new(entity: &Entity, exprs: Box<[Expr]>) -> Self {
        let base = entity.code.from.0;
        let at = |id: ExprId| exprs[(id.0 - base) as usize];
        let fixed = |drive: &Drive| match *drive {
            Drive::Coast(var) => Some((var.index(), COAST)),
            Drive::Flow { var, degree, value } => match at(value) {
                Expr::Number(n) => Some((var.index(), (degree, one_zero(n)))),
                _ => None,
            },
            Drive::Envelope(..) => None,
        };
        let split = |drives: &[Drive]| -> (Vec<(usize, Flow)>, Vec<Drive>) {
            let others = drives.iter().copied().filter(|d| fixed(d).is_none()).collect();
            (drives.iter().filter_map(fixed).collect(), others)
        };
        let (always, free) = split(&entity.free);
        let mut all_steady = vec![COAST; entity.vars.len()];
        for (var, flow) in always {
            all_steady[var] = flow;
        }
        let has_one_group = entity.groups.len() == 1;
        let is_single = has_one_group && free.is_empty();
        let number = |id: ExprId| match at(id) {
            Expr::Number(n) => Some(n),
            _ => None,
        };
        let limits = (!entity.clamps.is_empty()).then(|| limits(entity, number)).flatten();
        let is_straight = (entity.clamps.is_empty() || limits.is_some()) && !has_peaks(entity);
        // A value that an update has put beyond its bounds comes back.
        let may_rest = |[(low, high), (slowest, fastest)]: &[Range; 2]| {
            low.is_infinite() && high.is_infinite() && *slowest <= 0.0 && 0.0 <= *fastest
        };
        let may_rest = limits.as_ref().is_none_or(|limits| limits.iter().all(may_rest));
        let plan = |leaf: &crate::ir::Leaf| {
            let (steady, drives) = split(&leaf.drives);
            let mut row = all_steady.clone();
            for &(var, flow) in &steady {
                row[var] = flow;
            }
            let is_steady = is_single && drives.is_empty();
            let straight = || row.iter().map(|flow| Straight::new(*flow)).collect();
            let mut filter = Filter::default();
            leaf.edges.iter().chain(&leaf.internal).for_each(|&edge| filter.add(entity.edges[edge].guard, &at, true));
            Plan {
                straight: (is_steady && is_straight).then(straight).flatten(),
                rests: may_rest && row.iter().all(|flow| matches!(flow, (1, 0.0) | &COAST)),
                filter,
                edges: leaf.edges.iter().map(|&edge| (Guard::new(entity.edges[edge].guard, at), edge)).collect(),
                internal: leaf.internal.iter().map(|&edge| Guard::new(entity.edges[edge].guard, at)).collect(),
                // A guard that needs a reference is not read without it.
                is_busy: !leaf.follows.is_empty() || leaf.internal.iter().any(|&e| !entity.edges[e].needs.is_empty()),
                is_steady,
                steady,
                drives,
                row,
                timers: entity.timers.pairs().filter(|(_, t)| leaf.path.contains(&t.mode)).map(|(id, _)| id).collect(),
            }
        };
        let is_apart = exprs.iter().all(reads_itself) && acts_on_itself(entity);
        let is_joint = exprs.iter().any(|e| matches!(e, Expr::Joint(..)));
        let plans = entity.leaves.iter().map(plan).collect();
        Code { plans, steady: all_steady, free, limits, is_joint, has_one_group, is_single, is_apart, exprs }
    }
}

/// Whether an expression, its operands aside, reads nothing but the instance itself and its inputs.
fn reads_itself(expr: &Expr) -> bool {
    match expr {
        Expr::Number(_) | Expr::Frames(_) | Expr::Bool(_) | Expr::Axis(_) | Expr::Button(..) | Expr::Timer(_) => true,
        Expr::Negate(_) | Expr::Arithmetic(..) | Expr::Call(..) | Expr::Compare(..) => true,
        Expr::And(..) | Expr::Or(..) | Expr::Not(_) | Expr::Joint(..) | Expr::Received(_) | Expr::Sum(_) => true,
        Expr::Param(of, _) | Expr::Var(of, ..) | Expr::Discrete(of, _) | Expr::Touching(of, _) => *of == Subject::Me,
        Expr::InMode(of, _) | Expr::InSpace(of, _) => *of == Subject::Me,
        _ => false,
    }
}

/// Whether the actions of an entity change its own variables and modes at most.
fn acts_on_itself(entity: &Entity) -> bool {
    let all = entity.modes.iter().map(|mode| &mode.entry).chain(entity.edges.iter().map(|edge| &edge.actions));
    entity.follows.is_empty()
        && all.into_iter().all(|a| {
            let destroys_itself = a.destroys.iter().all(|of| matches!(of, RefValue::Of(Subject::Me)));
            a.refs.is_empty() && a.spawns.is_empty() && a.sends.is_empty() && destroys_itself
        })
}

/// Whether any envelope records its peak.
fn has_peaks(entity: &Entity) -> bool {
    entity.envelopes.iter().any(|envelope| envelope.peak.is_some())
}

/// The bounds that clamps give each variable and its velocity; `None` if one of them is not constant.
fn limits(entity: &Entity, number: impl Fn(ExprId) -> Option<f64>) -> Option<Vec<[Range; 2]>> {
    let unbounded = (f64::NEG_INFINITY, f64::INFINITY);
    let mut limits = vec![[unbounded; 2]; entity.vars.len()];
    for clamp in &entity.clamps {
        let low = clamp.low.map_or(Some(unbounded.0), &number)?;
        let high = clamp.high.map_or(Some(unbounded.1), &number)?;
        let limit = limits[clamp.var.index()].get_mut(usize::from(clamp.degree))?;
        // Several clamps in sequence equal one.
        *limit = (one_zero(limit.0.greatest(low).least(high)), one_zero(limit.1.greatest(low).least(high)));
    }
    Some(limits)
}

/// The prepared data of a slot.
#[derive(Debug)]
pub(super) struct Actor {
    pub id: SlotId,
    pub entity: Arc<Entity>,
    /// For each timer, the count above which it no longer matters.
    pub timer_limits: IdVec<TimerId, u32>,
    pub layout: SlotLayout,
    /// Numbers of its contact queries, and of those that are bound.
    pub touches: usize,
    pub bound: usize,
    /// Numbers of its signals, and of those that come with a number.
    pub signals: usize,
    pub numbered: usize,
    /// The code of the entity.
    pub code: Arc<Code>,
    /// The id of its first expression.
    pub base: u32,
    /// The range of its groups among the groups of all slots; and so on.
    pub groups: ops::Range<usize>,
    pub vars: ops::Range<usize>,
    pub clamps: ops::Range<usize>,
    pub envelopes: ops::Range<usize>,
    /// The range of its contact queries that can name a tile.
    pub kept: ops::Range<usize>,
    /// The number of its first draw among those of the world.
    pub draws: usize,
    /// The index of the controlling player.
    pub player: Option<usize>,
    /// Whether it has clamps with variable bounds, or envelopes that record their peak.
    pub is_bounded: bool,
    /// The offset of the leaf of its first group in a state.
    pub leaf_at: usize,
}

/// The actors of a world.
pub(super) fn actors(program: &Program, world: &World) -> Vec<Actor> {
    // Instances of one entity with the same parameters (as bits) share their code, unless it reads where they rest.
    type Key = (EntityId, Option<Vec<u64>>, Option<Vec<u64>>);
    let mut known: BTreeMap<Key, Arc<Code>> = BTreeMap::new();
    let take = |from: &mut usize, count: usize| {
        *from += count;
        *from - count..*from
    };
    let (mut all_groups, mut all_vars, mut all_clamps, mut all_envelopes, mut all_draws) = (0, 0, 0, 0, 0);
    let mut all_kept = 0;
    let mut out = Vec::with_capacity(world.slots.len());
    for (id, slot) in world.slots.pairs() {
        let entity = &program.entities[slot.entity];
        // Parameters that can change are part of the state.
        let layout = world.layout.slots[id].clone();
        let is_read = |rest: &&Rest| {
            let reads = |e: u32| matches!(program.exprs[ExprId(e)], Expr::Var(Subject::Me, ..));
            !rest.vars.is_empty() && (entity.code.from.0..entity.code.to.0).any(reads)
        };
        let rest = layout.rest.as_deref();
        let read = rest.filter(is_read).map(|rest| rest.vars.iter().map(|value| value.to_bits()).collect());
        let key = (slot.entity, slot.is_fixed.then(|| slot.params.iter().map(|p| p.to_bits()).collect()), read);
        let none = IdVec::new();
        let params = if slot.is_fixed { &slot.params } else { &none };
        let code = known.entry(key).or_insert_with(|| {
            let exprs = entity.code.from.0..entity.code.to.0;
            let exprs = exprs.map(|e| folded(program, ExprId(e), (params, rest), world.step)).collect();
            Arc::new(Code::new(entity, exprs))
        });
        let (code, base) = (code.clone(), entity.code.from.0);
        let is_bounded = has_peaks(entity) || !entity.clamps.is_empty() && code.limits.is_none();
        out.push(Actor {
            id,
            entity: Arc::clone(entity),
            timer_limits: slot.timer_limits.clone(),
            touches: entity.touches.len(),
            bound: entity.bound,
            signals: entity.signals.len(),
            numbered: entity.numbered_signals(),
            kept: take(&mut all_kept, if layout.tiles.is_some() { entity.bound } else { 0 }),
            leaf_at: layout.leaf_offset(GroupId(0)),
            layout,
            code,
            base,
            groups: take(&mut all_groups, entity.groups.len()),
            vars: take(&mut all_vars, entity.vars.len()),
            clamps: take(&mut all_clamps, entity.clamps.len()),
            envelopes: take(&mut all_envelopes, entity.envelopes.len()),
            draws: take(&mut all_draws, entity.chances.len()).start,
            player: slot.player.map(Id::index),
            is_bounded,
        });
    }
    out
}

/// An expression, or its value if it is constant, as the variables are where an instance rests.
fn folded(program: &Program, id: ExprId, (params, rest): (&IdVec<ParamId, f64>, Option<&Rest>), step: Step) -> Expr {
    let expr = program.exprs[id];
    match (program.constant(id, params, step), expr) {
        (None, Expr::Var(Subject::Me, var, degree)) => rest.map_or(expr, |rest| {
            let value = rest.vars.get(var).filter(|_| degree == 0);
            Expr::Number(value.copied().unwrap_or(0.0))
        }),
        (None, _) => expr,
        (Some(value), Expr::Bool(_) | Expr::Compare(..) | Expr::And(..) | Expr::Or(..) | Expr::Not(_)) => {
            Expr::Bool(value != 0.0)
        }
        (Some(value), _) => Expr::Number(value),
    }
}

/// The box of a collider, if it is constant.
pub(super) fn fixed_box(program: &Program, world: &World, slot: SlotId, shape: &Shape) -> Option<[f64; 4]> {
    let slot = &world.slots[slot];
    let none = IdVec::new();
    let params = if slot.is_fixed { &slot.params } else { &none };
    shape.sides(|id| program.constant(id, params, world.step))
}

/// The leaves in which a guard holds, if it depends only on modes of one group of the entity itself.
pub(super) fn leaves(program: &Program, entity: &Entity, guard: ExprId) -> Option<(GroupId, Vec<bool>)> {
    let both = |a: ExprId, b: ExprId, join: &dyn Fn(bool, bool) -> bool| {
        let ((group, a), (other, b)) = (leaves(program, entity, a)?, leaves(program, entity, b)?);
        let joined = a.iter().zip(&b).map(|(a, b)| join(*a, *b)).collect();
        (group == other).then_some((group, joined))
    };
    match program.exprs[guard] {
        Expr::InMode(Subject::Me, mode) => {
            let mode = &entity.modes[mode];
            let inside = mode.leaves;
            Some((mode.group, entity.leaves.ids().map(|leaf| inside.contains(leaf)).collect()))
        }
        Expr::Not(a) => leaves(program, entity, a).map(|(group, held)| (group, held.iter().map(|h| !h).collect())),
        Expr::And(a, b) => both(a, b, &|a, b| a && b),
        Expr::Or(a, b) => both(a, b, &|a, b| a || b),
        _ => None,
    }
}

/// Whether no instance reads another one in the continuous phase.
pub(super) fn moves_independently(actors: &[Actor]) -> bool {
    let other = |of: Subject| of != Subject::Me;
    actors.iter().all(|actor| {
        !actor.code.exprs.iter().any(|e| match *e {
            Expr::Var(of, ..) | Expr::Discrete(of, _) | Expr::Param(of, _) | Expr::InMode(of, _) => other(of),
            Expr::Touching(of, _) | Expr::InSpace(of, _) | Expr::Near { of, .. } | Expr::Distance { of, .. } => {
                other(of)
            }
            Expr::Probe { .. } | Expr::Count { .. } | Expr::Nearest { .. } | Expr::Broken(_) => true,
            _ => false,
        })
    })
}

impl Actor {
    /// Its index.
    pub fn index(&self) -> usize {
        self.id.index()
    }

    /// The ids of its groups.
    #[inline]
    pub fn group_ids(&self) -> impl Iterator<Item = GroupId> + use<> {
        (0..self.groups.len()).map(GroupId::from_index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::compare;

    #[test]
    fn a_range_of_a_comparison_holds_the_numbers_that_compare_so() {
        let numbers = [f64::NEG_INFINITY, -1.5, -f64::MIN_POSITIVE, -0.0, 0.0, f64::MIN_POSITIVE, 3.0, f64::INFINITY];
        for op in [
            CompareOp::Equal,
            CompareOp::Unequal,
            CompareOp::Less,
            CompareOp::AtMost,
            CompareOp::Greater,
            CompareOp::AtLeast,
        ] {
            for n in numbers {
                let ((low, high), wanted) = within(op, n);
                for v in numbers {
                    assert_eq!((low <= v && v <= high) == wanted, compare(op, v, n), "{v} {op:?} {n}");
                }
            }
        }
    }
}
