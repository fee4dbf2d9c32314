//! `hypedc bounds`: the values that each part of a world can have, as tables or as JSON, and the number of dimensions
//! that remain.

mod sweep;
mod table;

use std::io::{self, Write};

use crate::ask::{Border, BoundsResult, End, WorldBounds, borders, bounds_of, goal_reasons};
use crate::compile::Changes;
use crate::json::{self, Layout};
use crate::reach::query::is_bounded;

use crate::cli::Exit;
use crate::cli::args::{BoundsArgs, ResultFormat};
use crate::cli::report::{choose_world, load_changed};
use crate::cli::sweep::{refuses_csv, swept};
use table::write_table;

pub(in crate::cli) fn run(args: &BoundsArgs) -> io::Result<Exit> {
    if let Some(exit) = swept(&args.numbers, |sweep| sweep::run(args, sweep))? {
        return Ok(exit);
    }
    if refuses_csv(args.csv.as_deref(), "`--format json` has all of one program")? {
        return Ok(Exit::Refused);
    }
    let numbers = args.numbers.fixed();
    let changes = Changes { numbers: &numbers, ..Changes::default() };
    let Some(loaded) = load_changed(&args.file, args.level.file(), &changes)? else { return Ok(Exit::Refused) };
    let Some(id) = choose_world(&loaded, &args.file, args.world.as_deref())? else { return Ok(Exit::Refused) };
    let space = bounds_of(&loaded.program, id);
    let of = WorldBounds { program: &loaded.program, world: &loaded.program.worlds[id], space: &space };
    let goals = goal_reasons(&loaded, id, &space);
    let mut out = io::stdout().lock();
    if args.format == ResultFormat::Json {
        json::write(&BoundsResult::new(&args.file, &of, &goals), Layout::Indented, &mut out)?;
        writeln!(out)?;
        return Ok(Exit::Yes);
    }
    writeln!(out, "{}, world {}", args.file.display(), of.world.name)?;
    write_table(&mut out, &of)?;
    write_borders(&mut out, &borders(&of))?;
    let mut proven = false;
    for (goal, why) in goals {
        match why {
            None => writeln!(out, "goal {goal}: not ruled out")?,
            Some(why) => {
                proven = true;
                writeln!(out, "goal {goal}: proven unreachable")?;
                for reason in why {
                    writeln!(out, "  {reason}")?;
                }
            }
        }
    }
    if proven && is_bounded(of.world) {
        writeln!(out, "a run ends where a player leaves the bounds of its space, below or beside")?;
    }
    Ok(Exit::Yes)
}

/// Writes the borders, one line for all spaces with the same ones.
fn write_borders(out: &mut impl Write, borders: &[Border]) -> io::Result<()> {
    for group in borders.chunk_by(|a, b| a.player == b.player && a.bounds == b.bounds) {
        let Some(Border { player, bounds, .. }) = group.first() else { continue };
        let names: Vec<String> = group.iter().map(|border| format!("`{}`", border.space)).collect();
        let names = match names.as_slice() {
            [one, .., last] if names.len() > 3 => format!("{one} to {last}"),
            _ => names.join(", "),
        };
        match bounds {
            None => writeln!(out, "{player} in {names}: a run ends at no border")?,
            Some(End { left, right, bottom }) => {
                writeln!(out, "{player} in {names}: a run ends where x < {left}, x > {right} or y < {bottom}")?;
            }
        }
    }
    Ok(())
}
