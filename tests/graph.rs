//! Statecharts: the contents of the pictures, and their legibility.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::support::{Disk, compile_text, files};
use hypedc::compile::compile;
use hypedc::graph::{Chart, chart, dot, mermaid, svg};

fn charts(path: &Path) -> Vec<Chart> {
    let compilation = compile(path, &Disk);
    let sources = compilation.sources.clone();
    let program = crate::support::program(compilation);
    program.entities.ids().map(|id| chart(&program, &sources, id)).collect()
}

fn charts_of(text: &str) -> Vec<Chart> {
    let compilation = compile_text(text);
    let sources = compilation.sources.clone();
    let program = crate::support::program(compilation);
    program.entities.ids().map(|id| chart(&program, &sources, id)).collect()
}

fn examples() -> Vec<PathBuf> {
    let mut all = files("examples", "hyped");
    all.extend(files("tests/conformance", "hyped"));
    all
}

/// A bit of everything.
const ALL: &str = "entity All {
    param level = 2
    button jump
    discrete n: int 0..9 = 0
    collider body: rect(0, 0, 16, 16)

    group a {
        mode outer {
            n := min(n + 1, 9) // counted
            when pressed(jump) -> second { n := 0; x := if(x > 1,
                2, 3) }
            when timer >= 1s { n := 1 }
            follow links when n > 0
            initial mode first { when touching(\"a \\u{3c} b\") -> second }
            initial when level >= 2 mode second {
                when x < 1
                    and not held(jump) -> outer // why
            }
        }
        mode last { when n == 9 { destroy self } }
    }
    group b { mode only { when lost(friend) -> only } }
    ref friend: All
}
entity Plain { x' = 3 }
";

fn all() -> Vec<Chart> {
    charts_of(&ALL.replace("\\u{3c}", "<"))
}

#[test]
fn a_chart_holds_what_the_program_says() {
    let charts = all();
    let [chart, plain] = &charts[..] else { panic!("two entities") };
    assert!(plain.regions.is_empty() && plain.modes.is_empty());
    let names: Vec<&str> = chart.modes.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["outer", "first", "second", "last", "only"]);
    assert_eq!(chart.regions.iter().map(|r| r.name.as_deref().unwrap()).collect::<Vec<_>>(), ["a", "b"]);
    assert_eq!(chart.regions[0].modes, [0, 3]);
    let outer = &chart.modes[0];
    assert_eq!((&outer.entry[..], outer.timed), (&["n := min(n + 1, 9)".to_string()][..], true));
    let said: Vec<String> = outer.internal.iter().map(|a| format!("{}/{}", a.guard, a.updates.join(";"))).collect();
    assert_eq!(said, ["timer >= 1s/n := 1", "follow links when n > 0/"]);
    let initial = outer.initial.as_ref().unwrap();
    assert_eq!((&initial.choices[..], initial.mode), (&[("level >= 2".to_string(), 2)][..], 1));
    let edges: Vec<String> = chart
        .edges
        .iter()
        .map(|e| format!("{} {} {}>{} {}", e.order, e.guard, names[e.source], names[e.target], e.updates.join(";")))
        .collect();
    assert_eq!(
        edges,
        [
            "1 pressed(jump) outer>second n := 0;x := if(x > 1, 2, 3)",
            "2 touching(\"a < b\") first>second ",
            "2 x < 1 and not held(jump) second>outer ",
            "1 lost(friend) only>only ",
        ]
    );
}

#[test]
fn pictures_look_like_this() {
    let charts = all();
    insta::assert_snapshot!("dot", dot(&charts));
    insta::assert_snapshot!("mermaid", mermaid(&charts));
    insta::assert_snapshot!("svg", svg(&charts));
}

/// Left, top, right and bottom.
type Rect = [f64; 4];

/// The contents of a picture: every text with its place, and every rectangle.
type Parts = (Vec<(String, Rect)>, Vec<Rect>);

fn parts(picture: &str) -> Vec<Parts> {
    let document = roxmltree::Document::parse(picture).unwrap();
    let charts = document.root_element().children().filter(|node| node.has_tag_name("g"));
    charts
        .map(|group| {
            let (mut texts, mut rects) = (Vec::new(), Vec::new());
            for node in group.children().filter(|node| node.is_element()) {
                let number = |name: &str| node.attribute(name).unwrap().parse::<f64>().unwrap();
                if node.has_tag_name("rect") {
                    let (x, y) = (number("x"), number("y"));
                    rects.push([x, y, x + number("width"), y + number("height")]);
                }
                if node.has_tag_name("text") && node.attribute("class") != Some("number") {
                    let text = node.text().unwrap_or("").to_string();
                    let (x, y, width) = (number("x"), number("y"), 7.23 * text.chars().count() as f64);
                    texts.push((text, [x, y - 10.0, x + width, y + 3.0]));
                }
            }
            (texts, rects)
        })
        .collect()
}

#[test]
fn no_text_of_a_picture_covers_another_or_leaves_its_box() {
    let drawn = |path: &PathBuf| compile(path, &Disk).program.is_some_and(|program| !program.entities.is_empty());
    let mut pictures: Vec<String> =
        examples().iter().filter(|path| drawn(path)).map(|path| svg(&charts(path))).collect();
    pictures.push(svg(&all()));
    assert!(pictures.len() > 20);
    for (texts, rects) in pictures.iter().flat_map(|picture| parts(picture)) {
        for (index, (text, a)) in texts.iter().enumerate() {
            for (other, b) in &texts[..index] {
                let apart = a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1];
                assert!(apart, "`{text}` and `{other}`");
            }
            for rect in &rects {
                let begins_in = rect[0] <= a[0] && a[0] <= rect[2] && rect[1] <= a[1] && a[1] <= rect[3];
                assert!(!begins_in || (a[2] <= rect[2] && a[3] <= rect[3]), "`{text}` leaves {rect:?}");
            }
        }
    }
}

fn hypedc(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hypedc")).args(arguments).output().unwrap()
}

#[test]
fn graph_draws_all_entities_or_one() {
    let drawn = |arguments: &[&str]| {
        let output = hypedc(&[&["graph", "examples/mario.hyped"], arguments].concat());
        assert_eq!(output.status.code(), Some(0));
        String::from_utf8(output.stdout).unwrap()
    };
    assert!(drawn(&[]).starts_with("<svg "));
    let all = drawn(&["--format", "dot"]);
    let one = drawn(&["--format", "dot", "--entity", "Goomba"]);
    assert!(all.contains("Mario") && !one.contains("Mario") && one.contains("Goomba"));
    assert!(drawn(&["--format", "mermaid"]).starts_with("stateDiagram-v2\n"));
    let output = hypedc(&["graph", "examples/mario.hyped", "--entity", "Gomba"]);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0));
    assert!(error.contains("did you mean `Goomba`?"), "{error}");
    assert_eq!(hypedc(&["graph", "tests/ui/step.hyped"]).status.code(), Some(2));
}
