//! Runs the searches of an experiment on several threads, each search on one. What is found does not depend on how many
//! threads there are, but for what the budget of seconds cuts short.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Sender};

use crate::reach::{End, Outcome, Verdict, search};
use crate::sim::Fault;
use crate::watch::Watch;

use super::design::{Design, Question};
use super::{Finding, Run};

/// Tells how much time has passed for the thread that asks.
pub trait Clock: Sync {
    /// Seconds since some moment that is always the same for a thread.
    fn seconds(&self) -> f64;
}

/// A question could not be searched: its initial state breaks a rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unasked {
    /// Which of the questions.
    pub question: usize,
    /// What it breaks.
    pub fault: Fault,
}

/// Runs all that the design says on the questions that the analysis leaves open, on so many threads (at least one).
///
/// Hands each run to `each`, on the calling thread, in the order of questions, setups and seeds whatever the threads do,
/// as soon as those before it are done; `each` may break off. `stop` is asked all the time; what was begun when it says
/// so has no part in the result.
///
/// # Errors
/// [`Unasked`] if a world's initial state breaks a rule.
pub fn conduct(
    design: &Design,
    questions: &[Question<'_>],
    threads: usize,
    clock: &dyn Clock,
    stop: &(dyn Fn() -> bool + Sync),
    each: &mut dyn FnMut(&Run) -> ControlFlow<()>,
) -> Result<Vec<Run>, Unasked> {
    let tasks = tasks(design, questions);
    let is_over = AtomicBool::new(false);
    let stop = || is_over.load(Ordering::Relaxed) || stop();
    let crew = Crew { design, questions, clock, stop: &stop, tasks: &tasks, next: AtomicUsize::new(0) };
    std::thread::scope(|scope| {
        let (sender, done) = mpsc::channel();
        for _ in 0..threads.clamp(1, tasks.len().max(1)) {
            let (crew, sender) = (&crew, sender.clone());
            scope.spawn(move || crew.work(&sender));
        }
        drop(sender);
        let mut found: Vec<Option<Run>> = vec![None; tasks.len()];
        let (mut told, mut is_broken_off) = (0, false);
        while let Ok((task, result)) = done.recv() {
            let run = result.inspect_err(|_| is_over.store(true, Ordering::Relaxed))?;
            found[task] = Some(run);
            while let (false, Some(Some(run))) = (is_broken_off, found.get(told)) {
                told += 1;
                if each(run).is_break() {
                    is_broken_off = true;
                    is_over.store(true, Ordering::Relaxed);
                }
            }
        }
        // Where it was stopped, runs were lost, and there are some behind them.
        for run in found.iter().skip(told).flatten() {
            if is_broken_off || each(run).is_break() {
                break;
            }
        }
        Ok(found.into_iter().flatten().collect())
    })
}

/// One search to be run.
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

/// What the threads share.
struct Crew<'c, 'q> {
    design: &'c Design,
    questions: &'c [Question<'q>],
    clock: &'c dyn Clock,
    stop: &'c (dyn Fn() -> bool + Sync),
    tasks: &'c [Task],
    /// The first task that nobody has begun.
    next: AtomicUsize,
}

impl Crew<'_, '_> {
    /// Runs tasks until there is none left.
    fn work(&self, done: &Sender<(usize, Result<Run, Unasked>)>) {
        while !(self.stop)() {
            let at = self.next.fetch_add(1, Ordering::Relaxed);
            let Some(&task) = self.tasks.get(at) else { return };
            match self.run(task) {
                Ok(None) => return,
                Ok(Some(run)) => {
                    if done.send((at, Ok(run))).is_err() {
                        return;
                    }
                }
                Err(fault) => {
                    // Nobody listens any more where another thread has met the same.
                    let _ = done.send((at, Err(Unasked { question: task.question, fault })));
                    return;
                }
            }
        }
    }

    /// Runs one; gives nothing if it was stopped on the way.
    fn run(&self, task: Task) -> Result<Option<Run>, Fault> {
        let Task { question, setup, seed } = task;
        let q = &self.questions[question];
        let began = self.clock.seconds();
        let until = began + self.design.seconds;
        let watch = RunWatch { clock: self.clock, until, stop: self.stop, is_stopped: Cell::new(false) };
        let settings = self.design.setups[setup].settings(seed);
        let outcome = search(&q.problem(), q.space, &settings, &self.design.limits, &watch)?;
        let seconds = self.clock.seconds() - began;
        if watch.is_stopped.get() {
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
}

fn finding(outcome: &Outcome) -> Finding {
    match (&outcome.verdict, outcome.end) {
        (Verdict::Reached(_), _) => Finding::Reached,
        (Verdict::Unreachable(_), _) => Finding::Unreachable,
        (Verdict::NotFound, End::Memory) => Finding::OutOfMemory,
        (Verdict::NotFound, _) => Finding::NotFound,
    }
}

/// Watches one run: its budget, and whether all is to end.
struct RunWatch<'w> {
    clock: &'w dyn Clock,
    until: f64,
    stop: &'w (dyn Fn() -> bool + Sync),
    is_stopped: Cell<bool>,
}

impl Watch for RunWatch<'_> {
    fn stop(&self) -> bool {
        if (self.stop)() {
            self.is_stopped.set(true);
            return true;
        }
        self.clock.seconds() >= self.until
    }
}
