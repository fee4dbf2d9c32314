//! The answers of `hypedc reach` as a page.

use std::io;

use crate::ask::{nearest, nodes, plan, search_svg};
use crate::reach::Conclusion;
use crate::reach::query::{Answer, Found, Kind, Session, unpressed_words};
use crate::sim::{Script, Simulator};
use crate::view::{Images, cells};
use crate::watch::Watch;

use super::files::Saved;
use super::result::RunResult;
use super::text::{Detail, Shown, answer_text, with_luck};
use crate::cli::page::{Moment, Report, Tone, Way, Witness};

/// An answer as a way that the page shows. `seconds` is the duration of the search.
pub(super) fn way(
    session: &Session,
    found: &Found<'_>,
    answer: &Answer,
    (images, seconds): (&Images, f64),
    watch: &dyn Watch,
) -> io::Result<Way> {
    // The page has the inputs in a field of their own.
    let printed = Answer { inputs: None, ..answer.clone() };
    let has_rooms = session.simulator().world().spaces.len() > 1;
    let (query, saved) = (session.query(), &Saved::default());
    let step = session.simulator().world().step.seconds();
    let sim = session.simulator();
    let unpressed = unpressed_words(sim.program(), sim.world(), &query.unpressed);
    let shown = Shown { query, unpressed, saved, seconds, step, has_rooms, detail: Detail::Full, is_verbose: false };
    let text = answer_text(&printed, &shown);
    let mut lines = text.lines().map(|line| line.trim().to_string());
    let first = lines.next().unwrap_or_default();
    let verdict = first.split_once(": ").map_or(first.as_str(), |(_, verdict)| verdict).to_string();
    let mut way = Way::new(answer.kind.name(), answer.goal.clone(), verdict, tone(answer.verdict));
    way.lines = lines.collect();
    let sim = session.simulator();
    if let Some(plan) = plan(found) {
        way.start = plan.after;
        show(&mut way, answer.kind, sim, (&plan.script, session.query().chance), watch)?;
    } else if let (Some(script), Some(why)) = (nearest(found, answer), &answer.why_not) {
        way.witness = Witness::run(sim, (script, session.query().chance), script.len(), watch)?;
        let text = format!("nearest: {}", why.phrase().unwrap_or_default());
        let moment = |witness: &Witness| Moment { frame: witness.steps, text, tone: Tone::Open };
        way.moments.extend(way.witness.as_ref().map(moment));
    }
    way.covered = cells(sim.program(), sim.world_id(), &nodes(found));
    way.picture = Some(search_svg(session, found, answer, images, watch));
    Ok(way)
}

/// The `never`s that a search has violated on its way to something else.
pub(super) fn violations(
    session: &Session,
    found: &Found<'_>,
    answer: &Answer,
    watch: &dyn Watch,
) -> io::Result<Vec<Way>> {
    let sim = session.simulator();
    let mut ways = Vec::new();
    for (id, script) in &found.outcome.violations {
        let name = &sim.world().nevers[*id].name;
        let Some(of) = answer.violations.iter().find(|of| of.never == *name) else { continue };
        let verdict = format!("can be violated{}", with_luck(of.luck.as_ref()));
        let mut way = Way::new(Kind::Never.name(), name.clone(), verdict, Tone::Bad);
        way.lines.push(format!("found on the way to {} {}", answer.kind.name(), answer.goal));
        show(&mut way, Kind::Never, sim, (script, session.query().chance), watch)?;
        ways.push(way);
    }
    Ok(ways)
}

/// Runs the inputs of a way.
fn show(way: &mut Way, kind: Kind, sim: &Simulator, run: (&Script, Option<u64>), watch: &dyn Watch) -> io::Result<()> {
    way.witness = Witness::run(sim, run, run.0.len(), watch)?;
    let (text, tone) = match kind {
        Kind::Goal => ("reached", Tone::Good),
        Kind::Never => ("violated", Tone::Bad),
    };
    let moment = |witness: &Witness| Moment { frame: witness.steps, text: text.to_string(), tone };
    way.moments.extend(way.witness.as_ref().map(moment));
    Ok(())
}

fn tone(verdict: Conclusion) -> Tone {
    match verdict {
        Conclusion::Reached => Tone::Good,
        Conclusion::Violated | Conclusion::Error => Tone::Bad,
        Conclusion::ProvenUnreachable => Tone::Proof,
        Conclusion::Exhausted | Conclusion::NotFound | Conclusion::NotAnswered => Tone::Open,
    }
}

/// The report without its ways.
pub(super) fn report(session: &Session, result: &RunResult) -> Report {
    let head = result.head();
    let mut lines = head.lines().map(|line| line.trim().to_string());
    let title = lines.next().unwrap_or_default();
    let mut report = Report::new("reach", title, session.simulator());
    report.notes = lines.collect();
    if let Some(refuted) = &result.refuted {
        report.notes.extend(refuted.human().lines().map(|line| line.trim().to_string()));
    }
    report
}
