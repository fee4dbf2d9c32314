//! Upper bounds of counters that count things which can be picked up only once. Stepping alone does not find them, so
//! they are computed from the program and the world before the analysis starts.
//!
//! A contact between two instances sets the contact bits of both in one collision phase, and both read them in the next
//! step. An edge that needs a contact is taken at most once per collision phase with such a contact. If everything that
//! can be touched in this way is *used up*, each of its lives contributes one such phase: in the next step it is
//! certainly destroyed, or permanently enters leaves where the collider is off. Lives are counted: one for each
//! instance that exists at the start, and those spawned by action lists that run a limited number of times in a life.
//! So a variable is at most its initial value, or a constant that is written, plus the sum of what such edges add.
//!
//! An instance is certainly used up if in each leaf in which the collider can be on, the edges of one group, in
//! evaluation order, all destroy the instance or lead to where the collider is off permanently, up to an edge whose
//! guard is just a contact query without a side that every such contact satisfies. Any other form gives no bound, which
//! is represented by infinity.

use std::collections::{BTreeMap, BTreeSet};

use crate::ir::{
    Actions, Arithmetic, ColliderId, DiscreteId, Edge, EdgeId, Entity, EntityId, Expr, ExprId, Extremes, FollowId,
    Function, IdRange, IdVec, LeafId, ModeId, Origin, ParamId, Place, Program, RefValue, Slot, SlotId, Subject, TagSet,
    TouchId, World, compare,
};

use crate::analysis::domain::values::{Interval, Values};
use crate::analysis::geometry::tiles::Tiles;

/// Values of each discrete variable of each slot that hold in every step.
pub(in crate::analysis) type Limits = IdVec<SlotId, IdVec<DiscreteId, Values>>;

/// The ranges of the variables.
pub(in crate::analysis) fn ranges(program: &Program, world: &World) -> Limits {
    let discretes =
        |slot: &Slot| program.entities[slot.entity].discretes.iter().map(|d| Values::range(d.range)).collect();
    world.slots.iter().map(discretes).collect()
}

/// The ranges, cut to the upper bounds.
pub(in crate::analysis) fn limits(program: &Program, world: &World) -> Limits {
    let mut limits = ranges(program, world);
    // The contents of an unknown map are not known either.
    if world.open.is_some() {
        return limits;
    }
    let mut bounds = CounterBounds { program, world, lives: IdVec::new(), runs: BTreeMap::new() };
    bounds.lives = bounds.lives();
    for (slot, limits) in world.slots.iter().zip(limits.iter_mut()) {
        for (id, limit) in program.entities[slot.entity].discretes.ids().zip(limits.iter_mut()) {
            *limit = limit.within(Interval { low: f64::NEG_INFINITY, high: bounds.upper_bound(slot, id) });
        }
    }
    limits
}

/// The cause that runs an action list.
#[derive(Debug, Clone, Copy)]
enum Cause {
    Edge(EdgeId),
    Entry(ModeId),
    Follow(FollowId),
}

/// A new value is at most the old one plus `above`, or at most `top`; minus infinity means that the case does not
/// occur.
#[derive(Debug, Clone, Copy)]
struct Upper {
    above: f64,
    top: f64,
}

impl Upper {
    fn at_most(top: f64) -> Upper {
        Upper { above: f64::NEG_INFINITY, top }
    }

    fn or(self, other: Upper) -> Upper {
        Upper { above: self.above.greatest(other.above), top: self.top.greatest(other.top) }
    }

    fn plus(self, other: f64) -> Upper {
        let sum = |x: f64| if x == f64::NEG_INFINITY { x } else { x + other };
        Upper { above: sum(self.above), top: sum(self.top) }
    }

    /// Both bounds hold; picks the more useful one.
    fn and(self, other: Upper, counts: bool) -> Upper {
        let order = |u: Upper| {
            let is_unknown = u.above == f64::INFINITY || u.top == f64::INFINITY;
            let is_flat = u.above <= 0.0;
            (is_unknown, is_flat == counts)
        };
        match order(self).cmp(&order(other)) {
            std::cmp::Ordering::Less => self,
            std::cmp::Ordering::Greater => other,
            std::cmp::Ordering::Equal if other.above.greatest(other.top) < self.above.greatest(self.top) => other,
            std::cmp::Ordering::Equal => self,
        }
    }
}

struct CounterBounds<'a> {
    program: &'a Program,
    world: &'a World,
    /// Maximum number of instances of each entity in a whole run.
    lives: IdVec<EntityId, f64>,
    /// How often edges run in a whole run; filled on demand.
    runs: BTreeMap<(EntityId, EdgeId), f64>,
}

impl<'a> CounterBounds<'a> {
    /// Maximum number of instances of each entity in a whole run.
    fn lives(&self) -> IdVec<EntityId, f64> {
        let (program, world) = (self.program, self.world);
        let slots = |entity| world.slots.iter().filter(move |s| s.entity == entity && s.origin != Origin::Free);
        let first: IdVec<EntityId, f64> = program.entities.ids().map(|e| slots(e).count() as f64).collect();
        // For each spawning action list: the spawner, the spawned entity, the number of runs per life, and the number
        // of initial instances that never run it.
        let mut spawning: Vec<(EntityId, EntityId, f64, f64)> = Vec::new();
        for (id, entity) in program.entities.pairs() {
            for (cause, actions) in lists(entity).filter(|(_, a)| !a.spawns.is_empty()) {
                let often = per_life(entity, cause, actions);
                let idle = match cause {
                    Cause::Edge(edge) => {
                        let guard = entity.edges[edge].guard;
                        slots(id).filter(|s| self.initial_constant(s, guard) == Some(0.0)).count() as f64
                    }
                    Cause::Entry(_) | Cause::Follow(_) => 0.0,
                };
                spawning.extend(actions.spawns.iter().map(|s| (id, entity.spawns[*s].entity, often, idle)));
            }
        }
        let mut lives = first.clone();
        let rounds = program.entities.len() + 1;
        for round in 0..3 * rounds {
            let mut next = first.clone();
            for &(spawner, made, often, idle) in &spawning {
                let spawners = lives[spawner] - idle;
                if spawners > 0.0 && often > 0.0 {
                    next[made] += spawners * often;
                }
            }
            // A count that still grows after as many rounds as there are entities is unbounded: the entity spawns
            // itself.
            for (life, before) in next.iter_mut().zip(lives.iter()) {
                if round >= rounds && *life > *before {
                    *life = f64::INFINITY;
                }
            }
            lives = next;
        }
        lives
    }

    /// The constant value of a guard or a number of an initial instance, if nothing ever changes it.
    fn initial_constant(&self, slot: &Slot, id: ExprId) -> Option<f64> {
        let entity = &self.program.entities[slot.entity];
        let truth = |holds: bool| Some(f64::from(u8::from(holds)));
        match self.program.exprs[id] {
            Expr::And(a, b) => match (self.initial_constant(slot, a), self.initial_constant(slot, b)) {
                (Some(0.0), _) | (_, Some(0.0)) => truth(false),
                (Some(_), Some(_)) => truth(true),
                _ => None,
            },
            Expr::Not(a) => truth(self.initial_constant(slot, a)? == 0.0),
            Expr::Compare(op, a, b) => {
                truth(compare(op, self.initial_constant(slot, a)?, self.initial_constant(slot, b)?))
            }
            Expr::Discrete(Subject::Me, id) => {
                let mut updates = lists(entity).flat_map(|(_, actions)| &actions.updates);
                let is_written = updates.any(|u| u.place == Place::Discrete(id));
                (!is_written).then(|| f64::from(slot.discretes[id]))
            }
            _ => self.program.constant(id, &slot.params, self.world.step),
        }
    }

    /// Upper bound of a discrete variable of a slot.
    fn upper_bound(&mut self, slot: &Slot, id: DiscreteId) -> f64 {
        let entity = &self.program.entities[slot.entity];
        let none = IdVec::new();
        // The parameters of a slot that can be reused are not known.
        let params = if slot.is_fixed { &slot.params } else { &none };
        let mut first = f64::from(slot.discretes[id]);
        let spawns = self.program.entities.iter().flat_map(|e| e.spawns.iter());
        let mut spawns = spawns.filter(|s| s.entity == slot.entity).peekable();
        if slot.origin != Origin::Named && spawns.peek().is_some() {
            let constant = |expr| self.program.constant(expr, &none, self.world.step).unwrap_or(f64::INFINITY);
            let given =
                spawns.flat_map(|s| &s.updates).filter(|u| u.place == Place::Discrete(id)).map(|u| constant(u.value));
            first = given.fold(constant(entity.discretes[id].first).greatest(first), f64::greatest);
        }
        let mut flat = first;
        let mut counted = (first, 0.0);
        for (cause, actions) in lists(entity) {
            for update in actions.updates.iter().filter(|u| u.place == Place::Discrete(id)) {
                let upper = |counts| self.upper(entity, update.value, id, params, counts);
                let never_counted = upper(false);
                flat = flat.greatest(if never_counted.above > 0.0 { f64::INFINITY } else { never_counted.top });
                let mut kept = upper(true);
                if kept.above > 0.0 {
                    let runs = self.runs(slot.entity, cause);
                    if runs.is_finite() {
                        counted.1 += if runs > 0.0 { kept.above * runs } else { 0.0 };
                    } else {
                        kept = never_counted;
                        counted.1 += if kept.above > 0.0 { f64::INFINITY } else { 0.0 };
                    }
                }
                counted.0 = kept.top.greatest(counted.0);
            }
        }
        // Rounded down, as a counter is a whole number, with a tolerance for sums of fractions.
        flat.least((counted.0 + counted.1 + 1e-6).floor())
    }

    /// Upper bound of an update. Where there is a choice, prefers a bound relative to the old value (`counts`) or an
    /// absolute one.
    fn upper(
        &self,
        entity: &Entity,
        value: ExprId,
        id: DiscreteId,
        params: &IdVec<ParamId, f64>,
        counts: bool,
    ) -> Upper {
        if let Some(constant) = self.program.constant(value, params, self.world.step) {
            return Upper::at_most(constant);
        }
        let of = |value| self.upper(entity, value, id, params, counts);
        match self.program.exprs[value] {
            Expr::Discrete(Subject::Me, other) if other == id => Upper { above: 0.0, top: f64::NEG_INFINITY },
            Expr::Discrete(Subject::Me, other) => Upper::at_most(f64::from(entity.discretes[other].range.1)),
            Expr::Arithmetic(Arithmetic::Add, a, b) => match (of(a), of(b)) {
                (a, b) if b.above == f64::NEG_INFINITY => a.plus(b.top),
                (a, b) if a.above == f64::NEG_INFINITY => b.plus(a.top),
                _ => Upper::at_most(f64::INFINITY),
            },
            Expr::Arithmetic(Arithmetic::Subtract, a, b) => {
                let least = match self.program.exprs[b] {
                    Expr::Discrete(Subject::Me, other) => Some(f64::from(entity.discretes[other].range.0)),
                    _ => self.program.constant(b, params, self.world.step),
                };
                least.map_or(Upper::at_most(f64::INFINITY), |least| of(a).plus(-least))
            }
            Expr::Call(Function::Min, [a, b, _]) => of(a).and(of(b), counts),
            Expr::Call(Function::Max, [a, b, _]) | Expr::Call(Function::If, [_, a, b]) => of(a).or(of(b)),
            Expr::Call(Function::Clamp, [a, b, c]) => of(a).or(of(b)).and(of(c), counts),
            Expr::Compare(..) | Expr::And(..) | Expr::Or(..) | Expr::Not(_) => Upper::at_most(1.0),
            _ => Upper::at_most(f64::INFINITY),
        }
    }

    /// Maximum number of runs of an action list in the life of an instance.
    fn runs(&mut self, id: EntityId, cause: Cause) -> f64 {
        let entity = &self.program.entities[id];
        match cause {
            Cause::Edge(edge) => {
                if let Some(known) = self.runs.get(&(id, edge)) {
                    return *known;
                }
                let Edge { guard, actions, .. } = &entity.edges[edge];
                let found = per_life(entity, cause, actions).least(self.contacts(entity, *guard, actions));
                self.runs.insert((id, edge), found);
                found
            }
            Cause::Entry(mode) => {
                let edges: Vec<EdgeId> = entering(entity, mode).collect();
                edges.into_iter().map(|edge| self.runs(id, Cause::Edge(edge))).sum()
            }
            Cause::Follow(follow) => {
                let follow = &entity.follows[follow];
                follow.guard.map_or(f64::INFINITY, |guard| self.contacts(entity, guard, &follow.actions))
            }
        }
    }

    /// Maximum number of collision phases after which a guard can hold, by the contacts that it needs.
    fn contacts(&self, entity: &Entity, guard: ExprId, actions: &Actions) -> f64 {
        match self.program.exprs[guard] {
            Expr::And(a, b) => self.contacts(entity, a, actions).least(self.contacts(entity, b, actions)),
            Expr::Or(a, b) => self.contacts(entity, a, actions) + self.contacts(entity, b, actions),
            Expr::Touching(Subject::Me, touch) => self.phases(entity, touch, actions),
            _ => f64::INFINITY,
        }
    }

    /// Maximum number of collision phases after which a contact query can hold.
    fn phases(&self, entity: &Entity, touch: TouchId, actions: &Actions) -> f64 {
        // Whether the edge destroys the touched instance.
        let destroys = actions.destroys.contains(&RefValue::Of(Subject::Touched(touch)));
        let touch = &entity.touches[touch];
        let other = TagSet::of(touch.other);
        let mine: Vec<TagSet> = entity.colliders.iter().map(|c| c.tags).filter(|t| t.meets(touch.mine)).collect();
        let meets = |tags: TagSet| tags.meets(other) && mine.iter().any(|a| self.world.meeting(*a, tags).is_some());
        let is_static = self.world.spaces.pairs().any(|(id, space)| {
            let tiles = Tiles::new(self.world, id);
            let mut kinds = tiles.tags.iter().enumerate();
            kinds.any(|(kind, tags)| meets(*tags) && tiles.has(kind)) || space.solids.iter().any(|s| meets(s.tags))
        });
        if is_static && (!touch.bound || touch.tiles) {
            return f64::INFINITY;
        }
        let mut sum = 0.0;
        for (id, carrier) in self.program.entities.pairs().filter(|(id, _)| self.lives[*id] > 0.0) {
            let carrying = carrier.colliders.pairs().filter(|(_, c)| meets(c.tags));
            let pairs: Vec<(TagSet, ColliderId)> = carrying
                .flat_map(|(id, c)| mine.iter().map(move |a| (*a, id, c.tags)))
                .filter(|(a, _, b)| self.world.meeting(*a, *b).is_some())
                .map(|(a, id, _)| (a, id))
                .collect();
            if pairs.is_empty() {
                continue;
            }
            let used_up = || carrier.groups.iter().any(|g| self.is_used_up(carrier, g.modes, &pairs));
            sum += if destroys || used_up() { self.lives[id] } else { f64::INFINITY };
        }
        sum
    }

    /// Whether an instance is used up by each of some contacts, given as the tags of the touched collider and the
    /// instance's own collider.
    fn is_used_up(&self, entity: &Entity, modes: IdRange<ModeId>, pairs: &[(TagSet, ColliderId)]) -> bool {
        let leaves: Vec<LeafId> =
            entity.leaves.pairs().filter(|(_, l)| modes.contains(l.mode)).map(|(id, _)| id).collect();
        let is_off = |leaf: LeafId, id: ColliderId| {
            let guard = entity.colliders[id].guard;
            guard.is_some_and(|guard| self.in_leaf(entity, guard, modes, leaf) == Some(false))
        };
        let mut off: BTreeSet<LeafId> =
            leaves.iter().copied().filter(|l| pairs.iter().all(|(_, id)| is_off(*l, *id))).collect();
        // Permanently off: no edge leads back.
        loop {
            let before = off.len();
            let leads_back =
                |l: &LeafId| entity.leaves[*l].edges.iter().any(|e| entered(entity, *e).any(|to| !off.contains(&to)));
            off = off.iter().copied().filter(|l| !leads_back(l)).collect();
            if off.len() == before {
                break;
            }
        }
        leaves.iter().all(|leaf| {
            let on = pairs.iter().filter(|(_, id)| !is_off(*leaf, *id));
            on.into_iter().all(|(other, id)| {
                let mine = entity.colliders[*id].tags;
                let holds = |guard| self.holds(entity, guard, mine, *other);
                let leaf = &entity.leaves[*leaf];
                let mut internal = leaf.internal.iter().map(|e| &entity.edges[*e]);
                if internal.any(|e| destroys_self(&e.actions) && e.needs.is_empty() && holds(e.guard)) {
                    return true;
                }
                for edge in &leaf.edges {
                    let uses_up = ends(entity, *edge) || entered(entity, *edge).all(|to| off.contains(&to));
                    if !uses_up {
                        return false;
                    }
                    if holds(entity.edges[*edge].guard) {
                        return true;
                    }
                }
                false
            })
        })
    }

    /// Whether a guard certainly holds after a contact of a collider.
    fn holds(&self, entity: &Entity, guard: ExprId, mine: TagSet, other: TagSet) -> bool {
        let of = |guard| self.holds(entity, guard, mine, other);
        match self.program.exprs[guard] {
            Expr::Bool(holds) => holds,
            Expr::And(a, b) => of(a) && of(b),
            Expr::Or(a, b) => of(a) || of(b),
            Expr::Touching(Subject::Me, touch) => {
                let touch = &entity.touches[touch];
                touch.side.is_none() && touch.mine.meets(mine) && other.meets(TagSet::of(touch.other))
            }
            _ => false,
        }
    }

    /// The truth of a guard while a leaf of a group is active, if the leaf decides it.
    fn in_leaf(&self, entity: &Entity, guard: ExprId, modes: IdRange<ModeId>, leaf: LeafId) -> Option<bool> {
        let of = |guard| self.in_leaf(entity, guard, modes, leaf);
        match self.program.exprs[guard] {
            Expr::Bool(holds) => Some(holds),
            Expr::InMode(Subject::Me, mode) if modes.contains(mode) => {
                let inside = entity.modes[mode].leaves;
                Some(inside.contains(leaf))
            }
            Expr::Not(a) => of(a).map(|holds| !holds),
            Expr::And(a, b) => match (of(a), of(b)) {
                (Some(false), _) | (_, Some(false)) => Some(false),
                (Some(true), Some(true)) => Some(true),
                _ => None,
            },
            Expr::Or(a, b) => match (of(a), of(b)) {
                (Some(true), _) | (_, Some(true)) => Some(true),
                (Some(false), Some(false)) => Some(false),
                _ => None,
            },
            _ => None,
        }
    }
}

/// All action lists of an entity.
fn lists(entity: &Entity) -> impl Iterator<Item = (Cause, &Actions)> {
    let edges = entity.edges.pairs().map(|(id, e)| (Cause::Edge(id), &e.actions));
    let entries = entity.modes.pairs().map(|(id, m)| (Cause::Entry(id), &m.entry));
    edges.chain(entries).chain(entity.follows.pairs().map(|(id, f)| (Cause::Follow(id), &f.actions)))
}

fn destroys_self(actions: &Actions) -> bool {
    actions.destroys.contains(&RefValue::Of(Subject::Me))
}

/// Whether taking an edge destroys the instance.
fn ends(entity: &Entity, edge: EdgeId) -> bool {
    let Edge { target, actions, .. } = &entity.edges[edge];
    // An edge enters its target even if the target is active.
    destroys_self(actions) || target.is_some_and(|target| destroys_self(&entity.modes[target].entry))
}

/// The leaves that an edge can make active.
fn entered(entity: &Entity, edge: EdgeId) -> impl Iterator<Item = LeafId> + use<> {
    entity.edges[edge].target.map(|target| entity.enterable(target).ids()).into_iter().flatten()
}

/// The edges that can enter a mode: their target is the mode itself, an ancestor or a descendant.
fn entering(entity: &Entity, mode: ModeId) -> impl Iterator<Item = EdgeId> + '_ {
    let within = |inner: ModeId, outer: ModeId| outer <= inner && inner < entity.modes[outer].end;
    let targets = entity.edges.pairs().filter_map(|(id, e)| Some((id, e.target?)));
    targets.filter(move |(_, target)| within(*target, mode) || within(mode, *target)).map(|(id, _)| id)
}

/// Maximum number of runs of an action list in one life, by the structure of the edges alone.
fn per_life(entity: &Entity, cause: Cause, actions: &Actions) -> f64 {
    if destroys_self(actions) {
        return 1.0;
    }
    match cause {
        Cause::Edge(edge) if ends(entity, edge) || !can_recur(entity, edge) => 1.0,
        Cause::Entry(mode) => {
            entering(entity, mode).map(|edge| per_life(entity, Cause::Edge(edge), &entity.edges[edge].actions)).sum()
        }
        Cause::Edge(_) | Cause::Follow(_) => f64::INFINITY,
    }
}

/// Whether an edge can be taken more than once.
fn can_recur(entity: &Entity, edge: EdgeId) -> bool {
    let Edge { source, target, .. } = &entity.edges[edge];
    if target.is_none() {
        return true;
    }
    let inside = entity.modes[*source].leaves;
    let mut seen: BTreeSet<LeafId> = entered(entity, edge).collect();
    let mut open: Vec<LeafId> = seen.iter().copied().collect();
    while let Some(leaf) = open.pop() {
        if inside.contains(leaf) {
            return true;
        }
        let next = entity.leaves[leaf].edges.iter().flat_map(|e| entered(entity, *e));
        open.extend(next.filter(|l| seen.insert(*l)));
    }
    false
}
