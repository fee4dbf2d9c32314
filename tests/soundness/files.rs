//! The files that random programs refer to, in memory: levels of each format, and a file to import.

use std::path::{Path, PathBuf};

use hypedc::compile::{Compilation, LevelFile, compile_with};
use hypedc::source::{Files, ReadError};

const FILES: [(&str, &str); 5] = [
    ("parts.hyped", "const width = 96\n"),
    ("levels/room.txt", "######\n#.a..#\n######\n"),
    (
        "levels/legend.json",
        r##"{"tiles": {"#": ["wall", "solid"], ".": ["passable", "empty"], "a": ["passable", "empty"]}}"##,
    ),
    (
        "levels/cave.tmx",
        r#"<?xml version="1.0" encoding="UTF-8"?>
<map version="1.10" orientation="orthogonal" width="4" height="3" tilewidth="16" tileheight="16" infinite="0">
 <tileset firstgid="1" name="stones" tilewidth="16" tileheight="16" tilecount="2" columns="2"></tileset>
 <layer id="1" name="Rock" width="4" height="3"><data encoding="csv">
0,0,2,0,
0,0,0,0,
1,1,1,1
</data></layer>
 <objectgroup id="2" name="things"><object id="1" type="blob" x="32" y="32"><point/></object></objectgroup>
</map>"#,
    ),
    (
        "levels/world.ldtk",
        r#"{ "jsonVersion": "1.5.3",
  "defs": { "layers": [{ "uid": 7, "intGridValues": [{ "value": 1, "identifier": "Rock" }] }] },
  "levels": [{ "identifier": "Cave", "layerInstances": [
    { "__identifier": "Things", "__type": "Entities", "__cWid": 3, "__cHei": 2, "__gridSize": 16, "entityInstances": [
      { "__identifier": "Mob", "px": [40, 16], "__pivot": [0.5, 1], "width": 16, "height": 16 }
    ] },
    { "__identifier": "Ground", "__type": "IntGrid", "layerDefUid": 7, "__cWid": 3, "__cHei": 2, "__gridSize": 16,
      "intGridCsv": [0,0,0, 1,1,1] }
  ] }] }"#,
    ),
];

/// A program's text, and the files that it refers to.
struct Shelf<'a>(&'a str);

impl Files for Shelf<'_> {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        if path == Path::new("test.hyped") {
            return Ok(self.0.to_string());
        }
        let found = FILES.iter().find(|(name, _)| path == Path::new(name));
        found.map(|(_, text)| (*text).to_string()).ok_or_else(|| ReadError::Unreadable("no such file".into()))
    }

    fn identity(&self, path: &Path) -> PathBuf {
        path.to_path_buf()
    }
}

/// Compiles a random program.
pub fn compiled(text: &str) -> Compilation {
    let level = match text.contains("map level") {
        true => LevelFile {
            tile: text.contains("map level {").then_some((16.0, 16.0)),
            ..LevelFile::new(Path::new("levels/room.txt"))
        },
        false => LevelFile::default(),
    };
    compile_with(Path::new("test.hyped"), level, &Shelf(text))
}
