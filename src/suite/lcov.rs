//! Coverage as an lcov tracefile, which editors show beside the text: a mode is a function, its line is covered once it is
//! entered; an edge is a line, covered once it is taken; each part of its guard is a branch of two sides.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::why::{EdgeCoverage, ModeCoverage, PlaceCoverage};

/// The tracefile.
pub fn lcov(coverage: &PlaceCoverage) -> String {
    let mut files: BTreeMap<&str, (Vec<&ModeCoverage>, Vec<&EdgeCoverage>)> = BTreeMap::new();
    for mode in coverage.modes() {
        files.entry(&mode.place.path).or_default().0.push(mode);
    }
    for edge in coverage.edges() {
        files.entry(&edge.place.path).or_default().1.push(edge);
    }
    let mut out = String::new();
    for (path, (modes, edges)) in files {
        // Writing to a string cannot fail.
        let _ = file(&mut out, path, &modes, &edges);
    }
    out
}

fn file(out: &mut String, path: &str, modes: &[&ModeCoverage], edges: &[&EdgeCoverage]) -> std::fmt::Result {
    writeln!(out, "TN:\nSF:{path}")?;
    let name = |mode: &ModeCoverage| format!("{}.{}", mode.entity, mode.mode);
    for mode in modes {
        writeln!(out, "FN:{},{}", mode.place.line, name(mode))?;
    }
    for mode in modes {
        writeln!(out, "FNDA:{},{}", mode.entered, name(mode))?;
    }
    let entered = modes.iter().filter(|mode| mode.entered > 0).count();
    writeln!(out, "FNF:{}\nFNH:{entered}", modes.len())?;
    let (mut found, mut hit) = (0, 0);
    for (block, edge) in edges.iter().enumerate() {
        for (part, counts) in edge.parts.iter().enumerate() {
            for (side, count) in [counts.held, counts.failed].into_iter().enumerate() {
                let taken = if edge.tried == 0 { "-".to_string() } else { count.to_string() };
                writeln!(out, "BRDA:{},{block},{},{taken}", edge.place.line, 2 * part + side)?;
                (found, hit) = (found + 1, hit + usize::from(count > 0));
            }
        }
    }
    writeln!(out, "BRF:{found}\nBRH:{hit}")?;
    let mut lines: BTreeMap<usize, u64> = BTreeMap::new();
    let counts = modes.iter().map(|mode| (mode.place.line, mode.entered));
    for (line, count) in counts.chain(edges.iter().map(|edge| (edge.place.line, edge.taken))) {
        let known = lines.entry(line).or_default();
        *known = count.max(*known);
    }
    for (line, count) in &lines {
        writeln!(out, "DA:{line},{count}")?;
    }
    let hit = lines.values().filter(|count| **count > 0).count();
    writeln!(out, "LF:{}\nLH:{hit}\nend_of_record", lines.len())
}
