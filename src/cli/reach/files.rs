//! The output files of an answer of `hypedc reach`: the inputs of a path, and the picture of the search.

use std::fs::write;
use std::io;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use crate::ir::GoalId;
use crate::reach::query::{Answer, Found, Session};
use crate::reach::{Plan, Verdict, Visited};
use crate::sim::{Script, Simulator};
use crate::view::{Images, Node, Picture, Recorder, Run, picture_svg};
use crate::watch::Watch;

use super::text::notes;
use crate::cli::args::ReachArgs;
use crate::cli::pictures::images;
use crate::cli::refusal::Refusal;
use crate::cli::sim::{drive, save_script};

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
            let images = images(session.simulator().program(), &self.args.file).map_err(Refusal::Plain)?;
            write(&path, picture(session, found, answer, &images, watch)).map_err(|error| cannot(&path, error))?;
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

/// The path that was found.
pub(super) fn plan<'f>(found: &'f Found<'_>) -> Option<&'f Plan> {
    match &found.outcome.verdict {
        Verdict::Reached(plan) => Some(plan),
        Verdict::NotFound | Verdict::Unreachable(_) | Verdict::Exhausted(_) => None,
    }
}

/// The nodes of a search, as pictures show them.
pub(super) fn nodes(found: &Found<'_>) -> Vec<Node> {
    let node = |v: &Visited| Node { parent: v.parent, space: v.space, at: v.at };
    found.outcome.record.iter().map(node).collect()
}

/// The picture of a search.
pub(super) fn picture(
    session: &Session,
    found: &Found<'_>,
    answer: &Answer,
    images: &Images,
    watch: &dyn Watch,
) -> String {
    let (nodes, sim) = (nodes(found), session.simulator());
    let chance = session.query().chance;
    let run = plan(found).map_or(Run::default(), |plan| recorded(sim, (&plan.script, chance), watch));
    let goals: Vec<GoalId> = sim.world().goal_named(&answer.goal).into_iter().collect();
    let notes = notes(answer);
    let picture = Picture {
        title: &answer.goal,
        result: answer.verdict.words(),
        is_good: answer.is_expected,
        goals: &goals,
        nodes: &nodes,
        run: &run,
        notes: &notes,
        images,
    };
    picture_svg(sim.program(), sim.world_id(), &picture)
}

/// The run of a script, until the watch stops it.
fn recorded(sim: &Simulator, (script, chance): (&Script, Option<u64>), watch: &dyn Watch) -> Run {
    let (mut recorder, mut last) = (Recorder::new(sim), Vec::new());
    // A path ends in its last step, also out of bounds; nothing is written here that could fail.
    let _ = drive(sim, (script, chance), script.len(), watch, &mut |step, input, state, _| {
        recorder.observe(step, input, state);
        last.clear();
        last.extend_from_slice(state);
        Ok(ControlFlow::Continue(()))
    });
    recorder.finish(&last, Vec::new())
}
