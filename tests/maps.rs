//! Maps from files: text with one's own tiles, levels of the Video Game Level Corpus (see `maps/LICENSE-VGLC.md`), and
//! worlds whose map the command line gives.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod support;

use std::path::Path;

use hypedc::compile::{compile, compile_with};
use hypedc::ir::{Origin, Program, SpaceId, WorldId};
use hypedc::sim::{Input, Simulator};
use hypedc::source::{Files, ReadError};
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
}

#[test]
fn only_what_a_level_has_takes_a_number() {
    let program = program(compile(Path::new("tests/maps/smb.hyped"), &Disk));
    let map = program.worlds[WorldId(0)].spaces[SpaceId(0)].map.as_ref().unwrap();
    let text = std::fs::read_to_string("tests/maps/mario-1-1.txt").unwrap();
    assert!(map.kinds.iter().all(|k| text.contains(k.symbol)), "{:?}", map.kinds);
    // The legend has cannons, the level has none; what the program says itself of `E` replaces the legend's tags.
    for absent in ["cannon", "Cannon top", "enemy", "moving", "empty"] {
        assert!(!program.tags.iter().any(|t| t == absent), "{absent}");
    }
}

/// Files that are not on the disk.
struct Memory<'a>(&'a [(&'a str, &'a str)]);

impl Files for Memory<'_> {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        let found = self.0.iter().find(|(name, _)| path == Path::new(name));
        found.map(|(_, text)| text.to_string()).ok_or(ReadError::Unreadable("no such file".into()))
    }
}

#[test]
fn paths_are_relative_to_the_file_that_names_them() {
    let files = Memory(&[
        ("games/main.hyped", "import \"worlds/world.hyped\"\n"),
        (
            "games/worlds/world.hyped",
            "world W {
    tiles own 16 x 16 { '#': solid }
    space a { map own from \"levels/a.txt\" }
    space b { map vglc \"levels/a.txt\" legend \"levels/l.json\" tile 8 x 8 }
}
",
        ),
        ("games/worlds/levels/a.txt", "  ##  \r\n##\r\n\r\n"),
        ("games/worlds/levels/l.json", r##"{ "tiles": { "#": ["solid"] } }"##),
    ]);
    let program = program(compile(Path::new("games/main.hyped"), &files));
    let spaces = &program.worlds[WorldId(0)].spaces;
    let sizes: Vec<(f64, f64)> = spaces.iter().map(|s| s.map.as_ref().unwrap().size()).collect();
    assert_eq!(sizes, [(32.0, 32.0), (16.0, 16.0)]);
}

#[test]
fn an_open_world_is_checked_with_the_instances_that_its_tiles_name() {
    let text = "entity Hero { x' = 60 }
world W {
    tiles own 16 x 16 {
        '-': empty
        'P': spawn Hero as hero
    }
    space main { map level own }
    player 1: hero
    goal far: hero.x > main.width / 2 and 100 / main.width > 1
}
";
    let level = ("levels/one.txt", "---\n-P-\n");
    let two = ("two.txt", "P-P\n");
    let files = Memory(&[("open.hyped", text), level, two]);
    let root = Path::new("open.hyped");
    assert!(program(compile(root, &files)).worlds[WorldId(0)].open.is_some());
    let given = program(compile_with(root, Some(Path::new(level.0)), &files));
    let world = &given.worlds[WorldId(0)];
    assert_eq!(world.open, None);
    let starts: Vec<[f64; 2]> =
        world.slots.iter().map(|s| [s.vars[hypedc::ir::VarId(0)][0], s.vars[hypedc::ir::VarId(1)][0]]).collect();
    assert_eq!(starts, [[16.0, 0.0]], "the instance is that of the level, and the only one");
    let twice = compile_with(root, Some(Path::new(two.0)), &files);
    assert!(twice.program.is_none(), "`as` needs exactly one such tile");
}

#[test]
fn a_legend_of_very_many_characters_is_read_or_refused() {
    let many: Vec<char> = (0..70_000).filter_map(|i| char::from_u32(0x2_0000 + i)).collect();
    let entries: Vec<String> = many.iter().map(|c| format!("\"{c}\": [\"some\"]")).collect();
    let legend = format!("{{ \"tiles\": {{ {}, \"\u{f0000}\": [\"last\"] }} }}", entries.join(", "));
    let text = "world W { space main { map vglc \"level.txt\" legend \"l.json\" tile 16 x 16 } }\n";
    let files = |level| [("w.hyped", text), ("l.json", legend.as_str()), ("level.txt", level)];
    let program = program(compile(Path::new("w.hyped"), &Memory(&files("\u{f0000}\u{f0000}\n"))));
    assert_eq!(program.tags.iter().collect::<Vec<_>>(), ["last"]);
    let map = program.worlds[WorldId(0)].spaces[SpaceId(0)].map.as_ref().unwrap();
    assert_eq!((map.kinds.len(), map.kind(1, 0)), (1, Some(0)));
    let all: String = many.into_iter().collect();
    let refused = compile(Path::new("w.hyped"), &Memory(&files(&all)));
    let found: Vec<&str> = refused.diagnostics.iter().map(|d| d.message.as_str()).collect();
    assert_eq!(found, ["too many kinds of tiles: 4097, at most 4096"]);
}
