//! Statecharts: what is drawn of a program, and that the pictures can be read.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod support;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use hypedc::compile::compile;
use hypedc::graph::{Chart, chart, dot, mermaid, svg};
use support::{Disk, compile_text, files};

fn charts(path: &Path) -> Vec<Chart> {
    let compilation = compile(path, &Disk);
    let sources = compilation.sources.clone();
    let program = support::program(compilation);
    program.entities.ids().map(|id| chart(&program, &sources, id)).collect()
}

fn charts_of(text: &str) -> Vec<Chart> {
    let compilation = compile_text(text);
    let sources = compilation.sources.clone();
    let program = support::program(compilation);
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

/// Every text of a picture with its box, in the coordinates of the whole.
fn texts(picture: &str) -> Vec<(String, [f64; 4])> {
    let document = roxmltree::Document::parse(picture).unwrap();
    let number = |node: &roxmltree::Node<'_, '_>, name: &str| node.attribute(name).unwrap().parse::<f64>().unwrap();
    let moved = |node: &roxmltree::Node<'_, '_>| -> f64 {
        let group = node.parent().unwrap().attribute("transform").unwrap();
        group.trim_end_matches(')').rsplit(' ').next().unwrap().parse().unwrap()
    };
    let drawn =
        document.descendants().filter(|node| node.has_tag_name("text") && node.attribute("class") != Some("number"));
    drawn
        .map(|node| {
            let text = node.text().unwrap_or("").to_string();
            let (x, y) = (number(&node, "x"), number(&node, "y") + moved(&node));
            let width = 7.23 * text.chars().count() as f64;
            (text, [x, y - 10.0, x + width, y + 4.0])
        })
        .collect()
}

#[test]
fn no_text_of_a_picture_covers_another() {
    for path in examples().iter().filter(|path| compile(path, &Disk).program.is_some_and(|p| !p.entities.is_empty())) {
        let picture = svg(&charts(path));
        let texts = texts(&picture);
        let width: f64 =
            roxmltree::Document::parse(&picture).unwrap().root_element().attribute("width").unwrap().parse().unwrap();
        for (index, (text, a)) in texts.iter().enumerate() {
            assert!(a[0] >= 0.0 && a[2] <= width, "{}: `{text}` leaves the picture", path.display());
            for (other, b) in &texts[..index] {
                let apart = a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1];
                assert!(apart, "{}: `{text}` and `{other}`", path.display());
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
