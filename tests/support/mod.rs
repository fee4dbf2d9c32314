//! Shared helpers of the tests: files from the disk, and compiling programs that must be valid.

#![allow(dead_code, reason = "not every test binary uses all of it")]

pub mod draw;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use hypedc::compile::{Compilation, compile};
use hypedc::diagnostic::render;
use hypedc::ir::{GoalId, Program, SlotId, WorldId};
use hypedc::sim::{Input, Script, Simulator, State, parse_script};
use hypedc::source::{Files, ReadError, SourceMap, decode};
use rand::{Rng, RngExt};

/// Reads from the disk.
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        // Without the system's own words, which differ between systems.
        decode(std::fs::read(path).map_err(|_| ReadError::Unreadable("no such file".into()))?)
    }

    fn identity(&self, path: &Path) -> PathBuf {
        path.canonicalize().unwrap_or_else(|_| path.to_path_buf())
    }

    fn bad_picture(&self, path: &Path) -> Option<String> {
        (!path.is_file()).then(|| "no such file".into())
    }
}

/// One text under the name `test.hyped`, and nothing else.
pub struct Text<'a>(pub &'a str);

impl Files for Text<'_> {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        if path == Path::new("test.hyped") {
            Ok(self.0.to_string())
        } else {
            Err(ReadError::Unreadable("no such file".into()))
        }
    }
}

/// Compiles a text.
pub fn compile_text(text: &str) -> Compilation {
    compile(Path::new("test.hyped"), &Text(text))
}

/// The program of a compilation, or its findings.
pub fn program(compilation: Compilation) -> Arc<Program> {
    let Compilation { sources, program, diagnostics, .. } = compilation;
    program.unwrap_or_else(|| panic!("{}", render::human(&sources, diagnostics.iter(), false)))
}

/// A script for a world, which must be valid.
pub fn script_of(program: &Program, world: WorldId, text: &str) -> Script {
    let file = SourceMap::new().add("inputs", text);
    let (script, found) = parse_script(program, world, file, text);
    assert!(found.is_empty(), "{text}: {found:?}");
    script
}

/// As [`script_of`], for the first world.
pub fn script(program: &Program, text: &str) -> Script {
    script_of(program, WorldId(0), text)
}

/// Runs a script in the first world and calls `look` in each state.
pub fn run(program: &Arc<Program>, inputs: &str, mut look: impl FnMut(&Simulator, &State)) -> (Simulator, State) {
    let sim = Simulator::new(program, WorldId(0));
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    for input in script(program, inputs).inputs() {
        sim.step(&mut state, input, &mut scratch).unwrap();
        look(&sim, &state);
    }
    (sim, state)
}

/// The slot of a name in the first world.
pub fn slot(program: &Program, name: &str) -> SlotId {
    program.worlds[WorldId(0)].slots.find(|s| s.name == name).unwrap()
}

/// A discrete variable of `hero` in a state of the first world.
pub fn count(program: &Program, state: &State, name: &str) -> i32 {
    let hero = slot(program, "hero");
    let world = &program.worlds[WorldId(0)];
    let id = program.entities[world.slots[hero].entity].discretes.find(|d| d.name == name).unwrap();
    world.layout.slots[hero].discrete(state, id)
}

/// The goals of the first world of a text that hold after the steps of a script.
pub fn goals_after(text: &str, script: &str) -> Vec<String> {
    let program = program(compile_text(text));
    let sim = Simulator::new(&program, WorldId(0));
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    for input in self::script(&program, script).inputs() {
        sim.step(&mut state, input, &mut scratch).unwrap();
    }
    let goals = program.worlds[WorldId(0)].goals.pairs();
    goals.filter(|(id, _)| sim.goal(&state, *id).unwrap()).map(|(_, goal)| goal.name.clone()).collect()
}

/// Changes all inputs.
pub fn stir(input: &mut Input, rng: &mut impl Rng) {
    for player in &mut input.0 {
        player.buttons = rng.random();
        player.axes.iter_mut().for_each(|axis| *axis = [-1.0, 0.0, 1.0, 0.5][rng.random_range(0..4)]);
    }
}

/// Runs a script from the beginning: no `never` holds on the way, and the goal holds at its end.
pub fn assert_leads_to(sim: &Simulator, script: &Script, goal: GoalId) {
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    for input in script.inputs() {
        sim.step(&mut state, input, &mut scratch).unwrap();
        assert_eq!(sim.violated(&state).unwrap(), None);
    }
    assert!(sim.goal(&state, goal).unwrap());
}

/// All files of a folder and the folders in it with an extension, sorted.
pub fn files(folder: &str, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![PathBuf::from(folder)];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == extension) {
                found.push(path);
            }
        }
    }
    found.sort();
    assert!(!found.is_empty(), "{folder} holds .{extension} files");
    found
}

/// Whether code declares a name after one of some words, such as `fn`; a public field comes after `pub`. Comments
/// declare nothing.
pub fn declares(code: &str, words: &[&str], name: &str) -> bool {
    let forms: Vec<String> = words.iter().map(|word| format!("{word} {name}")).collect();
    let mut lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    lines.any(|line| {
        forms.iter().any(|form| {
            let after = line.split_once(form.as_str()).and_then(|(_, rest)| rest.chars().next());
            after.is_some_and(|c| !c.is_alphanumeric() && c != '_')
        })
    })
}

/// Whether to run the long version of tests that take long.
pub fn is_long() -> bool {
    std::env::var_os("HYPEDC_LONG").is_some()
}

/// A size of a test: the usual one, or that of its long version.
pub fn sized<T>(usual: T, long: T) -> T {
    if is_long() { long } else { usual }
}

/// All, in the long version of a test; else the one whose turn it is.
pub fn by_turn<T>(all: &[T], turn: usize) -> &[T] {
    let turn = turn % all.len();
    sized(&all[turn..=turn], all)
}
