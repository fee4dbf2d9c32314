//! What the fuzz targets check, on changed programs, levels and layouts: some thousands of inputs, the same in every run.
//! The targets themselves (`fuzz/`) run for as long as one likes, and learn which inputs lead to new code.

#[path = "../fuzz/src/lib.rs"]
mod targets;

use std::path::Path;

use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::mutation::mutate::{Kind, mutant};
use crate::support::{files, sized};

/// Maximum length of an input before it is changed, bytes: what is longer takes long.
const MAX_LENGTH: usize = 6_000;
/// Maximum number of changes of an input, of its bytes.
const MAX_CHANGES: usize = 4;
/// Numbers at the ends of what there is.
const NUMBERS: &[&str] =
    &["0", "-0.0", "0.1", "-1", "255", "65536", "4294967296", "99999999999999999999", "1e-320", "1e308", "-1e308"];

/// Files that are not too long.
fn contents(folders: &[&str], extension: &str) -> Vec<Vec<u8>> {
    let all = folders.iter().flat_map(|folder| files(folder, extension)).map(|path| std::fs::read(path).unwrap());
    all.filter(|bytes| bytes.len() <= MAX_LENGTH).collect()
}

/// A random range of at most 64 bytes.
fn range(length: usize, rng: &mut Pcg64) -> std::ops::Range<usize> {
    let begin = rng.random_range(0..=length);
    begin..(begin + rng.random_range(0..=64)).min(length)
}

/// Changes bytes: removes, repeats or overwrites some, or inserts a part of another input or a number.
fn change(bytes: &mut Vec<u8>, others: &[Vec<u8>], rng: &mut Pcg64) {
    let at = rng.random_range(0..=bytes.len());
    let inserted = match rng.random_range(0..5) {
        0 => {
            bytes.drain(range(bytes.len(), rng));
            return;
        }
        1 => {
            if let Some(byte) = bytes.get_mut(at) {
                *byte = rng.random();
            }
            return;
        }
        2 => bytes[range(bytes.len(), rng)].to_vec(),
        3 => {
            let other = others.choose(rng).unwrap();
            other[range(other.len(), rng)].to_vec()
        }
        _ => NUMBERS.choose(rng).unwrap().as_bytes().to_vec(),
    };
    bytes.splice(at..at, inserted);
}

/// Gives a target a number of changed inputs; returns how many of them it took. What it fails on stays in `target/tmp`.
fn run(name: &str, target: fn(&[u8]) -> bool, count: usize, originals: &[Vec<u8>]) -> usize {
    assert!(originals.len() > 1);
    let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("fuzz-{name}"));
    let mut rng = Pcg64::seed_from_u64(11);
    let mut taken = 0;
    for turn in 0..count {
        let mut input = originals.choose(&mut rng).unwrap().clone();
        // Half of them have a change of words, as what is cut anywhere seldom compiles.
        let kind = *Kind::ALL.choose(&mut rng).unwrap();
        let of_words =
            str::from_utf8(&input).ok().filter(|_| turn % 2 == 0).and_then(|text| mutant(text, kind, &mut rng));
        match of_words {
            Some(mutant) => input = mutant.text.into_bytes(),
            None => (0..rng.random_range(1..=MAX_CHANGES)).for_each(|_| change(&mut input, originals, &mut rng)),
        }
        // Before, as there is nothing after an overflow of the stack.
        std::fs::write(&kept, &input).unwrap();
        taken += usize::from(target(&input));
    }
    std::fs::remove_file(&kept).unwrap();
    taken
}

/// Programs, half of them without a mistake.
fn programs() -> Vec<Vec<u8>> {
    let mut programs = contents(&["tests/ui"], "hyped");
    let examples = contents(&["examples", "benches/worlds"], "hyped");
    programs.extend(examples.iter().cycle().take(programs.len()).cloned());
    programs
}

#[test]
fn changed_programs_are_answered() {
    let count = sized(2_000, 60_000);
    let taken = run("check", targets::check, count, &programs());
    assert!(taken > count / 10, "{taken}");
}

#[test]
fn changed_programs_are_laid_out() {
    let count = sized(3_000, 150_000);
    let taken = run("fmt", targets::fmt, count, &programs());
    assert!(taken > count / 10, "{taken}");
}

/// A map with the tiles that the target knows: ground, air, and one foe.
fn known(map: &[u8]) -> Vec<u8> {
    let foe = map.iter().position(|tile| *tile == b'E');
    let tile = |(at, tile): (usize, &u8)| match tile {
        b'X' | b'\n' => *tile,
        _ if Some(at) == foe => b'E',
        _ => b'-',
    };
    map.trim_ascii_end().iter().enumerate().map(tile).collect()
}

#[test]
fn changed_levels_are_answered() {
    let maps: Vec<Vec<u8>> = contents(&["tests/maps", "examples/smb"], "txt").iter().map(|map| known(map)).collect();
    let legends = contents(&["tests/maps", "examples/smb"], "json");
    let joined = |(legend, map): (&Vec<u8>, &Vec<u8>)| [legend, &b"\n====\n"[..], map].concat();
    let levels: Vec<Vec<u8>> = legends.iter().flat_map(|l| maps.iter().map(move |m| (l, m))).map(joined).collect();
    let count = sized(600, 60_000);
    let taken = run("levels", targets::levels, count, &levels);
    assert!(taken > count / 30, "{taken}");
}
