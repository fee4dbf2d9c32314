//! The positions at which a list of completions is looked at while a text is typed from its beginning to its end.

use std::collections::BTreeSet;

/// Words that are names in the grammar, and words of the language to people.
const OTHER_WORDS: &[&str] = &["left", "right", "above", "below", "rect", "circle", "empty", "x", "y"];

/// Words before a name that is declared there.
const DECLARING: &[&str] = &[
    "entity",
    "mode",
    "group",
    "param",
    "button",
    "axis",
    "discrete",
    "continuous",
    "condition",
    "signal",
    "chance",
    "as",
];

/// The words of a text, with where they begin: without those in comments and quotes.
fn words(text: &str) -> Vec<(usize, &str)> {
    let (mut out, mut at) = (Vec::new(), 0);
    while at < text.len() {
        let rest = &text[at..];
        let length = |stop: fn(char) -> bool| rest.find(stop).unwrap_or(rest.len());
        let first = rest.chars().next().unwrap();
        at += match first {
            '/' if rest.starts_with("//") => length(|c| c == '\n'),
            '"' => rest[1..].find('"').map_or(rest.len(), |end| end + 2),
            '\'' if rest[1..].chars().nth(1) == Some('\'') => 3,
            c if c.is_ascii_digit() => length(|c| !(c.is_alphanumeric() || c == '_')),
            c if c.is_alphabetic() || c == '_' => {
                let end = length(|c| !(c.is_alphanumeric() || c == '_'));
                out.push((at, &rest[..end]));
                end
            }
            c => c.len_utf8(),
        };
    }
    out
}

/// What closes the brackets that are open at the end of a text.
fn closing(text: &str) -> String {
    let mut open = Vec::new();
    let line = text.rfind('\n').map_or(0, |at| at + 1);
    let mut at = 0;
    while at < text.len() {
        let rest = &text[at..];
        at += match rest.as_bytes()[0] {
            b'/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            b'"' => rest[1..].find('"').map_or(rest.len(), |end| end + 2),
            b'{' | b'(' => {
                open.push(at);
                1
            }
            b'}' | b')' => {
                open.pop();
                1
            }
            _ => 1,
        };
    }
    let close = |at: &usize| {
        if text.as_bytes()[*at] == b'(' {
            return ")".to_string();
        }
        if *at >= line {
            return " }".to_string();
        }
        let start = text[..*at].rfind('\n').map_or(0, |at| at + 1);
        let indent = text[start..].len() - text[start..].trim_start_matches(' ').len();
        format!("\n{}}}", " ".repeat(indent))
    };
    open.iter().rev().map(close).collect()
}

/// A place where an item is wanted.
#[derive(Debug)]
pub struct Position<'t> {
    /// The offset of the word.
    pub at: usize,
    /// The word.
    pub wanted: &'t str,
    /// What of it is typed.
    pub typed: &'t str,
}

impl Position<'_> {
    /// The offset of the cursor.
    pub fn cursor(&self) -> usize {
        self.at + self.typed.len()
    }
}

/// Whether a line goes on with a name: `button jump, attack`, `collider body, player`, `touching(body, player`.
fn is_in_names(line: &str) -> bool {
    let first = line.split_whitespace().next().unwrap_or_default();
    let is_list = matches!(first, "button" | "axis" | "signal" | "collider" | "kinematic") && !line.contains(':');
    let touching = line.rfind("touching(").map_or("", |at| &line[at..]);
    let is_tag = !touching.is_empty() && !touching.contains(')') && touching.matches(',').count() < 2;
    (is_list || is_tag) && line.trim_end().ends_with([',', '('])
}

/// The positions of a text, given the words of the language; and the number of names that are new in their place.
pub fn positions<'t>(text: &'t str, language: &BTreeSet<String>) -> (Vec<Position<'t>>, usize) {
    let mut known: BTreeSet<&str> = BTreeSet::new();
    let (mut out, mut new_names) = (Vec::new(), 0);
    let mut last = "";
    for (at, wanted) in words(text) {
        // `mode left`, `-> left`, `as g`: a word of the language can be a name.
        let so_far = text[..at].rsplit('\n').next().unwrap_or_default();
        let in_set = so_far.trim_start().starts_with("discrete") && so_far.contains('{') && !so_far.contains('}');
        let is_named =
            DECLARING.contains(&last) || text[..at].trim_end().ends_with("->") || in_set || is_in_names(so_far);
        last = wanted;
        let is_new =
            (!language.contains(wanted) && !OTHER_WORDS.contains(&wanted) || is_named) && !known.contains(wanted);
        known.insert(wanted);
        if is_new {
            new_names += 1;
            continue;
        }
        let line = text[..at].rfind('\n').map_or(0, |at| at + 1);
        let before = &text[line..at];
        let is_open = !before.trim().is_empty() && before.ends_with(['.', '>', '(', ',', ':', ' ', '"', '/']);
        for letters in if is_open { 0..=1 } else { 1..=1 } {
            let first = wanted.chars().next().map_or(0, char::len_utf8) * letters;
            out.push(Position { at, wanted, typed: &wanted[..first] });
        }
    }
    (out, new_names)
}

/// The text as it is when the cursor is at an offset: its line ends there, open brackets are closed.
pub fn typed_until(text: &str, cursor: usize) -> String {
    let so_far = &text[..cursor];
    format!("{so_far}{}\n", closing(so_far))
}

/// Whether an item is what is wanted at a position.
pub fn is_wanted(label: &str, position: &Position<'_>) -> bool {
    label == position.wanted || label.split([' ', '.']).next() == Some(position.wanted)
}

/// The place of the wanted item among those that begin with what is typed, from 1; and the first labels.
pub fn place<'i>(labels: impl Iterator<Item = &'i str>, position: &Position<'_>) -> (Option<usize>, Vec<String>) {
    let lower = position.typed.to_lowercase();
    let shown: Vec<&str> = labels.filter(|label| label.to_lowercase().starts_with(&lower)).collect();
    let place = shown.iter().position(|label| is_wanted(label, position)).map(|at| at + 1);
    (place, shown.iter().take(4).map(|label| (*label).to_string()).collect())
}

/// The entities of a text, each alone.
pub fn entities(text: &str) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let mut inside = false;
    for line in text.lines() {
        if line.starts_with("entity ") {
            inside = true;
            out.push(String::new());
        }
        if inside && let Some(last) = out.last_mut() {
            last.push_str(&format!("{line}\n"));
        }
        inside &= line != "}";
    }
    out
}
