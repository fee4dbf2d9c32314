//! Layout of statecharts for our SVG, in pixels; y points down.
//!
//! The modes of a group are stacked, inner ones inside. The actions of a mode are lines of text in its box, edges among
//! them, so that no text covers another. The routes of the edges run beside the boxes: from the edge's line to the
//! right, along a track, back to the target's title. All edges to one mode share a route.

use super::Chart;
use super::chart::{Initial, Mode};
use super::excerpt::{short, wrapped};
use crate::ir::Extremes;
use crate::ordered::Ordered;

/// Assumed width of a character, slightly more than in common fonts.
pub(super) const LETTER: f64 = 7.3;
/// The height of a line of text.
pub(super) const LINE: f64 = 18.0;
/// Distance from a border to its content.
pub(super) const PAD: f64 = 10.0;
/// Distance from the number of an edge to its guard.
pub(super) const NUMBER: f64 = 22.0;

/// Indentation of the updates of internal actions.
pub(super) const INDENT: f64 = 2.0 * LETTER;

/// The text of an entity without modes.
pub(super) const NONE: &str = "no modes";

/// Width of the arrow of an initial marker.
const MARKER: f64 = 26.0;
const GAP: f64 = 10.0;
const TRACK: f64 = 11.0;
/// Maximum number of characters of a line.
const WIDTH: usize = 44;
/// Maximum width of a row of groups.
const MAX_ROW_WIDTH: f64 = 1700.0;

/// A rectangle.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Rect {
    pub x: f64,
    pub y: f64,
    pub width: f64,
    pub height: f64,
}

impl Rect {
    pub fn right(self) -> f64 {
        self.x + self.width
    }
}

/// The kind of a line of text in a box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum LineKind {
    /// The mode's name.
    Name,
    /// An entry action, or the guard of `follow links`.
    Action,
    /// The guard of an edge without a target: its index among the edges of the entity.
    Internal(usize),
    /// An update of an internal action.
    Effect,
    /// The first line of an edge's guard, with the index of the edge.
    Guard(usize),
    /// A further line of the guard.
    GuardContinued,
    /// An update of the edge.
    Update,
    /// The target of an edge: the last line of its text.
    Target(usize),
}

/// A line of text of a mode.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Line {
    pub kind: LineKind,
    pub text: String,
    /// The y coordinate of its middle.
    pub y: f64,
}

/// The box of a mode.
#[derive(Debug, Clone, Default)]
pub(super) struct Box {
    pub rect: Rect,
    pub lines: Vec<Line>,
    /// Its initial marker, if any, and whether it depends on a guard.
    pub initial: Option<bool>,
}

/// The route of all edges to one mode.
#[derive(Debug, Clone)]
pub(super) struct Route {
    pub target: usize,
    pub edges: Vec<usize>,
    /// The x coordinate of its track.
    pub x: f64,
}

/// The layout of a chart.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    pub rect: Rect,
    pub groups: Vec<Rect>,
    /// The box of each mode.
    pub boxes: Vec<Box>,
    pub routes: Vec<Route>,
}

impl Layout {
    /// The middle of a mode's title.
    pub fn title(&self, mode: usize) -> f64 {
        self.boxes.get(mode).and_then(|b| b.lines.first()).map_or(0.0, |line| line.y)
    }

    /// The right end and the middle of the line where the route of an edge begins.
    pub fn start(&self, edge: usize) -> (f64, f64) {
        let lines = self.boxes.iter().flat_map(|b| b.lines.iter().map(move |line| (b, line)));
        let mut found = lines.filter(|(_, line)| line.kind == LineKind::Target(edge));
        found.next().map_or((0.0, 0.0), |(b, line)| (b.rect.x + PAD + NUMBER + letters(&line.text), line.y))
    }
}

/// The width of a text.
pub(super) fn letters(text: &str) -> f64 {
    text.chars().count() as f64 * LETTER
}

/// Computes the layout of a chart, its upper left corner at (0, 0).
pub(super) fn layout(chart: &Chart) -> Layout {
    let boxes = chart.modes.iter().enumerate().map(|(index, mode)| Box {
        lines: lines(chart, index, mode),
        initial: marker(chart, index),
        rect: Rect::default(),
    });
    let mut out = Layout { rect: Rect::default(), groups: Vec::new(), boxes: boxes.collect(), routes: Vec::new() };
    let title = LINE + PAD;
    let (mut x, mut y, mut row, mut right) = (PAD, title + PAD, 0.0f64, letters(&chart.entity) + 2.0 * PAD);
    for region in &chart.regions {
        let inside = region.modes.iter().map(|m| width(chart, &out, *m)).fold(0.0, f64::greatest);
        let routes = routes(chart, region.modes.iter().copied());
        let name = region.name.as_ref().map_or(0.0, |name| letters(name) + 2.0 * PAD);
        // Tracks are assigned when the lines have their places; there are at most as many as targets.
        let beside = |tracks: usize| (tracks as f64 + 1.0) * TRACK;
        if x > PAD && x + MARKER + inside + beside(routes.len()) > MAX_ROW_WIDTH {
            (x, y, row) = (PAD, y + row + GAP, 0.0);
        }
        let mut bottom = y + if region.name.is_some() { LINE + PAD } else { PAD };
        for &mode in &region.modes {
            bottom = place(chart, &mut out, mode, (x + MARKER, bottom), inside) + GAP;
        }
        let tracks = assign_tracks(&mut out, routes, x + MARKER + inside);
        let rect = Rect { x, y, width: (MARKER + inside + beside(tracks)).greatest(name), height: bottom - y };
        row = row.greatest(rect.height);
        right = right.greatest(rect.right() + PAD);
        x = rect.right() + GAP;
        out.groups.push(rect);
    }
    if chart.regions.is_empty() {
        row = LINE;
        right = right.greatest(letters(NONE) + 2.0 * PAD);
    }
    out.rect = Rect { x: 0.0, y: 0.0, width: right, height: y + row + PAD };
    // Groups in one row have the same height.
    let rows: Vec<Rect> = out.groups.clone();
    for group in &mut out.groups {
        let beside = rows.iter().filter(|other| other.y == group.y);
        group.height = beside.map(|other| other.height).fold(group.height, f64::greatest);
    }
    out
}

/// The lines of a mode's box; places are set later.
fn lines(chart: &Chart, index: usize, mode: &Mode) -> Vec<Line> {
    let mut out = vec![Line { kind: LineKind::Name, text: mode.name.clone(), y: 0.0 }];
    let mut add = |kind, text: String| out.push(Line { kind, text, y: 0.0 });
    for (guard, chosen) in siblings_initial(chart, index).iter().flat_map(|initial| &initial.choices) {
        if *chosen == index {
            wrapped(&format!("initial when {guard}"), WIDTH).into_iter().for_each(|text| add(LineKind::Action, text));
        }
    }
    for update in &mode.entry {
        add(LineKind::Action, short(&format!("entry / {update}"), WIDTH));
    }
    for action in &mode.internal {
        let kind = action.edge.map_or(LineKind::Action, LineKind::Internal);
        wrapped(&action.guard, WIDTH).into_iter().for_each(|text| add(kind, text));
        action.updates.iter().for_each(|update| add(LineKind::Effect, short(&format!("/ {update}"), WIDTH)));
    }
    for (id, edge) in chart.edges.iter().enumerate().filter(|(_, edge)| edge.source == index) {
        for (line, text) in wrapped(&edge.guard, WIDTH).into_iter().enumerate() {
            add(if line == 0 { LineKind::Guard(id) } else { LineKind::GuardContinued }, text);
        }
        edge.updates.iter().for_each(|update| add(LineKind::Update, short(&format!("/ {update}"), WIDTH)));
        add(LineKind::Target(id), format!("→ {}", chart.modes[edge.target].name));
    }
    out
}

/// The initial mode of a mode and its siblings.
fn siblings_initial(chart: &Chart, index: usize) -> Option<&Initial> {
    match chart.modes[index].parent {
        Some(parent) => chart.modes[parent].initial.as_ref(),
        None => chart.regions.iter().find(|r| r.modes.contains(&index)).map(|r| &r.initial),
    }
}

fn marker(chart: &Chart, index: usize) -> Option<bool> {
    let initial = siblings_initial(chart, index)?;
    let chosen = initial.choices.iter().any(|(_, mode)| *mode == index);
    (initial.mode == index || chosen).then_some(chosen)
}

/// The minimum width of a mode's box.
fn width(chart: &Chart, out: &Layout, mode: usize) -> f64 {
    let line = |line: &Line| match line.kind {
        // A clock follows the name.
        LineKind::Name => letters(&line.text) + 2.0 * LINE,
        LineKind::Action | LineKind::Internal(_) => letters(&line.text),
        LineKind::Effect => letters(&line.text) + INDENT,
        LineKind::Guard(_) | LineKind::GuardContinued | LineKind::Update => letters(&line.text) + NUMBER,
        LineKind::Target(_) => letters(&line.text) + NUMBER + LINE,
    };
    let own = out.boxes[mode].lines.iter().map(line).fold(0.0, f64::greatest) + 2.0 * PAD;
    let children = chart.modes[mode].children.iter().map(|child| width(chart, out, *child) + MARKER + PAD);
    children.fold(own, f64::greatest)
}

/// Sets the place of a mode and its inner modes; returns its bottom.
fn place(chart: &Chart, out: &mut Layout, mode: usize, (x, y): (f64, f64), width: f64) -> f64 {
    let mut bottom = y + PAD / 2.0;
    for line in &mut out.boxes[mode].lines {
        line.y = bottom + LINE / 2.0;
        bottom += LINE;
    }
    bottom += PAD / 2.0;
    for &child in &chart.modes[mode].children {
        bottom = place(chart, out, child, (x + MARKER, bottom), width - MARKER - PAD) + GAP;
    }
    out.boxes[mode].rect = Rect { x, y, width, height: bottom - y };
    bottom
}

/// The routes of the edges between modes, by target.
fn routes(chart: &Chart, modes: impl Iterator<Item = usize>) -> Vec<Route> {
    let mut inside: Vec<usize> = modes.collect();
    let mut next = 0;
    while let Some(&mode) = inside.get(next) {
        inside.extend(&chart.modes[mode].children);
        next += 1;
    }
    let mut routes: Vec<Route> = Vec::new();
    for (id, edge) in chart.edges.iter().enumerate().filter(|(_, edge)| inside.contains(&edge.source)) {
        match routes.iter_mut().find(|route| route.target == edge.target) {
            Some(route) => route.edges.push(id),
            None => routes.push(Route { target: edge.target, edges: vec![id], x: 0.0 }),
        }
    }
    routes
}

/// Assigns each route a track right of `left`, inner ones to short routes; returns the number of tracks.
fn assign_tracks(out: &mut Layout, routes: Vec<Route>, left: f64) -> usize {
    let reach = |route: &Route| {
        let ends = route.edges.iter().map(|edge| out.start(*edge).1).chain([out.title(route.target)]);
        ends.fold((f64::MAX, f64::MIN), |(low, high), y| (low.least(y), high.greatest(y)))
    };
    let mut routes: Vec<((f64, f64), Route)> = routes.into_iter().map(|route| (reach(&route), route)).collect();
    routes.order_by(|((a, b), _), ((c, d), _)| (b - a).total_cmp(&(d - c)));
    let mut taken: Vec<Vec<(f64, f64)>> = Vec::new();
    for ((low, high), mut route) in routes {
        let free = |track: &Vec<(f64, f64)>| track.iter().all(|(from, to)| high < from - GAP || low > to + GAP);
        let track = taken.iter().position(free).unwrap_or(taken.len());
        if track == taken.len() {
            taken.push(Vec::new());
        }
        taken[track].push((low, high));
        route.x = left + (track as f64 + 1.0) * TRACK;
        out.routes.push(route);
    }
    taken.len()
}
