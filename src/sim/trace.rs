//! Traces: a header with everything that the run depends on, then a line per step; step 0 is the initial state. The
//! format is JSON lines, or CSV (RFC 4180) with the header as a comment above the columns.

use std::io::{self, Write};

use serde::Deserialize;
use serde::ser::{Serialize, SerializeMap, Serializer};

use crate::ir::{Domain, SlotId};
use crate::json::{self, Layout};
use crate::ordered::Ordered;
use crate::tabular::csv;

use super::input::Input;
use super::script::names;
use super::simulator::Simulator;

/// The version of the trace format.
pub const TRACE_VERSION: u32 = 2;

/// The prefix of the header in CSV.
const COMMENT: &str = "# ";

/// The format of a trace.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TraceFormat {
    /// A JSON object a line.
    Jsonl,
    /// A row a line, with the same columns in all traces of a program.
    Csv,
}

/// What a run depends on: with the files it can be run again.
#[derive(Debug, Clone, PartialEq, serde::Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct TraceHeader {
    /// [`TRACE_VERSION`].
    pub trace: u32,
    /// The version of `hypedc`.
    pub hypedc: String,
    /// The path of the program as it was given.
    pub file: String,
    /// Of the flat program, in hexadecimal digits; with the level, if there is one.
    pub program_sha256: String,
    /// The path of the level as it was given; none if the program has its map in it.
    pub level: Option<String>,
    /// Of the level's bytes, in hexadecimal digits.
    pub level_sha256: Option<String>,
    /// The path of the legend that the level is read with, if it is not the program's.
    pub legend: Option<String>,
    /// Width and height of a tile of the level, px, if it is not the program's.
    pub tile: Option<(f64, f64)>,
    /// The numbers of the program that were set, such as `Hero.jump_speed=310`; left out if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<String>,
    /// The world.
    pub world: String,
    /// How long a step is, as a fraction of a second.
    pub step: String,
    /// The script of the whole input.
    pub inputs: String,
    /// The seed of what nature drew where the script leaves it open; left out in a world without chances.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chance: Option<u64>,
    /// How many steps were run, with no input after the script's end.
    pub steps: u64,
}

impl TraceHeader {
    /// Reads the first line of a trace; also returns the format.
    ///
    /// # Errors
    /// Why it is no header.
    pub fn read(line: &str) -> Result<(TraceHeader, TraceFormat), String> {
        let (json, format) = match line.strip_prefix(COMMENT) {
            Some(json) => (json, TraceFormat::Csv),
            None => (line, TraceFormat::Jsonl),
        };
        let version = serde_json::from_str::<serde_json::Value>(json).map_err(|error| error.to_string())?;
        match version.get("trace").and_then(serde_json::Value::as_u64) {
            Some(version) if version == u64::from(TRACE_VERSION) => {}
            Some(version) => return Err(format!("a trace of version {version}, this `hypedc` has {TRACE_VERSION}")),
            None => return Err("no header of a trace".to_string()),
        }
        serde_json::from_value(version).map(|header| (header, format)).map_err(|error| error.to_string())
    }
}

/// Formats the lines of a trace.
pub struct TraceLines<'s> {
    sim: &'s Simulator,
    format: TraceFormat,
}

/// A state in a trace.
#[derive(serde::Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct Line<'a> {
    /// The step; 0 is the initial state.
    step: u64,
    /// What is held in this step, and what nature drew of what the step has read.
    inputs: Vec<String>,
    /// The instances that exist, by name.
    #[cfg_attr(feature = "testing", schemars(with = "std::collections::BTreeMap<String, InstanceSchema>"))]
    instances: Instances<'a>,
    /// The tiles that are broken, by space, then row, then column.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "testing", schemars(default))]
    broken: Vec<BrokenTile<'a>>,
    /// The goals that hold.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "testing", schemars(default))]
    goals: Vec<&'a str>,
    /// Each `never` that holds.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "testing", schemars(default))]
    never: Vec<&'a str>,
}

/// A broken tile in a state; column 0 is the leftmost, row 0 the lowest.
#[derive(serde::Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
struct BrokenTile<'a> {
    /// The space.
    space: &'a str,
    /// The column in its map.
    column: usize,
    /// The row in its map.
    row: usize,
}

/// An instance in a state. Beside these fields it has one for each variable: a continuous variable is its position,
/// velocity and acceleration, a discrete one its value, a reference a name or null.
#[cfg(feature = "testing")]
#[derive(schemars::JsonSchema)]
#[allow(dead_code, reason = "it describes what `Instance` writes")]
struct InstanceSchema {
    /// The entity.
    entity: String,
    /// The space.
    space: String,
    /// The active innermost mode of each group.
    modes: Vec<String>,
    /// The times in modes whose `timer` is read, s.
    timers: Option<std::collections::BTreeMap<String, f64>>,
    #[serde(flatten)]
    variables: std::collections::BTreeMap<String, VariableSchema>,
}

/// A value of a variable.
#[cfg(feature = "testing")]
#[derive(schemars::JsonSchema)]
#[schemars(untagged)]
#[allow(dead_code, reason = "it describes what `Instance` writes")]
enum VariableSchema {
    /// Position, velocity, acceleration.
    Continuous([f64; 3]),
    /// A whole number.
    Int(i32),
    /// A truth value.
    Bool(bool),
    /// A value of a set, or the instance that a reference refers to.
    Name(Option<String>),
}

/// The schemas of the lines of a trace as JSON lines: the header, and a state.
#[cfg(feature = "testing")]
pub(crate) fn trace_schemas() -> [schemars::Schema; 2] {
    [schemars::schema_for!(TraceHeader), schemars::schema_for!(Line<'_>)]
}

impl<'s> TraceLines<'s> {
    /// Formats the runs of a world.
    pub fn new(sim: &'s Simulator, format: TraceFormat) -> Self {
        TraceLines { sim, format }
    }

    /// The lines before all states, each with its line end: the header, and in CSV the names of the columns.
    ///
    /// Infallible: writes to memory.
    pub fn header(&self, header: &TraceHeader) -> io::Result<String> {
        let json = json::text(header, Layout::Compact)?;
        Ok(match self.format {
            TraceFormat::Jsonl => format!("{json}\n"),
            TraceFormat::Csv => format!("{COMMENT}{json}\n{}\n", csv::line(self.columns())),
        })
    }

    /// The line of a state, with its line end.
    ///
    /// Infallible: writes to memory.
    pub fn state(&self, step: u64, input: &Input, state: &[u8]) -> io::Result<String> {
        let inputs = names(self.sim.program(), self.sim.world_id(), input);
        if self.format == TraceFormat::Csv {
            return Ok(format!("{}\n", csv::line(self.cells(step, &inputs, state))));
        }
        let world = self.sim.world();
        let holds = |expr| self.sim.holds(state, expr).unwrap_or(false);
        let is_running = self.sim.left_bounds(state).is_none();
        let line = Line {
            step,
            inputs,
            instances: Instances { sim: self.sim, state },
            broken: self.broken(state),
            goals: world.goals.iter().filter(|g| is_running && holds(g.holds)).map(|g| g.name.as_str()).collect(),
            never: world.nevers.iter().filter(|n| holds(n.holds)).map(|n| n.name.as_str()).collect(),
        };
        Ok(format!("{}\n", json::text(&line, Layout::Compact)?))
    }

    /// The broken tiles of a state.
    fn broken(&self, state: &[u8]) -> Vec<BrokenTile<'s>> {
        let tiles = self.sim.broken_tiles(state).into_iter();
        let mut places: Vec<_> = tiles.filter_map(|tile| self.sim.place_of_tile(tile)).collect();
        places.order_by_key(|(space, column, row)| (*space, *row, *column));
        let spaces = &self.sim.world().spaces;
        let named = |(space, column, row)| BrokenTile { space: &spaces[space].name, column, row };
        places.into_iter().map(named).collect()
    }

    /// The names of the columns: the step and its inputs, all possible instances, broken tiles if any can break, goals and
    /// `never`s.
    pub fn columns(&self) -> Vec<String> {
        let world = self.sim.world();
        let mut columns = vec!["step".to_string(), "inputs".to_string()];
        for (id, slot) in world.slots.pairs() {
            let entity = self.sim.entity(id);
            let mut add = |name: &str| columns.push(format!("{}.{name}", slot.name));
            add("space");
            for group in entity.groups.iter() {
                add(&group.name.as_ref().map_or("mode".to_string(), |name| format!("mode.{name}")));
            }
            for name in entity.vars.iter() {
                ["", "'", "''"].into_iter().for_each(|degree| add(&format!("{name}{degree}")));
            }
            entity.discretes.iter().for_each(|discrete| add(&discrete.name));
            entity.refs.iter().for_each(|reference| add(&reference.name));
            entity.timers.iter().for_each(|timer| add(&format!("timer.{}", entity.modes[timer.mode].path)));
        }
        columns.extend(world.layout.tiles.as_ref().map(|_| "broken".to_string()));
        columns.extend(world.goals.iter().map(|goal| format!("goal.{}", goal.name)));
        columns.extend(world.nevers.iter().map(|never| format!("never.{}", never.name)));
        columns
    }

    /// The cells of a state for [`TraceLines::columns`]; empty for an absent instance.
    fn cells(&self, step: u64, inputs: &[String], state: &[u8]) -> Vec<String> {
        let world = self.sim.world();
        let mut cells = vec![step.to_string(), inputs.join("+")];
        for id in world.slots.ids() {
            let (entity, layout) = (self.sim.entity(id), &world.layout.slots[id]);
            if !layout.alive(state) {
                let numbers = entity.groups.len() + 3 * entity.vars.len() + entity.discretes.len();
                let count = 1 + numbers + entity.refs.len() + entity.timers.len();
                cells.extend(std::iter::repeat_n(String::new(), count));
                continue;
            }
            cells.push(world.spaces[layout.space(state)].name.clone());
            let path = |g| entity.modes[entity.leaves[layout.leaf(state, g)].mode].path.clone();
            cells.extend(entity.groups.ids().map(path));
            for var in entity.vars.ids() {
                cells.extend([0, 1, 2].map(|degree| layout.var(state, var, degree).to_string()));
            }
            for (id, discrete) in entity.discretes.pairs() {
                cells.push(discrete.domain.text(layout.discrete(state, id)));
            }
            let target = |r| layout.reference(state, r).map_or(String::new(), |t| world.slots[t].name.clone());
            cells.extend(entity.refs.ids().map(target));
            cells.extend(entity.timers.ids().map(|t| world.step.times(layout.timer(state, t)).to_string()));
        }
        if world.layout.tiles.is_some() {
            let tiles = self.broken(state).into_iter().map(|t| format!("{}:{}:{}", t.space, t.column, t.row));
            cells.push(tiles.collect::<Vec<_>>().join(" "));
        }
        let holds = |expr| self.sim.holds(state, expr).unwrap_or(false);
        let is_running = self.sim.left_bounds(state).is_none();
        cells.extend(world.goals.iter().map(|goal| (is_running && holds(goal.holds)).to_string()));
        cells.extend(world.nevers.iter().map(|never| holds(never.holds).to_string()));
        cells
    }
}

/// Writes the states of a run.
pub struct TraceWriter<'s, W> {
    lines: TraceLines<'s>,
    out: W,
}

impl<'s, W: Write> TraceWriter<'s, W> {
    /// Starts a trace with its header.
    ///
    /// The error of the writer.
    pub fn new(lines: TraceLines<'s>, mut out: W, header: &TraceHeader) -> io::Result<Self> {
        out.write_all(lines.header(header)?.as_bytes())?;
        Ok(TraceWriter { lines, out })
    }

    /// Writes one state.
    ///
    /// The error of the writer.
    pub fn state(&mut self, step: u64, input: &Input, state: &[u8]) -> io::Result<()> {
        self.out.write_all(self.lines.state(step, input, state)?.as_bytes())
    }

    /// Flushes the trace.
    ///
    /// The error of the writer.
    pub fn finish(mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// The first difference between two lines of traces, with both values; the whole lines if they have no common form.
pub fn first_difference(format: TraceFormat, columns: &[String], old: &str, new: &str) -> (String, String, String) {
    let parsed = |text: &str| serde_json::from_str::<serde_json::Value>(text);
    match (format, parsed(old), parsed(new)) {
        (TraceFormat::Jsonl, Ok(old), Ok(new)) => {
            let (path, old, new) = difference(String::new(), &old, &new);
            (path.trim_start_matches('.').to_string(), old, new)
        }
        (TraceFormat::Csv, ..) => {
            let (old, new) = (csv::cells(old), csv::cells(new));
            let cell = |cells: &[String], at: usize| cells.get(at).cloned().unwrap_or_default();
            let differs = (0..old.len().max(new.len())).find(|at| cell(&old, *at) != cell(&new, *at));
            let at = differs.unwrap_or(old.len());
            let column = columns.get(at).cloned().unwrap_or_else(|| format!("column {}", at + 1));
            (column, cell(&old, at), cell(&new, at))
        }
        _ => ("the line".to_string(), old.to_string(), new.to_string()),
    }
}

/// The first difference between two values.
fn difference(path: String, old: &serde_json::Value, new: &serde_json::Value) -> (String, String, String) {
    use serde_json::Value::{Array, Object};
    let nothing = serde_json::Value::Null;
    match (old, new) {
        (Object(a), Object(b)) => {
            let keys = a.keys().chain(b.keys().filter(|key| !a.contains_key(*key)));
            let mut differing = keys.filter(|key| a.get(*key) != b.get(*key));
            if let Some(key) = differing.next() {
                let value = |map: &serde_json::Map<_, _>| map.get(key).cloned().unwrap_or(nothing.clone());
                return difference(format!("{path}.{key}"), &value(a), &value(b));
            }
        }
        (Array(a), Array(b)) => {
            if let Some(at) = (0..a.len().max(b.len())).find(|at| a.get(*at) != b.get(*at)) {
                let value = |list: &[serde_json::Value]| list.get(at).cloned().unwrap_or(nothing.clone());
                return difference(format!("{path}[{at}]"), &value(a), &value(b));
            }
        }
        _ => {}
    }
    (path, old.to_string(), new.to_string())
}

struct Instances<'a> {
    sim: &'a Simulator,
    state: &'a [u8],
}

impl Serialize for Instances<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let world = self.sim.world();
        let mut map = serializer.serialize_map(None)?;
        for (id, slot) in world.slots.pairs() {
            if world.layout.slots[id].alive(self.state) {
                map.serialize_entry(&slot.name, &Instance { sim: self.sim, state: self.state, slot: id })?;
            }
        }
        map.end()
    }
}

struct Instance<'a> {
    sim: &'a Simulator,
    state: &'a [u8],
    slot: SlotId,
}

impl Serialize for Instance<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let world = self.sim.world();
        let entity = self.sim.entity(self.slot);
        let layout = &world.layout.slots[self.slot];
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("entity", &entity.name)?;
        map.serialize_entry("space", &world.spaces[layout.space(self.state)].name)?;
        let modes: Vec<&str> = entity
            .groups
            .ids()
            .map(|g| entity.modes[entity.leaves[layout.leaf(self.state, g)].mode].path.as_str())
            .collect();
        map.serialize_entry("modes", &modes)?;
        for (var, name) in entity.vars.pairs() {
            map.serialize_entry(name, &[0, 1, 2].map(|degree| layout.var(self.state, var, degree)))?;
        }
        for (id, discrete) in entity.discretes.pairs() {
            let value = layout.discrete(self.state, id);
            match &discrete.domain {
                Domain::Int => map.serialize_entry(&discrete.name, &value)?,
                Domain::Bool => map.serialize_entry(&discrete.name, &(value != 0))?,
                Domain::Set(names) => {
                    let name = usize::try_from(value).ok().and_then(|v| names.get(v));
                    map.serialize_entry(&discrete.name, &name)?;
                }
            }
        }
        for (id, reference) in entity.refs.pairs() {
            let target = layout.reference(self.state, id).map(|t| &world.slots[t].name);
            map.serialize_entry(&reference.name, &target)?;
        }
        if !entity.timers.is_empty() {
            let timers: std::collections::BTreeMap<&str, f64> = entity
                .timers
                .pairs()
                .map(|(id, t)| (entity.modes[t.mode].path.as_str(), world.step.times(layout.timer(self.state, id))))
                .collect();
            map.serialize_entry("timers", &timers)?;
        }
        map.end()
    }
}
