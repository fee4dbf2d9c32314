//! The result of `hypedc diff` as text for people: the summary first, then what changed, how players move, and the
//! answers that are others.

use crate::cli::reach::ScriptDetail;
use crate::diff::{Class, Comparison};
use crate::tabular::{Cell, Column, Table};

use super::figure_words::figure_changes;
use super::result::{DiffResult, LevelResult};
use super::words::{change_words, class_word, map_words, question_words, set_words, summary, way_lines};

/// Maximum number of changes and of jumps that the text shows.
const MAX_SHOWN: usize = 20;
/// Maximum width of the first of two columns.
const MAX_NAME: usize = 70;
/// Maximum number of levels whose old ways the text shows.
const MAX_WAYS: usize = 8;

/// Lines of which only the first ones are shown.
fn limited(out: &mut String, lines: &[String]) {
    lines.iter().take(MAX_SHOWN).for_each(|line| out.push_str(&format!("    {line}\n")));
    if lines.len() > MAX_SHOWN {
        out.push_str(&format!("    and {} more, `--format json` has all\n", lines.len() - MAX_SHOWN));
    }
}

/// Pairs of words as two columns; what does not fit into the first one has a line of its own.
fn columns(lines: &[(String, String)]) -> Vec<String> {
    let length = |name: &String| name.chars().count();
    let width = lines.iter().map(|(name, _)| length(name)).filter(|length| *length <= MAX_NAME).max().unwrap_or(0);
    let mut all = Vec::new();
    for (name, what) in lines {
        if length(name) > MAX_NAME {
            all.extend([name.clone(), format!("  {what}")]);
        } else {
            all.push(format!("{name:width$}  {what}"));
        }
    }
    all
}

/// The result as text.
pub(super) fn result_text(result: &DiffResult, detail: ScriptDetail) -> String {
    let mut out = format!("{} → {}{}: {}\n", result.old.file, result.new.file, set_words(result), summary(result));
    if result.stopped {
        out.push_str("  stopped: not all questions were asked\n");
    }
    if !result.changes.is_empty() || !result.maps.is_empty() {
        out.push_str("  what changed\n");
        let mut lines: Vec<String> = result.changes.iter().map(change_words).collect();
        lines.extend(result.maps.iter().map(map_words));
        limited(&mut out, &lines);
    } else if !result.is_same {
        out.push_str("  what changed: nothing that is told apart by name\n");
    }
    for (head, lines) in figure_changes(result) {
        out.push_str(&format!("  {head}\n"));
        limited(&mut out, &columns(&lines));
    }
    let asked: Vec<&LevelResult> = result.asked().collect();
    match asked.as_slice() {
        [] => {}
        [only] => out.push_str(&level_text(only, true, detail)),
        _ => {
            out.push_str(&table(&asked));
            let changed = asked.iter().filter(|level| level.class() != Class::Same);
            changed.clone().take(MAX_WAYS).for_each(|level| out.push_str(&level_text(level, false, detail)));
            if changed.clone().count() > MAX_WAYS {
                let more = changed.count() - MAX_WAYS;
                out.push_str(&format!("  and {more} more, `--format json` has all\n"));
            }
        }
    }
    out
}

/// A line for each level.
fn table(levels: &[&LevelResult]) -> String {
    let mut table = Table::new(vec![
        Column::left("", "level"),
        Column::left("", "question"),
        Column::left("", "change"),
        Column::left("", "answer"),
    ]);
    for level in levels {
        if let Some(error) = &level.error {
            let error = error.lines().next().unwrap_or_default().to_string();
            let word = if level.is_broken { "worse" } else { "error" };
            table.push([level.name(), String::new(), word.to_string(), error].map(Cell::from).into());
        }
        for question in &level.questions {
            let name = format!("{} {}", question.kind.name(), question.goal);
            let class = class_word(question.class).to_string();
            table.push([level.name(), name, class, question_words(question)].map(Cell::from).into());
        }
    }
    table.text()
}

/// The answers about a level; without `all`, only those that are others.
fn level_text(level: &LevelResult, all: bool, detail: ScriptDetail) -> String {
    let mut out = format!("  {}\n", level.name());
    level.maps.iter().for_each(|change| out.push_str(&format!("    {}\n", map_words(change))));
    level.error.iter().flat_map(|error| error.lines()).for_each(|line| out.push_str(&format!("    {line}\n")));
    let shown = level.questions.iter().filter(|question| all || question.class != Class::Same);
    shown.for_each(|question| out.push_str(&question_text(question, detail)));
    if level.is_refuted {
        out.push_str(
            "    the analysis is wrong about this world, and its proofs are withdrawn: a mistake of hypedc; \
                      `hypedc reach` shows the inputs\n",
        );
    }
    out
}

fn question_text(question: &Comparison, detail: ScriptDetail) -> String {
    let Comparison { kind, goal, class, new, old_way, .. } = question;
    let word = match class {
        Class::Same | Class::Way => String::new(),
        class => format!(" ({})", class_word(*class)),
    };
    let mut out = format!("    {} {goal}: {}{word}\n", kind.name(), question_words(question));
    let mut lines: Vec<(String, String)> =
        new.reasons.iter().filter(|_| *class != Class::Same).map(|why| ("because".into(), why.clone())).collect();
    lines.extend(old_way.iter().flat_map(|way| way_lines(way, *class)));
    lines.extend(question.other_way().map(|inputs| ("inputs".to_string(), detail.script(inputs))));
    columns(&lines).iter().for_each(|line| out.push_str(&format!("      {line}\n")));
    out
}
