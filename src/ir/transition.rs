//! The effect of an edge on the modes of its group: which modes it keeps, exits and enters, and which timers restart.
//! The simulator and the analysis share this code: if they differed, proofs would be unsound.

use super::{Entity, Group, GroupId, Id, IdRange, LeafId, ModeId, TimerId};

/// A taken edge, with the leaf before and after.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// The group whose modes change.
    pub group: GroupId,
    /// The previous leaf.
    pub from: LeafId,
    /// The target of the edge.
    pub target: ModeId,
    /// The new leaf.
    pub to: LeafId,
}

impl Transition {
    /// Whether it neither exits nor enters a mode: an active proper ancestor of the target.
    pub fn keeps(self, entity: &Entity, mode: ModeId) -> bool {
        mode < self.target && self.target < entity.modes[mode].end && entity.is_active_in(mode, self.from)
    }

    /// Whether it exits a mode.
    pub fn leaves(self, entity: &Entity, mode: ModeId) -> bool {
        entity.is_active_in(mode, self.from) && !self.keeps(entity, mode)
    }

    /// Whether it enters a mode, possibly from the mode itself.
    pub fn enters(self, entity: &Entity, mode: ModeId) -> bool {
        entity.is_active_in(mode, self.to) && !self.keeps(entity, mode)
    }

    /// The modes that it enters, from the outermost in, as their entries run.
    pub fn entered(self, entity: &Entity) -> impl Iterator<Item = ModeId> + '_ {
        let path = entity.leaves[self.to].path.iter().copied();
        path.filter(move |mode| !self.keeps(entity, *mode))
    }

    /// The timers of its group that restart: those of all modes except the ones that it keeps.
    pub fn resets(self, entity: &Entity) -> impl Iterator<Item = TimerId> + '_ {
        let inside = entity.groups[self.group].modes;
        let kept = move |mode: ModeId| entity.is_active_in(mode, self.to) && self.keeps(entity, mode);
        let of_group = entity.timers.pairs().filter(move |(_, timer)| inside.contains(timer.mode));
        of_group.filter(move |(_, timer)| !kept(timer.mode)).map(|(id, _)| id)
    }
}

impl Entity {
    /// Whether a mode is active while a leaf is.
    pub fn is_active_in(&self, mode: ModeId, leaf: LeafId) -> bool {
        self.modes[mode].leaves.contains(leaf)
    }

    /// Whether a mode is another one or a descendant of it.
    pub fn is_inside(&self, mode: ModeId, outer: ModeId) -> bool {
        outer <= mode && mode < self.modes[outer].end
    }

    /// The leaves of a group.
    pub fn leaves_of(&self, group: &Group) -> IdRange<LeafId> {
        let last = ModeId::from_index(group.modes.to.index() - 1);
        IdRange::new(self.modes[group.modes.from].leaves.from, self.modes[last].leaves.to)
    }

    /// The leaves that can become active when a mode is entered; parameters may decide between them.
    pub fn enterable(&self, mode: ModeId) -> IdRange<LeafId> {
        let mode = &self.modes[mode];
        match mode.chooses {
            true => mode.leaves,
            false => IdRange::new(mode.initial, LeafId(mode.initial.0 + 1)),
        }
    }
}
