//! Growth rate of a plain RRT over the interpreter and of one written by hand for the same worlds, in the same run.
//!
//! `cargo bench --bench extensions` grows both trees alternately, 512 nodes at a time, in one thread, and prints the
//! nodes per second of CPU time of each at some sizes, and the memory of a node. Without `--bench` it grows small trees
//! and asserts that the one written by hand is correct.

#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a bench fails by panicking")]
#![allow(clippy::print_stdout, reason = "the table is what it is for")]

#[path = "../tests/support/mod.rs"]
mod support;
mod yardstick;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::Mutex;
use std::time::Duration;

use allocation_counter::measure;
use cpu_time::ThreadTime;
use hypedc::analysis::{ConfigurationSpace, configuration_space};
use hypedc::compile::compile;
use hypedc::ir::{GoalId, Program, WorldId};
use hypedc::reach::{End, Limits, Outcome, Planner, Problem, Restart, Settings, search};
use hypedc::sim::Simulator;
use hypedc::source::{Files, ReadError};
use hypedc::watch::{Progress, Unwatched, Watch};
use support::{Disk, program};
use yardstick::rrt::{Planned, Tree};
use yardstick::{Test1, Test2};

/// The sizes of trees for which rates are measured, each with the number of seeds for the median.
const SIZES: [(u64, u64); 3] = [(1_000, 101), (10_000, 21), (100_000, 3)];
/// The size at which memory is measured.
const LARGE: u64 = 100_000;

/// The disk, with an additional goal in each world that is never met, so that a search grows its tree up to its limit.
/// Samples are biased to the place of the real goal, and evaluating both costs the same.
struct WithGoal((f32, f32));

impl Files for WithGoal {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        let (x, y) = self.0;
        let goal = format!("goal endless: near(hero, ({x}, {y}), 16) and hero.x * hero.x < 0");
        Disk.read(path).map(|text| text.replace("    never fell", &format!("    {goal}\n    never fell")))
    }

    fn identity(&self, path: &Path) -> PathBuf {
        Disk.identity(path)
    }
}

/// A world to search in.
struct World {
    name: &'static str,
    program: Arc<Program>,
    goal: GoalId,
    space: ConfigurationSpace,
}

impl World {
    fn new<W: Planned>(name: &'static str) -> Self {
        let program = program(compile(Path::new(&format!("examples/paper/{name}.hyped")), &WithGoal(W::GOAL)));
        let goals = &program.worlds[WorldId(0)].goals;
        let (goal, _) = goals.pairs().find(|(_, goal)| goal.name == "endless").expect("it was added");
        let space = configuration_space(&program, WorldId(0));
        World { name, goal, space, program }
    }

    /// Grows a tree over the interpreter.
    fn search(&self, seed: u64, nodes: u64, watch: &dyn Watch) -> Outcome {
        let sim = Simulator::new(&self.program, WorldId(0));
        let settings = Settings {
            seed,
            planner: Planner::Rrt,
            hold: Some((10, 10)),
            restart: Restart::Never,
            ..Settings::default()
        };
        let limits = Limits { nodes, memory: u64::MAX };
        let outcome = search(&Problem::new(&sim, self.goal), &self.space, &settings, &limits, watch).unwrap();
        assert_eq!((outcome.end, outcome.statistics.nodes), (End::Nodes, nodes), "{}, seed {seed}", self.name);
        outcome
    }
}

/// The time of both for the growth from one size to another.
#[derive(Clone, Copy)]
struct Batch {
    from: u64,
    to: u64,
    interpreted: Duration,
    by_hand: Duration,
}

/// A watch that grows the tree written by hand to the size of the search at each progress report.
struct AlternatingGrowth<W> {
    by_hand: Mutex<Tree<W>>,
    batches: Mutex<Vec<Batch>>,
    /// CPU time of the thread.
    since: Mutex<Duration>,
}

impl<W: Planned> AlternatingGrowth<W> {
    fn new(seed: u64) -> Self {
        let (by_hand, batches) = (Mutex::new(Tree::new(seed)), Mutex::default());
        AlternatingGrowth { by_hand, batches, since: Mutex::new(ThreadTime::now().as_duration()) }
    }
}

impl<W: Planned> Watch for AlternatingGrowth<W> {
    fn stop(&self) -> bool {
        false
    }

    fn progress(&self, progress: Progress) {
        let interpreted = ThreadTime::now().as_duration() - *self.since.lock().unwrap();
        let mut batches = self.batches.lock().unwrap();
        let (from, to) = (batches.last().map_or(0, |batch| batch.to), progress.nodes);
        let before = ThreadTime::now();
        self.by_hand.lock().unwrap().grow_to(to as usize);
        batches.push(Batch { from, to, interpreted, by_hand: before.elapsed() });
        *self.since.lock().unwrap() = ThreadTime::now().as_duration();
    }
}

/// Nodes per second of both over the last tenth before a size, but at least over the last batch.
fn rates(batches: &[Batch], size: u64) -> [f64; 2] {
    let last: Vec<&Batch> = batches.iter().filter(|batch| batch.from < size && batch.to > size / 10 * 9).collect();
    let nodes: u64 = last.iter().map(|batch| batch.to - batch.from).sum();
    let rate =
        |time: fn(&Batch) -> Duration| nodes as f64 / last.iter().map(|b| time(b)).sum::<Duration>().as_secs_f64();
    [rate(|batch| batch.interpreted), rate(|batch| batch.by_hand)]
}

/// Grows both trees slightly above a size: the search reports progress every 512 nodes.
fn grow<W: Planned>(world: &World, seed: u64, size: u64) -> (AlternatingGrowth<W>, Outcome) {
    let turns = AlternatingGrowth::new(seed);
    let outcome = world.search(seed, size.next_multiple_of(512) + 1, &turns);
    (turns, outcome)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn compare<W: Planned>(world: &World) {
    for (size, seeds) in SIZES {
        let runs: Vec<[f64; 2]> =
            (1..=seeds).map(|seed| rates(&grow::<W>(world, seed, size).0.batches.lock().unwrap(), size)).collect();
        let [interpreted, by_hand] = [0, 1].map(|which| median(runs.iter().map(|rates| rates[which]).collect()));
        let ratio = median(runs.iter().map(|[interpreted, by_hand]| interpreted / by_hand).collect());
        println!("{:<6} {size:>8} {seeds:>6} {interpreted:>12.0} {by_hand:>12.0} {ratio:>8.2}", world.name);
    }
}

/// Prints the memory of a node of each, and the share of extensions of full length.
fn weigh<W: Planned>(world: &World) {
    let mut statistics = None;
    let interpreted = measure(|| statistics = Some(world.search(1, LARGE, &Unwatched).statistics));
    let statistics = statistics.expect("it was searched");
    let mut extensions = 0;
    let by_hand = measure(|| {
        let mut tree = Tree::<W>::new(1);
        tree.grow_to(LARGE as usize);
        extensions = tree.extensions;
    });
    let each = |bytes: u64| bytes as f64 / LARGE as f64;
    let kept = |extensions: f64| 100.0 * LARGE as f64 / extensions;
    println!(
        "{:<6} {:>10.0} {:>8.0} {:>14.0}% {:>7.0}%",
        world.name,
        each(interpreted.bytes_max),
        each(by_hand.bytes_max),
        kept(statistics.extensions as f64),
        kept(extensions as f64)
    );
}

/// Asserts that the tree written by hand is a tree and selects nearest nodes.
fn check<W: Planned>(world: &World) {
    let (turns, _) = grow::<W>(world, 1, 1_000);
    let [interpreted, by_hand] = rates(&turns.batches.lock().unwrap(), 1_000);
    assert!(interpreted > 0.0 && by_hand > 0.0, "{}", world.name);
    let mut tree = turns.by_hand.lock().unwrap();
    assert_eq!(tree.len(), 1_024, "{}", world.name);
    assert!((0..tree.len()).all(|node| tree.replays(node)), "{}", world.name);
    for _ in 0..200 {
        let toward = tree.sample();
        assert_eq!(tree.nearest(&toward), tree.nearest_one_by_one(&toward), "{}: {toward:?}", world.name);
    }
}

fn main() {
    let (one, two) = (World::new::<Test1>("test1"), World::new::<Test2>("test2"));
    check::<Test1>(&one);
    check::<Test2>(&two);
    if !std::env::args().any(|a| a == "--bench") {
        return;
    }
    println!("nodes per second of CPU time over the last tenth before a size; medians over seeds");
    println!("world     nodes  seeds  interpreter      by hand    ratio");
    compare::<Test1>(&one);
    compare::<Test2>(&two);
    println!("\nat {LARGE} nodes: bytes per node at the peak, and extensions that became nodes");
    println!("world  interpreter  by hand    interpreter  by hand");
    weigh::<Test1>(&one);
    weigh::<Test2>(&two);
}
