//! Membership of concrete states in a configuration space: a table for each kind of instance, built once and queried
//! often. Proofs rely on these tables: rows of configurations, energies of falls, regions among obstacles, and
//! positions of contacts.
//!
//! A table is independent of the state layout: it reads an instance through [`Reading`].

mod lookup;

use std::collections::HashMap;
use std::fmt;
use std::sync::Arc;

use crate::ir::{
    DiscreteId, Entity, GroupId, Id, IdVec, LeafId, ParamId, Program, SlotId, SpaceId, TimerId, TouchId, VarId, World,
    WorldId,
};
use crate::ordered::Ordered;

use super::{ConfigurationSpace, SlotSpace};
use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::energy::Fall;
use crate::analysis::domain::values::{Interval, Values};
use crate::analysis::geometry::presence::KeptOut;
use crate::analysis::membership::lookup::{Boxes, Grid, exact_text, slice};

/// Maximum number of combinations of leaves with a direct table; above it, combinations are searched linearly.
const MAX_KEYS: usize = 1 << 16;
/// Up to this number, rows are searched linearly.
const FEW_ROWS: u32 = 8;
/// Marks a row that allows every space.
const ANYWHERE: u32 = u32::MAX;

/// Read access to an instance in a state.
pub trait Reading {
    /// The active leaf of a group.
    fn leaf(&self, group: GroupId) -> LeafId;
    /// A continuous variable (degree 0) or one of its derivatives: the number at `3 * var + degree`.
    fn real(&self, place: usize) -> f64;
    /// A discrete variable.
    fn discrete(&self, id: DiscreteId) -> i32;
    /// A timer's count of steps.
    fn timer(&self, id: TimerId) -> u32;
    /// A parameter of a slot whose parameters can change.
    fn param(&self, id: ParamId) -> f64;
    /// Its space.
    fn space(&self) -> SpaceId;
    /// Whether a contact query held in the last collision phase.
    fn touch(&self, id: TouchId) -> bool;
}

/// An instance whose state is outside the configuration space.
#[derive(Debug, Clone, PartialEq)]
pub struct Outside {
    /// The instance.
    pub instance: String,
    /// Its active modes; empty if there is no instance.
    pub modes: Vec<String>,
    /// The values outside, relative to the closest configuration; several if several are equally close.
    pub beyond: Vec<Beyond>,
}

/// A value outside the allowed ones.
#[derive(Debug, Clone, PartialEq)]
pub struct Beyond {
    /// Its name.
    pub variable: String,
    /// Its value.
    pub value: String,
    /// All values that the analysis allows.
    pub allowed: String,
}

impl fmt::Display for Outside {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.instance)?;
        if !self.modes.is_empty() {
            write!(f, " in {}", self.modes.join(", "))?;
        }
        for (index, Beyond { variable, value, allowed }) in self.beyond.iter().enumerate() {
            write!(f, "{}{variable} is {value}, allowed is {allowed}", if index == 0 { ": " } else { "; or " })?;
        }
        Ok(())
    }
}

/// The membership tables of a world.
#[derive(Debug, Clone)]
pub struct Membership {
    tables: Vec<Table>,
    /// The table of each slot.
    of: IdVec<SlotId, usize>,
    /// The tables with players distinguished by place: proofs rely on both.
    finer: Option<Box<Membership>>,
}

/// A number of an instance.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Quantity {
    /// `3 * var + degree`
    Real(u32),
    Discrete(DiscreteId),
    Timer(TimerId),
    Param(ParamId),
}

impl Quantity {
    fn read(self, of: &impl Reading) -> f64 {
        match self {
            Quantity::Real(place) => of.real(place as usize),
            Quantity::Discrete(id) => f64::from(of.discrete(id)),
            Quantity::Timer(id) => f64::from(of.timer(id)),
            Quantity::Param(id) => of.param(id),
        }
    }

    fn name(self, entity: &Entity) -> String {
        match self {
            Quantity::Real(place) => {
                format!("{}{}", entity.vars[VarId(place / 3)], "'".repeat(place as usize % 3))
            }
            Quantity::Discrete(id) => entity.discretes[id].name.clone(),
            Quantity::Timer(id) => format!("time in {}", entity.modes[entity.timers[id].mode].path),
            Quantity::Param(id) => entity.params[id].name.clone(),
        }
    }
}

/// A check of one number.
#[derive(Debug, Clone, Copy)]
struct Check {
    of: Quantity,
    hull: Interval,
    /// The range of its intervals in `parts`, if there are several.
    parts: (u32, u32),
}

/// A configuration.
#[derive(Debug, Clone)]
struct Row {
    /// The hull of its positions.
    hull: [Interval; 2],
    checks: (u32, u32),
    falls: (u32, u32),
    /// The number of its set of spaces, or [`ANYWHERE`].
    spaces: u32,
}

/// The rows of a combination of leaves.
#[derive(Debug, Clone, Copy, Default)]
struct RowRange {
    rows: (u32, u32),
    /// If they are many: 1 plus the number of the grid.
    grid: u32,
}

/// A variable in free fall.
#[derive(Debug, Clone, Copy)]
struct Falling {
    var: VarId,
    fall: Fall,
    energy: Interval,
}

/// The allowed states of the instances of a kind.
#[derive(Debug, Clone, Default)]
struct Table {
    can_be_absent: bool,
    /// Whether the rows apply to all leaves.
    any_leaves: bool,
    groups: usize,
    /// The contribution of each leaf to the key of a combination.
    weights: Vec<usize>,
    /// The rows of each key; empty if there are too many keys.
    by_key: Vec<RowRange>,
    /// The rows by combination of leaves, if there are too many keys.
    listed: Vec<(Arc<[LeafId]>, RowRange)>,
    rows: Vec<Row>,
    grids: Vec<Grid>,
    checks: Vec<Check>,
    parts: Vec<Interval>,
    falls: Vec<Falling>,
    /// The distinct sets of spaces, indexed by space.
    space_sets: Vec<Vec<bool>>,
    /// The reachable region in each space, if known, and the condition under which it applies.
    regions: Vec<Option<Boxes>>,
    kept_out: KeptOut,
    /// The positions at which each contact query can hold.
    contacts: Vec<(TouchId, [Values; 2])>,
}

impl ConfigurationSpace {
    /// Builds the membership tables.
    pub fn membership(&self, program: &Program, world: WorldId) -> Membership {
        let table = &program.worlds[world];
        let mut tables: Vec<Table> = Vec::new();
        // Slots that are empty at the start share their tables.
        let mut known: HashMap<usize, Vec<(SlotId, usize)>> = HashMap::new();
        let of = table.slots.ids().map(|slot| {
            let first = self.slots[slot].configurations.first().map_or(0, |c| Arc::as_ptr(&c.numbers) as usize);
            let alike = known.entry(first).or_default();
            if let Some((_, number)) = alike.iter().find(|(other, _)| self.is_same(table, *other, slot)) {
                return *number;
            }
            alike.push((slot, tables.len()));
            tables.push(self.table(program, table, slot));
            tables.len() - 1
        });
        let of = of.collect();
        let finer = self.finer.as_ref().map(|finer| Box::new(finer.membership(program, world)));
        Membership { tables, of, finer }
    }

    /// Whether the results for two slots are identical.
    fn is_same(&self, world: &World, a: SlotId, b: SlotId) -> bool {
        let (one, other) = (&self.slots[a], &self.slots[b]);
        let shared = |(a, b): (&Configuration, &Configuration)| {
            a.shares(b) && a.leaves == b.leaves && a.timers == b.timers && a.spaces == b.spaces
        };
        world.slots[a].entity == world.slots[b].entity
            && world.slots[a].is_fixed == world.slots[b].is_fixed
            && (one.can_be_absent, one.is_given_up) == (other.can_be_absent, other.is_given_up)
            && one.configurations.len() == other.configurations.len()
            && one.configurations.iter().zip(&other.configurations).all(shared)
            && self.overall[a] == self.overall[b]
            && std::ptr::eq(self.surroundings.of(a), self.surroundings.of(b))
    }

    fn table(&self, program: &Program, world: &World, slot: SlotId) -> Table {
        let entity = &program.entities[world.slots[slot].entity];
        let SlotSpace { configurations, can_be_absent, is_given_up, .. } = &self.slots[slot];
        let mut out = Table {
            can_be_absent: *can_be_absent || *is_given_up,
            any_leaves: *is_given_up,
            groups: entity.groups.len(),
            ..Table::default()
        };
        let overall = &self.overall[slot];
        let params = if world.slots[slot].is_fixed { IdVec::new() } else { overall.params.clone() };
        if *is_given_up {
            // Bounds that hold in every step.
            let first = out.checks.len() as u32;
            overall.discretes.pairs().for_each(|(id, values)| out.check(Quantity::Discrete(id), *values));
            params.pairs().for_each(|(id, values)| out.check(Quantity::Param(id), *values));
            let checks = (first, out.checks.len() as u32);
            out.rows.push(Row { hull: [Interval::ALL; 2], checks, falls: (0, 0), spaces: ANYWHERE });
            out.by_key.push(RowRange { rows: (0, 1), grid: 0 });
            return out;
        }
        let mut order: Vec<&Configuration> = configurations.iter().collect();
        order.order_by(|a, b| a.leaves.cmp(&b.leaves));
        let keys = out.assign_weights(entity);
        for alike in order.chunk_by(|a, b| a.leaves == b.leaves) {
            let first = out.rows.len() as u32;
            for at in alike {
                out.row(at, &params, world.spaces.len());
            }
            let row_range = out.row_range((first, out.rows.len() as u32));
            let Some(leaves) = alike.first().map(|c| &c.leaves) else { continue };
            match keys {
                Some(count) => {
                    out.by_key.resize(count, RowRange::default());
                    let key: usize = leaves.iter().map(|leaf| out.weights[leaf.index()]).sum();
                    out.by_key[key] = row_range;
                }
                None => out.listed.push((leaves.clone(), row_range)),
            }
        }
        let regions = self.surroundings.regions(slot);
        if !regions.is_empty() {
            let region = |space: SpaceId| regions.iter().find(|(of, _)| *of == space);
            out.kept_out = self.surroundings.kept_out(slot).clone();
            out.regions = world.spaces.ids().map(|space| Some(Boxes::new(&region(space)?.1))).collect();
        }
        let contacts = entity.touches.ids().map(|touch| (touch, *self.surroundings.places(slot, touch)));
        out.contacts = contacts.filter(|(_, places)| places.iter().any(|p| *p != Values::all())).collect();
        out
    }
}

impl Table {
    /// Computes the weights of the leaves; returns the number of keys, or `None` if there are too many.
    fn assign_weights(&mut self, entity: &Entity) -> Option<usize> {
        self.weights = vec![0; entity.leaves.len()];
        let mut stride = 1_usize;
        for group in entity.groups.iter() {
            let leaves = entity.leaves.pairs().filter(|(_, l)| group.modes.contains(l.mode));
            let mut count = 0;
            for (leaf, _) in leaves {
                self.weights[leaf.index()] = count * stride;
                count += 1;
            }
            stride = stride.saturating_mul(count.max(1));
            if stride > MAX_KEYS {
                return None;
            }
        }
        Some(stride)
    }

    /// Adds a check of a number, unless everything is allowed.
    fn check(&mut self, of: Quantity, values: Values) {
        if values == Values::all() {
            return;
        }
        // An empty set allows nothing.
        let hull = values.hull().unwrap_or(Interval { low: f64::INFINITY, high: f64::NEG_INFINITY });
        let first = self.parts.len() as u32;
        if values.intervals().len() > 1 {
            self.parts.extend(values.intervals());
        }
        self.checks.push(Check { of, hull, parts: (first, self.parts.len() as u32) });
    }

    fn row(&mut self, at: &Configuration, params: &IdVec<ParamId, Values>, spaces: usize) {
        let (checks, falls) = (self.checks.len() as u32, self.falls.len() as u32);
        // Discrete variables first: they distinguish configurations of the same leaves.
        at.discretes.pairs().for_each(|(id, values)| self.check(Quantity::Discrete(id), *values));
        for (var, values) in at.vars.pairs() {
            for (degree, values) in (0..).zip(values) {
                // A position of one interval is checked by the hull.
                if var.index() >= 2 || degree > 0 || values.intervals().len() > 1 {
                    self.check(Quantity::Real(3 * var.0 + degree), *values);
                }
            }
        }
        at.timers.pairs().for_each(|(id, count)| self.check(Quantity::Timer(id), Values::from(*count)));
        for (id, values) in params.pairs() {
            // The values of the configuration are a subset of those of the slot.
            self.check(Quantity::Param(id), *at.params.get(id).unwrap_or(values));
        }
        for (var, energy) in at.energy.pairs() {
            let Some((fall, energy)) = *energy else { continue };
            self.falls.push(Falling { var, fall, energy });
        }
        let hull = VarId::XY.map(|var| {
            let none = Interval { low: f64::INFINITY, high: f64::NEG_INFINITY };
            at.vars.get(var).map_or(Interval::ALL, |values| values[0].hull().unwrap_or(none))
        });
        let spaces = self.space_set((0..spaces as u32).map(|space| at.spaces.contains(&SpaceId(space))).collect());
        let checks = (checks, self.checks.len() as u32);
        self.rows.push(Row { hull, checks, falls: (falls, self.falls.len() as u32), spaces });
    }

    fn space_set(&mut self, set: Vec<bool>) -> u32 {
        if set.iter().all(|is_in| *is_in) {
            return ANYWHERE;
        }
        let number = self.space_sets.iter().position(|known| *known == set).unwrap_or_else(|| {
            self.space_sets.push(set);
            self.space_sets.len() - 1
        });
        number as u32
    }

    /// Indexes rows by position if they are many.
    fn row_range(&mut self, rows: (u32, u32)) -> RowRange {
        if rows.1 - rows.0 > FEW_ROWS
            && let Some(grid) = Grid::new(&slice(&self.rows, rows).iter().map(|row| row.hull).collect::<Vec<_>>())
        {
            self.grids.push(grid);
            return RowRange { rows, grid: self.grids.len() as u32 };
        }
        RowRange { rows, grid: 0 }
    }

    /// The rows for the leaves of an instance.
    #[inline]
    fn row_range_of(&self, of: &impl Reading) -> RowRange {
        if self.any_leaves {
            return self.by_key.first().copied().unwrap_or_default();
        }
        let leaves = (0..self.groups).map(|group| of.leaf(GroupId(group as u32)));
        if self.listed.is_empty() {
            let key: usize = leaves.map(|leaf| self.weights.get(leaf.index()).map_or(0, |w| *w)).sum();
            self.by_key.get(key).copied().unwrap_or_default()
        } else {
            let found = self.listed.iter().find(|(known, _)| leaves.clone().eq(known.iter().copied()));
            found.map_or(RowRange::default(), |(_, row_range)| *row_range)
        }
    }

    /// Whether an instance is in one of the rows of its leaves.
    #[inline]
    fn is_in_rows(&self, at: [f64; 2], of: &impl Reading) -> bool {
        let row_range = self.row_range_of(of);
        let rows = slice(&self.rows, row_range.rows);
        match self.grids.get((row_range.grid as usize).wrapping_sub(1)) {
            None => rows.iter().any(|row| self.is_in_row(row, at, of)),
            Some(grid) => grid.around(at).iter().any(|row| self.is_in_row(&rows[*row as usize], at, of)),
        }
    }

    #[inline]
    fn passes(&self, check: &Check, of: &impl Reading) -> bool {
        let value = check.of.read(of);
        check.hull.contains(value)
            && (check.parts.0 == check.parts.1 || slice(&self.parts, check.parts).iter().any(|i| i.contains(value)))
    }

    #[inline]
    fn is_in_spaces(&self, row: &Row, space: SpaceId) -> bool {
        row.spaces == ANYWHERE
            || self
                .space_sets
                .get(row.spaces as usize)
                .and_then(|set| set.get(space.index()))
                .is_some_and(|is_in| *is_in)
    }

    #[inline]
    fn is_in_row(&self, row: &Row, at: [f64; 2], of: &impl Reading) -> bool {
        row.hull[0].contains(at[0])
            && row.hull[1].contains(at[1])
            && slice(&self.checks, row.checks).iter().all(|check| self.passes(check, of))
            && self.is_in_spaces(row, of.space())
            && slice(&self.falls, row.falls).iter().all(|falling| falling.holds(of))
    }

    #[inline]
    fn is_in_region(&self, at: [f64; 2], of: &impl Reading) -> bool {
        // For a space without a region, only the rows count.
        let region = self.regions.get(of.space().index()).and_then(Option::as_ref);
        region.is_none_or(|r| r.contains(at)) || !self.kept_out.holds(&|group| of.leaf(group))
    }

    #[inline]
    fn are_contacts_in_place(&self, at: [f64; 2], of: &impl Reading) -> bool {
        let is_there = |places: &[Values; 2]| places[0].contains(at[0]) && places[1].contains(at[1]);
        self.contacts.iter().all(|(touch, places)| !of.touch(*touch) || is_there(places))
    }

    #[inline]
    fn contains(&self, of: &impl Reading) -> bool {
        let at = [of.real(0), of.real(3)];
        self.is_in_rows(at, of) && self.is_in_region(at, of) && self.are_contacts_in_place(at, of)
    }

    /// The first failing check of a row, with its rank.
    fn first_failure(&self, row: &Row, entity: &Entity, world: &World, of: &impl Reading) -> Option<(usize, Beyond)> {
        let beyond = |place: Quantity, allowed: String| Beyond {
            variable: place.name(entity),
            value: place.read(of).to_string(),
            allowed,
        };
        let positions = [Quantity::Real(0), Quantity::Real(3)].into_iter().zip(&row.hull);
        let positions = positions.map(|(place, hull)| (hull.contains(place.read(of)), place, exact_text(&[*hull])));
        let checks = slice(&self.checks, row.checks).iter().map(|check| {
            let parts = slice(&self.parts, check.parts);
            let allowed = if parts.is_empty() { std::slice::from_ref(&check.hull) } else { parts };
            (self.passes(check, of), check.of, exact_text(allowed))
        });
        for (rank, (passes, place, allowed)) in positions.chain(checks).enumerate() {
            if !passes {
                return Some((rank, beyond(place, allowed)));
            }
        }
        let rank = 2 + slice(&self.checks, row.checks).len();
        if !self.is_in_spaces(row, of.space()) {
            let set = self.space_sets.get(row.spaces as usize);
            let allowed = set.map_or(Vec::new(), |set| {
                world.spaces.iter().zip(set).filter(|(_, is_in)| **is_in).map(|(s, _)| s.name.clone()).collect()
            });
            let (variable, value) = ("space".to_string(), world.spaces[of.space()].name.clone());
            return Some((rank, Beyond { variable, value, allowed: allowed.join(", ") }));
        }
        let falling = slice(&self.falls, row.falls).iter().find(|falling| !falling.holds(of))?;
        let name = &entity.vars[falling.var];
        let Fall { acceleration, step } = falling.fall;
        let variable = format!(
            "energy of {name} ({name}' * {name}' + {acceleration} * {step} * {name}' - 2 * {acceleration} * {name})"
        );
        let beyond = Beyond { variable, value: falling.now(of).to_string(), allowed: exact_text(&[falling.energy]) };
        Some((rank + 1, beyond))
    }

    /// The values of an instance that are outside; empty if it is inside.
    fn beyond(&self, entity: &Entity, world: &World, of: &impl Reading) -> Vec<Beyond> {
        if self.contains(of) {
            return Vec::new();
        }
        let rows = slice(&self.rows, self.row_range_of(of).rows);
        if rows.is_empty() {
            let modes = (0..self.groups).map(|group| mode(entity, of.leaf(GroupId(group as u32)))).collect::<Vec<_>>();
            let (variable, value) = ("combination of modes".to_string(), modes.join(", "));
            return vec![Beyond { variable, value, allowed: "never this one".to_string() }];
        }
        let failed: Vec<_> = rows.iter().map(|row| self.first_failure(row, entity, world, of)).collect();
        if failed.iter().all(Option::is_some) {
            let best = failed.iter().flatten().map(|(rank, _)| *rank).max();
            let mut out: Vec<Beyond> = Vec::new();
            for (_, beyond) in failed.into_iter().flatten().filter(|(rank, _)| Some(*rank) == best) {
                match out.iter_mut().find(|known| known.variable == beyond.variable) {
                    Some(known) if known.allowed.contains(&beyond.allowed) => {}
                    Some(known) => known.allowed = format!("{} or {}", known.allowed, beyond.allowed),
                    None => out.push(beyond),
                }
            }
            return out;
        }
        let at = [of.real(0), of.real(3)];
        let value = format!("({}, {})", at[0], at[1]);
        if !self.is_in_region(at, of) {
            let region = self.regions.get(of.space().index()).and_then(Option::as_ref);
            let allowed = region.map_or(String::new(), |region| region.text(at));
            return vec![Beyond { variable: "position".to_string(), value, allowed }];
        }
        let misplaced = self
            .contacts
            .iter()
            .filter(|(touch, places)| of.touch(*touch) && !(places[0].contains(at[0]) && places[1].contains(at[1])));
        let beyond = misplaced.map(|(touch, places)| Beyond {
            variable: format!("position while contact query {} holds", touch.index()),
            value: value.clone(),
            allowed: format!(
                "x in {} and y in {}",
                exact_text(places[0].intervals()),
                exact_text(places[1].intervals())
            ),
        });
        beyond.collect()
    }
}

impl Membership {
    /// Whether a slot can be empty.
    #[inline]
    pub fn can_be_absent(&self, slot: SlotId) -> bool {
        self.tables[self.of[slot]].can_be_absent && self.finer.as_ref().is_none_or(|finer| finer.can_be_absent(slot))
    }

    /// Whether the state of an instance is allowed.
    #[inline]
    pub fn contains(&self, slot: SlotId, of: &impl Reading) -> bool {
        self.tables[self.of[slot]].contains(of) && self.finer.as_ref().is_none_or(|finer| finer.contains(slot, of))
    }

    /// The values of a slot that are outside, if any; `of` is `None` if the slot is empty.
    pub fn outside(
        &self,
        program: &Program,
        world: WorldId,
        slot: SlotId,
        of: Option<&impl Reading>,
    ) -> Option<Outside> {
        let here = self.outside_here(program, world, slot, of);
        here.or_else(|| self.finer.as_ref().and_then(|finer| finer.outside(program, world, slot, of)))
    }

    fn outside_here(
        &self,
        program: &Program,
        world: WorldId,
        slot: SlotId,
        of: Option<&impl Reading>,
    ) -> Option<Outside> {
        let (world, table) = (&program.worlds[world], &self.tables[self.of[slot]]);
        let entity = &program.entities[world.slots[slot].entity];
        let instance = world.slots[slot].name.clone();
        let Some(of) = of else {
            let (variable, value) = ("instance".to_string(), "absent".to_string());
            let beyond = vec![Beyond { variable, value, allowed: "always present".to_string() }];
            return (!table.can_be_absent).then_some(Outside { instance, modes: Vec::new(), beyond });
        };
        let beyond = table.beyond(entity, world, of);
        let modes = || entity.groups.ids().map(|group| mode(entity, of.leaf(group))).collect();
        (!beyond.is_empty()).then(|| Outside { instance, modes: modes(), beyond })
    }
}

impl Falling {
    fn reals(&self, of: &impl Reading) -> (f64, f64) {
        (of.real(3 * self.var.index()), of.real(3 * self.var.index() + 1))
    }

    /// Its current energy, with rounding errors.
    fn now(&self, of: &impl Reading) -> f64 {
        let (position, velocity) = self.reals(of);
        let Fall { acceleration, step } = self.fall;
        velocity * velocity + acceleration * step * velocity - 2.0 * acceleration * position
    }

    #[inline]
    fn holds(&self, of: &impl Reading) -> bool {
        self.energy.contains(self.now(of)) || {
            let (position, velocity) = self.reals(of);
            let margined = self.fall.energy(Interval::point(position), Interval::point(velocity));
            margined.and(self.energy).is_some()
        }
    }
}

fn mode(entity: &Entity, leaf: LeafId) -> String {
    entity.modes[entity.leaves[leaf].mode].path.clone()
}
