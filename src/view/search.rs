//! The whole picture: a title with figures, a panel for each space, the key.

use crate::ir::{Bounds, PlayerId, Program, SpaceId, WorldId};

use super::body::Body;
use super::extent::{Presence, extent};
use super::frame::Frame;
use super::goal::Goal;
use super::legend;
use super::look::Looks;
use super::panel::{self, Scene};
use super::route::{Route, strands};
use super::style::STYLE;
use super::svg::{BOLD, Number, escaped, put, shortened, text_width, wrapped};

/// A node of a search tree, as far as it is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// The index of its parent; its own for a root.
    pub parent: u32,
    /// The space that the first player is in.
    pub space: SpaceId,
    /// The first player's position, px.
    pub at: [f32; 2],
}

/// Where the first player was after a step of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// The space.
    pub space: SpaceId,
    /// The position, px.
    pub at: [f64; 2],
    /// Whether the inputs differ from those of the step before.
    pub changes: bool,
}

/// What is drawn of a search.
#[derive(Debug, Clone, Copy)]
pub struct Search<'a> {
    /// The name of the goal.
    pub goal: &'a str,
    /// How it ended: `reached`, `not found`.
    pub verdict: &'a str,
    /// The nodes of all trees.
    pub nodes: &'a [Node],
    /// The way to the goal, empty if there is none.
    pub path: &'a [Stop],
    /// Lines under the title.
    pub notes: &'a [String],
}

/// The margin of the picture, and between panels.
const MARGIN: f64 = 20.0;
/// The width and the height that the panels are to have together.
const TARGET: (f64, f64) = (1400.0, 860.0);
/// A long level is at least so high, while it is not longer than the second number.
const LONG: (f64, f64) = (230.0, 2800.0);
/// The longest of several panels is at least so long.
const SMALL: f64 = 260.0;
/// The greatest size of a px of the game.
const MAX_SCALE: f64 = 4.0;
/// The least width of the picture without its margins.
const MIN_WIDTH: f64 = 620.0;
/// The height of a line of the notes, and of the name over a panel.
const LINE: f64 = 18.0;
const HEAD: f64 = 24.0;
/// The most lines of one note.
const NOTE_LINES: usize = 3;

/// Draws the spaces of a world with what a search covered, its tree and its path, as SVG that needs nothing else.
pub fn search_svg(program: &Program, world: WorldId, search: &Search<'_>) -> String {
    let world = &program.worlds[world];
    let hero = world.players.get(PlayerId(0)).map(|player| player.slot);
    let body = hero.map(|hero| Body::new(program, world, hero)).unwrap_or_default();
    let middle = body.middle();
    let goal = Goal::new(program, world, search.goal, hero, middle);
    let strands = strands(world, search.path);
    let mut shown = Vec::new();
    for (id, space) in world.spaces.pairs() {
        let nodes = search.nodes.iter().filter(|node| node.space == id);
        let stops = search.path.iter().filter(|stop| stop.space == id);
        let presence = Presence::new(
            nodes.map(|node| [f64::from(node.at[0]) + middle[0], f64::from(node.at[1]) + middle[1]]),
            stops.map(|stop| [stop.at[0] + middle[0], stop.at[1] + middle[1]]),
        );
        let empty = space.map.is_none() && space.solids.is_empty() && space.bounds.is_none();
        let starts_here = hero.is_some_and(|hero| world.slots[hero].space == id);
        if !empty || presence.visits > 0 || presence.path.is_some() || starts_here {
            let size = body.bounds().map_or(0.0, |b| (b.right - b.left).max(b.top - b.bottom));
            shown.push((id, extent(program, world, id, &presence, size), presence));
        }
    }
    let looks = Looks::new(program, world, hero, goal.tags);
    let route = Route { path: search.path, strands: &strands, middle, body: body.bounds() };
    let visited = shown.iter().filter(|(.., presence)| presence.visits > 0).count().max(1);
    let bounded = shown.iter().any(|(id, view, _)| world.spaces[*id].bounds.is_some_and(|bounds| bounds != *view));
    let scene = Scene { program, world, search, looks, goal, route, hero, visited, bounded };
    let grid = Grid::new(&shown.iter().map(|(_, view, _)| *view).collect::<Vec<_>>());
    let width = grid.width().max(MIN_WIDTH);

    let mut out = String::new();
    let mut y = title(&mut out, &world.name, search, width);
    for (index, (id, view, presence)) in shown.iter().enumerate() {
        let (x, top) = grid.place(index);
        let frame = Frame { view: *view, scale: grid.scale };
        let mut top = y + top;
        if shown.len() > 1 {
            head(&mut out, &scene, *id, presence, (x, top), frame.width());
            top += HEAD;
        }
        // An inner picture cuts what stands out of it, and needs no name for that.
        let (x, top) = (Number(MARGIN + x), Number(top));
        let (width, height) = (Number(frame.width()), Number(frame.height()));
        put!(out, "<svg x=\"{x}\" y=\"{top}\" width=\"{width}\" height=\"{height}\">\n");
        panel::draw(&mut out, &scene, *id, &frame, presence);
        out.push_str("</svg>\n");
    }
    y += grid.height() + MARGIN * 0.6;
    put!(out, "<g transform=\"translate({MARGIN} {})\">\n", Number(y));
    y += legend::draw(&mut out, &scene, width) + MARGIN * 0.6;
    out.push_str("</g>\n");

    let (width, height) = (Number((width + 2.0 * MARGIN).ceil()), Number(y.ceil()));
    let name = format!("{}, goal {}: {}", world.name, search.goal, search.verdict);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" role=\"img\">\n<title>{}</title>\n<style>{STYLE}</style>\n\
         <rect class=\"paper\" width=\"{width}\" height=\"{height}\"/>\n{out}</svg>\n",
        escaped(&name)
    )
}

/// World, goal, verdict and notes; returns where the panels begin.
fn title(out: &mut String, world: &str, search: &Search<'_>, width: f64) -> f64 {
    let verdict = shortened(search.verdict, 12.0, width / 3.0);
    let pill = text_width(&verdict, 12.0 * BOLD) + 20.0;
    let text = shortened(&format!("{world}: {}", search.goal), 20.0 * BOLD, width - pill - 14.0);
    put!(out, "<text class=\"title\" x=\"{MARGIN}\" y=\"38\">{}</text>\n", escaped(&text));
    let x = MARGIN + text_width(&text, 20.0 * BOLD) + 14.0;
    let class = if search.path.is_empty() { "no" } else { "yes" };
    let (left, middle, wide) = (Number(x), Number(x + pill / 2.0), Number(pill));
    put!(out, "<rect class=\"{class}\" x=\"{left}\" y=\"20\" width=\"{wide}\" height=\"22\" rx=\"11\"/>\n");
    put!(out, "<text class=\"verdict\" x=\"{middle}\" y=\"35.2\">{}</text>\n", escaped(&verdict));
    let mut y = 44.0;
    for line in search.notes.iter().flat_map(|note| wrapped(note, 12.0, width, NOTE_LINES)) {
        y += LINE;
        put!(out, "<text class=\"quiet\" x=\"{MARGIN}\" y=\"{}\">{}</text>\n", Number(y), escaped(&line));
    }
    y + 14.0
}

/// The name over a panel, with how much of the search was there.
fn head(out: &mut String, scene: &Scene<'_>, id: SpaceId, presence: &Presence, (x, y): (f64, f64), width: f64) {
    let all = scene.search.nodes.len();
    let share = match presence.visits {
        _ if all == 0 => String::new(),
        0 => "never entered".into(),
        visits => format!("{} % of the states found", Number((1000.0 * visits as f64 / all as f64).round() / 10.0)),
    };
    let (x, line) = (MARGIN + x, Number(y + 16.0));
    let name = shortened(&scene.world.spaces[id].name, 13.0 * BOLD, width);
    put!(out, "<text class=\"head\" x=\"{}\" y=\"{line}\">{}</text>\n", Number(x), escaped(&name));
    let after = text_width(&name, 13.0 * BOLD) + 12.0;
    if !share.is_empty() && after + text_width(&share, 12.0) <= width {
        put!(out, "<text class=\"quiet\" x=\"{}\" y=\"{line}\">{share}</text>\n", Number(x + after));
    }
}

/// Where the panels are: in rows of equal length, all to the same scale.
struct Grid {
    columns: Vec<f64>,
    rows: Vec<f64>,
    scale: f64,
    heads: f64,
}

impl Grid {
    fn new(views: &[Bounds]) -> Grid {
        let sizes: Vec<(f64, f64)> = views.iter().map(|b| (b.right - b.left, b.top - b.bottom)).collect();
        let arranged = |count: usize| {
            let mut columns = vec![0.0f64; count];
            for (index, size) in sizes.iter().enumerate() {
                columns[index % count] = columns[index % count].max(size.0);
            }
            let rows: Vec<f64> =
                sizes.chunks(count).map(|row| row.iter().map(|size| size.1).fold(0.0, f64::max)).collect();
            (columns, rows)
        };
        // The arrangement that can be drawn largest.
        let fit = |(columns, rows): &(Vec<f64>, Vec<f64>)| {
            let (width, height): (f64, f64) = (columns.iter().sum(), rows.iter().sum());
            (TARGET.0 / width.max(1.0)).min(TARGET.1 / height.max(1.0))
        };
        let all = (1..=sizes.len().max(1)).map(arranged);
        let best = all.reduce(|best, next| if fit(&next) > fit(&best) { next } else { best });
        let best = best.unwrap_or_default();
        let long = |&(width, height): &(f64, f64)| {
            let (short, long) = (width.min(height), width.max(height));
            (LONG.0 / short.max(1.0)).min(LONG.1 / long.max(1.0))
        };
        let longest = sizes.iter().map(|(width, height)| width.max(*height)).fold(1.0, f64::max);
        let least = if let [only] = sizes.as_slice() { long(only) } else { SMALL / longest };
        let scale = fit(&best).max(least).min(MAX_SCALE);
        let scaled = |sizes: Vec<f64>| sizes.into_iter().map(|size| size * scale).collect();
        let heads = if views.len() > 1 { HEAD } else { 0.0 };
        Grid { columns: scaled(best.0), rows: scaled(best.1), scale, heads }
    }

    fn width(&self) -> f64 {
        self.columns.iter().sum::<f64>() + MARGIN * self.columns.len().saturating_sub(1) as f64
    }

    fn height(&self) -> f64 {
        self.rows.iter().map(|row| row + self.heads).sum::<f64>() + MARGIN * self.rows.len().saturating_sub(1) as f64
    }

    /// The upper left corner of a panel with its name.
    fn place(&self, index: usize) -> (f64, f64) {
        let (column, row) = (index % self.columns.len().max(1), index / self.columns.len().max(1));
        let x = self.columns.iter().take(column).map(|width| width + MARGIN).sum();
        let y = self.rows.iter().take(row).map(|height| height + self.heads + MARGIN).sum();
        (x, y)
    }
}
