//! What each part of a world can be: abstract interpretation of the flat program (Cousot and Cousot, *Abstract
//! interpretation: a unified lattice model*, POPL 1977), per slot and per combination of active leaves.
//!
//! For each combination that can be active it finds what each variable and its derivatives can be: a constant, a few
//! values, or intervals. A state that a run can reach is never outside, as long as the run stops where a search does:
//! when a player leaves the bounds of its space, below or beside. It steps from all that is known until nothing new is
//! found (`fixpoint`), moves ends that keep growing to numbers of the program, and in the end cuts what nothing comes to
//! (`widen`).
//!
//! What is assumed: inputs can be anything at any time; references can refer to any instance of their entity; joint
//! transitions can happen or not. Positions are known from levels in three ways: a push ends where edges meet and a
//! contact tells where both are (`surroundings`), and what moves in small steps among walls stays where it can get
//! (`region`); how far something gets in a number of steps is `pace`. Speed and height under a constant acceleration are
//! tied to each other (`energy`). What can be used up once bounds what counts it (`counter_bounds`). Players can be distinguished by
//! place (`cells`, `local`).
//!
//! What is lost: else variables are not related to each other, nor instances. An entity with more than a thousand
//! combinations of leaves, or a world that takes too many steps to look at, is given up: everything is possible then.
//!
//! # Rooms
//!
//! Each uses those above it.
//!
//! | folder, file | holds |
//! |---|---|
//! | `domain` | sets of values, what an instance can be, widening |
//! | `geometry` | bodies, tiles, what never moves, where pushes end, what the instances of a kind are together |
//! | `step` | the phases of a step over sets of values |
//! | `fixpoint` | steps from all that is known until nothing new is found; how it begins, how it ends |
//! | `membership` | whether a state lies inside, fast: searches ask it of every state |
//! | `pace` | how far an instance gets in a number of steps |
//! | `findings` | what `check` reports |
//!
//! # The phases of a step
//!
//! The analysis takes a step in the order of the simulator's phases. Each row sets a phase beside its abstraction, and names
//! what holds the two together, beside the random runs of `tests/analysis.rs`, the harness in `tests/soundness` and the
//! interpreter in `tests/oracle`, which look at all of them.
//!
//! | simulator | here | distinguished or given up | tests |
//! |---|---|---|---|
//! | `Simulator::initial`: contacts are found, nothing is pushed | `initial::begin`: the first positions are places of contacts | what begins inside of something is pushed anywhere beside it | `found/*initial*`, `*slight*` |
//! | input: buttons, axes | `Reader::truth`, `number`: anything, if there is a player | – | oracle, exhaustive |
//! | discrete: `decide`, edges in order, first guard that holds | `Stepper::choices`: refined by each guard in turn | others are read as the step began (`Phase::Discrete`) | `verdicts/*` |
//! | discrete: `take`, entries, updates, timers restart | `Stepper::take`, `enter`, `act` | ways of groups are joined beyond 512 | `found.rs` |
//! | `life::change`: destroy, spawn | `outcome.can_end`, `initial::spawn`: parameters are part of what a spawned instance can be | which slot is taken is not known | `found/spawnchain*`, `pair`, `home` |
//! | what dies is read until the step ends | `Between`: what the discrete phase makes of it, modes included | – | `found/*dying*` |
//! | `life::change`: links | `Stepper::through` | – | `found/linkout`, `found.rs` |
//! | continuous: flows, envelopes, clamps | `flow::flow`: contacts are those of the last collision (`Phase::Continuous`) | of others, all they are within a step | `found/*stale*`, `*clamp*` |
//! | `collision::carry` | `Surroundings::collide`: near what carries it, moved by as much, carriers of carriers included | positions of the two are not related | `tests/semantics.rs`, oracle |
//! | contacts, where everything is before pushes | `Overall::contact`, `places` | – | `found/false-pushed-pusher` |
//! | pushes: along an axis the deepest counts | `Contacts::push_out`: it ends at an edge of what it meets | instances that move and push (`crowd`); colliders that appear inside of something (`Stepper::activations`); overlaps; gaps a little too narrow: anywhere beside it | `found/false-opposite-pushes`, `verdicts/slit*` |
//! | velocities into surfaces become 0 | the same, beside the old one | energies: only of what never moves | `found/false-clamped*` |
//! | `life::remove_destroyed`: references become none | references may always be none | – | oracle |
//! | observation: `never`, then written bounds, then `goal` | `forbidden`, `widen::within_bounds`, `can_turn_out` | – | `tests/border.rs` |

mod domain;
mod findings;
mod fixpoint;
mod geometry;
mod membership;
mod pace;
mod step;

pub use domain::configuration::{Configuration, Numbers};
pub use domain::values::{Interval, Values};
pub use domain::wording;
pub use findings::{InvariantVerdict, Spaces, findings, invariants, watched_findings};
pub use membership::{Beyond, Membership, Outside, Reading};

use std::sync::Arc;

use crate::ir::{ExprId, GoalId, IdVec, Program, SlotId, World, WorldId};

use crate::watch::{Unwatched, Watch};

use domain::configuration::Overall;
use fixpoint::Analysis;
use fixpoint::counter_bounds::{self, Limits};
use geometry::scene::Scene;
use geometry::surroundings::Surroundings;
use step::evaluate::{Joined, Phase, Pinned, Reader};
use step::forbidden::Forbidden;

/// So where players are distinguished by place, with each place that a way leads to.
const MAX_EFFORT_BY_PLACE: usize = 60_000;

/// The number of ways of steps after which a world is given up: everything can be anything.
const MAX_EFFORT: usize = 300_000;

/// Why everything is taken to be possible.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GivenUp {
    /// There are too many combinations of leaves, or too many ways of a step.
    Combinations,
    /// The analysis takes too many steps.
    Effort,
    /// The watch stopped it.
    Stopped,
}

impl GivenUp {
    /// In words, of an analysis.
    pub fn reason(self) -> String {
        match self {
            GivenUp::Combinations => format!("more than {} combinations of modes", fixpoint::MAX_CONFIGURATIONS),
            GivenUp::Effort => "the world takes too many steps to analyse".to_string(),
            GivenUp::Stopped => "the analysis was stopped".to_string(),
        }
    }
}

/// What a slot can be.
#[derive(Debug, Clone)]
pub struct SlotSpace {
    /// What it can be while there is an instance, one for each combination of leaves; none if there never is one.
    pub configurations: Vec<Configuration>,
    /// Whether there can be no instance.
    pub can_be_absent: bool,
    /// Whether there was too much to tell, so that everything is possible.
    pub is_given_up: bool,
    /// Why, if so.
    pub why: Option<GivenUp>,
}

/// What a world can be.
#[derive(Debug, Clone)]
pub struct ConfigurationSpace {
    /// Of each slot.
    pub slots: IdVec<SlotId, SlotSpace>,
    overall: IdVec<SlotId, Overall>,
    joined: Joined,
    surroundings: Surroundings,
    /// The same with players distinguished by place, where that was asked for and could be done.
    finer: Option<Box<ConfigurationSpace>>,
}

/// Finds what a world can be.
pub fn configuration_space(program: &Program, world: WorldId) -> ConfigurationSpace {
    let world = &program.worlds[world];
    within_limits(program, world, &[], counter_bounds::limits(program, world), &mut { MAX_EFFORT }, &Unwatched)
}

/// As [`configuration_space`], of all runs on which some predicates of the world never hold.
pub fn configuration_space_without(program: &Program, world: WorldId, predicates: &[ExprId]) -> ConfigurationSpace {
    let world = &program.worlds[world];
    within_limits(program, world, predicates, counter_bounds::limits(program, world), &mut { MAX_EFFORT }, &Unwatched)
}

/// As [`configuration_space_without`], until a watch stops it: then everything is possible.
pub fn watched_space(
    program: &Program,
    world: WorldId,
    predicates: &[ExprId],
    watch: &dyn Watch,
) -> ConfigurationSpace {
    let world = &program.worlds[world];
    within_limits(program, world, predicates, counter_bounds::limits(program, world), &mut { MAX_EFFORT }, watch)
}

/// A program in whose world nothing ends a run but a fault: it has no `bounds`, and a space of it without predicates knows of
/// no `never`. What a run of the world comes to it comes to there, too, the state included in which it ends.
pub fn endless(program: &Program, world: WorldId) -> Program {
    let mut endless = program.clone();
    Arc::make_mut(&mut endless.worlds[world]).spaces.iter_mut().for_each(|space| space.bounds = None);
    endless
}

/// As [`configuration_space`], but whatever the number of things that can be picked up: that is a matter of the level.
/// Takes what it needs from an effort; a world that needs more than is left is given up. The world need not be one of the
/// program's, but is of its entities.
fn without_counter_bounds(
    program: &Program,
    world: &World,
    effort: &mut usize,
    watch: &dyn Watch,
) -> ConfigurationSpace {
    within_limits(program, world, &[], counter_bounds::ranges(program, world), effort, watch)
}

fn within_limits(
    program: &Program,
    world: &World,
    predicates: &[ExprId],
    limits: Limits,
    effort: &mut usize,
    watch: &dyn Watch,
) -> ConfigurationSpace {
    let forbidden = Forbidden { program, world, predicates };
    let scene = Scene::new(program, world, watch);
    let mut analysis = Analysis::new(scene, forbidden, limits, *effort, watch);
    analysis.run();
    *effort = analysis.effort;
    analysis.finish()
}

impl ConfigurationSpace {
    /// Tells players apart by place, too, as long as none of some predicates holds: what they cannot come to step by step
    /// is shown then. That takes longer; nothing changes if there is no player of whom it can be done, or if there is too
    /// much to look at.
    #[must_use]
    pub fn by_place(mut self, program: &Program, world: WorldId, predicates: &[ExprId], watch: &dyn Watch) -> Self {
        let table = &program.worlds[world];
        let mut scene = Scene::new(program, table, watch);
        if scene.refine() {
            let forbidden = Forbidden { program, world: table, predicates };
            let limits = counter_bounds::limits(program, table);
            let mut analysis = Analysis::new(scene, forbidden, limits, MAX_EFFORT_BY_PLACE, watch);
            analysis.run();
            let finer = analysis.finish();
            let is_known = finer.slots.iter().all(|s| !s.is_given_up);
            self.finer = is_known.then(|| Box::new(finer));
        }
        self
    }

    /// What is known in most detail.
    pub fn finest(&self) -> &ConfigurationSpace {
        self.finer.as_deref().unwrap_or(self)
    }

    /// Whether a goal can hold in some state; if not, it is proven that it cannot be reached.
    pub fn can_hold(&self, program: &Program, world: WorldId, goal: GoalId) -> bool {
        self.can_turn_out(program, world, program.worlds[world].goals[goal].holds, true)
    }

    /// Whether a predicate of the world, or a part of one, can hold (or fail) in some state.
    pub fn can_turn_out(&self, program: &Program, world: WorldId, predicate: ExprId, holds: bool) -> bool {
        let table = &program.worlds[world];
        if self.finer.as_ref().is_some_and(|f| !f.can_turn_out(program, world, predicate, holds)) {
            return false;
        }
        let reader = self.reader(program, table, None);
        let can = |reader: &Reader<'_>| {
            let truth = reader.truth(predicate);
            if holds { truth.can_hold } else { truth.can_fail }
        };
        // Each instance is somewhere in its region while it is covered, if it is there at all.
        let in_parts = |slot: SlotId| {
            let regions = self.surroundings.regions(slot);
            let mut parts = regions.iter().flat_map(|(space, region)| region.boxes().iter().map(move |b| (*space, *b)));
            let absent = self.overall[slot].can_be_absent;
            let at = |at| can(&Reader { pinned: Some((slot, Pinned::At(at))), ..reader });
            regions.is_empty()
                || absent
                || parts.any(|(space, part)| can(&Reader { pinned: Some((slot, Pinned::Part(space, part))), ..reader }))
                || self.bare(slot).any(at)
        };
        // So it is in one of its configurations.
        let in_configurations = |slot: SlotId| {
            let SlotSpace { configurations, can_be_absent, is_given_up, .. } = &self.slots[slot];
            let at = |at| can(&Reader { pinned: Some((slot, Pinned::At(at))), ..reader });
            *can_be_absent || *is_given_up || configurations.iter().any(at)
        };
        let players = || table.players.iter().map(|p| p.slot);
        can(&reader) && players().all(in_parts) && players().all(in_configurations)
    }

    /// The configurations in which nothing keeps an instance out of what blocks it.
    fn bare(&self, slot: SlotId) -> impl Iterator<Item = &Configuration> {
        let cover = self.surroundings.cover(slot);
        let is_bare = |at: &&Configuration| !cover.covers(&at.leaves);
        self.slots[slot].configurations.iter().filter(is_bare)
    }

    /// What expressions are read against: those of an instance in one of its configurations, or those of the world.
    fn reader<'a>(
        &'a self,
        program: &'a Program,
        world: &'a World,
        me: Option<(SlotId, &'a Configuration)>,
    ) -> Reader<'a> {
        Reader {
            program,
            world,
            slots: &self.overall,
            joined: &self.joined,
            surroundings: &self.surroundings,
            pinned: None,
            me,
            phase: Phase::Discrete,
        }
    }
}
