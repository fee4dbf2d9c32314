//! A set of states, each stored once, exactly and in few bytes. A state is cut into words of 8 bytes. For each word, a
//! dictionary numbers the values that occur, in the order in which they are found; a state is the numbers of its words,
//! each in as many bits as its dictionary needs. A word that has the same value in all states takes no bits.
//!
//! Two states have the same key exactly if all their bytes are equal.

use hashbrown::HashTable;

use super::super::coverage::mix;

/// The value of a word whose number is not known.
pub(super) const UNKNOWN: u32 = u32::MAX;
/// Maximum size of a key, bytes.
const MAX_KEY: usize = 128;
/// Bits by which a word grows when its dictionary is full.
const GROWTH: u8 = 2;
/// Memory use of an entry of a hash table: a number, a byte, and the share of places that stay free; bytes.
const ENTRY: usize = 6;
/// Divisor: the share by which the list of states grows.
const SHARE: usize = 8;

/// The values of a word.
#[derive(Debug, Default)]
struct Dictionary {
    values: Vec<u64>,
    numbers: HashTable<u32>,
    /// Bits of a number in a key.
    width: u8,
}

impl Dictionary {
    #[inline]
    fn find(&self, value: u64) -> u32 {
        let is_same = |number: &u32| self.values[*number as usize] == value;
        self.numbers.find(mix(0, value), is_same).copied().unwrap_or(UNKNOWN)
    }

    fn add(&mut self, value: u64) -> u32 {
        let known = self.find(value);
        if known != UNKNOWN {
            return known;
        }
        let number = self.values.len() as u32;
        self.values.push(value);
        let values = &self.values;
        self.numbers.insert_unique(mix(0, value), number, |other| mix(0, values[*other as usize]));
        number
    }

    /// Whether its numbers fit into its bits.
    fn fits(&self) -> bool {
        self.values.len() as u64 <= 1 << self.width
    }

    fn bytes(&self) -> usize {
        self.values.capacity() * 8 + self.numbers.capacity() * ENTRY
    }
}

/// A packed state.
#[derive(Debug, Clone, Copy)]
struct Key([u8; MAX_KEY]);

/// Packed states, one after the other.
#[derive(Debug, Default)]
struct Keys {
    words: Vec<Dictionary>,
    /// The words that vary, and the bits of each.
    varying: Vec<(u16, u8)>,
    /// Bytes of a key.
    stride: usize,
    bytes: Vec<u8>,
}

/// The states that were reached, numbered in the order in which they were found.
#[derive(Debug)]
pub(super) struct States {
    keys: Keys,
    /// The state from which each was reached first.
    parents: Vec<u32>,
    table: HashTable<u32>,
}

/// A state cannot be added: there are too many, or they are too different.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Full;

impl States {
    /// An empty set of states of some words.
    pub fn new(words: usize) -> Self {
        let words = (0..words).map(|_| Dictionary::default()).collect();
        States { keys: Keys { words, ..Keys::default() }, parents: Vec::new(), table: HashTable::new() }
    }

    /// Number of states.
    pub fn len(&self) -> usize {
        self.parents.len()
    }

    /// Memory use, bytes.
    pub fn bytes(&self) -> usize {
        let words: usize = self.keys.words.iter().map(Dictionary::bytes).sum();
        words + self.keys.bytes.capacity() + self.parents.capacity() * 4 + self.table.capacity() * ENTRY
    }

    /// The state from which one was reached first; a start is its own.
    pub fn parent(&self, state: u32) -> u32 {
        self.parents[state as usize]
    }

    /// The number of a value of a word, [`UNKNOWN`] if no state has it.
    #[inline]
    pub fn number(&self, word: usize, value: u64) -> u32 {
        self.keys.words[word].find(value)
    }

    /// The words of a state, and their numbers.
    #[inline]
    pub fn read(&self, state: u32, numbers: &mut [u32], values: &mut [u64]) {
        numbers.fill(0);
        for (word, number) in numbers_of(self.keys.get(state), &self.keys.varying) {
            numbers[word] = number;
        }
        for (word, dictionary) in self.keys.words.iter().enumerate() {
            values[word] = dictionary.values[numbers[word] as usize];
        }
    }

    /// Whether a state is in the set. All numbers must be known.
    #[inline]
    pub fn contains(&self, numbers: &[u32]) -> bool {
        self.find(&self.keys.pack(numbers)).is_ok()
    }

    /// Adds a state that was reached from another one, if it is new. Words whose number is [`UNKNOWN`] get one for
    /// their value. A start has no parent.
    ///
    /// [`Full`] if there is no place for it.
    pub fn add(&mut self, numbers: &mut [u32], values: &[u64], parent: Option<u32>) -> Result<bool, Full> {
        let mut fits = true;
        for (word, dictionary) in self.keys.words.iter_mut().enumerate() {
            if numbers[word] == UNKNOWN {
                numbers[word] = dictionary.add(values[word]);
                fits &= dictionary.fits();
            }
        }
        if !fits {
            self.keys.widen(self.parents.len())?;
        }
        let key = self.keys.pack(numbers);
        let Err(hash) = self.find(&key) else { return Ok(false) };
        let Some(state) = u32::try_from(self.len()).ok().filter(|state| *state != u32::MAX) else { return Err(Full) };
        // A vector that doubles would be half empty.
        grow(&mut self.keys.bytes, self.keys.stride);
        grow(&mut self.parents, 1);
        self.keys.bytes.extend_from_slice(&key.0[..self.keys.stride]);
        self.parents.push(parent.unwrap_or(state));
        let keys = &self.keys;
        self.table.insert_unique(hash, state, |other| hash_of(keys.get(*other), &keys.varying));
        Ok(true)
    }

    /// The state with a key, or else the hash of the key.
    #[inline]
    fn find(&self, key: &Key) -> Result<u32, u64> {
        let key = &key.0[..self.keys.stride];
        let hash = hash_of(key, &self.keys.varying);
        self.table.find(hash, |state| self.keys.get(*state) == key).copied().ok_or(hash)
    }
}

impl Keys {
    #[inline]
    fn get(&self, state: u32) -> &[u8] {
        let at = state as usize * self.stride;
        &self.bytes[at..at + self.stride]
    }

    /// Gives words more bits, and packs all states anew.
    fn widen(&mut self, states: usize) -> Result<(), Full> {
        for word in &mut self.words {
            while !word.fits() {
                word.width += if word.width == 0 { 1 } else { GROWTH };
            }
        }
        let bits: usize = self.words.iter().map(|word| usize::from(word.width)).sum();
        // A key is written in pieces of 8 bytes.
        if bits.next_multiple_of(64) / 8 > MAX_KEY {
            return Err(Full);
        }
        let widths = (0..).zip(&self.words).map(|(at, word)| (at, word.width));
        let mut new = Keys {
            varying: widths.filter(|(_, width)| *width > 0).collect(),
            stride: bits.div_ceil(8),
            bytes: Vec::new(),
            words: Vec::new(),
        };
        new.bytes.reserve(states * new.stride);
        let mut numbers = vec![0; self.words.len()];
        for state in 0..states as u32 {
            for (word, number) in numbers_of(self.get(state), &self.varying) {
                numbers[word] = number;
            }
            let key = new.pack(&numbers);
            new.bytes.extend_from_slice(&key.0[..new.stride]);
        }
        new.words = std::mem::take(&mut self.words);
        *self = new;
        Ok(())
    }

    #[inline]
    fn pack(&self, numbers: &[u32]) -> Key {
        let mut key = Key([0; MAX_KEY]);
        let (mut piece, mut bits, mut at) = (0u64, 0u32, 0);
        for &(word, width) in &self.varying {
            let (number, width) = (u64::from(numbers[usize::from(word)]), u32::from(width));
            piece |= number << bits;
            bits += width;
            if bits >= 64 {
                key.0[at..at + 8].copy_from_slice(&piece.to_le_bytes());
                at += 8;
                bits -= 64;
                // What did not fit; a width is less than 64.
                piece = number >> (width - bits);
            }
        }
        if bits > 0 {
            key.0[at..at + 8].copy_from_slice(&piece.to_le_bytes());
        }
        key
    }
}

/// Makes room for some more entries.
fn grow<T>(list: &mut Vec<T>, more: usize) {
    if list.capacity() - list.len() < more {
        list.reserve_exact(more.max(list.len() / SHARE).max(64));
    }
}

/// The numbers of the words that vary.
#[inline]
fn numbers_of(key: &[u8], varying: &[(u16, u8)]) -> impl Iterator<Item = (usize, u32)> {
    let mut bit = 0;
    varying.iter().map(move |&(word, width)| {
        let (rest, shift) = (&key[bit / 8..], bit % 8);
        let piece = match rest.first_chunk::<8>() {
            Some(chunk) => u64::from_le_bytes(*chunk),
            None => rest.iter().rev().fold(0, |piece, byte| piece << 8 | u64::from(*byte)),
        };
        bit += usize::from(width);
        // At most 7 bits before it, and 32 of the number.
        (usize::from(word), (piece >> shift & ((1 << width) - 1)) as u32)
    })
}

/// A hash of a state that does not change when the words get more bits, or further words vary.
#[inline]
fn hash_of(key: &[u8], varying: &[(u16, u8)]) -> u64 {
    let mut hash = 0u64;
    for (word, number) in numbers_of(key, varying) {
        if number != 0 {
            let pair = (word as u64) << 32 | u64::from(number);
            hash = (hash ^ pair).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
        }
    }
    mix(0, hash)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers that look random.
    fn scrambled(seed: u64) -> u64 {
        mix(7, seed)
    }

    #[test]
    fn states_are_told_apart_exactly_while_words_grow() {
        const WORDS: usize = 9;
        let mut states = States::new(WORDS);
        let mut all = std::collections::BTreeMap::new();
        for at in 0..20_000 {
            // Some words vary little, one not at all, one with each state.
            let limits = [1, 2, 3, 50, 300, 5, 1, 2, 1_000];
            let mut values: Vec<u64> = limits.iter().zip(0..).map(|(n, w)| scrambled(at * 16 + w) % n).collect();
            values[4] = values[4].wrapping_mul(0x0123_4567_89ab_cdef);
            let number = all.len() as u32;
            let is_new = !all.contains_key(&values);
            all.entry(values.clone()).or_insert(number);
            let mut numbers: Vec<u32> = (0..WORDS).map(|word| states.number(word, values[word])).collect();
            if !numbers.contains(&UNKNOWN) {
                assert_eq!(states.contains(&numbers), !is_new);
            }
            assert_eq!(states.add(&mut numbers, &values, None), Ok(is_new));
        }
        assert_eq!(states.len(), all.len());
        let (mut numbers, mut values) = (vec![0; WORDS], vec![0; WORDS]);
        for (wanted, state) in &all {
            states.read(*state, &mut numbers, &mut values);
            assert_eq!((&values, states.parent(*state)), (wanted, *state));
        }
        assert!(states.keys.stride <= 7, "1 + 2 + 6 + 9 + 3 + 1 + 10 bits, and a bit each to grow");
    }

    #[test]
    fn states_that_differ_too_much_are_refused() {
        const WORDS: usize = 400;
        let mut states = States::new(WORDS);
        let full = (0..100).find(|&at| {
            let values: Vec<u64> = (0..WORDS as u64).map(|word| scrambled(at * 1_000 + word)).collect();
            states.add(&mut [UNKNOWN; WORDS], &values, None) == Err(Full)
        });
        assert!(full.is_some_and(|at| at > 1), "{full:?}");
    }
}
