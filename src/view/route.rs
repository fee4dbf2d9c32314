//! The path: a strong line with the player's box at intervals, dots where the inputs change, and the links that it uses
//! as numbered doors.

use std::ops::Range;

use crate::ir::{Bounds, SpaceId, World};

use super::frame::{Frame, Rect, moved};
use super::label::Labels;
use super::search::Stop;
use super::svg::{Number, box_data, line_data, path, put};

/// Maximum number of points of the line in one panel.
const MAX_POINTS: usize = 8_000;
/// Maximum number of boxes, and of dots, in one panel.
const MAX_MARKS: usize = 400;
/// Minimum distance of two dots.
const DOT_GAP: f64 = 5.0;
/// The radius of the markers of the start, the end and doors.
const MARKER: f64 = 7.0;

/// A segment of the path that stays in one space without a jump.
#[derive(Debug, Clone)]
pub(super) struct PathSegment {
    pub space: SpaceId,
    pub stops: Range<usize>,
    /// The numbers of the doors where it enters and leaves.
    pub doors: (Option<usize>, Option<usize>),
}

/// Splits a path at links.
pub(super) fn segments(world: &World, path: &[Stop]) -> Vec<PathSegment> {
    let stays = |a: &Stop, b: &Stop| a.space == b.space && !jumps(world, a.space, a.at, b.at);
    let mut segments: Vec<PathSegment> = Vec::new();
    let mut from = 0;
    for run in path.chunk_by(stays) {
        let door = segments.len();
        if let Some(last) = segments.last_mut() {
            last.doors.1 = Some(door);
        }
        let stops = from..from + run.len();
        from = stops.end;
        segments.push(PathSegment { space: run[0].space, stops, doors: ((door > 0).then_some(door), None) });
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

/// The path and its data for all panels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Route<'a> {
    pub world: &'a World,
    pub path: &'a [Stop],
    pub segments: &'a [PathSegment],
    /// The offset from the position to the drawn point.
    pub middle: [f64; 2],
    /// The player's box relative to the position.
    pub body: Option<Bounds>,
}

impl Route<'_> {
    fn point(&self, stop: &Stop) -> [f64; 2] {
        drawn(self.world, stop.space, [stop.at[0] + self.middle[0], stop.at[1] + self.middle[1]])
    }

    /// The lines of a panel, in the picture.
    pub fn lines(&self, frame: &Frame, space: SpaceId) -> Vec<Vec<[f64; 2]>> {
        let mut gap = 0.6;
        loop {
            let mut lines = Vec::new();
            for strand in self.segments.iter().filter(|strand| strand.space == space) {
                let points: Vec<[f64; 2]> =
                    self.path[strand.stops.clone()].iter().map(|stop| self.point(stop)).collect();
                let inside = |a: &[f64; 2], b: &[f64; 2]| {
                    frame.holds(*a) == frame.holds(*b) && !crosses(self.world, space, *a, *b)
                };
                for run in points.chunk_by(inside).filter(|run| frame.holds(run[0])) {
                    let points: Vec<[f64; 2]> = run.iter().map(|&point| frame.point(point)).collect();
                    lines.push(thinned(&points, gap));
                }
            }
            if lines.iter().map(Vec::len).sum::<usize>() <= MAX_POINTS.max(2 * lines.len()) {
                return lines;
            }
            gap *= 2.0;
        }
    }

    /// Draws the part of the path that is in a space.
    pub fn draw(&self, out: &mut String, frame: &Frame, space: SpaceId, lines: &[Vec<[f64; 2]>], labels: &mut Labels) {
        let mut data = String::new();
        for line in lines {
            line_data(&mut data, line);
        }
        path(out, "casing", &data);
        path(out, "ghost", &self.ghosts(frame, space));
        path(out, "route", &data);
        self.dots(out, frame, space);
        for strand in self.segments.iter().filter(|strand| strand.space == space) {
            let ends = [(strand.stops.start, strand.doors.0), (strand.stops.end - 1, strand.doors.1)];
            for (stop, door) in ends {
                let at = self.point(&self.path[stop]);
                let (Some(door), true) = (door, frame.holds(at)) else { continue };
                marker(out, labels, "door", frame.point(at), Some(door));
            }
        }
        let ends = [(self.path.first(), "start"), (self.path.last(), "end")];
        for (stop, class) in ends {
            if let Some(stop) = stop.filter(|stop| stop.space == space && frame.holds(self.point(stop))) {
                let at = frame.point(self.point(stop));
                marker(out, labels, class, at, None);
                // The start is labelled with the player's name.
                if class == "end" {
                    labels.write("name strong", class, Rect::around(at, MARKER));
                }
            }
        }
    }

    /// The player's box after each move by its own size.
    fn ghosts(&self, frame: &Frame, space: SpaceId) -> String {
        let Some(body) = self.body else { return String::new() };
        let size = (body.right - body.left).max(body.top - body.bottom);
        let mut gap = (1.2 * size).max(4.0 / frame.scale);
        loop {
            let mut boxes = Vec::new();
            for strand in self.segments.iter().filter(|strand| strand.space == space) {
                let mut last: Option<[f64; 2]> = None;
                let stops = self.path[strand.stops.clone()].iter();
                for stop in stops.filter(|stop| frame.holds(self.point(stop))) {
                    let far = last.is_none_or(|last| distance(last, stop.at) >= gap);
                    if far || strand.stops.end == self.path.len() && Some(stop) == self.path.last() {
                        last = Some(stop.at);
                        boxes.extend(frame.cut(moved(body, stop.at)));
                    }
                }
            }
            if boxes.len() <= MAX_MARKS.max(2 * self.segments.len()) {
                let mut data = String::new();
                boxes.into_iter().for_each(|rect| box_data(&mut data, rect));
                return data;
            }
            gap *= 2.0;
        }
    }

    fn dots(&self, out: &mut String, frame: &Frame, space: SpaceId) {
        let segments = self.segments.iter().filter(|strand| strand.space == space);
        let stops = segments.flat_map(|strand| &self.path[strand.stops.clone()]);
        let changes = stops.filter(|stop| stop.changes).map(|stop| self.point(stop)).filter(|p| frame.holds(*p));
        let changes: Vec<[f64; 2]> = changes.map(|point| frame.point(point)).collect();
        let mut gap = DOT_GAP;
        let mut dots = apart(&changes, gap);
        while dots.len() > MAX_MARKS {
            gap *= 2.0;
            dots = apart(&changes, gap);
        }
        for [x, y] in dots {
            put!(out, "<circle class=\"dot\" cx=\"{}\" cy=\"{}\" r=\"2.5\"/>\n", Number(x), Number(y));
        }
    }
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
