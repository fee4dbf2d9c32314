//! A play session: what it shows is what the simulator computes, however one moves in time; a change of the text goes on
//! with the inputs so far; what it says of edges is what happens.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use hypedc::compile::compile;
use hypedc::ir::{GoalId, WorldId};
use hypedc::sim::{Event, Run, Simulator, TraceFormat, TraceLines};
use hypedc::studio::{Answer, Frame, Held, Inspected, Level, Opened, Request, Role, Searching, Session, Shown, Target};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::support::{Disk, Text, files, program, script_of};

pub fn session_of(path: &Path) -> Session {
    Session::new(Box::new(Disk), path.to_path_buf(), Level::default(), Box::new(|task| task()))
}

fn session_with(text: &'static str) -> Session {
    let path = PathBuf::from("test.hyped");
    Session::new(Box::new(Text(text)), path, Level::default(), Box::new(|task| task()))
}

pub fn opened(answer: Answer) -> Opened {
    let Answer::Opened(opened) = answer else { panic!("{answer:?}") };
    *opened
}

pub fn shown(answer: Answer) -> Shown {
    let Answer::Shown(shown) = answer else { panic!("{answer:?}") };
    shown
}

pub fn inspected(answer: Answer) -> Inspected {
    let Answer::Inspected(inspected) = answer else { panic!("{answer:?}") };
    *inspected
}

fn text(answer: Answer) -> String {
    let Answer::Text { text } = answer else { panic!("{answer:?}") };
    text
}

fn searched(answer: Answer) -> Searching {
    let Answer::Searching(searching) = answer else { panic!("{answer:?}") };
    searching
}

/// Random inputs that are held for some steps.
fn stirred(rng: &mut Pcg64, players: &[hypedc::studio::PlayerInfo]) -> Vec<Held> {
    let of = |player: &hypedc::studio::PlayerInfo| {
        let buttons = (0..player.buttons.len()).filter(|_| rng.random_bool(0.3)).collect();
        Held { buttons, axes: player.axes.iter().map(|_| f64::from(rng.random_range(-1..=1))).collect() }
    };
    players.iter().map(of).collect()
}

/// Examples with worlds that can be played as they are.
fn playable() -> impl Iterator<Item = PathBuf> {
    files("examples", "hyped").into_iter().filter(|path| {
        compile(path, &Disk)
            .program
            .is_some_and(|program| program.worlds.iter().next().is_some_and(|w| w.open.is_none()))
    })
}

#[test]
fn every_frame_is_the_simulators_however_one_gets_there() {
    let mut played = 0;
    for path in playable() {
        let mut session = session_of(&path);
        let first = opened(session.answer(Request::Open { world: None }));
        let (scene, start) = (first.scene.unwrap(), first.shown.unwrap());
        let mut rng = Pcg64::seed_from_u64(3);
        let mut frames: Vec<Frame> = vec![start.frame];
        while frames.len() < 400 {
            let held = stirred(&mut rng, &scene.players);
            let inputs = vec![held; rng.random_range(1..20)];
            for input in inputs {
                let shown = shown(session.answer(Request::Play { inputs: vec![input] }));
                if shown.ended.is_none() {
                    assert_eq!(shown.before.as_ref(), frames.last(), "{}", path.display());
                    frames.push(shown.frame);
                }
            }
            if frames.len() < 20 {
                break;
            }
        }
        // The same inputs in the simulator.
        let program = program(compile(&path, &Disk));
        let script = script_of(&program, WorldId(0), &text(session.answer(Request::Script)));
        let mut run = Run::new(&program, WorldId(0)).unwrap();
        for (frame, input) in (1..).zip(script.inputs()) {
            run.step(input).unwrap();
            let Some(shown) = frames.get(frame) else { break };
            let mut bodies = shown.bodies.as_slice();
            while let [slot, _, x, y, count, rest @ ..] = bodies {
                let instance = run.instance(hypedc::ir::SlotId(*slot as u32));
                assert_eq!(instance.position(), (*x, *y), "{} {frame}", path.display());
                bodies = &rest[5 * *count as usize..];
            }
        }
        // All that a state is made of, as in a trace.
        let sim = Simulator::new(&program, WorldId(0));
        let (mut run, lines) = (Run::new(&program, WorldId(0)).unwrap(), TraceLines::new(&sim, TraceFormat::Jsonl));
        let mut expected = lines.state(0, &run.nothing(), run.state()).unwrap();
        for (step, input) in (1..).zip(script.inputs()) {
            run.step(input).unwrap();
            expected.push_str(&lines.state(step, &run.drawn(input), run.state()).unwrap());
        }
        let traced = text(session.answer(Request::Trace { from: 0, count: 3_600 }));
        assert_eq!(traced.lines().count() as u64, script.len() + 1, "{}", path.display());
        assert!(traced == expected, "{}", path.display());
        for _ in 0..30 {
            let at = rng.random_range(0..frames.len());
            let shown = shown(session.answer(Request::Seek { frame: at as u64 }));
            assert_eq!(shown.frame, frames[at], "{}", path.display());
            assert_eq!(shown.before.as_ref(), at.checked_sub(1).map(|at| &frames[at]), "{}", path.display());
            played += 1;
        }
        // Taking over drops what comes after.
        let at = frames.len() / 2;
        session.answer(Request::Seek { frame: at as u64 });
        let over = shown(session.answer(Request::Play { inputs: vec![Vec::new()] }));
        assert_eq!((over.frame.at, over.length), (at as u64 + 1, at as u64 + 1), "{}", path.display());
    }
    assert!(played > 400, "{played}");
}

#[test]
fn what_is_said_of_edges_is_what_happens() {
    let mut taken = 0;
    for path in playable() {
        // Groups that read each other's transitions are decided together; here each is looked at alone.
        if std::fs::read_to_string(&path).unwrap().contains("entering(") {
            continue;
        }
        let mut session = session_of(&path);
        let scene = opened(session.answer(Request::Open { world: None })).scene.unwrap();
        let program = program(compile(&path, &Disk));
        let mut run = Run::new(&program, WorldId(0)).unwrap();
        let mut rng = Pcg64::seed_from_u64(5);
        let slots: Vec<u32> = scene.players.iter().map(|player| player.slot).collect();
        let mut held = Vec::new();
        for step in 0..300 {
            if step % 7 == 0 {
                held = stirred(&mut rng, &scene.players);
            }
            let after = shown(session.answer(Request::Play { inputs: vec![held.clone()] }));
            if after.ended.is_some() {
                break;
            }
            let script = script_of(&program, WorldId(0), &text(session.answer(Request::Script)));
            let mut happened = BTreeSet::new();
            let input = script.inputs().last().unwrap();
            run.step_with_events(input, &mut |event| {
                if let Event::Edge(slot, edge) = event {
                    happened.insert((slot.0, edge.0 as usize));
                }
            })
            .unwrap();
            for &slot in &slots {
                let of = inspected(session.answer(Request::Inspect { slot }));
                let said: BTreeSet<_> =
                    of.edges.iter().filter(|edge| edge.taken).map(|edge| (slot, edge.edge)).collect();
                let mine: BTreeSet<_> = happened.iter().filter(|(of, _)| *of == slot).copied().collect();
                assert_eq!(said, mine, "{} step {step}", path.display());
                taken += said.len();
                // A guard of one part holds if its part does.
                for edge in of.edges.iter().filter(|edge| edge.atoms.len() == 1) {
                    let text = &edge.atoms[0].text;
                    assert!(edge.atoms[0].held == Some(edge.held) || text.starts_with("not "), "{text}");
                }
            }
        }
    }
    assert!(taken > 500, "{taken}");
}

const JUMPER: &str = "\
const high: px/s = 120  // how high
entity Jumper {
    param fall: px/s^2 = 400
    param speed: px/s = 60
    param rest = 50ms
    button jump
    axis horizontal
    collider body: rect(0, 0, 8, 8)
    mode stand { y' = 0; x' = speed * horizontal; when held(jump) and timer >= rest -> air { y' := high } }
    mode air { y'' = -fall; x' = speed * horizontal; when y < 0 -> stand { y := 0 } }
}
world Field {
    space main { place hero: Jumper at (0, 0) }
    player 1: hero
    goal up: hero.y > 16
    goal far: hero.x > 100
}
";

fn jump() -> Vec<Vec<Held>> {
    vec![vec![Held { buttons: vec![0], axes: vec![1.0] }]; 20]
}

#[test]
fn a_changed_program_goes_on_with_the_same_inputs() {
    let mut session = session_with(JUMPER);
    let start = opened(session.answer(Request::Open { world: None }));
    assert_eq!((start.findings.len(), start.is_current), (0, true));
    let before = shown(session.answer(Request::Play { inputs: jump() }));
    assert_eq!((before.frame.at, before.ended), (20, None));
    // An error: the last good program stays as it is.
    let broken = JUMPER.replace("y' := high", "y' := hihg");
    let wrong = opened(session.answer(Request::Edit { path: None, text: Some(broken) }));
    assert!(!wrong.is_current && wrong.findings.iter().any(|found| found.message.contains("hihg")));
    let place = wrong.findings[0].place.clone().unwrap();
    assert_eq!((place.line, place.path.as_str()), (9, "test.hyped"));
    assert_eq!(wrong.shown.unwrap().frame, before.frame);
    // A change: the inputs are played again, the run before is a ghost.
    let higher = JUMPER.replace("= 120", "= 240");
    let changed = opened(session.answer(Request::Edit { path: None, text: Some(higher) }));
    assert!(changed.is_current && changed.lost.is_none() && changed.ghost[0].len() == 21);
    let after = changed.shown.unwrap();
    assert_eq!((after.frame.at, after.length), (20, 20));
    assert!(after.frame.bodies[3] > before.frame.bodies[3] + 20.0, "{:?}", after.frame.bodies);
    assert_eq!(changed.ghost[0][20][1..], before.frame.bodies[2..4]);
    // Without the button, the inputs no longer fit.
    let renamed = JUMPER.replace("jump", "hop");
    let lost = opened(session.answer(Request::Edit { path: None, text: Some(renamed) }));
    assert!(lost.lost.unwrap().contains("jump") && lost.shown.unwrap().frame.at == 0);
}

#[test]
fn a_number_is_set_in_its_literal_alone() {
    let mut session = session_with(JUMPER);
    session.answer(Request::Open { world: None });
    session.answer(Request::Play { inputs: jump() });
    let Answer::Sliders { sliders } = session.answer(Request::Sliders) else { panic!() };
    let names: Vec<_> =
        sliders.iter().map(|s| (s.entity.as_deref(), s.name.as_str(), s.value, s.unit.as_str())).collect();
    let of = |name, value, unit| (Some("Jumper"), name, value, unit);
    let expected = [(None, "high", 120.0, ""), of("fall", 400.0, ""), of("speed", 60.0, ""), of("rest", 50.0, "ms")];
    assert_eq!(names, expected);
    let set = opened(session.answer(Request::Set { slider: 0, value: 150.5 }));
    assert!(set.is_current && set.shown.unwrap().length == 20);
    assert_eq!(text(session.answer(Request::Text { path: None, written: false })), JUMPER.replace("= 120", "= 150.5"));
    let Answer::Sliders { sliders } = session.answer(Request::Sliders) else { panic!() };
    assert_eq!((sliders[0].value, sliders[0].written), (150.5, 120.0));
    session.answer(Request::Set { slider: 3, value: 75.0 });
    let both = JUMPER.replace("= 120", "= 150.5").replace("50ms", "75ms");
    assert_eq!(text(session.answer(Request::Text { path: None, written: false })), both);
    // Reading the file again forgets it.
    session.answer(Request::Reload);
    assert_eq!(text(session.answer(Request::Text { path: None, written: false })), JUMPER);
    assert!(matches!(session.answer(Request::Set { slider: 9, value: 1.0 }), Answer::Refused { .. }));
    assert!(matches!(session.answer(Request::Set { slider: 0, value: f64::NAN }), Answer::Refused { .. }));
}

#[test]
fn a_number_is_written_alone() {
    let mut session = session_with(JUMPER);
    session.answer(Request::Open { world: None });
    session.answer(Request::Set { slider: 0, value: 150.0 });
    session.answer(Request::Set { slider: 3, value: 75.0 });
    let written = opened(session.answer(Request::Write { slider: 3 }));
    assert_eq!(written.unsaved, ["test.hyped"]);
    let with_rest = JUMPER.replace("50ms", "75ms");
    assert_eq!(text(session.answer(Request::Text { path: None, written: true })), with_rest);
    let both = with_rest.replace("= 120", "= 150");
    assert_eq!(text(session.answer(Request::Text { path: None, written: false })), both);
    assert!(opened(session.answer(Request::Undo)).unsaved.is_empty());
    assert_eq!(text(session.answer(Request::Text { path: None, written: true })), JUMPER);
    assert!(matches!(session.answer(Request::Undo), Answer::Refused { .. }));
    assert!(matches!(session.answer(Request::Write { slider: 9 }), Answer::Refused { .. }));
}

#[test]
fn a_cell_is_a_character_of_the_text() {
    let mut painted = 0;
    for path in playable() {
        let mut session = session_of(&path);
        let first = opened(session.answer(Request::Open { world: None }));
        let scene = first.scene.unwrap();
        for (space, info) in scene.spaces.iter().enumerate() {
            let Some(map) = info.map.as_ref().filter(|map| !map.brushes.is_empty()) else { continue };
            let before: BTreeMap<PathBuf, String> = session
                .paths()
                .into_iter()
                .map(|path| {
                    let of = std::fs::read_to_string(&path).unwrap();
                    (path, of)
                })
                .collect();
            let cell = map.cells.len() / 3;
            let kind = map.kinds.iter().position(|kind| kind.role == Role::Solid).unwrap_or(0);
            let symbol = map.kinds[kind].symbol.clone();
            let answer = session.answer(Request::Paint { space, cell, symbol: symbol.clone() });
            let after = opened(answer);
            if after.is_current {
                let is = after.scene.unwrap().spaces[space].map.clone().unwrap().cells[cell];
                assert_eq!(is, if map.kinds[kind].tags.is_empty() { -1 } else { kind as i32 }, "{}", path.display());
                painted += 1;
            }
            for file in &after.unsaved {
                let now = text(session.answer(Request::Text { path: Some(file.clone()), written: true }));
                let old = &before[Path::new(file)];
                let differing = old.chars().zip(now.chars()).filter(|(a, b)| a != b).count();
                assert_eq!((differing, old.chars().count()), (1, now.chars().count()), "{file}");
            }
            assert!(after.unsaved.len() <= 1);
            // What was there already is no change.
            match session.answer(Request::Undo) {
                Answer::Opened(undone) => assert!(undone.unsaved.is_empty() && after.unsaved.len() == 1),
                other => assert!(matches!(other, Answer::Refused { .. }) && after.unsaved.is_empty()),
            }
        }
    }
    assert!(painted > 10, "{painted}");
}

#[test]
fn no_run_leaves_what_values_can_be() {
    let mut session = session_with(JUMPER);
    session.answer(Request::Open { world: None });
    // The task runs at once here: the second answer has the result.
    session.answer(Request::Bounds { slot: 0 });
    let Answer::Bounds { is_ready: true, values, in_modes } = session.answer(Request::Bounds { slot: 0 }) else {
        panic!()
    };
    let of = |name: &str| values.iter().find(|value| value.name == name).map(|value| value.value.clone()).unwrap();
    assert_eq!(of("x'"), "[-60, 60]");
    assert!(of("y'").contains(", 113.333]"), "{}", of("y'"));
    let names: BTreeSet<&str> = values.iter().map(|value| value.name.as_str()).collect();
    // On the ground nothing moves up; in the air it falls.
    let at = |name: &str| values.iter().position(|value| value.name == name).unwrap();
    assert_eq!(in_modes.len(), 2, "{in_modes:?}");
    assert_eq!((in_modes[0].values[at("y'")].as_str(), in_modes[0].values[at("y''")].as_str()), ("= 0", "= 0"));
    assert_eq!(in_modes[1].values[at("y''")], "= -400");
    // Each set of modes of a run is one of them, and its values are within it.
    let mut modes = BTreeSet::new();
    for _ in 0..60 {
        session.answer(Request::Play { inputs: jump()[..1].to_vec() });
        let now = inspected(session.answer(Request::Inspect { slot: 0 }));
        let mut active = now.modes.clone();
        active.sort_unstable();
        let own = in_modes.iter().find(|of| of.modes == active).unwrap();
        for value in now.values.iter().filter(|value| value.kind == "variable") {
            let (is, can_be) = (value.value.parse::<f64>().unwrap(), &own.values[at(&value.name)]);
            let numbers = can_be.split(|c: char| !c.is_ascii_digit() && !"-.e".contains(c));
            let numbers: Vec<f64> = numbers.filter_map(|number| number.parse().ok()).collect();
            let unbounded = ["<=", ">="].map(|side| can_be == "any" || can_be.starts_with(side));
            let (low, high) = (numbers.iter().copied().reduce(f64::min), numbers.iter().copied().reduce(f64::max));
            assert!(unbounded[0] || low.is_some_and(|low| is >= low - 1e-3), "{} {is} {can_be}", value.name);
            assert!(unbounded[1] || high.is_some_and(|high| is <= high + 1e-3), "{} {is} {can_be}", value.name);
        }
        modes.insert(active);
    }
    assert_eq!(modes.len(), 2);
    for value in inspected(session.answer(Request::Inspect { slot: 0 })).values {
        assert!(value.kind == "parameter" || names.contains(value.name.as_str()), "{}", value.name);
    }
}

#[test]
fn a_prediction_is_what_comes() {
    let mut session = session_with(JUMPER);
    session.answer(Request::Open { world: None });
    let input = jump()[0].clone();
    let Answer::Predicted { paths } = session.answer(Request::Predict { input, steps: 20 }) else { panic!() };
    assert_eq!(paths[0].len(), 21);
    for (path, steps) in paths[0].iter().zip(0..) {
        let frame = match steps {
            0 => shown(session.answer(Request::Seek { frame: 0 })).frame,
            _ => shown(session.answer(Request::Play { inputs: vec![jump()[0].clone()] })).frame,
        };
        assert_eq!(path[1..], frame.bodies[2..4]);
    }
}

#[test]
fn a_search_starts_from_the_frame_that_is_shown() {
    let mut session = session_with(JUMPER);
    session.answer(Request::Open { world: None });
    session.answer(Request::Play { inputs: jump() });
    session.answer(Request::Seek { frame: 5 });
    for target in [Target::Goal("far".into()), Target::Predicate("hero.x > 150".into())] {
        let started = session.answer(Request::Search { target: target.clone(), nodes: 20_000, seed: 1 });
        assert!(matches!(started, Answer::Searching(_)), "{started:?}");
        let found = searched(session.answer(Request::Poll));
        assert!(!found.is_running, "{found:?}");
        let script = found.script.clone().unwrap_or_else(|| panic!("{target:?} {:?}", found.verdict));
        let end = shown(session.answer(Request::Load { script: script.clone() }));
        assert!(end.frame.bodies[2] > 100.0, "{:?}", end.frame);
        assert_eq!(found.ghost[0].last().unwrap()[1..], end.frame.bodies[2..4]);
        assert_eq!(found.ghost[0].len() as u64, end.length - 5 + 1);
        session.answer(Request::Seek { frame: 5 });
    }
    // A place, and the points of the search on the way to it.
    let near = Request::Search { target: Target::Place([0.0, 120.0, 8.0]), nodes: 20_000, seed: 1 };
    let points = searched(session.answer(near)).points;
    let found = searched(session.answer(Request::Poll));
    let last = found.ghost[0].last().copied().unwrap_or_else(|| panic!("{:?}", found.verdict));
    assert!((last[1] - 120.0).abs() <= 8.0 && (last[2] - 8.0).abs() <= 8.0, "{last:?}");
    assert!(!points.is_empty() && found.points.is_empty(), "points are told once");
    let unknown = session.answer(Request::Search { target: Target::Goal("near".into()), nodes: 10, seed: 1 });
    assert_eq!(unknown, Answer::Refused { message: "there is no goal `near`".into() });
    let wrong = session.answer(Request::Search { target: Target::Predicate("hero.z > 1".into()), nodes: 10, seed: 1 });
    let Answer::Refused { message } = wrong else { panic!("{wrong:?}") };
    assert!(message.contains('z'), "{message}");
    // What can never hold is proven.
    session.answer(Request::Search { target: Target::Predicate("hero.x' > 100".into()), nodes: 10, seed: 1 });
    let proven = searched(session.answer(Request::Poll));
    assert_eq!(proven.conclusion.as_deref(), Some("proven-unreachable"), "{proven:?}");
}

#[test]
fn a_place_is_searched_in_its_own_space() {
    let mut session = session_of(Path::new("examples/link.hyped"));
    let first = opened(session.answer(Request::Open { world: None })).shown.unwrap().frame;
    let (x, y) = (first.bodies[2], first.bodies[3]);
    for (space, is_there) in [(0.0, true), (1.0, false)] {
        let target = Target::Place([space, x, y]);
        let started = session.answer(Request::Search { target, nodes: 20, seed: 1 });
        assert!(matches!(started, Answer::Searching(_)), "{started:?}");
        let found = searched(session.answer(Request::Poll));
        assert_eq!(found.script.is_some(), is_there, "space {space}: {found:?}");
    }
}

#[test]
fn a_script_leads_to_the_goal_it_is_for() {
    for path in playable() {
        let inputs = path.with_extension("inputs");
        let Ok(script) = std::fs::read_to_string(&inputs) else { continue };
        let mut session = session_of(&path);
        let goals = opened(session.answer(Request::Open { world: None })).scene.unwrap().goals;
        let program = program(compile(&path, &Disk));
        let end = shown(session.answer(Request::Load { script: script.clone() }));
        let mut run = Run::new(&program, WorldId(0)).unwrap();
        for input in script_of(&program, WorldId(0), &script).inputs() {
            run.step(input).unwrap();
        }
        let held: Vec<usize> =
            (0..goals.len()).filter(|goal| run.simulator().goal(run.state(), GoalId(*goal as u32)).unwrap()).collect();
        assert_eq!(end.frame.goals, held, "{}", path.display());
    }
}

#[test]
fn requests_out_of_place_are_refused() {
    let mut session = session_with("entity A {");
    let held = || vec![vec![Held::default()]];
    let broken = opened(session.answer(Request::Open { world: None }));
    assert!(broken.scene.is_none() && !broken.findings.is_empty());
    for request in [
        Request::Play { inputs: held() },
        Request::Seek { frame: 7 },
        Request::Inspect { slot: 0 },
        Request::Poll,
        Request::Script,
        Request::Load { script: "right*3".into() },
        Request::Chart { entity: "A".into() },
    ] {
        assert!(matches!(session.answer(request.clone()), Answer::Refused { .. }), "{request:?}");
    }
    let mut session = session_with(JUMPER);
    session.answer(Request::Open { world: Some("Nowhere".into()) });
    let wild = vec![vec![Held { buttons: vec![0, 5, 63, 64, 9999], axes: vec![f64::NAN, 5.0, 5.0, 5.0, 5.0] }; 3]; 2];
    assert_eq!(shown(session.answer(Request::Play { inputs: wild })).frame.at, 2);
    assert_eq!(text(session.answer(Request::Script)), "jump*2");
    assert_eq!(shown(session.answer(Request::Seek { frame: u64::MAX })).frame.at, 2);
    assert!(matches!(session.answer(Request::Inspect { slot: u32::MAX }), Answer::Refused { .. }));
    assert!(matches!(session.answer(Request::Load { script: "fly*3".into() }), Answer::Refused { .. }));
    let outside = session.answer(Request::Text { path: Some("Cargo.toml".into()), written: false });
    assert!(matches!(outside, Answer::Refused { .. }), "{outside:?}");
}
