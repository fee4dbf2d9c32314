//! What nature draws: one whole number for each chance of each slot and each step. It is part of the input of a step; a
//! seed gives what the input leaves open, by the numbers of the step and of the draw alone, so that neither the order of
//! a search nor the number of instances plays a part.

use std::borrow::Cow;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::ir::{Chance, ChanceId, Program, SlotId, World, WorldId};

use super::actor::Actor;
use super::input::{Frame, Input};
use super::simulator::{Scratch, Simulator};

/// What is drawn for one chance of one slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Draw {
    /// The slot.
    pub slot: SlotId,
    /// The chance of its entity.
    pub chance: ChanceId,
    /// The least and the greatest value.
    pub range: (i32, i32),
}

impl Draw {
    /// The number of values.
    pub fn values(&self) -> u64 {
        self.range.0.abs_diff(self.range.1) as u64 + 1
    }

    /// One of the values by number, counted from 0; the last one if there are not so many.
    pub fn value(&self, number: u64) -> i32 {
        let number = number.min(self.values() - 1);
        // The values of a range fit, and so does their number.
        (i64::from(self.range.0) + number as i64) as i32
    }

    /// A value for some random bits.
    pub(crate) fn of_bits(&self, bits: u64) -> i32 {
        self.value(((u128::from(bits) * u128::from(self.values())) >> 64) as u64)
    }
}

/// The number of a draw among those of its world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct DrawId(pub u32);

/// The draws of a world that an input fixes; the others are open.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Draws(Vec<Option<i32>>);

impl Draws {
    /// All open, with room for a number of them.
    pub(super) fn with_capacity(count: usize) -> Draws {
        Draws(Vec::with_capacity(count))
    }

    /// The value of a draw, if it is fixed.
    #[inline]
    pub fn get(&self, id: DrawId) -> Option<i32> {
        self.0.get(id.0 as usize).copied().flatten()
    }

    /// Fixes a draw, or opens it.
    pub fn set(&mut self, id: DrawId, value: Option<i32>) {
        let at = id.0 as usize;
        if at >= self.0.len() {
            if value.is_none() {
                return;
            }
            self.0.resize(at + 1, None);
        }
        self.0[at] = value;
        while self.0.last() == Some(&None) {
            self.0.pop();
        }
    }

    /// Whether all are open.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Those that are fixed.
    pub fn iter(&self) -> impl Iterator<Item = (DrawId, i32)> {
        self.0.iter().enumerate().filter_map(|(at, value)| value.map(|value| (DrawId(at as u32), value)))
    }
}

/// All draws of a world, slot by slot.
pub(super) fn draws(program: &Program, world: &World) -> Vec<Draw> {
    let of_slot = |slot: SlotId| {
        let chances = program.entities[world.slots[slot].entity].chances.pairs();
        chances.map(move |(chance, &Chance { range, .. })| Draw { slot, chance, range })
    };
    world.slots.ids().flat_map(of_slot).collect()
}

/// The names of the draws that an input fixes, as written in scripts.
pub(super) fn names(program: &Program, world: WorldId, fixed: &Draws) -> Vec<String> {
    if fixed.is_empty() {
        return Vec::new();
    }
    let world = &program.worlds[world];
    let all = draws(program, world);
    let name = |draw: &Draw| program.entities[world.slots[draw.slot].entity].chances[draw.chance].name.as_str();
    let named = fixed.iter().filter_map(|(id, value)| {
        let draw = all.get(id.0 as usize)?;
        let (slot, chance) = (&world.slots[draw.slot].name, name(draw));
        let is_only = all.iter().filter(|other| name(other) == chance).count() == 1;
        Some(if is_only { format!("nature:{chance}={value}") } else { format!("nature:{slot}.{chance}={value}") })
    });
    named.collect()
}

/// The draw that a script names, as `roll` or `hero.roll`: all that fit.
pub(super) fn named(program: &Program, world: &World, name: &str) -> Vec<(DrawId, Draw)> {
    let (slot, chance) = match name.rsplit_once('.') {
        Some((slot, chance)) => (Some(slot), chance),
        None => (None, name),
    };
    let fits = |draw: &Draw| {
        let of = &world.slots[draw.slot];
        program.entities[of.entity].chances[draw.chance].name == chance && slot.is_none_or(|slot| of.name == slot)
    };
    let all = draws(program, world).into_iter().enumerate();
    all.filter(|(_, draw)| fits(draw)).map(|(at, draw)| (DrawId(at as u32), draw)).collect()
}

/// A draw of a step, and whether the step has read it. Working memory can be shared between threads, hence the atom.
#[derive(Debug, Default)]
pub(super) struct Drawn {
    value: f64,
    is_read: AtomicBool,
}

impl Clone for Drawn {
    fn clone(&self) -> Self {
        Drawn { value: self.value, is_read: self.is_read.load(Ordering::Relaxed).into() }
    }
}

/// What the players do and what nature draws in a step.
#[derive(Debug, Clone)]
pub(super) struct Frames {
    /// Each player's input with its changes.
    pub players: Vec<Frame>,
    /// All draws of the world.
    drawn: Vec<Drawn>,
}

impl Frames {
    /// No players and no draws.
    pub const NONE: &'static Frames = &Frames { players: Vec::new(), drawn: Vec::new() };

    /// For some players and draws.
    pub fn new(players: usize, draws: usize) -> Self {
        Frames { players: vec![Frame::default(); players], drawn: vec![Drawn::default(); draws] }
    }

    /// The input of the player that controls an instance, if there is one.
    #[inline(always)]
    pub fn of(&self, actor: &Actor) -> Option<&Frame> {
        actor.player.and_then(|player| self.players.get(player))
    }

    /// A draw by its number, which is then read.
    pub fn read(&self, at: usize) -> f64 {
        let Some(drawn) = self.drawn.get(at) else { return 0.0 };
        drawn.is_read.store(true, Ordering::Relaxed);
        drawn.value
    }
}

/// Bits for a draw of a step: the finalizer of SplitMix64 (Steele, Lea, Flood, *Fast Splittable Pseudorandom Number
/// Generators*, 2014) over a chain of the three numbers.
pub(crate) fn bits(seed: u64, step: u64, draw: u64) -> u64 {
    let mix = |z: u64| {
        let z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    mix(mix(mix(seed) ^ step) ^ draw)
}

impl Simulator {
    /// What nature draws in each step, slot by slot; empty for a world without chances.
    #[inline]
    pub fn draws(&self) -> &[Draw] {
        &self.draws
    }

    /// The draw of a chance of an instance, by name.
    pub fn draw_named(&self, slot: &str, chance: &str) -> Option<DrawId> {
        let slot = self.world().slot_named(slot)?;
        let chance = self.entity(slot).chance_named(chance)?;
        let at = self.draws.iter().position(|draw| (draw.slot, draw.chance) == (slot, chance))?;
        Some(DrawId(at as u32))
    }

    /// An input with all of its open draws drawn from a seed for a step; the first step of a run has the number 1.
    pub fn draw<'i>(&self, seed: u64, step: u64, input: &'i Input) -> Cow<'i, Input> {
        if self.draws.is_empty() {
            return Cow::Borrowed(input);
        }
        let mut drawn = Input::default();
        self.draw_into(seed, step, input, &mut drawn);
        Cow::Owned(drawn)
    }

    /// As [`Simulator::draw`], written to an input that is reused, so that nothing is allocated.
    pub fn draw_into(&self, seed: u64, step: u64, input: &Input, drawn: &mut Input) {
        drawn.0.clone_from(&input.0);
        drawn.1.0.clear();
        for (id, draw) in (0..).map(DrawId).zip(&self.draws) {
            let key = (u64::from(draw.slot.0) << 32) | u64::from(draw.chance.0);
            let value = input.1.get(id).unwrap_or_else(|| draw.of_bits(bits(seed, step, key)));
            drawn.1.0.push(Some(value));
        }
    }

    /// An input with the draws that the last step made with `scratch` has read, and no others: it has the same effect.
    pub fn drawn(&self, input: &Input, scratch: &Scratch) -> Input {
        let mut drawn = Input(input.0.clone(), Draws::default());
        for (id, of_step) in (0..).map(DrawId).zip(&scratch.frames.drawn) {
            if of_step.is_read.load(Ordering::Relaxed) {
                drawn.1.set(id, Some(of_step.value as i32));
            }
        }
        drawn
    }

    /// Stores the draws of a step. What is open or out of its range is the least value.
    pub(super) fn lay(&self, fixed: &Draws, frames: &mut Frames) {
        for (at, (drawn, draw)) in frames.drawn.iter_mut().zip(&self.draws).enumerate() {
            let value = fixed.get(DrawId(at as u32)).filter(|value| (draw.range.0..=draw.range.1).contains(value));
            drawn.value = f64::from(value.unwrap_or(draw.range.0));
            drawn.is_read = false.into();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_draws_all_values_alike() {
        let draw = Draw { slot: SlotId(0), chance: ChanceId(0), range: (-2, 3) };
        let mut counts = [0_u32; 6];
        for step in 0..6_000 {
            counts[(draw.of_bits(bits(7, step, 3)) + 2) as usize] += 1;
        }
        assert!(counts.iter().all(|count| (900..1_100).contains(count)), "{counts:?}");
        // Two draws of a step, and two steps of a draw, have nothing to do with each other.
        let same = |other: fn(u64) -> (u64, u64)| {
            let of = |(step, key): (u64, u64)| draw.of_bits(bits(7, step, key));
            (0..6_000_u64).filter(|step| of((*step, 3)) == of(other(*step))).count()
        };
        assert!((900..1_100).contains(&same(|step| (step, 4))));
        assert!((900..1_100).contains(&same(|step| (step + 1, 3))));
        assert_eq!(draw.of_bits(u64::MAX), 3);
        assert_eq!(draw.of_bits(0), -2);
        let wide = Draw { range: (i32::MIN, i32::MAX), ..draw };
        assert_eq!((wide.of_bits(0), wide.of_bits(u64::MAX)), (i32::MIN, i32::MAX));
    }

    #[test]
    fn the_numbers_of_a_seed_stay_the_same() {
        // Traces and documents hold what a seed draws.
        let draw = Draw { slot: SlotId(0), chance: ChanceId(0), range: (1, 6) };
        let rolls: Vec<i32> = (1..=12).map(|step| draw.of_bits(bits(0, step, 0))).collect();
        assert_eq!(rolls, [2, 6, 2, 3, 1, 4, 2, 6, 2, 5, 6, 4]);
    }

    #[test]
    fn fixed_draws_are_the_same_however_they_were_fixed() {
        let mut draws = Draws::default();
        draws.set(DrawId(4), None);
        draws.set(DrawId(2), Some(5));
        draws.set(DrawId(2), None);
        assert_eq!(draws, Draws::default());
        draws.set(DrawId(1), Some(3));
        assert_eq!((draws.get(DrawId(0)), draws.get(DrawId(1)), draws.get(DrawId(9))), (None, Some(3), None));
        assert_eq!(draws.iter().collect::<Vec<_>>(), [(DrawId(1), 3)]);
    }
}
