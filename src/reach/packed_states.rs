//! The states of a tree (`tree.rs`), without loss in a fraction of their size: most of a large state is as in others, above
//! all what goes on by itself in states of the same depth. A state is a reference, or the differences from one; a reference
//! is kept whole, or as the differences from one of the few that are. All memory is in chunks: what grows is never copied.

use hashbrown::HashMap;

/// States up to this size (bytes) are kept whole: little is gained by less.
const SMALL: usize = 256;
/// The size of a chunk, bytes.
const CHUNK: usize = 1 << 18;
/// Differences begin at multiples of this, bytes.
const ALIGNMENT: usize = 4;
/// Number of references of a depth with which a new state is compared.
const COMPARED: usize = 2;
/// A state of which the differences need more than this part of its size is a reference once what was kept so from the same
/// one exceeds that much of its size: what is reached from there is as near to it.
const LARGE: usize = 32;
/// A reference is kept whole if its differences need more than this part of its size.
const FAR: usize = 3;

/// What stands for no offset.
const NONE: u32 = u32::MAX;

/// States of one size.
#[derive(Debug, Default)]
pub struct PackedStates {
    stride: usize,
    /// Binary logarithm of the number of whole states per chunk.
    shift: u32,
    /// Those that are kept whole, and their number.
    whole: Vec<Box<[u8]>>,
    wholes: usize,
    /// For each reference, where it is: a whole state, and the differences from it.
    references: Vec<Entry>,
    /// For each reference, by how much differences from it were larger than a [`LARGE`] part, bytes in sum.
    excesses: Vec<u64>,
    /// For each state, the number of a reference, and the differences from it.
    states: Vec<Entry>,
    packed: Vec<Box<[u8]>>,
    /// Number of bytes of `packed` in use.
    used: usize,
    /// The references of each depth, the newest first.
    depths: HashMap<u32, [u32; COMPARED]>,
    /// The differences of the new state, and a reference.
    differences: Vec<u8>,
    reference: Vec<u8>,
}

/// What a state is.
#[derive(Debug, Clone, Copy)]
struct Entry {
    /// The number of what it is near to.
    near: u32,
    /// Where the differences from that begin, in units of [`ALIGNMENT`]; [`NONE`] if there are none.
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
        self.wholes = 0;
        self.references.clear();
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
            + (self.references.capacity() + self.states.capacity()) * size_of::<Entry>()
            + self.depths.capacity() * size_of::<(u32, [u32; COMPARED])>()
    }

    /// Whether all states are kept whole. Others are made of whole words, as all layouts are.
    #[inline]
    fn is_small(&self) -> bool {
        self.stride <= SMALL || !self.stride.is_multiple_of(WORD)
    }

    /// Adds a state that is reached at a depth, after another.
    pub fn push(&mut self, state: &[u8], depth: u32, before: Option<usize>) {
        if self.is_small() {
            let near = self.push_whole(state);
            self.states.push(Entry { near, at: NONE });
            return;
        }
        let mut differences = std::mem::take(&mut self.differences);
        let entry = match self.nearest(state, depth, before, &mut differences) {
            Some(near) => Entry { near, at: self.keep(&differences) },
            None => {
                let near = self.push_reference(state, &mut differences);
                let of_depth = self.depths.entry(depth).or_insert([NONE; COMPARED]);
                of_depth.rotate_right(1);
                of_depth[0] = near;
                Entry { near, at: NONE }
            }
        };
        self.states.push(entry);
        self.differences = differences;
    }

    /// The nearest of some references, and the differences from it; `None` if the state is to be a reference itself.
    fn nearest(&mut self, state: &[u8], depth: u32, before: Option<usize>, differences: &mut Vec<u8>) -> Option<u32> {
        let after = before.map_or(NONE, |before| self.states[before].near);
        let of_depth = self.depths.get(&depth).copied().unwrap_or([NONE; COMPARED]);
        let (mut buffer, mut least, mut nearest) = (std::mem::take(&mut self.reference), usize::MAX, None);
        for near in of_depth.into_iter().chain([after]).filter(|near| *near != NONE) {
            let reference = self.reference(near, &mut buffer);
            let changed = changed_words(reference, state);
            if changed < least {
                differences.clear();
                differ(reference, state, differences);
                (least, nearest) = (changed, Some(near));
            }
            if differences.len() <= self.stride / LARGE {
                break;
            }
        }
        self.reference = buffer;
        let (nearest, size) = (nearest?, differences.len());
        if size > self.stride / 2 || !self.has_room(differences) {
            return None;
        }
        let excess = &mut self.excesses[nearest as usize];
        let is_near = size <= self.stride / LARGE || *excess <= self.stride as u64;
        *excess += if is_near { size.saturating_sub(self.stride / LARGE) as u64 } else { 0 };
        is_near.then_some(nearest)
    }

    /// Adds a reference; returns its number.
    fn push_reference(&mut self, state: &[u8], differences: &mut Vec<u8>) -> u32 {
        let number = self.references.len() as u32;
        let whole = self.wholes.checked_sub(1).map(|last| last as u32);
        differences.clear();
        whole.into_iter().for_each(|whole| differ(self.whole_state(whole), state, differences));
        let entry = match whole {
            Some(near) if differences.len() <= self.stride / FAR && self.has_room(differences) => {
                Entry { near, at: self.keep(differences) }
            }
            _ => Entry { near: self.push_whole(state), at: NONE },
        };
        self.references.push(entry);
        self.excesses.push(0);
        number
    }

    /// Keeps a state whole; returns its number.
    fn push_whole(&mut self, state: &[u8]) -> u32 {
        let number = self.wholes as u32;
        self.wholes += 1;
        let (chunk, from) = self.place(number);
        if chunk >= self.whole.len() {
            self.whole.push(vec![0; self.stride << self.shift].into_boxed_slice());
        }
        self.whole[chunk][from..from + self.stride].copy_from_slice(state);
        number
    }

    /// Whether there is room for differences.
    fn has_room(&self, differences: &[u8]) -> bool {
        differences.len() <= CHUNK && self.used / ALIGNMENT + CHUNK < NONE as usize
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

    /// Differences that begin somewhere, and what follows them; nothing if there are none.
    fn kept(&self, at: u32) -> &[u8] {
        if at == NONE {
            return &[];
        }
        let begin = at as usize * ALIGNMENT;
        &self.packed[begin / CHUNK][begin % CHUNK..]
    }

    /// A reference; the buffer is for one that is not kept whole.
    fn reference<'s>(&'s self, number: u32, buffer: &'s mut Vec<u8>) -> &'s [u8] {
        let Entry { near, at } = self.references[number as usize];
        if at == NONE {
            return self.whole_state(near);
        }
        self.copy_reference(number, buffer);
        buffer
    }

    fn copy_reference(&self, number: u32, buffer: &mut Vec<u8>) {
        let Entry { near, at } = self.references[number as usize];
        buffer.clear();
        buffer.extend_from_slice(self.whole_state(near));
        apply(self.kept(at), buffer);
    }

    /// A state; the buffer is for one that is not kept whole.
    pub fn get<'s>(&'s self, index: usize, buffer: &'s mut Vec<u8>) -> &'s [u8] {
        let Entry { near, at } = self.states[index];
        if self.is_small() {
            return self.whole_state(near);
        }
        if at == NONE {
            return self.reference(near, buffer);
        }
        self.copy_reference(near, buffer);
        apply(self.kept(at), buffer);
        buffer
    }

    /// Whether a state is the given one.
    pub fn is(&self, index: usize, state: &[u8]) -> bool {
        let Entry { near, at } = self.states[index];
        if self.is_small() {
            return self.whole_state(near) == state;
        }
        let Entry { near, at: from_whole } = self.references[near as usize];
        let [mut first, mut second] = [from_whole, at].map(|at| Patches::new(self.kept(at)));
        let (whole, state) = (words(self.whole_state(near)), words(state));
        whole.zip(state).enumerate().all(|(at, (whole, word))| second.patched(at, first.patched(at, whole)) == word)
    }
}

const WORD: usize = 8;

/// The words of a state that is packed.
fn words(state: &[u8]) -> impl Iterator<Item = u64> {
    state.as_chunks().0.iter().map(|word| u64::from_le_bytes(*word))
}

fn changed_words(a: &[u8], b: &[u8]) -> usize {
    words(a).zip(words(b)).filter(|(a, b)| a != b).count()
}

/// Which bytes of a word are kept: the number of those before, and of those. What differs takes the shortest with all of it.
/// In numbers with fractions the high bytes differ most, in others the low ones.
const SHAPES: [(usize, usize); 16] = [
    (0, 0),
    (7, 1),
    (6, 1),
    (6, 2),
    (5, 1),
    (5, 2),
    (5, 3),
    (4, 1),
    (4, 4),
    (3, 1),
    (2, 1),
    (2, 6),
    (0, 1),
    (0, 4),
    (0, 7),
    (0, 8),
];
/// The shape for what differs, by the number of equal bytes before and after it.
const SHAPE_OF: [[u8; WORD]; WORD] = shape_of();

const fn shape_of() -> [[u8; WORD]; WORD] {
    let mut out = [[SHAPES.len() as u8 - 1; WORD]; WORD];
    let mut at = 0;
    while at < WORD * WORD {
        let (before, after) = (at / WORD, at % WORD);
        let mut shape = 1;
        while shape < SHAPES.len() {
            let ((begin, length), (_, least)) = (SHAPES[shape], SHAPES[out[before][after] as usize]);
            if begin <= before && begin + length + after >= WORD && length < least {
                out[before][after] = shape as u8;
            }
            shape += 1;
        }
        at += 1;
    }
    out
}

/// The number of equal words from which on their number needs a byte more, and the greatest one.
const MANY: usize = 15;
const MOST: usize = MANY + u8::MAX as usize;

/// The differences of a state from another: for each word that differs, its shape and 16 times the number of equal words
/// before it, if there are [`MANY`] how many more, and the bytes. No bytes follow where more words are equal; 0 ends it.
fn differ(from: &[u8], state: &[u8], out: &mut Vec<u8>) {
    let mut equal = 0;
    for (a, b) in words(from).zip(words(state)) {
        if a == b {
            equal += 1;
            continue;
        }
        while equal > MOST {
            out.extend([16 * MANY as u8, u8::MAX]);
            equal -= MOST;
        }
        let [before, after] = [(a ^ b).trailing_zeros() as usize / 8, (a ^ b).leading_zeros() as usize / 8];
        let shape = SHAPE_OF[before][after];
        out.push(16 * equal.min(MANY) as u8 + shape);
        if equal >= MANY {
            out.push((equal - MANY) as u8);
        }
        let (before, length) = SHAPES[usize::from(shape)];
        out.extend(&b.to_le_bytes()[before..before + length]);
        equal = 0;
    }
    out.push(0);
}

/// One word that differs, or equal ones.
#[derive(Debug, Clone, Copy, Default)]
struct Difference {
    /// Number of equal words before it.
    equal: usize,
    /// Its bits that may differ, none if there are only equal words; and what they are.
    mask: u64,
    bits: u64,
}

impl Difference {
    /// The first of what [`differ`] has written, up to its end.
    #[inline(always)]
    fn take(left: &mut &[u8]) -> Option<Self> {
        let (header, mut rest) = left.split_first()?;
        if *header == 0 {
            return None;
        }
        let mut equal = usize::from(header / 16);
        if equal == MANY {
            let (more, after) = rest.split_first()?;
            equal += usize::from(*more);
            rest = after;
        }
        let (before, length) = SHAPES[usize::from(header % 16)];
        // Behind the bytes are others, except at the end of a chunk.
        let bytes = rest.first_chunk().copied().unwrap_or_else(|| {
            let mut bytes = [0; WORD];
            bytes[..length].copy_from_slice(&rest[..length]);
            bytes
        });
        *left = &rest[length..];
        let mask = u64::MAX.checked_shr(64 - 8 * length as u32).unwrap_or(0);
        let bits = u64::from_le_bytes(bytes) & mask;
        Some(Difference { equal, mask: mask << (8 * before), bits: bits << (8 * before) })
    }

    #[inline(always)]
    fn patched(self, word: u64) -> u64 {
        word & !self.mask | self.bits
    }
}

/// Makes the state from which another differs into that.
fn apply(mut differences: &[u8], state: &mut [u8]) {
    let words = state.as_chunks_mut().0;
    let mut at = 0;
    while let Some(difference) = Difference::take(&mut differences) {
        at += difference.equal;
        if difference.mask != 0 {
            words[at] = difference.patched(u64::from_le_bytes(words[at])).to_le_bytes();
            at += 1;
        }
    }
}

/// Differences that are applied word by word.
struct Patches<'d> {
    left: &'d [u8],
    /// The number of the next word that differs, and how.
    next: usize,
    difference: Difference,
}

impl<'d> Patches<'d> {
    fn new(differences: &'d [u8]) -> Self {
        let mut patches = Patches { left: differences, next: 0, difference: Difference::default() };
        patches.advance(0);
        patches
    }

    /// Goes on to the next word that differs, from one on.
    fn advance(&mut self, mut from: usize) {
        self.next = usize::MAX;
        while let Some(difference) = Difference::take(&mut self.left) {
            from += difference.equal;
            if difference.mask != 0 {
                (self.next, self.difference) = (from, difference);
                return;
            }
        }
    }

    /// What becomes of a word, all in their order.
    #[inline(always)]
    fn patched(&mut self, at: usize, word: u64) -> u64 {
        if self.next != at {
            return word;
        }
        let patched = self.difference.patched(word);
        self.advance(at + 1);
        patched
    }
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
        for size in [120, 128, 2_000, 2_160, 2_168, 2_176, 8_192] {
            let whole = vec![7; size];
            for at in [0, 9, size / 2, size - 1] {
                let mut state = whole.clone();
                state[at] = 9;
                let mut differences = Vec::new();
                differ(&whole, &state, &mut differences);
                let mut other = whole.clone();
                apply(&differences, &mut other);
                assert_eq!(other, state);
                let mut patches = Patches::new(&differences);
                let patched: Vec<u64> = words(&whole).enumerate().map(|(at, word)| patches.patched(at, word)).collect();
                assert_eq!(patched, words(&state).collect::<Vec<_>>());
            }
        }
    }
}
