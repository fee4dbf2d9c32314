//! `hypedc check`: reports findings. They are the result, so they go to standard output.

use std::io::{self, IsTerminal, Write};
use std::path::Path;

use crate::compile::{Compilation, check_with};
use crate::diagnostic::render::{self, Found};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, MAX_FINDINGS, Severity};

use super::Exit;
use super::args::{CheckArgs, FindingFormat};
use super::disk::Disk;
use super::fix::apply_fixes;
use super::report::colored;

/// Maximum number of findings per program that are shown to people.
const MAX_SHOWN: usize = 100;

pub(super) fn run(args: &CheckArgs) -> io::Result<Exit> {
    let color = colored(io::stdout().is_terminal());
    let mut answer = Exit::Yes;
    let mut first: Option<(Severity, Code)> = None;
    let mut kept: Vec<(&Path, Compilation)> = Vec::new();
    for path in &args.files {
        if args.fix && !apply_fixes(path, args.level.file())? {
            answer = Exit::Refused;
        }
        let compilation = check_with(path, args.level.file(), &Disk);
        let found = &compilation.diagnostics;
        answer = answer.max(exit_code(found, args.deny.is_some()));
        // The first error, or the first warning where there is no error.
        let all = first.into_iter().chain(found.iter().map(|d| (d.severity, d.code)));
        first = all.min_by_key(|(severity, _)| *severity);
        match args.format {
            FindingFormat::Human => {
                let shown = select_shown(found);
                write!(io::stdout(), "{}", render::human(&compilation.sources, shown.iter().copied(), color))?;
                let left = found.iter().len() - shown.len();
                if left > 0 {
                    writeln!(io::stdout(), "… and {left} more, all of which `--format short` shows\n")?;
                }
                writeln!(io::stderr(), "{}: {}", path.display(), summary(found, !args.fix))?;
            }
            FindingFormat::Short => write!(io::stdout(), "{}", render::short(&compilation.sources, found.iter()))?,
            FindingFormat::Json | FindingFormat::Sarif => {}
        }
        let (left, most) = (found.left_out(), MAX_FINDINGS);
        if left > 0 {
            writeln!(io::stderr(), "{}: more than {most} findings; the other {left} are only counted", path.display())?;
        }
        if matches!(args.format, FindingFormat::Json | FindingFormat::Sarif) {
            kept.push((path, compilation));
        }
    }
    let run: Vec<Found<'_>> = kept
        .iter()
        .map(|(path, Compilation { sources, diagnostics, .. })| Found { path, sources, diagnostics })
        .collect();
    match args.format {
        FindingFormat::Human => {
            if let Some((severity, code)) = first {
                let article = if severity == Severity::Error { "an error" } else { "a warning" };
                writeln!(io::stderr(), "for more on {article}: hypedc explain {code}")?;
            }
        }
        FindingFormat::Short => {}
        FindingFormat::Json => write!(io::stdout(), "{}", render::json(&run)?)?,
        FindingFormat::Sarif => write!(io::stdout(), "{}", render::sarif(&run, &std::env::current_dir()?)?)?,
    }
    Ok(answer)
}

/// The findings shown to people: the first ones, errors before warnings if there are too many.
fn select_shown(found: &Diagnostics) -> Vec<&Diagnostic> {
    let (errors, warnings) = found.iter().partition::<Vec<_>, _>(|d| d.severity == Severity::Error);
    let mut errors = errors.len().min(MAX_SHOWN);
    let mut warnings = warnings.len().min(MAX_SHOWN - errors);
    let shown = found.iter().filter(|d| {
        let left = if d.severity == Severity::Error { &mut errors } else { &mut warnings };
        let shows = *left > 0;
        *left = left.saturating_sub(1);
        shows
    });
    shown.collect()
}

fn exit_code(found: &Diagnostics, deny_warnings: bool) -> Exit {
    let unasked = |code: Code| matches!(code, Code::Unreadable | Code::NotUtf8 | Code::TooLarge | Code::NoQuestion);
    if found.iter().any(|d| unasked(d.code) && d.primary.is_none()) {
        Exit::Refused
    } else if found.has_errors() || (deny_warnings && !found.is_empty()) {
        Exit::No
    } else {
        Exit::Yes
    }
}

fn summary(found: &Diagnostics, hint: bool) -> String {
    let mendable = found.iter().filter(|d| d.fix.is_some()).count();
    let hint = if hint && mendable > 0 { format!("; `--fix` fixes {mendable}") } else { String::new() };
    let count = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    let counts = match found.counts() {
        (0, 0) => "no errors".to_string(),
        (errors, 0) => count(errors, "error"),
        (0, warnings) => count(warnings, "warning"),
        (errors, warnings) => format!("{}, {}", count(errors, "error"), count(warnings, "warning")),
    };
    counts + &hint
}
