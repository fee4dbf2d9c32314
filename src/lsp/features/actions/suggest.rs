//! Suggestions of findings as edits: what a check says by spans becomes text in its layout.

use std::ops::Range;

use crate::diagnostic::suggestion::{BlockKind, Change, Piece, Suggestion};
use crate::lsp::features::rename::rename;
use crate::lsp::location::FileOffset;
use crate::lsp::snapshot::Snapshot;
use crate::lsp::view::View;
use crate::source::Span;
use crate::syntax::Rule;

use super::blocks::Blocks;
use super::draft::Draft;

/// The draft of a suggestion; `None` if it does not fit the text.
pub(super) fn draft(view: &View, snapshot: &Snapshot, suggestion: &Suggestion) -> Option<Draft> {
    let mut draft = Draft::default();
    for change in &suggestion.changes {
        add(&mut draft, view, snapshot, change)?;
    }
    Some(draft)
}

fn add(draft: &mut Draft, view: &View, snapshot: &Snapshot, change: &Change) -> Option<()> {
    let first = change.spans().next()?;
    let path = snapshot.path(first.file()).to_path_buf();
    let text = snapshot.text(first.file());
    let code = text.code();
    let blocks = || Blocks::of(code);
    match change {
        Change::Write(at, pieces) => {
            let new: Vec<&str> = pieces
                .iter()
                .map(|piece| match piece {
                    Piece::Text(text) => text,
                    Piece::Of(span) => snapshot.ide.compilation.sources.slice(*span),
                })
                .collect();
            draft.edit(&path, at.range(), new.concat());
        }
        Change::Remove(at) => draft.edit(&path, blocks()?.removed(&at.range())?, ""),
        Change::Add(to, near, statement) => {
            let (at, new) = blocks()?.insertion(*to, &near.range(), statement)?;
            draft.edit(&path, at, new);
        }
        Change::MoveBefore(what, before) => {
            let blocks = blocks()?;
            let (what, before) = (blocks.statement(&what.range())?, blocks.statement(&before.range())?);
            let line = blocks.line_start(before.bytes.start);
            let moved = blocks.lines(&what.bytes)?;
            let new = code.get(what.bytes.clone())?;
            if moved.start < before.bytes.end {
                return None;
            }
            draft.edit(&path, line..line, format!("{}{new}\n", blocks.indent(before.bytes.start)));
            draft.edit(&path, moved, "");
        }
        Change::MoveToEntity(what, for_mode) => {
            let (moved, at, new) = to_entity(&blocks()?, &what.range(), *for_mode)?;
            draft.edit(&path, moved, "");
            draft.edit(&path, at, new);
        }
        Change::Rename(at, to) => {
            let at = FileOffset { path, byte: at.range().start };
            for edit in rename(view, &at, to).ok()?.edits {
                draft.edit(&edit.at.path, edit.at.bytes, edit.new_text);
            }
        }
        Change::AddArguments(at, arguments) => {
            let (at, new) = with_arguments(code, *at, arguments)?;
            draft.edit(&path, at, new);
        }
        Change::AddLine(model, after, line) => {
            let start = code.get(..model.range().start)?.rfind('\n').map_or(0, |at| at + 1);
            let head = code.get(start..)?;
            let indent = &head[..head.len() - head.trim_start_matches([' ', '\t']).len()];
            let end = code.get(..after.range().end)?.trim_end().len();
            let end = end + code.get(end..)?.find('\n').unwrap_or(code.len() - end);
            draft.edit(&path, end..end, format!("\n{indent}{line}"));
        }
    }
    Some(())
}

/// What is removed, and the insertion into the entity.
fn to_entity(blocks: &Blocks<'_>, at: &Range<usize>, for_mode: bool) -> Option<(Range<usize>, Range<usize>, String)> {
    let statement = blocks.statement(at)?;
    let mode = blocks.innermost(&statement.bytes, &[Rule::mode])?;
    let mut new = blocks.code.get(statement.bytes.clone())?.to_string();
    if for_mode {
        // Only colliders have a condition, and only one without a guard can get one.
        let name = blocks.inside(&mode.bytes).find(|node| node.rule == Rule::name)?;
        let has_guard = blocks.inside(&statement.bytes).any(|node| node.rule == Rule::kw_when);
        if statement.rule != Rule::collider || has_guard {
            return None;
        }
        new = format!("{new} when in {}", blocks.code.get(name.bytes.clone())?);
    } else if statement.rule == Rule::collider {
        return None;
    }
    let (insert, new) = blocks.insertion(BlockKind::Entity, at, &new)?;
    let removed = blocks.lines(&statement.bytes)?;
    (insert.end <= removed.start || removed.end <= insert.start).then_some((removed, insert, new))
}

/// Adds arguments to the call at a span: of `0, 0, 0, 0` for `rect(16, 16)` the first two, before those that are there,
/// since a size comes last; for other functions the last ones.
fn with_arguments(code: &str, at: Span, arguments: &str) -> Option<(Range<usize>, String)> {
    let call = at.range();
    let name: String = code.get(call.start..)?.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    let blocks = Blocks::of(code)?;
    if name == "use" {
        let put = blocks.around(&call).find(|node| node.rule == Rule::put)?;
        let end = put.bytes.end;
        let text = code.get(put.bytes.clone())?;
        let Some(inside) = text.strip_suffix(')') else { return Some((end..end, format!("({arguments})"))) };
        let separator = if inside.trim_end().ends_with('(') { "" } else { ", " };
        return Some((end - 1..end - 1, format!("{separator}{arguments}")));
    }
    let node = blocks.around(&call).find(|node| matches!(node.rule, Rule::shape | Rule::call))?;
    let open = node.bytes.start + code.get(node.bytes.clone())?.find('(')? + 1;
    let close = node.bytes.start + code.get(node.bytes.clone())?.rfind(')')?;
    let is_direct = |bytes: &Range<usize>| {
        let inner = blocks.around(bytes).find(|n| matches!(n.rule, Rule::shape | Rule::call));
        inner.is_some_and(|inner| inner.bytes == node.bytes)
    };
    let rule = if node.rule == Rule::shape { Rule::expression } else { Rule::argument };
    let outer = |bytes: &Range<usize>| {
        blocks.around(bytes).filter(|n| n.rule == rule && n.bytes.start >= open && n.bytes != *bytes).count() == 0
    };
    let given = blocks.inside(&(open..close)).filter(|n| n.rule == rule && is_direct(&n.bytes) && outer(&n.bytes));
    let given = given.count();
    let missing = arguments.split(", ").count().checked_sub(given).filter(|missing| *missing > 0)?;
    let zeros = vec!["0"; missing].join(", ");
    match (node.rule, given) {
        (_, 0) => Some((open..close, zeros)),
        (Rule::shape, _) => Some((open..open, format!("{zeros}, "))),
        _ => Some((close..close, format!(", {zeros}"))),
    }
}
