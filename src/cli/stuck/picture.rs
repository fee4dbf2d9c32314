//! The picture of stuck places: the level, the places, and the ways into the first of them.

use std::path::Path;

use crate::ir::GoalId;
use crate::reach::stuck::Spot;
use crate::sim::Simulator;
use crate::view::{Images, Node, Picture, Run, picture_svg};
use crate::watch::Watch;

use super::text::{summary, verdict};
use crate::ask::{StuckDrawn, StuckResult, recorded};

/// Maximum number of ways in a picture.
const MAX_DRAWN: usize = 4;

/// Writes the picture.
///
/// # Errors
/// As writing the file.
pub(super) fn save(
    path: &Path,
    (sim, goal): (&Simulator, GoalId),
    result: &StuckResult,
    drawn: &StuckDrawn,
    images: &Images,
    watch: &dyn Watch,
) -> std::io::Result<()> {
    let node = |(at, spot): (u32, &Spot)| Node { parent: at, space: spot.0, at: spot.1 };
    let traps: Vec<Node> = (0u32..).zip(&drawn.spots).map(node).collect();
    let mut run = Run::default();
    for script in drawn.scripts.iter().take(MAX_DRAWN) {
        let way = recorded(sim, (script, None), watch);
        // Only the players: the ways of others would be drawn once for each way in.
        let players = way.tracks.into_iter().filter(|track| sim.world().slots[track.slot].player.is_some());
        run.tracks.extend(players);
    }
    let picture = Picture {
        title: &result.goal,
        result: verdict(result.verdict),
        is_good: drawn.spots.is_empty(),
        goals: &[goal],
        nodes: &[],
        traps: &traps,
        layers: &[],
        run: &run,
        notes: &[summary(result)],
        images,
    };
    std::fs::write(path, picture_svg(sim.program(), sim.world_id(), &picture))
}
