//! The value of an expression; truth values are 0 and 1.

use hypedc::ir::{Arithmetic, CompareOp, Function, ModeId, Press, ProbeId, Side, Subject, TagId, TouchId};

use std::collections::BTreeSet;

use hypedc::sema::checked::{BoundProbe, Probe, Term, TermKind};

use super::model::{Along, Contact, Fault, Keys, Oracle, State, Thing};
use super::probe::Taken;
use super::step::Passing;

/// The context of an evaluation.
#[derive(Clone, Copy)]
pub struct Code<'a> {
    pub oracle: &'a Oracle<'a>,
    pub state: &'a State,
    /// The slot that the code runs for; none for code of the world.
    pub me: Option<usize>,
    /// The slot that a question to each instance asks.
    pub member: Option<usize>,
    pub keys: Option<(&'a Keys, &'a BTreeSet<u32>)>,
    /// The modes that were entered and those that were left in this step.
    pub joint: Option<(&'a BTreeSet<ModeId>, &'a BTreeSet<ModeId>)>,
    /// What came and went in this step, after its edges.
    pub passing: Option<&'a Passing>,
}

impl<'a> Code<'a> {
    fn my(&self) -> Option<&'a Thing> {
        self.state.things[self.me?].as_ref()
    }

    /// The slot of a subject, if it exists.
    pub fn slot(&self, of: Subject) -> Option<usize> {
        let slot = match of {
            Subject::Me => self.me?,
            Subject::Slot(slot) => slot.0 as usize,
            Subject::Ref(r) => self.my()?.refs[r.0 as usize]?,
            Subject::Touched(id) => self.touched(id)?,
            Subject::Probed(id) => self.probed(id)?,
            Subject::Member(_) => self.member?,
        };
        self.state.things[slot].is_some().then_some(slot)
    }

    fn of(&self, of: Subject) -> Result<&'a Thing, Fault> {
        let slot = self.slot(of).ok_or(Fault::ReadNone)?;
        self.state.things[slot].as_ref().ok_or(Fault::ReadNone)
    }

    /// The first instance, by its slot, that answers a contact query with a named result.
    pub fn touched(&self, id: TouchId) -> Option<usize> {
        let question = &self.oracle.entity(self.me?).bound[id];
        touching(self.my()?, question.mine, question.other, question.side).filter_map(|c| c.who).min()
    }

    /// The first instance, by its slot, that a probe with a named result finds.
    fn probed(&self, id: ProbeId) -> Option<usize> {
        match &self.oracle.entity(self.me?).probes[id] {
            BoundProbe::Place(asked, _) => match self.probe(&Probe { bound: Some(id), ..asked.clone() }) {
                Ok(Taken::ByInstance(slot)) => Some(slot),
                _ => None,
            },
            BoundProbe::Nearest(asked, _) => self.nearest(asked).ok()?,
        }
    }

    /// The space and the cell of the tile that a term names, where it names no instance.
    pub fn tile(&self, term: &Term) -> Option<(usize, usize)> {
        let space = self.my()?.space;
        match term.kind {
            TermKind::Instance(Subject::Touched(id)) if self.touched(id).is_none() => {
                Some((space, self.tile_touched(id)?))
            }
            TermKind::Instance(Subject::Probed(id)) => {
                let BoundProbe::Place(asked, _) = &self.oracle.entity(self.me?).probes[id] else { return None };
                match self.probe(&Probe { bound: Some(id), ..asked.clone() }) {
                    Ok(Taken::ByTile(cell)) => Some((space, cell)),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// The cell of the tile that a contact query with a named result keeps: the one with the longest edge, then the
    /// first.
    pub fn tile_touched(&self, id: TouchId) -> Option<usize> {
        let question = &self.oracle.entity(self.me?).bound[id];
        let all = touching(self.my()?, question.mine, question.other, question.side).filter_map(|c| c.tile);
        longest(all)
    }

    pub fn holds(&self, term: &Term) -> Result<bool, Fault> {
        Ok(self.value(term)? != 0.0)
    }

    /// The instance to which a term refers.
    pub fn instance(&self, term: &Term) -> Option<usize> {
        match &term.kind {
            TermKind::Instance(of) => self.slot(*of),
            _ => None,
        }
    }

    pub fn value(&self, term: &Term) -> Result<f64, Fault> {
        let truth = |b: bool| if b { 1.0 } else { 0.0 };
        let value = match &term.kind {
            TermKind::Number(n) => *n,
            TermKind::Quantity(quantity) => quantity.0,
            TermKind::Frames(n) => self.oracle.seconds(*n),
            TermKind::Bool(b) => truth(*b),
            TermKind::Param(of, id) => self.of(*of)?.params[id.0 as usize],
            TermKind::Var(of, id, degree) => self.of(*of)?.vars[id.0 as usize][usize::from(*degree)],
            TermKind::Discrete(of, id) => f64::from(self.of(*of)?.discretes[id.0 as usize]),
            TermKind::Axis(id) => self.keys.map_or(0.0, |(keys, _)| keys.axes[id.0 as usize]),
            TermKind::Chance(id) => f64::from(self.state.drawn[self.me.unwrap()][id.0 as usize]),
            TermKind::Timer(mode) => {
                let count = self.my().and_then(|me| me.timers.get(mode)).copied().unwrap_or(0);
                self.oracle.seconds(f64::from(count))
            }
            TermKind::Negate(a) => -self.value(a)?,
            TermKind::Arithmetic(op, sides) => {
                let [a, b] = sides.as_ref();
                let (a, b) = (self.value(a)?, self.value(b)?);
                match op {
                    Arithmetic::Add => a + b,
                    Arithmetic::Subtract => a - b,
                    Arithmetic::Multiply => a * b,
                    Arithmetic::Divide if b == 0.0 => return Err(Fault::DivisionByZero),
                    Arithmetic::Divide => a / b,
                }
            }
            TermKind::Call(called) => {
                let (function, arguments) = &**called;
                if *function == Function::If {
                    let branch = if self.holds(&arguments[0])? { 1 } else { 2 };
                    return self.value(&arguments[branch]);
                }
                let values: Vec<f64> = arguments.iter().map(|a| self.value(a)).collect::<Result<_, Fault>>()?;
                if *function == Function::Mod && values[1] == 0.0 {
                    return Err(Fault::DivisionByZero);
                }
                call(*function, &values)
            }
            TermKind::Compare(op, sides) => {
                let [a, b] = sides.as_ref();
                let (a, b) = (self.value(a)?, self.value(b)?);
                truth(match op {
                    CompareOp::Equal => a == b,
                    CompareOp::Unequal => a != b,
                    CompareOp::Less => a < b,
                    CompareOp::AtMost => a <= b,
                    CompareOp::Greater => a > b,
                    CompareOp::AtLeast => a >= b,
                })
            }
            TermKind::And(sides) => {
                let [a, b] = sides.as_ref();
                truth(self.holds(a)? && self.holds(b)?)
            }
            TermKind::Or(sides) => {
                let [a, b] = sides.as_ref();
                truth(self.holds(a)? || self.holds(b)?)
            }
            TermKind::Not(a) => truth(!self.holds(a)?),
            TermKind::Button(press, id) => truth(self.keys.is_some_and(|(keys, before)| {
                let (is, was) = (keys.held.contains(&id.0), before.contains(&id.0));
                match press {
                    Press::Pressed => is && !was,
                    Press::Held => is,
                    Press::Released => was && !is,
                }
            })),
            TermKind::Touching(asked) => {
                let thing = self.of(asked.of)?;
                let mut all = touching(thing, asked.mine, asked.other, asked.side);
                truth(all.any(|c| asked.bound.is_none() || c.who.is_some() || c.tile.is_some()))
            }
            TermKind::Probe(asked) => truth(self.probe(asked)? != Taken::Free),
            TermKind::Joint { mode, entering } => {
                truth(self.joint.is_some_and(|(entered, left)| if *entering { entered } else { left }.contains(mode)))
            }
            TermKind::Received(signal) => truth(self.my().is_some_and(|me| me.signals.contains_key(&signal.0))),
            TermKind::Sum(signal) => self.my().and_then(|me| me.signals.get(&signal.0)).copied().unwrap_or(0.0),
            TermKind::IsNone(of) => truth(self.slot(*of).is_none()),
            TermKind::Is(of, entity) => {
                truth(self.slot(*of).is_some_and(|slot| self.oracle.entity_id(slot) == *entity))
            }
            TermKind::Alive(slot) => truth(self.slot(Subject::Slot(*slot)).is_some()),
            TermKind::InMode(of, mode) => truth(self.of(*of).is_ok_and(|thing| thing.is_in(*mode))),
            TermKind::InSpace(of, space) => truth(self.of(*of).is_ok_and(|thing| thing.space == space.0 as usize)),
            TermKind::Count(of) => {
                let mut count = 0.0;
                for one in of.iter() {
                    count += truth(self.holds(one)?);
                }
                count
            }
            TermKind::Tiles(tag) => {
                let mut count = 0.0;
                for (number, space) in self.oracle.world.spaces.iter().enumerate() {
                    let map = space.map.iter();
                    for (cell, kind) in
                        map.flat_map(|map| map.cells.iter().map(|k| &map.kinds[usize::from(*k)])).enumerate()
                    {
                        let is_there = !self.state.broken.contains_key(&(number, cell));
                        count += truth(is_there && kind.tags.contains(tag));
                    }
                }
                count
            }
            TermKind::Members(asked) => self.count(asked)?,
            TermKind::Nearest(asked) => truth(self.nearest(asked)?.is_some()),
            TermKind::Distance(asked) => {
                let (of, [x, y]) = &**asked;
                self.distance(*of, x, y)?
            }
            TermKind::Near(asked) => {
                let (of, [x, y, radius]) = &**asked;
                match self.slot(*of) {
                    Some(_) => truth(self.distance(*of, x, y)? <= self.value(radius)?),
                    None => 0.0,
                }
            }
            TermKind::NoneRef | TermKind::Instance(_) => panic!("a reference is no number"),
        };
        if value.is_finite() { Ok(value) } else { Err(Fault::NotFinite) }
    }
}

/// The cell of the tile along which something lies longest, of equally long ones the first.
pub fn longest(all: impl Iterator<Item = Along>) -> Option<usize> {
    let mut best: Option<Along> = None;
    for Along { length, cell } in all {
        let wins = best.is_none_or(|best| length > best.length || (length == best.length && cell < best.cell));
        best = if wins { Some(Along { length, cell }) } else { best };
    }
    best.map(|best| best.cell)
}

/// The contacts that match a query.
pub fn touching(
    thing: &Thing,
    mine: Option<TagId>,
    other: TagId,
    side: Option<Side>,
) -> impl Iterator<Item = &Contact> {
    thing.contacts.iter().filter(move |c| {
        mine.is_none_or(|tag| c.mine.contains(&tag))
            && c.other.contains(&other)
            && side.is_none_or(|side| c.side == side)
    })
}

fn call(function: Function, arguments: &[f64]) -> f64 {
    let smaller = |a: f64, b: f64| if b < a { b } else { a };
    let larger = |a: f64, b: f64| if b > a { b } else { a };
    match (function, arguments) {
        (Function::Min, &[a, b]) => smaller(a, b),
        (Function::Max, &[a, b]) => larger(a, b),
        (Function::Abs, &[a]) => a.abs(),
        (Function::Sign, &[a]) => {
            if a > 0.0 {
                1.0
            } else if a < 0.0 {
                -1.0
            } else {
                0.0
            }
        }
        (Function::Clamp, &[a, low, high]) => smaller(larger(a, low), high),
        (Function::Floor, &[a]) => a.floor(),
        (Function::Ceil, &[a]) => a.ceil(),
        (Function::Round, &[a]) => a.round(),
        (Function::Sqrt, &[a]) => a.sqrt(),
        (Function::Sin, &[a]) => libm::sin(a),
        (Function::Cos, &[a]) => libm::cos(a),
        (Function::Atan2, &[y, x]) => libm::atan2(y, x),
        (Function::Mod, &[a, b]) => {
            // From 0 to before `b`, for an `a` of either sign.
            let rest = a % b;
            let inside = if rest != 0.0 && rest.signum() != b.signum() { rest + b } else { rest };
            if inside == b || inside == 0.0 { 0.0 } else { inside }
        }
        other => panic!("{other:?}"),
    }
}
