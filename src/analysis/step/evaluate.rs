//! Abstract evaluation: values of numbers and outcomes of guards. Guards restrict configurations in `refine`.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, PoisonError};

use crate::ir::{
    Arithmetic, CompareOp, DiscreteId, Entity, EntityId, Expr, ExprId, Extremes, Function, Id, IdVec, LeafId, ParamId,
    ProbeId, Program, SlotId, SpaceId, Subject, TagId, TouchId, VarId, World, call,
};

use crate::analysis::domain::configuration::{Configuration, MidStep, Overall};
use crate::analysis::domain::received::Received;
use crate::analysis::domain::truth::Truth;
use crate::analysis::domain::values::{Interval, Values};
use crate::analysis::geometry::breakable;
use crate::analysis::geometry::surroundings::Surroundings;

use super::probe::There;

/// The phase of the simulator in which an expression is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::analysis) enum Phase {
    /// The discrete phase, and predicates between steps: the state at the start of the step.
    Discrete,
    /// The continuous phase: the state after the discrete phase, with the contacts of the last collision phase.
    Continuous {
        /// Whether the instance was moved after its contacts were detected.
        is_put: bool,
    },
}

/// The part of an instance's states for which a predicate of the world is evaluated.
#[derive(Debug, Clone, Copy)]
pub(in crate::analysis) enum Pinned<'a> {
    /// A box of its region.
    Part(SpaceId, [Interval; 2]),
    /// A configuration.
    At(&'a Configuration),
}

/// A number of an instance that is read through a reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    Param(ParamId),
    /// The flag is true for reads in the middle of a step.
    Var(VarId, usize, bool),
    Discrete(DiscreteId, bool),
}

/// The instances that a subject can name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Named {
    /// All.
    Any,
    /// Those of an entity.
    Of(EntityId),
    /// Those that a bound contact query of an entity can find.
    By(EntityId, TouchId),
    /// Those that a bound probe of an entity can find.
    At(EntityId, ProbeId),
}

/// For each tag, the colliders that probes can find, at the start of a step or (true) within it.
type Probed = BTreeMap<(TagId, bool), Arc<[There]>>;

/// The join over the instances that a subject can name: cached until the slots change.
#[derive(Debug, Default)]
pub(in crate::analysis) struct Joined {
    values: Mutex<BTreeMap<(Named, Part), Values>>,
    alive: Mutex<BTreeMap<Named, Arc<[SlotId]>>>,
    /// What probes can find.
    pub(super) probed: Mutex<Probed>,
}

impl Joined {
    /// Clears the cache after the slots have changed.
    pub fn forget(&mut self) {
        *self = Joined::default();
    }
}

impl Clone for Joined {
    fn clone(&self) -> Self {
        Joined::default()
    }
}

/// The context in which an expression is evaluated.
#[derive(Clone, Copy)]
pub(in crate::analysis) struct Reader<'a> {
    pub program: &'a Program,
    pub world: &'a World,
    pub slots: &'a IdVec<SlotId, Overall>,
    /// Cached joins over several slots.
    pub joined: &'a Joined,
    /// The possible contacts of each slot.
    pub surroundings: &'a Surroundings,
    /// The signals that instances of each entity can receive.
    pub received: &'a Received,
    /// For a predicate of the world: an instance, and the part of its states that is considered.
    pub pinned: Option<(SlotId, Pinned<'a>)>,
    /// The instance of `Subject::Me`; `None` for a predicate of the world.
    pub me: Option<(SlotId, &'a Configuration)>,
    /// A subject that is known to be of an entity where the expression is evaluated.
    pub tested: Option<(Subject, EntityId)>,
    /// The instance that a question to each asks.
    pub member: Option<SlotId>,
    /// The phase of evaluation.
    pub phase: Phase,
}

impl<'a> Reader<'a> {
    pub(super) fn entity(&self, slot: SlotId) -> &'a Entity {
        &self.program.entities[self.world.slots[slot].entity]
    }

    /// The slots that a subject can refer to.
    fn candidates(&self, of: Subject) -> Arc<[SlotId]> {
        match (of, self.me) {
            (Subject::Me, Some((me, _))) => Arc::new([me]),
            (Subject::Slot(slot), _) => Arc::new([slot]),
            (Subject::Member(_), _) if self.member.is_some() => self.member.into_iter().collect(),
            _ => {
                let named = self.named(of);
                let mut known = self.joined.alive.lock().unwrap_or_else(PoisonError::into_inner);
                let fits = |slot: &SlotId| {
                    let entity = self.world.slots[*slot].entity;
                    let is_named = match named {
                        Named::Any => true,
                        Named::Of(declared) => declared == entity,
                        Named::By(me, touch) => self.program.can_be(me, Subject::Touched(touch), entity),
                        Named::At(me, probe) => self.program.can_be(me, Subject::Probed(probe), entity),
                    };
                    is_named && self.slots[*slot].can_live
                };
                let alive = known.entry(named).or_insert_with(|| self.world.slots.ids().filter(fits).collect());
                Arc::clone(alive)
            }
        }
    }

    /// The instances that a reference or the name of a contact can name.
    fn named(&self, of: Subject) -> Named {
        let tested = self.tested.filter(|(tested, _)| *tested == of).map(|(_, entity)| Named::Of(entity));
        let Some((me, _)) = self.me else { return Named::Any };
        let declared = match of {
            Subject::Ref(id) => self.entity(me).refs[id].entity.map_or(Named::Any, Named::Of),
            Subject::Touched(id) => Named::By(self.world.slots[me].entity, id),
            Subject::Probed(id) => Named::At(self.world.slots[me].entity, id),
            Subject::Member(entity) => Named::Of(entity),
            Subject::Me | Subject::Slot(_) => Named::Any,
        };
        tested.unwrap_or(declared)
    }

    /// The context in which a guard holds.
    pub(super) fn after(&self, guard: ExprId) -> Self {
        Reader { tested: self.program.tested(guard).or(self.tested), ..*self }
    }

    /// The join of `read` over all instances that a subject can refer to; instances without the number are skipped.
    fn read(&self, of: Subject, part: Part, read: impl Fn(&Overall) -> Option<Values>) -> Values {
        let is_one = match of {
            Subject::Me => self.me.is_some(),
            Subject::Slot(_) => true,
            Subject::Member(_) => self.member.is_some(),
            Subject::Ref(_) | Subject::Touched(_) | Subject::Probed(_) => false,
        };
        let key = (self.named(of), part);
        let known = || self.joined.values.lock().unwrap_or_else(PoisonError::into_inner);
        if !is_one && let Some(values) = known().get(&key) {
            return *values;
        }
        let candidates = self.candidates(of);
        let found = candidates.iter().filter_map(|slot| read(&self.slots[*slot]));
        // An absent instance reads as zero.
        let absent = matches!(of, Subject::Slot(slot) if self.slots[slot].can_be_absent);
        let zero = absent.then(|| Interval::point(0.0));
        let values = Values::any(found.flat_map(|v| v.intervals().to_vec()).chain(zero));
        if !is_one {
            known().insert(key, values);
        }
        values
    }

    /// A position of an instance, restricted to the pinned part.
    fn in_part(&self, slot: SlotId, axis: usize, at: &Values) -> Values {
        match self.pinned {
            Some((pinned, Pinned::Part(_, part))) if pinned == slot => at.within(part[axis]),
            _ => *at,
        }
    }

    /// Whether others are read after the discrete phase.
    pub(super) fn is_within_step(&self) -> bool {
        self.phase != Phase::Discrete
    }

    /// The state of another instance after the discrete phase, if it is read then.
    pub(super) fn mid_step<'o>(&self, o: &'o Overall) -> Option<&'o MidStep> {
        self.is_within_step().then_some(&o.mid_step)
    }

    /// A variable of another instance.
    pub(super) fn var(&self, o: &Overall, var: VarId, degree: usize) -> Option<Values> {
        let mid_step = self.mid_step(o).and_then(|b| b.vars.get(var));
        Some(o.vars.get(var)?[degree].or(mid_step.map_or(&Values::none(), |v| &v[degree])))
    }

    pub(super) fn position(&self, of: Subject, axis: usize) -> Values {
        let at = |o: &Overall| self.var(o, VarId::XY[axis], 0);
        let part = Part::Var(VarId::XY[axis], 0, self.is_within_step());
        match of {
            Subject::Slot(slot) => self.read(of, part, |o| Some(self.in_part(slot, axis, &at(o)?))),
            _ => self.read(of, part, at),
        }
    }

    /// The configuration of a subject, if it is fixed.
    pub(super) fn configuration_of(&self, of: Subject) -> Option<&'a Configuration> {
        self.slot_and_configuration(of).map(|(_, at)| at)
    }

    fn slot_and_configuration(&self, of: Subject) -> Option<(SlotId, &'a Configuration)> {
        match (of, self.pinned) {
            (Subject::Me, _) => self.me,
            (Subject::Member(_), _) => self.me.filter(|(me, _)| self.member == Some(*me)),
            (Subject::Slot(slot), Some((pinned, Pinned::At(at)))) if pinned == slot => Some((slot, at)),
            _ => None,
        }
    }

    /// The boxes of a configuration in which one of its contact queries can hold.
    pub(super) fn touched(&self, slot: SlotId, id: TouchId, at: &Configuration) -> Option<Vec<[Interval; 2]>> {
        let mut boxes = self.surroundings.touched(slot, id, &self.entity(slot).touches[id], at)?;
        boxes.retain(|b| (0..2).all(|axis| !at.vars[VarId(axis)][0].within(b[axis as usize]).is_none()));
        Some(boxes)
    }

    /// The positions of a configuration at which one of its contact queries can fail, between steps; `None` if it holds at
    /// all of them.
    pub(super) fn untouched(&self, slot: SlotId, id: TouchId, at: &Configuration) -> Option<[Values; 2]> {
        let mut left = VarId::XY.map(|var| at.vars[var][0]);
        for sure in self.surroundings.surely_touched(slot, &self.entity(slot).touches[id], at) {
            for axis in 0..2 {
                let across = Values::from(sure[1 - axis]);
                if left[1 - axis].is_within(&across) {
                    let outside = [(f64::NEG_INFINITY, sure[axis].low), (sure[axis].high, f64::INFINITY)];
                    let outside = Values::any(outside.map(|(low, high)| Interval { low, high }));
                    let is_in = left[axis].is_within(&Values::from(sure[axis]));
                    left[axis] = if is_in { Values::none() } else { left[axis].and(&outside) };
                }
            }
        }
        (!left.iter().any(Values::is_none)).then_some(left)
    }

    fn has_player(&self) -> bool {
        self.me.is_some_and(|(me, _)| self.world.slots[me].player.is_some())
    }

    /// Evaluates a number.
    pub fn number(&self, id: ExprId) -> Values {
        let number = |id| self.number(id);
        match self.program.exprs[id] {
            Expr::Number(n) => Values::point(n),
            Expr::Frames(n) => Values::point(self.world.step.frames(n)),
            Expr::Param(Subject::Me, p) if self.me.is_some() => {
                let own = self.me.and_then(|(me, c)| c.params.get(p).or(self.slots[me].params.get(p)));
                own.copied().unwrap_or(Values::all())
            }
            Expr::Param(of, p) => match self.configuration_of(of).and_then(|c| c.params.get(p)) {
                Some(values) => *values,
                None => self.read(of, Part::Param(p), |o| o.params.get(p).cloned()),
            },
            Expr::Var(of, var, degree) => match self.configuration_of(of) {
                Some(c) => c.vars[var][usize::from(degree)],
                None if degree == 0 && var.is_position() => self.position(of, var.index()),
                None => {
                    let degree = usize::from(degree);
                    self.read(of, Part::Var(var, degree, self.is_within_step()), |o| self.var(o, var, degree))
                }
            },
            Expr::Discrete(of, id) => match self.configuration_of(of) {
                Some(c) => c.discretes[id],
                None => self.read(of, Part::Discrete(id, self.is_within_step()), |o| {
                    let mid_step = self.mid_step(o).and_then(|b| b.discretes.get(id));
                    Some(o.discretes.get(id)?.or(mid_step.unwrap_or(&Values::none())))
                }),
            },
            Expr::Sum(sum) => match self.me {
                Some((me, _)) => Values::from(self.received.sum(self.world.slots[me].entity, sum)),
                None => Values::all(),
            },
            Expr::Broken(tag) => Values::from(Interval { low: 0.0, high: breakable::most_broken(self.world, tag) }),
            Expr::Tiles(tag) => Values::from(breakable::number_of_tiles(self.world, tag)),
            Expr::Axis(_) if self.has_player() => Values::from(Interval { low: -1.0, high: 1.0 }),
            Expr::Axis(_) => Values::point(0.0),
            Expr::Chance(chance) => match self.me {
                // Each step draws anew, so nothing is known of it but its range.
                Some((me, _)) => {
                    let (low, high) = self.program.entities[self.world.slots[me].entity].chances[chance].range;
                    Values::from(Interval { low: f64::from(low), high: f64::from(high) })
                }
                None => Values::all(),
            },
            Expr::Timer(timer) => match self.me {
                Some((_, c)) => {
                    let step = self.world.step;
                    let count = c.timers[timer];
                    let time = |steps: f64| if steps.is_finite() { step.times(steps as u32) } else { steps };
                    Values::from(Interval { low: time(count.low), high: time(count.high) })
                }
                None => Values::all(),
            },
            Expr::Count { of, holds } => Values::from(self.count_members(of, holds)),
            Expr::Distance { of, x, y } => self.distance(of, x, y),
            Expr::Negate(a) => number(a).map(|i| i.map(|x| -x)),
            Expr::Arithmetic(op, a, b) => {
                let (a, b) = (number(a), number(b));
                match op {
                    Arithmetic::Add => a.pairs(&b, Interval::plus),
                    Arithmetic::Subtract => a.pairs(&b, Interval::minus),
                    Arithmetic::Multiply => a.pairs(&b, Interval::times),
                    Arithmetic::Divide => a.pairs(&b, |a, b| match b.contains(0.0) {
                        true => Interval::ALL,
                        false => a.corners(b, |a, b| a / b),
                    }),
                }
            }
            Expr::Call(Function::If, [condition, a, b]) => {
                let truth = self.truth(condition);
                let a = if truth.can_hold { number(a) } else { Values::none() };
                if truth.can_fail { a.or(&number(b)) } else { a }
            }
            Expr::Call(function, arguments) => self.call_values(function, arguments),
            _ => {
                let truth = self.truth(id);
                let ways = [(truth.can_hold, 1.0), (truth.can_fail, 0.0)];
                Values::any(ways.into_iter().filter(|(can, _)| *can).map(|(_, x)| Interval::point(x)))
            }
        }
    }

    fn call_values(&self, function: Function, arguments: [ExprId; 3]) -> Values {
        let [a, b, c] = arguments.map(|x| self.number(x));
        let f = |x: f64| call(function, [x, 0.0, 0.0]);
        let within = |low: f64, high: f64| Values::from(Interval { low, high });
        match function {
            Function::Min => a.pairs(&b, Interval::least),
            Function::Max => a.pairs(&b, Interval::greatest),
            Function::Clamp => a.pairs(&b, Interval::greatest).pairs(&c, Interval::least),
            Function::Abs => a.map(|i| match i.contains(0.0) {
                true => Interval { low: 0.0, high: i.high.greatest(-i.low) },
                false => i.map(f64::abs),
            }),
            Function::Sign | Function::Floor | Function::Ceil | Function::Round => {
                // A sign has three values, of which the ends of an interval show two.
                let zero = function == Function::Sign && a.contains(0.0);
                let found = a.map(|i| i.map(f));
                if zero { found.or(&Values::point(0.0)) } else { found }
            }
            Function::Sqrt => a.within(Interval { low: 0.0, high: f64::INFINITY }).map(|i| i.map(f)),
            Function::Sin | Function::Cos => match a.constant() {
                Some(x) => Values::point(f(x)),
                None => within(-1.0, 1.0),
            },
            Function::Atan2 => within(-4.0, 4.0),
            Function::Mod => a.pairs(&b, modulo),
            Function::If => Values::all(),
        }
    }

    /// Evaluates a guard.
    pub fn truth(&self, id: ExprId) -> Truth {
        match self.program.exprs[id] {
            Expr::Bool(b) => Truth::of(b),
            Expr::Compare(op, a, b) => compare_values(op, &self.number(a), &self.number(b)),
            Expr::And(a, b) => {
                let (a, b) = (self.truth(a), self.after(a).truth(b));
                Truth { can_hold: a.can_hold && b.can_hold, can_fail: a.can_fail || b.can_fail }
            }
            Expr::Or(a, b) => {
                let (a, b) = (self.truth(a), self.truth(b));
                Truth { can_hold: a.can_hold || b.can_hold, can_fail: a.can_fail && b.can_fail }
            }
            Expr::Not(a) => self.truth(a).not(),
            Expr::Button(..) => Truth { can_hold: self.has_player(), can_fail: true },
            // The contacts belong to the position before the move.
            Expr::Touching(Subject::Me, _) if self.phase == (Phase::Continuous { is_put: true }) => Truth::EITHER,
            Expr::Touching(of, touch) => {
                if let Some(boxes) =
                    self.slot_and_configuration(of).and_then(|(slot, at)| self.touched(slot, touch, at))
                {
                    let is_asked = of == Subject::Me && self.phase == Phase::Discrete && !boxes.is_empty();
                    let me = self.me.filter(|_| is_asked);
                    let can_fail = me.is_none_or(|(slot, at)| self.untouched(slot, touch, at).is_some());
                    return Truth { can_hold: !boxes.is_empty(), can_fail };
                }
                let can = |slot: &SlotId| {
                    let vars = self.configuration_of(of).map_or(&self.slots[*slot].vars, |c| &c.vars);
                    let places = self.surroundings.places(*slot, touch).iter().enumerate();
                    places
                        .zip(vars.iter())
                        .all(|((axis, places), [at, ..])| !self.in_part(*slot, axis, at).and(places).is_none())
                };
                Truth { can_hold: self.candidates(of).iter().any(can), can_fail: true }
            }
            Expr::Probe { .. } => self.probe(id),
            Expr::Alive(slot) if self.configuration_of(Subject::Slot(slot)).is_some() => Truth::of(true),
            Expr::Alive(slot) => {
                let Overall { can_live, can_be_absent, .. } = self.slots[slot];
                Truth { can_hold: can_live, can_fail: can_be_absent }
            }
            Expr::InMode(of, mode) => {
                let leaves = |slot: SlotId| self.entity(slot).modes[mode].leaves;
                if let Some((me, c)) = self.slot_and_configuration(of) {
                    return Truth::of(c.leaves.iter().any(|l| leaves(me).contains(*l)));
                }
                let of_mode = |slot: &SlotId| {
                    let o = &self.slots[*slot];
                    let Some(m) = self.entity(*slot).modes.get(mode) else { return false };
                    let any = |leaves: &BTreeSet<LeafId>| leaves.range(m.leaves.from..m.leaves.to).next().is_some();
                    any(&o.leaves) || self.mid_step(o).is_some_and(|b| any(&b.leaves))
                };
                let can_fail = !matches!(of, Subject::Member(_)) || !self.is_surely_in(mode);
                Truth { can_hold: self.candidates(of).iter().any(of_mode), can_fail }
            }
            Expr::InSpace(of, space) => {
                match (of, self.pinned) {
                    (Subject::Slot(slot), Some((pinned, Pinned::Part(here, _)))) if pinned == slot => {
                        return Truth::of(here == space);
                    }
                    (Subject::Slot(slot), Some((pinned, Pinned::At(at)))) if pinned == slot => {
                        let can_hold = at.spaces.contains(&space);
                        return Truth { can_hold, can_fail: !can_hold || at.spaces.len() > 1 };
                    }
                    _ => {}
                }
                let spaces = |slot: &SlotId| self.slots[*slot].spaces.contains(&space);
                Truth { can_hold: self.candidates(of).iter().any(spaces), can_fail: true }
            }
            Expr::Near { of, x, y, radius } => {
                let distance = self.distance(of, x, y);
                let found = compare_values(CompareOp::AtMost, &distance, &self.number(radius));
                Truth { can_hold: found.can_hold, can_fail: true }
            }
            Expr::Nearest { of, holds } => self.has_member(of, holds),
            Expr::Received(signal) => {
                let can = |me: SlotId| self.received.can_receive(self.world.slots[me].entity, signal);
                Truth { can_hold: self.me.is_none_or(|(me, _)| can(me)), can_fail: true }
            }
            Expr::Joint(..) | Expr::IsNone(_) | Expr::Is(..) => Truth::EITHER,
            _ => {
                let number = self.number(id);
                Truth { can_hold: number != Values::point(0.0), can_fail: number.contains(0.0) }
            }
        }
    }
}

/// The values of `mod(a, b)`.
fn modulo(a: Interval, b: Interval) -> Interval {
    // Before `b`: of whole numbers, one less.
    let all = Interval { low: b.low.next_up().least(0.0), high: b.high.next_down().greatest(0.0) };
    let period = b.low;
    let is_within_period = a.high - a.low < period.abs();
    if !b.is_point() || !is_within_period {
        return all;
    }
    let of = |x: f64| call(Function::Mod, [x, period, 0.0]);
    let ends = Interval { low: of(a.low), high: of(a.high) };
    if a.is_point() {
        return ends;
    }
    // The remainders of numbers of one sign are exact and grow within a period, so that both ends are in one.
    let is_one_sign = (a.low >= 0.0 || a.high < 0.0) && period > 0.0;
    let grows = a.low % period <= a.high % period && (a.high >= 0.0 || a.high % period != 0.0);
    if is_one_sign && grows && ends.low <= ends.high { ends } else { all }
}

fn compare_values(op: CompareOp, a: &Values, b: &Values) -> Truth {
    let (Some(x), Some(y)) = (a.hull(), b.hull()) else { return Truth { can_hold: false, can_fail: false } };
    match op {
        CompareOp::Less => Truth { can_hold: x.low < y.high, can_fail: x.high >= y.low },
        CompareOp::AtMost => Truth { can_hold: x.low <= y.high, can_fail: x.high > y.low },
        CompareOp::Greater => Truth { can_hold: x.high > y.low, can_fail: x.low <= y.high },
        CompareOp::AtLeast => Truth { can_hold: x.high >= y.low, can_fail: x.low < y.high },
        CompareOp::Equal => {
            let same = a.constant().is_some() && a.constant() == b.constant();
            Truth { can_hold: !a.and(b).is_none(), can_fail: !same }
        }
        CompareOp::Unequal => compare_values(CompareOp::Equal, a, b).not(),
    }
}
