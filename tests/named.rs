//! Parts of a state by name: what is read is what the layout holds, what is written is checked.

use std::collections::BTreeSet;
use std::sync::Arc;

use hypedc::compile::compile;
use hypedc::ir::WorldId;
use hypedc::sim::{NamedValue, Run, Simulator};

use crate::support::{Disk, compile_text, files, program};

#[test]
fn every_name_is_found_and_can_be_written_as_it_is() {
    let mut written = 0;
    for path in files("examples", "hyped") {
        let program = program(compile(&path, &Disk));
        for world in program.worlds.ids().filter(|id| program.worlds[*id].open.is_none()) {
            let sim = Arc::new(Simulator::new(&program, world));
            let mut run = Run::of(Arc::clone(&sim)).unwrap();
            let nothing = run.nothing();
            for _ in 0..30 {
                let _ = run.step(&nothing);
            }
            let mut state = run.state().clone();
            let distinct: BTreeSet<String> = sim.names().into_iter().collect();
            assert_eq!(distinct.len(), sim.names().len(), "{}", path.display());
            for name in sim.names() {
                let part = sim.named(&name).unwrap_or_else(|why| panic!("{name}: {}", why.why));
                let (value, number) = (sim.named_value(&state, part), sim.named_number(&state, part));
                match (&value, sim.words(part)) {
                    (NamedValue::Name(word), Some(words)) => assert_eq!(words[number as usize], *word, "{name}"),
                    (NamedValue::Number(value), _) => assert_eq!(value.to_bits(), number.to_bits(), "{name}"),
                    (NamedValue::Whole(value), _) => assert_eq!(f64::from(*value), number, "{name}"),
                    (NamedValue::Truth(is), _) => assert_eq!(f64::from(u8::from(*is)), number, "{name}"),
                    _ => {}
                }
                if sim.set_named(&mut state, part, &value).is_ok() {
                    written += 1;
                    assert_eq!(&state, run.state(), "{name}");
                }
            }
        }
    }
    assert!(written > 1000, "{written}");
}

#[test]
fn wrong_values_leave_the_state() {
    let text = "entity Hero {
            discrete lives: int 0..3 = 3
            discrete color: {red, green} = red
            group legs {
                mode still { }
                mode moving { mode slow { } mode fast { } }
            }
        }
        world W { space main { place hero: Hero at (0, 0) } player 1: hero; goal won: hero.lives == 0 }"
        .replace("} mode", "}\n mode")
        .replace("} player", "}\n player");
    let program = program(compile_text(&text));
    let sim = Arc::new(Simulator::new(&program, WorldId(0)));
    let run = Run::of(Arc::clone(&sim)).unwrap();
    let mut state = run.state().clone();
    let name = |text: &str| NamedValue::Name(text.to_string());
    for (part, value, why) in [
        ("hero.lives", NamedValue::Whole(4), "a whole number from 0 to 3"),
        ("hero.lives", NamedValue::Number(0.5), "a whole number from 0 to 3"),
        ("hero.color", name("blue"), "none of `red`, `green`"),
        ("hero.color", NamedValue::Whole(0), "it is `red`, `green`"),
        ("hero.x", NamedValue::Number(f64::INFINITY), "a finite number"),
        ("hero.mode.legs", name("moving"), "none of"),
        ("hero.mode.legs", NamedValue::Whole(1), "written as a name"),
        ("hero.space", name("attic"), "no space `attic`"),
        ("hero.alive", NamedValue::Truth(false), "spawned and destroyed"),
        ("hero in still", NamedValue::Truth(true), "INSTANCE.mode"),
        ("goal.won", NamedValue::Truth(true), "follows from the state"),
    ] {
        let found = sim.set_named(&mut state, sim.named(part).unwrap_or_else(|why| panic!("{}", why.why)), &value);
        assert!(found.as_ref().is_err_and(|found| found.contains(why)), "{part}: {found:?}");
        assert_eq!(&state, run.state(), "{part}");
    }
    sim.set_named(&mut state, sim.named("hero.mode.legs").ok().unwrap(), &name("legs.moving.fast")).unwrap();
    sim.set_named(&mut state, sim.named("hero.lives").ok().unwrap(), &NamedValue::Number(0.0)).unwrap();
    sim.set_named(&mut state, sim.named("hero.x").ok().unwrap(), &NamedValue::Number(-0.0)).unwrap();
    assert_eq!(sim.named_number(&state, sim.named("hero in fast").ok().unwrap()), 1.0);
    assert_eq!(sim.named_number(&state, sim.named("goal.won").ok().unwrap()), 1.0);
    assert!(sim.load(&sim.save(&state)).is_ok(), "what is written is a state");
}

#[test]
fn unknown_names_say_what_there_is() {
    let text = "entity Hero { x' = 3 }
        world W { space main { place hero: Hero at (0, 0) } }";
    let program = program(compile_text(text));
    let sim = Simulator::new(&program, WorldId(0));
    let why = |name: &str| sim.named(name).err().unwrap();
    assert_eq!(why("hero.xx").near.as_deref(), Some("hero.x"));
    assert!(why("hero.speed").help.unwrap().contains("`hero.x'`"));
    assert!(why("villain.x").help.unwrap().contains("`hero`"));
    for name in
        ["", ".", "hero", "hero.", "hero.x'''", "hero in", "hero in air", "goal.x", "never.", "é", "hero.mode.x"]
    {
        assert!(sim.named(name).is_err(), "{name}");
    }
}
