//! Conformance with the 2017 Python system: its recorded runs, replayed from the initial state by our simulator.
//! The traces are data of that system (see `conformance/LICENSE-HyPED-2017`).

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

mod support;

use std::path::Path;

use hypedc::compile::compile;
use hypedc::ir::{VarId, WorldId};
use hypedc::sim::{Simulator, parse_script};
use hypedc::source::SourceMap;
use serde_json::Value;
use support::Disk;

/// How far two numbers may differ.
const TOLERANCE: f64 = 1e-6;

/// The first thing in which a recorded step and a state differ.
fn difference(sim: &Simulator<'_>, state: &[u8], record: &Value) -> Option<String> {
    let (program, world) = (sim.program(), sim.world());
    for (index, recorded) in record.as_array().unwrap().iter().enumerate() {
        let (slot, s) = world.slots.pairs().nth(index).unwrap();
        let entity = &program.entities[s.entity];
        let layout = &world.layout.slots[slot];
        // The record lists all active modes, with the names of nested groups in between: `air.aerial.falling`.
        let deepest = recorded["modes"].as_array().unwrap().iter().filter_map(Value::as_str).max_by_key(|m| m.len());
        let expected: Vec<&str> = deepest.unwrap_or("").split('.').skip(1).step_by(2).collect();
        let expected = expected.join(".");
        let group = entity.groups.ids().next().unwrap();
        let active = &entity.modes[entity.leaves[layout.leaf(state, group)].mode].path;
        if *active != expected {
            return Some(format!("{}: mode {active}, recorded {expected}", s.name));
        }
        for (var, name) in [(VarId(0), "x"), (VarId(1), "y")] {
            for degree in 0..3u8 {
                let found = layout.var(state, var, degree);
                let expected = recorded["vars"][name][usize::from(degree)].as_f64().unwrap();
                if (found - expected).abs() > TOLERANCE {
                    return Some(format!("{}: {name} of degree {degree} is {found}, recorded {expected}", s.name));
                }
            }
        }
    }
    None
}

/// For how many steps a free run agrees with the record, of how many, and the first difference.
fn free_run(name: &str) -> (usize, usize, Option<String>) {
    let folder = Path::new("tests/conformance");
    let trace: Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join(format!("traces/{name}.json"))).unwrap()).unwrap();
    let compiled = compile(&folder.join(format!("{name}.hyped")), &Disk);
    let program = compiled.program.unwrap_or_else(|| panic!("{name} compiles: {:?}", compiled.diagnostics));
    let world = WorldId(0);
    let mut script = String::new();
    for run in trace["input_sequence_rle"].as_array().unwrap() {
        let held: Vec<&str> = run[1].as_array().unwrap().iter().filter_map(Value::as_str).collect();
        let held = if held.is_empty() { "-".to_string() } else { held.join("+") };
        script.push_str(&format!("{held}*{} ", run[0]));
    }
    if program.worlds[world].players.is_empty() {
        script.clear();
    }
    let file = SourceMap::new().add("inputs", "");
    let (script, found) = parse_script(&program, world, file, &script);
    assert!(!found.has_errors(), "{name}: {found:?}");
    let sim = Simulator::new(&program, world);
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    assert_eq!(difference(&sim, &state, &trace["initial"]), None, "{name}: initial state");
    if trace["initial_contacts"].as_array().unwrap().is_empty() {
        // Theirs overlooks a tile that is touched exactly along its edge before the first step; later ones it sees.
        for (id, slot) in sim.world().slots.pairs() {
            sim.world().layout.slots[id].clear_touches(
                &mut state,
                program.entities[slot.entity].touches.len(),
                program.entities[slot.entity].bound,
            );
        }
    }
    let steps = trace["steps"].as_array().unwrap();
    let nothing = hypedc::sim::Input::nothing(program.worlds[world].players.len());
    let inputs = script.inputs().chain(std::iter::repeat(&nothing));
    for (index, (record, input)) in steps.iter().zip(inputs).enumerate() {
        sim.step(&mut state, input, &mut scratch).unwrap();
        if let Some(difference) = difference(&sim, &state, record) {
            return (index, steps.len(), Some(difference));
        }
    }
    (steps.len(), steps.len(), None)
}

#[test]
fn free_runs_agree_with_the_records() {
    let mut names: Vec<String> = std::fs::read_dir("tests/conformance/traces")
        .unwrap()
        .map(|f| f.unwrap().path().file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    names.sort();
    assert!(names.len() >= 10, "the traces are there");
    let mut table = String::new();
    for name in names {
        let (agree, steps, difference) = free_run(&name);
        let difference = difference.map_or(String::new(), |d| format!("; then {d}"));
        table.push_str(&format!("{name}: {agree} of {steps}{difference}\n"));
    }
    insta::assert_snapshot!(table);
}
