//! `hypedc bounds`: its text for people and its JSON for programs.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::PathBuf;
use std::process::Command;

use serde_json::Value;

fn bounds(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_hypedc")).arg("bounds").args(arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn written(name: &str, text: &str) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, text).unwrap();
    path.to_string_lossy().into_owned()
}

/// The paragraph of a slot.
fn slot<'t>(text: &'t str, head: &str) -> &'t str {
    text.split("\n\n").find(|p| p.starts_with(head)).unwrap_or_else(|| panic!("no `{head}` in\n{text}"))
}

#[test]
fn a_platform_reads_as_what_it_is() {
    let text = bounds(&["examples/paper/test1.hyped"]);
    let brown = slot(&text, "brown: ActivatingPlatform");
    assert!(brown.contains("7 dimensions, of which 3 vary, at most 1 in one combination of modes"), "{brown}");
    assert!(brown.contains("always  x'' = 0, y [px] = 32, y' = 0, y'' = 0"), "{brown}");
    let rows: Vec<Vec<&str>> = brown.lines().skip(3).map(|l| l.split_whitespace().collect()).collect();
    assert_eq!(rows[0], ["mode", "x", "[px]", "x'", "[px/s]"]);
    assert_eq!(rows[1], ["wait", "=", "96", "=", "0"]);
    assert_eq!((rows[2][0], &rows[2][rows[2].len() - 2..]), ("right", &["=", "30"][..]));
    assert_eq!((rows[3][0], &rows[3][rows[3].len() - 2..]), ("left", &["=", "-30"][..]));
    assert!(text.contains("goal arrive: not ruled out"), "{text}");
}

#[test]
fn groups_are_told_apart_and_lines_are_short() {
    for file in ["examples/paper/test2.hyped", "examples/link.hyped", "examples/moldorm.hyped", "examples/homing.hyped"]
    {
        let text = bounds(&[file]);
        for line in text.lines() {
            assert!(line.chars().count() <= 120, "{file}: {line}");
            assert_eq!(line, line.trim_end(), "{file}");
        }
        assert!(text.contains("total: "), "{text}");
    }
    let text = bounds(&["examples/link.hyped"]);
    let link = slot(&text, "hero: Link");
    assert!(link.contains("facing in {up, down, left, right}") && link.contains("keys in [0, 2]"), "{link}");
    let life = link.lines().position(|l| l.starts_with("  life  hearts")).unwrap();
    let dead = link.lines().skip(life).find(|l| l.starts_with("  dead")).unwrap();
    assert_eq!(dead.split_whitespace().collect::<Vec<_>>(), ["dead", "=", "0", "=", "0"]);
    assert!(link.contains("[1, 61] (1.017 s)"), "steps and seconds: {link}");
    assert!(slot(&text, "door: Door").contains("  mode  locked, open"));
}

#[test]
fn what_is_alike_stands_together() {
    let path = written(
        "alike.hyped",
        "entity Walker { collider body: rect(0, 0, 8, 8); mode right { x' = 5 } mode left { x' = -5 } }
         entity Rock { }
         entity Never { }
         world W {
             space main {
                 place a: Rock at (1, 2); place b: Rock at (3, 2); place c: Rock at (3, 2)
                 place d: Rock at (5, 2)
             }
             goal there: a.x > 2
             goal both: a.x < 2 and not (b.x > 2 or c.x > 9)
             goal fine: a.x < 2
         }",
    );
    let text = bounds(&[&path]);
    assert!(text.contains("\na to d, 4 of them: Rock\n"), "{text}");
    assert!(
        text.contains("always  x as placed, x' = 0, x'' = 0, y [px] = 2") || text.contains("y as placed"),
        "{text}"
    );
    assert!(text.contains("goal there: proven unreachable\n  `a.x > 2` never holds: a.x = 1\n"), "{text}");
    assert!(text.contains("goal both: proven unreachable\n  `b.x > 2` always holds: b.x = 3\n"), "{text}");
    assert!(text.contains("goal fine: not ruled out\n"), "{text}");
}

#[test]
fn json_has_every_combination() {
    let json: Value = serde_json::from_str(&bounds(&["examples/paper/test1.hyped", "--format", "json"])).unwrap();
    assert_eq!(json["version"], 1);
    let brown = &json["slots"][1];
    assert_eq!(brown["slot"], "brown");
    assert_eq!(brown["dimensions"], serde_json::json!({ "all": 7, "varying": 3, "in_one_combination": 1 }));
    let combinations = brown["combinations"].as_array().unwrap();
    assert_eq!(combinations.len(), 3);
    assert_eq!(combinations[1]["modes"], serde_json::json!(["right"]));
    assert_eq!(combinations[1]["variables"][0]["velocity"], serde_json::json!([[30.0, 30.0]]));
    assert_eq!(json["goals"][0], serde_json::json!({ "goal": "arrive", "verdict": "not ruled out", "argument": null }));
    let link: Value = serde_json::from_str(&bounds(&["examples/car.hyped", "--format", "json"])).unwrap();
    let y = &link["slots"][0]["combinations"][0]["variables"][1]["value"];
    // An end that is open: the car may leave the map.
    assert!(y[0][1].is_null(), "{y}");
}

#[test]
fn the_tag_of_a_contact_and_is_say_what_is_named() {
    let path = written(
        "named.hyped",
        "entity Berry { discrete worth: int 0..9 = 3; collider food: rect(0, 0, 8, 8); mode there { } }
         entity Melon { discrete worth: int 0..9 = 7; collider food: rect(0, 0, 8, 8); mode there { } }
         entity Rock { discrete worth: int 0..9 = 9; collider stone: rect(0, 0, 8, 8); mode there { } }
         entity Hero {
             param speed = 60
             axis horizontal
             discrete eaten: int 0..9 = 0
             discrete sweet: int 0..9 = 0
             collider body: rect(0, 0, 16, 16)
             always {
                 when touching(food) as b and b is Berry { eaten := b.worth; destroy b }
                 when touching(food) as m and m is Melon and m.worth < 5 { sweet := 1 }
             }
             x' = speed * horizontal
         }
         world W {
             collide body with food: sense
             collide body with stone: block
             space main {
                 place hero: Hero at (0, 0)
                 place berry: Berry at (40, 0); place melon: Melon at (80, 0); place rock: Rock at (160, 0)
             }
             player 1: hero
             goal much: hero.eaten > 3
             goal light: hero.sweet == 1
             goal sated: hero.eaten == 3
         }",
    );
    let text = bounds(&[&path]);
    for (slot, can_be_absent) in [("berry", true), ("melon", false), ("rock", false), ("hero", false)] {
        let line = text.lines().find(|line| line.starts_with(&format!("{slot}: "))).unwrap();
        assert_eq!(line.contains("can be absent"), can_be_absent, "{text}");
    }
    for (goal, is_ruled_out) in [("much", true), ("light", true), ("sated", false)] {
        let line = text.lines().find(|line| line.contains(&format!("goal {goal}: "))).unwrap();
        assert_eq!(!line.contains("not ruled out"), is_ruled_out, "{text}");
    }
}

#[test]
fn what_is_sent_bounds_what_is_received() {
    let path = written(
        "sent.hyped",
        "entity Gun {
             ref target: Target
             discrete power: int 1..3 = 1
             button fire
             mode only {
                 when pressed(fire) { send target.hit(power); send target.push(-0.5) }
                 when timer > 1s { power += 1 }
                 when timer > 9s and false { send target.never }
             }
         }
         entity Target {
             signal hit(points)
             signal push(way: px)
             signal never
             signal nobody
             discrete last: int 0..99 = 0
             mode whole {
                 when received(hit) { last := hit.points; x := x + push.way }
                 when received(nobody) -> gone
             }
             mode gone { }
         }
         world W {
             space main {
                 place target: Target at (0, 0)
                 place one: Gun at (0, 0) { target = target }
                 place two: Gun at (0, 0) { target = target }
             }
             player 1: one
             player 2: two
             goal most: target.last == 6
             goal more: target.last > 6
             goal right: target.x > 0
             goal left: target.x < 0
             goal gone: target in gone
         }",
    );
    let text = bounds(&[&path]);
    let expected = [("most", false), ("more", true), ("right", true), ("left", false), ("gone", true)];
    for (goal, is_ruled_out) in expected {
        let line = text.lines().find(|line| line.contains(&format!("goal {goal}: "))).unwrap();
        assert_eq!(!line.contains("not ruled out"), is_ruled_out, "{text}");
    }
}
