//! Joint transitions: a group whose guards depend on transitions of another group in the same step is decided after it.

use crate::diagnostic::catalogue::structure::JointCycle;
use crate::ir::{GroupId, Id, IdVec};
use crate::source::Span;

use super::Checker;
use super::checked::{Entity, Term, TermKind};

impl Checker<'_> {
    /// The groups in the order of decision; reports cyclic dependencies.
    pub(super) fn group_order(&mut self, entity: &Entity) -> Vec<GroupId> {
        let mut waits: IdVec<GroupId, Vec<(GroupId, Span)>> = entity.groups.iter().map(|_| Vec::new()).collect();
        for edge in entity.edges.iter().filter(|e| e.target.is_some()) {
            let group = entity.modes[edge.source].group;
            collect(entity, &edge.guard, &mut waits[group]);
        }
        let mut order = Vec::new();
        let mut done = vec![false; entity.groups.len()];
        while order.len() < entity.groups.len() {
            let free = |g: GroupId| waits[g].iter().all(|(other, _)| done[other.index()]);
            match entity.groups.ids().find(|g| !done[g.index()] && free(*g)) {
                Some(next) => {
                    done[next.index()] = true;
                    order.push(next);
                }
                None => {
                    self.report_cycle(entity, &waits, &done);
                    return entity.groups.ids().collect();
                }
            }
        }
        order
    }

    /// Follows dependencies until a group repeats.
    fn report_cycle(&mut self, entity: &Entity, waits: &IdVec<GroupId, Vec<(GroupId, Span)>>, done: &[bool]) {
        let mut chain: Vec<(GroupId, Span)> = Vec::new();
        let Some(mut at) = entity.groups.ids().find(|g| !done[g.index()]) else { return };
        loop {
            let Some(&(next, span)) = waits[at].iter().find(|(other, _)| !done[other.index()]) else { return };
            if let Some(first) = chain.iter().position(|(g, _)| *g == at) {
                chain.drain(..first);
                break;
            }
            chain.push((at, span));
            at = next;
        }
        let name = |g: GroupId| match &entity.groups[g].name {
            Some(name) => format!("`{}`", name.text),
            None => "the modes".to_string(),
        };
        let steps = chain.iter().map(|(g, span)| (name(*g), *span)).collect();
        self.diagnostics.report(JointCycle { steps });
    }
}

/// The groups on whose transitions a guard depends, with the spans.
fn collect(entity: &Entity, term: &Term, out: &mut Vec<(GroupId, Span)>) {
    match &term.kind {
        TermKind::Joint { mode, .. } => out.push((entity.modes[*mode].group, term.span)),
        _ => term.operands().iter().for_each(|operand| collect(entity, operand, out)),
    }
}
