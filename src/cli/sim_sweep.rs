//! `hypedc sim --set NAME=A..B/STEP`: the same inputs for each value of one or two numbers of the program, as a
//! table and as CSV.

use std::io;
use std::ops::ControlFlow;
use std::path::Path;

use crate::compile::Changes;
use crate::ir::{VarId, WorldId};
use crate::sim::Simulator;
use crate::tabular::{Cell, Column, Table};

use super::Exit;
use super::args::{ResultFormat, SimArgs};
use super::report::{Loaded, choose_world, load_again, load_changed, plain_error};
use super::sim::{RunEnd, drive, questions, script};
use super::sweep::{Sweep, show};
use super::watches::Interrupt;

/// What is shown of a run: for each goal and `never`, the first step at which it held.
struct Row {
    steps: u64,
    goals: Vec<Option<u64>>,
    nevers: Vec<Option<u64>>,
    /// For each player the last x and y, and the greatest y.
    players: Vec<[f64; 3]>,
    end: &'static str,
}

pub(super) fn run(args: &SimArgs, file: &Path, sweep: &Sweep<'_>) -> io::Result<Exit> {
    let is_json = args.format == ResultFormat::Json;
    if args.trace.is_some() || args.svg.is_some() || args.animation.gif.is_some() || is_json {
        plain_error("a sweep has a table alone, which `--csv` writes: traces, pictures and JSON are of one run")?;
        return Ok(Exit::Refused);
    }
    let mut table: Option<Table> = None;
    let mut head = String::new();
    for point in 0..sweep.points() {
        let numbers = [args.numbers.fixed(), sweep.numbers(point)].concat();
        let questions = questions(args);
        let changes = Changes { questions: &questions, numbers: &numbers, ..Changes::default() };
        let load = if point == 0 { load_changed } else { load_again };
        let Some(mut loaded) = load(file, args.level.file(), &changes)? else { return Ok(Exit::Refused) };
        let Some(world) = choose_world(&loaded, file, args.world.as_deref())? else { return Ok(Exit::Refused) };
        let Some(script) = script(args, &mut loaded, world)? else { return Ok(Exit::Refused) };
        let row = row(args, &loaded, world, &script)?;
        let sim_world = &loaded.program.worlds[world];
        let table = table.get_or_insert_with(|| {
            head = format!("{}, world {}: {}\n", file.display(), sim_world.name, sweep.text());
            let mut columns = sweep.columns();
            columns.push(Column::right("", "steps"));
            let goals = sim_world.goals.iter().map(|goal| Column::right("", format!("goal {}", goal.name)));
            columns.extend(goals);
            columns.extend(sim_world.nevers.iter().map(|never| Column::right("", format!("never {}", never.name))));
            for player in sim_world.players.iter() {
                let name = &sim_world.slots[player.slot].name;
                let of = ["x", "y", "y at most"].map(|what| Column::right("", format!("{name}.{what}")));
                columns.extend(of);
            }
            columns.push(Column::left("", "end"));
            Table::new(columns)
        });
        let mut cells = sweep.cells(point);
        cells.push(row.steps.to_string().into());
        let whole = |step: f64| format!("{step:.0}");
        let first = row.goals.iter().chain(&row.nevers);
        cells.extend(first.map(|step| Cell::of(step.map(|step| step as f64), whole)));
        cells.extend(row.players.iter().flatten().map(|at| Cell::from(format!("{at:.2}"))));
        cells.push(row.end.into());
        table.push(cells);
    }
    show(&head, table.as_ref(), args.csv.as_deref())
}

fn row(args: &SimArgs, loaded: &Loaded, world: WorldId, script: &crate::sim::Script) -> io::Result<Row> {
    let sim = Simulator::new(&loaded.program, world);
    let table = sim.world();
    let mut row = Row {
        steps: 0,
        goals: vec![None; table.goals.len()],
        nevers: vec![None; table.nevers.len()],
        players: vec![[0.0, 0.0, f64::NEG_INFINITY]; table.players.len()],
        end: "",
    };
    let frames = args.frames.unwrap_or(script.len());
    let ended = drive(&sim, (script, args.chance), frames, &Interrupt::new(), &mut |step, _, state, _| {
        row.steps = step;
        // Out of bounds, a `never` still counts, a goal does not.
        let is_inside = sim.left_bounds(state).is_none();
        let goals = row.goals.iter_mut().zip(table.goals.iter()).filter(|_| is_inside);
        for (first, predicate) in goals.chain(row.nevers.iter_mut().zip(table.nevers.iter())) {
            if first.is_none() && sim.holds(state, predicate.holds) == Ok(true) {
                *first = Some(step);
            }
        }
        for (at, player) in row.players.iter_mut().zip(table.players.iter()) {
            let instance = sim.instance(state, player.slot);
            if instance.is_alive() {
                let [x, y] = VarId::XY.map(|var| instance.var(var, 0));
                *at = [x, y, at[2].max(y)];
            }
        }
        Ok(ControlFlow::Continue(()))
    })?;
    row.end = match ended {
        RunEnd::Done | RunEnd::Enough => "",
        RunEnd::LeftBounds => "left the bounds",
        RunEnd::Fault(..) => "a run-time error",
        RunEnd::Stopped(_) => "stopped",
    };
    Ok(row)
}
