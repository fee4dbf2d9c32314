//! Evidence for names: how they were used, whether their dimension fits, what around the cursor is named alike.

use super::{Candidate, Evidence, Take, digit, is_variable, logarithm, yes};
use crate::lsp::features::completion_order::dimension::hint;
use crate::lsp::features::completion_order::reading::{NEARBY, Reading, Word, ends_statement, nearby};

/// What is written after the last words.
pub(super) fn role(reading: &Reading<'_>) -> &'static str {
    match reading.before(1).text {
        _ if reading.statement().is_empty() => "start",
        "when" | "and" | "or" | "not" | "while" | "invariant" => "asked",
        "=" if reading.word(reading.start).text == "condition" => "asked",
        "->" => "target",
        "mode" => "declared",
        "<" | "<=" | ">" | ">=" | "==" | "!=" | ".." => "compared",
        "in" if reading.word(reading.start).text == "clamp" => "compared",
        "=" | ":=" | "+=" | "-=" | "accel" | "sustain" | "to" => "value",
        "*" | "/" => "factor",
        "+" | "-" => "term",
        "(" | "," => "argument",
        _ => "",
    }
}

impl Evidence<'_> {
    /// How a name was used, and whether its dimension fits.
    pub(super) fn name(&self, item: &Candidate<'_>, take: Take<'_>) {
        let (reading, class, role) = (&self.reading, item.class, self.role);
        let end = reading.words.len();
        let uses = reading.names.get(item.label);
        let at = uses.map_or(&[][..], |uses| &uses.at);
        let declared = uses.and_then(|uses| uses.declared);
        match at.last() {
            None => {
                take(&["unused", class], 1.0);
                take(&["unused", class, role], 1.0);
                let known = reading.class(item.label).unwrap_or_default();
                if self.first_unused.get(known) == Some(&item.label) {
                    take(&["unused first", class], 1.0);
                    take(&["unused first", class, role], 1.0);
                }
                if declared.is_some_and(|at| end - at < 12) {
                    take(&["unused fresh", class], 1.0);
                }
            }
            Some(last) => {
                let distance = logarithm(end - last - 1);
                take(&["distance", class], distance);
                take(&["distance", class, role], distance);
                take(&["distance"], distance);
                take(&["times", class], logarithm(at.len() - 1));
                take(&["times", class, role], logarithm(at.len() - 1));
                let newer = self.newer.get(item.label).copied().unwrap_or(0);
                take(&["recent", digit(newer, 4), class], 1.0);
                take(&["recent", digit(newer, 4), class, role], 1.0);
            }
        }
        let place = uses.map_or(0, |uses| uses.place);
        take(&["declared late", class], logarithm(place));
        take(&["declared late", class, role], logarithm(place));
        let wanted = self.wanted.as_deref();
        let fits = match (wanted, item.dimension, hint(item.label)) {
            (None, None, _) => "none",
            (None, Some(_), _) => "free",
            (Some(wanted), Some(known), _) if wanted == known => "fits",
            (Some(_), Some(_), _) => "conflicts",
            (Some(_), None, None) => "unknown",
            (Some(wanted), None, Some(hint)) if wanted == hint => "hint fits",
            (Some(_), None, Some(_)) => "hint conflicts",
        };
        take(&["dimension", fits, if class == "#param" { "fixed" } else { "varies" }], 1.0);
        take(&["dimension", fits, class, role], 1.0);
        if let Some(first) = reading.statement().first() {
            let latest = reading.words.len() - reading.start;
            if latest < 4 && self.by_text.latest.get(latest - 1) == Some(&item.label) {
                take(&["latest value", first.class, digit(latest, 4)], 1.0);
            }
        }
        if let Some(wanted) = wanted {
            take(&["wanted", wanted, class], 1.0);
        }
    }

    /// Where around the cursor a name occurs, or one that shares a part with it.
    pub(super) fn neighbours(&self, item: &Candidate<'_>, take: Take<'_>) {
        let (reading, class) = (&self.reading, item.class);
        let at = reading.names.get(item.label).map_or(&[][..], |uses| &uses.at);
        let innermost = reading.open.last();
        let block = innermost.map_or("", |open| open.block);
        let is_same = |word: &Word<'_>| word.text == item.label;
        let shares = |words: &[Word<'_>]| words.iter().any(|word| !is_same(word) && share_stem(item.label, word.text));
        let statement = nearby(reading.statement());
        if let Some(first) = reading.statement().first() {
            take(&["statement has", yes(statement.iter().any(is_same)), class], 1.0);
            if is_same(first) && statement.iter().any(|word| matches!(word.text, "=" | ":=")) {
                take(&["assigned itself", reading.before(1).class], 1.0);
            }
            let head = |at: usize| (reading.word(at).text, reading.word(at + 1).text);
            let similar = at.iter().rev().take(6).any(|at| {
                let mut earlier = (at.saturating_sub(NEARBY)..*at).rev();
                let start = earlier.find(|at| ends_statement(reading.word(*at).text)).map_or(0, |at| at + 1);
                head(start) == head(reading.start)
            });
            take(&["statement alike", yes(similar), class, yes(is_variable(first.class))], 1.0);
            if shares(statement) {
                take(&["stem in statement", class], 1.0);
            }
        }
        for outer in ["mode", "group"] {
            if let Some(open) = reading.enclosing(outer) {
                take(&["used in", outer, yes(at.last().is_some_and(|at| *at >= open.head)), class], 1.0);
                if (outer != "mode" || class != "#mode") && share_stem(item.label, open.name) {
                    take(&["stem in", outer, class], 1.0);
                }
            }
        }
        let head = innermost.and_then(|open| reading.words.get(open.head..reading.start)).map_or(&[][..], nearby);
        if block == "when" && !statement.is_empty() {
            take(&["edge has", yes(head.iter().any(is_same)), class], 1.0);
            if shares(head) {
                take(&["stem in edge", class], 1.0);
            }
        }
        if let Some(open) = innermost.filter(|open| open.block == "envelope") {
            if at.last().is_some_and(|at| *at > open.head) {
                take(&["envelope has"], 1.0);
            }
            if share_stem(item.label, reading.before(1).text) {
                take(&["stem in ramp"], 1.0);
            }
            let inside = nearby(reading.words.get(open.head..).unwrap_or_default());
            let is_param = |word: &&Word<'_>| word.class == "#param" && !is_same(word);
            if inside.iter().filter(is_param).any(|word| share_stem(item.label, word.text)) {
                take(&["stem in envelope"], 1.0);
            }
        }
    }
}

/// Whether two names share a part, endings aside: `jump_speed` and `jumping`.
pub(super) fn share_stem(one: &str, other: &str) -> bool {
    let parts = |name| str::split(name, '_').filter(|part| part.len() > 2);

    parts(one).any(|a| {
        parts(other).any(|b| {
            let shared = a.bytes().zip(b.bytes()).take_while(|(a, b)| a == b).count();
            let shorter = a.len().min(b.len());
            shared == shorter || shared >= 4 && shared + 3 >= shorter
        })
    })
}
