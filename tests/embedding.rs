//! The simulator embedded in a game: states that are saved and restored, the events of a step, and the example.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "../examples/embed.rs"]
#[allow(dead_code, reason = "its `main` prints")]
mod embed;

use std::collections::{BTreeSet, HashSet};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use crate::support::{Disk, compile_text, files, program, stir};
use allocation_counter::measure;
use hypedc::compile::compile;
use hypedc::ir::{Id, Program, SlotId, WorldId};
use hypedc::sim::{Control, Event, Input, Instance, NotAState, Run, Simulator, State};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn worlds() -> Vec<(String, Arc<Program>, WorldId)> {
    let programs = ["examples", "tests/conformance"].iter().flat_map(|folder| files(folder, "hyped"));
    let mut all = Vec::new();
    for path in programs {
        let program = program(compile(&path, &Disk));
        let closed = program.worlds.pairs().filter(|(_, world)| world.open.is_none());
        all.extend(closed.map(|(id, _)| (path.display().to_string(), Arc::clone(&program), id)));
    }
    assert!(all.len() > 20, "{}", all.len());
    all
}

#[test]
fn the_example_plays() {
    let mut out = Vec::new();
    embed::play(&mut out).unwrap();
    insta::assert_snapshot!(String::from_utf8(out).unwrap());
}

#[test]
fn a_run_can_be_moved_and_shared() {
    fn everywhere<T: Send + Sync + 'static>() {}
    everywhere::<Simulator>();
    everywhere::<Run>();
    everywhere::<State>();
    everywhere::<Program>();
}

#[test]
fn a_saved_state_goes_on_as_if_nothing_had_been() {
    for (name, program, world) in worlds() {
        let mut rng = Pcg64::seed_from_u64(7);
        let mut run = Run::new(&program, world).unwrap();
        let mut input = run.nothing();
        for step in 0..200 {
            if step % 10 == 0 {
                stir(&mut input, &mut rng);
                let saved = run.simulator().save(run.state());
                let state = run.simulator().load(&saved).unwrap_or_else(|why| panic!("{name}, step {step}: {why}"));
                assert_eq!(&state, run.state(), "{name}, step {step}");
                // A separate run from there.
                let mut other = Run::of(Arc::clone(run.simulator())).unwrap();
                other.set_state(&state);
                other.set_steps(run.steps());
                for _ in 0..10 {
                    if run.step(&input).is_err() {
                        break;
                    }
                    other.step(&input).unwrap();
                    assert_eq!(other.state(), run.state(), "{name}, step {step}");
                }
            }
        }
    }
}

#[test]
fn a_state_that_was_damaged_is_refused_or_runs() {
    let worlds = worlds();
    let (mut refused, mut ran) = (0, 0);
    for seed in 0..10_000 {
        let mut rng = Pcg64::seed_from_u64(seed);
        let (name, program, world) = &worlds[rng.random_range(0..worlds.len())];
        let mut run = Run::new(program, *world).unwrap();
        let mut input = run.nothing();
        for _ in 0..rng.random_range(0..6) {
            stir(&mut input, &mut rng);
            run.step(&input).unwrap();
        }
        let mut saved = run.simulator().save(run.state());
        let at = rng.random_range(16..saved.len());
        saved[at] = [0, 1, 255, 128, rng.random()][rng.random_range(0..5)];
        let tried = catch_unwind(AssertUnwindSafe(|| match run.simulator().load(&saved) {
            Err(_) => false,
            Ok(state) => {
                run.set_state(&state);
                for _ in 0..20 {
                    stir(&mut input, &mut rng);
                    if run.step_with_events(&input, &mut |_| {}).is_err() {
                        break;
                    }
                }
                true
            }
        }));
        match tried {
            Ok(true) => ran += 1,
            Ok(false) => refused += 1,
            Err(_) => panic!("{name}, seed {seed}, byte {at}"),
        }
    }
    assert!(refused > 500 && ran > 500, "{refused} refused, {ran} ran");
}

fn room(entity: &str, more: &str) -> Simulator {
    let text = format!("entity A {{\n{entity}\n}}\nworld W {{ space main {{\nplace a: A at (0, 0)\n{more}\n}} }}");
    Simulator::new(&program(compile_text(&text)), WorldId(0))
}

#[test]
fn a_state_of_another_world_is_refused_and_one_of_other_numbers_is_not() {
    let before = room("param speed = 3\nmode m { x' = speed }", "");
    let saved = before.save(&before.initial(&mut before.scratch()).unwrap());
    let faster = room("param speed = 5\nmode m { x' = speed; when x > 3 -> m }", "");
    assert!(faster.load(&saved).is_ok());
    for other in [room("mode n { x' = 3 }", ""), room("mode m { x' = 3 }", "place b: A at (9, 9)")] {
        assert_eq!(other.load(&saved), Err(NotAState::OtherWorld));
    }
    assert_eq!(before.load(b"hypedst1"), Err(NotAState::Header));
    assert_eq!(before.load(b""), Err(NotAState::Header));
}

/// The leaves of an instance.
fn leaves(instance: Instance<'_>) -> Vec<usize> {
    instance.entity().groups.ids().map(|group| instance.leaf(group).index()).collect()
}

/// The events of a step are exactly the difference between its states, each event once.
#[test]
fn what_is_told_is_what_has_changed() {
    let mut kinds = BTreeSet::new();
    for (name, program, world) in worlds() {
        let mut rng = Pcg64::seed_from_u64(11);
        let mut run = Run::new(&program, world).unwrap();
        let (sim, table) = (Arc::clone(run.simulator()), run.world().clone());
        let mut input = run.nothing();
        for step in 0..400 {
            if step % 12 == 0 {
                stir(&mut input, &mut rng);
            }
            let before = run.state().clone();
            let mut told = Vec::new();
            if run.step_with_events(&input, &mut |event| told.push(event)).is_err() {
                break;
            }
            kinds.extend(told.iter().map(|event| format!("{event:?}").split('(').next().unwrap().to_string()));
            let all: HashSet<String> = told.iter().map(|event| format!("{event:?}")).collect();
            assert_eq!(all.len(), told.len(), "{name}, step {step}: {told:?}");
            let has = |event: Event| told.contains(&event);
            let taken = |slot: SlotId| told.iter().any(|event| matches!(event, Event::Edge(of, _) if *of == slot));
            for slot in table.slots.ids() {
                let (old, new) = (sim.instance(&before, slot), run.instance(slot));
                assert_eq!(has(Event::Spawned(slot)), !old.is_alive() && new.is_alive(), "{name}, step {step}");
                assert_eq!(has(Event::Destroyed(slot)), old.is_alive() && !new.is_alive(), "{name}, step {step}");
                if old.is_alive() && new.is_alive() {
                    assert_eq!(
                        has(Event::Entered(slot, new.space())),
                        old.space() != new.space(),
                        "{name}, step {step}"
                    );
                    assert!(leaves(old) == leaves(new) || taken(slot), "{name}, step {step}: {}", new.name());
                }
                for touch in new.entity().touches.ids() {
                    let (was, is) = (old.is_alive() && old.touches(touch), new.is_alive() && new.touches(touch));
                    assert_eq!(has(Event::Touched(slot, touch)), is && !was, "{name}, step {step}");
                    assert_eq!(has(Event::Parted(slot, touch)), new.is_alive() && was && !is, "{name}, step {step}");
                }
            }
            for event in &told {
                if let Event::Edge(slot, edge) = *event {
                    let (old, new) = (sim.instance(&before, slot), run.instance(slot));
                    let edge = &old.entity().edges[edge];
                    assert!(old.is_in(edge.source), "{name}, step {step}");
                    assert!(edge.target.is_none_or(|mode| !new.is_alive() || new.is_in(mode)), "{name}, step {step}");
                }
            }
            let (old, new) = (sim.broken_tiles(&before), sim.broken_tiles(run.state()));
            let broken = new.iter().filter(|tile| !old.contains(tile)).map(|tile| Event::Broken(*tile));
            let restored = old.iter().filter(|tile| !new.contains(tile)).map(|tile| Event::Restored(*tile));
            let changed: Vec<Event> = broken.chain(restored).collect();
            assert!(changed.iter().all(|event| has(*event)), "{name}, step {step}: {changed:?}");
            let of_tiles = told.iter().filter(|event| matches!(event, Event::Broken(_) | Event::Restored(_)));
            assert_eq!(of_tiles.count(), changed.len(), "{name}, step {step}: {told:?}");
            for (id, goal) in table.goals.pairs() {
                let holds = |state: &State| sim.holds(state, goal.holds).unwrap();
                assert_eq!(has(Event::Goal(id)), holds(run.state()) && !holds(&before), "{name}, step {step}");
            }
        }
    }
    let all = ["Broken", "Destroyed", "Edge", "Entered", "Goal", "Never", "Parted", "Restored", "Spawned", "Touched"];
    assert_eq!(kinds.iter().map(String::as_str).collect::<Vec<_>>(), all);
}

#[test]
fn a_run_allocates_nothing_whether_somebody_listens_or_not() {
    for (name, program, world) in worlds() {
        let mut run = Run::new(&program, world).unwrap();
        let (mut input, mut rng) = (run.nothing(), Pcg64::seed_from_u64(3));
        let mut heard = 0;
        let counted = measure(|| {
            for step in 0..200 {
                stir(&mut input, &mut rng);
                let stepped = match step % 2 {
                    0 => run.step(&input),
                    _ => run.step_with_events(&input, &mut |_| heard += 1),
                };
                if stepped.is_err() {
                    break;
                }
            }
        });
        assert_eq!(counted.count_total, 0, "{name}");
    }
}

#[test]
fn what_an_instance_is_can_be_asked_by_name() {
    let sim = room(
        "param speed = 30\ndiscrete colour: {red, green} = green\ncontinuous heat = 2
         group go { mode on { x' = speed
mode slow { when timer > 1s -> fast }
mode fast { } } }
         group rest { mode idle { } }
ref friend: A",
        "",
    );
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    for _ in 0..30 {
        sim.step(&mut state, &Input::nothing(0), &mut scratch).unwrap();
    }
    let instance = sim.instances(&state).next().unwrap();
    let entity = instance.entity();
    assert_eq!(instance.name(), "a");
    assert_eq!(
        ["x", "x'", "heat", "colour", "speed"].map(|name| instance.get(name)),
        [15.0, 30.0, 2.0, 1.0, 30.0].map(Some)
    );
    assert_eq!(["z", "x'''", "speed'", ""].map(|name| instance.get(name)), [None; 4]);
    assert_eq!(instance.discrete_name(entity.discrete_named("colour").unwrap()), Some("green"));
    let modes: Vec<&str> = instance.modes().map(|mode| entity.modes[mode].path.as_str()).collect();
    assert_eq!(modes, ["go.on.slow", "rest.idle"]);
    let [on, slow, fast] = ["go.on", "go.on.slow", "go.on.fast"].map(|path| entity.mode_named(path).unwrap());
    assert_eq!([on, slow, fast].map(|mode| instance.is_in(mode)), [true, true, false]);
    assert_eq!([on, slow].map(|mode| instance.time_in(mode)), [None, Some(0.5)]);
    assert!(instance.reference(entity.ref_named("friend").unwrap()).is_none());
}

#[test]
fn inputs_are_set_by_name() {
    let text = "entity A { button go, stop\naxis turn\nmode m { x' = if(turn > 0, 9, 3) } }
                world W { space main { place a: A at (0, 0) }; player 2: a }";
    let run = Run::new(&program(compile_text(text)), WorldId(0)).unwrap();
    let control = |player, name| run.simulator().control(player, name);
    let (stop, turn) = (control(2, "stop").unwrap(), control(2, "turn").unwrap());
    assert!(matches!((stop, turn), (Control::Button(..), Control::Axis(..))));
    assert_eq!([control(1, "stop"), control(2, "jump")], [None, None]);
    let mut input = run.nothing();
    input.set(stop, 1.0);
    input.set(turn, 7.0);
    assert_eq!((input.0[0].buttons, input.0[0].axes[0]), (2, 1.0));
    input.set(stop, 0.0);
    input.set(turn, f64::NAN);
    assert_eq!(input, run.nothing());
}
