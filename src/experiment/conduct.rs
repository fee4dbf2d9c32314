//! Runs the searches of an experiment on several threads, each search on one. Results do not depend on the number of
//! threads, except where the budget of seconds ends a search.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::parallel::{self, TaskContext};
use crate::reach::{End, Outcome, Verdict, search};
use crate::sim::Fault;
use crate::watch::Watch;

use super::design::{Design, Question};
use super::{Finding, Run};

/// A clock for the time of the calling thread.
pub trait Clock: Sync {
    /// Seconds since a fixed moment, for each thread.
    fn seconds(&self) -> f64;
}

/// An error: the initial state of a question violates a rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunError {
    /// The index of the question.
    pub question: usize,
    /// The violated rule.
    pub fault: Fault,
}

/// Runs the design on the questions that the analysis leaves open, on a number of threads (at least one).
///
/// Calls `each` on the calling thread with each run, in the order of questions, setups and seeds, as soon as all before
/// it are done; `each` may cancel. `stop` is polled throughout; runs that it interrupts are not part of the result.
///
/// [`RunError`] if a world's initial state violates a rule.
pub fn conduct(
    design: &Design,
    questions: &[Question<'_>],
    threads: usize,
    clock: &dyn Clock,
    stop: &(dyn Fn() -> bool + Sync),
    each: &mut dyn FnMut(&Run) -> ControlFlow<()>,
) -> Result<Vec<Run>, RunError> {
    let tasks = tasks(design, questions);
    let mut found: Vec<Option<Run>> = vec![None; tasks.len()];
    let (mut delivered, mut is_broken_off, mut failure) = (0, false, None);
    let run = |at: usize, task_context: &TaskContext<'_, Result<Run, RunError>>| {
        let task = tasks[at];
        match run(design, questions, clock, task, task_context) {
            Ok(None) => {}
            Ok(Some(run)) => task_context.submit(Ok(run)),
            Err(fault) => task_context.submit(Err(RunError { question: task.question, fault })),
        }
    };
    parallel::work(tasks.len(), threads, stop, &run, &mut |task, result| {
        match result {
            Ok(run) => found[task] = Some(run),
            Err(error) => failure = failure.or(Some(error)),
        }
        while let (None, false, Some(Some(run))) = (failure, is_broken_off, found.get(delivered)) {
            delivered += 1;
            is_broken_off = each(run).is_break();
        }
        if is_broken_off || failure.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    if let Some(error) = failure {
        return Err(error);
    }
    // After a stop some runs are missing; complete ones after them are kept.
    for run in found.iter().skip(delivered).flatten() {
        if is_broken_off || each(run).is_break() {
            break;
        }
    }
    Ok(found.into_iter().flatten().collect())
}

/// One search of the experiment.
#[derive(Debug, Clone, Copy)]
struct Task {
    question: usize,
    setup: usize,
    seed: u64,
}

fn tasks(design: &Design, questions: &[Question<'_>]) -> Vec<Task> {
    let mut tasks = Vec::with_capacity(design.runs(questions));
    for (question, q) in questions.iter().enumerate() {
        if q.is_ruled_out {
            continue;
        }
        for setup in 0..design.setups.len() {
            tasks.extend((1..=u64::from(design.seeds)).map(|seed| Task { question, setup, seed }));
        }
    }
    tasks
}

/// Runs a task; returns none if it was stopped.
fn run(
    design: &Design,
    questions: &[Question<'_>],
    clock: &dyn Clock,
    task: Task,
    task_context: &TaskContext<'_, Result<Run, RunError>>,
) -> Result<Option<Run>, Fault> {
    let Task { question, setup, seed } = task;
    let q = &questions[question];
    let began = clock.seconds();
    let stop = || task_context.is_over();
    let watch = RunWatch { clock, until: began + design.seconds, stop: &stop, is_stopped: AtomicBool::new(false) };
    let settings = design.setups[setup].settings(seed);
    let outcome = search(&q.problem(), q.space, &settings, &design.limits, &watch)?;
    let seconds = clock.seconds() - began;
    if watch.is_stopped.load(Ordering::Relaxed) {
        return Ok(None);
    }
    let path_steps = match &outcome.verdict {
        Verdict::Reached(plan) => Some(plan.steps),
        _ => None,
    };
    let s = outcome.statistics;
    let (nodes, trees, extensions, steps) = (s.nodes, s.trees, s.extensions, s.steps);
    let finding = finding(&outcome);
    Ok(Some(Run { question, setup, seed, finding, nodes, trees, extensions, steps, seconds, path_steps }))
}

fn finding(outcome: &Outcome) -> Finding {
    match (&outcome.verdict, outcome.end) {
        (Verdict::Reached(_), _) => Finding::Reached,
        (Verdict::Unreachable(_), _) => Finding::Unreachable,
        (Verdict::Exhausted(_), _) => Finding::Exhausted,
        (Verdict::NotFound, End::Memory) => Finding::OutOfMemory,
        (Verdict::NotFound, _) => Finding::NotFound,
    }
}

/// The watch of one run: its budget, and the stop of the experiment.
struct RunWatch<'w> {
    clock: &'w dyn Clock,
    until: f64,
    stop: &'w (dyn Fn() -> bool + Sync),
    is_stopped: AtomicBool,
}

impl Watch for RunWatch<'_> {
    fn stop(&self) -> bool {
        if (self.stop)() {
            self.is_stopped.store(true, Ordering::Relaxed);
            return true;
        }
        self.clock.seconds() >= self.until
    }
}
