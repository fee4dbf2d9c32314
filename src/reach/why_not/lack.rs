//! What a goal lacks in a state: its parts, each with how far it is from holding. Searches ask this of every state, so
//! that the common parts (a variable against a number) are read directly, and nothing is allocated.

use crate::ir::{
    Arithmetic, CompareOp, Domain, Expr, ExprId, Extremes, Id, IdVec, ModeId, Program, SlotId, Subject, VarId, World,
    compare,
};
use crate::sim::Simulator;

use super::super::problem::Problem;
use super::approach::{Approach, is_free};
use super::contact::Contact;
use super::rooms::ways_to;
use super::unit::{Unit, unit_of};

/// What a part that is true or false counts as, in tiles of 16 px.
const TRUTH: f64 = 4.0;
/// What a room on the way counts as.
pub(super) const ROOM: f64 = 64.0;
/// What it counts as if an instance that a part is about is gone.
const GONE: f64 = 4096.0;
/// The least cost of what does not hold, where the distance is 0.
const LEAST: f64 = 1e-9;

/// A part of a goal.
#[derive(Debug)]
pub(super) enum Term {
    /// What `and`, `or` and `not` join.
    Atom(Atom),
    /// All of them are needed.
    All(Vec<Term>),
    /// One of them is enough.
    Any(Vec<Term>),
    /// It holds only while an instance is there.
    While(SlotId, Box<Term>),
    /// It also holds if an instance is not there.
    Unless(SlotId, Box<Term>),
}

/// A condition with the truth value that it needs.
#[derive(Debug)]
pub(super) struct Atom {
    /// The expression.
    pub id: ExprId,
    /// The truth value.
    pub wanted: bool,
    /// The instance whose guard it is part of; none of a predicate of the world.
    owner: Option<SlotId>,
    /// How far it is from that.
    pub gauge: Gauge,
    /// The unit of the distance.
    pub unit: Unit,
    /// What 1 of it counts as, in tiles.
    weight: f64,
}

/// How the distance of an atom is measured.
#[derive(Debug)]
pub(super) enum Gauge {
    /// A variable against a number.
    Var(SlotId, VarId, u8, CompareOp, f64),
    /// Two numbers, by how much one has to be beyond the other (1 if both are whole), and the way to the edges that change
    /// the first in its direction, if only edges do.
    Numbers(CompareOp, ExprId, ExprId, f64, Option<Approach>),
    /// A position against a circle: inside of it (true) or outside.
    Circle(SlotId, [ExprId; 3]),
    /// The gap between two bodies.
    Contact(Contact),
    /// The number of rooms to another one, by room; `u32::MAX` if no way is known.
    Room(SlotId, Vec<u32>),
    /// The number of edges to a mode.
    Mode(ModeId, Approach),
    /// The number of edges to a value of a discrete variable.
    Value(Approach),
    /// True or false.
    Truth,
    /// Of a guard, what inputs decide: it costs nothing.
    Free,
}

/// How far an atom is from holding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lack {
    /// Whether it holds.
    pub holds: bool,
    /// The distance in the atom's unit, where there is one; 0 if it holds, or at the limit.
    pub distance: Option<f64>,
    /// What it counts as, in tiles; 0 if it holds.
    pub cost: f64,
}

impl Lack {
    const NONE: Lack = Lack { holds: true, distance: Some(0.0), cost: 0.0 };

    fn truth(holds: bool) -> Lack {
        if holds { Lack::NONE } else { Lack { holds, distance: None, cost: TRUTH } }
    }

    fn by(holds: bool, distance: f64, unit: Unit) -> Lack {
        if holds {
            return Lack::NONE;
        }
        // What is no number is far away.
        let distance = if distance >= 0.0 { distance } else { f64::INFINITY };
        Lack { holds, distance: Some(distance), cost: LEAST + distance * unit.weight() }
    }

    pub(super) fn unmeasured(cost: f64) -> Lack {
        Lack { holds: false, distance: None, cost }
    }
}

/// The parts of a goal that all have to hold.
#[derive(Debug)]
pub(super) struct Parts {
    /// Each part; at least one.
    pub terms: Vec<Term>,
    /// The expression of each.
    pub ids: Vec<ExprId>,
}

impl Parts {
    /// Of the target of a question.
    pub fn new(problem: &Problem<'_>) -> Parts {
        Parts::of(problem, problem.predicate())
    }

    /// Of a predicate of the world.
    pub fn of(problem: &Problem<'_>, predicate: ExprId) -> Parts {
        Parts::owned_by(problem, None, predicate)
    }

    /// Of a guard of an instance.
    pub fn of_guard(problem: &Problem<'_>, slot: SlotId, guard: ExprId) -> Parts {
        Parts::owned_by(problem, Some(slot), guard)
    }

    fn owned_by(problem: &Problem<'_>, owner: Option<SlotId>, predicate: ExprId) -> Parts {
        let builder = Builder { problem, program: problem.sim.program(), world: problem.sim.world(), owner };
        let mut parts = Parts { terms: Vec::new(), ids: Vec::new() };
        builder.split(predicate, &mut Vec::new(), &mut parts);
        parts
    }
}

impl Term {
    /// What it lacks in a state, in tiles. What is known to be at least `limit` need not be exact.
    #[inline]
    pub fn cost(&self, sim: &Simulator, state: &[u8], limit: f64) -> f64 {
        match self {
            Term::Atom(atom) => atom.cost(sim, state, limit),
            Term::While(slot, inner) => {
                if sim.world().layout.slots[*slot].alive(state) {
                    inner.cost(sim, state, limit)
                } else {
                    GONE
                }
            }
            Term::Unless(slot, inner) => {
                if sim.world().layout.slots[*slot].alive(state) {
                    inner.cost(sim, state, limit)
                } else {
                    0.0
                }
            }
            Term::All(terms) => terms.iter().map(|term| term.cost(sim, state, limit)).sum(),
            Term::Any(terms) => terms.iter().map(|term| term.cost(sim, state, limit)).fold(f64::INFINITY, f64::least),
        }
    }
}

impl Term {
    /// Moves out its atoms, each with the instance that it needs.
    pub fn into_atoms(self, needed: Option<SlotId>, out: &mut Vec<(Option<SlotId>, Atom)>) {
        match self {
            Term::Atom(atom) => out.push((needed, atom)),
            Term::While(slot, inner) | Term::Unless(slot, inner) => inner.into_atoms(Some(slot), out),
            Term::All(terms) | Term::Any(terms) => terms.into_iter().for_each(|term| term.into_atoms(needed, out)),
        }
    }

    /// Its atoms.
    pub fn atoms<'t>(&'t self, out: &mut Vec<&'t Atom>) {
        match self {
            Term::Atom(atom) => out.push(atom),
            Term::While(_, inner) | Term::Unless(_, inner) => inner.atoms(out),
            Term::All(terms) | Term::Any(terms) => terms.iter().for_each(|term| term.atoms(out)),
        }
    }
}

impl Atom {
    /// As the cost of [`Atom::lack`].
    #[inline(always)]
    pub fn cost(&self, sim: &Simulator, state: &[u8], limit: f64) -> f64 {
        if let Gauge::Var(slot, var, degree, op, bound) = &self.gauge {
            let value = sim.world().layout.slots[*slot].var(state, *var, *degree);
            return if compare(*op, value, *bound) { 0.0 } else { LEAST + (value - bound).abs() * self.weight };
        }
        self.lack(sim, state, limit).cost
    }

    /// What it lacks in a state. What is known to cost at least `limit` need not be exact.
    #[inline(never)]
    pub fn lack(&self, sim: &Simulator, state: &[u8], limit: f64) -> Lack {
        let number = |id| match self.owner {
            None => sim.number(state, id),
            Some(slot) => sim.own_number(state, slot, id),
        };
        let truth = || number(self.id).map(|value| (value != 0.0) == self.wanted);
        // What cannot be computed holds nowhere; in a guard, what it reads is not there.
        let lack = match &self.gauge {
            Gauge::Var(slot, var, degree, op, bound) => {
                let value = sim.world().layout.slots[*slot].var(state, *var, *degree);
                Ok(Lack::by(compare(*op, value, *bound), (value - bound).abs(), self.unit))
            }
            Gauge::Numbers(op, a, b, beyond, approach) => number(*a).and_then(|a| {
                let b = number(*b)?;
                let lack = Lack::by(compare(*op, a, b), (a - b).abs() + beyond, self.unit);
                let bonus = approach.as_ref().filter(|_| !lack.holds).map_or(0.0, |way| way.bonus(sim, state));
                Ok(Lack { cost: lack.cost - bonus, ..lack })
            }),
            Gauge::Circle(slot, [x, y, radius]) => number(*x).and_then(|x| {
                let (y, radius) = (number(*y)?, number(*radius)?);
                let away = sim.distance(state, *slot, (x, y));
                Ok(Lack::by(truth()?, (away - radius).abs(), self.unit))
            }),
            Gauge::Contact(contact) => truth().map(|holds| match holds {
                true => Lack::NONE,
                false => contact.lack(sim, state, limit, self.unit),
            }),
            Gauge::Room(slot, ways) => truth().map(|holds| {
                let away = ways.get(sim.space(state, *slot).index()).copied().unwrap_or(u32::MAX);
                match (holds, away) {
                    (true, _) => Lack::NONE,
                    (false, u32::MAX) => Lack::unmeasured(ROOM * 8.0),
                    (false, _) => Lack { holds, distance: Some(f64::from(away)), cost: f64::from(away) * ROOM },
                }
            }),
            Gauge::Mode(_, approach) | Gauge::Value(approach) => truth().map(|holds| {
                if holds {
                    return Lack::NONE;
                }
                match approach.left(sim, state) {
                    None => Lack::unmeasured(2.0 * TRUTH),
                    Some((edges, cost)) => Lack { holds, distance: Some(f64::from(edges)), cost: TRUTH - 1.0 + cost },
                }
            }),
            Gauge::Truth => truth().map(Lack::truth),
            Gauge::Free => Ok(Lack::NONE),
        };
        lack.unwrap_or(Lack::unmeasured(if self.owner.is_none() { f64::INFINITY } else { TRUTH }))
    }
}

struct Builder<'a> {
    problem: &'a Problem<'a>,
    program: &'a Program,
    world: &'a World,
    /// The instance whose guard it is.
    owner: Option<SlotId>,
}

impl Builder<'_> {
    /// Splits what `and` joins.
    fn split(&self, id: ExprId, guards: &mut Vec<SlotId>, out: &mut Parts) {
        if let Expr::And(a, b) = self.program.exprs[id] {
            if let Expr::Alive(slot) = self.program.exprs[a] {
                guards.push(slot);
                self.split(b, guards, out);
                guards.pop();
                return;
            }
            self.split(a, guards, out);
            self.split(b, guards, out);
            return;
        }
        let guard = |term, slot: &SlotId| Term::While(*slot, Box::new(term));
        out.terms.push(guards.iter().rev().fold(self.term(id, true), guard));
        out.ids.push(id);
    }

    fn term(&self, id: ExprId, wanted: bool) -> Term {
        let both = |a, b, is_all: bool| {
            let mut terms = Vec::new();
            for term in [self.term(a, wanted), self.term(b, wanted)] {
                match (term, is_all) {
                    (Term::All(inner), true) | (Term::Any(inner), false) => terms.extend(inner),
                    (term, _) => terms.push(term),
                }
            }
            if is_all { Term::All(terms) } else { Term::Any(terms) }
        };
        match self.program.exprs[id] {
            Expr::Not(a) => self.term(a, !wanted),
            Expr::And(a, b) => match self.program.exprs[a] {
                Expr::Alive(slot) if wanted => Term::While(slot, Box::new(self.term(b, wanted))),
                Expr::Alive(slot) => Term::Unless(slot, Box::new(self.term(b, wanted))),
                _ => both(a, b, wanted),
            },
            Expr::Or(a, b) => both(a, b, !wanted),
            _ => {
                let (gauge, unit) = self.gauge(id, wanted);
                Term::Atom(Atom { id, wanted, owner: self.owner, gauge, unit, weight: unit.weight() })
            }
        }
    }

    fn gauge(&self, id: ExprId, wanted: bool) -> (Gauge, Unit) {
        let unmeasured = (Gauge::Truth, Unit::NONE);
        if self.owner.is_some() && is_free(self.problem, id) {
            return (Gauge::Free, Unit::NONE);
        }
        match self.program.exprs[id] {
            Expr::Compare(op, a, b) => {
                let op = if wanted { op } else { op.negated() };
                let unit = unit_of(self.program, a).or(unit_of(self.program, b));
                if self.is_named(a) || self.is_named(b) {
                    let value = match op {
                        CompareOp::Equal => self.constant(b).map(|b| (a, b)).or(self.constant(a).map(|a| (b, a))),
                        _ => None,
                    };
                    return value.and_then(|(a, value)| self.value(a, value)).unwrap_or(unmeasured);
                }
                if op == CompareOp::Unequal {
                    return unmeasured;
                }
                let gauge = match (self.variable(a), self.constant(b), self.variable(b), self.constant(a)) {
                    (Some((slot, var, degree)), Some(bound), ..) => Gauge::Var(slot, var, degree, op, bound),
                    (_, _, Some((slot, var, degree)), Some(bound)) => {
                        Gauge::Var(slot, var, degree, op.mirrored(), bound)
                    }
                    _ => {
                        let is_strict = matches!(op, CompareOp::Less | CompareOp::Greater);
                        let is_whole = is_strict && self.is_whole(a) && self.is_whole(b);
                        let approach = self.change(op, a, b).or_else(|| self.change(op.mirrored(), b, a));
                        Gauge::Numbers(op, a, b, f64::from(u8::from(is_whole)), approach)
                    }
                };
                (gauge, unit)
            }
            Expr::Near { of, x, y, radius } => match self.slot(of) {
                Some(slot) => (Gauge::Circle(slot, [x, y, radius]), Unit::PX),
                None => unmeasured,
            },
            Expr::Touching(of, touch) if wanted => {
                match self.slot(of).and_then(|slot| Contact::new(self.problem, slot, touch)) {
                    Some(contact) => (Gauge::Contact(contact), Unit::PX),
                    None => unmeasured,
                }
            }
            Expr::InSpace(Subject::Slot(slot), space) if wanted => {
                (Gauge::Room(slot, ways_to(self.world, |id| id == space)), Unit::ROOMS)
            }
            // Of what a guard asks of modes, the guards are not looked at in turn.
            Expr::InMode(Subject::Slot(slot), mode) if wanted && self.owner.is_none() => {
                (Gauge::Mode(mode, Approach::to_mode(self.problem, slot, mode)), Unit::EDGES)
            }
            Expr::Discrete(..) => self.value(id, f64::from(u8::from(wanted))).unwrap_or(unmeasured),
            _ => unmeasured,
        }
    }

    /// Whose instance it is, if that is always the same.
    fn slot(&self, subject: Subject) -> Option<SlotId> {
        match subject {
            Subject::Slot(slot) => Some(slot),
            Subject::Me => self.owner,
            _ => None,
        }
    }

    /// How far a discrete variable is from a value with a name, or from true or false.
    fn value(&self, id: ExprId, value: f64) -> Option<(Gauge, Unit)> {
        let Expr::Discrete(Subject::Slot(slot), discrete) = self.program.exprs[id] else { return None };
        let approach = self.owner.is_none().then(|| Approach::to_value(self.problem, slot, discrete, value))?;
        Some((Gauge::Value(approach?), Unit::EDGES))
    }

    /// How near a whole number that has to be above or below a constant is to a change in that direction.
    fn change(&self, op: CompareOp, id: ExprId, bound: ExprId) -> Option<Approach> {
        let Expr::Discrete(Subject::Slot(slot), discrete) = self.program.exprs[id] else { return None };
        let upwards = match op {
            CompareOp::Greater | CompareOp::AtLeast => true,
            CompareOp::Less | CompareOp::AtMost => false,
            CompareOp::Equal | CompareOp::Unequal => return None,
        };
        // Of a guard, the guards are not looked at in turn.
        (self.owner.is_none() && self.constant(bound).is_some())
            .then(|| Approach::to_change(self.problem, slot, discrete, upwards))?
    }

    /// Whether it is a value with a name, or true or false: such values are not near each other.
    fn is_named(&self, id: ExprId) -> bool {
        let Expr::Discrete(of, discrete) = self.program.exprs[id] else { return false };
        let Some(slot) = self.slot(of) else { return false };
        let entity = &self.program.entities[self.world.slots[slot].entity];
        !matches!(entity.discretes[discrete].domain, Domain::Int)
    }

    /// Whether its values are whole numbers.
    fn is_whole(&self, id: ExprId) -> bool {
        match self.program.exprs[id] {
            Expr::Number(number) => number.fract() == 0.0,
            Expr::Discrete(..) | Expr::Broken(_) | Expr::Tiles(_) | Expr::Count { .. } => true,
            Expr::Bool(_) | Expr::And(..) | Expr::Or(..) | Expr::Not(_) | Expr::Compare(..) => true,
            Expr::Alive(_) | Expr::InMode(..) | Expr::InSpace(..) | Expr::Touching(..) | Expr::Near { .. } => true,
            Expr::Negate(a) => self.is_whole(a),
            Expr::Arithmetic(Arithmetic::Divide, ..) => false,
            Expr::Arithmetic(_, a, b) => self.is_whole(a) && self.is_whole(b),
            _ => false,
        }
    }

    fn variable(&self, id: ExprId) -> Option<(SlotId, VarId, u8)> {
        match self.program.exprs[id] {
            Expr::Var(of, var, degree) => self.slot(of).map(|slot| (slot, var, degree)),
            _ => None,
        }
    }

    fn constant(&self, id: ExprId) -> Option<f64> {
        self.program.constant(id, &IdVec::new(), self.world.step)
    }
}
