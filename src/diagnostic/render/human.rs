//! The renderer for people: excerpts with labels, through ariadne.

use std::fmt;
use std::ops::Range;

use ariadne::{Cache, Color, Config, IndexType, Label, Report, ReportKind, Source};

use crate::diagnostic::{Diagnostic, Severity};
use crate::source::{FileId, SourceMap, Span};

impl ariadne::Span for Span {
    type SourceId = FileId;

    fn source(&self) -> &FileId {
        &self.file
    }

    fn start(&self) -> usize {
        self.range().start
    }

    fn end(&self) -> usize {
        self.range().end
    }
}

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
pub fn human<'d>(
    sources: &SourceMap,
    diagnostics: impl IntoIterator<Item = &'d Diagnostic>,
    color: bool,
) -> String {
    let mut excerpts = Excerpts {
        map: sources,
        made: sources.iter().map(|_| None).collect(),
    };
    let mut out = Vec::new();
    for diagnostic in diagnostics {
        match &diagnostic.primary {
            Some(_) => {
                let report = report(sources, diagnostic, color);
                // Writing into a vector cannot fail; a span outside of its source is left out by `clamp`.
                let _ = report.write(&mut excerpts, &mut out);
            }
            None => out.extend(plain(diagnostic).into_bytes()),
        }
        out.push(b'\n');
    }
    String::from_utf8_lossy(&out).into_owned()
}

fn report(sources: &SourceMap, d: &Diagnostic, color: bool) -> Report<'static, Span> {
    let (kind, primary_color) = match d.severity {
        Severity::Error => (ReportKind::Custom("error", Color::Red), Color::Red),
        Severity::Warning => (ReportKind::Custom("warning", Color::Yellow), Color::Yellow),
    };
    let fallback = Span::new(FileId(0), 0, 0);
    let at = clamp(sources, d.primary.as_ref().map_or(fallback, |l| l.span));
    let mut report = Report::build(kind, at)
        .with_config(
            Config::default()
                .with_color(color)
                .with_index_type(IndexType::Byte),
        )
        .with_code(d.code)
        .with_message(&d.message);
    if let Some(primary) = &d.primary {
        report.add_label(
            Label::new(clamp(sources, primary.span))
                .with_message(&primary.text)
                .with_color(primary_color)
                .with_priority(1),
        );
    }
    for label in &d.secondary {
        report.add_label(
            Label::new(clamp(sources, label.span))
                .with_message(&label.text)
                .with_color(Color::Blue),
        );
    }
    for help in &d.helps {
        report.add_help(help);
    }
    for note in &d.notes {
        report.add_note(note);
    }
    report.finish()
}

/// A span that lies within its file and is not empty where the file is not: carets need something to stand under.
fn clamp(sources: &SourceMap, span: Span) -> Span {
    let text = sources.file(span.file).text();
    let Range { start, end } = span.range();
    let mut start = start.min(text.len());
    while !text.is_char_boundary(start) {
        start -= 1;
    }
    let mut end = end.clamp(start, text.len());
    while !text.is_char_boundary(end) {
        end += 1;
    }
    Span::new(span.file, start, end)
}

fn plain(d: &Diagnostic) -> String {
    let severity = match d.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    };
    let mut out = format!("{severity}[{}]: {}\n", d.code, d.message);
    for help in &d.helps {
        out.push_str(&format!("  help: {help}\n"));
    }
    for note in &d.notes {
        out.push_str(&format!("  note: {note}\n"));
    }
    out
}
