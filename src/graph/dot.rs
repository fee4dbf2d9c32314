//! Writer of DOT, for Graphviz. A mode with inner modes is a cluster; its own edges start at a node in it that has its
//! name.

use super::excerpt::{short, wrapped};
use super::{Action, Chart, Edge, Initial, Mode};

/// Maximum number of characters of a line of a label, and of an update.
const WIDTH: usize = 40;

/// Writes charts as one DOT graph.
pub fn dot(charts: &[Chart]) -> String {
    let mut out = String::from("digraph statecharts {\n");
    out.push_str("  newrank=true fontname=\"Helvetica\" bgcolor=\"transparent\"\n");
    out.push_str("  node [shape=box style=\"rounded,filled\" fillcolor=\"#f6f8fa\" color=\"#57606a\" fontname=\"Helvetica\" fontsize=11]\n");
    out.push_str("  edge [color=\"#57606a\" fontname=\"Helvetica\" fontsize=10]\n");
    for (index, chart) in charts.iter().enumerate() {
        Writer { chart, prefix: format!("e{index}"), out: &mut out }.chart();
    }
    out.push_str("}\n");
    out
}

struct Writer<'a> {
    chart: &'a Chart,
    prefix: String,
    out: &'a mut String,
}

impl Writer<'_> {
    fn line(&mut self, depth: usize, text: &str) {
        self.out.push_str(&format!("{}{text}\n", "  ".repeat(depth)));
    }

    fn node(&self, mode: usize) -> String {
        format!("{}_m{mode}", self.prefix)
    }

    fn chart(&mut self) {
        let (chart, prefix) = (self.chart, self.prefix.clone());
        self.line(1, &format!("subgraph cluster_{prefix} {{"));
        self.line(
            2,
            &format!(
                "label={} style=rounded penwidth=2 color=\"#57606a\"",
                quoted(std::slice::from_ref(&chart.entity))
            ),
        );
        if chart.regions.is_empty() {
            self.line(2, &format!("{prefix}_none [label=\"no modes\" shape=plaintext style=\"\"]"));
        }
        for (index, region) in chart.regions.iter().enumerate() {
            self.line(2, &format!("subgraph cluster_{prefix}_g{index} {{"));
            let label = region.name.iter().cloned().collect::<Vec<_>>();
            self.line(3, &format!("label={} style=dashed penwidth=1 color=\"#57606a\"", quoted(&label)));
            self.initial(3, &format!("{prefix}_g{index}_first"), &region.initial);
            for &mode in &region.modes {
                self.mode(3, mode);
            }
            self.line(2, "}");
        }
        for edge in &chart.edges {
            let (from, to) = (self.node(edge.source), self.node(edge.target));
            self.line(2, &format!("{from} -> {to} [label={}]", quoted(&edge_label(edge))));
        }
        self.line(1, "}");
    }

    fn mode(&mut self, depth: usize, index: usize) {
        let mode = &self.chart.modes[index];
        let (node, label) = (self.node(index), quoted(&mode_label(mode)));
        let Some(initial) = &mode.initial else {
            self.line(depth, &format!("{node} [label={label}]"));
            return;
        };
        self.line(depth, &format!("subgraph cluster_{node} {{"));
        self.line(depth + 1, "label=\"\" style=rounded penwidth=1 color=\"#57606a\"");
        self.line(depth + 1, &format!("{node} [label={label} style=filled penwidth=0 fontname=\"Helvetica-Bold\"]"));
        self.initial(depth + 1, &format!("{node}_first"), initial);
        self.line(depth + 1, &format!("{node} -> {node}_first [style=invis]"));
        for &child in &mode.children {
            self.mode(depth + 1, child);
        }
        self.line(depth, "}");
    }

    fn initial(&mut self, depth: usize, point: &str, initial: &Initial) {
        self.line(
            depth,
            &format!("{point} [label=\"\" shape=circle width=0.12 fixedsize=true style=filled fillcolor=\"#57606a\"]"),
        );
        for (guard, mode) in &initial.choices {
            let (node, label) = (self.node(*mode), quoted(&wrapped(guard, WIDTH)));
            self.line(depth, &format!("{point} -> {node} [label={label}]"));
        }
        let node = self.node(initial.mode);
        self.line(depth, &format!("{point} -> {node}"));
    }
}

fn mode_label(mode: &Mode) -> Vec<String> {
    let mut lines = vec![if mode.timed { format!("{} · timer", mode.name) } else { mode.name.clone() }];
    lines.extend(mode.entry.iter().map(|update| format!("entry / {}", short(update, WIDTH))));
    for Action { guard, updates } in &mode.internal {
        lines.extend(wrapped(guard, WIDTH));
        lines.extend(updates.iter().map(|update| format!("/ {}", short(update, WIDTH))));
    }
    lines
}

fn edge_label(edge: &Edge) -> Vec<String> {
    let mut lines = wrapped(&format!("{}: {}", edge.order, edge.guard), WIDTH);
    lines.extend(edge.updates.iter().map(|update| format!("/ {}", short(update, WIDTH))));
    lines
}

/// Lines as a string of DOT, left-aligned except for the first.
fn quoted(lines: &[String]) -> String {
    let end = if lines.len() > 1 { "\\l" } else { "" };
    let escaped = lines.iter().map(|line| line.replace('&', "&amp;").replace('\\', "\\\\").replace('"', "\\\"") + end);
    format!("\"{}\"", escaped.collect::<String>())
}
