//! The command line: one file per subcommand. Only this part accesses the terminal, the clock and the disk, and chooses
//! an exit code: 0 if every question has the expected answer, 1 if an answer is no or missing, 2 if a question could
//! not be asked.

#![allow(clippy::disallowed_methods, reason = "seconds are a matter of the command line")]

mod about;
mod animation;
mod args;
mod bounds;
mod check;
mod corpus;
mod diff;
mod disk;
mod experiment;
mod explain;
mod fix;
mod fmt;
mod goal;
mod graph;
mod import;
mod ir;
#[cfg(feature = "lsp")]
mod lsp;
#[cfg(feature = "lsp")]
mod memory;
mod merge;
mod new;
mod page;
mod pictures;
mod play;
mod reach;
mod refusal;
mod replay;
mod report;
#[cfg(feature = "testing")]
mod schemas;
mod sim;
mod sim_sweep;
mod stuck;
mod sweep;
mod test;
mod time;
mod tune;
mod watches;
mod why;

use std::io;
use std::process::ExitCode;

use clap::Parser;

use args::{Arguments, Command};
#[cfg(feature = "testing")]
#[doc(hidden)]
pub use reach::answer_by_analysis_of;
#[cfg(feature = "testing")]
pub use schemas::schemas;

/// The exit status of a subcommand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Exit {
    /// As expected.
    Yes,
    /// An answer is no or missing: errors, a goal not reached, a `never` violated or not answered, a layout that is not
    /// canonical.
    No,
    /// The question could not be asked.
    Refused,
}

/// Parses the arguments, runs the subcommand and returns the exit code.
pub fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            // Clap's exit codes, 0 for help and 2 for bad usage, match ours. A closed pipe is no error.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    let answer = match arguments.command {
        Command::Check(args) => check::run(&args),
        Command::Fmt(args) => fmt::run(&args),
        Command::Import(command) => import::run(&command),
        Command::Ir(args) => ir::run(&args),
        Command::Sim(args) => sim::run(&args),
        Command::Play(args) => play::run(&args),
        Command::Reach(args) if corpus::is_corpus_run(&args) => corpus::run(&args),
        Command::Reach(args) => reach::run(&args),
        Command::Merge(args) => merge::run(&args),
        Command::Why(args) => why::run(&args),
        Command::Stuck(args) => stuck::run(&args),
        Command::Tune(args) => tune::run(&args),
        Command::Test(args) => test::run(&args),
        Command::Diff(args) => diff::run(&args),
        Command::Experiment(args) => experiment::run(&args),
        Command::Explain(args) => explain::run(&args),
        Command::Bounds(args) => bounds::run(&args),
        Command::Graph(args) => graph::run(&args),
        Command::New(args) => new::run(&args),
        Command::Completions(args) => about::completions(&args),
        #[cfg(feature = "lsp")]
        Command::Lsp(_) => lsp::run(),
        Command::Man(args) => about::man(&args),
    };
    match answer {
        Ok(Exit::Yes) => ExitCode::SUCCESS,
        Ok(Exit::No) => ExitCode::from(1),
        Ok(Exit::Refused) => ExitCode::from(2),
        // The reader of the output is gone.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(error) => {
            let _ = report::plain_error(&format!("cannot write: {error}"));
            ExitCode::from(2)
        }
    }
}
