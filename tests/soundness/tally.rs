//! Coverage of the suite: rules of the grammar in the texts, and events in the runs.

use std::cell::RefCell;
use std::collections::BTreeMap;

use hyped_grammar::{Grammar, Rule};
use hypedc::ir::{
    Actions, By, ColliderId, Domain, Drive, Expr, Id, Origin, Place, Push, RefValue, Release, Shape, SlotId, SpaceId,
    Subject, TagSet, VarId,
};
use hypedc::sim::{Fault, FaultKind, Input, Scratch, Simulator};
use pest::Parser;
use pest::iterators::Pairs;

use super::eye::{Eye, Move, Notes, by_name};

/// Counts by name.
#[derive(Default)]
pub struct Tally {
    rules: BTreeMap<String, usize>,
    events: RefCell<BTreeMap<String, usize>>,
}

impl Notes for Tally {
    fn note(&self, what: &str) {
        let mut events = self.events.borrow_mut();
        match events.get_mut(what) {
            Some(count) => *count += 1,
            None => {
                events.insert(what.to_string(), 1);
            }
        }
    }

    fn turned_out(&self, atom: &str, holds: bool) {
        self.note(&format!("{atom}: {holds}"));
    }
}

/// A body's box, px, and its slot.
struct Body {
    slot: Option<SlotId>,
    is_kinematic: bool,
    tags: TagSet,
    sides: [f64; 4],
}

impl Tally {
    /// Counts the rules that a text uses.
    pub fn read(&mut self, text: &str) {
        let Ok(pairs) = Grammar::parse(Rule::file, text) else { return };
        self.count(pairs);
    }

    fn count(&mut self, pairs: Pairs<'_, Rule>) {
        for pair in pairs {
            *self.rules.entry(format!("{:?}", pair.as_rule())).or_default() += 1;
            self.count(pair.into_inner());
        }
    }

    /// The rules of the grammar that can give a pair in a text without mistakes, each with its count.
    pub fn rules(&self) -> Vec<(String, usize)> {
        let grammar = include_str!("../../grammar/hyped.pest");
        let names = grammar.lines().filter_map(|line| {
            let (name, rest) = line.split_once('=')?;
            let name = name.trim();
            let is_rule = !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_');
            let is_silent = rest.trim_start().starts_with('_');
            (is_rule && !is_silent && !line.starts_with(' ')).then(|| name.to_string())
        });
        // What only texts with mistakes have, what stands inside of rules that are one token, and the ends of parts of a
        // text that is read part by part.
        let is_of_texts = |name: &String| {
            !["only_", "bad_", "skip", "next_", "plain_"].iter().any(|p| name.starts_with(p))
                && !name.ends_with("_head")
                && !["statement", "opening", "opening_word", "reserved"].contains(&name.as_str())
        };
        names
            .filter(is_of_texts)
            .map(|name| {
                let count = self.rules.get(&name).copied().unwrap_or(0);
                (name, count)
            })
            .collect()
    }

    /// All possible events, each with its count.
    pub fn events(&self) -> Vec<(String, usize)> {
        let events = self.events.borrow();
        let mut names: Vec<String> = EVENTS.iter().map(|e| (*e).to_string()).collect();
        names.extend(ATOMS.iter().flat_map(|a| [format!("{a}: true"), format!("{a}: false")]));
        let others: Vec<String> = events.keys().filter(|name| !names.contains(name)).cloned().collect();
        assert!(others.is_empty(), "events without a place in the table: {others:?}");
        names
            .into_iter()
            .map(|name| {
                let count = events.get(&name).copied().unwrap_or(0);
                (name, count)
            })
            .collect()
    }

    /// Records the events of a step.
    pub fn watch(&self, sim: &Simulator, before: &[u8], input: &Input, after: &[u8], scratch: &Scratch) {
        let (program, world) = (sim.program(), sim.world());
        // Whether a slot of an entity was empty and stays so: one with a name, or one that a spawn may take.
        let is_empty = |entity, is_named: bool| {
            world.slots.pairs().any(|(slot, s)| {
                let layout = &world.layout.slots[slot];
                let is_such = s.entity == entity && (s.origin == Origin::Named) == is_named;
                is_such && !layout.alive(before) && !layout.alive(after)
            })
        };
        if let Some((slot, spawn)) = sim.refused(scratch) {
            self.note("a spawn is refused");
            if is_empty(program.entities[world.slots[slot].entity].spawns[spawn].entity, false) {
                self.note("a spawn is refused beside a free slot");
            }
        }
        if sim.left_bounds(after).is_some() {
            self.note("a player leaves its bounds");
        }
        for goal in world.goals.ids() {
            self.turned_out("goal", sim.goal(after, goal) == Ok(true));
        }
        for never in world.nevers.iter() {
            self.turned_out("never", sim.holds(after, never.holds) == Ok(true));
        }
        for predicate in world.goals.iter().chain(world.nevers.iter()) {
            let _ = self.eye(sim, after, input, SlotId(0), &[]).truth(predicate.holds);
        }
        for (slot, s) in world.slots.pairs() {
            let layout = &world.layout.slots[slot];
            match (layout.alive(before), layout.alive(after)) {
                (true, false) => self.note("an instance ends"),
                (false, true) => {
                    self.note("an instance begins");
                    if is_empty(s.entity, true) {
                        self.note("an instance begins where a placed one is gone");
                    }
                }
                (true, true) => {}
                (false, false) => continue,
            }
            if layout.alive(before) {
                self.watch_edges(sim, before, input, slot, after);
                self.watch_flows(sim, before, input, slot, after);
            }
            if s.player.is_some_and(|p| p.index() > 0) {
                self.note("a second player");
            }
            for invariant in &program.entities[s.entity].invariants {
                if let Some(holds) = self.eye(sim, after, input, slot, &[]).truth(*invariant) {
                    self.turned_out("invariant", holds);
                }
            }
            self.watch_rooms(sim, before, after, slot);
            if let Some(carrier) = layout.carrier(after).filter(|_| layout.alive(after)) {
                let moved = sim.position(before, carrier) != sim.position(after, carrier);
                self.note(if moved { "carried along" } else { "on a carrier that stands" });
                if world.layout.slots[carrier].carrier(after).is_some() {
                    self.note("on a carrier that is carried");
                }
            }
        }
        self.watch_contacts(sim, after, input);
        self.watch_tiles(sim, before, after);
    }

    /// Records tiles that break and come back.
    fn watch_tiles(&self, sim: &Simulator, before: &[u8], after: &[u8]) {
        let (was, is) = (sim.broken_tiles(before), sim.broken_tiles(after));
        for tile in is.iter().filter(|tile| !was.contains(tile)) {
            let comes_back = sim.steps_until_restored(after, *tile) > 0;
            self.note(if comes_back { "a tile breaks for a time" } else { "a tile breaks for good" });
        }
        for tile in was.iter().filter(|tile| !is.contains(tile)) {
            self.note("a tile is back");
            let Some((space, column, row)) = sim.place_of_tile(*tile) else { continue };
            let Some(map) = &sim.world().spaces[space].map else { continue };
            let [x, y, width, height] = map.rectangle(row * map.columns + column);
            let is_there = sim.world().slots.pairs().any(|(slot, _)| {
                let layout = &sim.world().layout.slots[slot];
                let at = sim.position(after, slot);
                let is_inside = x < at.0 && at.0 < x + width && y < at.1 && at.1 < y + height;
                layout.alive(after) && layout.space(after) == space && is_inside
            });
            if is_there {
                self.note("a tile is back around a body");
            }
        }
    }

    /// Records the reason why a run stops.
    pub fn stopped(&self, fault: &Fault) {
        self.note(match fault.kind {
            FaultKind::NotFinite(..) | FaultKind::Diverged(..) => "stops: not finite",
            FaultKind::DivisionByZero(..) => "stops: division by zero",
            FaultKind::OutOfRange(..) => "stops: out of range",
            // The checker excludes this.
            FaultKind::ReadNone(_) => panic!("a run reads none"),
        });
    }

    fn eye<'a>(
        &'a self,
        sim: &'a Simulator,
        state: &'a [u8],
        input: &'a Input,
        me: SlotId,
        taken: &'a [Option<Move>],
    ) -> Eye<'a> {
        Eye { program: sim.program(), world: sim.world(), state, input, me, member: None, taken, notes: self }
    }

    /// Records steps longer than the width of rooms, and events in a room that was entered by a link.
    fn watch_rooms(&self, sim: &Simulator, before: &[u8], after: &[u8], slot: SlotId) {
        /// More than the width of a room of the suite, px.
        const FAR: f64 = 400.0;
        let (world, layout) = (sim.world(), &sim.world().layout.slots[slot]);
        if !layout.alive(before) || !layout.alive(after) {
            return;
        }
        let space = layout.space(after);
        if space == layout.space(before) {
            let (from, to) = (sim.position(before, slot), sim.position(after, slot));
            let ways = [(from.0, to.0), (from.1, to.1)].into_iter().zip(world.spaces[space].periods);
            for ((from, to), period) in ways {
                if period.is_some_and(|period| (to - from).abs() > period.size() / 2.0) {
                    self.note("a seam is crossed");
                }
            }
            let walls = &world.spaces[space].solids;
            let is_among =
                |(x, y): (f64, f64)| (-100.0..=FAR).contains(&x) && (-100.0..=FAR).contains(&y) && !walls.is_empty();
            if (to.0 - from.0).abs().max((to.1 - from.1).abs()) > FAR {
                match (is_among(from), is_among(to)) {
                    (true, false) => self.note("a dash out of a room"),
                    (false, true) => self.note("a dash into a room"),
                    _ => self.note("a dash elsewhere"),
                }
            }
        }
        if space != world.slots[slot].space && layout.var(after, VarId(1), 2) < 0.0 {
            let speed = layout.var(after, VarId(1), 1);
            if speed < 0.0 {
                self.note("one who came by a link falls");
            } else if speed > 50.0 {
                self.note("one who came by a link jumps");
            }
            if space.index() > 1 {
                self.note("a third room");
            }
        }
    }

    /// Records properties of a world that are no construct of the language.
    pub fn survey(&self, sim: &Simulator, is_by_place: bool) {
        if is_by_place {
            self.note("a player is told apart by place");
        }
        // Only a setting gives the instance of a tile a reference.
        if sim.world().slots.iter().any(|s| s.origin == Origin::Tile && s.refs.iter().any(|to| to.is_some())) {
            self.note("a tile sets a reference");
        }
        for space in sim.world().spaces.iter() {
            let boxes: Vec<[f64; 4]> =
                space.solids.iter().map(|s| [s.bounds.left, s.bounds.right, s.bounds.bottom, s.bounds.top]).collect();
            for a in &boxes {
                for b in &boxes {
                    let gaps = [b[0] - a[1], b[2] - a[3]];
                    if gaps.iter().any(|gap| 0.0 < *gap && *gap < 1.0) {
                        self.note("walls half a pixel apart");
                    }
                }
            }
        }
    }

    fn note_else(&self, sim: &Simulator, edge: &hypedc::ir::Edge) {
        let guard = sim.program().spans.exprs[edge.guard].range();
        // A negation that is written in a word.
        if matches!(sim.program().exprs[edge.guard], Expr::Not(_)) && guard.len() == "else".len() {
            self.note("an edge by else");
        }
    }

    fn watch_edges(&self, sim: &Simulator, before: &[u8], input: &Input, slot: SlotId, after: &[u8]) {
        let world = sim.world();
        let entity = &sim.program().entities[world.slots[slot].entity];
        let layout = &world.layout.slots[slot];
        let mut taken: Vec<Option<Move>> = vec![None; entity.groups.len()];
        for &group in &entity.order {
            let decided = self.eye(sim, before, input, slot, &taken).decide(group);
            taken[group.index()] = decided;
        }
        let eye = self.eye(sim, before, input, slot, &taken);
        for group in entity.groups.ids() {
            let from = layout.leaf(before, group);
            for &edge in &entity.leaves[from].internal {
                let is_set = entity.edges[edge].needs.iter().all(|r| layout.reference(before, *r).is_some());
                if is_set && eye.truth(entity.edges[edge].guard) == Some(true) {
                    self.note("an edge without a target");
                    if entity.modes[entity.edges[edge].source].path == "always" {
                        self.note("an edge of always");
                    }
                    self.note_else(sim, &entity.edges[edge]);
                    self.watch_actions(sim, (before, input), slot, &entity.edges[edge].actions);
                }
            }
            if let Some(Move { edge, target, from, to }) = taken[group.index()] {
                let source = entity.edges[edge].source;
                let is_around = target <= source && source < entity.modes[target].end;
                self.note(if is_around { "an edge that starts a mode anew" } else { "an edge" });
                self.note_else(sim, &entity.edges[edge]);
                if entity.groups[group].name.is_none() && entity.groups.iter().any(|g| g.name.is_some()) {
                    self.note("an edge of modes beside groups");
                }
                let modes = &entity.modes;
                if modes[target].chooses || modes[target].inner.is_some() {
                    self.note("an edge into a mode with modes");
                }
                self.watch_actions(sim, (before, input), slot, &entity.edges[edge].actions);
                for mode in entity.leaves[to].path.iter().filter(|m| !entity.leaves[from].path.contains(m)) {
                    if !modes[*mode].entry.updates.is_empty() {
                        self.note("an entry update");
                    }
                }
            }
            for &follow in &entity.leaves[from].follows {
                let follow = &entity.follows[follow];
                let is_open = follow.guard.is_none_or(|g| eye.truth(g) == Some(true));
                if is_open && layout.alive(after) && layout.space(before) != layout.space(after) {
                    let links = &world.spaces[layout.space(before)].links;
                    self.note(if follow.guard.is_some() {
                        "a link is followed on a guard"
                    } else {
                        "a link is followed"
                    });
                    if links.iter().any(|l| l.guard.is_some()) {
                        self.note("a link with a guard is open");
                    }
                    if !follow.actions.updates.is_empty() {
                        self.note("updates as a link is followed");
                    }
                }
            }
        }
        let choices = entity.groups.iter().flat_map(|g| &g.choices).chain(entity.modes.iter().flat_map(|m| &m.choices));
        for choice in choices {
            if let Some(holds) = eye.truth(choice.guard) {
                self.turned_out("initial when", holds);
            }
        }
    }

    fn watch_actions(&self, sim: &Simulator, (before, input): (&[u8], &Input), slot: SlotId, actions: &Actions) {
        let entity = &sim.program().entities[sim.world().slots[slot].entity];
        for update in &actions.updates {
            self.note(match update.place {
                Place::Var(VarId(0 | 1), 0) => "an update of a position",
                Place::Var(_, 0) => "an update of a variable",
                Place::Var(_, 1) => "an update of a velocity",
                Place::Var(..) => "an update of an acceleration",
                Place::Discrete(id) => match entity.discretes[id].domain {
                    Domain::Int => "an update of a whole number",
                    Domain::Bool => "an update of a truth value",
                    Domain::Set(_) => "an update of a name",
                },
                Place::Ref(_) => continue,
            });
        }
        for update in &actions.refs {
            self.note(match update.value {
                RefValue::None => "a reference is cleared",
                RefValue::Of(Subject::Me) => "a reference is set to self",
                RefValue::Of(Subject::Touched(_) | Subject::Probed(_)) => "a reference is set to what is touched",
                RefValue::Of(_) => "a reference is set to another",
            });
        }
        for &spawn in &actions.spawns {
            let spawn = &entity.spawns[spawn];
            self.note(if spawn.into.is_some() { "a spawn into a reference" } else { "a spawn" });
            let own = sim.world().slots[slot].entity;
            if spawn.entity == own && !spawn.params.is_empty() && sim.world().slots[slot].origin == Origin::Free {
                self.note("a spawn by what was spawned, parameters from its own");
            }
        }
        for &send in &actions.sends {
            let send = &entity.sends[send];
            self.note(match send.to {
                None => "a signal to all",
                Some(Subject::Me) => "a signal to itself",
                Some(_) => "a signal to one",
            });
            if send.value.is_some() {
                self.note("a signal with a number");
            }
            if let Some(Subject::Ref(to)) = send.to
                && sim.world().layout.slots[slot].reference(before, to).is_none()
            {
                self.note("a signal to nobody");
            }
        }
        let layout = &sim.world().layout.slots[slot];
        let eye = self.eye(sim, before, input, slot, &[]);
        for destroyed in &actions.destroys {
            self.note(match destroyed {
                RefValue::None => continue,
                RefValue::Of(Subject::Me) => "destroy self",
                RefValue::Of(Subject::Touched(id)) => match layout.touched(before, *id) {
                    Some(_) => "destroy what is touched",
                    None => "destroy a tile that is touched",
                },
                RefValue::Of(of @ Subject::Probed(_)) => match eye.instance(*of) {
                    Some(_) => "destroy what a probe finds",
                    None => "destroy a tile that a probe finds",
                },
                RefValue::Of(_) => "destroy a reference",
            });
        }
    }

    fn watch_flows(&self, sim: &Simulator, before: &[u8], input: &Input, slot: SlotId, after: &[u8]) {
        let world = sim.world();
        let entity = &sim.program().entities[world.slots[slot].entity];
        let layout = &world.layout.slots[slot];
        if !layout.alive(after) {
            return;
        }
        let eye = self.eye(sim, before, input, slot, &[]);
        let leaves = entity.groups.ids().map(|g| layout.leaf(after, g));
        let drives: Vec<Drive> =
            entity.free.iter().copied().chain(leaves.flat_map(|l| entity.leaves[l].drives.iter().copied())).collect();
        for drive in drives {
            match drive {
                Drive::Coast(var) => {
                    if layout.var(before, var, 2) != 0.0 {
                        self.note("an acceleration that goes on");
                    }
                }
                Drive::Flow { degree, value, .. } => {
                    self.note(
                        ["a flow of a position", "a flow of a velocity", "a flow of an acceleration"]
                            [usize::from(degree.min(2))],
                    );
                    let _ = eye.number(value);
                }
                Drive::Envelope(id, component) => {
                    let envelope = &entity.envelopes[id];
                    self.note(&format!("an envelope {}", by_name(&envelope.by)));
                    let var = envelope.vars[usize::from(component)];
                    let (old, new) =
                        (layout.var(before, var, envelope.degree), layout.var(after, var, envelope.degree));
                    if let Some(guard) = envelope.guard
                        && let Some(holds) = eye.truth(guard)
                    {
                        self.turned_out("while", holds);
                    }
                    self.watch_envelope(
                        envelope,
                        [old, new],
                        envelope.peak.is_some() && layout.peak(after, id) != 0,
                        &eye,
                    );
                }
            }
        }
        let values = self.eye(sim, before, input, slot, &[]);
        for clamp in &entity.clamps {
            let value = layout.var(after, clamp.var, clamp.degree);
            for (bound, what) in [(clamp.low, "low"), (clamp.high, "high")] {
                if bound.and_then(|b| values.number(b)) == Some(value) {
                    let of = if clamp.degree == 0 { "position" } else { "velocity" };
                    self.note(&format!("a clamp of a {of} at its {what} end"));
                }
            }
        }
    }

    fn watch_envelope(&self, envelope: &hypedc::ir::Envelope, [old, new]: [f64; 2], is_at_peak: bool, eye: &Eye<'_>) {
        let is_moving = old != new;
        let is_driven = match &envelope.by {
            By::Button(b) => {
                let player = eye.world.slots[eye.me].player;
                player.is_some_and(|p| eye.input.of(p).buttons >> b.index() & 1 == 1)
            }
            By::Axis(axis) => eye.world.slots[eye.me].player.is_some_and(|p| eye.input.of(p).axes[axis.index()] != 0.0),
            By::Axes(axes, _) => eye.world.slots[eye.me]
                .player
                .is_some_and(|p| axes.iter().any(|a| eye.input.of(p).axes[a.index()] != 0.0)),
            By::Clock { .. } => {
                self.note(if is_moving { "a fixed envelope moves" } else { "a fixed envelope stays" });
                return;
            }
        };
        self.note(match (is_driven, is_at_peak, is_moving, &envelope.release) {
            (true, true, true, _) => "a decay",
            (true, true, false, _) => "a sustain after a peak",
            (true, false, true, _) => "an attack",
            (true, false, false, _) => "a sustain",
            (false, _, _, Release::Hold) => "a release that holds",
            (false, _, true, _) => "a release",
            (false, _, false, _) => "a release that is over",
        });
    }

    /// Records which colliders touch, and how, from their positions after the step.
    fn watch_contacts(&self, sim: &Simulator, state: &[u8], input: &Input) {
        let (program, world) = (sim.program(), sim.world());
        for space in world.spaces.ids() {
            let mut bodies = Vec::new();
            for (slot, s) in world.slots.pairs() {
                let layout = &world.layout.slots[slot];
                if !layout.alive(state) || layout.space(state) != space {
                    continue;
                }
                let entity = &program.entities[s.entity];
                for (id, collider) in entity.colliders.pairs() {
                    let eye = self.eye(sim, state, input, slot, &[]);
                    let guard = collider.guard.map(|g| eye.truth(g) == Some(true));
                    if guard == Some(true) && id.index() > 0 && entity.colliders[ColliderId(0)].guard.is_some() {
                        let first = entity.colliders[ColliderId(0)].guard.and_then(|g| eye.truth(g));
                        if first == Some(false) {
                            self.note("a collider of another size");
                        }
                    }
                    if let Some(is_there) = guard {
                        self.turned_out("collider when", is_there);
                    }
                    if guard != Some(false)
                        && let Some(sides) = self.sides(&eye, id)
                    {
                        bodies.push(Body {
                            slot: Some(slot),
                            is_kinematic: collider.kinematic,
                            tags: collider.tags,
                            sides,
                        });
                    }
                }
            }
            let own = bodies.len();
            let solid = |tags: TagSet, b: hypedc::ir::Bounds| Body {
                slot: None,
                is_kinematic: true,
                tags,
                sides: [b.left, b.right, b.bottom, b.top],
            };
            bodies.extend(world.spaces[space].solids.iter().map(|s| solid(s.tags, s.bounds)));
            for i in 0..own {
                let mut pushed = [false; 4];
                for j in 0..bodies.len() {
                    if i != j && bodies[i].slot != bodies[j].slot {
                        self.meet(sim, &bodies[i], &bodies[j], i < j, &mut pushed);
                    }
                }
                if pushed[0] && pushed[1] || pushed[2] && pushed[3] {
                    self.note("pushed from two sides");
                }
            }
            self.watch_slopes(sim, space, &bodies[..own]);
            self.watch_seams(sim, space, &bodies[..own], &bodies);
        }
    }

    /// Records which colliders touch a slope that blocks, and from where.
    fn watch_slopes(&self, sim: &Simulator, space: SpaceId, own: &[Body]) {
        const NEAR: f64 = 0.01;
        let Some(map) = &sim.world().spaces[space].map else { return };
        for (cell, kind) in map.cells.iter().enumerate() {
            let kind = &map.kinds[usize::from(*kind)];
            let Some(slope) = kind.slope else { continue };
            let [left, bottom, width, height] = map.rectangle(cell);
            let tags = kind.tags.iter().copied().collect();
            for body in own.iter().filter(|body| !body.is_kinematic) {
                let pushes = sim.world().meeting(body.tags, tags).map(|meeting| meeting.response.push);
                let [low, high, under, over] = body.sides;
                if !matches!(pushes, Some(Push::Block | Push::FromAbove)) || high < left || low > left + width {
                    continue;
                }
                let at = |x: f64| slope.left + (slope.right - slope.left) * ((x - left) / width).clamp(0.0, 1.0);
                let top = bottom + at(low).max(at(high));
                let is_level = over > bottom + NEAR && under < bottom + height - NEAR;
                match () {
                    () if (under - top).abs() < NEAR => self.note("on a slope"),
                    () if (over - bottom).abs() < NEAR => self.note("under a slope"),
                    () if is_level && (high - left).min(left + width - low) < NEAR => self.note("beside a slope"),
                    () => {}
                }
            }
        }
    }

    /// Records which colliders touch across the border of a space that wraps.
    fn watch_seams(&self, sim: &Simulator, space: SpaceId, own: &[Body], all: &[Body]) {
        for (axis, period) in sim.world().spaces[space].periods.into_iter().enumerate() {
            let Some(period) = period else { continue };
            for (a, b) in own.iter().flat_map(|a| all.iter().map(move |b| (a, b))).filter(|(a, b)| a.slot != b.slot) {
                let is_met = [-1.0, 1.0].into_iter().any(|turn| {
                    let mut sides = b.sides;
                    sides[2 * axis..2 * axis + 2].iter_mut().for_each(|side| *side += turn * period.size());
                    let over = |axis: usize| {
                        a.sides[2 * axis + 1].min(sides[2 * axis + 1]) - a.sides[2 * axis].max(sides[2 * axis])
                    };
                    over(0) > 0.01 && over(1) > 0.01
                });
                if is_met && sim.world().meeting(a.tags, b.tags).is_some() {
                    self.note(if b.slot.is_some() { "two across a seam" } else { "a wall across a seam" });
                }
            }
        }
    }

    fn sides(&self, eye: &Eye<'_>, id: ColliderId) -> Option<[f64; 4]> {
        let layout = &eye.world.layout.slots[eye.me];
        let (px, py) = (layout.var(eye.state, VarId(0), 0), layout.var(eye.state, VarId(1), 0));
        let shape = &eye.entity(eye.me).colliders[id].shape;
        let is_steady = shape.numbers().iter().all(|n| matches!(eye.program.exprs[*n], Expr::Number(_)));
        if !is_steady {
            self.note("a collider whose size is an expression");
        }
        match shape {
            Shape::Rect([x, y, w, h]) => {
                let [x, y, w, h] = [eye.number(*x)?, eye.number(*y)?, eye.number(*w)?, eye.number(*h)?];
                (w > 0.0 && h > 0.0).then_some([px + x, px + x + w, py + y, py + y + h])
            }
            Shape::Circle([x, y, r]) => {
                let [x, y, r] = [eye.number(*x)?, eye.number(*y)?, eye.number(*r)?];
                self.note("a circle");
                (r > 0.0).then_some([px + x - r, px + x + r, py + y - r, py + y + r])
            }
        }
    }

    fn meet(&self, sim: &Simulator, a: &Body, b: &Body, is_first: bool, pushed: &mut [bool; 4]) {
        const NEAR: f64 = 0.01;
        let Some(meeting) = sim.world().meeting(a.tags, b.tags) else { return };
        let over = |axis: usize| {
            let low = a.sides[2 * axis].max(b.sides[2 * axis]);
            a.sides[2 * axis + 1].min(b.sides[2 * axis + 1]) - low
        };
        let (x, y) = (over(0), over(1));
        if x < -NEAR || y < -NEAR || x < NEAR && y < NEAR {
            return;
        }
        let response = meeting.response;
        if response.push == Push::Block && !a.is_kinematic {
            let side =
                if x < y { usize::from(a.sides[0] < b.sides[0]) } else { 2 + usize::from(a.sides[2] < b.sides[2]) };
            pushed[side] = true;
        }
        if !is_first {
            return;
        }
        let push = match response.push {
            Push::Sense => "sense",
            Push::Block => "block",
            Push::FromAbove => "block from above",
        };
        let keep = if response.stop || response.push == Push::Sense { "" } else { ", keep velocity" };
        let carry = if response.carry { ", carry" } else { "" };
        let bounce = if response.bounce.is_none() { "" } else { ", bounce" };
        self.note(&format!("meets: {push}{keep}{carry}{bounce}"));
        if response.push != Push::Sense {
            self.note(match (a.slot.is_some() && b.slot.is_some(), a.is_kinematic, b.is_kinematic) {
                (false, false, _) => "a movable and a wall",
                (false, true, _) => "a kinematic one and a wall",
                (true, false, false) => "two movable ones",
                (true, true, true) => "two kinematic ones",
                (true, ..) => "a movable and a kinematic one",
            });
            if x > 0.5 && y > 0.5 {
                self.note("deep inside of what blocks");
            }
        }
    }
}

/// Events without a truth value.
const EVENTS: &[&str] = &[
    "own parameter",
    "parameter of another",
    "own variable",
    "the number of a signal",
    "variable of another",
    "own discrete",
    "discrete of another",
    "axis at 0",
    "axis at an end",
    "axis at a fraction",
    "the least that is drawn",
    "the greatest that is drawn",
    "what is drawn between",
    "timer at 0",
    "timer that counts",
    "+",
    "-",
    "*",
    "/",
    "min",
    "max",
    "abs",
    "sign",
    "clamp()",
    "floor",
    "ceil",
    "round",
    "sqrt",
    "sin",
    "cos",
    "atan2",
    "mod",
    "an edge",
    "an edge without a target",
    "an edge by else",
    "an edge of always",
    "an edge of modes beside groups",
    "an edge that starts a mode anew",
    "an edge into a mode with modes",
    "an entry update",
    "a link is followed",
    "a link is followed on a guard",
    "a link with a guard is open",
    "updates as a link is followed",
    "an update of a position",
    "an update of a variable",
    "an update of a velocity",
    "an update of an acceleration",
    "an update of a whole number",
    "an update of a truth value",
    "an update of a name",
    "a reference is cleared",
    "a reference is set to self",
    "a reference is set to what is touched",
    "a reference is set to another",
    "a spawn",
    "a spawn into a reference",
    "a spawn is refused",
    "a spawn is refused beside a free slot",
    "a spawn by what was spawned, parameters from its own",
    "a signal to one",
    "a signal to itself",
    "a signal to all",
    "a signal with a number",
    "a signal to nobody",
    "destroy self",
    "destroy what is touched",
    "destroy what a probe finds",
    "a count of none",
    "a count of one",
    "a count of several",
    "distance",
    "destroy a reference",
    "destroy a tile that is touched",
    "destroy a tile that a probe finds",
    "a tile breaks for good",
    "a tile breaks for a time",
    "a tile is back",
    "a tile is back around a body",
    "a place with a breakable tile",
    "broken tiles are counted",
    "an entity counts tiles",
    "an instance begins",
    "an instance begins where a placed one is gone",
    "an instance ends",
    "a player leaves its bounds",
    "on a slope",
    "under a slope",
    "beside a slope",
    "a seam is crossed",
    "two across a seam",
    "a wall across a seam",
    "a second player",
    "a tile sets a reference",
    "a place with an instance",
    "a player is told apart by place",
    "walls half a pixel apart",
    "a dash out of a room",
    "a dash into a room",
    "a dash elsewhere",
    "one who came by a link falls",
    "one who came by a link jumps",
    "a third room",
    "a collider of another size",
    "carried along",
    "on a carrier that stands",
    "on a carrier that is carried",
    "an acceleration that goes on",
    "a flow of a position",
    "a flow of a velocity",
    "a flow of an acceleration",
    "an envelope by a button",
    "an envelope by an axis",
    "an envelope by two axes, any direction",
    "an envelope by two axes, directions",
    "an envelope fixed",
    "a fixed envelope moves",
    "a fixed envelope stays",
    "an attack",
    "a decay",
    "a sustain",
    "a sustain after a peak",
    "a release",
    "a release that holds",
    "a release that is over",
    "a clamp of a position at its low end",
    "a clamp of a position at its high end",
    "a clamp of a velocity at its low end",
    "a clamp of a velocity at its high end",
    "meets: sense",
    "meets: block",
    "meets: block, bounce",
    "meets: block, carry",
    "meets: block, carry, bounce",
    "meets: block, keep velocity",
    "meets: block, keep velocity, carry",
    "meets: block from above",
    "meets: block from above, bounce",
    "meets: block from above, carry",
    "a movable and a wall",
    "a kinematic one and a wall",
    "two movable ones",
    "two kinematic ones",
    "a movable and a kinematic one",
    "deep inside of what blocks",
    "pushed from two sides",
    "a collider whose size is an expression",
    "a circle",
    "stops: not finite",
    "stops: division by zero",
    "stops: out of range",
];

/// Events with a truth value.
const ATOMS: &[&str] = &[
    "<",
    "<=",
    ">",
    ">=",
    "==",
    "!=",
    "and",
    "or",
    "not",
    "if",
    "pressed",
    "held",
    "released",
    "touching",
    "touching on a side",
    "touching as",
    "touching at",
    "touching at, as",
    "nearest",
    "entering",
    "exiting",
    "received",
    "is none",
    "is ENTITY",
    "in MODE",
    "in MODE of another",
    "inside",
    "near",
    "alive",
    "goal",
    "never",
    "invariant",
    "while",
    "initial when",
    "collider when",
];
