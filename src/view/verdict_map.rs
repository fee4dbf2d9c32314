//! A map of verdicts over the values of one or two numbers of a program: a cell for each, with a legend. Verdicts differ
//! by colour and by sign, so that the map is read without colours, too.

use super::style::STYLE;
use super::svg::{Number, escaped, put, shortened, text_width};
use crate::ir::Extremes;

/// What came of a question.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shade {
    /// The goal is reached.
    Reached,
    /// The `never` is violated.
    Violated,
    /// Neither found nor proven.
    Open,
    /// No way with axes at -1, 0 and 1.
    Exhausted,
    /// The goal is proven unreachable.
    Unreachable,
    /// The `never` is proven.
    Safe,
    /// The program with these values has errors.
    Error,
}

impl Shade {
    const ALL: [Shade; 7] =
        [Shade::Reached, Shade::Violated, Shade::Open, Shade::Exhausted, Shade::Unreachable, Shade::Safe, Shade::Error];

    fn class(self) -> &'static str {
        match self {
            Shade::Reached => "m0",
            Shade::Violated => "m1",
            Shade::Open => "m2",
            Shade::Exhausted => "m3",
            Shade::Unreachable => "m4",
            Shade::Safe => "m5",
            Shade::Error => "m6",
        }
    }

    /// The sign of a cell without a number of steps.
    fn sign(self) -> &'static str {
        match self {
            Shade::Reached | Shade::Violated => "",
            Shade::Open => "?",
            Shade::Exhausted => "~",
            Shade::Unreachable => "×",
            Shade::Safe => "✓",
            Shade::Error => "!",
        }
    }

    fn words(self) -> &'static str {
        match self {
            Shade::Reached => "reached, in so many steps",
            Shade::Violated => "violated, in so many steps",
            Shade::Open => "not found: nothing is proven",
            Shade::Exhausted => "no way with axes at -1, 0 and 1",
            Shade::Unreachable => "proven unreachable",
            Shade::Safe => "proven: it never holds",
            Shade::Error => "the program has errors",
        }
    }
}

/// The verdicts of one question.
#[derive(Debug, Clone)]
pub struct VerdictPanel {
    /// The question.
    pub title: String,
    /// What came of it at each point, with the steps of the path; the second number varies fastest.
    pub cells: Vec<(Shade, Option<u64>)>,
}

/// A map of verdicts.
#[derive(Debug, Clone)]
pub struct VerdictMap {
    /// Its title.
    pub title: String,
    /// One or two numbers with their values.
    pub axes: Vec<(String, Vec<String>)>,
    /// A panel for each question.
    pub panels: Vec<VerdictPanel>,
}

const MARGIN: f64 = 24.0;
/// Height of a cell.
const HEIGHT: f64 = 26.0;
/// Least and greatest width of a cell, and of the cells of a panel together.
const CELL: (f64, f64) = (12.0, 52.0);
const ROOM: f64 = 900.0;
/// The width from which on numbers fit into a cell.
const FOR_NUMBERS: f64 = 34.0;
/// Distance of two labels of an axis.
const LABEL: f64 = 10.0;

const COLORS: &str = "\
.m0{fill:#2da44e}.m1{fill:#d1242f}.m2{fill:#d8dee4}.m3{fill:#bfa46a}.m4{fill:#57606a}.m5{fill:#0969da}.m6{fill:#bf3989}
.cell{stroke:#fff;stroke-width:1.5}.in{font-size:11px;text-anchor:middle;fill:#fff}.in.dark{fill:#1f2328}
.mid{text-anchor:middle}.far{text-anchor:end}
@media(prefers-color-scheme:dark){.cell{stroke:#0d1117}.m2{fill:#363d47}.in.dark{fill:#e6edf3}.m3{fill:#7d6608}.m4{fill:#8b949e}}";

/// Draws a map.
pub fn verdict_map_svg(map: &VerdictMap) -> String {
    // One number goes to the right; of two, the first goes upwards.
    let none = (String::new(), Vec::new());
    let (up, across) = match map.axes.as_slice() {
        [only] => (&none, only),
        [first, second, ..] => (first, second),
        [] => (&none, &none),
    };
    let columns = across.1.len().max(1);
    let rows = up.1.len().max(1);
    let cell = (ROOM / columns as f64).clamp(CELL.0, CELL.1).floor();
    let left =
        up.1.iter().map(|value| text_width(value, 12.0)).fold(0.0, f64::greatest) + if rows > 1 { 14.0 } else { 0.0 };
    let (wide, high) = (cell * columns as f64, HEIGHT * rows as f64);
    let width = (left + wide).greatest(460.0);
    let (mut out, mut y) = (String::new(), MARGIN + 16.0);
    put!(out, "<text class=\"title\" x=\"{MARGIN}\" y=\"{}\">{}</text>\n", Number(y), escaped(&map.title));
    y += 14.0;
    for panel in &map.panels {
        y += 28.0;
        let title = shortened(&panel.title, 13.0, width);
        put!(out, "<text class=\"head\" x=\"{MARGIN}\" y=\"{}\">{}</text>\n", Number(y), escaped(&title));
        y += 10.0;
        if rows > 1 {
            y += 14.0;
            put!(out, "<text class=\"quiet\" x=\"{MARGIN}\" y=\"{}\">↑ {}</text>\n", Number(y), escaped(&up.0));
            y += 8.0;
        }
        for (index, (shade, steps)) in panel.cells.iter().enumerate() {
            let (row, column) = (index / columns, index % columns);
            let (x, top) = (MARGIN + left + cell * column as f64, y + HEIGHT * (rows - 1 - row.min(rows - 1)) as f64);
            let values = [
                up.1.get(row).map(|v| format!("{} = {v}", up.0)),
                Some(across.1.get(column)).flatten().map(|v| format!("{} = {v}", across.0)),
            ];
            let values: Vec<String> = values.into_iter().flatten().collect();
            let told = steps.map_or(shade.words().to_string(), |steps| {
                shade.words().replace("so many steps", &format!("{steps} steps"))
            });
            put!(
                out,
                "<rect class=\"cell {}\" x=\"{}\" y=\"{}\" width=\"{cell}\" height=\"{HEIGHT}\"><title>{}: {}</title></rect>\n",
                shade.class(),
                Number(x),
                Number(top),
                escaped(&values.join(", ")),
                escaped(&told)
            );
            let word = match steps {
                Some(steps) if cell >= FOR_NUMBERS => steps.to_string(),
                Some(_) => String::new(),
                None => shade.sign().to_string(),
            };
            if !word.is_empty() {
                let dark = if *shade == Shade::Open { " dark" } else { "" };
                let (x, y) = (Number(x + cell / 2.0), Number(top + HEIGHT / 2.0 + 4.0));
                put!(out, "<text class=\"in{dark}\" x=\"{x}\" y=\"{y}\">{word}</text>\n");
            }
        }
        for (row, value) in up.1.iter().enumerate() {
            let at = y + HEIGHT * (rows - 1 - row) as f64 + HEIGHT / 2.0 + 4.0;
            put!(
                out,
                "<text class=\"far\" x=\"{}\" y=\"{}\">{}</text>\n",
                Number(MARGIN + left - 8.0),
                Number(at),
                escaped(value)
            );
        }
        y += high + 16.0;
        let mut free = f64::NEG_INFINITY;
        for (column, value) in across.1.iter().enumerate() {
            let (middle, half) = (MARGIN + left + cell * (column as f64 + 0.5), text_width(value, 12.0) / 2.0);
            if middle - half >= free {
                put!(
                    out,
                    "<text class=\"mid\" x=\"{}\" y=\"{}\">{}</text>\n",
                    Number(middle),
                    Number(y),
                    escaped(value)
                );
                free = middle + half + LABEL;
            }
        }
        y += 18.0;
        put!(
            out,
            "<text class=\"quiet\" x=\"{}\" y=\"{}\">{} →</text>\n",
            Number(MARGIN + left),
            Number(y),
            escaped(&across.0)
        );
    }
    y += 14.0;
    for shade in Shade::ALL {
        let count = map.panels.iter().flat_map(|panel| &panel.cells).filter(|(of, _)| *of == shade).count();
        if count == 0 {
            continue;
        }
        y += 22.0;
        let (class, sign) = (shade.class(), shade.sign());
        put!(
            out,
            "<rect class=\"cell {class}\" x=\"{MARGIN}\" y=\"{}\" width=\"26\" height=\"18\"/>\n",
            Number(y - 13.0)
        );
        let dark = if shade == Shade::Open { " dark" } else { "" };
        put!(out, "<text class=\"in{dark}\" x=\"{}\" y=\"{}\">{sign}</text>\n", Number(MARGIN + 13.0), Number(y));
        put!(out, "<text x=\"{}\" y=\"{}\">{} ({count})</text>\n", Number(MARGIN + 36.0), Number(y), shade.words());
    }
    let title_width = text_width(&map.title, 20.0) * 1.05;
    let (width, height) = (Number((width.greatest(title_width) + 2.0 * MARGIN).ceil()), Number((y + MARGIN).ceil()));
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         role=\"img\">\n<title>{}</title>\n<style>{STYLE}\n{COLORS}</style>\n\
         <rect class=\"paper\" width=\"{width}\" height=\"{height}\"/>\n{out}</svg>\n",
        escaped(&map.title)
    )
}
