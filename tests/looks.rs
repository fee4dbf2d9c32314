//! Looks: what the table holds, and that nothing that runs depends on it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::support::{compile_text, program};
use hypedc::compile::compile;
use hypedc::ir::{EntityId, Look, Program, SlotId, TagSet, WorldId};
use hypedc::source::{Files, ReadError, SourceMap};

const WORLD: WorldId = WorldId(0);

/// A program with looks; without them it is `text("")`.
fn text(look: &str, tag_look: &str) -> String {
    format!(
        "entity Hero {{
            {look}
            button jump
            collider body, hero: rect(0, 0, 16, 16)
            y' = if(held(jump), 60, 0)
        }}
        world Room {{
            {tag_look}
            collide body with coin: sense
            tiles room 16 x 16 {{ '.': empty; 'o': coin, \"gold bar\"; '#': rock }}
            space main {{
                map room \"
                    .o.#
                \"
                place hero: Hero at (0, 0)
            }}
            player 1: hero
            goal rich: hero touching coin
        }}"
    )
}

#[test]
fn the_table_holds_colors_and_pictures() {
    let text = text("look #E43", "look coin: \"coin.png\"\nlook \"gold bar\", rock: #0A0B0C");
    let program = program(compile_text(&text));
    let (color, coin) = (Look::Color("#ee4433".into()), Look::Picture("coin.png".into()));
    assert_eq!(program.looks.of_entity(EntityId(0)), Some(&color));
    assert_eq!(program.look_of(WORLD, SlotId(0)), Some(&color));
    assert_eq!(color.rgb(), Some([0xee, 0x44, 0x33]));
    let tag = |name: &str| TagSet::of(program.tags.find(|tag| tag == name).unwrap());
    let rock = Look::Color("#0a0b0c".into());
    // Of several tags the first line counts.
    assert_eq!(program.looks.of_tags(WORLD, tag("coin").with(tag("gold bar"))), Some(&coin));
    assert_eq!(program.looks.of_tags(WORLD, tag("gold bar")), Some(&rock));
    assert_eq!(program.looks.of_tags(WORLD, tag("body")), None);
    assert_eq!(program.looks.pictures(), ["coin.png"]);
}

/// An instance without a look of its own has that of a tag of its colliders.
#[test]
fn the_look_of_a_tag_is_that_of_instances_too() {
    let looks = |look: &str| {
        let program = program(compile_text(&text(look, "look hero: #123456")));
        program.look_of(WORLD, SlotId(0)).cloned()
    };
    assert_eq!(looks(""), Some(Look::Color("#123456".into())));
    assert_eq!(looks("look \"hero.png\""), Some(Look::Picture("hero.png".into())));
}

#[test]
fn nothing_that_runs_depends_on_looks() {
    let plain = program(compile_text(&text("", "")));
    let shown = program(compile_text(&text("look \"hero.png\"", "look coin, rock: #123")));
    assert!(plain.looks.is_empty() && !shown.looks.is_empty());
    let json = |program: &Program| serde_json::to_string(&program.meaning()).unwrap();
    assert_eq!(json(&plain), json(&shown));
    // A tag that only a look names is no tag of the program.
    let other = program(compile_text(&text("", "look silver: #ccc")));
    assert_eq!(json(&plain), json(&other));
    assert!(other.looks.is_empty());
}

#[test]
fn looks_are_written_and_read_and_wrong_ones_refused() {
    let program = program(compile_text(&text("look \"hero.png\"", "look coin: #123")));
    let mut written = Vec::new();
    program.write_json(&SourceMap::new(), &mut written).unwrap();
    let written = String::from_utf8(written).unwrap();
    let bare = |text: &str| {
        let mut value: serde_json::Value = serde_json::from_str(text).unwrap();
        value.as_object_mut().unwrap().remove("sources");
        value.to_string()
    };
    let (back, _) = Program::from_json(&bare(&written)).unwrap();
    assert_eq!(back.looks, program.looks);
    for (good, wrong) in [("#112233", "#11223"), ("hero.png", "/hero.png")] {
        assert!(written.contains(good), "{written}");
        let refused = Program::from_json(&bare(&written.replace(good, wrong))).map(|_| ()).unwrap_err().to_string();
        assert!(refused.contains("looks"), "{wrong}: {refused}");
    }
}

struct Several(BTreeMap<PathBuf, String>);

impl Files for Several {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        self.0.get(path).cloned().ok_or_else(|| ReadError::Unreadable("no such file".into()))
    }
}

/// A path is relative to the file that names it; in the table it is relative to the program.
#[test]
fn paths_of_imports_lead_to_their_folders() {
    let files = [
        ("games/one/main.hyped", "import \"parts/bat.hyped\"\nimport \"../slime.hyped\"\n".to_string() + &text("", "")),
        ("games/one/parts/bat.hyped", "entity Bat { look \"pictures/bat.png\" }".to_string()),
        ("games/one/../slime.hyped", "entity Slime { look \"slime.png\" }".to_string()),
    ];
    let files = Several(files.into_iter().map(|(path, text)| (path.into(), text)).collect());
    let program = program(compile(Path::new("games/one/main.hyped"), &files));
    assert_eq!(program.looks.pictures(), ["../slime.png", "parts/pictures/bat.png"]);
}
