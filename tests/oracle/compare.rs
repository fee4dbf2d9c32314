//! Comparison of the simulator's states with those of the reference interpreter, to the bit.

use hypedc::ir::{Id, Program, SlotId, SpaceId, WorldId};
use hypedc::sema::checked::Checked;
use hypedc::sim::state::real;
use hypedc::sim::{DrawId, FaultKind, Input, PlayerInput, Simulator};
use rand::{Rng, RngExt};
use std::collections::BTreeMap;
use std::sync::Arc;

use super::evaluate::{longest, touching};
use super::model::{Fault, Keys, Moves, Oracle, State};

/// Converts the input of a step for the simulator.
pub fn input(moves: &Moves) -> Input {
    let one = |keys: &Keys| PlayerInput { buttons: keys.held.iter().map(|b| 1u64 << b).sum(), axes: keys.axes };
    let mut input = Input::of_players(moves.keys.iter().map(one).collect());
    for (draw, value) in (0..).map(DrawId).zip(moves.drawn.iter().flatten()) {
        input.1.set(draw, Some(*value));
    }
    input
}

fn kind(fault: FaultKind) -> Fault {
    match fault {
        FaultKind::NotFinite(..) => Fault::NotFinite,
        FaultKind::DivisionByZero(..) => Fault::DivisionByZero,
        FaultKind::Diverged(..) => Fault::Diverged,
        FaultKind::OutOfRange(..) => Fault::OutOfRange,
        FaultKind::ReadNone(_) => Fault::ReadNone,
    }
}

/// A compact text of inputs.
fn written(moves: &Moves) -> String {
    let one = |keys: &Keys| format!("{:?}{:?}", keys.held, &keys.axes[..2]);
    let drawn = moves.drawn.iter().flatten().map(|value| format!("?{value}"));
    moves.keys.iter().map(one).chain(drawn).collect::<Vec<_>>().join(" ").replace(' ', "")
}

/// A run of both.
pub struct Run {
    /// Each step's input as text.
    pub script: Vec<String>,
    /// The first difference, if there is one.
    pub difference: Option<String>,
    /// The steps that both have done.
    pub steps: usize,
    /// Whether both had a run-time fault.
    pub faulted: bool,
}

/// Runs both with random inputs until they differ, fault, or reach a number of steps.
pub fn run(program: &Arc<Program>, checked: &Checked, world: WorldId, steps: usize, rng: &mut impl Rng) -> Run {
    let oracle = Oracle::new(checked, world);
    let sim = Simulator::new(program, world);
    let mut scratch = sim.scratch();
    let mut run = Run { script: Vec::new(), difference: None, steps: 0, faulted: false };
    let (mut theirs, mut ours) = match (sim.initial(&mut scratch), oracle.initial()) {
        (Ok(theirs), Ok(ours)) => (theirs, ours),
        (Err(theirs), Err(ours)) if kind(theirs.kind) == ours => return Run { faulted: true, ..run },
        (theirs, ours) => {
            let (theirs, ours) = (theirs.map(|_| "a state"), ours.map(|_| "a state"));
            run.difference = Some(format!("at the start: simulator {theirs:?}, interpreter {ours:?}"));
            return run;
        }
    };
    let mut moves = Moves { keys: oracle.world.players.iter().map(|_| Keys::default()).collect(), drawn: Vec::new() };
    let mut before: Vec<String> = Vec::new();
    loop {
        let mut all = differences(&sim, &theirs, &ours);
        all.extend(questions(&sim, &theirs, &oracle, &ours));
        if !all.is_empty() {
            let before = before.join("\n  ");
            run.difference = Some(format!("after step {}:\n  {}\nbefore it:\n  {before}", run.steps, all.join("\n  ")));
            return run;
        }
        if run.steps == steps {
            return run;
        }
        for (player, keys) in moves.keys.iter_mut().enumerate() {
            if rng.random_range(0..4) > 0 && run.steps > 0 {
                continue;
            }
            let entity = oracle.entity(oracle.world.players.iter().nth(player).unwrap().slot.index());
            keys.held = (0..entity.buttons.len() as u32).filter(|_| rng.random_range(0..2) == 0).collect();
            for axis in keys.axes.iter_mut().take(entity.axes.len()) {
                *axis = [-1.0, 0.0, 1.0, 0.3, -0.75][rng.random_range(0..5)];
            }
        }
        let slots = 0..oracle.world.instances.len();
        moves.drawn = slots.map(|slot| draws(&oracle, slot, |low, high| rng.random_range(low..=high))).collect();
        run.script.push(written(&moves));
        let last: Vec<String> = ours.things.iter().flatten().map(|thing| format!("{thing:?}")).collect();
        run.steps += 1;
        match (sim.step(&mut theirs, &input(&moves), &mut scratch), oracle.step(&ours, &moves)) {
            (Ok(()), Ok((next, _))) => {
                ours = next;
                before = last;
            }
            (Err(theirs), Err(ours)) if kind(theirs.kind) == ours => return Run { faulted: true, ..run },
            (theirs, ours) => {
                let ours = ours.map(|_| "a state");
                run.difference = Some(format!("step {}: simulator {theirs:?}, interpreter {ours:?}", run.steps));
                return run;
            }
        }
    }
}

/// What is drawn for the chances of a slot.
fn draws(oracle: &Oracle<'_>, slot: usize, mut draw: impl FnMut(i32, i32) -> i32) -> Vec<i32> {
    oracle.entity(slot).chances.iter().map(|chance| draw(chance.range.0, chance.range.1)).collect()
}

/// The differences between two states.
pub fn differences(sim: &Simulator, state: &[u8], ours: &State) -> Vec<String> {
    let (program, world) = (sim.program(), sim.world());
    let mut all = Vec::new();
    for (slot, s) in world.slots.pairs() {
        let (entity, layout) = (&program.entities[s.entity], &world.layout.slots[slot]);
        let mut differs = |what: String, theirs: String, ours: String| {
            if theirs != ours {
                all.push(format!("{} {what}: simulator {theirs}, interpreter {ours}", s.name));
            }
        };
        let thing = &ours.things[slot.index()];
        differs("lives".into(), layout.alive(state).to_string(), thing.is_some().to_string());
        let Some(thing) = thing.as_ref().filter(|_| layout.alive(state)) else { continue };
        let shown = |value: f64| format!("{value:?} ({:016x})", value.to_bits());
        for (var, name) in entity.vars.pairs() {
            for degree in 0..3 {
                let (theirs, ours) = (layout.var(state, var, degree), thing.vars[var.index()][usize::from(degree)]);
                differs(format!("{name}{}", "'".repeat(usize::from(degree))), shown(theirs), shown(ours));
            }
        }
        if let Some(at) = layout.params {
            for (param, p) in entity.params.pairs() {
                let theirs = real(state, at + 8 * param.index());
                differs(p.name.clone(), shown(theirs), shown(thing.params[param.index()]));
            }
        }
        for (id, discrete) in entity.discretes.pairs() {
            let ours = thing.discretes[id.index()].to_string();
            differs(discrete.name.clone(), layout.discrete(state, id).to_string(), ours);
        }
        for (id, reference) in entity.refs.pairs() {
            let theirs = layout.reference(state, id).map(SlotId::index);
            differs(reference.name.clone(), format!("{theirs:?}"), format!("{:?}", thing.refs[id.index()]));
        }
        differs("space".into(), layout.space(state).index().to_string(), thing.space.to_string());
        for group in entity.groups.ids() {
            let theirs = &entity.leaves[layout.leaf(state, group)].path;
            differs("modes".into(), format!("{theirs:?}"), format!("{:?}", thing.modes[group.index()]));
        }
        for (id, timer) in entity.timers.pairs() {
            let ours = thing.timers.get(&timer.mode).copied().unwrap_or(0).min(s.timer_limits[id]);
            let name = format!("timer({})", entity.modes[timer.mode].path);
            differs(name, layout.timer(state, id).to_string(), ours.to_string());
        }
        for (id, touch) in entity.touches.pairs() {
            // Without a tag of the entity's own collider, all of them match.
            let mine: Vec<_> = touch.mine.iter().collect();
            let mine = if let [only] = mine.as_slice() { Some(*only) } else { None };
            let answers = || touching(thing, mine, touch.other, touch.side);
            let ours = answers().any(|c| !touch.bound || c.who.is_some() || c.tile.is_some());
            differs(format!("{touch:?}"), layout.touch(state, id).to_string(), ours.to_string());
            if touch.bound {
                let theirs = layout.touched(state, id).map(SlotId::index);
                let ours = answers().filter_map(|c| c.who).min();
                differs(format!("{touch:?} by"), format!("{theirs:?}"), format!("{ours:?}"));
                let place = |tile| sim.place_of_tile(tile).map(|(_, column, row)| (column, row));
                let theirs = layout.touched_tile(state, id).and_then(place);
                let columns = world.spaces[layout.space(state)].map.as_ref().map_or(1, |map| map.columns);
                let ours = longest(answers().filter_map(|c| c.tile)).map(|cell| (cell % columns, cell / columns));
                differs(format!("{touch:?} by the tile"), format!("{theirs:?}"), format!("{ours:?}"));
            }
        }
        for (id, signal) in entity.signals.pairs() {
            let sum = thing.signals.get(&id.0);
            differs(signal.name.clone(), layout.signal(state, id).to_string(), sum.is_some().to_string());
            if let Some(number) = &signal.number {
                let ours = sum.copied().unwrap_or(0.0) + 0.0;
                differs(number.name.clone(), shown(layout.sum(state, id)), shown(ours));
            }
        }
        let theirs = layout.carrier(state).map(SlotId::index);
        differs("carrier".into(), format!("{theirs:?}"), format!("{:?}", thing.carrier));
    }
    let columns = |space: SpaceId| world.spaces[space].map.as_ref().map_or(1, |map| map.columns);
    let theirs: BTreeMap<(usize, usize), u16> = sim
        .broken_tiles(state)
        .into_iter()
        .filter_map(|tile| {
            let (space, column, row) = sim.place_of_tile(tile)?;
            Some(((space.index(), row * columns(space) + column), sim.steps_until_restored(state, tile)))
        })
        .collect();
    let ours: BTreeMap<(usize, usize), u16> = ours.broken.iter().map(|(at, left)| (*at, left.unwrap_or(0))).collect();
    if theirs != ours {
        all.push(format!("broken tiles: simulator {theirs:?}, interpreter {ours:?}"));
    }
    all
}

/// The predicates of a world that differ.
fn questions(sim: &Simulator, state: &[u8], oracle: &Oracle<'_>, ours: &State) -> Vec<String> {
    let mut all = Vec::new();
    let mut differs = |name: &str, theirs: String, ours: String| {
        if theirs != ours {
            all.push(format!("{name}: simulator {theirs}, interpreter {ours}"));
        }
    };
    for (id, goal) in oracle.world.goals.pairs() {
        let theirs = sim.goal(state, id).map_err(|f| kind(f.kind));
        differs(&goal.name.text, format!("{theirs:?}"), format!("{:?}", oracle.predicate(ours, &goal.predicate)));
    }
    for (never, theirs) in oracle.world.nevers.iter().zip(sim.world().nevers.iter()) {
        let theirs = sim.holds(state, theirs.holds).map_err(|f| kind(f.kind));
        differs(&never.name.text, format!("{theirs:?}"), format!("{:?}", oracle.predicate(ours, &never.predicate)));
    }
    let theirs = sim.broken_invariant(state).map(|b| b.map(|(slot, i)| (slot.index(), i))).map_err(|f| kind(f.kind));
    differs("invariants", format!("{theirs:?}"), format!("{:?}", oracle.broken(ours)));
    all
}
