//! The renderer of the pages that explain codes: prose as it is, examples indented below a heading; and of the
//! descriptions of words.

use std::fmt::Write;

use crate::diagnostic::page::{Example, Page, Part, Side};
use crate::diagnostic::words::{Explained, Meaning, Signature};

const PLAIN: &str = "\x1b[0m";
const BOLD: &str = "\x1b[1m";
const RED: &str = "\x1b[1;31m";
const GREEN: &str = "\x1b[1;32m";
const CYAN: &str = "\x1b[36m";

/// A page as text.
pub fn page(page: &Page<'_>, color: bool) -> String {
    let mut out = styled(page.title, BOLD, color) + "\n";
    for part in &page.parts {
        out.push('\n');
        match part {
            Part::Prose(lines) => {
                out.push_str(&prose(&lines.join("\n"), color));
                out.push('\n');
            }
            Part::Example(example) => {
                out.push_str(&heading(example, color));
                out.push_str("\n\n");
                let prompt = if example.language == "sh" { "$ " } else { "" };
                for line in &example.lines {
                    let text = format!("    {prompt}{line}");
                    out.push_str(text.trim_end());
                    out.push('\n');
                }
            }
        }
    }
    out
}

/// Maximum length of a line of a description.
const WIDTH: usize = 80;

/// The description of a word as text: the ways to call it, what it means as a keyword, an example.
pub fn word(word: &Explained, color: bool) -> String {
    let mut out = styled(word.word, BOLD, color) + "\n";
    let calls = word.calls.iter().copied().map(Signature::line);
    let meaning = word.meaning.map(|Meaning { description, .. }| (*description).to_string());
    for paragraph in calls.chain(meaning) {
        out.push('\n');
        out.push_str(&prose(&wrapped(&paragraph), color));
        out.push('\n');
    }
    if let Some(Meaning { example, .. }) = word.meaning {
        out.push('\n');
        for line in example.lines() {
            out.push_str(&format!("    {line}\n"));
        }
    }
    out
}

/// A paragraph in lines.
fn wrapped(text: &str) -> String {
    let mut out = String::new();
    let mut length = 0;
    for word in text.split_whitespace() {
        let more = word.chars().count();
        if length > 0 {
            let is_full = length + 1 + more > WIDTH;
            out.push(if is_full { '\n' } else { ' ' });
            length = if is_full { 0 } else { length + 1 };
        }
        out.push_str(word);
        length += more;
    }
    out
}

fn styled(text: &str, style: &str, color: bool) -> String {
    if color { format!("{style}{text}{PLAIN}") } else { text.to_string() }
}

/// Text between backquotes is coloured instead, if there are colours.
fn prose(text: &str, color: bool) -> String {
    if !color {
        return text.to_string();
    }
    let parts = text.split('`').enumerate();
    parts.map(|(index, part)| styled(part, CYAN, index % 2 == 1)).collect()
}

/// `wrong, in `other.hyped`:`
fn heading(example: &Example<'_>, color: bool) -> String {
    let mut out = match example.side {
        Some(Side::Wrong) => styled("wrong", RED, color),
        Some(Side::Right) => styled("right", GREEN, color),
        None => String::new(),
    };
    if let Some(file) = example.setting("file") {
        let joint = if out.is_empty() { "" } else { ", in " };
        let _ = write!(out, "{joint}{}", prose(&format!("`{file}`"), color));
    }
    if let Some(inputs) = example.setting("inputs") {
        let _ = write!(out, ", run with the inputs {}", prose(&format!("`{inputs}`"), color));
    }
    out + ":"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_take_the_place_of_backquotes() {
        let text =
            "# E0: t\n\nUse `a`.\n\n```hyped wrong file=\"b\" inputs=\"-\"\nx\n\n    y\n```\n```sh right\nz\n```\n";
        let parsed = Page::new(text);
        let plain =
            "E0: t\n\nUse `a`.\n\nwrong, in `b`, run with the inputs `-`:\n\n    x\n\n        y\n\nright:\n\n    $ z\n";
        assert_eq!(page(&parsed, false), plain);
        let colored = page(&parsed, true);
        assert!(colored.contains("Use \x1b[36ma\x1b[0m.\n\n\x1b[1;31mwrong\x1b[0m, in"), "{colored:?}");
    }
}
