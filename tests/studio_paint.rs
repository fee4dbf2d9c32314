//! Painting into the files of level editors: one number changes, and nothing else; what cannot be painted says why.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use hypedc::source::{Files, ReadError};
use hypedc::studio::{Answer, Level, MapInfo, Opened, Request, Session};

struct Memory(BTreeMap<PathBuf, String>);

impl Files for Memory {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        self.0.get(path).cloned().ok_or_else(|| ReadError::Unreadable("no such file".into()))
    }
}

const HERO: &str = "
entity Hero {
    param speed = 10
    collider body: rect(0, 0, 8, 8)
    x' = speed
}
entity Slime {
    param speed = 5
    collider body: rect(0, 0, 8, 8)
    x' = speed
}
world Room {
    collide body with ground: block
    collide body with lava: sense
    space main {
        MAP
        place hero: Hero at (0, 16)
    }
    player 1: hero
    goal far: hero.x > 20
}
";

const TILESET: &str = r#"{"firstgid": 1, "name": "t", "tilewidth": 16, "tileheight": 16, "tilecount": 8, "columns": 4,
  "image": "art/tiles.png", "imagewidth": 64, "imageheight": 32,
  "tiles": [{"id": 4, "type": "Slime"}, {"id": 5, "type": "hot"}, {"id": 6, "type": "lawn"}]}"#;

/// A map whose ground has a mirrored tile (2147483649 is 1), with a layer of decoration, and one of water above.
fn json_map(data: &str) -> String {
    format!(
        r#"{{ "type": "map", "orientation": "orthogonal", "width": 3, "height": 2, "tilewidth": 16, "tileheight": 16,
  "tilesets": [{TILESET}],
  "layers": [
    {{ "type": "tilelayer", "name": "ground", "width": 3, "height": 2, "data": {data} }},
    {{ "type": "tilelayer", "name": "sky", "width": 3, "height": 2, "data": [3, 3, 3, 3, 3, 3] }},
    {{ "type": "tilelayer", "name": "water", "width": 3, "height": 2, "data": [ 0,0,0,
       0, 0 ,4 ] }}
  ] }}
"#
    )
}

const DATA: &str = "[0, 0,\n 0,2,   2147483649,1]";
const KINDS: &str = "{\n ground: ground\n sky: empty\n hot: lava\n}";

struct Playing {
    session: Session,
    opened: Opened,
}

impl Playing {
    fn new(map: &str, files: &[(&str, &str)], level: Option<&str>) -> Playing {
        let mut all: BTreeMap<PathBuf, String> =
            files.iter().map(|(path, text)| (PathBuf::from(path), (*text).to_string())).collect();
        all.insert("games/room.hyped".into(), HERO.replace("MAP", map));
        let level = Level { map: level.map(PathBuf::from), ..Level::default() };
        let root = PathBuf::from("games/room.hyped");
        let mut session = Session::new(Box::new(Memory(all)), root, level, Box::new(|task| task()));
        let Answer::Opened(opened) = session.answer(Request::Open { world: None }) else { panic!() };
        let opened = *opened;
        assert!(opened.is_current, "{:?}", opened.findings);
        Playing { session, opened }
    }

    fn map(&self) -> &MapInfo {
        self.opened.scene.as_ref().unwrap().spaces[0].map.as_ref().unwrap()
    }

    fn brushes(&self) -> Vec<String> {
        self.map().brushes.iter().map(|brush| format!("{} {}", brush.symbol, brush.label)).collect()
    }

    fn text(&mut self, path: &str) -> String {
        let answer = self.session.answer(Request::Text { path: Some(path.to_string()), written: true });
        let Answer::Text { text } = answer else { panic!("{answer:?}") };
        text
    }

    fn paint(&mut self, cell: usize, symbol: &str) {
        let answer = self.session.answer(Request::Paint { space: 0, cell, symbol: symbol.to_string() });
        let Answer::Opened(opened) = answer else { panic!("{answer:?}") };
        assert!(opened.is_current, "{:?}", opened.findings);
        self.opened = *opened;
    }

    fn undo(&mut self) {
        let Answer::Opened(opened) = self.session.answer(Request::Undo) else { panic!() };
        self.opened = *opened;
    }

    /// The tags of a cell.
    fn tags(&self, cell: usize) -> Vec<&str> {
        let (scene, map) = (self.opened.scene.as_ref().unwrap(), self.map());
        let Ok(kind) = usize::try_from(map.cells[cell]) else { return Vec::new() };
        map.kinds[kind].tags.iter().map(|tag| scene.tags[*tag].as_str()).collect()
    }
}

#[test]
fn a_cell_of_a_tiled_map_is_one_number() {
    let map = json_map(DATA);
    let program = format!("map tiled \"level.tmj\" {KINDS}");
    let mut playing = Playing::new(&program, &[("games/level.tmj", &map)], None);
    // Used tiles have the names of their layers; unused ones are offered if the program knows a name of theirs.
    assert_eq!(playing.brushes(), ["0 empty", "0/1 ground", "0/2 ground", "1/4 water", "5 spawn Slime", "6 lava"]);
    let lava = playing.map().brushes.iter().find(|brush| brush.symbol == "6").unwrap();
    assert_eq!(lava.picture.as_ref().unwrap().part, [16, 16, 16, 16]);
    assert_eq!(playing.map().art.as_ref().unwrap().pictures, ["art/tiles.png"]);
    assert_eq!((playing.tags(0), playing.tags(4)), (vec![], vec!["ground"]));

    // The mirrored number goes as a whole, the white space beside it stays.
    playing.paint(4, "0/2");
    let once = map.replace("2147483649", "2");
    assert_eq!(playing.text("games/level.tmj"), once);
    // An empty cell belongs to the lowest layer; one with water to the water.
    playing.paint(0, "6");
    let twice = once.replace("[0, 0,\n", "[6, 0,\n");
    assert_eq!(playing.text("games/level.tmj"), twice);
    assert_eq!(playing.tags(0), ["lava"]);
    assert_eq!(playing.tags(5), ["ground", "water"]);
    playing.paint(5, "0");
    let thrice = twice.replace("0 ,4 ]", "0 ,0 ]");
    assert_eq!(playing.text("games/level.tmj"), thrice);
    assert_eq!(playing.tags(5), ["ground"]);
    playing.paint(5, "0");
    assert_eq!(playing.text("games/level.tmj"), thrice.replace("2,1]", "2,0]").replace("   2,1", "   2,0"));
    assert!(playing.tags(5).is_empty());
    // A tile that spawns.
    let count = playing.opened.scene.as_ref().unwrap().slots.len();
    playing.paint(1, "5");
    assert_eq!(playing.opened.scene.as_ref().unwrap().slots.len(), count + 1);
    for before in [None, Some(&thrice), Some(&twice), Some(&once), Some(&map)] {
        playing.undo();
        assert!(before.is_none_or(|before| *before == playing.text("games/level.tmj")));
    }
    assert!(playing.opened.unsaved.is_empty());
    // What is there already is no change.
    playing.paint(3, "0/2");
    assert!(matches!(playing.session.answer(Request::Undo), Answer::Refused { .. }));
    for (cell, symbol) in [(0, "99"), (0, "0/5"), (0, "#"), (600, "0")] {
        let answer = playing.session.answer(Request::Paint { space: 0, cell, symbol: symbol.to_string() });
        assert!(matches!(answer, Answer::Refused { .. }), "{symbol}: {answer:?}");
    }
}

#[test]
fn of_too_many_tiles_those_that_the_map_has_are_offered() {
    let tiles: Vec<String> = (1..700).map(|id| format!(r#"{{"id": {id}, "type": "hot"}}"#)).collect();
    let large = TILESET.replace("\"tilecount\": 8", "\"tilecount\": 700");
    let (head, _) = large.split_once("\"tiles\"").unwrap();
    let map = json_map("[0, 0, 700, 0, 0, 1]").replace(TILESET, &format!("{head} \"tiles\": [{}]}}", tiles.join(", ")));
    let program = format!("map tiled \"level.tmj\" {KINDS}");
    let playing = Playing::new(&program, &[("games/level.tmj", &map)], None);
    // The empty one, 1, 3, 4 and 700 of the map, and the others that are `hot`.
    assert_eq!(playing.map().brushes.len(), 500);
    assert!(playing.brushes()[..5].iter().any(|brush| brush.starts_with("700 ")), "{:?}", &playing.brushes()[..5]);
    assert_eq!(playing.map().brushes_left_out, 201);
}

#[test]
fn csv_of_xml_and_tilesets_in_files_are_painted() {
    let tileset = r#"<tileset name="t" tilewidth="16" tileheight="16" tilecount="4" columns="4">
 <tile id="1" class="lava"/></tileset>"#;
    let map = r#"<?xml version="1.0"?>
<map orientation="orthogonal" width="3" height="2" tilewidth="16" tileheight="16" infinite="0">
 <tileset firstgid="1" source="t.tsx"/>
 <group name="all"><layer name="ground" width="3" height="2"><data encoding="csv">
0,0,1,
1,1,1
</data></layer></group>
</map>
"#;
    let files = [("levels/level.tmx", map), ("levels/t.tsx", tileset)];
    // The level of the command line.
    let mut playing = Playing::new("map level { ground: ground }", &files, Some("levels/level.tmx"));
    assert_eq!(playing.brushes(), ["0 empty", "0/1 ground", "2 lava"]);
    playing.paint(2, "2");
    assert_eq!(playing.text("levels/level.tmx"), map.replace("0,0,1,", "0,0,2,"));
    playing.paint(5, "0");
    assert_eq!(playing.text("levels/level.tmx"), map.replace("0,0,1,\n1,1,1", "0,0,2,\n1,1,0"));
}

#[test]
fn what_is_no_number_says_how_it_becomes_one() {
    let program = format!("map tiled \"level.tmj\" {KINDS}");
    let packed = json_map(r#""AAAAAAAAAAABAAAAAQAAAAEAAAABAAAA", "encoding": "base64""#);
    let chunk = format!(r#""chunks": [{{ "x": 0, "y": 0, "width": 3, "height": 2, "data": {DATA} }}]"#);
    let infinite = json_map(DATA)
        .replace(&format!(r#""data": {DATA}"#), &chunk)
        .replace(r#""type": "map","#, r#""type": "map", "infinite": true,"#);
    for (map, why) in [(packed, "`ground` are packed"), (infinite, "infinite map is not painted")] {
        let mut playing = Playing::new(&program, &[("games/level.tmj", &map)], None);
        let said = playing.map().unpainted.clone().unwrap();
        assert!(said.contains(why) && said.contains("Map Properties"), "{said}");
        assert!(playing.map().brushes.is_empty());
        let answer = playing.session.answer(Request::Paint { space: 0, cell: 0, symbol: "0".into() });
        assert!(matches!(answer, Answer::Refused { message } if message == said));
        assert_eq!(playing.text("games/level.tmj"), map);
    }
}

/// A level of LDtk: two grids, the one above is `Liquids`.
fn level() -> String {
    let layer = |name: &str, uid: u32, grid: &str, tiles: &str| {
        format!(
            r#"{{"__identifier": "{name}", "__type": "IntGrid", "__cWid": 3, "__cHei": 2, "__gridSize": 16,
      "layerDefUid": {uid}, "__tilesetDefUid": 9, "__tilesetRelPath": "tiles.png",
      "intGridCsv": {grid}, "autoLayerTiles": {tiles}}}"#
        )
    };
    let drawn = r#"[{"px": [0, 16], "src": [0, 0], "f": 0}, {"px": [16, 16], "src": [16, 0], "f": 0}]"#;
    let liquids = layer("Liquids", 2, "[0,0,0, 0,0,1]", "[]");
    format!(
        r#"{{"identifier": "Level_0", "layerInstances": [{liquids}, {}]}}"#,
        layer("Walls", 1, "[\n0,0,0,\n1,1,1\n]", drawn)
    )
}

fn project(levels: &str) -> String {
    format!(
        r#"{{"__header__": {{"app": "LDtk"}}, "jsonVersion": "1.5.3", "defs": {{
  "tilesets": [{{"uid": 9, "tileGridSize": 16}}],
  "layers": [
    {{"uid": 1, "intGridValues": [{{"value": 1, "identifier": "ground"}}, {{"value": 2, "identifier": "ice"}}]}},
    {{"uid": 2, "intGridValues": [{{"value": 1, "identifier": "lava"}}]}}]}},
  "levels": [{levels}]}}"#
    )
}

#[test]
fn a_cell_of_an_integer_grid_is_one_number() {
    let map = project(&level());
    let kinds = "{\n Walls: ground\n Liquids: lava\n ice: ground\n}";
    let program = format!("map ldtk \"world.ldtk\" level \"Level_0\" {kinds}");
    let mut playing = Playing::new(&program, &[("games/world.ldtk", &map)], None);
    assert_eq!(playing.brushes(), ["0 empty", "0/1 ground", "1/1 lava", "0/2 ground"]);
    let stacks = |playing: &Playing| {
        let art = playing.map().art.clone().unwrap();
        art.cells.iter().map(|stack| art.stacks[usize::from(*stack)].len()).collect::<Vec<_>>()
    };
    assert_eq!(stacks(&playing), [0, 0, 0, 1, 1, 0]);
    playing.paint(3, "0");
    let once = map.replace("1,1,1\n]", "0,1,1\n]");
    assert_eq!(playing.text("games/world.ldtk"), once);
    // What LDtk's rules drew for the old value is not shown over the new one.
    assert_eq!(stacks(&playing), [0, 0, 0, 0, 1, 0]);
    playing.paint(1, "1/1");
    assert_eq!(playing.text("games/world.ldtk"), once.replace("[0,0,0, 0,0,1]", "[0,1,0, 0,0,1]"));
    assert_eq!(playing.tags(1), ["lava"]);
    playing.undo();
    playing.undo();
    assert_eq!(playing.text("games/world.ldtk"), map);
    assert_eq!(stacks(&playing), [0, 0, 0, 1, 1, 0]);

    // A level in a file of its own, named on the command line.
    let (own, apart) = (level(), project(r#"{"identifier": "Level_0", "externalRelPath": "world/Level_0.ldtkl"}"#));
    let files = [("games/world.ldtk", apart.as_str()), ("games/world/Level_0.ldtkl", own.as_str())];
    let mut playing = Playing::new(&format!("map level {kinds}"), &files, Some("games/world.ldtk#Level_0"));
    playing.paint(5, "0");
    assert_eq!(playing.text("games/world/Level_0.ldtkl"), own.replace("0,0,1]", "0,0,0]"));
    assert_eq!(playing.text("games/world.ldtk"), apart);
}
