//! `hypedc check`: what is wrong with programs. Findings go to standard output, they are the result.

use std::io::{self, IsTerminal, Write};

use crate::compile::compile_with;
use crate::diagnostic::{Code, Diagnostics, Severity};

use super::Answer;
use super::args::{CheckArgs, FindingFormat};
use super::disk::Disk;
use super::report::{colored, rendered};

pub(super) fn run(args: &CheckArgs) -> io::Result<Answer> {
    let color = colored(io::stdout().is_terminal());
    let mut answer = Answer::Yes;
    let mut first_error = None;
    for path in &args.files {
        let compilation = compile_with(path, args.map.as_deref(), &Disk);
        let found = &compilation.diagnostics;
        write!(io::stdout(), "{}", rendered(&compilation.sources, found, args.format, color))?;
        if args.format == FindingFormat::Human {
            writeln!(io::stderr(), "{}: {}", path.display(), summary(found))?;
        }
        answer = answer.max(judged(found));
        first_error = first_error.or(found.iter().find(|d| d.severity == Severity::Error).map(|d| d.code));
    }
    if let Some(code) = first_error.filter(|_| args.format == FindingFormat::Human) {
        writeln!(io::stderr(), "for more on an error: hypedc explain {code}")?;
    }
    Ok(answer)
}

fn judged(found: &Diagnostics) -> Answer {
    let unasked = |code: Code| matches!(code, Code::Unreadable | Code::NotUtf8 | Code::TooLarge | Code::NoQuestion);
    if found.iter().any(|d| unasked(d.code) && d.primary.is_none()) {
        Answer::Unasked
    } else if found.has_errors() {
        Answer::No
    } else {
        Answer::Yes
    }
}

fn summary(found: &Diagnostics) -> String {
    let count = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    match found.counts() {
        (0, 0) => "no errors".to_string(),
        (errors, 0) => count(errors, "error"),
        (0, warnings) => count(warnings, "warning"),
        (errors, warnings) => format!("{}, {}", count(errors, "error"), count(warnings, "warning")),
    }
}
