//! Dimensions: every number is `px^i · s^j`, inferred from all its uses, never required.
//!
//! Exponents are unknowns of linear equations, solved one by one as uses are met (unification in an Abelian group;
//! Kennedy, *Programming Languages and Dimensions*, 1996). A literal takes the dimension that its place needs; as a
//! factor beside anything else it is a pure number.

mod report;

use crate::ir::{Arithmetic, EntityId, Function, ParamId, Place, SlotId, Subject, VarId};

use std::collections::BTreeMap;

use crate::diagnostic::Diagnostics;
use crate::source::{SourceMap, Span};

use super::checked::{Action, By, Checked, DriveBy, Entity, Given, Rate, Release, Term, TermKind, World};

/// A fraction in lowest terms with a positive denominator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Ratio(i64, i64);

impl Ratio {
    const ZERO: Ratio = Ratio(0, 1);
    const ONE: Ratio = Ratio(1, 1);

    fn new(n: i64, d: i64) -> Ratio {
        let (mut a, mut b) = (n.unsigned_abs(), d.unsigned_abs());
        while b != 0 {
            (a, b) = (b, a % b);
        }
        let g = (a.max(1) as i64) * d.signum();
        Ratio(n / g, d / g)
    }
    /// None if it cannot be told exactly.
    fn plus(self, o: Ratio) -> Option<Ratio> {
        let sum = self.0.checked_mul(o.1)?.checked_add(o.0.checked_mul(self.1)?)?;
        Ratio::checked(sum, self.1.checked_mul(o.1)?)
    }
    /// None if it cannot be told exactly.
    fn times(self, o: Ratio) -> Option<Ratio> {
        Ratio::checked(self.0.checked_mul(o.0)?, self.1.checked_mul(o.1)?)
    }
    /// Every number of a ratio has its negative.
    fn checked(n: i64, d: i64) -> Option<Ratio> {
        (n != i64::MIN && d != i64::MIN).then(|| Ratio::new(n, d))
    }
}

type Unknown = usize;

/// A dimension: known exponents plus multiples of unknown dimensions.
#[derive(Debug, Clone, PartialEq)]
struct Dim {
    px: Ratio,
    s: Ratio,
    unknowns: BTreeMap<Unknown, Ratio>,
    /// Whether an exponent grew beyond what can be told exactly: then nothing is known of it.
    is_lost: bool,
}

impl Dim {
    fn known(px: i64, s: i64) -> Dim {
        Dim { px: Ratio(px, 1), s: Ratio(s, 1), unknowns: BTreeMap::new(), is_lost: false }
    }
    fn unknown(u: Unknown) -> Dim {
        Dim { unknowns: BTreeMap::from([(u, Ratio::ONE)]), ..Dim::known(0, 0) }
    }
    fn plus(mut self, other: &Dim, factor: Ratio) -> Dim {
        self.add(other, factor);
        self
    }
    fn add(&mut self, other: &Dim, factor: Ratio) {
        if self.try_add(other, factor).is_none() {
            *self = Dim { is_lost: true, ..Dim::known(0, 0) };
        }
    }
    /// None if an exponent cannot be told exactly; then what is there is no sum.
    fn try_add(&mut self, other: &Dim, factor: Ratio) -> Option<()> {
        if self.is_lost || other.is_lost {
            return None;
        }
        self.px = self.px.plus(other.px.times(factor)?)?;
        self.s = self.s.plus(other.s.times(factor)?)?;
        for (u, r) in &other.unknowns {
            let sum = self.unknowns.get(u).copied().unwrap_or(Ratio::ZERO).plus(r.times(factor)?)?;
            if sum == Ratio::ZERO {
                self.unknowns.remove(u);
            } else {
                self.unknowns.insert(*u, sum);
            }
        }
        Some(())
    }
    fn words(&self) -> String {
        let part = |unit: &str, r: Ratio| match (r.0, r.1) {
            (1, 1) => unit.to_string(),
            (n, 1) => format!("{unit}^{n}"),
            (n, d) => format!("{unit}^({n}/{d})"),
        };
        let negative = |r: Ratio| Ratio(-r.0, r.1);
        let mut top: Vec<String> = Vec::new();
        let mut bottom: Vec<String> = Vec::new();
        for (unit, r) in [("px", self.px), ("s", self.s)] {
            match r.0.signum() {
                1 => top.push(part(unit, r)),
                -1 => bottom.push(part(unit, negative(r))),
                _ => {}
            }
        }
        let top = if top.is_empty() { "1".to_string() } else { top.join("*") };
        if bottom.is_empty() { top } else { format!("{top}/{}", bottom.join("/")) }
    }
}

const TIME: (i64, i64) = (0, 1);
const LENGTH: (i64, i64) = (1, 0);

/// Checks all entities and worlds of a program that is otherwise right.
/// Returns what it found of parameters and variables.
pub(super) fn check(program: &Checked, sources: &SourceMap, diagnostics: &mut Diagnostics) -> Dimensions {
    let mut solver = Solver {
        program,
        solved: Vec::new(),
        named: BTreeMap::new(),
        conflicts: Vec::new(),
        envelope: None,
        roots: Vec::new(),
    };
    for (id, entity) in program.entities.pairs() {
        solver.entity(id, entity);
    }
    for world in program.worlds.iter() {
        solver.world(world);
        for question in world.goals.iter().chain(world.nevers.iter()) {
            let entity_of = |slot: SlotId| world.instances[slot].entity;
            solver.dimension(&question.predicate, &Here { me: None, entity_of: &entity_of });
        }
        for guard in world.spaces.iter().flat_map(|s| &s.links).filter_map(|l| l.guard.as_ref()) {
            let entity_of = |slot: SlotId| world.instances[slot].entity;
            solver.dimension(guard, &Here { me: None, entity_of: &entity_of });
        }
    }
    let found = solver.found();
    solver.report(sources, diagnostics);
    found
}

/// The dimensions of parameters and variables, as one writes them: `px/s^2`.
#[derive(Debug, Clone, Default)]
pub struct Dimensions {
    /// Those of parameters that follow from how they are used.
    pub params: BTreeMap<(EntityId, ParamId), String>,
    /// Those of continuous variables.
    pub vars: BTreeMap<(EntityId, VarId), String>,
}

/// Whose variables a term reads.
struct Here<'a> {
    me: Option<EntityId>,
    entity_of: &'a dyn Fn(SlotId) -> EntityId,
}

/// A name with an unknown dimension.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Named {
    Param(EntityId, ParamId),
    Var(EntityId, VarId),
}

/// Where a term is whose dimension does not fit.
#[derive(Debug, Clone)]
enum Beside {
    /// In a place that asks for a dimension.
    Place,
    /// Beside another term: what is done with both.
    Term(Term, Joint),
    /// It is driven by the envelope that drives the first of its variables.
    Driven { first: VarId, other: VarId, degree: u8 },
}

/// What asks for one dimension of two terms.
#[derive(Debug, Clone, Copy)]
enum Joint {
    Added,
    Subtracted,
    Compared,
    Given(Function),
}

struct Conflict {
    entity: Option<EntityId>,
    term: Term,
    needed: Dim,
    found: Dim,
    beside: Beside,
    /// The envelope that holds the place.
    envelope: Option<Span>,
}

struct Solver<'p> {
    program: &'p Checked,
    /// Of each unknown: its solution, and the use that gave it.
    solved: Vec<Option<(Dim, Span)>>,
    named: BTreeMap<Named, Unknown>,
    conflicts: Vec<Conflict>,
    /// The envelope whose terms are examined.
    envelope: Option<Span>,
    /// Of each square root: its dimension and what it is taken of.
    roots: Vec<(Dim, Term)>,
}

impl Solver<'_> {
    /// What is known in the end.
    fn found(&mut self) -> Dimensions {
        let mut out = Dimensions::default();
        for (name, unknown) in self.named.clone() {
            let dim = self.reduce(&Dim::unknown(unknown));
            if dim.is_lost || !dim.unknowns.is_empty() {
                continue;
            }
            match name {
                Named::Param(entity, id) => out.params.insert((entity, id), dim.words()),
                Named::Var(entity, id) => out.vars.insert((entity, id), dim.words()),
            };
        }
        out
    }

    fn fresh(&mut self) -> Unknown {
        self.solved.push(None);
        self.solved.len() - 1
    }

    fn name(&mut self, name: Named) -> Dim {
        if let Named::Var(_, var) = name
            && var <= VarId::Y
        {
            return Dim::known(1, 0);
        }
        if let Some(&u) = self.named.get(&name) {
            return Dim::unknown(u);
        }
        let u = self.fresh();
        self.named.insert(name, u);
        let annotation = match name {
            Named::Param(e, p) => self.program.entities[e].params[p].dimension,
            Named::Var(e, v) => self.program.entities[e].vars[v].dimension,
        };
        if let Some(a) = annotation {
            self.solved[u] = Some((Dim::known(i64::from(a.px), i64::from(a.s)), a.span));
        }
        Dim::unknown(u)
    }

    /// A dimension without the unknowns that are solved.
    fn reduce(&mut self, dim: &Dim) -> Dim {
        self.settle(dim);
        self.put_in(dim)
    }

    /// Puts in what is known of the unknowns of a dimension, itself not to be reduced any further.
    fn put_in(&self, dim: &Dim) -> Dim {
        let mut out = Dim { unknowns: BTreeMap::new(), ..dim.clone() };
        for (u, r) in &dim.unknowns {
            match &self.solved[*u] {
                Some((solution, _)) => out.add(solution, *r),
                None => out.add(&Dim::unknown(*u), *r),
            }
        }
        out
    }

    /// Reduces the solutions that a dimension needs, innermost first and each once: a chain of them may be long.
    fn settle(&mut self, dim: &Dim) {
        let mut open: Vec<(Unknown, bool)> = dim.unknowns.keys().map(|u| (*u, false)).collect();
        while let Some((u, inner_done)) = open.pop() {
            let Some((solution, at)) = &self.solved[u] else { continue };
            if solution.unknowns.keys().all(|v| self.solved[*v].is_none()) {
                continue;
            }
            if inner_done {
                self.solved[u] = Some((self.put_in(solution), *at));
            } else {
                open.push((u, true));
                open.extend(solution.unknowns.keys().map(|v| (*v, false)));
            }
        }
    }

    /// Makes `found`, the dimension of `term`, equal to what its place needs.
    fn need(&mut self, term: &Term, found: &Dim, needed: &Dim, beside: Beside, here: &Here<'_>) {
        let difference = self.reduce(found).plus(&self.reduce(needed), Ratio(-1, 1));
        // The unknown that is alone is the one that this use determines.
        let pick =
            difference.unknowns.iter().max_by_key(|(u, _)| found.unknowns.contains_key(*u)).map(|(u, r)| (*u, *r));
        match pick {
            Some((u, r)) => {
                let rest = difference.plus(&Dim::unknown(u), Ratio(-r.0, r.1));
                let solution = Dim::known(0, 0).plus(&rest, Ratio::new(-r.1, r.0));
                if !solution.is_lost {
                    self.solved[u] = Some((solution, term.span));
                }
            }
            None if difference.px != Ratio::ZERO || difference.s != Ratio::ZERO => {
                let (needed, found) = (self.reduce(needed), self.reduce(found));
                self.conflicts.push(Conflict {
                    entity: here.me,
                    term: term.clone(),
                    needed,
                    found,
                    beside,
                    envelope: self.envelope,
                });
            }
            None => {}
        }
    }

    /// The default of a parameter: what it is given is the first that is known of it. Of several unknowns none is solved
    /// by it: products of products would grow.
    fn is_given(&mut self, term: &Term, found: &Dim, needed: &Dim, here: &Here<'_>) {
        let own = needed.unknowns.keys().next().copied().filter(|u| self.solved[*u].is_none());
        let found = self.reduce(found);
        match own {
            Some(own) if found.unknowns.len() > 1 && !found.unknowns.contains_key(&own) => {
                self.solved[own] = Some((found, term.span))
            }
            _ => self.need(term, &found, needed, Beside::Place, here),
        }
    }

    /// A term in a place of known dimension.
    fn place(&mut self, term: &Term, needed: &Dim, here: &Here<'_>) {
        if let Some(found) = self.dimension(term, here) {
            self.need(term, &found, needed, Beside::Place, here);
        }
    }

    /// Terms that must agree; returns their common dimension, none if all are literals.
    fn agree(&mut self, terms: &[&Term], joint: Joint, here: &Here<'_>) -> Option<Dim> {
        let mut common: Option<(Dim, &Term)> = None;
        for term in terms {
            let Some(found) = self.dimension(term, here) else {
                continue;
            };
            match &common {
                Some((needed, first)) => {
                    self.need(term, &found, needed, Beside::Term((*first).clone(), joint), here);
                }
                None => common = Some((found, term)),
            }
        }
        common.map(|(dim, _)| dim)
    }

    /// The dimension of a term; none for literals, which fit everywhere.
    fn dimension(&mut self, term: &Term, here: &Here<'_>) -> Option<Dim> {
        let entity = |of: Subject| match of {
            Subject::Me => here.me,
            Subject::Slot(slot) => Some((here.entity_of)(slot)),
            Subject::Ref(id) => here.me.and_then(|me| self.program.entities[me].refs[id].entity),
            Subject::Touched(_) => None,
        };
        match &term.kind {
            TermKind::Number(_) | TermKind::Bool(_) => None,
            TermKind::Quantity(quantity) => Some(Dim::known(i64::from(quantity.1), i64::from(quantity.2))),
            TermKind::Frames(_) | TermKind::Timer(_) => Some(Dim::known(TIME.0, TIME.1)),
            TermKind::Param(of, p) => Some(self.name(Named::Param(entity(*of)?, *p))),
            TermKind::Var(of, var, degree) => {
                let base = match entity(*of) {
                    Some(entity) => self.name(Named::Var(entity, *var)),
                    None if *var <= VarId::Y => Dim::known(LENGTH.0, LENGTH.1),
                    None => return None,
                };
                Some(base.plus(&Dim::known(0, -i64::from(*degree)), Ratio::ONE))
            }
            TermKind::Discrete(..) | TermKind::Axis(_) => Some(Dim::known(0, 0)),
            TermKind::Negate(a) => self.dimension(a, here),
            TermKind::Arithmetic(Arithmetic::Add, sides) => {
                let [a, b] = sides.as_ref();
                self.agree(&[a, b], Joint::Added, here)
            }
            TermKind::Arithmetic(Arithmetic::Subtract, sides) => {
                let [a, b] = sides.as_ref();
                self.agree(&[a, b], Joint::Subtracted, here)
            }
            TermKind::Arithmetic(op, sides) => {
                let [a, b] = sides.as_ref();
                let sign = if *op == Arithmetic::Divide { Ratio(-1, 1) } else { Ratio::ONE };
                let (a, b) = (self.dimension(a, here), self.dimension(b, here));
                if a.is_none() && b.is_none() {
                    return None;
                }
                let pure = Dim::known(0, 0);
                Some(a.unwrap_or(pure.clone()).plus(&b.unwrap_or(pure), sign))
            }
            TermKind::Call(call) => {
                let (function, args) = call.as_ref();
                let args: Vec<&Term> = args.iter().collect();
                match (function, args.as_slice()) {
                    (Function::If, [condition, values @ ..]) => {
                        self.dimension(condition, here);
                        self.agree(values, Joint::Given(*function), here)
                    }
                    (Function::Sign | Function::Atan2, _) => {
                        self.agree(&args, Joint::Given(*function), here);
                        Some(Dim::known(0, 0))
                    }
                    (Function::Sin | Function::Cos, [angle]) => {
                        self.place(angle, &Dim::known(0, 0), here);
                        Some(Dim::known(0, 0))
                    }
                    (Function::Sqrt, [a]) => {
                        let square = self.dimension(a, here)?;
                        let root = Dim::unknown(self.fresh());
                        let twice = Dim::known(0, 0).plus(&root, Ratio(2, 1));
                        self.need(a, &twice, &square, Beside::Place, here);
                        self.roots.push((root.clone(), (*a).clone()));
                        Some(root)
                    }
                    _ => self.agree(&args, Joint::Given(*function), here),
                }
            }
            TermKind::Compare(_, sides) => {
                let [a, b] = sides.as_ref();
                self.agree(&[a, b], Joint::Compared, here);
                None
            }
            TermKind::And(sides) | TermKind::Or(sides) => {
                for side in sides.iter() {
                    self.dimension(side, here);
                }
                None
            }
            TermKind::Not(a) => {
                self.dimension(a, here);
                None
            }
            TermKind::Near(asked) => {
                for term in &asked.1 {
                    self.place(term, &Dim::known(LENGTH.0, LENGTH.1), here);
                }
                None
            }
            TermKind::Button(..)
            | TermKind::Touching(_)
            | TermKind::Joint { .. }
            | TermKind::IsNone(_)
            | TermKind::Is(..)
            | TermKind::Alive(_)
            | TermKind::NoneRef
            | TermKind::Instance(_)
            | TermKind::InMode(..)
            | TermKind::InSpace(..) => None,
        }
    }

    fn world(&mut self, world: &World) {
        let length = Dim::known(LENGTH.0, LENGTH.1);
        let nobody = Here { me: None, entity_of: &|_| EntityId(0) };
        for side in &world.lengths {
            self.place(side, &length, &nobody);
        }
        for instance in world.instances.iter() {
            let id = instance.entity;
            let here = Here { me: Some(id), entity_of: &|_| id };
            self.given(id, &instance.given, &here);
        }
    }

    /// What is given to an instance of an entity; the terms are those of `here`.
    fn given(&mut self, id: EntityId, given: &[(Given, Term)], here: &Here<'_>) {
        for (what, term) in given {
            let needed = match *what {
                Given::Param(param) => self.name(Named::Param(id, param)),
                Given::Var(var, degree) => self.derivative(id, var, degree),
                Given::Discrete(_) => Dim::known(0, 0),
                Given::Ref(_) => continue,
            };
            self.place(term, &needed, here);
        }
    }

    /// The dimension of a variable or one of its derivatives.
    fn derivative(&mut self, id: EntityId, var: VarId, degree: u8) -> Dim {
        self.name(Named::Var(id, var)).plus(&Dim::known(0, -i64::from(degree)), Ratio::ONE)
    }

    fn entity(&mut self, id: EntityId, entity: &Entity) {
        let here = Here { me: Some(id), entity_of: &|_| id };
        let of_var = |this: &mut Self, var: VarId, degree: u8| this.derivative(id, var, degree);
        let length = Dim::known(LENGTH.0, LENGTH.1);
        let time = Dim::known(TIME.0, TIME.1);
        let updates = |this: &mut Self, actions: &[Action]| {
            for action in actions {
                match action {
                    Action::Update(update) => match update.place {
                        Place::Var(var, degree) => {
                            let needed = of_var(this, var, degree);
                            this.place(&update.value, &needed, &here);
                        }
                        Place::Discrete(_) => this.place(&update.value, &Dim::known(0, 0), &here),
                        Place::Ref(_) => {}
                    },
                    Action::Spawn(spawn) => this.given(spawn.entity, &spawn.given, &here),
                    Action::Destroy(_) => {}
                }
            }
        };
        // What a parameter is given is the first that is known of it.
        for (param, declared) in entity.params.pairs() {
            if let Some(found) = self.dimension(&declared.default, &here) {
                let needed = self.name(Named::Param(id, param));
                self.is_given(&declared.default, &found, &needed, &here);
            }
        }
        for drive in entity.drives.iter().chain(entity.modes.iter().flat_map(|m| &m.drives)) {
            if let DriveBy::Flow(value) = &drive.by {
                let needed = of_var(self, drive.var, drive.degree);
                self.place(value, &needed, &here);
            }
        }
        for envelope in entity.envelopes.iter() {
            let Some(&var) = envelope.vars.first() else { continue };
            // Its first word stands for it.
            let (start, end) = (envelope.span.start(), envelope.span.end());
            self.envelope = Some(envelope.span.ending(end.min(start + "envelope".len() as u32)));
            let level = of_var(self, var, envelope.degree);
            let rate_of = of_var(self, var, envelope.degree + 1);
            // The components of a vector are of one dimension.
            for &other in envelope.vars.iter().skip(1) {
                let found = of_var(self, other, envelope.degree);
                let (first, degree) = (var, envelope.degree);
                self.need(&envelope.sustain, &found, &level, Beside::Driven { first, other, degree }, &here);
            }
            let rate = |this: &mut Self, rate: &Rate| match rate {
                Rate::Instant => {}
                Rate::Accel(a) => this.place(a, &rate_of, &here),
                Rate::Over(t) => this.place(t, &time, &here),
            };
            rate(self, &envelope.attack);
            self.place(&envelope.sustain, &level, &here);
            if let Some(peak) = &envelope.peak {
                self.place(peak, &level, &here);
                rate(self, &envelope.decay);
            }
            if let (By::Clock(_), Some(held)) = (&envelope.by, &envelope.sustain_for) {
                self.place(held, &time, &here);
            }
            if let Release::To(release, to) = &envelope.release {
                rate(self, release);
                if let Some(to) = to {
                    self.place(to, &level, &here);
                }
            }
            if let Some(guard) = &envelope.driven_while {
                self.dimension(guard, &here);
            }
        }
        self.envelope = None;
        for mode in entity.modes.iter() {
            updates(self, &mode.entry);
            if let Some(guard) = &mode.initial_when {
                self.dimension(guard, &here);
            }
            for follow in &mode.follows {
                updates(self, &follow.actions);
                if let Some(guard) = &follow.guard {
                    self.dimension(guard, &here);
                }
            }
        }
        for edge in entity.edges.iter() {
            self.dimension(&edge.guard, &here);
            updates(self, &edge.actions);
        }
        for collider in entity.colliders.iter() {
            for side in collider.shape.numbers() {
                self.place(side, &length, &here);
            }
            if let Some(guard) = &collider.guard {
                self.dimension(guard, &here);
            }
        }
        for clamp in &entity.clamps {
            let needed = of_var(self, clamp.var, clamp.degree);
            for bound in clamp.low.iter().chain(&clamp.high) {
                self.place(bound, &needed, &here);
            }
        }
        for invariant in &entity.invariants {
            self.dimension(invariant, &here);
        }
        for (var, declared) in entity.vars.pairs() {
            if let Some(initial) = &declared.initial {
                let needed = of_var(self, var, 0);
                self.place(initial, &needed, &here);
            }
        }
    }
}
