//! Verifies expressions: operands come before operators, and everything read exists. Variables of a subject of any
//! entity can be read after a guard has tested the entity (`e is Foe and e.hp > 0`), with the same rules as in `sema`.

use std::cell::Cell;

use crate::ir::{Arena, EntityId, Expr, ExprId, Function, Id, Press, ProbeId, Program, RefValue, Subject, WorldId};

use super::{At, Checked, Invalid, each, each_pair, ensure, exists, exists_among};

/// Maximum number of operands of an expression, counted with repetition.
const MAX_PARTS: u32 = 1 << 24;
/// Maximum nesting depth: expressions are read by recursion.
const MAX_DEPTH: u16 = 640;

/// The verifier of expressions.
pub(super) struct Code<'p> {
    program: &'p Program,
    /// Remaining work for context-dependent checks.
    budget: Cell<u64>,
}

/// The owner of an expression.
#[derive(Clone, Copy)]
pub(super) enum Owner {
    Entity(EntityId),
    World(WorldId),
}

/// The entities of subjects that guards have tested.
pub(super) type Facts = Vec<(Subject, EntityId)>;

impl<'p> Code<'p> {
    /// Runs the context-free checks of all expressions.
    pub fn new(program: &'p Program) -> Result<Self, Invalid> {
        // Two separate tables, as they are large for large programs.
        let mut sizes: Arena<ExprId, u32> = Arena::default();
        let mut depths: Arena<ExprId, u16> = Arena::default();
        let mut look = |id: ExprId, expr: &Expr| {
            let (mut parts, mut deep) = (1, 0);
            for operand in expr.operands() {
                ensure(operand < id, "an operand does not come before it")?;
                parts += sizes[operand];
                deep = deep.max(depths[operand] + 1);
            }
            ensure(parts <= MAX_PARTS && deep <= MAX_DEPTH, "it is made of too many parts")?;
            sizes.push(parts);
            depths.push(deep);
            match *expr {
                Expr::Number(number) | Expr::Frames(number) => ensure(number.is_finite(), "a number is not finite"),
                Expr::Var(_, _, degree) => ensure(degree <= 2, "there are no derivatives but the first and the second"),
                Expr::Call(function, _) => ensure(function != Function::Atan2 || deep > 0, "it has no arguments"),
                _ => Ok(()),
            }
        };
        each_pair("exprs", program.exprs.pairs(), &mut look)?;
        let work = 16 * program.exprs.len() as u64 + (1 << 20);
        Ok(Code { program, budget: Cell::new(work) })
    }

    /// Checks an expression as code of an entity or a world, given some facts.
    pub fn check(&self, owner: Owner, id: ExprId, facts: &mut Facts) -> Checked {
        exists_among(id, self.program.exprs.len())?;
        if let Owner::Entity(entity) = owner {
            let code = self.program.entities[entity].code;
            ensure(code.contains(id), "it is not among the expressions of its entity")?;
        }
        let left = self.budget.get();
        self.budget.set(left.saturating_sub(1));
        ensure(left > 0, "its expressions share too much")?;
        match self.program.exprs[id] {
            Expr::And(a, b) | Expr::Or(a, b) => {
                self.operand(owner, a, facts)?;
                let outcome = matches!(self.program.exprs[id], Expr::And(..));
                self.operand_where(owner, b, (a, outcome), facts)
            }
            Expr::Call(Function::If, [condition, a, b]) => {
                self.operand(owner, condition, facts)?;
                self.operand_where(owner, a, (condition, true), facts)?;
                self.operand_where(owner, b, (condition, false), facts)
            }
            Expr::Count { of, holds } | Expr::Nearest { of, holds } => {
                exists(of, &self.program.entities)?;
                let member = |(subject, _): &(Subject, EntityId)| matches!(subject, Subject::Member(_));
                ensure(!facts.iter().any(member), "a question to each instance is inside of another one")?;
                ensure(matches!(owner, Owner::Entity(_)), "a world asks its instances by their slots")?;
                facts.push((Subject::Member(of), of));
                let checked = self.operand(owner, holds, facts);
                facts.pop();
                checked?;
                let is_nearest = matches!(self.program.exprs[id], Expr::Nearest { .. });
                ensure(
                    !is_nearest || self.is_own(holds, Some(of)),
                    "it reads more than its own instance and the member",
                )
            }
            expr => {
                for operand in expr.operands() {
                    self.operand(owner, operand, facts)?;
                }
                self.atom(owner, expr, facts)
            }
        }
    }

    /// As [`check`](Self::check), of what another expression reads.
    fn operand(&self, owner: Owner, id: ExprId, facts: &mut Facts) -> Checked {
        self.check(owner, id, facts).map_err(|inner| at_its_place(inner, id))
    }

    /// As [`operand`](Self::operand), where a guard has an outcome.
    fn operand_where(&self, owner: Owner, id: ExprId, guard: (ExprId, bool), facts: &mut Facts) -> Checked {
        let known = facts.len();
        self.learn(guard.0, guard.1, facts);
        let checked = self.operand(owner, id, facts);
        facts.truncate(known);
        checked
    }

    /// Whether what an expression itself reads is there, apart from the recursion: so that one level of it takes little
    /// of the stack.
    fn atom(&self, owner: Owner, expr: Expr, facts: &Facts) -> Checked {
        let program = self.program;
        let of = |subject: Subject| {
            let of = self.entity(owner, subject, facts)?;
            exists(of, &program.entities).map(|()| &program.entities[of])
        };
        let me = || match owner {
            Owner::Entity(me) => Ok(&program.entities[me]),
            Owner::World(_) => Err(Invalid::new("a world reads no inputs, timers and signals")),
        };
        match expr {
            Expr::Param(subject, param) => exists(param, &of(subject)?.params),
            // Every entity has a position.
            Expr::Var(subject, var, _) if var.is_position() => self.read(owner, subject, facts),
            Expr::Var(subject, var, _) => exists(var, &of(subject)?.vars),
            Expr::Discrete(subject, id) => exists(id, &of(subject)?.discretes),
            Expr::InMode(subject, mode) => exists(mode, &of(subject)?.modes),
            Expr::Touching(subject, touch) => exists(touch, &of(subject)?.touches),
            Expr::Axis(axis) => exists(axis, &me()?.axes),
            Expr::Chance(chance) => exists(chance, &me()?.chances),
            Expr::Button(Press::Pressed | Press::Held | Press::Released, button) => exists(button, &me()?.buttons),
            Expr::Timer(timer) => exists(timer, &me()?.timers),
            Expr::Joint(mode, _) => exists(mode, &me()?.modes),
            Expr::Received(signal) => exists(signal, &me()?.signals),
            Expr::Sum(signal) => {
                exists(signal, &me()?.signals)?;
                ensure(me()?.signals[signal].number.is_some(), "the signal comes without a number")
            }
            Expr::IsNone(subject) | Expr::Near { of: subject, .. } | Expr::Distance { of: subject, .. } => {
                self.read(owner, subject, facts)
            }
            Expr::Is(subject, entity) => {
                self.read(owner, subject, facts)?;
                exists(entity, &program.entities)
            }
            Expr::Alive(slot) => self.subject(owner, Subject::Slot(slot)),
            Expr::Probe { mine, other, offset, bound, tiles } => {
                me()?;
                ensure(bound || !tiles, "a probe that keeps nothing keeps no tile")?;
                exists(mine, &program.tags)?;
                exists(other, &program.tags)?;
                ensure(offset.iter().all(|id| self.is_own(*id, None)), "an offset reads more than its own instance")
            }
            Expr::Broken(tag) | Expr::Tiles(tag) => exists(tag, &program.tags),
            Expr::InSpace(subject, space) => {
                self.read(owner, subject, facts)?;
                match owner {
                    Owner::World(world) => exists(space, &program.worlds[world].spaces),
                    Owner::Entity(_) => Err(Invalid::new("an entity knows no spaces")),
                }
            }
            Expr::Number(_)
            | Expr::Frames(_)
            | Expr::Bool(_)
            | Expr::Negate(_)
            | Expr::Not(_)
            | Expr::Arithmetic(..)
            | Expr::Compare(..)
            | Expr::Call(..)
            | Expr::And(..)
            | Expr::Or(..)
            // Checked with what they ask.
            | Expr::Count { .. }
            | Expr::Nearest { .. } => Ok(()),
        }
    }

    /// Whether an expression reads nothing but the values, modes and inputs of its own instance, and of a member of an
    /// entity.
    fn is_own(&self, id: ExprId, member: Option<EntityId>) -> bool {
        let left = self.budget.get();
        self.budget.set(left.saturating_sub(1));
        let expr = self.program.exprs[id];
        let is_own = match expr {
            Expr::Param(of, _)
            | Expr::Var(of, ..)
            | Expr::Discrete(of, _)
            | Expr::InMode(of, _)
            | Expr::Distance { of, .. } => {
                of == Subject::Me || member.is_some_and(|of_it| of == Subject::Member(of_it))
            }
            Expr::Touching(..)
            | Expr::Probe { .. }
            | Expr::Joint(..)
            | Expr::Received(_)
            | Expr::Sum(_)
            | Expr::IsNone(_)
            | Expr::Is(..)
            | Expr::Alive(_)
            | Expr::Broken(_)
            | Expr::Tiles(_)
            | Expr::InSpace(..)
            | Expr::Near { .. }
            | Expr::Count { .. }
            | Expr::Nearest { .. } => false,
            Expr::Number(_)
            | Expr::Frames(_)
            | Expr::Bool(_)
            | Expr::Axis(_)
            | Expr::Chance(_)
            | Expr::Timer(_)
            | Expr::Button(..)
            | Expr::Negate(_)
            | Expr::Arithmetic(..)
            | Expr::Call(..)
            | Expr::Compare(..)
            | Expr::And(..)
            | Expr::Or(..)
            | Expr::Not(_) => true,
        };
        left > 0 && is_own && expr.operands().into_iter().all(|operand| self.is_own(operand, member))
    }

    /// Whether an expression asks no probe and no question to each instance. A collider may not: it would ask where
    /// colliders are.
    pub fn asks_no_probe(&self, id: ExprId) -> bool {
        self.asks_none(id, true, |_| true)
    }

    /// Whether an expression of an entity asks no question to each instance.
    pub fn asks_no_members(&self, me: EntityId, id: ExprId) -> bool {
        let probes = &self.program.entities[me].probes;
        let is_nearest = |id: ProbeId| {
            probes.get(id).is_some_and(|probe| matches!(self.program.exprs[*probe], Expr::Nearest { .. }))
        };
        self.asks_none(id, false, is_nearest)
    }

    fn asks_none(&self, id: ExprId, probes: bool, is_asked: impl Fn(ProbeId) -> bool + Copy) -> bool {
        let left = self.budget.get();
        self.budget.set(left.saturating_sub(1));
        let expr = self.program.exprs[id];
        let asks = match expr {
            Expr::Count { .. } | Expr::Nearest { .. } => true,
            Expr::Probe { .. } => probes,
            Expr::Param(of, _)
            | Expr::Var(of, ..)
            | Expr::Discrete(of, _)
            | Expr::InMode(of, _)
            | Expr::Touching(of, _)
            | Expr::IsNone(of)
            | Expr::Is(of, _)
            | Expr::InSpace(of, _)
            | Expr::Near { of, .. }
            | Expr::Distance { of, .. } => matches!(of, Subject::Probed(probe) if is_asked(probe)),
            _ => false,
        };
        left > 0 && !asks && expr.operands().into_iter().all(|operand| self.asks_none(operand, probes, is_asked))
    }

    /// Checks that an expression can read a subject.
    fn read(&self, owner: Owner, subject: Subject, facts: &Facts) -> Checked {
        match subject {
            Subject::Member(_) => {
                let is_asked = facts.iter().any(|(of, _)| *of == subject);
                ensure(is_asked, "it reads a member outside of a question to each")
            }
            _ => self.subject(owner, subject),
        }
    }

    /// Checks that a subject exists.
    pub fn subject(&self, owner: Owner, subject: Subject) -> Checked {
        match (owner, subject) {
            (Owner::Entity(_), Subject::Me) => Ok(()),
            (Owner::Entity(me), Subject::Ref(id)) => exists(id, &self.program.entities[me].refs),
            (Owner::Entity(me), Subject::Touched(id)) => {
                exists(id, &self.program.entities[me].touches)?;
                ensure(id.index() < self.program.entities[me].bound, "the contact query does not keep whom it finds")
            }
            (Owner::Entity(me), Subject::Probed(id)) => exists(id, &self.program.entities[me].probes),
            (Owner::World(world), Subject::Slot(slot)) => exists(slot, &self.program.worlds[world].slots),
            (_, Subject::Member(_)) => Err(Invalid::new("it reads a member outside of a question to each")),
            (Owner::Entity(_), Subject::Slot(_)) => Err(Invalid::new("an entity knows no instances of a world")),
            (Owner::World(_), _) => Err(Invalid::new("a world has no references and contacts of its own")),
        }
    }

    /// The entity of a subject.
    fn entity(&self, owner: Owner, subject: Subject, facts: &Facts) -> Result<EntityId, Invalid> {
        self.read(owner, subject, facts)?;
        let declared = match (owner, subject) {
            (_, Subject::Member(of)) => Some(of),
            (Owner::Entity(me), Subject::Probed(id)) => {
                match self.program.exprs[self.program.entities[me].probes[id]] {
                    Expr::Nearest { of, .. } => Some(of),
                    _ => None,
                }
            }
            (Owner::Entity(me), Subject::Me) => Some(me),
            (Owner::Entity(me), Subject::Ref(id)) => self.program.entities[me].refs[id].entity,
            (Owner::World(world), Subject::Slot(slot)) => Some(self.program.worlds[world].slots[slot].entity),
            _ => None,
        };
        let known = || facts.iter().rev().find(|(of, _)| *of == subject).map(|(_, entity)| *entity);
        declared.or_else(known).ok_or_else(|| Invalid::new("it reads an instance that may be of any entity"))
    }

    /// Adds the facts that a guard implies if it has this outcome.
    pub fn learn(&self, guard: ExprId, outcome: bool, facts: &mut Facts) {
        match (self.program.exprs[guard], outcome) {
            (Expr::And(a, b), true) | (Expr::Or(a, b), false) => {
                self.learn(a, outcome, facts);
                self.learn(b, outcome, facts);
            }
            (Expr::Not(a), _) => self.learn(a, !outcome, facts),
            (Expr::Is(subject, entity), true) => facts.push((subject, entity)),
            _ => {}
        }
    }

    /// Checks the value of a reference.
    pub fn instance(&self, owner: Owner, value: RefValue) -> Checked {
        match value {
            RefValue::None => Ok(()),
            RefValue::Of(subject) => self.subject(owner, subject),
        }
    }
}

/// An error in an operand, with its place if it has none.
fn at_its_place(inner: Invalid, id: ExprId) -> Invalid {
    match inner.at.is_empty() {
        true => inner.within(&format!("exprs[{}]", id.index())),
        false => inner,
    }
}

/// Checks that the code ranges of entities are disjoint and in order.
pub(super) fn check_code_ranges(program: &Program) -> Checked {
    let mut end = ExprId(0);
    each("entities", &program.entities, |_, entity| {
        ensure(entity.code.from >= end, "its expressions are another entity's, too").at("code")?;
        end = entity.code.to;
        Ok(())
    })
}
