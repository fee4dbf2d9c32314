//! Writer of Mermaid's `stateDiagram-v2`. Labels escape Mermaid's syntax.

use super::excerpt::short;
use super::writer::{Writer, write_all};
use super::{Action, Chart, Edge, Initial, Mode};

/// Maximum number of characters of a guard, and of all updates of an edge.
const WIDTH: usize = 80;

/// Writes charts as one Mermaid diagram.
pub fn mermaid(charts: &[Chart]) -> String {
    let mut out = String::from("stateDiagram-v2\n");
    write_all(charts, &mut out, write_chart);
    out
}

/// The node for edges of a mode: with inner modes, a state inside it, as Mermaid draws no edge from a state into itself.
fn end(out: &Writer<'_>, mode: usize) -> String {
    if out.chart.modes[mode].initial.is_some() { format!("{}_self", out.node(mode)) } else { out.node(mode) }
}

fn write_chart(out: &mut Writer<'_>) {
    let (chart, prefix) = (out.chart, out.prefix.clone());
    out.line(1, &format!("state \"{}\" as {prefix} {{", escaped(&chart.entity)));
    if chart.regions.is_empty() {
        out.line(2, &format!("{prefix}_none : no modes"));
    }
    for (index, region) in chart.regions.iter().enumerate() {
        // Mermaid's own regions, `--`, have no names.
        let named = region.name.as_ref().map(|name| format!("state \"{}\" as {prefix}_g{index} {{", escaped(name)));
        let depth = if let Some(head) = named {
            if index > 0 {
                out.line(2, "--");
            }
            out.line(2, &head);
            3
        } else {
            2
        };
        write_initial(out, depth, &region.initial);
        // Mermaid places a state where it is named last, so the edges come before the states.
        let inside = |edge: &&Edge| region.modes.contains(&outermost(out, edge.source));
        let edges: Vec<&Edge> = chart.edges.iter().filter(inside).collect();
        for edge in edges {
            let (from, to) = (end(out, edge.source), end(out, edge.target));
            out.line(depth, &format!("{from} --> {to} : {}", escaped(&edge_label(edge))));
        }
        for &mode in &region.modes {
            write_mode(out, depth, mode);
        }
        if depth == 3 {
            out.line(2, "}");
        }
    }
    out.line(1, "}");
}

fn outermost(out: &Writer<'_>, mode: usize) -> usize {
    out.chart.modes[mode].parent.map_or(mode, |parent| outermost(out, parent))
}

fn write_mode(out: &mut Writer<'_>, depth: usize, index: usize) {
    let mode = &out.chart.modes[index];
    let (node, name) = (out.node(index), escaped(&mode.title()));
    let Some(initial) = &mode.initial else {
        out.line(depth, &format!("state \"{name}\" as {node}"));
        write_actions(out, depth, &node, mode);
        return;
    };
    out.line(depth, &format!("state \"{name}\" as {node} {{"));
    let own = format!("{node}_self");
    out.line(depth + 1, &format!("state \"({name})\" as {own}"));
    write_actions(out, depth + 1, &own, mode);
    write_initial(out, depth + 1, initial);
    for &child in &mode.children {
        write_mode(out, depth + 1, child);
    }
    out.line(depth, "}");
}

fn write_actions(out: &mut Writer<'_>, depth: usize, node: &str, mode: &Mode) {
    for update in &mode.entry {
        out.line(depth, &format!("{node} : {}", escaped(&format!("entry / {}", short(update, WIDTH)))));
    }
    for action in &mode.internal {
        out.line(depth, &format!("{node} : {}", escaped(&action_label(action))));
    }
}

fn write_initial(out: &mut Writer<'_>, depth: usize, initial: &Initial) {
    for (guard, mode) in &initial.choices {
        let (node, label) = (end(out, *mode), escaped(&short(guard, WIDTH)));
        out.line(depth, &format!("[*] --> {node} : {label}"));
    }
    let node = end(out, initial.mode);
    out.line(depth, &format!("[*] --> {node}"));
}

fn edge_label(edge: &Edge) -> String {
    let action =
        Action { edge: Some(edge.id), guard: format!("{}. {}", edge.order, edge.guard), updates: edge.updates.clone() };
    action_label(&action)
}

fn action_label(action: &Action) -> String {
    let guard = short(&action.guard, WIDTH);
    if action.updates.is_empty() { guard } else { format!("{guard} / {}", short(&action.updates.join(", "), WIDTH)) }
}

/// Escapes special characters of Mermaid and HTML as numeric entities.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        if c.is_alphanumeric() || " _.,()/+*=!'…·".contains(c) {
            out.push(c);
        } else {
            out.push_str(&format!("#{};", u32::from(c)));
        }
    }
    out
}
