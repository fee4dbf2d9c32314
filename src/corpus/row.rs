//! A row: what came of one question about one level, with all that it depends on. What depends on the machine alone
//! is apart, in [`Timing`].

use serde::{Deserialize, Serialize};

use crate::reach::query::{Answer, Kind};
use crate::reach::why_not::WhyNot;
use crate::reach::{self, Conclusion, End, Limits, Restart};

/// The version of the rows.
pub const ROW_VERSION: u32 = 4;

/// All that a search depends on beside the program and the level. With the same settings, the same program and the same
/// level a row is the same, but for its timing; with a limit of seconds it depends on the machine, too.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
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
    /// The numbers of the program that were set, such as `Hero.jump_speed=310`; left out if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<String>,
    /// What may never hold.
    pub without: Option<String>,
    /// How long it may take, as it was asked for.
    #[serde(default)]
    pub within: Option<String>,
    /// Where the search begins.
    pub after: Vec<String>,
    /// For how many steps an input is held at least, as it was asked for.
    pub min_hold: Option<String>,
    /// The timing errors that paths should withstand, as they were asked for; left out if they were not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robust: Option<String>,
    /// The reaction time of a player, as it was asked for; left out if it was not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reaction: Option<String>,
    /// The seed of what nature draws; left out if the search is free to choose it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chance: Option<u64>,
    /// Whether paths are made better.
    pub minimize: bool,
    /// In which style, if not for the fastest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub style: Option<String>,
    /// Maximum number of nodes; none: no limit.
    pub nodes_limit: Option<u64>,
    /// Maximum time, s.
    pub seconds_limit: Option<f64>,
    /// Maximum memory, bytes.
    pub memory_limit: u64,
}

impl Settings {
    /// What a search has of its own; all that was asked beside it is left out.
    pub fn of(settings: &reach::Settings, limits: &Limits) -> Settings {
        Settings {
            hypedc: env!("CARGO_PKG_VERSION").to_string(),
            seed: settings.seed,
            planner: settings.planner.name().to_string(),
            bounds: settings.sampling.name().to_string(),
            metric: settings.measure.name().to_string(),
            hold: settings.hold,
            restart: match settings.restart {
                Restart::ByPlanner => None,
                Restart::After(nodes) => Some(nodes.to_string()),
                Restart::Never => Some("never".to_string()),
            },
            trees: settings.trees,
            legend: None,
            tile: None,
            set: Vec::new(),
            without: None,
            within: None,
            after: Vec::new(),
            min_hold: None,
            robust: None,
            reaction: None,
            chance: None,
            minimize: false,
            style: None,
            nodes_limit: Some(limits.nodes),
            seconds_limit: None,
            memory_limit: limits.memory,
        }
    }
}

/// What depends on the machine.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Timing {
    /// Seconds on the clock that the search took.
    pub seconds: f64,
    /// Seconds of processor time; none if the system does not tell.
    pub cpu_seconds: Option<f64>,
    /// Seconds on the clock for what the level's world can be, once for all its goals.
    pub analysis_seconds: f64,
}

/// What tells the questions of a run apart.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
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

    /// For people: `levels/a.txt, goal out`.
    pub fn text(&self) -> String {
        format!("{}, {} {}", self.level_name(), self.kind.name(), self.goal)
    }

    /// What is asked, of whatever level.
    pub fn question(&self) -> (Kind, &str) {
        (self.kind, &self.goal)
    }
}

/// What came of one question about one level: its answer, with all that it depends on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Row {
    /// [`ROW_VERSION`].
    pub row: u32,
    /// The path of the level as it was given; null for a program that has its maps in it.
    pub level: Option<String>,
    /// The answer.
    #[serde(flatten)]
    pub answer: Answer,
    /// Why there is no answer: what is wrong with the program, the level or where the search begins.
    pub error: Option<String>,
    /// The first run-time error met: a mistake of the program that the search went around.
    pub fault: Option<String>,
    /// How a search has shown that the analysis is wrong about the level, a mistake of `hypedc`; null if none has.
    pub refuted: Option<String>,
    /// The path of the program as it was given.
    pub file: String,
    /// The world.
    pub world: String,
    /// A hash of the level's bytes, in hexadecimal digits; null if there is no level, or it cannot be read.
    pub level_sha256: Option<String>,
    /// A hash of what the program with this level means; null if it does not compile.
    pub program_sha256: Option<String>,
    /// What else it depends on.
    pub settings: Settings,
    /// What depends on the machine.
    pub timing: Timing,
}

impl Row {
    /// The row of a question that could not be asked.
    pub fn failed(key: Key, file: String, world: String, settings: Settings, error: String) -> Row {
        Row {
            row: ROW_VERSION,
            level: key.level,
            answer: Answer::failed(key.kind, key.goal),
            error: Some(error),
            fault: None,
            refuted: None,
            file,
            world,
            level_sha256: None,
            program_sha256: None,
            settings,
            timing: Timing::default(),
        }
    }

    /// Which question it answers.
    pub fn key(&self) -> Key {
        Key { level: self.level.clone(), kind: self.answer.kind, goal: self.answer.goal.clone() }
    }

    /// Why the verdict is not the expected one, in one line; empty if the verdict says it all.
    pub fn reason(&self) -> String {
        let answer = &self.answer;
        match answer.verdict {
            Conclusion::Error => self.error.as_deref().and_then(|error| error.lines().next()).unwrap_or("").to_string(),
            Conclusion::ProvenUnreachable | Conclusion::Exhausted => answer.reasons.join("; "),
            _ if self.refuted.is_some() => self.refuted.clone().unwrap_or_default(),
            Conclusion::NotFound | Conclusion::NotAnswered => match answer.end {
                End::Stopped => "the time is spent".to_string(),
                End::Memory => "the memory is full".to_string(),
                End::Answered | End::Nodes => {
                    let nearest = answer.why_not.as_ref().and_then(WhyNot::phrase);
                    let nearest = nearest.map_or(String::new(), |phrase| format!("; {phrase}"));
                    format!("not among {} nodes{nearest}", answer.nodes)
                }
            },
            Conclusion::Violated => "there is a way to break it".to_string(),
            Conclusion::Reached => String::new(),
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::reach::query::CoverageSummary;

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
            set: Vec::new(),
            without: None,
            within: None,
            after: Vec::new(),
            min_hold: None,
            robust: None,
            reaction: None,
            chance: None,
            minimize: false,
            style: None,
            nodes_limit: Some(200_000),
            seconds_limit: None,
            memory_limit: 1 << 31,
        };
        let key = Key { level: Some(level.to_string()), kind: Kind::Goal, goal: "out".into() };
        let coverage = CoverageSummary {
            place: 16.0,
            places: 12,
            mode_combinations: 2,
            places_with_modes: 15,
            ..CoverageSummary::default()
        };
        let answer = Answer {
            verdict: Conclusion::Reached,
            is_expected: true,
            steps: Some(120),
            inputs: Some("right*120".into()),
            answered_by: Some("coverage".into()),
            nodes: 31,
            coverage,
            ..Answer::failed(key.kind, key.goal.clone())
        };
        Row {
            answer,
            level_sha256: Some("4f".into()),
            program_sha256: Some("a0".into()),
            error: None,
            timing: Timing { seconds: 0.25, cpu_seconds: Some(0.125), analysis_seconds: 0.5 },
            ..Row::failed(key, "game.hyped".into(), "Open".into(), settings, String::new())
        }
    }

    #[test]
    fn a_row_is_read_as_it_was_written() {
        let failed = Answer::failed(Kind::Never, "fell".into());
        let error = Row { error: Some("cannot read".into()), answer: failed, ..row("levels/\"odd\", ü.txt") };
        for row in [row("a"), error] {
            let text = serde_json::to_string(&row).unwrap();
            assert_eq!(serde_json::from_str::<Row>(&text).unwrap(), row);
        }
    }
}
