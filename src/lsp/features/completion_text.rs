//! Completion by what the text itself tells, resolved or not: names that are used and not declared yet, names that an
//! edge gives, the values in braces; and names that are gone.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::diagnostic::words::SIGNATURES;
use crate::ir::Side;
use crate::syntax::is_reserved;

use super::completion_items::{CompletionCollector, CompletionKind};
use super::completion_order::UNDECLARED;
use crate::lsp::location::FileOffset;
use crate::lsp::text::cursor::{Block, CursorContext};
use crate::lsp::text::lexer::{Kind, starts_name, tokens, words};
use crate::lsp::text::operands::ends_operand;
use crate::lsp::text::words::is_keyword;
use crate::lsp::view::View;

/// The word at the cursor, if it occurs nowhere else: it is no name yet.
pub(super) fn half_typed<'t>(code: &'t str, word: &Range<usize>) -> Option<&'t str> {
    // `x` and `y` need no declaration.
    let text = code.get(word.clone()).filter(|text| !matches!(*text, "" | "x" | "y"))?;
    let is_known = is_keyword(text) || words(code).filter(|other| *other == text).count() > 1;
    (!is_known).then_some(text)
}

/// The names that the last texts without errors had and that no current text has.
pub(super) fn deleted_names(view: &View, at: &FileOffset, code: &str) -> BTreeSet<String> {
    let states = || view.programs_with(&at.path);
    let older = states().filter(|state| !state.current.is_error_free()).filter_map(|state| state.last_good.as_deref());
    let mut deleted = BTreeSet::new();
    for snapshot in older {
        let Some(file) = snapshot.file(&at.path) else { continue };
        let declared = snapshot.ide.occurrences.iter().filter(|o| o.at.file() == file && o.at == o.declared);
        deleted.extend(declared.map(|o| snapshot.name(o).to_string()));
    }
    if deleted.is_empty() {
        return deleted;
    }
    let mut keep = |code: &str| {
        for word in words(code) {
            deleted.remove(word);
        }
    };
    keep(code);
    for snapshot in states().map(|state| &*state.current) {
        let files: BTreeSet<_> = snapshot.ide.occurrences.iter().map(|o| o.at.file()).collect();
        files
            .into_iter()
            .filter(|file| snapshot.path(*file) != at.path)
            .for_each(|file| keep(snapshot.text(file).code()));
    }
    deleted
}

impl CompletionCollector<'_> {
    /// Adds names that the item around uses before the cursor and that nothing declares yet: what is written from top to
    /// bottom uses some names again before they are declared.
    pub(super) fn undeclared(&mut self, cursor: &CursorContext<'_>) {
        let Some(item) = cursor.blocks.first().filter(|_| !cursor.statement.is_empty()) else { return };
        let before = cursor.previous(1);
        if cursor.calls.last().is_some_and(|call| matches!(call.name, "pressed" | "held" | "released")) {
            return;
        }
        // A new name, or one of which all are known.
        if ends_operand(cursor) || matches!(before, "." | "mode" | "param" | "button" | "axis") {
            return;
        }
        let code: &str = self.code;
        let text = code.get(item.start..cursor.word.start).unwrap_or_default();
        let mut names: BTreeSet<&str> = BTreeSet::new();
        let mut last = "";
        for token in tokens(text).filter(|token| token.kind != Kind::Comment) {
            let word = token.text(text);
            // A word of the language is a name in a list.
            let is_side = Side::ALL.into_iter().any(|side| side.name() == word);
            let is_name = !is_keyword(word) || matches!(last, "," | "->") && !is_reserved(word) && !is_side;
            if token.kind == Kind::Word && is_name && before != "group" {
                names.insert(word);
            }
            // `entering(hurt.yes)`
            if before == "group" && word == "." && !last.is_empty() {
                names.insert(last);
            }
            last = word;
        }
        for program in self.programs.iter().take(1) {
            for o in &program.ide.occurrences {
                names.remove(program.name(o));
            }
        }
        for item in &self.list {
            names.remove(item.label.as_str());
        }
        let is_function = |name: &str| SIGNATURES.iter().any(|signature| signature.name == name);
        for name in names.into_iter().filter(|name| !is_function(name) && *name != "x") {
            self.add(9, name, CompletionKind::Value, UNDECLARED);
        }
    }

    /// Adds the values in the braces before the cursor: `discrete way: {left, right} = `.
    pub(super) fn first_values(&mut self, cursor: &CursorContext<'_>) {
        let before = self.code.get(..cursor.word.start).unwrap_or_default();
        let statement = before.rfind("discrete").and_then(|at| before.get(at..)).unwrap_or_default();
        let inside = statement.split_once('{').and_then(|(_, rest)| rest.split_once('}'));
        let Some((values, _)) = inside.filter(|(_, rest)| rest.trim() == "=") else { return };
        for value in values.split(',').map(str::trim).filter(|value| !value.is_empty()) {
            self.add(0, value, CompletionKind::Value, "value");
        }
    }

    /// Adds the modes of the entity that edges and guards name, and that are not declared yet.
    pub(super) fn awaited_modes(&mut self, cursor: &CursorContext<'_>) {
        let Some(block) = cursor.enclosing(Block::Entity) else { return };
        let code: &str = self.code;
        let text = code.get(block.start..cursor.word.start).unwrap_or_default();
        let all = tokens(text).filter(|token| !matches!(token.kind, Kind::Comment | Kind::Newline));
        let words: Vec<&str> = all.map(|token| token.text(text)).collect();
        let declared: BTreeSet<&str> = words.windows(2).filter(|pair| pair[0] == "mode").map(|pair| pair[1]).collect();
        // Others than those that are known, in this group or another.
        let known = self.entity(block.name);
        let is_known =
            |name: &str| known.is_some_and(|entity| entity.modes.iter().any(|mode| &*mode.name.text == name));
        let mut awaited: Vec<&str> = Vec::new();
        for at in 1..words.len() {
            // `not in hidden`: of the instance itself; `entering(life.dead)`.
            let asks = match (at.checked_sub(2).map_or("", |at| words[at]), words[at - 1]) {
                (_, "->") => true,
                ("entering" | "exiting", "(") => true,
                (before, "in") => matches!(before, "when" | "and" | "or" | "not" | "="),
                _ => false,
            };
            let is_qualified = |at: usize| words.get(at + 1) == Some(&".");
            let mut last = at;
            while asks && is_qualified(last) {
                last += 2;
            }
            let Some(name) = words.get(last).filter(|name| asks && name.starts_with(starts_name)) else { continue };
            if !declared.contains(name) && !awaited.contains(name) && !is_known(name) {
                awaited.push(name);
            }
        }
        for name in awaited {
            self.add(0, name, CompletionKind::Mode, "named before");
        }
    }

    /// Adds the names that the edge at the cursor gives to what it touches: `touching(body, coin) as c`.
    pub(super) fn touched(&mut self, cursor: &CursorContext<'_>) {
        let code: &str = self.code;
        let edge = cursor.blocks.last().filter(|open| open.block == Block::Updates);
        let head = edge.and_then(|edge| code.get(edge.start..cursor.word.start)).unwrap_or_default();
        let head: Vec<&str> = tokens(head).map(|token| token.text(head)).collect();
        for words in [&head, &cursor.statement] {
            for pair in words.windows(2).filter(|pair| pair[0] == "as") {
                self.add(0, pair[1], CompletionKind::Instance, "touched");
            }
        }
    }
}
