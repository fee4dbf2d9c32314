//! Writer of self-contained SVG: no script, font or style from outside. It follows the reader's light or dark scheme.

use super::chart::{Chart, Edge};
use super::layout::{INDENT, LINE, Layout, LineKind, NONE, NUMBER, PAD, Rect, Route, layout, letters};
use crate::ir::Extremes;

const MARGIN: f64 = 12.0;
/// The radius of a corner.
const ROUND: f64 = 5.0;

/// Colours with contrast to white and to black.
const COLORS: [&str; 8] = ["#2f81f7", "#d1414a", "#2da44e", "#a371f7", "#d4772a", "#1b9aaa", "#c2559d", "#8a8f3a"];

const STYLE: &str = "text{font:12px ui-monospace,Menlo,Consolas,\"DejaVu Sans Mono\",monospace;fill:#1f2328}
.paper{fill:#fff}.frame{fill:none;stroke:#6e7781;stroke-width:1.5}.group{fill:none;stroke:#6e7781;stroke-dasharray:5 4}
.mode{fill:#6e7781;fill-opacity:.07;stroke:#6e7781}.name{font-weight:bold}.quiet{fill:#57606a}
.way{fill:none;stroke-width:1.4}.number{font-size:10px;text-anchor:middle;fill:#fff}.first{fill:#1f2328}
.line{fill:none;stroke:#1f2328}
@media(prefers-color-scheme:dark){text{fill:#e6edf3}.paper{fill:#0d1117}.quiet{fill:#9aa4ae}.number{fill:#fff}
.first{fill:#e6edf3}.line{stroke:#e6edf3}}";

/// Draws charts one below the other.
pub fn svg(charts: &[Chart]) -> String {
    let mut body = String::new();
    let (mut width, mut y) = (0.0f64, MARGIN);
    for chart in charts {
        let layout = layout(chart);
        width = width.greatest(layout.rect.width + 2.0 * MARGIN);
        body.push_str(&format!("<g transform=\"translate({MARGIN} {y})\">\n"));
        Drawing { chart, layout: &layout, out: &mut body }.chart();
        body.push_str("</g>\n");
        y += layout.rect.height + MARGIN;
    }
    let names: Vec<&str> = charts.iter().map(|c| c.entity.as_str()).collect();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{y:.0}\" \
         viewBox=\"0 0 {width:.0} {y:.0}\" role=\"img\">\n<title>{}</title>\n<style>{STYLE}</style>\n\
         <rect class=\"paper\" width=\"100%\" height=\"100%\"/>\n{body}</svg>\n",
        escaped(&names.join(", "))
    )
}

struct Drawing<'a> {
    chart: &'a Chart,
    layout: &'a Layout,
    out: &'a mut String,
}

impl Drawing<'_> {
    fn line(&mut self, text: &str) {
        self.out.push_str(text);
        self.out.push('\n');
    }

    fn chart(&mut self) {
        let (chart, layout) = (self.chart, self.layout);
        self.rect("frame", layout.rect);
        self.text("name", (PAD, PAD + LINE / 2.0), &chart.entity);
        if chart.regions.is_empty() {
            self.text("quiet", (PAD, 2.0 * PAD + LINE * 1.5), NONE);
        }
        for (region, rect) in chart.regions.iter().zip(&layout.groups) {
            if let Some(name) = &region.name {
                self.rect("group", *rect);
                self.text("quiet", (rect.x + PAD, rect.y + PAD / 2.0 + LINE / 2.0), name);
            }
        }
        for mode in 0..chart.modes.len() {
            self.mode(mode);
        }
        for route in &layout.routes {
            self.route(route);
        }
    }

    fn mode(&mut self, index: usize) {
        let (mode, b) = (&self.chart.modes[index], &self.layout.boxes[index]);
        self.rect(&format!("mode\" data-mode=\"{index}"), b.rect);
        for line in &b.lines {
            let x = b.rect.x + PAD;
            match line.kind {
                LineKind::Name => {
                    self.text("name", (x, line.y), &line.text);
                    if mode.timed {
                        self.clock(x + letters(&line.text) + LINE / 2.0, line.y);
                    }
                }
                LineKind::Effect => self.text("quiet", (x + INDENT, line.y), &line.text),
                LineKind::Action => self.text("quiet", (x, line.y), &line.text),
                LineKind::Internal(edge) => self.text(&format!("quiet\" data-edge=\"{edge}"), (x, line.y), &line.text),
                LineKind::Guard(edge) => {
                    let edge = &self.chart.edges[edge];
                    let (color, center) = (color(edge.target), x + 7.0);
                    let (id, y) = (edge.id, line.y);
                    self.line(&format!(
                        "<circle data-edge=\"{id}\" cx=\"{center:.1}\" cy=\"{y:.1}\" r=\"7.5\" fill=\"{color}\"/>"
                    ));
                    self.text("number", (center, line.y), &edge.order.to_string());
                    self.text("", (x + NUMBER, line.y), &line.text);
                }
                LineKind::GuardContinued => self.text("", (x + NUMBER, line.y), &line.text),
                LineKind::Update => self.text("quiet", (x + NUMBER, line.y), &line.text),
                LineKind::Target(_) => self.text("", (x + NUMBER, line.y), &line.text),
            }
        }
        if let Some(chosen) = b.initial {
            let (x, y) = (b.rect.x, self.layout.title(index));
            // With a guard, the marker is hollow.
            let class = if chosen { "line" } else { "first" };
            self.line(&format!("<circle class=\"{class}\" cx=\"{:.1}\" cy=\"{y:.1}\" r=\"4\"/>", x - 16.0));
            self.line(&format!("<path class=\"line\" d=\"M{:.1} {y:.1}H{:.1}\"/>", x - 12.0, x - 5.0));
            self.line(&format!("<path class=\"first\" d=\"M{x:.1} {y:.1}l-6 -3.5v7z\"/>"));
        }
    }

    /// All edges to one mode.
    fn route(&mut self, route: &Route) {
        let color = color(route.target);
        let (to, end) = (self.layout.boxes[route.target].rect.right(), self.layout.title(route.target));
        let x = route.x;
        for &id in &route.edges {
            let edge = &self.chart.edges[id];
            let (from, start) = self.layout.start(id);
            let turn = if start < end { ROUND } else { -ROUND };
            self.line(&format!(
                "<path class=\"way\" data-edge=\"{}\" stroke=\"{color}\" d=\"M{:.1} {start:.1}H{:.1}Q{x:.1} {start:.1} {x:.1} {:.1}V{:.1}Q{x:.1} {end:.1} {:.1} {end:.1}H{:.1}\"><title>{}</title></path>",
                edge.id,
                from + 5.0,
                x - ROUND,
                start + turn,
                end - turn,
                x - ROUND,
                to + 5.0,
                escaped(&self.edge_text(edge)),
            ));
        }
        self.line(&format!("<path fill=\"{color}\" d=\"M{to:.1} {end:.1}l7 -4v8z\"/>"));
    }

    /// The full text of an edge.
    fn edge_text(&self, edge: &Edge) -> String {
        let mode = |mode: usize| &self.chart.modes[mode].path;
        let updates = edge.updates.join("; ");
        let updates = if updates.is_empty() { updates } else { format!(" {{ {updates} }}") };
        format!("{}: when {} -> {}{updates}", mode(edge.source), edge.guard, mode(edge.target))
    }

    fn clock(&mut self, x: f64, y: f64) {
        self.line(&format!("<circle class=\"line\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"5.5\"/>"));
        self.line(&format!("<path class=\"line\" d=\"M{x:.1} {:.1}V{y:.1}H{:.1}\"/>", y - 4.0, x + 3.0));
    }

    fn rect(&mut self, class: &str, Rect { x, y, width, height }: Rect) {
        self.line(&format!(
            "<rect class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" rx=\"{ROUND}\"/>"
        ));
    }

    fn text(&mut self, class: &str, (x, y): (f64, f64), text: &str) {
        let class = if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") };
        // From the middle of the letters to their baseline.
        let y = y + if class.contains("number") { 3.5 } else { 4.2 };
        self.line(&format!("<text{class} x=\"{x:.1}\" y=\"{y:.1}\">{}</text>", escaped(text)));
    }
}

/// The colour of the edges to a target.
fn color(target: usize) -> &'static str {
    COLORS[target % COLORS.len()]
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
