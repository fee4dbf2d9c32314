//! What followed the last words where they occur before: exactly the same words, and words of the same classes.

use std::collections::BTreeMap;

use super::reading::{Reading, Word};

/// The lengths of contexts that are counted.
pub(super) const ORDERS: usize = 4;

/// The longest context that is compared.
const LONGEST: usize = 16;

/// What followed a context.
#[derive(Debug, Default)]
pub(super) struct Followers<'t> {
    /// By the length of the context less one: how often it occurs, and how often what follows it.
    pub counts: [(usize, BTreeMap<&'t str, usize>); ORDERS],
    /// The length of the longest context that what follows it has.
    pub longest: BTreeMap<&'t str, usize>,
    /// The length of the longest of all.
    pub best: usize,
    /// By the length of the context less one: what followed it where it last occurs.
    pub latest: [&'t str; ORDERS],
}

impl<'t> Followers<'t> {
    /// What followed the last words of a reading, by their texts or their classes.
    pub fn of(reading: &Reading<'t>, part: fn(&Word<'t>) -> &'t str) -> Self {
        let mut found = Followers::default();
        let words: Vec<&'t str> = reading.words.iter().map(part).collect();
        for at in 1..words.len() {
            let backwards = words.iter().take(at).rev().zip(words.iter().rev());
            let length = backwards.take(LONGEST).take_while(|(a, b)| a == b).count();
            let Some(next) = words.get(at).filter(|_| length > 0) else { continue };
            for ((total, by_word), latest) in found.counts.iter_mut().zip(&mut found.latest).take(length) {
                *total += 1;
                *by_word.entry(*next).or_default() += 1;
                *latest = *next;
            }
            let longest = found.longest.entry(*next).or_default();
            *longest = (*longest).max(length);
            found.best = found.best.max(length);
        }
        found
    }
}
