//! Questions and answers: planners, verdicts, many levels, experiments, the command line.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "a minimum in a test is of numbers other than -0")]

mod support;

mod around;
mod asked;
mod border;
mod chance;
mod cli;
mod corpus;
mod diff;
mod exhaustion;
mod experiment;
mod figures;
mod guard;
mod led;
mod misses;
mod pictures;
mod questions;
mod reach;
mod report_pages;
mod shards;
mod shortcuts;
mod skill;
mod stop;
mod stuck;
mod styles;
mod suite;
mod timing;
mod tune;
mod verdicts;
mod why;
mod why_not;
