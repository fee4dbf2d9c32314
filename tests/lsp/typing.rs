//! Completion while an entity is typed from nothing: at which place in the list the wanted item is.
//!
//! A finished text is typed from its beginning to its end. At each word the text ends with the line of the cursor;
//! brackets that are open there are closed, as editors do. A position is counted after the first letter of a word, and
//! before it where the list is open already: after a character that opens it and that was typed, not put in by the
//! editor as indentation. A name that the text has nowhere before is new: no list can have it, so it is not counted.
//! Of the items, those that begin with what is typed are shown.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use hypedc::lsp::service::{Answer, Completion, Request, Service};

use super::client::Memory;

const PATH: &str = "typed.hyped";

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

/// A position at which the wanted item was not first.
#[derive(Debug)]
struct Miss {
    line: usize,
    before: String,
    wanted: String,
    /// Its place, from 1; none if it is not offered.
    place: Option<usize>,
    first: Vec<String>,
}

/// The places of the wanted items.
#[derive(Debug, Default)]
struct Count {
    positions: usize,
    first: usize,
    among_three: usize,
    new_names: usize,
    misses: Vec<Miss>,
}

fn place(items: &[Completion], typed: &str, wanted: &str) -> (Option<usize>, Vec<String>) {
    let lower = typed.to_lowercase();
    let shown: Vec<&Completion> = items.iter().filter(|i| i.label.to_lowercase().starts_with(&lower)).collect();
    let is_wanted = |item: &&&Completion| {
        let first = item.label.split([' ', '.']).next().unwrap_or_default();
        item.label == wanted || first == wanted
    };
    let place = shown.iter().position(|item| is_wanted(&item)).map(|at| at + 1);
    (place, shown.iter().take(4).map(|item| item.label.clone()).collect())
}

/// Types a text.
fn typed(text: &str) -> Count {
    let mut service = Service::new(Arc::new(Memory::default()));
    let Answer::Keywords { keywords, functions } = service.answer(Request::Keywords) else { panic!("no words") };
    let language: BTreeSet<&str> =
        keywords.iter().chain(&functions).map(String::as_str).chain(OTHER_WORDS.iter().copied()).collect();
    let mut known: BTreeSet<&str> = BTreeSet::new();
    let mut count = Count::default();
    let mut last = "";
    for (at, word) in words(text) {
        // `mode left`, `-> left`, `as g`: a word of the language can be a name.
        let so_far = text[..at].rsplit('\n').next().unwrap_or_default();
        let in_set = so_far.trim_start().starts_with("discrete") && so_far.contains('{') && !so_far.contains('}');
        let is_named = DECLARING.contains(&last) || text[..at].trim_end().ends_with("->") || in_set;
        last = word;
        let is_new = (!language.contains(word) || is_named) && !known.contains(word);
        known.insert(word);
        if is_new {
            count.new_names += 1;
            continue;
        }
        let line = text[..at].rfind('\n').map_or(0, |at| at + 1);
        let before = &text[line..at];
        let is_open = !before.trim().is_empty() && before.ends_with(['.', '>', '(', ',', ':', ' ', '"', '/']);
        for letters in if is_open { 0..=1 } else { 1..=1 } {
            let first = word.chars().next().map_or(0, char::len_utf8) * letters;
            let so_far = &text[..at + first];
            let now = format!("{so_far}{}\n", closing(so_far));
            service.answer(Request::Document { path: PATH.into(), text: now });
            let offset = so_far.encode_utf16().count();
            let items = match service.answer(Request::Completion { path: PATH.into(), at: offset }) {
                Answer::Completion { items, .. } => items,
                _ => Vec::new(),
            };
            let (place, shown) = place(&items, &word[..first], word);
            count.positions += 1;
            count.first += usize::from(place == Some(1));
            count.among_three += usize::from(place.is_some_and(|place| place <= 3));
            if place != Some(1) {
                count.misses.push(Miss {
                    line: text[..at].matches('\n').count() + 1,
                    before: format!("{before}{}", &word[..first]),
                    wanted: word.into(),
                    place,
                    first: shown,
                });
            }
        }
    }
    count
}

/// The entities of a text, each alone.
fn entities(text: &str) -> Vec<String> {
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

#[test]
#[ignore = "prints what is to be improved, over the examples"]
fn typing_the_examples() {
    let (mut all, mut by_pattern) = (Count::default(), BTreeMap::<String, usize>::new());
    for path in crate::support::files("examples", "hyped") {
        let text = std::fs::read_to_string(&path).unwrap();
        let constants: Vec<&str> = text.lines().filter(|line| line.starts_with("const ")).collect();
        for entity in entities(&text).iter().filter(|entity| (40..120).contains(&entity.lines().count())) {
            let count = typed(&format!("{}\n{entity}", constants.join("\n")));
            let name = entity.lines().next().unwrap();
            println!("{:60} {:4} {:4} {:4}", name, count.positions, count.first, count.among_three);
            all.positions += count.positions;
            all.first += count.first;
            all.among_three += count.among_three;
            for miss in count.misses {
                let last = miss.before.split_whitespace().next_back().unwrap_or_default().to_string();
                *by_pattern.entry(format!("{last} ⇒ {}", miss.wanted)).or_default() += 1;
                println!(
                    "    {}: {} ⇒ {} {:?} {:?}",
                    miss.line,
                    miss.before.trim(),
                    miss.wanted,
                    miss.place,
                    miss.first
                );
            }
        }
    }
    let percent = |part: usize| part as f64 * 100.0 / all.positions as f64;
    println!(
        "{} positions: first {:.1} %, in three {:.1} %",
        all.positions,
        percent(all.first),
        percent(all.among_three)
    );
    let mut patterns: Vec<_> = by_pattern.into_iter().collect();
    patterns.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    patterns.iter().take(60).for_each(|(pattern, count)| println!("{count:4} {pattern}"));
}

/// Entities that were written after the order of items was settled; the limits are what they gave at once.
#[test]
fn typing_new_entities() {
    let mut all = Count::default();
    for path in crate::support::files("tests/lsp/sessions", "hyped") {
        let count = typed(&std::fs::read_to_string(&path).unwrap());
        assert!(count.positions >= 150, "{}", path.display());
        all.positions += count.positions;
        all.first += count.first;
        all.among_three += count.among_three;
        all.misses.extend(count.misses);
    }
    let percent = |part: usize| part * 100 / all.positions;
    let (first, among_three) = (percent(all.first), percent(all.among_three));
    assert!(first >= 71 && among_three >= 86, "first {first} %, in three {among_three} %: {:#?}", all.misses);
}
