//! The ways of the players: a strong line with the player's shape at intervals, dots where the inputs change, and the
//! places where it is put elsewhere as numbered doors.

use std::ops::Range;

use crate::ir::{Bounds, Extremes, SpaceId, World};

use super::body::outline;
use super::frame::{Frame, Rect, moved};
use super::label::Labels;
use super::svg::{Number, box_data, line_data, path, put};
use super::track::{Part, Pose, Stop, Track};

/// Maximum number of points of the line in one panel.
const MAX_POINTS: usize = 8_000;
/// Maximum number of shapes, and of dots, in one panel.
const MAX_MARKS: usize = 400;
/// Minimum distance of two dots.
const DOT_GAP: f64 = 5.0;
/// The radius of the markers of the start, the end and doors.
const MARKER: f64 = 7.0;

/// A segment of a way that stays in one space without a jump.
#[derive(Debug, Clone)]
pub(super) struct PathSegment {
    pub space: SpaceId,
    pub stops: Range<usize>,
    /// The numbers of the doors where it enters and leaves.
    pub doors: (Option<usize>, Option<usize>),
}

/// Splits a way where it jumps; `first` is the number of the first door.
pub(super) fn segments(path: &[Stop], first: usize) -> Vec<PathSegment> {
    let mut segments: Vec<PathSegment> = Vec::new();
    let mut from = 0;
    for run in path.chunk_by(|a, b| a.space == b.space && !b.jumps) {
        let door = first + segments.len().saturating_sub(1);
        let enters = segments.last_mut().map(|last| last.doors.1.insert(door)).copied();
        let stops = from..from + run.len();
        from = stops.end;
        segments.push(PathSegment { space: run[0].space, stops, doors: (enters, None) });
    }
    segments
}

/// Whether a move within a space uses a link of the space to itself.
pub(super) fn jumps(world: &World, space: SpaceId, from: [f64; 2], to: [f64; 2]) -> bool {
    let distance = |[x, y]: [f64; 2]| x.abs() + y.abs();
    let step = [to[0] - from[0], to[1] - from[1]];
    let inner = world.spaces.get(space).into_iter().flat_map(|s| &s.links).filter(|link| link.space == space);
    inner.into_iter().any(|link| {
        let shift = [link.to.left - link.from.left, link.to.bottom - link.from.bottom];
        distance([step[0] - shift[0], step[1] - shift[1]]) < distance(step)
    })
}

/// A point where it is drawn: between the borders of a space that wraps.
pub(super) fn drawn(world: &World, space: SpaceId, at: [f64; 2]) -> [f64; 2] {
    let periods = world.spaces.get(space).map_or([None; 2], |space| space.periods);
    [0, 1].map(|axis| periods[axis].map_or(at[axis], |period| period.wrapped(at[axis])))
}

/// Whether a move goes over the border of a space that wraps: a line between its ends would go the other way around.
pub(super) fn crosses(world: &World, space: SpaceId, from: [f64; 2], to: [f64; 2]) -> bool {
    let periods = world.spaces.get(space).map_or([None; 2], |space| space.periods);
    (0..2).any(|axis| periods[axis].is_some_and(|period| (to[axis] - from[axis]).abs() > period.size() / 2.0))
}

/// The way of a player and its data for all panels.
#[derive(Debug, Clone)]
pub(super) struct Route<'a> {
    pub world: &'a World,
    pub track: &'a Track,
    pub segments: Vec<PathSegment>,
    /// The offset from the position to the drawn point.
    pub middle: [f64; 2],
    /// The class of the player's colour; empty for the first player.
    pub color: &'static str,
}

impl Route<'_> {
    fn point(&self, stop: &Stop) -> [f64; 2] {
        drawn(self.world, stop.space, [stop.at[0] + self.middle[0], stop.at[1] + self.middle[1]])
    }

    fn class(&self, class: &str) -> String {
        format!("{class}{}", self.color)
    }

    /// The lines of a panel, in the picture.
    pub fn lines(&self, frame: &Frame, space: SpaceId) -> Vec<Vec<[f64; 2]>> {
        let mut gap = 0.6;
        loop {
            let mut lines = Vec::new();
            for segment in self.segments.iter().filter(|segment| segment.space == space) {
                let points: Vec<[f64; 2]> =
                    self.track.stops[segment.stops.clone()].iter().map(|stop| self.point(stop)).collect();
                lines.extend(visible(self.world, frame, space, &points).iter().map(|line| thinned(line, gap)));
            }
            if lines.iter().map(Vec::len).sum::<usize>() <= MAX_POINTS.max(2 * lines.len()) {
                return lines;
            }
            gap *= 2.0;
        }
    }

    /// Draws the part of the way that is in a space.
    pub fn draw(&self, out: &mut String, frame: &Frame, space: SpaceId, lines: &[Vec<[f64; 2]>], labels: &mut Labels) {
        let mut data = String::new();
        for line in lines {
            line_data(&mut data, line);
        }
        path(out, "casing", &data);
        ghosts(out, &self.class("ghost"), frame, (self.world, space), &self.track.poses, (0.5, MAX_MARKS));
        path(out, &self.class("route"), &data);
        self.dots(out, frame, space);
        for segment in self.segments.iter().filter(|segment| segment.space == space) {
            let ends = [(segment.stops.start, segment.doors.0), (segment.stops.end - 1, segment.doors.1)];
            for (stop, door) in ends {
                let at = self.point(&self.track.stops[stop]);
                let (Some(door), true) = (door, frame.holds(at)) else { continue };
                marker(out, labels, &self.class("door"), frame.point(at), Some(door));
            }
        }
        let ends = [(self.track.stops.first(), "start"), (self.track.stops.last(), "end")];
        for (stop, class) in ends {
            if let Some(stop) = stop.filter(|stop| stop.space == space && frame.holds(self.point(stop))) {
                let at = frame.point(self.point(stop));
                marker(out, labels, &self.class(class), at, None);
                // The start is labelled with the player's name.
                if class == "end" && self.track.stops.len() > 1 {
                    let word = if self.track.is_destroyed { "destroyed" } else { class };
                    labels.write("name strong", word, Rect::around(at, MARKER));
                }
            }
        }
    }

    /// Where the player was after a step, in the picture of a space, if it was there.
    pub fn place(&self, frame: &Frame, space: SpaceId, step: u64) -> Option<[f64; 2]> {
        let stop = self.track.at(step).filter(|stop| stop.space == space)?;
        let at = self.point(stop);
        frame.holds(at).then(|| frame.point(at))
    }

    fn dots(&self, out: &mut String, frame: &Frame, space: SpaceId) {
        let segments = self.segments.iter().filter(|segment| segment.space == space);
        let stops = segments.flat_map(|segment| &self.track.stops[segment.stops.clone()]);
        let changes = stops.filter(|stop| stop.changes).map(|stop| self.point(stop)).filter(|p| frame.holds(*p));
        let changes: Vec<[f64; 2]> = changes.map(|point| frame.point(point)).collect();
        let mut gap = DOT_GAP;
        let mut dots = apart(&changes, gap);
        while dots.len() > MAX_MARKS {
            gap *= 2.0;
            dots = apart(&changes, gap);
        }
        let class = self.class("dot");
        for [x, y] in dots {
            put!(out, "<circle class=\"{class}\" cx=\"{}\" cy=\"{}\" r=\"2.5\"/>\n", Number(x), Number(y));
        }
    }
}

/// The visible parts of a line through points of a space, in the picture: cut at the frame and at seams.
pub(super) fn visible(world: &World, frame: &Frame, space: SpaceId, points: &[[f64; 2]]) -> Vec<Vec<[f64; 2]>> {
    if let &[only] = points {
        return if frame.holds(only) { vec![vec![frame.point(only)]] } else { Vec::new() };
    }
    let mut lines: Vec<Vec<[f64; 2]>> = Vec::new();
    let mut goes_on = false;
    for pair in points.windows(2) {
        let [from, to] = [pair[0], pair[1]];
        if crosses(world, space, from, to) {
            lines.extend(around(world, frame, space, from, to));
            goes_on = false;
            continue;
        }
        let Some([start, end]) = frame.clip([from, to]) else {
            goes_on = false;
            continue;
        };
        match lines.last_mut().filter(|_| goes_on && start == from) {
            Some(line) => line.push(frame.point(end)),
            None => lines.push(vec![frame.point(start), frame.point(end)]),
        }
        goes_on = end == to;
    }
    lines
}

/// The two parts of a move over a seam, in the picture: to the one border, and from the other one.
fn around(world: &World, frame: &Frame, space: SpaceId, from: [f64; 2], to: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    let periods = world.spaces.get(space).map_or([None; 2], |space| space.periods);
    let way = [0, 1].map(|axis| {
        let way = to[axis] - from[axis];
        periods[axis].map_or(way, |period| period.shortest(way))
    });
    let mut view = frame.view;
    if let Some(period) = periods[0] {
        (view.left, view.right) = (view.left.greatest(period.low), view.right.least(period.high));
    }
    if let Some(period) = periods[1] {
        (view.bottom, view.top) = (view.bottom.greatest(period.low), view.top.least(period.high));
    }
    let parts = [[from, [from[0] + way[0], from[1] + way[1]]], [[to[0] - way[0], to[1] - way[1]], to]];
    let seen = parts.into_iter().filter_map(|part| Frame { view, scale: frame.scale }.clip(part));
    seen.map(|part| part.map(|end| frame.point(end)).to_vec()).collect()
}

/// A shape in the picture: boxes, and circles by centre and radius.
type Ghost = (Vec<Rect>, Vec<([f64; 2], f64)>);

/// Draws the shapes of an instance on its way, at most so many; of several at nearly the same place the first. `apart` is
/// the distance of two shapes, in sizes of the instance.
pub(super) fn ghosts(
    out: &mut String,
    class: &str,
    frame: &Frame,
    (world, space): (&World, SpaceId),
    poses: &[Pose],
    (apart, most): (f64, usize),
) {
    let mut shown: Vec<Ghost> = Vec::new();
    let mut taken: Vec<([f64; 2], f64)> = Vec::new();
    for pose in poses.iter().filter(|pose| pose.space == space) {
        let parts = outline(world, &pose.parts);
        let at = drawn(world, space, pose.at);
        let sides = |part: &Part| [part.bounds.right - part.bounds.left, part.bounds.top - part.bounds.bottom];
        // Another shape at the same place is shown as well.
        let sum = |sum: f64, [width, height]: [f64; 2]| sum + width.round() + 7.0 * height.round();
        let shape = parts.iter().map(sides).fold(parts.len() as f64, sum);
        let whole = parts.iter().map(|part| part.bounds).reduce(Bounds::join);
        let size = whole.map_or([0.0; 2], |b| [b.right - b.left, b.top - b.bottom]);
        let gap = size.map(|side| apart * side.greatest(4.0 / frame.scale));
        let is_near = |other: [f64; 2]| (0..2).all(|axis| (other[axis] - at[axis]).abs() < gap[axis]);
        if taken.iter().any(|(other, of)| *of == shape && is_near(*other)) {
            continue;
        }
        taken.push((at, shape));
        let (mut boxes, mut circles) = (Vec::new(), Vec::new());
        for part in &parts {
            let bounds = moved(part.bounds, at);
            let center = [(bounds.left + bounds.right) / 2.0, (bounds.bottom + bounds.top) / 2.0];
            if !part.round {
                boxes.extend(frame.cut(bounds));
            } else if frame.holds(center) {
                circles.push((frame.point(center), (bounds.right - bounds.left) / 2.0 * frame.scale));
            }
        }
        if !boxes.is_empty() || !circles.is_empty() {
            shown.push((boxes, circles));
        }
    }
    let every = shown.len().div_ceil(most.max(1)).max(1);
    let mut data = String::new();
    let mut round = String::new();
    for (boxes, circles) in shown.into_iter().step_by(every) {
        boxes.into_iter().for_each(|rect| box_data(&mut data, rect));
        for ([x, y], radius) in circles {
            put!(
                round,
                "<circle class=\"{class}\" cx=\"{}\" cy=\"{}\" r=\"{}\"/>\n",
                Number(x),
                Number(y),
                Number(radius)
            );
        }
    }
    path(out, class, &data);
    out.push_str(&round);
}

/// A round marker with an optional number.
fn marker(out: &mut String, labels: &mut Labels, class: &str, [x, y]: [f64; 2], number: Option<usize>) {
    let radius = if number.is_some() { MARKER + 1.0 } else { MARKER };
    put!(out, "<circle class=\"{class}\" cx=\"{}\" cy=\"{}\" r=\"{}\"/>\n", Number(x), Number(y), Number(radius));
    if let Some(number) = number {
        put!(out, "<text class=\"number\" x=\"{}\" y=\"{}\">{number}</text>\n", Number(x), Number(y + 3.5));
    }
    labels.keep_free(Rect::around([x, y], radius));
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

/// The points of a line at a minimum distance, and its end.
fn thinned(points: &[[f64; 2]], gap: f64) -> Vec<[f64; 2]> {
    let mut kept = apart(points, gap);
    if let Some(&end) = points.last()
        && kept.last() != Some(&end)
    {
        kept.push(end);
    }
    // A line of one point is invisible.
    if let &[only] = kept.as_slice() {
        kept.push(only);
    }
    kept
}

/// The first point, and each point at a minimum distance from the last selected one.
fn apart(points: &[[f64; 2]], gap: f64) -> Vec<[f64; 2]> {
    let mut kept: Vec<[f64; 2]> = Vec::new();
    for &point in points {
        if kept.last().is_none_or(|&last| distance(last, point) >= gap) {
            kept.push(point);
        }
    }
    kept
}
