//! The run of `hypedc sim` as a page.

use std::io;
use std::path::Path;

use crate::ask::RunOutcome;
use crate::diagnostic::render;
use crate::diagnostic::{Diagnostics, Severity};
use crate::sim::{Script, Simulator};
use crate::source::SourceMap;
use crate::watch::Watch;

use crate::cli::page::{Moment, Report, Tone, Way, Witness};
use crate::cli::play::export::Carried;

/// What was said about a run, and its picture.
pub(super) struct Said<'s> {
    pub text: &'s str,
    pub unmet: &'s [String],
    pub findings: (&'s SourceMap, &'s Diagnostics),
    pub outcome: &'s RunOutcome<'s>,
    pub picture: String,
}

/// Writes the page of a run of some steps.
///
/// # Errors
/// A message if it cannot be written.
pub(super) fn save(
    (carried, target): (&Carried, &Path),
    sim: &Simulator,
    run: (&Script, Option<u64>),
    said: Said<'_>,
    watch: &dyn Watch,
) -> io::Result<Result<(), String>> {
    let mut lines = said.text.lines().map(|line| line.trim().to_string());
    let title = lines.next().unwrap_or_default();
    let verdict = title.rsplit_once(": ").map_or(title.as_str(), |(_, steps)| steps).to_string();
    let tone = if said.outcome.is_good { Tone::Good } else { Tone::Bad };
    let mut way = Way::new("run", "run".to_string(), verdict, tone);
    way.lines = lines.collect();
    way.moments = said
        .outcome
        .marks
        .iter()
        .map(|mark| match mark.is_never {
            true => Moment { frame: mark.step, text: format!("never {}", mark.name), tone: Tone::Bad },
            false => Moment { frame: mark.step, text: format!("goal {}", mark.name), tone: Tone::Good },
        })
        .collect();
    way.witness = Witness::run(sim, run, said.outcome.steps, watch)?;
    way.picture = Some(said.picture);
    let mut report = Report::new("sim", title, sim);
    report.notes = said.unmet.to_vec();
    let (sources, findings) = said.findings;
    let worth = findings.iter().filter(|found| matches!(found.severity, Severity::Error | Severity::Warning));
    report.notes.extend(render::short(sources, worth).lines().map(str::to_string));
    report.ways.push(way);
    Ok(carried.save(target, Some(&sim.world().name), &report))
}
