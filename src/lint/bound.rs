//! Lints of bound contact queries and probes, `touching(…) as e`: they hold only of instances and of
//! tiles that can be broken, so a tag that only other tiles and `rect`s have never gives one.

use std::collections::BTreeSet;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::lint::NoInstanceTouched;
use crate::ir::TagId;
use crate::sema::checked::{BoundProbe, BoundTouch, Checked, Entity};
use crate::sema::side_meant;
use crate::source::FileId;

use super::world::{root_of, statics, tags_of};

/// Maximum number of entities that a finding offers.
const MAX_OFFERED: usize = 4;

/// Reports bound queries for tags that no collider of an entity has. What nothing at all has is reported elsewhere.
pub(super) fn bound(checked: &Checked, root: FileId, found: &mut Diagnostics) {
    if checked.worlds.is_empty() {
        // Another file may have the entities.
        return;
    }
    let root = root_of(checked, root);
    let colliders = checked.entities.iter().flat_map(|e| e.colliders.iter());
    let of_instances: BTreeSet<TagId> = colliders.flat_map(|c| &c.tags).copied().collect();
    let spaces = checked.worlds.iter().flat_map(|w| w.spaces.iter());
    let of_statics: BTreeSet<TagId> = spaces.flat_map(statics).flatten().collect();
    let is_open = checked.worlds.iter().any(|w| w.open.is_some());
    for entity in checked.entities.iter() {
        let mut seen: BTreeSet<TagId> = BTreeSet::new();
        let contacts = entity.bound.iter().map(|query| (query.other, query.span, Some(query)));
        let probes = entity.probes.iter().filter_map(|probe| match probe {
            BoundProbe::Place(probe, span) => Some((probe.other, *span, None)),
            BoundProbe::Nearest(..) => None,
        });
        let asked = contacts.chain(probes);
        let is_known = |other: &TagId| of_instances.contains(other) || checked.breakable.contains(other);
        for (other, at, query) in asked.filter(|(other, ..)| !is_known(other)) {
            let tag = &checked.tags[other].text;
            let is_static = of_statics.contains(&other) || checked.other_tags.contains(&**tag);
            // An imported entity may ask for more than this program has.
            let is_own = is_static || at.file() == root && is_open && side_meant(tag).is_none();
            if is_own && seen.insert(other) {
                let same = checked.entities.iter().find(|e| e.name.text.eq_ignore_ascii_case(tag));
                let same = same.map(|e| (e.name.text.to_string(), tags_of(checked, e)));
                found.report(NoInstanceTouched {
                    at,
                    tag: tag.to_string(),
                    is_static,
                    same: same.filter(|(_, tags)| !tags.is_empty()),
                    others: query.map_or(Vec::new(), |query| touchable(checked, entity, query)),
                });
            }
        }
    }
}

/// Entities that the query's own colliders can touch, each with one of the tags by which they do.
fn touchable(checked: &Checked, entity: &Entity, query: &BoundTouch) -> Vec<(String, String)> {
    let own = entity.colliders.iter().map(|c| &c.tags).filter(|tags| query.mine.is_none_or(|m| tags.contains(&m)));
    let own: BTreeSet<TagId> = own.flatten().copied().collect();
    let mut met: BTreeSet<TagId> = BTreeSet::new();
    for rule in checked.worlds.iter().flat_map(|w| &w.collide) {
        for (one, other) in [(&rule.left, &rule.right), (&rule.right, &rule.left)] {
            if one.iter().any(|tag| own.contains(tag)) {
                met.extend(other);
            }
        }
    }
    let others = checked.entities.iter().filter_map(|other| {
        let tag = other.colliders.iter().flat_map(|c| &c.tags).find(|tag| met.contains(tag))?;
        Some((other.name.text.to_string(), checked.tags[*tag].text.to_string()))
    });
    others.take(MAX_OFFERED).collect()
}
