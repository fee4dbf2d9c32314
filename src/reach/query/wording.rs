//! Sentences that explain a "no": values of the parts of a predicate, the distance to a goal, the visited states.

use crate::analysis::wording::relation;
use crate::analysis::{Interval, Values};
use crate::ir::{Program, World};
use crate::source::SourceMap;

use super::super::outcome::{Argument, Exhaustion, Verdict};
use super::super::proof::{Proof, TooFar};

/// The reasons for a "no"; empty for any other verdict.
pub(super) fn reasons(sources: &SourceMap, program: &Program, world: &World, verdict: &Verdict) -> Vec<String> {
    match verdict {
        Verdict::Unreachable(argument) => argument_reasons(sources, program, world, argument),
        Verdict::Exhausted(all) => {
            let between = "values of axes between these were not tried, and can make a difference".to_string();
            let visited = visited(*all, has_draws(program, world));
            [visited].into_iter().chain(left_out(all.left_out)).chain([between]).collect()
        }
        Verdict::Reached(_) | Verdict::NotFound => Vec::new(),
    }
}

fn argument_reasons(sources: &SourceMap, program: &Program, world: &World, argument: &Argument) -> Vec<String> {
    match argument {
        Argument::Analysis(proof) => proof_reasons(sources, program, world, proof),
        Argument::Distance(TooFar { player, within: [x, y], least }) => {
            let name = &world.slots[*player].name;
            let range = |axis: &str, at: &Interval| relation(&format!("{name}.{axis}"), &Values::from(*at));
            let seconds = *least as f64 * world.step.seconds();
            let steps = if *least == 1 { "step" } else { "steps" };
            vec![
                format!("by then {} and {}, where it cannot hold", range("x", x), range("y", y)),
                format!("it takes at least {least} {steps} ({seconds:.2} s)"),
            ]
        }
        Argument::Exhaustion(all) => {
            let visited = visited(*all, has_draws(program, world));
            [visited].into_iter().chain(left_out(all.left_out)).collect()
        }
        Argument::Over => vec!["every run is over before it begins".to_string()],
    }
}

/// Whether nature draws anything in a world.
fn has_draws(program: &Program, world: &World) -> bool {
    world.slots.iter().any(|slot| !program.entities[slot.entity].chances.is_empty())
}

/// Describes the states that an exhaustive search visited.
fn visited(Exhaustion { states, min_hold, .. }: Exhaustion, has_draws: bool) -> String {
    let held = match min_hold {
        1 => "that can change at every step".to_string(),
        steps => format!("that are held for at least {steps} steps"),
    };
    let states = if states == 1 { "the only state was".to_string() } else { format!("all {states} states were") };
    let drawn = if has_draws { ", all that nature can draw" } else { "" };
    format!("{states} visited to which inputs lead {held}: all buttons, axes at -1, 0 and 1{drawn}")
}

/// Describes what an exhaustive search left out; nothing if nothing was.
pub(super) fn left_out(instances: u32) -> Option<String> {
    let (were, they) = match instances {
        0 => return None,
        1 => ("1 instance was".to_string(), "it"),
        more => (format!("{more} instances were"), "they"),
    };
    Some(format!("{were} left out: {they} can act only by contacts, which counted as possible wherever {they} can be"))
}

/// One reason for each part of a predicate that cannot hold. `sources` hold the text of the predicates.
pub fn proof_reasons(sources: &SourceMap, program: &Program, world: &World, proof: &Proof) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for part in &proof.parts {
        let reason = part.sentence(sources, program, world);
        if !out.contains(&reason) {
            out.push(reason);
        }
    }
    out
}

/// Buttons that no player holds, in words: `held(run)`; `None` if there are none.
pub fn unpressed_words(program: &Program, world: &World, unpressed: &[u64]) -> Option<String> {
    let mut names: Vec<String> = Vec::new();
    for (player, mask) in world.players.iter().zip(unpressed) {
        let entity = &program.entities[world.slots[player.slot].entity];
        for (_, name) in entity.buttons.pairs().filter(|(id, _)| mask >> id.0 & 1 == 1) {
            let name = format!("`held({name})`");
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    (!names.is_empty()).then(|| names.join(" and "))
}

/// Whether a run ends when a player leaves the bounds of its space: all proofs about such a world assume it.
pub fn is_bounded(world: &World) -> bool {
    !world.players.is_empty() && world.spaces.iter().any(|s| s.bounds.is_some())
}
