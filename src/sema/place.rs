//! Instances with the values of their parameters and variables in the initial state.

use crate::diagnostic::catalogue::structure::BadCollider;
use crate::diagnostic::catalogue::types::{OutOfRange, TypeMismatch};
use crate::ir::{DiscreteId, EntityId, IdVec, Origin, ParamId, RefId, SlotId, SpaceId, VarId};
use crate::source::Span;
use crate::syntax::ast::{self, ExprKind, Name, PlaceHeight};

use super::checked::{Entity, Given, Instance, Term};
use super::constant::{ConstantContext, evaluate};
use super::expression::Scope;
use super::names::{Table, unknown};
use super::room::Room;
use super::{Checker, start};

/// The explicitly set values of an instance; the rest follows from the entity.
#[derive(Clone)]
pub(super) struct Values {
    pub params: IdVec<ParamId, Option<f64>>,
    pub vars: IdVec<VarId, [Option<f64>; 3]>,
    pub discretes: IdVec<DiscreteId, Option<f64>>,
}

impl Values {
    /// Nothing set.
    pub fn of(entity: &Entity) -> Self {
        Values {
            params: entity.params.iter().map(|_| None).collect(),
            vars: entity.vars.iter().map(|_| [None; 3]).collect(),
            discretes: entity.discretes.iter().map(|_| None).collect(),
        }
    }
}

/// What a block of settings gives an instance.
pub(super) struct Settings {
    pub values: Values,
    /// The settings as terms.
    pub given: Vec<(Given, Term)>,
    /// References, each with the name of its target.
    pub references: Vec<(RefId, Name)>,
}

impl Checker<'_> {
    /// Checks settings; the result is none if a value is not known. The instance's position is at `position`.
    pub(super) fn settings(
        &mut self,
        id: EntityId,
        settings: &[ast::Assignment],
        position: Span,
        step: (u64, u64),
        scope: &Scope<'_>,
    ) -> Option<Settings> {
        let constants = ConstantContext { params: None, step: Some(step) };
        let mut out =
            Settings { values: Values::of(&self.checked.entities[id]), given: Vec::new(), references: Vec::new() };
        let mut set: Table<()> = Table::new("setting");
        let mut fits = true;
        for setting in settings {
            let variable = &setting.variable;
            let written = format!("{}{}", variable.text, "'".repeat(variable.primes as usize));
            if !set.declare(&Name { text: written.into(), span: variable.span }, (), &mut self.diagnostics) {
                continue;
            }
            let Some((what, ty)) = self.setting(id, variable) else { continue };
            if self.position_is_placed(position, setting, what) {
                continue;
            }
            if let Given::Ref(reference) = what {
                out.references.extend(self.instance_name(&setting.value).map(|name| (reference, name)));
                continue;
            }
            let term = self.typed(&setting.value, scope, &ty);
            let value = term.as_ref().and_then(|t| self.evaluated(t, constants));
            out.given.extend(term.map(|t| (what, t)));
            fits &= value.is_some();
            match what {
                Given::Param(id) => out.values.params[id] = value,
                Given::Discrete(id) => out.values.discretes[id] = value,
                Given::Var(id, degree) => out.values.vars[id][usize::from(degree)] = value,
                Given::Ref(_) => {}
            }
        }
        fits.then_some(out)
    }

    /// A placed instance. Targets of references are stored by name, as not all instances are known yet.
    pub(super) fn place(
        &mut self,
        place: &ast::Place,
        space: SpaceId,
        step: (u64, u64),
        slot: SlotId,
        references: &mut Vec<(SlotId, RefId, Name)>,
        room: &Room<'_>,
    ) -> Option<Instance> {
        let constants = ConstantContext { params: None, step: Some(step) };
        let scope = Scope::measured(room.spaces);
        let mut given = Vec::new();
        let mut coordinate = |of: &mut Self, e: &ast::Expr, var| {
            let term = of.number(e, &scope)?;
            let value = of.measured(&term, constants, e.span);
            given.push((Given::Var(var, 0), term));
            value
        };
        let x = coordinate(self, &place.x, VarId::X);
        let y = match &place.y {
            PlaceHeight::At(y) => coordinate(self, y, VarId::Y),
            PlaceHeight::Above(tag) => self.above(tag, x, room),
        };
        let Some(id) = self.entity_named(&place.entity) else {
            let fact = unknown("entity", &place.entity.text, place.entity.span, self.entities.names());
            self.report_unknown(fact);
            return None;
        };
        let settings = self.settings(id, &place.settings, place.x.span.to(place.y.span()), step, &scope);
        let (Some(x), Some(y), Some(settings)) = (x, y, settings) else { return None };
        let Settings { mut values, given: set, references: named } = settings;
        values.vars[VarId::X][0] = Some(x);
        values.vars[VarId::Y][0] = Some(y);
        given.extend(set);
        let made = self.instance_of(id, values, place.name.clone(), Origin::Named, space, step, place.span)?;
        references.extend(named.into_iter().map(|(reference, name)| (slot, reference, name)));
        Some(Instance { given, ..made })
    }

    /// The instance name that a reference of a placed instance is set to; `None` for `none`.
    fn instance_name(&mut self, e: &ast::Expr) -> Option<Name> {
        match (&e.kind, e.name()) {
            (ExprKind::NoneRef, _) => None,
            (_, Some(name)) => Some(name),
            _ => {
                self.diagnostics.report(TypeMismatch {
                    at: e.span,
                    found: "an expression".into(),
                    expected: "the name of an instance of this world".into(),
                    help: None,
                });
                None
            }
        }
    }

    /// An instance with the set values, and defaults for the rest.
    #[allow(clippy::too_many_arguments, reason = "an instance is all of these")]
    pub(super) fn instance_of(
        &mut self,
        id: EntityId,
        mut set: Values,
        name: Name,
        origin: Origin,
        space: SpaceId,
        step: (u64, u64),
        span: Span,
    ) -> Option<Instance> {
        let entity = self.checked.entities[id].clone();
        start::place(&entity, &mut set);
        let mut params: IdVec<_, f64> = IdVec::new();
        for (id, param) in entity.params.pairs() {
            let value = match set.params[id] {
                Some(value) => value,
                None => {
                    let context = ConstantContext { params: Some(&params), step: Some(step) };
                    self.evaluated(&param.default, context)?
                }
            };
            // Normalises -0.
            params.push(value + 0.0);
        }
        let context = ConstantContext { params: Some(&params), step: Some(step) };
        let mut vars = IdVec::new();
        for (id, var) in entity.vars.pairs() {
            let mut value = [0.0; 3];
            for degree in 0..3 {
                value[degree] = match (set.vars[id][degree], &var.initial) {
                    (Some(value), _) => value,
                    (None, Some(initial)) if degree == 0 => self.evaluated(initial, context)?,
                    _ => 0.0,
                };
            }
            vars.push(value.map(|value| value + 0.0));
        }
        let mut discretes = IdVec::new();
        for (id, discrete) in entity.discretes.pairs() {
            let value = match set.discretes[id] {
                Some(value) => value,
                None => self.evaluated(&discrete.initial, context)?,
            };
            let (low, high) = discrete.range;
            let certain = set.discretes[id].is_none() && evaluate(&discrete.initial, ConstantContext::LITERALS).is_ok();
            let inside = value >= f64::from(low) && value <= f64::from(high);
            if !certain && (!inside || value.fract() != 0.0) {
                self.diagnostics.report(OutOfRange {
                    at: if set.discretes[id].is_some() { span } else { discrete.initial.span },
                    what: format!("`{}` = {value}", discrete.name.text),
                    range: if inside { "the whole numbers".into() } else { format!("{low}..{high}") },
                });
            }
            discretes.push(value as i32);
        }
        self.collider_sizes(&entity, &name, span, context);
        let refs = entity.refs.iter().map(|_| None).collect();
        Some(Instance { name, origin, entity: id, space, params, vars, discretes, refs, given: Vec::new(), span })
    }

    /// Checks sizes that depend on parameters, which are known only now.
    fn collider_sizes(&mut self, entity: &Entity, name: &Name, span: Span, context: ConstantContext<'_>) {
        for collider in entity.colliders.iter() {
            for (term, what) in collider.shape.sizes() {
                let always = evaluate(term, ConstantContext::LITERALS).is_ok();
                match evaluate(term, context) {
                    Ok(value) if value <= 0.0 && !always => {
                        let instance = Some((name.text.to_string(), span));
                        self.diagnostics.report(BadCollider { at: term.span, what, value, instance });
                    }
                    _ => {}
                }
            }
        }
    }
}
