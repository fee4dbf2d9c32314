//! Rename of a symbol in all files. The edit is verified first: every affected program is compiled with the new name,
//! and must have no new errors and the same bindings of names.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

use crate::diagnostic::Severity;
use crate::source::{FileId, Span};
use crate::syntax::is_name;
use crate::syntax::occurrence::{NameKind, Occurrence};

use super::navigate::{all_occurrences, keys_at, positions};
use crate::lsp::documents::{Document, OpenDocuments};
use crate::lsp::location::{Edit, FileOffset, Location};
use crate::lsp::snapshot::{Snapshot, SymbolKey};
use crate::lsp::view::{Refusal, View};

/// The ranges of a name in each file, in order: start and end offset.
type NameRanges = BTreeMap<PathBuf, Vec<(u32, u32)>>;

/// A name that can be renamed.
pub(in crate::lsp) struct Renamable {
    pub name: String,
    pub at: Location,
}

/// A verified rename.
pub(in crate::lsp) struct Renaming {
    pub old: String,
    pub new: String,
    pub edits: Vec<Edit>,
}

/// The name at a position, if there is one.
pub(in crate::lsp) fn prepare_rename(view: &View, at: &FileOffset) -> Result<Option<Renamable>, Refusal> {
    let positions = positions(view, at);
    let Some((position, o)) = positions.iter().find_map(|position| Some((position, position.names.first()?))) else {
        return Ok(None);
    };
    let snapshot = position.snapshot;
    check_renamable(view, &BTreeSet::from([snapshot.key(o)]))?;
    Ok(Some(Renamable { name: snapshot.name(o).to_string(), at: snapshot.location(o.at) }))
}

/// Renames the symbol at a position.
pub(in crate::lsp) fn rename(view: &View, at: &FileOffset, new: &str) -> Result<Renaming, Refusal> {
    let new = new.trim();
    let mut keys = keys_at(view, at);
    if keys.is_empty() {
        return Err(Refusal("there is nothing to rename here".into()));
    }
    if !is_name(new) {
        return Err(Refusal(format!("`{new}` is not a valid name: a letter or `_`, then letters, digits and `_`")));
    }
    add_related(view, &mut keys);
    check_renamable(view, &keys)?;
    check_unused(view, &keys, new)?;
    let found = all_occurrences(view, &keys);
    let mut spans = NameRanges::new();
    for (snapshot, o) in &found {
        spans.entry(snapshot.path(o.at.file()).to_path_buf()).or_default().push((o.at.start(), o.at.end()));
    }
    verify(view, &spans, new)?;
    let edits = found.iter().map(|(snapshot, o)| Edit { at: snapshot.location(o.at), new_text: new.into() });
    let old = keys.first().map(|key| key.name.clone()).unwrap_or_default();
    Ok(Renaming { old, new: new.to_string(), edits: edits.collect() })
}

/// Adds all symbols that share an occurrence with these: a name in a behaviour can refer to symbols of several
/// entities.
fn add_related(view: &View, keys: &mut BTreeSet<SymbolKey>) {
    loop {
        let before = keys.len();
        for state in view.programs.values() {
            let snapshot = &*state.current;
            let places: BTreeSet<Span> = snapshot.occurrences_of(keys).map(|o| o.at).collect();
            let here = snapshot.ide.occurrences.iter().filter(|o| places.contains(&o.at));
            keys.extend(here.map(|o| snapshot.key(o)));
        }
        if keys.len() == before {
            return;
        }
    }
}

/// Refuses symbols whose names are given by the language or by levels.
fn check_renamable(view: &View, keys: &BTreeSet<SymbolKey>) -> Result<(), Refusal> {
    for key in keys {
        let name = &key.name;
        for state in view.programs.values() {
            let snapshot = &*state.current;
            if key.kind == NameKind::Tag && snapshot.ide.checked.level_tags.contains(name) {
                return Err(Refusal(format!("a level or a legend also uses the tag `{name}`")));
            }
            for o in snapshot.occurrences_of(&BTreeSet::from([key.clone()])) {
                let declared = snapshot.ide.compilation.sources.slice(o.declared);
                if key.kind == NameKind::Variable && declared != name {
                    return Err(Refusal(format!("`{name}` is part of the language")));
                }
                if declared != name {
                    return Err(Refusal(format!("`{name}` is used by a level")));
                }
            }
        }
    }
    Ok(())
}

/// Refuses a new name for a tag that another tag has: the two would become one.
fn check_unused(view: &View, keys: &BTreeSet<SymbolKey>, new: &str) -> Result<(), Refusal> {
    if !keys.iter().any(|key| key.kind == NameKind::Tag && key.name != new) {
        return Ok(());
    }
    let has_tag = |snapshot: &Snapshot| {
        let mut all = snapshot.ide.occurrences.iter().filter(|o| o.kind == NameKind::Tag);
        snapshot.ide.checked.level_tags.contains(new) || all.any(|o| snapshot.name(o) == new)
    };
    let is_affected = |snapshot: &Snapshot| snapshot.occurrences_of(keys).next().is_some();
    let mut affected = view.programs.values().map(|state| &*state.current).filter(|snapshot| is_affected(snapshot));
    match affected.any(has_tag) {
        true => Err(Refusal(format!("there is a tag `{new}` already: the two would be one"))),
        false => Ok(()),
    }
}

/// Compiles the affected programs with the new name; refuses it if there are new errors or other bindings.
fn verify(view: &View, ranges: &NameRanges, new: &str) -> Result<(), Refusal> {
    let touched = |s: &Snapshot| ranges.keys().any(|path| s.file(path).is_some());
    let mut open: OpenDocuments = (**view.documents.all()).clone();
    for state in view.programs.values() {
        for (path, spans) in ranges {
            let Some(file) = state.current.file(path) else { continue };
            let old = state.current.text(file);
            let mut code = old.code().to_string();
            for (start, end) in spans.iter().rev() {
                if code.get(*start as usize..*end as usize).is_some() {
                    code.replace_range(*start as usize..*end as usize, new);
                }
            }
            let text = Arc::new(old.replaced(code));
            let document = Document { uri: String::new(), version: 0, is_program: true, text, edited: None };
            open.insert(path.clone(), document);
        }
    }
    let open = Arc::new(open);
    for state in view.programs.values().filter(|state| touched(&state.current)) {
        let before = &*state.current;
        let after = Snapshot::compile(&before.root, &open, &*view.disk, Some(before));
        let errors = |s: &Snapshot| s.ide.compilation.diagnostics.counts().0;
        if errors(&after) > errors(before) {
            let messages = |s: &Snapshot| -> Vec<String> {
                let found = s.ide.compilation.diagnostics.iter();
                found.filter(|d| d.severity == Severity::Error).map(|d| d.message.clone()).collect()
            };
            let known = messages(before);
            let why = messages(&after).into_iter().find(|m| !known.contains(m)).unwrap_or_default();
            return Err(Refusal(format!("`{new}` clashes: {why}")));
        }
        if bindings(before, ranges, new.len() as u32) != bindings(&after, &NameRanges::new(), 0) {
            return Err(Refusal(format!("with `{new}`, a name would refer to something else")));
        }
    }
    Ok(())
}

/// The bindings of a program: position, kind and declaration of each occurrence. Positions are adjusted as if the names
/// in `ranges` had another length.
fn bindings(snapshot: &Snapshot, ranges: &NameRanges, length: u32) -> BTreeSet<(FileId, u32, NameKind, FileId, u32)> {
    let moved = |at: Span| {
        let before =
            ranges.get(snapshot.path(at.file())).into_iter().flatten().filter(|(start, _)| *start < at.start());
        before.fold(i64::from(at.start()), |start, (a, b)| start + i64::from(length) - i64::from(b - a)) as u32
    };
    let all = snapshot.ide.occurrences.iter();
    all.map(|o: &Occurrence| (o.at.file(), moved(o.at), o.kind, o.declared.file(), moved(o.declared))).collect()
}
