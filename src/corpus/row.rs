//! A row: what came of one question about one level, with all that it depends on. What depends on the machine alone
//! stands apart, in [`Timing`].

use serde::{Deserialize, Serialize};

use crate::reach::Conclusion;

/// The version of the rows.
pub const ROW_VERSION: u32 = 3;

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// A way to a goal.
    Goal,
    /// A way to break a `never`.
    Never,
}

impl Kind {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Goal => "goal",
            Kind::Never => "never",
        }
    }
}

/// The answer about a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "&'static str", try_from = "String")]
pub enum Verdict {
    /// What came of the question.
    Of(Conclusion),
    /// The question could not be asked about this level.
    Error,
}

impl Verdict {
    /// All of them, best first where a goal is asked for.
    pub fn all() -> impl Iterator<Item = Verdict> {
        Conclusion::ALL.into_iter().map(Verdict::Of).chain([Verdict::Error])
    }

    /// As it is written in rows.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Of(conclusion) => conclusion.name(),
            Verdict::Error => "error",
        }
    }

    /// As people read it.
    pub fn words(self) -> &'static str {
        match self {
            Verdict::Of(conclusion) => conclusion.words(),
            Verdict::Error => "error",
        }
    }
}

impl From<Verdict> for &'static str {
    fn from(verdict: Verdict) -> &'static str {
        verdict.name()
    }
}

impl TryFrom<String> for Verdict {
    type Error = String;

    fn try_from(name: String) -> Result<Verdict, String> {
        Verdict::all().find(|verdict| verdict.name() == name).ok_or_else(|| format!("`{name}` is no verdict"))
    }
}

/// All that a search depends on beside the program and the level. With the same settings, the same program and the same
/// level a row is the same, but for its timing; with a limit of seconds it depends on the machine, too.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// The version of `hypedc`.
    pub hypedc: String,
    /// The seed.
    pub seed: u64,
    /// Who searches.
    pub planner: String,
    /// Where samples are drawn from.
    pub bounds: String,
    /// What distances are measured in.
    pub metric: String,
    /// For how many steps inputs are held; none: as the planner does by itself.
    pub hold: Option<(u16, u16)>,
    /// A number of nodes, `never`, or none: as the planner does by itself.
    pub restart: Option<String>,
    /// How many trees grow side by side.
    pub trees: usize,
    /// The legend that levels are read with, if it is not the program's.
    pub legend: Option<String>,
    /// Width and height of their tiles, px, if they are not the program's.
    pub tile: Option<(f64, f64)>,
    /// What may never hold.
    pub without: Option<String>,
    /// How long it may take, as it was asked for.
    #[serde(default)]
    pub within: Option<String>,
    /// Where the search begins.
    pub after: Vec<String>,
    /// For how many steps an input is held at least, as it was asked for.
    pub min_hold: Option<String>,
    /// Whether paths are shortened.
    pub minimize: bool,
    /// The most nodes; none: as many as come.
    pub nodes_limit: Option<u64>,
    /// The most seconds.
    pub seconds_limit: Option<f64>,
    /// The most memory, bytes.
    pub memory_limit: u64,
}

/// How much a search covered.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// The side of a place, px.
    pub place: f64,
    /// Places.
    pub places: u64,
    /// Combinations of modes.
    pub mode_combinations: u64,
    /// Both together.
    pub places_with_modes: u64,
}

/// Inputs that change only every so many steps, all of which were tried. It says nothing of others.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Exhausted {
    /// For how many steps they are held.
    pub hold: u16,
    /// To how many states they lead.
    pub states: u64,
}

/// A `never` that was broken on the way.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Broken {
    /// Its name.
    pub never: String,
    /// After how many steps.
    pub steps: u64,
    /// By which inputs.
    pub inputs: String,
}

/// What depends on the machine.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Timing {
    /// Seconds on the clock that the search took.
    pub seconds: f64,
    /// Seconds of processor time; none if the system does not tell.
    pub cpu_seconds: Option<f64>,
    /// Seconds on the clock for what the level's world can be, once for all its goals.
    pub analysis_seconds: f64,
}

/// What tells the questions of a run apart.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct Key {
    /// The path of the level as it was given; none for a program that has its maps in it.
    pub level: Option<String>,
    /// What is asked for.
    pub kind: Kind,
    /// Its name.
    pub goal: String,
}

impl Key {
    /// The level's path, or a word for there being none.
    pub fn level_name(&self) -> &str {
        self.level.as_deref().unwrap_or("(own map)")
    }
}

/// What came of one question about one level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// [`ROW_VERSION`].
    pub row: u32,
    /// The path of the level as it was given; none for a program that has its maps in it.
    pub level: Option<String>,
    /// What is asked for.
    pub kind: Kind,
    /// Its name.
    pub goal: String,
    /// The path of the program as it was given.
    pub file: String,
    /// The world.
    pub world: String,
    /// Of the level's bytes, in hexadecimal digits; none if there is no level, or it cannot be read.
    pub level_sha256: Option<String>,
    /// Of the flat program with this level; none if it does not compile.
    pub program_sha256: Option<String>,
    /// What else it depends on.
    pub settings: Settings,
    /// The answer.
    pub verdict: Verdict,
    /// Whether that is as wished: a goal reached, a `never` proven.
    pub is_expected: bool,
    /// Why there is no answer: what is wrong with the program, the level or where the search begins.
    pub error: Option<String>,
    /// Why it is proven unreachable.
    pub argument: Option<String>,
    /// If all states were visited: how many there are.
    pub states: Option<u64>,
    /// If it takes more steps than it may: how many at least.
    pub least_steps: Option<u64>,
    /// The steps of the path; none if there is none.
    pub steps: Option<u64>,
    /// Whether no inputs that the question admits, with axes at -1, 0 and 1, take fewer steps; none if there is no path.
    pub is_shortest: Option<bool>,
    /// Whether axes between -1, 0 and 1, which no search tries, can make a difference.
    pub reads_between: bool,
    /// The path, as a script.
    pub inputs: Option<String>,
    /// Which planner had the answer; `analysis` if nothing was searched.
    pub answered_by: Option<String>,
    /// Nodes over all trees.
    pub nodes: u64,
    /// Trees begun.
    pub trees: u64,
    /// Extensions simulated.
    pub extensions: u64,
    /// Extensions that led nowhere.
    pub failures: u64,
    /// Steps simulated.
    pub simulated_steps: u64,
    /// What was covered.
    pub coverage: Coverage,
    /// Where nothing was found: inputs that change only every so many steps and were all tried.
    pub exhausted: Option<Exhausted>,
    /// Each `never` that was broken on the way.
    pub violations: Vec<Broken>,
    /// Whether the limit of seconds ended the search.
    pub stopped: bool,
    /// Whether the limit of memory ended the search.
    pub out_of_memory: bool,
    /// Whether some combinations of buttons were left out.
    pub inputs_left_out: bool,
    /// The first run-time error met: a mistake of the program that the search went around.
    pub fault: Option<String>,
    /// How the search, or that for another goal of the level, has shown that the analysis is wrong about the level: a mistake
    /// of `hypedc`. None if none has.
    #[serde(default)]
    pub refuted: Option<String>,
    /// What depends on the machine.
    pub timing: Timing,
}

impl Row {
    /// A row of a question that could not be asked.
    pub fn of_error(key: Key, file: String, world: String, settings: Settings, error: String) -> Row {
        Row {
            row: ROW_VERSION,
            level: key.level,
            kind: key.kind,
            goal: key.goal,
            file,
            world,
            level_sha256: None,
            program_sha256: None,
            settings,
            verdict: Verdict::Error,
            is_expected: false,
            error: Some(error),
            argument: None,
            states: None,
            least_steps: None,
            steps: None,
            is_shortest: None,
            reads_between: false,
            inputs: None,
            answered_by: None,
            nodes: 0,
            trees: 0,
            extensions: 0,
            failures: 0,
            simulated_steps: 0,
            coverage: Coverage::default(),
            exhausted: None,
            violations: Vec::new(),
            stopped: false,
            out_of_memory: false,
            inputs_left_out: false,
            fault: None,
            refuted: None,
            timing: Timing::default(),
        }
    }

    /// Which question it answers.
    pub fn key(&self) -> Key {
        Key { level: self.level.clone(), kind: self.kind, goal: self.goal.clone() }
    }

    /// Why it is not as wished, in one line.
    pub fn reason(&self) -> String {
        match (self.verdict, &self.error, &self.argument) {
            (Verdict::Error, Some(error), _) => error.lines().next().unwrap_or_default().to_string(),
            (Verdict::Of(Conclusion::ProvenUnreachable | Conclusion::Exhausted), _, Some(argument)) => argument.clone(),
            _ if self.refuted.is_some() => self.refuted.clone().unwrap_or_default(),
            (Verdict::Of(conclusion), ..) if conclusion.is_open() => match (self.stopped, self.out_of_memory) {
                (true, _) => "the time is spent".to_string(),
                (false, true) => "the memory is full".to_string(),
                (false, false) => format!("not among {} nodes", self.nodes),
            },
            (Verdict::Of(Conclusion::Violated), ..) => "there is a way to break it".to_string(),
            _ => String::new(),
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A row of a level that was reached.
    pub fn row(level: &str) -> Row {
        let settings = Settings {
            hypedc: "1.2.3".into(),
            seed: 1,
            planner: "auto".into(),
            bounds: "reduced".into(),
            metric: "full".into(),
            hold: None,
            restart: None,
            trees: 1,
            legend: None,
            tile: None,
            without: None,
            within: None,
            after: Vec::new(),
            min_hold: None,
            minimize: false,
            nodes_limit: Some(200_000),
            seconds_limit: None,
            memory_limit: 1 << 31,
        };
        let key = Key { level: Some(level.to_string()), kind: Kind::Goal, goal: "out".into() };
        Row {
            level_sha256: Some("4f".into()),
            program_sha256: Some("a0".into()),
            verdict: Verdict::Of(Conclusion::Reached),
            is_expected: true,
            error: None,
            steps: Some(120),
            inputs: Some("right*120".into()),
            answered_by: Some("coverage".into()),
            nodes: 31,
            coverage: Coverage { place: 16.0, places: 12, mode_combinations: 2, places_with_modes: 15 },
            timing: Timing { seconds: 0.25, cpu_seconds: Some(0.125), analysis_seconds: 0.5 },
            ..Row::of_error(key, "game.hyped".into(), "Open".into(), settings, String::new())
        }
    }

    #[test]
    fn a_row_is_read_as_it_was_written() {
        let error = Row { error: Some("cannot read".into()), verdict: Verdict::Error, ..row("levels/\"odd\", ü.txt") };
        for row in [row("a"), error] {
            let text = serde_json::to_string(&row).unwrap();
            assert_eq!(serde_json::from_str::<Row>(&text).unwrap(), row);
        }
    }

    #[test]
    fn verdicts_are_written_as_they_are_called() {
        for verdict in Verdict::all() {
            let written = serde_json::to_value(verdict).unwrap();
            assert_eq!(written, verdict.name());
            assert_eq!(serde_json::from_value::<Verdict>(written).unwrap(), verdict);
        }
        assert!(serde_json::from_value::<Verdict>("not found".into()).is_err());
    }
}
