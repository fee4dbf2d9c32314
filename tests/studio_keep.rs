//! A play session in which the state goes on after a change: by names, and what no longer exists is said.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::PathBuf;

use hypedc::compile::compile;
use hypedc::studio::{Answer, Held, Inspected, Level, Opened, PlayerInfo, Request, Session, Shown, Target};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::studio::{inspected, opened, session_of, shown};
use crate::support::{Disk, Text, files};

const GAME: &str = "entity Hero {
    param speed: px/s = 60
    param high: px/s = 120
    continuous fuel: px = 5
    discrete lives: int 0..9 = 3
    discrete mood: {calm, angry} = angry
    axis horizontal
    button jump
    collider body: rect(0, 0, 8, 8)
    x' = speed * horizontal
    initial mode ground {
        y' = 0
        when pressed(jump) -> air { y' := high; lives := lives - 1 }
    }
    mode air {
        y'' = -200
        when timer > 2 -> ground
    }
}
entity Bat {
    collider enemy: circle(0, 0, 4)
    x' = 10
}
world Sky {
    space main {
        place hero: Hero at (20, 20)
        place bat: Bat at (50, 50)
    }
    player 1: hero
    goal far: hero.x > 1000
}
";

fn edit(session: &mut Session, text: &str) -> Opened {
    opened(session.answer(Request::Edit { path: None, text: Some(text.to_string()) }))
}

/// A session of the game in which the hero is in the air, and which keeps the state.
fn in_the_air() -> (Session, Shown) {
    let path = PathBuf::from("test.hyped");
    let mut session = Session::new(Box::new(Text(GAME)), path, Level::default(), Box::new(|task| task()));
    let start = opened(session.answer(Request::Open { world: None }));
    assert!(start.is_current, "{:?}", start.findings);
    assert_eq!(session.answer(Request::Keep { state: true }), Answer::Done);
    let held = vec![Held { buttons: vec![0], axes: vec![1.0] }];
    let before = shown(session.answer(Request::Play { inputs: vec![held; 20] }));
    (session, before)
}

fn value(of: &Inspected, name: &str) -> String {
    of.values.iter().find(|value| value.name == name).unwrap_or_else(|| panic!("{name}")).value.clone()
}

#[test]
fn what_has_a_name_goes_on() {
    let (mut session, before) = in_the_air();
    let changed = edit(
        &mut session,
        &GAME.replace("speed: px/s = 60", "speed: px/s = 90").replace("calm, angry", "dizzy, calm, angry"),
    );
    assert!(changed.is_current && changed.lost.is_none(), "{:?}", changed.lost);
    let after = changed.shown.unwrap();
    assert!(after.is_carried && (after.frame.at, after.length) == (0, 0));
    assert_eq!(after.frame.bodies, before.frame.bodies);
    let hero = inspected(session.answer(Request::Inspect { slot: 0 }));
    assert_eq!(
        (value(&hero, "mood"), value(&hero, "lives"), value(&hero, "fuel")),
        ("angry".into(), "2".into(), "5".into())
    );
    assert_eq!(hero.modes, [1]);
    // The button that is still held is no new press, and the new number counts.
    let x = after.frame.bodies[2];
    let held = vec![Held { buttons: vec![0], axes: vec![1.0] }];
    let next = shown(session.answer(Request::Play { inputs: vec![held; 10] }));
    assert!((next.frame.bodies[2] - x - 15.0).abs() < 1e-9, "{}", next.frame.bodies[2]);
    // One goes back to the state that was carried over.
    assert_eq!(shown(session.answer(Request::Seek { frame: 0 })).frame.bodies, before.frame.bodies);
}

#[test]
fn what_is_gone_is_said() {
    let (mut session, before) = in_the_air();
    let text = GAME
        .replace("    continuous fuel: px = 5\n", "")
        .replace("mode air", "mode flight")
        .replace("-> air", "-> flight");
    let changed = edit(&mut session, &text.replace("place bat: Bat at (50, 50)", "place owl: Bat at (60, 50)"));
    let lost = changed.lost.unwrap();
    for name in ["bat", "hero.fuel", "hero in air"] {
        assert!(lost.contains(name), "{name}: {lost}");
    }
    let after = changed.shown.unwrap();
    assert_eq!(after.frame.bodies[..4], before.frame.bodies[..4]);
    // The new instance is where the text says.
    let scene = changed.scene.unwrap();
    assert_eq!(scene.slots[1].name, "owl");
    assert!(after.frame.bodies.windows(4).any(|of| of == [1.0, 0.0, 60.0, 50.0]), "{:?}", after.frame.bodies);
}

#[test]
fn inputs_that_lead_nowhere_are_not_told() {
    let (mut session, _) = in_the_air();
    edit(&mut session, &GAME.replace("= 60", "= 90"));
    let search = Request::Search { target: Target::Goal("far".into()), nodes: 10, seed: 1 };
    for request in [Request::Script, search] {
        let Answer::Refused { message } = session.answer(request) else { panic!() };
        assert!(message.contains("start again"), "{message}");
    }
    // A script begins at the start of the world.
    let start = shown(session.answer(Request::Load { script: "-*3".into() }));
    assert!(!start.is_carried && start.length == 3 && start.frame.bodies[2] == 20.0, "{start:?}");
    assert!(matches!(session.answer(Request::Script), Answer::Text { .. }));
}

/// Random inputs that are held for some steps.
fn stirred(rng: &mut Pcg64, players: &[PlayerInfo]) -> Vec<Held> {
    let of = |player: &PlayerInfo| {
        let buttons = (0..player.buttons.len()).filter(|_| rng.random_bool(0.3)).collect();
        Held { buttons, axes: player.axes.iter().map(|_| f64::from(rng.random_range(-1..=1))).collect() }
    };
    players.iter().map(of).collect()
}

/// The same program again: nothing is lost, and the run goes on as if nothing had happened.
#[test]
fn a_change_that_says_nothing_changes_nothing() {
    let mut compared = 0;
    for path in files("examples", "hyped") {
        let program = compile(&path, &Disk).program;
        // What nature draws depends on the number of steps.
        let is_playable = program.is_some_and(|program| {
            program.worlds.iter().next().is_some_and(|w| w.open.is_none())
                && program.entities.iter().all(|entity| entity.chances.is_empty())
        });
        if !is_playable {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let (mut plain, mut kept) = (session_of(&path), session_of(&path));
        let scene = opened(plain.answer(Request::Open { world: None })).scene.unwrap();
        kept.answer(Request::Open { world: None });
        kept.answer(Request::Keep { state: true });
        let mut rng = Pcg64::seed_from_u64(9);
        for round in 0..12 {
            let inputs = vec![stirred(&mut rng, &scene.players); rng.random_range(1..30)];
            let expected = shown(plain.answer(Request::Play { inputs: inputs.clone() }));
            let found = shown(kept.answer(Request::Play { inputs }));
            assert_eq!(found.frame.bodies, expected.frame.bodies, "{}, round {round}", path.display());
            assert_eq!(found.frame.broken, expected.frame.broken, "{}, round {round}", path.display());
            if expected.ended.is_some() {
                break;
            }
            let changed = edit(&mut kept, &format!("{text}\n// {round}\n"));
            assert_eq!(changed.lost, None, "{}", path.display());
            assert_eq!(changed.shown.unwrap().frame.bodies, expected.frame.bodies, "{}", path.display());
            compared += 1;
        }
    }
    assert!(compared > 100, "{compared}");
}
