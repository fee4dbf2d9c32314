//! The result of `hypedc diff` as Markdown, for a comment on a pull request.

use crate::diff::{Class, Comparison};

use super::figure_words::figure_changes;
use super::result::{DiffResult, LevelResult};
use super::words::{change_words, class_word, map_words, question_words, set_words, summary, way_lines};

/// Maximum number of lines of a list.
const MAX_SHOWN: usize = 30;

/// A text in a cell or a list: what Markdown would read as markup is escaped.
fn plain(text: &str) -> String {
    let mut out = String::new();
    let mut is_code = false;
    for c in text.chars() {
        match c {
            '`' => is_code = !is_code,
            '*' | '_' | '<' | '#' | '[' | ']' | '\\' if !is_code => out.push('\\'),
            '|' => out.push('\\'),
            _ => {}
        }
        out.push(if c == '\n' { ' ' } else { c });
    }
    // A backquote that opens and is never closed.
    if is_code { out.replace('`', "\\`") } else { out }
}

fn list(out: &mut String, lines: &[String]) {
    // What is indented belongs to the line above.
    for line in lines.iter().take(MAX_SHOWN) {
        let indent = line.len() - line.trim_start().len();
        out.push_str(&format!("{}- {}\n", &line[..indent], plain(line.trim_start())));
    }
    if lines.len() > MAX_SHOWN {
        out.push_str(&format!("- and {} more\n", lines.len() - MAX_SHOWN));
    }
}

/// The result as Markdown.
pub(super) fn result_markdown(result: &DiffResult) -> String {
    let mut out = format!("### hypedc diff: {}\n\n", plain(&summary(result)));
    out.push_str(&format!("`{}` → `{}`{}\n", result.old.file, result.new.file, escaped(&set_words(result))));
    if result.stopped {
        out.push_str("\n**Stopped: not all questions were asked.**\n");
    }
    let mut lines: Vec<String> = result.changes.iter().map(change_words).collect();
    lines.extend(result.maps.iter().map(map_words));
    if !lines.is_empty() {
        out.push_str("\n**What changed**\n\n");
        list(&mut out, &lines);
    }
    for (head, lines) in figure_changes(result) {
        out.push_str(&format!("\n**{}**\n", plain(&head)));
        if lines.is_empty() {
            continue;
        }
        out.push_str("\n| input | change |\n|---|---|\n");
        for (name, what) in lines.iter().take(MAX_SHOWN) {
            out.push_str(&format!("| {} | {} |\n", plain(name), plain(what)));
        }
    }
    if result.asked().next().is_some() {
        out.push_str("\n| level | question | change | answer |\n|---|---|---|---|\n");
        result.asked().for_each(|level| out.push_str(&rows(level)));
        for level in result.asked() {
            let changed = level.questions.iter().filter(|question| question.class != Class::Same);
            changed.for_each(|question| out.push_str(&details(level, question)));
        }
    }
    out
}

fn rows(level: &LevelResult) -> String {
    let mut out = String::new();
    let name = plain(&level.name());
    if let Some(error) = &level.error {
        let word = if level.is_broken { "**worse**" } else { "error" };
        out.push_str(&format!("| {name} | | {word} | {} |\n", plain(error)));
    }
    for question in &level.questions {
        let asked = format!("{} {}", question.kind.name(), question.goal);
        let word = class_word(question.class);
        let word = if question.class == Class::Worse { format!("**{word}**") } else { word.to_string() };
        out.push_str(&format!("| {name} | {} | {word} | {} |\n", plain(&asked), plain(&question_words(question))));
    }
    out
}

/// The way of a question that changed, folded.
fn details(level: &LevelResult, question: &Comparison) -> String {
    let mut lines: Vec<String> = question.new.reasons.iter().map(|why| format!("because {why}")).collect();
    for (name, what) in question.old_way.iter().flat_map(|way| way_lines(way, question.class)) {
        lines.push(if name.is_empty() { what } else { format!("{name}: {what}") });
    }
    lines.extend(question.other_way().map(|inputs| format!("inputs: `{inputs}`")));
    if lines.is_empty() {
        return String::new();
    }
    let head = format!("{}, {} {}", level.name(), question.kind.name(), question.goal);
    let mut out = format!("\n<details><summary>{}</summary>\n\n", escaped(&head));
    list(&mut out, &lines);
    out.push_str("\n</details>\n");
    out
}

/// A text in HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
