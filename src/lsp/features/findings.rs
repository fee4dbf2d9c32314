//! Findings as editors show them: the text of one, and whether its place has no effect.

use crate::diagnostic::{Code, Diagnostic};

/// Labels that add nothing to the message: they only mark the span.
const REDUNDANT_LABELS: [&str; 2] = ["not declared", "does not fit here"];

/// The message of a finding, the label of its span, helps, notes: in lines.
pub(in crate::lsp) fn message(finding: &Diagnostic) -> String {
    // A terminal shows the label below the span; here a label that repeats the message is redundant.
    let adds = |text: &String| !finding.message.contains(text.as_str()) && !REDUNDANT_LABELS.contains(&text.as_str());
    let label = finding.primary.iter().map(|l| l.text.to_string()).filter(adds);
    let helps = finding.helps.iter().map(|text| format!("help: {text}"));
    let notes = finding.notes.iter().map(|text| format!("note: {text}"));
    let lines: Vec<String> = std::iter::once(finding.message.clone()).chain(label).chain(helps).chain(notes).collect();
    lines.join("\n")
}

/// Whether a finding is about code without effect, which editors fade.
pub(in crate::lsp) fn is_unnecessary(code: Code) -> bool {
    matches!(code.text(), "W0201" | "W0401" | "W0403" | "W0405" | "W0702")
}
