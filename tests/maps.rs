//! Maps from files: text with a tile set of the program, levels of the Video Game Level Corpus (see
//! `maps/LICENSE-VGLC.md`), and worlds whose map is given on the command line.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::Path;
use std::sync::Arc;

use crate::support::{Disk, program};
use hypedc::compile::{LevelFile, compile, compile_with};
use hypedc::ir::{Origin, Program, SpaceId, WorldId};
use hypedc::sim::{Input, Simulator};
use hypedc::source::{Files, ReadError};

/// Runs the first world without input; returns its initial number of instances.
fn run(program: &Arc<Program>, steps: usize) -> usize {
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
    let with = program(compile_with(path, LevelFile::new(Path::new("tests/maps/mario-1-1.txt")), &Disk));
    assert_eq!(with.worlds[WorldId(0)].open, None);
    assert!(run(&with, 60) > 5);
    let closed =
        compile_with(Path::new("tests/maps/own.hyped"), LevelFile::new(Path::new("tests/maps/mario-1-1.txt")), &Disk);
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
    let given = program(compile_with(root, LevelFile::new(Path::new(level.0)), &files));
    let world = &given.worlds[WorldId(0)];
    assert_eq!(world.open, None);
    let starts: Vec<[f64; 2]> =
        world.slots.iter().map(|s| [s.vars[hypedc::ir::VarId(0)][0], s.vars[hypedc::ir::VarId(1)][0]]).collect();
    assert_eq!(starts, [[16.0, 0.0]], "the instance is that of the level, and the only one");
    let twice = compile_with(root, LevelFile::new(Path::new(two.0)), &files);
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

const OPEN: &str = "entity Goomba { collider body: rect(0, 0, 16, 16) }
world Set {
    collide body with ground: block
    tiles own 8 x 8 {
        '#': ground
        'o': spawn Goomba
    }
    space main { map level own }
}
";

const ALL: &str = "entity Goomba { collider body: rect(0, 0, 16, 16) }
world All {
    collide body with ground: block
    space main {
        map level {
            'o': spawn Goomba
        }
    }
}
";

#[test]
fn the_command_line_says_how_an_open_map_is_read() {
    let files = Memory(&[
        ("set.hyped", OPEN),
        ("all.hyped", ALL),
        ("one.txt", "..o.\n~~##\n"),
        ("l.json", r##"{ "tiles": { ".": ["empty"], "~": ["water"], "o": ["enemy"], "#": ["ground", "rock"] } }"##),
        ("own.json", r##"{ "tiles": { "#": ["ground"] } }"##),
    ]);
    let (map, legend) = (Some(Path::new("one.txt")), Some(Path::new("l.json")));
    let read = |root: &str, level| compile_with(Path::new(root), level, &files);
    let tags = |program: &Program, column, row| -> Vec<String> {
        let map = program.worlds[WorldId(0)].spaces[SpaceId(0)].map.as_ref().unwrap();
        let kind = &map.kinds[map.kind(column, row).unwrap()];
        kind.tags.iter().map(|t| program.tags[*t].clone()).collect()
    };
    let size = |program: &Program| program.worlds[WorldId(0)].spaces[SpaceId(0)].map.as_ref().unwrap().tile;
    let set = program(read("set.hyped", LevelFile { map, legend, tile: None }));
    assert_eq!(size(&set), (8.0, 8.0), "as the tile set says");
    assert_eq!(tags(&set, 0, 0), ["water"], "of the legend");
    assert_eq!(tags(&set, 3, 0), ["ground"], "of the tile set, which goes before the legend");
    assert_eq!(run(&set, 1), 1, "the tile set's Goomba, not the legend's enemy");
    let all = program(read("all.hyped", LevelFile { map, legend, tile: Some((16.0, 12.0)) }));
    assert_eq!(size(&all), (16.0, 12.0));
    assert_eq!(tags(&all, 3, 0), ["ground", "rock"]);
    assert_eq!(run(&all, 1), 1);
    let open = program(read("all.hyped", LevelFile { legend, ..LevelFile::default() }));
    assert!(open.worlds[WorldId(0)].open.is_some(), "a legend alone leaves the map open");
    let wrong = |root: &str, level| {
        let found = read(root, level);
        assert!(found.program.is_none());
        found.diagnostics.iter().map(|d| d.message.clone()).collect::<Vec<_>>().join("; ")
    };
    let tile = Some((16.0, 16.0));
    assert_eq!(
        wrong("all.hyped", LevelFile { map, legend, tile: None }),
        "nothing says how to read `one.txt`: how large its tiles are"
    );
    assert_eq!(
        wrong("all.hyped", LevelFile { map, legend: None, tile }),
        "no tile `.` in `map level` (3 times); no tile `~` in `map level` (2 times); no tile `#` in `map level` (2 times)"
    );
    let own = Some(Path::new("own.json"));
    assert_eq!(
        wrong("set.hyped", LevelFile { map, legend: own, tile }),
        "`tiles own` has all characters of `own.json`: the legend says nothing; no tile `.` in `tiles own` (3 times); \
         no tile `~` in `tiles own` (2 times)"
    );
    let closed = Path::new("tests/maps/smb.hyped");
    let closed = compile_with(closed, LevelFile { map: None, legend: None, tile }, &Disk);
    let found: Vec<&str> = closed.diagnostics.iter().map(|d| d.message.as_str()).collect();
    assert_eq!(found, ["`--tile` is for worlds with an open map, and `tests/maps/smb.hyped` has none"]);
}

#[test]
fn what_is_no_rows_of_characters_is_named() {
    let text = "world W { space main { map vglc \"level.txt\" legend \"l.json\" tile 16 x 16 } }\n";
    let legend = r##"{ "tiles": { "#": ["solid"], "B": ["solid"], "-": ["empty"] } }"##;
    let found = |level: &str, legend: &str| {
        let files = [("w.hyped", text), ("l.json", legend), ("level.txt", level)];
        let found = compile(Path::new("w.hyped"), &Memory(&files));
        let short = hypedc::diagnostic::render::short(&found.sources, found.diagnostics.iter());
        short.lines().map(|line| line.replace(": error[E0501]", "")).collect::<Vec<_>>()
    };
    assert_eq!(found("--#\r\n###  \r\n\r\n \r\n", legend), [""; 0], "line ends of Windows, blanks, empty lines");
    assert_eq!(found("{ \"tiles\": {} }", legend), ["level.txt:1:1: this level is JSON, not rows of tiles"]);
    assert_eq!(found("--#\n-\u{0}#\n", legend), ["level.txt:2:2: this level is binary data, not rows of tiles"]);
    assert_eq!(
        found("<?xml version=\"1.0\"?>\n<map/>", legend),
        ["level.txt:1:1: this level is XML, not rows of tiles"]
    );
    // A tab inside of a row, and the letter in the other case, as in three levels of Super Mario Bros. 2.
    assert_eq!(
        found("--#\n-\tb\n", legend),
        ["level.txt:2:2: no tile `\t` in `l.json`", "level.txt:2:3: no tile `b` in `l.json`"]
    );
    assert_eq!(found("--#\n-##\n-\n", legend), ["level.txt:3:1: row 3 has 1 tile, others have 3"]);
    // Other files of the corpus: graphs, and lists of solid tiles.
    let graph = "{ \"nodes\": {},\n \"edges\": {} }";
    assert_eq!(found("--#\n", graph), ["l.json:2:14: this is no legend: it has no `tiles`, but `edges`, `nodes`"]);
}
