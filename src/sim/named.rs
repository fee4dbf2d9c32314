//! Parts of a state by name, for tools and for languages that have no ids: `hero.x'`, `hero.mode`, `hero in air`. Names
//! are looked up once; reading by what was found allocates nothing.

use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::similar;
use crate::ir::{
    DiscreteId, Domain, Entity, GoalId, GroupId, Id, LeafId, ModeId, NeverId, ParamId, RefId, SlotId, TimerId, VarId,
};

use super::saved::State;
use super::simulator::Simulator;

/// A part of a state, or something that is computed from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Named {
    /// `hero.x`, `hero.x'`, `hero.x''`: a continuous variable, its velocity, its acceleration.
    Var(SlotId, VarId, u8),
    /// `hero.coins`: a discrete variable.
    Discrete(SlotId, DiscreteId),
    /// `hero.speed`: a parameter.
    Param(SlotId, ParamId),
    /// `hero.target`: a reference to another instance.
    Reference(SlotId, RefId),
    /// `hero.mode`, or `hero.mode.NAME` of a group with a name: the innermost active mode.
    Mode(SlotId, GroupId),
    /// `hero in air`: whether a mode is active.
    InMode(SlotId, ModeId),
    /// `hero.timer.air`: the time for which a mode has been active, s, where something reads it.
    Timer(SlotId, TimerId),
    /// `hero.space`: the space that it is in.
    Space(SlotId),
    /// `hero.alive`: whether there is an instance.
    Alive(SlotId),
    /// `goal.NAME`: whether a goal holds.
    Goal(GoalId),
    /// `never.NAME`: whether a `never` holds.
    Never(NeverId),
}

/// A value as the language writes it.
#[derive(Debug, Clone, PartialEq)]
pub enum NamedValue {
    /// A number.
    Number(f64),
    /// A whole number.
    Whole(i32),
    /// A truth value.
    Truth(bool),
    /// A mode, a space, an instance or a value of a set.
    Name(String),
    /// A reference to nothing, or what an absent instance has no value for.
    Nothing,
}

impl Simulator {
    /// Looks up a name.
    ///
    /// # Errors
    /// Why there is no such part, with the nearest name.
    pub fn named(&self, name: &str) -> Result<Named, NoQuestion> {
        self.find(name).ok_or_else(|| {
            let (all, world) = (self.names(), self.world());
            let of = name.split(['.', ' ']).next().unwrap_or(name);
            let help = match world.slot_named(of) {
                Some(_) => {
                    let own = all.iter().filter(|known| known.split('.').next() == Some(of));
                    let mut list: Vec<String> = own.take(24).map(|known| format!("`{known}`")).collect();
                    list.push(format!("`{of} in MODE`"));
                    format!("there is {}", list.join(", "))
                }
                None => {
                    let list: Vec<String> =
                        world.slots.iter().take(24).map(|slot| format!("`{}`", slot.name)).collect();
                    format!("a name is `INSTANCE.VARIABLE`; instances are {}", list.join(", "))
                }
            };
            let why = format!("no `{name}` in `{}`", world.name);
            NoQuestion { why, near: similar(name, all.iter().map(String::as_str)), help: Some(help) }
        })
    }

    fn find(&self, name: &str) -> Option<Named> {
        let world = self.world();
        if let Some((of, mode)) = name.split_once(" in ") {
            let slot = world.slot_named(of.trim())?;
            return Some(Named::InMode(slot, mode_named(self.entity(slot), mode.trim())?));
        }
        let (of, part) = name.split_once('.')?;
        let Some(slot) = world.slot_named(of) else {
            return match of {
                "goal" => world.goal_named(part).map(Named::Goal),
                "never" => world.never_named(part).map(Named::Never),
                _ => None,
            };
        };
        let entity = self.entity(slot);
        let plain = part.trim_end_matches('\'');
        if let (Some(var), degree @ 0..=2) = (entity.var_named(plain), part.len() - plain.len()) {
            return Some(Named::Var(slot, var, degree as u8));
        }
        let discrete = entity.discrete_named(part).map(|id| Named::Discrete(slot, id));
        let param = || entity.param_named(part).map(|id| Named::Param(slot, id));
        let reference = || entity.ref_named(part).map(|id| Named::Reference(slot, id));
        discrete.or_else(param).or_else(reference).or_else(|| match part.split_once('.').unwrap_or((part, "")) {
            ("mode", "") => plain_group(entity).map(|id| Named::Mode(slot, id)),
            ("mode", of) => entity.groups.find(|g| g.name.as_deref() == Some(of)).map(|id| Named::Mode(slot, id)),
            ("timer", of) => {
                let timer = entity.timers.find(|timer| entity.modes[timer.mode].path == of);
                timer.map(|id| Named::Timer(slot, id))
            }
            ("space", "") => Some(Named::Space(slot)),
            ("alive", "") => Some(Named::Alive(slot)),
            _ => None,
        })
    }

    /// All names but those of the form `hero in air`, instance by instance; then goals and `never`s.
    pub fn names(&self) -> Vec<String> {
        let world = self.world();
        let mut names = Vec::new();
        for (id, slot) in world.slots.pairs() {
            let entity = self.entity(id);
            let mut add = |part: &str| names.push(format!("{}.{part}", slot.name));
            add("alive");
            add("space");
            if plain_group(entity).is_some() {
                add("mode");
            }
            entity.groups.iter().filter_map(|group| group.name.as_ref()).for_each(|name| add(&format!("mode.{name}")));
            for var in entity.vars.ids() {
                (0..=2).for_each(|degree| add(&entity.variable_text(var, degree)));
            }
            entity.discretes.iter().for_each(|discrete| add(&discrete.name));
            entity.params.iter().for_each(|param| add(&param.name));
            entity.refs.iter().for_each(|reference| add(&reference.name));
            entity.timers.iter().for_each(|timer| add(&format!("timer.{}", entity.modes[timer.mode].path)));
        }
        names.extend(world.goals.iter().map(|goal| format!("goal.{}", goal.name)));
        names.extend(world.nevers.iter().map(|never| format!("never.{}", never.name)));
        names
    }

    /// A part of a state as a number: truth is 1; a name is its place among [`Simulator::words`]; a reference is 1 plus
    /// the slot that it refers to. 0 if the instance is absent.
    pub fn named_number(&self, state: &[u8], part: Named) -> f64 {
        let truth = |is: bool| f64::from(u8::from(is));
        let slot = match part {
            Named::Goal(goal) => {
                let holds = self.left_bounds(state).is_none() && self.goal(state, goal) == Ok(true);
                return truth(holds);
            }
            Named::Never(never) => return truth(self.holds(state, self.world().nevers[never].holds) == Ok(true)),
            Named::Var(slot, ..) | Named::Discrete(slot, _) | Named::Param(slot, _) | Named::Reference(slot, _) => slot,
            Named::Mode(slot, _) | Named::InMode(slot, _) | Named::Timer(slot, _) => slot,
            Named::Space(slot) | Named::Alive(slot) => slot,
        };
        let layout = self.layout(slot);
        if !layout.alive(state) {
            return 0.0;
        }
        match part {
            Named::Var(_, var, degree) => layout.var(state, var, degree),
            Named::Discrete(_, id) => f64::from(layout.discrete(state, id)),
            Named::Param(_, id) => self.param(state, slot, id),
            Named::Reference(_, id) => layout.reference(state, id).map_or(0.0, |target| f64::from(target.0) + 1.0),
            Named::Mode(_, group) => {
                let first = self.entity(slot).leaves_of(&self.entity(slot).groups[group]).from.0;
                f64::from(layout.leaf(state, group).0 - first)
            }
            Named::InMode(_, mode) => truth(self.instance(state, slot).is_in(mode)),
            Named::Timer(_, timer) => self.world().step.times(layout.timer(state, timer)),
            Named::Space(_) => f64::from(layout.space(state).0),
            Named::Alive(_) | Named::Goal(_) | Named::Never(_) => 1.0,
        }
    }

    /// The words that the numbers of a part stand for, in order; none if they are numbers.
    pub fn words(&self, part: Named) -> Option<Vec<String>> {
        match part {
            Named::Discrete(slot, id) => match &self.entity(slot).discretes[id].domain {
                Domain::Set(names) => Some(names.clone()),
                Domain::Int | Domain::Bool => None,
            },
            Named::Mode(slot, group) => {
                let entity = self.entity(slot);
                let leaves = entity.leaves_of(&entity.groups[group]).ids();
                Some(leaves.map(|leaf| entity.modes[entity.leaves[leaf].mode].path.clone()).collect())
            }
            Named::Space(_) => Some(self.world().spaces.iter().map(|space| space.name.clone()).collect()),
            _ => None,
        }
    }

    /// A part of a state as the language writes it.
    pub fn named_value(&self, state: &[u8], part: Named) -> NamedValue {
        let number = self.named_number(state, part);
        let slot = match part {
            Named::Goal(_) | Named::Never(_) | Named::Alive(_) => return NamedValue::Truth(number != 0.0),
            Named::Var(slot, ..) | Named::Discrete(slot, _) | Named::Param(slot, _) | Named::Reference(slot, _) => slot,
            Named::Mode(slot, _) | Named::InMode(slot, _) | Named::Timer(slot, _) | Named::Space(slot) => slot,
        };
        if !self.layout(slot).alive(state) {
            return NamedValue::Nothing;
        }
        match part {
            Named::InMode(..) => NamedValue::Truth(number != 0.0),
            Named::Reference(_, id) => match self.layout(slot).reference(state, id) {
                Some(target) => NamedValue::Name(self.world().slots[target].name.clone()),
                None => NamedValue::Nothing,
            },
            Named::Discrete(_, id) => match &self.entity(slot).discretes[id].domain {
                Domain::Int => NamedValue::Whole(number as i32),
                Domain::Bool => NamedValue::Truth(number != 0.0),
                domain @ Domain::Set(_) => NamedValue::Name(domain.text(number as i32)),
            },
            Named::Mode(_, group) => {
                let entity = self.entity(slot);
                NamedValue::Name(entity.modes[entity.leaves[self.layout(slot).leaf(state, group)].mode].path.clone())
            }
            Named::Space(_) => NamedValue::Name(self.world().spaces[self.space(state, slot)].name.clone()),
            _ => NamedValue::Number(number),
        }
    }

    /// Writes a part of a state as it is: nothing of what a step does beside it happens. The contacts stay those of the
    /// last step, until the next one.
    ///
    /// # Errors
    /// Why it cannot be written, in one sentence; the state is then unchanged.
    pub fn set_named(&self, state: &mut State, part: Named, value: &NamedValue) -> Result<(), String> {
        let mut next = state.clone();
        let slot = self.put(&mut next, part, value)?;
        self.check(&next, slot).map_err(str::to_string)?;
        state.clone_from(&next);
        Ok(())
    }

    fn put(&self, state: &mut State, part: Named, value: &NamedValue) -> Result<SlotId, String> {
        let slot = match part {
            Named::Goal(_) | Named::Never(_) => return Err("whether it holds follows from the state".to_string()),
            Named::Alive(_) => return Err("instances are spawned and destroyed by the program".to_string()),
            Named::InMode(..) => return Err("the active mode is written as `INSTANCE.mode`".to_string()),
            Named::Timer(..) => return Err("it is counted by the simulator".to_string()),
            Named::Var(slot, ..) | Named::Discrete(slot, _) | Named::Param(slot, _) | Named::Reference(slot, _) => slot,
            Named::Mode(slot, _) | Named::Space(slot) => slot,
        };
        let (layout, entity) = (self.layout(slot), self.entity(slot));
        if !layout.alive(state) {
            return Err("the instance is absent".to_string());
        }
        if layout.rest.is_some() && matches!(part, Named::Var(..) | Named::Space(_)) {
            return Err("the instance never moves".to_string());
        }
        match (part, value) {
            (Named::Var(_, var, degree), _) => layout.set_var(state, var, degree, finite(value)?),
            (Named::Param(_, id), _) => {
                layout.param(state, id).ok_or("it never changes in a run: compile the program with another value")?;
                layout.set_param(state, id, finite(value)?);
            }
            (Named::Discrete(_, id), _) => {
                let discrete = &entity.discretes[id];
                let number = match (&discrete.domain, value) {
                    (Domain::Set(names), NamedValue::Name(name)) => {
                        word(&names.iter().map(String::as_str).collect::<Vec<_>>(), name)?
                    }
                    (Domain::Set(names), _) => {
                        return Err(format!("it is {}", listed(&names.iter().map(String::as_str).collect::<Vec<_>>())));
                    }
                    (Domain::Bool, NamedValue::Truth(is)) => usize::from(*is),
                    (Domain::Bool, _) => return Err("it is true or false".to_string()),
                    (Domain::Int, _) => {
                        let number = finite(value)?;
                        let (low, high) = discrete.range;
                        if number.fract() != 0.0 || !(f64::from(low)..=f64::from(high)).contains(&number) {
                            return Err(format!("it is a whole number from {low} to {high}"));
                        }
                        layout.set_discrete(state, id, number as i32);
                        return Ok(slot);
                    }
                };
                layout.set_discrete(state, id, number as i32);
            }
            (Named::Reference(_, id), NamedValue::Nothing) => layout.set_reference(state, id, None),
            (Named::Reference(_, id), NamedValue::Name(name)) => {
                let target = self.world().slot_named(name).ok_or_else(|| format!("there is no instance `{name}`"))?;
                layout.set_reference(state, id, Some(target));
            }
            (Named::Reference(..), _) => return Err("it is the name of an instance, or nothing".to_string()),
            (Named::Mode(_, group), NamedValue::Name(name)) => {
                let leaves = entity.leaves_of(&entity.groups[group]);
                let path = |leaf: LeafId| entity.modes[entity.leaves[leaf].mode].path.as_str();
                let paths: Vec<&str> = leaves.ids().map(path).collect();
                let leaf = LeafId::from_index(leaves.from.index() + word(&paths, name)?);
                layout.set_leaf(state, group, leaf);
            }
            (Named::Space(_), NamedValue::Name(name)) => {
                let space = self.world().space_named(name).ok_or_else(|| format!("there is no space `{name}`"))?;
                layout.set_space(state, space);
            }
            _ => return Err("it is written as a name".to_string()),
        }
        Ok(slot)
    }
}

/// The group without a name: of several, the first that has more than one mode. What holds in all modes is in one, too.
fn plain_group(entity: &Entity) -> Option<GroupId> {
    let plain = || entity.groups.pairs().filter(|(_, group)| group.name.is_none());
    let found = plain().find(|(_, group)| entity.leaves_of(group).len() > 1).or_else(|| plain().next());
    found.map(|(id, _)| id)
}

/// A mode by its path, or by its last part if no other mode ends in it.
fn mode_named(entity: &Entity, name: &str) -> Option<ModeId> {
    let ends = |path: &str| path.strip_suffix(name).is_some_and(|rest| rest.ends_with('.'));
    entity.mode_named(name).or_else(|| {
        let mut found = entity.modes.pairs().filter(|(_, mode)| ends(&mode.path)).map(|(id, _)| id);
        found.next().filter(|_| found.next().is_none())
    })
}

fn finite(value: &NamedValue) -> Result<f64, String> {
    match value {
        NamedValue::Number(number) if number.is_finite() => Ok(*number),
        NamedValue::Whole(number) => Ok(f64::from(*number)),
        _ => Err("it is a finite number".to_string()),
    }
}

fn word(words: &[&str], name: &str) -> Result<usize, String> {
    words.iter().position(|word| *word == name).ok_or_else(|| format!("`{name}` is none of {}", listed(words)))
}

fn listed(words: &[&str]) -> String {
    words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ")
}
