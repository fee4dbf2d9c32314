//! A search remembers what instances did that nothing touched: its steps give the same bits, and count the same work, as
//! steps that remember nothing.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg32;

use crate::support::{Disk, compile_text, files, program, sized, stir};
use hypedc::compile::{LevelFile, compile, compile_with};
use hypedc::ir::{Program, WorldId};
use hypedc::sim::{Input, Simulator, State};
use hypedc::watch::{Meter, Unwatched};

/// Number of states to which a run returns, and the longest part of a run between two returns, steps.
const KEPT: usize = 24;
const PART: u64 = 40;

/// Runs a world for a number of steps, back and forth between states as a search does, with and without memory. Returns the
/// number of bytes that are remembered.
fn run(sim: &Simulator, rng: &mut impl Rng, steps: u64) -> usize {
    let (mut plain, mut remembering) = (sim.scratch(), sim.remembering_scratch());
    let Ok(first) = sim.initial(&mut plain) else { return 0 };
    assert!(first == sim.initial(&mut remembering).unwrap());
    let mut kept: Vec<State> = vec![first];
    let mut input = Input::nothing(sim.world().players.len());
    let mut done = 0;
    while done < steps {
        let at = rng.random_range(0..kept.len());
        let (mut state, mut same) = (kept[at].clone(), kept[at].clone());
        let part = rng.random_range(1..=PART);
        // Nothing of earlier steps counts.
        if rng.random_range(0..4) == 0 {
            plain = sim.scratch();
        }
        for step in 0..part {
            if step % 8 == 0 {
                stir(&mut input, rng);
            }
            let (meter, other) = (Meter::new(&Unwatched), Meter::new(&Unwatched));
            let result = sim.metered_step(&mut state, &input, &mut plain, &meter);
            assert_eq!(sim.metered_step(&mut same, &input, &mut remembering, &other), result);
            if result.is_err() {
                // Such a state is no start.
                state = kept[at].clone();
                break;
            }
            assert!(state == same, "step {} of a part from state {at}", step + 1);
            assert_eq!(meter.total(), other.total(), "work");
        }
        // A start is computed with the same working memory now and then.
        if rng.random_range(0..20) == 0 {
            assert!(sim.initial(&mut remembering).unwrap() == sim.initial(&mut plain).unwrap());
        }
        done += part;
        match kept.len() {
            KEPT => kept[rng.random_range(0..KEPT)] = state,
            _ => kept.push(state),
        }
    }
    remembering.bytes()
}

fn runs(program: &Arc<Program>, steps: u64) -> usize {
    let mut rng = Pcg32::seed_from_u64(steps);
    program.worlds.ids().filter(|id| run(&Simulator::new(program, *id), &mut rng, steps) > 0).count()
}

#[test]
fn worlds_of_the_examples() {
    let of = |path: PathBuf| runs(&program(compile(&path, &Disk)), sized(400, 20_000));
    let remembering: usize = ["examples", "tests/conformance"].iter().flat_map(|of| files(of, "hyped")).map(of).sum();
    assert!(remembering >= 4, "in {remembering} worlds there are instances whose steps recur");
}

#[test]
fn real_levels() {
    for name in ["1-1", "1-3", "8-1"] {
        let map = format!("examples/smb/mario-{name}.txt");
        let level = LevelFile { map: Some(Path::new(&map)), ..LevelFile::default() };
        let program = program(compile_with(Path::new("examples/smb/smb.hyped"), level, &Disk));
        assert_eq!(runs(&program, sized(8_000, 200_000)), 1, "{name}");
    }
}

/// Crowds that sleep until they are seen, block and push each other and the player, bounce, count, shrink and vanish.
const CROWDS: &str = "
    entity Hero {
        param speed = 120
        axis horizontal, vertical
        button act
        collider body: rect(0, 0, 12, 12)
        collider view: rect(-40, -40, 92, 92)
        x' = speed * horizontal
        y' = speed * vertical
        always { when touching(body, ball) as it { destroy it } }
        mode free { when pressed(act) -> heavy }
        mode heavy { when timer >= 0.3s -> free }
    }
    entity Sleeper {
        collider sleeper: rect(0, 0, 8, 8) when in asleep
        collider body: rect(0, 0, 8, 8) when in awake
        mode asleep { when touching(sleeper, view) -> awake }
        mode awake {
            y'' = -300
            when timer >= 2s and touching(body, solid, below) { destroy self }
            mode left {
                x' = -30
                when touching(body, solid, left) or touching(body, body, left) -> right
            }
            mode right {
                x' = 30
                when touching(body, solid, right) or touching(body, body, right) -> left
            }
        }
    }
    entity Ball {
        collider ball: rect(0, 0, 8, 8)
        mode held { when timer >= 0.1s -> flying { x' := 35; y' := 50 } }
        mode flying { when touching(ball, body) { y' := -y' } }
    }
    entity Crate {
        discrete hits: int 0..9 = 0
        collider body: rect(0, 0, 10, 10)
        x' = 0
        y'' = -200
        mode falling { when touching(body, body) and hits < 9 { hits += 1 } }
    }
    entity Breather {
        collider body: circle(4, 4, 4)
        mode out { when timer >= 1.5s -> inwards }
        mode inwards { when timer >= 1s -> out }
    }
    world Hall {
        collide body with solid: block
        collide body with body: block
        collide ball with solid: block, bounce 1
        collide ball with body: sense
        collide view with sleeper: sense
        tiles hall 16 x 16 {
            '.': empty; '#': solid; 's': spawn Sleeper; 'b': spawn Ball; 'c': spawn Crate; 'r': spawn Breather
        }
        space main {
            map hall \"
MAP\"
            place hero: Hero at (160, 40)
        }
        player 1: hero
    }";

/// A hall with walls around it, and anything in it.
fn hall(rng: &mut impl Rng) -> String {
    let (columns, rows) = (20, 10);
    let mut map = String::new();
    for row in 0..rows {
        for column in 0..columns {
            let is_wall = row == 0 || column == 0 || row == rows - 1 || column == columns - 1;
            let tile = b".......####ssssbbccr"[rng.random_range(0..20)];
            map.push(if is_wall { '#' } else { tile.into() });
        }
        map.push('\n');
    }
    map
}

#[test]
fn crowds() {
    for seed in 0..sized(20, 1_000) {
        let mut rng = Pcg32::seed_from_u64(seed);
        let compilation = compile_text(&CROWDS.replace("MAP", &hall(&mut rng)));
        assert!(compilation.program.is_some(), "{:?}", compilation.diagnostics);
        assert_eq!(runs(&program(compilation), 3_000), 1, "hall {seed}");
    }
}

#[test]
fn boxes_may_depend_on_others() {
    let compilation = compile_text(
        "entity Hero {
            param speed = 40
            axis horizontal
            ref first: Drifter
            collider body: rect(0, 0, 6, 6) when first.y' < 0
            x' = speed * horizontal
            y' = 0
        }
        entity Drifter {
            collider body: rect(0, 0, 6, 6)
            x' = 0
            mode falling {
                y'' = -300
                when timer >= 0.2s -> rising
            }
            mode rising {
                y'' = 300
                when timer >= 0.2s -> falling
            }
        }
        world Sea {
            collide body with body: block
            space main {
                place a: Drifter at (0, 0)
                place b: Drifter at (100, 0)
                place c: Drifter at (200, 0)
                place hero: Hero at (30, 0) { first = a }
            }
            player 1: hero
        }",
    );
    assert!(compilation.program.is_some(), "{:?}", compilation.diagnostics);
    runs(&program(compilation), sized(4_000, 100_000));
}

#[test]
fn what_is_remembered_is_bounded() {
    let compilation = compile_text(
        "entity Drifter {
            collider body: rect(0, 0, 4, 4)
            x'' = 0.01
            y' = 1
        }
        world Sea {
            space main {
                place a: Drifter at (0, 0)
                place b: Drifter at (100, 0)
                place c: Drifter at (200, 0)
            }
        }",
    );
    let program = program(compilation);
    let sim = Simulator::new(&program, WorldId(0));
    let mut scratch = sim.remembering_scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    let mut most = 0;
    for _ in 0..100_000 {
        sim.step(&mut state, &Input::default(), &mut scratch).unwrap();
        most = most.max(scratch.bytes());
    }
    assert!((1..16 << 20).contains(&most), "{most} bytes");
}
