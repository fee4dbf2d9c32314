//! A plan as changes: presses and releases of buttons and moves of axes, each at its time. Each change can be made too
//! early or too late.

use crate::ir::{AxisId, ButtonId, PlayerId, World};
use crate::ordered::Ordered;
use crate::sim::{Control, Draws, Input, PlayerInput, Script};

use super::super::outcome::Plan;

/// A change of one button or axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// The button or axis.
    pub control: Control,
    /// The number of steps before it, from the initial state on.
    pub step: u64,
    /// Its value from then on: 0 and 1 for a button.
    pub value: f64,
    /// Whose errors it has: a change keeps them when a plan is edited.
    pub(super) key: u32,
}

/// A plan as changes of inputs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Timeline {
    /// The given steps before the search.
    given: Script,
    /// The inputs held at their end.
    held: Input,
    /// The changes by time.
    pub changes: Vec<Change>,
    /// For each change, the one before of the same control.
    before: Vec<Option<usize>>,
    /// Number of given steps.
    pub after: u64,
    /// Number of steps until the target holds.
    pub steps: u64,
    /// What nature draws in each step from `after` on; empty if nothing is fixed.
    nature: Vec<Draws>,
}

impl Timeline {
    /// The changes of a plan.
    pub fn new(world: &World, plan: &Plan) -> Timeline {
        let given = plan.script.first(plan.after);
        let mut held = Input::nothing(world.players.len());
        if let Some(last) = given.steps.last() {
            held.0.clone_from(&last.input.0);
        }
        let mut changes = Vec::new();
        let (mut now, mut step) = (held.clone(), 0);
        for part in &plan.script.steps {
            let end = step + u64::from(part.count);
            if end > plan.after {
                let at = step.max(plan.after);
                for player in world.players.ids() {
                    differences(player, (now.of(player), part.input.of(player)), at, &mut changes);
                }
                now.0.clone_from(&part.input.0);
            }
            step = end;
        }
        (0..).zip(&mut changes).for_each(|(key, change)| change.key = key);
        let has_draws = plan.script.steps.iter().any(|part| !part.input.1.is_empty());
        let drawn = plan.script.inputs().skip(plan.after as usize).filter(|_| has_draws).map(|input| input.1.clone());
        let nature = drawn.collect();
        Timeline::of(Timeline {
            given,
            held,
            changes,
            before: Vec::new(),
            after: plan.after,
            steps: plan.steps,
            nature,
        })
    }

    /// The same plan with other changes, which are put into order. Changes that change nothing are left out.
    pub fn with(&self, mut changes: Vec<Change>, steps: u64) -> Timeline {
        changes.order_by_key(|change| change.step);
        let mut now = self.held.clone();
        let mut kept: Vec<Change> = Vec::with_capacity(changes.len());
        for change in changes {
            // Of two changes of one control at one time, the later counts.
            let is_same = |other: &Change| (other.control, other.step) == (change.control, change.step);
            if let Some(at) = kept.iter().rposition(is_same) {
                kept.remove(at);
                now.set(change.control, value_before(&self.held, &kept, change.control));
            }
            if now.get(change.control) != change.value {
                now.set(change.control, change.value);
                kept.push(change);
            }
        }
        Timeline::of(Timeline { changes: kept, steps, ..self.clone() })
    }

    fn of(mut self) -> Timeline {
        let last = |at: usize| self.changes[..at].iter().rposition(|c| c.control == self.changes[at].control);
        self.before = (0..self.changes.len()).map(last).collect();
        self
    }

    /// Numbers the changes: the errors of each are those of its number.
    pub fn number(&mut self) {
        (0..).zip(&mut self.changes).for_each(|(key, change)| change.key = key);
    }

    /// The inputs held just before a step.
    pub fn input_before(&self, step: u64) -> Input {
        let mut now = self.held.clone();
        self.changes.iter().take_while(|change| change.step < step).for_each(|c| now.set(c.control, c.value));
        now
    }

    /// When each change happens if it is made `errors` steps too late: not before the search starts, and at least one
    /// step after the change before of the same control.
    pub fn times(&self, errors: &[i32], out: &mut Vec<u64>) {
        out.clear();
        for ((change, before), error) in self.changes.iter().zip(&self.before).zip(errors) {
            let least = match before {
                Some(before) => out.get(*before).map_or(self.after, |time| time + 1),
                None => self.after,
            };
            out.push(change.step.saturating_add_signed(i64::from(*error)).max(least));
        }
    }

    /// The inputs held at the start of the search.
    pub fn held(&self) -> &Input {
        &self.held
    }

    /// The value of a change's control before it.
    pub fn value_before(&self, change: usize) -> f64 {
        match self.before[change] {
            Some(before) => self.changes[before].value,
            None => self.held.get(self.changes[change].control),
        }
    }

    /// For each control that changes, its value before a step, as a change.
    pub fn held_before(&self, step: u64) -> Vec<Change> {
        let mut last: Vec<Change> = Vec::new();
        for change in &self.changes {
            if !last.iter().any(|known| known.control == change.control) {
                last.push(Change { value: self.held.get(change.control), ..*change });
            }
        }
        for held in &mut last {
            let before = self.changes.iter().rev().find(|c| c.control == held.control && c.step < step);
            held.value = before.map_or(held.value, |change| change.value);
        }
        last
    }

    /// What nature draws in a step, if the plan fixes it.
    pub fn drawn(&self, step: u64) -> Option<&Draws> {
        self.nature.get(usize::try_from(step.checked_sub(self.after)?).ok()?)
    }

    /// The plan as a script.
    pub fn script(&self) -> Script {
        let (mut script, mut now) = (self.given.clone(), self.held.clone());
        let mut next = self.changes.iter().peekable();
        for step in self.after..self.steps {
            while let Some(change) = next.next_if(|change| change.step <= step) {
                now.set(change.control, change.value);
            }
            now.1 = self.drawn(step).cloned().unwrap_or_default();
            script.push(&now, 1);
        }
        script
    }
}

/// The value of a control after some changes.
fn value_before(held: &Input, changes: &[Change], control: Control) -> f64 {
    let last = changes.iter().rev().find(|change| change.control == control);
    last.map_or_else(|| held.get(control), |change| change.value)
}

/// The changes from one input of a player to the next.
pub(super) fn differences(player: PlayerId, (old, new): (PlayerInput, PlayerInput), step: u64, out: &mut Vec<Change>) {
    for (axis, (a, b)) in (0..).zip(old.axes.into_iter().zip(new.axes)) {
        if a != b {
            out.push(Change { control: Control::Axis(player, AxisId(axis)), step, value: b, key: 0 });
        }
    }
    for button in (0..64).filter(|bit| (old.buttons ^ new.buttons) >> bit & 1 == 1) {
        let value = f64::from(u8::from(new.buttons >> button & 1 == 1));
        out.push(Change { control: Control::Button(player, ButtonId(button)), step, value, key: 0 });
    }
}
