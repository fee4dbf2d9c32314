//! The sentences that text and Markdown share: what changed, answers and ways.

use crate::diff::{
    Answered, Change, ChangeKind, Class, Comparison, Difference, Ended, LevelChange, OldWay, Origin, RunEnd,
};
use crate::reach::Conclusion;
use crate::reach::query::Kind;

use crate::cli::reach::counted;

use super::result::DiffResult;

/// Maximum number of characters of what a part says.
const MAX_SAID: usize = 70;

/// A text that is cut to a line.
fn cut(text: &str) -> String {
    if text.chars().count() <= MAX_SAID {
        return text.to_string();
    }
    let cut: String = text.chars().take(MAX_SAID - 1).collect();
    format!("{}…", cut.trim_end())
}

/// A number with at most one digit after the point.
pub(super) fn px(number: f64) -> String {
    let text = format!("{number:.1}");
    let text = text.strip_suffix(".0").unwrap_or(&text);
    if text == "-0" { "0".to_string() } else { text.to_string() }
}

/// What a part says now and before.
pub(super) fn change_words(change: &Change) -> String {
    format!("{} ({})", what_changed(change), change.place)
}

fn what_changed(change: &Change) -> String {
    let name = if change.name.is_empty() { String::new() } else { format!(" {}", change.name) };
    let head = format!("{}{name}", change.what);
    let said = |text: &Option<String>| text.as_deref().map(|text| format!(": {}", cut(text))).unwrap_or_default();
    match change.change {
        ChangeKind::Changed => {
            let [old, new] = [&change.old, &change.new].map(|text| cut(text.as_deref().unwrap_or_default()));
            let nothing = |text: String| if text.is_empty() { "(nothing)".to_string() } else { text };
            format!("{head}: {} → {}", nothing(old), nothing(new))
        }
        ChangeKind::Added => format!("{head} is new{}", said(&change.new)),
        ChangeKind::Removed => format!("{head} is gone{}", said(&change.old)),
        ChangeKind::Renamed => format!("{head} is now called {}", change.new.as_deref().unwrap_or_default()),
        ChangeKind::Reordered => format!("the edges of {} are tried in another order", change.name),
    }
}

/// What differs in a map.
pub(super) fn map_words(change: &LevelChange) -> String {
    let mut parts = Vec::new();
    if let Some([[columns, rows], [new_columns, new_rows]]) = change.sizes {
        parts.push(format!("{columns} x {rows} → {new_columns} x {new_rows} tiles"));
    }
    if let (Some([column, row]), Some([old, new])) = (change.first, change.symbols) {
        let first = if change.tiles == 1 { "at" } else { "the first at" };
        let differ = if change.tiles == 1 { "differs" } else { "differ" };
        let tiles = counted(change.tiles as u64, "tile");
        parts.push(format!("{tiles} {differ}, {first} column {column}, row {row}: '{old}' → '{new}'"));
    }
    if change.instances_gone > 0 {
        parts.push(format!("{} gone", counted(change.instances_gone as u64, "instance")));
    }
    if change.instances_new > 0 {
        parts.push(format!("{} new", counted(change.instances_new as u64, "instance")));
    }
    format!("map of {}.{}: {}", change.world, change.space, parts.join("; "))
}

/// A class as a word.
pub(super) fn class_word(class: Class) -> &'static str {
    match class {
        Class::Worse => "worse",
        Class::Lost => "lost",
        Class::Other => "other",
        Class::Way => "another way",
        Class::Found => "found",
        Class::Better => "better",
        Class::Same => "same",
    }
}

fn verdict(kind: Kind, conclusion: Conclusion) -> &'static str {
    match (kind, conclusion) {
        (Kind::Never, Conclusion::ProvenUnreachable) => "proven",
        (_, Conclusion::Exhausted) => "no way with axes at -1, 0 and 1",
        (_, conclusion) => conclusion.words(),
    }
}

/// What became of an answer: `reached → proven unreachable`.
pub(super) fn question_words(question: &Comparison) -> String {
    let Comparison { kind, class, old, new, .. } = question;
    let (was, is) = (verdict(*kind, old.verdict), verdict(*kind, new.verdict));
    let steps =
        |answered: &Answered| answered.steps.map_or(String::new(), |steps| format!(" in {}", counted(steps, "step")));
    let searched = format!(" ({} searched)", counted(new.nodes, "node"));
    let by = |answered: &Answered| match answered.by {
        Origin::AlongOldWay => ", found along the old way",
        Origin::Replay | Origin::Search => "",
    };
    match class {
        Class::Same => match (old.steps, new.steps) {
            (Some(a), Some(b)) if a != b => format!("{was} as before, in {a} → {b} steps"),
            _ => format!("{was} as before"),
        },
        Class::Way => {
            let steps = format!("{} → {}", old.steps.unwrap_or(0), new.steps.unwrap_or(0));
            format!("{is} by another way, {steps} steps{}", by(new))
        }
        Class::Lost => {
            let any_more = if new.verdict == Conclusion::NotFound { " any more" } else { "" };
            format!("{was}{} → {is}{any_more}{searched}: not known to be worse", steps(old))
        }
        Class::Found => format!("{was} → {is}{}{}, which may have been so before", steps(new), by(new)),
        Class::Worse | Class::Better | Class::Other => format!("{was}{} → {is}{}{}", steps(old), steps(new), by(new)),
    }
}

fn place(at: Option<[f64; 2]>) -> String {
    at.map_or("not there".to_string(), |[x, y]| format!("at ({}, {})", px(x), px(y)))
}

/// How a run ended; `done` is what it means that all inputs were given.
fn end_words(ended: &Ended, done: &str) -> String {
    let why = match &ended.end {
        RunEnd::Done => done.to_string(),
        RunEnd::Never(name) => format!("`never {name}` holds"),
        RunEnd::Outside(name) => format!("{name} leaves the bounds"),
        RunEnd::Fault => "a run-time error".to_string(),
    };
    let missing = match ended.missing.as_slice() {
        [] => String::new(),
        [part] => format!(": {part} does not hold"),
        parts => format!(": {} do not hold", parts.join(", ")),
    };
    format!("{why} after step {}, {}{missing}", ended.step, place(ended.at))
}

fn difference_lines(difference: &Difference) -> Vec<(String, String)> {
    let Difference { step, seconds: time, instance, space, old, new } = difference;
    let space = space.as_ref().map_or(String::new(), |space| format!(", in `{space}`"));
    vec![
        ("differs".to_string(), format!("first at step {step} ({time:.2} s){space}: {instance}")),
        ("  old".to_string(), format!("{}: {}", place(old.at), old.what.join("; "))),
        ("  new".to_string(), format!("{}: {}", place(new.at), new.what.join("; "))),
    ]
}

/// How the old way fares, as words with what they say.
pub(super) fn way_lines(way: &OldWay, class: Class) -> Vec<(String, String)> {
    let mut lines = Vec::new();
    if let Some(why) = &way.refused {
        lines.push(("old way".to_string(), format!("its inputs cannot be given any more: {why}")));
        return lines;
    }
    if let Some(steps) = way.holds {
        if class != Class::Same {
            lines.push(("old way".to_string(), format!("holds: {}", counted(steps, "step"))));
        }
        return lines;
    }
    lines.push(("old way".to_string(), format!("{}: does not arrive any more", counted(way.steps, "step"))));
    let Some(divergence) = &way.divergence else { return lines };
    lines.extend(divergence.other.iter().flat_map(difference_lines));
    lines.extend(divergence.player.iter().flat_map(difference_lines));
    if divergence.player.is_none() && divergence.other.is_none() {
        lines.push(("differs".to_string(), "nowhere in what is active, only in positions and values".to_string()));
    }
    lines.push(("ends".to_string(), format!("old: {}", end_words(&divergence.old, "it arrives"))));
    lines.push((String::new(), format!("new: {}", end_words(&divergence.new, "the inputs end"))));
    lines
}

/// The numbers that were set: ` with Hero.jump_speed=280`.
pub(super) fn set_words(result: &DiffResult) -> String {
    if result.set.is_empty() { String::new() } else { format!(" with {}", result.set.join(", ")) }
}

/// The summary: `1 of 2 answers changed: 1 worse`.
pub(super) fn summary(result: &DiffResult) -> String {
    if result.is_same && result.levels.iter().all(|level| level.is_same) {
        return "nothing changed: both programs mean the same".to_string();
    }
    let several = result.levels.len() > 1;
    let (all, what) = if several {
        (result.levels.len(), if result.levels.iter().any(|level| level.level.is_some()) { "level" } else { "world" })
    } else {
        (result.questions(), "answer")
    };
    let classes = [Class::Worse, Class::Lost, Class::Other, Class::Way, Class::Found, Class::Better];
    let count = |class: Class| match several {
        true => result.levels.iter().filter(|level| level.class() == class).count(),
        false => result.count(class),
    };
    let changed: usize = classes.into_iter().map(count).sum();
    let word = |class: Class| match class {
        Class::Way => "by another way",
        class => class_word(class),
    };
    let parts: Vec<String> = classes
        .into_iter()
        .filter(|class| count(*class) > 0)
        .map(|class| format!("{} {}", count(class), word(class)))
        .collect();
    match (all, changed) {
        (0, _) => {
            let changes = counted((result.changes.len() + result.maps.len()) as u64, "change");
            format!("{changes}; no question was asked")
        }
        (_, 0) => format!("no answer changed ({})", counted(result.questions() as u64, "question")),
        _ => format!("{changed} of {all} {what}s changed: {}", parts.join(", ")),
    }
}
