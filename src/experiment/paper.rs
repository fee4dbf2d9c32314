//! The experiment of the paper: its two tests, embedded in the binary, and the figures of its Tables 1 and 2 (Osborn,
//! Lambrigger and Mateas, *HyPED*, AIIDE 2017).

use std::path::Path;

use serde::Serialize;

use crate::compile::{Compilation, compile};
use crate::reach::{Planner, Sampling};
use crate::source::{Files, ReadError};

/// A test of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Test {
    /// A walking robot boards two platforms at the right moments.
    One,
    /// A jumping robot climbs two platforms.
    Two,
}

impl Test {
    /// Both.
    pub const ALL: [Test; 2] = [Test::One, Test::Two];

    /// Its number in the paper, and the number of its table.
    pub fn number(self) -> u8 {
        match self {
            Test::One => 1,
            Test::Two => 2,
        }
    }

    /// The name of its file, without `.hyped`.
    pub fn name(self) -> &'static str {
        match self {
            Test::One => "test1",
            Test::Two => "test2",
        }
    }

    /// Compiles its program, without reading the disk.
    pub fn compile(self) -> Compilation {
        compile(Path::new(&format!("{}.hyped", self.name())), &Embedded)
    }
}

/// The embedded programs of `examples/paper`.
struct Embedded;

const PROGRAMS: [(&str, &str); 5] = [
    ("test1.hyped", include_str!("../../examples/paper/test1.hyped")),
    ("test2.hyped", include_str!("../../examples/paper/test2.hyped")),
    ("robot.hyped", include_str!("../../examples/paper/robot.hyped")),
    ("mario.hyped", include_str!("../../examples/paper/mario.hyped")),
    ("platforms.hyped", include_str!("../../examples/paper/platforms.hyped")),
];

impl Files for Embedded {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        let found = PROGRAMS.iter().find(|(name, _)| path == Path::new(name));
        found.map(|(_, text)| (*text).to_string()).ok_or_else(|| ReadError::Unreadable("no such file".into()))
    }
}

/// The planners that the paper compares.
pub const PLANNERS: [Planner; 4] = [Planner::Rrt, Planner::RcRrt, Planner::RgRrt, Planner::EgRrt];

/// The paper's limit for each run, seconds of wall-clock time.
pub const SECONDS: u32 = 20;

/// The paper's number of runs of each planner.
pub const RUNS: u32 = 50;

/// A row of the paper's tables.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Published {
    /// Mean number of nodes over all runs.
    pub nodes: f64,
    /// Mean time of the runs that reached the goal, s of wall-clock time.
    pub goal_seconds: f64,
    /// Mean number of nodes of those runs.
    pub goal_nodes: f64,
    /// How many of the 50 runs reached the goal.
    pub successes: u32,
}

/// The paper's figures for a test; none for other planners.
pub fn published(test: Test, sampling: Sampling, planner: Planner) -> Option<Published> {
    let [rrt, rc, rg, eg] = match (test, sampling) {
        (Test::One, Sampling::Naive) => {
            [(1087, 4.87, 334, 27), (1083, 4.94, 308, 22), (580, 3.34, 109, 20), (771, 7.91, 315, 32)]
        }
        (Test::One, Sampling::Reduced) => {
            [(1048, 3.31, 219, 24), (1018, 3.11, 219, 24), (505, 2.44, 69, 13), (814, 9.8, 365, 46)]
        }
        (Test::Two, Sampling::Naive) => {
            [(224, 1.61, 23, 21), (221, 2.53, 32, 24), (99, 0.62, 4, 8), (113, 1.19, 7, 13)]
        }
        (Test::Two, Sampling::Reduced) => {
            [(204, 2.75, 45, 40), (199, 3.55, 45, 32), (92, 4.62, 25, 28), (107, 6.33, 38, 43)]
        }
    };
    let (nodes, goal_seconds, goal_nodes, successes) = match planner {
        Planner::Rrt => rrt,
        Planner::RcRrt => rc,
        Planner::RgRrt => rg,
        Planner::EgRrt => eg,
        _ => return None,
    };
    Some(Published { nodes: f64::from(nodes), goal_seconds, goal_nodes: f64::from(goal_nodes), successes })
}
