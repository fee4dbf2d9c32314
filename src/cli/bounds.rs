//! `hypedc bounds`: what each part of a world can be.

use std::io::{self, Write};

use crate::analysis::{Configuration, ConfigurationSpace, SlotSpace, Values, configuration_space};
use crate::ir::{Entity, Program, World};

use super::Answer;
use super::args::BoundsArgs;
use super::report::{choose_world, load};

pub(super) fn run(args: &BoundsArgs) -> io::Result<Answer> {
    let Some(loaded) = load(&args.file, args.map.as_deref())? else { return Ok(Answer::Unasked) };
    let Some(id) = choose_world(&loaded, &args.file, args.world.as_deref())? else { return Ok(Answer::Unasked) };
    let (program, world) = (&loaded.program, &loaded.program.worlds[id]);
    let space = configuration_space(program, id);
    let mut out = io::stdout().lock();
    writeln!(out, "{}, world {}", args.file.display(), world.name)?;
    for (slot, found) in space.slots.pairs() {
        let entity = &program.entities[world.slots[slot].entity];
        write_slot(&mut out, &world.slots[slot].name, entity, found)?;
    }
    write_goals(&mut out, program, world, id, &space)?;
    Ok(Answer::Yes)
}

fn write_goals(
    out: &mut impl Write,
    program: &Program,
    world: &World,
    id: crate::ir::WorldId,
    space: &ConfigurationSpace,
) -> io::Result<()> {
    for (goal, g) in world.goals.pairs() {
        let verdict = if space.can_hold(program, id, goal) { "within what can be" } else { "proven unreachable" };
        writeln!(out, "goal {}: {verdict}", g.name)?;
    }
    Ok(())
}

fn write_slot(out: &mut impl Write, name: &str, entity: &Entity, found: &SlotSpace) -> io::Result<()> {
    if found.is_given_up {
        return writeln!(out, "\n{name}: {}\n  too much to tell: everything is possible", entity.name);
    }
    let count = found.configurations.len();
    let modes = if count == 1 { "combination" } else { "combinations" };
    let absent = if found.can_be_absent { ", or absent" } else { "" };
    writeln!(out, "\n{name}: {}, {count} {modes} of modes{absent}", entity.name)?;
    for at in &found.configurations {
        let paths: Vec<&str> = at.leaves.iter().map(|l| entity.modes[entity.leaves[*l].mode].path.as_str()).collect();
        writeln!(out, "  {}", if paths.is_empty() { "always".to_string() } else { paths.join(", ") })?;
        write_configuration(out, entity, at)?;
    }
    Ok(())
}

fn write_configuration(out: &mut impl Write, entity: &Entity, at: &Configuration) -> io::Result<()> {
    for (var, values) in at.vars.pairs() {
        let name = &entity.vars[var];
        let degrees = values.iter().zip(["", "'", "''"]);
        let shown: Vec<String> = degrees.map(|(v, primes)| format!("{name}{primes} {}", shown(v))).collect();
        writeln!(out, "    {}", shown.join("   "))?;
    }
    for (id, values) in at.discretes.pairs() {
        writeln!(out, "    {} {}", entity.discretes[id].name, shown(values))?;
    }
    Ok(())
}

fn shown(values: &Values) -> String {
    match values.constant() {
        Some(_) => format!("= {values}"),
        None => format!("in {{{values}}}"),
    }
}
