//! Comparison with the rows of an older run: changed verdicts, added and removed questions, longer or shorter paths.

use std::collections::BTreeMap;
use std::fmt::Write;

use serde::Serialize;

use crate::reach::{Conclusion, Shift};

use super::row::{Key, Row};

/// A verdict that is another one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Flip {
    /// What it is about.
    #[serde(flatten)]
    pub key: Key,
    /// What it was.
    pub from: Conclusion,
    /// What it is.
    pub to: Conclusion,
    /// What that means.
    pub change: Shift,
}

/// A path whose length is another one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct LengthChange {
    /// What it is about.
    #[serde(flatten)]
    pub key: Key,
    /// How many steps it took.
    pub from: u64,
    /// How many it takes.
    pub to: u64,
}

/// A question that only one of the two runs asked.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Unpaired {
    /// What it is about.
    #[serde(flatten)]
    pub key: Key,
    /// What it came to.
    pub verdict: Conclusion,
    /// Whether that is the expected verdict.
    pub is_expected: bool,
}

impl Unpaired {
    fn of(row: &Row) -> Unpaired {
        Unpaired { key: row.key(), verdict: row.answer.verdict, is_expected: row.answer.is_expected }
    }
}

/// What changed since an older run.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Comparison {
    /// Verdicts that are others, in the order of the new rows.
    pub flips: Vec<Flip>,
    /// What the older run did not ask.
    pub added: Vec<Unpaired>,
    /// What was not asked any more, by name.
    pub vanished: Vec<Unpaired>,
    /// Paths that differ by more than the tolerance.
    pub lengths: Vec<LengthChange>,
    /// How many have the same verdict.
    pub unchanged: usize,
}

impl Comparison {
    /// Compares two runs; lengths are listed if they differ by more than this share of the older one (0.1 is a tenth).
    pub fn of<'r>(
        old: impl IntoIterator<Item = &'r Row>,
        new: impl IntoIterator<Item = &'r Row>,
        tolerance: f64,
    ) -> Comparison {
        let mut old: BTreeMap<Key, &Row> = old.into_iter().map(|row| (row.key(), row)).collect();
        let mut found = Comparison::default();
        for row in new {
            let (key, now) = (row.key(), &row.answer);
            let Some(before) = old.remove(&key).map(|row| &row.answer) else {
                found.added.push(Unpaired::of(row));
                continue;
            };
            if before.verdict == now.verdict {
                found.unchanged += 1;
            } else {
                let change = Shift::of(key.kind, before.verdict, now.verdict);
                found.flips.push(Flip { key: key.clone(), from: before.verdict, to: now.verdict, change });
            }
            if let (Some(from), Some(to)) = (before.steps, now.steps)
                && from.abs_diff(to) as f64 > tolerance * from as f64
            {
                found.lengths.push(LengthChange { key, from, to });
            }
        }
        found.vanished = old.into_values().map(Unpaired::of).collect();
        found
    }

    /// Whether something is not as it should be, and was: an expected verdict is worse or not found any more, a `never`
    /// is violated, or a new question has an unexpected verdict.
    pub fn is_failure(&self) -> bool {
        let fails = |flip: &Flip| matches!(flip.change, Shift::Worse | Shift::Lost) || flip.to == Conclusion::Violated;
        self.flips.iter().any(fails) || self.added.iter().any(|lone| !lone.is_expected)
    }

    /// As text, a line each.
    pub fn text(&self, baseline: &str) -> String {
        let mut out = String::new();
        let mut line = |mark: &str, key: &Key, what: String| {
            // Infallible: writes to a string.
            let _ = writeln!(out, "  {mark:7} {}: {what}", key.text());
        };
        for Flip { key, from, to, change } in &self.flips {
            let more = match change {
                Shift::Lost if *to == Conclusion::NotFound => " any more, not known to be worse",
                Shift::Lost => ", not known to be worse",
                Shift::Found => ", which may have been so before",
                Shift::Worse | Shift::Other | Shift::Better | Shift::Same => "",
            };
            line(change.name(), key, format!("{} → {}{more}", from.words(), to.words()));
        }
        for Unpaired { key, verdict, .. } in &self.added {
            line("new", key, verdict.words().to_string());
        }
        for Unpaired { key, verdict, .. } in &self.vanished {
            line("gone", key, format!("was {}", verdict.words()));
        }
        for LengthChange { key, from, to } in &self.lengths {
            let mark = if to > from { "longer" } else { "shorter" };
            let share = (*to as f64 / (*from).max(1) as f64 - 1.0) * 100.0;
            line(mark, key, format!("{from} → {to} steps ({share:+.0} %)"));
        }
        format!("since {baseline}: {} as before\n{out}", self.unchanged)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corpus::row::tests::row;
    use crate::reach::query::{Answer, Kind};

    fn with(level: &str, verdict: Conclusion, steps: Option<u64>) -> Row {
        let row = row(level);
        let answer = Answer { verdict, is_expected: verdict == Conclusion::Reached, steps, ..row.answer };
        Row { answer, ..row }
    }

    #[test]
    fn flips_have_a_direction() {
        use Conclusion::{Error, NotAnswered, NotFound, ProvenUnreachable, Reached, Violated};
        let old = [with("a", Reached, Some(100)), with("b", NotFound, None), with("c", NotFound, None)];
        let new = [with("a", NotFound, None), with("b", Reached, Some(9)), with("c", ProvenUnreachable, None)];
        let found = Comparison::of(&old, &new, 0.1);
        let changes: Vec<Shift> = found.flips.iter().map(|f| f.change).collect();
        assert_eq!(changes, [Shift::Lost, Shift::Found, Shift::Other]);
        assert!(found.is_failure() && found.unchanged == 0);
        assert_eq!(
            found.text("old.jsonl"),
            "since old.jsonl: 0 as before\n  \
             lost    a, goal out: reached → not found any more, not known to be worse\n  \
             found   b, goal out: not found → reached, which may have been so before\n  \
             other   c, goal out: not found → proven unreachable\n"
        );
        assert!(!Comparison::of(&old[1..], &new[1..], 0.1).is_failure());
        let found = Comparison::of(&[with("a", Reached, None)], &[with("a", Error, None)], 0.1);
        assert!(found.is_failure() && found.flips[0].change == Shift::Worse);
        // A path to a `never` predicate is no improvement.
        let never = |verdict: Conclusion| {
            let row = row("a");
            let is_expected = verdict == ProvenUnreachable;
            Row { answer: Answer { kind: Kind::Never, verdict, is_expected, ..row.answer }, ..row }
        };
        let found = Comparison::of(&[never(ProvenUnreachable)], &[never(Violated)], 0.1);
        assert!(found.is_failure() && found.flips[0].change == Shift::Worse);
        let found = Comparison::of(&[never(NotAnswered)], &[never(Violated)], 0.1);
        assert!(found.is_failure() && found.flips[0].change == Shift::Other, "it may have been violated before");
    }

    #[test]
    fn what_came_and_went_is_told() {
        let (old, new) = ([row("a"), row("gone")], [row("a"), with("new", Conclusion::NotFound, None)]);
        let found = Comparison::of(&old, &new, 0.1);
        assert_eq!((found.unchanged, found.added.len(), found.vanished.len()), (1, 1, 1));
        assert!(found.is_failure(), "what is new and fails is a failure");
        assert!(!Comparison::of(&old, &[row("a"), row("new")], 0.1).is_failure());
        assert_eq!(
            found.text("old.jsonl"),
            "since old.jsonl: 1 as before\n  new     new, goal out: not found\n  gone    gone, goal out: was reached\n"
        );
    }

    #[test]
    fn lengths_are_compared_by_share() {
        let long = |steps| [with("a", Conclusion::Reached, Some(steps))];
        let is_listed = |from, to| !Comparison::of(&long(from), &long(to), 0.1).lengths.is_empty();
        assert!(!is_listed(100, 110) && is_listed(100, 111) && !is_listed(100, 90) && is_listed(100, 89));
        assert!(is_listed(0, 1) && !is_listed(0, 0));
        let text = Comparison::of(&long(100), &long(150), 0.1).text("o");
        assert_eq!(text, "since o: 1 as before\n  longer  a, goal out: 100 → 150 steps (+50 %)\n");
    }
}
