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
/// | `restarts` | nodes of the shortest tree before a restart, or `never`; `own` for `auto`, `time-guided`, `beam` |
/// | `bounds` | `naive` or `reduced` |
/// | `metric` | `full` or `xy` |
/// | `hold` | steps that an input is held, `10` or `4..60`; `own` for `auto`, `time-guided`, `beam` |
/// | `seed` | of the generator |
/// | `verdict` | `reached`, `not-found`, `out-of-memory`, `proven-unreachable` |
/// | `nodes`, `trees`, `extensions`, `steps` | over the whole run; steps simulated |
/// | `seconds` | CPU time of the search |
/// | `path_steps` | steps of the way to the goal; empty if there is none |
/// | `program_sha256` | of what the program means |
/// | `version` | of `hypedc` |
/// | `set` | the numbers that are swept, `NAME=NUMBER`, separated by blanks |
pub const CSV_HEADER: [&str; 18] = [
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
    "set",
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
        question.settings().join(" "),
    ];
    line(cells)
}

/// All of an experiment.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Experiment<'a> {
    /// The version of this format.
    version: u32,
    /// The version of `hypedc`.
    hypedc: &'static str,
    /// What was to be run.
    settings: SettingsPart,
    /// The questions.
    questions: Vec<QuestionPart<'a>>,
    /// Each run.
    runs: Vec<Named<'a, RunPart>>,
    /// The runs of each question and way to search in sum.
    rows: Vec<Named<'a, RowPart>>,
}

#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct SettingsPart {
    /// The number of seeds, from 1.
    seeds: u32,
    /// The limit of CPU time for a run, s.
    seconds: f64,
    /// The limit of nodes for a run; null without a limit.
    nodes: Option<u64>,
    /// The limit of memory for a run, bytes.
    memory: u64,
    /// How the figures of the 2017 paper were measured; null if no question is the paper's.
    paper: Option<PaperPart>,
}

#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct PaperPart {
    /// The limit of time for a run, s.
    seconds: u32,
    /// Runs of each planner.
    runs: u32,
}

#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct QuestionPart<'a> {
    /// `test1` or `test2` of the paper, or a file and its world.
    test: &'a str,
    /// The numbers that are swept, with their values.
    set: Vec<String>,
    /// The goal's name.
    goal: &'a str,
    /// A hash of what the program means.
    program_sha256: &'a str,
    /// The duration of the analysis, s.
    analysis_seconds: f64,
    /// Whether the goal is proven unreachable, so that nothing was searched.
    is_ruled_out: bool,
}

impl<'a> QuestionPart<'a> {
    fn new(question: &'a Question<'_>) -> Self {
        QuestionPart {
            test: &question.test,
            set: question.settings(),
            goal: question.goal_name(),
            program_sha256: &question.program_sha256,
            analysis_seconds: question.analysis_seconds,
            is_ruled_out: question.is_ruled_out,
        }
    }
}

/// A run or a row, with the question and the way to search.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Named<'a, T> {
    /// `test1` or `test2` of the paper, or a file and its world.
    test: &'a str,
    /// The numbers that are swept, with their values.
    set: Vec<String>,
    /// The goal's name.
    goal: &'a str,
    /// The planner.
    planner: &'static str,
    /// Nodes of the shortest tree before a restart, or `never`; `own` where the planner decides.
    restarts: String,
    /// `naive` or `reduced`.
    bounds: &'static str,
    /// `full` or `xy`.
    metric: &'static str,
    /// Steps that an input is held, `10` or `4..60`; `own` where the planner decides.
    hold: String,
    #[serde(flatten)]
    rest: T,
}

impl<'a, T> Named<'a, T> {
    fn new(question: &'a Question<'_>, setup: &Setup, rest: T) -> Self {
        Named {
            test: &question.test,
            set: question.settings(),
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
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct RunPart {
    /// The seed.
    seed: u64,
    /// `reached`, `not-found`, `out-of-memory` or `proven-unreachable`.
    verdict: &'static str,
    /// Nodes of all trees.
    nodes: u64,
    /// Trees.
    trees: u64,
    /// Simulated extensions.
    extensions: u64,
    /// Simulated steps.
    steps: u64,
    /// CPU time of the search, s.
    seconds: f64,
    /// Steps of the path; null if there is none.
    path_steps: Option<u64>,
}

#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct RowPart {
    /// The number of runs.
    runs: u32,
    /// How many reached the goal.
    successes: u32,
    /// The interval of the success rate at a confidence of 95 % (Wilson).
    success_rate_95: Option<[f64; 2]>,
    /// How many ran out of memory.
    out_of_memory: u32,
    /// Nodes of all runs.
    nodes: Option<Spread>,
    /// Nodes of the runs that reached the goal.
    goal_nodes: Option<Spread>,
    /// CPU time of the runs that reached the goal, s.
    goal_seconds: Option<Spread>,
    /// Steps of the paths.
    path_steps: Option<Spread>,
    /// Extensions per second of CPU time.
    extensions_per_second: Option<f64>,
    /// What the paper has for the planner as it was published.
    paper: Option<Published>,
}

/// The schema of what [`json`] gives.
#[cfg(feature = "testing")]
pub(super) fn json_schema() -> schemars::Schema {
    schemars::schema_for!(Experiment<'_>)
}

/// All of an experiment.
pub(super) fn json(report: &Report<'_>) -> Value {
    let Report { design, questions, runs } = *report;
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
        Named::new(&questions[r.question], &design.setups[r.setup], part)
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
        Named::new(&questions[r.question], &design.setups[r.setup], part)
    };
    let is_paper = questions.iter().any(|q| q.paper.is_some());
    json!(Experiment {
        version: RESULT_VERSION,
        hypedc: env!("CARGO_PKG_VERSION"),
        settings: SettingsPart {
            seeds: design.seeds,
            seconds: design.seconds,
            // Without a limit there is none.
            nodes: (design.limits.nodes < u64::MAX).then_some(design.limits.nodes),
            memory: design.limits.memory,
            paper: is_paper.then_some(PaperPart { seconds: paper::SECONDS, runs: paper::RUNS }),
        },
        questions: questions.iter().map(QuestionPart::new).collect(),
        runs: runs.iter().map(run).collect(),
        rows: report.rows().iter().map(row).collect(),
    })
}
