//! The result of `hypedc diff` as a record, from which JSON, text and Markdown are made.

use serde::Serialize;

use crate::diff::{Change, Class, Comparison, Figures, LevelChange, PlayerChange};

/// The version of the JSON result.
pub(super) const RESULT_VERSION: u32 = 1;

/// What a change of a program broke.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub(super) struct DiffResult {
    /// The version of this format.
    pub version: u32,
    /// The version of `hypedc`.
    pub hypedc: &'static str,
    /// The program before the change.
    pub old: ProgramOf,
    /// The program after it.
    pub new: ProgramOf,
    /// The numbers of the program after the change that were set.
    pub set: Vec<String>,
    /// The seed of the searches.
    pub seed: u64,
    /// Maximum number of nodes of each search.
    pub nodes_limit: u64,
    /// Whether both programs mean the same: comments, layout and looks may differ.
    pub is_same: bool,
    /// Whether the run was interrupted: not all questions were asked.
    pub stopped: bool,
    /// Whether something is known to be worse.
    pub is_worse: bool,
    /// The parts of the programs that differ.
    pub changes: Vec<Change>,
    /// The tiles and instances of tiles that differ in the maps of the programs.
    pub maps: Vec<LevelChange>,
    /// How players move, for each world with players on flat ground.
    pub figures: Vec<WorldFigures>,
    /// The answers, for each level and world.
    pub levels: Vec<LevelResult>,
}

/// A program.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub(super) struct ProgramOf {
    /// Its path.
    pub file: String,
    /// A hash of what it means, without levels.
    pub program_sha256: String,
}

/// How the players of a world move.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub(super) struct WorldFigures {
    /// The world.
    pub world: String,
    /// In the old program.
    pub old: Vec<Figures>,
    /// In the new program.
    pub new: Vec<Figures>,
    /// What differs.
    pub changes: Vec<PlayerChange>,
}

/// The answers about a level and a world.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub(super) struct LevelResult {
    /// The path of the level; null for a world that has its maps.
    pub level: Option<String>,
    /// The world in the new program.
    pub world: String,
    /// Whether both programs with this level mean the same, so that nothing was asked.
    pub is_same: bool,
    /// Why it could not be compared; null if it was.
    pub error: Option<String>,
    /// Whether that is so for the new program only: it is worse.
    pub is_broken: bool,
    /// Whether a search has shown that the analysis is wrong about this world, a mistake of `hypedc`.
    pub is_refuted: bool,
    /// The tiles and instances that differ, if the level itself was changed.
    pub maps: Vec<LevelChange>,
    /// The questions.
    pub questions: Vec<Comparison>,
}

impl LevelResult {
    /// The most important of its changes.
    pub fn class(&self) -> Class {
        if self.is_broken {
            return Class::Worse;
        }
        let classes = self.questions.iter().map(|question| question.class);
        classes.min().unwrap_or(if self.error.is_some() { Class::Other } else { Class::Same })
    }

    /// Its name in text.
    pub fn name(&self) -> String {
        match &self.level {
            Some(level) => level.clone(),
            None => format!("world {}", self.world),
        }
    }
}

impl DiffResult {
    /// The levels with answers, or with an error instead.
    pub fn asked(&self) -> impl Iterator<Item = &LevelResult> {
        self.levels.iter().filter(|level| !level.questions.is_empty() || level.error.is_some())
    }

    /// The number of questions of a class; a level that is broken counts as one.
    pub fn count(&self, class: Class) -> usize {
        let of = |level: &LevelResult| match level.is_broken {
            true => usize::from(class == Class::Worse),
            false => level.questions.iter().filter(|question| question.class == class).count(),
        };
        self.levels.iter().map(of).sum()
    }

    /// The number of questions.
    pub fn questions(&self) -> usize {
        self.levels.iter().map(|level| level.questions.len() + usize::from(level.is_broken)).sum()
    }
}

/// The schema of the result.
#[cfg(feature = "testing")]
pub(in crate::cli) fn json_schema() -> schemars::Schema {
    schemars::schema_for!(DiffResult)
}
