//! Text from diagnostics: [`human`] with excerpts of the source, [`short`] with one line a finding; and from the pages
//! that explain them: [`page()`].

mod human;
mod page;
mod short;

pub use human::human;
pub use page::page;
pub use short::short;
