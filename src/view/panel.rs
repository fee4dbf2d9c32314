//! The panel of a space, layer by layer: the level, the visits, the tree, the instances, the goal, the path, names.

use crate::ir::{Bounds, Origin, Period, Program, SlotId, SpaceId, World};

use super::appearance::{Appearances, Role, role};
use super::body::{Body, placed, position};
use super::extent::Visits;
use super::frame::{Frame, Rect};
use super::goal::{Form, Goal};
use super::heat;
use super::label::Labels;
use super::route::{self, Route, crosses, jumps};
use super::search::Search;
use super::svg::{Number, escaped, line_data, put};
use super::{tiles, tree};

/// Maximum number of lines of the tree and of rectangles of the heat map in the whole picture.
const MAX_LINES: usize = 16_000;
const MAX_HEAT: usize = 6_000;
/// Cells of the heat map per side of a tile.
const CELLS: f64 = 4.0;
/// Maximum side of such a cell in the picture; its side if there are no tiles.
const CELL: f64 = 10.0;

/// Minimum distance of two named instances with the same name.
const SAME_NAME: f64 = 280.0;

/// The data that all panels share.
pub(super) struct PictureContext<'a> {
    pub program: &'a Program,
    pub world: &'a World,
    pub search: &'a Search<'a>,
    pub appearances: Appearances,
    pub goal: Goal,
    pub route: Route<'a>,
    /// The first player.
    pub hero: Option<SlotId>,
    /// Number of panels with visits, at least 1.
    pub visited: usize,
    /// Whether a panel shows the bounds of its space.
    pub bounded: bool,
}

/// Draws a space.
pub(super) fn draw(out: &mut String, context: &PictureContext<'_>, id: SpaceId, frame: &Frame, visits: &Visits) {
    let space = &context.world.spaces[id];
    let middle = context.route.middle;
    let (width, height) = (frame.width(), frame.height());
    put!(out, "<rect class=\"air\" width=\"{}\" height=\"{}\"/>\n", Number(width), Number(height));
    let goals = goals(context, id, frame, visits);
    for (form, rect) in &goals {
        region(out, "goal", frame, *form, *rect);
    }
    let drawn =
        |at: [f32; 2]| route::drawn(context.world, id, [f64::from(at[0]) + middle[0], f64::from(at[1]) + middle[1]]);
    let nodes = context.search.nodes;
    let visited = nodes.iter().filter(|node| node.space == id).map(|node| drawn(node.at));
    if visits.count > 0 {
        let tile = space.map.as_ref().map_or(f64::MAX, |map| map.tile.0.min(map.tile.1));
        let cell = (tile / CELLS).min(CELL / frame.scale);
        heat::draw(out, frame, visited, cell, MAX_HEAT / context.visited);
    }
    if let Some(map) = &space.map {
        tiles::draw(out, frame, map, &context.appearances);
    }
    for solid in &space.solids {
        let appearance =
            context.appearances.of(solid.tags).and_then(|appearance| context.appearances.list.get(appearance));
        if let (Some(rect), Some(appearance)) = (frame.cut(solid.bounds), appearance) {
            rectangle(out, &format!("tile {}", appearance.class), rect, &appearance.name);
        }
    }
    if visits.count > 0 {
        let lines = nodes.iter().filter(|node| node.space == id).filter_map(|node| {
            let parent = nodes.get(node.parent as usize).filter(|parent| parent.space == id)?;
            let ends = [drawn(parent.at), drawn(node.at)];
            let goes = !jumps(context.world, id, ends[0], ends[1]) && !crosses(context.world, id, ends[0], ends[1]);
            goes.then_some(ends)
        });
        tree::draw(out, frame, lines, MAX_LINES / context.visited);
    }
    let lines = context.route.lines(frame, id);
    let mut labels = Labels::new((width, height), lines.iter().flatten().copied().collect());
    if let Some(rect) = space.bounds.filter(|bounds| *bounds != frame.view).and_then(|bounds| frame.cut(bounds)) {
        rectangle(out, "bounds", rect, "bounds");
    }
    seams(out, frame, space.periods);
    for (form, rect) in &goals {
        region(out, "rim", frame, *form, *rect);
    }
    let mut names = links(out, context, id, frame);
    things(out, context, id, frame, &mut names);
    context.route.draw(out, frame, id, &lines, &mut labels);
    for (_, rect) in goals {
        // The name of a wide region is inside, below its upper edge.
        let beside = if rect.height > height / 2.0 { Rect { height: 0.0, ..rect } } else { rect };
        labels.write("name green", context.search.goal, beside);
    }
    for (class, name, rect) in names {
        labels.write(class, &name, rect);
    }
    out.push_str(&labels.finish());
    put!(out, "<rect class=\"frame\" width=\"{}\" height=\"{}\"/>\n", Number(width), Number(height));
}

/// Draws the borders that are one place.
fn seams(out: &mut String, frame: &Frame, periods: [Option<Period>; 2]) {
    let Bounds { left, right, bottom, top } = frame.view;
    let mut data = String::new();
    for (axis, period) in periods.into_iter().enumerate() {
        for at in period.into_iter().flat_map(|period| [period.low, period.high]) {
            let ends = if axis == 0 { [[at, bottom], [at, top]] } else { [[left, at], [right, at]] };
            if ends.iter().all(|end| frame.holds(*end)) {
                line_data(&mut data, &ends.map(|end| frame.point(end)));
            }
        }
    }
    if !data.is_empty() {
        put!(out, "<path class=\"bounds\" stroke-width=\"3\" d=\"{data}\"><title>seam</title></path>\n");
    }
}

/// A name to write: class, text, subject.
type Name = (&'static str, String, Rect);

/// The visible parts of the goal's region, with their extent in the picture.
fn goals(context: &PictureContext<'_>, id: SpaceId, frame: &Frame, visits: &Visits) -> Vec<(Form, Rect)> {
    let starts_here = context.hero.is_some_and(|hero| context.world.slots[hero].space == id);
    let may_be_here = starts_here || visits.count > 0 || visits.path.is_some();
    let areas = context.goal.areas.iter().filter(|area| area.space.map_or(may_be_here, |space| space == id));
    let extent = |form: Form| match form {
        Form::Box(bounds) => bounds,
        Form::Circle([x, y], radius) => Bounds::new([x - radius, y - radius, 2.0 * radius, 2.0 * radius]),
    };
    areas.filter_map(|area| Some((area.form, frame.cut(extent(area.form))?))).collect()
}

fn region(out: &mut String, class: &str, frame: &Frame, form: Form, rect: Rect) {
    match form {
        Form::Box(_) => rectangle(out, class, rect, ""),
        Form::Circle(center, radius) => circle(out, class, frame.point(center), radius * frame.scale, ""),
    }
}

fn links(out: &mut String, context: &PictureContext<'_>, id: SpaceId, frame: &Frame) -> Vec<Name> {
    let mut names = Vec::new();
    for link in &context.world.spaces[id].links {
        let Some(rect) = frame.cut(link.from) else { continue };
        let to = format!("→ {}", context.world.spaces[link.space].name);
        rectangle(out, "link", rect, &to);
        names.push(("name violet", to, rect));
    }
    names
}

/// All instances at their initial positions.
fn things(out: &mut String, context: &PictureContext<'_>, id: SpaceId, frame: &Frame, names: &mut Vec<Name>) {
    let slots = context.world.slots.pairs();
    let here = slots.filter(|(_, slot)| slot.space == id && slot.origin != Origin::Free);
    let mut unnamed: Vec<Name> = Vec::new();
    for (of, slot) in here {
        let body = Body::new(context.program, context.world, of);
        let is_hero = context.hero == Some(of);
        let is_requested =
            context.goal.slots.contains(&of) || body.parts.iter().any(|p| p.tags.meets(context.goal.tags));
        let mut around: Option<Rect> = None;
        for part in &body.parts {
            let bounds = placed(part, slot);
            let Some(rect) = frame.cut(bounds) else { continue };
            let class = match role(context.program, context.world, context.hero, part.tags) {
                _ if is_hero => "hero",
                _ if is_requested => "asked",
                Role::Solid | Role::OneWay => "block",
                _ => "thing",
            };
            if part.round {
                let center = [(bounds.left + bounds.right) / 2.0, (bounds.bottom + bounds.top) / 2.0];
                let radius = (bounds.right - bounds.left) / 2.0 * frame.scale;
                circle(out, class, frame.point(center), radius, &slot.name);
            } else {
                rectangle(out, class, rect, &slot.name);
            }
            around = Some(around.map_or(rect, |other| union(other, rect)));
        }
        if around.is_none() && frame.holds(position(slot)) {
            // Of unknown size: a diamond.
            let [x, y] = frame.point(position(slot)).map(Number);
            let class = if is_hero { "hero" } else { "thing" };
            put!(
                out,
                "<path class=\"{class}\" d=\"M{x} {y}m0-5l5 5l-5 5l-5-5z\"><title>{}</title></path>\n",
                escaped(&slot.name)
            );
            around = Some(Rect::around([x.0, y.0], 5.0));
        }
        let Some(around) = around else { continue };
        let class = if is_hero { "name strong" } else { "name" };
        match slot.origin {
            Origin::Named => names.push((class, slot.name.clone(), around)),
            _ => {
                let name = context.program.entities[slot.entity].name.to_string();
                let near = |(_, other, rect): &Name| *other == name && (rect.x - around.x).abs() < SAME_NAME;
                if !unnamed.iter().any(near) {
                    unnamed.push((class, name, around));
                }
            }
        }
    }
    // The first name gets the best place.
    let hero = names.iter().position(|(class, ..)| *class == "name strong");
    if let Some(hero) = hero {
        names[..=hero].rotate_right(1);
    }
    names.extend(unnamed);
}

fn union(a: Rect, b: Rect) -> Rect {
    let (x, y) = (a.x.min(b.x), a.y.min(b.y));
    let (right, bottom) = ((a.x + a.width).max(b.x + b.width), (a.y + a.height).max(b.y + b.height));
    Rect { x, y, width: right - x, height: bottom - y }
}

fn rectangle(out: &mut String, class: &str, r: Rect, title: &str) {
    let (x, y, width, height) = (Number(r.x), Number(r.y), Number(r.width), Number(r.height));
    put!(out, "<rect class=\"{class}\" x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"");
    close(out, "rect", title);
}

fn circle(out: &mut String, class: &str, [x, y]: [f64; 2], radius: f64, title: &str) {
    put!(out, "<circle class=\"{class}\" cx=\"{}\" cy=\"{}\" r=\"{}\"", Number(x), Number(y), Number(radius));
    close(out, "circle", title);
}

/// Ends an element; the title is a tooltip.
fn close(out: &mut String, element: &str, title: &str) {
    if title.is_empty() {
        out.push_str("/>\n");
    } else {
        put!(out, "><title>{}</title></{element}>\n", escaped(title));
    }
}
