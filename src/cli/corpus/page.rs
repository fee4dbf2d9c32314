//! The table of many levels as a page (`--html`): a row for each question with the picture of its way, its verdict, and what
//! changed since the baseline. One file without scripts; the pictures are drawn from the rows alone, so that the page is the
//! same whether a row was computed or kept.

use std::collections::BTreeMap;
use std::path::Path;

use crate::ask::recorded;
use crate::compile::{Compilation, compile_changed};
use crate::corpus::{Comparison, Flip, Key, LengthChange, Row, Unpaired, summary};
use crate::ir::GoalId;
use crate::reach::{Conclusion, Shift};
use crate::sim::{Simulator, parse_script};
use crate::source::SourceMap;
use crate::view::{Images, Picture, Run, escaped, picture_svg};
use crate::watch::Unwatched;

use super::Presentation;
use crate::cli::disk::Disk;
use crate::cli::pictures::{data_uri, images};
use crate::cli::reach::question::ReachChanges;
use crate::cli::reach::refuted::command_line;
use crate::cli::report::find_world;

/// The look of the page.
const STYLE: &str = "
:root { color-scheme: light dark; --line: #8884; --soft: #888; --good: #1a7f37; --bad: #cf222e; --proof: #8250df; --open: #9a6700 }
@media (prefers-color-scheme: dark) { :root { --good: #3fb950; --bad: #f85149; --proof: #ab7df8; --open: #d29922 } }
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 90rem; padding: 0 1.5rem }
h1 { font-size: 1.3rem; margin: 0 }
.note, td small { color: var(--soft) }
table { border-collapse: collapse; margin-top: 1.2rem; width: 100% }
th { color: var(--soft); font-weight: 500; text-align: left }
th, td { border-top: 1px solid var(--line); padding: .6rem .8rem .6rem 0; vertical-align: top }
td.number { font-variant-numeric: tabular-nums; white-space: nowrap }
td small { display: block; max-width: 22rem; overflow-wrap: anywhere }
td.picture { width: 55% }
td.picture img { display: block; max-height: 42rem; max-width: 100% }
.good { color: var(--good) } .bad { color: var(--bad) } .proof { color: var(--proof) } .open { color: var(--open) }
";

/// A change since the baseline: how it is coloured, and what it says.
type Changes = BTreeMap<Key, Vec<(&'static str, String)>>;

impl Presentation<'_> {
    /// The page.
    pub fn page(&self, world: &str, note: &str) -> String {
        let rows: Vec<&Row> = self.rows.iter().map(|kept| &kept.row).collect();
        let file = self.args.file.display().to_string();
        let (title, said) = (escaped(&format!("{file}, world {world}")), escaped(&summary(&rows)));
        let mut out = format!(
            "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}</title>\n<style>{STYLE}</style>\n\
             <h1>{title}</h1>\n<p>{said}{}</p>\n",
            escaped(note)
        );
        let baseline = self.args.corpus.baseline.as_deref().unwrap_or(Path::new("")).display().to_string();
        if let Some(comparison) = self.comparison {
            let gone = comparison.vanished.len();
            let gone = if gone == 0 { String::new() } else { format!(", {gone} not asked any more") };
            let text = format!("since {baseline}: {} as before{gone}", comparison.unchanged);
            paragraph(&mut out, &text);
        }
        if self.is_stopped {
            paragraph(&mut out, "stopped before all levels were done");
        }
        paragraph(&mut out, &format!("hypedc {}: {}", env!("CARGO_PKG_VERSION"), command_line()));
        let since = if self.comparison.is_some() { "<th>since the baseline" } else { "" };
        out.push_str(&format!("<table>\n<tr><th>level<th>verdict<th>way<th>search{since}<th>\n"));
        let changes = self.comparison.map(changes);
        for row in rows {
            self.row(&mut out, row, changes.as_ref());
        }
        if let Some(comparison) = self.comparison {
            for Unpaired { key, verdict, .. } in &comparison.vanished {
                let name = escaped(&format!("{}, {} {}", key.level_name(), key.kind.name(), key.goal));
                out.push_str(&format!("<tr><td>{name}<td>not asked any more<td><td><td>was {}<td>\n", verdict.words()));
            }
        }
        out.push_str("</table>\n</html>\n");
        out
    }

    fn row(&self, out: &mut String, row: &Row, changes: Option<&Changes>) {
        let answer = &row.answer;
        let key = row.key();
        out.push_str(&format!(
            "<tr><td>{}<small>{} {}</small>",
            escaped(key.level_name()),
            key.kind.name(),
            escaped(&key.goal)
        ));
        let tone = match answer.verdict {
            Conclusion::Reached => "good",
            Conclusion::Violated | Conclusion::Error => "bad",
            Conclusion::ProvenUnreachable | Conclusion::Exhausted => "proof",
            Conclusion::NotFound | Conclusion::NotAnswered => "open",
        };
        let reason = escaped(&row.reason());
        out.push_str(&format!("<td><b class=\"{tone}\">{}</b><small>{reason}</small>", answer.verdict.words()));
        let way = match (answer.steps, answer.seconds_of_play) {
            (Some(steps), Some(seconds)) => format!("{seconds:.1} s<small>{steps} steps</small>"),
            (Some(steps), None) => format!("{steps} steps"),
            (None, _) => String::new(),
        };
        out.push_str(&format!("<td class=\"number\">{way}"));
        out.push_str(&format!("<td class=\"number\">{:.2} s<small>{} nodes</small>", row.timing.seconds, answer.nodes));
        if let Some(changes) = changes {
            out.push_str("<td>");
            for (tone, text) in changes.get(&key).into_iter().flatten() {
                out.push_str(&format!("<span class=\"{tone}\">{}</span> ", escaped(text)));
            }
        }
        out.push_str("<td class=\"picture\">");
        if let Some(picture) = self.picture(row) {
            let data = data_uri("svg+xml", picture.as_bytes());
            let what = escaped(&format!("{}: {}", key.level_name(), answer.verdict.words()));
            out.push_str(&format!("<img loading=\"lazy\" alt=\"{what}\" src=\"{data}\">"));
        }
        out.push('\n');
    }

    /// The level with the way that was found in it; none if the level cannot be read any more.
    fn picture(&self, row: &Row) -> Option<String> {
        let changes = ReachChanges::new(self.args);
        let reading = self.args.reading.of(row.level.as_deref().map(Path::new));
        let Compilation { program, .. } = compile_changed(&self.args.file, reading, &changes.changes(), &Disk);
        let program = program?;
        let id = find_world(&program, &self.args.file, Some(&row.world)).ok()?;
        let sim = Simulator::new(&program, id);
        let run = row.answer.inputs.as_deref().map_or(Run::default(), |inputs| {
            let file = SourceMap::new().add("inputs", inputs);
            let (script, _) = parse_script(&program, id, file, inputs);
            recorded(&sim, (&script, row.settings.chance), &Unwatched)
        });
        let goals: Vec<GoalId> = sim.world().goal_named(&row.answer.goal).into_iter().collect();
        let picture = Picture {
            title: &row.answer.goal,
            result: row.answer.verdict.words(),
            is_good: row.answer.is_expected,
            goals: &goals,
            nodes: &[],
            traps: &[],
            layers: &[],
            run: &run,
            notes: &[],
            // A page is made of what is there: without its picture a thing is shown by its colliders.
            images: &images(&program, &self.args.file).unwrap_or_else(|_| Images::default()),
        };
        Some(picture_svg(&program, id, &picture))
    }
}

/// What changed, by question.
fn changes(comparison: &Comparison) -> Changes {
    let mut found = Changes::new();
    let mut add = |key: &Key, tone, text| found.entry(key.clone()).or_default().push((tone, text));
    for Flip { key, from, change, .. } in &comparison.flips {
        let tone = match change {
            Shift::Worse => "bad",
            Shift::Lost | Shift::Other => "open",
            Shift::Found | Shift::Better | Shift::Same => "good",
        };
        add(key, tone, format!("{}: was {}", change.name(), from.words()));
    }
    for Unpaired { key, .. } in &comparison.added {
        add(key, "note", "new".to_string());
    }
    for LengthChange { key, from, to } in &comparison.lengths {
        let share = (*to as f64 / (*from).max(1) as f64 - 1.0) * 100.0;
        add(key, "note", format!("{from} → {to} steps ({share:+.0} %)"));
    }
    found
}

fn paragraph(out: &mut String, text: &str) {
    out.push_str(&format!("<p class=\"note\">{}</p>\n", escaped(text)));
}
