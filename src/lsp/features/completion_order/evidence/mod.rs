//! The evidence for each completion item: features of the item in its place. A feature is named by a few words; the
//! order of items is by the sums of their weights.

mod edges;
mod modes;
mod names;

use std::collections::{BTreeMap, BTreeSet};

use super::matches::Followers;
use super::reading::{Reading, UNKNOWN, nearby};
use edges::{Update, updates};
use names::role;

/// An item as the order sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate<'a> {
    /// Its first word, or a name.
    pub label: &'a str,
    /// A word of the language is its own class; a name has one that begins with `#`.
    pub class: &'a str,
    /// The dimension of a name, if it is known.
    pub dimension: Option<&'a str>,
}

/// Takes a feature: the words that name it, and its value.
pub(super) type Take<'f> = &'f mut dyn FnMut(&[&str], f32);

/// What is known at a cursor.
pub(super) struct Evidence<'t> {
    pub reading: Reading<'t>,
    /// The dimension of what is written at the cursor, if it is known.
    wanted: Option<String>,
    by_text: Followers<'t>,
    by_class: Followers<'t>,
    /// The number of names of the same class that were used after a name was.
    newer: BTreeMap<&'t str, usize>,
    /// Of each class, the first declared name that is not used yet.
    first_unused: BTreeMap<&'t str, &'t str>,
    /// Where earlier edges led whose guards share words with this one, and how much they share.
    led: Vec<(&'t str, f32)>,
    /// The targets of edges that are not declared yet, in order.
    awaited: Vec<&'t str>,
    /// The number of declared names of each class.
    counts: BTreeMap<&'t str, usize>,
    /// The indices of the first words of modes.
    mode_heads: Vec<usize>,
    /// The assignments on edges.
    updates: Vec<Update<'t>>,
    /// What is written at the cursor.
    role: &'static str,
}

const DIGITS: [&str; 17] = ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "14", "15", "16"];

/// A small number in the name of a feature.
fn digit(number: usize, most: usize) -> &'static str {
    DIGITS.get(number.min(most)).copied().unwrap_or_default()
}

/// A length in the name of a feature: longer ones are told apart less.
fn length(number: usize) -> &'static str {
    match number {
        0..=4 => digit(number, 4),
        5..=6 => "5",
        7..=9 => "7",
        10..=13 => "10",
        _ => "14",
    }
}

fn yes(is_so: bool) -> &'static str {
    if is_so { "yes" } else { "no" }
}

fn logarithm(count: usize) -> f32 {
    libm::logf(count as f32 + 1.0)
}

impl<'t> Evidence<'t> {
    pub fn new(text: &'t str, wanted: Option<String>) -> Self {
        let reading = Reading::of(text);
        let by_text = Followers::of(&reading, |word| word.text);
        let by_class = Followers::of(&reading, |word| word.class);
        let mut used: Vec<(&str, &'t str, usize)> = Vec::new();
        let mut first_unused: BTreeMap<&'t str, (usize, &'t str)> = BTreeMap::new();
        for (name, uses) in &reading.names {
            let Some(class) = reading.class(name) else { continue };
            match (uses.at.last(), uses.declared) {
                (Some(last), _) => used.push((class, name, *last)),
                (None, Some(declared)) => {
                    let first = first_unused.entry(class).or_insert((declared, name));
                    *first = (*first).min((declared, name));
                }
                (None, None) => {}
            }
        }
        used.sort_by_key(|(class, _, last)| (*class, std::cmp::Reverse(*last)));
        let mut newer = BTreeMap::new();
        let mut before = ("", 0);
        for (class, name, _) in used {
            before = (class, if before.0 == class { before.1 + 1 } else { 0 });
            newer.insert(name, before.1);
        }
        let mut awaited: Vec<&'t str> = Vec::new();
        let mut seen: BTreeSet<&'t str> = reading.modes.iter().map(|mode| mode.name).collect();
        for edge in &reading.edges {
            if seen.insert(edge.to) {
                awaited.push(edge.to);
            }
        }
        let first_unused = first_unused.into_iter().map(|(class, (_, name))| (class, name)).collect();
        let mut counts: BTreeMap<&'t str, usize> = BTreeMap::new();
        for (name, _) in reading.names.iter().filter(|(_, uses)| uses.declared.is_some()) {
            *counts.entry(reading.class(name).unwrap_or_default()).or_default() += 1;
        }
        let words = reading.words.iter().enumerate();
        let mode_heads = words.filter(|(_, word)| word.text == "mode").map(|(at, _)| at).collect();
        let updates = updates(&reading);
        let role = role(&reading);
        let mut evidence = Evidence {
            reading,
            wanted,
            by_text,
            by_class,
            newer,
            first_unused,
            led: Vec::new(),
            awaited,
            counts,
            mode_heads,
            updates,
            role,
        };
        if evidence.reading.before(1).text == "->" {
            evidence.led = evidence.led();
        }
        evidence
    }

    /// Tells the features of an item.
    pub fn features(&self, item: &Candidate<'_>, take: Take<'_>) {
        let reading = &self.reading;
        let is_name = item.class.starts_with('#') || matches!(item.class, "x" | "y");
        self.place(item, take);
        if reading.statement().is_empty() {
            self.statement(item, is_name, take);
        }
        self.matches(item, is_name, take);
        self.siblings(item, is_name, take);
        self.guards(item, take);
        self.changes(item, take);
        self.updates(item, is_name, take);
        if is_name {
            self.name(item, take);
            self.neighbours(item, take);
            match item.class {
                "#mode" => self.mode(item.label, take),
                "#tag" => {
                    let declared = reading.names.get(item.label).is_some_and(|uses| uses.declared.is_some());
                    let argument = reading.calls.last().map_or(9, |(_, commas)| *commas);
                    take(&["tag", yes(declared), digit(argument, 9)], 1.0);
                }
                _ => {}
            }
        } else if !reading.statement().is_empty() {
            let has = nearby(reading.statement()).iter().any(|word| word.text == item.label);
            take(&["word again", yes(has), item.class], 1.0);
            for kind in ["#button", "#axis", "#signal", "#condition", "#chance", "#ref", "#set", "#int", "#bool"] {
                let has = match (self.counts.get(kind), self.first_unused.contains_key(kind)) {
                    (None, _) => "none",
                    (Some(_), true) => "unused",
                    (Some(_), false) => "used",
                };
                take(&["entity has", kind, has, item.class], 1.0);
            }
            let groups = self.counts.get("#group").copied().unwrap_or(0);
            take(&["groups", digit(groups, 2), item.class], 1.0);
        }
    }

    /// What the grammar and habit expect here: the last words, the statement, the call.
    fn place(&self, item: &Candidate<'_>, take: Take<'_>) {
        let reading = &self.reading;
        let before = |count| reading.before(count).class;
        let block = reading.open.last().map_or("", |open| open.block);
        take(&["class", item.class], 1.0);
        take(&["after", before(1), item.class], 1.0);
        take(&["after", before(2), before(1), item.class], 1.0);
        if let Some(first) = reading.statement().first() {
            let first = if is_variable(first.class) { "=" } else { first.class };
            take(&["in", first, block, item.class], 1.0);
        }
    }

    /// How statements follow each other in a block.
    fn statement(&self, item: &Candidate<'_>, is_name: bool, take: Take<'_>) {
        let reading = &self.reading;
        let (block, statements) = reading.open.last().map_or(("", &[][..]), |open| (open.block, &open.statements[..]));
        // The first two words tell what a statement is: `y''`, `when pressed`.
        let last = statements.last().map_or(("^", ""), |at| {
            let (first, second) = (reading.word(*at).class, reading.word(at + 1).class);
            if is_variable(first) || first == "when" { (first, second) } else { (first, "") }
        });
        take(&["next", block, last.0, item.class], 1.0);
        take(&["next", block, last.0, last.1, item.class], 1.0);
        let here = statements.iter().any(|at| reading.word(*at).class == item.class);
        take(&["here", block, yes(here), item.class], 1.0);
        if !is_name {
            return;
        }
        let assigned = statements.iter().any(|at| reading.word(*at).text == item.label);
        take(&["assigned", block, yes(assigned), yes(matches!(item.class, "x" | "y"))], 1.0);
        if let Some(edge) = reading.open.last().filter(|open| open.block == "when") {
            let head = nearby(reading.words.get(edge.head..edge.brace).unwrap_or_default());
            take(&["guard has", yes(head.iter().any(|word| word.text == item.label)), item.class], 1.0);
            take(&["edge leads", yes(head.iter().any(|word| word.text == "->")), item.class], 1.0);
        }
    }

    /// What followed the same words before, and words of the same classes.
    fn matches(&self, item: &Candidate<'_>, is_name: bool, take: Take<'_>) {
        let kind = if is_name { "name" } else { "word" };
        let sets = [("text", &self.by_text, item.label), ("class", &self.by_class, item.class)];
        for (set, followers, what) in sets {
            match followers.longest.get(what) {
                Some(longest) if *longest == followers.best => take(&[set, "best", length(*longest), kind], 1.0),
                Some(longest) => take(&[set, "other", length(*longest), kind], 1.0),
                None => take(&[set, "none", length(followers.best.min(6)), kind], 1.0),
            }
            for (order, (total, by_word)) in followers.counts.iter().enumerate().filter(|(_, (total, _))| *total > 0) {
                let count = by_word.get(what).copied().unwrap_or(0);
                take(&[set, "share", digit(order, 4), kind], count as f32 / (*total as f32 + 0.5));
                if set == "text" {
                    take(&[set, "count", digit(order, 4), kind], logarithm(count));
                    if followers.latest.get(order) == Some(&what) {
                        take(&["latest", digit(order, 4), kind], 1.0);
                    }
                }
            }
        }
    }
}

/// Whether a class is one of names that a statement assigns.
fn is_variable(class: &str) -> bool {
    class.starts_with('#') || matches!(class, "x" | "y") || class == UNKNOWN
}
