//! `hypedc why` is true: what it says of a step is what the simulator did in it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::Path;
use std::process::Command;

use hypedc::compile::compile;
use hypedc::ir::{EdgeId, Id, ModeId, SlotId, WorldId};
use hypedc::sim::{Event, Run, Simulator};
use hypedc::why::{RunError, nearly, why};

use crate::support::{Disk, Text, files, script};

const JUMPER: &str = "entity Hero {
    param jump_speed = 240
    param run = 60
    button jump
    axis horizontal
    discrete jumps: int 0..99 = 0
    collider body: rect(0, 0, 16, 16)
    x' = run * horizontal
    group legs {
        mode ground {
            when pressed(jump) and jumps < 9 -> air { y' := jump_speed; jumps := jumps + 1 }
            when y > 50 or not touching(body, rock, below) -> air
        }
        mode air {
            y'' = -720
            when touching(body, rock, below) -> ground
        }
    }
    group face {
        mode calm {
            when entering(air) -> glad
            when y' > 300 and jumps > 2 -> dizzy
        }
        mode glad { when entering(ground) -> calm }
        mode dizzy { }
    }
}
world Yard {
    step 1/60
    collide body with rock: block
    space main {
        bounds rect(-40, -40, 240, 200)
        rect rock (0, 0, 200, 16)
        place hero: Hero at (32, 16)
    }
    player 1: hero
    goal off: hero.x > 200
}
";

fn shown(name: &str, arguments: &[&str]) -> String {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("why");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join(name), JUMPER).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_hypedc")).args(arguments).current_dir(&folder).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let code = output.status.code().unwrap();
    format!("$ hypedc {}\n{}{}[exit {code}]\n\n", arguments.join(" "), text(&output.stdout), text(&output.stderr))
}

#[test]
fn a_step_is_explained_in_words() {
    let of = |more: &[&str]| shown("words.hyped", &[&["why", "words.hyped"], more].concat());
    let run = ["--inputs", "right*10 jump*20 -*30"];
    let mut all = String::new();
    for more in [
        &["--at", "0"][..],
        &["--at", "11"],
        &["--at", "12"],
        &["--at", "40", "--mode", "ground"],
        &["--at", "40", "--mode", "glad"],
        &["--mode", "dizzy", "--not"],
        &["--mode", "air", "--not"],
        &["--mode", "ground", "--not"],
        &["--edge", "12", "--not"],
        // Mistakes.
        &["--mode", "grnd"],
        &["--instance", "her"],
        &["--edge", "3"],
        &["--not"],
    ] {
        all += &of(&[&run[..], more].concat());
    }
    all += &of(&["--inputs", "left*90", "--at", "80"]);
    all += &of(&["--inputs", "lft*90"]);
    all += &of(&[]);
    insta::assert_snapshot!(all);
}

#[test]
fn the_edges_that_are_said_to_be_taken_are_those_of_the_simulator() {
    let (mut steps, mut taken, mut joint) = (0, 0, 0);
    for path in files("examples/inputs", "inputs") {
        let name = path.file_stem().unwrap().to_str().unwrap();
        let program = Path::new("examples").join(name).with_extension("hyped");
        if !program.exists() {
            continue;
        }
        let compiled = compile(&program, &Disk);
        let (program, sources) = (compiled.program.unwrap(), compiled.sources);
        let world = &program.worlds[WorldId(0)];
        let inputs = script(&program, &std::fs::read_to_string(&path).unwrap());
        let sim = std::sync::Arc::new(Simulator::new(&program, WorldId(0)));
        let slot = world.players.iter().next().unwrap().slot;
        let mut run = Run::of(std::sync::Arc::clone(&sim)).unwrap();
        for (input, step) in inputs.inputs().zip(1..240_u64) {
            let mut events = Vec::new();
            run.step_with_events(input, &mut |event| events.push(event)).unwrap();
            let edges: Vec<EdgeId> = events
                .iter()
                .filter_map(|event| match event {
                    Event::Edge(of, edge) if *of == slot => Some(*edge),
                    _ => None,
                })
                .collect();
            // Every step in which something happens, and some others.
            if edges.is_empty() && step % 60 != 0 {
                continue;
            }
            steps += 1;
            let found = why(&sim, &sources, (&inputs, 0), step, slot).unwrap();
            let mut told: Vec<usize> = found.edges.iter().filter(|edge| edge.taken).map(|edge| edge.edge).collect();
            let mut expected: Vec<usize> = edges.iter().map(|edge| edge.index()).collect();
            told.sort_unstable();
            expected.sort_unstable();
            assert_eq!(told, expected, "{name}, step {step}");
            taken += told.len();
            for edge in &found.edges {
                assert!(!edge.taken || edge.held && edge.tried, "{name}, step {step}: {edge:?}");
                joint +=
                    usize::from(edge.taken && edge.atoms.iter().any(|atom| atom.atom.text.starts_with("entering")));
                assert!(edge.atoms.iter().all(|atom| atom.since <= step), "{edge:?}");
            }
            // The modes are those of the run.
            let modes: Vec<&str> =
                run.instance(slot).modes().map(|mode| run.instance(slot).entity().modes[mode].path.as_str()).collect();
            let told: Vec<&str> = found.modes.iter().map(|mode| mode.mode.as_str()).collect();
            assert_eq!(told, modes, "{name}, step {step}");
        }
    }
    assert!(steps > 100 && taken > 80, "{steps} {taken} {joint}");
}

#[test]
fn since_when_is_the_last_change() {
    let compiled = compile(Path::new("test.hyped"), &Text(JUMPER));
    let (program, sources) = (compiled.program.unwrap(), compiled.sources);
    let sim = Simulator::new(&program, WorldId(0));
    let inputs = script(&program, "right*10 jump*30 right*6 jump*30 -*10");
    let at = |step: u64| why(&sim, &sources, (&inputs, 0), step, SlotId(0)).unwrap();
    let all: Vec<_> = (0..=inputs.len()).map(at).collect();
    let mut compared = 0;
    for now in &all {
        for (group, mode) in now.modes.iter().enumerate() {
            let was = |step: u64| all[step as usize].modes[group].mode == mode.mode;
            assert!((mode.since..=now.step).all(was), "{mode:?}");
            assert!(mode.since == 0 || !was(mode.since - 1), "{mode:?}");
        }
        for edge in &now.edges {
            for (index, atom) in edge.atoms.iter().enumerate() {
                // Of the steps in which the edge was considered, too.
                let held = |step: u64| {
                    let then = all[step as usize].edges.iter().find(|other| other.edge == edge.edge)?;
                    then.atoms[index].atom.held
                };
                let then = (atom.since..=now.step).filter_map(held);
                assert!(then.into_iter().all(|held| Some(held) == atom.atom.held), "{edge:?}");
                let before = atom.since.checked_sub(1).and_then(held);
                assert!(before.is_none() || before != atom.atom.held, "step {}: {edge:?}", now.step);
                compared += usize::from(before.is_some());
            }
        }
    }
    assert!(compared > 20, "{compared}");
}

#[test]
fn the_nearest_miss_is_the_least() {
    let compiled = compile(Path::new("test.hyped"), &Text(JUMPER));
    let (program, sources) = (compiled.program.unwrap(), compiled.sources);
    let sim = Simulator::new(&program, WorldId(0));
    let entity = &program.entities[program.entity_named("Hero").unwrap()];
    let inputs = script(&program, "right*10 jump*30 -*20");
    let asked = |path: &str| -> (ModeId, Vec<EdgeId>) {
        let mode = entity.mode_named(path).unwrap();
        (mode, entity.edges.pairs().filter(|(_, edge)| edge.target == Some(mode)).map(|(id, _)| id).collect())
    };
    let (mode, edges) = asked("face.dizzy");
    let found = nearly(&sim, &sources, (&inputs, 0), 60, SlotId(0), (Some(mode), &edges)).unwrap();
    assert_eq!((found.entered, found.edges.len()), (None, 1));
    let edge = &found.edges[0];
    // It is calm on the ground and in the step of the take-off, where nothing is faster than 300: both parts are missing,
    // by 300 - 0 and 2 - 0, or after the landing by 300 - 0 and 2 - 1.
    let missing: Vec<(&str, f64)> =
        edge.missing.iter().map(|missing| (missing.atom.text.as_str(), missing.distance.unwrap())).collect();
    assert_eq!(missing, [("y' > 300", 300.0), ("jumps > 2", 1.0)], "{edge:?}");
    let landed = edge.step.unwrap();
    let after = why(&sim, &sources, (&inputs, 0), landed, SlotId(0)).unwrap();
    assert_eq!(after.modes[1].mode, "face.calm");
    // What was entered is told with its step.
    let (mode, edges) = asked("face.glad");
    let found = nearly(&sim, &sources, (&inputs, 0), 60, SlotId(0), (Some(mode), &edges)).unwrap();
    assert_eq!(found.entered, Some(11));
    let before = nearly(&sim, &sources, (&inputs, 0), 10, SlotId(0), (Some(mode), &edges)).unwrap();
    assert_eq!(before.entered, None);
    // A run that is over has no later steps.
    let left = script(&program, "left*90");
    let over = why(&sim, &sources, (&left, 0), 80, SlotId(0));
    let Err(RunError::Over(slot, step)) = over else { panic!("{over:?}") };
    assert!(slot == SlotId(0) && why(&sim, &sources, (&left, 0), step, SlotId(0)).is_ok());
}

/// In space that wraps, where rocks are hit: what is destroyed is named, and what is seen beyond the seam.
#[test]
fn what_an_edge_did_is_what_came_of_it() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/asteroids.hyped");
    let compiled = compile(&path, &Disk);
    let (program, sources) = (compiled.program.unwrap(), compiled.sources);
    let sim = Simulator::new(&program, WorldId(0));
    let inputs = script(&program, &"fire*2 left+thrust*7 -*3 ".repeat(90));
    let mut steps: Vec<(u64, SlotId)> = Vec::new();
    let (mut scratch, mut known) = (sim.scratch(), Vec::new());
    let mut state = sim.initial(&mut scratch).unwrap();
    for (step, input) in (1..).zip(inputs.inputs()) {
        let before = state.clone();
        sim.step(&mut state, &sim.draw(0, step, input), &mut scratch).unwrap();
        let mut is_hit = false;
        sim.events(&before, &state, &scratch, &mut |event| is_hit |= matches!(event, Event::Destroyed(_))).unwrap();
        if is_hit {
            let actors = sim.taken_edges(&scratch).iter().map(|(slot, _)| (step, *slot));
            steps.extend(actors);
            known.push((step, before, state.clone()));
        }
    }
    steps.dedup();
    assert!(known.len() > 3, "{} steps", known.len());
    let (mut destroyed, mut received) = (0, 0);
    for &(step, slot) in steps.iter().take(40) {
        let (_, before, after) = known.iter().find(|(at, ..)| *at == step).unwrap();
        let found = why(&sim, &sources, (&inputs, 0), step, slot).unwrap();
        let named = |name: &str| program.worlds[WorldId(0)].slot_named(name.trim_matches('`')).unwrap();
        for write in &found.writes {
            if let Some(name) = write.text.strip_prefix("destroy ") {
                let target = if name == "self" { slot } else { named(name) };
                assert!(
                    sim.instance(before, target).is_alive() && !sim.instance(after, target).is_alive(),
                    "{write:?}"
                );
                destroyed += 1;
            }
            if write.text.starts_with("send ") {
                let to = write.value.as_ref().unwrap();
                let names = to.strip_prefix("received by ").unwrap_or_else(|| panic!("{write:?}"));
                assert!(names.split(", ").all(|name| sim.instance(before, named(name)).is_alive()), "{write:?}");
                received += 1;
            }
        }
    }
    assert!(destroyed > 3 && received > 3, "{destroyed} {received}");
}

const SEAM: &str = "entity Hero {
    param speed = 60
    axis horizontal
    collider body: rect(0, 0, 16, 16)
    x' = speed * horizontal
    mode free {
        when touching(body, gate, right) -> held
    }
    mode held { }
}
entity Gate {
    collider door, gate: rect(0, 0, 8, 16)
    mode there { }
}
world Ring {
    step 1/60
    collide body with gate: block
    space main {
        bounds rect(0, 0, 64, 64)
        wrap horizontal
        place hero: Hero at (40, 0)
        place door: Gate at (0, 0)
    }
    player 1: hero
}
";

#[test]
fn what_is_touched_beyond_a_seam_has_its_name() {
    let compiled = compile(Path::new("test.hyped"), &Text(SEAM));
    let (program, sources) = (compiled.program.unwrap(), compiled.sources);
    let sim = Simulator::new(&program, WorldId(0));
    // The door at 0 is at 64, too: 8 px are free on the right.
    let found = why(&sim, &sources, (&script(&program, "right*20"), 0), 20, SlotId(0)).unwrap();
    assert_eq!(found.modes[0].mode, "held");
    let touched: Vec<(&str, &[String])> =
        found.contacts.iter().map(|found| (found.contact.text.as_str(), found.whom.as_slice())).collect();
    assert_eq!(touched, [("touching(body, gate, right)", &["`door`".to_string()][..])]);
}
