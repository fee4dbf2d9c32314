//! Batches: rows are single runs, however they are divided into parts; a step and an observation allocate nothing.

use std::sync::Arc;

use allocation_counter::measure;
use hypedc::batch::{Batch, Part, PlaneChoice, Planes, Rules, Status, Variables, View, Worker};
use hypedc::compile::compile;
use hypedc::ir::{Program, WorldId};
use hypedc::sim::{Run, Simulator};

use crate::support::{Disk, compile_text, files, program};

/// Number of rows.
const ROWS: usize = 12;

/// Numbers that change with the row and the step: 0, 1, or something between -1 and 1.
fn number(row: usize, control: usize, step: usize) -> f32 {
    let mixed = (row * 7919 + control * 104_729 + (step / 8) * 1_299_709) % 1009;
    [0.0, 1.0, -1.0, 0.25, 0.0, 1.0, 0.0][mixed % 7]
}

fn inputs(batch: &Batch, step: usize) -> Vec<f32> {
    let (players, controls) = batch.shape();
    let width = players * controls;
    (0..ROWS * width).map(|at| number(at / width, at % width, step)).collect()
}

fn closed() -> Vec<(String, Arc<Program>, WorldId)> {
    let mut all = Vec::new();
    for path in files("examples", "hyped") {
        let program = program(compile(&path, &Disk));
        let ids = program.worlds.pairs().filter(|(_, world)| world.open.is_none()).map(|(id, _)| id);
        all.extend(ids.map(|id| (path.display().to_string(), Arc::clone(&program), id)));
    }
    assert!(all.len() > 20, "{}", all.len());
    all
}

fn views(sim: &Simulator) -> Vec<View> {
    let names: Vec<String> = sim.names().into_iter().take(30).collect();
    let planes = Planes::new(sim, &PlaneChoice { size: (7, 5), ..PlaneChoice::default() });
    let variables = Variables::new(sim, &names).ok().unwrap();
    planes.into_iter().map(View::Planes).chain([View::Variables(variables)]).collect()
}

/// Steps the rows of a part in parts of some rows each.
fn divided(mut part: Part<'_>, mut inputs: &[f32], rows: usize, worker: &mut Worker) {
    while !part.is_empty() {
        let (mut first, others) = part.split_at(rows);
        let (now, later) = inputs.split_at(first.len() * first.width());
        first.step(now, false, worker);
        (part, inputs) = (others, later);
    }
}

#[test]
fn rows_are_single_runs_in_whatever_parts() {
    for (name, program, world) in closed() {
        let sim = Arc::new(Simulator::new(&program, world));
        let rules = Rules::default();
        let mut whole = Batch::new(Arc::clone(&sim), ROWS, 3, rules.clone()).unwrap();
        let mut parts = Batch::new(Arc::clone(&sim), ROWS, 3, rules).unwrap();
        let mut run = Run::of(Arc::clone(&sim)).unwrap();
        run.set_seed(3 + 5);
        let (mut worker, mut other, mut input) = (whole.worker(), parts.worker(), run.nothing());
        let (players, controls) = whole.shape();
        let names = |player: u32| {
            let of = sim.world().players.iter().find(|p| p.number == player).unwrap();
            let entity = &program.entities[sim.world().slots[of.slot].entity];
            entity.buttons.iter().chain(entity.axes.iter()).cloned().collect::<Vec<_>>()
        };
        let numbers: Vec<u32> = sim.world().players.iter().map(|player| player.number).collect();
        for step in 0..120 {
            let numbers_in = inputs(&whole, step);
            whole.whole().step(&numbers_in, false, &mut worker);
            divided(parts.whole(), &numbers_in, 1 + step % 5, &mut other);
            assert_eq!(whole.states(), parts.states(), "{name}, step {step}");
            if run.simulator().left_bounds(run.state()).is_some() {
                continue;
            }
            for (at, player) in numbers.iter().enumerate() {
                for (control, of) in names(*player).iter().enumerate() {
                    let value = numbers_in[(5 * players + at) * controls + control];
                    input.set(sim.control(*player, of).unwrap(), f64::from(value));
                }
            }
            let is_fine = run.step(&input).is_ok();
            assert_eq!(is_fine, whole.rows()[5].status != Status::Fault, "{name}, step {step}");
            assert_eq!(&run.state()[..], whole.state(5).unwrap(), "{name}, step {step}");
        }
    }
}

/// What ends runs is decided from offsets where it can be; the simulator evaluates it.
#[test]
fn runs_end_as_the_simulator_says() {
    let mut ended = 0;
    for (name, program, id) in closed() {
        let sim = Arc::new(Simulator::new(&program, id));
        let world = sim.world();
        let mut batch = Batch::new(Arc::clone(&sim), ROWS, 3, Rules::of(world)).unwrap();
        let mut worker = batch.worker();
        for step in 0..400 {
            let inputs = inputs(&batch, step);
            batch.whole().step(&inputs, true, &mut worker);
            for (at, row) in batch.rows().iter().enumerate().filter(|(_, row)| row.status != Status::Fault) {
                let state = batch.state(at).unwrap();
                let never = world.nevers.pairs().find(|(_, never)| sim.holds(state, never.holds).unwrap());
                let goal = world.goals.pairs().find(|(_, goal)| sim.holds(state, goal.holds).unwrap());
                let expected = match (never, sim.left_bounds(state), goal) {
                    (Some((id, _)), ..) => (Status::Never, id.0),
                    (None, Some(_), _) => (Status::Outside, 0),
                    (None, None, Some((id, _))) => (Status::Goal, id.0),
                    (None, None, None) => (Status::Running, 0),
                };
                assert_eq!((row.status, row.which), expected, "{name}, row {at}, step {step}");
                ended += usize::from(expected.0 != Status::Running);
            }
        }
    }
    assert!(ended > 200, "{ended}");
}

#[test]
fn a_step_and_an_observation_allocate_nothing() {
    for (name, program, world) in closed() {
        let sim = Arc::new(Simulator::new(&program, world));
        let mut batch = Batch::new(Arc::clone(&sim), ROWS, 0, Rules::of(sim.world())).unwrap();
        let views = views(&sim);
        let mut seen: Vec<Vec<f32>> = views.iter().map(|view| vec![0.0; ROWS * view.len()]).collect();
        let all: Vec<Vec<f32>> = (0..200).map(|step| inputs(&batch, step)).collect();
        let mut worker = batch.worker();
        let counted = measure(|| {
            for inputs in &all {
                let mut part = batch.whole();
                part.step(inputs, true, &mut worker);
                for (view, seen) in views.iter().zip(&mut seen) {
                    part.observe(view, seen);
                }
            }
        });
        assert_eq!((counted.count_total, counted.bytes_total), (0, 0), "{name}: allocations, bytes");
        assert!(seen.iter().flatten().any(|number| *number != 0.0), "{name}");
    }
}

const WALK: &str = "entity Walker {
    button back
    collider body: rect(0, 0, 8, 8)
    mode on {
        x' = 60
        when held(back) -> off
    }
    mode off {
        x' = -60
    }
}
world Plain {
    tiles land 8 x 8 { '.': empty; '#': rock; 'o': rock }
    space main {
        bounds rect(-40, 0, 400, 80)
        map land \"
            ...#
            ##.#
        \"
        place walker: Walker at (4, 8)
    }
    player 1: walker
    goal far: walker.x > 20
    never back: walker.x < -20
}";

#[test]
fn a_run_ends_by_goal_never_and_time() {
    let program = program(compile_text(WALK));
    let sim = Arc::new(Simulator::new(&program, WorldId(0)));
    let rules = Rules { within: Some(40), ..Rules::of(sim.world()) };
    let mut batch = Batch::new(Arc::clone(&sim), 3, 0, rules).unwrap();
    let mut worker = batch.worker();
    for step in 0..60 {
        // The last one turns round late.
        let late = if step == 10 { 1.0 } else { 0.0 };
        batch.whole().step(&[0.0, 1.0, late], false, &mut worker);
    }
    let found: Vec<(Status, u64)> = batch.rows().iter().map(|row| (row.status, row.steps)).collect();
    assert_eq!(found, [(Status::Goal, 17), (Status::Never, 25), (Status::TimeUp, 40)]);
    let before = batch.state(1).unwrap().to_vec();
    batch.whole().step(&[0.0; 3], true, &mut worker);
    assert_ne!(batch.state(1).unwrap(), before);
    assert!(batch.rows().iter().all(|row| (row.status, row.steps) == (Status::Running, 0)));
    assert_eq!(batch.rows().iter().map(|row| row.seed).collect::<Vec<_>>(), [3, 4, 5]);
}

#[test]
fn planes_are_the_tiles_around_the_player() {
    let program = program(compile_text(WALK));
    let sim = Arc::new(Simulator::new(&program, WorldId(0)));
    let batch = Batch::new(Arc::clone(&sim), 1, 0, Rules::default()).unwrap();
    let choice = PlaneChoice { size: (5, 3), ..PlaneChoice::default() };
    let view = View::Planes(Planes::new(&sim, &choice).ok().unwrap());
    assert_eq!(view.shape(), [2, 3, 5]);
    let mut seen = vec![9_u8; view.len()];
    batch.observe(&view, &mut seen);
    let rows: Vec<String> = seen.chunks(5).map(|row| row.iter().map(u8::to_string).collect()).collect();
    // The walker is in the second row from below, over the first two columns.
    assert_eq!(rows, ["00000", "00000", "00110", "00000", "00110", "00000"]);
    for (wrong, part) in [
        (PlaneChoice { tags: Some(vec!["rick".into()]), ..choice.clone() }, "no tag `rick`"),
        (PlaneChoice { entities: Some(vec!["Worker".into()]), ..choice.clone() }, "no entity `Worker`"),
        (PlaneChoice { player: Some(2), ..choice.clone() }, "no player 2"),
    ] {
        assert!(Planes::new(&sim, &wrong).err().unwrap().why.contains(part));
    }
}
