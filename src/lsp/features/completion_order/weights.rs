//! The weights of the evidence for completion items, from `weights.txt`: each line has a weight and the name of a
//! feature. They were fitted by `cargo test --test language fits_the_weights -- --ignored`, which writes that file.

/// The lines of the file.
const TEXT: &str = include_str!("weights.txt");

/// Number of weights.
const COUNT: usize = lines(TEXT.as_bytes());

/// The hashes of the names in ascending order, and the weights.
static TABLE: ([u32; COUNT], [i8; COUNT]) = table(TEXT.as_bytes());

/// A weight of 1 in the table.
const UNIT: f32 = 20.0;

/// The hash of nothing (FNV-1a).
const EMPTY: u32 = 0x811c_9dc5;

const fn hashed(hash: u32, byte: u8) -> u32 {
    (hash ^ byte as u32).wrapping_mul(0x0100_0193)
}

/// The weight of a feature, by the words that name it; 0 if it has none.
pub(super) fn weight(name: &[&str]) -> f32 {
    let mut hash = EMPTY;
    for (at, word) in name.iter().enumerate() {
        let space: &[u8] = if at > 0 { b" " } else { b"" };
        hash = space.iter().chain(word.as_bytes()).fold(hash, |hash, byte| hashed(hash, *byte));
    }
    let found = TABLE.0.binary_search(&hash).ok().and_then(|at| TABLE.1.get(at));
    found.map_or(0.0, |weight| f32::from(*weight) / UNIT)
}

const fn lines(text: &[u8]) -> usize {
    let (mut count, mut at) = (0, 0);
    while at < text.len() {
        count += (text[at] == b'\n') as usize;
        at += 1;
    }
    count
}

/// Reads the file while the compiler runs: the library holds only the table.
const fn table(text: &[u8]) -> ([u32; COUNT], [i8; COUNT]) {
    let (mut hashes, mut weights) = ([0; COUNT], [0; COUNT]);
    let (mut count, mut at) = (0, 0);
    while at < text.len() {
        let (mut weight, mut sign, mut hash) = (0i8, 1i8, EMPTY);
        while text[at] != b'\t' {
            match text[at] {
                b'-' => sign = -1,
                digit => weight = weight * 10 + (digit - b'0') as i8,
            }
            at += 1;
        }
        at += 1;
        while text[at] != b'\n' {
            hash = hashed(hash, text[at]);
            at += 1;
        }
        at += 1;
        // The lines are in the order of their hashes.
        assert!(count == 0 || hashes[count - 1] < hash, "the weights are not in order");
        (hashes[count], weights[count]) = (hash, sign * weight);
        count += 1;
    }
    (hashes, weights)
}
