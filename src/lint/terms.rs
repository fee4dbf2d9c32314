//! Traversal and equality of terms.

use crate::sema::checked::{Action, DriveBy, Entity, Rate, Release, Term, TermKind, Update};

/// Calls `visit` with a term and all terms inside of it.
pub(super) fn walk<'t>(term: &'t Term, visit: &mut dyn FnMut(&'t Term)) {
    visit(term);
    for child in term.operands() {
        walk(child, visit);
    }
}

/// The terms that some actions compute.
pub(super) fn of_actions(actions: &[Action]) -> Vec<&Term> {
    let mut out = Vec::new();
    for action in actions {
        match action {
            Action::Update(update) => out.push(&update.value),
            Action::Spawn(spawn) => out.extend(spawn.given.iter().map(|(_, term)| term)),
            Action::Destroy(term) => out.push(term),
            Action::Send(send) => out.extend(send.to.iter().chain(&send.number)),
        }
    }
    out
}

/// The updates among some actions.
pub(super) fn updates(actions: &[Action]) -> impl Iterator<Item = &Update> {
    actions.iter().filter_map(|a| if let Action::Update(update) = a { Some(update) } else { None })
}

/// All terms that an entity evaluates while its world runs.
pub(super) fn of_entity(entity: &Entity) -> Vec<&Term> {
    let mut out: Vec<&Term> = Vec::new();
    let drives = entity.drives.iter().chain(entity.modes.iter().flat_map(|m| &m.drives));
    out.extend(drives.filter_map(|d| if let DriveBy::Flow(term) = &d.by { Some(term) } else { None }));
    for mode in entity.modes.iter() {
        out.extend(&mode.initial_when);
        out.extend(of_actions(&mode.entry));
        for follow in &mode.follows {
            out.extend(&follow.guard);
            out.extend(of_actions(&follow.actions));
        }
    }
    for edge in entity.edges.iter() {
        out.push(&edge.guard);
        out.extend(of_actions(&edge.actions));
    }
    for collider in entity.colliders.iter() {
        out.extend(collider.shape.numbers());
        out.extend(&collider.guard);
    }
    for envelope in entity.envelopes.iter() {
        let of_rate = |rate| match rate {
            &Rate::Instant => None,
            Rate::Accel(term) | Rate::Over(term) => Some(term),
        };
        out.extend(of_rate(&envelope.attack));
        out.extend(of_rate(&envelope.decay));
        out.extend(&envelope.peak);
        out.push(&envelope.sustain);
        out.extend(&envelope.sustain_for);
        if let Release::To(rate, level) = &envelope.release {
            out.extend(of_rate(rate));
            out.extend(level);
        }
        out.extend(&envelope.driven_while);
    }
    for clamp in &entity.clamps {
        out.extend(&clamp.low);
        out.extend(&clamp.high);
    }
    out.extend(&entity.invariants);
    out
}

/// Whether two terms of one entity are equal, regardless of their places.
pub(super) fn same(a: &Term, b: &Term) -> bool {
    let inside = |a: &Term, b: &Term| {
        let (a, b) = (a.operands(), b.operands());
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b))
    };
    match (&a.kind, &b.kind) {
        (TermKind::Negate(_), TermKind::Negate(_))
        | (TermKind::Not(_), TermKind::Not(_))
        | (TermKind::And(..), TermKind::And(..))
        | (TermKind::Or(..), TermKind::Or(..))
        | (TermKind::Count(..), TermKind::Count(..)) => inside(a, b),
        (TermKind::Arithmetic(f, ..), TermKind::Arithmetic(g, ..)) => f == g && inside(a, b),
        (TermKind::Compare(f, ..), TermKind::Compare(g, ..)) => f == g && inside(a, b),
        (TermKind::Call(f), TermKind::Call(g)) => f.0 == g.0 && inside(a, b),
        (TermKind::Near(f), TermKind::Near(g)) => f.0 == g.0 && inside(a, b),
        (TermKind::Distance(f), TermKind::Distance(g)) => f.0 == g.0 && inside(a, b),
        (TermKind::Members(f), TermKind::Members(g)) => f.of == g.of && inside(a, b),
        (TermKind::Nearest(f), TermKind::Nearest(g)) => {
            (f.of, f.bound.is_some()) == (g.of, g.bound.is_some()) && inside(a, b)
        }
        (TermKind::Probe(f), TermKind::Probe(g)) => {
            (f.mine, f.other, f.bound.is_some()) == (g.mine, g.other, g.bound.is_some()) && inside(a, b)
        }
        (f, g) => a.operands().is_empty() && b.operands().is_empty() && f == g,
    }
}
