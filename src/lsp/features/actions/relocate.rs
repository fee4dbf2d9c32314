//! The refactoring that moves an entity or a behaviour to a file of its own, with the imports that both files need.

use std::ops::Range;
use std::path::Path;

use crate::lsp::snapshot::Snapshot;
use crate::syntax::Rule;

use super::blocks::Blocks;
use super::create::import;
use super::draft::Draft;
use super::{ActionKind, Candidate};

/// Moves the entity or the behaviour whose head is at a range.
pub(super) fn candidate(
    snapshot: &Snapshot,
    path: &Path,
    blocks: &Blocks<'_>,
    bytes: &Range<usize>,
) -> Option<Candidate> {
    let item = blocks.innermost(bytes, &[Rule::entity, Rule::behavior])?;
    let code = blocks.code;
    let head = item.bytes.start + code.get(item.bytes.clone())?.find('{')?;
    let is_at_head = bytes.start <= head;
    let items = blocks.inside(&(0..code.len())).filter(|node| is_item(node.rule)).count();
    if !is_at_head || items < 2 {
        return None;
    }
    let name = blocks.inside(&item.bytes).find(|node| node.rule == Rule::name)?;
    let name = code.get(name.bytes.clone())?;
    let file = format!("{}.hyped", snake_case(name));
    let target = path.parent()?.join(&file);
    // A file that is there is not overwritten; nor is one that the program tries to import.
    if target == path || snapshot.dependencies.contains(&target) || snapshot.file(&target).is_some() {
        return None;
    }
    let moved = blocks.lines(&item.bytes)?;
    // What the file imports may be needed there, too.
    let imports: Vec<&str> = blocks
        .inside(&(0..code.len()))
        .filter(|node| node.rule == Rule::import)
        .filter_map(|node| code.get(node.bytes.clone()))
        .collect();
    let body = code.get(moved.clone())?.trim();
    let text = if imports.is_empty() { format!("{body}\n") } else { format!("{}\n\n{body}\n", imports.join("\n")) };
    let mut draft = Draft::default();
    let (at, new) = import(code, &file);
    draft.edit(path, moved, "");
    draft.edit(path, at, new);
    draft.new_files.insert(target, text);
    let title = format!("move `{name}` to `{file}`");
    Some(Candidate { title, kind: ActionKind::Move, keeps_program: true, draft })
}

fn is_item(rule: Rule) -> bool {
    matches!(rule, Rule::entity | Rule::behavior | Rule::world | Rule::constant)
}

/// `FireBall` as `fire_ball`.
fn snake_case(name: &str) -> String {
    let mut out = String::new();
    let mut was_lower = false;
    for c in name.chars() {
        if c.is_uppercase() && was_lower {
            out.push('_');
        }
        was_lower = c.is_lowercase() || c.is_numeric();
        out.extend(c.to_lowercase());
    }
    out
}
