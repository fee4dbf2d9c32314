//! Configurations of an instance told apart by the courses of its falls: a second analysis of one instance, among others
//! of which the first has found what they can do.
//!
//! How far a jump leads depends on how long it lasts, and so on the relation of height, speed and way, which intervals
//! alone do not know. Here a fall is followed step by step from where it begins: at a push along y, or where an edge sets
//! the height or the velocity. Configurations are joined only if as many steps have passed since the same beginning, and
//! only where they lie side by side along x. The dynamics are monotonic, so the ends of the joined heights and velocities
//! are those of real falls. What neither rises nor falls may have moved along for any time, with any speed: it is widened to
//! all places up to the next edge. This is trace partitioning (Rival and Mauborgne, *The trace partitioning abstract
//! domain*, TOPLAS 2007) by the last event that began a fall.
//!
//! Where modes change, as a button is let go, the steps until then and since are told apart, for players, as long as it still
//! rises. Where events would tell little, as it comes down after that, modes have changed again or a fall begins at many
//! heights, the state does: falls are told apart by rows of heights and by ranges of velocities as large as what a step
//! changes, so that a range becomes the next one. What falls at one velocity is told apart by rows alone: of two at a place
//! the higher one gets further.

mod course;
mod parts;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use hashbrown::HashMap;

use crate::ir::{EntityId, Expr, Extremes, LeafId, Origin, SlotId, Subject, VarId};

use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::values::{Interval, Values};
use crate::analysis::fixpoint::Analysis;
use crate::analysis::geometry::grid::{Grid, THIN};
use crate::analysis::geometry::surroundings::Surroundings;
use crate::analysis::step::Stepper;
use crate::analysis::step::evaluate::Reader;

use course::{Course, Phase, beginning, pushed, single};
use parts::{NOWHERE, Part, joined, overlay, placed};

/// Maximum number of steps of a fall.
const MAX_AGE: u32 = 1 << 12;
/// Maximum number of cells of the spaces of a world.
const MAX_CELLS: usize = 1 << 18;

/// After how many steps along a run it is widened to all of it.
const PATIENCE: u32 = 16;

/// How far below everything falls are still followed, px.
const BELOW: f64 = 256.0;
/// To what the heights are widened at which a fall begins, px.
const STEP: f64 = 4.0;

/// The courses that were found.
struct Flights<'a> {
    slot: SlotId,
    is_player: bool,
    stepper: Stepper<'a>,
    analysis: &'a Analysis<'a>,
    grids: &'a [Grid],
    /// All values while some leaves are active.
    known: BTreeMap<Arc<[LeafId]>, Configuration>,
    numbers: HashMap<Course, usize>,
    /// How often what stays on a run of a course, by where that begins, has moved on along it.
    grown: HashMap<(usize, u64), u32>,
    /// Of each course: its parts, in order along x and apart.
    courses: Vec<(Course, Vec<Part>)>,
    /// The courses with parts that are to be stepped, in this order.
    due: BTreeSet<(Turn, usize)>,
}

/// When a course is stepped: first what was widened, then the steps of falls one after the other, from fast to slow, and last
/// what goes on steadily, from its highest row down. So most of what is joined is there before it is stepped.
type Turn = (bool, u8, i64);

impl Analysis<'_> {
    /// The configurations of the players, told apart; `goes_on` is asked before each of them. `None` if that is not possible
    /// for any, or too much.
    pub(in crate::analysis) fn by_flight(
        &mut self,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Option<Vec<(SlotId, Vec<Configuration>)>> {
        let players: Vec<SlotId> = self.world.players.iter().map(|player| player.slot).collect();
        let falls = |slot: &SlotId| {
            let known = self.slots[*slot].configurations.values();
            known.into_iter().any(|growing| growing.at.vars[VarId::Y][2] != Values::point(0.0))
        };
        if players.is_empty() || !players.iter().all(|slot| self.begins_once(*slot) && falls(slot)) {
            return None;
        }
        // Those that players meet come first: where they are tells where contacts with them can be.
        let mut met: BTreeSet<usize> = BTreeSet::new();
        for slot in &players {
            met.extend(Surroundings::asked_kinds(&self.scene, *slot));
        }
        let is_player = |slot: SlotId| self.world.slots[slot].player.is_some();
        let named = self.program.with_operands(self.forbidden.predicates.to_vec()).into_iter();
        let mut named = named.filter_map(|id| self.program.exprs[id].subject());
        let names_others = named.any(|of| matches!(of, Subject::Slot(slot) if !is_player(slot)));
        let mut others: BTreeMap<usize, Vec<Configuration>> = BTreeMap::new();
        for kind in met {
            let slots = self.scene.kinds[kind].slots.clone();
            let live: Vec<SlotId> = slots.into_iter().filter(|slot| self.overall[*slot].can_live).collect();
            if live.iter().any(|slot| !self.begins_once(*slot)) {
                continue;
            }
            let can_be_alike = !names_others && !self.looks_around(self.scene.kinds[kind].entity);
            let mut groups: Vec<Vec<SlotId>> = Vec::new();
            for slot in live {
                match groups.iter_mut().find(|group| can_be_alike && self.are_alike(group[0], slot)) {
                    Some(group) => group.push(slot),
                    None => groups.push(vec![slot]),
                }
            }
            let found: Option<Vec<_>> = groups.iter().map(|group| self.flown(kind, group, &others, goes_on)).collect();
            others.extend(found.map(|found| (kind, found.concat())));
        }
        let mut out = Vec::new();
        for slot in players {
            out.push((slot, self.flown(self.scene.of[slot], &[slot], &others, goes_on)?));
        }
        Some(out)
    }

    /// Whether a slot holds an instance from the start, and none later.
    fn begins_once(&self, slot: SlotId) -> bool {
        let begun = &self.world.slots[slot];
        let is_spawned = self.program.entities.iter().any(|of| of.spawns.iter().any(|s| s.entity == begun.entity));
        !self.slots[slot].is_given_up
            && (begun.origin == Origin::Named || (begun.origin == Origin::Tile && !is_spawned))
    }

    /// Whether instances of an entity look for others: none finds itself.
    fn looks_around(&self, entity: EntityId) -> bool {
        let asked = self.program.with_operands(self.program.entities[entity].exprs());
        asked.iter().any(|id| matches!(self.program.exprs[*id], Expr::Probe { .. } | Expr::Nearest { .. }))
    }

    /// Whether two slots of a kind differ only in where they begin, if nothing tells them from each other.
    fn are_alike(&self, a: SlotId, b: SlotId) -> bool {
        let [one, other] = [a, b].map(|slot| &self.world.slots[slot]);
        let [known, also] = [a, b].map(|slot| &self.overall[slot]);
        one.origin == Origin::Tile
            && other.origin == Origin::Tile
            && one.timer_limits == other.timer_limits
            && self.limits[a] == self.limits[b]
            && known.params == also.params
            && known.spaces == also.spaces
    }

    /// The configurations of some slots of a kind, which differ only in where they begin, told apart, among others that
    /// are.
    fn flown(
        &mut self,
        kind: usize,
        slots: &[SlotId],
        others: &BTreeMap<usize, Vec<Configuration>>,
        goes_on: &mut dyn FnMut() -> bool,
    ) -> Option<Vec<Configuration>> {
        let grids = self.scene.grids(kind, MAX_CELLS)?;
        let mut surroundings = Surroundings::new(&mut self.scene, &self.overall);
        if !slots.iter().all(|slot| surroundings.can_tell_apart(*slot)) {
            return None;
        }
        surroundings.tell_others(&self.scene, slots[0], others);
        let begins = slots.iter().flat_map(|slot| self.begins(*slot)).collect();
        flights(self, &surroundings, slots, (&grids, begins), goes_on)
    }
}

/// The configurations of some slots that differ only in where they begin, told apart. `None` if it does not go on, or
/// if the watch stops it.
fn flights<'a>(
    analysis: &'a Analysis<'a>,
    surroundings: &'a Surroundings,
    slots: &[SlotId],
    (grids, begins): (&'a [Grid], Vec<Configuration>),
    goes_on: &mut dyn FnMut() -> bool,
) -> Option<Vec<Configuration>> {
    let slot = slots[0];
    let stepper = analysis.stepper(slot);
    let stepper = Stepper { reader: Reader { surroundings, ..stepper.reader }, grids: Some(grids), ..stepper };
    let mut known: BTreeMap<Arc<[LeafId]>, Configuration> = BTreeMap::new();
    for ((leaves, _), growing) in slots.iter().flat_map(|slot| &analysis.slots[*slot].configurations) {
        let joined = known.get(leaves).map_or_else(|| growing.at.clone(), |known| known.or(&growing.at));
        known.insert(leaves.clone(), joined);
    }
    let (numbers, grown, courses, due) = (HashMap::new(), HashMap::new(), Vec::new(), BTreeSet::new());
    let mut flights = Flights {
        slot,
        is_player: analysis.world.slots[slot].player.is_some(),
        stepper,
        analysis,
        grids,
        known,
        numbers,
        grown,
        courses,
        due,
    };
    for begin in begins {
        flights.grow(begin, None)?;
    }
    while let Some((_, number)) = flights.due.pop_first() {
        let (course, parts) = &mut flights.courses[number];
        let course = course.clone();
        let due =
            parts.iter_mut().filter_map(|part| std::mem::take(&mut part.is_due).then(|| placed(&part.at, part.x)));
        let due: Vec<Configuration> = due.collect();
        for at in due {
            if !goes_on() || analysis.watch.stop() {
                return None;
            }
            flights.step((&course, number), at)?;
        }
    }
    Some(flights.courses.into_iter().flat_map(|(_, parts)| parts).map(|part| placed(&part.at, part.x)).collect())
}

impl Flights<'_> {
    /// Adds the successors of a configuration of a course.
    fn step(&mut self, (course, number): (&Course, usize), at: Configuration) -> Option<()> {
        let outcome = self.stepper.run(&at)?;
        let after = |mut next: Configuration| -> Vec<(Course, Configuration)> {
            let (Some(y), Some(first)) = (next.vars[VarId::Y][0].hull(), beginning(&next)) else { return Vec::new() };
            let y = self.grid(&next).map_or(y, |grid| grid.snapped(1, y));
            next.set(VarId::Y, 0, Values::from(y));
            course::after((course, &at), (next, y, first), (self.stepper.step, self.is_player))
        };
        let all = outcome.next.into_iter().flat_map(single).flat_map(after);
        // In a row, what falls stays in its course, too.
        let may_stay = matches!(course.2, Phase::Since(..));
        let (own, others): (Vec<_>, Vec<_>) = all.partition(|(of, _)| may_stay && of == course);
        for (_, next) in own {
            for wide in self.widened(number, next) {
                self.grow(wide, Some((course.clone(), true)))?;
            }
        }
        // What is wider includes it, and is stepped instead.
        let x = at.vars[VarId::X][0].hull();
        let is_in = |part: &&Part| x.is_some_and(|x| part.x.low <= x.low && x.high <= part.x.high);
        let mut wider = self.courses[number].1.iter().filter(|part| part.is_due).filter(is_in);
        let is_widened = wider.any(|part| placed(&at, NOWHERE).is_within(&part.at));
        for (of, next) in others.into_iter().filter(|_| !is_widened) {
            self.grow(next, Some((of, false)))?;
        }
        Some(())
    }

    /// Adds what is new of a configuration to its course.
    fn grow(&mut self, mut found: Configuration, of: Option<(Course, bool)>) -> Option<()> {
        // What is disturbed by the next step is told anew.
        if let Some(trace) = &mut found.trace {
            trace.is_disturbed = false;
        }
        if !self.analysis.restrict(self.slot, &mut found) {
            return Some(());
        }
        let hulls = VarId::XY.map(|var| found.vars[var][0].hull());
        let ([Some(x), Some(y)], Some(first)) = (hulls, beginning(&found)) else { return Some(()) };
        let [mut x, y] = self.grid(&found).map_or([x, y], |grid| [grid.snapped(0, x), grid.snapped(1, y)]);
        let begins = of.as_ref().is_none_or(|((.., phase), _)| matches!(phase, Phase::Since(_, 0)));
        let y = if begins { self.widened_up([x, y], &found) } else { y };
        found.set(VarId::Y, 0, Values::from(y));
        let new = || ((found.leaves.clone(), pushed(&found), Phase::Since(first, 0)), false);
        let (mut course, is_wide) = of.unwrap_or_else(new);
        let is_below = self.grid(&found).is_some_and(|grid| y.high < grid.bottom() - BELOW);
        if let Some(known) = self.known.get(&found.leaves).filter(|_| is_below) {
            // Nothing is there that it could meet.
            let (trace, [_, velocity, _]) = (found.trace, found.vars[VarId::Y]);
            found = joined(&found, known);
            (found.trace, x) = (trace, Interval::ALL);
            found.set(VarId::Y, 0, Values::from(Interval { low: f64::NEG_INFINITY, high: y.high }));
            // A body that falls goes on to.
            let ends = velocity.hull().zip(known.vars[VarId::Y][1].hull());
            if let Some((own, known)) = ends.filter(|(own, _)| own.high < 0.0) {
                found.set(VarId::Y, 1, Values::from(Interval { low: known.low.least(own.low), high: own.high }));
            }
            course = (found.leaves.clone(), pushed(&found), Phase::Since((i64::MIN, [true; 2]), 0));
        } else if !self.is_player {
            // Others need not be told apart as finely.
            x = Interval { low: x.low.floor(), high: x.high.ceil() };
        }
        if matches!(course.2, Phase::Since(_, MAX_AGE..) | Phase::Turned(_, _, MAX_AGE..)) {
            return None;
        }
        let number = match self.numbers.get(&course) {
            Some(number) => *number,
            None => {
                self.numbers.insert(course.clone(), self.courses.len());
                self.courses.push((course, Vec::new()));
                self.courses.len() - 1
            }
        };
        let ((.., phase), parts) = &mut self.courses[number];
        found.set(VarId::X, 0, Values::from(NOWHERE));
        if overlay(parts, x, &found) {
            let turn = match *phase {
                Phase::Since(_, age) => (!is_wide, 0, i64::from(age)),
                Phase::Turned(_, turn, age) => (!is_wide, 0, i64::from(turn) + i64::from(age)),
                Phase::Within(_, range) => (!is_wide, 1, range.saturating_neg()),
                Phase::Steady(row, _) => (!is_wide, 2, row.saturating_neg()),
            };
            self.due.insert((turn, number));
        }
        Some(())
    }

    /// The heights at which a fall begins, in whole rows: they grow in few steps.
    fn widened_up(&self, [x, y]: [Interval; 2], at: &Configuration) -> Interval {
        let wide = Interval { low: (y.low / STEP).floor() * STEP, high: (y.high / STEP).ceil() * STEP };
        let is_free = |grid: &Grid| grid.parts([x, wide]).iter().all(|(_, is_blocked)| !is_blocked);
        let is_wide = y.high - y.low > THIN * STEP && self.grid(at).is_some_and(is_free);
        if is_wide { wide } else { y }
    }

    /// The cells of the space that a configuration is in.
    fn grid(&self, at: &Configuration) -> Option<&Grid> {
        let space = at.spaces.first().filter(|_| at.spaces.len() == 1)?;
        self.grids.iter().find(|grid| grid.space == *space)
    }

    /// All that a configuration may become that neither rises nor falls: at any place up to the next edge, with any values
    /// of its modes.
    fn widened(&mut self, number: usize, found: Configuration) -> Vec<Configuration> {
        let hulls = VarId::XY.map(|var| found.vars[var][0].hull());
        let (Some(grid), [Some(x), Some(y)]) = (self.grid(&found), hulls) else { return vec![found] };
        let runs = grid.runs([x, y]);
        let mut wide = found.clone();
        if let Some(known) = self.known.get(&found.leaves) {
            for (var, values) in known.vars.pairs().filter(|(var, _)| *var != VarId::Y) {
                for (degree, all) in values.iter().enumerate().skip(usize::from(var == VarId::X)) {
                    wide.set(var, degree, all.or(&found.vars[var][degree]));
                }
            }
            known.discretes.pairs().for_each(|(id, values)| wide.set_discrete(id, values.or(&found.discretes[id])));
            wide.timers = known.timers.iter().zip(found.timers.iter()).map(|(a, b)| a.or(*b)).collect();
        }
        let runs = runs.into_iter();
        runs.map(|(run, part)| {
            // What only touches the next run is not on it.
            let mut is_there = part.high - part.low > 4.0 * THIN;
            if is_there {
                let grown = self.grown.entry((number, run.low.to_bits())).or_default();
                *grown += 1;
                is_there = *grown > PATIENCE;
            }
            let mut at = if is_there { wide.clone() } else { found.clone() };
            at.set(VarId::X, 0, Values::from(if is_there { run.or(part) } else { part }));
            at
        })
        .collect()
    }
}
