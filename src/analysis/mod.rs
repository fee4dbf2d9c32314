//! Abstract interpretation of the flat program (Cousot and Cousot, *Abstract interpretation: a unified lattice model*,
//! POPL 1977), per slot and per combination of active leaves.
//!
//! For each possible combination of leaves it computes the values of each variable and its derivatives: a constant, a
//! few values, or intervals. The result contains every state that a run can reach until a search would stop: when a
//! player leaves the bounds of its space, below or beside. The analysis steps from all known configurations until
//! nothing new is found (`fixpoint`), widens growing ends to numbers of the program (`widen`), and finally narrows
//! (`narrowing`).
//!
//! Assumptions: inputs are arbitrary at any time; references can refer to any instance of their entity; joint
//! transitions may or may not happen. Positions follow from levels in three ways: a push ends where edges touch and a
//! contact determines the positions of both bodies (`surroundings`), a body that moves in small steps among obstacles
//! stays in its reachable region (`region`), and the distance covered in a number of steps is bounded (`travel_bound`).
//! Speed and height under a constant acceleration are related by `energy`. Things that can be used up only once bound
//! the counters that count them (`counter_bounds`). Players can be distinguished by place (`cells`, `local`),
//! and by the courses of their falls (`flights`).
//!
//! Losses: variables are otherwise not related to each other, nor are instances. An entity with more than a thousand
//! combinations of leaves, or a world that needs too many steps, is given up: everything is possible then.
//!
//! # Folders
//!
//! Each folder or file uses only those above it.
//!
//! | folder, file | holds |
//! |---|---|
//! | `domain` | sets of values, abstract states of instances, widening |
//! | `geometry` | bodies, tiles, static obstacles, ends of pushes, summaries of kinds |
//! | `step` | the phases of a step over sets of values |
//! | `fixpoint` | the iteration, with initial states and narrowing |
//! | `flights` | players told apart by the courses of their falls, within the result of the iteration |
//! | `membership` | fast membership test of a state, which searches apply to every state |
//! | `travel_bound` | how far an instance gets in a number of steps |
//! | `varied` | the analysis for all values of some parameters at once |
//! | `findings` | the findings that `check` reports |
//!
//! # The phases of a step
//!
//! The analysis follows the order of the simulator's phases. Each row relates a phase to its abstraction and names the
//! tests that compare the two, in addition to the random runs of `tests/analysis.rs`, the harness in `tests/soundness`
//! and the interpreter in `tests/oracle`, which cover all of them.
//!
//! | simulator | here | distinguished or given up | tests |
//! |---|---|---|---|
//! | `Simulator::initial`: contacts are found, nothing is pushed | `begin`: the first positions are places of contacts | what begins inside of something is pushed anywhere beside it | `found/*initial*`, `*slight*` |
//! | input: buttons, axes | `Reader::truth`, `Reader::number`: anything, if there is a player | – | oracle, exhaustive |
//! | discrete: `decide`, edges in order, first guard that holds | `Stepper::choices`: refined by each guard in turn | others are read as the step began (`Phase::Discrete`) | `verdicts/*` |
//! | discrete: `take`, entries, updates, timers restart | `Stepper::take`, `enter`, `act` | ways of groups are joined beyond 512 | `found.rs` |
//! | `apply_changes`: destroy, spawn | `outcome.can_end`, `spawn`: parameters are part of what a spawned instance can be | which slot is taken is not known | `found/spawnchain*`, `pair`, `home` |
//! | what dies is read until the step ends | `MidStep`: what the discrete phase makes of it, modes included | – | `found/*dying*` |
//! | `apply_changes`: links | `Stepper::through_link` | – | `tests/border.rs`, `found.rs` |
//! | continuous: flows, envelopes, clamps | `flow`: contacts are those of the last collision (`Phase::Continuous`) | of others, all they are within a step | `found/*stale*`, `*clamp*` |
//! | `carry` | `Surroundings::collide`: near what carries it, moved by as much, carriers of carriers included | positions of the two are not related | `tests/semantics.rs`, oracle |
//! | contacts, where everything is before pushes | `Overall::contact`, `places` | – | `found/false-pushed-pusher` |
//! | pushes: along an axis the deepest counts | `Contacts::push_out`: it ends at an edge of what it meets; `Contacts::pushed`, where falls are told apart: each edge by itself | instances that move and push (`kind_summary`); colliders that appear inside of something (`Stepper::activations`); overlaps; gaps a little too narrow: anywhere beside it | `found/false-opposite-pushes`, `verdicts/slit*` |
//! | velocities into surfaces become 0 | the same, beside the old one | energies: only of what never moves | `found/false-clamped*` |
//! | `remove_destroyed`: references become none | references may always be none | – | oracle |
//! | observation: `never`, then written bounds, then `goal` | `forbidden`, `within_bounds`, `can_evaluate_to` | – | `tests/border.rs` |

mod domain;
mod findings;
mod fixpoint;
mod flights;
mod geometry;
mod membership;
mod never;
mod step;
mod travel_bound;
mod varied;

pub use domain::configuration::{Configuration, Numbers};
pub use domain::values::{Interval, Values};
pub use domain::wording;
pub use findings::{InvariantVerdict, Spaces, findings, invariants, watched_findings};
pub use membership::{Beyond, Membership, Outside, Reading};
pub use never::{Part, Quantity, never_holds};
pub use varied::{ParamRange, Varied};

use std::sync::Arc;

use crate::ir::{ExprId, GoalId, IdVec, Program, SlotId, World, WorldId};

use crate::watch::{Unwatched, Watch};

use domain::configuration::Overall;
use domain::received::Received;
use domain::unknown::{KNOWN, Unknown};
use fixpoint::Analysis;
use fixpoint::counter_bounds::{self, Limits};
use geometry::breakable;
use geometry::scene::Scene;
use geometry::surroundings::Surroundings;
use step::evaluate::{Joined, Phase, Pinned, Reader};
use step::forbidden::Forbidden;

/// Maximum number of branches, if players are distinguished by place.
const MAX_BRANCHES_BY_PLACE: usize = 60_000;

/// Maximum number of branches of steps per world; above it, the world is given up and everything is possible.
const MAX_BRANCHES: usize = 300_000;

/// Why a slot was given up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GivenUp {
    /// There are too many combinations of leaves, or too many ways of a step.
    Combinations,
    /// The analysis takes too many steps.
    Budget,
    /// The watch stopped it.
    Stopped,
}

impl GivenUp {
    /// The reason, as text.
    pub fn reason(self) -> String {
        match self {
            GivenUp::Combinations => format!("more than {} combinations of modes", fixpoint::MAX_CONFIGURATIONS),
            GivenUp::Budget => "the world takes too many steps to analyse".to_string(),
            GivenUp::Stopped => "the analysis was stopped".to_string(),
        }
    }
}

/// The possible states of a slot.
#[derive(Debug, Clone)]
pub struct SlotSpace {
    /// The configurations of its instance, one per combination of leaves and cell; empty if there never is an instance.
    pub configurations: Vec<Configuration>,
    /// Whether the slot can be empty.
    pub can_be_absent: bool,
    /// Whether the analysis gave up, so that everything is possible.
    pub is_given_up: bool,
    /// The reason, if given up.
    pub why: Option<GivenUp>,
}

/// The possible states of a world.
#[derive(Debug, Clone)]
pub struct ConfigurationSpace {
    /// The possible states of each slot.
    pub slots: IdVec<SlotId, SlotSpace>,
    overall: IdVec<SlotId, Overall>,
    joined: Joined,
    surroundings: Surroundings,
    received: Received,
    /// The result with players distinguished by place, if it was requested and possible.
    finer: Option<Box<ConfigurationSpace>>,
}

/// Computes the configuration space of a world.
pub fn configuration_space(program: &Program, world: WorldId) -> ConfigurationSpace {
    let world = &program.worlds[world];
    within_limits(program, world, &[], limits(program, world), &mut { MAX_BRANCHES }, &Unwatched)
}

/// As [`configuration_space`], for runs on which some predicates of the world never hold.
pub fn configuration_space_without(program: &Program, world: WorldId, predicates: &[ExprId]) -> ConfigurationSpace {
    let world = &program.worlds[world];
    within_limits(program, world, predicates, limits(program, world), &mut { MAX_BRANCHES }, &Unwatched)
}

/// As [`configuration_space_without`]; if the watch stops it, everything is possible.
pub fn watched_space(
    program: &Program,
    world: WorldId,
    predicates: &[ExprId],
    watch: &dyn Watch,
) -> ConfigurationSpace {
    let world = &program.worlds[world];
    within_limits(program, world, predicates, limits(program, world), &mut { MAX_BRANCHES }, watch)
}

/// A copy of the program in which only a fault ends a run of the world: it has no `bounds` (what repeats between them
/// still does), and an analysis without
/// predicates ignores `never`. It reaches every state that the original reaches, including the state in which a run
/// ends.
pub fn endless(program: &Program, world: WorldId) -> Program {
    let mut endless = program.clone();
    Arc::make_mut(&mut endless.worlds[world]).spaces.iter_mut().for_each(|space| space.bounds = None);
    endless
}

/// As [`configuration_space`], but without bounds on counters of things to pick up: these depend on the level. Takes
/// its work from `effort`; a world that needs more is given up. The world need not be one of the program's, but must
/// use its entities.
fn without_counter_bounds(
    program: &Program,
    world: &World,
    effort: &mut usize,
    watch: &dyn Watch,
) -> ConfigurationSpace {
    within_limits(program, world, &[], (counter_bounds::ranges(program, world), &KNOWN), effort, watch)
}

/// The bounds of counters of a world of which all is known.
fn limits(program: &Program, world: &World) -> (Limits, &'static Unknown) {
    (counter_bounds::limits(program, world), &KNOWN)
}

fn within_limits(
    program: &Program,
    world: &World,
    predicates: &[ExprId],
    limits: (Limits, &Unknown),
    effort: &mut usize,
    watch: &dyn Watch,
) -> ConfigurationSpace {
    let world = &*breakable::prepared(program, world);
    let forbidden = Forbidden { program, world, predicates };
    let scene = Scene::new(program, world, watch);
    let mut analysis = Analysis::new(scene, forbidden, limits, *effort, watch);
    analysis.run();
    *effort = analysis.effort;
    analysis.finish()
}

/// Says yes so many times.
pub fn at_most(mut times: usize) -> impl FnMut() -> bool {
    move || {
        let is_left = times > 0;
        times = times.saturating_sub(1);
        is_left
    }
}

impl ConfigurationSpace {
    /// Adds a second analysis that distinguishes players by place, for runs on which the predicates never hold; it
    /// shows what they cannot reach step by step. Nothing changes if no player can be distinguished, or if there is too
    /// much to examine.
    #[must_use]
    pub fn by_place(self, program: &Program, world: WorldId, predicates: &[ExprId], watch: &dyn Watch) -> Self {
        self.varied_by_place(program, world, predicates, &KNOWN, watch)
    }

    fn varied_by_place(
        mut self,
        program: &Program,
        world: WorldId,
        predicates: &[ExprId],
        unknown: &Unknown,
        watch: &dyn Watch,
    ) -> Self {
        let table = &*breakable::prepared(program, &program.worlds[world]);
        let mut scene = Scene::new(program, table, watch);
        if scene.refine() {
            let forbidden = Forbidden { program, world: table, predicates };
            let limits = counter_bounds::limits(program, table);
            let mut analysis = Analysis::new(scene, forbidden, (limits, unknown), MAX_BRANCHES_BY_PLACE, watch);
            analysis.run();
            let finer = analysis.finish();
            let is_known = finer.slots.iter().all(|s| !s.is_given_up);
            self.finer = is_known.then(|| Box::new(finer));
        }
        self
    }

    /// Adds a second analysis that tells players apart by the courses of their falls (`flights`), for runs on which the
    /// predicates never hold. `goes_on` is asked before each configuration. Nothing changes if it says no, or if that is not
    /// possible.
    #[must_use]
    pub fn by_flight(
        mut self,
        program: &Program,
        world: WorldId,
        predicates: &[ExprId],
        goes_on: &mut dyn FnMut() -> bool,
        watch: &dyn Watch,
    ) -> Self {
        let table = &*breakable::prepared(program, &program.worlds[world]);
        let forbidden = Forbidden { program, world: table, predicates };
        let limits = (counter_bounds::limits(program, table), &KNOWN);
        let mut analysis = Analysis::new(Scene::new(program, table, watch), forbidden, limits, MAX_BRANCHES, watch);
        analysis.run();
        let Some(found) = analysis.by_flight(goes_on) else { return self };
        let mut finer = analysis.finish();
        for (slot, configurations) in found {
            finer.slots[slot].configurations = configurations;
        }
        finer.finer = self.finer.take();
        self.finer = Some(Box::new(finer));
        self
    }

    /// The most precise result.
    pub fn finest(&self) -> &ConfigurationSpace {
        self.finer.as_deref().unwrap_or(self)
    }

    /// Whether a goal can hold in some state; if not, it is proven unreachable.
    pub fn can_hold(&self, program: &Program, world: WorldId, goal: GoalId) -> bool {
        self.can_evaluate_to(program, world, program.worlds[world].goals[goal].holds, true)
    }

    /// Whether a predicate of the world, or a part of one, can hold (or fail) in some state.
    pub fn can_evaluate_to(&self, program: &Program, world: WorldId, predicate: ExprId, holds: bool) -> bool {
        let table = &program.worlds[world];
        if self.finer.as_ref().is_some_and(|f| !f.can_evaluate_to(program, world, predicate, holds)) {
            return false;
        }
        let reader = self.reader(program, table, None);
        let can = |reader: &Reader<'_>| {
            let truth = reader.truth(predicate);
            if holds { truth.can_hold } else { truth.can_fail }
        };
        // A player that is kept out of obstacles is in some box of its region.
        let in_parts = |slot: SlotId| {
            let regions = self.surroundings.regions(slot);
            let mut parts = regions.iter().flat_map(|(space, region)| region.boxes().iter().map(move |b| (*space, *b)));
            let absent = self.overall[slot].can_be_absent;
            let at = |at| can(&Reader { pinned: Some((slot, Pinned::At(at))), ..reader });
            regions.is_empty()
                || absent
                || parts.any(|(space, part)| can(&Reader { pinned: Some((slot, Pinned::Part(space, part))), ..reader }))
                || self.not_kept_out(slot).any(at)
        };
        // A player is in one of its configurations.
        let in_configurations = |slot: SlotId| {
            let SlotSpace { configurations, can_be_absent, is_given_up, .. } = &self.slots[slot];
            let at = |at| can(&Reader { pinned: Some((slot, Pinned::At(at))), ..reader });
            *can_be_absent || *is_given_up || configurations.iter().any(at)
        };
        let players = || table.players.iter().map(|p| p.slot);
        can(&reader) && players().all(in_parts) && players().all(in_configurations)
    }

    /// The configurations in which nothing keeps an instance out of obstacles.
    fn not_kept_out(&self, slot: SlotId) -> impl Iterator<Item = &Configuration> {
        let cover = self.surroundings.kept_out(slot);
        let is_not_kept_out = |at: &&Configuration| !cover.holds_for(&at.leaves);
        self.slots[slot].configurations.iter().filter(is_not_kept_out)
    }

    /// The context in which expressions of an instance in a configuration, or of the world, are evaluated.
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
            received: &self.received,
            pinned: None,
            me,
            tested: None,
            member: None,
            phase: Phase::Discrete,
        }
    }
}
