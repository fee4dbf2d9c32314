//! Guards that never hold, or always do, by the values of what they read.

use std::collections::{BTreeMap, BTreeSet};

use crate::diagnostic::catalogue::values::{GuardByValue, Reason};
use crate::diagnostic::{Code, Diagnostics};
use crate::ir::{Drive, EdgeId, Expr, ExprId, Id, LeafId};
use crate::source::Span;

use super::super::configuration::Configuration;
use super::super::evaluate::Truth;
use super::judge::{Judge, Reads};
use super::{Occurrence, Subject, words};

/// What else tells that a guard is of no use.
pub(super) const SAID: &[Code] = &[
    Code::ConstantGuard,
    Code::UnreachableMode,
    Code::Trap,
    Code::Shadowed,
    Code::UncarriedTag,
    Code::UnpairedTouch,
    Code::NoPlayer,
];

/// A guard, and the leaves in which it is looked at; all if none.
pub(super) struct Site {
    pub guard: ExprId,
    pub edge: Option<EdgeId>,
    leaves: Option<BTreeSet<LeafId>>,
}

impl Site {
    fn is_asked(&self, at: &Configuration) -> bool {
        self.leaves.as_ref().is_none_or(|leaves| at.leaves.iter().any(|l| leaves.contains(l)))
    }

    fn leaf(&self, at: &Configuration) -> Option<LeafId> {
        let leaves = self.leaves.as_ref()?;
        at.leaves.iter().copied().find(|l| leaves.contains(l))
    }

    /// The cases in which it is looked at.
    fn cases<'s, 'a>(&self, subject: &'s Subject<'a>) -> Vec<(&'s Occurrence<'a>, &'a Configuration)> {
        subject.configurations().filter(|(_, c)| self.is_asked(c)).collect()
    }

    /// How an expression in it turns out in any of these cases.
    fn truth(
        &self,
        subject: &Subject<'_>,
        judge: &Judge<'_>,
        id: ExprId,
        cases: &[(&Occurrence<'_>, &Configuration)],
    ) -> Truth {
        let mut truth = Truth { can_hold: false, can_fail: false };
        for (o, c) in cases {
            truth = truth.joined(judge.truth(&o.reader(subject.scene.program, c), id));
            if truth == Truth::EITHER {
                break;
            }
        }
        truth
    }

    /// Whether it never (false) or always (true) holds, by the values.
    pub fn verdict(&self, subject: &Subject<'_>, judge: &Judge<'_>) -> Option<bool> {
        let cases = self.cases(subject);
        if cases.is_empty() || matches!(subject.scene.program.exprs[self.guard], Expr::Bool(_)) {
            return None;
        }
        match self.truth(subject, judge, self.guard, &cases) {
            Truth { can_hold: false, .. } => Some(false),
            Truth { can_fail: false, .. } => Some(true),
            _ => None,
        }
    }

    /// The part of it that decides, and what the values are there.
    pub fn reason(&self, subject: &Subject<'_>, judge: &Judge<'_>, holds: bool) -> Reason {
        let cases = self.cases(subject);
        let program = subject.scene.program;
        let mut part = self.guard;
        while let (Expr::And(a, b), false) | (Expr::Or(a, b), true) = (program.exprs[part], holds) {
            let decides = |id: &ExprId| {
                let truth = self.truth(subject, judge, *id, &cases);
                if holds { !truth.can_fail } else { !truth.can_hold }
            };
            match [a, b].into_iter().find(decides) {
                Some(next) => part = next,
                None => break,
            }
        }
        let reads = Reads::of(program, part);
        let (values, notes) = words::reason(subject, &reads, &cases, |c| self.leaf(c));
        let at = program.spans.exprs[part];
        let text = subject.scene.sources.slice(at);
        let text = (text.len() <= 60 && !text.contains('\n') && !text.is_empty()).then(|| text.to_string());
        Reason { at, text, values, notes }
    }
}

/// Every guard of an entity that is read against the state as a step begins, or that reads nothing that moves.
pub(super) fn sites(subject: &Subject<'_>) -> Vec<Site> {
    let (entity, program) = (subject.entity, subject.scene.program);
    let mut of_edges: BTreeMap<EdgeId, BTreeSet<LeafId>> = BTreeMap::new();
    let mut of_follows = BTreeMap::new();
    let mut of_envelopes = BTreeMap::new();
    for (id, leaf) in entity.leaves.pairs() {
        for &edge in leaf.edges.iter().chain(&leaf.internal) {
            of_edges.entry(edge).or_default().insert(id);
        }
        for &follow in &leaf.follows {
            of_follows.entry(follow).or_insert_with(BTreeSet::new).insert(id);
        }
        for drive in &leaf.drives {
            if let Drive::Envelope(envelope, _) = drive {
                of_envelopes.entry(*envelope).or_insert_with(BTreeSet::new).insert(id);
            }
        }
    }
    let mut out: Vec<Site> = of_edges
        .into_iter()
        .map(|(edge, leaves)| Site { guard: entity.edges[edge].guard, edge: Some(edge), leaves: Some(leaves) })
        .collect();
    for (follow, leaves) in of_follows {
        let guard = entity.follows[follow].guard;
        out.extend(guard.map(|guard| Site { guard, edge: None, leaves: Some(leaves) }));
    }
    // These are read in the middle of a step, when modes and discrete variables alone are as they are after it.
    let is_settled = |guard: &ExprId| {
        let reads = Reads::of(program, *guard);
        !reads.motion && reads.timers.is_empty()
    };
    for collider in entity.colliders.iter() {
        let guard = collider.guard.filter(is_settled);
        out.extend(guard.map(|guard| Site { guard, edge: None, leaves: None }));
    }
    for (envelope, leaves) in of_envelopes {
        let guard = entity.envelopes[envelope].guard.filter(is_settled);
        out.extend(guard.map(|guard| Site { guard, edge: None, leaves: Some(leaves) }));
    }
    out
}

/// Reports guards that values decide; not those of the edges that explain why a mode is never entered.
pub(super) fn guards(subject: &Subject<'_>, explained: &BTreeSet<EdgeId>, found: &mut Diagnostics) {
    let judge = Judge::new(subject);
    let scene = subject.scene;
    for site in sites(subject) {
        if site.edge.is_some_and(|e| explained.contains(&e)) {
            continue;
        }
        let Some(holds) = site.verdict(subject, &judge) else { continue };
        let span = scene.program.spans.exprs[site.guard];
        if scene.said.of(SAID, span, scene.sources) || !is_said_everywhere(subject, span, holds) {
            continue;
        }
        found.report(GuardByValue { holds, reason: site.reason(subject, &judge, holds) });
    }
}

/// Whether all uses of a behaviour agree about a guard in it.
fn is_said_everywhere(subject: &Subject<'_>, at: Span, holds: bool) -> bool {
    if !at.is_copy() {
        return true;
    }
    let scene = subject.scene;
    let (original, _) = scene.sources.trace(at);
    scene.program.entities.ids().all(|id| {
        let other = scene.subject(id);
        let judge = Judge::new(&other);
        sites(&other)
            .iter()
            .filter(|s| scene.sources.trace(scene.program.spans.exprs[s.guard]).0 == original)
            .all(|s| other.is_known && s.verdict(&other, &judge) == Some(holds))
    })
}

/// Which modes can be active.
pub(super) fn live(subject: &Subject<'_>) -> BTreeSet<LeafId> {
    subject.configurations().flat_map(|(_, c)| c.leaves.iter().copied()).collect()
}

/// Whether a leaf of a range is among some.
pub(super) fn any_of(leaves: &BTreeSet<LeafId>, (first, after): (LeafId, LeafId)) -> bool {
    debug_assert!(first.index() <= after.index());
    leaves.range(first..after).next().is_some()
}
