//! Names: arbitrary texts in the file become names of the language, unique for each kind of declaration.

use std::collections::{BTreeMap, BTreeSet};

use pest::unicode::{XID_CONTINUE, XID_START};

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::import::Renamed;
use crate::source::Span;
use crate::syntax::{MAX_WORD, is_name, is_reserved};

/// The name most similar to a text.
fn near(text: &str) -> String {
    let mut name: String = text.chars().map(|c| if XID_CONTINUE(c) { c } else { '_' }).collect();
    if !name.starts_with(|c| XID_START(c) || c == '_') {
        name.insert(0, '_');
    }
    while name.len() > MAX_WORD / 2 {
        name.pop();
    }
    if is_reserved(&name) {
        name.push('_');
    }
    name
}

/// The used names of one kind, each once.
#[derive(Default)]
pub(super) struct Names {
    taken: BTreeSet<String>,
    /// The last number that was appended to each name.
    numbers: BTreeMap<String, usize>,
}

impl Names {
    /// A set of names that reserves some.
    pub fn without(taken: &[&str]) -> Self {
        Names { taken: taken.iter().map(|name| (*name).to_string()).collect(), numbers: BTreeMap::new() }
    }

    /// The name for a declaration called `text` in the file; reports it if it differs.
    pub fn give(&mut self, kind: &'static str, text: &str, at: Span, diagnostics: &mut Diagnostics) -> String {
        let name = self.unused(near(text));
        if name != text {
            let why = if is_name(text) {
                "the name is taken"
            } else if is_reserved(text) {
                "a word of the language"
            } else {
                "not a name in the language"
            };
            diagnostics.report(Renamed { kind, from: text.to_string(), to: name.clone(), why, at });
        }
        name
    }

    /// A name, with a number if it is taken; marks it as taken.
    fn unused(&mut self, name: String) -> String {
        if self.taken.insert(name.clone()) {
            return name;
        }
        let number = self.numbers.entry(name.clone()).or_insert(1);
        loop {
            *number += 1;
            let numbered = format!("{name}{number}");
            if self.taken.insert(numbered.clone()) {
                return numbered;
            }
        }
    }
}

/// The name of an entity: capitalised words, `plat_h` as `PlatH`.
pub(super) fn entity(text: &str, at: Span, taken: &mut Names, diagnostics: &mut Diagnostics) -> String {
    let words = text.split(|c: char| c == '_' || !XID_CONTINUE(c)).filter(|word| !word.is_empty());
    let capital = |word: &str| {
        let mut rest = word.chars();
        rest.next().into_iter().flat_map(char::to_uppercase).chain(rest).collect::<String>()
    };
    let name = near(&words.map(capital).collect::<String>());
    let given = taken.unused(name.clone());
    if given != name || !is_name(text) && !is_reserved(text) {
        let why = if given == name { "not a name in the language" } else { "the name is taken" };
        diagnostics.report(Renamed { kind: "entity", from: text.to_string(), to: given.clone(), why, at });
    }
    given
}

/// A tag as source text: in quotes if it is no name; none if it cannot be written.
pub(super) fn tag(text: &str) -> Option<String> {
    if is_name(text) {
        return Some(text.to_string());
    }
    let writable = !text.is_empty() && text.len() <= MAX_WORD && !text.contains(['"', '\n', '\r']);
    writable.then(|| format!("\"{text}\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_made_of_any_text() {
        for (text, name) in
            [("walk", "walk"), ("mode", "mode_"), ("a-b c", "a_b_c"), ("2d", "_2d"), ("", "_"), ("größe", "größe")]
        {
            assert_eq!(near(text), name);
            assert!(is_name(&near(text)), "{text}");
        }
        assert!(is_name(&near(&"ä".repeat(1_000))));
    }

    #[test]
    fn tags_that_are_no_names_stand_in_quotes() {
        assert_eq!(tag("wall").as_deref(), Some("wall"));
        assert_eq!(tag("question block").as_deref(), Some("\"question block\""));
        assert_eq!(tag("mode").as_deref(), Some("\"mode\""));
        assert_eq!(["", "a\"b", "a\nb"].map(tag), [const { None }; 3]);
    }
}
