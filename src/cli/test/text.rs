//! The result of `hypedc test` as text for people.

use crate::diagnostic::catalogue::test::TestFailed;
use crate::diagnostic::{Diagnostics, render};
use crate::source::SourceMap;
use crate::suite::{ClaimResult, CoverageResult, SuiteResult, TestResult};
use crate::why::{Atom, EdgeCoverage, Place, shown};

use crate::cli::reach::counted;

/// Maximum number of characters of a script in a finding.
const MAX_SCRIPT: usize = 300;
/// Maximum number of places that were not covered in the text.
const MAX_PLACES: usize = 40;

/// The line of a test.
pub(super) fn line(result: &TestResult, has_worlds: bool) -> String {
    let world = if has_worlds { format!("{}: ", result.world) } else { String::new() };
    let verdict = if result.passed { "ok" } else { "FAILED" };
    format!("test {world}{} ... {verdict}\n", result.test)
}

/// Why a test failed, with the places in the text.
pub(super) fn failures(result: &TestResult, sources: &SourceMap, color: bool) -> String {
    let mut found = Diagnostics::new();
    let mut report = |at, what: &str, notes: Vec<String>| {
        found.report(TestFailed { at, test: result.test.clone(), what: what.to_string(), notes });
    };
    for problem in &result.problems {
        report(result.at, problem, Vec::new());
    }
    for claim in result.claims.iter().filter(|claim| !claim.passed) {
        report(claim.at, &claim.answer, notes(claim));
    }
    render::human(sources, found.iter(), color)
}

/// What is known of a claim that is not so.
fn notes(claim: &ClaimResult) -> Vec<String> {
    let mut notes = claim.reasons.clone();
    notes.extend(claim.parts.iter().filter_map(part));
    if let Some(inputs) = claim.inputs.as_ref().filter(|inputs| !inputs.is_empty()) {
        let cut: String = inputs.chars().take(MAX_SCRIPT).collect();
        let rest = if cut.len() < inputs.len() { " …" } else { "" };
        notes.push(format!("inputs: {cut}{rest}"));
    }
    notes
}

/// ``hero.keys == 1` does not hold: it compares 0 with 1``
fn part(part: &Atom) -> Option<String> {
    let held = match part.held? {
        true => "holds",
        false => "does not hold",
    };
    let sides = part.sides.map(|[a, b]| format!(": it compares {} with {}", shown(a), shown(b))).unwrap_or_default();
    Some(format!("`{}` {held}{sides}", part.text))
}

/// The last line.
pub(super) fn summary(result: &SuiteResult) -> String {
    let SuiteResult { passed, failed, filtered, not_run, seconds, .. } = result;
    let verdict = if *failed == 0 && *not_run == 0 { "ok" } else { "FAILED" };
    let filtered = if *filtered > 0 { format!("; {filtered} filtered out") } else { String::new() };
    let not_run = if *not_run > 0 { format!("; {not_run} not run") } else { String::new() };
    format!("test result: {verdict}. {passed} passed; {failed} failed{filtered}{not_run}; finished in {seconds:.2} s\n")
}

/// The coverage: its counts, then the places that were not covered.
pub(super) fn coverage(coverage: &CoverageResult) -> String {
    let CoverageResult { runs, steps, modes, edges } = coverage;
    let entered = modes.iter().filter(|mode| mode.entered > 0).count();
    let taken = edges.iter().filter(|edge| edge.taken > 0).count();
    let sides: Vec<u64> = edges.iter().flat_map(|edge| &edge.parts).flat_map(|part| [part.held, part.failed]).collect();
    let seen = sides.iter().filter(|count| **count > 0).count();
    let mut out = format!("coverage of {}, {}\n", counted(*runs, "run"), counted(*steps, "step"));
    for (what, count, all) in [
        ("modes entered", entered, modes.len()),
        ("edges taken", taken, edges.len()),
        ("sides of guard parts seen", seen, sides.len()),
    ] {
        let share = if all == 0 { 100.0 } else { 100.0 * count as f64 / all as f64 };
        out.push_str(&format!("  {what:26}{count:4} of {all:4}  {share:5.1} %\n"));
    }
    let mut open: Vec<(&Place, String)> = Vec::new();
    for mode in modes.iter().filter(|mode| mode.entered == 0) {
        open.push((&mode.place, format!("mode `{}` of {} was never entered", mode.mode, mode.entity)));
    }
    for edge in edges {
        open.extend(uncovered(edge).map(|words| (&edge.place, words)));
    }
    let key = |place: &Place| (place.path.clone(), place.line, place.column);
    open.sort_by_key(|(place, _)| key(place));
    let rest = open.len().saturating_sub(MAX_PLACES);
    for (place, words) in open.iter().take(MAX_PLACES) {
        out.push_str(&format!("  {place}: {words}\n"));
    }
    if rest > 0 {
        out.push_str(&format!("  and {} more\n", counted(rest as u64, "place")));
    }
    out
}

/// What is missing of an edge.
fn uncovered(edge: &EdgeCoverage) -> Option<String> {
    let to = edge.to.as_ref().map_or("which stays".to_string(), |to| format!("to `{to}`"));
    let name = format!("edge of {} from `{}` {to}", edge.entity, edge.from);
    if edge.tried == 0 {
        return Some(format!("{name} was never tried"));
    }
    let mut missing = Vec::new();
    if edge.taken == 0 {
        missing.push("was never taken".to_string());
    }
    for part in &edge.parts {
        match (part.held, part.failed) {
            (0, 1..) => missing.push(format!("`{}` was never true", part.text)),
            (1.., 0) => missing.push(format!("`{}` was never false", part.text)),
            _ => {}
        }
    }
    (!missing.is_empty()).then(|| format!("{name}: {}", missing.join(", ")))
}
