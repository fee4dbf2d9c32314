//! What happened in a step.

use hypedc::sim;
use hypedc::sim::Simulator;
use pyo3::prelude::*;

/// An event of a step.
#[pyclass(frozen, get_all, eq, module = "hyped")]
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// `edge`, `spawned`, `destroyed`, `entered`, `touched`, `parted`, `broken`, `restored`, `goal` or `never`.
    kind: &'static str,
    /// The instance; None of tiles, goals and `never`s.
    instance: Option<String>,
    /// The mode that an edge leads to, the space, the tag that is touched, the place of a tile, the goal or the `never`.
    what: Option<String>,
}

impl Event {
    /// An event of the library by names.
    pub(crate) fn new(sim: &Simulator, event: sim::Event) -> Event {
        let (world, program) = (sim.world(), sim.program());
        let name = |slot| Some(world.slots[slot].name.clone());
        let entity = |slot| &program.entities[world.slots[slot].entity];
        let tag = |slot, touch| Some(program.tags[entity(slot).touches[touch].other].clone());
        let tile = |tile| {
            let (space, column, row) = sim.place_of_tile(tile)?;
            Some(format!("{} {column} {row}", world.spaces[space].name))
        };
        let (kind, instance, what) = match event {
            sim::Event::Edge(slot, edge) => {
                let target = entity(slot).edges[edge].target.map(|mode| entity(slot).modes[mode].path.clone());
                ("edge", name(slot), target)
            }
            sim::Event::Spawned(slot) => ("spawned", name(slot), None),
            sim::Event::Destroyed(slot) => ("destroyed", name(slot), None),
            sim::Event::Entered(slot, space) => ("entered", name(slot), Some(world.spaces[space].name.clone())),
            sim::Event::Touched(slot, touch) => ("touched", name(slot), tag(slot, touch)),
            sim::Event::Parted(slot, touch) => ("parted", name(slot), tag(slot, touch)),
            sim::Event::Broken(id) => ("broken", None, tile(id)),
            sim::Event::Restored(id) => ("restored", None, tile(id)),
            sim::Event::Goal(goal) => ("goal", None, Some(world.goals[goal].name.clone())),
            sim::Event::Never(never) => ("never", None, Some(world.nevers[never].name.clone())),
        };
        Event { kind, instance, what }
    }
}

#[pymethods]
impl Event {
    fn __repr__(&self) -> String {
        let part = |name: &str, of: &Option<String>| of.as_ref().map_or(String::new(), |of| format!(", {name}={of:?}"));
        let (instance, what) = (part("instance", &self.instance), part("what", &self.what));
        format!("Event(kind={:?}{instance}{what})", self.kind)
    }
}
