//! What the page is told of looks: colours, pictures, and the tiles of a level editor. Runs do not depend on them.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use hypedc::compile::compile;
use hypedc::ir::{Look, Program, TilePicture};
use hypedc::source::{Files, ReadError, SourceMap};
use hypedc::studio::{Answer, Level, MapArt, Request, Scene, Session};

use crate::support::program;

const GAME: &str = "entity Hero {
    look \"hero.png\"
    collider body: rect(0, 0, 16, 16)
    x' = 10
}
entity Coin { collider gold: circle(0, 0, 4) }
world Room {
    look gold: #123
    collide body with ground: block
    space main {
        map tiled \"maps/room.tmj\" { ground: ground; Coin: spawn Coin }
        rect gold (0, 0, 4, 4)
        place hero: Hero at (0, 32)
    }
    player 1: hero
    goal far: hero.x > 100
}
";
/// Two tiles in a row of the tileset, of 16 px, with a border: the ground, and an instance.
const TILESET: &str = r#"{ "type": "tileset", "name": "t", "tilewidth": 16, "tileheight": 16, "tilecount": 4, "columns": 2,
    "margin": 1, "spacing": 2, "image": "../art/tiles.png", "imagewidth": 36, "imageheight": 36,
    "tiles": [{ "id": 3, "type": "Coin" }] }"#;

#[derive(Clone)]
struct Several(BTreeMap<PathBuf, String>);

impl Files for Several {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        self.0.get(path).cloned().ok_or_else(|| ReadError::Unreadable("no such file".into()))
    }
}

/// A map of three columns and two rows in two layers; the second number is a tile that is mirrored horizontally.
fn map(extra: &str) -> String {
    let layer = |name: &str, data: &str| {
        format!("{{ \"type\": \"tilelayer\", \"name\": \"{name}\", \"width\": 3, \"height\": 2, \"data\": [{data}] }}")
    };
    let mirrored = (1_u32 << 31) + 1;
    let layers = [
        layer("sky", "3, 3, 3, 0, 0, 0"),
        layer("ground", &format!("0, 0, 4, 1, {mirrored}, 2")),
        layer("over", "0, 0, 0, 2, 0, 0").replace("\"tilelayer\"", "\"tilelayer\", \"visible\": false"),
    ];
    format!(
        "{{ \"type\": \"map\", \"orientation\": \"orthogonal\", \"width\": 3, \"height\": 2, \"tilewidth\": 16, \
         \"tileheight\": 16, \"layers\": [{}], \"tilesets\": [{{ \"firstgid\": 1, \"source\": \"set/t.tsj\" }}] {extra} }}",
        layers.join(", ")
    )
}

fn files(game: &str, tileset: &str) -> Several {
    let all = [("game/room.hyped", game), ("game/maps/room.tmj", &map("")), ("game/maps/set/t.tsj", tileset)];
    Several(all.into_iter().map(|(path, text)| (path.into(), text.to_string())).collect())
}

fn scene(files: Several) -> (Scene, Vec<String>) {
    let path = PathBuf::from("game/room.hyped");
    let mut session = Session::new(Box::new(files), path, Level::default(), Box::new(|task| task()));
    let Answer::Opened(opened) = session.answer(Request::Open { world: None }) else { panic!() };
    let pictures = session.pictures();
    (opened.scene.unwrap_or_else(|| panic!("{:?}", opened.findings)), pictures)
}

#[test]
fn things_have_the_looks_of_the_text() {
    let (scene, pictures) = scene(files(GAME, TILESET));
    assert_eq!(scene.entities[0].look, Some(Look::Picture("hero.png".into())));
    let gold = Some(Look::Color("#112233".into()));
    assert_eq!(scene.entities[1].look, gold, "a collider has the tag");
    assert_eq!(scene.spaces[0].solids[0].look, gold);
    assert_eq!(pictures, ["hero.png", "maps/art/tiles.png"]);
}

#[test]
fn cells_show_the_tiles_of_the_editor() {
    let (scene, _) = scene(files(GAME, TILESET));
    let art: MapArt = scene.spaces[0].map.clone().unwrap().art.unwrap();
    assert_eq!(art.pictures, ["maps/art/tiles.png"]);
    let shown = |cell: usize| -> Vec<TilePicture> {
        art.stacks[usize::from(art.cells[cell])].iter().map(|tile| art.tiles[usize::from(*tile)].clone()).collect()
    };
    let tile = |left, top, mirrored| TilePicture { picture: 0, part: [left, top, 16, 16], mirrored };
    // The sky means nothing in the game, and is shown; the coin moves, so that it is not; a hidden layer is not.
    for cell in 0..3 {
        assert_eq!(shown(cell), [tile(1, 19, 0)], "cell {cell}");
    }
    assert_eq!(shown(3), [tile(1, 1, 0)]);
    assert_eq!(shown(4), [tile(1, 1, 1)], "mirrored");
    assert_eq!(shown(5), [tile(19, 1, 0)]);
}

/// A level of LDtk: the topmost layer first, tiles by rules and by hand.
#[test]
fn cells_show_the_tiles_of_ldtk() {
    let tile = |px: &str, src: &str, f: u32| format!("{{ \"px\": [{px}], \"src\": [{src}], \"f\": {f}, \"t\": 0 }}");
    let layer = |name: &str, kind: &str, own: &str| {
        format!(
            "{{ \"__identifier\": \"{name}\", \"__type\": \"{kind}\", \"__cWid\": 2, \"__cHei\": 2, \"__gridSize\": 16, \
             \"__pxTotalOffsetX\": 0, \"__pxTotalOffsetY\": 0, \"__tilesetDefUid\": 7, \"__tilesetRelPath\": \"../art/t.png\", \
             \"layerDefUid\": 5, \"visible\": true, {own} }}"
        )
    };
    let over = layer("Over", "Tiles", &format!("\"gridTiles\": [{}]", tile("16, 0", "32, 0", 1)));
    let tiles = [tile("0, 16", "0, 0", 0), tile("16, 16", "16, 0", 2), tile("16, 0", "0, 16", 0)];
    let ground = layer(
        "Ground",
        "IntGrid",
        &format!("\"intGridCsv\": [0, 0, 1, 1], \"autoLayerTiles\": [{}]", tiles.join(", ")),
    );
    let project = format!(
        "{{ \"jsonVersion\": \"1.5.3\", \"defs\": {{ \"tilesets\": [{{ \"uid\": 7, \"tileGridSize\": 16 }}], \"layers\": \
         [{{ \"uid\": 5, \"intGridValues\": [{{ \"value\": 1, \"identifier\": \"ground\" }}] }}] }}, \
         \"levels\": [{{ \"identifier\": \"One\", \"layerInstances\": [{over}, {ground}] }}] }}"
    );
    let game =
        GAME.replace("map tiled \"maps/room.tmj\" { ground: ground; Coin: spawn Coin }", "map ldtk \"maps/room.ldtk\"");
    let mut files = files(&game, TILESET);
    files.0.insert("game/maps/room.ldtk".into(), project);
    let (scene, _) = scene(files);
    let art = scene.spaces[0].map.clone().unwrap().art.unwrap();
    assert_eq!(art.pictures, ["art/t.png"]);
    let shown = |cell: usize| -> Vec<TilePicture> {
        art.stacks[usize::from(art.cells[cell])].iter().map(|tile| art.tiles[usize::from(*tile)].clone()).collect()
    };
    let tile = |left, top, mirrored| TilePicture { picture: 0, part: [left, top, 16, 16], mirrored };
    assert_eq!(shown(0), []);
    assert_eq!(shown(1), [tile(0, 16, 0), tile(32, 0, 1)], "the layer above is over the one below");
    assert_eq!(shown(2), [tile(0, 0, 0)]);
    assert_eq!(shown(3), [tile(16, 0, 2)]);
}

#[test]
fn what_cells_show_is_no_part_of_the_meaning() {
    let read = |tileset: &str| program(compile(Path::new("game/room.hyped"), &files(GAME, tileset)));
    let (shown, plain) = (read(TILESET), read(&TILESET.replace("\"image\"", "\"other\"")));
    assert!(plain.looks.maps.is_empty() && !shown.looks.maps.is_empty());
    let json = |program: &Program| serde_json::to_string(&program.meaning()).unwrap();
    assert_eq!(json(&shown), json(&plain));
    // Written and read again, it is the same; a part of a table that is missing is refused.
    let mut written = Vec::new();
    shown.write_json(&SourceMap::new(), &mut written).unwrap();
    let mut value: serde_json::Value = serde_json::from_slice(&written).unwrap();
    value.as_object_mut().unwrap().remove("sources");
    assert_eq!(Program::from_json(&value.to_string()).unwrap().0.looks, shown.looks);
    value["program"]["looks"]["maps"][0]["stacks"] = serde_json::json!([[]]);
    let refused = Program::from_json(&value.to_string()).map(|_| ()).unwrap_err().to_string();
    assert!(refused.contains("looks"), "{refused}");
}
