//! The whole picture: a title with figures, a panel for each space or part of a long level, the legend.

use crate::ir::{Bounds, Extremes, GoalId, PlayerId, Program, SlotId, SpaceId, TagSet, World, WorldId};

use super::appearance::Appearances;
use super::body::Body;
use super::extent::{Visits, extent};
use super::frame::Frame;
use super::goal::Goal;
use super::grid::{Fold, Grid, HEAD, MARGIN, folded};
use super::legend;
use super::look::Images;
use super::moment;
use super::panel::{self, PictureContext};
use super::route::{Route, segments};
use super::style::STYLE;
use super::svg::{BOLD, Number, escaped, put, shortened, text_width, wrapped};
use super::track::{Run, Track};
use super::trail::is_way;
use super::trap;

/// The drawn data of a node of a search tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// The index of its parent; its own for a root.
    pub parent: u32,
    /// The space that the first player is in.
    pub space: SpaceId,
    /// The first player's position, px.
    pub at: [f32; 2],
}

/// Where players with some skill were, and nobody with less.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureLayer {
    /// Who they are, for the legend.
    pub name: String,
    /// The positions: a space, and the position of a player, px.
    pub places: Vec<(SpaceId, [f32; 2])>,
}

/// What a picture shows.
#[derive(Debug, Clone, Copy)]
pub struct Picture<'a> {
    /// The title, after the name of the world.
    pub title: &'a str,
    /// The result, in a word or two: `reached`, `not found`, `377 steps`.
    pub result: &'a str,
    /// Whether it is a good one.
    pub is_good: bool,
    /// The goals whose regions are drawn.
    pub goals: &'a [GoalId],
    /// The nodes of all trees of a search.
    pub nodes: &'a [Node],
    /// Where players are stuck.
    pub traps: &'a [Node],
    /// Who was where, in place of nodes: from the least skill to the most.
    pub layers: &'a [PictureLayer],
    /// The run: the path that a search has found, or what was simulated. Without tracks there is none.
    pub run: &'a Run,
    /// Lines under the title.
    pub notes: &'a [String],
    /// The pictures that looks name.
    pub images: &'a Images,
}

/// Minimum width of the picture without its margins.
const MIN_WIDTH: f64 = 620.0;
/// Height of a line of the notes.
const LINE: f64 = 18.0;
/// Maximum number of lines of a note.
const NOTE_LINES: usize = 3;
/// The classes of the colours of the second player and the next ones.
const COLORS: [&str; 4] = ["", " p2", " p3", " p4"];

/// A panel: a space, or a part of it.
struct Panel {
    space: SpaceId,
    view: Bounds,
    visits: Visits,
}

/// Draws the spaces of a world with a run, and with the visits and the tree of a search, as self-contained SVG.
pub fn picture_svg(program: &Program, id: WorldId, picture: &Picture<'_>) -> String {
    let world = &program.worlds[id];
    let hero = world.players.get(PlayerId(0)).map(|player| player.slot);
    let body = hero.map(|hero| Body::new(program, world, hero)).unwrap_or_default();
    let middle = body.middle();
    let goals: Vec<Goal> =
        picture.goals.iter().map(|id| Goal::new(program, world, &world.goals[*id], middle)).collect();
    let wanted = goals.iter().map(|goal| goal.tags).fold(TagSet::default(), TagSet::with);
    let routes = routes(program, world, picture.run);
    let size = body.bounds().map_or(0.0, |b| (b.right - b.left).greatest(b.top - b.bottom));
    let (panels, fold) = panels(program, world, picture, (hero, middle, size), &routes);
    let views: Vec<Bounds> = panels.iter().map(|panel| panel.view).collect();
    let grid = match fold {
        Some(fold) => Grid::of_parts(fold, &views),
        None => Grid::of_spaces(&views),
    };
    let is_player = |track: &Track| world.slots[track.slot].player.is_some();
    let context = PictureContext {
        program,
        id,
        world,
        picture,
        appearances: Appearances::new(program, id, wanted),
        goals,
        routes,
        ways: picture.run.tracks.iter().filter(|track| !is_player(track) && is_way(track)).collect(),
        hero,
        middle,
        visited: panels.iter().filter(|panel| panel.visits.count > 0).count().max(1),
        bounded: panels.iter().any(|panel| world.spaces[panel.space].bounds.is_some_and(|b| b != panel.view)),
    };
    let width = grid.width().greatest(MIN_WIDTH);

    let mut out = String::new();
    picture.images.define(&mut out);
    let mut y = title(&mut out, &world.name, picture, width);
    for (index, panel) in panels.iter().enumerate() {
        let (x, top) = grid.place(index);
        let frame = Frame { view: panel.view, scale: grid.scale };
        let (x, mut top) = (MARGIN + x, y + top);
        match fold {
            Some(Fold::Columns) => top += HEAD,
            None if panels.len() > 1 => {
                head(&mut out, &context, panel, (x, top), frame.width());
                top += HEAD;
            }
            Some(Fold::Rows) | None => {}
        }
        // Columns of different height stand on one line.
        if fold == Some(Fold::Columns) {
            top += grid.height() - HEAD - frame.height();
        }
        // A nested `svg` element clips, without the need for a named clip path.
        let (width, height) = (Number(frame.width()), Number(frame.height()));
        put!(out, "<svg x=\"{}\" y=\"{}\" width=\"{width}\" height=\"{height}\">\n", Number(x), Number(top));
        panel::draw(&mut out, &context, panel.space, &frame, &panel.visits);
        out.push_str("</svg>\n");
        if let Some(fold) = fold {
            continuations(&mut out, fold, (index, panels.len()), (x, top), &frame);
        }
    }
    y += grid.height() + MARGIN * 0.6;
    if fold == Some(Fold::Columns) {
        y += HEAD;
    }
    put!(out, "<g transform=\"translate({MARGIN} {})\">\n", Number(y));
    y += legend::draw(&mut out, &context, width) + MARGIN * 0.6;
    out.push_str("</g>\n");

    let traps = if picture.traps.is_empty() { "" } else { trap::STYLE };
    let moments = if picture.run.moments.is_empty() { "" } else { moment::STYLE };
    let (width, height) = (Number((width + 2.0 * MARGIN).ceil()), Number(y.ceil()));
    let name = format!("{}, {}: {}", world.name, picture.title, picture.result);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" role=\"img\">\n<title>{}</title>\n<style>{STYLE}{traps}{moments}</style>\n\
         <rect class=\"paper\" width=\"{width}\" height=\"{height}\"/>\n{out}</svg>\n",
        escaped(&name)
    )
}

/// The ways of all players.
fn routes<'a>(program: &Program, world: &'a World, run: &'a Run) -> Vec<Route<'a>> {
    let mut routes: Vec<Route<'a>> = Vec::new();
    for (player, color) in world.players.iter().zip(COLORS.iter().cycle()) {
        let middle = Body::new(program, world, player.slot).middle();
        for track in run.of(player.slot) {
            let doors = routes.iter().map(|route| route.segments.len().saturating_sub(1)).sum::<usize>();
            routes.push(Route { world, track, segments: segments(&track.stops, doors + 1), middle, color });
        }
    }
    routes
}

/// The spaces that are drawn, or the parts of the only one.
fn panels(
    program: &Program,
    world: &World,
    picture: &Picture<'_>,
    (hero, middle, size): (Option<SlotId>, [f64; 2], f64),
    routes: &[Route<'_>],
) -> (Vec<Panel>, Option<Fold>) {
    let visits = |id: SpaceId, view: Option<Bounds>| {
        let is_in = move |at: &[f64; 2]| view.is_none_or(|view| Frame { view, scale: 1.0 }.holds(*at));
        let places = picture.layers.iter().flat_map(|layer| layer.places.iter().copied());
        let nodes = picture.nodes.iter().map(|node| (node.space, node.at)).chain(places);
        let nodes = nodes.filter(move |(space, _)| *space == id);
        let nodes = nodes.map(move |(_, at)| [f64::from(at[0]) + middle[0], f64::from(at[1]) + middle[1]]);
        let stops = routes.iter().flat_map(|route| {
            let stops = route.track.stops.iter().filter(|stop| stop.space == id);
            stops.map(|stop| [stop.at[0] + route.middle[0], stop.at[1] + route.middle[1]])
        });
        Visits::new(nodes.filter(is_in), stops.filter(is_in))
    };
    let mut panels = Vec::new();
    for (id, space) in world.spaces.pairs() {
        let visits = visits(id, None);
        let empty = space.map.is_none() && space.solids.is_empty() && space.bounds.is_none();
        let starts_here = hero.is_some_and(|hero| world.slots[hero].space == id);
        if !empty || visits.count > 0 || visits.path.is_some() || starts_here {
            let view = extent(program, world, id, &visits, size);
            panels.push(Panel { space: id, view, visits });
        }
    }
    if let [only] = panels.as_slice()
        && let Some((fold, views)) = folded(only.view, world.spaces[only.space].map.as_ref())
    {
        let space = only.space;
        let panel = |view| Panel { space, view, visits: visits(space, Some(view)) };
        return (views.into_iter().map(panel).collect(), Some(fold));
    }
    (panels, None)
}

/// Draws world, title, result and notes; returns the top of the panels.
fn title(out: &mut String, world: &str, picture: &Picture<'_>, width: f64) -> f64 {
    let result = shortened(picture.result, 12.0, width / 3.0);
    let pill = text_width(&result, 12.0 * BOLD) + 20.0;
    let text = shortened(&format!("{world}: {}", picture.title), 20.0 * BOLD, width - pill - 14.0);
    put!(out, "<text class=\"title\" x=\"{MARGIN}\" y=\"38\">{}</text>\n", escaped(&text));
    let x = MARGIN + text_width(&text, 20.0 * BOLD) + 14.0;
    let class = if picture.is_good { "yes" } else { "no" };
    let (left, middle, wide) = (Number(x), Number(x + pill / 2.0), Number(pill));
    put!(out, "<rect class=\"{class}\" x=\"{left}\" y=\"20\" width=\"{wide}\" height=\"22\" rx=\"11\"/>\n");
    put!(out, "<text class=\"verdict\" x=\"{middle}\" y=\"35.2\">{}</text>\n", escaped(&result));
    let mut y = 44.0;
    for line in picture.notes.iter().flat_map(|note| wrapped(note, 12.0, width, NOTE_LINES)) {
        y += LINE;
        put!(out, "<text class=\"quiet\" x=\"{MARGIN}\" y=\"{}\">{}</text>\n", Number(y), escaped(&line));
    }
    y + 14.0
}

/// The title of a panel, with its share of the search.
fn head(out: &mut String, context: &PictureContext<'_>, panel: &Panel, (x, y): (f64, f64), width: f64) {
    let all = context.picture.nodes.len();
    let share = match panel.visits.count {
        0 if all > 0 || !context.picture.layers.is_empty() => "never entered".into(),
        _ if all == 0 => String::new(),
        visits => format!("{} % of the states found", Number((1000.0 * visits as f64 / all as f64).round() / 10.0)),
    };
    let line = Number(y + 16.0);
    let name = shortened(&context.world.spaces[panel.space].name, 13.0 * BOLD, width);
    put!(out, "<text class=\"head\" x=\"{}\" y=\"{line}\">{}</text>\n", Number(x), escaped(&name));
    let after = text_width(&name, 13.0 * BOLD) + 12.0;
    if !share.is_empty() && after + text_width(&share, 12.0) <= width {
        put!(out, "<text class=\"quiet\" x=\"{}\" y=\"{line}\">{share}</text>\n", Number(x + after));
    }
}

/// Marks where a part of a level continues: an arrow with the letter of the cut on both sides of it.
fn continuations(out: &mut String, fold: Fold, (index, count): (usize, usize), (x, y): (f64, f64), frame: &Frame) {
    let letter = |cut: usize| char::from(b'a' + (cut % 26) as u8);
    let (width, height) = (frame.width(), frame.height());
    let mut mark = |cut: usize, at: [f64; 2], text: [f64; 2], arrow: &str| {
        let [x, y] = at.map(Number);
        put!(out, "<path class=\"fold\" d=\"M{x} {y}{arrow}\"/>\n");
        put!(out, "<text class=\"cut\" x=\"{}\" y=\"{}\">{}</text>\n", Number(text[0]), Number(text[1]), letter(cut));
    };
    let (middle, center) = (x + width / 2.0, y + height / 2.0);
    match fold {
        Fold::Rows => {
            if index > 0 {
                mark(index - 1, [x - 10.0, center - 5.0], [x - 8.0, center + 18.0], "l5 5l-5 5");
            }
            if index + 1 < count {
                let right = x + width;
                mark(index, [right + 5.0, center - 5.0], [right + 8.0, center + 18.0], "l5 5l-5 5");
            }
        }
        Fold::Columns => {
            if index > 0 {
                mark(index - 1, [middle - 5.0, y + height + 12.0], [middle + 14.0, y + height + 15.0], "l5 -5l5 5");
            }
            if index + 1 < count {
                mark(index, [middle - 5.0, y - 6.0], [middle + 14.0, y - 4.0], "l5 -5l5 5");
            }
        }
    }
}
