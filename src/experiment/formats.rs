//! Runs as CSV (RFC 4180) and all of an experiment as JSON.

use serde::Serialize;
use serde_json::{Value, json};

use super::design::{Design, Question, Setup};
use super::paper::Published;
use super::report::Report;
use super::row::Spread;
use super::{Run, paper};
use crate::tabular::csv::line;

/// The version of the JSON result.
const RESULT_VERSION: u32 = 1;

/// The columns of the CSV, one line a run.
///
/// | column | holds |
/// |---|---|
/// | `test` | `test1` or `test2` of the paper, or a file and its world |
/// | `goal` | the goal's name |
/// | `planner` | who searched |
/// | `restarts` | nodes of the shortest tree before a restart, or `never`; `own` for `auto`, whose planners differ |
/// | `bounds` | `naive` or `reduced` |
/// | `metric` | `full` or `xy` |
/// | `hold` | steps that an input is held, `10` or `4..60`; `own` for `auto`, whose planners differ |
/// | `seed` | of the generator |
/// | `verdict` | `reached`, `not-found`, `out-of-memory`, `proven-unreachable` |
/// | `nodes`, `trees`, `extensions`, `steps` | over the whole run; steps simulated |
/// | `seconds` | CPU time of the search |
/// | `path_steps` | steps of the way to the goal; empty if there is none |
/// | `program_sha256` | of what the program means |
/// | `version` | of `hypedc` |
pub const CSV_HEADER: [&str; 17] = [
    "test",
    "goal",
    "planner",
    "restarts",
    "bounds",
    "metric",
    "hold",
    "seed",
    "verdict",
    "nodes",
    "trees",
    "extensions",
    "steps",
    "seconds",
    "path_steps",
    "program_sha256",
    "version",
];

/// A run as a line of CSV under [`CSV_HEADER`], without the line's end.
pub fn csv_line(design: &Design, questions: &[Question<'_>], run: &Run) -> String {
    let (question, setup) = (&questions[run.question], &design.setups[run.setup]);
    let cells: [String; CSV_HEADER.len()] = [
        question.test.clone(),
        question.goal_name().to_string(),
        setup.planner.name().to_string(),
        setup.restarts(),
        setup.bounds().to_string(),
        setup.metric().to_string(),
        setup.held(),
        run.seed.to_string(),
        run.finding.name().to_string(),
        run.nodes.to_string(),
        run.trees.to_string(),
        run.extensions.to_string(),
        run.steps.to_string(),
        format!("{:.6}", run.seconds),
        run.path_steps.map_or(String::new(), |steps| steps.to_string()),
        question.program_sha256.clone(),
        env!("CARGO_PKG_VERSION").to_string(),
    ];
    line(cells)
}

/// What runs and rows say of themselves.
#[derive(Serialize)]
struct Named<'a, T> {
    test: &'a str,
    goal: &'a str,
    planner: &'static str,
    restarts: String,
    bounds: &'static str,
    metric: &'static str,
    hold: String,
    #[serde(flatten)]
    rest: T,
}

impl<'a, T> Named<'a, T> {
    fn new(question: &'a Question<'_>, setup: &Setup, rest: T) -> Self {
        Named {
            test: &question.test,
            goal: question.goal_name(),
            planner: setup.planner.name(),
            restarts: setup.restarts(),
            bounds: setup.bounds(),
            metric: setup.metric(),
            hold: setup.held(),
            rest,
        }
    }
}

#[derive(Serialize)]
struct RunPart {
    seed: u64,
    verdict: &'static str,
    nodes: u64,
    trees: u64,
    extensions: u64,
    steps: u64,
    seconds: f64,
    path_steps: Option<u64>,
}

#[derive(Serialize)]
struct RowPart {
    runs: u32,
    successes: u32,
    /// Wilson's interval.
    success_rate_95: Option<[f64; 2]>,
    out_of_memory: u32,
    nodes: Option<Spread>,
    goal_nodes: Option<Spread>,
    goal_seconds: Option<Spread>,
    path_steps: Option<Spread>,
    extensions_per_second: Option<f64>,
    /// What the paper has for the planner as it was published.
    paper: Option<Published>,
}

/// All of an experiment.
pub(super) fn json(report: &Report<'_>) -> Value {
    let Report { design, questions, runs } = *report;
    let about = questions.iter().map(|q| {
        json!({
            "test": q.test,
            "goal": q.goal_name(),
            "program_sha256": q.program_sha256,
            "analysis_seconds": q.analysis_seconds,
            "is_ruled_out": q.is_ruled_out,
        })
    });
    let run = |r: &Run| {
        let part = RunPart {
            seed: r.seed,
            verdict: r.finding.name(),
            nodes: r.nodes,
            trees: r.trees,
            extensions: r.extensions,
            steps: r.steps,
            seconds: r.seconds,
            path_steps: r.path_steps,
        };
        json!(Named::new(&questions[r.question], &design.setups[r.setup], part))
    };
    let row = |r: &super::Row| {
        let part = RowPart {
            runs: r.runs,
            successes: r.successes,
            success_rate_95: r.success_rate_95(),
            out_of_memory: r.out_of_memory,
            nodes: r.nodes,
            goal_nodes: r.goal_nodes,
            goal_seconds: r.goal_seconds,
            path_steps: r.path_steps,
            extensions_per_second: r.extensions_per_second,
            paper: report.published(r),
        };
        json!(Named::new(&questions[r.question], &design.setups[r.setup], part))
    };
    json!({
        "version": RESULT_VERSION,
        "hypedc": env!("CARGO_PKG_VERSION"),
        "settings": {
            "seeds": design.seeds,
            "seconds": design.seconds,
            // Without a limit there is none.
            "nodes": (design.limits.nodes < u64::MAX).then_some(design.limits.nodes),
            "memory": design.limits.memory,
            "paper": questions.iter().any(|q| q.paper.is_some()).then(|| json!({
                "seconds": paper::SECONDS,
                "runs": paper::RUNS,
            })),
        },
        "questions": about.collect::<Vec<_>>(),
        "runs": runs.iter().map(run).collect::<Vec<_>>(),
        "rows": report.rows().iter().map(row).collect::<Vec<_>>(),
    })
}
