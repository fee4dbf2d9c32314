//! The search for the smallest change: samples over the whole range, then ever closer between a value that turns the
//! answer and one that does not.

use crate::ir::Extremes;
use crate::reach::Conclusion;

use super::axis::{Way, joint_ways, single_ways};
use super::oracle::Oracle;
use super::record::{Change, Part, Tuned};
use super::{Host, Question, Wanted};

/// How often the way of the smallest change on a way of changes is made faster.
const MAX_IMPROVEMENTS: usize = 6;
/// Relative tolerance for sizes of changes that are equal.
const ROUNDING: f64 = 1e-9;

/// The smallest change of one of the numbers that turns the answer; if none does alone, the smallest one of several together.
///
/// What is found is what was tried: a change that is not listed can do it, too.
pub fn tune(host: &dyn Host, question: &Question) -> Tuned {
    let mut oracle = Oracle::new(host, question);
    let base: Vec<f64> = question.axes.iter().map(|axis| axis.base).collect();
    let start = oracle.judge(&base);
    if start.is_none() || oracle.found.is_wanted_already() || oracle.found.trials.iter().any(|t| t.error.is_some()) {
        return oracle.found;
    }
    let singles = single_ways(&question.axes);
    let mut change = smallest(&mut oracle, &singles);
    if change.is_none() && question.axes.len() > 1 {
        change = smallest(&mut oracle, &joint_ways(&question.axes));
    }
    for number in 0..question.axes.len() {
        oracle.prove_parts(number);
    }
    let mut found = oracle.found;
    if found.refuted.is_some() {
        withdraw(&mut found, question);
        change = change.filter(|change| found.trials[change.trial].is_wanted);
    }
    found.change =
        change.map(|change| Change { is_proven_smallest: is_proven_smallest(&found, &change, &singles), ..change });
    found
}

/// Drops what rests on an analysis that a run refutes.
fn withdraw(found: &mut Tuned, question: &Question) {
    found.parts.clear();
    for trial in found.trials.iter_mut().filter(|trial| trial.proven_by.is_some()) {
        trial.proven_by = None;
        trial.verdict = Conclusion::NotAnswered;
        trial.reasons.clear();
        trial.is_wanted &= question.wanted == Wanted::Reached;
    }
}

/// The smallest change on some ways.
fn smallest(oracle: &mut Oracle<'_>, ways: &[Way]) -> Option<Change> {
    let samples = oracle.question.samples.max(1);
    let far = ways.iter().filter_map(|way| way.points.last()).map(|(_, size)| *size).fold(0.0, f64::greatest);
    // The points of each way that were tried, with their trials.
    let mut tried: Vec<Vec<(usize, usize)>> = vec![Vec::new(); ways.len()];
    for level in 1..=samples {
        let size = far * level as f64 / samples as f64;
        for (number, way) in ways.iter().enumerate() {
            let count = way.points.partition_point(|(_, of)| *of <= size * (1.0 + ROUNDING));
            let Some(at) = count.checked_sub(1).filter(|at| tried[number].last().is_none_or(|(last, _)| last < at))
            else {
                continue;
            };
            let Some(trial) = oracle.judge(&way.points[at].0) else { return best(oracle, ways, &tried) };
            tried[number].push((at, trial));
        }
    }
    oracle.replay_all();
    // Closer and closer, where the smallest change can be.
    for (number, way) in ways.iter().enumerate() {
        let mut improvements = 0;
        loop {
            let turned = tried[number].iter().position(|(_, trial)| oracle.found.trials[*trial].is_wanted);
            let Some(turned) = turned else { break };
            let upper = tried[number][turned].0;
            let lower = turned.checked_sub(1).map(|before| tried[number][before].0);
            let least = lower.map_or(0.0, |lower| way.points[lower].1);
            let known = best(oracle, ways, &tried).map_or(f64::INFINITY, |change| change.size);
            let middle = lower.map_or(upper / 2, |lower| lower.midpoint(upper));
            if least >= known || middle == upper {
                break;
            }
            if let Some(before) = turned.checked_sub(1).filter(|_| lower == Some(middle)) {
                // A faster way can work at smaller values.
                let (before, turned) = (tried[number][before].1, tried[number][turned].1);
                improvements += 1;
                if improvements > MAX_IMPROVEMENTS || !(oracle.improve(turned) && oracle.replay(before)) {
                    break;
                }
                for &(_, trial) in &tried[number] {
                    oracle.replay(trial);
                }
                continue;
            }
            let Some(trial) = oracle.judge(&way.points[middle].0) else { return best(oracle, ways, &tried) };
            tried[number].insert(turned, (middle, trial));
        }
    }
    best(oracle, ways, &tried)
}

/// The smallest change that is known.
fn best(oracle: &Oracle<'_>, ways: &[Way], tried: &[Vec<(usize, usize)>]) -> Option<Change> {
    let changes = ways.iter().zip(tried).filter_map(|(way, tried)| {
        let turned = tried.iter().position(|(_, trial)| oracle.found.trials[*trial].is_wanted)?;
        let before = turned.checked_sub(1).map_or(0, |before| tried[before].1);
        let (at, trial) = tried[turned];
        Some(Change { trial, size: way.points[at].1, before, is_proven_smallest: false })
    });
    changes.min_by(|a, b| a.size.total_cmp(&b.size))
}

/// Whether every smaller change of one number is proven not to turn the answer, up to the next smaller one that was tried.
fn is_proven_smallest(found: &Tuned, change: &Change, singles: &[Way]) -> bool {
    let values = &found.trials[change.trial].values;
    let changes = |at: &usize| values[*at] != found.axes[*at].base;
    let mut changed = (0..values.len()).filter(changes);
    let (Some(number), None) = (changed.next(), changed.next()) else { return false };
    let before = found.trials[change.before].values[number];
    singles.iter().all(|way| {
        let Some(&at) = way.changes.first() else { return false };
        let base = found.axes[at].base;
        // Of the way of the change itself up to the value before it; of others, all that is smaller.
        let is_own = at == number && way.points.iter().any(|(point, _)| point == values);
        let end = match is_own {
            true => before,
            false => {
                let mut smaller = way.points.iter().filter(|(_, size)| *size < change.size);
                smaller.next_back().map_or(base, |(point, _)| point[at])
            }
        };
        let (low, high) = (base.least(end), base.greatest(end));
        found.parts.iter().any(|Part { number, from, to }| *number == at && *from <= low && high <= *to)
    })
}
