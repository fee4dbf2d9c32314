//! Proves parts of the range of a number: one analysis for all of its values.

use std::sync::Arc;

use crate::analysis::{ConfigurationSpace, Interval, ParamRange, Varied};
use crate::ir::{EntityId, Expr, Extremes, Id, IdVec, Layout, ParamId, Program, World, WorldId};
use crate::json;
use crate::reach::query::ProofMethod;
use crate::reach::{Conclusion, Limits, Monitor, Refutation, Target, search};
use crate::sim::Simulator;
use crate::watch::Watch;

use super::Built;
use super::axis::Axis;
use super::oracle::Oracle;
use super::record::{Part, Trial};

/// Maximum number of analyses of parts of the range of a number.
const MAX_ANALYSES: usize = 24;
/// How often the end of a proven part is moved towards the next value that is not proven.
const MOVES: usize = 6;
/// Number of nodes of a search whose states are compared with the argument for a part.
const CHECKED_NODES: u64 = 2_000;

impl Oracle<'_> {
    /// Proves parts of the range of a number, in which all values that were tried are proven.
    pub fn prove_parts(&mut self, number: usize) {
        let mut known = self.on_line(number);
        known.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut prover = Prover { oracle: self, number, analyses: 0 };
        let mut parts: Vec<(f64, f64)> = Vec::new();
        for run in known.chunk_by(|a, b| a.1 == b.1).filter(|run| run.first().is_some_and(|(_, is_proven)| *is_proven))
        {
            let values: Vec<f64> = run.iter().map(|(value, _)| *value).collect();
            prover.prove_run(&values, &mut parts);
        }
        // Towards values at which nothing is known.
        for part in &mut parts {
            let above = known.iter().find(|(value, _)| *value > part.1).map(|(value, _)| *value);
            let below = known.iter().rev().find(|(value, _)| *value < part.0).map(|(value, _)| *value);
            if let Some(above) = above {
                part.1 = prover.moved(part.0, part.1, above);
            }
            if let Some(below) = below {
                part.0 = prover.moved(part.1, part.0, below);
            }
        }
        parts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let joined = joined(&parts);
        self.found.parts.extend(joined.into_iter().map(|(from, to)| Part { number, from, to }));
    }

    /// The values of a number that were tried while all others were as the program has them, each with whether the
    /// analysis proves that there is no way.
    fn on_line(&self, number: usize) -> Vec<(f64, bool)> {
        let axes = &self.question.axes;
        let is_there = |trial: &&Trial| {
            let same = |at: usize| at == number || trial.values[at] == axes[at].base;
            trial.error.is_none() && (0..axes.len()).all(same)
        };
        let is_proven = |trial: &Trial| {
            trial.verdict == Conclusion::ProvenUnreachable && trial.proven_by == Some(ProofMethod::Analysis)
        };
        self.found.trials.iter().filter(is_there).map(|trial| (trial.values[number], is_proven(trial))).collect()
    }

    /// Whether no value between two of a number reaches the goal, with these two values and the others as the program has
    /// them. False if that is not proven.
    fn is_proven(&mut self, number: usize, (from, to): (f64, f64)) -> bool {
        let axes = &self.question.axes;
        let with = |value: f64| -> Vec<f64> {
            let value = |(at, axis): (usize, &Axis)| if at == number { value } else { axis.base };
            axes.iter().enumerate().map(value).collect()
        };
        let (Ok(low), Ok(high)) = (self.build(&with(from)), self.build(&with(to))) else { return false };
        let Some(range) = range(&low, &high, &axes[number]) else { return false };
        let label = format!("{}={}..{}", axes[number].name, Axis::text(from), Axis::text(to));
        let mut proof = None;
        self.host.watched(&label, &mut |watch| {
            proof = self.proof(&low, range, watch).map(|space| {
                // As every search, with what the proof rests on: at both ends.
                [&low, &high].map(|built| (self.checked(built, &space, watch), built.clone()))
            });
        });
        if self.host.is_stopped() {
            self.found.is_stopped = true;
            return false;
        }
        let Some(checks) = proof else { return false };
        for (refutation, built) in checks {
            if let Some(refutation) = refutation {
                self.found.refuted.get_or_insert((refutation, built));
                return false;
            }
        }
        true
    }

    /// The configuration space in which the goal never holds.
    fn proof(&self, built: &Built, range: ParamRange, watch: &dyn Watch) -> Option<ConfigurationSpace> {
        let query = &self.question.query;
        let table = &built.program.worlds[built.world];
        let varied = Varied::new(&built.program, built.world, &[range])?;
        // As for one value: a `never` counts in the state that ends the run, too.
        let (varied, rules, holds) = match *query.targets.first()? {
            Target::Goal(goal) => (varied, query.rules(table), table.goals[goal].holds),
            Target::Never(never) => (varied.endless(), Vec::new(), table.nevers[never].holds),
        };
        let space = varied.space(&rules, watch);
        if !varied.can_hold(&space, holds) {
            return Some(space);
        }
        let finer = varied.by_place(space, &rules, watch);
        (!varied.can_hold(&finer, holds)).then_some(finer)
    }

    /// A run of one of the programs that is outside of the space for all of them, if a short search meets one.
    fn checked(&self, built: &Built, space: &ConfigurationSpace, watch: &dyn Watch) -> Option<Refutation> {
        let query = &self.question.query;
        let sim = Simulator::new(&built.program, built.world);
        let monitor = Monitor::new(space, &built.program, built.world);
        let problem = query.problem(&sim, *query.targets.first()?, watch).ok()??.monitored(&monitor);
        let limits = Limits { nodes: CHECKED_NODES.min(query.limits.nodes), ..query.limits };
        // A fault ends a run.
        let _ = search(&problem, space, &query.settings, &limits, watch);
        monitor.refutation()
    }
}

/// Proves intervals of one number.
struct Prover<'o, 'h> {
    oracle: &'o mut Oracle<'h>,
    number: usize,
    analyses: usize,
}

impl Prover<'_, '_> {
    fn prove(&mut self, from: f64, to: f64) -> bool {
        self.analyses += 1;
        self.analyses <= MAX_ANALYSES && self.oracle.is_proven(self.number, (from, to))
    }

    /// Proves what lies between some values, each of which is proven: all together, or else each half.
    fn prove_run(&mut self, values: &[f64], parts: &mut Vec<(f64, f64)>) {
        let (Some(&first), Some(&last)) = (values.first(), values.last()) else { return };
        if first == last || self.prove(first, last) {
            parts.push((first, last));
            return;
        }
        if values.len() == 2 {
            parts.extend([(first, first), (last, last)]);
            return;
        }
        let middle = values.len() / 2;
        self.prove_run(&values[..=middle], parts);
        self.prove_run(&values[middle..], parts);
    }

    /// The end of a proven part, moved towards a value that is not proven as far as the proof holds.
    fn moved(&mut self, other_end: f64, end: f64, towards: f64) -> f64 {
        let axis = self.oracle.question.axes[self.number].clone();
        let (mut proven, mut open) = (end, towards);
        for _ in 0..MOVES {
            let middle = axis.between(proven, open);
            let Some(middle) = middle else { break };
            let (from, to) = if other_end <= middle { (other_end, middle) } else { (middle, other_end) };
            match self.prove(from, to) {
                true => proven = middle,
                false => open = middle,
            }
        }
        proven
    }
}

/// Parts that share an end, as one.
fn joined(parts: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut joined: Vec<(f64, f64)> = Vec::new();
    for &(from, to) in parts {
        match joined.last_mut() {
            Some(last) if from <= last.1 => last.1 = last.1.greatest(to),
            _ => joined.push((from, to)),
        }
    }
    joined
}

/// The range of a parameter, given the programs with its ends; `None` if it is no parameter, or if the programs differ in
/// anything else.
fn range(low: &Built, high: &Built, axis: &Axis) -> Option<ParamRange> {
    let (entity, name) = axis.name.split_once('.')?;
    let (entity, world) = (low.program.entity_named(entity)?, low.world);
    let param = low.program.entities[entity].param_named(name)?;
    let default = |built: &Built| {
        let default = built.program.entities.get(entity)?.params.get(param)?.default;
        built.program.constant(default, &IdVec::new(), built.program.worlds.get(world)?.step)
    };
    let (a, b) = (default(low)?, default(high)?);
    let is_same = low.world == high.world
        && comparable(&low.program, world, (entity, param))? == comparable(&high.program, world, (entity, param))?;
    is_same.then_some(ParamRange { entity, param, values: Interval { low: a.least(b), high: a.greatest(b) } })
}

/// A program as text, without the default of a parameter and the first values of instances, which follow from it.
fn comparable(program: &Program, world: WorldId, (entity, param): (EntityId, ParamId)) -> Option<Vec<u8>> {
    let mut program = program.meaning();
    let default = program.entities[entity].params[param].default;
    program.exprs[default] = Expr::Number(0.0);
    let table: &mut World = Arc::make_mut(&mut program.worlds[world]);
    table.layout = Layout::default();
    for slot in table.slots.iter_mut().filter(|slot| slot.entity == entity) {
        slot.params.iter_mut().for_each(|value| *value = 0.0);
        slot.timer_limits.iter_mut().for_each(|limit| *limit = 0);
        // Positions are given.
        for (var, values) in slot.vars.ids().collect::<Vec<_>>().into_iter().zip(slot.vars.iter_mut()) {
            if var.index() >= 2 {
                values[0] = 0.0;
            }
        }
    }
    json::bytes(&program, json::Layout::Compact).ok()
}
