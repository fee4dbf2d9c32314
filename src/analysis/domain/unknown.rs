//! Parameters that are not known exactly: of each only an interval is given, and all that follows from it is computed
//! where an instance begins.

use std::collections::BTreeMap;

use crate::ir::{EntityId, IdVec, ParamId, SlotId, VarId};

use crate::analysis::domain::values::Values;

/// What is not known of a world.
#[derive(Debug, Clone, Default)]
pub(in crate::analysis) struct Unknown {
    /// The defaults of parameters.
    pub defaults: BTreeMap<(EntityId, ParamId), Values>,
    /// What depends on them in instances that exist from the start.
    pub slots: BTreeMap<SlotId, Dependent>,
}

/// The values of an instance that depend on something unknown.
#[derive(Debug, Clone, Default, PartialEq)]
pub(in crate::analysis) struct Dependent {
    /// Parameters, each with its value in the program from which the world was made.
    pub params: BTreeMap<ParamId, f64>,
    /// The first values of continuous variables, likewise.
    pub vars: BTreeMap<VarId, f64>,
}

/// Nothing is unknown.
pub(in crate::analysis) static KNOWN: Unknown = Unknown { defaults: BTreeMap::new(), slots: BTreeMap::new() };

/// The values of a number of a slot, of which NaN stands for one that is not known.
pub(in crate::analysis) fn known_or(value: f64, unknown: Values) -> Values {
    if value.is_nan() { unknown } else { Values::point(value) }
}

/// The least and the greatest of some parameters, once if they are equal; NaN where there is no such number.
pub(in crate::analysis) fn ends(params: &IdVec<ParamId, Values>) -> Vec<IdVec<ParamId, f64>> {
    let of = |values: &Values| values.hull().map_or([f64::NAN; 2], |hull| [hull.low, hull.high]);
    let count = if params.iter().all(|values| values.constant().is_some()) { 1 } else { 2 };
    (0..count).map(|end| params.iter().map(|values| of(values)[end]).collect()).collect()
}
