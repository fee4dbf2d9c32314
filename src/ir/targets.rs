//! Which entities the instance that a subject names can have: declared by a reference, implied by the tag of a contact,
//! or tested by `is`.

use super::{Actions, Entity, EntityId, Expr, ExprId, IdVec, Program, RefValue, Subject, TagSet};

impl Program {
    /// Whether a subject of an entity can name an instance of another entity.
    pub fn can_be(&self, me: EntityId, of: Subject, other: EntityId) -> bool {
        match of {
            Subject::Me => me == other,
            Subject::Member(entity) => entity == other,
            Subject::Ref(id) => self.entities[me].refs[id].entity.is_none_or(|declared| declared == other),
            Subject::Touched(id) => {
                let tag = TagSet::of(self.entities[me].touches[id].other);
                self.entities[other].colliders.iter().any(|collider| collider.tags.meets(tag))
            }
            Subject::Probed(id) => self.exprs.get(self.entities[me].probes[id]).is_some_and(|probe| {
                let tag = match *probe {
                    Expr::Probe { other: tag, .. } => TagSet::of(tag),
                    Expr::Nearest { of, .. } => return of == other,
                    _ => return false,
                };
                self.entities[other].colliders.iter().any(|collider| collider.tags.meets(tag))
            }),
            Subject::Slot(_) => true,
        }
    }

    /// The last subject that a guard tests by `is` where it holds, and the entity.
    pub fn tested(&self, guard: ExprId) -> Option<(Subject, EntityId)> {
        match self.exprs[guard] {
            Expr::Is(of, entity) => Some((of, entity)),
            Expr::And(a, b) => self.tested(b).or_else(|| self.tested(a)),
            _ => None,
        }
    }

    /// For each entity, whether an action of `by` on one of some subjects may destroy an instance of it.
    pub fn destroyed_by(&self, by: EntityId, subjects: fn(Subject) -> bool) -> IdVec<EntityId, bool> {
        let mut destroyed: IdVec<EntityId, bool> = self.entities.iter().map(|_| false).collect();
        for (guard, actions) in self.entities[by].guarded_actions() {
            let tested = guard.and_then(|guard| self.tested(guard));
            for what in &actions.destroys {
                let RefValue::Of(of) = *what else { continue };
                if !subjects(of) {
                    continue;
                }
                for other in self.entities.ids().filter(|other| self.can_be(by, of, *other)) {
                    let is_other = tested.is_some_and(|(tested, entity)| tested == of && entity != other);
                    destroyed[other] |= !is_other;
                }
            }
        }
        destroyed
    }
}

impl Entity {
    /// All its actions in the discrete phase, with the guards under which they run.
    pub fn guarded_actions(&self) -> impl Iterator<Item = (Option<ExprId>, &Actions)> {
        let edges = self.edges.iter().map(|edge| (Some(edge.guard), &edge.actions));
        let entries = self.modes.iter().map(|mode| (None, &mode.entry));
        edges.chain(entries).chain(self.follows.iter().map(|follow| (follow.guard, &follow.actions)))
    }
}
