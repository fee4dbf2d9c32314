//! Warnings: programs that are valid but probably wrong.
//!
//! The lints read a checked program without errors, so that no warning is a consequence of an error. They are
//! syntactic; findings from the values of variables over time belong to `analysis`.

mod border;
mod bound;
mod guard;
mod initial;
mod modes;
mod range;
mod terms;
mod unused;
mod updates;
mod world;
mod wrap;

use crate::diagnostic::Diagnostics;
use crate::sema::checked::Checked;
use crate::source::FileId;

/// Runs all lints; `root` is the compiled file: unused declarations of imported files are not reported.
pub fn lint(checked: &Checked, root: FileId) -> Diagnostics {
    let mut found = Diagnostics::new();
    for entity in checked.entities.iter() {
        modes::modes(entity, &mut found);
        updates::clashes(entity, &mut found);
        updates::ranges(entity, &mut found);
    }
    unused::unused(checked, root, &mut found);
    let explained = world::tags(checked, root, &mut found);
    world::level_names(checked, &explained, &mut found);
    bound::bound(checked, root, &mut found);
    world::touches(checked, &mut found);
    world::players(checked, &mut found);
    world::places(checked, &mut found);
    world::links(checked, &mut found);
    border::border(checked, &mut found);
    wrap::wraps(checked, &mut found);
    found
}
