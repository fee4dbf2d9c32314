//! Goals that hold in no state of their world, however it is played.

use std::collections::BTreeSet;

use crate::diagnostic::catalogue::values::GoalByValue;
use crate::diagnostic::{Code, Diagnostics};
use crate::ir::{Expr, ExprId, Program, WorldId};

use super::super::{ConfigurationSpace, never_holds};
use super::Context;

/// Reports the goals of a world that hold in no state of its space.
pub(super) fn report(context: &Context<'_>, world: WorldId, space: &ConfigurationSpace, found: &mut Diagnostics) {
    let (program, sources) = (context.program, context.sources);
    let of = &program.worlds[world];
    for (id, goal) in of.goals.pairs().filter(|(_, goal)| !is_written_false(program, goal.holds)) {
        let predicate = program.spans.exprs[goal.holds];
        if context.reported.of(&[Code::BeyondBounds], predicate, sources) {
            continue;
        }
        let Some(parts) = never_holds(program, world, goal.holds, space) else { continue };
        let mut told = BTreeSet::new();
        let reasons =
            parts.iter().map(|part| (program.spans.exprs[part.predicate], part.sentence(sources, program, of)));
        let reasons = reasons.filter(|(_, sentence)| told.insert(sentence.clone())).collect();
        let at = program.spans.worlds[world].goals[id];
        found.report(GoalByValue { name: goal.name.clone(), at, reasons });
    }
}

/// Whether a predicate is `false` as it is written, which somebody means.
fn is_written_false(program: &Program, predicate: ExprId) -> bool {
    matches!(program.exprs[predicate], Expr::Bool(false))
}
