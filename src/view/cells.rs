//! Where a search was, as counts of nodes in square cells: for pages that draw the heat map themselves.

use std::collections::BTreeMap;

use crate::ir::{PlayerId, Program, WorldId};

use super::body::Body;
use super::picture::Node;
use super::route::drawn;

/// Side of a cell, px; the same as in `studio/src/draw/overlays.ts`.
const CELL: f64 = 8.0;

/// The cells that hold the middle of the first player at a node: space, column, row from the bottom, number of nodes.
pub fn cells(program: &Program, id: WorldId, nodes: &[Node]) -> Vec<[i64; 4]> {
    let world = &program.worlds[id];
    let hero = world.players.get(PlayerId(0)).map(|player| player.slot);
    let middle = hero.map_or([0.0; 2], |hero| Body::new(program, world, hero).middle());
    let mut counts: BTreeMap<(u32, i64, i64), i64> = BTreeMap::new();
    for node in nodes {
        let at = [0, 1].map(|axis| f64::from(node.at[axis]) + middle[axis]);
        let [x, y] = drawn(world, node.space, at);
        if x.is_finite() && y.is_finite() {
            let cell = |at: f64| (at / CELL).floor() as i64;
            *counts.entry((node.space.0, cell(x), cell(y))).or_default() += 1;
        }
    }
    counts.into_iter().map(|((space, column, row), count)| [i64::from(space), column, row, count]).collect()
}
