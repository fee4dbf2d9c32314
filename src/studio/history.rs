//! The run that is played: the inputs of all its steps, and states on the way, so that any frame is a few steps from one
//! that is kept. The states that are kept are bounded in number, however long one plays.

use std::sync::Arc;

use crate::ir::Id;
use crate::sim::{Event, Fault, Input, Run, Script, Simulator, State, TraceFormat, TraceLines};

use super::protocol::{EventInfo, Frame, Shown};
use super::scene::{frame, places};

/// Number of steps between two kept states at first.
const SPACING: u64 = 64;
/// Maximum number of kept states: if there are as many, every second one is dropped.
const MAX_KEPT: usize = 512;
/// Maximum number of events that one answer reports.
const MAX_EVENTS: usize = 2_000;
/// Maximum number of steps of a run: ten hours at 60 steps a second.
pub(super) const MAX_LENGTH: u64 = 60 * 60 * 60 * 10;

/// A run and its history.
pub(super) struct History {
    run: Run,
    /// The inputs of all steps.
    script: Script,
    /// Number of steps before each part of the script.
    starts: Vec<u64>,
    length: u64,
    /// Whether the first state is that of another program.
    is_carried: bool,
    /// Kept states by the number of steps before them.
    kept: Vec<(u64, State)>,
    spacing: u64,
    /// The state before the current one.
    before: Option<State>,
    /// Why the run ends with the last frame of the history.
    ended: Option<String>,
    events: Vec<EventInfo>,
}

impl History {
    /// A run that has not begun.
    ///
    /// # Errors
    /// A [`Fault`] if the initial state breaks a rule of the language.
    pub fn new(sim: &Arc<Simulator>) -> Result<History, Fault> {
        let run = Run::of(Arc::clone(sim))?;
        let kept = vec![(0, run.state().clone())];
        let mut history = History {
            run,
            script: Script::default(),
            starts: Vec::new(),
            length: 0,
            is_carried: false,
            kept,
            spacing: SPACING,
            before: None,
            ended: None,
            events: Vec::new(),
        };
        history.ended = history.reason_to_end();
        Ok(history)
    }

    /// A run that begins with a state that was carried over from another program.
    ///
    /// # Errors
    /// As [`History::new`].
    pub fn carried(sim: &Arc<Simulator>, state: &State) -> Result<History, Fault> {
        let mut history = History::new(sim)?;
        history.run.set_state(state);
        history.kept = vec![(0, state.clone())];
        history.is_carried = true;
        history.ended = history.reason_to_end();
        Ok(history)
    }

    /// Whether the first state is that of another program: then the script does not lead to the other states.
    pub fn is_carried(&self) -> bool {
        self.is_carried
    }

    pub fn sim(&self) -> &Arc<Simulator> {
        self.run.simulator()
    }

    /// The inputs of all steps.
    pub fn script(&self) -> &Script {
        &self.script
    }

    /// Number of the frame that is shown.
    pub fn at(&self) -> u64 {
        self.run.steps()
    }

    /// Number of steps of the history.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// The state of the frame that is shown.
    pub fn state(&self) -> &State {
        self.run.state()
    }

    /// The state before the current one, and the input of the step between them, as it was drawn.
    pub fn last_step(&self) -> Option<(&State, Input)> {
        let at = self.at();
        let input = self.input(at.checked_sub(1)?)?;
        let drawn = self.sim().draw(0, at, input).into_owned();
        Some((self.before.as_ref()?, drawn))
    }

    /// The input of the step after a frame.
    fn input(&self, frame: u64) -> Option<&Input> {
        let part = self.starts.partition_point(|&start| start <= frame).checked_sub(1)?;
        let step = self.script.steps.get(part)?;
        (frame - self.starts[part] < u64::from(step.count)).then_some(&step.input)
    }

    /// Steps on from the current frame and drops what the history has after it. Returns whether it stepped: a run that
    /// has ended does not go on.
    pub fn step(&mut self, input: &Input) -> bool {
        let at = self.at();
        if at < self.length {
            self.cut(at);
        }
        if self.ended.is_some() || at >= MAX_LENGTH {
            return false;
        }
        if !self.advance(input) {
            return false;
        }
        let parts = self.script.steps.len();
        self.script.push(input, 1);
        if self.script.steps.len() > parts {
            self.starts.push(at);
        }
        self.length = at + 1;
        self.ended = self.reason_to_end();
        true
    }

    /// Steps the run, and keeps what is asked of the step.
    fn advance(&mut self, input: &Input) -> bool {
        let before = self.run.state().clone();
        let at = self.at() + 1;
        let mut events = Vec::new();
        if let Err(fault) = self.run.step_with_events(input, &mut |event| events.push(event)) {
            let fact = fault.fact(self.sim().program(), self.sim().world_id(), at);
            self.ended = Some(format!("{} ({}, step {at})", fact.what, fact.instance));
            return false;
        }
        self.before = Some(before);
        for event in events {
            self.note(at, event);
        }
        if at.is_multiple_of(self.spacing) && self.kept.last().is_none_or(|(last, _)| *last < at) {
            self.kept.push((at, self.run.state().clone()));
            if self.kept.len() > MAX_KEPT {
                self.spacing *= 2;
                let spacing = self.spacing;
                self.kept.retain(|(at, _)| at.is_multiple_of(spacing));
            }
        }
        true
    }

    fn note(&mut self, frame: u64, event: Event) {
        let world = self.run.world();
        let slot = |slot| world.slots[slot].name.clone();
        let (kind, name) = match event {
            Event::Goal(goal) => ("goal", world.goals[goal].name.clone()),
            Event::Never(never) => ("never", world.nevers[never].name.clone()),
            Event::Spawned(of) => ("spawned", slot(of)),
            Event::Destroyed(of) => ("destroyed", slot(of)),
            Event::Entered(of, _) => ("entered", slot(of)),
            Event::Edge(..) | Event::Touched(..) | Event::Parted(..) | Event::Broken(_) | Event::Restored(_) => return,
        };
        if self.events.len() < MAX_EVENTS {
            self.events.push(EventInfo { frame, kind: kind.into(), name });
        }
    }

    /// Drops the history after a frame.
    fn cut(&mut self, frame: u64) {
        self.script = self.script.first(frame);
        self.starts.truncate(self.script.steps.len());
        self.kept.retain(|(at, _)| *at <= frame);
        self.length = frame;
        self.ended = self.reason_to_end();
    }

    /// Why a run ends in the current state.
    fn reason_to_end(&self) -> Option<String> {
        let slot = self.sim().left_bounds(self.run.state())?;
        Some(format!("{} left the bounds", self.run.world().slots[slot].name))
    }

    /// Shows another frame of the history; the last one if there are not so many.
    pub fn seek(&mut self, frame: u64) {
        let frame = frame.min(self.length);
        // What happened on the way was told when it was played.
        let untold = std::mem::take(&mut self.events);
        self.go_to(frame);
        self.events = untold;
    }

    fn go_to(&mut self, frame: u64) {
        if frame == self.at() {
            return;
        }
        // The frame before is drawn, too: from a kept state before both.
        let from = self.kept.partition_point(|(at, _)| *at < frame).saturating_sub(1);
        let is_ahead = self.at() < frame && self.kept.get(from).is_none_or(|(at, _)| *at <= self.at());
        if !is_ahead && let Some((at, state)) = self.kept.get(from) {
            let (at, state) = (*at, state.clone());
            self.run.set_state(&state);
            self.run.set_steps(at);
            self.before = None;
        }
        let ended = self.ended.take();
        while self.at() < frame {
            let Some(input) = self.input(self.at()).cloned() else { break };
            if !self.advance(&input) {
                break;
            }
        }
        self.ended = ended;
    }

    /// Plays a script from the first state. Returns the number of steps that were played.
    pub fn play(&mut self, script: &Script) -> u64 {
        self.seek(0);
        self.cut(0);
        self.events.clear();
        for input in script.inputs() {
            if !self.step(input) {
                break;
            }
        }
        self.length
    }

    /// The positions of the players in the next steps, if an input is held; as
    /// [`Answer::Predicted`](super::protocol::Answer::Predicted).
    pub fn predict(&self, input: &Input, steps: u32) -> Vec<Vec<[f64; 3]>> {
        let mut run = self.run.clone();
        let mut paths = Paths::new(self.sim(), run.state());
        for _ in 0..steps {
            if self.sim().left_bounds(run.state()).is_some() || run.step(input).is_err() {
                break;
            }
            paths.add(self.sim(), run.state());
        }
        paths.0.into_iter().map(|(path, _)| path).collect()
    }

    /// The positions of the players over the frames of the history, at most `most` of them.
    pub fn paths(&self, most: u64) -> Vec<Vec<[f64; 3]>> {
        if self.length == 0 {
            return Vec::new();
        }
        paths_of(self.sim(), &self.script.first(most), 0)
    }

    /// Some frames as lines of a trace.
    pub fn trace(&mut self, from: u64, count: u32) -> String {
        let (at, sim) = (self.at(), Arc::clone(self.sim()));
        let lines = TraceLines::new(&sim, TraceFormat::Jsonl);
        let mut out = String::new();
        for frame in from..from.saturating_add(u64::from(count)).min(self.length + 1) {
            self.seek(frame);
            let input = frame.checked_sub(1).and_then(|before| self.input(before));
            let input = input.map_or_else(|| self.run.nothing(), |input| self.run.drawn(input));
            // Infallible: writes to memory.
            out.push_str(&lines.state(frame, &input, self.run.state()).unwrap_or_default());
        }
        self.seek(at);
        out
    }

    /// What the page shows now.
    pub fn shown(&mut self) -> Shown {
        let at = self.at();
        let before = at.checked_sub(1).zip(self.before.as_ref());
        let before = before.map(|(at, state)| frame(self.sim(), state, at));
        let ended = self.ended.clone().filter(|_| at == self.length);
        let events = std::mem::take(&mut self.events);
        Shown { frame: self.current(), before, length: self.length, events, is_carried: self.is_carried, ended }
    }

    fn current(&self) -> Frame {
        frame(self.sim(), self.run.state(), self.at())
    }

    /// The input of a step from what the players hold.
    pub fn input_of(&self, held: &[super::protocol::Held]) -> Input {
        let mut input = self.run.nothing();
        for (of, held) in input.0.iter_mut().zip(held) {
            for &button in held.buttons.iter().filter(|button| **button < 64) {
                of.buttons |= 1 << button;
            }
            for (axis, &value) in of.axes.iter_mut().zip(&held.axes) {
                *axis = if value.is_nan() { 0.0 } else { value.clamp(-1.0, 1.0) };
            }
        }
        // Buttons that there are.
        for ((_, player), of) in self.run.world().players.pairs().zip(&mut input.0) {
            let entity = self.run.instance(player.slot).entity();
            let all = entity.buttons.ids().fold(0, |all, button| all | 1 << button.index());
            of.buttons &= all;
            for axis in of.axes.iter_mut().skip(entity.axes.len()) {
                *axis = 0.0;
            }
        }
        input
    }
}

/// The positions of players, and whether each is still there.
struct Paths(Vec<(Vec<[f64; 3]>, bool)>);

impl Paths {
    fn new(sim: &Simulator, state: &[u8]) -> Self {
        let mut paths = Paths(vec![(Vec::new(), true); sim.world().players.len()]);
        paths.add(sim, state);
        paths
    }

    fn add(&mut self, sim: &Simulator, state: &[u8]) {
        for ((path, is_there), place) in self.0.iter_mut().zip(places(sim, state)) {
            match place {
                Some(place) if *is_there => path.push(place),
                _ => *is_there = false,
            }
        }
    }
}

/// The positions of the players along a script, from one of its frames on.
pub(super) fn paths_of(sim: &Arc<Simulator>, script: &Script, from: u64) -> Vec<Vec<[f64; 3]>> {
    let Ok(mut run) = Run::of(Arc::clone(sim)) else { return Vec::new() };
    let mut paths = (from == 0).then(|| Paths::new(sim, run.state()));
    for input in script.inputs() {
        if run.step(input).is_err() {
            break;
        }
        match &mut paths {
            Some(paths) => paths.add(sim, run.state()),
            None if run.steps() == from => paths = Some(Paths::new(sim, run.state())),
            None => {}
        }
    }
    paths.map_or(Vec::new(), |paths| paths.0.into_iter().map(|(path, _)| path).collect())
}
