//! The values that each part of a world can have, as a record, and the number of dimensions that remain.

use std::ops::AddAssign;
use std::path::Path;
use std::sync::Arc;

use serde::Serialize;

use crate::analysis::{Configuration, ConfigurationSpace, Interval, SlotSpace, Values, watched_space};
use crate::ir::{Bounds, DiscreteId, Entity, Id, Program, SlotId, TimerId, VarId, World, WorldId};
use crate::reach::query::proof_reasons;
use crate::reach::{Conclusion, Problem, Proof};
use crate::sim::Simulator;
use crate::watch::{Unwatched, Watch};

use super::Loaded;

/// The version of the JSON result.
const RESULT_VERSION: u32 = 1;

/// How many numbers a state has: three for each continuous variable (it and two derivatives), one for each discrete
/// variable and each timer, one for each group of modes that has several.
#[derive(Debug, Clone, Copy, Default, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Dimensions {
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

/// The dimensions of a slot.
pub fn dimensions(entity: &Entity, space: &SlotSpace) -> Dimensions {
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
pub struct WorldBounds<'a> {
    /// The program.
    pub program: &'a Program,
    /// The world.
    pub world: &'a World,
    /// What its slots can be.
    pub space: &'a ConfigurationSpace,
}

impl<'a> WorldBounds<'a> {
    /// The entity of a slot.
    pub fn entity(&self, slot: SlotId) -> &'a Entity {
        &self.program.entities[self.world.slots[slot].entity]
    }

    /// Of all slots together.
    pub fn dimensions(&self) -> Dimensions {
        let mut sum = Dimensions::default();
        for (slot, space) in self.space.slots.pairs() {
            sum += dimensions(self.entity(slot), space);
        }
        sum
    }
}

/// What each part of a world can be; players are distinguished by place if that may tell more about goals.
pub fn bounds_of(program: &Arc<Program>, id: WorldId) -> ConfigurationSpace {
    bounds_watched(program, id, &Unwatched)
}

/// As [`bounds_of`]; if the watch stops it, less is known.
pub fn bounds_watched(program: &Arc<Program>, id: WorldId, watch: &dyn Watch) -> ConfigurationSpace {
    let space = watched_space(program, id, &[], watch);
    let is_open = |goal| space.can_hold(program, id, goal);
    match program.worlds[id].goals.ids().any(is_open) {
        true => space.by_place(program, id, &[], watch),
        false => space,
    }
}

/// Where runs of a world end, for each player and each space that it can be in.
pub fn borders(of: &WorldBounds<'_>) -> Vec<Border> {
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
pub struct BoundsResult<'a> {
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

impl<'a> BoundsResult<'a> {
    /// The record; `goals` are those of [`goal_reasons`].
    pub fn new(file: &Path, of: &WorldBounds<'a>, goals: &'a [(String, Option<Vec<String>>)]) -> Self {
        BoundsResult {
            version: RESULT_VERSION,
            hypedc: env!("CARGO_PKG_VERSION"),
            file: file.display().to_string(),
            world: &of.world.name,
            dimensions: of.dimensions(),
            slots: of.space.slots.ids().map(|slot| slot_result(of, slot)).collect(),
            borders: borders(of),
            goals: goals.iter().map(|(name, why)| goal_result(name, why.as_deref())).collect(),
        }
    }
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
pub fn bounds_schema() -> schemars::Schema {
    schemars::schema_for!(BoundsResult<'_>)
}

/// Where runs end because of a player in a space.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Border {
    /// The player's instance.
    pub player: String,
    /// The space.
    pub space: String,
    /// None: at no border.
    pub bounds: Option<End>,
}

/// Below and beside these numbers, px, a run ends.
#[derive(Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct End {
    /// On the left.
    pub left: f64,
    /// On the right.
    pub right: f64,
    /// Below.
    pub bottom: f64,
}

/// Each goal, with the reasons why it cannot hold, if any.
pub fn goal_reasons(loaded: &Loaded, id: WorldId, space: &ConfigurationSpace) -> Vec<(String, Option<Vec<String>>)> {
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
