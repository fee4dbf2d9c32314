//! Where a cursor is, told from the words before it: the blocks around it, the statement that it is in, the brackets
//! that are open. Works in any text, finished or not.

use super::lexer::{Kind, Token, tokens};
use super::words::begins;

/// What a block is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::lsp) enum Block {
    Entity,
    Behavior,
    Group,
    Mode,
    /// The updates of an edge.
    Updates,
    Envelope,
    World,
    Tiles,
    Space,
    /// What a `place` sets.
    Settings,
    /// What the names and characters of a level stand for.
    Kinds,
    /// The values of a discrete variable, and what is not known.
    Other,
}

/// A block that is open.
#[derive(Debug, Clone)]
pub(in crate::lsp) struct Open<'t> {
    pub block: Block,
    /// Its name, if it has one.
    pub name: &'t str,
    /// The first byte of its head.
    pub start: usize,
    /// How far the line of its head is indented, bytes.
    indent: usize,
}

/// A bracket that is open, and what is called with it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::lsp) struct Call<'t> {
    pub name: &'t str,
    /// The word before the name, such as `spawn`.
    pub before: &'t str,
    /// Which argument the cursor is in.
    pub argument: usize,
    /// What it is called, if it is given by name.
    pub given: &'t str,
}

/// A bracket that is open in a statement.
struct Bracket {
    /// Which word of the statement it is.
    start: usize,
    /// How many commas came since.
    commas: usize,
    /// Which word the last of them is, or else the bracket.
    last: usize,
}

/// Where a cursor is.
#[derive(Debug, Clone, Default)]
pub(in crate::lsp) struct Place<'t> {
    /// The blocks around it, outermost first.
    pub blocks: Vec<Open<'t>>,
    /// The words of its statement, those before it; the one that is being written is not among them.
    pub statement: Vec<&'t str>,
    /// The bytes of the word that is being written.
    pub word: std::ops::Range<usize>,
    /// The calls that are open, outermost first.
    pub calls: Vec<Call<'t>>,
    /// The first byte of the statement.
    begin: usize,
    /// How far the line in which the statement begins is indented, bytes.
    indent: usize,
    /// Whether it is in a comment or a text in quotes. In a text, the word is what the quotes hold.
    pub is_quoted: bool,
}

impl<'t> Place<'t> {
    /// Of a byte of a text.
    pub fn of(text: &'t str, byte: usize) -> Self {
        let mut place = Place { word: byte..byte, ..Place::default() };
        let mut brackets: Vec<Bracket> = Vec::new();
        for token in tokens(text) {
            if token.at.start >= byte {
                break;
            }
            let Token { kind, at } = &token;
            let written = token.text(text);
            let is_open = *kind == Kind::Text && (written.len() == 1 || !written.ends_with('"'));
            let inside = at.start < byte && (byte < at.end || is_open && byte == at.end);
            if *kind == Kind::Text && inside {
                place.word = at.start + 1..at.end - usize::from(!is_open);
            }
            if matches!(kind, Kind::Comment) && byte <= at.end || matches!(kind, Kind::Text | Kind::Tile) && inside {
                place.is_quoted = true;
                break;
            }
            if *kind == Kind::Word && byte <= at.end {
                place.word = at.clone();
                break;
            }
            place.take(text, &token, &mut brackets);
        }
        for Bracket { start, commas, last } in brackets {
            let word = |at: Option<usize>| at.and_then(|at| place.statement.get(at)).copied().unwrap_or_default();
            let (name, before) = (word(start.checked_sub(1)), word(start.checked_sub(2)));
            let given = if word(Some(last + 2)) == "=" { word(Some(last + 1)) } else { "" };
            place.calls.push(Call { name, before, argument: commas, given });
        }
        place
    }

    fn take(&mut self, text: &'t str, token: &Token, brackets: &mut Vec<Bracket>) {
        let word = text.get(token.at.clone()).unwrap_or_default();
        let line = text.get(..token.at.start).and_then(|before| before.rfind('\n')).map_or(0, |at| at + 1);
        let is_first = text.get(line..token.at.start).is_some_and(|before| before.trim().is_empty());
        if is_first && brackets.is_empty() && !matches!(token.kind, Kind::Newline | Kind::Comment) {
            let indent = token.at.start - line;
            // What is further left than the head of a block is not in it: the block is still to be closed.
            while self.blocks.last().is_some_and(|open| open.indent > indent) {
                self.blocks.pop();
            }
            if self.statement.is_empty() && !matches!(word, "and" | "or" | "->" | "{") {
                self.indent = indent;
            }
        }
        if self.statement.is_empty() && begins(None).0.contains(&word) {
            self.blocks.clear();
        }
        match word {
            "{" => {
                let head = std::mem::take(&mut self.statement);
                let outer = self.blocks.last().map(|b| b.block);
                let (block, name) = opened(&head, outer);
                self.blocks.push(Open { block, name, start: self.begin, indent: self.indent });
                brackets.clear();
            }
            "}" => {
                self.blocks.pop();
                self.statement.clear();
                brackets.clear();
            }
            ";" => {
                self.statement.clear();
                brackets.clear();
            }
            _ if token.kind == Kind::Newline => {
                let goes_on = self.statement.last().is_some_and(|last| {
                    matches!(*last, "and" | "or" | "not" | "," | "+" | "-" | "*" | "/" | "<" | ">" | "=" | ":=" | "->")
                });
                if brackets.is_empty() && !goes_on {
                    self.statement.clear();
                }
            }
            _ if token.kind == Kind::Comment => {}
            _ => {
                match word {
                    "(" => {
                        let start = self.statement.len();
                        brackets.push(Bracket { start, commas: 0, last: start });
                    }
                    ")" => drop(brackets.pop()),
                    "," => {
                        if let Some(bracket) = brackets.last_mut() {
                            bracket.commas += 1;
                            bracket.last = self.statement.len();
                        }
                    }
                    _ => {}
                }
                if self.statement.is_empty() {
                    self.begin = token.at.start;
                }
                self.statement.push(word);
            }
        }
    }

    /// The innermost block.
    pub fn block(&self) -> Option<Block> {
        self.blocks.last().map(|b| b.block)
    }

    /// The block of some kind around it.
    pub fn around(&self, block: Block) -> Option<&Open<'t>> {
        self.blocks.iter().rev().find(|b| b.block == block)
    }

    /// The word a number of words back.
    pub fn back(&self, count: usize) -> &'t str {
        self.statement.len().checked_sub(count).and_then(|at| self.statement.get(at)).copied().unwrap_or_default()
    }
}

/// What a block is by its head.
fn opened<'t>(head: &[&'t str], outer: Option<Block>) -> (Block, &'t str) {
    let word = |at: usize| head.get(at).copied().unwrap_or_default();
    let after = |key: &str| head.iter().position(|w| *w == key).map(|at| word(at + 1)).unwrap_or_default();
    match (word(0), outer) {
        ("entity", _) => (Block::Entity, word(1)),
        ("behavior", _) => (Block::Behavior, word(1)),
        ("world", _) => (Block::World, word(1)),
        ("group", _) => (Block::Group, word(1)),
        ("mode" | "initial", _) => (Block::Mode, after("mode")),
        ("when" | "follow" | "->" | "and" | "or", _) => (Block::Updates, ""),
        ("envelope", _) => (Block::Envelope, ""),
        ("tiles", Some(Block::World)) => (Block::Tiles, word(1)),
        ("space", Some(Block::World)) => (Block::Space, word(1)),
        ("place", Some(Block::Space)) => (Block::Settings, word(3)),
        ("map", Some(Block::Space)) => (Block::Kinds, ""),
        _ => (Block::Other, ""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> (String, usize) {
        let byte = text.find('|').unwrap_or(text.len());
        (text.replacen('|', "", 1), byte)
    }

    #[test]
    fn blocks_and_statements_are_told() {
        let (text, byte) = at("entity A {\n  mode up {\n    when held(b)\n  and y > 3 -> do|wn");
        let place = Place::of(&text, byte);
        assert_eq!(place.block(), Some(Block::Mode));
        assert_eq!(place.around(Block::Entity).map(|b| b.name), Some("A"));
        assert_eq!((place.back(1), &text[place.word.clone()]), ("->", "down"));
    }

    #[test]
    fn blocks_that_are_still_to_be_closed_end_where_their_outer_ones_go_on() {
        let (text, byte) = at("world W {\n    space s {\n        place a: A at (0,\n    0) {\n    }\n    |\n}");
        assert_eq!(Place::of(&text, byte).block(), Some(Block::World));
        let (text, byte) = at("entity A {\n    mode m {\n        when x > 3 {\n\nworld W {\n    |");
        let place = Place::of(&text, byte);
        assert_eq!(place.blocks.iter().map(|open| open.name).collect::<Vec<_>>(), ["W"]);
        let (text, byte) =
            at("entity A {\n    mode m {\n        when a\n            and b -> m {\n        }\n        |");
        assert_eq!(Place::of(&text, byte).block(), Some(Block::Mode), "a head of several lines");
        let (text, byte) = at("entity A {\nmode m {\nwhen x > 3 {\n|");
        assert_eq!(Place::of(&text, byte).block(), Some(Block::Updates), "not indented at all");
    }

    #[test]
    fn calls_are_told() {
        let (text, byte) = at("world W { goal g: near(hero, (3, 4), |");
        let call = |name, argument| Call { name, before: ":", argument, given: "" };
        assert_eq!(Place::of(&text, byte).calls, [call("near", 2)]);
        let (text, byte) = at("entity A { mode m { when touching(a, |");
        assert_eq!(Place::of(&text, byte).calls, [Call { name: "touching", before: "when", argument: 1, given: "" }]);
        let (text, byte) = at("entity A { use B(a = max(1, 2), b = |");
        assert_eq!(Place::of(&text, byte).calls, [Call { name: "B", before: "use", argument: 1, given: "b" }]);
    }

    #[test]
    fn texts_and_comments_are_told() {
        let (text, byte) = at("import \"a|\"");
        assert!(Place::of(&text, byte).is_quoted);
        let place = Place::of(&text, byte);
        assert_eq!(&text[place.word], "a", "what stands in the quotes");
        let (text, byte) = at("import \"a|");
        assert!(Place::of(&text, byte).is_quoted);
        let (text, byte) = at("import \"a\"|");
        assert!(!Place::of(&text, byte).is_quoted);
        let (text, byte) = at("x // a|");
        assert!(Place::of(&text, byte).is_quoted);
    }
}
