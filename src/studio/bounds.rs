//! What each value of an instance can be, by the analysis: it runs beside the play, once for each program.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use crate::analysis::wording::{number, values as worded};
use crate::analysis::{Configuration, ConfigurationSpace, Values, configuration_space};
use crate::ir::{DiscreteId, Domain, Entity, Id, Program, SlotId, World, WorldId};

use super::protocol::{BoundsInModes, Value};
use super::search::Task;

/// Maximum number of names of a discrete variable that are listed.
const MAX_NAMES: usize = 12;

/// Maximum number of sets of active modes for which values are told.
const MAX_SETS: usize = 200;

/// Possible states of an instance.
struct States<'s> {
    configurations: Vec<&'s Configuration>,
    /// Whether everything is possible.
    is_given_up: bool,
}

/// The analysis of a world, which begins when it is first asked for.
#[derive(Default)]
pub(super) struct Analysis {
    found: Arc<OnceLock<ConfigurationSpace>>,
    has_begun: Mutex<bool>,
}

impl Analysis {
    /// The result, if it is there; else it is computed beside the session.
    pub fn result(&self, program: &Arc<Program>, world: WorldId, spawn: &dyn Fn(Task)) -> Option<&ConfigurationSpace> {
        let mut has_begun = self.has_begun.lock().unwrap_or_else(PoisonError::into_inner);
        if !*has_begun {
            *has_begun = true;
            let (found, program) = (Arc::clone(&self.found), Arc::clone(program));
            spawn(Box::new(move || {
                found.get_or_init(|| configuration_space(&program, world));
            }));
        }
        self.found.get()
    }
}

/// The values of an instance in words, with the kinds and names of [`Inspected::values`](super::protocol::Inspected).
pub(super) fn bounds(program: &Program, world: WorldId, space: &ConfigurationSpace, slot: SlotId) -> Vec<Value> {
    let world = &program.worlds[world];
    let of = &space.slots[slot];
    let of = States { configurations: of.configurations.iter().collect(), is_given_up: of.is_given_up };
    values(&program.entities[world.slots[slot].entity], world, &of)
}

/// The values of an instance while its active modes are the same, for each such set of modes; none if there are too many
/// sets, or if the analysis has given up.
pub(super) fn bounds_in_modes(
    program: &Program,
    world: WorldId,
    space: &ConfigurationSpace,
    slot: SlotId,
) -> Vec<BoundsInModes> {
    let world = &program.worlds[world];
    let (entity, of) = (&program.entities[world.slots[slot].entity], &space.slots[slot]);
    let mut sets: BTreeMap<Vec<usize>, Vec<&Configuration>> = BTreeMap::new();
    for configuration in of.configurations.iter().filter(|_| !of.is_given_up) {
        let leaves = configuration.leaves.iter().filter_map(|leaf| entity.leaves.get(*leaf));
        let mut modes: Vec<usize> = leaves.flat_map(|leaf| &leaf.path).map(|mode| mode.index()).collect();
        modes.sort_unstable();
        sets.entry(modes).or_default().push(configuration);
    }
    if sets.len() > MAX_SETS {
        return Vec::new();
    }
    let of_set = |(modes, configurations)| {
        let own = States { configurations, is_given_up: false };
        BoundsInModes { modes, values: values(entity, world, &own).into_iter().map(|value| value.value).collect() }
    };
    sets.into_iter().map(of_set).collect()
}

fn values(entity: &Entity, world: &World, of: &States<'_>) -> Vec<Value> {
    let value = |kind: &str, name: String, value: String| Value { kind: kind.into(), name, value };
    let mut all = Vec::new();
    for var in entity.vars.ids() {
        for degree in 0..=2u8 {
            let found = joined(of, |c| c.vars[var][usize::from(degree)]);
            all.push(value("variable", entity.variable_text(var, degree), text(of, &found)));
        }
    }
    for id in entity.discretes.ids() {
        let found = joined(of, |c| c.discretes[id]);
        let text = if of.is_given_up { text(of, &found) } else { discrete(entity, id, &found) };
        all.push(value("discrete", entity.discretes[id].name.clone(), text));
    }
    for (id, timer) in entity.timers.pairs() {
        let found = joined(of, |c| Values::from(c.timers[id]));
        let longest = found.hull().map(|hull| hull.high).filter(|high| high.is_finite() && *high < f64::from(u32::MAX));
        let text = match longest {
            Some(steps) if !of.is_given_up => format!("up to {} s", number(steps * world.step.seconds())),
            _ => "any".to_string(),
        };
        all.push(value("timer", entity.modes[timer.mode].path.clone(), text));
    }
    all
}

fn joined(space: &States<'_>, of: impl Fn(&Configuration) -> Values) -> Values {
    Values::any(space.configurations.iter().flat_map(|c| of(c).intervals().to_vec()))
}

fn text(space: &States<'_>, values: &Values) -> String {
    match () {
        () if space.is_given_up => "any (too large to analyse)".to_string(),
        () if space.configurations.is_empty() => "never there".to_string(),
        () => worded(values),
    }
}

/// The values of a discrete variable by name.
fn discrete(entity: &Entity, id: DiscreteId, values: &Values) -> String {
    let domain = &entity.discretes[id].domain;
    if matches!(domain, Domain::Int) {
        return worded(&values.hull().map_or_else(|| *values, Values::from));
    }
    let all = values.intervals().iter().flat_map(|i| i.low as i32..=i.high as i32);
    all.take(MAX_NAMES).map(|value| domain.text(value)).collect::<Vec<_>>().join(", ")
}
