//! How robust a path is, as a record of plain data.

use serde::{Deserialize, Serialize};

use crate::analysis::ConfigurationSpace;
use crate::sim::{Control, Input, Script, ScriptStep, Simulator};
use crate::watch::Watch;

use super::super::outcome::Plan;
use super::super::problem::Problem;
use super::super::robust::{
    Estimate, Improved, Jitter, Robustness, SLACK, Side, Window, estimate_success, improve_robustness,
    measure_robustness,
};
use super::super::search::{Limits, Settings};

/// Timing errors that a path must withstand.
#[derive(Debug, Clone, Copy)]
pub struct TimingErrors {
    /// The standard deviation, steps.
    pub sigma: f64,
    /// Number of plays.
    pub trials: u64,
    pub(super) methods: Methods,
}

/// Measures a path: its seed, number of plays and number of threads.
type Measure<T> = fn(&Problem<'_>, &Plan, &Jitter, (u64, u64, usize), &dyn Watch) -> Option<T>;

/// Searches for a better path.
type Improve = fn(&Problem<'_>, &ConfigurationSpace, (&Settings, &Limits), &Plan, &Jitter, &dyn Watch) -> Improved;

/// What answers the question. It is a part of the question, so that a program which never asks it does not contain it:
/// the engine for browsers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Methods {
    pub improve: Improve,
    pub robustness: Measure<Robustness>,
    pub success: Measure<Estimate>,
}

impl TimingErrors {
    /// Errors of a standard deviation, in steps, and the number of plays.
    pub fn new(sigma: f64, trials: u64) -> Self {
        let methods =
            Methods { improve: improve_robustness, robustness: measure_robustness, success: estimate_success };
        TimingErrors { sigma, trials, methods }
    }
}

/// What a search for a robust path has found.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundRobust {
    /// The path that was found first, if it is another one, and how often it succeeds.
    pub first: Option<(Plan, Estimate)>,
    /// Number of paths that were compared.
    pub compared: u64,
    /// How robust the path is.
    pub robustness: Robustness,
}

/// How probable it is that a path succeeds: an estimate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct SuccessRecord {
    /// Number of plays.
    pub trials: u64,
    /// Those that succeeded.
    pub successes: u64,
    /// Their share.
    pub success: f64,
    /// The confidence interval of the probability at 95 % (Wilson).
    pub success_95: [f64; 2],
}

impl SuccessRecord {
    fn new(estimate: Estimate) -> Self {
        SuccessRecord {
            trials: estimate.trials,
            successes: estimate.successes,
            success: estimate.probability(),
            success_95: estimate.interval(),
        }
    }
}

/// The path that was found before a more robust one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct FirstPath {
    /// Number of its steps.
    pub steps: u64,
    /// Its inputs, as a script.
    pub inputs: String,
    /// How probable its success is.
    #[serde(flatten)]
    pub success: SuccessRecord,
}

/// A change of an input, with its window.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct ChangeRecord {
    /// The number of steps before it, from the initial state on.
    pub step: u64,
    /// The same as a time, s.
    pub seconds: f64,
    /// The player, by number.
    pub player: u32,
    /// The name of the button or axis.
    pub control: String,
    /// What happens, in words: `jump pressed`, `left to right`.
    pub what: String,
    /// The value from then on: 0 and 1 for a button.
    pub value: f64,
    /// By how many steps it alone can be too early; null: by any number, as it cannot come before the start or before the
    /// last change of its button.
    pub early: Option<u32>,
    /// Whether more steps were not tried.
    pub early_is_least: bool,
    /// By how many steps it alone can be too late.
    pub late: Option<u32>,
    /// Whether more steps were not tried.
    pub late_is_least: bool,
    /// The probability of success if only this change has a timing error.
    pub alone: f64,
    /// The space that the first player is in then; null without players.
    pub space: Option<String>,
    /// The first player's x and y, px.
    pub at: Option<[f64; 2]>,
}

impl ChangeRecord {
    /// Whether it can be missed.
    pub fn needs_timing(&self) -> bool {
        let is_limited = |side: Option<u32>, is_least: bool| side.is_some() && !is_least;
        is_limited(self.early, self.early_is_least) || is_limited(self.late, self.late_is_least)
    }

    /// `3 early, 5 late`, in steps.
    pub fn window(&self) -> String {
        let side = |steps: Option<u32>, is_least: bool| match steps {
            None => "any".to_string(),
            Some(steps) if is_least => format!("{steps} or more"),
            Some(steps) => steps.to_string(),
        };
        let (early, late) = (side(self.early, self.early_is_least), side(self.late, self.late_is_least));
        format!("{early} early, {late} late")
    }
}

/// How robust a path is under timing errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct RobustRecord {
    /// The standard deviation of the errors before they are rounded, steps.
    pub sigma: f64,
    /// How much later than planned the goal may hold, s.
    pub slack: f64,
    /// How probable the path's success is.
    #[serde(flatten)]
    pub success: SuccessRecord,
    /// The path that was found first; null if it is the same.
    pub first: Option<FirstPath>,
    /// Number of paths that were compared.
    pub compared: u64,
    /// The changes of inputs, by time.
    pub changes: Vec<ChangeRecord>,
    /// The index of the hardest of them; null if none has to be timed.
    pub hardest: Option<usize>,
}

impl RobustRecord {
    pub(super) fn new(sim: &Simulator, errors: TimingErrors, found: &FoundRobust) -> Self {
        let (program, world) = (sim.program(), sim.world_id());
        let robustness = &found.robustness;
        let hardest = robustness.hardest();
        let first = found.first.as_ref().map(|(plan, success)| FirstPath {
            steps: plan.steps,
            inputs: plan.script.text(program, world),
            success: SuccessRecord::new(*success),
        });
        RobustRecord {
            sigma: Jitter::new(errors.sigma).sigma(),
            slack: SLACK,
            success: SuccessRecord::new(robustness.success),
            first,
            compared: found.compared,
            changes: robustness.windows.iter().map(|window| record(sim, window)).collect(),
            hardest: robustness
                .windows
                .iter()
                .position(|window| hardest.is_some_and(|other| std::ptr::eq(other, window))),
        }
    }
}

fn record(sim: &Simulator, window: &Window) -> ChangeRecord {
    let (Control::Button(player, _) | Control::Axis(player, _)) = window.change.control;
    let table = &sim.world().players[player];
    let entity = &sim.program().entities[sim.world().slots[table.slot].entity];
    let side = |side: Side| match side {
        Side::Steps(steps) => (Some(steps), false),
        Side::AtLeast(steps) => (Some(steps), true),
        Side::Any => (None, false),
    };
    let ((early, early_is_least), (late, late_is_least)) = (side(window.early), side(window.late));
    ChangeRecord {
        step: window.change.step,
        seconds: window.change.step as f64 * sim.world().step.seconds(),
        player: table.number,
        control: match window.change.control {
            Control::Button(_, button) => entity.buttons[button].clone(),
            Control::Axis(_, axis) => entity.axes[axis].clone(),
        },
        what: words(sim, window),
        value: window.change.value,
        early,
        early_is_least,
        late,
        late_is_least,
        alone: window.alone,
        space: window.place.map(|(space, _)| sim.world().spaces[space].name.clone()),
        at: window.place.map(|(_, (x, y))| [x, y]),
    }
}

/// What a change does, in words.
fn words(sim: &Simulator, window: &Window) -> String {
    let control = window.change.control;
    // As scripts write it.
    let named = |value: f64| {
        let mut input = Input::nothing(sim.world().players.len());
        input.set(control, value);
        Script { steps: vec![ScriptStep { input, count: 1 }] }.text(sim.program(), sim.world_id())
    };
    match (window.before != 0.0, window.change.value != 0.0) {
        (true, true) => format!("{} to {}", named(window.before), named(window.change.value)),
        (_, true) => format!("{} pressed", named(window.change.value)),
        (_, false) => format!("{} released", named(window.before)),
    }
}
