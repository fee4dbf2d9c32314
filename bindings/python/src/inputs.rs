//! Inputs of a step from Python: scripts, mappings from names to numbers, arrays.

use std::sync::Arc;

use hypedc::ask::Loaded;
use hypedc::diagnostic::catalogue::run::NoQuestion;
use hypedc::diagnostic::similar;
use hypedc::ir::WorldId;
use hypedc::sim::{Input, Script, Simulator, parse_script};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::error::{argument, question, questions};

/// Reads an input script.
pub(crate) fn script(loaded: &Arc<Loaded>, world: WorldId, text: &str) -> PyResult<Script> {
    let mut sources = hypedc::source::SourceMap::new();
    let file = sources.add("inputs", text);
    let (script, found) = parse_script(&loaded.program, world, file, text);
    if found.has_errors() { Err(questions(&sources, &found)) } else { Ok(script) }
}

/// The input of a step: None, a step of a script such as `right+jump`, or a mapping such as `{"jump": True, "steer": -0.5}`;
/// names are as in scripts: `2:jump` is of player 2, `nature:hero.roll` is what nature draws.
pub(crate) fn input(
    (loaded, world): (&Arc<Loaded>, WorldId),
    sim: &Simulator,
    given: Option<&Bound<'_, PyAny>>,
) -> PyResult<Input> {
    let mut input = Input::nothing(sim.world().players.len());
    let Some(given) = given.filter(|given| !given.is_none()) else { return Ok(input) };
    if let Ok(text) = given.cast::<PyString>() {
        let text = text.to_cow()?;
        let script = script(loaded, world, &text)?;
        return match script.steps.as_slice() {
            [] => Ok(input),
            [only] if only.count == 1 => Ok(only.input.clone()),
            _ => {
                let message = format!("`{text}` has {} steps: `run` takes a whole script", script.len());
                Err(argument(message))
            }
        };
    }
    let Ok(given) = given.cast::<PyDict>() else {
        let message = "inputs are None, a step of a script such as \"right+jump\", or a dict from names to numbers";
        return Err(argument(format!("{message}, not {}", given.get_type().name()?)));
    };
    for (name, value) in given {
        let name: String = name.extract()?;
        if let Some(drawn) = name.strip_prefix("nature:") {
            let (slot, chance) = drawn.rsplit_once('.').unwrap_or(("", drawn));
            let id = sim.draw_named(slot, chance);
            let id = id.ok_or_else(|| argument(format!("no chance `{drawn}`: write `nature:INSTANCE.CHANCE`")))?;
            let value: i32 = value.extract()?;
            let draw = sim.draws().get(id.0 as usize).map_or((0, 0), |draw| draw.range);
            if !(draw.0..=draw.1).contains(&value) {
                return Err(argument(format!("`{drawn}` is from {} to {}, not {value}", draw.0, draw.1)));
            }
            input.1.set(id, Some(value));
            continue;
        }
        let players = || sim.world().players.iter();
        let first = players().map(|player| player.number).min().unwrap_or(1);
        let (player, control) = match name.split_once(':') {
            Some((number, control)) => {
                let known = number.parse().ok().filter(|number| players().any(|player| player.number == *number));
                let known = known.ok_or_else(|| argument(format!("no player `{number}` in `{}`", sim.world().name)))?;
                (known, control)
            }
            None => (first, name.as_str()),
        };
        let found = sim.control(player, control).ok_or_else(|| unknown(sim, player, control))?;
        let value: f64 = value.extract()?;
        if value.is_nan() {
            return Err(argument(format!("`{name}` is NaN: a button is 0 or 1, an axis from -1 to 1")));
        }
        input.set(found, value);
    }
    Ok(input)
}

fn unknown(sim: &Simulator, number: u32, name: &str) -> PyErr {
    let world = sim.world();
    let Some(player) = world.players.iter().find(|player| player.number == number) else {
        return argument(format!("no player {number} in `{}`", world.name));
    };
    let entity = &sim.program().entities[world.slots[player.slot].entity];
    let known: Vec<&str> = entity.buttons.iter().chain(entity.axes.iter()).map(String::as_str).collect();
    let list: Vec<String> = known.iter().map(|known| format!("`{known}`")).collect();
    question(NoQuestion {
        why: format!("`{}` reads no button or axis `{name}`", entity.name),
        near: similar(name, known.iter().copied()),
        help: (!list.is_empty()).then(|| format!("it reads {}", list.join(", "))),
    })
}
