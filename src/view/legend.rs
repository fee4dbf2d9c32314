//! The legend below the panels: exactly the signs in the picture.

use crate::ir::{Origin, Space};

use super::appearance::Role;
use super::heat::{self, LEVELS};
use super::panel::PictureContext;
use super::svg::{Number, escaped, put, shortened, text_width};

const SIZE: f64 = 12.0;
/// The height of a row.
const ROW: f64 = 24.0;
/// Width of a sign.
const SWATCH: f64 = 26.0;
/// Distance between a sign and its text, and between entries.
const GAP: f64 = 7.0;
const APART: f64 = 22.0;

/// The sign of an entry, drawn in a box of `SWATCH` by 14.
enum Sign {
    Box(String),
    Goal,
    Route,
    Line(&'static str),
    Dot(&'static str, f64),
    Ghost,
    Heat,
}

/// Draws the legend with a maximum width; returns its height.
pub(super) fn draw(out: &mut String, context: &PictureContext<'_>, width: f64) -> f64 {
    let (mut x, mut y) = (0.0, 0.0);
    for (sign, words) in entries(context) {
        let swatch = match sign {
            Sign::Heat => LEVELS as f64 * 14.0,
            Sign::Route => 1.6 * SWATCH,
            _ => SWATCH,
        };
        let words = shortened(&words, SIZE, width - swatch - GAP);
        let whole = swatch + GAP + text_width(&words, SIZE);
        if x > 0.0 && x + whole > width {
            (x, y) = (0.0, y + ROW);
        }
        draw_sign(out, &sign, x, y + (ROW - 14.0) / 2.0);
        let (left, line) = (Number(x + swatch + GAP), Number(y + ROW / 2.0 + 4.2));
        put!(out, "<text x=\"{left}\" y=\"{line}\">{}</text>\n", escaped(&words));
        x += whole + APART;
    }
    y + ROW
}

fn entries(context: &PictureContext<'_>) -> Vec<(Sign, String)> {
    let mut entries = Vec::new();
    if !context.search.path.is_empty() {
        entries.push((Sign::Route, "path, from start to end".into()));
        if context.search.path.iter().any(|stop| stop.changes) {
            entries.push((Sign::Dot("dot", 2.5), "inputs change".into()));
        }
        if context.route.body.is_some() {
            entries.push((Sign::Ghost, "player on its way".into()));
        }
        if context.route.segments.len() > 1 {
            entries.push((Sign::Dot("door", 7.0), "leaves and arrives, in order".into()));
        }
    }
    if !context.search.nodes.is_empty() {
        entries.push((Sign::Heat, "where the player was: seldom to often".into()));
        entries.push((Sign::Line("tree key"), "moves tried".into()));
    }
    if !context.goal.areas.is_empty() {
        entries.push((Sign::Goal, format!("goal {}", context.search.goal)));
    }
    for appearance in &context.appearances.list {
        let note = match appearance.role {
            Role::OneWay => " (from above)",
            Role::Scenery => " (no contact)",
            Role::Sensed | Role::Solid => "",
        };
        entries.push((Sign::Box(format!("tile {}", appearance.class)), format!("{}{note}", appearance.name)));
    }
    if context.world.spaces.iter().any(|space| !space.links.is_empty()) {
        entries.push((Sign::Box("link".into()), "link to another place".into()));
    }
    if context.bounded {
        entries.push((Sign::Box("bounds".into()), "bounds".into()));
    }
    if context.world.spaces.iter().any(Space::wraps) {
        entries.push((Sign::Line("bounds"), "border that is one with the opposite one".into()));
    }
    if context.hero.is_some() {
        entries.push((Sign::Box("hero".into()), "player at the start".into()));
    }
    let others = context.world.slots.pairs().any(|(id, s)| Some(id) != context.hero && s.origin != Origin::Free);
    if others {
        entries.push((Sign::Box("thing".into()), "other instances at the start".into()));
    }
    entries
}

fn draw_sign(out: &mut String, sign: &Sign, x: f64, y: f64) {
    let (left, top, center) = (Number(x), Number(y), Number(y + 7.0));
    match sign {
        Sign::Box(class) => {
            put!(out, "<rect class=\"{class}\" x=\"{left}\" y=\"{top}\" width=\"{SWATCH}\" height=\"14\"/>\n");
            if class.ends_with("cloud") {
                put!(out, "<rect class=\"tile lip\" x=\"{left}\" y=\"{top}\" width=\"{SWATCH}\" height=\"3\"/>\n");
            }
        }
        Sign::Goal => {
            for class in ["goal", "rim"] {
                draw_sign(out, &Sign::Box(class.into()), x, y);
            }
        }
        Sign::Route => {
            let (left, right) = (Number(x + 7.0), Number(x + 1.6 * SWATCH - 7.0));
            put!(out, "<path class=\"route\" d=\"M{left} {center}H{right}\"/>\n");
            put!(out, "<circle class=\"start\" cx=\"{left}\" cy=\"{center}\" r=\"5\"/>\n");
            put!(out, "<circle class=\"end\" cx=\"{right}\" cy=\"{center}\" r=\"6\"/>\n");
        }
        Sign::Line(class) => put!(out, "<path class=\"{class}\" d=\"M{left} {center}h{SWATCH}\"/>\n"),
        Sign::Dot(class, radius) => {
            let middle = Number(x + SWATCH / 2.0);
            put!(out, "<circle class=\"{class}\" cx=\"{middle}\" cy=\"{center}\" r=\"{radius}\"/>\n");
        }
        Sign::Ghost => {
            let middle = Number(x + (SWATCH - 12.0) / 2.0);
            put!(out, "<rect class=\"ghost\" x=\"{middle}\" y=\"{top}\" width=\"12\" height=\"14\"/>\n");
        }
        Sign::Heat => {
            for level in 0..LEVELS {
                let (left, opacity) = (Number(x + 14.0 * level as f64), Number(heat::opacity(level)));
                put!(
                    out,
                    "<rect class=\"heat\" fill-opacity=\"{opacity}\" x=\"{left}\" y=\"{top}\" width=\"14\" height=\"14\"/>\n"
                );
            }
        }
    }
}
