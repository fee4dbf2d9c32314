//! The ways of what moves besides the players: thin lines, with the shape at intervals, and a cross where something is
//! destroyed.

use crate::ir::{Origin, Program, SpaceId, World};

use super::body::Body;
use super::frame::Frame;
use super::route::{drawn, ghosts, segments, visible};
use super::svg::{Number, line_data, path, put};
use super::track::Track;

/// Maximum number of points of all lines in one panel, and of ways that are drawn.
const MAX_POINTS: usize = 6_000;
const MAX_TRACKS: usize = 300;
/// Maximum number of shapes of one way in one panel.
const MAX_SHAPES: usize = 24;
/// Distance of two shapes, in sizes of the instance.
const APART: f64 = 0.95;
/// What has moved less has not moved, px.
const STILL: f64 = 1.0;

/// Whether a way is worth drawing.
pub(super) fn is_way(track: &Track) -> bool {
    track.extent() > STILL || track.stops.iter().any(|stop| stop.jumps)
}

/// Draws the ways in a space.
pub(super) fn draw(
    out: &mut String,
    (program, world): (&Program, &World),
    frame: &Frame,
    space: SpaceId,
    tracks: &[&Track],
) {
    let every = tracks.len().div_ceil(MAX_TRACKS).max(1);
    let tracks: Vec<&Track> = tracks.iter().copied().step_by(every).collect();
    let mut lines = Vec::new();
    let mut gone = String::new();
    for track in &tracks {
        let middle = Body::new(program, world, track.slot).middle();
        let at = |at: [f64; 2]| drawn(world, space, [at[0] + middle[0], at[1] + middle[1]]);
        for segment in segments(&track.stops, 1).into_iter().filter(|segment| segment.space == space) {
            let points: Vec<[f64; 2]> = track.stops[segment.stops].iter().map(|stop| at(stop.at)).collect();
            if points.len() > 1 {
                lines.extend(visible(world, frame, space, &points));
            }
        }
        let is_placed = world.slots[track.slot].origin != Origin::Free;
        let end = track.stops.last().filter(|stop| track.is_destroyed && is_placed && stop.space == space);
        if let Some(end) = end.map(|stop| at(stop.at)).filter(|end| frame.holds(*end)) {
            let [x, y] = frame.point(end);
            put!(gone, "M{} {}l8 8m0-8l-8 8", Number(x - 4.0), Number(y - 4.0));
        }
    }
    let mut data = String::new();
    let every = lines.iter().map(Vec::len).sum::<usize>().div_ceil(MAX_POINTS).max(1);
    for line in &lines {
        let mut points: Vec<[f64; 2]> = line.iter().copied().step_by(every).collect();
        points.extend(line.last().filter(|_| (line.len() - 1) % every != 0));
        line_data(&mut data, &points);
    }
    path(out, "trail", &data);
    for track in tracks {
        ghosts(out, "mover", frame, (world, space), &track.poses, (APART, MAX_SHAPES));
    }
    path(out, "gone", &gone);
}
