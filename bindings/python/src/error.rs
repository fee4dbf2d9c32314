//! Exceptions from findings. Their classes are in `python/hyped/_errors.py`.

use hypedc::ask::Refusal;
use hypedc::diagnostic::render::{self, Found};
use hypedc::diagnostic::{Diagnostics, Fact};
use hypedc::source::SourceMap;
use pyo3::prelude::*;

pub(crate) mod class {
    //! The classes.

    pyo3::import_exception!(hyped._errors, HypedError);
    pyo3::import_exception!(hyped._errors, CompileError);
    pyo3::import_exception!(hyped._errors, QuestionError);
    pyo3::import_exception!(hyped._errors, StepError);
    pyo3::import_exception!(hyped._errors, UnknownNameError);
}

/// All findings as JSON, in the form of `hypedc check --format json`.
pub(crate) fn findings(sources: &SourceMap, diagnostics: &Diagnostics) -> String {
    let path = sources.iter().next().map(|(_, file)| file.path.clone()).unwrap_or_default();
    let found = Found { path: &path, sources, diagnostics };
    render::json(&[found]).unwrap_or_default()
}

/// A program that cannot be compiled: as text, as coloured text, as JSON.
pub(crate) fn compile_error(sources: &SourceMap, diagnostics: &Diagnostics) -> PyErr {
    let text = |color| render::human(sources, diagnostics.iter(), color);
    class::CompileError::new_err((text(false), text(true), findings(sources, diagnostics)))
}

/// A question that cannot be asked.
pub(crate) fn question(fact: impl Fact) -> PyErr {
    question_at(&SourceMap::new(), fact)
}

/// As [`question`], about a place in some files.
pub(crate) fn question_at(sources: &SourceMap, fact: impl Fact) -> PyErr {
    let mut found = Diagnostics::new();
    found.report(fact);
    questions(sources, &found)
}

/// As [`question`], from findings.
pub(crate) fn questions(sources: &SourceMap, found: &Diagnostics) -> PyErr {
    class::QuestionError::new_err(as_keywords(render::human(sources, found.iter(), false).trim_end()))
}

/// A name that there is not, where Python expects a `KeyError`.
pub(crate) fn unknown_name(fact: impl Fact) -> PyErr {
    let mut found = Diagnostics::new();
    found.report(fact);
    let text = render::human(&SourceMap::new(), found.iter(), false);
    class::UnknownNameError::new_err(as_keywords(text.trim_end()))
}

/// A question that cannot be asked.
pub(crate) fn refusal(sources: &SourceMap, refusal: Refusal) -> PyErr {
    match refusal {
        Refusal::Findings(found) => questions(sources, &found),
        Refusal::Plain(message) => class::QuestionError::new_err(as_keywords(&message)),
    }
}

/// A step that broke a rule of the language.
pub(crate) fn step(sources: &SourceMap, fact: impl Fact) -> PyErr {
    let mut found = Diagnostics::new();
    found.report(fact);
    class::StepError::new_err(render::human(sources, found.iter(), false).trim_end().to_string())
}

/// An argument that is wrong.
pub(crate) fn argument(message: impl Into<String>) -> PyErr {
    class::QuestionError::new_err(message.into())
}

/// What messages say of options of the command line, as arguments of Python: `--world NAME` is `world=NAME`.
fn as_keywords(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) = rest.find("`--") {
        let (before, option) = rest.split_at(at + 1);
        out.push_str(before);
        let option = &option[2..];
        let end = option.find(|c: char| c != '-' && !c.is_ascii_lowercase()).unwrap_or(option.len());
        let name = if &option[..end] == "map" { "level".to_string() } else { option[..end].replace('-', "_") };
        out.push_str(&name);
        rest = match option[end..].strip_prefix(' ') {
            Some(value) => {
                out.push('=');
                value
            }
            None => &option[end..],
        };
    }
    out + rest
}
