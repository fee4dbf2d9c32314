//! The renderer for people: excerpts with labels, through ariadne.

use std::fmt;
use std::ops::Range;

use ariadne::{Cache, Color, Config, IndexType, Label, Report, ReportKind, Source};

use crate::diagnostic::{Diagnostic, Label as MarkedPlace, Severity};
use crate::ordered::Ordered;
use crate::source::{FileId, SourceMap, Span};

/// A span in ariadne's form.
type Place = (FileId, Range<usize>);

/// The sources in ariadne's form, made when first needed.
struct Excerpts<'a> {
    map: &'a SourceMap,
    made: Vec<Option<Source<&'a str>>>,
}

impl<'a> Cache<FileId> for Excerpts<'a> {
    type Storage = &'a str;

    fn fetch(&mut self, id: &FileId) -> Result<&Source<&'a str>, impl fmt::Debug> {
        let (map, id) = (self.map, *id);
        match self.made.get_mut(id.0 as usize) {
            Some(slot) => Ok(&*slot.get_or_insert_with(|| Source::from(map.file(id).text()))),
            None => Err("no such file"),
        }
    }

    fn display<'b>(&self, id: &'b FileId) -> Option<impl fmt::Display + 'b> {
        Some(self.map.file(*id).path.display().to_string())
    }
}

/// Renders findings with excerpts of the source, one below the other.
pub fn human<'d>(sources: &SourceMap, diagnostics: impl IntoIterator<Item = &'d Diagnostic>, color: bool) -> String {
    let mut excerpts = Excerpts { map: sources, made: sources.iter().map(|_| None).collect() };
    let mut out = String::new();
    for d in diagnostics {
        let d = &d.clone().traced(sources);
        out.push_str(&header(d, color));
        if let Some(primary) = d.primary.as_ref().filter(|_| is_printable(sources, d)) {
            let mut text = Vec::new();
            // Writing into a vector cannot fail.
            let _ = report(sources, d, primary, color).write(&mut excerpts, &mut text);
            let text = String::from_utf8_lossy(&text);
            // The first line is ariadne's header; ours is the form that compilers share. Carets are padded with
            // blanks, which would be noise in a log.
            for line in text.lines().skip(1) {
                out.push_str(line.trim_end());
                out.push('\n');
            }
        } else {
            for label in d.primary.iter().chain(&d.secondary) {
                let file = sources.file(label.span.file());
                let (line, column) = file.line_column(label.span.range().start);
                out.push_str(&format!("  {}:{line}:{column}: {}\n", file.path.display(), label.text));
            }
            for (word, lines) in [("help", &d.helps), ("note", &d.notes)] {
                for line in lines {
                    out.push_str(&format!("  {word}: {line}\n"));
                }
            }
        }
        out.push('\n');
    }
    out
}

/// Maximum length of a line in an excerpt, in bytes.
const MAX_LINE: usize = 400;

/// Whether all lines of the excerpts are short enough.
fn is_printable(sources: &SourceMap, d: &Diagnostic) -> bool {
    d.primary.iter().chain(&d.secondary).all(|label| {
        let file = sources.file(label.span.file());
        let lines = file.line_column(label.span.range().start).0..=file.line_column(label.span.range().end).0;
        lines.take(8).all(|line| file.line_range(line - 1).is_none_or(|range| range.len() <= MAX_LINE))
    })
}

/// `error[E0302]: message`
fn header(d: &Diagnostic, color: bool) -> String {
    let (word, code) = match d.severity {
        Severity::Error => ("error", 31),
        Severity::Warning => ("warning", 33),
    };
    if color {
        format!("\u{1b}[1;{code}m{word}[{}]\u{1b}[0m\u{1b}[1m: {}\u{1b}[0m\n", d.code, d.message)
    } else {
        format!("{word}[{}]: {}\n", d.code, d.message)
    }
}

fn report(sources: &SourceMap, d: &Diagnostic, primary: &MarkedPlace, color: bool) -> Report<'static, Place> {
    let (kind, primary_color) = match d.severity {
        Severity::Error => (ReportKind::Error, Color::Red),
        Severity::Warning => (ReportKind::Warning, Color::Yellow),
    };
    let at = clamp(sources, primary.span);
    let config = Config::default().with_color(color).with_index_type(IndexType::Byte);
    let mut report = Report::build(kind, at).with_config(config);
    let mut labels = vec![(primary, primary_color)];
    labels.extend(d.secondary.iter().map(|l| (l, Color::Blue)));
    // Excerpts run down the page: the file of the mistake first, then by line.
    labels.order_by_key(|(l, _)| (l.span.file() != primary.span.file(), l.span.file(), l.span.start()));
    for (label, color) in labels {
        report.add_label(Label::new(clamp(sources, label.span)).with_message(&label.text).with_color(color));
    }
    for help in &d.helps {
        report.add_help(help);
    }
    for note in &d.notes {
        report.add_note(note);
    }
    report.finish()
}

/// A span clamped to its file, and not empty unless the file is: carets need text above them.
fn clamp(sources: &SourceMap, span: Span) -> Place {
    let text = sources.file(span.file()).text();
    let Range { start, end } = span.range();
    let mut start = start.min(text.len());
    while !text.is_char_boundary(start) {
        start -= 1;
    }
    let mut end = end.clamp(start, text.len());
    while !text.is_char_boundary(end) {
        end += 1;
    }
    (span.file(), start..end)
}
