//! Renaming, in all files that name a thing. A new name is tried out first: every program that changes is compiled as it
//! would be, and must mean what it meant before.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::PathBuf;
use std::sync::Arc;

use gen_lsp_types as types;
use gen_lsp_types::{TextEdit, Uri, WorkspaceEdit};

use crate::diagnostic::Severity;
use crate::source::{FileId, Span};
use crate::syntax::is_name;
use crate::syntax::occurrence::{NameKind, Occurrence};

use crate::lsp::documents::{Document, Open};
use crate::lsp::snapshot::{Key, Snapshot};
use crate::lsp::text::document_text::Text;
use crate::lsp::view::{Failure, View};

/// Where a name is in each file, in order: first and one past the last byte.
type Places = BTreeMap<PathBuf, Vec<(u32, u32)>>;

/// A renaming that was tried out.
pub(in crate::lsp) struct Renaming {
    pub old: String,
    pub new: String,
    pub edit: WorkspaceEdit,
}

impl View {
    pub(in crate::lsp) fn prepare_rename(
        &self,
        params: types::PrepareRenameParams,
    ) -> Result<Option<types::PrepareRenameResult>, Failure> {
        let positions = self.positions(&params.text_document_position_params);
        let Some((position, o)) = positions.iter().find_map(|position| Some((position, position.names.first()?)))
        else {
            return Ok(None);
        };
        let snapshot = position.snapshot;
        let keys = BTreeSet::from([snapshot.key(o)]);
        self.renamable(&keys)?;
        let range = snapshot.range(o.at, self.client.encoding);
        let placeholder = snapshot.name(o).to_string();
        Ok(Some(types::PrepareRenamePlaceholder { range, placeholder }.into()))
    }

    pub(in crate::lsp) fn rename(&self, params: types::RenameParams) -> Result<Renaming, Failure> {
        let new = params.new_name.trim();
        let mut keys = self.keys_at(&params.text_document_position_params);
        if keys.is_empty() {
            return Err(Failure::refused("there is no name here"));
        }
        if !is_name(new) {
            return Err(Failure::refused(format!("`{new}` is no name: a letter or `_`, then letters, digits and `_`")));
        }
        self.close_over(&mut keys);
        self.renamable(&keys)?;
        let mut places = Places::new();
        for (snapshot, o) in self.places(&keys) {
            places.entry(snapshot.path(o.at.file()).to_path_buf()).or_default().push((o.at.start(), o.at.end()));
        }
        self.try_out(&places, new)?;
        let mut changes: HashMap<Uri, Vec<TextEdit>> = HashMap::new();
        for (snapshot, o) in self.places(&keys) {
            let edit = TextEdit { range: snapshot.range(o.at, self.client.encoding), new_text: new.into() };
            changes.entry(snapshot.uri(o.at.file())).or_default().push(edit);
        }
        let old = keys.first().map(|key| key.name.clone()).unwrap_or_default();
        let edit = WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() };
        Ok(Renaming { old, new: new.to_string(), edit })
    }

    /// Adds what else is named where these names are: a word of a behaviour can mean something in several entities.
    fn close_over(&self, keys: &mut BTreeSet<Key>) {
        loop {
            let before = keys.len();
            for known in self.known.values() {
                let snapshot = &*known.now;
                let places: BTreeSet<Span> = snapshot.matching(keys).map(|o| o.at).collect();
                let here = snapshot.ide.occurrences.iter().filter(|o| places.contains(&o.at));
                keys.extend(here.map(|o| snapshot.key(o)));
            }
            if keys.len() == before {
                return;
            }
        }
    }

    /// Whether the program alone says what these names are.
    fn renamable(&self, keys: &BTreeSet<Key>) -> Result<(), Failure> {
        for key in keys {
            let name = &key.name;
            for known in self.known.values() {
                let snapshot = &*known.now;
                if key.kind == NameKind::Tag && snapshot.ide.checked.level_tags.contains(name) {
                    return Err(Failure::refused(format!("a level or a legend names the tag `{name}`, too")));
                }
                for o in snapshot.matching(&BTreeSet::from([key.clone()])) {
                    let declared = snapshot.ide.compilation.sources.slice(o.declared);
                    if key.kind == NameKind::Variable && declared != name {
                        return Err(Failure::refused(format!("`{name}` is part of the language")));
                    }
                    if declared != name {
                        return Err(Failure::refused(format!("`{name}` is named by a level")));
                    }
                }
            }
        }
        Ok(())
    }

    /// Compiles all programs that hold a place as they would be.
    fn try_out(&self, places: &Places, new: &str) -> Result<(), Failure> {
        let touched = |s: &Snapshot| places.keys().any(|path| s.file(path).is_some());
        let mut open: Open = (**self.documents.all()).clone();
        for known in self.known.values() {
            for (path, spans) in places {
                let Some(file) = known.now.file(path) else { continue };
                let mut code = known.now.text(file).code().to_string();
                for (start, end) in spans.iter().rev() {
                    if code.get(*start as usize..*end as usize).is_some() {
                        code.replace_range(*start as usize..*end as usize, new);
                    }
                }
                let text = Arc::new(Text::new(code));
                let document = Document { uri: known.now.uri(file), version: 0, is_program: true, text };
                open.insert(path.clone(), document);
            }
        }
        let open = Arc::new(open);
        for known in self.known.values().filter(|known| touched(&known.now)) {
            let before = &*known.now;
            let after = Snapshot::of(&before.root, &open, &*self.disk);
            let errors = |s: &Snapshot| s.ide.compilation.diagnostics.counts().0;
            if errors(&after) > errors(before) {
                let messages = |s: &Snapshot| -> Vec<String> {
                    let found = s.ide.compilation.diagnostics.iter();
                    found.filter(|d| d.severity == Severity::Error).map(|d| d.message.clone()).collect()
                };
                let known = messages(before);
                let why = messages(&after).into_iter().find(|m| !known.contains(m)).unwrap_or_default();
                return Err(Failure::refused(format!("`{new}` clashes: {why}")));
            }
            if meaning(before, places, new.len() as u32) != meaning(&after, &Places::new(), 0) {
                return Err(Failure::refused(format!("with `{new}`, a name would come to mean something else")));
            }
        }
        Ok(())
    }
}

/// Where each name is and where it is declared, as it is once the places have names of another length.
fn meaning(snapshot: &Snapshot, places: &Places, length: u32) -> BTreeSet<(FileId, u32, NameKind, FileId, u32)> {
    let moved = |at: Span| {
        let before =
            places.get(snapshot.path(at.file())).into_iter().flatten().filter(|(start, _)| *start < at.start());
        before.fold(i64::from(at.start()), |start, (a, b)| start + i64::from(length) - i64::from(b - a)) as u32
    };
    let all = snapshot.ide.occurrences.iter();
    all.map(|o: &Occurrence| (o.at.file(), moved(o.at), o.kind, o.declared.file(), moved(o.declared))).collect()
}
