//! `start.x` and `start.y`: where an instance was placed or spawned. An entity that reads them has two more parameters,
//! the first ones, which get their values from the position and cannot be set.

use crate::ir::{ParamId, Subject, VarId};
use crate::source::Span;
use crate::syntax::ast::{Name, PathRef, is_start};

use super::Checker;
use super::annotation::Annotation;
use super::checked::{Entity, Given, Param, Term, TermKind, Type};
use super::entity::Skeleton;
use super::expression::{ReadLimit, Scope};
use super::place::Values;

/// The names of the parameters.
const NAMES: [&str; 2] = ["start.x", "start.y"];

/// The parameters, each with the variable that it keeps the first value of.
fn kept() -> impl Iterator<Item = (ParamId, VarId)> {
    [ParamId(0), ParamId(1)].into_iter().zip(VarId::XY)
}

impl Entity {
    /// The parameters that the text declares.
    pub fn declared_params(&self) -> impl Iterator<Item = (ParamId, &Param)> {
        self.params.pairs().skip(if self.reads_start { NAMES.len() } else { 0 })
    }
}

/// Declares the parameters of an entity that has none yet.
pub(super) fn declare(entity: &mut Entity) {
    entity.reads_start = true;
    let span = entity.name.span;
    for text in NAMES {
        let default = Term { kind: TermKind::Number(0.0), ty: Type::Real, span };
        let dimension = Some(Annotation { px: 1, s: 0, span });
        entity.params.push(Param { name: Name { text: text.into(), span }, default, dimension });
    }
}

/// Sets them in the values of an instance.
pub(super) fn place(entity: &Entity, values: &mut Values) {
    for (param, var) in kept().filter(|_| entity.reads_start) {
        values.params[param] = Some(values.vars[var][0].unwrap_or_default());
    }
}

/// Gives them to an instance that is spawned with these values: what is not given is the spawner's.
pub(super) fn spawn(entity: &Entity, given: &mut Vec<(Given, Term)>, span: Span) {
    for (param, var) in kept().filter(|_| entity.reads_start) {
        let known = given.iter().find(|(what, _)| *what == Given::Var(var, 0)).map(|(_, term)| term.clone());
        let spawners = || Term { kind: TermKind::Var(Subject::Me, var, 0), ty: Type::Real, span };
        given.push((Given::Param(param), known.unwrap_or_else(spawners)));
    }
}

/// The meaning of a first name before a dot.
pub(super) fn suggestion(name: &str) -> Option<String> {
    (name == "start").then(|| "`start.x` and `start.y` are where the instance was placed".into())
}

impl Checker<'_> {
    /// `start.x` or `start.y`, unless the entity itself has something called `start`.
    pub(super) fn start(
        &mut self,
        path: &PathRef<'_>,
        names: &Skeleton,
        span: Span,
        scope: &Scope<'_>,
    ) -> Option<Option<Term>> {
        let [first, second] = &*path.segments else { return None };
        if !is_start(first, second) || names.value_place(&first.text).is_some() {
            return None;
        }
        if self.referred(&first.text, scope).is_some() {
            return None;
        }
        let param = *names.params.get(&format!("{}.{}", first.text, second.text))?;
        let term = Term { kind: TermKind::Param(Subject::Me, param), ty: Type::Real, span };
        let may =
            self.unprimed(path).and_then(|()| self.allow(Some(()), span, scope, ReadLimit::Params, "a parameter"));
        Some(may.map(|()| term))
    }
}
