//! Bounded supplies: items that can be picked up only once bound a counter: small worlds in which they do and in which
//! they do not, each checked against random runs.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::Path;
use std::sync::Arc;

use crate::support::{Disk, Text, compile_text, program};
use hypedc::analysis::{ConfigurationSpace, configuration_space};
use hypedc::compile::{LevelFile, check_with, compile};
use hypedc::ir::{GoalId, Id, Program, WorldId};
use hypedc::sim::{Input, PlayerInput, Simulator};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const WORLD: WorldId = WorldId(0);

/// A coin that is used up in the usual way.
const COIN: &str = "mode there { when touching(coin, body) -> gone } mode gone { }";
/// Three of them, one where the hero begins.
const THREE: &str = "place a: Coin at (50, 50); place b: Coin at (90, 10); place c: Coin at (10, 80)";
const TAKES: &str = "when touching(body, coin) { coins := min(coins + 1, 9) }";

/// A world with a hero that can go anywhere in a square.
fn world(coin: &str, others: &str, hero: &str, placed: &str) -> String {
    let on = if coin.contains("mode there") { "when in there" } else { "" };
    let coin = format!("entity Coin {{ collider coin: rect(0, 0, 8, 8) {on}\n{coin} }}");
    whole(&format!("{coin} {others}"), hero, placed)
}

fn whole(entities: &str, hero: &str, placed: &str) -> String {
    let hero = if hero.contains("mode ") { hero.to_string() } else { format!("mode only {{\n{hero}\n}}") };
    let limit = if entities.contains("spawn Coin") { "limit Coin 6" } else { "" };
    format!(
        "{entities}
        entity Hero {{
            param speed = 150
            discrete coins: int 0..9 = 0
            axis horizontal, vertical
            button lucky
            collider body: rect(0, 0, 8, 8)
            collider shield: rect(-4, -4, 16, 16)
            clamp x in 0..100
            clamp y in 0..100
            x' = speed * horizontal
            y' = speed * vertical
            {hero}
        }}
        world W {{
            step 1/20
            collide body, shield with coin, chest: sense
            tiles room 16 x 16 {{ '.': empty; 'o': coin }}
            space main {{ place hero: Hero at (50, 50); {placed} }}
            {limit}
            player 1: hero
            goal four: hero.coins >= 4
        }}"
    )
}

/// The upper bound of the hero's first variable, in any mode.
fn bound(program: &Program, space: &ConfigurationSpace) -> f64 {
    let hero = program.worlds[WORLD].slots.find(|s| s.name == "hero").unwrap();
    let ends = space.slots[hero].configurations.iter().map(|c| c.discretes.iter().next().unwrap().hull().unwrap().high);
    ends.fold(f64::NEG_INFINITY, f64::max)
}

/// The greatest value that random runs show.
fn seen(program: &Arc<Program>) -> f64 {
    let sim = Simulator::new(program, WORLD);
    let hero = sim.world().slots.find(|s| s.name == "hero").unwrap();
    let mut scratch = sim.scratch();
    let start = sim.initial(&mut scratch).unwrap();
    let counter = program.entities[sim.world().slots[hero].entity].discretes.ids().next().unwrap();
    let mut rng = Pcg64::seed_from_u64(1);
    let mut most = 0;
    for _ in 0..30 {
        let mut state = start.clone();
        for _ in 0..60 {
            let mut axis = || f64::from(rng.random_range(-1..=1));
            let axes = [axis(), axis(), 0.0, 0.0];
            let input = Input::of_players(vec![PlayerInput { buttons: rng.random(), axes }]);
            for _ in 0..rng.random_range(1..8) {
                if sim.step(&mut state, &input, &mut scratch).is_err() {
                    break;
                }
                most = most.max(sim.world().layout.slots[hero].discrete(&state, counter));
            }
        }
    }
    f64::from(most)
}

/// The bound of a text and what runs show, which is within.
fn both(name: &str, text: &str) -> (f64, f64) {
    let program = program(compile_text(text));
    let space = configuration_space(&program, WORLD);
    let (bound, seen) = (bound(&program, &space), seen(&program));
    assert!(seen <= bound, "{name}: {seen} was seen, {bound} is the bound");
    let four = space.can_hold(&program, WORLD, GoalId::from_index(0));
    assert_eq!(four, bound >= 4.0, "{name}: the goal");
    (bound, seen)
}

#[test]
fn as_many_as_there_are() {
    let chest = |edge: &str| format!("entity Chest {{ collider chest: rect(0, 0, 8, 8); mode shut {{ {edge} }} }}");
    let opened = "entity Chest { collider chest: rect(0, 0, 8, 8)
        mode shut { when touching(chest, body) -> open { spawn Coin } } mode open { } }";
    let written = "entity Chest { discrete full: bool = false; collider chest: rect(0, 0, 8, 8)
        mode shut { when touching(chest, body) and full { spawn Coin; destroy self } } }";
    let chests = "place a: Coin at (50, 50); place b: Chest at (90, 10); place c: Chest at (10, 80)";
    let cases = [
        ("goes for good", world(COIN, "", TAKES, THREE), 3.0),
        ("is destroyed", world("mode lies { when touching(coin, body) { destroy self } }", "", TAKES, THREE), 3.0),
        (
            "is destroyed by an edge",
            world("mode lies { when touching(coin, body) -> lies { destroy self } }", "", TAKES, THREE),
            3.0,
        ),
        (
            "is destroyed by an entry",
            world(
                "mode there { when touching(coin, body) -> gone }
                 mode gone { destroy self; when timer >= 0s -> there }",
                "",
                TAKES,
                THREE,
            ),
            3.0,
        ),
        (
            "names what touches it",
            world("mode lies { when touching(coin, body) as who { destroy self } }", "", TAKES, THREE),
            3.0,
        ),
        (
            "one of two",
            world("mode lies { when touching(coin, body) or timer > 9s { destroy self } }", "", TAKES, THREE),
            3.0,
        ),
        (
            "the hero destroys it",
            world(
                "mode lies { }",
                "",
                "when touching(body, coin) as c { coins := min(coins + 1, 9); destroy c }",
                THREE,
            ),
            3.0,
        ),
        (
            "is hidden at first",
            world(
                "mode hidden { when timer >= 0.5s -> there } mode there { when touching(coin, body) -> gone } mode gone { }",
                "",
                TAKES,
                THREE,
            ),
            3.0,
        ),
        (
            "all ways lead away",
            world(
                "mode there { when timer > 90s -> gone; when touching(coin, body) -> gone } mode gone { mode a { when timer > 1s -> b } mode b { } }",
                "",
                TAKES,
                THREE,
            ),
            3.0,
        ),
        ("counts by two", world(COIN, "", "when touching(body, coin) { coins := min(coins + 2, 9) }", THREE), 6.0),
        (
            "is counted on entry",
            world(
                COIN,
                "",
                "mode free { when touching(body, coin) -> happy } mode happy { coins := min(coins + 1, 9); when timer > 0s -> free }",
                THREE,
            ),
            3.0,
        ),
        (
            "is lost now and then",
            world(COIN, "", &format!("{TAKES} when x > 95 and y > 95 {{ coins := max(coins - 1, 0) }}"), THREE),
            3.0,
        ),
        ("is clamped", world(COIN, "", "when touching(body, coin) { coins := clamp(coins + 1, 0, 9) }", THREE), 3.0),
        (
            "from chests that are gone",
            world(COIN, &chest("when touching(chest, body) { spawn Coin; destroy self }"), TAKES, chests),
            3.0,
        ),
        ("from chests that stay open", world(COIN, opened, TAKES, chests), 3.0),
        (
            "from chests of which one is full",
            world(COIN, written, TAKES, &chests.replace("(90, 10)", "(90, 10) { full = true }")),
            2.0,
        ),
    ];
    for (name, text, expected) in cases {
        assert_eq!(both(name, &text), (expected, expected), "{name}: the bound, and what runs reach");
    }
}

#[test]
fn a_sum_is_enough() {
    let cases = [
        (
            "two edges",
            world(
                COIN,
                "",
                "mode only { when touching(body, coin) and x > 50 -> only { coins := min(coins + 1, 9) }
                 when touching(body, coin) -> only { coins := min(coins + 1, 9) } }",
                THREE,
            ),
            6.0,
        ),
        (
            "two groups",
            world(
                COIN,
                "",
                &format!("group a {{ mode one {{ {TAKES} }} }} group b {{ mode two {{ {TAKES} }} }}"),
                THREE,
            ),
            6.0,
        ),
        ("set to a number", world(COIN, "", &format!("{TAKES} when pressed(lucky) {{ coins := 2 }}"), THREE), 5.0),
        (
            "raised once by itself",
            world(
                COIN,
                "",
                &format!(
                    "mode poor {{ {TAKES} when pressed(lucky) -> rich {{ coins := min(coins + 1, 9) }} }} mode rich {{ {TAKES} }}"
                ),
                THREE,
            ),
            7.0,
        ),
    ];
    for (name, text, expected) in cases {
        let (bound, seen) = both(name, &text);
        assert_eq!(bound, expected, "{name}");
        assert!(seen >= 3.0, "{name}: {seen}");
    }
}

#[test]
fn no_bound_where_it_would_be_wrong() {
    let fountain = "entity Fountain { mode on { when timer >= 0.2s -> on { spawn Coin } } }";
    let splits = "mode there { when touching(coin, body) { spawn Coin(x = 120 - x, y = 120 - y); destroy self } }";
    let torch = "entity Torch { collider coin: rect(0, 0, 8, 8) }";
    let two = "entity Coin { collider coin: rect(0, 0, 8, 8) when in there or in lit
        group a { mode there { when touching(coin, body) -> gone } mode gone { } }
        group b { mode dark { when timer > 0.3s -> lit } mode lit { when timer > 0.3s -> dark } } }";
    let map = "map room \"
        .......
        .....o.
        .......
        .......
        .......
        .......
        .......
    \";";
    let cases = [
        (
            "comes back",
            world(
                "mode there { when touching(coin, body) -> gone } mode gone { when timer >= 0.5s -> there }",
                "",
                TAKES,
                THREE,
            ),
        ),
        ("a tile is one", world(COIN, "", TAKES, &format!("{map} {THREE}"))),
        ("a rectangle is one", world(COIN, "", TAKES, &format!("rect coin (70, 70, 8, 8); {THREE}"))),
        (
            "asks for a side",
            world("mode there { when touching(coin, body, left) -> gone } mode gone { }", "", TAKES, THREE),
        ),
        (
            "another edge comes first",
            world(
                "mode there { when timer >= 0.1s -> there; when touching(coin, body) -> gone } mode gone { }",
                "",
                TAKES,
                THREE,
            ),
        ),
        (
            "an edge around comes first",
            whole(
                "entity Coin { collider coin: rect(0, 0, 8, 8) when in around
                    mode around { when timer >= 0.1s -> around; mode there { when touching(coin, body) -> gone } }
                    mode gone { } }",
                TAKES,
                THREE,
            ),
        ),
        (
            "not at every touch",
            world("mode there { when touching(coin, body) and timer > 2s -> gone } mode gone { }", "", TAKES, THREE),
        ),
        (
            "is on for ever",
            whole(
                "entity Coin { collider coin: rect(0, 0, 8, 8); mode there { when touching(coin, body) -> gone } mode gone { } }",
                TAKES,
                THREE,
            ),
        ),
        ("another group turns it on", whole(two, TAKES, THREE)),
        ("something else is one, too", world(COIN, torch, TAKES, &format!("{THREE}; place torch: Torch at (70, 70)"))),
        ("the shield does not use it up", world(COIN, "", "when touching(coin) { coins := min(coins + 1, 9) }", THREE)),
        (
            "also without",
            world(COIN, "", &format!("{TAKES} when pressed(lucky) {{ coins := min(coins + 1, 9) }}"), THREE),
        ),
        (
            "either of two",
            world(COIN, "", "when touching(body, coin) or pressed(lucky) { coins := min(coins + 1, 9) }", THREE),
        ),
        (
            "while it does not touch",
            world(COIN, "", "when not touching(body, coin) { coins := min(coins + 1, 9) }", THREE),
        ),
        (
            "spawned without end",
            world(
                "mode lies { when touching(coin, body) { destroy self } }",
                fountain,
                TAKES,
                &format!("{THREE}; place f: Fountain at (70, 70)"),
            ),
        ),
        ("spawns itself", world(splits, "", TAKES, THREE)),
    ];
    let mut wrong = Vec::new();
    for (name, text) in cases {
        let (bound, seen) = both(name, &text);
        if (bound, seen > 3.0) != (9.0, true) {
            wrong.push(format!("{name}: the bound is {bound}, {seen} was seen"));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn examples_are_bounded() {
    for (file, expected) in [("tests/conformance/link_zelda4rooms.hyped", 1.0), ("examples/link.hyped", 2.0)] {
        let program = compile(Path::new(file), &Disk).program.unwrap();
        let space = configuration_space(&program, WORLD);
        let hero = program.worlds[WORLD].slots.find(|s| s.name == "hero").unwrap();
        let entity = &program.entities[program.worlds[WORLD].slots[hero].entity];
        let keys = entity.discretes.find(|d| d.name == "keys").unwrap();
        let ends = space.slots[hero].configurations.iter().map(|c| c.discretes[keys].hull().unwrap().high);
        assert_eq!(ends.fold(0.0, f64::max), expected, "{file}");
    }
}

#[test]
fn check_leaves_the_number_of_things_to_the_level() {
    let told = |most: u8| {
        let hero = format!(
            "discrete gems: int 0..99 = 0
             mode poor {{ {TAKES}
                when pressed(lucky) {{ gems := if(coins >= 4, 20, 0) }}
                when gems >= {most} -> rich }}
             mode rich {{ when timer > 1s -> poor }}"
        );
        let text = world(COIN, "", &hero, THREE);
        let found = check_with(Path::new("test.hyped"), LevelFile::default(), &Text(&text)).diagnostics;
        found.iter().map(|d| d.code.text()).filter(|code| code.starts_with("W07")).collect::<Vec<_>>()
    };
    assert_eq!(told(10), [""; 0]);
    assert_eq!(told(21), ["W0702"], "no number of coins is enough");
}
