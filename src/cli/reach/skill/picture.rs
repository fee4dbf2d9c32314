//! The picture of `hypedc reach --skill`: the level, and in colours who was where.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::ir::{GoalId, Program, WorldId};
use crate::reach::Target;
use crate::reach::query::Query;
use crate::reach::query::layers::{Cell, Layer, STEP};
use crate::view::{Images, Picture, PictureLayer, Run, picture_svg};

use super::super::text::counted;
use super::result::SkillResult;

/// Draws the layers, each where no layer before has been.
pub(super) fn svg(
    (program, world): (&Arc<Program>, WorldId),
    query: &Query,
    (layers, names): (&[Layer], &[&str]),
    result: &SkillResult,
    images: &Images,
) -> String {
    let mut known: BTreeSet<Cell> = BTreeSet::new();
    let drawn = layers.iter().zip(names).map(|(layer, name)| {
        let new: Vec<Cell> = layer.seen.cells.iter().copied().filter(|cell| known.insert(*cell)).collect();
        let middle = |at: i32| ((f64::from(at) + 0.5) * STEP) as f32;
        let places = new.into_iter().map(|(space, column, row)| (space, [middle(column), middle(row)]));
        PictureLayer { name: name.to_string(), places: places.collect() }
    });
    let drawn: Vec<PictureLayer> = drawn.collect();
    let goals = query.targets.iter().filter_map(|target| match target {
        Target::Goal(id) => Some(*id),
        Target::Never(_) => None,
    });
    let goals: Vec<GoalId> = goals.collect();
    let floors = |layer: &super::result::LayerResult| format!("{} {}", layer.name, layer.tops_stood_on);
    let notes = [
        "each place in the colour of the first players who were there, as far as the searches found".to_string(),
        format!(
            "stood on of {}: {}",
            counted(result.tops, "floor tile"),
            result.layers.iter().map(floors).collect::<Vec<_>>().join(", ")
        ),
    ];
    let picture = Picture {
        title: "who gets where",
        result: &counted(layers.len() as u64, "layer"),
        is_good: true,
        goals: &goals,
        nodes: &[],
        traps: &[],
        layers: &drawn,
        run: &Run::default(),
        notes: &notes,
        images,
    };
    picture_svg(program, world, &picture)
}
