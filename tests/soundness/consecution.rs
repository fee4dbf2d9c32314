//! States that are claimed to be possible, stepped: what comes of them should be possible, too. Reached states are changed
//! towards the ends of what is claimed, and parts of different ones put together.
//!
//! Contacts that a drawn state remembers need not fit where its bodies are, so its own next state is only the ground for
//! another step, if that is possible by the claims as well. What lies outside then may still come from a state that no
//! run reaches: it is a hint of a way that the analysis does not see, not a proof of one.

use hypedc::analysis::{Configuration, Interval, Values};
use hypedc::ir::{Id, SlotId, SlotLayout};
use hypedc::sim::Simulator;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::claims::{Claims, StateStatus, Violation};
use super::run::Inputs;

/// The results of some drawn states.
#[derive(Debug, Default)]
pub struct Drawn {
    pub states: usize,
    /// Number of them that were stepped.
    pub stepped: usize,
    pub hints: Vec<Violation>,
}

/// Steps states that are drawn from claimed and from reached ones.
pub fn consecution(sim: &Simulator, claims: &Claims, samples: &[Vec<u8>], tries: usize, seed: u64) -> Drawn {
    let mut out = Drawn::default();
    if samples.is_empty() {
        return out;
    }
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut scratch = sim.scratch();
    let standing = StateStatus { is_inside: true, is_allowed: false };
    let is_possible = |state: &[u8]| sim.left_bounds(state).is_none() && claims.refuted(sim, state, standing).is_none();
    let mut inputs = Inputs::new(seed, sim);
    for _ in 0..tries {
        let mut state = drawn(sim, claims, samples, &mut rng);
        out.states += 1;
        if !is_possible(&state) || sim.step(&mut state, inputs.next(), &mut scratch).is_err() || !is_possible(&state) {
            continue;
        }
        let input = inputs.next();
        if sim.step(&mut state, input, &mut scratch).is_err() || sim.left_bounds(&state).is_some() {
            continue;
        }
        out.stepped += 1;
        out.hints.extend(claims.refuted(sim, &state, standing));
    }
    out
}

fn drawn(sim: &Simulator, claims: &Claims, samples: &[Vec<u8>], rng: &mut Pcg64) -> Vec<u8> {
    let (program, world) = (sim.program(), sim.world());
    let mut state = samples[rng.random_range(0..samples.len())].clone();
    for (slot, s) in world.slots.pairs() {
        let layout = &world.layout.slots[slot];
        let entity = &program.entities[s.entity];
        let space = &claims.space.finest().slots[slot];
        let way = rng.random_range(0..6);
        if way == 0 {
            let (from, to) = layout.block;
            let other = &samples[rng.random_range(0..samples.len())];
            state[from..to].copy_from_slice(&other[from..to]);
        }
        if !layout.alive(&state) || space.is_given_up || space.configurations.is_empty() || way < 2 {
            continue;
        }
        if way == 2 {
            let other = &space.configurations[rng.random_range(0..space.configurations.len())];
            for (group, leaf) in entity.groups.ids().zip(&*other.leaves) {
                layout.set_leaf(&mut state, group, *leaf);
            }
        }
        let leaves = || entity.groups.ids().map(|g| layout.leaf(&state, g));
        // If places are distinguished, many have the same leaves.
        let alike: Vec<_> = space.configurations.iter().filter(|c| leaves().eq(c.leaves.iter().copied())).collect();
        if alike.is_empty() {
            continue;
        }
        let at = alike[rng.random_range(0..alike.len())];
        change(layout, at, s.timer_limits.iter().as_slice(), way == 2, &mut state, rng);
    }
    // Nothing refers to an absent instance.
    for (slot, s) in world.slots.pairs() {
        let layout = &world.layout.slots[slot];
        let entity = &program.entities[s.entity];
        let is_gone = |other: Option<SlotId>, state: &[u8]| other.is_some_and(|o| !world.layout.slots[o].alive(state));
        for reference in entity.refs.ids() {
            if is_gone(layout.reference(&state, reference), &state) {
                layout.set_reference(&mut state, reference, None);
            }
        }
        if is_gone(layout.carrier(&state), &state) {
            layout.set_carrier(&mut state, None);
        }
        layout.clear_touches(&mut state, entity.touches.len(), entity.bound);
    }
    state
}

/// Draws values from a configuration: some, or all where the modes were changed.
fn change(layout: &SlotLayout, at: &Configuration, limits: &[u32], all: bool, state: &mut [u8], rng: &mut Pcg64) {
    for (var, values) in at.vars.pairs() {
        for (degree, values) in (0u8..).zip(values) {
            let now = layout.var(state, var, degree);
            if !values.contains(now) || all || rng.random_range(0..4) == 0 {
                layout.set_var(state, var, degree, value(values, now, rng));
            }
        }
    }
    for (id, values) in at.discretes.pairs() {
        if !values.contains(f64::from(layout.discrete(state, id))) || rng.random_range(0..4) == 0 {
            layout.set_discrete(state, id, value(values, 0.0, rng).round() as i32);
        }
    }
    for (id, count) in at.timers.pairs() {
        if !count.contains(f64::from(layout.timer(state, id))) || rng.random_range(0..4) == 0 {
            let limit = limits.get(id.index()).copied().unwrap_or(u32::MAX);
            let count = value(&Values::from(*count), f64::from(layout.timer(state, id)), rng).round();
            layout.set_timer(state, id, (count as u32).min(limit));
        }
    }
    if !at.spaces.contains(&layout.space(state))
        && let Some(space) = at.spaces.first()
    {
        layout.set_space(state, *space);
    }
}

/// An end of an interval, or a value inside.
fn value(values: &Values, now: f64, rng: &mut Pcg64) -> f64 {
    let Some(Interval { low, high }) =
        values.intervals().get(rng.random_range(0..values.intervals().len().max(1))).copied()
    else {
        return now;
    };
    let far = |x: f64, otherwise: f64| if x.is_finite() { x } else { otherwise };
    let (low, high) = match (low.is_finite(), high.is_finite()) {
        (false, false) => (now - 40.0, now + 40.0),
        _ => (far(low, high.min(now) - 200.0), far(high, low.max(now) + 200.0)),
    };
    match rng.random_range(0..3) {
        0 => low,
        1 => high,
        _ if low < high => rng.random_range(low..high),
        _ => low,
    }
}
