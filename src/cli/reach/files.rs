//! The output files of an answer of `hypedc reach`: the inputs of a path, and the picture of the search.

use std::fs::write;
use std::io;
use std::path::{Path, PathBuf};

use crate::reach::query::{Answer, Found, Session};
use crate::reach::{Verdict, Visited};
use crate::sim::{PlayerInput, Script, Simulator};
use crate::view::{Node, Search, Stop, search_svg};
use crate::watch::{Meter, Watch};

use super::text::notes;
use crate::cli::args::ReachArgs;
use crate::cli::refusal::Refusal;
use crate::cli::sim::save_script;

/// The files that were written.
#[derive(Debug, Clone, Default)]
pub(in crate::cli) struct Saved {
    pub inputs: Option<PathBuf>,
    pub picture: Option<PathBuf>,
}

/// The output paths of an answer. If there are several levels or goals, their names become part of the paths.
pub(in crate::cli) struct Destination<'d> {
    args: &'d ReachArgs,
    level: Option<&'d str>,
    goal: Option<&'d str>,
}

impl<'d> Destination<'d> {
    /// `goals` is the number of goals.
    pub fn new(args: &'d ReachArgs, level: Option<&'d str>, goal: &'d str, goals: usize) -> Self {
        Destination { args, level, goal: (goals > 1).then_some(goal) }
    }

    /// The path of the inputs; `None` without `--save-inputs`.
    fn inputs(&self) -> Option<PathBuf> {
        self.args.save_inputs.as_deref().map(|path| self.named(path))
    }

    /// The path of the picture; `None` without `--svg`.
    fn picture(&self) -> Option<PathBuf> {
        self.args.svg.as_deref().map(|path| self.named(path))
    }

    /// Whether all files of an answer exist.
    pub fn is_complete(&self, has_inputs: bool) -> bool {
        self.inputs().filter(|_| has_inputs).into_iter().chain(self.picture()).all(|path| path.exists())
    }

    /// Writes the requested files.
    pub fn save(
        &self,
        session: &Session,
        found: &Found<'_>,
        answer: &Answer,
        watch: &dyn Watch,
    ) -> Result<Saved, Refusal> {
        let cannot =
            |path: &Path, error: io::Error| Refusal::Plain(format!("cannot write `{}`: {error}", path.display()));
        let mut saved = Saved::default();
        if let (Some(path), Some(inputs)) = (self.inputs(), &answer.inputs) {
            save_script(&path, inputs).map_err(|error| cannot(&path, error))?;
            saved.inputs = Some(path);
        }
        if let Some(path) = self.picture() {
            write(&path, picture(session, found, answer, watch)).map_err(|error| cannot(&path, error))?;
            saved.picture = Some(path);
        }
        Ok(saved)
    }

    /// Inserts the names before the extension of a path.
    fn named(&self, path: &Path) -> PathBuf {
        let mut name = path.file_stem().unwrap_or_default().to_os_string();
        for word in self.level.into_iter().chain(self.goal) {
            name.push(".");
            name.push(word);
        }
        if let Some(extension) = path.extension() {
            name.push(".");
            name.push(extension);
        }
        path.with_file_name(name)
    }
}

/// The picture of a search.
fn picture(session: &Session, found: &Found<'_>, answer: &Answer, watch: &dyn Watch) -> String {
    let node = |v: &Visited| Node { parent: v.parent, space: v.space, at: v.at };
    let nodes: Vec<Node> = found.outcome.record.iter().map(node).collect();
    let sim = session.simulator();
    let path = match &found.outcome.verdict {
        Verdict::Reached(plan) => stops(sim, (&plan.script, session.query().chance), watch),
        Verdict::NotFound | Verdict::Unreachable(_) | Verdict::Exhausted(_) => Vec::new(),
    };
    let (goal, notes) = (answer.goal.as_str(), notes(answer));
    let search = Search { goal, verdict: answer.verdict.words(), nodes: &nodes, path: &path, notes: &notes };
    search_svg(sim.program(), sim.world_id(), &search)
}

/// The positions of the first player before a script and after each of its steps, until the watch stops.
fn stops(sim: &Simulator, (script, chance): (&Script, Option<u64>), watch: &dyn Watch) -> Vec<Stop> {
    let Some(player) = sim.world().players.iter().next().map(|p| p.slot) else { return Vec::new() };
    let (mut scratch, meter) = (sim.scratch(), Meter::new(watch));
    let Ok(mut state) = sim.metered_initial(&mut scratch, &meter) else { return Vec::new() };
    let stop = |state: &[u8], changes: bool| {
        let (x, y) = sim.position(state, player);
        Stop { space: sim.space(state, player), at: [x, y], changes }
    };
    let mut stops = vec![stop(&state, false)];
    let mut last: Option<&Vec<PlayerInput>> = None;
    for (step, input) in (1..).zip(script.inputs()) {
        let drawn = sim.draw(chance.unwrap_or_default(), step, input);
        if sim.metered_step(&mut state, &drawn, &mut scratch, &meter).is_err() || meter.is_stopped() {
            break;
        }
        stops.push(stop(&state, last.is_some_and(|last| *last != input.0)));
        last = Some(&input.0);
    }
    stops
}
