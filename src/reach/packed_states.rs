//! The states of a tree (`tree.rs`), without loss in a fraction of their size: most of a large state is as in others, above
//! all what goes on by itself in states of the same depth. A state is kept whole, or as its differences from one of those.
//! All memory is in chunks: what grows is never copied.

use hashbrown::HashMap;

/// States up to this size (bytes) are kept whole: little is gained by less.
const SMALL: usize = 256;
/// The size of a chunk, bytes.
const CHUNK: usize = 1 << 18;
/// Differences begin at multiples of this, bytes.
const ALIGNMENT: usize = 4;
/// Number of whole states of a depth with which a new one is compared.
const COMPARED: usize = 2;
/// A state of which the differences need more than this part of its size is kept whole once what was kept so from the same
/// one exceeds its size: what is reached from there is as near to it.
const LARGE: usize = 16;

/// What stands for no offset.
const NONE: u32 = u32::MAX;

/// States of one size.
#[derive(Debug, Default)]
pub struct PackedStates {
    stride: usize,
    /// Binary logarithm of the number of whole states per chunk.
    shift: u32,
    whole: Vec<Box<[u8]>>,
    /// For each whole state, by how much differences from it were larger than a [`LARGE`] part, bytes in sum.
    excesses: Vec<u64>,
    states: Vec<Entry>,
    packed: Vec<Box<[u8]>>,
    /// Number of bytes of `packed` in use.
    used: usize,
    /// The whole states of each depth, the newest first.
    depths: HashMap<u32, [u32; COMPARED]>,
    /// The differences of the new state.
    differences: Vec<u8>,
}

/// Where a state is.
#[derive(Debug, Clone, Copy)]
struct Entry {
    /// The number of a whole state.
    whole: u32,
    /// Where the differences from it begin, in units of [`ALIGNMENT`]; [`NONE`] if there are none.
    at: u32,
}

impl PackedStates {
    /// No states of a size in bytes.
    pub fn new(stride: usize) -> Self {
        let stride = stride.max(1);
        PackedStates { stride, shift: (CHUNK / stride).max(1).ilog2(), ..PackedStates::default() }
    }

    /// Removes all states, but keeps the memory.
    pub fn clear(&mut self) {
        self.excesses.clear();
        self.states.clear();
        self.used = 0;
        self.depths.clear();
    }

    /// Memory use, bytes.
    pub fn bytes(&self) -> usize {
        self.whole.len() * (self.stride << self.shift)
            + self.packed.len() * CHUNK
            + self.excesses.capacity() * size_of::<u64>()
            + self.states.capacity() * size_of::<Entry>()
            + self.depths.capacity() * size_of::<(u32, [u32; COMPARED])>()
    }

    /// Adds a state that is reached at a depth, after another.
    pub fn push(&mut self, state: &[u8], depth: u32, before: Option<usize>) {
        if self.stride <= SMALL {
            self.push_whole(state);
            return;
        }
        let near = before.map_or(NONE, |before| self.states[before].whole);
        let of_depth = self.depths.get(&depth).copied().unwrap_or([NONE; COMPARED]);
        let candidates = std::iter::once(near).chain(of_depth).filter(|whole| *whole != NONE);
        let nearest = candidates.min_by_key(|whole| changed_words(self.whole_state(*whole), state));
        let Some(whole) = nearest else {
            self.push_whole(state);
            self.remember(depth);
            return;
        };
        let mut differences = std::mem::take(&mut self.differences);
        differences.clear();
        differ(self.whole_state(whole), state, &mut differences);
        let size = differences.len();
        let excess = (size - size.min(self.stride / LARGE)) as u64;
        let is_large = size > CHUNK.min(self.stride / 2) || self.used / ALIGNMENT + CHUNK >= NONE as usize;
        if is_large || excess > 0 && self.excesses[whole as usize] > self.stride as u64 {
            self.push_whole(state);
            self.remember(depth);
        } else {
            self.excesses[whole as usize] += excess;
            let at = self.keep(&differences);
            self.states.push(Entry { whole, at });
        }
        self.differences = differences;
    }

    /// Compares states of a depth with the newest whole state from now on.
    fn remember(&mut self, depth: u32) {
        let new = self.excesses.len() as u32 - 1;
        let of_depth = self.depths.entry(depth).or_insert([NONE; COMPARED]);
        of_depth.rotate_right(1);
        of_depth[0] = new;
    }

    fn push_whole(&mut self, state: &[u8]) {
        let whole = self.excesses.len();
        if whole >> self.shift >= self.whole.len() {
            self.whole.push(vec![0; self.stride << self.shift].into_boxed_slice());
        }
        let (chunk, from) = self.place(whole as u32);
        self.whole[chunk][from..from + self.stride].copy_from_slice(state);
        self.excesses.push(0);
        self.states.push(Entry { whole: whole as u32, at: NONE });
    }

    /// Keeps differences, which are not longer than a chunk; returns where they begin.
    fn keep(&mut self, differences: &[u8]) -> u32 {
        let mut begin = self.used.next_multiple_of(ALIGNMENT);
        if begin % CHUNK + differences.len() > CHUNK {
            begin = begin.next_multiple_of(CHUNK);
        }
        if begin / CHUNK >= self.packed.len() {
            self.packed.push(vec![0; CHUNK].into_boxed_slice());
        }
        let from = begin % CHUNK;
        self.packed[begin / CHUNK][from..from + differences.len()].copy_from_slice(differences);
        self.used = begin + differences.len();
        (begin / ALIGNMENT) as u32
    }

    fn place(&self, whole: u32) -> (usize, usize) {
        let whole = whole as usize;
        (whole >> self.shift, (whole & ((1 << self.shift) - 1)) * self.stride)
    }

    fn whole_state(&self, whole: u32) -> &[u8] {
        let (chunk, from) = self.place(whole);
        &self.whole[chunk][from..from + self.stride]
    }

    /// A state; the buffer is for one that is not kept whole.
    pub fn get<'s>(&'s self, index: usize, buffer: &'s mut Vec<u8>) -> &'s [u8] {
        let Entry { whole, at } = self.states[index];
        let whole = self.whole_state(whole);
        if at == NONE {
            return whole;
        }
        buffer.clear();
        buffer.extend_from_slice(whole);
        let begin = at as usize * ALIGNMENT;
        apply(&self.packed[begin / CHUNK][begin % CHUNK..], buffer);
        buffer
    }

    /// Whether a state is the given one.
    pub fn is(&self, index: usize, state: &[u8]) -> bool {
        let Entry { whole, at } = self.states[index];
        let whole = self.whole_state(whole);
        if at == NONE {
            return whole == state;
        }
        let begin = at as usize * ALIGNMENT;
        is_changed_to(whole, &self.packed[begin / CHUNK][begin % CHUNK..], state)
    }
}

const WORD: usize = 8;

fn words(state: &[u8]) -> impl Iterator<Item = u64> {
    state.chunks(WORD).map(|bytes| {
        let mut word = [0; WORD];
        word[..bytes.len()].copy_from_slice(bytes);
        u64::from_le_bytes(word)
    })
}

fn changed_words(a: &[u8], b: &[u8]) -> usize {
    a.chunks_exact(WORD).zip(b.chunks_exact(WORD)).filter(|(a, b)| a != b).count()
}

/// The differences of a state from another: for each word that differs, the number of equal words before it, a mask of its
/// bytes that differ, and those. A mask of 0 after equal words is for those alone; both 0 end it.
fn differ(whole: &[u8], state: &[u8], out: &mut Vec<u8>) {
    let mut equal = 0;
    for (a, b) in words(whole).zip(words(state)) {
        if a == b {
            equal += 1;
            if equal == 255 {
                out.extend([255, 0]);
                equal = 0;
            }
            continue;
        }
        out.push(equal as u8);
        equal = 0;
        let mask_at = out.len();
        out.push(0);
        let mut mask = 0;
        for (i, (a, b)) in a.to_le_bytes().into_iter().zip(b.to_le_bytes()).enumerate() {
            if a != b {
                mask |= 1 << i;
                out.push(b);
            }
        }
        out[mask_at] = mask;
    }
    out.extend([0, 0]);
}

/// One word that differs, or the end of equal ones.
struct Difference<'d> {
    /// Number of equal words before it.
    equal: usize,
    /// Its bytes that differ, with a bit for each; none at the end of equal words.
    mask: u8,
    bytes: &'d [u8],
}

/// What [`differ`] has written, up to its end.
fn each_difference(mut left: &[u8]) -> impl Iterator<Item = Difference<'_>> {
    std::iter::from_fn(move || {
        let ([equal, mask], rest) = left.split_first_chunk()?;
        if *equal == 0 && *mask == 0 {
            return None;
        }
        let bytes;
        (bytes, left) = rest.split_at(mask.count_ones() as usize);
        Some(Difference { equal: usize::from(*equal), mask: *mask, bytes })
    })
}

/// Makes a state that is kept whole into another.
fn apply(differences: &[u8], state: &mut [u8]) {
    let mut at = 0;
    for Difference { equal, mask, bytes } in each_difference(differences) {
        at += equal * WORD;
        if mask != 0 {
            patch(&mut state[at..], mask, bytes);
            at += WORD;
        }
    }
}

fn patch(word: &mut [u8], mut mask: u8, bytes: &[u8]) {
    for byte in bytes {
        word[mask.trailing_zeros() as usize] = *byte;
        mask &= mask - 1;
    }
}

/// Whether a state that is kept whole differs so from the given one.
fn is_changed_to(whole: &[u8], differences: &[u8], state: &[u8]) -> bool {
    let mut at = 0;
    for Difference { equal, mask, bytes } in each_difference(differences) {
        let to = at + equal * WORD;
        if whole[at..to] != state[at..to] {
            return false;
        }
        at = to;
        if mask != 0 {
            let end = (at + WORD).min(whole.len());
            let mut word = [0; WORD];
            word[..end - at].copy_from_slice(&whole[at..end]);
            patch(&mut word, mask, bytes);
            if word[..end - at] != state[at..end] {
                return false;
            }
            at = end;
        }
    }
    whole[at..] == state[at..]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// States of a size, each with changes of one before.
    fn states(size: usize) -> impl Strategy<Value = Vec<(usize, u32, Vec<u8>)>> {
        let change = (0..size, any::<u8>());
        let new = (any::<prop::sample::Index>(), 0..6u32, prop::collection::vec(change, 0..size / 8));
        prop::collection::vec(new, 1..60).prop_map(move |all| {
            let mut states: Vec<(usize, u32, Vec<u8>)> = vec![(0, 0, vec![0; size])];
            for (from, depth, changes) in all {
                let from = from.index(states.len());
                let mut state = states[from].2.clone();
                changes.into_iter().for_each(|(at, byte)| state[at] = byte);
                states.push((from, depth, state));
            }
            states
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn states_come_out_as_they_went_in(
            states in prop_oneof![Just(SMALL), Just(SMALL + 8), Just(SMALL + 5), Just(4_096)].prop_flat_map(states),
        ) {
            let mut packed = PackedStates::new(states[0].2.len());
            let mut buffer = Vec::new();
            for _ in 0..2 {
                for (index, (before, depth, state)) in states.iter().enumerate() {
                    packed.push(state, *depth, (index > 0).then_some(*before));
                }
                for (index, (_, _, state)) in states.iter().enumerate() {
                    prop_assert_eq!(packed.get(index, &mut buffer), &**state);
                    for (_, _, other) in &states {
                        prop_assert_eq!(packed.is(index, other), other == state);
                    }
                }
                packed.clear();
            }
        }
    }

    #[test]
    fn what_changes_little_takes_little() {
        let mut packed = PackedStates::new(4_096);
        let mut state: Vec<u8> = (0..4_096).map(|i| i as u8).collect();
        packed.push(&state, 0, None);
        for i in 1..10_000usize {
            state[i * 8 % 4_096] ^= 1;
            packed.push(&state, i as u32 % 500, Some(i - 1));
        }
        assert!(packed.bytes() < 10_000 * 400, "{} bytes", packed.bytes());
        let mut buffer = Vec::new();
        assert_eq!(packed.get(9_999, &mut buffer), state);
    }

    #[test]
    fn equal_words_of_any_number_are_skipped() {
        for size in [2_000, 2_040, 2_048, 2_056, 8_192] {
            let whole = vec![7; size];
            for at in [0, 8, size / 2, size - 1] {
                let mut state = whole.clone();
                state[at] = 9;
                let mut differences = Vec::new();
                differ(&whole, &state, &mut differences);
                assert!(is_changed_to(&whole, &differences, &state));
                assert!(!is_changed_to(&whole, &differences, &whole));
                let mut other = whole.clone();
                apply(&differences, &mut other);
                assert_eq!(other, state);
            }
        }
    }
}
