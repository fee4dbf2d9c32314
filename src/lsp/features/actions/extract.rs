//! Refactorings that name a part of the program: a constant, a parameter, a condition, a behaviour.

use std::ops::Range;
use std::path::Path;

use crate::diagnostic::suggestion::BlockKind;
use crate::lsp::text::lexer::words;
use crate::syntax::Rule;

use super::blocks::Blocks;
use super::draft::Draft;
use super::{ActionKind, Candidate};

/// The extractions at a range: of what is selected, or of the number or the guard around the cursor.
pub(super) fn candidates(path: &Path, blocks: &Blocks<'_>, bytes: &Range<usize>) -> Vec<Candidate> {
    let Some(selected) = trimmed(blocks.code, bytes) else { return Vec::new() };
    let extraction = Extraction { path, blocks };
    let mut out = Vec::new();
    if let Some(value) = extraction.value(&selected) {
        out.extend(extraction.constant(&value));
        out.extend(extraction.parameter(&value));
    }
    if let Some(guard) = extraction.guard(&selected) {
        out.extend(extraction.condition(&guard));
    }
    if !selected.is_empty() {
        out.extend(extraction.behavior(&selected));
    }
    out
}

/// A range without the blanks at its ends.
fn trimmed(code: &str, bytes: &Range<usize>) -> Option<Range<usize>> {
    let text = code.get(bytes.clone())?;
    let start = bytes.start + (text.len() - text.trim_start().len());
    Some(if text.trim().is_empty() { bytes.clone() } else { start..start + text.trim().len() })
}

/// A name that no word of a text has.
pub(super) fn unused(code: &str, name: &str) -> String {
    let is_used = |name: &str| words(code).any(|word| word == name);
    let numbered = (2..).map(|number| format!("{name}{number}"));
    std::iter::once(name.to_string()).chain(numbered).find(|name| !is_used(name)).unwrap_or_default()
}

struct Extraction<'a> {
    path: &'a Path,
    blocks: &'a Blocks<'a>,
}

impl Extraction<'_> {
    fn text(&self, at: &Range<usize>) -> &str {
        self.blocks.code.get(at.clone()).unwrap_or_default()
    }

    fn candidate(&self, title: &str, keeps_program: bool, edits: [(Range<usize>, String); 2]) -> Candidate {
        let mut draft = Draft::default();
        for (at, new) in edits {
            draft.edit(self.path, at, new);
        }
        Candidate { title: title.into(), kind: ActionKind::Extract, keeps_program, draft }
    }

    /// What is selected in an expression, or the number at the cursor.
    fn value(&self, selected: &Range<usize>) -> Option<Range<usize>> {
        let value = match selected.is_empty() {
            true => self.blocks.innermost(selected, &[Rule::number])?.bytes.clone(),
            false => selected.clone(),
        };
        let around = self.blocks.innermost(&value, &[Rule::expression])?;
        // The value of a declaration has a name.
        let is_named = self.blocks.around(&around.bytes).find(|node| node.bytes != around.bytes);
        let is_named = is_named.is_some_and(|node| matches!(node.rule, Rule::constant | Rule::parameter));
        (!(is_named && around.bytes == value)).then_some(value)
    }

    fn constant(&self, value: &Range<usize>) -> Option<Candidate> {
        let item = self.blocks.innermost(value, &[Rule::entity, Rule::behavior, Rule::world, Rule::constant])?;
        let name = unused(self.blocks.code, "new_constant");
        let statement = format!("const {name} = {}", self.text(value));
        let constants = self.blocks.inside(&(0..value.start)).filter(|node| node.rule == Rule::constant);
        let insertion = match constants.last().filter(|_| item.rule != Rule::constant) {
            Some(last) => (last.bytes.end..last.bytes.end, format!("\n{statement}")),
            None => {
                let start = self.blocks.lines(&item.bytes)?.start;
                let gap = if item.rule == Rule::constant { "\n" } else { "\n\n" };
                (start..start, format!("{statement}{gap}"))
            }
        };
        Some(self.candidate("extract a constant", true, [insertion, (value.clone(), name)]))
    }

    fn parameter(&self, value: &Range<usize>) -> Option<Candidate> {
        self.blocks.innermost(value, &[Rule::entity])?;
        let name = unused(self.blocks.code, "new_param");
        let statement = format!("param {name} = {}", self.text(value));
        let insertion = self.blocks.insertion(BlockKind::Entity, value, &statement)?;
        let is_apart = insertion.0.end <= value.start || value.end <= insertion.0.start;
        is_apart.then(|| self.candidate("extract a parameter", false, [insertion, (value.clone(), name)]))
    }

    /// What is selected in a guard, or the guard at the cursor.
    fn guard(&self, selected: &Range<usize>) -> Option<Range<usize>> {
        let owners = [Rule::edge, Rule::follow, Rule::collider, Rule::invariant, Rule::goal, Rule::never];
        let owner = self.blocks.innermost(selected, &owners)?;
        let guard = self.blocks.inside(&owner.bytes).find(|node| node.rule == Rule::expression)?;
        // Its end holds the white space before what follows.
        let guard = trimmed(self.blocks.code, &guard.bytes)?;
        let is_inside = guard.start <= selected.start && selected.end <= guard.end;
        let guard = if selected.is_empty() { guard } else { selected.clone() };
        let is_name = self.text(&guard).chars().all(|c| c.is_alphanumeric() || c == '_');
        let binds = self.blocks.inside(&guard).any(|node| node.rule == Rule::binding);
        (is_inside && !is_name && !binds).then_some(guard)
    }

    fn condition(&self, guard: &Range<usize>) -> Option<Candidate> {
        let owner = self.blocks.innermost(guard, &[Rule::entity, Rule::behavior, Rule::world])?;
        let to = if owner.rule == Rule::world { BlockKind::World } else { BlockKind::Entity };
        let name = unused(self.blocks.code, "new_condition");
        let statement = format!("condition {name} = {}", self.text(guard));
        let insertion = self.blocks.insertion(to, guard, &statement)?;
        Some(self.candidate("extract a condition", true, [insertion, (guard.clone(), name)]))
    }

    /// The statements of an entity or a mode that are selected.
    fn behavior(&self, selected: &Range<usize>) -> Option<Candidate> {
        let entity = self.blocks.innermost(selected, &[Rule::entity])?;
        let block = self.blocks.innermost(selected, &[Rule::block])?;
        let chosen: Vec<_> = self.blocks.statements(&block.bytes);
        let chosen: Vec<_> = chosen
            .into_iter()
            .filter(|node| selected.start <= node.bytes.start && node.bytes.end <= selected.end)
            .collect();
        let (first, last) = (chosen.first()?, chosen.last()?);
        if first.bytes.start != selected.start || last.bytes.end != selected.end {
            return None;
        }
        let name = unused(self.blocks.code, "NewBehavior");
        let start = self.blocks.lines(&entity.bytes)?.start;
        let outer = self.blocks.indent(selected.start);
        let lines: Vec<String> = self
            .text(selected)
            .lines()
            .map(|line| line.strip_prefix(outer).unwrap_or(line))
            .map(|line| if line.is_empty() { String::new() } else { format!("    {line}") })
            .collect();
        let behavior = format!("behavior {name} {{\n{}\n}}\n\n", lines.join("\n"));
        let edits = [(start..start, behavior), (selected.clone(), format!("use {name}"))];
        Some(self.candidate("extract a behavior", true, edits))
    }
}
