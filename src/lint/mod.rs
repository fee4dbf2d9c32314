//! Warnings: programs that have a meaning, but hardly the one that was meant.
//!
//! They look at a checked program without errors, so that none of them is only the shadow of an error. What follows
//! from values that variables can have over time is not looked for here, only what the text alone tells.

mod border;
mod guard;
mod modes;
mod range;
mod terms;
mod unused;
mod updates;
mod world;

use crate::diagnostic::Diagnostics;
use crate::sema::checked::Checked;
use crate::source::FileId;

/// Looks for what is hardly meant; `root` is the file that was asked about, imported ones are known to others.
pub fn lint(checked: &Checked, root: FileId) -> Diagnostics {
    let mut found = Diagnostics::new();
    for entity in checked.entities.iter() {
        modes::modes(entity, &mut found);
        updates::clashes(entity, &mut found);
        updates::ranges(entity, &mut found);
    }
    unused::unused(checked, root, &mut found);
    world::tags(checked, &mut found);
    world::touches(checked, &mut found);
    world::players(checked, &mut found);
    world::places(checked, &mut found);
    world::links(checked, &mut found);
    border::border(checked, &mut found);
    found
}
