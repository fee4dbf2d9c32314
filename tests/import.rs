//! Imports: the entities of the 2017 system become readable programs that check, and that run like the recorded runs of
//! that system; parts that cannot be imported are reported, and the import never fails otherwise.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "conformance/compare.rs"]
mod compare;
#[path = "conformance/record.rs"]
mod record;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Arc;

use crate::support::{Disk, Text, compile_text, files};
use hypedc::compile::{LevelFile, check_with, compile};
use hypedc::diagnostic::{Code, render};
use hypedc::format::format;
use hypedc::import::{Import, xml};
use hypedc::ir::Program;
use hypedc::source::{Files, SourceMap};
use proptest::prelude::*;
use serde::Deserialize;

/// Imports a text; returns the result, and the rendered findings.
fn import(path: &Path, text: &str) -> (Import, String) {
    let mut sources = SourceMap::new();
    let file = sources.add(path, text);
    let import = xml::import(file, text, &mut xml::Entities::default());
    let shown = render::human(&sources, import.diagnostics.iter(), false);
    (import, shown)
}

/// The definitions of the 2017 system.
fn definitions() -> Vec<(PathBuf, String)> {
    files("tests/import/xml", "xml").into_iter().map(|path| (path.clone(), Disk.read(&path).unwrap())).collect()
}

#[test]
fn definitions_become_programs_that_check() {
    let all = definitions();
    assert_eq!(all.len(), 11);
    for (path, text) in all {
        let (Import { text, diagnostics }, shown) = import(&path, &text);
        assert!(!diagnostics.has_errors(), "{shown}");
        let text = text.unwrap();
        assert_eq!(format(SourceMap::new().add("test.hyped", ""), &text).unwrap(), text, "{}", path.display());
        let checked = check_with(Path::new("test.hyped"), LevelFile::default(), &Text(&text));
        // Only findings that a world would resolve.
        let warnings: Vec<Code> = checked.diagnostics.iter().map(|d| d.code).collect();
        assert!(warnings.is_empty(), "{}", render::human(&checked.sources, checked.diagnostics.iter(), false));
        let name = path.file_name().unwrap().to_string_lossy().replace(".char.xml", "");
        let findings = if shown.is_empty() { String::new() } else { format!("\n{shown}") };
        insta::assert_snapshot!(format!("import_{name}"), format!("{text}{findings}"));
    }
}

/// An instance in the world of a recorded run: what defines it, and its parameters, those left alone, too.
#[derive(Deserialize)]
struct Instance {
    name: String,
    params: BTreeMap<String, f64>,
}

/// The instances of each recorded run, in the order in which they are recorded.
fn instances() -> BTreeMap<String, Vec<Instance>> {
    serde_json::from_str(&std::fs::read_to_string("tests/import/instances.json").unwrap()).unwrap()
}

/// The world of a recorded run, with imported entities in place of those written by hand.
fn imported(name: &str) -> Arc<Program> {
    let instances = instances().remove(name).unwrap();
    let mut program = String::new();
    let mut entities: BTreeMap<&str, (String, String)> = BTreeMap::new();
    for Instance { name, .. } in &instances {
        if !entities.contains_key(name.as_str()) {
            let path = PathBuf::from(format!("tests/import/xml/{name}.char.xml"));
            let text = import(&path, &Disk.read(&path).unwrap()).0.text.unwrap();
            let entity = text.split_once("entity ").unwrap().1.split_once(' ').unwrap().0.to_string();
            program.push_str(&text);
            entities.insert(name, (entity, text));
        }
    }
    let mut instances = instances.iter();
    let world = std::fs::read_to_string(format!("tests/conformance/{name}.hyped")).unwrap();
    for line in world.lines().filter(|line| !line.starts_with("import ")) {
        let Some((instance, rest)) = line.trim_start().strip_prefix("place ").and_then(|l| l.split_once(": ")) else {
            writeln!(program, "{line}").unwrap();
            continue;
        };
        let at = rest.split_once(" at ").unwrap().1.split_once(')').unwrap().0;
        let of = instances.next().unwrap();
        let (entity, text) = &entities[of.name.as_str()];
        let declared = of.params.iter().filter(|(name, _)| text.contains(&format!("param {name} = ")));
        let settings: String = declared.map(|(name, value)| format!(" {name} = {value};")).collect();
        writeln!(program, "place {instance}: {entity} at {at}) {{{settings} }}").unwrap();
    }
    assert!(instances.next().is_none(), "{name}: all instances are placed");
    crate::support::program(compile_text(&program))
}

/// The world of a recorded run, with entities written by hand.
fn by_hand(name: &str) -> Arc<Program> {
    crate::support::program(compile(&Path::new("tests/conformance").join(format!("{name}.hyped")), &Disk))
}

#[test]
fn imported_entities_run_as_recorded() {
    let steps = compare::steps(imported);
    assert!(steps.contains("all: 7197 steps, 7195 agree, 2 excused"), "{steps}");
    assert_eq!(steps, compare::steps(by_hand));
    assert_eq!(compare::free_runs(imported), compare::free_runs(by_hand));
}

#[test]
fn what_cannot_be_carried_over_is_told_of() {
    for path in files("tests/import/findings", "xml") {
        let text = Disk.read(&path).unwrap();
        let (Import { text, .. }, shown) = import(&path, &text);
        let text = text.unwrap();
        let name = path.file_name().unwrap().to_string_lossy().replace(".char.xml", "");
        if ["names", "discrete"].contains(&name.as_str()) {
            let checked = check_with(Path::new("test.hyped"), LevelFile::default(), &Text(&text));
            assert!(checked.diagnostics.is_empty(), "{}", render::short(&checked.sources, checked.diagnostics.iter()));
        }
        insta::assert_snapshot!(format!("findings_{name}"), format!("{text}\n{shown}"));
    }
}

/// Texts that are no documents, or that would take long to read.
fn refused() -> Vec<(&'static str, String)> {
    let deep = |open: &str, close: &str, times: usize| open.repeat(times) + &close.repeat(times);
    let attributes: String = (0..20_000).map(|n| format!(" a{n}='>'")).collect();
    let spaces: String = (0..2_000).map(|n| format!("<e xmlns:n{n}='u{n}'>")).collect();
    vec![
        ("empty", String::new()),
        ("no element", "<!-- nothing -->".into()),
        ("wrong end", "<automaton name='a'>\n  <group>\n  </mode>\n</automaton>".into()),
        ("no end", "<automaton name='a'>\n  <group>\n".into()),
        ("bare sign", "<automaton name='a & b'/>".into()),
        ("less", "<automaton name='a'><group name='a < b'/></automaton>".into()),
        ("twice", "<automaton name='a' name='b'/>".into()),
        ("comment", "<automaton name='a'>\n  <!-- a -- b -->\n</automaton>".into()),
        ("no quotes", "<automaton name=a/>".into()),
        ("prefix", "<a:automaton name='a'/>".into()),
        ("second root", "<automaton name='a'/>\n<automaton name='b'/>".into()),
        ("not a document", "entity Bird { }\n".into()),
        ("macros", "<!DOCTYPE a [<!ENTITY a 'aaaa'><!ENTITY b '&a;&a;'>]>\n<automaton name='&b;'/>".into()),
        ("unknown macro", "<automaton name='&b;'/>".into()),
        ("deep", deep("<group><mode name='a'>", "</mode></group>", 4_000)),
        ("crowd", format!("<automaton{attributes}/>")),
        ("namespaces", spaces),
        ("many", format!("<automaton name='a'>{}</automaton>", "<flow/>".repeat(30_000))),
        ("large", " ".repeat(2 << 20)),
    ]
}

#[test]
fn what_is_no_document_is_refused_with_its_place() {
    let mut all = String::new();
    for (what, text) in refused() {
        let mut sources = SourceMap::new();
        let file = sources.add("test.char.xml", text.as_str());
        let Import { text, diagnostics } = xml::import(file, &text, &mut xml::Entities::default());
        assert_eq!(text, None, "{what}");
        let codes: Vec<Code> = diagnostics.iter().map(|d| d.code).collect();
        assert_eq!(codes, [Code::NotWellFormed], "{what}");
        write!(all, "{what}: {}", render::short(&sources, diagnostics.iter())).unwrap();
    }
    insta::assert_snapshot!(all);
}

#[test]
fn a_crowd_of_names_is_given_out_in_time() {
    // All differ, and all would get the same name.
    let odd = |n: usize| (0..6).map(|at| b"-.+!:"[n / 5_usize.pow(at) % 5] as char).collect::<String>();
    let modes: String = (0..4_000).map(|n| format!("<mode name='a{}b'/>", odd(n))).collect();
    let text = format!("<automaton name='crowd'><group name='g'>{modes}</group></automaton>");
    let text = import(Path::new("crowd.char.xml"), &text).0.text.unwrap();
    let mut names: Vec<&str> = text.lines().filter_map(|l| l.trim().strip_prefix("mode ")).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!((count, names.len()), (4_000, 4_000));
}

/// The inserted texts: symbols of XML, and names and values of the form.
const PIECES: &[&str] = &[
    "<",
    ">",
    "/>",
    "\"",
    "'",
    "&",
    "&#9;",
    "<!--",
    "-->",
    "<![CDATA[",
    "]]>",
    "<?a?>",
    "\n",
    "\r",
    "\u{85}",
    "é",
    "\u{0}",
    "<mode name=\"a\">",
    "</mode>",
    "<group name=\"x\">",
    "</group>",
    "<edge target=\"falling\">",
    "</edge>",
    "<guard>",
    "</guard>",
    "<not>",
    "</not>",
    "<or>",
    "</or>",
    "<true/>",
    "<timer limit=\"1\"/>",
    "name=\"mode\"",
    "<colliding othertype=\"left\"/>",
    "<envelope ways=\"8\">",
    "</envelope>",
    "<rect x=\"a\" y=\"b\" w=\"c\" h=\"d\"/>",
    "<update var=\"y'\" value=\"-(1+2)*x/3\"/>",
    "<dvariable name=\"n\" value=\"1e9\"/>",
    "<!-- } // { -->",
    "((((",
    "1e400",
    "-",
    "**2",
    "keys-1",
    "max(x, 2)",
    "\" value=\"",
    "static=\"true\"",
    "automaton",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any bytes are imported or rejected, and the result is a canonical program.
    #[test]
    fn any_bytes_are_imported_or_refused(
        which in 0..11_usize,
        edits in prop::collection::vec((0.0..1.0_f64, 0..4_usize, 0..PIECES.len(), 0..60_usize), 1..8),
    ) {
        let (path, text) = definitions().swap_remove(which);
        let mut bytes = text.into_bytes();
        for (at, kind, piece, length) in edits {
            let at = ((bytes.len() as f64) * at) as usize;
            let end = (at + length).min(bytes.len());
            match kind {
                0 => drop(bytes.drain(at..end)),
                1 => drop(bytes.splice(at..at, PIECES[piece].bytes())),
                2 => drop(bytes.splice(at..end, PIECES[piece].bytes())),
                _ => {
                    let copy = bytes[at..end].to_vec();
                    drop(bytes.splice(at..at, copy));
                }
            }
        }
        let text = String::from_utf8_lossy(&bytes);
        let (Import { text, diagnostics }, shown) = import(&path, &text);
        match text {
            Some(text) => {
                let canonical = format(SourceMap::new().add("test.hyped", ""), &text);
                prop_assert_eq!(canonical.as_deref(), Ok(text.as_str()), "{}", shown);
            }
            None => prop_assert!(
                diagnostics.iter().any(|d| matches!(d.code, Code::NotWellFormed | Code::BadForm)),
                "{}", shown
            ),
        }
    }
}

fn hypedc(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hypedc")).args(arguments).output().unwrap()
}

#[test]
fn the_command_prints_or_writes_programs() {
    let (door, key) = ("tests/import/xml/door.char.xml", "tests/import/xml/key.char.xml");
    let printed = |file: &str| String::from_utf8(hypedc(&["import", "xml", file]).stdout).unwrap();
    let both = hypedc(&["import", "xml", door, key]);
    assert_eq!((both.status.code(), both.stderr.as_slice()), (Some(0), &[][..]));
    let both = String::from_utf8(both.stdout).unwrap();
    assert_eq!(both, format!("{}\n{}", printed(door), printed(key)));
    assert_eq!(format(SourceMap::new().add("test.hyped", ""), &both).unwrap(), both);
    let twice = hypedc(&["import", "xml", "--format", "short", door, door]);
    assert!(String::from_utf8_lossy(&twice.stdout).contains("entity Door2 {"), "names in one text differ");
    assert!(String::from_utf8_lossy(&twice.stderr).contains("warning[W0801]"));

    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("import");
    let _ = std::fs::remove_dir_all(&folder);
    let shown = folder.to_string_lossy().into_owned();
    let written = hypedc(&["import", "xml", door, key, "-o", &shown]);
    assert_eq!((written.status.code(), written.stdout.as_slice()), (Some(0), &[][..]));
    assert_eq!(std::fs::read_to_string(folder.join("key.hyped")).unwrap(), printed(key));
    let door_program = folder.join("door.hyped");
    std::fs::write(&door_program, "mine").unwrap();
    let again = hypedc(&["import", "xml", door, "-o", &shown]);
    assert_eq!(again.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&again.stderr).contains("it is there already; `--force` replaces it"));
    assert_eq!(std::fs::read_to_string(&door_program).unwrap(), "mine");
    assert_eq!(hypedc(&["import", "xml", door, "--output", &shown, "--force"]).status.code(), Some(0));
    assert_eq!(std::fs::read_to_string(&door_program).unwrap(), printed(door));
}

#[test]
fn the_command_ends_with_a_code_for_what_was_found() {
    let code = |arguments: &[&str]| hypedc(&[&["import", "xml"], arguments].concat()).status.code();
    assert_eq!(code(&["tests/import/xml/mario.char.xml"]), Some(0));
    assert_eq!(code(&["tests/import/findings/meaning.char.xml"]), Some(1));
    assert_eq!(code(&["tests/import/no such.char.xml", "tests/import/findings/meaning.char.xml"]), Some(2));
    assert_eq!(code(&["Cargo.toml"]), Some(1));
    let json = hypedc(&["import", "xml", "tests/import/findings/meaning.char.xml", "--format", "json"]);
    let found: serde_json::Value = serde_json::from_slice(&json.stderr).unwrap();
    assert!(found["findings"].as_array().unwrap().len() > 5);
    let sarif = hypedc(&["import", "xml", "tests/import/findings/meaning.char.xml", "--format", "sarif"]);
    let found: serde_json::Value = serde_json::from_slice(&sarif.stderr).unwrap();
    assert_eq!(found["version"], "2.1.0");
}
