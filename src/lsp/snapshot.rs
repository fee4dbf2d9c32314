//! A compiled program: the result of the compiler, the occurrences of names, and the texts that it was compiled from,
//! to convert spans to locations. Snapshots are immutable; a change of a text creates a new one.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use crate::compile::{Compilation, IdeCompilation, LevelFile, compile_parsed, compile_with};
use crate::diagnostic::Diagnostics;
use crate::source::{FileId, Files, ReadError, Span, decode, normalize};
use crate::syntax::ast::{self, Behavior, Item};
use crate::syntax::occurrence::{NameKind, Occurrence};
use crate::syntax::{self, Parsed, Trees, reparse};

use crate::lsp::Workspace;
use crate::lsp::documents::{Document, OpenDocuments};
use crate::lsp::location::Location;
use crate::lsp::text::document_text::Text;

/// Reads open documents from the editor and other files from the disk, and records the requested paths.
struct Overlay<'a> {
    open: &'a OpenDocuments,
    disk: &'a dyn Workspace,
    requested: RefCell<BTreeSet<PathBuf>>,
    /// The trees of the compilation before.
    before: &'a [Arc<Parsed>],
    trees: RefCell<Vec<Arc<Parsed>>>,
}

impl<'a> Overlay<'a> {
    fn new(open: &'a OpenDocuments, disk: &'a dyn Workspace, before: &'a [Arc<Parsed>]) -> Self {
        Overlay { open, disk, requested: RefCell::default(), before, trees: RefCell::default() }
    }
}

impl Trees for Overlay<'_> {
    fn parse(&self, path: &Path, id: FileId, text: &str) -> (ast::File, Diagnostics) {
        let document = self.open.get(&normalize(path)).filter(|document| document.text.code() == text);
        let parsed = match document {
            Some(document) if id == FileId(0) => Arc::clone(document.text.parsed()),
            _ => match self.before.iter().find(|parsed| parsed.file.id == id) {
                Some(parsed) if parsed.source() == text => Arc::clone(parsed),
                before => Arc::new(reparse(id, text, before.map(|before| &**before))),
            },
        };
        let tree = (parsed.file.clone(), parsed.diagnostics.clone());
        self.trees.borrow_mut().push(parsed);
        tree
    }
}

impl Files for Overlay<'_> {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        let path = normalize(path);
        let text = match self.open.get(&path) {
            Some(document) => decode(document.text.whole().as_bytes().to_vec()),
            None => self.disk.read(&path),
        };
        self.requested.borrow_mut().insert(path);
        text
    }

    fn identity(&self, path: &Path) -> PathBuf {
        let path = normalize(path);
        if self.open.contains_key(&path) { path } else { self.disk.identity(&path) }
    }

    fn bad_picture(&self, path: &Path) -> Option<String> {
        self.disk.bad_picture(&normalize(path))
    }
}

/// A compiled program at one point in time.
#[derive(Debug)]
pub(in crate::lsp) struct Snapshot {
    /// The file that was compiled.
    pub root: PathBuf,
    /// The result of the compiler.
    pub ide: IdeCompilation,
    /// The files that the compiler read or tried to read. A change of one of them invalidates the snapshot.
    pub dependencies: BTreeSet<PathBuf>,
    open: Arc<OpenDocuments>,
    paths: Vec<PathBuf>,
    /// Texts of files that are not open, built on demand.
    texts: Vec<OnceLock<Arc<Text>>>,
    /// The trees of its files, for the next compilation.
    trees: Vec<Arc<Parsed>>,
}

/// The identity of a named symbol, equal in all programs that contain it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::lsp) struct SymbolKey {
    pub kind: NameKind,
    pub name: String,
    /// File and offset of the declaration; `None` for a tag, which is identified by its name alone.
    pub declared: Option<(PathBuf, u32)>,
}

impl Snapshot {
    /// Compiles a program; open documents take precedence over files on the disk. What it was `before` saves time.
    pub fn compile(root: &Path, open: &Arc<OpenDocuments>, disk: &dyn Workspace, before: Option<&Snapshot>) -> Self {
        let files = Overlay::new(open, disk, before.map_or(&[], |before| &before.trees));
        let ide = compile_parsed(root, &files, &files);
        let Overlay { requested, trees, .. } = files;
        let mut snapshot = Snapshot::new(root, open, ide, requested.into_inner());
        // Programs that are not open change rarely, and there may be many.
        if open.contains_key(root) {
            snapshot.trees = trees.into_inner();
        }
        snapshot
    }

    /// Compiles a program with a level for its open maps. Returns the files that it read, too.
    pub fn with_level(
        root: &Path,
        level: LevelFile<'_>,
        (open, disk): (&OpenDocuments, &dyn Workspace),
    ) -> (Compilation, BTreeSet<PathBuf>) {
        let files = Overlay::new(open, disk, &[]);
        let compilation = compile_with(root, level, &files);
        (compilation, files.requested.into_inner())
    }

    /// A program that was compiled from `dependencies`.
    pub fn new(root: &Path, open: &Arc<OpenDocuments>, ide: IdeCompilation, dependencies: BTreeSet<PathBuf>) -> Self {
        let paths: Vec<PathBuf> = ide.compilation.sources.iter().map(|(_, file)| normalize(&file.path)).collect();
        let texts = paths.iter().map(|_| OnceLock::new()).collect();
        Snapshot {
            root: root.to_path_buf(),
            ide,
            dependencies,
            open: Arc::clone(open),
            paths,
            texts,
            trees: Vec::new(),
        }
    }

    /// Whether the program has no error.
    pub fn is_error_free(&self) -> bool {
        self.ide.compilation.program.is_some()
    }

    /// The id of a path, if the program contains that file.
    pub fn file(&self, path: &Path) -> Option<FileId> {
        self.paths.iter().position(|other| other == path).map(|at| FileId(at as u32))
    }

    /// The path of a file.
    pub fn path(&self, file: FileId) -> &Path {
        self.paths.get(file.0 as usize).unwrap_or(&self.root)
    }

    /// The document of a path as it was compiled, if it was open then.
    pub fn document(&self, path: &Path) -> Option<&Document> {
        self.open.get(path)
    }

    /// The text of a file.
    pub fn text(&self, file: FileId) -> Arc<Text> {
        if let Some(document) = self.open.get(self.path(file)) {
            return Arc::clone(&document.text);
        }
        let read = || Arc::new(Text::new(self.ide.compilation.sources.file(file).text()));
        match self.texts.get(file.0 as usize) {
            Some(text) => Arc::clone(text.get_or_init(read)),
            None => read(),
        }
    }

    /// Converts a span to a location in the compiled text.
    pub fn location(&self, at: Span) -> Location {
        Location { path: self.path(at.file()).to_path_buf(), text: self.text(at.file()), bytes: at.range() }
    }

    /// The names at an offset in a file: those that contain it, or else those that end there.
    pub fn names_at(&self, file: FileId, byte: usize) -> Vec<Occurrence> {
        let byte = byte as u32;
        let all = &self.ide.occurrences;
        let from = all.partition_point(|o| (o.at.file(), o.at.start()) < (file, byte.saturating_sub(256)));
        let near = || all[from..].iter().take_while(|o| o.at.file() == file && o.at.start() <= byte);
        let inside: Vec<Occurrence> = near().filter(|o| byte < o.at.end()).copied().collect();
        if inside.is_empty() { near().filter(|o| o.at.end() == byte).copied().collect() } else { inside }
    }

    /// The name of an occurrence, as text.
    pub fn name(&self, o: &Occurrence) -> &str {
        self.ide.compilation.sources.slice(o.at)
    }

    /// The symbol of an occurrence.
    pub fn key(&self, o: &Occurrence) -> SymbolKey {
        let declared = (self.path(o.declared.file()).to_path_buf(), o.declared.start());
        let name = self.name(o).to_string();
        SymbolKey { kind: o.kind, name, declared: Some(declared).filter(|_| o.kind != NameKind::Tag) }
    }

    /// The occurrences of some symbols.
    pub fn occurrences_of(&self, keys: &BTreeSet<SymbolKey>) -> std::vec::IntoIter<Occurrence> {
        // Compare file ids instead of paths.
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

    /// The syntax tree of a behaviour, by name.
    pub fn behavior(&self, name: &str) -> Option<Arc<Behavior>> {
        let of = |tree: &ast::File| {
            tree.items.iter().find_map(|item| match item {
                Item::Behavior(behavior) if behavior.name.text == name => Some(Arc::clone(behavior)),
                _ => None,
            })
        };
        if !self.trees.is_empty() {
            return self.trees.iter().find_map(|parsed| of(&parsed.file));
        }
        let files = self.ide.compilation.sources.iter();
        let programs = files.filter(|(_, file)| file.path.extension().is_some_and(|e| e == "hyped"));
        programs.into_iter().find_map(|(id, file)| of(&syntax::parse(id, file.text()).0))
    }

    /// The text of the `///` lines above a span.
    pub fn doc(&self, at: Span) -> Option<String> {
        let text = self.ide.compilation.sources.file(at.file()).text();
        let before = text.get(..at.range().start)?;
        let line = before.rfind('\n').map_or(0, |at| at + 1);
        let above = before.get(..line)?.lines().rev();
        let mut lines: Vec<&str> = above.map_while(|l| l.trim().strip_prefix("///")).collect();
        lines.reverse();
        let lines: Vec<&str> = lines.iter().map(|l| l.strip_prefix(' ').unwrap_or(l)).collect();
        (!lines.is_empty()).then(|| lines.join("\n"))
    }

    /// The line of a span, without a comment and an opening brace.
    pub fn line(&self, at: Span) -> String {
        let text = self.ide.compilation.sources.file(at.file()).text();
        let start = text.get(..at.range().start).and_then(|t| t.rfind('\n')).map_or(0, |at| at + 1);
        let line = text.get(start..).and_then(|t| t.lines().next()).unwrap_or_default();
        let line = line.split("//").next().unwrap_or(line).trim();
        line.strip_suffix('{').unwrap_or(line).trim_end().to_string()
    }
}
