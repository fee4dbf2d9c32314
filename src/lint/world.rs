//! Lints of worlds: tags that nothing has, contacts that no `collide` line pairs, inputs without a player, instances
//! inside walls, links to nowhere.

use std::collections::{BTreeMap, BTreeSet};

use crate::diagnostic::catalogue::lint::{Elsewhere, LinkNowhere, NoPlayer, PlacedInside, UncarriedTag, UnpairedTouch};
use crate::diagnostic::catalogue::world::{UnknownLevelName, as_tag};
use crate::diagnostic::{Diagnostics, similar};
use crate::ir::{EntityId, Extremes, MAX_TAGS, Origin, Push, Subject, TagId};
use crate::ordered::Ordered;
use crate::sema::checked::{
    Checked, CollideRule, Entity, Instance, LevelName, Shape, Solid, Space, Term, TermKind, Touching, World,
};
use crate::sema::{ConstantContext, evaluate, side_meant};
use crate::source::{FileId, Span};

use super::initial::Placed;
use super::terms;

/// Overlaps less deep than this are ignored, px.
const TOLERANCE: f64 = 0.001;

/// Maximum number of tags that nothing asks for which are shown.
const MAX_UNASKED: usize = 2;

/// A contact query: the tag of the entity's own collider, if given, and the other's.
type ContactQuery = (Option<TagId>, TagId);

/// The contact queries of an entity, each with its first place.
fn contact_queries(entity: &Entity) -> Vec<(ContactQuery, Span)> {
    let mut out: Vec<(ContactQuery, Span)> = Vec::new();
    for term in terms::of_entity(entity) {
        terms::walk(term, &mut |term| {
            if let TermKind::Touching(query) = &term.kind
                && let Touching { of: Subject::Me, mine, other, .. } = **query
                && !out.iter().any(|(q, _)| *q == (mine, other))
            {
                out.push(((mine, other), term.span));
            }
        });
    }
    out
}

/// The tags that `collide` lines and contact queries name.
fn requested(checked: &Checked) -> BTreeSet<TagId> {
    let requested = checked.worlds.iter().flat_map(|w| &w.collide).flat_map(|c| c.left.iter().chain(&c.right));
    let mut requested: BTreeSet<TagId> = requested.copied().collect();
    for entity in checked.entities.iter() {
        for ((mine, other), _) in contact_queries(entity) {
            requested.extend(mine);
            requested.insert(other);
        }
        for term in terms::of_entity(entity) {
            terms::walk(term, &mut |term| match &term.kind {
                TermKind::Probe(asked) => requested.extend([asked.mine, asked.other]),
                TermKind::Touching(asked) if matches!(asked.of, Subject::Member(_)) => {
                    requested.insert(asked.other);
                }
                _ => {}
            });
        }
    }
    requested
}

/// The last tags of contact queries with two tags, each with the entity's own tag if one of its colliders carries it.
fn last_tags(checked: &Checked) -> BTreeMap<TagId, Option<TagId>> {
    let mut last = BTreeMap::new();
    for entity in checked.entities.iter() {
        for ((mine, other), _) in contact_queries(entity) {
            let Some(mine) = mine else { continue };
            let is_own = entity.colliders.iter().any(|collider| collider.tags.contains(&mine));
            last.entry(other).or_insert(Some(mine).filter(|_| is_own));
        }
    }
    last
}

/// Reports looks of tags that nothing has.
fn looks(checked: &Checked, carried: &BTreeSet<TagId>, found: &mut Diagnostics) {
    let texts = || carried.iter().map(|tag| checked.tags[*tag].text.as_str());
    for (name, _) in checked.worlds.iter().flat_map(|world| &world.looks) {
        let text = name.text.as_str();
        if texts().any(|tag| tag == text) || checked.other_tags.contains(text) {
            continue;
        }
        let near = similar(text, texts()).and_then(|near| checked.tags.iter().find(|tag| tag.text == near));
        let near = near.map(|tag| (tag.text.to_string(), tag.span));
        found.report(UncarriedTag { tag: text.to_string(), at: name.span, near, elsewhere: None, unasked: Vec::new() });
    }
}

/// Reports tags that are queried but that nothing in the program has; returns the similar tags that it names. Where a
/// map is open or there is no world, only words that are surely no tags.
pub(super) fn tags(checked: &Checked, root: FileId, found: &mut Diagnostics) -> BTreeSet<String> {
    let mut named = BTreeSet::new();
    let is_open = checked.worlds.iter().any(|w| w.open.is_some());
    let is_complete = !is_open && !checked.worlds.is_empty();
    let colliders = checked.entities.iter().flat_map(|e| e.colliders.iter()).flat_map(|c| &c.tags);
    let of_colliders: BTreeSet<TagId> = colliders.copied().collect();
    let mut carried = of_colliders.clone();
    for space in checked.worlds.iter().flat_map(|w| w.spaces.iter()) {
        carried.extend(statics(space).into_iter().flatten());
    }
    // `touching(wall, bottom)` is read as a question about two tags.
    let last = last_tags(checked);
    let requested = requested(checked);
    if is_complete {
        looks(checked, &carried, found);
    }
    let root = root_of(checked, root);
    let unasked = of_colliders.difference(&requested).map(|tag| &checked.tags[*tag]);
    let unasked = unasked.map(|tag| (tag.text.to_string(), tag.span));
    let unasked: Vec<(String, Span)> = unasked.take(MAX_UNASKED + 1).collect();
    for &tag in requested.difference(&carried) {
        let name = &checked.tags[tag];
        if checked.other_tags.contains(name.text.as_str()) {
            continue;
        }
        let entity = checked.entities.iter().find(|entity| entity.name.text == name.text);
        let elsewhere = match (entity, side_meant(&name.text)) {
            (Some(entity), _) if !is_open => Some(Elsewhere::Entity(tags_of(checked, entity))),
            (None, Some(side)) => match last.get(&tag) {
                Some(None) => Some(Elsewhere::Side(side)),
                Some(Some(own)) if is_complete => Some(Elsewhere::SideOf(side, checked.tags[*own].text.to_string())),
                _ => None,
            },
            _ => None,
        };
        if !is_complete && elsewhere.is_none() {
            continue;
        }
        let near = similar(&name.text, carried.iter().map(|t| checked.tags[*t].text.as_str()));
        let near = near.and_then(|near| checked.tags.iter().find(|t| t.text == near));
        let near = near.filter(|_| elsewhere.is_none()).map(|tag| (tag.text.to_string(), tag.span));
        named.extend(near.iter().map(|(near, _)| near.clone()));
        // An imported entity may refer to tags that this program does not use.
        if name.span.file() == root || near.is_some() {
            let is_shown = near.is_none() && unasked.len() <= MAX_UNASKED;
            let unasked = if is_shown { unasked.clone() } else { Vec::new() };
            found.report(UncarriedTag { tag: name.text.to_string(), at: name.span, near, elsewhere, unasked });
        }
    }
    named
}

/// The file whose own words are judged: that of the first world.
pub(super) fn root_of(checked: &Checked, root: FileId) -> FileId {
    checked.worlds.iter().next().map_or(root, |w| w.name.span.file())
}

/// The tags of an entity's colliders, in the order of the text.
pub(super) fn tags_of(checked: &Checked, entity: &Entity) -> Vec<String> {
    let mut tags: Vec<String> = Vec::new();
    for tag in entity.colliders.iter().flat_map(|collider| &collider.tags) {
        let tag = checked.tags[*tag].text.to_string();
        if !tags.contains(&tag) {
            tags.push(tag);
        }
    }
    tags
}

/// Reports names in editors' levels that nothing asks and that are almost names of the program, but for those that are
/// explained already.
pub(super) fn level_names(checked: &Checked, explained: &BTreeSet<String>, found: &mut Diagnostics) {
    if checked.level_names.is_empty() {
        return;
    }
    let requested: BTreeSet<&str> = requested(checked).into_iter().map(|tag| &*checked.tags[tag].text).collect();
    let entities = || checked.entities.iter().map(|entity| &*entity.name.text);
    for LevelName { name, map, is_object, near: explained_near } in &checked.level_names {
        if requested.contains(name.as_str()) || explained.contains(name) {
            continue;
        }
        let instances = || entities().filter(|_| *is_object);
        let in_block = explained_near.iter().map(|(near, _)| near.as_str());
        let known = in_block.chain(instances()).chain(requested.iter().copied()).chain(entities());
        let Some(near) = similar(name, known) else { continue };
        let meaning = match explained_near {
            Some((explained, meaning)) if *explained == near => meaning.clone(),
            _ if entities().any(|entity| entity == near) => format!("spawn {near}"),
            _ => as_tag(&near),
        };
        found.report(UnknownLevelName { at: *map, name: name.clone(), near, meaning });
    }
}

/// The sets of tags of the static geometry of a space.
pub(super) fn statics(space: &Space) -> Vec<Vec<TagId>> {
    let tiles = space.map.iter().flat_map(|m| &m.kinds).map(|k| k.tags.to_vec());
    tiles.chain(space.solids.iter().map(|s| s.tags.clone())).collect()
}

/// A set of tags as bits.
fn bits<'t>(tags: impl IntoIterator<Item = &'t TagId>) -> u64 {
    tags.into_iter().fold(0, |bits, tag| bits | 1 << (tag.0 as usize % MAX_TAGS))
}

/// For each tag the tags that it meets by the `collide` lines of a world, by response.
struct Meetings([(Push, [u64; MAX_TAGS]); 3]);

impl Meetings {
    fn new(world: &World) -> Self {
        let mut met = [Push::Sense, Push::FromAbove, Push::Block].map(|push| (push, [0; MAX_TAGS]));
        for rule in &world.collide {
            for (_, table) in met.iter_mut().filter(|(push, _)| *push == rule.response.push) {
                for (from, to) in [(&rule.left, bits(&rule.right)), (&rule.right, bits(&rule.left))] {
                    for tag in from {
                        table[tag.0 as usize % MAX_TAGS] |= to;
                    }
                }
            }
        }
        Meetings(met)
    }

    /// The strongest response to a contact of two sets of tags.
    fn response(&self, a: u64, b: u64) -> Option<Push> {
        let meets = |table: &[u64; MAX_TAGS]| (0..MAX_TAGS).any(|tag| a >> tag & 1 == 1 && table[tag] & b != 0);
        self.0.iter().filter(|(_, table)| meets(table)).map(|(push, _)| *push).max()
    }
}

/// Reports contact queries of a world's entities that its `collide` lines never make true.
pub(super) fn touches(checked: &Checked, found: &mut Diagnostics) {
    let mut reported: BTreeSet<Span> = BTreeSet::new();
    for world in checked.worlds.iter() {
        let present: BTreeSet<EntityId> = world.instances.iter().map(|i| i.entity).collect();
        let mut carriers: Vec<u64> = world.spaces.iter().flat_map(statics).map(|tags| bits(&tags)).collect();
        let colliders = present.iter().flat_map(|e| checked.entities[*e].colliders.iter());
        carriers.extend(colliders.map(|c| bits(&c.tags)));
        carriers.sort_unstable();
        carriers.dedup();
        // Whether two sets of colliders meet depends on all of their tags.
        let with = |tag: &TagId| carriers.iter().filter(|c| **c & bits([tag]) != 0).fold(0, |all, c| all | c);
        let beside: Vec<u64> = checked.tags.ids().take(MAX_TAGS).map(|tag| with(&tag)).collect();
        let meetings = Meetings::new(world);
        for &entity in &present {
            let entity = &checked.entities[entity];
            for ((mine, other), at) in contact_queries(entity) {
                let own =
                    || entity.colliders.iter().map(|c| &c.tags).filter(|tags| mine.is_none_or(|m| tags.contains(&m)));
                let others = beside.get(other.0 as usize).copied().unwrap_or(0);
                if others == 0 || own().next().is_none() {
                    continue;
                }
                let answered = meetings.response(bits(own().flatten()), others).is_some();
                if !answered && reported.insert(at) {
                    let tag = |t: TagId| checked.tags[t].text.to_string();
                    let mine: BTreeSet<TagId> = match mine {
                        Some(mine) => [mine].into(),
                        None => own().flat_map(|tags| tags.iter().copied()).collect(),
                    };
                    let tags = (mine.iter().copied().map(tag).collect(), tag(other));
                    let lines = lines(world, &mine, other);
                    found.report(UnpairedTouch {
                        at,
                        tags,
                        world: (world.name.text.to_string(), world.name.span),
                        lines,
                        before: world.body,
                    });
                }
            }
        }
    }
}

/// The last `collide` line that pairs some tags with others, and the last that pairs another tag; otherwise the last
/// line of all.
fn lines(world: &World, mine: &BTreeSet<TagId>, other: TagId) -> Vec<Span> {
    let last = |test: &dyn Fn(TagId) -> bool| {
        let pairs = |c: &&CollideRule| c.left.iter().chain(&c.right).any(|t| test(*t));
        world.collide.iter().rfind(pairs).map(|c| c.span)
    };
    let mut found: Vec<Span> = last(&|t| mine.contains(&t)).into_iter().chain(last(&|t| t == other)).collect();
    if found.is_empty() {
        found.extend(world.collide.last().map(|c| c.span));
    }
    found.dedup();
    found
}

/// Reports entities with inputs that have an instance but no player.
pub(super) fn players(checked: &Checked, found: &mut Diagnostics) {
    let played: BTreeSet<EntityId> =
        checked.worlds.iter().flat_map(|w| w.players.iter().map(|p| w.instances[p.slot].entity)).collect();
    let mut named: BTreeMap<EntityId, &Instance> = BTreeMap::new();
    let instances = checked.worlds.iter().flat_map(|w| w.instances.iter());
    for instance in instances.filter(|i| i.origin == Origin::Named) {
        named.entry(instance.entity).or_insert(instance);
    }
    for (id, entity) in checked.entities.pairs().filter(|(id, _)| !played.contains(id)) {
        let Some(input) = entity.buttons.iter().chain(entity.axes.iter()).min_by_key(|n| n.span) else { continue };
        if let Some(instance) = named.get(&id) {
            found.report(NoPlayer {
                entity: entity.name.text.to_string(),
                at: input.span,
                instance: (instance.name.text.to_string(), instance.span),
            });
        }
    }
}

/// Reports instances whose initial position is inside an obstacle.
pub(super) fn places(checked: &Checked, found: &mut Diagnostics) {
    for world in checked.worlds.iter() {
        let meetings = Meetings::new(world);
        let walls: Vec<Walls<'_>> = world.spaces.iter().map(Walls::new).collect();
        for instance in world.instances.iter().filter(|i| i.origin != Origin::Free) {
            inside(checked, world, instance, (&meetings, &walls[instance.space.0 as usize]), found);
        }
    }
}

/// Left, right, bottom, top.
type Sides = [f64; 4];

/// A depth, px, and the obstacle: a tile by column and row, or a `rect`.
type Inside = (f64, Result<(usize, usize), Span>);

/// The static geometry of a space, its `rect`s sorted by their left sides.
struct Walls<'a> {
    space: &'a Space,
    /// The sides of a `rect`, its index, and the maximum of the right sides up to here.
    solids: Vec<(Sides, usize, f64)>,
}

impl<'a> Walls<'a> {
    fn new(space: &'a Space) -> Self {
        let sides = space.solids.iter().map(|s| sides(s.rect));
        let mut solids: Vec<(Sides, usize, f64)> = sides.zip(0..).map(|(sides, index)| (sides, index, 0.0)).collect();
        solids.order_by(|a, b| a.0[0].total_cmp(&b.0[0]));
        let mut reach = f64::NEG_INFINITY;
        for (sides, _, up_to_here) in &mut solids {
            reach = reach.greatest(sides[1]);
            *up_to_here = reach;
        }
        Walls { space, solids }
    }

    /// The `rect`s that overlap a box horizontally, in source order.
    fn beside(&self, of: Sides) -> Vec<(Sides, &'a Solid)> {
        let before = self.solids.partition_point(|(sides, ..)| sides[0] < of[1]);
        let near = self.solids[..before].iter().rev().take_while(|(_, _, reach)| *reach > of[0]);
        let mut near: Vec<(Sides, usize)> = near.map(|(sides, index, _)| (*sides, *index)).collect();
        near.order_by_key(|(_, index)| *index);
        near.into_iter().map(|(sides, index)| (sides, &self.space.solids[index])).collect()
    }
}

fn sides([x, y, width, height]: [f64; 4]) -> Sides {
    [x, x + width, y, y + height]
}

fn inside(
    checked: &Checked,
    world: &World,
    instance: &Instance,
    (meetings, walls): (&Meetings, &Walls<'_>),
    found: &mut Diagnostics,
) {
    let (Some([x, ..]), Some([y, ..])) = (instance.vars.iter().next(), instance.vars.iter().nth(1)) else { return };
    let context = ConstantContext { params: Some(&instance.params), step: Some(world.step) };
    let entity = &checked.entities[instance.entity];
    let placed = Placed { entity, instance, context };
    let is_there = |guard: &Option<Term>| guard.as_ref().is_none_or(|guard| placed.holds(guard) == Some(true));
    for collider in entity.colliders.iter().filter(|collider| !collider.kinematic && is_there(&collider.guard)) {
        let Shape::Rect(numbers) = &collider.shape else { continue };
        let [Ok(left), Ok(bottom), Ok(width), Ok(height)] = numbers.each_ref().map(|n| evaluate(n, context)) else {
            continue;
        };
        let (left, bottom) = (x + left, y + bottom);
        let own = bits(&collider.tags);
        let blocks = |tags: &[TagId]| meetings.response(own, bits(tags)) == Some(Push::Block);
        if let Some((depth, of)) = deepest(walls, sides([left, bottom, width, height]), blocks) {
            found.report(PlacedInside { name: instance.name.text.to_string(), at: instance.span, depth, of });
            return;
        }
    }
}

/// The obstacle with the deepest overlap, and its depth, px.
fn deepest(walls: &Walls<'_>, sides: Sides, blocks: impl Fn(&[TagId]) -> bool) -> Option<Inside> {
    let mut found: Vec<Inside> = Vec::new();
    for (of, solid) in walls.beside(sides).into_iter().filter(|(_, s)| blocks(&s.tags)) {
        found.push((depth(sides, of), Err(solid.span)));
    }
    if let Some(map) = &walls.space.map {
        let blocking: Vec<bool> = map.kinds.iter().map(|kind| blocks(&kind.tags)).collect();
        let (width, height) = map.tile;
        let cells = |low: f64, high: f64, size: f64, count: usize| {
            let first = (low / size).floor().clamp(0.0, count as f64) as usize;
            let after = (high / size).ceil().clamp(0.0, count as f64) as usize;
            first..after
        };
        for row in cells(sides[2], sides[3], height, map.rows) {
            for column in cells(sides[0], sides[1], width, map.columns) {
                let kind = map.kind(column as i64, row as i64);
                if kind.is_some_and(|k| blocking[k]) {
                    let (left, bottom) = (column as f64 * width, row as f64 * height);
                    found.push((depth(sides, [left, left + width, bottom, bottom + height]), Ok((column, row))));
                }
            }
        }
    }
    let deep = found.into_iter().filter(|(depth, _)| *depth > TOLERANCE);
    deep.max_by(|a, b| a.0.total_cmp(&b.0))
}

/// The overlap of two boxes along their axis of least overlap, px; negative if they are apart.
fn depth(a: Sides, b: Sides) -> f64 {
    let along = |low: usize| a[low + 1].least(b[low + 1]) - a[low].greatest(b[low]);
    along(0).least(along(2))
}

/// Reports links whose destination is outside of the contents of its space.
pub(super) fn links(checked: &Checked, found: &mut Diagnostics) {
    for world in checked.worlds.iter() {
        for link in world.spaces.iter().flat_map(|s| &s.links) {
            let space = &world.spaces[link.space];
            let Some(extent) = extent(space) else { continue };
            let [x, y, width, height] = link.to;
            if depth([x, x + width, y, y + height], extent) < 0.0 {
                found.report(LinkNowhere {
                    at: link.span,
                    space: space.name.text.to_string(),
                    extent: (extent[0], extent[1], extent[2], extent[3]),
                });
            }
        }
    }
}

/// The box around the contents of a space; none if it is empty or its map is not known.
fn extent(space: &Space) -> Option<Sides> {
    let map = space.map.as_ref().map(|m| m.size()).map(|(width, height)| [0.0, width, 0.0, height]);
    let of = |&[x, y, width, height]: &[f64; 4]| [x, x + width, y, y + height];
    let solids = space.solids.iter().map(|s| of(&s.rect)).chain(space.bounds.as_ref().map(of));
    let all = map.into_iter().chain(solids);
    all.reduce(|a, b| [a[0].least(b[0]), a[1].greatest(b[1]), a[2].least(b[2]), a[3].greatest(b[3])])
}
