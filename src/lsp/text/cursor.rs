//! The context of a cursor, from the tokens before it: the enclosing blocks, the current statement, the open calls.
//! Works in any text, complete or not.

use super::lexer::{Kind, Token, tokens};
use super::words::statement_starts;
use crate::syntax::ast::ALWAYS;

/// The kind of a block.
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
    /// The settings of a `place`, or of a tile that spawns.
    Settings,
    /// The meanings of the names and characters of a level.
    Kinds,
    /// The statements of a test.
    Test,
    /// The values of a discrete variable, or an unknown block.
    Other,
}

/// A block that is open at the cursor.
#[derive(Debug, Clone)]
pub(in crate::lsp) struct OpenBlock<'t> {
    pub block: Block,
    /// Its name; may be empty.
    pub name: &'t str,
    /// The offset of its head.
    pub start: usize,
    /// The indentation of the line of its head, bytes.
    indent: usize,
}

/// A call whose parenthesis is open at the cursor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::lsp) struct Call<'t> {
    pub name: &'t str,
    /// The word before the name, such as `spawn`.
    pub before: &'t str,
    /// The index of the argument at the cursor.
    pub argument: usize,
    /// The name of that argument if it is passed by name, or else empty.
    pub argument_name: &'t str,
}

/// A bracket that is open in a statement.
struct Bracket {
    /// Its index in the words of the statement.
    start: usize,
    /// Number of commas since then.
    commas: usize,
    /// The index of the last comma, or else of the bracket.
    last: usize,
}

/// The context of a cursor.
#[derive(Debug, Clone, Default)]
pub(in crate::lsp) struct CursorContext<'t> {
    /// The enclosing blocks, outermost first.
    pub blocks: Vec<OpenBlock<'t>>,
    /// The words of the statement before the cursor, without the one at the cursor.
    pub statement: Vec<&'t str>,
    /// The range of the word at the cursor; empty if there is none.
    pub word: std::ops::Range<usize>,
    /// The open calls, outermost first.
    pub calls: Vec<Call<'t>>,
    /// Whether the statement ends unless the next token continues it.
    is_line_over: bool,
    /// The offset of the statement.
    statement_start: usize,
    /// The indentation of the first line of the statement, bytes.
    indent: usize,
    /// Whether the cursor is in a comment or a quoted string. In a string, `word` is the range between the quotes.
    pub is_quoted: bool,
}

impl<'t> CursorContext<'t> {
    /// The context at an offset in a text.
    pub fn at(text: &'t str, byte: usize) -> Self {
        let mut cursor = CursorContext { word: byte..byte, ..CursorContext::default() };
        let mut brackets: Vec<Bracket> = Vec::new();
        // The offset of the line that the next token begins.
        let mut line = Some(0);
        for token in tokens(text) {
            if token.at.start >= byte {
                break;
            }
            let Token { kind, at } = &token;
            let token_text = token.text(text);
            let is_open = *kind == Kind::Text && (token_text.len() == 1 || !token_text.ends_with('"'));
            let inside = at.start < byte && (byte < at.end || is_open && byte == at.end);
            if *kind == Kind::Text && inside {
                cursor.word = at.start + 1..at.end - usize::from(!is_open);
            }
            if matches!(kind, Kind::Comment) && byte <= at.end || matches!(kind, Kind::Text | Kind::Tile) && inside {
                cursor.is_quoted = true;
                break;
            }
            if *kind == Kind::Word && byte <= at.end {
                cursor.word = at.clone();
                break;
            }
            cursor.consume(text, &token, line, &mut brackets);
            line = (token.kind == Kind::Newline).then_some(token.at.end);
        }
        if cursor.is_line_over {
            cursor.statement.clear();
        }
        for Bracket { start, commas, last } in brackets {
            let word = |at: Option<usize>| at.and_then(|at| cursor.statement.get(at)).copied().unwrap_or_default();
            let (name, before) = (word(start.checked_sub(1)), word(start.checked_sub(2)));
            let argument_name = if word(Some(last + 2)) == "=" { word(Some(last + 1)) } else { "" };
            cursor.calls.push(Call { name, before, argument: commas, argument_name });
        }
        cursor
    }

    fn consume(&mut self, text: &'t str, token: &Token, line: Option<usize>, brackets: &mut Vec<Bracket>) {
        let word = text.get(token.at.clone()).unwrap_or_default();
        let is_blank = matches!(token.kind, Kind::Newline | Kind::Comment);
        if !is_blank && std::mem::take(&mut self.is_line_over) && !goes_on(word) {
            self.statement.clear();
        }
        if let Some(line) = line.filter(|_| brackets.is_empty() && !is_blank) {
            let indent = token.at.start - line;
            // Less indentation than the head of a block: its closing brace is missing.
            while self.blocks.last().is_some_and(|open| open.indent > indent) {
                self.blocks.pop();
            }
            if self.statement.is_empty() && !goes_on(word) {
                self.indent = indent;
            }
        }
        if self.statement.is_empty() && statement_starts(None).0.contains(&word) {
            self.blocks.clear();
        }
        match word {
            "{" => {
                let head = std::mem::take(&mut self.statement);
                let outer = self.blocks.last().map(|b| b.block);
                let (block, name) = block_of_head(&head, outer);
                self.blocks.push(OpenBlock { block, name, start: self.statement_start, indent: self.indent });
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
                self.is_line_over = brackets.is_empty() && !self.statement.last().is_some_and(|last| awaits_more(last));
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
                    self.statement_start = token.at.start;
                }
                self.statement.push(word);
            }
        }
    }

    /// The innermost block.
    pub fn block(&self) -> Option<Block> {
        self.blocks.last().map(|b| b.block)
    }

    /// The innermost enclosing block of a kind.
    pub fn enclosing(&self, block: Block) -> Option<&OpenBlock<'t>> {
        self.blocks.iter().rev().find(|b| b.block == block)
    }

    /// The `count`th word before the cursor in the statement, from 1; empty if there are fewer.
    pub fn previous(&self, count: usize) -> &'t str {
        self.statement.len().checked_sub(count).and_then(|at| self.statement.get(at)).copied().unwrap_or_default()
    }
}

const OPERATORS: &[&str] = &["and", "or", "+", "-", "*", "/", "<", "<=", ">", ">=", "==", "!="];

/// Whether a statement continues after a line that ends with this token.
fn awaits_more(token: &str) -> bool {
    OPERATORS.contains(&token) || matches!(token, "not" | "," | "=" | ":=" | "+=" | "-=" | "->")
}

/// Whether a line that begins with this token continues the statement before.
fn goes_on(token: &str) -> bool {
    OPERATORS.contains(&token) || matches!(token, "->" | "{")
}

/// The kind and the name of a block, from the words of its head.
fn block_of_head<'t>(head: &[&'t str], outer: Option<Block>) -> (Block, &'t str) {
    let word = |at: usize| head.get(at).copied().unwrap_or_default();
    let after = |key: &str| head.iter().position(|w| *w == key).map(|at| word(at + 1)).unwrap_or_default();
    match (word(0), outer) {
        ("entity", _) => (Block::Entity, word(1)),
        ("behavior", _) => (Block::Behavior, word(1)),
        ("world", _) => (Block::World, word(1)),
        ("group", _) => (Block::Group, word(1)),
        ("mode" | "initial", _) => (Block::Mode, after("mode")),
        ("always", Some(Block::Entity | Block::Behavior)) => (Block::Mode, ALWAYS),
        ("when" | "else" | "follow" | "->" | "and" | "or", _) => (Block::Updates, ""),
        ("envelope", _) => (Block::Envelope, ""),
        ("tiles", Some(Block::World)) => (Block::Tiles, word(1)),
        ("space", Some(Block::World)) => (Block::Space, word(1)),
        ("test", Some(Block::World)) => (Block::Test, word(1)),
        ("place", Some(Block::Space)) => (Block::Settings, word(3)),
        ("map", Some(Block::Space)) => (Block::Kinds, ""),
        (_, Some(Block::Tiles | Block::Kinds)) if head.contains(&"spawn") => (Block::Settings, after("spawn")),
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
        let cursor = CursorContext::at(&text, byte);
        assert_eq!(cursor.block(), Some(Block::Mode));
        assert_eq!(cursor.enclosing(Block::Entity).map(|b| b.name), Some("A"));
        assert_eq!((cursor.previous(1), &text[cursor.word.clone()]), ("->", "down"));
    }

    #[test]
    fn blocks_that_are_still_to_be_closed_end_where_their_outer_ones_go_on() {
        let (text, byte) = at("world W {\n    space s {\n        place a: A at (0,\n    0) {\n    }\n    |\n}");
        assert_eq!(CursorContext::at(&text, byte).block(), Some(Block::World));
        let (text, byte) = at("entity A {\n    mode m {\n        when x > 3 {\n\nworld W {\n    |");
        let cursor = CursorContext::at(&text, byte);
        assert_eq!(cursor.blocks.iter().map(|open| open.name).collect::<Vec<_>>(), ["W"]);
        let (text, byte) =
            at("entity A {\n    mode m {\n        when a\n            and b -> m {\n        }\n        |");
        assert_eq!(CursorContext::at(&text, byte).block(), Some(Block::Mode), "a head of several lines");
        let (text, byte) = at("entity A {\nmode m {\nwhen x > 3 {\n|");
        assert_eq!(CursorContext::at(&text, byte).block(), Some(Block::Updates), "not indented at all");
        let (text, byte) = at("entity A {\n    mode m {\n        when x\n            > 3\n        {\n            |");
        assert_eq!(CursorContext::at(&text, byte).block(), Some(Block::Updates), "a line begins with an operator");
        let (text, byte) = at("entity A\n{\n    mode m\n    {\n        x' = 3\n        |");
        let cursor = CursorContext::at(&text, byte);
        assert_eq!((cursor.block(), cursor.previous(1)), (Some(Block::Mode), ""), "a brace on a line of its own");
    }

    #[test]
    fn calls_are_told() {
        let (text, byte) = at("world W { goal g: near(hero, (3, 4), |");
        let call = |name, argument| Call { name, before: ":", argument, argument_name: "" };
        assert_eq!(CursorContext::at(&text, byte).calls, [call("near", 2)]);
        let (text, byte) = at("entity A { mode m { when touching(a, |");
        assert_eq!(
            CursorContext::at(&text, byte).calls,
            [Call { name: "touching", before: "when", argument: 1, argument_name: "" }]
        );
        let (text, byte) = at("entity A { use B(a = max(1, 2), b = |");
        assert_eq!(
            CursorContext::at(&text, byte).calls,
            [Call { name: "B", before: "use", argument: 1, argument_name: "b" }]
        );
    }

    #[test]
    fn texts_and_comments_are_told() {
        let (text, byte) = at("import \"a|\"");
        assert!(CursorContext::at(&text, byte).is_quoted);
        let cursor = CursorContext::at(&text, byte);
        assert_eq!(&text[cursor.word], "a", "what stands in the quotes");
        let (text, byte) = at("import \"a|");
        assert!(CursorContext::at(&text, byte).is_quoted);
        let (text, byte) = at("import \"a\"|");
        assert!(!CursorContext::at(&text, byte).is_quoted);
        let (text, byte) = at("x // a|");
        assert!(CursorContext::at(&text, byte).is_quoted);
    }
}
