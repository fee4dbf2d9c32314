//! A report as a page (`--html`): the page of `hypedc play --export`, with answers or a run to be looked at. What it says
//! is what the command prints; what it shows was simulated here, and the page plays the inputs again.

use std::io;
use std::ops::ControlFlow;
use std::path::Path;

use serde::Serialize;

use crate::compile::LevelFile;
use crate::sim::{Script, Simulator};
use crate::watch::Watch;

use super::args::PageArgs;
use super::play::export::{Carried, NoPage};
use super::reach::refuted::command_line;
use super::report::program_sha256;
use super::sim::{RunEnd, drive};

/// What a page reports, as `studio/src/report.ts` has it.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    /// `reach` or `sim`.
    kind: &'static str,
    /// The line before the answers.
    pub title: String,
    /// What is said about all of them, line by line.
    pub notes: Vec<String>,
    /// The answers, or the run.
    pub ways: Vec<Way>,
    /// The command line.
    command: String,
    hypedc: &'static str,
    program_sha256: String,
}

/// An answer or a run, with what is shown of it.
#[derive(Debug, Serialize)]
pub(super) struct Way {
    /// `goal`, `never` or `run`.
    pub kind: &'static str,
    pub name: String,
    pub verdict: String,
    pub tone: Tone,
    /// The lines below the verdict.
    pub lines: Vec<String>,
    /// The inputs that show it.
    pub witness: Option<Witness>,
    /// The frame from which the search went.
    pub start: u64,
    /// Frames that are worth a look.
    pub moments: Vec<Moment>,
    /// Where a search was, as [`cells`](crate::view::cells).
    pub covered: Vec<[i64; 4]>,
    /// The picture of `--svg`.
    pub picture: Option<String>,
}

/// How a verdict is coloured.
#[derive(Debug, Clone, Copy, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Tone {
    Good,
    Bad,
    Proof,
    Open,
}

/// A frame of a run.
#[derive(Debug, Serialize)]
pub(super) struct Moment {
    pub frame: u64,
    pub text: String,
    pub tone: Tone,
}

/// Inputs that were run from the first state, with what nature drew.
#[derive(Debug, Serialize)]
pub(super) struct Witness {
    pub script: String,
    /// Number of steps.
    pub steps: u64,
    /// For each player its space and position after each step, the first state included, while it is there.
    ghost: Vec<Vec<(u32, f64, f64)>>,
}

impl Report {
    pub fn new(kind: &'static str, title: String, sim: &Simulator) -> Report {
        Report {
            kind,
            title,
            notes: Vec::new(),
            ways: Vec::new(),
            command: called(),
            hypedc: env!("CARGO_PKG_VERSION"),
            program_sha256: program_sha256(sim.program()),
        }
    }
}

impl Way {
    /// Without anything to show.
    pub fn new(kind: &'static str, name: String, verdict: String, tone: Tone) -> Way {
        Way {
            kind,
            name,
            verdict,
            tone,
            lines: Vec::new(),
            witness: None,
            start: 0,
            moments: Vec::new(),
            covered: Vec::new(),
            picture: None,
        }
    }
}

impl Witness {
    /// Runs a script; what it leaves open is drawn from the seed `chance`. Returns nothing if it was stopped.
    pub fn run(
        sim: &Simulator,
        run: (&Script, Option<u64>),
        steps: u64,
        watch: &dyn Watch,
    ) -> io::Result<Option<Self>> {
        let mut script = Script::default();
        let mut ghost = vec![(Vec::new(), true); sim.world().players.len()];
        let ended = drive(sim, run, steps, watch, &mut |step, input, state, _| {
            if step > 0 {
                script.push(input, 1);
            }
            for (player, (path, is_there)) in sim.world().players.iter().zip(&mut ghost) {
                let instance = sim.instance(state, player.slot);
                *is_there &= instance.is_alive();
                if *is_there {
                    let (x, y) = instance.position();
                    // What is drawn needs no more.
                    let short = |at: f64| (at * 100.0).round() / 100.0;
                    path.push((instance.space().0, short(x), short(y)));
                }
            }
            Ok(ControlFlow::Continue(()))
        })?;
        let (text, steps) = (script.text(sim.program(), sim.world_id()), script.len());
        let ghost = ghost.into_iter().map(|(path, _)| path).collect();
        let is_whole = !matches!(ended, RunEnd::Stopped(_));
        Ok(is_whole.then_some(Witness { script: text, steps, ghost }))
    }
}

/// Reads what a page carries; nothing if none is asked for. Called before long work: a page that cannot be written is
/// refused at once, and what it carries is what the work was about.
pub(super) fn carried(args: &PageArgs, file: &Path, level: LevelFile<'_>) -> Result<Option<Carried>, NoPage> {
    if args.html.is_none() {
        return Ok(None);
    }
    if file.extension().is_some_and(|extension| extension == "json") {
        let why = format!("`{}` is a compiled program, and a page holds the text", file.display());
        return Err(NoPage::Plain(format!("{why}: give the `.hyped` file that it was made from")));
    }
    Carried::read(file, level, args.engine.as_deref()).map(Some)
}

/// The command line, without the place of the binary.
fn called() -> String {
    let line = command_line();
    match line.split_once(' ') {
        Some((_, arguments)) => format!("hypedc {arguments}"),
        None => line,
    }
}
