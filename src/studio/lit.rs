//! Where the current frame is in the texts of the program: the modes that are active, and the guards that were tried. For
//! editors, which light them.

use serde::Serialize;

use crate::ir::SlotId;
use crate::why::{EdgeState, Place, place};

use super::inspect::inspect;
use super::session::Session;

/// The places of a frame.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Lit {
    /// The number of the frame.
    pub frame: u64,
    /// The active modes of all instances, outer ones included.
    pub modes: Vec<LitMode>,
    /// The edges of one instance that were considered in the step that led to the frame, with the values of their guards.
    pub edges: Vec<EdgeState>,
}

/// An active mode.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LitMode {
    /// The instance.
    pub instance: String,
    /// Its entity.
    pub entity: String,
    /// The path of the mode.
    pub mode: String,
    /// Its name in the text.
    pub place: Place,
}

impl Session {
    /// The places of the current frame, with the edges of the instance of a slot; that of the first player if none is given.
    /// `None` if nothing is played.
    pub fn lit(&self, slot: Option<u32>) -> Option<Lit> {
        let (program, sources, history) = self.played()?;
        let sim = history.sim();
        let world = sim.world();
        let first = || world.players.iter().next().map(|player| player.slot);
        let chosen = slot.map(SlotId).filter(|slot| world.slots.get(*slot).is_some()).or_else(first);
        let mut modes = Vec::new();
        for (id, of) in world.slots.pairs() {
            let instance = sim.instance(history.state(), id);
            if !instance.is_alive() {
                continue;
            }
            let (entity, spans) = (instance.entity(), &program.spans.entities[of.entity]);
            for mode in entity.modes.ids().filter(|mode| instance.is_in(*mode)) {
                let span = spans.modes[mode];
                // The only mode of an entity without modes is not in the text.
                if sources.holds(span) && span != spans.name {
                    let (instance, entity, mode) =
                        (of.name.clone(), entity.name.to_string(), entity.modes[mode].path.clone());
                    modes.push(LitMode { instance, entity, mode, place: place(sources, span) });
                }
            }
        }
        let edges = chosen.map_or_else(Vec::new, |slot| inspect(history, sources, slot).edges);
        Some(Lit { frame: history.at(), modes, edges })
    }
}
