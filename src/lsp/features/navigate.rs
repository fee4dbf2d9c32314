//! Navigation by names in all programs that contain a file: definition, references, highlights, workspace symbols,
//! document links.

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::ordered::Ordered;
use crate::source::{FileId, Span, normalize};
use crate::syntax::ast;
use crate::syntax::ast::{Item, MapSource, Name};
use crate::syntax::occurrence::{NameKind, Occurrence, Role};

use crate::lsp::location::{FileOffset, Location};
use crate::lsp::snapshot::{Snapshot, SymbolKey};
use crate::lsp::text::alignment::Alignment;
use crate::lsp::text::document_text::Text;
use crate::lsp::text::lexer::{Kind, tokens};
use crate::lsp::view::{ProgramState, View};

/// Maximum number of workspace symbols in a response.
const MAX_SYMBOLS: usize = 500;

/// A position in one of the programs that contain the file.
pub(super) struct ProgramPosition<'a> {
    pub state: &'a ProgramState,
    /// The current snapshot, or the last one without errors.
    pub snapshot: &'a Snapshot,
    pub file: FileId,
    /// The names at the position.
    pub names: Vec<Occurrence>,
}

/// A position in all programs that contain the file, the one whose root it is first.
pub(super) fn positions<'v>(view: &'v View, at: &FileOffset) -> Vec<ProgramPosition<'v>> {
    let positions = view.programs_with(&at.path).filter_map(|state| {
        let snapshot = &*state.current;
        let file = snapshot.file(&at.path)?;
        let names = snapshot.names_at(file, view.byte_in(snapshot, file, at.byte));
        Some(ProgramPosition { state, snapshot, file, names })
    });
    positions.collect()
}

/// As [`positions`]; a name that does not resolve because of errors is looked up in the last snapshots without errors.
pub(super) fn last_known_positions<'v>(view: &'v View, at: &FileOffset) -> Vec<ProgramPosition<'v>> {
    let positions = positions(view, at);
    let word = view.documents.get(&at.path).and_then(|document| {
        let code = document.text.code();
        Some((code, word_at(code, at.byte)?))
    });
    let Some((code, word)) = word.filter(|_| positions.iter().all(|position| position.names.is_empty())) else {
        return positions;
    };
    let name = code.get(word.clone()).unwrap_or_default();
    let renamed = view.last_rename.as_ref().filter(|(_, new)| new == name).map(|(old, _)| old.as_str());
    let positions = view.programs_with(&at.path).filter_map(|state| {
        let snapshot = state.last_good.as_deref().filter(|_| !state.current.is_error_free())?;
        let file = snapshot.file(&at.path)?;
        let text = snapshot.text(file);
        let mut names = snapshot.names_at(file, Alignment::between(text.code(), code).old_offset(word.start)?);
        names.retain(|o| snapshot.name(o) == name || renamed == Some(snapshot.name(o)));
        Some(ProgramPosition { state, snapshot, file, names })
    });
    positions.collect()
}

/// The location of a span in the current text of its document; `None` if the line has changed.
fn current_location(view: &View, snapshot: &Snapshot, at: Span) -> Option<Location> {
    let then = snapshot.location(at);
    match view.documents.get(&then.path) {
        Some(document) if document.text != then.text => {
            let bytes = Alignment::between(then.text.code(), document.text.code()).new_range(then.bytes)?;
            Some(Location { path: then.path, text: Arc::clone(&document.text), bytes })
        }
        _ => Some(then),
    }
}

/// The symbols at a position.
pub(super) fn keys_at(view: &View, at: &FileOffset) -> BTreeSet<SymbolKey> {
    let positions = positions(view, at);
    positions.iter().flat_map(|position| position.names.iter().map(|o| position.snapshot.key(o))).collect()
}

/// The occurrences of symbols in all programs, in order of position, without duplicates.
pub(super) fn all_occurrences<'v>(view: &'v View, keys: &BTreeSet<SymbolKey>) -> Vec<(&'v Snapshot, Occurrence)> {
    let mut seen: BTreeSet<(PathBuf, u32)> = BTreeSet::new();
    let mut out = Vec::new();
    for state in view.programs.values() {
        let snapshot = &*state.current;
        for o in snapshot.occurrences_of(keys) {
            if seen.insert((snapshot.path(o.at.file()).to_path_buf(), o.at.start())) {
                out.push((snapshot, o));
            }
        }
    }
    out.order_by(|(a, x), (b, y)| (a.path(x.at.file()), x.at.start()).cmp(&(b.path(y.at.file()), y.at.start())));
    out
}

/// The result of a definition request.
#[derive(Debug)]
pub(in crate::lsp) enum Definition {
    /// The file that a path at the position refers to.
    File(PathBuf),
    /// The declarations of a name; several for a tag, or if several programs declare it.
    Declarations(Vec<Location>),
}

/// The definition of the name or path at a position.
pub(in crate::lsp) fn definition(view: &View, at: &FileOffset) -> Definition {
    if let Some(path) = file_at(view, at) {
        return Definition::File(path);
    }
    let mut out: Vec<Location> = Vec::new();
    for position in last_known_positions(view, at) {
        let snapshot = position.snapshot;
        for o in nearest_values(&position.names) {
            let declared: Vec<Span> = match o.kind {
                NameKind::Tag => {
                    let all = snapshot.occurrences_of(&BTreeSet::from([snapshot.key(&o)]));
                    all.filter(|o| o.role == Role::Declared).map(|o| o.at).collect()
                }
                _ => vec![o.declared],
            };
            for location in declared.into_iter().filter_map(|span| current_location(view, snapshot, span)) {
                if !out.contains(&location) {
                    out.push(location);
                }
            }
        }
    }
    Definition::Declarations(out)
}

/// The references to a name in all programs.
pub(in crate::lsp) fn references(view: &View, at: &FileOffset, with_declarations: bool) -> Vec<Location> {
    let keys = keys_at(view, at);
    let places = all_occurrences(view, &keys).into_iter();
    let wanted = places.filter(|(_, o)| with_declarations || o.role != Role::Declared);
    wanted.map(|(snapshot, o)| snapshot.location(o.at)).collect()
}

/// An occurrence of a name in the file of the request.
#[derive(Debug)]
pub(in crate::lsp) struct Highlight {
    pub at: Location,
    pub role: Role,
}

/// The occurrences of the name at a position in its file; `None` if there is no name.
pub(in crate::lsp) fn highlights(view: &View, at: &FileOffset) -> Option<Vec<Highlight>> {
    let positions = positions(view, at);
    let position = positions.iter().find(|position| !position.names.is_empty())?;
    let snapshot = position.snapshot;
    let keys: BTreeSet<SymbolKey> = position.names.iter().map(|o| snapshot.key(o)).collect();
    let mut out: Vec<Highlight> = Vec::new();
    for o in snapshot.occurrences_of(&keys).filter(|o| o.at.file() == position.file) {
        if !out.iter().any(|known| known.at.bytes == o.at.range()) {
            out.push(Highlight { at: snapshot.location(o.at), role: o.role });
        }
    }
    Some(out)
}

/// A declaration in the workspace.
#[derive(Debug)]
pub(in crate::lsp) struct WorkspaceSymbol {
    pub name: String,
    pub kind: NameKind,
    pub at: Location,
    /// The entity, behaviour or world that it is in.
    pub container: Option<String>,
}

/// The declarations in all programs whose names match a query. Names that start with the query come first, then by
/// length.
pub(in crate::lsp) fn workspace_symbols(view: &View, query: &str) -> Vec<WorkspaceSymbol> {
    let mut seen: BTreeSet<(PathBuf, u32)> = BTreeSet::new();
    let mut found: Vec<(bool, WorkspaceSymbol)> = Vec::new();
    for state in view.programs.values() {
        let snapshot = &*state.current;
        let declared = snapshot.ide.occurrences.iter().filter(|o| o.role == Role::Declared);
        for o in declared.filter(|o| is_listed(o.kind)) {
            let name = snapshot.name(o);
            let Some(begins) = fuzzy_match(name, query) else { continue };
            if !seen.insert((snapshot.path(o.at.file()).to_path_buf(), o.at.start())) {
                continue;
            }
            let container = container(snapshot, o.at).map(|c| snapshot.name(c).to_string());
            let at = snapshot.location(o.at);
            found.push((!begins, WorkspaceSymbol { name: name.into(), kind: o.kind, at, container }));
        }
    }
    found.sort_by_cached_key(|(later, symbol)| (*later, symbol.name.len(), symbol.name.clone()));
    found.truncate(MAX_SYMBOLS);
    found.into_iter().map(|(_, symbol)| symbol).collect()
}

/// A path of a file in a text.
#[derive(Debug)]
pub(in crate::lsp) struct Link {
    pub bytes: Range<usize>,
    pub target: PathBuf,
}

/// The paths of files in a text, resolved.
pub(in crate::lsp) fn document_links(path: &Path, text: &Text) -> Vec<Link> {
    let link = |name: &Name| Link { bytes: inside_quotes(name, text.code()), target: resolve(path, &name.text) };
    named_files(text.tree()).into_iter().map(link).collect()
}

/// The file whose path is at a position.
fn file_at(view: &View, at: &FileOffset) -> Option<PathBuf> {
    let document = view.documents.get(&at.path)?;
    let name = named_files(document.text.tree()).into_iter().find(|name| name.span.range().contains(&at.byte))?;
    Some(resolve(&at.path, &name.text))
}

/// If several equal sets declare a value, keeps the nearest preceding declaration.
fn nearest_values(names: &[Occurrence]) -> Vec<Occurrence> {
    let is_value = |o: &&Occurrence| o.kind == NameKind::Value && o.declared.file() == o.at.file();
    let before = names.iter().filter(is_value).filter(|o| o.declared.start() <= o.at.start());
    match before.max_by_key(|o| o.declared.start()) {
        Some(nearest) => vec![*nearest],
        None => names.to_vec(),
    }
}

/// Whether a name starts with a query; `None` if it does not contain the letters of the query in order.
fn fuzzy_match(name: &str, query: &str) -> Option<bool> {
    let (name, query) = (name.to_lowercase(), query.to_lowercase());
    let mut letters = name.chars();
    query.chars().all(|q| letters.any(|c| c == q)).then(|| name.starts_with(&query))
}

/// The entity, behaviour or world that contains a declaration: the last one before it in its file.
fn container(snapshot: &Snapshot, at: Span) -> Option<&Occurrence> {
    let is_outer = |o: &&Occurrence| {
        o.role == Role::Declared && matches!(o.kind, NameKind::Entity | NameKind::Behavior | NameKind::World)
    };
    let all = &snapshot.ide.occurrences;
    let here = all.partition_point(|o| (o.at.file(), o.at.start()) < (at.file(), at.start()));
    let own = all.get(here).is_some_and(|o| is_outer(&o) || o.kind == NameKind::Constant);
    let before = all.get(..here)?.iter().rev().take_while(|o| o.at.file() == at.file());
    before.filter(|_| !own).find(is_outer)
}

/// Whether names of a kind are workspace symbols.
fn is_listed(kind: NameKind) -> bool {
    !matches!(kind, NameKind::Value | NameKind::Tag | NameKind::Touched | NameKind::Argument)
}

/// The range of the word that contains an offset, or ends there.
pub(super) fn word_at(code: &str, byte: usize) -> Option<Range<usize>> {
    let near = tokens(code).filter(|token| token.kind == Kind::Word).map(|token| token.at);
    let near = near.skip_while(|at| at.end < byte).take_while(|at| at.start <= byte);
    near.max_by_key(|at| at.start)
}

/// The paths in a text: imports, levels, legends.
fn named_files(tree: &ast::File) -> Vec<&Name> {
    let imports = tree.items.iter().filter_map(|i| if let Item::Import(i) = i { Some(&i.path) } else { None });
    let maps = tree.maps().flat_map(|map| match &map.source {
        MapSource::Text(_, path) | MapSource::Tiled(path, _) | MapSource::Ldtk(path, ..) => vec![path],
        MapSource::Vglc(path, legend) => vec![path, &legend.path],
        MapSource::OpenLegend(legend) => vec![&legend.path],
        MapSource::Inline(..) | MapSource::Open(_) | MapSource::OpenAll(_) => Vec::new(),
    });
    imports.chain(maps).collect()
}

/// Resolves a path relative to a file.
fn resolve(file: &Path, named: &str) -> PathBuf {
    normalize(&file.parent().unwrap_or(Path::new("")).join(named))
}

/// The range of a string without its quotes.
fn inside_quotes(name: &Name, code: &str) -> Range<usize> {
    let bytes = name.span.range();
    let quoted = code.get(bytes.clone()).is_some_and(|t| t.len() >= 2 && t.starts_with('"') && t.ends_with('"'));
    if quoted { bytes.start + 1..bytes.end - 1 } else { bytes }
}
