//! The refactoring that writes what a name stands for in its place: of a constant, and of a condition.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::source::FileId;
use crate::syntax::Rule;
use crate::syntax::occurrence::{NameKind, Role};

use crate::lsp::snapshot::Snapshot;
use crate::lsp::view::View;

use super::blocks::Blocks;
use super::draft::Draft;
use super::{ActionKind, Candidate};

/// Writes the value of the constant or the condition at a place wherever it is used, and removes its declaration.
pub(super) fn candidate(view: &View, snapshot: &Snapshot, file: FileId, bytes: &Range<usize>) -> Option<Candidate> {
    let names = snapshot.names_at(file, bytes.start);
    let name = names.iter().find(|o| matches!(o.kind, NameKind::Constant | NameKind::Condition))?;
    let key = snapshot.key(name);
    let keys = BTreeSet::from([key]);
    // Another program would lose the name.
    let is_elsewhere = |other: &Snapshot| {
        let all = other.occurrences_of(&keys);
        all.into_iter().any(|o| snapshot.file(other.path(o.at.file())).is_none())
    };
    if view.programs.values().any(|state| is_elsewhere(&state.current)) {
        return None;
    }
    let declared = name.declared;
    let text = snapshot.text(declared.file());
    let blocks = Blocks::of(text.code())?;
    let statement = blocks.innermost(&declared.range(), &[Rule::constant, Rule::condition])?;
    let value = blocks.inside(&statement.bytes).find(|node| node.rule == Rule::expression)?;
    let value_text = text.code().get(value.bytes.clone())?.trim();
    if value_text.contains("//") {
        return None;
    }
    // One operand stays one; anything else goes into parentheses.
    let operands = blocks.inside(&value.bytes).filter(|node| node.rule == Rule::primary);
    let is_simple = operands.clone().next().is_some_and(|first| first.bytes.len() == value_text.len());
    let written = if is_simple { value_text.to_string() } else { format!("({value_text})") };
    let mut draft = Draft::default();
    let mut uses = 0;
    for o in snapshot.occurrences_of(&keys).filter(|o| o.role != Role::Declared) {
        uses += 1;
        let path = snapshot.path(o.at.file());
        // Alone in its place it needs no parentheses.
        let place = snapshot.text(o.at.file());
        let around = Blocks::of(place.code())?;
        let is_alone = around.around(&o.at.range()).find(|node| node.rule == Rule::expression);
        let is_alone = is_alone.is_some_and(|node| node.bytes == o.at.range());
        draft.edit(path, o.at.range(), if is_alone { value_text } else { &written });
    }
    draft.edit(snapshot.path(declared.file()), blocks.lines(&statement.bytes)?, "");
    let title = format!("inline `{}`", snapshot.name(name));
    (uses > 0).then_some(Candidate { title, kind: ActionKind::Inline, keeps_program: true, draft })
}
