//! What the writers of text share: indented lines, the names of nodes, and the words of a mode.

use super::{Chart, Mode};

/// Writes the chart of one entity.
pub(super) struct Writer<'a> {
    pub chart: &'a Chart,
    /// What the names of all its nodes begin with.
    pub prefix: String,
    out: &'a mut String,
}

/// Writes charts one after the other.
pub(super) fn write_all(charts: &[Chart], out: &mut String, write: impl Fn(&mut Writer<'_>)) {
    for (index, chart) in charts.iter().enumerate() {
        write(&mut Writer { chart, prefix: format!("e{index}"), out });
    }
}

impl Writer<'_> {
    /// A line.
    pub fn line(&mut self, depth: usize, text: &str) {
        self.out.push_str(&format!("{}{text}\n", "  ".repeat(depth)));
    }

    /// The node of a mode.
    pub fn node(&self, mode: usize) -> String {
        format!("{}_m{mode}", self.prefix)
    }
}

impl Mode {
    /// Its name, and whether its timer is read.
    pub(super) fn title(&self) -> String {
        if self.timed { format!("{} · timer", self.name) } else { self.name.clone() }
    }
}
