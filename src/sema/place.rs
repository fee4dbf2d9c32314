//! Placed instances: the values of their parameters and variables before the first step.

use crate::diagnostic::catalogue::names::DuplicateName;
use crate::diagnostic::catalogue::structure::BadCollider;
use crate::diagnostic::catalogue::types::OutOfRange;
use crate::syntax::ast::{self, Name};

use super::Checker;
use super::checked::{Given, Instance, Type};
use super::constant::{ConstantContext, evaluate};
use super::entity::{X, Y};
use super::expression::Scope;
use super::ids::{EntityId, IdVec, SpaceId};
use super::names::{Table, unknown};

impl Checker<'_> {
    /// A placed instance with the values of its parameters and variables.
    pub(super) fn place(&mut self, place: &ast::Place, space: SpaceId, step: f64) -> Option<Instance> {
        let constants = ConstantContext { params: None, step: Some(step) };
        let scope = Scope::constant();
        let mut at = [None, None];
        let mut given = Vec::new();
        for ((slot, e), var) in at.iter_mut().zip([&place.x, &place.y]).zip([X, Y]) {
            if let Some(term) = self.number(e, &scope) {
                *slot = self.evaluated(&term, constants);
                given.push((Given::Var(var, 0), term));
            }
        }
        let Some(&id) = self.entities.get(&place.entity.text) else {
            let fact = unknown("entity", &place.entity.text, place.entity.span, self.entities.names());
            self.report_unknown(fact);
            return None;
        };
        let entity = self.checked.entities[id].clone();
        let mut set: Table<()> = Table::new("setting");
        let mut params: IdVec<_, Option<f64>> = entity.params.iter().map(|_| None).collect();
        let mut vars: IdVec<_, [Option<f64>; 3]> = entity.vars.iter().map(|_| [None; 3]).collect();
        vars[X][0] = at[0];
        vars[Y][0] = at[1];
        let mut discretes: IdVec<_, Option<f64>> = entity.discretes.iter().map(|_| None).collect();
        let mut fits = at[0].is_some() && at[1].is_some();
        for setting in &place.settings {
            let name = &setting.variable.name;
            let written = format!("{}{}", name.text, "'".repeat(setting.variable.primes));
            if !set.declare(&Name { text: written, span: setting.variable.span }, (), &mut self.diagnostics) {
                continue;
            }
            let mut value = |this: &mut Self, ty: &Type, what: Given| {
                let term = this.typed(&setting.value, &scope, ty);
                let value = term.as_ref().and_then(|t| this.evaluated(t, constants));
                given.extend(term.map(|t| (what, t)));
                fits &= value.is_some();
                value
            };
            let plain = setting.variable.primes == 0;
            if let Some(p) = entity.params.find(|p| plain && p.name.text == name.text) {
                let ty = match &entity.params[p].default.ty {
                    Type::Int => Type::Real,
                    ty => ty.clone(),
                };
                params[p] = value(self, &ty, Given::Param(p));
            } else if let Some(d) = entity.discretes.find(|d| plain && d.name.text == name.text) {
                discretes[d] = value(self, &entity.discretes[d].ty, Given::Discrete(d));
            } else if let Some(v) = entity.vars.find(|v| v.name.text == name.text) {
                if v <= Y && plain {
                    self.diagnostics.report(DuplicateName {
                        kind: "the position",
                        name: name.text.clone(),
                        first: place.x.span.to(place.y.span),
                        second: setting.span,
                    });
                    continue;
                }
                if let Some(degree) = self.primes(&setting.variable) {
                    vars[v][usize::from(degree)] = value(self, &Type::Real, Given::Var(v, degree));
                }
            } else {
                let known = entity.params.iter().map(|p| &p.name);
                let known = known.chain(entity.discretes.iter().map(|d| &d.name));
                let known = known.chain(entity.vars.iter().map(|v| &v.name)).map(|n| n.text.as_str());
                let fact = unknown("parameter or variable", &name.text, name.span, known);
                self.report_unknown(fact);
            }
        }
        if !fits {
            return None;
        }
        let mut values: IdVec<_, f64> = IdVec::new();
        for (id, param) in entity.params.pairs() {
            let value = match params[id] {
                Some(value) => value,
                None => {
                    let context = ConstantContext { params: Some(&values), step: Some(step) };
                    self.evaluated(&param.default, context)?
                }
            };
            values.push(value);
        }
        let context = ConstantContext { params: Some(&values), step: Some(step) };
        let mut first = IdVec::new();
        for (id, var) in entity.vars.pairs() {
            let mut value = [0.0; 3];
            for degree in 0..3 {
                value[degree] = match (vars[id][degree], &var.initial) {
                    (Some(value), _) => value,
                    (None, Some(initial)) if degree == 0 => self.evaluated(initial, context)?,
                    _ => 0.0,
                };
            }
            first.push(value);
        }
        let mut whole = IdVec::new();
        for (id, discrete) in entity.discretes.pairs() {
            let value = match discretes[id] {
                Some(value) => value,
                None => self.evaluated(&discrete.initial, context)?,
            };
            let (low, high) = discrete.range;
            let certain = discretes[id].is_none() && evaluate(&discrete.initial, ConstantContext::LITERALS).is_ok();
            let inside = value >= f64::from(low) && value <= f64::from(high);
            if !certain && (!inside || value.fract() != 0.0) {
                self.diagnostics.report(OutOfRange {
                    at: if discretes[id].is_some() { place.span } else { discrete.initial.span },
                    what: format!("`{}` = {value}", discrete.name.text),
                    range: if inside { "the whole numbers".into() } else { format!("{low}..{high}") },
                });
            }
            whole.push(value as i32);
        }
        self.collider_sizes(id, place, context);
        Some(Instance {
            name: place.name.clone(),
            entity: id,
            space,
            params: values,
            vars: first,
            discretes: whole,
            given,
            span: place.span,
        })
    }

    /// Sizes that depend on parameters are known only now.
    fn collider_sizes(&mut self, entity: EntityId, place: &ast::Place, context: ConstantContext<'_>) {
        let mut found = Vec::new();
        for collider in self.checked.entities[entity].colliders.iter() {
            for (term, what) in [(&collider.rect[2], "width"), (&collider.rect[3], "height")] {
                let always = evaluate(term, ConstantContext::LITERALS).is_ok();
                match evaluate(term, context) {
                    Ok(value) if value <= 0.0 && !always => found.push((term.span, what, value)),
                    _ => {}
                }
            }
        }
        for (at, what, value) in found {
            let instance = Some((place.name.text.clone(), place.span));
            self.diagnostics.report(BadCollider { at, what, value, instance });
        }
    }
}
