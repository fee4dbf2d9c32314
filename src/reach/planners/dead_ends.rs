//! Dead ends that a search has learned of: places, with velocities and modes, from where all ways have ended soon after.
//!
//! A distance through the level knows nothing of what a player can do: who falls into a pit beyond the last ledge is
//! nearer to the goal than who stands on it. As the value of a state is learned from what became of its descendants in
//! Tesauro and Galperin, *On-line Policy Improvement using Monte-Carlo Search*, 1996, the trees of a search tell which
//! kinds of states are lost.

use hashbrown::HashMap;

/// Whoever has descendants after so many more extensions has not been in a dead end.
const ALIVE: u32 = 16;
/// After so many dead ends of a kind, without or with this many times fewer that were none, its states are taken for dead.
const SAMPLES: u32 = 4;
const RATIO: u32 = 16;

/// What became of the states of a kind.
#[derive(Debug, Clone, Copy, Default)]
struct Fates {
    dead: u32,
    alive: u32,
}

/// A state of the current tree.
#[derive(Debug, Clone, Copy)]
struct Visit {
    parent: Option<u32>,
    kind: u64,
    /// The number of extensions up to it, and to the last of its descendants.
    age: u32,
    last: u32,
    /// Whether all was tried from it.
    is_done: bool,
    /// Whether a way on was left alone.
    is_open: bool,
}

/// The fates of states, by their kinds.
#[derive(Debug, Default)]
pub(super) struct DeadEnds {
    tree: Vec<Visit>,
    /// The number of its states that are in the fates.
    learned: usize,
    fates: HashMap<u64, Fates>,
}

impl DeadEnds {
    /// Adds a state of a kind to the current tree; returns its number.
    pub fn add(&mut self, parent: Option<u32>, kind: u64) -> u32 {
        let age = parent.map_or(0, |parent| self.tree[parent as usize].age + 1);
        self.tree.push(Visit { parent, kind, age, last: age, is_done: false, is_open: false });
        (self.tree.len() - 1) as u32
    }

    /// All was tried from a state.
    pub fn finish(&mut self, state: u32) {
        self.tree[state as usize].is_done = true;
    }

    /// A way on from a state is left alone.
    pub fn leave(&mut self, state: u32) {
        self.tree[state as usize].is_open = true;
    }

    /// Begins another tree.
    pub fn end_tree(&mut self) {
        self.learn();
        self.tree.clear();
        self.learned = 0;
    }

    /// Learns what became of the states that were added since the last time.
    pub fn learn(&mut self) {
        // Parents come before their children.
        for at in (self.learned..self.tree.len()).rev() {
            let Visit { parent, kind, age, last, is_done, is_open } = self.tree[at];
            let is_open = is_open || !is_done;
            if let Some(parent) = parent {
                let parent = &mut self.tree[parent as usize];
                parent.last = parent.last.max(last);
                parent.is_open |= is_open;
            }
            if last - age >= ALIVE {
                self.fates.entry(kind).or_default().alive += 1;
            } else if !is_open {
                self.fates.entry(kind).or_default().dead += 1;
            }
        }
        self.learned = self.tree.len();
    }

    /// Whether states of a kind are in a dead end, as far as is known.
    pub fn is_dead(&self, kind: u64) -> bool {
        self.fates.get(&kind).is_some_and(|fates| fates.dead >= SAMPLES && fates.dead / RATIO >= fates.alive)
    }

    /// Memory use, bytes.
    pub fn bytes(&self) -> usize {
        self.tree.capacity() * size_of::<Visit>() + self.fates.capacity() * 24
    }
}

#[cfg(test)]
mod tests {
    use super::{ALIVE, DeadEnds, SAMPLES};

    /// A tree with a chain of states of a kind below its root.
    fn chain(of: &mut DeadEnds, kind: u64, length: u32) -> u32 {
        let mut last = of.add(None, 0);
        of.finish(last);
        for _ in 0..length {
            last = of.add(Some(last), kind);
            of.finish(last);
        }
        last
    }

    #[test]
    fn a_kind_from_which_all_ways_end_is_dead() {
        let mut of = DeadEnds::default();
        for _ in 0..SAMPLES {
            assert!(!of.is_dead(7));
            chain(&mut of, 7, 1);
            of.end_tree();
        }
        assert!(of.is_dead(7) && !of.is_dead(8));
    }

    #[test]
    fn a_way_that_was_left_alone_or_goes_on_for_long_is_not() {
        let mut of = DeadEnds::default();
        for _ in 0..2 * SAMPLES {
            let last = chain(&mut of, 7, 1);
            of.leave(last);
            of.end_tree();
            // The last one was not extended.
            let last = chain(&mut of, 8, 1);
            of.add(Some(last), 9);
            of.end_tree();
        }
        assert!(!of.is_dead(7) && !of.is_dead(8) && !of.is_dead(9));
        for _ in 0..2 * SAMPLES {
            chain(&mut of, 10, 1);
            chain(&mut of, 10, 2 * ALIVE);
            of.end_tree();
        }
        assert!(!of.is_dead(10));
    }
}
