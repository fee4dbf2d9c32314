//! Writer of DOT, for Graphviz. A mode with inner modes is a cluster; its own edges start at a node in it that has its
//! name.

use super::excerpt::{short, wrapped};
use super::writer::{Writer, write_all};
use super::{Action, Chart, Edge, Initial, Mode};

/// Maximum number of characters of a line of a label, and of an update.
const WIDTH: usize = 40;

/// Writes charts as one DOT graph.
pub fn dot(charts: &[Chart]) -> String {
    let mut out = String::from("digraph statecharts {\n");
    out.push_str("  newrank=true fontname=\"Helvetica\" bgcolor=\"transparent\"\n");
    out.push_str("  node [shape=box style=\"rounded,filled\" fillcolor=\"#f6f8fa\" color=\"#57606a\" fontname=\"Helvetica\" fontsize=11]\n");
    out.push_str("  edge [color=\"#57606a\" fontname=\"Helvetica\" fontsize=10]\n");
    write_all(charts, &mut out, write_chart);
    out.push_str("}\n");
    out
}

fn write_chart(out: &mut Writer<'_>) {
    let (chart, prefix) = (out.chart, out.prefix.clone());
    out.line(1, &format!("subgraph cluster_{prefix} {{"));
    out.line(
        2,
        &format!("label={} style=rounded penwidth=2 color=\"#57606a\"", quoted(std::slice::from_ref(&chart.entity))),
    );
    if chart.regions.is_empty() {
        out.line(2, &format!("{prefix}_none [label=\"no modes\" shape=plaintext style=\"\"]"));
    }
    for (index, region) in chart.regions.iter().enumerate() {
        out.line(2, &format!("subgraph cluster_{prefix}_g{index} {{"));
        let label = region.name.iter().cloned().collect::<Vec<_>>();
        out.line(3, &format!("label={} style=dashed penwidth=1 color=\"#57606a\"", quoted(&label)));
        write_initial(out, 3, &format!("{prefix}_g{index}_first"), &region.initial);
        for &mode in &region.modes {
            write_mode(out, 3, mode);
        }
        out.line(2, "}");
    }
    for edge in &chart.edges {
        let (from, to) = (out.node(edge.source), out.node(edge.target));
        out.line(2, &format!("{from} -> {to} [label={}]", quoted(&edge_label(edge))));
    }
    out.line(1, "}");
}

fn write_mode(out: &mut Writer<'_>, depth: usize, index: usize) {
    let mode = &out.chart.modes[index];
    let (node, label) = (out.node(index), quoted(&mode_label(mode)));
    let Some(initial) = &mode.initial else {
        out.line(depth, &format!("{node} [label={label}]"));
        return;
    };
    out.line(depth, &format!("subgraph cluster_{node} {{"));
    out.line(depth + 1, "label=\"\" style=rounded penwidth=1 color=\"#57606a\"");
    out.line(depth + 1, &format!("{node} [label={label} style=filled penwidth=0 fontname=\"Helvetica-Bold\"]"));
    write_initial(out, depth + 1, &format!("{node}_first"), initial);
    out.line(depth + 1, &format!("{node} -> {node}_first [style=invis]"));
    for &child in &mode.children {
        write_mode(out, depth + 1, child);
    }
    out.line(depth, "}");
}

fn write_initial(out: &mut Writer<'_>, depth: usize, point: &str, initial: &Initial) {
    out.line(
        depth,
        &format!("{point} [label=\"\" shape=circle width=0.12 fixedsize=true style=filled fillcolor=\"#57606a\"]"),
    );
    for (guard, mode) in &initial.choices {
        let (node, label) = (out.node(*mode), quoted(&wrapped(guard, WIDTH)));
        out.line(depth, &format!("{point} -> {node} [label={label}]"));
    }
    let node = out.node(initial.mode);
    out.line(depth, &format!("{point} -> {node}"));
}

fn mode_label(mode: &Mode) -> Vec<String> {
    let mut lines = vec![mode.title()];
    lines.extend(mode.entry.iter().map(|update| format!("entry / {}", short(update, WIDTH))));
    for Action { guard, updates, .. } in &mode.internal {
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
