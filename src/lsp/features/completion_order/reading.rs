//! The words before a cursor, as the order of completion items sees them: each with its class, the blocks around the
//! cursor, where names are declared and used, the modes and edges so far. Works in any text, complete or not.

use std::collections::BTreeMap;

use crate::diagnostic::words::SIGNATURES;
use crate::lsp::text::lexer::{Kind, tokens};
use crate::lsp::text::words::is_keyword;

/// The class of a name that nothing declares yet.
pub(super) const UNKNOWN: &str = "#name";

/// Names that open a call.
const CALLS: &[&str] = &["pressed", "held", "released", "touching", "entering", "exiting", "lost", "received"];

/// The number of last words of a statement or a guard that count, so that a line of any length is read in linear time.
pub(super) const NEARBY: usize = 64;

/// A word, number or symbol. Statements are separated by `;`; the braces of a set of values are `[` and `]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Word<'t> {
    pub text: &'t str,
    /// A keyword, function or symbol is its own class; names have a class by their declaration, such as `#param`.
    pub class: &'t str,
}

/// A block that is open at the cursor.
#[derive(Debug)]
pub(super) struct Open<'t> {
    /// `entity`, `group`, `mode`, `when` for the updates of an edge, `envelope` …
    pub block: &'t str,
    pub name: &'t str,
    /// The index of the first word of its head.
    pub head: usize,
    /// The index of its brace.
    pub brace: usize,
    /// The indices of the first words of its finished statements, and of the unfinished one.
    pub statements: Vec<usize>,
}

/// A mode that is declared before the cursor.
#[derive(Debug, PartialEq)]
pub(super) struct Mode<'t> {
    pub name: &'t str,
    pub group: &'t str,
}

/// An edge before the cursor.
#[derive(Debug)]
pub(super) struct Edge<'t> {
    pub from: &'t str,
    pub to: &'t str,
    /// The indices of the words of its guard.
    pub guard: std::ops::Range<usize>,
}

/// What is known of a name.
#[derive(Debug, Default)]
pub(super) struct Uses {
    /// The index of its declaration.
    pub declared: Option<usize>,
    /// How many names of its class are declared before it.
    pub place: usize,
    /// The indices of its other occurrences.
    pub at: Vec<usize>,
}

/// The words before a cursor.
#[derive(Debug, Default)]
pub(super) struct Reading<'t> {
    pub words: Vec<Word<'t>>,
    pub open: Vec<Open<'t>>,
    /// The index of the first word of the statement at the cursor; the number of words if it has none yet.
    pub start: usize,
    /// The calls that are open in the statement: the indices of their parentheses, and the numbers of commas since.
    pub calls: Vec<(usize, usize)>,
    pub names: BTreeMap<&'t str, Uses>,
    pub modes: Vec<Mode<'t>>,
    pub edges: Vec<Edge<'t>>,
    /// How many names of a class are declared.
    declared: BTreeMap<&'static str, usize>,
    /// The classes of the declared names.
    classes: BTreeMap<&'t str, &'static str>,
    /// The brackets that are open in the statement.
    brackets: Vec<&'t str>,
    /// Whether the statement at the end has a colon.
    has_colon: bool,
    /// The last predicate of buttons, signals or colliders in the statement at the end.
    call: &'t str,
}

/// The last of some words.
pub(super) fn nearby<'w, 't>(words: &'w [Word<'t>]) -> &'w [Word<'t>] {
    words.get(words.len().saturating_sub(NEARBY)..).unwrap_or_default()
}

pub(super) fn ends_statement(word: &str) -> bool {
    matches!(word, ";" | "{" | "}")
}

fn is_operator(word: &str) -> bool {
    matches!(word, "and" | "or" | "+" | "-" | "*" | "/" | "<" | "<=" | ">" | ">=" | "==" | "!=" | "->")
}

fn awaits_more(word: &str) -> bool {
    is_operator(word) || matches!(word, "not" | "," | "=" | ":=" | "+=" | "-=")
}

impl<'t> Reading<'t> {
    /// Reads a text up to a cursor; the word at the cursor is not part of it.
    pub fn of(text: &'t str) -> Self {
        let mut reading = Reading::default();
        let mut line_over = false;
        for token in tokens(text) {
            let word = token.text(text);
            match token.kind {
                Kind::Comment => continue,
                Kind::Newline => {
                    let last = reading.before(1).text;
                    line_over = reading.brackets.is_empty() && !last.is_empty() && !ends_statement(last);
                    line_over &= !awaits_more(last);
                    continue;
                }
                _ => {}
            }
            let separates = std::mem::take(&mut line_over) && !is_operator(word) && !matches!(word, "{" | "}");
            if (separates || word == ";") && !ends_statement(reading.before(1).text) {
                reading.words.push(Word { text: ";", class: ";" });
                reading.begin_statement();
            }
            if word != ";" {
                reading.push(word, token.kind);
            }
        }
        let line = text.rsplit('\n').next().unwrap_or_default();
        if line_over && line.trim().is_empty() {
            reading.words.push(Word { text: ";", class: ";" });
            reading.begin_statement();
        }
        reading.finish();
        reading
    }

    /// The word before the cursor, from 1, or a word without text.
    pub fn before(&self, count: usize) -> Word<'t> {
        self.words.len().checked_sub(count).map_or(Word { text: "", class: "" }, |at| self.word(at))
    }

    /// The word at an index.
    pub fn word(&self, at: usize) -> Word<'t> {
        self.words.get(at).copied().unwrap_or(Word { text: "", class: "" })
    }

    /// The words of the statement at the cursor.
    pub fn statement(&self) -> &[Word<'t>] {
        self.words.get(self.start..).unwrap_or_default()
    }

    /// The innermost open block of a kind.
    pub fn enclosing(&self, block: &str) -> Option<&Open<'t>> {
        self.open.iter().rev().find(|open| open.block == block)
    }

    /// The class of a name, if it is declared.
    pub fn class(&self, name: &str) -> Option<&'static str> {
        self.classes.get(name).copied()
    }

    fn push(&mut self, word: &'t str, kind: Kind) {
        let at = self.words.len();
        let first = self.word(self.start).text;
        // The braces of a set of values do not open a block.
        let text = match word {
            "{" if first == "discrete" => "[",
            "}" if self.brackets.last() == Some(&"[") => "]",
            _ => word,
        };
        if self.start == at
            && !ends_statement(text)
            && let Some(open) = self.open.last_mut()
        {
            open.statements.push(at);
        }
        let class = match kind {
            Kind::Number => "0",
            Kind::Text => "\"",
            Kind::Tile => "'.'",
            Kind::Word => self.class_of_word(text),
            _ => text,
        };
        match text {
            "(" | "[" => self.brackets.push(text),
            ")" | "]" => drop(self.brackets.pop()),
            "{" => {
                self.brackets.clear();
                let head = |at: usize| self.word(self.start + at).text;
                let block = match head(0) {
                    "initial" => "mode",
                    "else" | "follow" | "->" => "when",
                    other => other,
                };
                let name = if head(0) == "initial" { head(2) } else { head(1) };
                self.open.push(Open { block, name, head: self.start, brace: at, statements: Vec::new() });
            }
            "}" => {
                self.brackets.clear();
                self.open.pop();
            }
            _ => {}
        }
        self.words.push(Word { text, class });
        if matches!(text, "{" | "}") {
            self.begin_statement();
            return;
        }
        self.has_colon |= text == ":";
        if CALLS.contains(&text) {
            self.call = text;
        }
    }

    fn begin_statement(&mut self) {
        self.start = self.words.len();
        self.has_colon = false;
        self.call = "";
    }

    /// The class of a name or keyword; notes its declaration or its use.
    fn class_of_word(&mut self, text: &'t str) -> &'t str {
        let at = self.words.len();
        let (first, last) = (self.word(self.start).text, self.before(1).text);
        let begins = at == self.start + 1 && last == first;
        let in_list = begins || last == "," && self.brackets.is_empty();
        let declared = match first {
            _ if last == "as" => Some("#touched"),
            "param" | "const" if begins => Some("#param"),
            "button" if in_list => Some("#button"),
            "axis" if in_list => Some("#axis"),
            "signal" if in_list => Some("#signal"),
            "continuous" if begins => Some("#continuous"),
            "discrete" if begins => Some("#discrete"),
            "discrete" if self.brackets.last() == Some(&"[") => Some("#value"),
            "condition" if begins => Some("#condition"),
            "chance" if begins => Some("#chance"),
            "ref" if begins => Some("#ref"),
            "group" if begins => Some("#group"),
            "entity" | "behavior" | "world" if begins => Some("#entity"),
            "mode" | "initial" if last == "mode" => Some("#mode"),
            "collider" | "kinematic" if (last == "collider" || in_list) && !self.has_colon => Some("#tag"),
            _ => None,
        };
        if let Some(class) = declared {
            if class == "#mode" {
                let group = self.enclosing("group").map_or("", |open| open.name);
                self.modes.push(Mode { name: text, group });
            }
            // A tag may have the name of something else.
            if class != "#tag" || !self.classes.contains_key(text) {
                self.classes.insert(text, class);
            }
            let place = self.declared.entry(class).or_default();
            let uses = self.names.entry(text).or_default();
            if uses.declared.is_none() {
                (uses.declared, uses.place) = (Some(at), *place);
                *place += 1;
            }
            return class;
        }
        self.names.entry(text).or_default().at.push(at);
        if last == "->" {
            let from = self.enclosing("mode").map_or("", |open| open.name);
            self.edges.push(Edge { from, to: text, guard: self.start..at - 1 });
            return "#mode";
        }
        let is_function = || SIGNATURES.iter().any(|signature| signature.name == text);
        if matches!(text, "x" | "y") || is_keyword(text) || is_function() {
            return text;
        }
        if let Some(class) = self.classes.get(text) {
            return class;
        }
        if !self.brackets.is_empty() && self.call == "touching" {
            self.classes.insert(text, "#tag");
            return "#tag";
        }
        UNKNOWN
    }

    /// Tells discrete variables by their types, and finds the open calls.
    fn finish(&mut self) {
        for at in 0..self.words.len() {
            if self.word(at).text == "discrete" && self.word(at + 2).text == ":" {
                let class = match self.word(at + 3).text {
                    "bool" => "#bool",
                    "int" => "#int",
                    _ => "#set",
                };
                self.classes.insert(self.word(at + 1).text, class);
            }
        }
        for word in &mut self.words {
            if matches!(word.class, "#discrete" | "#int" | "#bool" | "#set") {
                word.class = self.classes.get(word.text).copied().unwrap_or(word.class);
            }
        }
        let mut calls: Vec<(usize, usize)> = Vec::new();
        for at in self.start..self.words.len() {
            match self.word(at).text {
                "(" => calls.push((at, 0)),
                ")" => drop(calls.pop()),
                "," => {
                    if let Some((_, commas)) = calls.last_mut() {
                        *commas += 1;
                    }
                }
                _ => {}
            }
        }
        self.calls = calls;
    }
}
