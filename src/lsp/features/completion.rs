//! Completion: names of the kind that fits the cursor, keywords that can start or continue a statement, snippets. Names
//! that the current text does not resolve come from the last snapshot without errors.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::ir::Side;
use crate::sema::KNOWN_CONSTANTS;
use crate::sema::checked::{Entity, Type, World};
use crate::syntax::occurrence::NameKind;

use super::actions::create::relative;
use super::completion_items::{CompletionCollector, CompletionItem, CompletionKind};
#[cfg(feature = "testing")]
use super::completion_order::named_features;
use super::completion_order::ordered;
use super::completion_text::{deleted_names, half_typed};
use crate::lsp::location::FileOffset;
use crate::lsp::text::cursor::{Block, CursorContext};
use crate::lsp::text::operands::{after_operand, assigned_names, ends_operand};
use crate::lsp::text::words::statement_starts;
use crate::lsp::view::View;

/// The completion items at a position.
#[derive(Debug)]
pub(in crate::lsp) struct Completions {
    /// The range that an item replaces.
    pub replaces: Range<usize>,
    /// The best first.
    pub items: Vec<CompletionItem>,
    /// Whether one of the first is likely, or one of a few is wanted. A list that nobody asked for is worth opening only
    /// then.
    pub is_likely: bool,
}

/// The completion items at a position of an open document.
pub(in crate::lsp) fn completion(view: &View, at: &FileOffset) -> Option<Completions> {
    let document = view.documents.get(&at.path)?;
    let code = document.text.code();
    let cursor = CursorContext::at(code, at.byte);
    let items = collected(view, at, code, &cursor)?;
    let replaces = cursor.word.start..cursor.word.end.max(at.byte);
    let (items, is_likely) = ordered(&items, &cursor, own(&items, &cursor), shown(&items, view, at, &cursor));
    // A target comes after an arrow, whatever it is.
    let is_likely = is_likely || cursor.previous(1) == "->";
    Some(Completions { replaces, items, is_likely })
}

/// The names of the items at a position, and the features by which they are ordered.
#[cfg(feature = "testing")]
pub(in crate::lsp) fn evidence(view: &View, at: &FileOffset) -> Vec<(String, Vec<(String, f32)>)> {
    let Some(document) = view.documents.get(&at.path) else { return Vec::new() };
    let code = document.text.code();
    let cursor = CursorContext::at(code, at.byte);
    let Some(items) = collected(view, at, code, &cursor) else { return Vec::new() };
    named_features(&items, &cursor, own(&items, &cursor), &shown(&items, view, at, &cursor))
}

/// All items at a cursor.
fn collected<'v>(
    view: &'v View,
    at: &'v FileOffset,
    code: &'v str,
    cursor: &CursorContext<'_>,
) -> Option<CompletionCollector<'v>> {
    let mut items = CompletionCollector::new(view, &at.path, code);
    if !cursor.is_quoted {
        items.at(cursor);
        items.undeclared(cursor);
    } else if cursor.statement == ["import"] {
        items.files(view.programs.keys().filter_map(|other| relative(&at.path, other)));
    } else if let Some(endings) = quoted_files(cursor) {
        let folder = at.path.parent()?;
        items.files(view.disk.files(folder, endings).iter().filter_map(|other| relative(&at.path, other)));
    }
    Some(items)
}

/// The entity around a cursor.
fn own<'v>(items: &CompletionCollector<'v>, cursor: &CursorContext<'_>) -> Option<&'v Entity> {
    cursor.enclosing(Block::Entity).and_then(|block| items.entity(block.name))
}

/// The items that are shown: each once, without names that are gone and the word that is being typed.
fn shown(
    items: &CompletionCollector<'_>,
    view: &View,
    at: &FileOffset,
    cursor: &CursorContext<'_>,
) -> Vec<CompletionItem> {
    let deleted = deleted_names(view, at, items.code);
    let typed = half_typed(items.code, &cursor.word);
    let mut seen = BTreeSet::new();
    let mut found = items.list.clone();
    found.retain(|item| {
        let is_gone = deleted.contains(item.label.as_str()) || typed == Some(item.label.as_str());
        !is_gone && seen.insert((item.label.clone(), item.kind))
    });
    found
}

/// The endings of the files that a quoted text at the cursor can name.
fn quoted_files(cursor: &CursorContext<'_>) -> Option<&'static [&'static str]> {
    let first = cursor.statement.first().copied().unwrap_or_default();
    match (first, cursor.previous(1)) {
        ("map", "from" | "vglc") => Some(&["txt"]),
        ("map", "legend") => Some(&["json"]),
        ("map", "tiled") => Some(&["tmx", "tmj", "json"]),
        ("map", "ldtk") => Some(&["ldtk"]),
        ("look", _) => Some(&["png"]),
        _ => None,
    }
}

impl CompletionCollector<'_> {
    /// Adds the items for a cursor.
    fn at(&mut self, cursor: &CursorContext<'_>) {
        let own = cursor.enclosing(Block::Entity).and_then(|b| self.entity(b.name));
        let world = cursor.enclosing(Block::World).and_then(|b| self.world(b.name));
        if cursor.previous(1) == "." {
            return self.after_dot(cursor, own, world);
        }
        if let Some(call) = cursor.calls.last().copied()
            && self.argument(cursor, call.name, call.before, call.argument, own, world)
        {
            return;
        }
        if self.after_word(cursor, own, world) {
            return;
        }
        if cursor.statement.is_empty() {
            return self.statement(cursor, own);
        }
        self.expression(cursor, own, world);
    }

    fn after_dot(&mut self, cursor: &CursorContext<'_>, own: Option<&Entity>, world: Option<&World>) {
        let mut prefix: Vec<&str> = Vec::new();
        let mut back = 1;
        while cursor.previous(back) == "." {
            prefix.insert(0, cursor.previous(back + 1));
            back += 2;
        }
        let Some(first) = prefix.first().copied() else { return };
        let sent_to = match (cursor.previous(back), cursor.previous(back + 1)) {
            ("send", _) if first == "self" => own,
            ("all", "send") => self.entity(first),
            _ => None,
        };
        // `any Slime.x`
        if let ("any" | "all", before) = (cursor.previous(back), cursor.previous(back + 1))
            && before != "send"
            && let Some(entity) = self.entity(first)
        {
            return self.members(entity);
        }
        if let Some(entity) = sent_to {
            return self.signals(entity);
        }
        if let Some(entity) = own {
            let leads = matches!(cursor.previous(back), "->" | "in");
            let names_mode = entity.modes.iter().any(|m| m.path.iter().any(|p| p == first));
            if leads || names_mode && entity.refs.find(|r| r.name.text == first).is_none() {
                return self.modes(entity, &prefix);
            }
            let refers = entity.refs.iter().find(|r| r.name.text == first).and_then(|r| r.entity);
            let referred = refers.and_then(|id| self.programs.first()?.ide.checked.entities.get(id)).map(|e| &**e);
            // `e is Slime and e.`
            let tested = cursor.statement.windows(3).find_map(|words| match words {
                [name, "is", entity] if *name == first => self.entity(entity),
                _ => None,
            });
            let signal = entity.signals.iter().find(|s| s.name.text == first);
            if let Some(sum) = signal.and_then(|signal| signal.number.as_ref()) {
                self.add(0, &sum.name.text, CompletionKind::Property, "number of a signal");
                return;
            }
            match referred.or(tested) {
                Some(entity) if cursor.previous(back) == "send" => self.signals(entity),
                Some(entity) => self.members(entity),
                None => ["x", "y"].iter().for_each(|v| self.add(0, v, CompletionKind::Variable, "continuous")),
            }
            return;
        }
        let Some(world) = world else { return };
        if cursor.previous(back) == "in" {
            let subject =
                self.instance(world, cursor.previous(back + 1)).or_else(|| self.entity(cursor.previous(back + 1)));
            return subject.into_iter().for_each(|entity| self.modes(entity, &prefix));
        }
        if world.spaces.iter().any(|s| s.name.text == first) {
            ["width", "height"].iter().for_each(|m| self.add(0, m, CompletionKind::Property, "px"));
        }
        if let Some(entity) = self.instance(world, first) {
            self.members(entity);
        }
    }

    /// Adds the items for an argument of a call; returns false if it is an ordinary expression.
    fn argument(
        &mut self,
        cursor: &CursorContext<'_>,
        name: &str,
        before: &str,
        argument: usize,
        own: Option<&Entity>,
        world: Option<&World>,
    ) -> bool {
        let in_behavior = cursor.enclosing(Block::Behavior).map(|b| b.start);
        match name {
            "pressed" | "held" | "released" => {
                let buttons = own.into_iter().flat_map(|e| e.buttons.iter());
                buttons.for_each(|b| self.add(0, &b.text, CompletionKind::Input, "button"));
                if let Some(from) = in_behavior {
                    self.declared_after(from, &[NameKind::Button, NameKind::Argument]);
                }
            }
            // `touching(body at (16, 0), wall)`
            "touching" if argument == 0 && !matches!(cursor.previous(1), "(" | "at") => self.words(&["at"]),
            "touching" => {
                if argument < 2 {
                    self.names_of_kind(NameKind::Tag);
                }
                // What can be referred to can be touched: its tag often has the same name.
                if argument == 1 {
                    self.refs(own);
                }
                // A place has no sides.
                if argument > 0 && !cursor.statement.contains(&"at") {
                    Side::ALL.into_iter().for_each(|s| self.add(1, s.name(), CompletionKind::Value, "side"));
                }
            }
            "timer" | "entering" | "exiting" => {
                // `entering` and `exiting` accept only modes of other groups.
                let group = cursor.enclosing(Block::Group).filter(|_| name != "timer").map(|group| group.name);
                if let Some(entity) = own {
                    self.modes_of(entity, &[], |path| Some(path) != group);
                }
                if let Some(from) = in_behavior {
                    self.declared_after(from, &[NameKind::Mode]);
                }
            }
            "lost" => self.refs(own),
            "received" => own.into_iter().for_each(|entity| self.signals(entity)),
            "near" | "inside" if argument == 0 => {
                self.instances(world);
                if own.is_some() {
                    self.refs(own);
                    self.words(&["self", "all"]);
                }
                self.words(&["any"]);
            }
            "inside" => {
                self.spaces(world);
            }
            // `place hero: Hero at (40, above ground)`
            "at" if cursor.previous(1) == "above" => self.names_of_kind(NameKind::Tag),
            _ if before == "spawn" && matches!(cursor.previous(1), "(" | ",") => {
                if let Some(entity) = self.entity(name) {
                    self.settings(entity, &assigned_names(self.code, cursor.word.start, "("));
                }
            }
            _ if before == "use" && matches!(cursor.previous(1), "(" | ",") => {
                let from = self.list.len();
                if let Some(behavior) = self.programs.iter().find_map(|program| program.behavior(name)) {
                    let parameters = behavior.parameters.iter();
                    parameters.for_each(|p| self.add(0, &p.text, CompletionKind::Property, "parameter"));
                }
                self.as_assignments(from, &assigned_names(self.code, cursor.word.start, "("));
            }
            _ => return false,
        }
        true
    }

    /// Adds the items after a keyword that determines them; returns false if there is no such keyword.
    fn after_word(&mut self, cursor: &CursorContext<'_>, own: Option<&Entity>, world: Option<&World>) -> bool {
        let first = cursor.statement.first().copied().unwrap_or_default();
        let (last, before) = (cursor.previous(1), cursor.previous(2));
        let in_behavior = cursor.enclosing(Block::Behavior).map(|b| b.start);
        match (last, first) {
            ("->", "link") => self.spaces(world),
            ("->", _) => {
                // An edge stays in its group.
                let group = cursor.enclosing(Block::Group).map(|group| group.name);
                own.into_iter().for_each(|e| self.modes_of(e, &[], |path| group.is_none_or(|group| path == group)));
                if let Some(from) = in_behavior {
                    self.declared_after(from, &[NameKind::Mode, NameKind::Argument]);
                }
                self.awaited_modes(cursor);
            }
            ("in", "clamp") => return false,
            ("in", _) => {
                let subject = world.and_then(|w| self.instance(w, before));
                let refers = own.and_then(|e| e.refs.iter().find(|r| r.name.text == before)?.entity);
                let referred = refers.and_then(|id| self.checked().next()?.entities.get(id)).map(|e| &**e);
                // `any Slime in`
                let any = Some(())
                    .filter(|()| matches!(cursor.previous(3), "any" | "all" | "nearest"))
                    .and_then(|()| self.entity(before));
                if let Some(entity) = subject.or(any).or(referred).or(own) {
                    self.modes(entity, &[]);
                    self.groups(entity);
                }
            }
            ("touching", _) | ("with", "collide") | ("collide" | "collider" | "rect", _) => {
                self.names_of_kind(NameKind::Tag)
            }
            (",", "collide" | "collider" | "kinematic" | "look") if !cursor.statement.contains(&":") => {
                self.names_of_kind(NameKind::Tag);
            }
            // In an entity a colour or a path follows: nothing that has a name.
            ("look", "look") if own.is_some() => {}
            ("look", "look") => self.names_of_kind(NameKind::Tag),
            (":", "look") => {}
            (":", "collide") => self.words(&["block", "sense"]),
            ("block" | ",", "collide") => self.words(&["from above", "keep velocity", "carry", "bounce"]),
            ("sense" | "above" | "velocity" | "carry", "collide") => {}
            (":", "collider" | "kinematic") => self.functions(|name| matches!(name, "rect" | "circle")),
            ("kinematic", _) => self.words(&["collider"]),
            ("initial", _) => self.words(&["mode", "when"]),
            ("is", _) => {
                self.entities();
                self.words(&["none"]);
            }
            ("any" | "all" | "nearest" | "spawn" | "limit", _) => self.entities(),
            (":", "place") => self.entities(),
            (":", "ref") => {
                self.entities();
                self.words(&["any"]);
            }
            (":", "player") => self.instances(world),
            (":", "discrete") => self.words(&["int", "bool"]),
            ("=", "discrete") if cursor.statement.contains(&"bool") => self.words(&["false", "true"]),
            ("=", "=") => self.first_values(cursor),
            ("use", _) => {
                self.names_of_kind(NameKind::Behavior);
                self.importable(&[NameKind::Behavior]);
            }
            // Modes to which edges lead already.
            ("mode", _) if cursor.statement.len() <= 2 => self.awaited_modes(cursor),
            ("destroy", _) => {
                self.touched(cursor);
                self.refs(own);
                self.words(&["self"]);
            }
            ("send", _) => {
                self.touched(cursor);
                self.refs(own);
                self.words(&["self", "all"]);
            }
            ("by", "envelope") => {
                let axes = own.into_iter().flat_map(|e| e.axes.iter());
                axes.for_each(|a| self.add(0, &a.text, CompletionKind::Input, "axis"));
                self.functions(|name| name == "held");
            }
            ("map", _) if cursor.block() == Some(Block::Space) => {
                self.names_of_kind(NameKind::TileSet);
                self.words(&["level", "vglc", "tiled", "ldtk"]);
            }
            ("level", "map") => {
                self.names_of_kind(NameKind::TileSet);
                self.words(&["legend"]);
            }
            (":" | ",", _) if matches!(cursor.block(), Some(Block::Tiles | Block::Kinds)) => {
                self.names_of_kind(NameKind::Tag);
                self.words(&["empty", "spawn"]);
            }
            ("breakable", _) if matches!(cursor.block(), Some(Block::Tiles | Block::Kinds)) => {
                self.words(&["restore after"]);
            }
            ("follow", _) => self.words(&["links"]),
            ("directions", "envelope") => self.words(&["any"]),
            ("(" | ",", "envelope") if !cursor.statement.contains(&"by") => {
                let vars = own.into_iter().flat_map(|e| e.vars.iter());
                vars.for_each(|v| self.add(0, &v.name.text, CompletionKind::Variable, "continuous"));
            }
            ("(" | ",", "envelope") if cursor.calls.last().is_none_or(|call| call.name == "by") => {
                let axes = own.into_iter().flat_map(|e| e.axes.iter());
                axes.for_each(|a| self.add(0, &a.text, CompletionKind::Input, "axis"));
            }
            ("envelope" | "clamp", _) => {
                let vars = own.into_iter().flat_map(|e| e.vars.iter());
                vars.for_each(|v| self.add(0, &v.name.text, CompletionKind::Variable, "continuous"));
                if let Some(from) = in_behavior {
                    self.declared_after(from, &[NameKind::Variable]);
                }
            }
            ("attack" | "decay" | "release", _) if cursor.block() == Some(Block::Envelope) => {
                self.words(&["instant", "accel", "over"]);
                if last == "release" {
                    self.words(&["hold", "to"]);
                }
            }
            ("sustain", _) => {
                self.words(&["for"]);
                return false;
            }
            ("chance", "chance") if cursor.block() == Some(Block::Test) => self.words(&["seed"]),
            ("seed", "chance") => {}
            ("inputs", "inputs") => self.words(&["from"]),
            ("at" | "by", "expect") => self.words(&["end"]),
            ("without" | "within", "reachable" | "unreachable" | "unfound") => return false,
            ("never", "never") if cursor.block() == Some(Block::Test) => {
                self.questions(world, false);
                return false;
            }
            ("expect" | "reachable" | "unreachable" | "unfound", _) if cursor.statement.len() == 1 => {
                self.questions(world, last != "unfound");
                return false;
            }
            ("condition", "condition") | ("chance", "chance") if cursor.statement.len() == 1 => {}
            // The author chooses a new name.
            ("entity" | "behavior" | "world" | "mode" | "group" | "param" | "continuous" | "discrete" | "ref", _)
            | (
                "button" | "axis" | "signal" | "const" | "goal" | "never" | "tiles" | "space" | "place" | "player"
                | "as",
                _,
            ) => {}
            _ => return false,
        }
        true
    }

    /// Adds the goals of a world, or its `never`s.
    fn questions(&mut self, world: Option<&World>, are_goals: bool) {
        let Some(world) = world else { return };
        let (questions, detail): (Vec<_>, _) = match are_goals {
            true => (world.goals.iter().collect(), "goal"),
            false => (world.nevers.iter().collect(), "never"),
        };
        questions.iter().for_each(|q| self.add(0, &q.name.text, CompletionKind::Function, detail));
    }

    /// Adds the items at the start of a statement.
    fn statement(&mut self, cursor: &CursorContext<'_>, own: Option<&Entity>) {
        let block = cursor.block();
        let (words, snippets) = statement_starts(block);
        self.words(words);
        self.snippets(snippets);
        let line = self.code.get(..cursor.word.start).and_then(|before| before.rfind('\n')).map_or(0, |at| at + 1);
        if block.is_some() && line == cursor.word.start {
            // The closing braces of the enclosing blocks may be missing.
            self.words(statement_starts(None).0);
        }
        match block {
            Some(Block::Settings) => {
                let name = cursor.blocks.last().map_or("", |b| b.name);
                if let Some(entity) = self.entity(name) {
                    self.settings(entity, &assigned_names(self.code, cursor.word.start, "{"));
                }
            }
            Some(Block::Entity | Block::Mode | Block::Updates | Block::Behavior) => {
                if let Some(entity) = own {
                    entity.vars.iter().for_each(|v| self.add(1, &v.name.text, CompletionKind::Variable, "continuous"));
                    let discretes = entity.discretes.iter().map(|d| (&d.name.text, "discrete"));
                    for (name, detail) in discretes.chain(entity.refs.iter().map(|r| (&r.name.text, "ref"))) {
                        if block != Some(Block::Entity) {
                            self.add(1, name, CompletionKind::Variable, detail);
                        }
                    }
                }
            }
            _ => {}
        }
        // Behaviours, which no entity is known of, assign positions.
        if own.is_none() && matches!(block, Some(Block::Behavior | Block::Mode | Block::Updates)) {
            ["x", "y"].iter().for_each(|v| self.add(1, v, CompletionKind::Variable, "continuous"));
        }
    }

    /// Adds the items inside an expression.
    fn expression(&mut self, cursor: &CursorContext<'_>, own: Option<&Entity>, world: Option<&World>) {
        let in_world = cursor.enclosing(Block::World).is_some();
        if ends_operand(cursor) {
            return self.words(after_operand(cursor));
        }
        // The entity whose member is assigned: of a `place`, of a `spawn`, or the enclosing one.
        let settings = cursor.blocks.last().filter(|open| open.block == Block::Settings).map(|open| open.name);
        let spawned = cursor.calls.last().filter(|call| call.before == "spawn").map(|call| call.name);
        let set = settings.or(spawned).and_then(|name| self.entity(name));
        if let Some(of) = set
            && of.refs.iter().any(|r| r.name.text == cursor.previous(2))
        {
            self.instances(world);
            self.refs(own);
            return self.words(&["none", "self"]);
        }
        let compared = if matches!(cursor.previous(1), "==" | "!=" | ":=" | "=") { cursor.previous(2) } else { "" };
        let chosen = set.or(own).and_then(|e| e.discretes.iter().find(|d| d.name.text == compared));
        if let Some(values) = chosen.filter(|d| matches!(d.ty, Type::Set(_))).map(|d| &d.values) {
            values.iter().for_each(|v| self.add(0, v, CompletionKind::Value, "value"));
            let same = own.into_iter().flat_map(|e| e.discretes.iter());
            let same = same.filter(|d| d.name.text != compared && d.values == *values);
            same.for_each(|d| self.add(1, &d.name.text, CompletionKind::Variable, "discrete"));
            return self.functions(|name| name == "if");
        }
        let is_fixed = cursor.statement.first() == Some(&"param");
        if let (Some(entity), true) = (own, is_fixed) {
            entity.params.iter().for_each(|p| self.add(0, &p.name.text, CompletionKind::Constant, "param"));
        } else if let Some(entity) = own {
            self.touched(cursor);
            self.members(entity);
            self.refs(Some(entity));
            let modes = cursor.blocks.iter().filter(|open| open.block == Block::Mode);
            let modes: Vec<&str> = modes.map(|open| open.name).collect();
            self.conditions(&entity.conditions, Some(entity), &modes);
            entity.axes.iter().for_each(|a| self.add(0, &a.text, CompletionKind::Input, "axis"));
            entity.chances.iter().for_each(|c| self.add(0, &c.name.text, CompletionKind::Input, "chance"));
        }
        if let Some(from) = cursor.enclosing(Block::Behavior).map(|b| b.start) {
            use NameKind::{Argument, Chance, Condition, Discrete, Parameter, Variable};
            let kinds = [Argument, Parameter, Variable, Discrete, Chance, Condition];
            self.declared_after(from, &kinds);
        }
        self.names_of_kind(NameKind::Constant);
        for (name, value) in KNOWN_CONSTANTS {
            self.add(1, name, CompletionKind::Constant, &format!("{value:.6}, unless the program declares it"));
        }
        if cursor.block() == Some(Block::Space) && !cursor.statement.contains(&"when") {
            self.spaces(world);
            self.functions(is_arithmetic);
            if cursor.calls.last().is_some_and(|call| call.name == "at" && call.argument == 1) {
                self.words(&["above"]);
            }
        } else if in_world {
            self.instances(world);
            world.into_iter().for_each(|world| self.conditions(&world.conditions, None, &[]));
            self.functions(|name| is_arithmetic(name) || matches!(name, "near" | "distance" | "inside" | "count"));
            self.words(&["any", "all", "in", "touching", "and", "or", "not", "true", "false"]);
        } else if is_fixed {
            self.functions(is_arithmetic);
            self.words(&["and", "or", "not", "true", "false"]);
        } else {
            // The offset of a probe reads only the instance itself.
            let is_offset = cursor.calls.last().is_some_and(|call| call.name == "at");
            let is_foreign = |name: &str| {
                matches!(name, "touching" | "entering" | "exiting" | "lost" | "received" | "near" | "distance")
            };
            // All instances of an entity are asked on edges only.
            let first = cursor.statement.first().copied().unwrap_or_default();
            let is_edge = matches!(first, "when" | "and" | "or" | "condition" | "follow");
            let asks = (is_edge || cursor.block() == Some(Block::Updates)) && !is_offset;
            self.functions(|name| match name {
                "inside" | "rect" | "circle" => false,
                "count" => asks,
                _ => !(is_offset && is_foreign(name)),
            });
            if asks {
                self.words(&["any", "all", "nearest"]);
            }
            self.words(&["timer", "in", "is", "and", "or", "not", "true", "false", "none", "self"]);
        }
    }
}

/// Whether a function depends only on its arguments.
fn is_arithmetic(name: &str) -> bool {
    let reads = ["pressed", "held", "released", "touching", "timer", "entering", "exiting", "lost", "received"];
    !reads.contains(&name) && !matches!(name, "near" | "distance" | "inside" | "count" | "rect" | "circle")
}
