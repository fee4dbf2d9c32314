//! The search window: how far a search follows players in a space whose author wrote no `bounds`.
//!
//! Such a run has no border, so a search stops beyond everything that the space contains and all positions that the
//! program compares with. States beyond are not searched, and a search that stops there proves nothing.

use std::collections::BTreeSet;

use crate::ir::{
    Arithmetic, Bounds, Drive, Entity, EntityId, Expr, ExprId, Extremes, Id, IdVec, Origin, Place, Slot, SlotId, Space,
    SpaceId, Subject, Update, VarId,
};

use super::coverage::PLACE;
use super::goal_positions::extent;
use super::problem::{Problem, Start};

/// The margin of a window, in sizes of the largest player.
const BODIES: f64 = 2.0;

/// The windows of the spaces of a world.
#[derive(Debug)]
pub(super) struct Windows {
    /// For each space; `None` if it has `bounds` or no contents.
    of: Vec<Option<Bounds>>,
    /// The hull of all spaces that have bounds or a map; without margins.
    pub extent: Option<Bounds>,
}

impl Windows {
    /// The windows for a question with some starts.
    pub fn new(problem: &Problem<'_>, starts: &[Start]) -> Self {
        let world = problem.sim.world();
        let contents = WorldContents::new(problem, starts);
        let margin = margin(problem);
        let window = |(id, contents): (SpaceId, &Contents)| {
            let hull = contents.hull().filter(|_| world.spaces[id].bounds.is_none())?;
            Some(Bounds {
                left: hull.left - margin,
                right: hull.right + margin,
                bottom: hull.bottom - margin,
                top: hull.top + margin,
            })
        };
        let extent = |(space, contents): (&Space, &Contents)| {
            space.bounds.or_else(|| contents.hull().filter(|_| space.map.is_some()))
        };
        Windows {
            of: world.spaces.ids().zip(&contents.spaces).map(window).collect(),
            extent: world.spaces.iter().zip(&contents.spaces).filter_map(extent).reduce(Bounds::join),
        }
    }

    /// The window of a space.
    pub fn of(&self, space: SpaceId) -> Option<&Bounds> {
        self.of[space.index()].as_ref()
    }

    /// The space whose window a player has left, if any.
    pub fn left(&self, problem: &Problem<'_>, state: &[u8]) -> Option<SpaceId> {
        let sim = problem.sim;
        problem.players().iter().find_map(|&slot| {
            let space = sim.space(state, slot);
            let window = self.of(space)?;
            let is_alive = sim.world().layout.slots[slot].alive(state);
            (is_alive && window.is_left_at(sim.position(state, slot))).then_some(space)
        })
    }
}

/// The margin of a window, px.
fn margin(problem: &Problem<'_>) -> f64 {
    let (program, world) = (problem.sim.program(), problem.sim.world());
    let bodies = problem.players().iter().flat_map(|&player| {
        let colliders = program.entities[world.slots[player].entity].colliders.iter();
        colliders.filter_map(move |collider| extent(problem, player, collider))
    });
    let largest = bodies.map(|b| (b.right - b.left).greatest(b.top - b.bottom)).fold(0.0, f64::greatest);
    let tiles = world.spaces.iter().filter_map(|space| space.map.as_ref()).map(|map| map.tile.0.greatest(map.tile.1));
    tiles.fold(PLACE, f64::greatest).greatest(BODIES * largest)
}

/// The contents of all spaces of a world.
struct WorldContents<'a> {
    problem: &'a Problem<'a>,
    spaces: Vec<Contents>,
}

/// The contents of a space.
#[derive(Debug, Clone, Default)]
struct Contents {
    /// The hull of its geometry and instances, if any.
    held: Option<Bounds>,
    /// Positions per axis that the program compares with or assigns.
    numbers: [Vec<f64>; 2],
    /// The starts of players.
    start: Option<Bounds>,
}

impl Contents {
    /// The hull of all contents, if any.
    fn hull(&self) -> Option<Bounds> {
        let hull = joined(self.start, self.held?)?;
        let least = |axis: usize, than: f64| self.numbers[axis].iter().copied().fold(than, f64::least);
        let greatest = |axis: usize, than: f64| self.numbers[axis].iter().copied().fold(than, f64::greatest);
        Some(Bounds {
            left: least(0, hull.left),
            right: greatest(0, hull.right),
            bottom: least(1, hull.bottom),
            top: greatest(1, hull.top),
        })
    }
}

impl<'a> WorldContents<'a> {
    fn new(problem: &'a Problem<'a>, starts: &[Start]) -> Self {
        let spaces = vec![Contents::default(); problem.sim.world().spaces.len()];
        let mut contents = WorldContents { problem, spaces };
        contents.add_geometry();
        contents.add_instances();
        contents.add_code();
        contents.add_questions();
        for (start, &player) in starts.iter().flat_map(|s| problem.players().iter().map(move |p| (s, p))) {
            let (x, y) = problem.sim.position(&start.state, player);
            let start = &mut contents.spaces[problem.sim.space(&start.state, player).index()].start;
            *start = joined(*start, Bounds::new([x, y, 0.0, 0.0]));
        }
        contents
    }

    fn add_geometry(&mut self) {
        for (id, space) in self.problem.sim.world().spaces.pairs() {
            let solids = space.solids.iter().map(|solid| solid.bounds);
            let links = space.links.iter().map(|link| link.from);
            for thing in space.map_rectangle().into_iter().chain(solids).chain(links) {
                self.include(id, thing);
            }
            for link in &space.links {
                self.include(link.space, link.to);
            }
        }
    }

    /// Placed instances except players, which say nothing about the extent of a space.
    fn add_instances(&mut self) {
        let problem = self.problem;
        let world = problem.sim.world();
        let placed = world.slots.pairs().filter(|(_, s)| s.origin != Origin::Free && s.player.is_none());
        for (id, slot) in placed {
            let position = first_position(slot);
            let colliders = problem.sim.program().entities[slot.entity].colliders.iter();
            for body in colliders.filter_map(|collider| extent(problem, id, collider)) {
                self.include(slot.space, body.placed(position));
            }
        }
    }

    /// Positions in the code of entities.
    fn add_code(&mut self) {
        let (program, world) = (self.problem.sim.program(), self.problem.sim.world());
        let used: BTreeSet<EntityId> = world.slots.iter().map(|slot| slot.entity).collect();
        for entity in used {
            let code: Vec<ExprId> = program.entities[entity].code.ids().collect();
            let put = positions_put(&program.entities[entity]);
            for slot in world.slots.ids().filter(|slot| world.slots[*slot].entity == entity) {
                code.iter().for_each(|&id| self.add_comparison(id, Some(slot)));
                for &(var, value) in &put {
                    if let Some(value) = self.constant(value, Some(slot)) {
                        self.add_number(Some(slot), var, value);
                    }
                }
            }
        }
    }

    /// Positions in the question, in `never`s and in the guards of links.
    fn add_questions(&mut self) {
        let problem = self.problem;
        let world = problem.sim.world();
        let links = world.spaces.iter().flat_map(|space| &space.links).filter_map(|link| link.guard);
        let nevers = world.nevers.iter().map(|never| never.holds);
        let mut open: Vec<ExprId> = links.chain(nevers).chain([problem.predicate()]).collect();
        open.extend(problem.avoided());
        while let Some(id) = open.pop() {
            match problem.sim.program().exprs[id] {
                Expr::And(a, b) | Expr::Or(a, b) => open.extend([a, b]),
                Expr::Not(a) => open.push(a),
                _ => self.add_comparison(id, None),
            }
        }
    }

    /// Adds the positions in a comparison of a slot's code, or of the world's.
    fn add_comparison(&mut self, id: ExprId, me: Option<SlotId>) {
        match self.problem.sim.program().exprs[id] {
            Expr::Compare(_, a, b) => {
                for (side, other) in [(a, b), (b, a)] {
                    if let (Some((of, var, shift)), Some(value)) = (self.position(side, me), self.constant(other, me)) {
                        self.add_number(of, var, value - shift);
                    }
                }
            }
            Expr::Near { of, x, y, radius } => {
                let Some(radius) = self.constant(radius, me) else { return };
                for (var, middle) in [(VarId::X, x), (VarId::Y, y)] {
                    let Some(middle) = self.constant(middle, me) else { continue };
                    for value in [middle - radius, middle + radius] {
                        self.add_number(slot_of(of, me), var, value);
                    }
                }
            }
            _ => {}
        }
    }

    /// If an expression is a position plus a constant: the slot, the axis and the constant.
    fn position(&self, id: ExprId, me: Option<SlotId>) -> Option<(Option<SlotId>, VarId, f64)> {
        match self.problem.sim.program().exprs[id] {
            Expr::Var(of, var, 0) if var.is_position() => Some((slot_of(of, me), var, 0.0)),
            Expr::Arithmetic(op @ (Arithmetic::Add | Arithmetic::Subtract), a, b) => {
                if let (Some((of, var, shift)), Some(value)) = (self.position(a, me), self.constant(b, me)) {
                    let value = if op == Arithmetic::Add { value } else { -value };
                    return Some((of, var, shift + value));
                }
                let (of, var, shift) = self.position(b, me).filter(|_| op == Arithmetic::Add)?;
                Some((of, var, shift + self.constant(a, me)?))
            }
            _ => None,
        }
    }

    /// The constant value of an expression in a slot or in the world, if it has one.
    fn constant(&self, id: ExprId, me: Option<SlotId>) -> Option<f64> {
        let world = self.problem.sim.world();
        // The parameters of a reusable slot are not known.
        let none = IdVec::new();
        let params = me.map(|slot| &world.slots[slot]).filter(|slot| slot.is_fixed).map_or(&none, |slot| &slot.params);
        self.problem.sim.program().constant(id, params, world.step)
    }

    /// Adds a position along an axis in each space in which a slot can be; in all spaces if the slot is unknown.
    fn add_number(&mut self, slot: Option<SlotId>, var: VarId, value: f64) {
        let (program, world) = (self.problem.sim.program(), self.problem.sim.world());
        let stays = slot
            .map(|id| &world.slots[id])
            .filter(|slot| slot.origin != Origin::Free && program.entities[slot.entity].follows.is_empty());
        for id in world.spaces.ids().filter(|id| stays.is_none_or(|slot| slot.space == *id)) {
            self.spaces[id.index()].numbers[var.index()].push(value);
        }
    }

    fn include(&mut self, space: SpaceId, thing: Bounds) {
        let held = &mut self.spaces[space.index()].held;
        *held = joined(*held, thing);
    }
}

/// The positions that an entity assigns or clamps to.
fn positions_put(entity: &Entity) -> Vec<(VarId, ExprId)> {
    let actions = entity.edges.iter().map(|edge| &edge.actions).chain(entity.modes.iter().map(|mode| &mode.entry));
    let actions = actions.chain(entity.follows.iter().map(|follow| &follow.actions));
    let updates = actions.flat_map(|a| &a.updates).chain(entity.spawns.iter().flat_map(|spawn| &spawn.updates));
    let updated = updates.filter_map(|&Update { place, value }| match place {
        Place::Var(var, 0) => Some((var, value)),
        _ => None,
    });
    let drives = entity.free.iter().chain(entity.leaves.iter().flat_map(|leaf| &leaf.drives));
    let driven = drives.filter_map(|drive| match *drive {
        Drive::Flow { var, degree: 0, value } => Some((var, value)),
        _ => None,
    });
    let clamps = entity.clamps.iter().filter(|clamp| clamp.degree == 0);
    let clamped = clamps.flat_map(|c| c.low.into_iter().chain(c.high).map(|end| (c.var, end)));
    updated.chain(driven).chain(clamped).filter(|(var, _)| var.is_position()).collect()
}

/// The slot of a subject in a slot's code or the world's; `None` if it can be several.
fn slot_of(subject: Subject, me: Option<SlotId>) -> Option<SlotId> {
    match subject {
        Subject::Me => me,
        Subject::Slot(slot) => Some(slot),
        Subject::Ref(_) | Subject::Touched(_) | Subject::Probed(_) | Subject::Member(_) => None,
    }
}

fn first_position(slot: &Slot) -> (f64, f64) {
    (slot.vars[VarId::X][0], slot.vars[VarId::Y][0])
}

fn joined(known: Option<Bounds>, more: Bounds) -> Option<Bounds> {
    Some(known.map_or(more, |known| known.join(more)))
}
