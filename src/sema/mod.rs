//! Semantic analysis, from syntax trees to a checked program: resolves names, types expressions, checks structure.
//!
//! All independent errors of a program are reported in one run. Names in unreadable parts (syntax errors) are known to
//! this stage, so that it reports no consequences of earlier errors.

mod annotation;
mod breakable;
mod call;
pub mod checked;
mod checked_contact;
mod checked_envelope;
mod checked_test;
mod checked_world;
mod condition;
mod conflict;
mod constant;
pub mod dimension;
mod distance;
mod editor_level;
mod entity;
mod envelope;
mod expression;
mod facts;
mod foreign;
mod joint;
mod lasting;
mod look;
mod map;
mod member;
mod members;
mod mode;
mod names;
mod operator;
mod place;
mod population;
mod predicate;
mod probe;
mod record_uses;
mod reference;
mod room;
mod signal;
mod slope;
mod start;
mod test;
mod unused;
mod world;
mod wrap;

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::file::TooMany;
use crate::diagnostic::catalogue::syntax::ExpressionTooLong;
use crate::diagnostic::catalogue::types::TypeMismatch;
use crate::ir::{EntityId, IdVec, MAX_TAGS, TagId};
use crate::source::{FileId, SourceMap, Span};
use crate::syntax::occurrence::{NameKind, Occurrences};
use crate::syntax::{MAX_OPERATORS, ast};

#[cfg(all(test, feature = "language"))]
pub(crate) use call::FUNCTIONS;
use checked::Checked;
use checked::SetId;
#[cfg(feature = "language")]
pub(crate) use constant::KNOWN_CONSTANTS;
pub use constant::{ConstantContext, ConstantError, evaluate};
pub(crate) use foreign::side as side_meant;
use names::Table;
pub use unused::names_of_unused;

/// Maximum number of entities of a program, including imported ones: each has its own tables, and nobody writes more by
/// hand.
pub const MAX_ENTITIES: usize = 10_000;
/// Maximum number of worlds of a program, including imported ones.
pub const MAX_WORLDS: usize = 10_000;
/// Maximum number of kinds of tiles of a set.
pub const MAX_TILE_KINDS: usize = 4_096;

/// The map of worlds with an open map, as far as it is given.
#[derive(Debug, Clone, Default)]
pub struct Level {
    /// The file.
    pub map: Option<FileId>,
    /// Whether there is a file that could not be read.
    pub is_unread: bool,
    /// The level of a project of LDtk.
    pub part: Option<String>,
    /// A legend for characters that the program does not define.
    pub legend: Option<FileId>,
    /// Width and height of a tile, px; overrides the program.
    pub tile: Option<(f64, f64)>,
}

/// Checks a program: the root file first, then its imports. `level` is the map of worlds with an open map. Adds to the
/// occurrences of names. The result is complete only if the diagnostics contain no error. Checked parts of the trees
/// are dropped at once, as both are large for a large program.
pub fn check(
    files: Vec<ast::File>,
    sources: &SourceMap,
    level: Level,
    occurrences: Occurrences,
) -> (Checked, Diagnostics) {
    let mut checker = Checker::new(&files, sources, level);
    checker.checked.occurrences = occurrences;
    let Items { constants, entities, worlds } = Items::of(files);
    // Imported files come last in the list, but their constants must be known to their importers.
    constants.into_iter().rev().flatten().for_each(|constant| checker.constant(&constant));
    for (index, body) in checker.declare(&entities).into_iter().enumerate() {
        let checked = checker.entity(body, EntityId(index as u32));
        checker.checked.entities[EntityId(index as u32)] = checked.into();
    }
    drop(entities);
    let mut worlds = worlds.into_iter();
    worlds.by_ref().take(MAX_WORLDS).for_each(|world| checker.world(&world));
    if let Some(world) = worlds.next() {
        checker.too_many("worlds", MAX_WORLDS, world.name.span);
    }
    checker.tiles_as_instances();
    checker.counted_tiles();
    checker.count_tags();
    let Checker { mut checked, mut diagnostics, .. } = checker;
    checked.dimensions = dimension::check(&checked, sources, &mut diagnostics);
    diagnostics.sort();
    (checked, diagnostics)
}

/// The items of files, by kind.
#[derive(Default)]
struct Items {
    /// Per file.
    constants: Vec<Vec<Arc<ast::Constant>>>,
    entities: Vec<Arc<ast::Entity>>,
    worlds: Vec<Arc<ast::World>>,
}

impl Items {
    fn of(files: Vec<ast::File>) -> Self {
        let mut all = Items::default();
        for file in files {
            let mut constants = Vec::new();
            for item in file.items {
                match item {
                    ast::Item::Constant(constant) => constants.push(constant),
                    ast::Item::Entity(entity) => all.entities.push(entity),
                    ast::Item::World(world) => all.worlds.push(world),
                    ast::Item::Import(_) | ast::Item::Behavior(_) => {}
                }
            }
            all.constants.push(constants);
        }
        all
    }
}

/// A set over which discrete variables range.
struct Set {
    names: Arc<Vec<String>>,
    /// Where they are declared.
    places: Vec<ast::Name>,
}

/// The shared state of this stage.
struct Checker<'a> {
    sources: &'a SourceMap,
    /// The file of the program.
    root: FileId,
    /// The map of worlds with an open map.
    level: Level,
    /// The files of maps, by the span of their names.
    texts: std::collections::BTreeMap<Span, FileId>,
    checked: Checked,
    diagnostics: Diagnostics,
    constants: Table<checked::Term>,
    entities: Table<EntityId>,
    worlds: Table<()>,
    tags: std::collections::BTreeMap<ast::Word, TagId>,
    /// Names that unreadable parts may have declared.
    poisoned_names: BTreeSet<String>,
    /// The step of the world that is checked, as a fraction of seconds.
    step: (u64, u64),
    /// The settings of each tile that spawns, by its place; none if they are wrong.
    spawn_settings: std::collections::BTreeMap<Span, Option<std::rc::Rc<place::Settings>>>,
    /// The open map of the world that is checked, if no level is given.
    awaited: Option<Span>,
    /// Names that may be instances of the level that is not given.
    awaited_names: Vec<crate::diagnostic::catalogue::names::UnknownName>,
    /// The instances that worlds place, with their entities.
    placed: std::collections::BTreeMap<ast::Word, ast::Word>,
    /// The references that may be none.
    lost: lasting::Lost,
    /// The conditions of the current entity or world.
    conditions: condition::Conditions,
    /// Uses of names as instances that may stand for tiles.
    instance_uses: Vec<breakable::InstanceUse>,
    /// The tags whose tiles entities count, and where.
    tile_counts: Vec<(TagId, Span)>,
    /// Whether a map could not be read.
    has_unread_map: bool,
    /// Whether the size of such a map was read since this was looked at last.
    reads_unknown_size: bool,
    /// The facts at the current expression.
    facts: facts::Facts,
    /// The mode names of entities that others read.
    mode_names: std::collections::BTreeMap<EntityId, std::rc::Rc<mode::ModeNames>>,
    /// The sets of discrete variables: equal ones are one type.
    sets: IdVec<SetId, Set>,
    /// The id of each set.
    set_ids: std::collections::BTreeMap<Arc<Vec<String>>, SetId>,
    /// The value names of entities that others read or set.
    values: std::collections::BTreeMap<EntityId, std::rc::Rc<std::collections::BTreeMap<String, checked::Given>>>,
}

impl<'a> Checker<'a> {
    fn new(files: &[ast::File], sources: &'a SourceMap, level: Level) -> Self {
        Checker {
            sources,
            root: files.first().map_or(FileId(0), |file| file.id),
            level,
            texts: files.iter().flat_map(|f| f.texts.iter().copied()).collect(),
            checked: Checked::default(),
            diagnostics: Diagnostics::new(),
            constants: Table::new("constant"),
            entities: Table::new("entity"),
            worlds: Table::new("world"),
            tags: std::collections::BTreeMap::new(),
            placed: foreign::placed(files),
            lost: lasting::Lost::of(files),
            conditions: condition::Conditions::default(),
            instance_uses: Vec::new(),
            tile_counts: Vec::new(),
            has_unread_map: false,
            reads_unknown_size: false,
            facts: facts::Facts::default(),
            mode_names: std::collections::BTreeMap::new(),
            sets: IdVec::new(),
            set_ids: std::collections::BTreeMap::new(),
            values: std::collections::BTreeMap::new(),
            step: (1, 60),
            spawn_settings: std::collections::BTreeMap::new(),
            awaited: None,
            awaited_names: Vec::new(),
            poisoned_names: files.iter().flat_map(|f| f.poisoned_names.iter().cloned()).collect(),
        }
    }

    /// Declares all entities, so that bodies may refer to any of them; returns the bodies.
    fn declare<'t>(&mut self, entities: &'t [Arc<ast::Entity>]) -> Vec<entity::PendingBody<'t>> {
        // References name entities, so all names are known before any skeleton.
        for (index, entity) in entities.iter().take(MAX_ENTITIES).enumerate() {
            self.record_declaration(NameKind::Entity, &entity.name);
            self.entities.declare(&entity.name, EntityId(index as u32), &mut self.diagnostics);
        }
        if let Some(first) = entities.get(MAX_ENTITIES) {
            self.too_many("entities", MAX_ENTITIES, first.name.span);
            // Uses of them are not reported.
            let others = entities.iter().skip(MAX_ENTITIES);
            self.poisoned_names.extend(others.map(|entity| entity.name.text.to_string()));
        }
        self.checked.entities.reserve(entities.len());
        let mut bodies = Vec::with_capacity(entities.len());
        for entity in entities.iter().take(MAX_ENTITIES) {
            let (checked, body) = self.skeleton(entity);
            self.checked.entities.push(checked.into());
            bodies.push(body);
        }
        bodies
    }

    fn count_tags(&mut self) {
        if let Some(first) = self.checked.tags.get(TagId(MAX_TAGS as u32)) {
            let (count, at) = (self.checked.tags.len() as u64, first.span);
            self.diagnostics.report(TooMany { what: "tags".into(), count, limit: MAX_TAGS as u64, at });
        }
    }

    fn constant(&mut self, constant: &ast::Constant) {
        self.record_declaration(NameKind::Constant, &constant.name);
        let scope = expression::Scope::constant();
        let mut term = self.value(&constant.value, &scope);
        if let Some(annotation) = constant.dimension.as_ref().and_then(|d| self.annotation(d)) {
            term = term.and_then(|term| self.pinned(term, annotation));
        }
        if let Some(at) = term.as_ref().filter(|t| operators(t) > MAX_OPERATORS).map(|t| t.span) {
            // Each use of a constant is a copy: constants that use each other twice grow exponentially.
            self.diagnostics.report(ExpressionTooLong { at, limit: MAX_OPERATORS, unread: false });
            term = None;
        }
        if let Some(term) = term {
            self.constants.declare(&constant.name, term, &mut self.diagnostics);
        } else {
            self.poisoned_names.insert(constant.name.text.to_string());
        }
    }

    /// Applies the annotated dimension to a constant.
    fn pinned(&mut self, term: checked::Term, to: checked::Annotation) -> Option<checked::Term> {
        let value = self.evaluated(&term, ConstantContext::LITERALS)?;
        if let checked::TermKind::Quantity(quantity) = &term.kind
            && (quantity.1, quantity.2) != (to.px, to.s)
        {
            self.diagnostics.report(TypeMismatch {
                at: term.span,
                found: "a value of another dimension".into(),
                expected: "a value of the annotated dimension".into(),
                help: None,
            });
            return None;
        }
        Some(checked::Term { kind: checked::TermKind::Quantity(Box::new((value, to.px, to.s))), ..term })
    }

    /// The id of a tag, created on first use.
    fn tag(&mut self, name: &ast::Name) -> TagId {
        self.record_tag(name, false);
        self.tag_id(name)
    }

    fn tag_id(&mut self, name: &ast::Name) -> TagId {
        if let Some(&id) = self.tags.get(&name.text) {
            return id;
        }
        let id = self.checked.tags.push(name.clone());
        self.tags.insert(name.text.clone(), id);
        id
    }
}

/// Number of operators and calls of a constant, including those of constants in it.
fn operators(term: &checked::Term) -> usize {
    let operands = term.operands();
    usize::from(!operands.is_empty()) + operands.iter().map(operators).sum::<usize>()
}

impl<I, T> IdVec<I, T>
where
    I: crate::ir::Id,
{
    /// Whether a table has reached a limit.
    fn is_full(&self, limit: usize) -> bool {
        self.len() >= limit
    }
}
