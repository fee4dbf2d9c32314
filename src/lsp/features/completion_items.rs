//! Completion items: names by kind, keywords, functions, files, snippets. [`completion`](super::completion) decides
//! which of them fit a position.

use std::path::Path;

use crate::diagnostic::words::SIGNATURES;
use crate::sema::checked::{Checked, Condition, Entity, World};
use crate::source::FileId;
use crate::syntax::occurrence::{NameKind, Occurrence, Role};

use super::actions::create::importable;
use super::hover::kind_label;
use crate::lsp::snapshot::Snapshot;
use crate::lsp::text::words::Snippet;
use crate::lsp::view::View;

/// The kind of an item. Items with the same name are sorted by kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::lsp) enum CompletionKind {
    Mode,
    /// A function of the language, a goal or a `never`.
    Function,
    /// A continuous or discrete variable, a condition, or a reference.
    Variable,
    /// An instance, or the name of a touched one.
    Instance,
    Entity,
    Behavior,
    /// A space or a world.
    Space,
    /// A parameter of a behaviour, or a size of a space.
    Property,
    /// A group or a tile set.
    Group,
    Keyword,
    /// A text with placeholders.
    Snippet,
    File,
    /// A value of a discrete variable, a tag or a side.
    Value,
    /// A constant, or a parameter of an entity.
    Constant,
    /// A button, an axis or a chance.
    Input,
}

impl CompletionKind {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            CompletionKind::Mode => "mode",
            CompletionKind::Function => "function",
            CompletionKind::Variable => "variable",
            CompletionKind::Instance => "instance",
            CompletionKind::Entity => "entity",
            CompletionKind::Behavior => "behavior",
            CompletionKind::Space => "space",
            CompletionKind::Property => "property",
            CompletionKind::Group => "group",
            CompletionKind::Keyword => "keyword",
            CompletionKind::Snippet => "snippet",
            CompletionKind::File => "file",
            CompletionKind::Value => "value",
            CompletionKind::Constant => "constant",
            CompletionKind::Input => "input",
        }
    }
}

/// The inserted text.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::lsp) enum Insert {
    /// The label.
    Label,
    /// A text with placeholders such as `$1`. Editors without snippets insert the label.
    Snippet(String),
}

/// A completion item. The field order is the sort order.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::lsp) struct CompletionItem {
    /// Items that fit better have lower ranks.
    pub rank: u8,
    pub label: String,
    pub kind: CompletionKind,
    /// May be empty.
    pub detail: String,
    pub insert: Insert,
    /// The file that is imported with it.
    pub import: Option<String>,
}

impl CompletionItem {
    /// Whether it is a name that another file of the workspace has.
    pub fn is_import(&self) -> bool {
        self.import.is_some()
    }
}

/// Collects completion items.
pub(super) struct CompletionCollector<'a> {
    /// The current snapshots of the programs, then their last ones without errors.
    pub programs: Vec<&'a Snapshot>,
    view: &'a View,
    path: &'a Path,
    file: Option<FileId>,
    pub code: &'a str,
    pub list: Vec<CompletionItem>,
}

impl<'a> CompletionCollector<'a> {
    pub fn new(view: &'a View, path: &'a Path, code: &'a str) -> Self {
        let known: Vec<_> = view.programs_with(path).collect();
        let now = known.iter().map(|k| &*k.current);
        let programs: Vec<&Snapshot> = now.chain(known.iter().filter_map(|k| k.last_good.as_deref())).collect();
        let file = programs.first().and_then(|p| p.file(path));
        CompletionCollector { view, path, programs, file, code, list: Vec::new() }
    }

    pub fn add(&mut self, rank: u8, label: &str, kind: CompletionKind, detail: &str) {
        let (label, detail) = (label.to_string(), detail.to_string());
        self.list.push(CompletionItem { rank, label, kind, detail, insert: Insert::Label, import: None });
    }

    pub fn files(&mut self, paths: impl Iterator<Item = String>) {
        paths.for_each(|path| self.add(0, &path, CompletionKind::File, ""));
    }

    pub fn words(&mut self, words: &[&str]) {
        words.iter().for_each(|word| self.add(2, word, CompletionKind::Keyword, ""));
    }

    pub fn snippets(&mut self, snippets: &[Snippet]) {
        for Snippet { label, text, detail } in snippets {
            self.add(3, label, CompletionKind::Snippet, detail);
            if let Some(last) = self.list.last_mut() {
                last.insert = Insert::Snippet((*text).to_string());
            }
        }
    }

    pub fn checked(&self) -> impl Iterator<Item = &'a Checked> + use<'a> {
        self.programs.clone().into_iter().map(|p| &p.ide.checked)
    }

    /// Looks up an entity, preferably in the first snapshot in which it has members.
    pub fn entity(&self, name: &str) -> Option<&'a Entity> {
        let all = || self.checked().flat_map(|c| c.entities.iter()).filter(|e| e.name.text == name);
        all().find(|e| e.modes.len() + e.params.len() + e.buttons.len() > 0).or_else(|| all().next()).map(|e| &**e)
    }

    pub fn world(&self, name: &str) -> Option<&'a World> {
        let all = || self.checked().flat_map(|c| c.worlds.iter()).filter(|w| w.name.text == name);
        all().find(|w| !w.instances.is_empty()).or_else(|| all().next())
    }

    /// Adds names of some kinds that are declared in a behaviour, which starts at an offset in this file.
    pub fn declared_after(&mut self, from: usize, kinds: &[NameKind]) {
        let Some((program, file)) = self.programs.first().copied().zip(self.file) else { return };
        let all = &program.ide.occurrences;
        let first = all.partition_point(|o| (o.at.file(), o.at.range().start) < (file, from));
        let here = all.iter().skip(first).take_while(|o| o.at.file() == file).filter(|o| o.role == Role::Declared);
        // Skip the behaviour's own name; end at the next item.
        let is_item = |o: &&Occurrence| {
            matches!(o.kind, NameKind::Entity | NameKind::Behavior | NameKind::World | NameKind::Constant)
        };
        for o in here.skip(1).take_while(|o| !is_item(o)).filter(|o| kinds.contains(&o.kind)) {
            self.add(0, program.name(o), kind_of(o.kind), kind_label(o.kind));
        }
    }

    /// Adds names of some kinds that other files of the workspace declare, with their imports.
    pub fn importable(&mut self, wanted: &[NameKind]) {
        let known = self.programs.first().map(|snapshot| importable(self.view, snapshot, self.path));
        for (kind, name, path) in known.into_iter().flatten().filter(|(kind, ..)| wanted.contains(kind)) {
            self.add(4, &name, kind_of(kind), &format!("{} of `{path}`", kind_label(kind)));
            if let Some(last) = self.list.last_mut() {
                last.import = Some(path);
            }
        }
    }

    /// Adds the named groups of an entity, which qualify the names of modes.
    pub fn groups(&mut self, entity: &Entity) {
        for name in entity.groups.iter().filter_map(|group| group.name.as_ref()) {
            self.add(0, &name.text, CompletionKind::Group, "group");
            if let Some(last) = self.list.last_mut() {
                last.insert = Insert::Snippet(format!("{}.$0", name.text));
            }
        }
    }

    pub fn entities(&mut self) {
        self.importable(&[NameKind::Entity]);
        for entity in self.checked().flat_map(|c| c.entities.iter()) {
            self.add(0, &entity.name.text, CompletionKind::Entity, "entity");
        }
    }

    pub fn names_of_kind(&mut self, kind: NameKind) {
        for program in self.programs.clone() {
            let all = program.ide.occurrences.iter();
            for o in all.filter(|o| o.kind == kind && (o.role == Role::Declared || kind == NameKind::Tag)) {
                self.add(0, program.name(o), kind_of(kind), kind_label(kind));
            }
        }
    }

    /// Adds the modes of an entity, or its modes below a path.
    pub fn modes(&mut self, entity: &Entity, prefix: &[&str]) {
        self.modes_of(entity, prefix, |_| true);
    }

    /// Adds the modes in groups that a filter accepts.
    pub fn modes_of(&mut self, entity: &Entity, prefix: &[&str], wanted: impl Fn(&str) -> bool) {
        let last = |name: &str| entity.modes.iter().filter(|m| m.name.text == name).count();
        for mode in entity.modes.iter().filter(|m| m.path.first().is_some_and(|group| wanted(group))) {
            let path: Vec<&str> = mode.path.iter().map(String::as_str).collect();
            if prefix.is_empty() {
                // The full path only if the name is ambiguous.
                let short = last(&mode.name.text) == 1;
                let label = if short { mode.name.text.to_string() } else { mode.path.join(".") };
                self.add(0, &label, CompletionKind::Mode, "mode");
            } else if let Some((name, outer)) = path.split_last()
                && outer.ends_with(prefix)
            {
                self.add(0, name, CompletionKind::Mode, "mode");
            }
        }
    }

    /// Adds the conditions of an entity that are visible in some modes, or those of a world.
    pub fn conditions(&mut self, of: &[Condition], entity: Option<&Entity>, modes: &[&str]) {
        for condition in of {
            let mode = condition.mode.and_then(|mode| entity?.modes.get(mode));
            if mode.is_none_or(|mode| modes.contains(&&*mode.name.text)) {
                self.add(0, &condition.name.text, CompletionKind::Variable, "condition");
            }
        }
    }

    /// Adds the variables and parameters of an entity: the members that other entities can read.
    pub fn members(&mut self, entity: &Entity) {
        entity.vars.iter().for_each(|v| self.add(0, &v.name.text, CompletionKind::Variable, "continuous"));
        entity.discretes.iter().for_each(|d| self.add(0, &d.name.text, CompletionKind::Variable, "discrete"));
        entity.params.iter().for_each(|p| self.add(0, &p.name.text, CompletionKind::Constant, "param"));
    }

    /// Adds the signals that an entity receives.
    pub fn signals(&mut self, entity: &Entity) {
        entity.signals.iter().for_each(|s| self.add(0, &s.name.text, CompletionKind::Input, "signal"));
    }

    /// Adds assignments to the settable members of an entity, without those that are already assigned.
    pub fn settings(&mut self, entity: &Entity, assigned: &[&str]) {
        let from = self.list.len();
        self.members(entity);
        self.refs(Some(entity));
        self.as_assignments(from, assigned);
    }

    /// Turns the items from an index on into assignments, without those that are already assigned.
    pub fn as_assignments(&mut self, from: usize, assigned: &[&str]) {
        let collected = self.list.split_off(from);
        for mut item in collected.into_iter().filter(|item| !assigned.contains(&item.label.as_str())) {
            item.insert = Insert::Snippet(format!("{} = $1", item.label));
            self.list.push(item);
        }
    }

    pub fn functions(&mut self, wanted: impl Fn(&str) -> bool) {
        let mut last_name = "";
        for s in SIGNATURES.iter().filter(|s| wanted(s.name)) {
            // Overloads are adjacent: add only the first.
            if std::mem::replace(&mut last_name, s.name) == s.name {
                continue;
            }
            self.add(1, s.name, CompletionKind::Function, s.doc);
            if let Some(last) = self.list.last_mut() {
                last.insert = Insert::Snippet(format!("{}($1)", s.name));
            }
        }
    }

    /// Looks up the entity of an instance.
    pub fn instance(&self, world: &World, name: &str) -> Option<&'a Entity> {
        let instance = world.instances.iter().find(|i| i.name.text == name)?;
        // The entity id refers to the program that contains the world.
        self.checked().filter(|c| c.worlds.iter().any(|w| w.span == world.span)).find_map(|c| {
            let entity = c.entities.get(instance.entity)?;
            Some(&**entity)
        })
    }

    pub fn instances(&mut self, world: Option<&World>) {
        let named = world.into_iter().flat_map(|w| w.instances.iter()).filter(|i| !i.name.text.contains('#'));
        let names: Vec<String> = named.map(|i| i.name.text.to_string()).collect();
        names.iter().for_each(|name| self.add(0, name, CompletionKind::Instance, "instance"));
    }

    pub fn spaces(&mut self, world: Option<&World>) {
        let spaces = world.into_iter().flat_map(|w| w.spaces.iter());
        spaces.for_each(|s| self.add(0, &s.name.text, CompletionKind::Space, "space"));
    }

    pub fn refs(&mut self, own: Option<&Entity>) {
        let refs = own.into_iter().flat_map(|e| e.refs.iter());
        refs.for_each(|r| self.add(0, &r.name.text, CompletionKind::Variable, "ref"));
    }
}

/// The kind of item for a name.
fn kind_of(kind: NameKind) -> CompletionKind {
    match kind {
        NameKind::Constant | NameKind::Parameter => CompletionKind::Constant,
        NameKind::Entity => CompletionKind::Entity,
        NameKind::Behavior => CompletionKind::Behavior,
        NameKind::Argument => CompletionKind::Property,
        NameKind::World | NameKind::Space => CompletionKind::Space,
        NameKind::Group | NameKind::TileSet => CompletionKind::Group,
        NameKind::Mode => CompletionKind::Mode,
        NameKind::Variable | NameKind::Discrete | NameKind::Condition | NameKind::Reference => CompletionKind::Variable,
        NameKind::Value | NameKind::Tag => CompletionKind::Value,
        NameKind::Touched | NameKind::Instance => CompletionKind::Instance,
        NameKind::Button | NameKind::Axis | NameKind::Chance => CompletionKind::Input,
        NameKind::Signal => CompletionKind::Input,
        NameKind::SignalNumber => CompletionKind::Property,
        NameKind::Goal | NameKind::Never => CompletionKind::Function,
    }
}
