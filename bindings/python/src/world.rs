//! What there is in a world: names, controls, tiles.

use std::sync::Arc;

use hypedc::ask::Loaded;
use hypedc::ir::{Origin, WorldId};
use hypedc::sim::Simulator;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use crate::error::{argument, question};
use crate::picture;
use crate::program::Program;

/// A world of a program.
#[pyclass(frozen, module = "hyped")]
pub struct World {
    program: Py<Program>,
    loaded: Arc<Loaded>,
    id: WorldId,
}

impl World {
    pub(crate) fn new(program: Py<Program>, loaded: &Arc<Loaded>, id: WorldId) -> World {
        World { program, loaded: Arc::clone(loaded), id }
    }

    fn table(&self) -> &hypedc::ir::World {
        &self.loaded.program.worlds[self.id]
    }
}

#[pymethods]
impl World {
    /// The program.
    #[getter]
    fn program(&self, py: Python<'_>) -> Py<Program> {
        self.program.clone_ref(py)
    }

    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.table().name
    }

    /// The length of a step, s.
    #[getter]
    fn step(&self) -> f64 {
        self.table().step.seconds()
    }

    /// The names of its spaces.
    #[getter]
    fn spaces(&self) -> Vec<&str> {
        self.table().spaces.iter().map(|space| space.name.as_str()).collect()
    }

    /// The names of the instances that are placed.
    #[getter]
    fn instances(&self) -> Vec<&str> {
        let placed = self.table().slots.iter().filter(|slot| slot.origin != Origin::Free);
        placed.map(|slot| slot.name.as_str()).collect()
    }

    /// The names of its goals.
    #[getter]
    fn goals(&self) -> Vec<&str> {
        self.table().goals.iter().map(|goal| goal.name.as_str()).collect()
    }

    /// The names of its `never`s.
    #[getter]
    fn nevers(&self) -> Vec<&str> {
        self.table().nevers.iter().map(|never| never.name.as_str()).collect()
    }

    /// The number of each player, with the instance that it controls.
    #[getter]
    fn players(&self) -> Vec<(u32, &str)> {
        let table = self.table();
        table.players.iter().map(|player| (player.number, table.slots[player.slot].name.as_str())).collect()
    }

    /// The buttons of a player, in the order of an action.
    #[pyo3(signature = (player = None))]
    fn buttons(&self, player: Option<u32>) -> PyResult<Vec<String>> {
        Ok(self.entity(player)?.buttons.iter().cloned().collect())
    }

    /// The axes of a player, in the order of an action, after its buttons.
    #[pyo3(signature = (player = None))]
    fn axes(&self, player: Option<u32>) -> PyResult<Vec<String>> {
        Ok(self.entity(player)?.axes.iter().cloned().collect())
    }

    /// All names of parts of a state, but those of the form `hero in air`.
    #[getter]
    fn names(&self) -> Vec<String> {
        Simulator::new(&self.loaded.program, self.id).names()
    }

    /// The words that the numbers of a part stand for, in order; None if they are numbers.
    fn words(&self, name: &str) -> PyResult<Option<Vec<String>>> {
        let sim = Simulator::new(&self.loaded.program, self.id);
        Ok(sim.words(sim.named(name).map_err(question)?))
    }

    /// The characters of the tiles of a space, the first by default: shape (rows, columns), rows from the top.
    #[pyo3(signature = (space = None))]
    fn tiles<'py>(&self, py: Python<'py>, space: Option<&str>) -> PyResult<Bound<'py, PyAny>> {
        let table = self.table();
        let of = match space {
            Some(name) => table.space_named(name),
            None => table.spaces.ids().next(),
        };
        let of = of.ok_or_else(|| {
            let list: Vec<String> = table.spaces.iter().map(|space| format!("`{}`", space.name)).collect();
            argument(format!("no space `{}` in `{}`; there is {}", space.unwrap_or(""), table.name, list.join(", ")))
        })?;
        let (rows, columns, cells) = match &table.spaces[of].map {
            None => (0, 0, Vec::new()),
            Some(map) => {
                let symbol = |kind: &u16| map.kinds.get(usize::from(*kind)).map_or(0, |kind| u32::from(kind.symbol));
                let rows = map.cells.chunks(map.columns.max(1)).rev();
                (map.rows, map.columns, rows.flatten().map(symbol).collect())
            }
        };
        // An array of code points of four bytes is one of texts of one character.
        PyArray1::from_vec(py, cells).reshape([rows, columns])?.call_method1("view", ("U1",))
    }

    /// The picture of the level, as SVG.
    fn _repr_svg_(&self, py: Python<'_>) -> PyResult<String> {
        picture::of_run(py, &self.loaded, self.id, "", None)
    }

    /// The picture of a run of an input script, as SVG.
    #[pyo3(signature = (inputs = "", chance = None))]
    fn svg(&self, py: Python<'_>, inputs: &str, chance: Option<u64>) -> PyResult<String> {
        picture::of_run(py, &self.loaded, self.id, inputs, chance)
    }

    fn __repr__(&self) -> String {
        format!("<hyped.World {}>", self.name())
    }
}

impl World {
    /// The entity of a player by number, or of the first one.
    fn entity(&self, player: Option<u32>) -> PyResult<&hypedc::ir::Entity> {
        let table = self.table();
        let found = match player {
            Some(number) => table.players.iter().find(|player| player.number == number),
            None => table.players.iter().min_by_key(|player| player.number),
        };
        let found = found.ok_or_else(|| {
            let list: Vec<String> = table.players.iter().map(|player| player.number.to_string()).collect();
            let which = player.map_or_else(String::new, |number| format!(" {number}"));
            argument(format!("no player{which} in `{}`; there is {}", table.name, list.join(", ")))
        })?;
        Ok(&self.loaded.program.entities[table.slots[found.slot].entity])
    }
}
