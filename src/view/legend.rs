//! The legend below the panels: exactly the signs in the picture.

use crate::ir::{Origin, Space};

use super::appearance::Role;
use super::body::pushes;
use super::frame::Rect;
use super::heat::{self, LEVELS};
use super::look;
use super::moment;
use super::panel::{HEROES, PictureContext};
use super::svg::{Number, escaped, put, shortened, text_width};
use super::track::Track;

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
    /// With its style, and the symbol of its picture.
    Tile(String, String, Option<String>),
    Goal,
    /// With the class of the player's colour.
    Route(&'static str),
    Way,
    Gone,
    Line(&'static str),
    Dot(&'static str, f64),
    Ghost(&'static str),
    Heat,
}

/// Draws the legend with a maximum width; returns its height.
pub(super) fn draw(out: &mut String, context: &PictureContext<'_>, width: f64) -> f64 {
    let (mut x, mut y) = (0.0, 0.0);
    for (sign, words) in entries(context) {
        let swatch = match sign {
            Sign::Heat => LEVELS as f64 * 14.0,
            Sign::Route(_) => 1.6 * SWATCH,
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
    let routes: Vec<_> = context.routes.iter().filter(|route| route.track.stops.len() > 1).collect();
    let mut colors: Vec<&str> = routes.iter().map(|route| route.color).collect();
    colors.dedup();
    for color in &colors {
        let of = routes.iter().find(|route| route.color == *color).map(|route| route.track.slot);
        let name = of.map_or("", |slot| context.world.slots[slot].name.as_str());
        let words = if colors.len() > 1 {
            format!("path of {name}, from start to end")
        } else {
            "path, from start to end".into()
        };
        entries.push((Sign::Route(color), words));
    }
    if !routes.is_empty() {
        if routes.iter().any(|route| route.track.stops.iter().any(|stop| stop.changes)) {
            entries.push((Sign::Dot("dot", 2.5), "inputs change".into()));
        }
        for (is_hardest, words) in [(false, "needs timing: steps too early, too late"), (true, "the hardest moment")] {
            if context.picture.run.moments.iter().any(|moment| moment.is_hardest == is_hardest) {
                entries.push((Sign::Dot(moment::class(is_hardest), moment::RADIUS), words.into()));
            }
        }
        entries.push((Sign::Ghost("ghost"), "player on its way".into()));
        if routes.iter().any(|route| route.segments.len() > 1) {
            entries.push((Sign::Dot("door", 7.0), "leaves and arrives, in order".into()));
        }
    }
    if !context.ways.is_empty() {
        entries.push((Sign::Way, "others on their way".into()));
        let is_gone = |track: &&Track| track.is_destroyed && context.world.slots[track.slot].origin != Origin::Free;
        if context.ways.iter().any(is_gone) {
            entries.push((Sign::Gone, "destroyed".into()));
        }
    }
    for (is_never, words) in [(false, "goal reached"), (true, "`never` violated")] {
        if !context.routes.is_empty() && context.picture.run.marks.iter().any(|mark| mark.is_never == is_never) {
            entries.push((Sign::Dot(if is_never { "broken" } else { "reached" }, 7.0), words.into()));
        }
    }
    if !context.picture.nodes.is_empty() {
        entries.push((Sign::Heat, "where the player was: seldom to often".into()));
        entries.push((Sign::Line("tree key"), "moves tried".into()));
    }
    let layers = context.picture.layers;
    for (index, layer) in layers.iter().enumerate().filter(|(_, layer)| !layer.places.is_empty()) {
        let class = format!("layer {}", heat::layer_class(index, layers.len()));
        entries.push((Sign::Box(class), layer.name.clone()));
    }
    if !context.picture.traps.is_empty() {
        entries.push((Sign::Box("trap".into()), "players are stuck here".into()));
    }
    let areas: Vec<&str> =
        context.goals.iter().filter(|goal| !goal.areas.is_empty()).map(|goal| goal.name.as_str()).collect();
    if !areas.is_empty() {
        let kind = if areas.len() > 1 { "goals" } else { "goal" };
        entries.push((Sign::Goal, format!("{kind} {}", areas.join(", "))));
    }
    for appearance in &context.appearances.list {
        let note = match appearance.role {
            Role::OneWay => " (from above)",
            Role::Scenery => " (no contact)",
            Role::ForOthers => " (no contact with players)",
            Role::Sensed | Role::Solid => "",
        };
        let look = appearance.look.as_ref();
        let symbol = look.and_then(|look| context.picture.images.symbol(look));
        let sign = Sign::Tile(format!("tile {}", appearance.class), look::fill(look), symbol);
        entries.push((sign, format!("{}{note}", appearance.name)));
    }
    if context.world.spaces.iter().any(|space| !space.links.is_empty()) {
        entries.push((Sign::Box("link".into()), "link to another place".into()));
    }
    if context.bounded {
        entries.push((Sign::Line("bounds"), "bounds".into()));
    }
    if context.world.spaces.iter().any(Space::wraps) {
        entries.push((Sign::Line("bounds"), "border that is one with the opposite one".into()));
    }
    let heroes = context.world.players.iter().zip(HEROES.iter().cycle());
    for (player, class) in heroes {
        let name = &context.world.slots[player.slot].name;
        let words = if context.world.players.len() > 1 { name.clone() } else { "player".into() };
        entries.push((Sign::Box((*class).into()), format!("{words} at the start")));
    }
    let others = |sensor: bool| {
        let there =
            context.world.slots.pairs().filter(|(_, slot)| slot.origin != Origin::Free && slot.player.is_none());
        let mut colliders = there.flat_map(|(_, slot)| context.program.entities[slot.entity].colliders.iter());
        colliders.any(|collider| pushes(context.world, collider.tags) != sensor)
    };
    if others(false) {
        entries.push((Sign::Box("thing".into()), "other instances at the start".into()));
    }
    if others(true) {
        entries.push((Sign::Box("thing sensor".into()), "those that only sense".into()));
    }
    entries
}

fn draw_sign(out: &mut String, sign: &Sign, x: f64, y: f64) {
    let (left, top, center) = (Number(x), Number(y), Number(y + 7.0));
    match sign {
        Sign::Box(class) => draw_sign(out, &Sign::Tile(class.clone(), String::new(), None), x, y),
        Sign::Tile(_, _, Some(symbol)) => {
            look::draw(out, symbol, Rect { x: x + (SWATCH - 14.0) / 2.0, y, width: 14.0, height: 14.0 });
        }
        Sign::Tile(class, style, None) => {
            put!(out, "<rect class=\"{class}\"{style} x=\"{left}\" y=\"{top}\" width=\"{SWATCH}\" height=\"14\"/>\n");
            if class.ends_with("cloud") {
                put!(out, "<rect class=\"tile lip\" x=\"{left}\" y=\"{top}\" width=\"{SWATCH}\" height=\"3\"/>\n");
            }
        }
        Sign::Goal => {
            for class in ["goal", "rim"] {
                draw_sign(out, &Sign::Box(class.into()), x, y);
            }
        }
        Sign::Route(color) => {
            let (left, right) = (Number(x + 7.0), Number(x + 1.6 * SWATCH - 7.0));
            put!(out, "<path class=\"route{color}\" d=\"M{left} {center}H{right}\"/>\n");
            put!(out, "<circle class=\"start{color}\" cx=\"{left}\" cy=\"{center}\" r=\"5\"/>\n");
            put!(out, "<circle class=\"end{color}\" cx=\"{right}\" cy=\"{center}\" r=\"6\"/>\n");
        }
        Sign::Line(class) => put!(out, "<path class=\"{class}\" d=\"M{left} {center}h{SWATCH}\"/>\n"),
        Sign::Dot(class, radius) => {
            let middle = Number(x + SWATCH / 2.0);
            put!(out, "<circle class=\"{class}\" cx=\"{middle}\" cy=\"{center}\" r=\"{radius}\"/>\n");
        }
        Sign::Way => {
            put!(out, "<path class=\"trail\" d=\"M{left} {center}h{SWATCH}\"/>\n");
            draw_sign(out, &Sign::Ghost("mover"), x, y);
        }
        Sign::Gone => {
            let middle = Number(x + SWATCH / 2.0 - 4.0);
            put!(out, "<path class=\"gone\" d=\"M{middle} {}l8 8m0 -8l-8 8\"/>\n", Number(y + 3.0));
        }
        Sign::Ghost(class) => {
            let middle = Number(x + (SWATCH - 12.0) / 2.0);
            put!(out, "<rect class=\"{class}\" x=\"{middle}\" y=\"{top}\" width=\"12\" height=\"14\"/>\n");
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
