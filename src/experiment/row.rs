//! A row of a table: statistics of the runs of one setup on one question.

use serde::Serialize;

use super::{Finding, Run};
use crate::reach::wilson_95;

/// The middle of some numbers, in two ways.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Spread {
    /// Their sum by their count.
    pub mean: f64,
    /// Half of them are at most this; between the two in the middle where there are two.
    pub median: f64,
}

impl Spread {
    /// The spread of numbers in any order; none if there are none.
    pub fn of(mut numbers: Vec<f64>) -> Option<Spread> {
        numbers.sort_by(f64::total_cmp);
        let half = numbers.len() / 2;
        let upper = *numbers.get(half)?;
        let median = if numbers.len() % 2 == 1 { upper } else { (numbers[half - 1] + upper) / 2.0 };
        Some(Spread { mean: numbers.iter().sum::<f64>() / numbers.len() as f64, median })
    }
}

/// Statistics of the runs of a setup on a question.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// The index of the question.
    pub question: usize,
    /// The index of the setup.
    pub setup: usize,
    /// Number of runs: fewer than seeds if the experiment was stopped.
    pub runs: u32,
    /// Number of runs that reached the goal.
    pub successes: u32,
    /// Number of runs that ran out of memory.
    pub out_of_memory: u32,
    /// Nodes over all runs.
    pub nodes: Option<Spread>,
    /// Nodes of the runs that reached the goal.
    pub goal_nodes: Option<Spread>,
    /// Seconds of the runs that reached the goal.
    pub goal_seconds: Option<Spread>,
    /// Steps of the paths.
    pub path_steps: Option<Spread>,
    /// Over all runs; none if the measured time is zero.
    pub extensions_per_second: Option<f64>,
}

impl Row {
    /// The row of a setup on a question; other runs are ignored.
    pub fn of(question: usize, setup: usize, runs: &[Run]) -> Row {
        let mine: Vec<&Run> = runs.iter().filter(|r| r.question == question && r.setup == setup).collect();
        let reached: Vec<&Run> = mine.iter().copied().filter(|r| r.finding == Finding::Reached).collect();
        let spread = |runs: &[&Run], number: fn(&Run) -> f64| Spread::of(runs.iter().map(|r| number(r)).collect());
        let (extensions, seconds) =
            mine.iter().fold((0, 0.0), |(extensions, seconds), r| (extensions + r.extensions, seconds + r.seconds));
        Row {
            question,
            setup,
            runs: mine.len() as u32,
            successes: reached.len() as u32,
            out_of_memory: mine.iter().filter(|r| r.finding == Finding::OutOfMemory).count() as u32,
            nodes: spread(&mine, |r| r.nodes as f64),
            goal_nodes: spread(&reached, |r| r.nodes as f64),
            goal_seconds: spread(&reached, |r| r.seconds),
            path_steps: spread(&reached, |r| r.path_steps.unwrap_or(0) as f64),
            extensions_per_second: (seconds > 0.0).then(|| extensions as f64 / seconds),
        }
    }

    /// The confidence interval (95 %) of the planner's success rate.
    pub fn success_rate_95(&self) -> Option<[f64; 2]> {
        wilson_95(u64::from(self.successes), u64::from(self.runs))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(setup: usize, finding: Finding, nodes: u64, seconds: f64) -> Run {
        let path_steps = (finding == Finding::Reached).then_some(2 * nodes);
        Run {
            question: 0,
            setup,
            seed: 1,
            finding,
            nodes,
            trees: 1,
            extensions: 10 * nodes,
            steps: 0,
            seconds,
            path_steps,
        }
    }

    #[test]
    fn the_median_is_in_the_middle_whatever_the_order() {
        assert_eq!(Spread::of(vec![9.0, 1.0, 2.0]), Some(Spread { mean: 4.0, median: 2.0 }));
        assert_eq!(Spread::of(vec![8.0, 1.0, 4.0, 3.0]), Some(Spread { mean: 4.0, median: 3.5 }));
        assert_eq!(Spread::of(Vec::new()), None);
    }

    #[test]
    fn only_runs_that_reached_the_goal_count_at_the_goal() {
        let runs = [
            run(0, Finding::Reached, 10, 0.5),
            run(0, Finding::NotFound, 100, 1.0),
            run(1, Finding::Reached, 1000, 7.0),
            run(0, Finding::OutOfMemory, 40, 0.5),
        ];
        let row = Row::of(0, 0, &runs);
        assert_eq!((row.runs, row.successes, row.out_of_memory), (3, 1, 1));
        assert_eq!(row.nodes, Some(Spread { mean: 50.0, median: 40.0 }));
        assert_eq!(row.goal_nodes, Some(Spread { mean: 10.0, median: 10.0 }));
        assert_eq!(row.goal_seconds, Some(Spread { mean: 0.5, median: 0.5 }));
        assert_eq!(row.path_steps, Some(Spread { mean: 20.0, median: 20.0 }));
        assert_eq!(row.extensions_per_second, Some(1500.0 / 2.0));
        assert_eq!(Row::of(1, 0, &runs).nodes, None);
    }

    #[test]
    fn the_interval_is_wilsons() {
        // 27 of 50, worked out by hand.
        let row = Row { runs: 50, successes: 27, ..Row::of(0, 0, &[]) };
        let [low, high] = row.success_rate_95().unwrap();
        assert!((low - 0.4040).abs() < 1e-4 && (high - 0.6703).abs() < 1e-4, "{low} {high}");
        let none = Row { successes: 0, ..row };
        assert!(none.success_rate_95().unwrap()[0] < 1e-12);
        assert_eq!(Row::of(0, 0, &[]).success_rate_95(), None);
    }
}
