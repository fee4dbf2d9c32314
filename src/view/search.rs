//! The whole picture: a title with figures, a panel for each space, the legend.

use crate::ir::{Bounds, PlayerId, Program, SpaceId, WorldId};

use super::appearance::Appearances;
use super::body::Body;
use super::extent::{Visits, extent};
use super::frame::Frame;
use super::goal::Goal;
use super::legend;
use super::panel::{self, PictureContext};
use super::route::{Route, segments};
use super::style::STYLE;
use super::svg::{BOLD, Number, escaped, put, shortened, text_width, wrapped};

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

/// The first player after a step of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// The space.
    pub space: SpaceId,
    /// The position, px.
    pub at: [f64; 2],
    /// Whether the inputs differ from those of the step before.
    pub changes: bool,
}

/// The drawn data of a search.
#[derive(Debug, Clone, Copy)]
pub struct Search<'a> {
    /// The name of the goal.
    pub goal: &'a str,
    /// Its verdict: `reached`, `not found`.
    pub verdict: &'a str,
    /// The nodes of all trees.
    pub nodes: &'a [Node],
    /// The path to the goal; empty if there is none.
    pub path: &'a [Stop],
    /// Lines under the title.
    pub notes: &'a [String],
}

/// Margin of the picture, and distance between panels.
const MARGIN: f64 = 20.0;
/// Target width and height of all panels together.
const TARGET: (f64, f64) = (1400.0, 860.0);
/// Minimum height of a long level, and maximum width up to which it applies.
const LONG: (f64, f64) = (230.0, 2800.0);
/// Minimum width of the longest of several panels.
const SMALL: f64 = 260.0;
/// Maximum scale: px of the picture per px of the game.
const MAX_SCALE: f64 = 4.0;
/// Minimum width of the picture without its margins.
const MIN_WIDTH: f64 = 620.0;
/// Height of a line of the notes, and of a panel's title.
const LINE: f64 = 18.0;
const HEAD: f64 = 24.0;
/// Maximum number of lines of a note.
const NOTE_LINES: usize = 3;

/// Draws the spaces of a world with the visits of a search, its tree and its path, as self-contained SVG.
pub fn search_svg(program: &Program, world: WorldId, search: &Search<'_>) -> String {
    let world = &program.worlds[world];
    let hero = world.players.get(PlayerId(0)).map(|player| player.slot);
    let body = hero.map(|hero| Body::new(program, world, hero)).unwrap_or_default();
    let middle = body.middle();
    let goal = Goal::new(program, world, search.goal, hero, middle);
    let segments = segments(world, search.path);
    let mut shown = Vec::new();
    for (id, space) in world.spaces.pairs() {
        let nodes = search.nodes.iter().filter(|node| node.space == id);
        let stops = search.path.iter().filter(|stop| stop.space == id);
        let visits = Visits::new(
            nodes.map(|node| [f64::from(node.at[0]) + middle[0], f64::from(node.at[1]) + middle[1]]),
            stops.map(|stop| [stop.at[0] + middle[0], stop.at[1] + middle[1]]),
        );
        let empty = space.map.is_none() && space.solids.is_empty() && space.bounds.is_none();
        let starts_here = hero.is_some_and(|hero| world.slots[hero].space == id);
        if !empty || visits.count > 0 || visits.path.is_some() || starts_here {
            let size = body.bounds().map_or(0.0, |b| (b.right - b.left).max(b.top - b.bottom));
            shown.push((id, extent(program, world, id, &visits, size), visits));
        }
    }
    let appearances = Appearances::new(program, world, hero, goal.tags);
    let route = Route { world, path: search.path, segments: &segments, middle, body: body.bounds() };
    let visited = shown.iter().filter(|(.., visits)| visits.count > 0).count().max(1);
    let bounded = shown.iter().any(|(id, view, _)| world.spaces[*id].bounds.is_some_and(|bounds| bounds != *view));
    let context = PictureContext { program, world, search, appearances, goal, route, hero, visited, bounded };
    let grid = Grid::new(&shown.iter().map(|(_, view, _)| *view).collect::<Vec<_>>());
    let width = grid.width().max(MIN_WIDTH);

    let mut out = String::new();
    let mut y = title(&mut out, &world.name, search, width);
    for (index, (id, view, visits)) in shown.iter().enumerate() {
        let (x, top) = grid.place(index);
        let frame = Frame { view: *view, scale: grid.scale };
        let mut top = y + top;
        if shown.len() > 1 {
            head(&mut out, &context, *id, visits, (x, top), frame.width());
            top += HEAD;
        }
        // A nested `svg` element clips, without the need for a named clip path.
        let (x, top) = (Number(MARGIN + x), Number(top));
        let (width, height) = (Number(frame.width()), Number(frame.height()));
        put!(out, "<svg x=\"{x}\" y=\"{top}\" width=\"{width}\" height=\"{height}\">\n");
        panel::draw(&mut out, &context, *id, &frame, visits);
        out.push_str("</svg>\n");
    }
    y += grid.height() + MARGIN * 0.6;
    put!(out, "<g transform=\"translate({MARGIN} {})\">\n", Number(y));
    y += legend::draw(&mut out, &context, width) + MARGIN * 0.6;
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

/// Draws world, goal, verdict and notes; returns the top of the panels.
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

/// The title of a panel, with its share of the search.
fn head(out: &mut String, context: &PictureContext<'_>, id: SpaceId, visits: &Visits, (x, y): (f64, f64), width: f64) {
    let all = context.search.nodes.len();
    let share = match visits.count {
        _ if all == 0 => String::new(),
        0 => "never entered".into(),
        visits => format!("{} % of the states found", Number((1000.0 * visits as f64 / all as f64).round() / 10.0)),
    };
    let (x, line) = (MARGIN + x, Number(y + 16.0));
    let name = shortened(&context.world.spaces[id].name, 13.0 * BOLD, width);
    put!(out, "<text class=\"head\" x=\"{}\" y=\"{line}\">{}</text>\n", Number(x), escaped(&name));
    let after = text_width(&name, 13.0 * BOLD) + 12.0;
    if !share.is_empty() && after + text_width(&share, 12.0) <= width {
        put!(out, "<text class=\"quiet\" x=\"{}\" y=\"{line}\">{share}</text>\n", Number(x + after));
    }
}

/// The arrangement of the panels: in rows of equal length, all at the same scale.
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
        // The arrangement with the largest scale.
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

    /// The upper left corner of a panel with its title.
    fn place(&self, index: usize) -> (f64, f64) {
        let (column, row) = (index % self.columns.len().max(1), index / self.columns.len().max(1));
        let x = self.columns.iter().take(column).map(|width| width + MARGIN).sum();
        let y = self.rows.iter().take(row).map(|height| height + self.heads + MARGIN).sum();
        (x, y)
    }
}
