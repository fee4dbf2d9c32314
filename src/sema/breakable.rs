//! Tiles that can be broken: how they are declared, and what may be done with a name that stands for one.

use std::collections::BTreeMap;

use crate::diagnostic::catalogue::types::{OutOfRange, TypeMismatch};
use crate::ir::{self, Subject, TagId};
use crate::source::Span;
use crate::syntax::ast::{self, Expr, Name};

use super::Checker;
use super::checked::{BoundProbe, Term, TermKind, Type, World};
use super::constant::ConstantContext;
use super::expression::{ReadLimit, Scope};
use super::names::{Candidate, unknown};

/// A use of a name that `as` gives, where only an instance can be meant.
#[derive(Debug)]
pub(super) struct InstanceUse {
    /// The tag of what the name stands for.
    tag: TagId,
    name: String,
    at: Span,
}

impl Checker<'_> {
    /// `breakable restore after time`, of a tile with some tags; `None` of a tile that cannot be broken.
    pub(super) fn breakable(
        &mut self,
        syntax: Option<&ast::Breakable>,
        tags: &[TagId],
        times: &mut Vec<Term>,
    ) -> Option<ir::Breakable> {
        let syntax = syntax?;
        self.checked.breakable.extend(tags);
        let Some(time) = &syntax.restore else { return Some(ir::Breakable { restore: None }) };
        let steps = self.number(time, &Scope::constant()).and_then(|term| {
            let context = ConstantContext { step: Some(self.step), ..ConstantContext::LITERALS };
            let seconds = self.evaluated(&term, context)?;
            times.push(term);
            let (numerator, denominator) = self.step;
            // The first step after which at least that much time has passed; the tolerance is for rounded quotients.
            let steps = (seconds * denominator as f64 / numerator as f64 - 1e-6).ceil() + 0.0;
            let fits = (1.0..=f64::from(u16::MAX)).contains(&steps);
            if !fits {
                let (what, range) = (format!("{steps} steps"), format!("1 to {} steps", u16::MAX));
                self.diagnostics.report(OutOfRange { at: time.span, what, range });
            }
            fits.then_some(steps as u16)
        });
        // A wrong time is already reported.
        Some(ir::Breakable { restore: Some(steps.unwrap_or(1)) })
    }

    /// The tags of the tiles of a world, by name.
    pub(super) fn tags_of_tiles(&self, world: &World) -> BTreeMap<String, TagId> {
        let kinds = world.spaces.iter().filter_map(|space| space.map.as_ref()).flat_map(|map| &map.kinds);
        kinds.flat_map(|kind| &kind.tags).map(|tag| (self.checked.tags[*tag].text.to_string(), *tag)).collect()
    }

    /// Whether `count(coin)` counts tiles: the name is no entity. An entity does not know the tags of tiles.
    pub(super) fn counts_tiles(&self, name: &Name, scope: &Scope<'_>) -> bool {
        let is_tag = match scope.world.map(|world| &world.tiles) {
            Some(Some(tags)) => tags.contains_key(&*name.text),
            Some(None) => self.tags.contains_key(&name.text),
            None => !self.poisoned_names.contains(&*name.text),
        };
        is_tag && self.entities.get(&name.text).is_none()
    }

    /// `count(coin)`: how many tiles with a tag are there.
    pub(super) fn count_of_tiles(&mut self, name: &Name, span: Span, scope: &Scope<'_>) -> Option<Term> {
        self.allow_inside(span, scope, ReadLimit::Edges, "`count`")?;
        let tag = self.tag(name);
        if scope.world.is_none() {
            self.tile_counts.push((tag, name.span));
        }
        Some(Term { kind: TermKind::Tiles(tag), ty: Type::Int, span })
    }

    /// Reports tags whose tiles entities count, if no world has such tiles.
    pub(super) fn counted_tiles(&mut self) {
        let counts = std::mem::take(&mut self.tile_counts);
        let worlds = &self.checked.worlds;
        // A level that is not given or not read may have them, and so may the worlds of those who import the file.
        if worlds.is_empty() || worlds.iter().any(|world| world.open.is_some()) || self.has_unread_map {
            return;
        }
        let of_tiles: BTreeMap<String, TagId> = worlds.iter().flat_map(|world| self.tags_of_tiles(world)).collect();
        for (tag, at) in counts {
            let name = &self.checked.tags[tag].text;
            if !of_tiles.contains_key(&**name) {
                let tags = of_tiles.keys().map(|tag| Candidate::from(tag.as_str()));
                let fact = unknown("entity or tag of tiles", name, at, self.entities.names().chain(tags));
                self.report_unknown(fact);
            }
        }
    }

    /// What `destroy` destroys: an instance, or a tile that is named by `as`.
    pub(super) fn destroyed(&mut self, what: &Expr, scope: &Scope<'_>) -> Option<Term> {
        let before = self.instance_uses.len();
        let term = self.typed(what, scope, &Type::AnyRef);
        self.instance_uses.truncate(before);
        term
    }

    /// Notes that a name is used as an instance. Whether it can be a tile is known once all maps are read.
    pub(super) fn note_instance(&mut self, subject: Subject, name: &str, at: Span) {
        let tag = match subject {
            Subject::Touched(id) => self.facts.bound.get(id).map(|touch| touch.other),
            Subject::Probed(id) => match self.facts.probes.get(id) {
                Some(BoundProbe::Place(probe, _)) => Some(probe.other),
                Some(BoundProbe::Nearest(..)) | None => None,
            },
            Subject::Me | Subject::Ref(_) | Subject::Slot(_) | Subject::Member(_) => None,
        };
        if let (Some(tag), None) = (tag, self.facts.entity(subject)) {
            self.instance_uses.push(InstanceUse { tag, name: name.into(), at });
        }
    }

    /// As [`Checker::note_instance`], of a name as an expression.
    pub(super) fn note_instance_of(&mut self, subject: Subject, named: &Expr) {
        if let Some(name) = named.name() {
            self.note_instance(subject, &name.text, named.span);
        }
    }

    /// Reports names that are used as instances and can be tiles.
    pub(super) fn tiles_as_instances(&mut self) {
        for InstanceUse { tag, name, at } in std::mem::take(&mut self.instance_uses) {
            if self.checked.breakable.contains(&tag) {
                let tag = &self.checked.tags[tag].text;
                self.diagnostics.report(TypeMismatch {
                    at,
                    found: format!("`{name}`, which may be a breakable tile"),
                    expected: "an instance".into(),
                    help: Some(format!(
                        "tiles tagged `{tag}` are breakable, and of a tile there is only `destroy {name}`; after `{name} is \
                         ENTITY` in the same `and` it is an instance"
                    )),
                });
            }
        }
    }
}
