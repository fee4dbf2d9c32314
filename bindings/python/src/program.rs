//! Compiled programs. A program keeps all texts that it was made of, so that it can be compiled again with further
//! questions, and sent to another process.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use hypedc::ask;
use hypedc::ask::{Loaded, find_world, open_world, program_sha256};
use hypedc::compile::{Asked, Changes, Compilation, ExtraConstraint, ExtraQuestion, LevelFile, NumberSetting};
use hypedc::compile::{check_with, compile_changed, question_name};
use hypedc::diagnostic::render;
use hypedc::ir::WorldId;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use serde::{Deserialize, Serialize};

use crate::error::{argument, compile_error, findings, question};
use crate::files::Texts;
use crate::watched::watched;
use crate::world::World;

/// What a program is made of.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Recipe {
    /// The main file.
    pub root: PathBuf,
    /// Texts by path.
    pub texts: BTreeMap<PathBuf, String>,
    /// The level of open worlds.
    pub level: Option<PathBuf>,
    /// Its legend.
    pub legend: Option<PathBuf>,
    /// Width and height of its tiles, px.
    pub tile: Option<(f64, f64)>,
    /// Numbers that are set, each with its value as text.
    pub numbers: Vec<(String, String)>,
    /// The questions that were added.
    pub questions: Questions,
}

/// Questions that are added to a program.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Questions {
    /// The world; none: all.
    pub world: Option<String>,
    /// Goals, as names or predicates.
    pub goals: Vec<String>,
    /// `never`s, as names or predicates: they end no run.
    pub nevers: Vec<String>,
    /// A predicate that never holds on a path.
    pub without: Option<String>,
}

/// The origin of `never`s that are questions, in findings.
pub(crate) const NEVERS: &str = "<nevers>";
/// The origin of [`Questions::without`] in findings.
const WITHOUT: &str = "<without>";

impl Recipe {
    /// The same with another level.
    fn with_level(&self, level: PathBuf, text: Option<String>) -> Recipe {
        let mut recipe = Recipe { level: Some(level.clone()), ..self.clone() };
        if let Some(text) = text {
            recipe.texts.insert(level, text);
        }
        recipe
    }

    /// Compiles it; `checks` adds the warnings of the analysis.
    pub fn compiled(&self, checks: bool) -> Compilation {
        let files = Texts(self.texts.clone());
        let level = LevelFile { map: self.level.as_deref(), legend: self.legend.as_deref(), tile: self.tile };
        if checks {
            return check_with(&self.root, level, &files);
        }
        let Questions { world, goals, nevers, without } = &self.questions;
        let world = world.as_deref();
        let question = |asked, origin| move |text: &'_ String| (asked, origin, text.clone());
        let all: Vec<(Asked, &str, String)> = goals
            .iter()
            .map(question(Asked::Goal, "<goals>"))
            .chain(nevers.iter().map(question(Asked::Never, NEVERS)))
            .collect();
        let questions: Vec<ExtraQuestion<'_>> =
            all.iter().map(|(asked, origin, text)| ExtraQuestion { asked: *asked, world, text, origin }).collect();
        let constraint = without.as_deref().map(|predicate| ExtraConstraint {
            world,
            name: ask::WITHOUT,
            predicate,
            origin: WITHOUT,
        });
        let numbers: Vec<NumberSetting<'_>> =
            self.numbers.iter().map(|(path, value)| NumberSetting { path, value }).collect();
        compile_changed(&self.root, level, &Changes { questions: &questions, constraint, numbers: &numbers }, &files)
    }
}

/// A compiled program.
#[pyclass(frozen, module = "hyped", weakref)]
pub struct Program {
    pub(crate) loaded: Arc<Loaded>,
    pub(crate) recipe: Arc<Recipe>,
    warnings: (String, String),
}

impl Program {
    /// Compiles a recipe, and keeps the texts that were read.
    pub(crate) fn new(py: Python<'_>, mut recipe: Recipe) -> PyResult<Program> {
        let (compilation, recipe) = watched(py, None, move |_| {
            let compilation = recipe.compiled(false);
            for (_, file) in compilation.sources.iter() {
                let is_file = !file.path.to_string_lossy().starts_with(['<', '-']);
                if is_file {
                    recipe.texts.entry(file.path.clone()).or_insert_with(|| file.text().to_string());
                }
            }
            (compilation, recipe)
        })?;
        let Compilation { sources, program, diagnostics, .. } = compilation;
        let Some(program) = program else { return Err(compile_error(&sources, &diagnostics)) };
        let warnings = (render::human(&sources, diagnostics.iter(), false), findings(&sources, &diagnostics));
        Ok(Program { loaded: Arc::new(Loaded { sources, program }), recipe: Arc::new(recipe), warnings })
    }

    /// The same program with further questions.
    pub(crate) fn asking(&self, py: Python<'_>, questions: Questions) -> PyResult<Program> {
        Program::new(py, Recipe { questions, ..(*self.recipe).clone() })
    }

    /// A world by name, or the only one.
    pub(crate) fn world_id(&self, name: Option<&str>) -> PyResult<WorldId> {
        let program = &self.loaded.program;
        let id = find_world(program, &self.recipe.root, name).map_err(question)?;
        match open_world(&program.worlds[id]) {
            Some(why) => Err(question(why)),
            None => Ok(id),
        }
    }
}

#[pymethods]
impl Program {
    /// The path of the main file, `<text>` if it was given as text.
    #[getter]
    fn path(&self) -> String {
        self.recipe.root.display().to_string()
    }

    /// The names of the worlds.
    #[getter]
    fn worlds(&self) -> Vec<String> {
        self.loaded.program.worlds.iter().map(|world| world.name.clone()).collect()
    }

    /// The names of the entities.
    #[getter]
    fn entities(&self) -> Vec<String> {
        self.loaded.program.entities.iter().map(|entity| entity.name.to_string()).collect()
    }

    /// A hash of what the program means, in hexadecimal digits.
    #[getter]
    fn sha256(&self) -> String {
        program_sha256(&self.loaded.program)
    }

    /// The warnings of the compiler as text, as on the terminal.
    #[getter]
    fn warnings(&self) -> &str {
        &self.warnings.0
    }

    /// The warnings as JSON.
    #[getter]
    fn _findings(&self) -> &str {
        &self.warnings.1
    }

    /// All findings of `hypedc check`, with those of the analysis, as text and as JSON.
    fn _check(&self, py: Python<'_>) -> PyResult<(String, String)> {
        let recipe = Arc::clone(&self.recipe);
        let checked = watched(py, None, move |_| recipe.compiled(true))?;
        let text = render::human(&checked.sources, checked.diagnostics.iter(), false);
        Ok((text, findings(&checked.sources, &checked.diagnostics)))
    }

    /// world(name=None)
    /// --
    ///
    /// A world by name, or the only one.
    #[pyo3(signature = (name = None))]
    fn world(slf: &Bound<'_, Self>, name: Option<&str>) -> PyResult<World> {
        let id = slf.get().world_id(name)?;
        Ok(World::new(slf.clone().unbind(), &slf.get().loaded, id))
    }

    /// The same program with another level: its path, and its text if it is not on the disk.
    #[pyo3(signature = (level, text = None))]
    fn _with_level(&self, py: Python<'_>, level: PathBuf, text: Option<String>) -> PyResult<Program> {
        Program::new(py, self.recipe.with_level(level, text))
    }

    /// The same program with further numbers set.
    fn _with_numbers(&self, py: Python<'_>, numbers: Vec<(String, String)>) -> PyResult<Program> {
        let numbers = self.recipe.numbers.iter().cloned().chain(numbers).collect();
        Program::new(py, Recipe { numbers, ..(*self.recipe).clone() })
    }

    /// The recipe, for `_rebuilt`.
    fn _recipe(&self) -> PyResult<String> {
        serde_json::to_string(&*self.recipe).map_err(|error| argument(error.to_string()))
    }

    /// The same program with goals and `never`s in addition, by predicates.
    #[pyo3(signature = (goals, nevers, without = None, world = None))]
    fn _asking(
        &self,
        py: Python<'_>,
        goals: Vec<String>,
        nevers: Vec<String>,
        without: Option<String>,
        world: Option<String>,
    ) -> PyResult<Program> {
        self.asking(py, Questions { world, goals, nevers, without })
    }

    fn __repr__(&self) -> String {
        format!("<hyped.Program {:?}, worlds {}>", self.path(), self.worlds().join(", "))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let rebuild = py.import("hyped._hyped")?.getattr("_rebuilt")?;
        Ok((rebuild, PyTuple::new(py, [self._recipe()?])?))
    }
}

/// Compiles a program from a path or from texts.
#[pyfunction]
#[pyo3(name = "_compile", signature = (root, texts, level, legend, tile, numbers))]
pub fn compile(
    py: Python<'_>,
    root: PathBuf,
    texts: BTreeMap<PathBuf, String>,
    level: Option<PathBuf>,
    legend: Option<PathBuf>,
    tile: Option<(f64, f64)>,
    numbers: Vec<(String, String)>,
) -> PyResult<Program> {
    if tile.is_some_and(|(width, height)| !(width > 0.0 && height > 0.0 && width.is_finite() && height.is_finite())) {
        return Err(argument("`tile` is the width and the height of a tile in px: two numbers above 0"));
    }
    Program::new(py, Recipe { root, texts, level, legend, tile, numbers, questions: Questions::default() })
}

/// A program that was pickled, perhaps with another level.
#[pyfunction]
#[pyo3(name = "_rebuilt", signature = (recipe, level = None, text = None))]
pub fn rebuilt(py: Python<'_>, recipe: &str, level: Option<PathBuf>, text: Option<String>) -> PyResult<Program> {
    let recipe: Recipe =
        serde_json::from_str(recipe).map_err(|error| argument(format!("not a pickled program: {error}")))?;
    Program::new(
        py,
        match level {
            Some(level) => recipe.with_level(level, text),
            None => recipe,
        },
    )
}

/// The name under which a question is asked: a name as it is, a predicate on one line.
#[pyfunction]
#[pyo3(name = "_question_name")]
pub fn named(text: &str) -> String {
    question_name(text)
}
