//! Evidence from the edges around: what modes beside this one ask, how this mode is entered, what like edges do.

use std::collections::BTreeSet;

use super::names::share_stem;
use super::{Candidate, Evidence, Take, yes};
use crate::lsp::features::completion_order::reading::{Reading, Word, ends_statement, nearby};

/// An assignment on an edge.
pub(super) struct Update<'t> {
    /// The indices of the first word of the edge, and of its brace.
    pub head: usize,
    pub brace: usize,
    pub assigned: &'t str,
    /// The first word of the value.
    pub value: &'t str,
}

/// The assignments on edges of a reading.
pub(super) fn updates<'t>(reading: &Reading<'t>) -> Vec<Update<'t>> {
    let (mut found, mut start, mut edge) = (Vec::new(), 0, None);
    for (at, word) in reading.words.iter().enumerate() {
        match word.text {
            "{" => {
                edge = matches!(reading.word(start).text, "when" | "else").then_some((start, at));
                start = at + 1;
            }
            "}" => (edge, start) = (None, at + 1),
            ";" => start = at + 1,
            ":=" | "+=" | "-=" => {
                if let Some((head, brace)) = edge {
                    let (assigned, value) = (reading.word(start).text, reading.word(at + 1).text);
                    found.push(Update { head, brace, assigned, value });
                }
            }
            _ => {}
        }
    }
    found
}

impl<'t> Evidence<'t> {
    /// Where earlier edges led whose guards have names and keywords of this one.
    pub(super) fn led(&self) -> Vec<(&'t str, f32)> {
        let set = |words: &[Word<'t>]| -> BTreeSet<&'t str> {
            words.iter().map(|word| word.text).filter(|text| text.len() > 2).collect()
        };
        let all = &self.reading.words;
        let here = set(all.get(self.reading.start..all.len() - 1).unwrap_or_default());
        let shares = self.reading.edges.iter().filter_map(|edge| {
            let there = set(all.get(edge.guard.clone())?);
            let both = here.intersection(&there).count();
            (both > 1).then(|| (edge.to, both as f32 / here.union(&there).count() as f32))
        });
        shares.collect()
    }

    /// Whether the modes beside this one go on like that, and how this one is entered.
    pub(super) fn siblings(&self, item: &Candidate<'_>, is_name: bool, take: Take<'_>) {
        let reading = &self.reading;
        let kind = if is_name { "name" } else { item.class };
        let before = reading.before(1).text;
        let before = if ends_statement(before) { "^" } else { before };
        let is_pair = |at: usize| {
            let last = at.checked_sub(1).map_or("", |at| reading.word(at).text);
            last == before || before == "^" && ends_statement(last)
        };
        let at = reading.names.get(item.label).map_or(&[][..], |uses| &uses.at);
        if let Some(mode) = reading.enclosing("mode")
            && matches!(before, "^" | "when" | "and" | "or" | "not" | "=")
        {
            let here = at.iter().any(|at| *at >= mode.head && is_pair(*at));
            let group = reading.enclosing("group").map_or(0, |group| group.head);
            let heads = &self.mode_heads;
            let beside = heads.iter().filter(|head| (group..mode.head).contains(*head)).count();
            let mut with: Vec<usize> = Vec::new();
            for at in at.iter().filter(|at| (group..mode.head).contains(*at) && is_pair(**at)) {
                let head = heads.partition_point(|head| head <= at);
                if with.last() != Some(&head) {
                    with.push(head);
                }
            }
            if beside > 0 {
                let share = with.len() as f32 / beside as f32;
                take(&["beside", yes(here), before, kind], share);
                if share > 0.6 && beside > 1 {
                    take(&["beside most", yes(here), before], 1.0);
                }
            }
            // How the mode is entered tells how it is left.
            let entered = reading.edges.iter().filter(|edge| edge.to == mode.name && edge.from != mode.name);
            let (mut has, mut negated, mut any) = (false, false, false);
            for edge in entered {
                any = true;
                for at in edge.guard.clone().filter(|at| reading.word(*at).text == item.label) {
                    has = true;
                    negated |= at.checked_sub(1).is_some_and(|at| reading.word(at).text == "not");
                }
            }
            if any && matches!(before, "when" | "and" | "or" | "not") {
                let how = match (has, negated) {
                    (false, _) => "without",
                    (true, true) => "negated",
                    (true, false) => "with",
                };
                take(&["entered", how, before, item.class], 1.0);
                take(&["entered", how, before, yes(here), kind], 1.0);
            }
        }
    }

    /// How the guards of a mode follow each other.
    pub(super) fn guards(&self, item: &Candidate<'_>, take: Take<'_>) {
        let reading = &self.reading;
        let Some(open) = reading.open.last().filter(|_| reading.before(1).text == "when") else { return };
        let edges = open.statements.iter().filter(|at| **at < reading.start && reading.word(**at).text == "when");
        let last = edges.clone().next_back();
        let class = |at: Option<&usize>| at.map_or("^", |at| reading.word(at + 1).class);
        let sign = |at: Option<&usize>| match class(at) {
            "not" => at.map_or("", |at| reading.word(at + 2).class),
            class => class,
        };
        let earlier = edges.rev().nth(1);
        take(&["guard after", class(last), item.class], 1.0);
        take(&["guard after", class(earlier), sign(last), item.class], 1.0);
        if let Some(last) = last {
            let is_same = reading.word(last + 1).text == item.label;
            let negates = reading.word(last + 2).text == item.label;
            let end = open.statements.iter().find(|at| *at > last).copied().unwrap_or(reading.start);
            let guard = reading.words.get(*last..end).unwrap_or_default();
            let guard = nearby(guard.split(|word| matches!(word.text, "->" | "{")).next().unwrap_or_default());
            let has = guard.iter().any(|word| word.text == item.label);
            let joins = guard.iter().any(|word| word.text == "and");
            let stays = reading.edges.last().is_none_or(|edge| edge.guard.start != *last);
            take(&["guard has", yes(is_same), yes(has), yes(joins), item.class], 1.0);
            take(&["guard has", yes(is_same), yes(has), yes(joins), yes(stays)], 1.0);
            if negates {
                take(&["guard negates", item.class], 1.0);
            }
        }
    }

    /// What a variable is changed to, by what it begins as and what it was changed to before.
    pub(super) fn changes(&self, item: &Candidate<'_>, take: Take<'_>) {
        let reading = &self.reading;
        let name = reading.word(reading.start).text;
        let declared = reading.names.get(name).and_then(|uses| uses.declared);
        let Some(declared) = declared.filter(|_| reading.before(1).text == ":=") else { return };
        let after = reading.words.get(declared..).unwrap_or_default();
        let statement = after.iter().take_while(|word| word.text != ";");
        let initial = statement.skip_while(|word| word.text != "=").nth(1).map_or("", |word| word.text);
        let class = reading.class(name).unwrap_or_default();
        let last = self.updates.iter().rev().skip(1).find(|other| other.assigned == name).map(|other| other.value);
        let edge = reading.open.last().filter(|open| open.block == "when");
        let head = edge.and_then(|edge| reading.words.get(edge.head..edge.brace)).map_or(&[][..], nearby);
        let asked = head.iter().position(|word| word.text == name);
        let is_asked = match asked {
            None => "no",
            Some(at) if at > 0 && head.get(at - 1).is_some_and(|word| word.text == "not") => "not",
            Some(_) => "yes",
        };
        if matches!(item.class, "true" | "false" | "#value") {
            let value = if class == "#bool" { item.class } else { "" };
            let is_last = last.map_or("none", |last| yes(last == item.label));
            take(&["change", class, value, is_asked, yes(initial == item.label), is_last], 1.0);
            take(&["change", class, value, is_asked], 1.0);
            take(&["change to", class, yes(initial == item.label), is_last], 1.0);
            let compares = asked.and_then(|at| head.get(at + 2)).is_some_and(|word| word.text == item.label);
            take(&["change from", class, yes(compares)], 1.0);
        } else {
            let kind = if item.label == name { "itself" } else { item.class };
            let begins = if initial == "0" { "0" } else { "more" };
            take(&["change of", class, begins, kind], 1.0);
            take(&["change of", class, begins, is_asked, kind], 1.0);
            if let Some(last) = last {
                let how = if last == name { "itself" } else { last };
                let how = if matches!(how, "itself" | "min" | "max" | "if") { how } else { "other" };
                take(&["change again", class, how, kind], 1.0);
            }
        }
    }

    /// What edges with the same target or a like guard do.
    pub(super) fn updates(&self, item: &Candidate<'_>, is_name: bool, take: Take<'_>) {
        let reading = &self.reading;
        let before = reading.before(1).text;
        let before = if ends_statement(before) { "^" } else { before };
        if let Some(edge) = reading.open.last().filter(|open| open.block == "when")
            && matches!(before, "^" | ":=")
        {
            let head = reading.words.get(edge.head..edge.brace).unwrap_or_default();
            let target = head.iter().position(|word| word.text == "->").and_then(|at| head.get(at + 1));
            let first = |words: &[Word<'t>]| words.get(1).map_or("", |word| word.text);
            let assigned = reading.word(reading.start).text;
            let done = reading.names.get(item.label).is_some_and(|uses| {
                uses.at.iter().any(|at| *at > edge.brace && matches!(reading.word(at - 1).text, "{" | ";"))
            });
            let (mut same_target, mut same_guard) = (false, false);
            for other in &self.updates {
                let does = match before {
                    "^" => other.assigned == item.label,
                    _ => other.assigned == assigned && other.value == item.label,
                };
                let there = reading.words.get(other.head..other.brace).unwrap_or_default();
                if does && other.brace < edge.brace {
                    same_target |= target.is_some_and(|target| there.iter().any(|word| word.text == target.text));
                    same_guard |= first(there) == first(head);
                }
            }
            let kind = if is_name { "name" } else { "word" };
            let ours = self.updates.iter().filter(|other| other.head == edge.head);
            let last = ours.clone().next_back();
            if before == "^" {
                let previous = self.updates.iter().rfind(|other| other.brace < edge.brace);
                if let Some(previous) = previous.filter(|_| last.is_none()) {
                    take(&["update again", yes(previous.assigned == item.label), kind], 1.0);
                }
                // What was assigned next where the last one was.
                let follows = last.is_some_and(|last| {
                    self.updates.windows(2).any(|pair| {
                        pair[0].head == pair[1].head
                            && pair[0].assigned == last.assigned
                            && pair[1].assigned == item.label
                    })
                });
                take(&["update follows", yes(follows), kind], 1.0);
            }
            take(&["updates", before, yes(same_target), yes(same_guard), yes(done), kind], 1.0);
            if let Some(target) = target {
                take(&["target stem", before, yes(share_stem(item.label, target.text)), kind], 1.0);
            }
            take(&["has target", before, yes(target.is_some()), item.class], 1.0);
        }
    }
}
