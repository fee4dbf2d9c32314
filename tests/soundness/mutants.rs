//! Worlds whose verdicts depend on details, with a few small mutations each.

use std::path::Path;

use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_pcg::Pcg64;

use super::mutate::{Kind, mutant};
use crate::support::files;

/// The programs to mutate: those that once had a false verdict, and those with a comment on each verdict.
pub fn originals() -> Vec<String> {
    let is_whole = |path: &Path| path.parent() != Some(Path::new("tests/verdicts/parts"));
    let all = ["tests/analysis/found", "tests/verdicts"].into_iter().flat_map(|folder| files(folder, "hyped"));
    let read = all.filter(|path| is_whole(path)).map(|path| std::fs::read_to_string(path).unwrap());
    read.filter(|text| !text.contains("import ")).map(|text| without_comments(&text)).collect()
}

fn without_comments(text: &str) -> String {
    let lines = text.lines().filter(|l| !l.trim_start().starts_with("//"));
    lines.map(|l| l.split(" //").next().unwrap_or(l).trim_end().to_string() + "\n").collect()
}

const KINDS: &[Kind] = &[
    Kind::RemoveLine,
    Kind::RepeatLine,
    Kind::Comparison,
    Kind::Retarget,
    Kind::OtherName,
    Kind::RemoveCollide,
    Kind::Derivative,
];

/// A mutated original.
pub fn changed(originals: &[String], rng: &mut Pcg64) -> String {
    let mut text = originals.choose(rng).unwrap().clone();
    for _ in 0..rng.random_range(1..6) {
        let next = match rng.random_range(0..10) {
            0..=4 => number(&text, rng),
            5 => response(&text, rng),
            6 => cell(&text, rng),
            7 => side(&text, rng),
            // A map without an end is not parsed.
            _ if text.matches('"').count() % 2 == 1 => None,
            _ => KINDS.choose(rng).and_then(|kind| mutant(&text, *kind, rng)).map(|m| m.text),
        };
        text = next.unwrap_or(text);
    }
    text
}

/// Another number, near it or one of the critical ones.
fn number(text: &str, rng: &mut Pcg64) -> Option<String> {
    let bytes = text.as_bytes();
    let is_part = |c: u8| c.is_ascii_digit() || c == b'.';
    let starts: Vec<usize> = (1..bytes.len())
        .filter(|i| {
            bytes[*i].is_ascii_digit()
                && !is_part(bytes[i - 1])
                && !bytes[i - 1].is_ascii_alphabetic()
                && bytes[i - 1] != b'_'
        })
        .collect();
    let start = *starts.choose(rng)?;
    let length = bytes[start..].iter().take_while(|c| is_part(**c)).count();
    let old: f64 = text[start..start + length].trim_end_matches('.').parse().ok()?;
    let new = match rng.random_range(0..12) {
        0 => old * 2.0,
        1 => old / 2.0,
        2 => old + 1.0,
        3 => (old - 1.0).max(0.0),
        4 => old + 0.0005,
        5 => (old - 0.0005).max(0.0),
        6 => old + 8.0,
        7 => (old - 8.0).max(0.0),
        8 => old + 0.5,
        9 => 0.0,
        10 => old * 10.0,
        _ => [16.0, 60.0, 3.0, 0.0005, 400.0, 1e9, 1.0][rng.random_range(0..7)],
    };
    Some(format!("{}{new}{}", &text[..start], &text[start + length..]))
}

/// Another response to a contact.
fn response(text: &str, rng: &mut Pcg64) -> Option<String> {
    let lines: Vec<&str> =
        text.lines().filter(|l| l.trim_start().starts_with("collide ") && l.contains(": ")).collect();
    let line = *lines.choose(rng)?;
    let (head, _) = line.rsplit_once(": ")?;
    let new = [
        "block",
        "sense",
        "block, carry",
        "block from above",
        "block, keep velocity",
        "block from above, carry",
        "block, bounce 1",
    ]
    .choose(rng)?;
    Some(text.replacen(line, &format!("{head}: {new}"), 1))
}

/// Another tile in a map.
fn cell(text: &str, rng: &mut Pcg64) -> Option<String> {
    let lines: Vec<&str> = text.lines().collect();
    let is_row = |l: &str| {
        let l = l.trim();
        l.len() > 2 && l.chars().all(|c| !c.is_whitespace() && c != '"') && (l.contains("##") || l.contains(".."))
    };
    let rows: Vec<usize> = (0..lines.len()).filter(|i| is_row(lines[*i])).collect();
    let symbols: Vec<char> = rows.iter().flat_map(|r| lines[*r].trim().chars()).collect();
    let (row, symbol) = (*rows.choose(rng)?, *symbols.choose(rng)?);
    let mut cells: Vec<char> = lines[row].trim().chars().collect();
    let at = rng.random_range(0..cells.len());
    cells[at] = symbol;
    let mut out: Vec<String> = lines.iter().map(|l| (*l).to_string()).collect();
    out[row] = cells.into_iter().collect();
    Some(out.join("\n") + "\n")
}

/// Another side, another axis, another sign.
fn side(text: &str, rng: &mut Pcg64) -> Option<String> {
    let (from, to) = *[
        (", below)", ", left)"),
        (", left)", ", right)"),
        (", right)", ")"),
        (", above)", ", below)"),
        ("x'", "y'"),
        ("y'", "x'"),
        ("= -", "= "),
        ("kinematic collider", "collider"),
        ("collider", "kinematic collider"),
        ("1/60", "1/30"),
        ("step 1/60", "step 1/8"),
        ("step 1/30", "step 1/60"),
        ("rect(0, 0, 16, 16)", "circle(8, 8, 8)"),
        ("rect(0, 0, 16, 16)", "rect(0, 0, 24, 3)"),
        ("rect(0, 0, 16, 16)", "rect(4, -4, 8, 12)"),
        ("mode ", "initial mode "),
    ]
    .choose(rng)?;
    let places: Vec<usize> = text.match_indices(from).map(|(at, _)| at).collect();
    let at = *places.choose(rng)?;
    Some(format!("{}{to}{}", &text[..at], &text[at + from.len()..]))
}
