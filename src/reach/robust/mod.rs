//! Can a person do it? A plan is open-loop: its inputs change at given times. A person misses these times by a little, each
//! on its own. This part estimates how probable it is that a plan succeeds nevertheless, says which of its moments are the
//! hardest, and searches for plans that are easier.
//!
//! A timing error is normally distributed and rounded to steps (`jitter.rs`). `timeline.rs` takes a plan apart into changes
//! of inputs and moves them, `play.rs` simulates the result, `windows.rs` replays each change with each error of its own.
//! `improve.rs` searches for easier plans: `edit.rs` has its edits, `crowd.rs` a search with many players at once along a path
//! (`guide.rs`).

mod crowd;
mod edit;
mod guide;
mod improve;
mod jitter;
mod play;
mod timeline;
mod windows;

use std::ops::ControlFlow;

use crate::ir::{SlotId, SpaceId};
use crate::parallel;
use crate::sim::State;
use crate::watch::{Meter, Progress, Watch};

use super::coverage::mix;
use super::interval::wilson_95;
use super::outcome::Plan;
use super::problem::Problem;
use play::{Ending, Nature, Plays};
use timeline::Timeline;

pub use improve::{Improved, improve_robustness};
pub use jitter::Jitter;
pub use timeline::Change;
pub use windows::{Side, Window};

/// Maximum number of steps of a window that are tried.
pub const MAX_WINDOW: u32 = 30;
/// How much later than planned the target may hold, s: errors delay it, and the inputs at the end are held on.
pub const SLACK: f64 = 2.0;
/// Number of plays between two looks at the watch.
const BATCH: u64 = 64;
/// Maximum memory of the states along a plan, bytes.
const MAX_BYTES: u64 = 64 << 20;
/// Sets the plays that are reported apart from those by which a plan was chosen.
const REPORTED: u64 = 0x7265_706f_7274_6564;

/// A share of plays that succeeded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Estimate {
    /// Number of plays.
    pub trials: u64,
    /// Those that reached the target.
    pub successes: u64,
}

impl Estimate {
    /// The share of successes.
    pub fn probability(self) -> f64 {
        self.successes as f64 / self.trials.max(1) as f64
    }

    /// The confidence interval of the probability (95 %).
    pub fn interval(self) -> [f64; 2] {
        wilson_95(self.successes, self.trials).unwrap_or([0.0, 1.0])
    }
}

/// How robust a plan is.
#[derive(Debug, Clone, PartialEq)]
pub struct Robustness {
    /// How probable its success is.
    pub success: Estimate,
    /// Its changes with their windows, by time.
    pub windows: Vec<Window>,
}

impl Robustness {
    /// The hardest moment: the change whose errors alone cost most, of several the one with the smallest window. `None` if
    /// there is none that has to be timed.
    pub fn hardest(&self) -> Option<&Window> {
        let room = |window: &Window| u64::from(window.early.steps()) + u64::from(window.late.steps());
        let harder = |a: &&Window, b: &&Window| a.alone.total_cmp(&b.alone).then(room(a).cmp(&room(b)));
        let needs_timing = |window: &&Window| [window.early, window.late].iter().any(|s| matches!(s, Side::Steps(_)));
        self.windows.iter().filter(needs_timing).min_by(harder)
    }
}

/// Measures how robust a plan is, on so many plays; their seeds are used for nothing else. If the watch stops it, `None`,
/// or fewer plays.
pub fn measure_robustness(
    problem: &Problem<'_>,
    plan: &Plan,
    jitter: &Jitter,
    (seed, trials, threads): (u64, u64, usize),
    watch: &dyn Watch,
) -> Option<Robustness> {
    let course = Course::new(problem, plan, watch)?;
    let timeline = Timeline::new(problem.sim.world(), plan);
    let windows = windows::windows(&course, &timeline, jitter, watch)?;
    let success = estimate(&course, &timeline, jitter, (seed, trials, threads), watch)?;
    Some(Robustness { success, windows })
}

/// The share of plays of a plan that succeed.
pub fn estimate_success(
    problem: &Problem<'_>,
    plan: &Plan,
    jitter: &Jitter,
    (seed, trials, threads): (u64, u64, usize),
    watch: &dyn Watch,
) -> Option<Estimate> {
    let course = Course::new(problem, plan, watch)?;
    estimate(&course, &Timeline::new(problem.sim.world(), plan), jitter, (seed, trials, threads), watch)
}

/// Plays a plan with errors. Play number `n` depends on the seed and on `n` alone, so that the result does not depend on
/// the number of threads. `None` if it was stopped before the first plays.
fn estimate(
    course: &Course<'_>,
    timeline: &Timeline,
    jitter: &Jitter,
    (seed, trials, threads): (u64, u64, usize),
    watch: &dyn Watch,
) -> Option<Estimate> {
    let seed = mix(seed, REPORTED);
    let batches = trials.div_ceil(BATCH) as usize;
    let until = course.until(timeline);
    let mut done: Vec<Option<u64>> = vec![None; batches];
    let stop = || watch.stop();
    let task = |batch: usize, context: &parallel::TaskContext<'_, Option<u64>>| {
        let (mut plays, meter, mut errors) = (Plays::new(course.problem), Meter::new(watch), Vec::new());
        let first = batch as u64 * BATCH;
        let mut successes = 0;
        for trial in first..(first + BATCH).min(trials) {
            errors.clear();
            errors.extend((0..timeline.changes.len() as u64).map(|change| jitter.draw(seed, trial, change)));
            timeline.times(&errors, &mut plays.times);
            let nature = Nature::Anew(mix(seed, trial));
            match plays.play(timeline, course.start(), until, nature, &meter) {
                Ending::Reached(_) => successes += 1,
                Ending::Over | Ending::Late => {}
                Ending::Stopped => return context.submit(None),
            }
        }
        context.submit(Some(successes));
    };
    let mut played = 0;
    parallel::work(batches, threads, &stop, &task, &mut |batch, successes| {
        done[batch] = successes;
        played += BATCH;
        watch.progress(Progress { nodes: played, budget: trials, places: 0 });
        ControlFlow::Continue(())
    });
    // If it was stopped: the first batches, whichever were quick.
    let whole: Vec<u64> = done.into_iter().map_while(|successes| successes).collect();
    let trials = (whole.len() as u64 * BATCH).min(trials);
    (trials > 0).then(|| Estimate { trials, successes: whole.iter().sum() })
}

/// What all plays of plans for one problem share.
struct Course<'p> {
    problem: &'p Problem<'p>,
    /// Number of given steps, and the state after them.
    start: (u64, State),
    slack: u64,
    /// The player whose place is reported.
    player: Option<SlotId>,
}

impl<'p> Course<'p> {
    /// The course of a plan and of those that start as it does; `None` if the watch stops the replay of what is given.
    fn new(problem: &'p Problem<'p>, plan: &Plan, watch: &dyn Watch) -> Option<Self> {
        let (sim, meter) = (problem.sim, Meter::new(watch));
        let mut scratch = sim.scratch();
        let mut state = sim.metered_initial(&mut scratch, &meter).ok().filter(|_| !meter.is_stopped())?;
        for (input, step) in plan.script.first(plan.after).inputs().zip(1..) {
            sim.metered_step(&mut state, &problem.draw(step, input), &mut scratch, &meter).ok()?;
            if meter.is_stopped() {
                return None;
            }
        }
        let slack = (SLACK / sim.world().step.seconds()).ceil().clamp(1.0, 1e6) as u64;
        Some(Course { problem, start: (plan.after, state), slack, player: problem.players().first().copied() })
    }

    fn start(&self) -> (u64, &[u8]) {
        (self.start.0, &self.start.1)
    }

    /// The number of steps by which a play must have succeeded.
    fn until(&self, timeline: &Timeline) -> u64 {
        let allowed = self.problem.time().map_or(u64::MAX, |most| timeline.after + u64::from(most));
        (timeline.steps + self.slack).min(allowed)
    }

    /// States along a plan without errors.
    fn checkpoints(&self, timeline: &Timeline, meter: &Meter<'_>) -> Option<Checkpoints> {
        let mut plays = Plays::new(self.problem);
        timeline.times(&vec![0; timeline.changes.len()], &mut plays.times);
        let (steps, size) = (timeline.steps - timeline.after, self.start.1.len() as u64);
        let every = (steps * size).div_ceil(MAX_BYTES).max(1);
        let mut points = Checkpoints { first: timeline.after, every, states: Vec::new(), places: Vec::new() };
        let mut state = self.start.1.to_vec();
        for step in timeline.after..=timeline.steps {
            points.places.push(
                self.player
                    .map(|player| (self.problem.sim.space(&state, player), self.problem.sim.position(&state, player))),
            );
            if (step - timeline.after).is_multiple_of(every) {
                points.states.push(state.clone());
            }
            let ending = plays.play(timeline, (step, &state), step + 1, Nature::Planned, meter);
            if ending == Ending::Stopped {
                return None;
            }
            state.clone_from(&plays.state);
        }
        Some(points)
    }
}

/// A space and a position in it, px.
pub type Place = (SpaceId, (f64, f64));

/// States along a plan.
struct Checkpoints {
    /// The number of the first.
    first: u64,
    /// Number of steps between two of them.
    every: u64,
    states: Vec<Vec<u8>>,
    /// Where the player is after each step.
    places: Vec<Option<Place>>,
}

impl Checkpoints {
    /// The last state at or before a step, with its number of steps.
    fn before(&self, step: u64) -> (u64, &[u8]) {
        let at = (step.saturating_sub(self.first) / self.every).min(self.states.len().saturating_sub(1) as u64);
        (self.first + at * self.every, self.states.get(at as usize).map_or(&[], Vec::as_slice))
    }

    /// The states, with their numbers of steps.
    fn states(self) -> impl Iterator<Item = (u64, Vec<u8>)> {
        let (first, every) = (self.first, self.every);
        (0..).zip(self.states).map(move |(index, state)| (first + index * every, state))
    }

    fn place(&self, step: u64) -> Option<Place> {
        self.places.get(step.checked_sub(self.first)? as usize).copied().flatten()
    }
}
