//! The panel of a space, layer by layer: the level, the visits, the tree, the instances, the goal, the path, names.

use crate::ir::{Bounds, Extremes, Origin, Period, Program, SlotId, SpaceId, World, WorldId};
use crate::ordered::Ordered;

use super::appearance::{Appearances, Role, for_players};
use super::body::{Body, outline, placed, position, pushes};
use super::extent::Visits;
use super::frame::{Frame, Rect};
use super::goal::{Form, Goal};
use super::heat;
use super::label::Labels;
use super::picture::{Node, Picture};
use super::route::{self, Route, crosses, jumps};
use super::svg::{Number, escaped, line_data, put};
use super::track::Track;
use super::{look, moment, tiles, trail, trap, tree};

/// Maximum number of lines of the tree and of rectangles of the heat map in the whole picture.
const MAX_LINES: usize = 16_000;
const MAX_HEAT: usize = 6_000;
/// Cells of the heat map per side of a tile.
const CELLS: f64 = 4.0;
/// Maximum side of such a cell in the picture; its side if there are no tiles.
const CELL: f64 = 10.0;

/// Minimum side of the cells of layers, px of the game: their places are known to half of it.
const LAYER_CELL: f64 = 8.0;
/// Side of the cells of stuck places in a space without tiles, px of the game.
const TRAP: f64 = 16.0;

/// The classes of the players.
pub(super) const HEROES: [&str; 4] = ["hero", "hero p2", "hero p3", "hero p4"];
/// A move of the tree that is so many times as long as most is a jump.
const JUMP: f64 = 4.0;
/// Minimum distance of two named instances with the same name.
const SAME_NAME: f64 = 280.0;

/// The data that all panels share.
pub(super) struct PictureContext<'a> {
    pub program: &'a Program,
    pub id: WorldId,
    pub world: &'a World,
    pub picture: &'a Picture<'a>,
    pub appearances: Appearances,
    pub goals: Vec<Goal>,
    /// The ways of players.
    pub routes: Vec<Route<'a>>,
    /// The ways of everything else that moves.
    pub ways: Vec<&'a Track>,
    /// The first player.
    pub hero: Option<SlotId>,
    /// The offset from its position to the drawn point.
    pub middle: [f64; 2],
    /// Number of panels with visits, at least 1.
    pub visited: usize,
    /// Whether a panel shows the bounds of its space.
    pub bounded: bool,
}

/// Draws a space, or a part of it.
pub(super) fn draw(out: &mut String, context: &PictureContext<'_>, id: SpaceId, frame: &Frame, visits: &Visits) {
    let space = &context.world.spaces[id];
    let (width, height) = (frame.width(), frame.height());
    put!(out, "<rect class=\"air\" width=\"{}\" height=\"{}\"/>\n", Number(width), Number(height));
    let goals = goals(context, id, frame, visits);
    for (_, form, rect) in &goals {
        region(out, "goal", frame, *form, *rect);
    }
    if visits.count > 0 {
        let tile = space.map.as_ref().map_or(f64::MAX, |map| map.tile.0.least(map.tile.1));
        let cell = (tile / CELLS).least(CELL / frame.scale);
        let (layers, limit) = (context.picture.layers, MAX_HEAT / context.visited);
        if layers.is_empty() {
            let nodes = context.picture.nodes.iter().filter(|node| node.space == id);
            heat::draw(out, frame, nodes.map(|node| place(context, node)), cell, limit);
        } else {
            let places = layers.iter().enumerate().flat_map(|(layer, of)| {
                let here = of.places.iter().filter(|(space, _)| *space == id);
                here.map(move |(space, at)| (layer, placed_at(context, *space, *at)))
            });
            heat::draw_layers(out, frame, (places, layers.len()), cell.greatest(LAYER_CELL), limit);
        }
    }
    if let Some(map) = &space.map {
        tiles::draw(out, frame, map, &context.appearances, (context.picture.images, id));
    }
    for solid in &space.solids {
        let appearance =
            context.appearances.of(solid.tags).and_then(|appearance| context.appearances.list.get(appearance));
        if let (Some(rect), Some(appearance)) = (frame.cut(solid.bounds), appearance) {
            let symbol = appearance.look.as_ref().and_then(|look| context.picture.images.symbol(look));
            let style = look::fill(appearance.look.as_ref());
            styled_rectangle(out, &format!("tile {}", appearance.class), &style, rect, &appearance.name);
            if let Some(symbol) = symbol {
                look::draw(out, &symbol, rect);
            }
        }
    }
    let traps = context.picture.traps.iter().filter(|node| node.space == id);
    let cell = space.map.as_ref().map_or((TRAP, TRAP), |map| map.tile);
    trap::draw(out, frame, traps.map(|node| place(context, node)), cell);
    if !context.picture.nodes.is_empty() && visits.count > 0 {
        tree::draw(out, frame, moves(context, id), MAX_LINES / context.visited);
    }
    let lines: Vec<_> = context.routes.iter().map(|route| route.lines(frame, id)).collect();
    let mut labels = Labels::new((width, height), lines.iter().flatten().flatten().copied().collect());
    if let Some(bounds) = space.bounds.filter(|bounds| *bounds != frame.view) {
        borders(out, frame, bounds);
    }
    seams(out, frame, space.periods);
    for (_, form, rect) in &goals {
        region(out, "rim", frame, *form, *rect);
    }
    let mut names = links(out, context, id, frame);
    things(out, context, id, frame, &mut names);
    trail::draw(out, (context.program, context.world), frame, id, &context.ways);
    // The first player is on top.
    for (route, lines) in context.routes.iter().zip(&lines).rev() {
        route.draw(out, frame, id, lines, &mut labels);
    }
    marks(out, context, id, frame, &mut labels);
    if let Some(route) = context.routes.first() {
        moment::draw(out, &context.picture.run.moments, route, (frame, id), &mut labels);
    }
    for (goal, _, rect) in goals {
        // The name of a wide region is inside, below its upper edge.
        let beside = if rect.height > height / 2.0 { Rect { height: 0.0, ..rect } } else { rect };
        labels.write("name green", &goal.name, beside);
    }
    for (class, name, rect) in names {
        labels.write(class, &name, rect);
    }
    out.push_str(&labels.finish());
    put!(out, "<rect class=\"frame\" width=\"{}\" height=\"{}\"/>\n", Number(width), Number(height));
}

/// Where a node is drawn.
fn place(context: &PictureContext<'_>, node: &Node) -> [f64; 2] {
    placed_at(context, node.space, node.at)
}

/// Where a player at a position is drawn.
fn placed_at(context: &PictureContext<'_>, space: SpaceId, at: [f32; 2]) -> [f64; 2] {
    let at = [0, 1].map(|axis| f64::from(at[axis]) + context.middle[axis]);
    route::drawn(context.world, space, at)
}

/// The moves of the tree in a space, without jumps: moves across a seam, and moves much longer than most.
fn moves(context: &PictureContext<'_>, id: SpaceId) -> impl Iterator<Item = [[f64; 2]; 2]> {
    let nodes = context.picture.nodes;
    let here = nodes.iter().filter(move |node| node.space == id);
    let ends = here.filter_map(|node| {
        let parent = nodes.get(node.parent as usize).filter(|parent| parent.space == id)?;
        Some([place(context, parent), place(context, node)])
    });
    let ends: Vec<[[f64; 2]; 2]> =
        ends.filter(|[a, b]| !jumps(context.world, id, *a, *b) && !crosses(context.world, id, *a, *b)).collect();
    let length = |[a, b]: &[[f64; 2]; 2]| libm::hypot(b[0] - a[0], b[1] - a[1]);
    let mut lengths: Vec<f64> = ends.iter().map(length).filter(|length| *length > 0.0).collect();
    lengths.sort_unstable_by(f64::total_cmp);
    let usual = lengths.get(lengths.len() * 9 / 10).copied().unwrap_or(f64::MAX);
    ends.into_iter().filter(move |line| length(line) <= JUMP * usual)
}

/// Draws the borders of a space where they are in the picture.
fn borders(out: &mut String, frame: &Frame, Bounds { left, right, bottom, top }: Bounds) {
    let corners = [[left, bottom], [right, bottom], [right, top], [left, top], [left, bottom]];
    let mut data = String::new();
    for side in corners.windows(2) {
        if let Some(line) = frame.clip([side[0], side[1]]) {
            line_data(&mut data, &line.map(|end| frame.point(end)));
        }
    }
    if !data.is_empty() {
        put!(out, "<path class=\"bounds\" d=\"{data}\"><title>bounds</title></path>\n");
    }
}

/// The places of the first player where goals and `never`s became true.
fn marks(out: &mut String, context: &PictureContext<'_>, id: SpaceId, frame: &Frame, labels: &mut Labels) {
    let Some(route) = context.routes.first() else { return };
    for mark in &context.picture.run.marks {
        let Some([x, y]) = route.place(frame, id, mark.step) else { continue };
        let class = if mark.is_never { "broken" } else { "reached" };
        let sign = if mark.is_never { "m-3.5 -3.5l7 7m0 -7l-7 7" } else { "m-4 0l3 3.5l5 -6.5" };
        put!(out, "<circle class=\"{class}\" cx=\"{}\" cy=\"{}\" r=\"9\"/>\n", Number(x), Number(y));
        put!(out, "<path class=\"sign\" d=\"M{} {}{sign}\"/>\n", Number(x), Number(y));
        let place = Rect::around([x, y], 9.0);
        labels.keep_free(place);
        let words = format!("{}: step {}, {} s", mark.name, mark.step, Number(mark.seconds));
        labels.write(if mark.is_never { "name red" } else { "name green" }, &words, place);
    }
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

/// The visible parts of the goals' regions, with their extent in the picture.
fn goals<'c>(
    context: &'c PictureContext<'_>,
    id: SpaceId,
    frame: &Frame,
    visits: &Visits,
) -> Vec<(&'c Goal, Form, Rect)> {
    let starts_here = context.hero.is_some_and(|hero| context.world.slots[hero].space == id);
    let may_be_here = starts_here || visits.count > 0 || visits.path.is_some();
    let areas = context.goals.iter().flat_map(|goal| goal.areas.iter().map(move |area| (goal, area)));
    let areas = areas.filter(|(_, area)| area.space.map_or(may_be_here, |space| space == id));
    let extent = |form: Form| match form {
        Form::Box(bounds) => bounds,
        Form::Circle([x, y], radius) => Bounds::new([x - radius, y - radius, 2.0 * radius, 2.0 * radius]),
    };
    areas.filter_map(|(goal, area)| Some((goal, area.form, frame.cut(extent(area.form))?))).collect()
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
        let own_look = context.program.look_of(context.id, of);
        let symbol = own_look.and_then(|look| context.picture.images.symbol(look));
        let player = context.world.players.iter().position(|player| player.slot == of);
        let is_requested = context
            .goals
            .iter()
            .any(|goal| goal.slots.contains(&of) || body.parts.iter().any(|part| part.tags.meets(goal.tags)));
        let mut around: Option<Rect> = None;
        let has_body = body.parts.iter().any(|part| pushes(context.world, part.tags));
        for part in &body.parts {
            let bounds = placed(part, slot);
            let Some(rect) = frame.cut(bounds) else { continue };
            let is_sensor = !pushes(context.world, part.tags);
            let class = match (player, for_players(context.program, context.world, part.tags)) {
                (Some(player), _) => HEROES[player % HEROES.len()],
                (None, _) if is_requested => "asked",
                (None, Some(Role::Solid | Role::OneWay)) => "block",
                (None, _) => "thing",
            };
            let class = match (is_sensor, has_body) {
                (false, _) => class.to_string(),
                (true, true) => format!("{class} sensor"),
                // What has only sensors is seen by them.
                (true, false) => format!("{class} ghostly"),
            };
            let class = class.as_str();
            around = Some(around.map_or(rect, |other| union(other, rect)));
            // The picture stands for the body.
            if symbol.is_some() && !is_sensor {
                continue;
            }
            let style = look::body(own_look, is_sensor, has_body);
            if part.round {
                let center = [(bounds.left + bounds.right) / 2.0, (bounds.bottom + bounds.top) / 2.0];
                let radius = (bounds.right - bounds.left) / 2.0 * frame.scale;
                styled_circle(out, class, &style, frame.point(center), radius, &slot.name);
            } else {
                styled_rectangle(out, class, &style, rect, &slot.name);
            }
        }
        if let Some(symbol) = &symbol {
            let shown = outline(context.world, &body.parts);
            let whole = shown.iter().map(|part| placed(part, slot)).reduce(Bounds::join);
            let whole = whole.filter(|bounds| frame.cut(*bounds).is_some());
            if let Some(bounds) = whole {
                look::draw(out, symbol, frame.place(bounds));
            }
        }
        if around.is_none() && frame.holds(position(slot)) {
            // Of unknown size: a diamond.
            let [x, y] = frame.point(position(slot)).map(Number);
            let class = player.map_or("thing", |player| HEROES[player % HEROES.len()]);
            put!(
                out,
                "<path class=\"{class}\" d=\"M{x} {y}m0-5l5 5l-5 5l-5-5z\"><title>{}</title></path>\n",
                escaped(&slot.name)
            );
            around = Some(Rect::around([x.0, y.0], 5.0));
        }
        let Some(around) = around else { continue };
        let class = if player.is_some() { "name strong" } else { "name" };
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
    // The names of players get the best places.
    names.order_by_key(|(class, ..)| *class != "name strong");
    names.extend(unnamed);
}

fn union(a: Rect, b: Rect) -> Rect {
    let (x, y) = (a.x.least(b.x), a.y.least(b.y));
    let (right, bottom) = ((a.x + a.width).greatest(b.x + b.width), (a.y + a.height).greatest(b.y + b.height));
    Rect { x, y, width: right - x, height: bottom - y }
}

fn rectangle(out: &mut String, class: &str, r: Rect, title: &str) {
    styled_rectangle(out, class, "", r, title);
}

fn styled_rectangle(out: &mut String, class: &str, style: &str, r: Rect, title: &str) {
    let (x, y, width, height) = (Number(r.x), Number(r.y), Number(r.width), Number(r.height));
    put!(out, "<rect class=\"{class}\"{style} x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"");
    close(out, "rect", title);
}

fn circle(out: &mut String, class: &str, at: [f64; 2], radius: f64, title: &str) {
    styled_circle(out, class, "", at, radius, title);
}

fn styled_circle(out: &mut String, class: &str, style: &str, [x, y]: [f64; 2], radius: f64, title: &str) {
    put!(out, "<circle class=\"{class}\"{style} cx=\"{}\" cy=\"{}\" r=\"{}\"", Number(x), Number(y), Number(radius));
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
