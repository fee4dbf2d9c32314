//! What would change an answer: the smallest change of a number of a program that turns it.
//!
//! A value of a number is judged as `hypedc reach` does it, with one thing before: the ways that were found at other
//! values are replayed, since what works at one often works at the next. Values are tried over the whole range, then
//! between one that turns the answer and one that does not. Nothing is concluded about values in between, except where
//! one analysis covers all of them: it takes the number as an unknown constant of an interval ([`crate::analysis::Varied`]).
//!
//! A [`Host`] compiles and watches.

mod axis;
mod oracle;
mod parts;
mod record;
mod search;
mod tiles;

pub use axis::Axis;
pub use record::{Change, NeverTrial, Part, Trial, Tuned};
pub use search::tune;
pub use tiles::{
    LevelHost, LevelTrial, TileChange, TileEdit, TileQuestion, TileSet, TilesFound, tile_edits, tune_tiles,
};

use std::sync::Arc;

use crate::compile::NumberSetting;
use crate::ir::{Program, WorldId};
use crate::reach::Target;
use crate::reach::query::Query;
use crate::source::SourceMap;
use crate::watch::Watch;

/// Maximum number of numbers that are varied.
pub const MAX_AXES: usize = 4;

/// A program with some numbers set.
#[derive(Debug, Clone)]
pub struct Built {
    /// Its files.
    pub sources: SourceMap,
    /// The program.
    pub program: Arc<Program>,
    /// The world that is asked about.
    pub world: WorldId,
}

/// What the search for a change needs from outside.
pub trait Host {
    /// The program with some numbers set.
    ///
    /// What is wrong with it.
    fn build(&self, numbers: &[NumberSetting<'_>]) -> Result<Built, String>;

    /// Runs work under a watch.
    fn watched(&self, what: &str, work: &mut dyn FnMut(&dyn Watch));

    /// Whether all work should end.
    fn is_stopped(&self) -> bool;
}

/// The answer that is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Wanted {
    /// The goal is reached.
    Reached,
    /// The goal is proven unreachable.
    Prevented,
}

/// What is asked.
#[derive(Debug, Clone)]
pub struct Question {
    /// The numbers that are varied.
    pub axes: Vec<Axis>,
    /// The goal, and how values are judged; the first target is the goal.
    pub query: Query,
    /// The wanted answer.
    pub wanted: Wanted,
    /// `never`s that no run breaks, as far as is known, where the answer has turned.
    pub nevers: Vec<Target>,
    /// Number of values over the range of a number that are tried first.
    pub samples: usize,
}
