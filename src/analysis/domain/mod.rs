//! Abstract domains: sets of intervals, abstract states of instances, widening.

pub(in crate::analysis) mod configuration;
pub(in crate::analysis) mod energy;
pub(in crate::analysis) mod received;
pub(in crate::analysis) mod truth;
pub(in crate::analysis) mod unknown;
pub(in crate::analysis) mod values;
pub(in crate::analysis) mod widen;
pub mod wording;
