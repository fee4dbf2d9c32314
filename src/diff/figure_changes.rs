//! The figures that differ between two programs.

use serde::Serialize;

use super::figures::{Figures, Jump, Press, Speed};
use crate::ir::Extremes;

/// The share of a figure by which it may differ: noise of rounding.
const NOISE: f64 = 1e-9;

/// A jump that differs; one side is none where the input leads off the ground in one program only.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct FigureChange<T> {
    /// In the old program.
    pub old: Option<T>,
    /// In the new program.
    pub new: Option<T>,
}

/// What differs of a player.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct PlayerChange {
    /// The number of the player.
    pub player: u32,
    /// Its instance in the new program, or in the old one if it stands on flat ground only there.
    pub instance: String,
    /// Whether it stands on flat ground in the old program, and in the new one.
    pub stands: [bool; 2],
    /// The number of jumps that were compared.
    pub compared: usize,
    /// The jumps that differ.
    pub jumps: Vec<FigureChange<Jump>>,
    /// The speeds that differ, of modes that both programs have.
    pub speeds: Vec<FigureChange<Speed>>,
}

/// The players whose figures differ.
pub fn player_changes(old: &[Figures], new: &[Figures]) -> Vec<PlayerChange> {
    let numbers = old.iter().chain(new).map(|figures| figures.player);
    let mut numbers: Vec<u32> = numbers.collect();
    numbers.sort_unstable();
    numbers.dedup();
    let of = |all: &[Figures], number: u32| all.iter().find(|figures| figures.player == number).cloned();
    let changes = numbers.into_iter().filter_map(|number| {
        let (before, after) = (of(old, number), of(new, number));
        let instance = after.as_ref().or(before.as_ref())?.instance.clone();
        let stands = [before.is_some(), after.is_some()];
        let mut change =
            PlayerChange { player: number, instance, stands, compared: 0, jumps: Vec::new(), speeds: Vec::new() };
        if let (Some(before), Some(after)) = (before, after) {
            compare(&before, &after, &mut change);
            if change.jumps.is_empty() && change.speeds.is_empty() {
                return None;
            }
        }
        Some(change)
    });
    changes.collect()
}

fn compare(old: &Figures, new: &Figures, change: &mut PlayerChange) {
    type Key<'j> = (&'j str, Press, &'j str, bool);
    fn key(jump: &Jump) -> Key<'_> {
        (&jump.input, jump.press, &jump.with, jump.running)
    }
    let partner = |all: &[Jump], jump: &Jump| all.iter().find(|other| key(other) == key(jump)).cloned();
    for jump in &old.jumps {
        let now = partner(&new.jumps, jump);
        change.compared += 1;
        if now.as_ref().is_none_or(|now| is_other_jump(jump, now)) {
            change.jumps.push(FigureChange { old: Some(jump.clone()), new: now });
        }
    }
    for jump in new.jumps.iter().filter(|jump| partner(&old.jumps, jump).is_none()) {
        change.compared += 1;
        change.jumps.push(FigureChange { old: None, new: Some(jump.clone()) });
    }
    for speed in &old.speeds {
        let Some(now) = new.speeds.iter().find(|other| other.mode == speed.mode) else { continue };
        let pairs = [(speed.sideways, now.sideways), (speed.up, now.up), (speed.down, now.down)];
        if pairs.into_iter().any(|(a, b)| is_other(a, b)) {
            change.speeds.push(FigureChange { old: Some(speed.clone()), new: Some(now.clone()) });
        }
    }
}

fn is_other_jump(a: &Jump, b: &Jump) -> bool {
    let differ = |a: Option<f64>, b: Option<f64>| match (a, b) {
        (Some(a), Some(b)) => is_other(a, b),
        (a, b) => a.is_some() != b.is_some(),
    };
    is_other(a.rise, b.rise)
        || differ(a.length, b.length)
        || differ(a.seconds, b.seconds)
        || a.running && is_other(a.speed, b.speed)
}

fn is_other(a: f64, b: f64) -> bool {
    (a - b).abs() > NOISE * (1.0 + a.abs().greatest(b.abs()))
}
