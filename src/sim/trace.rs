//! Traces: a header line, then one line of JSON for each step; step 0 is the initial state.

use std::io::{self, Write};

use serde::ser::{Serialize, SerializeMap, Serializer};

use crate::ir::{Domain, SlotId};

use super::input::Input;
use super::script::names;
use super::simulator::Simulator;

/// The version of the trace format.
pub const TRACE_VERSION: u32 = 1;

/// Writes the states of a run as JSON lines.
pub struct TraceWriter<'s, W> {
    sim: &'s Simulator<'s>,
    out: W,
}

#[derive(serde::Serialize)]
struct Header<'a> {
    trace: u32,
    hypedc: &'a str,
    file: &'a str,
    world: &'a str,
    step: String,
    inputs: &'a str,
    steps: u64,
}

#[derive(serde::Serialize)]
struct Line<'a> {
    step: u64,
    inputs: Vec<String>,
    instances: Instances<'a>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    goals: Vec<&'a str>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    never: Vec<&'a str>,
}

impl<'s, W: Write> TraceWriter<'s, W> {
    /// Starts a trace with its header; `script` is the text of the whole input, of which `steps` steps are run (with no
    /// input after its end).
    ///
    /// # Errors
    /// What the writer says.
    pub fn new(sim: &'s Simulator<'s>, mut out: W, file: &str, script: &str, steps: u64) -> io::Result<Self> {
        let step = sim.world().step;
        let header = Header {
            trace: TRACE_VERSION,
            hypedc: env!("CARGO_PKG_VERSION"),
            file,
            world: &sim.world().name,
            step: format!("{}/{}", step.numerator, step.denominator),
            inputs: script,
            steps,
        };
        serde_json::to_writer(&mut out, &header)?;
        out.write_all(b"\n")?;
        Ok(TraceWriter { sim, out })
    }

    /// Writes one state.
    ///
    /// # Errors
    /// What the writer says.
    pub fn state(&mut self, step: u64, input: &Input, state: &[u8]) -> io::Result<()> {
        let world = self.sim.world();
        let holds = |expr| self.sim.holds(state, expr).unwrap_or(false);
        let line = Line {
            step,
            inputs: names(self.sim.program(), self.sim.world_id(), input),
            instances: Instances { sim: self.sim, state },
            goals: world.goals.iter().filter(|g| holds(g.holds)).map(|g| g.name.as_str()).collect(),
            never: world.nevers.iter().filter(|n| holds(n.holds)).map(|n| n.name.as_str()).collect(),
        };
        serde_json::to_writer(&mut self.out, &line)?;
        self.out.write_all(b"\n")
    }

    /// Flushes the trace.
    ///
    /// # Errors
    /// What the writer says.
    pub fn finish(mut self) -> io::Result<()> {
        self.out.flush()
    }
}

struct Instances<'a> {
    sim: &'a Simulator<'a>,
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
    sim: &'a Simulator<'a>,
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
