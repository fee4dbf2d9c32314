//! The renderer for code hosts and editors: SARIF 2.1.0, the exchange format of checkers.
//! Every code is a rule, its page the rule's help; columns count UTF-16 code units.

use std::path::{Component, Path, PathBuf};

use serde_json::{Value, json};

use super::{Found, distinct, page};
use crate::diagnostic::page::Page;
use crate::diagnostic::{Code, Diagnostic, Fix, Label, Severity};
use crate::json::{Layout, text};
use crate::source::{FileId, SourceMap, Span};

const SCHEMA: &str = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json";

/// Renders the findings of all programs of a run as a SARIF log. Paths in `folder`, which is absolute, are written
/// relative to it.
///
/// # Errors
/// None that are known; those of `serde_json`.
pub fn sarif(run: &[Found<'_>], folder: &Path) -> Result<String, serde_json::Error> {
    let rules: Vec<Value> = Code::ALL.iter().map(|code| rule(*code)).collect();
    let results: Vec<Value> = distinct(run, |found, d| finding(found, d, folder));
    let driver = json!({ "name": "hypedc", "semanticVersion": env!("CARGO_PKG_VERSION"), "rules": rules });
    let run = json!({ "tool": { "driver": driver }, "columnKind": "utf16CodeUnits", "results": results });
    let log = json!({ "$schema": SCHEMA, "version": "2.1.0", "runs": [run] });
    Ok(text(&log, Layout::Indented)? + "\n")
}

fn rule(code: Code) -> Value {
    json!({
        "id": code.text(),
        "shortDescription": { "text": code.title() },
        "help": { "text": page(&Page::of(code), false) },
        "defaultConfiguration": { "level": level(code.severity()) },
    })
}

fn level(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    }
}

fn finding(found: &Found<'_>, d: &Diagnostic, folder: &Path) -> Value {
    let place = |label: &Label| location(found.sources, label, folder);
    let mut text = d.message.clone();
    for help in &d.helps {
        text.push_str(&format!("\nhelp: {help}"));
    }
    for note in &d.notes {
        text.push_str(&format!("\nnote: {note}"));
    }
    let mut finding = json!({
        "ruleId": d.code.text(),
        "ruleIndex": Code::ALL.iter().position(|code| *code == d.code),
        "level": level(d.severity),
        "message": { "text": text },
        "locations": [d.primary.as_ref().map_or_else(|| whole_file(found.path, folder), place)],
    });
    if !d.secondary.is_empty() {
        let related = (1..).zip(&d.secondary).map(|(id, label)| {
            let mut related = place(label);
            related["id"] = json!(id);
            related
        });
        finding["relatedLocations"] = related.collect();
    }
    if let Some(fix) = &d.fix {
        finding["fixes"] = json!([mending(found.sources, fix, folder)]);
    }
    finding
}

fn location(sources: &SourceMap, label: &Label, folder: &Path) -> Value {
    let artifact = artifact(&sources.file(label.span.file()).path, folder);
    json!({
        "physicalLocation": { "artifactLocation": artifact, "region": region(sources, label.span) },
        "message": { "text": label.text.as_str() },
    })
}

fn whole_file(path: &Path, folder: &Path) -> Value {
    json!({ "physicalLocation": { "artifactLocation": artifact(path, folder) } })
}

fn region(sources: &SourceMap, span: Span) -> Value {
    let file = sources.file(span.file());
    let (start_line, start_column) = file.line_column_utf16(span.range().start);
    let (end_line, end_column) = file.line_column_utf16(span.range().end);
    json!({
        "startLine": start_line,
        "startColumn": start_column,
        "endLine": end_line,
        "endColumn": end_column,
        "byteOffset": span.start(),
        "byteLength": span.end().saturating_sub(span.start()),
    })
}

/// One change for each file.
fn mending(sources: &SourceMap, fix: &Fix, folder: &Path) -> Value {
    let mut files: Vec<FileId> = fix.edits.iter().map(|(span, _)| span.file()).collect();
    files.sort();
    files.dedup();
    let changes = files.into_iter().map(|file| {
        let edits = fix.edits.iter().filter(|(span, _)| span.file() == file);
        let replacements: Vec<Value> = edits
            .map(|(span, text)| {
                json!({ "deletedRegion": region(sources, *span), "insertedContent": { "text": text.as_str() } })
            })
            .collect();
        json!({
            "artifactLocation": artifact(&sources.file(file).path, folder),
            "replacements": replacements,
        })
    });
    json!({ "description": { "text": fix.title.as_str() }, "artifactChanges": changes.collect::<Vec<_>>() })
}

fn artifact(path: &Path, folder: &Path) -> Value {
    json!({ "uri": uri(path, folder) })
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
