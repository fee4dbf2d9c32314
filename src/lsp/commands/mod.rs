//! The commands of the server that run a program: `sim`, `reach`, `test` and `why`, on the texts of the editor. The results
//! are the records that the command line prints with `--format json`; [`crate::ask`] has what both share.
//!
//! A command is a function that may take long: it asks its [`Monitor`] whether to stop, and tells it how far it is.

mod arguments;
mod reach;
mod record;
mod sim;
mod test;
mod why;

use std::path::PathBuf;

use serde::Serialize;

use crate::ask::{Drawing, Loaded, Refusal, RunResult, SimResult, WhyResult, find_world, open_world, read_scripts};
use crate::compile::{Changes, Compilation, LevelFile, NumberSetting, TestCase, compile_changed};
use crate::ir::WorldId;
use crate::lsp::buffers::Buffers;
use crate::lsp::verdicts::level::ChosenLevel;
use crate::sim::Script;
use crate::source::normalize;
use crate::suite::SuiteResult;
use crate::watch::Watch;

pub(in crate::lsp) use arguments::{Program, ReachArguments, SimArguments, TestArguments, WhyArguments};
pub(in crate::lsp) use record::{RecordArguments, Recording, record};

/// A command with its arguments.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::lsp) enum Command {
    Sim(SimArguments),
    Reach(ReachArguments),
    Test(TestArguments),
    Why(WhyArguments),
}

/// What came of a command.
#[derive(Serialize)]
#[serde(untagged)]
pub(in crate::lsp) enum Outcome {
    Sim(Box<Drawn<SimResult>>),
    Reach(Box<Drawn<RunResult>>),
    Test(Box<SuiteResult>),
    Why(Box<WhyResult>),
}

/// A result with the pictures that were asked for.
#[derive(Serialize)]
pub(in crate::lsp) struct Drawn<R> {
    #[serde(flatten)]
    result: R,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pictures: Vec<Drawing>,
}

/// Watches over a command.
pub(in crate::lsp) trait Monitor: Watch {
    /// A part of the work begins: its number of so many, and what it is.
    fn part(&self, index: usize, of: usize, what: &str);

    /// Seconds since some moment.
    fn seconds(&self) -> f64;
}

impl Command {
    /// The title that is shown while it runs.
    pub fn title(&self) -> String {
        match self {
            Command::Sim(of) => of.program.title("Simulate"),
            Command::Reach(of) => of.program.title("Search in"),
            Command::Test(of) => of.program.title("Test"),
            Command::Why(of) => of.program.title("Explain"),
        }
    }

    /// Runs it; says why that is not possible.
    pub fn run(&self, buffers: &Buffers, monitor: &dyn Monitor) -> Result<Outcome, String> {
        match self {
            Command::Sim(arguments) => sim::run(arguments, buffers, monitor).map(|result| Outcome::Sim(result.into())),
            Command::Reach(arguments) => {
                reach::run(arguments, buffers, monitor).map(|result| Outcome::Reach(result.into()))
            }
            Command::Test(arguments) => {
                test::run(arguments, buffers, monitor).map(|result| Outcome::Test(result.into()))
            }
            Command::Why(arguments) => why::run(arguments, buffers).map(|result| Outcome::Why(result.into())),
        }
    }
}

impl Program {
    /// `VERB World`, or the name of the file if no world is named.
    fn title(&self, verb: &str) -> String {
        let file = self.path.file_name().unwrap_or_default().to_string_lossy();
        format!("{verb} {}", self.world.as_deref().unwrap_or(&file))
    }

    /// The level of worlds that leave their map open.
    fn level(&self) -> LevelFile<'_> {
        self.level.as_ref().map_or(LevelFile::default(), ChosenLevel::file)
    }

    /// The numbers that are set.
    fn numbers(&self) -> Result<Vec<NumberSetting<'_>>, String> {
        let setting = |text: &'_ String| match text.split_once('=') {
            Some(_) => Ok(()),
            None => Err(format!("`{text}` sets no number: write `Hero.jump_speed=310`")),
        };
        self.set.iter().try_for_each(setting)?;
        let pairs = self.set.iter().filter_map(|text| text.split_once('='));
        Ok(pairs.map(|(path, value)| NumberSetting { path: path.trim(), value: value.trim() }).collect())
    }

    /// Compiles the texts with changes; the first error is why that fails.
    fn load(&self, changes: &Changes<'_>, buffers: &Buffers) -> Result<(Loaded, Vec<TestCase>), String> {
        let Compilation { sources, program, diagnostics, tests } =
            compile_changed(&self.path, self.level(), changes, buffers);
        match program {
            Some(program) => Ok((Loaded { sources, program }, tests)),
            None => Err(Refusal::Findings(diagnostics).sentence(&sources)),
        }
    }

    /// Compiles the texts with the numbers that are set, and reads the inputs of a run.
    fn load_run(&self, inputs: &str, buffers: &Buffers) -> Result<(Loaded, WorldId, Script), String> {
        let numbers = self.numbers()?;
        let (mut loaded, _) = self.load(&Changes { numbers: &numbers, ..Changes::default() }, buffers)?;
        let world = self.world(&loaded)?;
        let scripts = read_scripts(&mut loaded, world, (&[inputs.to_string()], "inputs"));
        let scripts = scripts.map_err(|why| why.sentence(&loaded.sources))?;
        Ok((loaded, world, scripts.into_iter().next().unwrap_or_default()))
    }

    /// The world.
    fn world(&self, loaded: &Loaded) -> Result<WorldId, String> {
        let found = find_world(&loaded.program, &self.path, self.world.as_deref());
        let checked = found.and_then(|world| match open_world(&loaded.program.worlds[world]) {
            Some(_) if self.level.is_none() => Err(crate::diagnostic::catalogue::run::NoQuestion {
                why: format!("the world `{}` leaves its map open", loaded.program.worlds[world].name),
                near: None,
                help: Some("choose a level".to_string()),
            }),
            Some(why) => Err(why),
            None => Ok(world),
        });
        checked.map_err(|why| Refusal::of(why).sentence(&loaded.sources))
    }
}

/// The name of a test's or a command's file in records.
fn named(path: &std::path::Path) -> PathBuf {
    normalize(path)
}
