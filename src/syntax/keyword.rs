//! The keywords, derived from the text of the grammar: all keywords, and those that can start a rule. Rules named
//! `kw_…` are reserved words; `word_…` are keywords only in context.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use super::Rule;

/// The grammar of pest.
const GRAMMAR: &str = include_str!("../../grammar/hyped.pest");

/// A keyword.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Keyword {
    /// The word.
    pub word: &'static str,
    /// Whether it is never a name.
    pub is_reserved: bool,
}

/// The bodies of the grammar's rules by their names.
static BODIES: LazyLock<BTreeMap<&'static str, &'static str>> = LazyLock::new(|| {
    let starts = |line: &str| line.starts_with(|c: char| c.is_ascii_alphabetic()) && line.contains(" = ");
    let mut bodies = BTreeMap::new();
    let mut rest = GRAMMAR;
    while !rest.is_empty() {
        let line = rest.lines().next().unwrap_or_default();
        let after = rest.get(line.len()..).map_or("", |rest| rest.strip_prefix('\n').unwrap_or(rest));
        // A rule ends before the next unindented line, except its own closing brace.
        let more = after.split_inclusive('\n').take_while(|line| !line.starts_with(|c: char| c.is_ascii_alphabetic()));
        let more: usize = more.map(str::len).sum();
        if starts(line) {
            let body = rest.get(..rest.len() - after.len() + more).unwrap_or(line);
            if let Some((name, body)) = body.split_once('=') {
                bodies.insert(name.trim(), body);
            }
        }
        rest = after.get(more..).unwrap_or_default();
    }
    bodies
});

static KEYWORDS: LazyLock<Vec<Keyword>> = LazyLock::new(|| {
    let lines = GRAMMAR.lines().filter(|line| line.starts_with("kw_") || line.starts_with("word_"));
    let keyword =
        |line: &'static str| Some(Keyword { word: line.split('"').nth(1)?, is_reserved: line.starts_with("kw_") });
    lines.filter_map(keyword).collect()
});

/// The keywords that can start each of the requested rules.
static OPENING: LazyLock<BTreeMap<&'static str, Vec<&'static str>>> = LazyLock::new(|| {
    let mut opening = BTreeMap::new();
    for name in BODIES.keys() {
        let mut words = Vec::new();
        FirstWords { rest: BODIES.get(name).copied().unwrap_or_default(), depth: 0 }.read(&mut words);
        opening.insert(*name, words);
    }
    opening
});

/// All keywords, in the order of the grammar.
pub fn keywords() -> &'static [Keyword] {
    &KEYWORDS
}

/// The keyword of a rule.
pub(super) fn keyword(rule: Rule) -> Option<&'static str> {
    let name = format!("{rule:?}");
    let word = name.strip_prefix("kw_").or_else(|| name.strip_prefix("word_"))?;
    keywords().iter().map(|keyword| keyword.word).find(|known| *known == word)
}

/// The keywords that can start a rule, in the order of the grammar.
pub fn opening_keywords(rule: &str) -> &'static [&'static str] {
    OPENING.get(rule).map_or(&[], Vec::as_slice)
}

/// Computes the keywords that can come first in the body of a rule.
struct FirstWords {
    rest: &'static str,
    depth: usize,
}

impl FirstWords {
    /// Reads alternatives up to the end or the closing bracket; returns whether one of them can be empty.
    fn read(&mut self, words: &mut Vec<&'static str>) -> bool {
        let (mut can_be_empty, mut is_first) = (false, true);
        while let Some(token) = self.token() {
            let is_empty = match token {
                ")" | "}" => break,
                "|" => {
                    can_be_empty |= is_first;
                    is_first = true;
                    continue;
                }
                "(" | "{" | "_{" | "@{" | "${" => {
                    let mut inner = Vec::new();
                    let is_empty = self.read(&mut inner);
                    if is_first {
                        words.extend(inner.into_iter().filter(|word| !words.contains(word)).collect::<Vec<_>>());
                    }
                    is_empty
                }
                "~" => continue,
                "!" | "&" => {
                    self.token();
                    true
                }
                name => {
                    if is_first {
                        self.rule(name, words);
                    }
                    false
                }
            };
            let is_optional = self.rest.starts_with(['?', '*']);
            if is_optional || self.rest.starts_with('+') {
                self.rest = self.rest.get(1..).unwrap_or_default();
            }
            is_first &= is_empty || is_optional;
        }
        can_be_empty || is_first
    }

    /// The keywords that can start a rule. Expressions are not followed: a name can start them.
    fn rule(&self, name: &'static str, words: &mut Vec<&'static str>) {
        /// Maximum depth: beyond it, the grammar is recursive.
        const MAX_DEPTH: usize = 8;
        let word = name.strip_prefix("kw_").or_else(|| name.strip_prefix("word_"));
        if let Some(word) = word {
            if !words.contains(&word) {
                words.push(word);
            }
        } else if let Some(body) = BODIES.get(name).filter(|_| self.depth < MAX_DEPTH && name != "expression") {
            FirstWords { rest: body, depth: self.depth + 1 }.read(words);
        }
    }

    fn token(&mut self) -> Option<&'static str> {
        self.rest = self.rest.trim_start();
        while self.rest.starts_with("//") {
            self.rest = self.rest.split_once('\n').map_or("", |(_, rest)| rest).trim_start();
        }
        let is_name = |c: char| c.is_alphanumeric() || c == '_';
        let first = self.rest.chars().next()?;
        let length = match first {
            '_' | '@' | '$' if self.rest.get(1..2) == Some("{") => 2,
            '"' | '\'' => {
                let mut is_escaped = false;
                let ends = |c: char| {
                    let ends = c == first && !is_escaped;
                    is_escaped = c == '\\' && !is_escaped;
                    ends
                };
                self.rest.get(1..)?.find(ends)? + 2
            }
            c if is_name(c) => self.rest.find(|c: char| !is_name(c)).unwrap_or(self.rest.len()),
            c => c.len_utf8(),
        };
        let (token, rest) = self.rest.split_at_checked(length)?;
        self.rest = rest;
        Some(token)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::word::is_reserved;

    #[test]
    fn keywords_are_those_of_the_grammar() {
        for Keyword { word, is_reserved: reserved } in keywords() {
            assert_eq!(is_reserved(word), *reserved, "{word}");
        }
        assert!(keywords().len() > 60 && keywords().iter().any(|keyword| keyword.word == "touching"));
        assert_eq!(keyword(Rule::word_by), Some("by"));
        assert_eq!(keyword(Rule::name), None);
    }

    #[test]
    fn what_a_statement_can_begin_with_is_read_from_its_rule() {
        assert_eq!(opening_keywords("good_item"), ["import", "const", "entity", "behavior", "world"]);
        assert_eq!(opening_keywords("good_ramp"), ["attack", "decay", "sustain", "release", "while"]);
        assert_eq!(opening_keywords("collider"), ["kinematic", "collider"]);
        assert_eq!(opening_keywords("mode"), ["initial", "mode"]);
        assert_eq!(opening_keywords("good_update"), ["spawn", "destroy", "send"]);
        assert_eq!(opening_keywords("good_space_item"), ["map", "place", "link", "rect", "bounds", "wrap"]);
        let world =
            ["step", "collide", "tiles", "space", "limit", "look", "player", "condition", "goal", "never", "test"];
        assert_eq!(opening_keywords("good_world_item"), world);
        assert!(opening_keywords("good_member").contains(&"follow"));
        assert_eq!(opening_keywords("name"), [""; 0]);
    }
}
