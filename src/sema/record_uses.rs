//! Records occurrences of names as they are resolved: see [`Occurrences`](crate::syntax::occurrence::Occurrences).

use crate::ir::{EntityId, Subject, TagId};
use crate::source::Span;
use crate::syntax::ast::{Name, PathRef};
use crate::syntax::occurrence::{NameKind, Role};

use super::Checker;
use super::checked::SetId;
use super::checked::{Entity, Given};
use super::expression::{Scope, WorldNames};
use super::mode::ModeNames;

impl Checker<'_> {
    /// A declaration.
    pub(super) fn record_declaration(&mut self, kind: NameKind, name: &Name) {
        self.checked.occurrences.declare(kind, name.span);
    }

    /// A use of a declared name.
    pub(super) fn record_use(&mut self, kind: NameKind, at: Span, declared: Span) {
        self.checked.occurrences.read(kind, at, declared);
    }

    /// The id of an entity that is named.
    pub(super) fn entity_named(&mut self, name: &Name) -> Option<EntityId> {
        let (id, declared) = self.entities.entry(&name.text).map(|(known, id)| (*id, known.span))?;
        self.record_use(NameKind::Entity, name.span, declared);
        Some(id)
    }

    /// A tag on something that carries it.
    pub(super) fn carried(&mut self, name: &Name) -> TagId {
        self.record_tag(name, true);
        self.tag_id(name)
    }

    /// Records a tag; tags of legends and levels have no span in the program.
    pub(super) fn record_tag(&mut self, name: &Name, carried: bool) {
        let written = self.sources.slice(name.span);
        let inner = written.strip_prefix('"').and_then(|w| w.strip_suffix('"')).unwrap_or(written);
        if inner != name.text {
            self.checked.level_tags.insert(name.text.to_string());
            return;
        }
        let mut at = name.span;
        if inner.len() < written.len() {
            at = Span::new(at.file(), at.range().start + 1, at.range().end - 1);
        }
        if carried {
            self.checked.occurrences.declare(NameKind::Tag, at);
        } else {
            self.record_use(NameKind::Tag, at, at);
        }
    }

    /// A value of an entity that is named.
    pub(super) fn record_value_use(&mut self, of: &Entity, what: Given, at: Span, role: Role) {
        let (kind, declared) = match what {
            Given::Param(id) => (NameKind::Parameter, of.params[id].name.span),
            Given::Var(id, _) => (NameKind::Variable, of.vars[id].name.span),
            Given::Discrete(id) => (NameKind::Discrete, of.discretes[id].name.span),
            Given::Ref(id) => (NameKind::Reference, of.refs[id].name.span),
        };
        if role == Role::Written {
            self.checked.occurrences.write(kind, at, declared);
        } else {
            self.record_use(kind, at, declared);
        }
    }

    /// A reference of the entity, or an instance bound by a guard.
    pub(super) fn record_subject_use(&mut self, subject: Subject, name: &Name, scope: &Scope<'_>) {
        match (subject, scope.entity) {
            (Subject::Ref(id), Some(entity)) => self.record_value_use(entity, Given::Ref(id), name.span, Role::Read),
            (Subject::Touched(_) | Subject::Probed(_), _) => {
                if let Some(declared) = self.facts.named_at(&name.text) {
                    self.record_use(NameKind::Touched, name.span, declared);
                }
            }
            _ => {}
        }
    }

    /// An instance of a world.
    pub(super) fn record_instance_use(&mut self, world: &WorldNames, name: &Name) {
        if let Some((slot, _)) = world.instance(&name.text)
            && let Some((declared, _)) = world.instances.get(slot.0 as usize)
        {
            self.record_use(NameKind::Instance, name.span, declared.span);
        }
    }

    /// A value of a set.
    pub(super) fn record_set_value_use(&mut self, set: SetId, name: &Name) {
        let places = self.sets[set].places.iter().filter(|n| n.text == name.text);
        for declared in places.map(|n| n.span).collect::<Vec<_>>() {
            self.record_use(NameKind::Value, name.span, declared);
        }
    }

    /// A path of a mode: its last name is the mode, the others are enclosing modes and the group.
    pub(super) fn record_mode_use(&mut self, names: &ModeNames, index: usize, path: &PathRef<'_>) {
        let Some((whole, _, declared)) = names.modes.get(index) else { return };
        let outer = whole.len().saturating_sub(path.segments.len());
        let (last, before) = match path.segments.split_last() {
            Some(split) => split,
            None => return,
        };
        self.record_use(NameKind::Mode, last.span, *declared);
        for (depth, segment) in before.iter().enumerate() {
            let prefix = &whole[..(outer + depth + 1).min(whole.len())];
            if let Some((_, _, at)) = names.modes.iter().find(|(path, _, _)| path == prefix) {
                self.record_use(NameKind::Mode, segment.span, *at);
            } else if let ([group], Some((_, at))) = (prefix, names.groups.iter().find(|(g, _)| *g == segment.text))
                && *group == segment.text
            {
                self.record_use(NameKind::Group, segment.span, *at);
            }
        }
    }
}
