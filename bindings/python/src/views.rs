//! What is observed: parts of a state by name, planes around a player.

use hypedc::batch;
use hypedc::batch::{PlaneChoice, View};
use hypedc::sim::Simulator;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

use crate::error::{argument, question};

/// Maximum number of observations of a batch, and of cells of a window.
pub(crate) const MAX_VIEWS: usize = 4;
const MAX_CELLS: usize = 1 << 20;

/// An observation: parts of a state by name.
#[pyclass(frozen, get_all, module = "hyped")]
pub struct Variables {
    /// The names.
    names: Vec<String>,
}

#[pymethods]
impl Variables {
    #[new]
    fn new(names: Vec<String>) -> Variables {
        Variables { names }
    }

    fn __repr__(&self) -> String {
        format!("Variables({:?})", self.names)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyAny>, (Vec<String>,)) {
        (slf.get_type().into_any(), (slf.get().names.clone(),))
    }
}

/// An observation: a window of tiles and instances around a player.
#[pyclass(frozen, get_all, module = "hyped")]
pub struct Planes {
    /// Number of columns of the window.
    columns: usize,
    /// Number of its rows.
    rows: usize,
    /// The tags that have a plane; None: those of all tiles and free-standing geometry.
    tags: Option<Vec<String>>,
    /// The entities that have a plane; None: all.
    entities: Option<Vec<String>>,
    /// The player in its middle; None: the first one.
    player: Option<u32>,
}

/// What makes [`Planes`] again.
type PlaneParts = (usize, usize, Option<Vec<String>>, Option<Vec<String>>, Option<u32>);

#[pymethods]
impl Planes {
    #[new]
    #[pyo3(signature = (columns, rows, tags = None, entities = None, player = None))]
    fn new(
        columns: usize,
        rows: usize,
        tags: Option<Vec<String>>,
        entities: Option<Vec<String>>,
        player: Option<u32>,
    ) -> PyResult<Planes> {
        match columns.checked_mul(rows) {
            Some(1..=MAX_CELLS) => Ok(Planes { columns, rows, tags, entities, player }),
            _ => Err(argument(format!("a window has 1 to {MAX_CELLS} cells, not {columns} x {rows}"))),
        }
    }

    fn __repr__(&self) -> String {
        format!("Planes({}, {})", self.columns, self.rows)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyAny>, PlaneParts) {
        let of = slf.get();
        (slf.get_type().into_any(), (of.columns, of.rows, of.tags.clone(), of.entities.clone(), of.player))
    }
}

/// The observations of a batch: none, one, or several.
pub(crate) fn views(sim: &Simulator, given: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<View>> {
    let Some(given) = given.filter(|given| !given.is_none()) else { return Ok(Vec::new()) };
    let all: Vec<Bound<'_, PyAny>> = match (given.cast::<PyList>(), given.cast::<PyTuple>()) {
        (Ok(list), _) => list.iter().collect(),
        (_, Ok(tuple)) => tuple.iter().collect(),
        _ => vec![given.clone()],
    };
    if all.len() > MAX_VIEWS {
        return Err(argument(format!("a batch has at most {MAX_VIEWS} observations, not {}", all.len())));
    }
    all.iter().map(|of| view(sim, of)).collect()
}

fn view(sim: &Simulator, of: &Bound<'_, PyAny>) -> PyResult<View> {
    if let Ok(of) = of.cast::<Variables>() {
        return batch::Variables::new(sim, &of.get().names).map(View::Variables).map_err(question);
    }
    if let Ok(of) = of.cast::<Planes>() {
        let Planes { columns, rows, tags, entities, player } = of.get();
        let choice =
            PlaneChoice { player: *player, size: (*columns, *rows), tags: tags.clone(), entities: entities.clone() };
        return batch::Planes::new(sim, &choice).map(View::Planes).map_err(question);
    }
    let name = of.get_type().name()?;
    Err(PyTypeError::new_err(format!("`observe` is a Variables or a Planes, or a list of them, not {name}")))
}
