//! Completion while an entity is typed from nothing: at which place in the list the wanted item is.
//!
//! A finished text is typed from its beginning to its end. At each word the text ends with the line of the cursor;
//! brackets that are open there are closed, as editors do. A position is counted after the first letter of a word, and
//! before it where the list is open already: after a character that opens it, that was typed, not put in by the editor
//! as indentation, and where the server gives a list that nobody asked for. What a list would have where it stays
//! closed is counted apart. A name that the text has nowhere before is new: no list can have it, so it is not counted.
//! Of the items, those that begin with what is typed are shown.

mod fit;
mod positions;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use hypedc::lsp::service::{Answer, Request, Service};

use super::client::Memory;
use positions::{entities, place, positions, typed_until};

const PATH: &str = "typed.hyped";

/// After these the server gives a list that nobody asked for only where one of the first items is likely.
const BETWEEN: [char; 4] = [' ', '(', ',', ':'];

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
    /// Of the positions after the first letter of a word: how many there are, and in how many the item is first, and
    /// among the first three.
    after_a_letter: [usize; 3],
    /// The same before the first letter, where the list stays closed. They are not among the positions.
    closed: [usize; 3],
    misses: Vec<Miss>,
}

impl Count {
    fn add(&mut self, other: Count) {
        self.positions += other.positions;
        self.first += other.first;
        self.among_three += other.among_three;
        self.new_names += other.new_names;
        self.after_a_letter.iter_mut().zip(other.after_a_letter).for_each(|(all, one)| *all += one);
        self.closed.iter_mut().zip(other.closed).for_each(|(all, one)| *all += one);
        self.misses.extend(other.misses);
    }
}

/// The words of the language.
fn language() -> BTreeSet<String> {
    let Answer::Keywords { keywords, functions } = Service::new(Arc::new(Memory::default())).answer(Request::Keywords)
    else {
        panic!("no words")
    };
    keywords.into_iter().chain(functions).collect()
}

/// Types a text.
fn typed(text: &str) -> Count {
    let mut service = Service::new(Arc::new(Memory::default()));
    let language = language();
    let (positions, new_names) = positions(text, &language);
    let mut count = Count { new_names, ..Count::default() };
    for position in &positions {
        let so_far = &text[..position.cursor()];
        service.answer(Request::Document { path: PATH.into(), text: typed_until(text, position.cursor()) });
        let at = so_far.encode_utf16().count();
        let (items, is_likely) = match service.answer(Request::Completion { path: PATH.into(), at }) {
            Answer::Completion { items, likely, .. } => (items, likely),
            _ => (Vec::new(), true),
        };
        let (place, first) = place(items.iter().map(|item| item.label.as_str()), position);
        let (is_first, is_among_three) = (place == Some(1), place.is_some_and(|place| place <= 3));
        let found = [1, usize::from(is_first), usize::from(is_among_three)];
        let is_after_a_letter = !position.typed.is_empty();
        if !is_after_a_letter && !is_likely && so_far.ends_with(BETWEEN) {
            count.closed.iter_mut().zip(found).for_each(|(all, one)| *all += one);
            continue;
        }
        count.positions += 1;
        count.first += usize::from(is_first);
        count.among_three += usize::from(is_among_three);
        if is_after_a_letter {
            count.after_a_letter.iter_mut().zip(found).for_each(|(all, one)| *all += one);
        }
        if place != Some(1) {
            count.misses.push(Miss {
                line: so_far.matches('\n').count() + 1,
                before: so_far.rsplit('\n').next().unwrap_or_default().into(),
                wanted: position.wanted.into(),
                place,
                first,
            });
        }
    }
    count
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
            for miss in &count.misses {
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
            all.add(count);
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

/// Entities that the weights were not fitted to; the limits are what they gave at once.
#[test]
fn typing_new_entities() {
    let mut all = Count::default();
    for path in crate::support::files("tests/lsp/sessions", "hyped") {
        let count = typed(&std::fs::read_to_string(&path).unwrap());
        assert!(count.positions >= 150, "{}", path.display());
        let Count { positions, first, among_three, new_names, after_a_letter, .. } = &count;
        println!(
            "{}: {positions} positions, {first}, {among_three}; after a letter {after_a_letter:?}; {new_names} new names",
            path.display()
        );
        all.add(count);
    }
    let percent = |part: usize, of: usize| part * 100 / of;
    let parts = |[all, first, among_three]: [usize; 3]| (percent(first, all), percent(among_three, all));
    let opened = parts([all.positions, all.first, all.among_three]);
    let (after_a_letter, closed) = (parts(all.after_a_letter), parts(all.closed));
    println!(
        "{} positions: first and in three {opened:?} %; {} after a letter: {after_a_letter:?} %; closed {} times, \
         where it would have been {closed:?} %",
        all.positions, all.after_a_letter[0], all.closed[0]
    );
    assert!(opened.0 >= 84 && opened.1 >= 96, "in percent: {opened:?}: {:#?}", all.misses);
    assert!(after_a_letter.0 >= 90 && after_a_letter.1 >= 97, "after a letter, in percent: {after_a_letter:?}");
    // A list that stays closed where it would have helped is a loss, too.
    let words = all.after_a_letter[0];
    assert!(all.closed[1] * 5 <= words, "closed where the wanted item is first: {} of {words}", all.closed[1]);
}
