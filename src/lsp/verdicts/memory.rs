//! What is remembered of a program: the levels that were chosen, the ways that were found, and the last verdicts. It
//! outlives the server in a cache outside of the project. It is never evidence: ways are replayed, proofs are made
//! again.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::json::{self, Layout};
use crate::lsp::Workspace;
use crate::reach::Conclusion;
use crate::reach::query::Kind;

use super::level::ChosenLevel;
use super::verdict::{Question, Verdict, Way};

/// The version of the form in which it is kept.
const VERSION: u32 = 1;
/// Maximum number of ways that are remembered for a question: an edit that is undone finds the way from before.
const MAX_WAYS: usize = 3;
/// Maximum number of questions of a program. Those that are gone from its text are forgotten only beyond it.
const MAX_QUESTIONS: usize = 500;

/// What is remembered of a program.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::lsp) struct Memory {
    version: u32,
    /// The level of each world with an open map.
    pub levels: BTreeMap<String, ChosenLevel>,
    questions: Vec<(Question, Known)>,
}

/// What is remembered of a question.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::lsp) struct Known {
    /// Inputs that led there, the last first.
    pub ways: Vec<String>,
    /// The last verdict.
    pub last: Option<Verdict>,
    /// How the goal was reached when it last was.
    pub reached: Option<Way>,
    /// Whether the `never` was proven once.
    pub was_proven: bool,
}

impl Memory {
    /// What is remembered of a program; nothing if it cannot be read. A text without a file has no past.
    pub fn recall(root: &Path, disk: &dyn Workspace) -> Memory {
        if is_unnamed(root) {
            return Memory::default();
        }
        let read = disk.recall(&key(root)).and_then(|text| json::read::<Memory>(&text).ok());
        read.filter(|memory| memory.version == VERSION).unwrap_or_default()
    }

    /// Remembers it.
    pub fn remember(&self, root: &Path, disk: &dyn Workspace) {
        if is_unnamed(root) {
            return;
        }
        let memory = Memory { version: VERSION, ..self.clone() };
        if let Ok(text) = json::text(&memory, Layout::Compact) {
            disk.remember(&key(root), &text);
        }
    }

    /// What is known of a question.
    pub fn known(&self, question: &Question) -> Option<&Known> {
        self.questions.iter().find(|(known, _)| known == question).map(|(_, known)| known)
    }

    /// The ways for a question, and then those for others of its world and level.
    pub fn ways(&self, question: &Question) -> Vec<&str> {
        let is_near = |of: &Question| of.world == question.world && of.level == question.level;
        let own = self.questions.iter().filter(|(of, _)| of == question);
        let others = self.questions.iter().filter(|(of, _)| of != question && is_near(of));
        let mut out: Vec<&str> = Vec::new();
        for way in own.flat_map(|(_, known)| &known.ways).chain(others.flat_map(|(_, known)| known.ways.first())) {
            if !out.contains(&way.as_str()) {
                out.push(way);
            }
        }
        out
    }

    /// The newest way of each question of a world on a level.
    pub fn ways_in(&self, world: &str, level: &str) -> Vec<String> {
        let near = self.questions.iter().filter(|(of, _)| of.world == world && of.level == level);
        near.filter_map(|(_, known)| known.ways.first().cloned()).collect()
    }

    /// The last verdicts of the questions of all worlds.
    pub fn last(&self) -> impl Iterator<Item = (&Question, &Verdict)> {
        self.questions.iter().filter_map(|(question, known)| Some((question, known.last.as_ref()?)))
    }

    /// Keeps a verdict about the newest text.
    pub fn keep(&mut self, question: &Question, verdict: &Verdict) {
        // The questions that were asked last are at the end.
        let at = self.questions.iter().position(|(known, _)| known == question);
        let mut known = at.map(|at| self.questions.remove(at).1).unwrap_or_default();
        if let Some(way) = &verdict.way {
            known.ways.retain(|other| *other != way.inputs);
            known.ways.insert(0, way.inputs.clone());
            known.ways.truncate(MAX_WAYS);
        }
        match (question.kind, verdict.conclusion) {
            (Kind::Goal, Conclusion::Reached) => known.reached.clone_from(&verdict.way),
            (Kind::Never, Conclusion::ProvenUnreachable) => known.was_proven = true,
            _ => {}
        }
        known.last = Some(verdict.clone());
        self.questions.push((question.clone(), known));
        let surplus = self.questions.len().saturating_sub(MAX_QUESTIONS);
        self.questions.drain(..surplus);
    }
}

/// Whether a document has no file yet: another one may get its name.
fn is_unnamed(root: &Path) -> bool {
    root.to_str().is_some_and(|path| path.starts_with("untitled:"))
}

/// The key of a program.
fn key(root: &Path) -> String {
    format!("verdicts {}", root.display())
}
