//! Writer of statements. It chooses the line breaks; the formatter sets all blanks.

use crate::format::WIDTH;

/// A statement and its comments.
#[derive(Default)]
pub(super) struct Statement {
    /// Comments before it.
    pub above: Vec<String>,
    /// Whether they document it.
    pub documented: bool,
    /// Whether a blank line is before it.
    pub apart: bool,
    /// Its own text; with a block, the text before `{`. Empty for only comments.
    pub text: String,
    /// Comments on its line.
    pub beside: Vec<String>,
    pub block: Option<Vec<Statement>>,
}

impl Statement {
    /// A statement without comments.
    pub fn new(text: impl Into<String>) -> Self {
        Statement { text: text.into(), ..Statement::default() }
    }

    /// A statement that is only a comment.
    pub fn comment(text: impl Into<String>) -> Self {
        Statement { above: vec![text.into()], ..Statement::default() }
    }

    /// A block.
    pub fn block(text: impl Into<String>, block: Vec<Statement>) -> Self {
        Statement { text: text.into(), block: Some(block), ..Statement::default() }
    }

    /// The statement with comments before it and on its line.
    pub fn with(mut self, above: Vec<String>, beside: Vec<String>) -> Self {
        self.above.splice(0..0, above);
        self.beside.extend(beside);
        self
    }
}

/// The text of a program with one statement at its top level.
pub(super) fn text(statement: &Statement) -> String {
    let mut out = String::new();
    write(&mut out, statement, 0);
    out
}

fn write(out: &mut String, s: &Statement, depth: usize) {
    let indent = " ".repeat(4 * depth);
    if s.apart {
        out.push('\n');
    }
    let marks = if s.documented { "///" } else { "//" };
    let comments = |out: &mut String, lines: &[String], depth: usize| {
        for line in lines.iter().flat_map(|line| wrapped(line, WIDTH.saturating_sub(4 * depth + marks.len() + 1))) {
            out.push_str(&format!("{}{marks} {line}\n", " ".repeat(4 * depth)));
        }
    };
    comments(out, &s.above, depth);
    let blank = s.block.as_ref().is_some_and(|block| block.iter().all(|s| s.text.is_empty() && s.above.is_empty()));
    let end = match s.block {
        Some(_) if blank => " { }",
        Some(_) => " {",
        None => "",
    };
    let fits = |line: &String| indent.len() + s.text.len() + end.len() + 4 + line.chars().count() <= WIDTH;
    let (beside, before) = match s.beside.as_slice() {
        [] => (String::new(), &[][..]),
        [line] if fits(line) => (format!(" // {line}"), &[][..]),
        lines => (String::new(), lines),
    };
    comments(out, before, depth);
    if s.text.is_empty() {
        return;
    }
    out.push_str(&format!("{indent}{}{end}{beside}\n", s.text));
    if let Some(block) = s.block.as_ref().filter(|_| !blank) {
        for (index, inner) in block.iter().enumerate() {
            // No blank line at the beginning of a block.
            if index == 0 && inner.apart {
                let mut first = String::new();
                write(&mut first, inner, depth + 1);
                out.push_str(first.trim_start_matches('\n'));
            } else {
                write(out, inner, depth + 1);
            }
        }
        out.push_str(&format!("{indent}}}\n"));
    }
}

/// A text in lines of limited length, unless one word is longer.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let (mut lines, mut line, mut length) = (Vec::new(), String::new(), 0);
    for word in text.split(' ') {
        let more = word.chars().count();
        if length > 0 && length + 1 + more > width {
            lines.push(std::mem::take(&mut line));
            length = 0;
        }
        if length > 0 {
            line.push(' ');
            length += 1;
        }
        line.push_str(word);
        length += more;
    }
    lines.push(line);
    lines
}
