//! The analysis of a world for all values of some parameters at once: the default of a parameter is any number of an
//! interval, the same one in the whole run. What holds in no state of the result holds for none of these numbers.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::ir::{EntityId, Expr, ExprId, Origin, ParamId, Program, SlotId, Subject, World, WorldId};
use crate::watch::Watch;

use super::domain::unknown::{Dependent, Unknown};
use super::fixpoint::counter_bounds;
use super::{ConfigurationSpace, Interval, MAX_BRANCHES, Values, endless, within_limits};

/// Relative difference up to which a value may be that of an expression.
const EQUAL: f64 = 1e-9;

/// A parameter whose default is any number of an interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParamRange {
    /// The entity.
    pub entity: EntityId,
    /// The parameter.
    pub param: ParamId,
    /// The numbers.
    pub values: Interval,
}

/// A world some of whose parameters are any number of an interval.
#[derive(Debug, Clone)]
pub struct Varied {
    /// The program; of the world's slots, NaN stands for a parameter that is not known.
    program: Program,
    world: WorldId,
    unknown: Unknown,
}

impl Varied {
    /// A world of a program, which is compiled with one number of each interval. Only the values of slots may differ in the
    /// programs of the other numbers.
    ///
    /// `None` if the analysis cannot represent it: the first value of a discrete variable depends on such a parameter.
    pub fn new(program: &Program, world: WorldId, ranges: &[ParamRange]) -> Option<Varied> {
        let defaults = ranges.iter().map(|range| ((range.entity, range.param), Values::from(range.values)));
        let mut unknown = Unknown { defaults: defaults.collect(), slots: BTreeMap::new() };
        let mut table: World = (*program.worlds[world]).clone();
        for id in program.worlds[world].slots.ids() {
            if let Some(dependent) = dependent(program, &table, id, &unknown)? {
                let step = table.step;
                let slot = &mut table.slots[id];
                dependent.params.keys().for_each(|param| slot.params[*param] = f64::NAN);
                // The limits of a slot that is used again do not depend on its parameters.
                if std::mem::replace(&mut slot.is_fixed, false) {
                    slot.timer_limits = program.timer_limits(slot.entity, Some(&slot.params), step);
                }
                unknown.slots.insert(id, dependent);
            }
        }
        let mut program = program.clone();
        program.worlds[world] = Arc::new(table);
        Some(Varied { program, world, unknown })
    }

    /// The same without `bounds`, which end runs; see [`endless`].
    #[must_use]
    pub fn endless(&self) -> Varied {
        Varied { program: endless(&self.program, self.world), ..self.clone() }
    }

    /// The configuration space for all numbers of the intervals together, for runs on which some predicates of the world
    /// never hold.
    pub fn space(&self, predicates: &[ExprId], watch: &dyn Watch) -> ConfigurationSpace {
        let world = &self.program.worlds[self.world];
        let limits = (counter_bounds::limits(&self.program, world), &self.unknown);
        within_limits(&self.program, world, predicates, limits, &mut { MAX_BRANCHES }, watch)
    }

    /// Adds the analysis that distinguishes players by place; see [`ConfigurationSpace::by_place`].
    #[must_use]
    pub fn by_place(&self, space: ConfigurationSpace, predicates: &[ExprId], watch: &dyn Watch) -> ConfigurationSpace {
        space.varied_by_place(&self.program, self.world, predicates, &self.unknown, watch)
    }

    /// Whether a predicate of the world can hold for any of the numbers.
    pub fn can_hold(&self, space: &ConfigurationSpace, predicate: ExprId) -> bool {
        space.can_evaluate_to(&self.program, self.world, predicate, true)
    }
}

/// What depends on unknown defaults in an instance that exists from the start; nothing if nothing does.
///
/// `None` if it is a discrete variable.
fn dependent(program: &Program, world: &World, slot: SlotId, unknown: &Unknown) -> Option<Option<Dependent>> {
    let slot = &world.slots[slot];
    let is_concerned = unknown.defaults.keys().any(|(entity, _)| *entity == slot.entity);
    if slot.origin == Origin::Free || !is_concerned {
        return Some(None);
    }
    let entity = &program.entities[slot.entity];
    // A value that differs from the default is given, and a given value reads no parameters.
    let may_be = |id: ExprId, value: f64| {
        let constant = program.constant(id, &slot.params, world.step);
        constant.is_none_or(|default| (default - value).abs() <= EQUAL * (1.0 + default.abs()))
    };
    let mut out = Dependent::default();
    for (id, param) in entity.params.pairs() {
        let is_varied = unknown.defaults.contains_key(&(slot.entity, id)) || reads(program, param.default, &out);
        if is_varied && may_be(param.default, slot.params[id]) {
            out.params.insert(id, slot.params[id]);
        }
    }
    // An instance is placed somewhere: its position is given.
    for (id, first) in entity.first.pairs().filter(|(id, _)| !id.is_position()) {
        if first.is_some_and(|first| reads(program, first, &out) && may_be(first, slot.vars[id][0])) {
            out.vars.insert(id, slot.vars[id][0]);
        }
    }
    let first_of = |first: ExprId, value: i32| reads(program, first, &out) && may_be(first, f64::from(value));
    let mut discretes = entity.discretes.iter().zip(slot.discretes.iter());
    if discretes.any(|(discrete, value)| first_of(discrete.first, *value)) {
        return None;
    }
    Some((!out.params.is_empty()).then_some(out))
}

/// Whether an expression reads a parameter that is not known.
fn reads(program: &Program, id: ExprId, unknown: &Dependent) -> bool {
    let is_unknown = |id: ExprId| match program.exprs[id] {
        Expr::Param(Subject::Me, param) => unknown.params.contains_key(&param),
        _ => false,
    };
    !unknown.params.is_empty() && program.with_operands(vec![id]).into_iter().any(is_unknown)
}
