//! Writer of Mermaid's `stateDiagram-v2`. Labels escape Mermaid's syntax.

use super::excerpt::short;
use super::{Action, Chart, Edge, Initial, Mode};

/// Maximum number of characters of a guard, and of all updates of an edge.
const WIDTH: usize = 80;

/// Writes charts as one Mermaid diagram.
pub fn mermaid(charts: &[Chart]) -> String {
    let mut out = String::from("stateDiagram-v2\n");
    for (index, chart) in charts.iter().enumerate() {
        Writer { chart, prefix: format!("e{index}"), out: &mut out }.chart();
    }
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

    /// The node for edges of a mode: with inner modes, a state inside it, as Mermaid draws no edge from a state into
    /// itself.
    fn end(&self, mode: usize) -> String {
        if self.chart.modes[mode].initial.is_some() { format!("{}_self", self.node(mode)) } else { self.node(mode) }
    }

    fn chart(&mut self) {
        let (chart, prefix) = (self.chart, self.prefix.clone());
        self.line(1, &format!("state \"{}\" as {prefix} {{", escaped(&chart.entity)));
        if chart.regions.is_empty() {
            self.line(2, &format!("{prefix}_none : no modes"));
        }
        for (index, region) in chart.regions.iter().enumerate() {
            // Mermaid's own regions, `--`, have no names.
            let named = region.name.as_ref().map(|name| format!("state \"{}\" as {prefix}_g{index} {{", escaped(name)));
            let depth = if let Some(head) = named {
                if index > 0 {
                    self.line(2, "--");
                }
                self.line(2, &head);
                3
            } else {
                2
            };
            self.initial(depth, &region.initial);
            // Mermaid places a state where it is named last, so the edges come before the states.
            let inside = |edge: &&Edge| region.modes.contains(&self.outermost(edge.source));
            let edges: Vec<&Edge> = chart.edges.iter().filter(inside).collect();
            for edge in edges {
                let (from, to) = (self.end(edge.source), self.end(edge.target));
                self.line(depth, &format!("{from} --> {to} : {}", escaped(&edge_label(edge))));
            }
            for &mode in &region.modes {
                self.mode(depth, mode);
            }
            if depth == 3 {
                self.line(2, "}");
            }
        }
        self.line(1, "}");
    }

    fn outermost(&self, mode: usize) -> usize {
        self.chart.modes[mode].parent.map_or(mode, |parent| self.outermost(parent))
    }

    fn mode(&mut self, depth: usize, index: usize) {
        let mode = &self.chart.modes[index];
        let (node, name) = (self.node(index), escaped(&title(mode)));
        let Some(initial) = &mode.initial else {
            self.line(depth, &format!("state \"{name}\" as {node}"));
            self.actions(depth, &node, mode);
            return;
        };
        self.line(depth, &format!("state \"{name}\" as {node} {{"));
        let own = format!("{node}_self");
        self.line(depth + 1, &format!("state \"({name})\" as {own}"));
        self.actions(depth + 1, &own, mode);
        self.initial(depth + 1, initial);
        for &child in &mode.children {
            self.mode(depth + 1, child);
        }
        self.line(depth, "}");
    }

    fn actions(&mut self, depth: usize, node: &str, mode: &Mode) {
        for update in &mode.entry {
            self.line(depth, &format!("{node} : {}", escaped(&format!("entry / {}", short(update, WIDTH)))));
        }
        for action in &mode.internal {
            self.line(depth, &format!("{node} : {}", escaped(&action_label(action))));
        }
    }

    fn initial(&mut self, depth: usize, initial: &Initial) {
        for (guard, mode) in &initial.choices {
            let (node, label) = (self.end(*mode), escaped(&short(guard, WIDTH)));
            self.line(depth, &format!("[*] --> {node} : {label}"));
        }
        let node = self.end(initial.mode);
        self.line(depth, &format!("[*] --> {node}"));
    }
}

fn title(mode: &Mode) -> String {
    if mode.timed { format!("{} · timer", mode.name) } else { mode.name.clone() }
}

fn edge_label(edge: &Edge) -> String {
    let action = Action { guard: format!("{}. {}", edge.order, edge.guard), updates: edge.updates.clone() };
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
