//! Maps from files: text with one's own tiles, levels of the Video Game Level Corpus (see `maps/LICENSE-VGLC.md`), and
//! worlds whose map the command line gives.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod support;

use std::path::Path;
use std::process::Command;

use hypedc::compile::{compile, compile_with};
use hypedc::ir::{Origin, Program, SpaceId, WorldId};
use hypedc::sim::{Input, Simulator};
use support::{Disk, program};

/// Runs the first world without input; gives how many instances it began with.
fn run(program: &Program, steps: usize) -> usize {
    let sim = Simulator::new(program, WorldId(0));
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    let alive = sim.world().slots.ids().filter(|&s| sim.world().layout.slots[s].alive(&state)).count();
    let nothing = Input::nothing(sim.world().players.len());
    for _ in 0..steps {
        sim.step(&mut state, &nothing, &mut scratch).unwrap();
    }
    alive
}

#[test]
fn a_level_of_the_corpus_is_a_world() {
    let program = program(compile(Path::new("tests/maps/smb.hyped"), &Disk));
    let world = &program.worlds[WorldId(0)];
    let map = world.spaces[SpaceId(0)].map.as_ref().unwrap();
    let text = std::fs::read_to_string("tests/maps/mario-1-1.txt").unwrap();
    let rows: Vec<&str> = text.lines().map(str::trim).filter(|r| !r.is_empty()).collect();
    assert_eq!((map.columns, map.rows, map.tile), (rows[0].len(), rows.len(), (16.0, 16.0)));
    // A Goomba stands on each `E`, slots row by row from the top, left to right.
    let enemies: Vec<[f64; 2]> = rows
        .iter()
        .enumerate()
        .flat_map(|(y, row)| row.match_indices('E').map(move |(x, _)| (x, y)))
        .map(|(x, y)| [16.0 * x as f64, 16.0 * (rows.len() - 1 - y) as f64])
        .collect();
    let made: Vec<[f64; 2]> = world
        .slots
        .iter()
        .filter(|s| s.origin == Origin::Tile)
        .map(|s| [s.vars[hypedc::ir::VarId(0)][0], s.vars[hypedc::ir::VarId(1)][0]])
        .collect();
    assert!(enemies.len() > 5);
    assert_eq!(made, enemies);
    assert!(program.tags.iter().any(|t| t == "question block"), "tags of the legend that are no names");
    assert_eq!(run(&program, 600), enemies.len() + 1);
}

#[test]
fn a_text_file_is_read_with_ones_own_tiles() {
    let program = program(compile(Path::new("tests/maps/own.hyped"), &Disk));
    let world = &program.worlds[WorldId(0)];
    let map = world.spaces[SpaceId(0)].map.as_ref().unwrap();
    assert_eq!((map.columns, map.rows), (11, 4), "blanks at the ends and empty lines at the end are no tiles");
    let boss = world.slots.iter().find(|s| s.name == "boss").unwrap();
    assert_eq!(boss.origin, Origin::Named);
    assert_eq!((boss.vars[hypedc::ir::VarId(0)][0], boss.vars[hypedc::ir::VarId(1)][0]), (128.0, 16.0));
}

#[test]
fn an_open_map_is_given_later() {
    let path = Path::new("tests/maps/open.hyped");
    let without = program(compile(path, &Disk));
    assert!(without.worlds[WorldId(0)].open.is_some());
    let with = program(compile_with(path, Some(Path::new("tests/maps/mario-1-1.txt")), &Disk));
    assert_eq!(with.worlds[WorldId(0)].open, None);
    assert!(run(&with, 60) > 5);
    let closed = compile_with(Path::new("tests/maps/own.hyped"), Some(Path::new("tests/maps/mario-1-1.txt")), &Disk);
    assert!(closed.program.is_none(), "a map that nobody asked for");
    let hypedc = |args: &[&str]| Command::new(env!("CARGO_BIN_EXE_hypedc")).args(args).output().unwrap();
    for command in ["sim", "reach"] {
        let refused = hypedc(&[command, "tests/maps/open.hyped"]);
        assert_eq!(refused.status.code(), Some(2), "{command}");
        assert!(String::from_utf8_lossy(&refused.stderr).contains("--map PATH"), "{command}");
    }
    let reached = hypedc(&["reach", "tests/maps/open.hyped", "--map", "tests/maps/mario-1-1.txt"]);
    assert_eq!(reached.status.code(), Some(0), "{}", String::from_utf8_lossy(&reached.stdout));
}
