//! Reports conflicts of the solver: two uses of one name, two terms that do not agree, a term in a context that needs
//! another dimension.

use crate::ir::{Arithmetic, EntityId, Function, Subject};

use crate::diagnostic::catalogue::types::{DimensionConflict, Dimensioned, NoSquare, Unjoinable, WrongDimension};
use crate::diagnostic::{Diagnostics, similar};
use crate::source::{SourceMap, Span};

use super::super::checked::{Term, TermKind};
use super::{Conflict, ConflictSite, Dim, Named, Ratio, Relation, Solver};

/// Maximum number of characters of an expression in a message.
const SHOWN: usize = 40;

impl Solver<'_> {
    pub(super) fn report(mut self, sources: &SourceMap, diagnostics: &mut Diagnostics) {
        for (root, of) in std::mem::take(&mut self.roots) {
            let root = self.reduce(&root);
            if root.unknowns.is_empty() && (root.px.1 != 1 || root.s.1 != 1) {
                let dimension = Dim::known(0, 0).plus(&root, Ratio(2, 1)).words();
                diagnostics.report(NoSquare { of: shown(sources, of.span), at: of.span, dimension });
            }
        }
        for conflict in std::mem::take(&mut self.conflicts) {
            self.conflict(&conflict, sources, diagnostics);
        }
    }

    fn conflict(&mut self, conflict: &Conflict, sources: &SourceMap, diagnostics: &mut Diagnostics) {
        let Conflict { entity, term, needed, found, beside, envelope } = conflict;
        let named = self.named(*entity, term);
        let near = named.as_ref().zip(*entity).and_then(|((_, name), e)| self.of_dimension(e, needed, name));
        let mut also: Vec<(Span, String)> =
            envelope.map(|at| (at, "of this envelope".to_string())).into_iter().collect();
        let this = Dimensioned { text: shown(sources, term.span), at: Some(term.span), dimension: found.words() };
        match beside {
            ConflictSite::Place => {
                let reason = named.as_ref().and_then(|(n, _)| self.named.get(n)).and_then(|&u| self.solved[u].as_ref());
                if let (Some((_, name)), Some((_, reason))) = (&named, reason) {
                    let (what, at) = (format!("`{name}`"), (term.span, needed.words()));
                    let other = (*reason, found.words());
                    diagnostics.report(DimensionConflict { what, at, other, also, near });
                    return;
                }
                also.extend(entity.and_then(|e| self.culprit(e, term)));
                let help = self.plain_factor(sources, *entity, term, found, needed);
                let help = help.or_else(|| self.missing_rate(*entity, term, found, needed));
                diagnostics.report(WrongDimension { this, needed: needed.words(), also, near, help });
            }
            ConflictSite::Term(first, joint) => {
                let culprits = [first, term].into_iter().filter_map(|t| self.culprit((*entity)?, t));
                for culprit in culprits.collect::<Vec<_>>() {
                    if !also.contains(&culprit) {
                        also.push(culprit);
                    }
                }
                let help = self.plain_factor(sources, *entity, term, found, needed);
                let help = help.or_else(|| self.plain_factor(sources, *entity, first, needed, found));
                let other = self.named(*entity, first).map(|(_, name)| name);
                let near = near.filter(|near| Some(near) != other.as_ref());
                let (text, at) = (shown(sources, first.span), Some(first.span));
                let first = Dimensioned { text, at, dimension: needed.words() };
                diagnostics.report(Unjoinable { first, second: this, how: joint.words(), also, near, help });
            }
            ConflictSite::Driven { first, other, degree } => {
                let Some(entity) = entity.map(|e| &self.program.entities[e]) else { return };
                let of = |var, dim: &Dim, at| {
                    let text = format!("`{}{}`", entity.vars[var].name.text, "'".repeat(usize::from(*degree)));
                    Dimensioned { text, at, dimension: dim.words() }
                };
                let (first, second) = (of(*first, needed, None), of(*other, found, *envelope));
                let how = "driven by one envelope".to_string();
                diagnostics.report(Unjoinable { first, second, how, also: Vec::new(), near: None, help: None });
            }
        }
    }

    /// The name and its text, if a term is a name.
    fn named(&self, entity: Option<EntityId>, term: &Term) -> Option<(Named, String)> {
        let e = entity?;
        match &term.kind {
            TermKind::Param(Subject::Me, p) => {
                Some((Named::Param(e, *p), self.program.entities[e].params[*p].name.text.to_string()))
            }
            TermKind::Var(Subject::Me, v, degree) => {
                let name = &self.program.entities[e].vars[*v].name.text;
                Some((Named::Var(e, *v), format!("{name}{}", "'".repeat(usize::from(*degree)))))
            }
            _ => None,
        }
    }

    /// The name in a term whose first use determined its dimension; else a name with a fixed dimension.
    fn culprit(&mut self, id: EntityId, term: &Term) -> Option<(Span, String)> {
        let mut names = Vec::new();
        leaves(term, &mut names);
        let entity = &self.program.entities[id];
        let given = names.iter().find_map(|leaf| {
            let (named, name) = match &leaf.kind {
                TermKind::Param(Subject::Me, p) => (Named::Param(id, *p), &entity.params[*p].name.text),
                TermKind::Var(Subject::Me, v, _) => (Named::Var(id, *v), &entity.vars[*v].name.text),
                _ => return None,
            };
            let (dim, at) = self.named.get(&named).and_then(|&u| self.solved[u].clone())?;
            let dim = self.reduce(&dim);
            (at != leaf.span && !dim.is_unknown).then(|| (at, format!("by this, `{name}` is {}", dim.words())))
        });
        given.or_else(|| {
            names.iter().find_map(|leaf| {
                let (name, kind) = match &leaf.kind {
                    TermKind::Discrete(Subject::Me, d) => (&entity.discretes[*d].name, "`discrete`"),
                    TermKind::Axis(axis) => (&entity.axes[*axis], "axis"),
                    TermKind::Chance(chance) => (&entity.chances[*chance].name, "`chance`"),
                    _ => return None,
                };
                Some((name.span, format!("`{}` is a pure number, as is every {kind}", name.text)))
            })
        })
    }

    /// The declaration of a number with a dimension, under a name that is free.
    fn declared(&self, entity: Option<EntityId>, dimension: &str, value: &str) -> String {
        let Some(entity) = entity.map(|e| &self.program.entities[e]) else {
            return format!("const k: {dimension} = {value}");
        };
        let values = || entity.params.iter().map(|p| &p.name).chain(entity.vars.iter().map(|v| &v.name));
        let is_free = |name: &&str| !values().any(|known| known.text == **name);
        let name = ["k", "factor", "scale"].into_iter().find(is_free).unwrap_or("NAME");
        format!("param {name}: {dimension} = {value}")
    }

    /// A plain factor or divisor whose dimension is all that is missing; the fix is to give it a name.
    fn plain_factor(
        &self,
        sources: &SourceMap,
        entity: Option<EntityId>,
        term: &Term,
        found: &Dim,
        needed: &Dim,
    ) -> Option<String> {
        let (number, divides) = factor(term, *found == Dim::known(0, 0))?;
        let text = sources.slice(number.span);
        let (more, less) = if divides { (found, needed) } else { (needed, found) };
        let annotation = more.clone().plus(less, Ratio(-1, 1)).words();
        let usual = ["px", "px/s", "px/s^2", "s", "s^2", "1/s", "1/s^2", "1/px"];
        let is_usual = !needed.is_unknown && !found.is_unknown && usual.contains(&annotation.as_str());
        if !is_usual || !text.bytes().all(|b| b.is_ascii_digit() || b == b'.') {
            return None;
        }
        Some(format!(
            "beside `*` or `/` a plain number such as `{text}` is a pure number; give it a name and a dimension: `{}`",
            self.declared(entity, &annotation, text)
        ))
    }

    /// The rate that makes a velocity of a distance.
    fn missing_rate(&self, entity: Option<EntityId>, term: &Term, found: &Dim, needed: &Dim) -> Option<String> {
        let is_difference = matches!(&term.kind, TermKind::Arithmetic(Arithmetic::Subtract, _));
        let rate = needed.clone().plus(found, Ratio(-1, 1)).words();
        (is_difference && found.words() == "px" && rate == "1/s").then(|| {
            let declared = self.declared(entity, &rate, "4");
            format!("a distance times a rate is a velocity: declare a factor such as `{declared}`")
        })
    }

    /// A parameter of an entity with a dimension; the most similar to `name` if there are several.
    fn of_dimension(&mut self, entity: EntityId, dim: &Dim, name: &str) -> Option<String> {
        let mut fitting: Vec<&str> = Vec::new();
        for (p, param) in self.program.entities[entity].params.pairs() {
            let solution = self.named.get(&Named::Param(entity, p)).and_then(|&u| self.solved[u].clone());
            if param.name.text != name && solution.is_some_and(|(found, _)| self.reduce(&found) == *dim) {
                fitting.push(&param.name.text);
            }
        }
        similar(name, fitting.iter().copied()).or_else(|| fitting.first().map(|n| (*n).to_string()))
    }
}

impl Relation {
    fn words(self) -> String {
        match self {
            Relation::Added => "added".into(),
            Relation::Subtracted => "subtracted".into(),
            Relation::Compared => "compared".into(),
            Relation::Given(Function::If) => "the values of one `if`".into(),
            Relation::Given(function) => format!("given to one `{function:?}`").to_lowercase(),
        }
    }
}

/// A plain number among the factors of a term, and whether the term is divided by it. With `sums` also among those of
/// the parts of a sum.
fn factor(term: &Term, sums: bool) -> Option<(&Term, bool)> {
    let number = |t: &Term| matches!(t.kind, TermKind::Number(_));
    match &term.kind {
        TermKind::Negate(a) => factor(a, sums),
        TermKind::Arithmetic(op, sides) => {
            let [a, b] = sides.as_ref();
            match op {
                Arithmetic::Multiply | Arithmetic::Divide if number(a) && !number(b) => Some((a, false)),
                Arithmetic::Multiply | Arithmetic::Divide if number(b) && !number(a) => {
                    Some((b, *op == Arithmetic::Divide))
                }
                Arithmetic::Add | Arithmetic::Subtract if !sums => None,
                Arithmetic::Divide => factor(a, sums),
                _ => factor(a, sums).or_else(|| factor(b, sums)),
            }
        }
        _ => None,
    }
}

/// The names in a term that its dimension comes from.
fn leaves<'t>(term: &'t Term, out: &mut Vec<&'t Term>) {
    match &term.kind {
        TermKind::Param(..) | TermKind::Var(..) | TermKind::Discrete(..) | TermKind::Axis(_) | TermKind::Chance(_) => {
            out.push(term)
        }
        // Truth values and references have none.
        TermKind::And(_)
        | TermKind::Or(_)
        | TermKind::Near(_)
        | TermKind::Probe(_)
        | TermKind::Nearest(_)
        | TermKind::Members(_)
        | TermKind::Count(_) => {}
        _ => term.operands().iter().for_each(|operand| leaves(operand, out)),
    }
}

/// The source text of an expression on one line, shortened in the middle.
fn shown(sources: &SourceMap, at: Span) -> String {
    let words: Vec<&str> = sources.slice(at).split_whitespace().collect();
    let text = words.join(" ");
    let length = text.chars().count();
    if text.is_empty() || text.contains("//") {
        return "this value".to_string();
    }
    if length <= SHOWN {
        return format!("`{text}`");
    }
    let start: String = text.chars().take(SHOWN / 2).collect();
    let end: String = text.chars().skip(length - SHOWN / 4).collect();
    format!("`{} … {}`", start.trim_end(), end.trim_start())
}
