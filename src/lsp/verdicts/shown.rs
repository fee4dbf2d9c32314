//! The verdicts as they are shown: those of each program, and whether they are about its text as it is now.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::lsp::snapshot::Snapshot;
use crate::reach::query::Kind;

use super::ask::Asked;
use super::level::ChosenLevel;
use super::verdict::{Question, Verdict};

/// The verdicts of all open programs.
#[derive(Default)]
pub(in crate::lsp) struct Shown {
    programs: BTreeMap<PathBuf, ShownProgram>,
}

/// The verdicts of a program.
#[derive(Default)]
pub(in crate::lsp) struct ShownProgram {
    /// The program that was asked about last; `None` if none was since the server started.
    pub about: Option<Arc<Snapshot>>,
    /// The level of each world with an open map.
    pub levels: BTreeMap<String, ChosenLevel>,
    /// By world: why its level cannot be its map.
    pub misfits: BTreeMap<String, String>,
    pub verdicts: Vec<ShownVerdict>,
    /// The files of its levels.
    read: BTreeSet<PathBuf>,
}

/// A verdict.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::lsp) struct ShownVerdict {
    pub asked: Asked,
    /// Whether it is about the text as it is now.
    pub is_current: bool,
}

impl ShownVerdict {
    /// What stands above the goal. What is out of date claims nothing.
    pub fn title(&self) -> String {
        let Asked { question, verdict, .. } = &self.asked;
        let title = verdict.title(question.kind);
        if self.is_current { title } else { format!("… was {}", title.trim_end_matches(" · play")) }
    }
}

impl ShownProgram {
    /// The name of the level of a world; empty if it has none.
    fn level(&self, root: &Path, world: &str) -> String {
        self.levels.get(world).map(|level| level.name(root)).unwrap_or_default()
    }
}

impl Shown {
    /// The verdicts of a program.
    pub fn program(&self, root: &Path) -> Option<&ShownProgram> {
        self.programs.get(root)
    }

    /// The level that was chosen for the open map of a world; without a world, of the only one for which one was chosen.
    pub fn level(&self, root: &Path, world: Option<&str>) -> Option<&ChosenLevel> {
        let levels = &self.programs.get(root)?.levels;
        match world {
            Some(world) => levels.get(world),
            None => levels.values().next().filter(|_| levels.len() == 1),
        }
    }

    /// The verdict of a goal or a `never`.
    pub fn verdict(&self, root: &Path, (world, kind, name): (&str, Kind, &str)) -> Option<&ShownVerdict> {
        self.programs.get(root)?.verdicts.iter().find(|shown| {
            let of = &shown.asked.question;
            of.world == world && of.kind == kind && of.name == name
        })
    }

    /// Verdicts about an older text, from the time before the server was started.
    pub fn recalled(&mut self, root: &Path, last: Vec<(Question, Verdict)>) {
        let program = self.programs.entry(root.to_path_buf()).or_default();
        for (question, verdict) in last {
            if question.level != program.level(root, &question.world) || program.has(&question) {
                continue;
            }
            let asked = Asked { question, verdict, broken: None };
            program.verdicts.push(ShownVerdict { asked, is_current: false });
        }
    }

    /// The levels that were chosen for a program. Verdicts on others are dropped.
    pub fn chosen(&mut self, root: &Path, levels: BTreeMap<String, ChosenLevel>) {
        let program = self.programs.entry(root.to_path_buf()).or_default();
        program.levels = levels;
        program.misfits.clear();
        let names: BTreeMap<String, String> =
            program.levels.iter().map(|(world, level)| (world.clone(), level.name(root))).collect();
        program.verdicts.retain(|shown| {
            let of = &shown.asked.question;
            of.level == names.get(&of.world).cloned().unwrap_or_default()
        });
    }

    /// Verdicts about a program as it is now.
    pub fn asked(&mut self, snapshot: &Arc<Snapshot>, read: &BTreeSet<PathBuf>, all: Vec<Asked>) {
        let program = self.programs.entry(snapshot.root.clone()).or_default();
        program.about = Some(Arc::clone(snapshot));
        program.read.extend(read.iter().cloned());
        for asked in all {
            let of = &asked.question;
            let is_same = |known: &Question| known.world == of.world && known.kind == of.kind && known.name == of.name;
            program.verdicts.retain(|shown| !is_same(&shown.asked.question));
            program.verdicts.push(ShownVerdict { asked, is_current: true });
        }
    }

    /// The level of a world of a program cannot be its map.
    pub fn misfit(&mut self, snapshot: &Arc<Snapshot>, read: BTreeSet<PathBuf>, world: String, why: String) {
        let program = self.programs.entry(snapshot.root.clone()).or_default();
        program.about = Some(Arc::clone(snapshot));
        program.read.extend(read);
        program.misfits.insert(world, why);
    }

    /// All questions of some programs were asked: other verdicts are dropped, as their goals are gone. Returns the
    /// programs that had some.
    pub fn finished(&mut self, is_asked: impl Fn(&Path) -> bool) -> BTreeSet<PathBuf> {
        let mut fewer = BTreeSet::new();
        for (root, program) in self.programs.iter_mut().filter(|(root, _)| is_asked(root)) {
            let count = program.verdicts.len();
            program.verdicts.retain(|shown| shown.is_current);
            if program.verdicts.len() < count {
                fewer.insert(root.clone());
            }
        }
        fewer
    }

    /// The files that verdicts about a program depend on.
    pub fn dependencies(&self, root: &Path) -> impl Iterator<Item = &PathBuf> {
        let program = self.programs.get(root);
        let own = program.and_then(|program| program.about.as_ref()).map(|about| about.dependencies.iter());
        own.into_iter().flatten().chain(program.into_iter().flat_map(|program| &program.read))
    }

    /// Files have changed: what was asked about them is out of date. Returns the programs with verdicts that were not
    /// before.
    pub fn changed(&mut self, paths: &BTreeSet<PathBuf>) -> Vec<PathBuf> {
        let mut outdated = Vec::new();
        for (root, program) in &mut self.programs {
            let is_read = program.about.as_ref().is_none_or(|about| !about.dependencies.is_disjoint(paths));
            if !is_read && program.read.is_disjoint(paths) {
                continue;
            }
            let mut was_current = !std::mem::take(&mut program.misfits).is_empty();
            for shown in &mut program.verdicts {
                was_current |= std::mem::take(&mut shown.is_current);
            }
            if was_current {
                outdated.push(root.clone());
            }
        }
        outdated
    }

    /// Forgets the verdicts of programs that are not kept, but not their levels. Returns the programs that had some.
    pub fn retain(&mut self, is_kept: impl Fn(&Path) -> bool) -> Vec<PathBuf> {
        let mut gone = Vec::new();
        for (root, program) in self.programs.iter_mut().filter(|(root, _)| !is_kept(root)) {
            program.about = None;
            let has_misfits = !std::mem::take(&mut program.misfits).is_empty();
            if !std::mem::take(&mut program.verdicts).is_empty() || has_misfits {
                gone.push(root.clone());
            }
        }
        gone
    }
}

impl ShownProgram {
    fn has(&self, question: &Question) -> bool {
        self.verdicts.iter().any(|shown| shown.asked.question == *question)
    }
}
