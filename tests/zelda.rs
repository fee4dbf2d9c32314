//! Dungeons of The Legend of Zelda, imported from the Video Game Level Corpus, and the tower of Kid Icarus (see the
//! licences beside them): rooms and doors as in the games, and a search that goes through them.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use crate::support::{Disk, assert_leads_to, program, script};
use hypedc::analysis::configuration_space;
use hypedc::compile::{LevelFile, check_with, compile, compile_with};
use hypedc::diagnostic::render;
use hypedc::format::format;
use hypedc::import::{Import, zelda};
use hypedc::ir::{GoalId, Program, SlotId, WorldId};
use hypedc::reach::{Limits, Problem, Settings, Verdict, reach};
use hypedc::sim::Simulator;
use hypedc::source::SourceMap;
use hypedc::watch::Unwatched;
use proptest::prelude::*;

const WORLD: WorldId = WorldId(0);

/// Imports a dungeon; returns the result, and the rendered findings.
fn import(text: &str) -> (Import, String) {
    let mut sources = SourceMap::new();
    let file = sources.add("dungeon.txt", text);
    let import = zelda::import(file, text, "Tloz1_1", "link.hyped");
    let shown = render::human(&sources, import.diagnostics.iter(), false);
    (import, shown)
}

fn first() -> String {
    std::fs::read_to_string("examples/zelda/tloz1_1.txt").unwrap()
}

fn player(program: &Program) -> SlotId {
    program.worlds[WORLD].players.iter().next().unwrap().slot
}

#[test]
fn the_example_is_the_import_of_its_dungeon() {
    let (Import { text, diagnostics }, shown) = import(&first());
    assert!(!diagnostics.has_errors(), "{shown}");
    let text = text.unwrap();
    assert_eq!(text, std::fs::read_to_string("examples/zelda/tloz1_1.hyped").unwrap());
    assert_eq!(format(SourceMap::new().add("test.hyped", ""), &text).unwrap(), text);
    let checked = check_with(Path::new("examples/zelda/tloz1_1.hyped"), LevelFile::default(), &Disk);
    let findings = render::human(&checked.sources, checked.diagnostics.iter(), false);
    assert!(findings.is_empty(), "{findings}");
    insta::assert_snapshot!("findings", shown);
}

#[test]
fn rooms_and_doors_are_those_of_the_game() {
    let program = program(compile(Path::new("examples/zelda/tloz1_1.hyped"), &Disk));
    let world = &program.worlds[WORLD];
    let rooms: BTreeSet<&str> = world.spaces.iter().map(|s| s.name.as_str()).collect();
    // The eagle: a manual of the game shows the same.
    let eagle = "b1 c1 c2 e2 f2 a3 b3 c3 d3 e3 b4 c4 d4 c5 b6 c6 d6";
    assert_eq!(rooms, eagle.split(' ').collect());
    for (id, space) in world.spaces.pairs() {
        assert_eq!(space.map.as_ref().unwrap().size(), (256.0, 176.0));
        for link in &space.links {
            let back = world.spaces[link.space].links.iter().any(|l| l.space == id);
            assert!(back, "{} leads to {}, which does not lead back", space.name, world.spaces[link.space].name);
            // A player that comes out does not go back at once.
            let (x, y) = (link.to.left.max(16.0), link.to.bottom.max(16.0));
            for other in &world.spaces[link.space].links {
                let across = other.from.left < link.to.right && link.to.left < other.from.right;
                let up = other.from.bottom < link.to.top && link.to.bottom < other.from.top;
                assert!(!(across && up) || x >= other.from.right || y >= other.from.top, "{}", space.name);
            }
        }
    }
    let monsters = world.slots.iter().filter(|s| s.name.starts_with("Monster")).count();
    assert_eq!(monsters, first().matches('M').count());
    assert_eq!(world.spaces[world.slots[player(&program)].space].name, "c6", "one comes in from below");
}

/// The rooms that a script leads through.
fn walk(program: &Arc<Program>, inputs: &str) -> Vec<String> {
    let sim = Simulator::new(program, WORLD);
    let script = script(program, inputs);
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    let mut rooms = Vec::new();
    for input in script.inputs() {
        sim.step(&mut state, input, &mut scratch).unwrap();
        rooms.push(sim.world().spaces[sim.space(&state, player(program))].name.clone());
    }
    rooms.dedup();
    rooms
}

/// Two rooms side by side or one above the other in the file, each with a door to the other, the first one with a door to
/// the outside on the side where the game's lower side is.
fn two_rooms(is_below: bool) -> String {
    let (open, shut) = ("WWFFFFFFFDW", "WWFFFFFFFWW");
    let with = |right: bool, left: bool| {
        (0..16).map(move |line| match line {
            0 | 1 | 14 | 15 => "WWWWWWWWWWW".to_string(),
            7 | 8 => format!("W{}FFFFFFF{}W", if left { 'D' } else { 'W' }, if right { 'D' } else { 'W' }),
            _ => shut.to_string(),
        })
    };
    if is_below {
        // Side by side in the file: one above the other in the game.
        let lines = with(true, false).zip(with(true, true)).map(|(upper, lower)| format!("{upper}{lower}"));
        return lines.collect::<Vec<String>>().join("\r\n");
    }
    let mut lines: Vec<String> = with(true, false).chain(with(false, false)).collect();
    lines[14] = "WWWWDDDWWWW".into();
    lines[17] = "WWWWDDDWWWW".into();
    assert_eq!(open.len(), shut.len());
    lines.join("\n")
}

#[test]
fn one_walks_through_doors_and_back() {
    for (is_below, there, back) in [(true, "up*150", "down*150"), (false, "up*50 right*200", "left*200")] {
        let (imported, shown) = import(&two_rooms(is_below));
        let text = imported.text.expect(&shown);
        let entities = std::fs::read_to_string("examples/zelda/link.hyped").unwrap();
        let text = text.replace("import \"link.hyped\"", &entities);
        let program = program(crate::support::compile_text(&text));
        let rooms = walk(&program, &format!("{there} {back}"));
        let expected = if is_below { ["a2", "a1", "a2"] } else { ["a1", "b1", "a1"] };
        assert_eq!(rooms, expected, "{text}");
    }
}

const TOWER: &str = "examples/kid-icarus/kid_icarus.hyped";
const STAGE: &str = "examples/kid-icarus/kidicarus_1.txt";

/// A program with a level, if its map is open.
fn with_level(path: &str, level: Option<&str>) -> Arc<Program> {
    let level = LevelFile { map: level.map(Path::new), ..LevelFile::default() };
    program(compile_with(Path::new(path), level, &Disk))
}

fn solve(path: &str, level: Option<&str>, nodes: u64) {
    let program = with_level(path, level);
    let sim = Simulator::new(&program, WORLD);
    let problem = Problem::new(&sim, GoalId(0));
    let space = configuration_space(&program, WORLD);
    let limits = Limits { nodes, ..Limits::default() };
    let found = reach(&problem, &space, &Settings::default(), &limits, &Unwatched).unwrap();
    let Verdict::Reached(plan) = found.verdict else { panic!("{path}: {:?}", found.verdict) };
    assert_leads_to(&sim, &plan.script, GoalId(0));
}

#[test]
fn link_gets_to_the_last_room() {
    solve("examples/zelda/tloz1_1.hyped", None, 100_000);
}

#[test]
fn pit_gets_to_the_last_door() {
    solve(TOWER, Some(STAGE), 600_000);
}

#[test]
fn pit_goes_round_the_sides_of_the_picture() {
    let program = with_level(TOWER, Some(STAGE));
    let sim = Simulator::new(&program, WORLD);
    // A row that is open on both sides, the ground below it whole from side to side: found in the map.
    let map = sim.world().spaces.iter().next().unwrap().map.as_ref().unwrap();
    let solid = |column: usize, row: usize| {
        let kind = &map.kinds[map.kind(column as i64, row as i64).unwrap()];
        kind.tags.iter().any(|t| program.tags[*t] == "solid")
    };
    let row = (1..map.rows - 1)
        .find(|row| {
            let ends = [0, 1, map.columns - 2, map.columns - 1];
            ends.iter().all(|c| solid(*c, row - 1) && !solid(*c, *row) && !solid(*c, row + 1))
        })
        .expect("a row to walk round on");
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    let pit = player(&program);
    let layout = &sim.world().layout.slots[pit];
    for (inputs, from, across) in [("right*40", 236.0, -1.0), ("left*40", 8.0, 1.0)] {
        layout.set_var(&mut state, hypedc::ir::VarId(0), 0, from);
        layout.set_var(&mut state, hypedc::ir::VarId(1), 0, 16.0 * row as f64);
        for input in script(&program, inputs).inputs() {
            sim.step(&mut state, input, &mut scratch).unwrap();
        }
        let (x, y) = sim.position(&state, pit);
        assert!((x - from) * across > 100.0 && y == 16.0 * row as f64, "{inputs}: from {from} to {x}, {y}");
    }
}

#[test]
fn what_is_no_dungeon_is_told() {
    let text = first();
    let line = "WWWWWWWWWWW\n";
    let cases = [
        ("empty", String::new()),
        ("void", "-----------\n".repeat(16)),
        ("ragged", format!("{}WWW\n", line.repeat(15))),
        ("part", line.repeat(10)),
        ("unknown", text.replacen('F', "é", 1)),
        ("alone", line.repeat(16)),
        ("one_sided", two_rooms(false).replacen("WWWWDDDWWWW", line.trim(), 1)),
    ];
    let shown = cases.map(|(name, text)| format!("{name}\n{}", import(&text).1));
    insta::assert_snapshot!("no_dungeons", shown.join("\n"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn no_text_makes_the_import_fail(text in "[WFDBSMPOI\\-\\n\\r é]{0,600}", at in 0usize..6000, with in any::<char>()) {
        import(&text);
        let mut whole = first();
        let at = (0..=at.min(whole.len() - 1)).rev().find(|at| whole.is_char_boundary(*at)).unwrap();
        whole.insert(at, with);
        import(&whole);
    }
}
