//! References that always hold an instance: nothing destroys what they may hold, and every instance that has them is made
//! with them. Found in the syntax trees, before bodies are checked; in doubt a reference may be none.

use std::collections::{BTreeMap, BTreeSet};

use crate::ir::Side;
use crate::source::Span;
use crate::syntax::ast::{
    self, BinaryOp, Expr, ExprKind, Item, MapSource, Member, SpaceItem, TileSpawn, Update, Word, WorldItem,
};

/// A reference: the names of its entity and of itself.
type Named<'t> = (&'t str, &'t str);

/// Why a reference may be none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Reason {
    /// An instance is made there without it.
    Unset(Span),
    /// It is set there to what may be none.
    Set(Span),
    /// What it holds can be destroyed there.
    Destroyed(Span),
    /// The instances of a level are not known here.
    Level,
}

impl Reason {
    /// Whether it only has to be set where the instance is made.
    pub fn is_unset(self) -> bool {
        matches!(self, Reason::Unset(_))
    }

    /// Where it becomes none and how, for a finding.
    pub fn told(self) -> Option<(Span, &'static str)> {
        match self {
            Reason::Unset(at) => Some((at, "made without it")),
            Reason::Set(at) => Some((at, "may set it to none")),
            Reason::Destroyed(at) => Some((at, "may destroy what it refers to")),
            Reason::Level => None,
        }
    }
}

/// The references that may be none, by the names of their entities and of themselves; all others always hold an instance.
#[derive(Debug, Default)]
pub(super) struct Lost(BTreeMap<(Word, Word), Reason>);

impl Lost {
    /// Why a reference of an entity may be none; `None` if it never is.
    pub fn reason(&self, entity: &str, reference: &str) -> Option<Reason> {
        self.0.get(&(entity.into(), reference.into())).copied()
    }

    /// Examines all files of a program, with behaviours expanded.
    pub fn of(files: &[ast::File]) -> Self {
        let mut search = Search::default();
        let items = || files.iter().flat_map(|file| &file.items);
        for item in items() {
            if let Item::Entity(entity) = item {
                search.entity(entity);
            }
        }
        for item in items() {
            if let Item::World(world) = item {
                search.world(world);
            }
        }
        search.finish()
    }
}

/// What an entity declares and does, as far as it matters here.
#[derive(Default)]
struct Body<'t> {
    /// References with the entities of their targets.
    references: BTreeMap<&'t str, &'t str>,
    /// The tags of its colliders.
    tags: BTreeSet<&'t str>,
    /// Updates with the guards under which they run.
    updates: Vec<(Option<&'t Expr>, &'t Update)>,
}

/// A value that a reference gets, and where.
struct Assigned<'t> {
    reference: Named<'t>,
    /// The own reference that is read; `None` if the value is never none.
    from: Option<Named<'t>>,
    at: Span,
}

#[derive(Default)]
struct Search<'t> {
    bodies: BTreeMap<&'t str, Body<'t>>,
    /// Where instances of each entity are made, with the references that they are given.
    made: Vec<(&'t str, Vec<&'t str>, Span)>,
    assigned: Vec<Assigned<'t>>,
    lost: BTreeMap<Named<'t>, Reason>,
    /// Whether a level makes instances that the program does not name.
    has_level: bool,
}

impl<'t> Search<'t> {
    fn entity(&mut self, entity: &'t ast::Entity) {
        // The first of two entities of one name counts; the second one is an error.
        if self.bodies.contains_key(&*entity.name.text) {
            return;
        }
        let mut body = Body::default();
        body.members(&entity.members);
        self.bodies.insert(&entity.name.text, body);
    }

    fn world(&mut self, world: &'t ast::World) {
        for item in &world.items {
            match item {
                WorldItem::Tiles(tiles) => self.tiles(&tiles.tiles),
                WorldItem::Space(space) => space.items.iter().for_each(|item| self.space_item(item)),
                _ => {}
            }
        }
    }

    fn space_item(&mut self, item: &'t SpaceItem) {
        match item {
            SpaceItem::Place(place) => {
                self.made.push((&place.entity.text, given(&place.settings), place.name.span));
            }
            SpaceItem::Map(map) => match &map.source {
                MapSource::Vglc(_, legend) | MapSource::OpenLegend(legend) => self.tiles(&legend.tiles),
                MapSource::Tiled(..) | MapSource::Ldtk(..) | MapSource::OpenAll(_) => self.has_level = true,
                MapSource::Inline(..) | MapSource::Text(..) | MapSource::Open(_) => {}
            },
            _ => {}
        }
    }

    fn tiles(&mut self, tiles: &'t [ast::Tile]) {
        for TileSpawn { entity, settings, span, .. } in tiles.iter().filter_map(|tile| tile.spawn.as_ref()) {
            self.made.push((&entity.text, given(settings), *span));
        }
    }

    /// What happens to references on the edges of all entities.
    fn updates(&mut self) {
        let (mut made, mut assigned) = (Vec::new(), Vec::new());
        for (me, body) in &self.bodies {
            for (guard, update) in &body.updates {
                match update {
                    Update::Spawn(spawn) => {
                        let mut given = Vec::new();
                        for setting in &spawn.settings {
                            let reference = (&*spawn.entity.text, &*setting.variable.text);
                            if let Some(from) = body.value(me, &setting.value, *guard) {
                                given.push(reference.1);
                                assigned.push(Assigned { reference, from, at: setting.span() });
                            }
                        }
                        made.push((&*spawn.entity.text, given, spawn.span));
                        if let Some(into) = &spawn.into {
                            // There may be no free instance.
                            self.lost.entry((me, &into.text)).or_insert(Reason::Set(spawn.span));
                        }
                    }
                    Update::Assign(update) if body.references.contains_key(&*update.variable.text) => {
                        let reference = (*me, &*update.variable.text);
                        match body.value(me, &update.value, *guard) {
                            Some(from) => assigned.push(Assigned { reference, from, at: update.span() }),
                            None => {
                                self.lost.entry(reference).or_insert(Reason::Set(update.span()));
                            }
                        }
                    }
                    Update::Assign(_) | Update::Destroy(_) | Update::Send(_) => {}
                }
            }
        }
        self.made.extend(made);
        self.assigned.extend(assigned);
    }

    /// Where instances of each entity are destroyed.
    fn destroyed(&self) -> BTreeMap<&'t str, Span> {
        let mut destroyed: BTreeMap<&str, Span> = BTreeMap::new();
        for (me, body) in &self.bodies {
            for (guard, update) in &body.updates {
                let Update::Destroy(destroy) = update else { continue };
                let mut mark = |entity: &'t str| {
                    destroyed.entry(entity).or_insert(destroy.span);
                };
                let name = destroy.what.name();
                match (&destroy.what.kind, name.as_ref().map(|name| &*name.text)) {
                    (ExprKind::SelfRef, _) => mark(me),
                    (_, Some(name)) => {
                        let declared =
                            body.references.get(name).copied().filter(|entity| self.bodies.contains_key(entity));
                        let tested = guard.and_then(|guard| tested(guard, name));
                        let touched = guard.and_then(|guard| touched(guard, name));
                        match (tested.or(declared), touched) {
                            (_, Some(Bound::Nearest(entity))) => mark(entity),
                            (Some(entity), _) => mark(entity),
                            (None, Some(Bound::Touching(call))) => {
                                let other = other(call);
                                let has = |body: &Body<'_>| other.is_none_or(|tag| body.tags.contains(tag));
                                self.bodies.iter().filter(|(_, body)| has(body)).for_each(|(entity, _)| mark(entity));
                            }
                            (None, None) => self.bodies.keys().for_each(|entity| mark(entity)),
                        }
                    }
                    _ => self.bodies.keys().for_each(|entity| mark(entity)),
                }
            }
        }
        destroyed
    }

    fn finish(mut self) -> Lost {
        self.updates();
        let destroyed = self.destroyed();
        for (me, body) in &self.bodies {
            for (reference, target) in &body.references {
                // `any` may be of each entity.
                let of = match self.bodies.contains_key(target) {
                    true => destroyed.get(target),
                    false => destroyed.values().next(),
                };
                if let Some(at) = of {
                    self.lost.insert((me, reference), Reason::Destroyed(*at));
                } else if self.has_level {
                    self.lost.entry((me, reference)).or_insert(Reason::Level);
                }
            }
        }
        for (entity, given, at) in &self.made {
            let declared = self.bodies.get(entity).into_iter().flat_map(|body| body.references.keys());
            for reference in declared.filter(|reference| !given.contains(reference)) {
                self.lost.entry((entity, reference)).or_insert(Reason::Unset(*at));
            }
        }
        // What is set to a reference that may be none may be none.
        loop {
            let before = self.lost.len();
            for Assigned { reference, from, at } in &self.assigned {
                if from.is_some_and(|from| self.lost.contains_key(&from)) {
                    self.lost.entry(*reference).or_insert(Reason::Set(*at));
                }
            }
            if self.lost.len() == before {
                break;
            }
        }
        Lost(self.lost.into_iter().map(|((entity, name), reason)| ((entity.into(), name.into()), reason)).collect())
    }
}

impl<'t> Body<'t> {
    fn members(&mut self, members: &'t [Member]) {
        for member in members {
            match member {
                Member::Reference(reference) => {
                    self.references.entry(&reference.name.text).or_insert(&reference.entity.text);
                }
                Member::Collider(collider) => self.tags.extend(collider.tags.iter().map(|tag| &*tag.text)),
                Member::Entry(update) => self.updates.push((None, update)),
                Member::Edge(edge) => {
                    self.updates.extend(edge.updates.iter().map(|update| (Some(&edge.guard), update)))
                }
                Member::Follow(follow) => {
                    self.updates.extend(follow.updates.iter().map(|update| (follow.guard.as_ref(), update)));
                }
                Member::Mode(mode) => self.members(&mode.members),
                Member::Group(group) => self.members(&group.members),
                _ => {}
            }
        }
    }

    /// Whether a value is an instance: the own reference that it is if that is one, or none if it always is.
    fn value(&self, me: &'t str, value: &'t Expr, guard: Option<&'t Expr>) -> Option<Option<Named<'t>>> {
        match &value.kind {
            ExprKind::Paren(inner) => self.value(me, inner, guard),
            ExprKind::SelfRef => Some(None),
            ExprKind::Name(name, 0) => match guard.and_then(|guard| touched(guard, name)) {
                Some(_) => Some(None),
                None => self.references.contains_key(&**name).then_some(Some((me, name))),
            },
            _ => None,
        }
    }
}

/// The names that settings in a world set to something.
fn given(settings: &[ast::Assignment]) -> Vec<&str> {
    let is_given = |setting: &&ast::Assignment| setting.value.kind != ExprKind::NoneRef;
    settings.iter().filter(is_given).map(|setting| &*setting.variable.text).collect()
}

/// The tag that an argument of `touching` names.
fn tag(argument: &Expr) -> Option<&str> {
    match &argument.kind {
        ExprKind::Moved(both) => tag(&both[0]),
        ExprKind::Name(name, 0) => Some(name),
        ExprKind::Text(text) => Some(text),
        _ => None,
    }
}

/// The tag of what a call of `touching` finds; a side may follow it, and a collider of one's own precede it.
fn other(call: &ast::Call) -> Option<&str> {
    let mut tags: Vec<&str> = call.arguments.iter().map(tag).collect::<Option<_>>()?;
    // A probe asks for no side.
    let is_probe = matches!(call.arguments.first()?.kind, ExprKind::Moved(_));
    if !is_probe && tags.len() > 1 && Side::named(tags[tags.len() - 1]).is_some() {
        tags.pop();
    }
    tags.pop()
}

/// What a guard binds to a name.
#[derive(Clone, Copy)]
enum Bound<'t> {
    /// What is touched.
    Touching(&'t ast::Call),
    /// An instance of an entity.
    Nearest(&'t str),
}

/// The contact that a guard binds to a name where it holds.
fn touched<'t>(guard: &'t Expr, name: &str) -> Option<Bound<'t>> {
    match &guard.kind {
        ExprKind::Paren(inner) => touched(inner, name),
        ExprKind::Binary(BinaryOp::And, both) => touched(&both[0], name).or_else(|| touched(&both[1], name)),
        ExprKind::Call(call) => {
            call.binding.as_ref().filter(|binding| &*binding.text == name).map(|_| Bound::Touching(call))
        }
        ExprKind::Nearest(nearest) => {
            let is_it = nearest.binding.as_ref().is_some_and(|binding| &*binding.text == name);
            is_it.then_some(Bound::Nearest(&nearest.entity.text))
        }
        _ => None,
    }
}

/// The entity that a guard tests a name for where it holds.
fn tested<'t>(guard: &'t Expr, name: &str) -> Option<&'t str> {
    match &guard.kind {
        ExprKind::Paren(inner) => tested(inner, name),
        ExprKind::Binary(BinaryOp::And, both) => tested(&both[0], name).or_else(|| tested(&both[1], name)),
        ExprKind::Is(operands) => {
            let is_named = operands.0.name().is_some_and(|of| &*of.text == name);
            operands.1.as_ref().filter(|_| is_named).map(|entity| &*entity.text)
        }
        _ => None,
    }
}
