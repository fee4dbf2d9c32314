//! The results of an experiment: its rows, and readable tables of them with the settings to reproduce them.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use crate::reach::Restart;

use super::design::{Design, Question, Setup};
use super::paper::{self, Published, Test, published};
use super::row::{Row, Spread};
use super::{Run, formats};
use crate::tabular::{Cell, Column, Table};

/// An experiment and its results.
#[derive(Clone, Copy)]
pub struct Report<'a> {
    /// The design.
    pub design: &'a Design,
    /// The questions.
    pub questions: &'a [Question<'a>],
    /// The completed runs.
    pub runs: &'a [Run],
}

impl Report<'_> {
    /// The rows, by questions and setups; none for questions that the analysis rules out.
    pub fn rows(&self) -> Vec<Row> {
        let open = self.questions.iter().enumerate().filter(|(_, q)| !q.is_ruled_out);
        open.flat_map(|(question, _)| (0..self.design.setups.len()).map(move |setup| (question, setup)))
            .map(|(question, setup)| Row::of(question, setup, self.runs))
            .collect()
    }

    /// The paper's figures for a row: only for planners as published, without restarts.
    pub fn published(&self, row: &Row) -> Option<Published> {
        let setup = &self.design.setups[row.setup];
        let test = self.questions[row.question].paper.filter(|_| setup.restart == Restart::Never)?;
        published(test, setup.sampling, setup.planner)
    }

    /// The whole result: `version`, `hypedc`, `settings`, `questions`, `runs`, `rows`.
    pub fn json(&self) -> Value {
        formats::json(self)
    }

    /// The schema of [`Report::json`].
    #[cfg(feature = "testing")]
    pub(crate) fn json_schema() -> schemars::Schema {
        formats::json_schema()
    }

    /// A table for each question, and the settings to reproduce it.
    pub fn text(&self) -> String {
        let rows = self.rows();
        let mut out = String::new();
        for (index, question) in self.questions.iter().enumerate() {
            if !question.set.is_empty() {
                // One table for all values, where the first of them is.
                let is_same =
                    |other: &&Question<'_>| (&other.test, other.goal_name()) == (&question.test, question.goal_name());
                if self.questions.iter().position(|other| is_same(&other)) == Some(index) {
                    let same: Vec<usize> =
                        (0..self.questions.len()).filter(|at| is_same(&&self.questions[*at])).collect();
                    out.push_str(&self.sweep(question, &same, &rows));
                }
                continue;
            }
            let mine: Vec<&Row> = rows.iter().filter(|r| r.question == index).collect();
            out.push_str(&title(question));
            out.push_str("\n\n");
            if mine.is_empty() {
                out.push_str("proven unreachable: it holds in no reachable state; nothing was searched\n");
            } else {
                out.push_str(&self.table(&mine, question.paper.is_some()));
                self.footnotes(&mine, &mut out);
            }
            out.push_str(&format!(
                "\nprogram SHA-256 {}\nanalysis of the world: {} s, once, not part of the times\n\n",
                question.program_sha256,
                seconds(question.analysis_seconds)
            ));
        }
        out.push_str(&self.caption());
        out
    }

    /// The table of a question for all values of the swept numbers.
    fn sweep(&self, question: &Question<'_>, same: &[usize], rows: &[Row]) -> String {
        let mine: Vec<&Row> = rows.iter().filter(|row| same.contains(&row.question)).collect();
        let mut out = format!("{}\n\n", title(question));
        if !mine.is_empty() {
            out.push_str(&self.table(&mine, question.paper.is_some()));
            self.footnotes(&mine, &mut out);
        }
        let ruled_out = same.iter().map(|at| &self.questions[*at]).filter(|question| question.is_ruled_out);
        for question in ruled_out {
            out.push_str(&format!("{}: proven unreachable, nothing was searched\n", question.settings().join(", ")));
        }
        let all: f64 = same.iter().map(|at| self.questions[*at].analysis_seconds).sum();
        out.push_str(&format!("\nanalysis of the worlds: {} s, once each, not part of the times\n\n", seconds(all)));
        out
    }

    fn table(&self, rows: &[&Row], is_papers: bool) -> String {
        let metrics: BTreeSet<&str> = self.design.setups.iter().map(|s| s.metric()).collect();
        let swept = rows.first().map_or(&[][..], |row| &self.questions[row.question].set);
        let mut columns: Vec<Column> = swept.iter().map(|(name, _)| Column::right("", name.clone())).collect();
        columns.extend([Column::left("", "bounds"), Column::left("", "planner"), Column::right("", "restarts")]);
        if metrics.len() > 1 {
            columns.push(Column::left("", "metric"));
        }
        columns.extend([
            Column::right("all runs", "nodes"),
            Column::right("nodes at the goal", "mean"),
            Column::right("nodes at the goal", "median"),
            Column::right("seconds at the goal", "mean"),
            Column::right("seconds at the goal", "median"),
            Column::right("", "reached"),
            Column::right("", "extensions/s"),
        ]);
        if is_papers {
            let paper = "the paper";
            columns.push(Column::right(paper, "nodes"));
            columns.push(Column::right(paper, "at goal"));
            columns.push(Column::right(paper, "seconds"));
            columns.push(Column::right(paper, "reached"));
        }
        let mut table = Table::new(columns);
        let (mean, median) = (|s: Spread| s.mean, |s: Spread| s.median);
        for row in rows {
            let setup = &self.design.setups[row.setup];
            let set = self.questions[row.question].set.iter();
            let mut cells: Vec<Cell> = set.map(|(_, value)| Cell::from(value.as_str())).collect();
            cells.extend([setup.bounds().into(), setup.planner.name().into(), setup.restarts().into()]);
            if metrics.len() > 1 {
                cells.push(setup.metric().into());
            }
            let few = if row.runs < self.design.seeds { "*" } else { "" };
            cells.extend([
                Cell::of(row.nodes.map(mean), whole),
                Cell::of(row.goal_nodes.map(mean), whole),
                Cell::of(row.goal_nodes.map(median), whole),
                Cell::of(row.goal_seconds.map(mean), seconds),
                Cell::of(row.goal_seconds.map(median), seconds),
                format!("{}/{}{few}", row.successes, row.runs).into(),
                Cell::of(row.extensions_per_second, whole),
            ]);
            if is_papers {
                match self.published(row) {
                    Some(p) => cells.extend([
                        whole(p.nodes).into(),
                        whole(p.goal_nodes).into(),
                        format!("{:.2}", p.goal_seconds).into(),
                        format!("{}/{}", p.successes, paper::RUNS).into(),
                    ]),
                    None => cells.extend([const { Cell::empty() }; 4]),
                }
            }
            table.push(cells);
        }
        table.text()
    }

    /// Explanations of special values in the rows.
    fn footnotes(&self, rows: &[&Row], out: &mut String) {
        if rows.iter().any(|r| r.runs < self.design.seeds) {
            out.push_str(&format!("* stopped before all of the {} runs were done\n", self.design.seeds));
        }
        let full: u32 = rows.iter().map(|r| r.out_of_memory).sum();
        if full > 0 {
            out.push_str(&format!("{full} of the runs ended early because their memory was full\n"));
        }
    }

    /// The number of steps that inputs are held; stated once if all planners have the same.
    fn holds(&self) -> String {
        let held: BTreeMap<&str, String> = self.design.setups.iter().map(|s| (s.planner.name(), s.held())).collect();
        let different: BTreeSet<&String> = held.values().collect();
        match different.first() {
            Some(only) if different.len() == 1 => (*only).clone(),
            _ => held.iter().map(|(planner, held)| format!("{planner} {held}")).collect::<Vec<_>>().join(", "),
        }
    }

    /// The settings that all tables share.
    fn caption(&self) -> String {
        let Design { setups, seeds, seconds: budget, limits } = self.design;
        let seeds = if *seeds == 1 { "seed 1".to_string() } else { format!("seeds 1 to {seeds}") };
        let nodes = if limits.nodes < u64::MAX { format!(", or {} nodes", limits.nodes) } else { String::new() };
        let mut out = format!(
            "hypedc {}; {seeds}; at most {budget} s of CPU time a run{nodes}; a run is one thread and ends at the goal.\n",
            env!("CARGO_PKG_VERSION")
        );
        let metrics: BTreeSet<&str> = setups.iter().map(Setup::metric).collect();
        let metrics = metrics.into_iter().collect::<Vec<_>>().join(", ");
        out.push_str(&format!("Distance: {metrics}. Steps for which inputs are held: {}.\n", self.holds()));
        out.push_str(
            "restarts: `never` is the planner as it was published, one tree; else the nodes of the shortest tree before a \
             restart.\nall runs: mean; at the goal: of the runs that reached it.\n",
        );
        if self.questions.iter().any(|q| q.paper.is_some()) {
            out.push_str(&format!(
                "The paper: Osborn, Lambrigger and Mateas, HyPED, AIIDE 2017, Tables 1 and 2; means of {} runs. Its budget was \
                 {} s a run,\nits times are wall-clock times of a system in Python on another machine.\n",
                paper::RUNS,
                paper::SECONDS
            ));
        }
        if self.questions.iter().any(|q| q.paper == Some(Test::Two)) {
            out.push_str(
                "Goals of Test 2: `drawn` is the tile on the upper left, as in the paper's Figure 3; `configured` is where the \
                 paper's code\nhas it, which a jump on the spot reaches.\n",
            );
        }
        out
    }
}

fn title(question: &Question<'_>) -> String {
    let goal = question.goal_name();
    match question.paper {
        Some(test) => format!("Test {} of the paper (its Table {}), goal {goal}", test.number(), test.number()),
        None => format!("{}, goal {goal}", question.test),
    }
}

fn whole(x: f64) -> String {
    format!("{x:.0}")
}

/// Seconds; small values with a resolution of 0.1 ms.
fn seconds(x: f64) -> String {
    if x < 1.0 { format!("{x:.4}") } else { format!("{x:.2}") }
}
