//! Flow-sensitive facts: references that were tested, instances that a guard bound. A guard provides facts to the rest
//! of the same `and`, the updates of its edge, and the branches of an `if`.

use crate::ir::{EntityId, IdVec, ModeId, ProbeId, RefId, Subject, TouchId};

use crate::source::Span;
use crate::syntax::ast::Name;

use super::checked::{BoundProbe, BoundTouch, Term, TermKind};
use super::names::Candidate;

/// The facts at the current expression, and data collected on the way.
#[derive(Debug, Default)]
pub(super) struct Facts {
    /// References that are not none here, with their entity if known.
    known: Vec<(Subject, Option<EntityId>)>,
    /// Names bound by `as`, in scope here.
    names: Vec<(Name, Subject)>,
    /// Whether `as` may bind a name here.
    pub bindable: bool,
    /// The bound contact queries of the entity.
    pub bound: IdVec<TouchId, BoundTouch>,
    /// The entity whose instances a question asks one by one here.
    pub member: Option<EntityId>,
    /// The bound probes of the entity.
    pub probes: IdVec<ProbeId, BoundProbe>,
    /// References read here that only an edge on `lost` covers.
    pub needs: Vec<RefId>,
    /// All such reads of the entity: the mode with the edge, the reference, the span.
    pub covered: Vec<(ModeId, RefId, Span)>,
}

/// A restore point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mark {
    known: usize,
    names: usize,
}

impl Facts {
    pub fn mark(&self) -> Mark {
        Mark { known: self.known.len(), names: self.names.len() }
    }

    /// Drops all facts learned since the mark.
    pub fn forget(&mut self, mark: Mark) {
        self.known.truncate(mark.known);
        self.names.truncate(mark.names);
    }

    /// Adds the facts that a guard implies if it has this outcome.
    pub fn learn(&mut self, guard: &Term, outcome: bool) {
        match (&guard.kind, outcome) {
            (TermKind::And(sides), true) | (TermKind::Or(sides), false) => {
                sides.iter().for_each(|side| self.learn(side, outcome));
            }
            (TermKind::Not(a), _) => self.learn(a, !outcome),
            (TermKind::Is(subject, entity), true) => self.known.push((*subject, Some(*entity))),
            (TermKind::IsNone(subject), false) => self.known.push((*subject, None)),
            (TermKind::Touching(asked), true) => {
                self.known.extend(asked.bound.map(|touch| (Subject::Touched(touch), None)));
            }
            (TermKind::Probe(asked), true) => {
                self.known.extend(asked.bound.map(|probe| (Subject::Probed(probe), None)));
            }
            (TermKind::Nearest(asked), true) => {
                self.known.extend(asked.bound.map(|probe| (Subject::Probed(probe), Some(asked.of))));
            }
            _ => {}
        }
    }

    /// Whether a reference is known not to be none.
    pub fn is_set(&self, subject: Subject) -> bool {
        self.known.iter().any(|(s, _)| *s == subject)
    }

    /// The references of the entity itself that are known not to be none.
    pub fn set_refs(&self) -> Vec<RefId> {
        self.known.iter().filter_map(|(s, _)| if let Subject::Ref(id) = s { Some(*id) } else { None }).collect()
    }

    /// The known entity of a reference.
    pub fn entity(&self, subject: Subject) -> Option<EntityId> {
        self.known.iter().rev().filter(|(s, _)| *s == subject).find_map(|(_, e)| *e)
    }

    /// Binds a name to a contact query.
    pub fn name(&mut self, name: &Name, question: BoundTouch) -> TouchId {
        let same = |b: &BoundTouch| (b.mine, b.other, b.side) == (question.mine, question.other, question.side);
        let id = self.bound.find(same).unwrap_or_else(|| self.bound.push(question));
        self.names.push((name.clone(), Subject::Touched(id)));
        id
    }

    /// Binds a name to a probe.
    pub fn name_probe(&mut self, name: &Name, probe: BoundProbe) -> ProbeId {
        let id = self.probes.push(probe);
        self.names.push((name.clone(), Subject::Probed(id)));
        id
    }

    /// The instance that a name stands for.
    pub fn named(&self, name: &str) -> Option<Subject> {
        self.names.iter().rev().find(|(n, _)| n.text == name).map(|(_, id)| *id)
    }

    /// The span where a name was bound.
    pub fn named_at(&self, name: &str) -> Option<Span> {
        self.names.iter().rev().find(|(n, _)| n.text == name).map(|(n, _)| n.span)
    }

    /// All names in scope.
    pub fn names(&self) -> impl Iterator<Item = Candidate<'_>> {
        self.names.iter().map(|(n, _)| Candidate::from(n))
    }
}
