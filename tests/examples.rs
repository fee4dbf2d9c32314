//! The examples: every one compiles without findings, every world runs, every script in `examples/inputs` has its
//! intended result.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::support::{Disk, files, program};
use hypedc::compile::{LevelFile, compile, compile_with};
use hypedc::diagnostic::render;
use hypedc::ir::{Program, WorldId};
use hypedc::sim::{Input, Script, Simulator, State, parse_script};
use hypedc::source::SourceMap;

/// Number of steps of each world without input.
const IDLE_STEPS: u32 = 600;

/// The events of a run.
struct Run {
    sim: Simulator,
    steps: u64,
    state: State,
    /// For each goal, the first step at which it held.
    goals: Vec<Option<u64>>,
    /// Each `never` that held, with the first step.
    violated: Vec<(String, u64)>,
}

impl Run {
    /// Runs a world to the end of a script; a fault fails the test.
    fn new(program: &Arc<Program>, world: WorldId, script: &Script, name: &str) -> Self {
        let sim = Simulator::new(program, world);
        let mut scratch = sim.scratch();
        let state = sim.initial(&mut scratch).unwrap_or_else(|f| panic!("{name}: {f:?} before the first step"));
        let goals = vec![None; program.worlds[world].goals.len()];
        let mut run = Run { sim, steps: 0, state, goals, violated: Vec::new() };
        run.observe();
        for input in script.inputs() {
            run.steps += 1;
            let step = run.sim.step(&mut run.state, input, &mut scratch);
            step.unwrap_or_else(|f| panic!("{name}: {f:?} at step {}", run.steps));
            run.observe();
        }
        run
    }

    fn observe(&mut self) {
        let world = &self.sim.program().worlds[self.sim.world_id()];
        for (first, goal) in self.goals.iter_mut().zip(world.goals.iter()) {
            if first.is_none() && self.sim.holds(&self.state, goal.holds).unwrap() {
                *first = Some(self.steps);
            }
        }
        for never in world.nevers.iter() {
            let new = self.violated.iter().all(|(name, _)| *name != never.name);
            if new && self.sim.holds(&self.state, never.holds).unwrap() {
                self.violated.push((never.name.clone(), self.steps));
            }
        }
    }

    /// The final positions of all live instances, and the step at which each goal was reached.
    fn text(&self) -> String {
        let (program, world) = (self.sim.program(), self.sim.world());
        let mut out = format!("world {}: {} steps\n", world.name, self.steps);
        for (id, slot) in world.slots.pairs() {
            let layout = &world.layout.slots[id];
            if !layout.alive(&self.state) {
                continue;
            }
            let entity = &program.entities[slot.entity];
            let leaf = |group| &entity.modes[entity.leaves[layout.leaf(&self.state, group)].mode];
            let modes: Vec<&str> = entity.groups.ids().map(|group| leaf(group).path.as_str()).collect();
            let space = &world.spaces[self.sim.space(&self.state, id)].name;
            let (x, y) = self.sim.position(&self.state, id);
            writeln!(out, "  {} in {space} at ({x:.1}, {y:.1}): {}", slot.name, modes.join(", ")).unwrap();
        }
        for (first, goal) in self.goals.iter().zip(world.goals.iter()) {
            match first {
                Some(step) => writeln!(out, "  goal {}: step {step}", goal.name).unwrap(),
                None => writeln!(out, "  goal {}: not reached", goal.name).unwrap(),
            }
        }
        for (never, step) in &self.violated {
            writeln!(out, "  never {never}: VIOLATED at step {step}").unwrap();
        }
        out
    }
}

/// The name of an example: its path in the folder, without the extension.
fn name_of(path: &Path, folder: &str) -> String {
    path.strip_prefix(folder).unwrap().with_extension("").to_str().unwrap().replace('\\', "/")
}

/// The inputs of an example: `examples/inputs/NAME.inputs` plays the first world of `examples/NAME.hyped`.
fn script_of(path: &Path) -> Option<PathBuf> {
    let script = PathBuf::from(format!("examples/inputs/{}.inputs", name_of(path, "examples")));
    script.exists().then_some(script)
}

/// A program, with the first level beside it if its map is open.
fn playable(path: &Path) -> Arc<Program> {
    let has_open_map = std::fs::read_to_string(path).unwrap().lines().any(|line| line.trim().starts_with("map level"));
    if !has_open_map {
        return program(compile(path, &Disk));
    }
    let levels = files(path.parent().unwrap().to_str().unwrap(), "txt");
    program(compile_with(path, LevelFile { map: Some(&levels[0]), ..LevelFile::default() }, &Disk))
}

fn parsed(program: &Program, path: &Path) -> Script {
    let text = std::fs::read_to_string(path).unwrap();
    let mut sources = SourceMap::new();
    let file = sources.add(path.display().to_string(), text.clone());
    let (script, found) = parse_script(program, WorldId(0), file, &text);
    assert!(found.is_empty(), "{}", render::human(&sources, found.iter(), false));
    script
}

#[test]
fn examples_compile_without_a_word() {
    for path in files("examples", "hyped") {
        let found = compile(&path, &Disk);
        let said = render::human(&found.sources, found.diagnostics.iter(), false);
        assert!(found.program.is_some() && said.is_empty(), "{}", said);
    }
}

#[test]
fn scripts_end_where_they_are_meant_to() {
    let mut played = Vec::new();
    for path in files("examples", "hyped") {
        let Some(script) = script_of(&path) else { continue };
        let name = name_of(&path, "examples");
        let program = playable(&path);
        let script = parsed(&program, &script);
        let run = Run::new(&program, WorldId(0), &script, &name);
        assert_eq!(run.violated, [], "{name}: what must not happen");
        assert!(run.goals.contains(&Some(run.steps)), "{name} ends with a goal:\n{}", run.text());
        insta::assert_snapshot!(name.replace('/', "_"), run.text());
        played.push(name);
    }
    let mut scripts: Vec<String> =
        files("examples/inputs", "inputs").iter().map(|p| name_of(p, "examples/inputs")).collect();
    played.sort();
    scripts.sort();
    assert_eq!(played, scripts, "every script belongs to one example");
}

#[test]
fn worlds_run_without_input() {
    let mut worlds = 0;
    for path in files("examples", "hyped") {
        let program = program(compile(&path, &Disk));
        for (world, w) in program.worlds.pairs() {
            let mut idle = Script::default();
            idle.push(&Input::nothing(w.players.len()), IDLE_STEPS);
            let run = Run::new(&program, world, &idle, &format!("{}, {}", path.display(), w.name));
            assert_eq!(run.steps, u64::from(IDLE_STEPS));
            worlds += 1;
        }
    }
    assert!(worlds >= 14, "there are {worlds} worlds");
}
