//! Guards, goals and links that can only have an effect out of bounds, where a run has ended.

use std::collections::BTreeSet;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::lint::BeyondBounds;
use crate::ir::{CompareOp, EntityId, Extremes, IdVec, Origin, ParamId, SlotId, Subject};
use crate::sema::checked::{Checked, Entity, Space, Term, TermKind, World};
use crate::sema::{ConstantContext, evaluate};

/// The region in which a player can be while its run lasts; px. Unbounded above.
#[derive(Debug, Clone, Copy)]
struct Area {
    left: f64,
    right: f64,
    bottom: f64,
}

impl Area {
    /// That of a space with bounds. Where it wraps, nobody is beyond them, and the way around may be the shorter one.
    fn of(space: &Space) -> Option<Self> {
        let [x, y, width, _] = space.bounds?;
        let (left, right) = if space.wraps[0] { (f64::NEG_INFINITY, f64::INFINITY) } else { (x, x + width) };
        Some(Area { left, right, bottom: if space.wraps[1] { f64::NEG_INFINITY } else { y } })
    }

    fn join(self, other: Area) -> Self {
        Area {
            left: self.left.least(other.left),
            right: self.right.greatest(other.right),
            bottom: self.bottom.least(other.bottom),
        }
    }

    /// Whether a rectangle, given by its left, right and top sides, lies wholly outside.
    fn excludes(self, left: f64, right: f64, top: f64) -> bool {
        right < self.left || left > self.right || top < self.bottom
    }
}

/// Reports guards, goals and links that can only have an effect out of bounds.
pub(super) fn border(checked: &Checked, found: &mut Diagnostics) {
    for world in checked.worlds.iter() {
        goals(checked, world, found);
        links(checked, world, found);
    }
    let entities: BTreeSet<EntityId> =
        checked.worlds.iter().flat_map(|w| w.players.iter().map(|p| w.instances[p.slot].entity)).collect();
    for entity in entities {
        guards(checked, entity, found);
    }
}

fn follows_links(entity: &Entity) -> bool {
    entity.modes.iter().any(|mode| !mode.follows.is_empty())
}

/// The region of a player; none if no player controls the slot, or if one of its spaces has no bounds.
fn area(checked: &Checked, world: &World, slot: SlotId) -> Option<Area> {
    world.players.iter().find(|player| player.slot == slot)?;
    let instance = &world.instances[slot];
    let moves = follows_links(&checked.entities[instance.entity]);
    let spaces = world.spaces.pairs().filter(|(id, _)| moves || *id == instance.space);
    let areas: Option<Vec<Area>> = spaces.map(|(_, space)| Area::of(space)).collect();
    areas?.into_iter().reduce(Area::join)
}

fn goals(checked: &Checked, world: &World, found: &mut Diagnostics) {
    for goal in world.goals.iter() {
        let of = |subject: Subject| match subject {
            Subject::Slot(slot) => area(checked, world, slot),
            _ => None,
        };
        let within = Within { of: &of, params: None, step: world.step };
        if within.never_holds(&goal.predicate) {
            found
                .report(BeyondBounds { what: format!("the goal `{}` holds", goal.name.text), at: goal.predicate.span });
        }
    }
}

/// Links that no player can reach, in worlds where nothing else follows links.
fn links(checked: &Checked, world: &World, found: &mut Diagnostics) {
    let is_player = |slot: SlotId| world.players.iter().any(|player| player.slot == slot);
    let followers = world.instances.pairs().filter(|(_, i)| follows_links(&checked.entities[i.entity]));
    if !followers.into_iter().all(|(slot, _)| is_player(slot)) {
        return;
    }
    for space in world.spaces.iter() {
        let Some(area) = Area::of(space) else { continue };
        for link in &space.links {
            let [x, y, width, height] = link.from;
            if area.excludes(x, x + width, y + height) {
                found.report(BeyondBounds { what: "this link is followed".into(), at: link.span });
            }
        }
    }
}

/// Reports comparisons in the guards of an entity whose instances are all players, if they hold for none of them.
fn guards(checked: &Checked, id: EntityId, found: &mut Diagnostics) {
    let entity = &checked.entities[id];
    let mut players = Vec::new();
    for world in checked.worlds.iter() {
        for (slot, instance) in world.instances.pairs().filter(|(_, instance)| instance.entity == id) {
            let Some(area) = area(checked, world, slot).filter(|_| instance.origin == Origin::Named) else { return };
            players.push((area, &instance.params, world.step));
        }
    }
    let edges = entity.edges.iter().map(|edge| &edge.guard);
    let follows = entity.modes.iter().flat_map(|mode| &mode.follows).filter_map(|follow| follow.guard.as_ref());
    let mut open: Vec<&Term> = edges.chain(follows).collect();
    while let Some(term) = open.pop() {
        if let TermKind::And(sides) | TermKind::Or(sides) = &term.kind {
            open.extend(sides.iter());
            continue;
        }
        let never = |(area, params, step): &(Area, &IdVec<ParamId, f64>, (u64, u64))| {
            let of = |subject: Subject| (subject == Subject::Me).then_some(*area);
            Within { of: &of, params: Some(*params), step: *step }.never_holds(term)
        };
        if players.iter().all(never) {
            found.report(BeyondBounds { what: "this holds".into(), at: term.span });
        }
    }
}

/// Evaluates predicates under the assumption that players are within bounds.
struct Within<'a> {
    /// The region of a subject, if it is known.
    of: &'a dyn Fn(Subject) -> Option<Area>,
    params: Option<&'a IdVec<ParamId, f64>>,
    step: (u64, u64),
}

impl Within<'_> {
    fn constant(&self, term: &Term) -> Option<f64> {
        evaluate(term, ConstantContext { params: self.params, step: Some(self.step) }).ok()
    }

    /// Whether a predicate can only hold out of bounds.
    fn never_holds(&self, term: &Term) -> bool {
        match &term.kind {
            TermKind::And(sides) => sides.iter().any(|side| self.never_holds(side)),
            TermKind::Or(sides) => sides.iter().all(|side| self.never_holds(side)),
            TermKind::Compare(op, sides) => {
                let [a, b] = sides.as_ref();
                self.never_compares(*op, a, b) || self.never_compares(op.mirrored(), b, a)
            }
            TermKind::Near(query) => {
                let (of, numbers) = query.as_ref();
                let Some(area) = (self.of)(*of) else { return false };
                let numbers = numbers.each_ref().map(|term| self.constant(term));
                matches!(numbers, [Some(x), Some(y), Some(r)] if area.excludes(x - r, x + r, y + r))
            }
            _ => false,
        }
    }

    /// Whether a comparison of a position with a number holds only out of bounds.
    fn never_compares(&self, op: CompareOp, position: &Term, number: &Term) -> bool {
        let TermKind::Var(subject, var, 0) = position.kind else { return false };
        let (Some(area), Some(number)) = ((self.of)(subject), self.constant(number)) else { return false };
        let (least, greatest) = match var.0 {
            0 => (area.left, area.right),
            1 => (area.bottom, f64::INFINITY),
            _ => return false,
        };
        match op {
            CompareOp::Less => number <= least,
            CompareOp::AtMost => number < least,
            CompareOp::Greater => number >= greatest,
            CompareOp::AtLeast => number > greatest,
            CompareOp::Equal => number < least || number > greatest,
            CompareOp::Unequal => false,
        }
    }
}
