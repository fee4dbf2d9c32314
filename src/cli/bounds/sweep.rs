//! `hypedc bounds --set NAME=A..B/STEP`: for each value of one or two numbers of the program, which goals are ruled out, and
//! the ranges of the players' positions and velocities.

use std::io;

use crate::analysis::wording::number;
use crate::analysis::{ConfigurationSpace, SlotSpace};
use crate::compile::Changes;
use crate::ir::{SlotId, VarId, World};
use crate::tabular::{Column, Table};

use crate::ask::{bounds_of, goal_reasons};
use crate::cli::Exit;
use crate::cli::args::{BoundsArgs, ResultFormat};
use crate::cli::report::{choose_world, load_again, load_changed, plain_error};
use crate::cli::sweep::{Sweep, show};

pub(super) fn run(args: &BoundsArgs, sweep: &Sweep<'_>) -> io::Result<Exit> {
    if args.format == ResultFormat::Json {
        plain_error("a sweep of `bounds` is a table, which `--csv` writes; `reach` writes its sweeps as JSON, too")?;
        return Ok(Exit::Refused);
    }
    let mut table: Option<Table> = None;
    let mut head = String::new();
    for point in 0..sweep.points() {
        let numbers = [args.numbers.fixed(), sweep.numbers(point)].concat();
        let changes = Changes { numbers: &numbers, ..Changes::default() };
        let load = if point == 0 { load_changed } else { load_again };
        let Some(loaded) = load(&args.file, args.level.file(), &changes)? else { return Ok(Exit::Refused) };
        let Some(id) = choose_world(&loaded, &args.file, args.world.as_deref())? else { return Ok(Exit::Refused) };
        let world = &loaded.program.worlds[id];
        let space = bounds_of(&loaded.program, id);
        let table = table.get_or_insert_with(|| {
            head = format!("{}, world {}: {}\n", args.file.display(), world.name, sweep.text());
            let mut columns = sweep.columns();
            columns.extend(world.goals.iter().map(|goal| Column::left("", format!("goal {}", goal.name))));
            for (slot, var, degree) in quantities(world) {
                let entity = &loaded.program.entities[world.slots[slot].entity];
                let name = format!("{}.{}", world.slots[slot].name, entity.variable_text(var, degree));
                columns.push(Column::left("", name));
            }
            Table::new(columns)
        });
        let mut cells = sweep.cells(point);
        cells.extend(goal_reasons(&loaded, id, &space).into_iter().map(|(_, why)| match why {
            Some(_) => "proven unreachable".into(),
            None => "not ruled out".into(),
        }));
        cells.extend(quantities(world).map(|(slot, var, degree)| range(&space, slot, var, degree).into()));
        table.push(cells);
    }
    show(&head, table.as_ref(), args.csv.as_deref())
}

/// The positions and velocities of players.
fn quantities(world: &World) -> impl Iterator<Item = (SlotId, VarId, u8)> {
    let players = world.players.iter().map(|player| player.slot);
    players.flat_map(|slot| VarId::XY.into_iter().flat_map(move |var| [0, 1].map(|degree| (slot, var, degree))))
}

/// All that a variable can be, in whatever mode.
fn range(space: &ConfigurationSpace, slot: SlotId, var: VarId, degree: u8) -> String {
    let of: &SlotSpace = &space.slots[slot];
    if of.is_given_up {
        return "anything".to_string();
    }
    let all = of.configurations.iter().filter_map(|at| at.vars.get(var)?.get(usize::from(degree)));
    let all = all.flat_map(|values| values.intervals());
    let ends = all.map(|interval| (interval.low, interval.high));
    match ends.reduce(|(low, high), (l, h)| (low.min(l), high.max(h))) {
        Some((low, high)) if low == high => number(low),
        Some((low, high)) => format!("{} to {}", number(low), number(high)),
        None => "-".to_string(),
    }
}
