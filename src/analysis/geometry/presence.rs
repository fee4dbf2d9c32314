//! The leaves in which a collider is active, if its guard depends only on the instance's modes: they change only in the
//! discrete phase, so whether it was active in the last collision phase is known when a step begins.

use std::collections::BTreeSet;

use crate::ir::{Entity, Expr, ExprId, GroupId, Id, IdRange, LeafId, Program, Subject};

use crate::analysis::domain::truth::Truth;

/// When a collider is active.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::analysis) enum Presence {
    Always,
    Never,
    /// While the active leaf of a group is in a range.
    In {
        group: GroupId,
        leaves: IdRange<LeafId>,
        /// All leaves of the group.
        all: IdRange<LeafId>,
    },
    Not(Box<Presence>),
    Both(Box<Presence>, Box<Presence>),
    Either(Box<Presence>, Box<Presence>),
}

impl Presence {
    /// `None` if a guard depends on more than modes.
    pub fn of(program: &Program, entity: &Entity, guard: Option<ExprId>) -> Option<Presence> {
        let Some(guard) = guard else { return Some(Presence::Always) };
        let of = |id: ExprId| Presence::of(program, entity, Some(id)).map(Box::new);
        Some(match program.exprs[guard] {
            Expr::Bool(true) => Presence::Always,
            Expr::Bool(false) => Presence::Never,
            Expr::InMode(Subject::Me, mode) => {
                let mode = &entity.modes[mode];
                let all = entity.leaves_of(&entity.groups[mode.group]);
                Presence::In { group: mode.group, leaves: mode.leaves, all }
            }
            Expr::Not(a) => Presence::Not(of(a)?),
            Expr::And(a, b) => Presence::Both(of(a)?, of(b)?),
            Expr::Or(a, b) => Presence::Either(of(a)?, of(b)?),
            _ => return None,
        })
    }

    /// Whether the collider is active, given the active leaf of each group.
    pub fn holds(&self, leaf: &impl Fn(GroupId) -> LeafId) -> bool {
        match self {
            Presence::Always => true,
            Presence::Never => false,
            Presence::In { group, leaves, .. } => leaves.contains(leaf(*group)),
            Presence::Not(a) => !a.holds(leaf),
            Presence::Both(a, b) => a.holds(leaf) && b.holds(leaf),
            Presence::Either(a, b) => a.holds(leaf) || b.holds(leaf),
        }
    }

    /// Whether the collider is active in some leaves, one for each group.
    pub fn is_there(&self, leaves: &[LeafId]) -> bool {
        self.holds(&|group: GroupId| leaves[group.index()])
    }

    /// Whether it can be active and whether it can be inactive, if each group is in any of some leaves.
    pub fn among(&self, active: &BTreeSet<LeafId>) -> Truth {
        match self {
            Presence::Always => Truth::of(true),
            Presence::Never => Truth::of(false),
            Presence::In { leaves: inside, all, .. } => Truth {
                can_hold: active.range(inside.from..inside.to).next().is_some(),
                can_fail: active.range(all.from..all.to).any(|leaf| !inside.contains(*leaf)),
            },
            Presence::Not(a) => {
                let Truth { can_hold, can_fail } = a.among(active);
                Truth { can_hold: can_fail, can_fail: can_hold }
            }
            Presence::Both(a, b) => {
                let (a, b) = (a.among(active), b.among(active));
                Truth { can_hold: a.can_hold && b.can_hold, can_fail: a.can_fail || b.can_fail }
            }
            Presence::Either(a, b) => {
                let (a, b) = (a.among(active), b.among(active));
                Truth { can_hold: a.can_hold || b.can_hold, can_fail: a.can_fail && b.can_fail }
            }
        }
    }

    /// The groups that it depends on.
    pub fn groups(&self, out: &mut BTreeSet<GroupId>) {
        match self {
            Presence::Always | Presence::Never => {}
            Presence::In { group, .. } => {
                out.insert(*group);
            }
            Presence::Not(a) => a.groups(out),
            Presence::Both(a, b) | Presence::Either(a, b) => {
                a.groups(out);
                b.groups(out);
            }
        }
    }
}

/// The condition under which an instance is kept out of blocking obstacles.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::analysis) enum KeptOut {
    Always,
    /// While at least one of some colliders is active.
    While(Vec<Presence>),
}

impl Default for KeptOut {
    /// Never.
    fn default() -> Self {
        KeptOut::While(Vec::new())
    }
}

impl KeptOut {
    /// Whether it holds, given the active leaf of each group.
    pub fn holds(&self, leaf: &impl Fn(GroupId) -> LeafId) -> bool {
        match self {
            KeptOut::Always => true,
            KeptOut::While(any) => any.iter().any(|presence| presence.holds(leaf)),
        }
    }

    /// Whether it holds in some leaves, one for each group.
    pub fn holds_for(&self, leaves: &[LeafId]) -> bool {
        self.holds(&|group: GroupId| leaves[group.index()])
    }
}
