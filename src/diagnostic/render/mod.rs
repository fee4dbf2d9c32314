//! Text from diagnostics: [`human`] with excerpts of the source, [`short`] with one line a finding.

mod human;
mod short;

pub use human::human;
pub use short::short;
