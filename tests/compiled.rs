//! Compiled programs as files: a written file is read back as the same program; any other file is rejected or runs
//! without a crash.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;

use crate::support::{Disk, compile_text, files, sized, stir};
use hypedc::analysis::watched_space;
use hypedc::compile::{LevelFile, compile_with};
use hypedc::ir::{Expr, GoalId, Program, WorldId, verify};
use hypedc::sim::{Input, Simulator, State};
use hypedc::source::{FileId, SourceMap, Span};
use hypedc::watch::PollLimit;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde_json::Value;

/// The examples, with a level where they leave their map open.
fn programs() -> Vec<(String, Arc<Program>, SourceMap)> {
    let mut all = Vec::new();
    for path in files("examples", "hyped") {
        let beside = std::fs::read_dir(path.parent().unwrap()).unwrap().map(|entry| entry.unwrap().path());
        let mut levels: Vec<_> = beside.filter(|path| path.extension().is_some_and(|e| e == "txt")).collect();
        levels.sort_unstable();
        let level = levels.first().map(|level| LevelFile::new(level)).unwrap_or_default();
        for level in [LevelFile::default(), level] {
            let compilation = compile_with(&path, level, &Disk);
            let Some(program) = compilation.program.filter(|p| p.worlds.iter().all(|w| w.open.is_none())) else {
                continue;
            };
            all.push((path.display().to_string(), program, compilation.sources));
            break;
        }
    }
    let coins = compile_text(COINS);
    all.push(("coins".into(), coins.program.unwrap(), coins.sources));
    assert!(all.len() > 10, "{}", all.len());
    all
}

/// Many instances that never move.
const COINS: &str = "
entity Hero {
    axis across
    param speed = 60
    collider body: rect(1, 0, 6, 7)
    x' = speed * across
}
entity Coin {
    discrete left: int 0..2 = 2
    collider coin: rect(2, 2, 4, 4) when not in gone
    mode there { when touching(coin, body) as by -> gone { left -= 1 } }
    mode gone { when timer > 0.5 and left > 0 -> there }
}
entity Stone {
    kinematic collider stone: circle(4, 4, 4)
    always { when touching(stone, body) { destroy self } }
}
world Mint {
    collide body with coin: sense
    collide body with stone: block
    tiles mine 8 x 8 { '.': empty; 'c': spawn Coin; 's': spawn Stone }
    space main {
        map mine \"
            cccccccccccc
            .s.s.s.s.s.s
        \"
        place hero: Hero at (0, 8)
    }
    player 1: hero
    goal rich: not any Stone
}";

fn written(program: &Program, sources: &SourceMap) -> String {
    let mut out = Vec::new();
    program.write_json(sources, &mut out).unwrap();
    String::from_utf8(out).unwrap()
}

/// The states of a world under random inputs, up to a fault.
fn states(program: &Arc<Program>, world: WorldId, steps: usize, seed: u64) -> Vec<State> {
    let sim = Simulator::new(program, world);
    let mut scratch = sim.scratch();
    let Ok(mut state) = sim.initial(&mut scratch) else { return Vec::new() };
    let mut all = vec![state.clone()];
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut input = Input::nothing(sim.world().players.len());
    for step in 0..steps {
        if step % 8 == 0 {
            stir(&mut input, &mut rng);
        }
        if sim.step(&mut state, &input, &mut scratch).is_err() {
            break;
        }
        all.push(state.clone());
    }
    all
}

#[test]
fn what_is_written_is_read_back_and_runs_the_same() {
    for (name, program, sources) in programs() {
        let text = written(&program, &sources);
        let (back, texts) = Program::from_json(&text).unwrap_or_else(|why| panic!("{name}: {why}"));
        assert!(text == written(&back, &texts), "{name}");
        for world in program.worlds.ids() {
            assert!(states(&program, world, 400, 1) == states(&back, world, 400, 1), "{name}");
        }
    }
}

/// The places of all numbers in a value.
fn numbers(value: &mut Value, visit: &mut dyn FnMut(&mut Value)) {
    match value {
        Value::Number(_) => visit(value),
        Value::Array(all) => all.iter_mut().for_each(|v| numbers(v, visit)),
        Value::Object(all) => all.values_mut().for_each(|v| numbers(v, visit)),
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}

#[test]
fn any_number_changed_is_refused_or_runs() {
    let mut programs = programs();
    // A level of thousands of tiles is mostly tiles.
    let longest = sized(40_000, 100_000);
    programs.retain(|(_, program, sources)| written(program, sources).len() < longest);
    let times = sized(10_000, 100_000);
    let (mut refused, mut run) = (0, 0);
    let texts: Vec<(String, Value, usize)> = programs
        .iter()
        .map(|(name, program, sources)| {
            let mut value: Value = serde_json::from_str(&written(program, sources)).unwrap();
            // Most numbers would be spans.
            value.as_object_mut().unwrap().remove("sources");
            value["program"].as_object_mut().unwrap().remove("spans");
            let mut count = 0;
            numbers(&mut value, &mut |_| count += 1);
            (name.clone(), value, count)
        })
        .collect();
    for seed in 0..times {
        let mut rng = Pcg64::seed_from_u64(seed);
        let (name, value, count) = &texts[rng.random_range(0..texts.len())];
        let (mut value, chosen) = (value.clone(), rng.random_range(0..*count));
        let mut at = 0;
        numbers(&mut value, &mut |number| {
            if at == chosen {
                let old = number.as_i64().unwrap_or(0);
                *number = match rng.random_range(0..6) {
                    0 => (old + 1).into(),
                    1 => (old - 1).into(),
                    2 => rng.random_range(0..40).into(),
                    3 => u64::from(u32::MAX).into(),
                    4 => rng.random_range(-1e6..1e6).into(),
                    _ => 0.into(),
                };
            }
            at += 1;
        });
        let text = value.to_string();
        let tried = catch_unwind(AssertUnwindSafe(|| match Program::from_json(&text) {
            Err(_) => false,
            Ok((program, _)) => {
                for world in program.worlds.ids() {
                    states(&program, world, 60, seed);
                    watched_space(&program, world, &[], &PollLimit::new(20));
                }
                true
            }
        }));
        match tried {
            Ok(true) => run += 1,
            Ok(false) => refused += 1,
            Err(_) => {
                let path = std::env::temp_dir().join("hypedc-compiled.json");
                std::fs::write(&path, text).unwrap();
                panic!("{name}, seed {seed}: it broke; see {}", Path::display(&path));
            }
        }
    }
    println!("{refused} refused, {run} run");
    assert!(refused > times / 10 && run > times / 10, "{refused} {run}");
}

#[test]
fn the_text_that_comes_with_a_program_is_its_own() {
    let (name, program, sources) = programs().swap_remove(0);
    let value: Value = serde_json::from_str(&written(&program, &sources)).unwrap();
    let read = |change: &dyn Fn(&mut Value)| {
        let mut value = value.clone();
        change(&mut value);
        Program::from_json(&value.to_string()).map(|_| ()).map_err(|why| why.to_string())
    };
    assert_eq!(read(&|_| {}), Ok(()), "{name}");
    assert_eq!(read(&|v| v["sources"] = Value::Null), Ok(()));
    let outside = "its `spans` lie outside of its `sources`, which may be left out";
    let changes: [&dyn Fn(&mut Value); 5] = [
        &|v| v["sources"]["files"][0]["text"] = "entity A { }".into(),
        &|v| v["sources"]["files"] = Value::Array(Vec::new()),
        &|v| v["program"]["spans"]["exprs"][0]["file"] = 99.into(),
        &|v| v["program"]["spans"]["exprs"][0]["start"] = 4_000_000_000_u32.into(),
        // A copy that is expanded into itself.
        &|v| v["sources"]["copies"] = serde_json::json!([[0, { "file": 1_u32 << 31, "start": 0, "end": 0 }]]),
    ];
    for change in changes {
        assert_eq!(read(change), Err(outside.to_string()));
    }
}

/// The schema in the documentation: `UPDATE=1 cargo test --test language compiled` rewrites it.
#[test]
fn what_is_written_is_as_the_schema_says() {
    let path = "docs/schemas/program.json";
    let schema = Program::json_schema();
    let text = serde_json::to_string_pretty(&schema).unwrap() + "\n";
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(path, &text).unwrap();
    }
    assert!(std::fs::read_to_string(path).unwrap() == text, "{path} is another; `UPDATE=1` writes it");
    let validator = jsonschema::draft202012::new(&schema).unwrap();
    for (name, program, sources) in programs() {
        let value: Value = serde_json::from_str(&written(&program, &sources)).unwrap();
        if let Some(error) = validator.iter_errors(&value).next() {
            panic!("{name}: {error} at {}", error.instance_path());
        }
        // Missing, misspelt and mistyped fields are detected.
        let mut keys = Vec::new();
        entries(&value, &mut Vec::new(), &mut keys);
        for at in keys.iter().step_by(keys.len() / 40 + 1) {
            let (last, path) = at.split_last().unwrap();
            let mut broken = value.clone();
            let parent = path.iter().fold(&mut broken, |value, key| value.pointer_mut(&format!("/{key}")).unwrap());
            let old = parent.as_object_mut().unwrap().remove(last).unwrap();
            parent[format!("{last}_")] = old;
            assert!(!validator.is_valid(&broken), "{name}: {at:?} has another name");
        }
    }
}

/// The paths of all members of objects.
fn entries(value: &Value, at: &mut Vec<String>, out: &mut Vec<Vec<String>>) {
    let mut inside = |key: String, value: &Value, is_named: bool| {
        at.push(key);
        if is_named {
            out.push(at.clone());
        }
        entries(value, at, out);
        at.pop();
    };
    match value {
        Value::Array(all) => all.iter().enumerate().for_each(|(index, value)| inside(index.to_string(), value, false)),
        Value::Object(all) => all.iter().for_each(|(key, value)| inside(key.clone(), value, true)),
        _ => {}
    }
}

/// A goal that is an `or` within an `or`, this many levels deep.
fn deep(levels: usize) -> Program {
    let compilation = compile_with(Path::new("examples/balloon.hyped"), LevelFile::default(), &Disk);
    let mut program = Program::clone(&compilation.program.unwrap());
    let Program { exprs, spans, worlds, .. } = &mut program;
    let mut push = |expr| {
        spans.exprs.push(Span::new(FileId(0), 0, 0));
        exprs.push(expr)
    };
    let fails = push(Expr::Bool(false));
    let goal = &mut Arc::make_mut(&mut worlds[WorldId(0)]).goals[GoalId(0)].holds;
    for _ in 0..levels {
        *goal = push(Expr::Or(*goal, fails));
    }
    program
}

/// A thread has a stack of 2 MiB by default.
#[test]
fn what_is_nested_as_deep_as_can_be_is_read_on_a_small_stack() {
    let program = (0..).map(deep).step_by(64).take_while(|program| verify(program).is_ok()).last().unwrap();
    let look = move || {
        let space = watched_space(&program, WorldId(0), &[], &PollLimit::new(1 << 20));
        assert!(space.can_hold(&program, WorldId(0), GoalId(0)));
        let sim = Simulator::new(&Arc::new(program), WorldId(0));
        let mut scratch = sim.scratch();
        let state = sim.initial(&mut scratch).unwrap();
        assert!(!sim.goal(&state, GoalId(0)).unwrap());
    };
    std::thread::Builder::new().stack_size(2 << 20).spawn(look).unwrap().join().unwrap();
}
