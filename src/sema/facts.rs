//! What is known where an expression is: references that were tested, instances that a guard named. A guard tells
//! what follows it in the same `and`, the updates of its edge, and the branches of an `if`.

use crate::ir::{EntityId, IdVec, ModeId, RefId, Subject, TouchId};

use crate::source::Span;
use crate::syntax::ast::Name;

use super::checked::{BoundTouch, Term, TermKind};
use super::names::Known;

/// What is known at the place that is being checked, and what was met on the way there.
#[derive(Debug, Default)]
pub(super) struct Facts {
    /// References that are not none here, with their entity where that is known.
    known: Vec<(Subject, Option<EntityId>)>,
    /// Names that `as` gave, in scope here.
    names: Vec<(Name, TouchId)>,
    /// Whether `as` may name something here.
    pub bindable: bool,
    /// The contact questions of the entity whose answers are named.
    pub bound: IdVec<TouchId, BoundTouch>,
    /// References read here that nothing but an edge on `lost` covers.
    pub needs: Vec<RefId>,
    /// All such reads of the entity: the mode with the edge, the reference, the place.
    pub covered: Vec<(ModeId, RefId, Span)>,
}

/// A point to go back to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mark {
    known: usize,
    names: usize,
}

impl Facts {
    pub fn mark(&self) -> Mark {
        Mark { known: self.known.len(), names: self.names.len() }
    }

    /// Forgets what was learnt since the mark.
    pub fn forget(&mut self, mark: Mark) {
        self.known.truncate(mark.known);
        self.names.truncate(mark.names);
    }

    /// Learns what a guard says if it has this outcome.
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

    /// The entity that a reference is known to be of.
    pub fn entity(&self, subject: Subject) -> Option<EntityId> {
        self.known.iter().rev().filter(|(s, _)| *s == subject).find_map(|(_, e)| *e)
    }

    /// Returns a name to the answer of a contact question.
    pub fn name(&mut self, name: &Name, question: BoundTouch) -> TouchId {
        let same = |b: &BoundTouch| (b.mine, b.other, b.side) == (question.mine, question.other, question.side);
        let id = self.bound.find(same).unwrap_or_else(|| self.bound.push(question));
        self.names.push((name.clone(), id));
        id
    }

    /// What a name was given to.
    pub fn named(&self, name: &str) -> Option<TouchId> {
        self.names.iter().rev().find(|(n, _)| n.text == name).map(|(_, id)| *id)
    }

    /// Where a name was given.
    pub fn named_at(&self, name: &str) -> Option<Span> {
        self.names.iter().rev().find(|(n, _)| n.text == name).map(|(n, _)| n.span)
    }

    /// All names in scope.
    pub fn names(&self) -> impl Iterator<Item = Known<'_>> {
        self.names.iter().map(|(n, _)| Known::from(n))
    }
}
