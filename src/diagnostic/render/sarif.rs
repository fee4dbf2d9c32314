//! The renderer for code hosts and editors: SARIF 2.1.0, the exchange format of checkers, through serde-sarif.
//! Every code is a rule, its page the rule's help; columns count UTF-16 code units.

use std::path::{Component, Path, PathBuf};

use serde_sarif::sarif::{
    ArtifactChange, ArtifactContent, ArtifactLocation, Fix as SarifFix, Location, Message, MultiformatMessageString,
    PhysicalLocation, Region, Replacement, ReportingConfiguration, ReportingDescriptor, Result as Finding, ResultLevel,
    Run, Sarif, Tool, ToolComponent,
};

use super::{Found, distinct, page};
use crate::diagnostic::page::Page;
use crate::diagnostic::{Code, Diagnostic, Fix, Label, Severity};
use crate::source::{FileId, SourceMap, Span};

const SCHEMA: &str = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json";

/// Renders the findings of all programs of a run as a SARIF log. Paths in `folder`, which is absolute, are written
/// relative to it.
///
/// # Errors
/// None that are known; those of `serde_json`.
pub fn sarif(run: &[Found<'_>], folder: &Path) -> Result<String, serde_json::Error> {
    let driver = ToolComponent::builder()
        .name("hypedc")
        .semantic_version(env!("CARGO_PKG_VERSION"))
        .rules(Code::ALL.iter().map(|code| rule(*code)).collect::<Vec<_>>())
        .build();
    let run = Run::builder()
        .tool(Tool::builder().driver(driver).build())
        .column_kind("utf16CodeUnits")
        .results(distinct(run, |found, d| finding(found, d, folder)))
        .build();
    let log = Sarif::builder().schema(SCHEMA).version("2.1.0").runs(vec![run]).build();
    Ok(serde_json::to_string_pretty(&log)? + "\n")
}

fn rule(code: Code) -> ReportingDescriptor {
    ReportingDescriptor::builder()
        .id(code.text())
        .short_description(MultiformatMessageString::builder().text(code.title()).build())
        .help(MultiformatMessageString::builder().text(page(&Page::of(code), false)).build())
        .default_configuration(ReportingConfiguration::builder().level(level(code.severity())).build())
        .build()
}

fn level(severity: Severity) -> serde_json::Value {
    match severity {
        Severity::Error => "error".into(),
        Severity::Warning => "warning".into(),
    }
}

fn finding(found: &Found<'_>, d: &Diagnostic, folder: &Path) -> Finding {
    let place = |label: &Label| location(found.sources, label, folder);
    let mut text = d.message.clone();
    for help in &d.helps {
        text.push_str(&format!("\nhelp: {help}"));
    }
    for note in &d.notes {
        text.push_str(&format!("\nnote: {note}"));
    }
    let mut finding = Finding::builder()
        .rule_id(d.code.text())
        .rule_index(Code::ALL.iter().position(|code| *code == d.code).map_or(-1, |index| index as i64))
        .level(match d.severity {
            Severity::Error => ResultLevel::Error,
            Severity::Warning => ResultLevel::Warning,
        })
        .message(message(text))
        .locations(vec![d.primary.as_ref().map_or_else(|| whole_file(found.path, folder), place)])
        .build();
    if !d.secondary.is_empty() {
        let numbered = (1..).zip(&d.secondary);
        let related = numbered.map(|(id, label)| Location { id: Some(id), ..place(label) });
        finding.related_locations = Some(related.collect());
    }
    finding.fixes = d.fix.as_ref().map(|fix| vec![mending(found.sources, fix, folder)]);
    finding
}

fn message(text: impl Into<String>) -> Message {
    Message::builder().text(text).build()
}

fn location(sources: &SourceMap, label: &Label, folder: &Path) -> Location {
    let physical = PhysicalLocation::builder()
        .artifact_location(artifact(&sources.file(label.span.file()).path, folder))
        .region(region(sources, label.span))
        .build();
    Location::builder().physical_location(physical).message(message(label.text.as_str())).build()
}

fn whole_file(path: &Path, folder: &Path) -> Location {
    let physical = PhysicalLocation::builder().artifact_location(artifact(path, folder)).build();
    Location::builder().physical_location(physical).build()
}

fn region(sources: &SourceMap, span: Span) -> Region {
    let file = sources.file(span.file());
    let (start_line, start_column) = file.line_column_utf16(span.range().start);
    let (end_line, end_column) = file.line_column_utf16(span.range().end);
    Region::builder()
        .start_line(start_line as i64)
        .start_column(start_column as i64)
        .end_line(end_line as i64)
        .end_column(end_column as i64)
        .byte_offset(i64::from(span.start()))
        .byte_length(i64::from(span.end().saturating_sub(span.start())))
        .build()
}

/// One change for each file.
fn mending(sources: &SourceMap, fix: &Fix, folder: &Path) -> SarifFix {
    let mut files: Vec<FileId> = fix.edits.iter().map(|(span, _)| span.file()).collect();
    files.sort();
    files.dedup();
    let changes = files.into_iter().map(|file| {
        let edits = fix.edits.iter().filter(|(span, _)| span.file() == file);
        let replacements = edits.map(|(span, text)| {
            let content = ArtifactContent::builder().text(text.as_str()).build();
            Replacement::builder().deleted_region(region(sources, *span)).inserted_content(content).build()
        });
        ArtifactChange::builder()
            .artifact_location(artifact(&sources.file(file).path, folder))
            .replacements(replacements.collect::<Vec<_>>())
            .build()
    });
    SarifFix::builder().description(message(fix.title.as_str())).artifact_changes(changes.collect::<Vec<_>>()).build()
}

fn artifact(path: &Path, folder: &Path) -> ArtifactLocation {
    ArtifactLocation::builder().uri(uri(path, folder)).build()
}

/// A path as a URI: relative to the folder where it lies in it, else `file:///…`.
fn uri(path: &Path, folder: &Path) -> String {
    let absolute = plain(&folder.join(path));
    let folder = plain(folder);
    let (start, path) = match absolute.strip_prefix(&folder) {
        Ok(inside) => ("", inside),
        Err(_) => ("file://", absolute.as_path()),
    };
    let mut out = start.to_string();
    for component in path.components() {
        match component {
            Component::RootDir => {}
            Component::Prefix(drive) => {
                out.push('/');
                out.push_str(&drive.as_os_str().to_string_lossy().replace('\\', "/"));
            }
            Component::CurDir | Component::ParentDir | Component::Normal(_) => {
                if !out.is_empty() {
                    out.push('/');
                }
                encode(&component.as_os_str().to_string_lossy(), &mut out);
            }
        }
    }
    out
}

/// A path without `.` and `..`, without looking at the file system.
fn plain(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir => {
                out.pop();
            }
            Component::Prefix(_) | Component::RootDir | Component::Normal(_) => out.push(component),
        }
    }
    out
}

/// A name in a URI: percent-encoded bytes except for letters, digits and `-._~`.
fn encode(name: &str, out: &mut String) {
    for byte in name.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~".contains(&byte) {
            out.push(char::from(byte));
        } else {
            out.push_str(&format!("%{byte:02X}"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_become_uris() {
        let uri = |path: &str| uri(Path::new(path), Path::new("/home/me"));
        assert_eq!(uri("./a b/c:d.hyped"), "a%20b/c%3Ad.hyped");
        assert_eq!(uri("/home/me/x/../y.hyped"), "y.hyped");
        assert_eq!(uri("../you/é.hyped"), "file:///home/you/%C3%A9.hyped");
    }
}
