//! The text before and after the answers of `hypedc reach`.

use std::collections::BTreeSet;

use crate::reach::query::{Counterexample, Kind};

use super::refuted::Refuted;
use super::text::{Detail, counted, with_luck};

pub(in crate::cli) use crate::ask::RunResult;

impl RunResult {
    /// The lines before the answers.
    pub(in crate::cli) fn head(&self) -> String {
        let settings = &self.settings;
        let naive = if settings.bounds == "naive" { ", naive bounds" } else { "" };
        let metric = if settings.metric == "xy" { ", measured by positions" } else { "" };
        let set: String = settings.set.iter().map(|set| format!(", {set}")).collect();
        let without = settings.without.as_ref().map_or(String::new(), |p| format!(", without {p}"));
        let within = settings.within.as_ref().map_or(String::new(), |time| format!(", within {time}"));
        let after = match settings.after.as_slice() {
            [] => String::new(),
            [only] => format!(", after {only}"),
            several => format!(", after {} scripts", several.len()),
        };
        let hold = settings.min_hold.as_ref();
        let hold = hold.map_or(String::new(), |time| format!(", inputs held for at least {time}"));
        let reaction = settings.reaction.as_ref().map_or(String::new(), |time| format!(", reaction {time}"));
        let robust = settings.robust.as_ref().map_or(String::new(), |errors| format!(", timing errors {errors}"));
        let chance = settings.chance.map_or(String::new(), |seed| format!(", chance seed={seed}"));
        let given_up = self.given_up.iter().map(|why| format!("  everything is possible for {why}\n"));
        let given_up: String = given_up.collect();
        format!(
            "{}, world {}, seed {}{set}{naive}{metric}{without}{within}{hold}{reaction}{robust}{chance}{after}\n{given_up}",
            self.file, self.world, settings.seed
        )
    }

    /// The lines after the answers: each `never` that was violated on the way but not asked about, and a refutation.
    pub(in crate::cli) fn tail(&self, detail: Detail) -> String {
        let answers = || self.goals.iter().map(|goal| &goal.answer);
        let mut seen: BTreeSet<&String> = answers().filter(|a| a.kind == Kind::Never).map(|a| &a.goal).collect();
        let mut out = String::new();
        for Counterexample { never, steps, inputs, luck } in answers().flat_map(|answer| &answer.violations) {
            if seen.insert(never) {
                let steps = counted(*steps, "step");
                let luck = with_luck(luck.as_ref());
                out.push_str(&format!("  never {never}: can be violated{luck}, counterexample: {steps}\n"));
                if detail != Detail::Quiet {
                    out.push_str(&format!("    inputs  {}\n", detail.script(inputs)));
                }
            }
        }
        out.extend(self.refuted.as_ref().map(Refuted::human));
        out
    }
}
