//! Precision: the spaces of the paper's tests and of Mario are within the sampling bounds of the 2017 system, in each
//! mode and dimension.
//!
//! Its rules: positions are in [0, 640]. A variable starts from its initial value. A constant flow gives its value, and
//! 0 if the entity can be pushed; an envelope gives from minus to plus its sustain level; a variable without a flow is
//! at rest. Derivatives above the driven one are 0. An acceleration widens the velocity to 1000 on its side, a velocity
//! the position.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

use hypedc::analysis::{Configuration, ConfigurationSpace, Interval, Values, configuration_space};
use hypedc::compile::compile;
use hypedc::ir::{Program, SlotId, VarId, WorldId};

use crate::support::{Disk, compile_text, program};

const X: VarId = VarId(0);
const Y: VarId = VarId(1);

fn space(path: &str) -> (Arc<Program>, ConfigurationSpace) {
    let program = program(compile(Path::new(path), &Disk));
    let space = configuration_space(&program, WorldId(0));
    (program, space)
}

fn slot(program: &Program, name: &str) -> SlotId {
    program.worlds[WorldId(0)].slots.find(|s| s.name == name).unwrap()
}

/// The configurations of a slot with the mode of its first group.
fn modes<'s>(program: &'s Program, space: &'s ConfigurationSpace, name: &str) -> Vec<(&'s str, &'s Configuration)> {
    let slot = slot(program, name);
    let entity = &program.entities[program.worlds[WorldId(0)].slots[slot].entity];
    let found = &space.slots[slot];
    assert!(!found.is_given_up && !found.configurations.is_empty(), "{name}");
    found.configurations.iter().map(|c| (entity.modes[entity.leaves[c.leaves[0]].mode].path.as_str(), c)).collect()
}

/// All configurations of a world, line by line.
fn shown(program: &Program, space: &ConfigurationSpace) -> String {
    let mut out = String::new();
    for (id, s) in program.worlds[WorldId(0)].slots.pairs() {
        let entity = &program.entities[s.entity];
        for at in &space.slots[id].configurations {
            let leaves = at.leaves.iter().map(|l| entity.modes[entity.leaves[*l].mode].path.as_str());
            writeln!(out, "{} in {}", s.name, leaves.collect::<Vec<_>>().join(", ")).unwrap();
            for (var, values) in at.vars.pairs() {
                for (degree, values) in values.iter().enumerate() {
                    let name = format!("{}{}", entity.vars[var], "'".repeat(degree));
                    writeln!(out, "  {name:<3} {values}").unwrap();
                }
            }
        }
    }
    out
}

/// The bounds of the 2017 system in a mode: `x'`, `x''`, `y'`, `y''`.
struct OldBounds {
    slot: &'static str,
    mode: &'static str,
    bounds: [&'static [(f64, f64)]; 4],
}

const ZERO: &[(f64, f64)] = &[(0.0, 0.0)];

const TEST1: &[OldBounds] = &[
    // It can be pushed, so that 0 is added to each flow. Gravity widens y' from 0 down to -1000.
    OldBounds {
        slot: "hero",
        mode: "stop",
        bounds: [ZERO, ZERO, &[(-1000.0, 0.0)], &[(-1000.0, -1000.0), (0.0, 0.0)]],
    },
    OldBounds {
        slot: "hero",
        mode: "right",
        bounds: [&[(0.0, 0.0), (60.0, 60.0)], ZERO, &[(-1000.0, 0.0)], &[(-1000.0, -1000.0), (0.0, 0.0)]],
    },
    OldBounds {
        slot: "hero",
        mode: "left",
        bounds: [&[(-60.0, -60.0), (0.0, 0.0)], ZERO, &[(-1000.0, 0.0)], &[(-1000.0, -1000.0), (0.0, 0.0)]],
    },
    // Nothing pushes a platform: only its flow; without a flow it is at rest.
    OldBounds { slot: "brown", mode: "wait", bounds: [ZERO, ZERO, ZERO, ZERO] },
    OldBounds { slot: "brown", mode: "right", bounds: [&[(30.0, 30.0)], ZERO, ZERO, ZERO] },
    OldBounds { slot: "brown", mode: "left", bounds: [&[(-30.0, -30.0)], ZERO, ZERO, ZERO] },
    // Before its first step it has its initial velocity, which that system did not count.
    OldBounds { slot: "blue", mode: "right", bounds: [&[(0.0, 0.0), (30.0, 30.0)], ZERO, ZERO, ZERO] },
    OldBounds { slot: "blue", mode: "left", bounds: [&[(-30.0, -30.0)], ZERO, ZERO, ZERO] },
];

// x' is driven by an envelope that sustains 100. A jump begins with 200 and gravity widens y' from there to -1000.
const RUN: &[(f64, f64)] = &[(-100.0, 100.0)];
const JUMP: &[(f64, f64)] = &[(-1000.0, 200.0)];

const TEST2: &[OldBounds] = &[
    OldBounds { slot: "hero", mode: "air.falling", bounds: [RUN, ZERO, JUMP, &[(-400.0, -400.0), (0.0, 0.0)]] },
    OldBounds { slot: "hero", mode: "air.jump_control", bounds: [RUN, ZERO, JUMP, &[(-250.0, -250.0), (0.0, 0.0)]] },
    OldBounds { slot: "hero", mode: "air.jump_fixed", bounds: [RUN, ZERO, JUMP, &[(-250.0, -250.0), (0.0, 0.0)]] },
    // The flow is y' = -30: above it all is 0.
    OldBounds { slot: "hero", mode: "ground", bounds: [RUN, ZERO, &[(-30.0, -30.0), (0.0, 0.0)], ZERO] },
    OldBounds { slot: "brown", mode: "wait", bounds: [ZERO, ZERO, ZERO, ZERO] },
    OldBounds { slot: "brown", mode: "right", bounds: [&[(30.0, 30.0)], ZERO, ZERO, ZERO] },
    OldBounds { slot: "brown", mode: "left", bounds: [&[(-30.0, -30.0)], ZERO, ZERO, ZERO] },
    OldBounds { slot: "green", mode: "right", bounds: [&[(0.0, 0.0), (30.0, 30.0)], ZERO, ZERO, ZERO] },
    OldBounds { slot: "green", mode: "left", bounds: [&[(-30.0, -30.0)], ZERO, ZERO, ZERO] },
];

/// Asserts that the space is within the old bounds, in each mode and dimension.
fn is_tighter(path: &str, old: &[OldBounds]) {
    let (program, space) = space(path);
    let mut met = BTreeSet::new();
    for name in ["hero", "brown", "blue", "green"] {
        if program.worlds[WorldId(0)].slots.iter().all(|s| s.name != name) {
            continue;
        }
        for (mode, at) in modes(&program, &space, name) {
            let Some(old) = old.iter().find(|o| (o.slot, o.mode) == (name, mode)) else {
                panic!("{path}: {name} in {mode} is not in the table");
            };
            met.insert((name, mode));
            let derivatives = [(X, 1), (X, 2), (Y, 1), (Y, 2)];
            for ((var, degree), bounds) in derivatives.into_iter().zip(old.bounds) {
                let (ours, theirs) = (&at.vars[var][degree], bounds.iter().map(|(a, b)| Interval::between(*a, *b)));
                let theirs = Values::any(theirs);
                assert!(ours.is_within(&theirs), "{path}: {name} in {mode}, {var} {degree}: {ours}, {theirs}");
            }
            for var in [X, Y] {
                let ours = at.vars[var][0].hull().unwrap();
                assert!(0.0 <= ours.low && ours.high <= 640.0, "{path}: {name} in {mode}, {var}: {ours}");
            }
            let level = program.worlds[WorldId(0)].spaces.iter().next().unwrap().bounds.unwrap();
            let x = at.vars[X][0].hull().unwrap();
            assert!(level.left <= x.low && x.high <= level.right, "{path}: {name} in {mode}: {x}");
        }
    }
    // Otherwise a mode has become unreachable, or the table has an unknown entry.
    assert_eq!(met.len(), old.len(), "{path}");
}

#[test]
fn test_1_is_tighter_than_it_was() {
    is_tighter("examples/paper/test1.hyped", TEST1);
    let (program, space) = space("examples/paper/test1.hyped");
    insta::assert_snapshot!("paper_test1", shown(&program, &space));
}

#[test]
fn test_2_is_tighter_than_it_was() {
    is_tighter("examples/paper/test2.hyped", TEST2);
    let (program, space) = space("examples/paper/test2.hyped");
    insta::assert_snapshot!("paper_test2", shown(&program, &space));
}

#[test]
fn a_platform_is_one_interval() {
    let (program, space) = space("examples/paper/test1.hyped");
    for (name, y) in [("brown", 32.0), ("blue", 32.0)] {
        for (mode, at) in modes(&program, &space, name) {
            let [x, speed, ..] = &at.vars[X];
            assert_eq!(x.intervals().len(), 1, "{name} in {mode}: {x}");
            assert_eq!(
                at.vars[Y].each_ref().map(Values::constant),
                [Some(y), Some(0.0), Some(0.0)],
                "{name} in {mode}"
            );
            // Blue begins in `right`, at rest.
            match (name, mode) {
                ("blue", "right") => assert_eq!(format!("{speed}"), "0, 30"),
                _ => assert!(speed.constant().is_some(), "{name} in {mode}: {speed}"),
            }
        }
    }
}

#[test]
fn mario_rises_and_falls_no_faster_than_he_can() {
    let (program, space) = space("examples/mario.hyped");
    let all = modes(&program, &space, "hero");
    assert!(all.len() > 100, "{}", all.len());
    let (fall_limit, jump_speed) = (-300.0, 200.0);
    let mut least = 0.0_f64;
    for (mode, at) in all {
        let speed = at.vars[Y][1].hull().unwrap();
        assert!(fall_limit <= speed.low && speed.high <= jump_speed, "{mode}: {speed}");
        least = least.min(speed.low);
    }
    // The limit is reached: he falls into pits.
    assert_eq!(least, fall_limit);
}

/// A guard about the size of a velocity bounds it on both sides, or leaves a gap between them.
#[test]
fn a_guard_on_a_size_bounds_what_it_is_of() {
    let text = "
entity Hero {
    axis horizontal
    button jump
    initial mode ground {
        envelope x' by horizontal {
            attack accel 120
            sustain 90
            release accel 120
        }
        when pressed(jump) and abs(x') < 60 -> hop
        when pressed(jump) and abs(x') >= 60 -> leap
    }
    mode hop { x'' = 0 }
    mode leap { x'' = 0 }
}
world W {
    step 1/60
    space main { place hero: Hero at (0, 0) }
    player 1: hero
}";
    let program = program(compile_text(text));
    let space = configuration_space(&program, WorldId(0));
    let speeds = |mode: &str| -> Vec<(f64, f64)> {
        let all = modes(&program, &space, "hero").into_iter().filter(|(name, _)| *name == mode);
        all.flat_map(|(_, at)| at.vars[X][1].intervals().to_vec()).map(|i| (i.low, i.high)).collect()
    };
    assert_eq!(speeds("ground"), [(-90.0, 90.0)]);
    assert_eq!(speeds("hop"), [(-60.0, 60.0)]);
    assert_eq!(speeds("leap"), [(-90.0, -60.0), (60.0, 90.0)]);
}
