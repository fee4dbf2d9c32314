//! Levels of the editors Tiled and LDtk. `maps/editors` holds one level in four formats, as the editors save it, and a
//! sample of LDtk itself (`LICENSE-LDtk`).

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::support::program;
use hypedc::compile::{Compilation, LevelFile, compile, compile_with};
use hypedc::diagnostic::render;
use hypedc::ir::{Program, SpaceId, VarId, WorldId};
use hypedc::sim::{Input, Simulator};
use hypedc::source::{Files, ReadError, decode};
use proptest::prelude::*;

const FOLDER: &str = "tests/maps/editors";

/// The files of the folder, with those of the test before them.
struct Beside<'a>(&'a [(&'a str, &'a [u8])]);

impl Files for Beside<'_> {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        match self.0.iter().find(|(name, _)| path == Path::new(name)) {
            Some((_, bytes)) => decode(bytes.to_vec()),
            None => decode(std::fs::read(path).map_err(|e| ReadError::Unreadable(e.to_string()))?),
        }
    }
}

/// A program with a map, whose Goombas have a speed of their own.
fn with_map(map: &str, speed: i32) -> String {
    format!(
        "entity Hero {{
    ref friend: Fairy
    collider body: rect(0, 0, 16, 16)
    x' = 30
    y'' = -100
}}
entity Fairy {{ x' = 0 }}
entity Goomba {{
    param speed = {speed}
    collider body: rect(0, 0, 16, 16)
    x' = speed
    y'' = -100
}}
world Valley {{
    collide body with ground: block
    tiles own 16 x 16 {{
        '.': empty
        '#': ground
        'E': spawn Goomba
        'P': spawn Hero as hero
    }}
    space main {{
        {map}
    }}
    player 1: hero
}}
"
    )
}

fn compiled(map: &str, speed: i32) -> Compilation {
    let path = format!("{FOLDER}/test.hyped");
    let text = with_map(map, speed);
    compile(Path::new(&path), &Beside(&[(&path, text.as_bytes())]))
}

/// The tags of each tile, row by row from the lowest, with the number of columns and the size of a tile.
fn tiles(program: &Program) -> (usize, (f64, f64), Vec<Vec<String>>) {
    let map = program.worlds[WorldId(0)].spaces[SpaceId(0)].map.as_ref().unwrap();
    let tags = |kind: u16| {
        let mut tags: Vec<String> =
            map.kinds[usize::from(kind)].tags.iter().map(|t| program.tags[*t].clone()).collect();
        tags.sort();
        tags
    };
    (map.columns, map.tile, map.cells.iter().map(|kind| tags(*kind)).collect())
}

/// Where the named instances are at each of some steps.
fn ways(program: &Arc<Program>, names: &[&str]) -> Vec<Vec<[f64; 2]>> {
    let sim = Simulator::new(program, WorldId(0));
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    let layout = &sim.world().layout;
    let slots: Vec<_> = names.iter().map(|name| sim.world().slots.find(|s| s.name == *name).unwrap()).collect();
    let nothing = Input::nothing(sim.world().players.len());
    let mut out = Vec::new();
    for _ in 0..120 {
        sim.step(&mut state, &nothing, &mut scratch).unwrap();
        out.push(
            slots.iter().map(|s| [0, 1].map(|var| layout.slots[*s].var(&state, VarId(var), 0))).collect::<Vec<_>>(),
        );
    }
    out
}

#[test]
fn a_level_is_the_same_in_four_formats() {
    let names = ["hero", "Goomba#1"];
    let text = program(compiled("map own from \"valley.txt\"", -24));
    let (known, way) = (tiles(&text), ways(&text, &names));
    assert!(way.iter().any(|at| at[0] != way[0][0]) && way[60][1] != way[0][1], "both move");
    for map in [
        "map tiled \"valley.tmx\"",
        "map tiled \"valley.tmj\"",
        "map ldtk \"valley.ldtk\" level \"Valley\" { Player: spawn Hero as hero; Mob: spawn Goomba }",
    ] {
        let other = program(compiled(map, 7));
        assert_eq!(tiles(&other), known, "{map}");
        assert_eq!(ways(&other, &names), way, "{map}");
        let world = &other.worlds[WorldId(0)];
        let slot = |name: &str| world.slots.find(|s| s.name == name).unwrap();
        let hero = &world.slots[slot("hero")];
        assert_eq!(hero.refs.iter().copied().collect::<Vec<_>>(), [Some(slot("Fairy#1"))], "{map}");
        let fairy = &world.slots[slot("Fairy#1")];
        assert_eq!([fairy.vars[VarId(0)][0], fairy.vars[VarId(1)][0]], [32.0, 48.0], "{map}");
    }
}

#[test]
fn the_command_line_gives_a_level_of_any_format() {
    let path = format!("{FOLDER}/test.hyped");
    let text = with_map("map level { Player: spawn Hero as hero; Mob: spawn Goomba; Hero: spawn Hero }", 7)
        .replace("    player 1: hero\n", "");
    let known = tiles(&program(compiled("map own from \"valley.txt\"", -24)));
    let files = [(path.as_str(), text.as_bytes())];
    let found = compile_with(
        Path::new(&path),
        LevelFile::new(&PathBuf::from(format!("{FOLDER}/valley.ldtk#Valley"))),
        &Beside(&files),
    );
    assert_eq!(tiles(&program(found)), known);
    let text = text.replace("Player: spawn Hero as hero; ", "");
    let files = [(path.as_str(), text.as_bytes())];
    for level in ["valley.tmx", "valley.tmj"] {
        let level = PathBuf::from(format!("{FOLDER}/{level}"));
        assert_eq!(tiles(&program(compile_with(Path::new(&path), LevelFile::new(&level), &Beside(&files)))), known);
        let legend = PathBuf::from(format!("{FOLDER}/valley.json"));
        let both = LevelFile { legend: Some(&legend), ..LevelFile::new(&level) };
        let found = compile_with(Path::new(&path), both, &Beside(&files));
        assert!(short(&found).iter().any(|line| line.contains("`--legend` is for levels of characters")));
    }
}

/// The findings, one a line, without the folder.
fn short(found: &Compilation) -> Vec<String> {
    let text = render::short(&found.sources, found.diagnostics.iter());
    text.lines().map(|line| line.replace(&format!("{FOLDER}/"), "")).collect()
}

#[test]
fn a_sample_of_ldtk_with_levels_in_files_of_their_own_is_read() {
    let text =
        "world Room { space main { map ldtk \"SeparateLevelFiles.ldtk\" level \"World_Level_1\" { walls: solid } } }";
    let path = format!("{FOLDER}/test.hyped");
    let compile = |text: &str| compile(Path::new(&path), &Beside(&[(&path, text.as_bytes())]));
    let (columns, tile, cells) = tiles(&program(compile(text)));
    assert_eq!((columns, cells.len(), tile), (15, 225, (16.0, 16.0)));
    assert!(cells.iter().any(|tags| tags == &["solid"]) && cells.iter().any(Vec::is_empty));
    let walls = cells.iter().filter(|tags| !tags.is_empty()).count();
    let placed = program(compile(&format!("entity Wall {{ }}\n{}", text.replace("walls: solid", "walls: spawn Wall"))));
    assert_eq!(placed.worlds[WorldId(0)].slots.len(), walls, "a value of the grid may be an entity");
    let found = compile(&text.replace("World_Level_1", "World_Lvl_1"));
    assert_eq!(
        short(&found),
        ["SeparateLevelFiles.ldtk:1:1: error[E0507]: this project has no level `World_Lvl_1`; \
          did you mean `World_Level_1`?"]
    );
    let found = compile(&text.replace(" level \"World_Level_1\"", ""));
    assert_eq!(
        short(&found),
        ["SeparateLevelFiles.ldtk:1:1: error[E0507]: this project has several levels, and one must be named: \
          `World_Level_0`, `World_Level_1`, `World_Level_2`"]
    );
}

/// A map of Tiled with something in place of its layers and tilesets.
fn tmx(attributes: &str, inside: &str) -> String {
    format!(
        "<map orientation=\"orthogonal\" width=\"3\" height=\"2\" tilewidth=\"8\" tileheight=\"4\" {attributes}>\n\
         <tileset firstgid=\"1\" name=\"own\" tilecount=\"2\"><tile id=\"1\" class=\"spike\"><properties>\
         <property name=\"tags\" value=\"deadly, sharp\"/></properties></tile></tileset>\n{inside}\n</map>\n"
    )
}

fn of_level(block: &str, level: &str) -> Compilation {
    let text = format!(
        "entity Coin {{ param worth = 1 }}\nworld W {{ space main {{ map tiled \"a.tmx\" {{ {block} }} }} }}\n"
    );
    compile(Path::new("w.hyped"), &Beside(&[("w.hyped", text.as_bytes()), ("a.tmx", level.as_bytes())]))
}

#[test]
fn layers_are_united_and_rectangles_become_static_geometry() {
    let layers = "<group name=\"all\"><layer name=\"back ground\" width=\"3\" height=\"2\"><data encoding=\"csv\">\
                  1,0,0,\n1,2,536870914</data></layer></group>\n\
                  <layer name=\"ice\" width=\"3\" height=\"2\"><data encoding=\"csv\">0,1,0,1,0,0</data></layer>\n\
                  <layer name=\"back\" width=\"3\" height=\"2\" offsetx=\"3\"><data encoding=\"csv\">0,2</data></layer>\n\
                  <objectgroup name=\"walls\" offsetx=\"2\"><object id=\"1\" x=\"4\" y=\"1\" width=\"10\" height=\"3\"/>\
                  <object id=\"2\" class=\"lava\" x=\"0\" y=\"6\" width=\"8\" height=\"2\"/>\
                  <object id=\"3\" x=\"0\" y=\"6\"><point/></object><object id=\"4\" x=\"0\" y=\"6\"><ellipse/></object>\
                  <object id=\"5\" class=\"Coin\" x=\"8\" y=\"4\" width=\"4\" height=\"4\"/>\
                  <object id=\"6\" gid=\"2\" class=\"Coin\" x=\"16\" y=\"4\" width=\"8\" height=\"8\"/></objectgroup>";
    let found = program(of_level("ice: slippery, cold; \"back ground\": far; back: empty", &tmx("", layers)));
    let (columns, tile, cells) = tiles(&found);
    assert_eq!((columns, tile), (3, (8.0, 4.0)));
    let spike = vec!["deadly".to_string(), "sharp".into(), "spike".into()];
    let ice = vec!["cold".to_string(), "slippery".into()];
    let both = vec!["cold".to_string(), "far".into(), "slippery".into()];
    assert_eq!(cells, [both, spike.clone(), spike, vec!["far".to_string()], ice, vec![]]);
    let world = &found.worlds[WorldId(0)];
    let solids = world.spaces[SpaceId(0)].solids.iter().map(|s| s.bounds);
    let solids: Vec<[f64; 4]> = solids.map(|b| [b.left, b.bottom, b.right, b.top]).collect();
    assert_eq!(solids, [[6.0, 4.0, 16.0, 7.0], [2.0, 0.0, 10.0, 2.0]]);
    let at: Vec<[f64; 2]> = world.slots.iter().map(|s| [s.vars[VarId(0)][0], s.vars[VarId(1)][0]]).collect();
    assert_eq!(at, [[10.0, 0.0], [18.0, 4.0]], "the lower-left corner of a rectangle, and of a tile");
}

#[test]
fn findings_point_at_the_place_in_the_level() {
    let layer = |data: &str| format!("<layer name=\"ice\" width=\"3\" height=\"2\">{data}</layer>");
    let csv = |data: &str| layer(&format!("<data encoding=\"csv\">{data}</data>"));
    let objects = |inside: &str| format!("<objectgroup name=\"o\">{inside}</objectgroup>");
    let found = |level: &str| short(&of_level("", level)).join("; ");
    assert_eq!(
        found(&tmx("", &csv("1,1,1,\n1,7,1"))),
        "a.tmx:4:3: error[E0507]: layer `ice`, column 1, row 1: no tileset has tile 7"
    );
    assert_eq!(found(&tmx("", &csv("1,1,x,1,1,1"))), "a.tmx:3:65: error[E0507]: `x` is no number of a tile");
    assert_eq!(found(&tmx("", &csv("1,1"))), "a.tmx:3:40: error[E0507]: there are 2 numbers of tiles, 6 are needed");
    let zstd = layer("<data encoding=\"base64\" compression=\"zstd\">AAAA</data>");
    assert_eq!(
        found(&tmx("", &zstd)),
        "a.tmx:3:40: error[E0507]: the compression `zstd` is not read: choose zlib, gzip or none in the editor"
    );
    let isometric = tmx("", "").replace("orthogonal", "isometric");
    assert_eq!(
        found(&isometric),
        "a.tmx:1:19: error[E0507]: the map is isometric: only orthogonal maps have tiles that are rectangles"
    );
    assert!(found("<map><layer></map>").starts_with("a.tmx:1:13: error[E0507]: the XML is broken: "));
    assert!(found("{ \"type\": \"map\", }").starts_with("a.tmx:1:18: error[E0507]: no JSON: "));
    let empty = csv("0,0,0,0,0,0");
    assert_eq!(
        found(&tmx(
            "",
            &(empty.clone() + &objects("<object id=\"1\" class=\"Coi\" x=\"0\" y=\"0\"><point/></object>"))
        )),
        "a.tmx:3:109: error[E0507]: `Coi` of the level is no entity of the program; did you mean `Coin`?"
    );
    let coin = "<object id=\"1\" class=\"Coin\" x=\"0\" y=\"0\"><properties><property name=\"wort\" type=\"int\" \
                value=\"3\"/></properties></object>";
    assert!(
        found(&tmx("", &(empty.clone() + &objects(coin))))
            .contains("warning[W0505]: the level sets `wort`, which `Coin` does not have; did you mean `worth`?")
    );
    let turned = "<object id=\"1\" class=\"wall\" rotation=\"45\" x=\"0\" y=\"0\" width=\"4\" height=\"4\"/>";
    assert!(found(&tmx("", &(empty + &objects(turned)))).contains("a rectangle that is turned is not read"));
    let outside = tmx("", "<tileset firstgid=\"3\" source=\"no.tsx\"/>");
    let outside = found(&outside);
    assert!(outside.starts_with("a.tmx:3:31: error[E0001]: cannot read `no.tsx`"), "{outside}");
    assert!(!outside.contains(';'), "the tileset is what is missing, and nothing else: {outside}");
}

#[test]
fn what_claims_to_be_huge_takes_no_memory() {
    // 64 MiB of zeros in some hundred bytes of zlib.
    let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    std::io::Write::write_all(&mut zlib, &vec![0; 64 << 20]).unwrap();
    let packed = base64::Engine::encode(&base64::engine::general_purpose::STANDARD, zlib.finish().unwrap());
    let layer = format!(
        "<layer width=\"3\" height=\"2\"><data encoding=\"base64\" compression=\"zlib\">{packed}</data></layer>"
    );
    let found = short(&of_level("", &tmx("", &layer)));
    assert!(found[0].contains("there are more numbers of tiles than 6"), "{found:?}");
    let wide = tmx("", "").replace("width=\"3\"", "width=\"4000000000\"");
    assert!(short(&of_level("", &wide))[0].contains("tiles are too many"));
    let far = "<layer name=\"l\" width=\"16\" height=\"16\"><data encoding=\"csv\">\
               <chunk x=\"-900000000\" y=\"0\" width=\"1\" height=\"1\">1</chunk>\
               <chunk x=\"900000000\" y=\"0\" width=\"1\" height=\"1\">1</chunk></data></layer>";
    assert!(short(&of_level("", &tmx("infinite=\"1\"", far)))[0].contains("tiles are too many"));
    let deep = "{\"a\":".repeat(100_000) + "1" + &"}".repeat(100_000);
    let found = short(&of_level("", &deep));
    assert_eq!(found.len(), 1, "{found:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn changed_levels_are_read_or_refused(
        which in 0..5usize,
        changes in prop::collection::vec((0..40_000usize, 0..12usize, "[0-9a-z\"<>{}\\[\\],./=é-]{0,6}"), 1..4),
    ) {
        const LEVELS: [&str; 5] = ["valley.tmx", "valley.tsx", "valley.tmj", "valley.tsj", "valley.ldtk"];
        let path = format!("{FOLDER}/{}", LEVELS[which]);
        let mut text = std::fs::read_to_string(&path).unwrap();
        for (at, length, new) in changes {
            let mut start = at % text.len().max(1);
            while !text.is_char_boundary(start) { start -= 1; }
            let mut end = (start + length).min(text.len());
            while !text.is_char_boundary(end) { end += 1; }
            text.replace_range(start..end, &new);
        }
        let root = format!("{FOLDER}/test.hyped");
        for map in ["map tiled \"valley.tmx\"", "map tiled \"valley.tmj\"", "map ldtk \"valley.ldtk\""] {
            let program = with_map(map, 7);
            let files = [(root.as_str(), program.as_bytes()), (path.as_str(), text.as_bytes())];
            let found = compile(Path::new(&root), &Beside(&files));
            // Every place is one of the text, on the borders of its characters.
            let human = render::human(&found.sources, found.diagnostics.iter(), false);
            prop_assert_eq!(human.is_empty(), found.diagnostics.is_empty());
            for label in found.diagnostics.iter().filter_map(|d| d.primary.as_ref()) {
                let file = found.sources.file(label.span.file()).text();
                prop_assert!(file.get(label.span.range()).is_some(), "{:?}", label);
            }
        }
    }
}

#[test]
fn the_form_of_a_level_is_told_in_one_finding_each() {
    let counts: BTreeMap<&str, usize> = ["", "{}", "[]", "<a/>", "\"x\"", "<map/>", "{\"type\":\"map\"}"]
        .into_iter()
        .map(|text| (text, short(&of_level("", text)).len()))
        .collect();
    assert!(counts.values().all(|count| *count == 1), "{counts:?}");
}

/// Settings of a block go for what the level leaves out; all formats and kinds of maps agree.
#[test]
fn settings_of_a_block_are_defaults_of_the_level() {
    let level = r#"<map orientation="orthogonal" width="4" height="2" tilewidth="16" tileheight="16" infinite="0">
 <tileset firstgid="1" name="t" tilewidth="16" tileheight="16" tilecount="1" columns="1">
  <tile id="0" type="cell"><properties><property name="speed" type="float" value="9"/></properties></tile>
 </tileset>
 <layer id="1" name="things" width="4" height="2"><data encoding="csv">0,0,0,1,
0,0,0,0</data></layer>
 <objectgroup id="2" name="objects">
  <object id="1" name="one" type="mob" x="0" y="16"><properties>
   <property name="speed" type="float" value="7"/><property name="target" type="object" value="2"/>
  </properties><point/></object>
  <object id="2" name="two" type="mob" x="16" y="16"><properties>
   <property name="mood" value="calm"/>
  </properties><point/></object>
  <object id="3" name="three" type="mob" x="32" y="16"><properties>
   <property name="target" value="placed"/>
  </properties><point/></object>
 </objectgroup>
</map>"#;
    let text = "entity Mob {
    param speed = 1
    discrete mood: {calm, angry} = calm
    discrete lives: int 0..9 = 1
    ref target: Mob
    mode only { x' = if(mood == angry, speed, lives * speed); when lost(target) -> only }
}
world W {
    tiles t 16 x 16 { '.': empty; 'm': spawn Mob as tile { speed = 5; y' = 2; target = placed } }
    space main {
        map tiled \"level.tmx\" {
            mob: spawn Mob { speed = 3; mood = angry; lives = 2; target = placed }
            cell: spawn Mob as cell { speed = 4; lives = 3 }
        }
        place placed: Mob at (0, 0)
    }
    space other {
        map t \"
            .m
        \"
    }
}
";
    let files = [("t.hyped", text.as_bytes()), ("level.tmx", level.as_bytes())];
    let program = program(compile(Path::new("t.hyped"), &Beside(&files)));
    let world = &program.worlds[WorldId(0)];
    let shown: Vec<String> = world
        .slots
        .iter()
        .map(|s| {
            let target = s.refs.iter().next().copied().flatten().map_or("none", |to| &world.slots[to].name);
            let params: Vec<f64> = s.params.iter().copied().collect();
            let discretes: Vec<i32> = s.discretes.iter().copied().collect();
            format!("{}: {params:?} {discretes:?} {target} {}", s.name, s.vars[VarId(1)][1])
        })
        .collect();
    let expected = [
        "cell: [9.0] [0, 3] none 0",
        "one: [7.0] [1, 2] two 0",
        "two: [3.0] [0, 2] placed 0",
        "three: [3.0] [1, 2] placed 0",
        "placed: [1.0] [0, 1] none 0",
        "tile: [5.0] [0, 1] placed 2",
    ];
    let sorted = |lines: &[String]| {
        let mut lines = lines.to_vec();
        lines.sort();
        lines
    };
    assert_eq!(sorted(&shown), sorted(&expected.map(str::to_string)));
}
