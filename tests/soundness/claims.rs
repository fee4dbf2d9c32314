//! The claims of the analysis about a world, and whether a state contradicts them.

use hypedc::analysis::{
    ConfigurationSpace, InvariantVerdict, Spaces, at_most, invariants, watched_findings, watched_space,
};
use hypedc::compile::Compilation;
use hypedc::diagnostic::{Code, Diagnostics};
use hypedc::ir::{Domain, EntityId, ExprId, GoalId, ModeId, NeverId, Program, World, WorldId};
use hypedc::reach::Monitor;
use hypedc::sim::{Input, Simulator};
use hypedc::source::{FileId, Span};

use super::eye::{Eye, Nobody};
use super::outside::outside;
use super::poll_limit::PollLimit;

/// A state or an event that is claimed to be impossible, and occurred.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Violation {
    /// The kind of the false claim; usually the same for the same bug.
    pub class: String,
    pub what: String,
}

impl Violation {
    pub fn new(class: &str, what: String) -> Self {
        Violation { class: class.into(), what }
    }
}

/// Which assumptions of the analysis a run still satisfies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StateStatus {
    /// No player has left its bounds.
    pub is_inside: bool,
    /// No `never` has held.
    pub is_allowed: bool,
}

fn poll_limit() -> PollLimit {
    PollLimit::new(MAX_POLLS)
}

/// Number of polls after which the analysis of a world is stopped.
const MAX_POLLS: u32 = 250;

fn findings_of(compilation: &Compilation, program: &Program) -> Option<(Diagnostics, Spaces)> {
    watched_findings(program, &compilation.sources, FileId(0), &compilation.diagnostics, &poll_limit())
}

fn is_given_up(space: &ConfigurationSpace) -> bool {
    space.slots.iter().any(|s| s.is_given_up)
}

/// Whether `check` looks at the very same world, so that it need not be looked at twice: it looks without bounds, with a
/// player for all who read inputs, and with any number of things to be picked up.
fn is_free(program: &Program, world: &World) -> bool {
    let is_played = |e: EntityId| program.entities[e].buttons.is_empty() && program.entities[e].axes.is_empty();
    let counts = |e: EntityId| program.entities[e].discretes.iter().any(|d| matches!(d.domain, Domain::Int));
    world.open.is_none()
        && program.worlds.len() == 1
        && world.spaces.iter().all(|s| s.bounds.is_none())
        && world.slots.iter().all(|s| (s.player.is_some() || is_played(s.entity)) && !counts(s.entity))
}

/// All claims about a world.
pub struct Claims {
    pub space: ConfigurationSpace,
    guard: Monitor,
    /// Claims about runs on which no `never` holds, if there is any.
    guard_within: Option<Monitor>,
    goals: Vec<GoalId>,
    goals_within: Vec<GoalId>,
    nevers: Vec<NeverId>,
    invariants: Vec<(EntityId, usize)>,
    /// Claims of `check`, about runs that continue whatever happens.
    silent: Vec<(EntityId, usize)>,
    modes: Vec<(EntityId, ModeId)>,
    guards: Vec<GuardClaim>,
}

/// A guard, or a part of one, that is claimed never or always to hold.
struct GuardClaim {
    entity: EntityId,
    part: ExprId,
    /// The leaf in which it is evaluated.
    leaves: Vec<hypedc::ir::LeafId>,
    holds: bool,
}

impl Claims {
    pub fn of(compilation: &Compilation, program: &Program, world: WorldId) -> Self {
        let table = &program.worlds[world];
        let by_place = |space: ConfigurationSpace, predicates: &[ExprId]| match is_given_up(&space) {
            true => space,
            false => space.by_place(program, world, predicates, &poll_limit()).by_flight(
                program,
                world,
                predicates,
                &mut at_most(10_000),
                &poll_limit(),
            ),
        };
        let free = is_free(program, table);
        let mut said = None;
        let space = match free {
            true => {
                said = findings_of(compilation, program);
                let spaces = said.as_mut().map(|(_, spaces)| spaces);
                spaces.and_then(|spaces| spaces.remove(&world))
            }
            false => None,
        };
        let space = space.unwrap_or_else(|| watched_space(program, world, &[], &poll_limit()));
        let is_known = !is_given_up(&space);
        let space = by_place(space, &[]);
        if is_known && !free {
            said = findings_of(compilation, program);
        }
        let nevers: Vec<ExprId> = table.nevers.iter().map(|n| n.holds).collect();
        let within = || by_place(watched_space(program, world, &nevers, &poll_limit()), &nevers);
        let within = (is_known && !nevers.is_empty()).then(within);
        let unreachable = |space: &ConfigurationSpace| -> Vec<GoalId> {
            table.goals.ids().filter(|g| !space.can_hold(program, world, *g)).collect()
        };
        let proven = invariants(program, world, &space).into_iter();
        let mut claims = Claims {
            goals: unreachable(&space),
            goals_within: within.as_ref().map(unreachable).unwrap_or_default(),
            nevers: table
                .nevers
                .pairs()
                .filter(|(_, n)| !space.can_evaluate_to(program, world, n.holds, true))
                .map(|(id, _)| id)
                .collect(),
            invariants: proven.filter(|(.., v)| *v == InvariantVerdict::Proven).map(|(e, i, _)| (e, i)).collect(),
            guard: Monitor::new(&space, program, world),
            guard_within: within.as_ref().map(|within| Monitor::new(within, program, world)),
            space,
            silent: Vec::new(),
            modes: Vec::new(),
            guards: Vec::new(),
        };
        if let Some((found, _)) = said {
            claims.check(&found, program, world);
        }
        claims
    }

    /// Whether some slot was given up.
    pub fn is_given_up(&self) -> bool {
        is_given_up(&self.space)
    }

    /// Whether a player is distinguished by place.
    pub fn is_by_place(&self) -> bool {
        !std::ptr::eq(self.space.finest(), &self.space)
    }

    /// Adds the claims of `hypedc check`, which also claims something by reporting nothing.
    fn check(&mut self, found: &Diagnostics, program: &Program, world: WorldId) {
        let places = |code: Code| -> Vec<(Span, bool)> {
            let all = found.iter().filter(|d| d.code == code);
            all.filter_map(|d| Some((d.primary.as_ref()?.span, d.message.ends_with("always holds")))).collect()
        };
        let modes = places(Code::ModeByValue);
        let guards = places(Code::GuardByValue);
        let mut doubted = places(Code::BrokenAtStart);
        doubted.extend(places(Code::UnprovenInvariant));
        for (id, spans) in program.spans.entities.pairs() {
            let entity = &program.entities[id];
            if program.worlds[world].slots.iter().all(|s| s.entity != id) {
                continue;
            }
            let never = spans.modes.pairs().filter(|(_, span)| modes.iter().any(|(at, _)| at == *span));
            self.modes.extend(never.map(|(mode, _)| (id, mode)));
            let silent =
                spans.invariants.iter().enumerate().filter(|(_, span)| !doubted.iter().any(|(at, _)| at == *span));
            self.silent.extend(silent.map(|(index, _)| (id, index)));
            for (edge, e) in entity.edges.pairs() {
                let leaves: Vec<_> = entity
                    .leaves
                    .pairs()
                    .filter(|(_, l)| l.edges.contains(&edge) || l.internal.contains(&edge))
                    .map(|(leaf, _)| leaf)
                    .collect();
                for part in program.with_operands(vec![e.guard]) {
                    let said = guards.iter().find(|(at, _)| *at == program.spans.exprs[part]);
                    // Only comparisons and atoms; an expression in brackets has the span of the brackets' content.
                    if let Some((_, holds)) = said {
                        let leaves = leaves.clone();
                        self.guards.push(GuardClaim { entity: id, part, leaves, holds: *holds });
                    }
                }
            }
        }
    }

    /// Number of claims.
    pub fn count(&self) -> usize {
        self.goals.len()
            + self.goals_within.len()
            + self.nevers.len()
            + self.invariants.len()
            + self.modes.len()
            + self.guards.len()
    }

    /// The ids of the goals that are proven unreachable with all inputs.
    pub fn verdicts(&self, program: &Program, world: WorldId) -> Vec<(String, bool)> {
        let table = &program.worlds[world];
        let goals = table.goals.pairs().map(|(id, g)| (g.name.clone(), self.goals.contains(&id)));
        let nevers = table.nevers.pairs().map(|(id, n)| (n.name.clone(), self.nevers.contains(&id)));
        goals.chain(nevers).collect()
    }

    /// The claim that a state contradicts, if a run of this kind reaches it.
    pub fn refuted(&self, sim: &Simulator, state: &[u8], standing: StateStatus) -> Option<Violation> {
        let (program, world) = (sim.program(), sim.world());
        if standing.is_inside {
            if let Some(what) = outside(sim, &self.guard, state) {
                return Some(Violation::new(&format!("outside: {}", class_of(&what)), what));
            }
            let holds = |goal: &&GoalId| sim.goal(state, **goal) == Ok(true);
            if let Some(goal) = self.goals.iter().find(holds) {
                return Some(Violation::new(
                    "goal",
                    format!("{} holds, which is proven never to", world.goals[*goal].name),
                ));
            }
            let holds = |never: &&NeverId| sim.holds(state, world.nevers[**never].holds) == Ok(true);
            if let Some(never) = self.nevers.iter().find(holds) {
                return Some(Violation::new(
                    "never",
                    format!("{} holds, which is proven never to", world.nevers[*never].name),
                ));
            }
            if standing.is_allowed
                && let Some(within) = &self.guard_within
            {
                if let Some(what) = outside(sim, within, state) {
                    return Some(Violation::new(&format!("outside without: {}", class_of(&what)), what));
                }
                let holds = |goal: &&GoalId| sim.goal(state, **goal) == Ok(true);
                if let Some(goal) = self.goals_within.iter().find(holds) {
                    return Some(Violation::new(
                        "goal without",
                        format!("{} holds, with no never before", world.goals[*goal].name),
                    ));
                }
            }
        }
        if let Some(what) = self.broken(sim, state, if standing.is_inside { &self.invariants } else { &[] }) {
            return Some(Violation::new("invariant", what));
        }
        if let Some(what) = self.broken(sim, state, &self.silent) {
            return Some(Violation::new("invariant of check", what));
        }
        for (slot, s) in world.slots.pairs() {
            let layout = &world.layout.slots[slot];
            let entity = &program.entities[s.entity];
            for (_, mode) in self.modes.iter().filter(|(e, _)| *e == s.entity && layout.alive(state)) {
                let m = &entity.modes[*mode];
                let leaf = layout.leaf(state, m.group);
                if m.leaves.contains(leaf) {
                    return Some(Violation::new(
                        "mode",
                        format!("{} is in {}, which is never entered", s.name, m.path),
                    ));
                }
            }
        }
        None
    }

    fn broken(&self, sim: &Simulator, state: &[u8], proven: &[(EntityId, usize)]) -> Option<String> {
        let (program, world) = (sim.program(), sim.world());
        let input = Input::nothing(world.players.len());
        for (slot, s) in world.slots.pairs().filter(|(slot, _)| world.layout.slots[*slot].alive(state)) {
            for (_, index) in proven.iter().filter(|(e, _)| *e == s.entity) {
                let eye =
                    Eye { program, world, state, input: &input, me: slot, member: None, taken: &[], notes: &Nobody };
                let holds = program.entities[s.entity].invariants[*index];
                if eye.truth(holds) == Some(false) {
                    return Some(format!("{}: its invariant {index} does not hold, which is proven", s.name));
                }
            }
        }
        None
    }

    /// The claim that a step from a state with an input contradicts.
    pub fn refuted_by_step(&self, sim: &Simulator, state: &[u8], input: &Input) -> Option<Violation> {
        let (program, world) = (sim.program(), sim.world());
        for claim in &self.guards {
            for (slot, _) in world.slots.pairs().filter(|(_, s)| s.entity == claim.entity) {
                let layout = &world.layout.slots[slot];
                let groups = &program.entities[claim.entity].groups;
                let is_asked = || groups.ids().any(|g| claim.leaves.contains(&layout.leaf(state, g)));
                if !layout.alive(state) || !is_asked() {
                    continue;
                }
                let eye = Eye { program, world, state, input, me: slot, member: None, taken: &[], notes: &Nobody };
                if eye.truth(claim.part) == Some(!claim.holds) {
                    let name = &world.slots[slot].name;
                    let verb = if claim.holds { "always" } else { "never" };
                    return Some(Violation::new(
                        "guard",
                        format!("{name}: a guard that {verb} holds turns out otherwise"),
                    ));
                }
            }
        }
        None
    }
}

/// The part of a state that is outside, without names and numbers.
fn class_of(what: &str) -> String {
    let rest = what.rsplit(": ").next().unwrap_or(what);
    match rest {
        _ if rest.contains("absent") => "absent".into(),
        _ if rest.contains("these modes") => "modes".into(),
        _ if rest.contains("timer") => "timer".into(),
        _ if rest.contains("space") => "space".into(),
        _ => rest.split(' ').next().unwrap_or("").to_string(),
    }
}
