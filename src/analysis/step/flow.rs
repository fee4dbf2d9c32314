//! The continuous phase over configurations: flows, envelopes, clamps, timers, and the effect of collisions.

use crate::ir::{By, Drive, Envelope, ExprId, Extremes, IdVec, Release, TimerId, VarId};

use crate::analysis::domain::configuration::Configuration;
use crate::analysis::domain::energy::Fall;
use crate::analysis::domain::values::{Interval, Values};
use crate::analysis::domain::widen::within_bounds;
use crate::analysis::geometry::seam::bring_in;
use crate::analysis::geometry::surroundings::Motion;
use crate::analysis::step::evaluate::Reader;
use crate::analysis::step::{Beginning, FlowCache, Outcome, Stepper, shift};

impl Stepper<'_> {
    /// Runs the continuous phase, with a cache: most branches of a step do not differ in anything that it depends on.
    pub(in crate::analysis) fn cached_flow(
        &self,
        next: &Configuration,
        beginning: Beginning,
        flow_cache: &mut FlowCache,
        outcome: &mut Outcome,
    ) -> Vec<Configuration> {
        let Some(flow_groups) = self.flow_groups.filter(|_| !beginning.is_put) else {
            return self.flow(next, beginning, outcome);
        };
        let same = |known: &Configuration| {
            let alike = |groups: &[bool]| {
                let leaves = known.leaves.iter().zip(&*next.leaves).zip(groups);
                leaves.into_iter().all(|((a, b), counts)| !counts || a == b)
            };
            alike(flow_groups)
                && self.collider_groups.is_none_or(alike)
                && known.spaces == next.spaces
                && known.trace == next.trace
                && (known.shares(next) || known.numbers == next.numbers)
        };
        if let Some((_, found)) = flow_cache.iter().find(|(known, _)| same(known)) {
            return found.clone();
        }
        let found = self.flow(next, beginning, outcome);
        flow_cache.push((next.clone(), found.clone()));
        found
    }

    /// The timers one step later.
    pub(in crate::analysis) fn time(&self, next: &Configuration) -> IdVec<TimerId, Interval> {
        let entity = self.entity();
        let limits = &self.reader.world.slots[self.slot].timer_limits;
        let later = |(id, count): (TimerId, &Interval)| {
            let inside = entity.modes[entity.timers[id].mode].leaves;
            let limit = f64::from(limits[id]);
            match next.leaves.iter().any(|l| inside.contains(*l)) {
                true => Interval { low: (count.low + 1.0).least(limit), high: (count.high + 1.0).least(limit) },
                false => *count,
            }
        };
        next.timers.pairs().map(later).collect()
    }

    /// Flows, envelopes, clamps and collisions.
    fn flow(&self, next: &Configuration, beginning: Beginning, outcome: &mut Outcome) -> Vec<Configuration> {
        let entity = self.entity();
        let Beginning { displacement, is_put } = beginning;
        let reader = self.flowing_at(next, is_put);
        let mut drives: IdVec<VarId, Drive> = entity.vars.ids().map(Drive::Coast).collect();
        let active = next.leaves.iter().flat_map(|l| &entity.leaves[*l].drives);
        for drive in entity.free.iter().chain(active) {
            match *drive {
                Drive::Coast(_) => {}
                Drive::Flow { var, .. } => drives[var] = *drive,
                Drive::Envelope(id, component) => {
                    drives[entity.envelopes[id].vars[usize::from(component)]] = *drive;
                }
            }
        }
        // A drive of an outer mode is not active where the group says "no flow": the leaf wins.
        for drive in next.leaves.iter().flat_map(|l| &entity.leaves[*l].drives) {
            if let Drive::Coast(var) = *drive {
                drives[var] = Drive::Coast(var);
            }
        }
        let bounds: Vec<(Values, Values)> = entity
            .clamps
            .iter()
            .map(|c| {
                let end = |e: Option<ExprId>, none: f64| e.map_or(Values::point(none), |e| reader.number(e));
                (end(c.low, f64::NEG_INFINITY), end(c.high, f64::INFINITY))
            })
            .collect();
        let clip = |var: VarId, degree: u8, values: Values| {
            let own = entity.clamps.iter().zip(&bounds).filter(|(c, _)| c.var == var && c.degree == degree);
            own.fold(values, |values, (_, (low, high))| {
                values.pairs(low, Interval::greatest).pairs(high, Interval::least)
            })
        };
        let dt = Interval::point(self.step);
        let mut moved = next.clone();
        for (var, drive) in drives.pairs() {
            let [position, velocity, acceleration] = &next.vars[var];
            let (degree, value) = match *drive {
                Drive::Coast(_) => (2, *acceleration),
                Drive::Flow { degree, value, .. } => (degree, reader.number(value)),
                Drive::Envelope(id, component) => {
                    let envelope = &entity.envelopes[id];
                    (envelope.degree, self.envelope(&reader, envelope, usize::from(component)))
                }
            };
            let times = |values: &Values| values.map(|i| i.times(dt));
            let new = match degree {
                0 => [clip(var, 0, value), clip(var, 1, Values::point(0.0)), Values::point(0.0)],
                _ => {
                    let (velocity, acceleration) = match degree {
                        1 => (value, Values::point(0.0)),
                        _ => (velocity.pairs(&times(&value), Interval::plus), value),
                    };
                    let velocity = clip(var, 1, velocity);
                    [clip(var, 0, position.pairs(&times(&velocity), Interval::plus)), velocity, acceleration]
                }
            };
            moved.vars[var] = new;
            // Where falls are told apart, it would tell nothing more.
            if self.grids.is_some() {
                moved.forget_energy(var);
                continue;
            }
            let fall = self.fall(*drive, &moved.vars[var][2]);
            moved.energy[var] = fall.and_then(|fall| Some((fall, self.energy_after(next, &moved, var, fall)?)));
        }
        let mut by = [Interval::point(0.0); 2];
        let mut step = [None; 2];
        let mut speeds = [0.0_f64; 2];
        for (axis, speed) in speeds.iter_mut().enumerate() {
            let var = VarId::XY[axis];
            // If the position itself is driven or clamped, it moves by the distance between its ends.
            let way = shift(next, &moved, var);
            let far = way.high.greatest(-way.low) / self.step;
            let velocity = moved.vars[var][1].hull().map_or(0.0, |v| v.high.greatest(-v.low));
            let is_put = matches!(drives[var], Drive::Flow { degree: 0, .. })
                || matches!(drives[var], Drive::Envelope(id, _) if entity.envelopes[id].degree == 0)
                || entity.clamps.iter().any(|c| c.var == var && c.degree == 0);
            *speed = if is_put { far } else { velocity };
            let by_velocity = moved.vars[var][1].hull().map_or(Interval::point(0.0), |v| v.times(dt));
            by[axis] = if is_put { way } else { by_velocity };
            step[axis] = (!is_put).then_some(self.step);
        }
        let far =
            [0, 1].map(|axis| moved.vars[VarId(axis)][1].hull().map_or(0.0, |v| v.high.greatest(-v.low) * self.step));
        let own = [0, 1].map(|axis| displacement[axis].plus(by[axis]));
        let motion = Motion { from: VarId::XY.map(|var| next.vars[var][0]), own, by, step, far };
        let begin = VarId::XY.map(|var| next.vars[var][0]);
        let apart = self.grids.and_then(|grids| {
            let surroundings = self.reader.surroundings;
            Some((
                VarId::XY.map(|var| moved.vars[var][0]),
                surroundings.collide_apart(self.slot, &motion, &moved, grids)?,
            ))
        });
        let (contact, all) = apart.unwrap_or_else(|| {
            let contact = self.reader.surroundings.collide(self.reader.world, self.slot, motion, &mut moved);
            moved.trace = None;
            (contact, vec![moved])
        });
        let greatest = |known: &mut [f64; 2]| *known = [known[0].greatest(speeds[0]), known[1].greatest(speeds[1])];
        greatest(&mut outcome.speed);
        // A step that leaves the area of the obstacles, or crosses it, counts as near them.
        let crossed = [0, 1].map(|axis| Values::any(begin[axis].or(&contact[axis]).hull()));
        if self.reader.surroundings.is_near_statics(self.slot, &crossed) {
            greatest(&mut outcome.near_speed);
        }
        for (known, at) in outcome.contact.iter_mut().zip(contact) {
            *known = known.or(&at);
        }
        let ended = |mut moved: Configuration| {
            bring_in(self.reader.world, &mut moved);
            let mut moved = within_bounds(self.reader.world, self.slot, moved);
            if self.grids.is_none() {
                moved.sharpen();
            }
            (!moved.is_impossible()).then_some(moved)
        };
        all.into_iter().filter_map(ended).collect()
    }

    /// The free fall of a drive with a constant acceleration.
    fn fall(&self, drive: Drive, acceleration: &Values) -> Option<Fall> {
        let accelerates = matches!(drive, Drive::Coast(_) | Drive::Flow { degree: 2, .. });
        let acceleration = acceleration.constant().filter(|a| accelerates && *a != 0.0)?;
        Some(Fall { acceleration, step: self.step })
    }

    /// The energy after a step of free fall.
    fn energy_after(&self, next: &Configuration, moved: &Configuration, var: VarId, fall: Fall) -> Option<Interval> {
        let (position, velocity) = (next.vars[var][0].hull()?, next.vars[var][1].hull()?);
        let mut energy = match next.energy[var] {
            Some((before, energy)) if before == fall => energy,
            Some((before, energy)) => before.converted(energy, fall, position, velocity),
            None => fall.energy(position, velocity),
        };
        // If a clamp applies, the energy is that of the clamped values.
        for clamp in self.entity().clamps.iter().filter(|c| c.var == var) {
            if clamp.degree == 0 {
                return None;
            }
            let at = moved.vars[var][0].hull()?;
            for (end, is_low) in [(clamp.low, true), (clamp.high, false)] {
                let end = end.and_then(|end| self.flowing_at(next, true).number(end).hull());
                energy = end.map_or(energy, |end| fall.cut(energy, at, end, is_low));
            }
        }
        (energy.low.is_finite() || energy.high.is_finite()).then_some(energy)
    }

    /// The values of a component of an envelope after a step.
    fn envelope(&self, reader: &Reader<'_>, envelope: &Envelope, component: usize) -> Values {
        let Some((_, at)) = reader.me else { return Values::all() };
        let sustain = reader.number(envelope.sustain);
        let level = match &envelope.release {
            Release::To { level, .. } => reader.number(*level),
            Release::Hold => Values::point(0.0),
        };
        if matches!(envelope.by, By::Clock { .. }) {
            let hull = sustain.hull().zip(level.hull()).map(|(a, b)| a.or(b));
            return hull.map_or(Values::none(), Values::from);
        }
        let Some(&var) = envelope.vars.get(component) else { return Values::all() };
        let current = at.vars[var][usize::from(envelope.degree)];
        let has_player = self.reader.world.slots[self.slot].player.is_some();
        let may_drive = has_player && envelope.guard.is_none_or(|g| reader.truth(g).can_hold);
        let mut out = Values::none();
        if may_drive {
            let levels = envelope.peak.map_or(sustain, |p| reader.number(p).or(&sustain));
            let target = match envelope.by {
                By::Button(_) if component == 0 => levels,
                By::Button(_) => Values::point(0.0),
                By::Axis(_) => levels.mirrored(),
                _ => Values::any(levels.mirrored().hull())
                    .or(&Values::point(0.0))
                    .hull()
                    .map_or(Values::none(), Values::from),
            };
            for rate in [envelope.attack].into_iter().chain(envelope.peak.map(|_| envelope.decay)) {
                out = out.or(&self.approached(reader, &current, &target, rate));
            }
        }
        match &envelope.release {
            Release::Hold => out.or(&current),
            Release::To { rate, .. } => {
                let target = level.mirrored().or(&Values::point(0.0));
                // A vector approaches a level along its own direction.
                let target = match envelope.vars.len() {
                    1 => target,
                    _ => target.hull().map_or(Values::none(), Values::from),
                };
                let target = if level == Values::point(0.0) { Values::point(0.0) } else { target };
                out.or(&self.approached(reader, &current, &target, *rate))
            }
        }
    }

    /// Moves from some values towards others by at most the rate of a step.
    fn approached(&self, reader: &Reader<'_>, current: &Values, target: &Values, rate: Option<ExprId>) -> Values {
        let Some(rate) = rate else { return *target };
        let Some(rate) = reader.number(rate).hull() else { return Values::none() };
        let most = rate.high.abs().greatest(rate.low.abs()) * self.step;
        if rate.low < 0.0 {
            // Away from the target.
            return current.map(|i| Interval { low: i.low - most, high: i.high + most }).or(target);
        }
        current.pairs(target, |from, to| Interval {
            low: if to.low < from.low { to.low.greatest(from.low - most) } else { from.low.least(to.high) },
            high: if to.high > from.high { to.high.least(from.high + most) } else { from.high.greatest(to.low) },
        })
    }
}
