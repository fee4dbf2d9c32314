//! Guards that never hold or always hold, given the values that they read.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use crate::diagnostic::catalogue::values::{GuardByValue, Reason};
use crate::diagnostic::{Code, Diagnostics};
use crate::ir::{Drive, EdgeId, Entity, Expr, ExprId, Id, IdRange, Leaf, LeafId, Program};
use crate::source::Span;

use super::atoms::{Atom, Judge, Reads, atoms, case};
use super::summary::{EntitySummary, Occurrence};
use super::value_text::Case;
use super::{Context, EntitySummaries, value_text};
use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::truth::Truth;

/// Codes that already explain why a guard is useless.
pub(super) const EXPLAINING_CODES: &[Code] = &[
    Code::ConstantGuard,
    Code::UnreachableMode,
    Code::Trap,
    Code::Shadowed,
    Code::UncarriedTag,
    Code::UnpairedTouch,
    Code::NoPlayer,
];

/// A guard and its outcomes wherever it is evaluated.
pub(super) struct Site {
    pub guard: ExprId,
    pub edge: Option<EdgeId>,
    /// The leaves in which it is evaluated, in order; `None` means all.
    leaves: Option<Vec<LeafId>>,
    /// Whether it is evaluated anywhere.
    is_evaluated: bool,
    /// An over-approximation of its outcomes.
    truth: Truth,
    /// As long as only one outcome is possible: the distinct outcomes of its atoms, concatenated in order.
    cases: Vec<u8>,
}

impl Site {
    fn new(guard: ExprId, edge: Option<EdgeId>, leaves: Option<Vec<LeafId>>) -> Self {
        let truth = Truth { can_hold: false, can_fail: false };
        Site { guard, edge, leaves, is_evaluated: false, truth, cases: Vec::new() }
    }

    fn is_evaluated_in(&self, active: &[LeafId]) -> bool {
        self.leaves.is_none() || self.leaf(active).is_some()
    }

    fn leaf(&self, active: &[LeafId]) -> Option<LeafId> {
        let leaves = self.leaves.as_ref()?;
        active.iter().copied().find(|l| leaves.binary_search(l).is_ok())
    }

    /// Whether values can decide it.
    pub fn can_be_decided(&self, program: &Program, entity: &Entity) -> bool {
        !atoms(program, entity, self.guard).is_empty()
    }

    /// Evaluates it in some cases.
    pub fn add(&mut self, program: &Program, entity: &Entity, cases: &[(&Occurrence<'_>, &Configuration)]) {
        if self.truth == Truth::EITHER || matches!(program.exprs[self.guard], Expr::Bool(_)) {
            return;
        }
        let mut asked = cases.iter().filter(|(_, c)| self.is_evaluated_in(&c.leaves)).peekable();
        if asked.peek().is_none() {
            return;
        }
        let atoms = atoms(program, entity, self.guard);
        let judge = Judge::early(program);
        let (mut truth, mut known) = (self.truth, self.cases.clone());
        for (o, c) in asked {
            let case = case(&atoms, &o.reader(program, c));
            truth = truth.joined(judge.truth(&atoms, &case, self.guard));
            if truth == Truth::EITHER {
                known = Vec::new();
                break;
            }
            keep(&mut known, &case);
        }
        (self.is_evaluated, self.truth, self.cases) = (true, truth, known);
    }

    /// The outcomes of a part of it over all cases.
    fn truth(&self, judge: &Judge<'_>, atoms: &[Atom], id: ExprId) -> Truth {
        if self.truth == Truth::EITHER {
            return Truth::EITHER;
        }
        if atoms.is_empty() {
            return judge.truth(atoms, &[], id);
        }
        let cases = self.cases.chunks(atoms.len()).map(|case| judge.truth(atoms, case, id));
        cases.reduce(Truth::joined).unwrap_or(self.truth)
    }

    /// `Some(false)` if it never holds, `Some(true)` if it always holds.
    pub fn verdict(&self, subject: &EntitySummary<'_>, judge: &Judge<'_>) -> Option<bool> {
        if !self.is_evaluated || self.truth == Truth::EITHER {
            return None;
        }
        let atoms = atoms(subject.context.program, subject.entity, self.guard);
        match self.truth(judge, &atoms, self.guard) {
            Truth { can_hold: false, .. } => Some(false),
            Truth { can_fail: false, .. } => Some(true),
            _ => None,
        }
    }

    /// The subexpression that decides it, and the values there.
    pub fn reason(&self, subject: &EntitySummary<'_>, judge: &Judge<'_>, holds: bool) -> Reason {
        let program = subject.context.program;
        let atoms = atoms(program, subject.entity, self.guard);
        let mut part = self.guard;
        while let (Expr::And(a, b), false) | (Expr::Or(a, b), true) = (program.exprs[part], holds) {
            let decides = |id: &ExprId| {
                let truth = self.truth(judge, &atoms, *id);
                if holds { !truth.can_fail } else { !truth.can_hold }
            };
            // The expression of a condition is elsewhere, and may be decided otherwise in its other uses.
            let is_written_here = |id: &ExprId| program.spans.exprs[part].contains(program.spans.exprs[*id]);
            match [a, b].into_iter().find(decides) {
                Some(next) if is_written_here(&next) => part = next,
                _ => break,
            }
        }
        let reads = Reads::of(program, part);
        let asked = subject.cases.iter().filter(|(leaves, _)| self.is_evaluated_in(leaves));
        let cases: Vec<Case<'_>> = asked.map(|(leaves, seen)| (leaves.as_slice(), seen)).collect();
        let (values, notes) = value_text::reason(subject.entity, &reads, &cases, |leaves| self.leaf(leaves));
        let at = program.spans.exprs[part];
        let text = subject.context.sources.slice(at);
        let text = (text.len() <= 60 && !text.contains('\n') && !text.is_empty()).then(|| text.to_string());
        Reason { at, text, values, notes }
    }
}

/// Inserts a case into the sorted list of cases of the same length, unless it is present.
fn keep(known: &mut Vec<u8>, case: &[u8]) {
    let (mut low, mut high) = (0, known.len().checked_div(case.len()).unwrap_or(0));
    while low < high {
        let middle = low.midpoint(high);
        let at = middle * case.len();
        match known[at..at + case.len()].cmp(case) {
            Ordering::Less => low = middle + 1,
            Ordering::Equal => return,
            Ordering::Greater => high = middle,
        }
    }
    let at = low * case.len();
    known.splice(at..at, case.iter().copied());
}

/// For each of `count` entries, the leaves that list it, in order.
fn by_leaf<I: Id>(entity: &Entity, count: usize, of: impl Fn(&Leaf) -> Vec<I>) -> Vec<(I, Vec<LeafId>)> {
    let mut out = vec![Vec::new(); count];
    for (id, leaf) in entity.leaves.pairs() {
        for entry in of(leaf) {
            let leaves: &mut Vec<LeafId> = &mut out[entry.index()];
            if leaves.last() != Some(&id) {
                leaves.push(id);
            }
        }
    }
    let entries = out.into_iter().enumerate().filter(|(_, leaves)| !leaves.is_empty());
    entries.map(|(index, leaves)| (I::from_index(index), leaves)).collect()
}

/// All guards of an entity that are evaluated on the state at the start of a step, or that do not read motion.
pub(super) fn sites(program: &Program, entity: &Entity) -> Vec<Site> {
    let edges = by_leaf(entity, entity.edges.len(), |l| l.edges.iter().chain(&l.internal).copied().collect());
    let mut out: Vec<Site> = edges
        .into_iter()
        .map(|(edge, leaves): (EdgeId, _)| Site::new(entity.edges[edge].guard, Some(edge), Some(leaves)))
        .collect();
    for (follow, leaves) in by_leaf(entity, entity.follows.len(), |l| l.follows.clone()) {
        let guard = entity.follows[follow].guard;
        out.extend(guard.map(|guard| Site::new(guard, None, Some(leaves))));
    }
    // These are evaluated in the middle of a step, when only modes and discrete variables have their final values.
    let is_settled = |guard: &ExprId| {
        let reads = Reads::of(program, *guard);
        !reads.motion && reads.timers.is_empty()
    };
    for collider in entity.colliders.iter() {
        let guard = collider.guard.filter(is_settled);
        out.extend(guard.map(|guard| Site::new(guard, None, None)));
    }
    let driving = |drive: &Drive| match drive {
        Drive::Envelope(id, _) => Some(*id),
        Drive::Coast(_) | Drive::Flow { .. } => None,
    };
    let envelopes = by_leaf(entity, entity.envelopes.len(), |l| l.drives.iter().filter_map(driving).collect());
    for (envelope, leaves) in envelopes {
        let guard = entity.envelopes[envelope].guard.filter(is_settled);
        out.extend(guard.map(|guard| Site::new(guard, None, Some(leaves))));
    }
    out
}

/// Reports guards that values decide, except those of edges that explain why a mode is never entered.
pub(super) fn guards(
    subject: &EntitySummary<'_>,
    summaries: &EntitySummaries<'_>,
    explained: &BTreeSet<EdgeId>,
    found: &mut Diagnostics,
) {
    let judge = Judge::new(subject);
    let context = subject.context;
    for site in &subject.sites {
        if site.edge.is_some_and(|e| explained.contains(&e)) {
            continue;
        }
        let Some(holds) = site.verdict(subject, &judge) else { continue };
        let span = context.program.spans.exprs[site.guard];
        if context.reported.of(EXPLAINING_CODES, span, context.sources)
            || !all_copies_agree(context, summaries, span, holds)
        {
            continue;
        }
        found.report(GuardByValue { holds, reason: site.reason(subject, &judge, holds) });
    }
}

/// Whether a guard in a behaviour has the same verdict in all its copies.
fn all_copies_agree(context: &Context<'_>, summaries: &EntitySummaries<'_>, at: Span, holds: bool) -> bool {
    if !at.is_copy() {
        return true;
    }
    let (original, _) = context.sources.trace(at);
    let is_it = |s: &&Site| context.sources.trace(context.program.spans.exprs[s.guard]).0 == original;
    context.program.entities.pairs().all(|(id, entity)| match summaries.get(&id) {
        Some(other) => {
            let judge = Judge::new(other);
            other.sites.iter().filter(is_it).all(|s| other.is_known && s.verdict(other, &judge) == Some(holds))
        }
        // Nothing is known about entities that were not examined.
        None => !sites(context.program, entity).iter().any(|s| is_it(&s)),
    })
}

/// Whether the set contains a leaf of the range.
pub(super) fn any_of(leaves: &BTreeSet<LeafId>, of: IdRange<LeafId>) -> bool {
    leaves.range(of.from..of.to).next().is_some()
}
