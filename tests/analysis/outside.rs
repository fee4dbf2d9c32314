//! Whether a state lies outside of what a world can be. The tests of the analysis and the fuzz targets share it.

use hypedc::analysis::{Configuration, ConfigurationSpace};
use hypedc::ir::{GoalId, Program};
use hypedc::sim::Simulator;

/// What of a state is outside, if anything is.
pub fn outside(program: &Program, sim: &Simulator<'_>, space: &ConfigurationSpace, state: &[u8]) -> Option<String> {
    let world = sim.world();
    for (slot, s) in world.slots.pairs() {
        let (found, layout) = (&space.slots[slot], &world.layout.slots[slot]);
        let entity = &program.entities[s.entity];
        if found.is_given_up {
            continue;
        }
        if !layout.alive(state) {
            if !found.can_be_absent {
                return Some(format!("{} is absent", s.name));
            }
            continue;
        }
        let leaves = || entity.groups.ids().map(|g| layout.leaf(state, g));
        let modes = || {
            let modes = leaves().map(|l| entity.modes[entity.leaves[l].mode].path.as_str());
            format!("{} in {:?}", s.name, modes.collect::<Vec<_>>())
        };
        let mut here = found.configurations.iter().filter(|c| leaves().eq(c.leaves.iter().copied())).peekable();
        if here.peek().is_none() {
            return Some(format!("{}: it cannot be in these modes", modes()));
        }
        // What of the state is outside of a configuration, if anything is.
        let beyond = |at: &Configuration| {
            for (var, values) in at.vars.pairs() {
                for (degree, values) in (0u8..).zip(values) {
                    let value = layout.var(state, var, degree);
                    if !values.contains(value) {
                        let name = format!("{}{}", entity.vars[var], "'".repeat(usize::from(degree)));
                        return Some(format!("{name} is {value}, not in {values}"));
                    }
                }
            }
            for (id, values) in at.discretes.pairs() {
                let value = f64::from(layout.discrete(state, id));
                if !values.contains(value) {
                    return Some(format!("{} is {value}, not in {values}", entity.discretes[id].name));
                }
            }
            for (id, count) in at.timers.pairs() {
                let value = layout.timer(state, id);
                if !count.contains(f64::from(value)) {
                    return Some(format!("timer {id} counts {value}, not in {count}"));
                }
            }
            (!at.spaces.contains(&layout.space(state))).then(|| "in another space".to_string())
        };
        let found: Option<Vec<String>> = here.map(beyond).collect();
        if let Some(what) = found {
            return Some(format!("{}: {}", modes(), what.join(" or ")));
        }
    }
    None
}

/// What of the goals of a world holds, although the space says that it never does.
pub fn ruled_out(program: &Program, sim: &Simulator<'_>, space: &ConfigurationSpace, state: &[u8]) -> Option<String> {
    let (world, id) = (sim.world(), sim.world_id());
    let holds = |goal: &GoalId| sim.goal(state, *goal) == Ok(true) && !space.can_hold(program, id, *goal);
    let goal = world.goals.ids().find(holds)?;
    Some(format!("goal {} holds, which is proven never to", world.goals[goal].name))
}

/// Whether a search would go on: no player is below or beside its space.
pub fn goes_on(sim: &Simulator<'_>, state: &[u8]) -> bool {
    sim.left_bounds(state).is_none()
}
