//! From names to where they are declared and used, in all programs that hold the file: definition, references,
//! highlights, symbols of the workspace, links to files.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

use gen_lsp_types as types;
use gen_lsp_types::{DocumentHighlight, DocumentHighlightKind, DocumentLink, Location, SymbolKind};

use crate::source::{FileId, Span};
use crate::syntax::ast::{Item, MapSource, Name};
use crate::syntax::occurrence::{NameKind, Occurrence, Role};
use crate::syntax::{self, ast};

use crate::lsp::snapshot::{Key, Snapshot};
use crate::lsp::text::alignment::Alignment;
use crate::lsp::text::lexer::{Kind, tokens};
use crate::lsp::text::uri::{clean, path_of, uri_of};
use crate::lsp::view::{Failure, Known, View};

/// The most symbols of a workspace in an answer.
const MAX_SYMBOLS: usize = 500;

/// A place in one of the programs that hold it.
pub(in crate::lsp) struct ProgramPosition<'a> {
    pub known: &'a Known,
    /// The program as it is, or as it was when it last had no errors.
    pub snapshot: &'a Snapshot,
    pub file: FileId,
    /// The names there.
    pub names: Vec<Occurrence>,
}

impl View {
    /// A place in all programs that hold it, its own first.
    pub(in crate::lsp) fn positions(&self, at: &types::TextDocumentPositionParams) -> Vec<ProgramPosition<'_>> {
        let path = path_of(&at.text_document.uri);
        let position = |known: &'_ Known| -> Option<(FileId, Vec<Occurrence>)> {
            let file = known.now.file(&path)?;
            let byte = known.now.text(file).byte(at.position, self.client.encoding);
            Some((file, known.now.names_at(file, byte)))
        };
        let positions = self.programs(&path).filter_map(|known| position(known).map(|found| (known, found)));
        positions.map(|(known, (file, names))| ProgramPosition { known, snapshot: &known.now, file, names }).collect()
    }

    /// As [`positions`](Self::positions); of a name that means nothing while its program has errors, what it meant when that had
    /// none.
    pub(in crate::lsp) fn last_known_positions(
        &self,
        at: &types::TextDocumentPositionParams,
    ) -> Vec<ProgramPosition<'_>> {
        let positions = self.positions(at);
        let path = path_of(&at.text_document.uri);
        let word = self.documents.get(&path).and_then(|document| {
            let byte = document.text.byte(at.position, self.client.encoding);
            Some((document.text.code(), word_at(document.text.code(), byte)?))
        });
        let Some((code, word)) = word.filter(|_| positions.iter().all(|position| position.names.is_empty())) else {
            return positions;
        };
        let name = code.get(word.clone()).unwrap_or_default();
        let renamed = self.renamed.as_ref().filter(|(_, new)| new == name).map(|(old, _)| old.as_str());
        let earlier = |known: &'_ Known| -> Option<(FileId, Vec<Occurrence>)> {
            let good = known.good.as_deref().filter(|_| !known.now.is_good())?;
            let file = good.file(&path)?;
            let text = good.text(file);
            let names = good.names_at(file, Alignment::between(text.code(), code).before(word.start)?);
            let is_it = |o: &Occurrence| good.name(o) == name || renamed == Some(good.name(o));
            Some((file, names.into_iter().filter(is_it).collect()))
        };
        let positions = self.programs(&path).filter_map(|known| Some((known, known.good.as_deref()?, earlier(known)?)));
        positions.map(|(known, snapshot, (file, names))| ProgramPosition { known, snapshot, file, names }).collect()
    }

    /// Where something of a program is in its document as it is now; none if that line has changed.
    fn location_now(&self, snapshot: &Snapshot, at: Span) -> Option<Location> {
        let path = snapshot.path(at.file());
        let text = snapshot.text(at.file());
        let (now, bytes) = match self.documents.get(path) {
            Some(document) if document.text != text => {
                let bytes = Alignment::between(text.code(), document.text.code()).after(at.range())?;
                (Arc::clone(&document.text), bytes)
            }
            _ => (text, at.range()),
        };
        Some(Location { uri: snapshot.uri(at.file()), range: now.range(bytes, self.client.encoding) })
    }

    /// What is at a place.
    pub(in crate::lsp) fn keys_at(&self, at: &types::TextDocumentPositionParams) -> BTreeSet<Key> {
        let positions = self.positions(at);
        positions.iter().flat_map(|position| position.names.iter().map(|o| position.snapshot.key(o))).collect()
    }

    /// Where some names occur in all programs, each place once.
    pub(in crate::lsp) fn places(&self, keys: &BTreeSet<Key>) -> Vec<(&Snapshot, Occurrence)> {
        let mut seen: BTreeSet<(PathBuf, u32)> = BTreeSet::new();
        let mut out = Vec::new();
        for known in self.known.values() {
            let snapshot = &*known.now;
            for o in snapshot.matching(keys) {
                if seen.insert((snapshot.path(o.at.file()).to_path_buf(), o.at.start())) {
                    out.push((snapshot, o));
                }
            }
        }
        out.sort_by(|(a, x), (b, y)| (a.path(x.at.file()), x.at.start()).cmp(&(b.path(y.at.file()), y.at.start())));
        out
    }

    pub(in crate::lsp) fn definition(
        &self,
        params: types::DefinitionParams,
    ) -> Result<Option<types::DefinitionResponse>, Failure> {
        let at = params.text_document_position_params;
        if let Some(target) = self.file_at(&at) {
            let start = types::Position { line: 0, character: 0 };
            let location = Location { uri: target, range: types::Range { start, end: start } };
            return Ok(Some(types::Definition::from(vec![location]).into()));
        }
        let mut out: Vec<Location> = Vec::new();
        for position in self.last_known_positions(&at) {
            let snapshot = position.snapshot;
            for o in own_values(&position.names) {
                let declared: Vec<Span> = match o.kind {
                    NameKind::Tag => {
                        let all = snapshot.matching(&BTreeSet::from([snapshot.key(&o)]));
                        all.filter(|o| o.role == Role::Declared).map(|o| o.at).collect()
                    }
                    _ => vec![o.declared],
                };
                for location in declared.into_iter().filter_map(|span| self.location_now(snapshot, span)) {
                    if !out.contains(&location) {
                        out.push(location);
                    }
                }
            }
        }
        Ok((!out.is_empty()).then(|| types::Definition::from(out).into()))
    }

    pub(in crate::lsp) fn references(&self, params: types::ReferenceParams) -> Result<Option<Vec<Location>>, Failure> {
        let keys = self.keys_at(&params.text_document_position_params);
        let all = params.context.include_declaration;
        let places = self.places(&keys).into_iter().filter(|(_, o)| all || o.role != Role::Declared);
        Ok(Some(places.map(|(snapshot, o)| snapshot.location(o.at, self.client.encoding)).collect()))
    }

    pub(in crate::lsp) fn highlights(
        &self,
        params: types::DocumentHighlightParams,
    ) -> Result<Option<Vec<DocumentHighlight>>, Failure> {
        let at = params.text_document_position_params;
        let positions = self.positions(&at);
        let Some(position) = positions.iter().find(|position| !position.names.is_empty()) else { return Ok(None) };
        let snapshot = position.snapshot;
        let keys: BTreeSet<Key> = position.names.iter().map(|o| snapshot.key(o)).collect();
        let mut out: Vec<DocumentHighlight> = Vec::new();
        for o in snapshot.matching(&keys).filter(|o| o.at.file() == position.file) {
            let kind = match o.role {
                Role::Read => DocumentHighlightKind::Read,
                Role::Written | Role::Declared => DocumentHighlightKind::Write,
            };
            let range = snapshot.range(o.at, self.client.encoding);
            if !out.iter().any(|known| known.range == range) {
                out.push(DocumentHighlight { range, kind: Some(kind) });
            }
        }
        Ok(Some(out))
    }

    pub(in crate::lsp) fn workspace_symbols(
        &self,
        params: types::WorkspaceSymbolParams,
    ) -> Result<Option<types::WorkspaceSymbolResponse>, Failure> {
        let mut seen: BTreeSet<(PathBuf, u32)> = BTreeSet::new();
        let mut found: Vec<(bool, types::WorkspaceSymbol)> = Vec::new();
        for known in self.known.values() {
            let snapshot = &*known.now;
            for o in snapshot.ide.occurrences.iter().filter(|o| o.role == Role::Declared) {
                let Some(kind) = symbol_kind(o.kind) else { continue };
                let name = snapshot.name(o);
                let Some(begins) = fits(name, &params.query) else { continue };
                if !seen.insert((snapshot.path(o.at.file()).to_path_buf(), o.at.start())) {
                    continue;
                }
                let container_name = container(snapshot, o.at).map(|c| snapshot.name(c).to_string());
                let base = types::BaseSymbolInformation { name: name.into(), kind, tags: None, container_name };
                let location = snapshot.location(o.at, self.client.encoding).into();
                let symbol = types::WorkspaceSymbol { location, data: None, base_symbol_information: base };
                found.push((!begins, symbol));
            }
        }
        // Names that begin with what is asked for come first, short ones before long ones.
        found.sort_by_key(|(later, s)| {
            (*later, s.base_symbol_information.name.len(), s.base_symbol_information.name.clone())
        });
        found.truncate(MAX_SYMBOLS);
        Ok(Some(found.into_iter().map(|(_, symbol)| symbol).collect::<Vec<_>>().into()))
    }

    pub(in crate::lsp) fn document_links(
        &self,
        params: types::DocumentLinkParams,
    ) -> Result<Option<Vec<DocumentLink>>, Failure> {
        let path = path_of(&params.text_document.uri);
        let Some(document) = self.documents.get(&path) else { return Ok(None) };
        let (tree, _) = syntax::parse(FileId(0), document.text.code());
        let link = |name: &Name| DocumentLink {
            range: document.text.range(inside(name, document.text.code()), self.client.encoding),
            target: Some(uri_of(&beside(&path, &name.text))),
            tooltip: None,
            data: None,
        };
        Ok(Some(named_files(&tree).into_iter().map(link).collect()))
    }

    /// The file that is named at a place.
    fn file_at(&self, at: &types::TextDocumentPositionParams) -> Option<types::Uri> {
        let path = path_of(&at.text_document.uri);
        let document = self.documents.get(&path)?;
        let byte = document.text.byte(at.position, self.client.encoding);
        let (tree, _) = syntax::parse(FileId(0), document.text.code());
        let name = named_files(&tree).into_iter().find(|name| name.span.range().contains(&byte))?;
        Some(uri_of(&beside(&path, &name.text)))
    }
}

impl Snapshot {
    /// Where some names occur.
    pub fn matching(&self, keys: &BTreeSet<Key>) -> std::vec::IntoIter<Occurrence> {
        // Places are compared by their numbers here.
        let local = keys.iter().filter_map(|key| {
            let declared = match &key.declared {
                Some((path, start)) => Some((self.file(path)?, *start)),
                None => None,
            };
            Some((key.kind, declared, key.name.as_str()))
        });
        let local: Vec<_> = local.collect();
        let fits = move |o: &&Occurrence| {
            local.iter().any(|(kind, declared, name)| {
                *kind == o.kind
                    && declared.is_none_or(|(file, start)| o.declared.file() == file && o.declared.start() == start)
                    && self.name(o) == *name
            })
        };
        self.ide.occurrences.iter().filter(fits).copied().collect::<Vec<_>>().into_iter()
    }
}

/// Of a value that several equal sets declare, the one that is nearest before.
fn own_values(names: &[Occurrence]) -> Vec<Occurrence> {
    let is_value = |o: &&Occurrence| o.kind == NameKind::Value && o.declared.file() == o.at.file();
    let before = names.iter().filter(is_value).filter(|o| o.declared.start() <= o.at.start());
    match before.max_by_key(|o| o.declared.start()) {
        Some(nearest) => vec![*nearest],
        None => names.to_vec(),
    }
}

/// Whether a name holds the letters of a query in order, and whether it begins with them.
fn fits(name: &str, query: &str) -> Option<bool> {
    let (name, query) = (name.to_lowercase(), query.to_lowercase());
    let mut letters = name.chars();
    query.chars().all(|q| letters.any(|c| c == q)).then(|| name.starts_with(&query))
}

/// The entity, behaviour or world that a declaration is in: the last one before it in its file.
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

/// How a kind of names is shown in lists; none for those that are not listed.
pub(in crate::lsp) fn symbol_kind(kind: NameKind) -> Option<SymbolKind> {
    Some(match kind {
        NameKind::Entity => SymbolKind::Class,
        NameKind::Behavior => SymbolKind::Interface,
        NameKind::World => SymbolKind::Module,
        NameKind::Space => SymbolKind::Namespace,
        NameKind::Group | NameKind::TileSet => SymbolKind::Enum,
        NameKind::Mode => SymbolKind::Method,
        NameKind::Constant | NameKind::Parameter => SymbolKind::Constant,
        NameKind::Variable | NameKind::Discrete => SymbolKind::Variable,
        NameKind::Reference => SymbolKind::Field,
        NameKind::Button | NameKind::Axis => SymbolKind::Event,
        NameKind::Instance => SymbolKind::Object,
        NameKind::Goal | NameKind::Never => SymbolKind::Boolean,
        NameKind::Value | NameKind::Tag | NameKind::Touched | NameKind::Argument => return None,
    })
}

/// The bytes of the word that holds a byte, or ends there.
pub(in crate::lsp) fn word_at(code: &str, byte: usize) -> Option<std::ops::Range<usize>> {
    let near = tokens(code).into_iter().filter(|token| token.kind == Kind::Word).map(|token| token.at);
    let near = near.skip_while(|at| at.end < byte).take_while(|at| at.start <= byte);
    near.max_by_key(|at| at.start)
}

/// The files that a program names: imports, levels, legends.
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

/// A path that is named in a file.
fn beside(file: &std::path::Path, named: &str) -> PathBuf {
    clean(&file.parent().unwrap_or(std::path::Path::new("")).join(named))
}

/// The bytes of a text in quotes, without them.
fn inside(name: &Name, code: &str) -> std::ops::Range<usize> {
    let bytes = name.span.range();
    let quoted = code.get(bytes.clone()).is_some_and(|t| t.len() >= 2 && t.starts_with('"') && t.ends_with('"'));
    if quoted { bytes.start + 1..bytes.end - 1 } else { bytes }
}
