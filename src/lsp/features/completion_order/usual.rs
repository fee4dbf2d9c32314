//! The usual order of completion items in worlds and outside of items: statements in the order in which worlds are
//! written, tags by where they stand, names by their use.

use std::collections::BTreeMap;

use super::UNDECLARED;
use crate::lsp::features::completion_items::{CompletionCollector, CompletionItem, CompletionKind};
use crate::lsp::text::cursor::{Block, CursorContext};
use crate::lsp::text::lexer::{Kind, tokens, words};
use crate::lsp::text::words::usual_order;

/// The position of an item: lower is better. First a class, then a place in it.
pub(super) type Key = (usize, usize);

/// Functions in values, the most frequent first.
const VALUES: &[&str] = &["if", "min", "max", "clamp", "abs", "sin", "cos", "sign", "floor", "mod"];

/// Where a name occurs before the cursor.
#[derive(Default)]
struct Uses {
    /// The index of the first occurrence among the words, and of the last one.
    first: usize,
    last: usize,
    /// Whether it is used, not only declared.
    is_used: bool,
    /// The two words before its occurrences.
    after: Vec<String>,
}

/// What is known at a cursor outside of entities.
pub(super) struct UsualOrder<'a> {
    cursor: &'a CursorContext<'a>,
    of: &'a CompletionCollector<'a>,
    uses: BTreeMap<String, Uses>,
    words: usize,
    /// The first word of the statement before, in the same block.
    statement_before: String,
}

impl<'a> UsualOrder<'a> {
    pub fn new(of: &'a CompletionCollector<'a>, cursor: &'a CursorContext<'a>) -> Self {
        let mut order = UsualOrder { cursor, of, uses: BTreeMap::new(), words: 0, statement_before: String::new() };
        // Outside of all items the names do not matter.
        if let Some(item) = cursor.blocks.first() {
            order.read(of.code.get(item.start..cursor.word.start).unwrap_or_default());
        } else {
            order.read_items(of.code.get(..cursor.word.start).unwrap_or_default());
        }
        order
    }

    /// Reads the words before the cursor in the item around it.
    fn read(&mut self, text: &str) {
        let (mut before_last, mut last_word) = ("", "");
        let mut at_start = true;
        // Of each open block: the first word of the last statement.
        let mut open: Vec<&str> = vec![""];
        for token in tokens(text) {
            let word = token.text(text);
            match (token.kind, word) {
                (Kind::Comment, _) => continue,
                (Kind::Newline, _) => {
                    at_start = true;
                    continue;
                }
                (Kind::Symbol, "{") => {
                    open.push("");
                    at_start = true;
                }
                (Kind::Symbol, "}") => {
                    open.pop();
                    at_start = true;
                }
                (Kind::Symbol, ";") => at_start = true,
                (Kind::Word, _) => {
                    if let Some(first) = open.last_mut().filter(|_| at_start) {
                        *first = word;
                    }
                    at_start = false;
                    self.words += 1;
                    let uses = self.uses.entry(word.to_string()).or_default();
                    if uses.first == 0 {
                        uses.first = self.words;
                    }
                    uses.is_used |= !matches!(last_word, "place" | "condition");
                    uses.last = self.words;
                    uses.after.push(format!("{before_last} {last_word}"));
                }
                _ => at_start = false,
            }
            (before_last, last_word) = (last_word, word);
        }
        self.statement_before = open.last().copied().unwrap_or_default().to_string();
    }

    /// Reads what the last item before the cursor is.
    fn read_items(&mut self, text: &str) {
        let order = usual_order(None);
        let first = |line: &'_ str| line.split_whitespace().next().unwrap_or_default().to_string();
        let last = text.lines().rev().map(first).find(|word| order.contains(&word.as_str()));
        self.statement_before = last.unwrap_or_default();
    }

    /// Unused names in the order of their declaration, then the others, the last used first.
    fn by_use(&self, name: &str) -> usize {
        match self.uses.get(name) {
            Some(uses) if !uses.is_used => uses.first,
            Some(uses) => 10_000 + self.words.saturating_sub(uses.last),
            None => 30_000,
        }
    }

    /// The names that were used last first.
    fn by_recency(&self, name: &str) -> usize {
        self.uses.get(name).map_or(30_000, |uses| self.words.saturating_sub(uses.last))
    }

    /// The position of an item.
    pub fn key(&self, item: &CompletionItem) -> Key {
        let label = item.label.as_str();
        let first = self.cursor.statement.first().copied().unwrap_or_default();
        let last = self.cursor.previous(1);
        if item.is_import() {
            return (6_000, 0);
        }
        if item.detail == UNDECLARED {
            return (5_000, self.by_recency(label));
        }
        if self.cursor.statement.is_empty() {
            return self.statement(item);
        }
        if matches!(last, "." | "in") {
            return (0, self.by_recency(label));
        }
        if matches!(first, "collide" | "rect" | "look") && item.kind == CompletionKind::Value {
            return self.tag(label, first);
        }
        if matches!(item.kind, CompletionKind::Value | CompletionKind::Property) {
            return (0, self.given(item));
        }
        if self.is_condition() { self.condition(item) } else { self.value(item) }
    }

    /// The order in which items were collected.
    fn given(&self, item: &CompletionItem) -> usize {
        self.of.list.iter().position(|other| other == item).unwrap_or(usize::MAX)
    }

    /// Statements in their usual order, after the one before.
    fn statement(&self, item: &CompletionItem) -> Key {
        let word = item.label.split(' ').next().unwrap_or_default();
        let order = usual_order(self.cursor.block());
        let place = |word: &str| order.iter().position(|known| *known == word);
        if matches!(item.kind, CompletionKind::Variable | CompletionKind::Constant | CompletionKind::Property) {
            return (5, self.by_recency(word));
        }
        let (Some(at), from) = (place(word), place(&self.statement_before).unwrap_or(0)) else {
            return (40, self.given(item));
        };
        // What comes before the last statement in the usual order is less likely.
        let is_rare = word == "look" && self.statement_before != word;
        let distance = if at >= from { at - from } else { order.len() + at };
        let distance = distance + if is_rare { order.len() } else { 0 };
        // A snippet comes before its keyword.
        (0, distance * 2 + usize::from(item.kind != CompletionKind::Snippet))
    }

    /// Tags in `collide` lines: before `with` those of colliders, after it those that are asked for.
    fn tag(&self, label: &str, first: &str) -> Key {
        let code = self.of.code.get(..self.cursor.word.start).unwrap_or_default();
        let is_after_with = self.cursor.statement.contains(&"with");
        let lines = code.lines().filter(|line| line.trim_start().starts_with("collide"));
        let is_paired = lines.filter(|line| line.split("with").nth(1).is_some_and(|rest| is_word_of(rest, label)));
        let pairs = is_paired.count();
        let of_collider = |line: &str| {
            let line = line.trim_start();
            let line = line.strip_prefix("kinematic ").unwrap_or(line);
            line.starts_with("collider") && is_word_of(line.split(':').next().unwrap_or(line), label)
        };
        let is_of_collider = code.lines().any(of_collider);
        let last = code.rmatch_indices(label).next().map_or(usize::MAX, |(at, _)| code.len() - at);
        let first_at = code.find(label).unwrap_or(usize::MAX);
        match (first, is_after_with) {
            ("collide", true) => (pairs.min(1) + usize::from(is_of_collider), first_at),
            ("collide", false) => (usize::from(!is_of_collider), last),
            ("rect", _) => (usize::from(is_of_collider), first_at),
            _ => (0, last),
        }
    }

    /// Whether a condition is written at the cursor, and an operand of it begins.
    fn is_condition(&self) -> bool {
        let last = self.cursor.previous(1);
        let first = self.cursor.statement.first().copied().unwrap_or_default();
        matches!(last, "when" | "and" | "or" | "not")
            || first == "condition" && last == "="
            || matches!(first, "goal" | "never") && last == ":"
            || matches!(last, "expect" | "reachable" | "unreachable")
    }

    fn condition(&self, item: &CompletionItem) -> Key {
        let label = item.label.as_str();
        if self.cursor.enclosing(Block::World).is_none() {
            return (3, self.given(item));
        }
        match item.kind {
            CompletionKind::Instance => (0, self.by_recency(label)),
            CompletionKind::Variable | CompletionKind::Function if item.detail == "condition" => (1, 0),
            CompletionKind::Function => (if matches!(item.detail.as_str(), "goal" | "never") { 0 } else { 2 }, 0),
            _ => (3, self.given(item)),
        }
    }

    fn value(&self, item: &CompletionItem) -> Key {
        let label = item.label.as_str();
        match item.kind {
            CompletionKind::Constant if item.detail.ends_with("unless the program declares it") => {
                (20, self.by_use(label))
            }
            CompletionKind::Variable | CompletionKind::Constant | CompletionKind::Input | CompletionKind::Instance => {
                // What was written in such a place before.
                let place = format!("{} {}", self.cursor.previous(2), self.cursor.previous(1));
                let again = self.uses.get(label).is_some_and(|uses| uses.after.contains(&place));
                (1, if again { 0 } else { self.by_use(label) })
            }
            CompletionKind::Function => (10, VALUES.iter().position(|word| *word == label).unwrap_or(VALUES.len())),
            CompletionKind::Keyword => (11, self.given(item)),
            _ => (8, self.given(item)),
        }
    }
}

/// Whether a text has a word.
fn is_word_of(text: &str, word: &str) -> bool {
    words(text).any(|other| other == word)
}
