//! A game loop around a compiled world: Mario with a scripted player, and what happens to him. `cargo run --example embed`

use std::error::Error;
use std::io::{Write, stdout};
use std::path::Path;

use hypedc::compile::compile;
use hypedc::ir::WorldId;
use hypedc::sim::{Event, Run};
use hypedc::source::{Files, ReadError, decode};

/// The game's files: the disk.
struct Assets;

impl Files for Assets {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        decode(std::fs::read(path).map_err(|error| ReadError::Unreadable(error.to_string()))?)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    play(&mut stdout().lock())
}

/// Plays ten seconds, and writes what happens.
pub fn play(out: &mut dyn Write) -> Result<(), Box<dyn Error>> {
    let compilation = compile(Path::new("examples/mario.hyped"), &Assets);
    let program = compilation.program.ok_or("`hypedc check examples/mario.hyped` tells what is wrong")?;
    let mut run = Run::new(&program, WorldId(0)).map_err(|fault| format!("{fault:?}"))?;
    let (world, sim) = (run.world().clone(), run.simulator().clone());
    let mario = world.slot_named("hero").ok_or("nobody is called hero")?;
    let jump = sim.control(1, "jump").ok_or("he cannot jump")?;
    let walk = sim.control(1, "horizontal").ok_or("he cannot walk")?;
    let mut input = run.nothing();
    for frame in 0..600 {
        // The player: to the right, with a long jump every second.
        input.set(walk, 1.0);
        input.set(jump, if frame % 60 < 30 { 1.0 } else { 0.0 });
        let mut events = Vec::new();
        run.step_with_events(&input, &mut |event| events.push(event)).map_err(|fault| format!("{fault:?}"))?;
        let (x, y) = run.instance(mario).position();
        let name = |slot| &world.slots[slot].name;
        for event in events {
            let what = match event {
                Event::Edge(slot, edge) => match run.instance(slot).entity().edges[edge].target {
                    Some(mode) => format!("{} -> {}", name(slot), run.instance(slot).entity().modes[mode].path),
                    None => continue,
                },
                Event::Destroyed(slot) => format!("{} is gone", name(slot)),
                Event::Spawned(slot) => format!("{} comes", name(slot)),
                Event::Goal(goal) => format!("goal {}", world.goals[goal].name),
                Event::Never(never) => format!("never {}", world.nevers[never].name),
                Event::Entered(..) | Event::Touched(..) | Event::Parted(..) => continue,
                Event::Broken(_) | Event::Restored(_) => continue,
            };
            writeln!(out, "frame {frame:3}, mario at ({x:6.1}, {y:5.1}): {what}")?;
        }
    }
    Ok(())
}
