//! The abstract step of an instance: edges, updates and links here, the continuous phase in `flow`. Each function
//! over-approximates a phase of the simulator.

pub(in crate::analysis) mod evaluate;
pub(in crate::analysis) mod flow;
pub(in crate::analysis) mod forbidden;
mod members;
mod probe;
pub(in crate::analysis) mod refine;

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::ir::{
    Actions, Arithmetic, EdgeId, Entity, Expr, ExprId, Function, GroupId, Id, IdVec, LeafId, Link, ModeId, Place,
    RefValue, SendId, SlotId, SpaceId, SpawnId, Subject, Transition, Update, VarId,
};

use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::{Interval, Values};
use crate::analysis::geometry::body::Body;
use crate::analysis::geometry::grid::Grid;
use crate::analysis::geometry::placement::{PlacedColliders, Placement};
use crate::analysis::geometry::scene::Scene;
use crate::analysis::step::evaluate::{Phase, Reader};

/// Maximum number of branches of a step.
const MAX_BRANCHES: usize = 512;

/// The possible results of a step.
#[derive(Debug, Default)]
pub(in crate::analysis) struct Outcome {
    pub next: Vec<Configuration>,
    /// Spawns, with the configurations of the spawner.
    pub spawns: Vec<(SpawnId, Configuration)>,
    /// Signals that are sent, with the values of their numbers.
    pub sends: Vec<(SendId, Interval)>,
    /// Whether the instance can be destroyed.
    pub can_end: bool,
    /// Whether a collider that is never pushed can be switched on.
    pub appears: bool,
    /// Combinations of leaves that switch a collider on.
    pub activated: Vec<Arc<[LeafId]>>,
    /// Per axis, the maximum speed before collisions, px/s.
    pub speed: [f64; 2],
    /// The same for steps that end near static obstacles.
    pub near_speed: [f64; 2],
    /// The results of the discrete phase that differ from the start of the step.
    pub mid_step: Vec<Configuration>,
    /// Position when contacts are detected, px.
    pub contact: [Values; 2],
    /// Positions set by updates and links.
    pub placements: Vec<Placement>,
    /// The spaces to which links lead it.
    pub spaces: BTreeSet<SpaceId>,
}

/// Results of the continuous phase by configuration.
pub(in crate::analysis) type FlowCache = Vec<(Configuration, Vec<Configuration>)>;

/// The abstract step of one slot.
pub(in crate::analysis) struct Stepper<'a> {
    pub reader: Reader<'a>,
    pub scene: &'a Scene<'a>,
    pub slot: SlotId,
    /// s
    pub step: f64,
    /// The groups whose leaves determine the flows; `None` if they also depend on time.
    pub flow_groups: Option<&'a [bool]>,
    /// The groups whose leaves determine which colliders are pushed, if that matters.
    pub collider_groups: Option<&'a [bool]>,
    /// The edges whose effect depends on position or motion.
    pub motion_edges: &'a IdVec<EdgeId, bool>,
    /// If pushes are told apart: the cells of each space.
    pub grids: Option<&'a [Grid]>,
}

/// The start of the continuous phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::analysis) struct Beginning {
    /// Displacement by updates since contacts were detected, px.
    pub displacement: [Interval; 2],
    /// Whether updates or a link have moved the instance.
    pub is_put: bool,
}

/// One choice of edges for the groups decided so far, and the refined configuration.
type Branch = (Vec<Option<EdgeId>>, Configuration);

impl<'a> Stepper<'a> {
    pub fn entity(&self) -> &'a Entity {
        &self.reader.program.entities[self.reader.world.slots[self.slot].entity]
    }

    pub fn at<'c>(&self, from: &'c Configuration) -> Reader<'c>
    where
        'a: 'c,
    {
        Reader { me: Some((self.slot, from)), ..self.reader }
    }

    /// The context of the continuous phase.
    pub fn flowing_at<'c>(&self, from: &'c Configuration, is_put: bool) -> Reader<'c>
    where
        'a: 'c,
    {
        Reader { phase: Phase::Continuous { is_put }, ..self.at(from) }
    }

    /// All successors of a configuration; `None` if there are too many branches.
    pub fn run(&self, from: &Configuration) -> Option<Outcome> {
        self.explore_branches(from, false)
    }

    /// The successors with the same leaves; `None` if there are too many branches.
    pub fn run_on(&self, from: &Configuration) -> Option<Outcome> {
        let mut outcome = self.explore_branches(from, true)?;
        outcome.next.retain(|next| next.leaves == from.leaves);
        Some(outcome)
    }

    fn explore_branches(&self, from: &Configuration, stays: bool) -> Option<Outcome> {
        let entity = self.entity();
        let mut branches: Vec<Branch> = vec![(Vec::new(), from.clone())];
        for group in entity.groups.ids() {
            let mut next = Vec::new();
            for (taken, at) in branches {
                self.choices(group, &taken, &at, stays, &mut next);
            }
            branches = next;
            if branches.len() > MAX_BRANCHES {
                return None;
            }
        }
        let mut outcome = Outcome::default();
        let mut flow_cache = FlowCache::new();
        for (taken, at) in branches {
            self.take(&taken, &at, &mut flow_cache, &mut outcome);
        }
        outcome.next.retain(|c| !c.is_impossible());
        Some(outcome)
    }

    /// The choices of a group: take one of its edges, or none. With `stays`, edges that leave the leaf are skipped.
    fn choices(
        &self,
        group: GroupId,
        taken: &[Option<EdgeId>],
        from: &Configuration,
        stays: bool,
        out: &mut Vec<Branch>,
    ) {
        let entity = self.entity();
        let leaf = from.leaves[group.index()];
        let with = |edge| taken.iter().copied().chain([edge]).collect::<Vec<_>>();
        let mut rest = from.clone();
        for &edge in &entity.leaves[leaf].edges {
            let guard = entity.edges[edge].guard;
            let target = entity.edges[edge].target;
            let leads_off = || target.is_some_and(|t| !self.entered(t, &rest).contains(&leaf));
            let held = if stays && leads_off() { None } else { self.at(&rest).refined(&rest, guard, true) };
            if let Some(mut held) = held {
                // An edge without effect on motion need not split the variables.
                if !self.motion_edges[edge] && held.discretes == rest.discretes {
                    held.numbers = Arc::clone(&rest.numbers);
                }
                out.push((with(Some(edge)), held));
            }
            if !self.at(from).refine(&mut rest, guard, false) {
                return;
            }
        }
        out.push((with(None), rest));
    }

    /// Runs the chosen edges, then the rest of the step.
    fn take(&self, taken: &[Option<EdgeId>], at: &Configuration, flow_cache: &mut FlowCache, outcome: &mut Outcome) {
        let entity = self.entity();
        let mut nexts = vec![at.clone()];
        let mut ends = false;
        let (mut links, mut put) = (Vec::new(), [false; 2]);
        for (group, edge) in entity.groups.ids().zip(taken) {
            let from = at.leaves[group.index()];
            for &internal in &entity.leaves[from].internal {
                let internal = &entity.edges[internal];
                if let Some(held) = self.at(at).refined(at, internal.guard, true) {
                    let sure = internal.needs.is_empty() && !self.at(at).truth(internal.guard).can_fail;
                    for next in &mut nexts {
                        let mut changed = next.clone();
                        self.act(Some(internal.guard), &internal.actions, &held, &mut changed, outcome);
                        mark_set_axes(&internal.actions, &mut put);
                        *next = if sure { changed } else { next.or(&changed) };
                    }
                }
            }
            if let Some(edge) = edge {
                let edge = &entity.edges[*edge];
                let Some(target) = edge.target else { continue };
                mark_set_axes(&edge.actions, &mut put);
                let entries = entity.modes.iter().map(|m| &m.entry).filter(|e| !e.updates.is_empty());
                entries.for_each(|e| mark_set_axes(e, &mut put));
                let mut entered = Vec::new();
                for leaf in self.entered(target, at) {
                    for next in &nexts {
                        let mut next = next.clone();
                        self.enter(Transition { group, from, target, to: leaf }, at, &mut next, outcome);
                        ends |= self.act(Some(edge.guard), &edge.actions, at, &mut next, outcome);
                        entered.push(next);
                    }
                }
                nexts = entered;
            }
            for &follow in &entity.leaves[from].follows {
                let follow = &entity.follows[follow];
                let held = match follow.guard {
                    Some(guard) => self.at(at).refined(at, guard, true),
                    None => Some(at.clone()),
                };
                let Some(held) = held else { continue };
                let open = self.open_links(&held);
                if open.is_empty() {
                    continue;
                }
                for next in &mut nexts {
                    let mut changed = next.clone();
                    self.act(follow.guard, &follow.actions, &held, &mut changed, outcome);
                    mark_set_axes(&follow.actions, &mut put);
                    *next = next.or(&changed);
                }
                links.extend(open);
            }
        }
        // Links apply after all updates.
        let is_kept_out = self.is_kept_out(at);
        let moved: Vec<Configuration> = nexts
            .iter()
            .flat_map(|next| links.iter().map(|link| self.through_link(*link, next, put, is_kept_out)))
            .collect();
        outcome.placements.extend(moved.iter().filter_map(Placement::of));
        outcome.spaces.extend(moved.iter().flat_map(|next| next.spaces.iter()));
        let is_put = put != [false; 2];
        let displacement = |next: &Configuration| {
            [0, 1].map(|axis| if put[axis as usize] { shift(at, next, VarId(axis)) } else { Interval::point(0.0) })
        };
        let mut nexts: Vec<_> =
            nexts.into_iter().map(|next| (Beginning { displacement: displacement(&next), is_put }, next)).collect();
        // The carrier stays behind.
        let linked = Beginning { displacement: [Interval::point(0.0); 2], is_put: true };
        nexts.extend(moved.into_iter().map(|next| (linked, next)));
        // Others read it in this step even if it is destroyed.
        let changed = nexts.iter().filter(|(_, next)| !next.shares(at) || next.leaves != at.leaves);
        outcome.mid_step.extend(changed.map(|(_, next)| next.clone()));
        outcome.can_end |= ends;
        if ends {
            return;
        }
        for (beginning, next) in nexts {
            let mut moved = self.cached_flow(&next, beginning, flow_cache, outcome);
            for moved in &mut moved {
                moved.leaves.clone_from(&next.leaves);
                moved.timers = self.time(&next);
            }
            self.activations(at, &next.leaves, &moved, outcome);
            outcome.next.extend(moved);
        }
    }

    /// A collider that is switched on can overlap an obstacle, at the old position as well as at the new one, as
    /// contacts on the way can push the instance. This counts even if the step has no result (`moved` is empty) or an
    /// impossible one: facts about pushes hold only for the colliders and positions that are registered here.
    fn activations(&self, from: &Configuration, leaves: &[LeafId], moved: &[Configuration], outcome: &mut Outcome) {
        let kind = &self.scene.kinds[self.scene.of[self.slot]];
        for (collider, body) in self.entity().colliders.ids().zip(&kind.bodies) {
            let Some(presence) = &body.presence else { continue };
            if presence.is_there(&from.leaves) || !presence.is_there(leaves) {
                continue;
            }
            if !body.is_live {
                outcome.activated.push(leaves.into());
            }
            if body.kinematic {
                outcome.appears = true;
                continue;
            }
            let was_unblocked = !kind.kept_out_while().holds_for(&from.leaves);
            let colliders = PlacedColliders::One { collider, was_unblocked };
            // If nothing else has pushed it on the way, it has moved into obstacles no further than any body.
            let stays = |body: &Body| {
                let is_there = |leaves: &[LeafId]| body.presence.as_ref().is_none_or(|p| p.is_there(leaves));
                body.is_pushed && is_there(&from.leaves) && is_there(leaves)
            };
            let moved = if kind.bodies.iter().any(stays) { moved } else { &[] };
            let at = std::iter::once(from).chain(moved).filter_map(Placement::of);
            outcome.placements.extend(at.map(|l| Placement { colliders: colliders.clone(), ..l }));
        }
    }

    /// The possible leaves when a mode is entered.
    fn entered(&self, mode: ModeId, at: &Configuration) -> Vec<LeafId> {
        let modes = &self.entity().modes;
        let mut open = vec![mode];
        let mut found = Vec::new();
        while let Some(mode) = open.pop() {
            let m = &modes[mode];
            let Some(inner) = m.inner.filter(|_| m.chooses) else {
                found.push(m.initial);
                continue;
            };
            let mut otherwise = true;
            for choice in &m.choices {
                let truth = self.at(at).truth(choice.guard);
                if truth.can_hold {
                    open.push(choice.mode);
                }
                if !truth.can_fail {
                    otherwise = false;
                    break;
                }
            }
            if otherwise {
                open.push(inner);
            }
        }
        found
    }

    /// Takes a transition: timers restart, entry actions run.
    fn enter(&self, transition: Transition, at: &Configuration, next: &mut Configuration, outcome: &mut Outcome) {
        let entity = self.entity();
        Arc::make_mut(&mut next.leaves)[transition.group.index()] = transition.to;
        for timer in transition.resets(entity) {
            next.timers[timer] = Interval::point(0.0);
        }
        for mode in transition.entered(entity) {
            self.act(None, &entity.modes[mode].entry, at, next, outcome);
        }
    }

    /// Runs an action list on a guard; returns whether the instance is certainly destroyed.
    fn act(
        &self,
        guard: Option<ExprId>,
        actions: &Actions,
        at: &Configuration,
        next: &mut Configuration,
        outcome: &mut Outcome,
    ) -> bool {
        let tested = guard.and_then(|guard| self.reader.program.tested(guard));
        for update in &actions.updates {
            self.update(update, &Reader { tested, ..self.at(at) }, at, next);
        }
        if actions.updates.iter().any(|u| matches!(u.place, Place::Var(VarId::X | VarId::Y, 0))) {
            outcome.placements.extend(Placement::of(next));
        }
        for &spawn in &actions.spawns {
            let at = at.or(next);
            match outcome.spawns.iter_mut().find(|(known, _)| *known == spawn) {
                Some((_, known)) => *known = known.or(&at),
                None => outcome.spawns.push((spawn, at)),
            }
        }
        for &send in &actions.sends {
            let reader = Reader { tested, ..self.at(at) };
            let value = self.entity().sends[send].value.and_then(|value| reader.number(value).hull());
            outcome.sends.push((send, value.unwrap_or(Interval::point(0.0))));
        }
        let ends = actions.destroys.contains(&RefValue::Of(Subject::Me));
        outcome.can_end |= ends;
        ends
    }

    fn update(&self, update: &Update, reader: &Reader<'_>, at: &Configuration, next: &mut Configuration) {
        let value = reader.number(update.value);
        match update.place {
            Place::Var(var, degree) => {
                let energy = next.energy[var].zip(next.vars[var][0].hull());
                let energy = energy.filter(|_| degree == 1 && self.slows(update.value, var, at));
                next.set(var, usize::from(degree), value);
                next.forget_energy(var);
                if let Some(trace) = next.trace.as_mut().filter(|_| var == VarId::Y) {
                    trace.is_disturbed |= !(degree == 1 && self.slows(update.value, var, at));
                }
                if let Some(((fall, energy), position)) = energy {
                    next.set_energy(var, (fall, fall.slowed(energy, position)));
                }
            }
            // A value out of range is a fault, which ends the run.
            Place::Discrete(id) => next.set_discrete(id, value.and(&Values::range(self.entity().discretes[id].range))),
            Place::Ref(_) => {}
        }
    }

    /// Whether a number always lies between 0 and the velocity of a variable, as when a jump is cut short.
    fn slows(&self, value: ExprId, var: VarId, at: &Configuration) -> bool {
        let slows = |id| self.slows(id, var, at);
        let within =
            |id, low: f64, high: f64| self.at(at).number(id).hull().is_some_and(|of| low <= of.low && of.high <= high);
        match self.reader.program.exprs[value] {
            Expr::Number(number) => number == 0.0,
            Expr::Var(Subject::Me, of, 1) => of == var,
            Expr::Arithmetic(Arithmetic::Multiply, a, b) => {
                (slows(a) && within(b, 0.0, 1.0)) || (slows(b) && within(a, 0.0, 1.0))
            }
            Expr::Arithmetic(Arithmetic::Divide, a, b) => slows(a) && within(b, 1.0, f64::INFINITY),
            Expr::Call(Function::Min, [a, b, _]) => {
                let cuts = |a, b| slows(a) && (slows(b) || within(b, 0.0, f64::INFINITY));
                cuts(a, b) || cuts(b, a)
            }
            Expr::Call(Function::Max, [a, b, _]) => {
                let cuts = |a, b| slows(a) && (slows(b) || within(b, f64::NEG_INFINITY, 0.0));
                cuts(a, b) || cuts(b, a)
            }
            Expr::Call(Function::Clamp, [a, low, high]) => {
                slows(a) && within(low, f64::NEG_INFINITY, 0.0) && within(high, 0.0, f64::INFINITY)
            }
            Expr::Call(Function::If, [_, a, b]) => slows(a) && slows(b),
            _ => false,
        }
    }

    /// The links that the instance can be in and that can be open, with their spaces.
    fn open_links(&self, at: &Configuration) -> Vec<(SpaceId, &'a Link)> {
        // The guards of links read the instances of the world.
        let world_reader = Reader { me: None, ..self.reader };
        let links = at.spaces.iter().flat_map(|&s| self.reader.world.spaces[s].links.iter().map(move |l| (s, l)));
        let open = |(space, link): &(SpaceId, &Link)| {
            let [x, y] = self.link_overlap(*space, link, at, self.is_kept_out(at));
            !x.is_none() && !y.is_none() && link.guard.is_none_or(|g| world_reader.truth(g).can_hold)
        };
        links.filter(open).collect()
    }

    /// Whether the instance is kept out of blocking obstacles.
    fn is_kept_out(&self, at: &Configuration) -> bool {
        self.reader.surroundings.is_kept_out(self.slot, &at.leaves)
    }

    /// The positions of the instance inside a link.
    fn link_overlap(&self, space: SpaceId, link: &Link, at: &Configuration, is_kept_out: bool) -> [Values; 2] {
        let from = &link.from;
        let axis = |axis: u32, low: f64, high: f64| at.vars[VarId(axis)][0].within(Interval { low, high });
        let (x, y) = (axis(0, from.left, from.right), axis(1, from.bottom, from.top));
        if is_kept_out { self.reader.surroundings.within_region(self.slot, space, &x, &y) } else { [x, y] }
    }

    /// The configuration after a link; `put` tells which coordinates updates may have set since it was inside.
    fn through_link(
        &self,
        (space, link): (SpaceId, &Link),
        next: &Configuration,
        put: [bool; 2],
        is_kept_out: bool,
    ) -> Configuration {
        let mut out = next.clone();
        out.spaces = Arc::new([link.space].into());
        out.trace = None;
        let (from, to) = (link.from, link.to);
        let link_overlap = match put {
            [false, false] => self.link_overlap(space, link, next, is_kept_out),
            _ => [(from.left, from.right), (from.bottom, from.top)].map(|(low, high)| Interval { low, high }.into()),
        };
        let axes = [((from.left, from.right), (to.left, to.right)), ((from.bottom, from.top), (to.bottom, to.top))];
        for (axis, (from, to)) in (0..).zip(axes) {
            let var = VarId::XY[axis];
            let position = out.vars[var][0];
            let values = if put[axis] { position } else { position.and(&link_overlap[axis]) };
            out.vars[var][0] = values.map(|i| i.map(|x| to.0 + (to.1 - to.0) * (x - from.0) / (from.1 - from.0)));
            out.forget_energy(var);
        }
        out
    }
}

/// Marks the coordinates that updates set.
fn mark_set_axes(actions: &Actions, put: &mut [bool; 2]) {
    for update in &actions.updates {
        if let Place::Var(var @ (VarId::X | VarId::Y), 0) = update.place {
            put[var.index()] = true;
        }
    }
}

/// The possible differences of a variable between two configurations.
pub(in crate::analysis) fn shift(from: &Configuration, to: &Configuration, var: VarId) -> Interval {
    let hulls = from.vars[var][0].hull().zip(to.vars[var][0].hull());
    hulls.map_or(Interval::point(0.0), |(from, to)| to.minus(from))
}
