//! How a path is to be played: fast, calmly, or with few changes of inputs. Orders plans, and searches for better ones
//! before they are shortened (`shorten.rs`).

use crate::analysis::ConfigurationSpace;
use crate::sim::ScriptStep;
use crate::watch::{Meter, Watch};

use super::coverage::mix;
use super::distance::DistanceField;
use super::improve_duration::improve_duration;
use super::outcome::{Plan, Verdict};
use super::planners::Planner;
use super::problem::Problem;
use super::search::{Limits, Settings, search};
use super::shorten::{MAX_STEPS, shorten, shorten_within, split};

/// What counts in a path, the first first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Style {
    /// The time, then the number of changes of inputs.
    #[default]
    Fast,
    /// How often an input is held for less than 0.2 s, then the number of changes, then the time.
    Calm,
    /// The number of changes of inputs, then the time.
    FewInputs,
}

/// What is held for at least as long is not in haste, s.
const CALM_SECONDS: f64 = 0.2;
/// How long a path may take that is not for the fastest, in percent of the fastest that is known.
const SLOWER: u64 = 150;
/// The holds of the searches for such paths, steps, and their planners.
const SEARCHES: [(Planner, (u16, u16)); 6] = [
    (Planner::TimeGuided, (12, 12)),
    (Planner::TimeGuided, (24, 24)),
    (Planner::DistanceGuided, (12, 60)),
    (Planner::DistanceGuided, (24, 120)),
    (Planner::Coverage, (24, 120)),
    (Planner::TimeGuided, (16, 16)),
];
/// The divisor of the node budget for one of them, and the maximum number of its nodes.
const SHARE: u64 = 8;
const MAX_NODES: u64 = 50_000;
/// Maximum number of steps that are simulated to make one of their paths simpler.
const SHORTENED: u64 = 300_000;

impl Style {
    /// All styles.
    pub const ALL: [Style; 3] = [Style::Fast, Style::Calm, Style::FewInputs];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Style::Fast => "fast",
            Style::Calm => "calm",
            Style::FewInputs => "few-inputs",
        }
    }

    /// The cost of the parts of a script in a world with steps of some length (s): less is better, the first number first.
    pub(super) fn cost(self, parts: &[ScriptStep], step: f64) -> [u64; 3] {
        let (changes, steps) = (parts.len() as u64, parts.iter().map(|part| u64::from(part.count)).sum());
        match self {
            Style::Fast => [steps, changes, 0],
            Style::FewInputs => [changes, steps, 0],
            Style::Calm => {
                let calm = CALM_SECONDS / step;
                let held = &parts[..parts.len().saturating_sub(1)];
                let hasty = held.iter().filter(|part| f64::from(part.count) < calm).count();
                [hasty as u64, changes, steps]
            }
        }
    }

    /// The number of steps that a path may take instead of one with a number of them.
    pub(super) fn most_steps(self, steps: u64) -> u64 {
        match self {
            Style::Fast => steps,
            Style::Calm | Style::FewInputs => steps * SLOWER / 100,
        }
    }
}

/// A better plan in a style, made as simple as possible; all searches for it together take at most twice the nodes of
/// `limits`, of the fastest not more than those.
#[must_use]
pub fn improve_style(
    problem: &Problem<'_>,
    space: &ConfigurationSpace,
    settings: &Settings,
    limits: &Limits,
    plan: &Plan,
    style: Style,
    watch: &dyn Watch,
) -> Plan {
    let fast = improve_duration(problem, space, settings, limits, plan, watch);
    if style == Style::Fast {
        return shorten(problem, space, &fast, style, watch);
    }
    let most = style.most_steps(fast.steps - fast.after);
    let most = u32::try_from(most).unwrap_or(u32::MAX).min(problem.time().unwrap_or(u32::MAX));
    let limited = problem.clone().within(most);
    let step = problem.sim.world().step.seconds();
    let cost = |plan: &Plan| style.cost(&split(&plan.script, plan.after).1, step);
    let distances = DistanceField::new(&limited, space, &Meter::new(watch));
    let shorter = |plan: &Plan, by, most| shorten_within(&limited, distances.as_ref(), plan, by, most, watch);
    // What one style makes simple, the other may make simpler than from where it was.
    let other = if style == Style::Calm { Style::FewInputs } else { Style::Calm };
    let simple = |plan: &Plan, most| {
        let own = shorter(plan, style, most);
        let both = shorter(&shorter(plan, other, most), style, most);
        if cost(&both) < cost(&own) { both } else { own }
    };
    let mut best = simple(&fast, SHORTENED);
    for (round, (planner, hold)) in (1..).zip(SEARCHES) {
        if watch.stop() {
            break;
        }
        let nodes = (limits.nodes / SHARE).clamp(1, MAX_NODES);
        let seed = mix(settings.seed, round);
        // Who has chosen a planner keeps it.
        let planner = if settings.planner == Planner::Auto { planner } else { settings.planner };
        let settings = Settings { planner, seed, hold: Some(hold), records: false, explains: false, ..*settings };
        let Ok(outcome) = search(&limited, space, &settings, &Limits { nodes, ..*limits }, watch) else { continue };
        if let Verdict::Reached(found) = outcome.verdict {
            let found = simple(&found, SHORTENED);
            if cost(&found) < cost(&best) {
                best = found;
            }
        }
    }
    best = simple(&best, MAX_STEPS);
    // Only without the limit it is known.
    Plan { is_shortest: plan.is_shortest && best.steps == plan.steps, ..best }
}
