//! What is known about an instance in the current frame of a history; see [`crate::why`].

use crate::ir::SlotId;
use crate::source::SourceMap;
use crate::why::{Inspected, Moment, inspect as inspected};

use super::history::History;

/// What is known about the instance of a slot in the current frame of a history.
pub(super) fn inspect(history: &History, sources: &SourceMap, slot: SlotId) -> Inspected {
    let step = history.last_step();
    let before = step.as_ref().map(|(state, input)| (&***state, input));
    inspected(&Moment { sim: history.sim(), sources, before, after: history.state(), taken: None }, slot)
}
