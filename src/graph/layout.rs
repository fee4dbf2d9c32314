//! Where everything of a statechart is in our own pictures, in pixels; y points down.
//!
//! The modes of a group are one below the other, inner ones inside. What a mode does is written in lines of text in its
//! box, an edge among them, so that no text covers another. The ways of the edges run beside the boxes: from the edge's
//! line to the right, along a track, back to the target's title. All edges to one mode share a track.

use super::Chart;
use super::chart::{Initial, Mode};
use super::excerpt::{short, wrapped};

/// The advance of a character, a little more than that of the usual fonts.
pub(super) const LETTER: f64 = 7.3;
/// The height of a line of text.
pub(super) const LINE: f64 = 18.0;
/// From a border to what is inside.
pub(super) const PAD: f64 = 10.0;
/// Where the guard of an edge begins, right of its number.
pub(super) const NUMBER: f64 = 22.0;

/// Of what staying changes.
pub(super) const INDENT: f64 = 2.0 * LETTER;

/// The text of an entity without modes.
pub(super) const NONE: &str = "no modes";

/// Room for the arrow of an initial marker.
const MARKER: f64 = 26.0;
const GAP: f64 = 10.0;
const TRACK: f64 = 11.0;
/// Characters of a line.
const WIDTH: usize = 44;
/// Groups that would reach further begin a new row.
const MOST: f64 = 1700.0;

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

/// What a line of text in a box says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Says {
    /// The mode's name.
    Name,
    /// What happens on entering and staying.
    Action,
    /// What staying changes.
    Effect,
    /// The beginning of an edge, by its place in the chart: its guard.
    Guard(usize),
    /// More of its guard.
    GuardGoesOn,
    /// What it changes.
    Update,
    /// Where an edge leads: the end of its text.
    Target(usize),
}

/// A line of text of a mode.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Line {
    pub says: Says,
    pub text: String,
    /// Its middle.
    pub y: f64,
}

/// The box of a mode.
#[derive(Debug, Clone, Default)]
pub(super) struct Box {
    pub rect: Rect,
    pub lines: Vec<Line>,
    /// Whether it has an initial marker, and whether that depends on a guard.
    pub initial: Option<bool>,
}

/// The way of all edges to one mode.
#[derive(Debug, Clone)]
pub(super) struct Way {
    pub target: usize,
    pub edges: Vec<usize>,
    /// The track's place.
    pub x: f64,
}

/// Where everything is.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    pub rect: Rect,
    pub groups: Vec<Rect>,
    /// For each mode.
    pub boxes: Vec<Box>,
    pub ways: Vec<Way>,
}

impl Layout {
    /// The middle of a mode's title.
    pub fn title(&self, mode: usize) -> f64 {
        self.boxes.get(mode).and_then(|b| b.lines.first()).map_or(0.0, |line| line.y)
    }

    /// The line at whose end the way of an edge begins: its right end and its middle.
    pub fn start(&self, edge: usize) -> (f64, f64) {
        let lines = self.boxes.iter().flat_map(|b| b.lines.iter().map(move |line| (b, line)));
        let mut found = lines.filter(|(_, line)| line.says == Says::Target(edge));
        found.next().map_or((0.0, 0.0), |(b, line)| (b.rect.x + PAD + NUMBER + letters(&line.text), line.y))
    }
}

/// The width of a text.
pub(super) fn letters(text: &str) -> f64 {
    text.chars().count() as f64 * LETTER
}

/// Lays a chart out, its upper left corner at (0, 0).
pub(super) fn layout(chart: &Chart) -> Layout {
    let boxes = chart.modes.iter().enumerate().map(|(index, mode)| Box {
        lines: lines(chart, index, mode),
        initial: marker(chart, index),
        rect: Rect::default(),
    });
    let mut out = Layout { rect: Rect::default(), groups: Vec::new(), boxes: boxes.collect(), ways: Vec::new() };
    let title = LINE + PAD;
    let (mut x, mut y, mut row, mut right) = (PAD, title + PAD, 0.0f64, letters(&chart.entity) + 2.0 * PAD);
    for region in &chart.regions {
        let inside = region.modes.iter().map(|m| width(chart, &out, *m)).fold(0.0, f64::max);
        let ways = ways(chart, region.modes.iter().copied());
        let name = region.name.as_ref().map_or(0.0, |name| letters(name) + 2.0 * PAD);
        // The tracks are numbered once the lines have their places, and there are no more of them than targets.
        let beside = |tracks: usize| (tracks as f64 + 1.0) * TRACK;
        if x > PAD && x + MARKER + inside + beside(ways.len()) > MOST {
            (x, y, row) = (PAD, y + row + GAP, 0.0);
        }
        let mut bottom = y + if region.name.is_some() { LINE + PAD } else { PAD };
        for &mode in &region.modes {
            bottom = place(chart, &mut out, mode, (x + MARKER, bottom), inside) + GAP;
        }
        let tracks = tracks(&mut out, ways, x + MARKER + inside);
        let rect = Rect { x, y, width: (MARKER + inside + beside(tracks)).max(name), height: bottom - y };
        row = row.max(rect.height);
        right = right.max(rect.right() + PAD);
        x = rect.right() + GAP;
        out.groups.push(rect);
    }
    if chart.regions.is_empty() {
        row = LINE;
        right = right.max(letters(NONE) + 2.0 * PAD);
    }
    out.rect = Rect { x: 0.0, y: 0.0, width: right, height: y + row + PAD };
    // Groups in one row are of one height.
    let rows: Vec<Rect> = out.groups.clone();
    for group in &mut out.groups {
        let beside = rows.iter().filter(|other| other.y == group.y);
        group.height = beside.map(|other| other.height).fold(group.height, f64::max);
    }
    out
}

/// The text of a mode's box; places come later.
fn lines(chart: &Chart, index: usize, mode: &Mode) -> Vec<Line> {
    let mut out = vec![Line { says: Says::Name, text: mode.name.clone(), y: 0.0 }];
    let mut add = |says, text: String| out.push(Line { says, text, y: 0.0 });
    for (guard, chosen) in siblings_initial(chart, index).iter().flat_map(|initial| &initial.choices) {
        if *chosen == index {
            wrapped(&format!("initial when {guard}"), WIDTH).into_iter().for_each(|text| add(Says::Action, text));
        }
    }
    for update in &mode.entry {
        add(Says::Action, short(&format!("entry / {update}"), WIDTH));
    }
    for action in &mode.internal {
        wrapped(&action.guard, WIDTH).into_iter().for_each(|text| add(Says::Action, text));
        action.updates.iter().for_each(|update| add(Says::Effect, short(&format!("/ {update}"), WIDTH)));
    }
    for (id, edge) in chart.edges.iter().enumerate().filter(|(_, edge)| edge.source == index) {
        for (line, text) in wrapped(&edge.guard, WIDTH).into_iter().enumerate() {
            add(if line == 0 { Says::Guard(id) } else { Says::GuardGoesOn }, text);
        }
        edge.updates.iter().for_each(|update| add(Says::Update, short(&format!("/ {update}"), WIDTH)));
        add(Says::Target(id), format!("→ {}", chart.modes[edge.target].name));
    }
    out
}

/// Which of the modes beside a mode, itself included, comes first.
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

/// How wide a mode's box must be.
fn width(chart: &Chart, out: &Layout, mode: usize) -> f64 {
    let line = |line: &Line| match line.says {
        // The name has a clock behind it.
        Says::Name => letters(&line.text) + 2.0 * LINE,
        Says::Action => letters(&line.text),
        Says::Effect => letters(&line.text) + INDENT,
        Says::Guard(_) | Says::GuardGoesOn | Says::Update => letters(&line.text) + NUMBER,
        Says::Target(_) => letters(&line.text) + NUMBER + LINE,
    };
    let own = out.boxes[mode].lines.iter().map(line).fold(0.0, f64::max) + 2.0 * PAD;
    let children = chart.modes[mode].children.iter().map(|child| width(chart, out, *child) + MARKER + PAD);
    children.fold(own, f64::max)
}

/// Puts a mode and what is inside in its place and gives its bottom.
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

/// The edges inside of modes, by target.
fn ways(chart: &Chart, modes: impl Iterator<Item = usize>) -> Vec<Way> {
    let mut inside: Vec<usize> = modes.collect();
    let mut next = 0;
    while let Some(&mode) = inside.get(next) {
        inside.extend(&chart.modes[mode].children);
        next += 1;
    }
    let mut ways: Vec<Way> = Vec::new();
    for (id, edge) in chart.edges.iter().enumerate().filter(|(_, edge)| inside.contains(&edge.source)) {
        match ways.iter_mut().find(|way| way.target == edge.target) {
            Some(way) => way.edges.push(id),
            None => ways.push(Way { target: edge.target, edges: vec![id], x: 0.0 }),
        }
    }
    ways
}

/// Gives each way a track right of `left`, short ones the inner ones, and gives the number of tracks.
fn tracks(out: &mut Layout, ways: Vec<Way>, left: f64) -> usize {
    let reach = |way: &Way| {
        let ends = way.edges.iter().map(|edge| out.start(*edge).1).chain([out.title(way.target)]);
        ends.fold((f64::MAX, f64::MIN), |(low, high), y| (low.min(y), high.max(y)))
    };
    let mut ways: Vec<((f64, f64), Way)> = ways.into_iter().map(|way| (reach(&way), way)).collect();
    ways.sort_by(|((a, b), _), ((c, d), _)| (b - a).total_cmp(&(d - c)));
    let mut taken: Vec<Vec<(f64, f64)>> = Vec::new();
    for ((low, high), mut way) in ways {
        let free = |track: &Vec<(f64, f64)>| track.iter().all(|(from, to)| high < from - GAP || low > to + GAP);
        let track = taken.iter().position(free).unwrap_or(taken.len());
        if track == taken.len() {
            taken.push(Vec::new());
        }
        taken[track].push((low, high));
        way.x = left + (track as f64 + 1.0) * TRACK;
        out.ways.push(way);
    }
    taken.len()
}
