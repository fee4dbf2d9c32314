//! How high, how far and how fast a player is, measured on flat ground in the simulator: each input alone, with each input
//! that moves the player sideways, from standing still and from its greatest speed, and with each end of an axis. Nothing is derived from the
//! text of a program: a figure is what a run did, and says nothing of inputs that were not tried.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Serialize;

use crate::ir::{AxisId, ButtonId, Extremes, Id, ModeId, PlayerId, Program, SlotId, World, WorldId};
use crate::sim::{Input, PlayerInput, Script, State};
use crate::watch::Meter;

use super::flat::{Flat, go, velocity};

/// How long a player runs until its speed counts as the greatest, s.
const RUNNING: f64 = 5.0;
/// How long it may take until a player leaves the ground, s.
const WAITING: f64 = 3.0;
/// How long it may be in the air, s.
const FLYING: f64 = 20.0;
/// For how long an input is held that is let go on the ground, s.
const CHARGING: f64 = 1.0;
/// What counts as a rise, px.
const RISE: f64 = 0.5;
/// The tolerance of heights and speeds: noise of rounding.
const NOISE: f64 = 1e-6;
/// Maximum number of inputs of an entity that are tried in pairs.
const MAX_PAIRED: usize = 12;
/// Maximum number of steps for one player.
const MAX_STEPS: u64 = 2_000_000;

/// For how long an input is pressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Press {
    /// Until the player lands.
    Held,
    /// For one step.
    Tapped,
    /// For one second; measured where the player does not leave the ground before that.
    Released,
}

/// A jump, from where a player leaves the ground to where it is at the same height again.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Jump {
    /// The input, as in scripts.
    pub input: String,
    /// For how long it is pressed.
    pub press: Press,
    /// Other inputs that are held all the time, as in scripts; empty if there are none.
    pub with: String,
    /// Whether these were held before, until the speed no longer grew.
    pub running: bool,
    /// The sideways speed before, px/s.
    pub speed: f64,
    /// How high it rises, px.
    pub rise: f64,
    /// How far from where it left the ground it lands, px; null if it does not within 20 s.
    pub length: Option<f64>,
    /// How long it is in the air, s; null as above.
    pub seconds: Option<f64>,
}

/// The greatest speeds in a mode, at the end of a step, in all of the runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Speed {
    /// The mode.
    pub mode: String,
    /// Sideways, px/s.
    pub sideways: f64,
    /// Upwards, px/s.
    pub up: f64,
    /// Downwards, px/s.
    pub down: f64,
}

/// What was measured of a player.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Figures {
    /// The number of the player.
    pub player: u32,
    /// Its instance.
    pub instance: String,
    /// The entity.
    pub entity: String,
    /// The tags of the ground.
    pub ground: Vec<String>,
    /// Jumps: inputs that do not lead off the ground are left out.
    pub jumps: Vec<Jump>,
    /// Speeds by mode.
    pub speeds: Vec<Speed>,
}

/// Measures all players of a world that stand on flat ground; those that never do are left out. None if it was stopped.
pub fn measure(program: &Arc<Program>, world: WorldId, meter: &Meter<'_>) -> Option<Vec<Figures>> {
    let mut all = Vec::new();
    let table = &program.worlds[world];
    for (id, player) in table.players.pairs() {
        if let Some(flat) = Flat::new(program, world, player.slot) {
            let mut gauge = Gauge::new(&flat, id, meter);
            let jumps = gauge.jumps()?;
            // What stays where it is put jumps if it comes back to the ground by itself.
            let comes_back = |jump: &Jump| jump.press != Press::Held && jump.length.is_some();
            if !flat.is_pulled && !jumps.iter().any(comes_back) {
                continue;
            }
            all.push(Figures {
                player: player.number,
                instance: table.slots[player.slot].name.clone(),
                entity: program.entities[table.slots[player.slot].entity].name.to_string(),
                ground: flat.ground.clone(),
                jumps,
                speeds: gauge.speeds(),
            });
        }
    }
    Some(all)
}

/// A button, or an end of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Control {
    Button(ButtonId),
    Axis(AxisId, f64),
}

/// Measures one player.
struct Gauge<'f> {
    flat: &'f Flat,
    player: PlayerId,
    meter: &'f Meter<'f>,
    scratch: crate::sim::Scratch,
    /// Greatest speeds so far: sideways, up, down.
    speeds: BTreeMap<ModeId, [f64; 3]>,
    steps: u64,
}

/// A player that moves along the ground.
struct Run {
    controls: Vec<Control>,
    state: State,
    speed: f64,
}

impl<'f> Gauge<'f> {
    fn new(flat: &'f Flat, player: PlayerId, meter: &'f Meter<'f>) -> Self {
        Gauge { flat, player, meter, scratch: flat.sim.scratch(), speeds: BTreeMap::new(), steps: 0 }
    }

    fn world(&self) -> &'f World {
        self.flat.sim.world()
    }

    fn slot(&self) -> SlotId {
        self.flat.slot
    }

    /// A number of seconds in steps.
    fn steps_of(&self, seconds: f64) -> u64 {
        (seconds / self.world().step.seconds()).ceil() as u64
    }

    fn controls(&self) -> Vec<Control> {
        let entity = self.flat.player(&self.flat.state).entity();
        let ends = entity.axes.ids().flat_map(|axis| [-1.0, 1.0].map(|end| Control::Axis(axis, end)));
        entity.buttons.ids().map(Control::Button).chain(ends).collect()
    }

    fn input(&self, controls: &[Control]) -> Input {
        let mut player = PlayerInput::default();
        for control in controls {
            match *control {
                Control::Button(button) => player.buttons |= 1 << button.index(),
                Control::Axis(axis, value) => player.axes[axis.index()] = value,
            }
        }
        let mut players = vec![PlayerInput::default(); self.world().players.len()];
        players[self.player.index()] = player;
        Input::of_players(players)
    }

    /// Controls as a script writes them.
    fn words(&self, controls: &[Control]) -> String {
        if controls.is_empty() {
            return String::new();
        }
        let mut script = Script::default();
        script.push(&self.input(controls), 1);
        script.text(self.flat.sim.program(), self.flat.sim.world_id())
    }

    /// One step. `Ok(false)` if the player is gone or a rule is broken; an error if all is to end.
    fn step(&mut self, state: &mut State, input: &Input) -> Result<bool, Stopped> {
        self.steps += 1;
        if self.meter.spend(1) || self.steps > MAX_STEPS {
            return Err(Stopped);
        }
        if go(&self.flat.sim, state, input, &mut self.scratch).is_none() {
            return Ok(false);
        }
        let player = self.flat.player(state);
        if !player.is_alive() || player.space() != self.world().slots[self.flat.slot].space {
            return Ok(false);
        }
        let (x, y) = velocity(player);
        for mode in player.modes() {
            let known = self.speeds.entry(mode).or_insert([0.0; 3]);
            for (known, now) in known.iter_mut().zip([x.abs(), y, -y]) {
                *known = known.greatest(now);
            }
        }
        Ok(true)
    }

    fn y(&self, state: &State) -> f64 {
        self.flat.sim.position(state, self.slot()).1
    }

    /// Holds controls on the ground until the speed no longer grows. None if the player leaves its height.
    fn run(&mut self, controls: &[Control]) -> Result<Option<Run>, Stopped> {
        let (mut state, input) = (self.flat.state.clone(), self.input(controls));
        let y = self.y(&state);
        for _ in 0..self.steps_of(RUNNING) {
            if !self.step(&mut state, &input)? || (self.y(&state) - y).abs() > NOISE {
                return Ok(None);
            }
        }
        let speed = velocity(self.flat.player(&state)).0;
        Ok(Some(Run { controls: controls.to_vec(), state, speed }))
    }

    /// Inputs that move the player along the ground, alone, and with another input that changes the speed; and those that
    /// leave it where it is.
    fn runs(&mut self, controls: &[Control]) -> Result<(Vec<Run>, Vec<Control>), Stopped> {
        let Some(rest) = self.run(&[])? else { return Ok((Vec::new(), Vec::new())) };
        let mut singles = Vec::new();
        let mut others = Vec::new();
        for &control in controls {
            match self.run(&[control])? {
                Some(run) if (run.speed - rest.speed).abs() > NOISE => singles.push(run),
                // What only turns the player, or does nothing by itself.
                Some(_) => others.push(control),
                None => {}
            }
        }
        let mut pairs = Vec::new();
        for single in &singles {
            for other in others.iter().take(MAX_PAIRED) {
                let both: Vec<Control> = single.controls.iter().copied().chain([*other]).collect();
                let run = self.run(&both)?;
                pairs.extend(run.filter(|run| (run.speed - single.speed).abs() > NOISE));
            }
        }
        singles.extend(pairs);
        Ok((singles, others))
    }

    /// All jumps; none if it was stopped.
    fn jumps(&mut self) -> Option<Vec<Jump>> {
        let mut jumps = Vec::new();
        match self.all_jumps(&mut jumps) {
            // What takes too long is measured in part; a stopped measurement says nothing.
            Err(Stopped) if self.meter.is_stopped() => None,
            _ => Some(jumps),
        }
    }

    fn all_jumps(&mut self, jumps: &mut Vec<Jump>) -> Result<(), Stopped> {
        let controls = self.controls();
        let (runs, others) = self.runs(&controls)?;
        for &control in &controls {
            let is_other = |run: &&Run| !run.controls.iter().any(|held| is_same_input(*held, control));
            let mut starts: Vec<(Vec<Control>, Option<&Run>)> = vec![(Vec::new(), None)];
            let single = |run: &&Run| run.controls.len() == 1;
            starts.extend(runs.iter().filter(single).filter(is_other).map(|run| (run.controls.clone(), None)));
            // What does not move it along the ground may direct a jump.
            let directs = |held: &&Control| matches!(held, Control::Axis(..)) && !is_same_input(**held, control);
            starts.extend(others.iter().filter(directs).map(|held| (vec![*held], None)));
            starts.extend(runs.iter().filter(is_other).map(|run| (run.controls.clone(), Some(run))));
            for (with, run) in starts {
                let held = self.jump(control, Press::Held, &with, run)?;
                let is_held = held.is_some();
                jumps.extend(held);
                jumps.extend(self.jump(control, Press::Tapped, &with, run)?);
                if !is_held {
                    jumps.extend(self.jump(control, Press::Released, &with, run)?);
                }
            }
        }
        Ok(())
    }

    /// A jump by pressing a control while others are held; none if the player stays on the ground.
    fn jump(
        &mut self,
        control: Control,
        press: Press,
        with: &[Control],
        run: Option<&Run>,
    ) -> Result<Option<Jump>, Stopped> {
        let mut state = run.map_or(&self.flat.state, |run| &run.state).clone();
        let (without, all) = (self.input(with), with.iter().copied().chain([control]).collect::<Vec<_>>());
        let pressed = self.input(&all);
        let pressing = match press {
            Press::Held => u64::MAX,
            Press::Tapped => 1,
            Press::Released => self.steps_of(CHARGING),
        };
        let ground = self.y(&state);
        let start_speed = velocity(self.flat.player(&state)).0.abs();
        let (waiting, flying) = (self.steps_of(WAITING), self.steps_of(FLYING));
        let (mut rise, mut taken_off, mut takeoff): (f64, Option<u64>, f64) = (0.0, None, 0.0);
        for step in 1.. {
            let before = self.flat.sim.position(&state, self.slot()).0;
            let input = if step <= pressing { &pressed } else { &without };
            if !self.step(&mut state, input)? {
                return Ok(None);
            }
            let (x, y) = self.flat.sim.position(&state, self.slot());
            rise = rise.greatest(y - ground);
            let is_up = y > ground + NOISE;
            let since = match taken_off {
                None if is_up => {
                    (taken_off, takeoff) = (Some(step - 1), before);
                    continue;
                }
                // Off the ground without a rise: it fell, or sank into it.
                None if step >= waiting || y < ground - RISE => return Ok(None),
                None => continue,
                Some(since) => since,
            };
            let lands = !is_up;
            if !lands && step - since < flying {
                continue;
            }
            if rise < RISE {
                return Ok(None);
            }
            let seconds = self.world().step.frames((step - since) as f64);
            return Ok(Some(Jump {
                input: self.words(&[control]),
                press,
                with: self.words(with),
                running: run.is_some(),
                speed: start_speed,
                rise,
                length: lands.then_some((x - takeoff).abs()),
                seconds: lands.then_some(seconds),
            }));
        }
        Ok(None)
    }

    /// The speeds of modes that exclude each other.
    fn speeds(&self) -> Vec<Speed> {
        let entity = self.flat.player(&self.flat.state).entity();
        let leaves = |mode: ModeId| entity.leaves_of(&entity.groups[entity.modes[mode].group]).len();
        let has_choice = self.speeds.keys().any(|mode| leaves(*mode) > 1);
        let shown = self.speeds.iter().filter(|(mode, _)| !has_choice || leaves(**mode) > 1);
        shown
            .map(|(mode, [sideways, up, down])| Speed {
                mode: entity.modes[*mode].path.clone(),
                sideways: *sideways,
                up: *up,
                down: *down,
            })
            .collect()
    }
}

/// Whether two controls are the same button, or ends of the same axis.
fn is_same_input(a: Control, b: Control) -> bool {
    match (a, b) {
        (Control::Button(a), Control::Button(b)) => a == b,
        (Control::Axis(a, _), Control::Axis(b, _)) => a == b,
        _ => false,
    }
}

/// The measurement was stopped, or takes too long.
struct Stopped;
