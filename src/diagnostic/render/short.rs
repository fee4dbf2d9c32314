//! The renderer for tools: `FILE:LINE:COL: error[E0302]: message`, one line a finding, through codespan-reporting.

use std::ops::Range;

use codespan_reporting::diagnostic::{Diagnostic as Report, Label};
use codespan_reporting::files::{Error, Files};
use codespan_reporting::term::{Config, DisplayStyle, emit_into_string};

use crate::diagnostic::{Diagnostic, Severity};
use crate::source::{FileId, SourceMap};

/// Our files as codespan-reporting reads them.
struct Sources<'a>(&'a SourceMap);

impl<'a> Files<'a> for Sources<'a> {
    type FileId = FileId;
    type Name = String;
    type Source = &'a str;

    fn name(&'a self, id: FileId) -> Result<String, Error> {
        Ok(self.0.file(id).path.display().to_string())
    }

    fn source(&'a self, id: FileId) -> Result<&'a str, Error> {
        Ok(self.0.file(id).text())
    }

    fn line_index(&'a self, id: FileId, byte: usize) -> Result<usize, Error> {
        Ok(self.0.file(id).line_column(byte).0 - 1)
    }

    fn column_number(&'a self, id: FileId, _: usize, byte: usize) -> Result<usize, Error> {
        Ok(self.0.file(id).line_column(byte).1)
    }

    fn line_range(&'a self, id: FileId, line: usize) -> Result<Range<usize>, Error> {
        self.0.file(id).line_range(line).ok_or(Error::LineTooLarge { given: line, max: 0 })
    }
}

/// Renders findings one per line, without colours.
pub fn short<'d>(sources: &SourceMap, diagnostics: impl IntoIterator<Item = &'d Diagnostic>) -> String {
    let config = Config { display_style: DisplayStyle::Short, ..Config::default() };
    let files = Sources(sources);
    let mut out = String::new();
    for d in diagnostics {
        let d = &d.clone().traced(sources);
        let report = match d.severity {
            Severity::Error => Report::error(),
            Severity::Warning => Report::warning(),
        };
        let labels = d.primary.iter().map(|l| Label::primary(l.span.file(), l.span.range())).collect();
        let report = report.with_code(d.code.text()).with_message(&d.message).with_labels(labels);
        out.push_str(&emit_into_string(&config, &files, &report).unwrap_or_else(|e| format!("{}: {e}\n", d.message)));
    }
    out
}
