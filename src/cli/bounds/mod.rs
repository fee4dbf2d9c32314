//! `hypedc bounds`: the values that each part of a world can have, as tables or as JSON, and the number of dimensions
//! that remain.

mod sweep;
mod table;

use std::io::{self, Write};
use std::ops::AddAssign;
use std::sync::Arc;

use serde::Serialize;

use crate::analysis::{Configuration, ConfigurationSpace, Interval, SlotSpace, Values, configuration_space};
use crate::compile::Changes;
use crate::ir::{Bounds, DiscreteId, Entity, Id, Program, SlotId, TimerId, VarId, World, WorldId};
use crate::json::{self, Layout};
use crate::reach::query::{is_bounded, proof_reasons};
use crate::reach::{Conclusion, Problem, Proof};
use crate::sim::Simulator;
use crate::watch::Unwatched;

use crate::cli::Exit;
use crate::cli::args::{BoundsArgs, ResultFormat};
use crate::cli::report::{Loaded, choose_world, load_changed};
use crate::cli::sweep::{refuses_csv, swept};
use table::write_table;

/// The version of the JSON result.
const RESULT_VERSION: u32 = 1;

/// How many numbers a state has: three for each continuous variable (it and two derivatives), one for each discrete
/// variable and each timer, one for each group of modes that has several.
#[derive(Debug, Clone, Copy, Default, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub(in crate::cli) struct Dimensions {
    /// As the program is written.
    pub all: usize,
    /// Those that are not the same in all that can be.
    pub varying: usize,
    /// The most that are not told by the combination of modes.
    pub in_one_combination: usize,
}

impl AddAssign for Dimensions {
    fn add_assign(&mut self, other: Self) {
        self.all += other.all;
        self.varying += other.varying;
        self.in_one_combination += other.in_one_combination;
    }
}

pub(in crate::cli) fn dimensions(entity: &Entity, space: &SlotSpace) -> Dimensions {
    let numbers = |c: &Configuration| -> Vec<Values> {
        let vars = c.vars.iter().flatten().cloned();
        vars.chain(c.discretes.iter().cloned()).chain(c.timers.iter().map(|t| Values::from(*t))).collect()
    };
    let groups: Vec<usize> = entity.groups.ids().map(Id::index).collect();
    let several = |group: &&usize| {
        let modes = entity.groups.iter().nth(**group).map_or((0, 0), |g| (g.modes.from.0, g.modes.to.0));
        entity.leaves.iter().filter(|l| modes.0 <= l.mode.0 && l.mode.0 < modes.1).count() > 1
    };
    let plain = 3 * entity.vars.len() + entity.discretes.len() + entity.timers.len();
    let all = plain + groups.iter().filter(several).count();
    if space.is_given_up {
        return Dimensions { all, varying: all, in_one_combination: plain };
    }
    let found: Vec<Vec<Values>> = space.configurations.iter().map(numbers).collect();
    let varies = |at: &usize| {
        let mut values = found.iter().map(|f| f[*at].constant());
        let first = values.next().flatten();
        first.is_none() || values.any(|v| v != first)
    };
    let leaves = |group: &&usize| {
        let mut leaves = space.configurations.iter().map(|c| c.leaves.get(**group));
        let first = leaves.next();
        leaves.any(|l| Some(l) != first)
    };
    let varying =
        (0..plain).filter(|at| !found.is_empty() && varies(at)).count() + groups.iter().filter(leaves).count();
    let free = |f: &Vec<Values>| f.iter().filter(|v| v.constant().is_none()).count();
    Dimensions { all, varying, in_one_combination: found.iter().map(free).max().unwrap_or(0) }
}

/// A world with its configuration space.
pub(in crate::cli) struct WorldBounds<'a> {
    pub program: &'a Program,
    pub world: &'a World,
    pub space: &'a ConfigurationSpace,
}

impl<'a> WorldBounds<'a> {
    pub fn entity(&self, slot: SlotId) -> &'a Entity {
        &self.program.entities[self.world.slots[slot].entity]
    }

    pub fn dimensions(&self) -> Dimensions {
        let mut sum = Dimensions::default();
        for (slot, space) in self.space.slots.pairs() {
            sum += dimensions(self.entity(slot), space);
        }
        sum
    }
}

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
    let goals = goals(&loaded, id, &space);
    let mut out = io::stdout().lock();
    if args.format == ResultFormat::Json {
        let result = BoundsResult {
            version: RESULT_VERSION,
            hypedc: env!("CARGO_PKG_VERSION"),
            file: args.file.display().to_string(),
            world: &of.world.name,
            dimensions: of.dimensions(),
            slots: of.space.slots.ids().map(|slot| slot_result(&of, slot)).collect(),
            borders: borders(&of),
            goals: goals.iter().map(|(name, why)| goal_result(name, why.as_deref())).collect(),
        };
        json::write(&result, Layout::Indented, &mut out)?;
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

/// What each part of a world can be; players are distinguished by place if that may tell more about goals.
fn bounds_of(program: &Arc<Program>, id: WorldId) -> ConfigurationSpace {
    let space = configuration_space(program, id);
    let is_open = |goal| space.can_hold(program, id, goal);
    match program.worlds[id].goals.ids().any(is_open) {
        true => space.by_place(program, id, &[], &Unwatched),
        false => space,
    }
}

/// Where runs of a world end, for each player and each space that it can be in.
fn borders(of: &WorldBounds<'_>) -> Vec<Border> {
    let mut borders = Vec::new();
    for player in of.world.players.iter() {
        let moves = !of.entity(player.slot).follows.is_empty();
        let first = of.world.slots[player.slot].space;
        for (_, space) in of.world.spaces.pairs().filter(|(id, _)| moves || *id == first) {
            let bounds = space.bounds.map(|Bounds { left, right, bottom, top: _ }| End { left, right, bottom });
            let player = of.world.slots[player.slot].name.clone();
            borders.push(Border { player, space: space.name.clone(), bounds });
        }
    }
    borders
}

/// What each part of a world can be.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct BoundsResult<'a> {
    /// The version of this format.
    version: u32,
    /// The version of `hypedc`.
    hypedc: &'static str,
    /// The path of the program.
    file: String,
    /// The world.
    world: &'a str,
    /// Of all slots together.
    dimensions: Dimensions,
    /// The places for instances.
    slots: Vec<SlotResult<'a>>,
    /// Where runs end.
    borders: Vec<Border>,
    /// The goals of the world.
    goals: Vec<GoalResult<'a>>,
}

/// A place for an instance.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct SlotResult<'a> {
    /// Its name.
    slot: &'a str,
    /// The entity of its instances.
    entity: &'a str,
    /// Whether there can be no instance.
    can_be_absent: bool,
    /// Whether nothing is known: the instance can be anything.
    given_up: bool,
    /// The numbers of its state.
    dimensions: Dimensions,
    /// The combinations of modes that can be; null if nothing is known.
    combinations: Option<Vec<Combination<'a>>>,
}

/// A combination of modes, and what the instance can be in it.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Combination<'a> {
    /// The innermost mode of each group.
    modes: Vec<&'a str>,
    /// The spaces that it can be in.
    spaces: Vec<&'a str>,
    /// Its continuous variables.
    variables: Vec<VariableResult<'a>>,
    /// Its discrete variables.
    discretes: Vec<DiscreteResult<'a>>,
    /// Its timers.
    timers: Vec<TimerResult<'a>>,
}

/// Closed intervals `[low, high]`; null for an end that is infinite.
type Intervals = Vec<[Option<f64>; 2]>;

/// What a continuous variable can be, as closed intervals; null for an end that is infinite.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct VariableResult<'a> {
    name: &'a str,
    value: Intervals,
    velocity: Intervals,
    acceleration: Intervals,
}

/// What a discrete variable can be, as closed intervals.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct DiscreteResult<'a> {
    name: &'a str,
    value: Intervals,
}

/// How long a mode can have been active, in steps.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct TimerResult<'a> {
    mode: &'a str,
    steps: Intervals,
}

/// What is known of a goal.
#[derive(Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct GoalResult<'a> {
    goal: &'a str,
    /// `not ruled out` or `proven-unreachable`.
    verdict: &'static str,
    /// Why it cannot hold.
    argument: Option<String>,
}

/// The schema of the JSON result.
#[cfg(feature = "testing")]
pub(super) fn json_schema() -> schemars::Schema {
    schemars::schema_for!(BoundsResult<'_>)
}

/// Where runs end because of a player in a space.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Border {
    player: String,
    space: String,
    /// None: at no border.
    bounds: Option<End>,
}

/// Below and beside these numbers, px, a run ends.
#[derive(Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct End {
    left: f64,
    right: f64,
    bottom: f64,
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

/// Each goal, with the reasons why it cannot hold, if any.
fn goals(loaded: &Loaded, id: WorldId, space: &ConfigurationSpace) -> Vec<(String, Option<Vec<String>>)> {
    let sim = Simulator::new(&loaded.program, id);
    let why = |goal| {
        let proof = Proof::of(&Problem::new(&sim, goal), space)?;
        Some(proof_reasons(&loaded.sources, &loaded.program, sim.world(), &proof))
    };
    sim.world().goals.pairs().map(|(goal, g)| (g.name.clone(), why(goal))).collect()
}

fn goal_result<'a>(goal: &'a str, why: Option<&[String]>) -> GoalResult<'a> {
    let verdict = if why.is_some() { Conclusion::ProvenUnreachable.name() } else { "not ruled out" };
    GoalResult { goal, verdict, argument: why.map(|w| w.join("; ")) }
}

fn slot_result<'a>(of: &WorldBounds<'a>, slot: SlotId) -> SlotResult<'a> {
    let (entity, found) = (of.entity(slot), &of.space.slots[slot]);
    let combinations = || found.configurations.iter().map(|c| combination(of, entity, c)).collect();
    SlotResult {
        slot: &of.world.slots[slot].name,
        entity: &entity.name,
        can_be_absent: found.can_be_absent,
        given_up: found.is_given_up,
        dimensions: dimensions(entity, found),
        combinations: (!found.is_given_up).then(combinations),
    }
}

fn intervals<'i>(all: impl IntoIterator<Item = &'i Interval>) -> Intervals {
    let end = |x: f64| x.is_finite().then_some(x);
    all.into_iter().map(|i| [end(i.low), end(i.high)]).collect()
}

fn combination<'a>(of: &WorldBounds<'a>, entity: &'a Entity, at: &Configuration) -> Combination<'a> {
    let variable = |(var, [value, velocity, acceleration]): (VarId, &[Values; 3])| VariableResult {
        name: &entity.vars[var],
        value: intervals(value.intervals()),
        velocity: intervals(velocity.intervals()),
        acceleration: intervals(acceleration.intervals()),
    };
    let discrete = |(id, values): (DiscreteId, &Values)| DiscreteResult {
        name: &entity.discretes[id].name,
        value: intervals(values.intervals()),
    };
    let timer = |(id, steps): (TimerId, &Interval)| TimerResult {
        mode: &entity.modes[entity.timers[id].mode].path,
        steps: intervals([steps]),
    };
    Combination {
        modes: at.leaves.iter().map(|l| entity.modes[entity.leaves[*l].mode].path.as_str()).collect(),
        spaces: at.spaces.iter().map(|s| of.world.spaces[*s].name.as_str()).collect(),
        variables: at.vars.pairs().map(variable).collect(),
        discretes: at.discretes.pairs().map(discrete).collect(),
        timers: at.timers.pairs().map(timer).collect(),
    }
}
