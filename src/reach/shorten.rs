//! Makes a plan shorter and simpler: removes parts, merges neighbours and cuts times while the rest still reaches the
//! goal. Every candidate is replayed.

use crate::sim::{Script, ScriptStep};
use crate::watch::{Meter, Watch};

use super::luck::only_read;
use super::outcome::Plan;
use super::problem::Problem;
use super::search_context::replays_to;
use super::start_hold::is_held;

/// Approximate maximum number of simulated steps.
const MAX_STEPS: u64 = 10_000_000;

/// Shortens a plan until no single change improves it, or the watch stops it. A plan is better if it has no more steps
/// and no more changes of inputs, and fewer of one of them. Steps before the start of the search are kept, and inputs
/// are held for their minimum time.
#[must_use]
pub fn shorten(problem: &Problem<'_>, plan: &Plan, watch: &dyn Watch) -> Plan {
    let kept = plan.after;
    let mut scratch = problem.sim.scratch();
    let meter = Meter::new(watch);
    let (prefix, mut best) = split(&plan.script, kept);
    // The steps up to the goal, if they reach it.
    let mut attempt = |steps: &[ScriptStep]| -> Option<Vec<ScriptStep>> {
        let mut script = prefix.clone();
        steps.iter().for_each(|s| script.push(&s.input, s.count));
        let length = replays_to(problem, &script, kept, &mut scratch, &meter)?;
        let mut cut = Script::default();
        let mut left = length - kept;
        for step in steps {
            let count = u64::from(step.count).min(left) as u32;
            cut.push(&step.input, count);
            left -= u64::from(count);
        }
        let mut whole = prefix.clone();
        cut.steps.iter().for_each(|s| whole.push(&s.input, s.count));
        is_held(&whole, kept, problem.min_hold()).then_some(cut.steps)
    };
    let cost = |steps: &[ScriptStep]| (steps.len(), steps.iter().map(|s| u64::from(s.count)).sum::<u64>());
    let better = |new: &[ScriptStep], old: &[ScriptStep]| {
        let (new, old) = (cost(new), cost(old));
        new.0 <= old.0 && new.1 <= old.1 && new != old
    };
    let mut changed = true;
    let mut left = MAX_STEPS;
    while std::mem::take(&mut changed) && left > 0 {
        let mut at = 0;
        while at < best.len() && left > 0 {
            let found = variants(&best, at).into_iter().find_map(|steps| {
                if meter.spend(0) || watch.stop() {
                    left = 0;
                }
                if left == 0 || !better(&steps, &best) {
                    return None;
                }
                left = left.saturating_sub(plan.steps);
                attempt(&steps).filter(|steps| better(steps, &best))
            });
            match found {
                Some(steps) => {
                    best = steps;
                    changed = true;
                }
                None => at += 1,
            }
        }
    }
    let mut script = prefix;
    best.iter().for_each(|s| script.push(&s.input, s.count));
    if script == plan.script {
        return plan.clone();
    }
    // A plan as short as a shortest one is a shortest one.
    let steps = script.len();
    // Other steps read what nature draws.
    let script = match problem.sim.draws() {
        [] => script,
        _ => match only_read(problem, &script, kept, &Meter::new(watch)) {
            Some(script) => script,
            None => return plan.clone(),
        },
    };
    Plan { is_shortest: plan.is_shortest && steps == plan.steps, steps, script, after: kept }
}

/// Splits a script after some steps.
fn split(script: &Script, kept: u64) -> (Script, Vec<ScriptStep>) {
    let (mut prefix, mut rest) = (Script::default(), Vec::new());
    let mut left = kept;
    for step in &script.steps {
        let count = u64::from(step.count).min(left) as u32;
        prefix.push(&step.input, count);
        left -= u64::from(count);
        if step.count > count {
            rest.push(ScriptStep { input: step.input.clone(), count: step.count - count });
        }
    }
    (prefix, rest)
}

/// Possible changes at an index of a plan, the boldest first.
fn variants(steps: &[ScriptStep], at: usize) -> Vec<Vec<ScriptStep>> {
    let mut out = Vec::new();
    let with = |change: &dyn Fn(&mut Vec<ScriptStep>)| {
        let mut steps = steps.to_vec();
        change(&mut steps);
        // Equal neighbours are merged.
        let mut script = Script::default();
        steps.iter().filter(|s| s.count > 0).for_each(|s| script.push(&s.input, s.count));
        script.steps
    };
    // Detours are several steps long (as in delta debugging: Zeller and Hildebrandt, 2002).
    let mut run = steps.len() / 2;
    while run > 1 {
        if at + run <= steps.len() {
            out.push(with(&|s| drop(s.drain(at..at + run))));
        }
        run = if run > 8 { run / 2 } else { run - 1 };
    }
    out.push(with(&|s| drop(s.remove(at))));
    for neighbour in [at.checked_sub(1), Some(at + 1)].into_iter().flatten().filter(|n| *n < steps.len()) {
        out.push(with(&|s| s[at].input = s[neighbour].input.clone()));
    }
    let count = steps[at].count;
    for cut in [count / 2, count / 4, 8, 4, 2, 1] {
        if 0 < cut && cut < count {
            out.push(with(&|s| s[at].count -= cut));
        }
    }
    // Moving a change of inputs can make room.
    if at + 1 < steps.len() {
        for moved in [8, 4, 2, 1] {
            if moved < count {
                out.push(with(&|s| {
                    s[at].count -= moved;
                    s[at + 1].count += moved;
                }));
            }
            if moved < steps[at + 1].count {
                out.push(with(&|s| {
                    s[at].count += moved;
                    s[at + 1].count -= moved;
                }));
            }
        }
    }
    out
}
