//! Questions and answers: planners, verdicts, many levels, experiments, the command line.

mod support;

mod border;
mod cli;
mod corpus;
mod experiment;
mod guard;
mod questions;
mod reach;
mod stop;
mod verdicts;
