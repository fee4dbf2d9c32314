//! Shards: one query on many levels in several parts, each for one machine and with a file of its own. Decides which
//! questions a shard has, and describes it in the header of its file, by which [`super::merge`] knows what is missing.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::row::Key;

/// The version of the header.
pub const SHARD_VERSION: u32 = 1;

/// One of several parts of a run, `3/8`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Shard {
    /// Which one, from 1.
    pub index: u32,
    /// The number of all.
    pub count: u32,
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

impl Shard {
    /// Reads `3/8`.
    ///
    /// # Errors
    /// What is wrong with it, and how it is written.
    pub fn read(text: &str) -> Result<Shard, String> {
        let form = || "a shard is written `I/N`: `3/8` is the third of eight".to_string();
        let (index, count) = text.split_once('/').ok_or_else(form)?;
        let number = |text: &str| {
            let is_number = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
            is_number.then(|| text.parse::<u32>().unwrap_or(u32::MAX)).ok_or_else(form)
        };
        match (number(index)?, number(count)?) {
            (_, 0) => Err("a run has at least one shard: `1/1` is all of it".to_string()),
            (0, count) => Err(format!(
                "shards are numbered from 1: the first is `1/{count}`; where a scheduler counts from 0, add 1"
            )),
            (index, count) if index > count => {
                Err(format!("there is no shard {index} of {count}: the last one is `{count}/{count}`"))
            }
            (index, count) => Ok(Shard { index, count }),
        }
    }
}

/// The first line of a shard's file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct ShardHeader {
    /// [`SHARD_VERSION`]. The first field, as readers tell the lines of a file apart by it.
    pub shard: u32,
    /// Which shard of how many.
    #[serde(flatten)]
    pub of: Shard,
    /// The path of the program as it was given.
    pub file: String,
    /// The world.
    pub world: String,
    /// A hash of what the program means, whatever the level.
    pub program_sha256: String,
    /// A hash of all questions and of how they are divided among the shards.
    pub plan_sha256: String,
    /// The number of questions of all shards.
    pub questions: usize,
    /// The questions of this shard, in the order of their rows.
    pub part: Vec<PlannedQuestion>,
}

/// A question of a shard.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct PlannedQuestion {
    /// Its place among the questions of all shards, from 0.
    pub at: usize,
    /// Which question.
    #[serde(flatten)]
    pub key: Key,
}

/// Divides questions among shards by their estimated costs in seconds: the most expensive first, each to the shard that
/// has least to do. Returns the shard of each question, from 1.
///
/// A question without an estimate counts as the median. Equal costs are divided by turns, and with at least as many
/// questions as shards none is without one. The result depends on nothing else, so that all machines divide alike.
pub fn shards(costs: &[Option<f64>], count: u32) -> Vec<u32> {
    // Integers: sums do not depend on their order.
    let cost = |seconds: f64| (seconds.clamp(0.0, 1e9) * 1e6) as u64;
    let mut known: Vec<u64> = costs.iter().flatten().copied().map(cost).collect();
    known.sort_unstable();
    let median = known.get(known.len() / 2).copied().unwrap_or(1);
    let mut order: Vec<(u64, usize)> =
        costs.iter().map(|known| known.map_or(median, cost)).enumerate().map(|(at, cost)| (cost, at)).collect();
    order.sort_unstable_by_key(|&(cost, at)| (Reverse(cost), at));
    let mut loads: BinaryHeap<Reverse<(u64, usize, u32)>> =
        (1..=count.max(1)).map(|shard| Reverse((0, 0, shard))).collect();
    let mut found = vec![1; costs.len()];
    for (cost, at) in order {
        let Some(Reverse((load, questions, shard))) = loads.pop() else { break };
        found[at] = shard;
        loads.push(Reverse((load.saturating_add(cost), questions + 1, shard)));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shard_is_read_as_it_is_written() {
        for text in ["1/1", "3/8", "8/8", "4000000000/4000000000"] {
            assert_eq!(Shard::read(text).unwrap().to_string(), text);
        }
        for (text, why) in [
            ("", "is written `I/N`"),
            ("3", "is written `I/N`"),
            ("3/", "is written `I/N`"),
            ("/8", "is written `I/N`"),
            ("-1/8", "is written `I/N`"),
            ("+1/8", "is written `I/N`"),
            ("1/8/2", "is written `I/N`"),
            ("a/b", "is written `I/N`"),
            ("0/8", "the first is `1/8`"),
            ("9/8", "the last one is `8/8`"),
            ("0/0", "at least one shard"),
            ("99999999999999999999/8", "the last one is `8/8`"),
        ] {
            let error = Shard::read(text).unwrap_err();
            assert!(error.contains(why), "{text}: {error}");
        }
    }

    #[test]
    fn questions_without_costs_are_divided_by_turns() {
        assert_eq!(shards(&[None; 7], 3), [1, 2, 3, 1, 2, 3, 1]);
        assert_eq!(shards(&[Some(0.0); 5], 2), [1, 2, 1, 2, 1]);
        assert_eq!(shards(&[], 4), [0; 0]);
        assert_eq!(shards(&[None; 3], 1), [1, 1, 1]);
    }

    #[test]
    fn expensive_questions_come_first() {
        // 9, 5 + 3 + 2 and 4 + 4: the unknown one counts as the median, 4.
        let costs = [Some(2.0), Some(9.0), Some(3.0), None, Some(4.0), Some(5.0)];
        let found = shards(&costs, 3);
        let load = |shard: u32| {
            let own = found.iter().zip(&costs).filter(|(of, _)| **of == shard);
            own.map(|(_, cost)| cost.unwrap_or(4.0)).sum::<f64>()
        };
        assert_eq!((1..=3).map(load).collect::<Vec<_>>(), [9.0, 10.0, 8.0], "{found:?}");
    }

    mod properties {
        use proptest::prelude::*;

        use super::*;

        /// Costs as they may be in any file, also one of other levels or with odd numbers.
        fn costs() -> impl Strategy<Value = Vec<Option<f64>>> {
            let cost = prop_oneof![
                2 => Just(None),
                4 => (0.0..100.0).prop_map(Some),
                1 => prop::sample::select(vec![0.0, -1.0, f64::MAX, f64::INFINITY, f64::NAN]).prop_map(Some),
            ];
            prop::collection::vec(cost, 0..200)
        }

        proptest! {
            #[test]
            fn each_question_has_one_shard(costs in costs(), count in 1_u32..70) {
                let found = shards(&costs, count);
                prop_assert_eq!(found.len(), costs.len());
                prop_assert!(found.iter().all(|shard| (1..=count).contains(shard)));
                // None is idle if there are enough questions.
                let used = (1..=count).filter(|shard| found.contains(shard)).count();
                prop_assert_eq!(used, costs.len().min(count as usize));
                prop_assert_eq!(&found, &shards(&costs, count));
            }

            #[test]
            fn no_shard_has_much_more_than_another(
                costs in prop::collection::vec((0.01..100.0).prop_map(Some), 1..100),
                count in 1_u32..20,
            ) {
                let found = shards(&costs, count);
                let load = |shard: u32| -> f64 {
                    found.iter().zip(&costs).filter(|(of, _)| **of == shard).filter_map(|(_, cost)| *cost).sum()
                };
                let loads: Vec<f64> = (1..=count).map(load).collect();
                let greatest = costs.iter().flatten().copied().max_by(f64::total_cmp).unwrap_or(0.0);
                let least = loads.iter().copied().min_by(f64::total_cmp).unwrap_or(0.0);
                prop_assert!(loads.iter().all(|load| *load <= least + greatest + 1e-3), "{loads:?}");
            }
        }
    }
}
