//! What is known of a program at one moment: what compiling found, where names occur, and the texts that it was
//! compiled from, so that places can be shown in them. It never changes; a new one takes its place.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use crate::compile::{IdeCompilation, compile_for_ide};
use crate::source::{FileId, Files, ReadError, Span, decode};
use crate::syntax;
use crate::syntax::ast::{Behavior, Item};
use crate::syntax::occurrence::{NameKind, Occurrence};

use crate::lsp::Workspace;
use crate::lsp::documents::{Document, Open, clean};
use crate::lsp::location::Location;
use crate::lsp::text::document_text::Text;

/// Reads what is open from the editor, all else from the disk, and remembers what was asked for.
struct Overlay<'a> {
    open: &'a Open,
    disk: &'a dyn Workspace,
    asked: RefCell<BTreeSet<PathBuf>>,
}

impl Files for Overlay<'_> {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        let path = clean(path);
        let text = match self.open.get(&path) {
            Some(document) => decode(document.text.whole().as_bytes().to_vec()),
            None => self.disk.read(&path),
        };
        self.asked.borrow_mut().insert(path);
        text
    }

    fn identity(&self, path: &Path) -> PathBuf {
        let path = clean(path);
        if self.open.contains_key(&path) { path } else { self.disk.identity(&path) }
    }
}

/// What is known of a program.
#[derive(Debug)]
pub(in crate::lsp) struct Snapshot {
    /// The file that was compiled.
    pub root: PathBuf,
    /// What came of it.
    pub ide: IdeCompilation,
    /// What was read, or was to be read.
    pub asked: BTreeSet<PathBuf>,
    open: Arc<Open>,
    paths: Vec<PathBuf>,
    /// Texts of files that are not open, made when they are first needed.
    texts: Vec<OnceLock<Arc<Text>>>,
}

/// What a name names, the same in all programs.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::lsp) struct Key {
    pub kind: NameKind,
    pub name: String,
    /// Where it is declared; a tag is the same wherever it is.
    pub declared: Option<(PathBuf, u32)>,
}

impl Snapshot {
    /// Compiles a file as it is in the editor, or on the disk.
    pub fn of(root: &Path, open: &Arc<Open>, disk: &dyn Workspace) -> Self {
        let files = Overlay { open, disk, asked: RefCell::default() };
        let ide = compile_for_ide(root, &files);
        let paths: Vec<PathBuf> = ide.compilation.sources.iter().map(|(_, file)| clean(&file.path)).collect();
        let texts = paths.iter().map(|_| OnceLock::new()).collect();
        let asked = files.asked.into_inner();
        Snapshot { root: root.to_path_buf(), ide, asked, open: Arc::clone(open), paths, texts }
    }

    /// Whether the program has no error.
    pub fn is_good(&self) -> bool {
        self.ide.compilation.program.is_some()
    }

    /// The file of a path, if the program has it.
    pub fn file(&self, path: &Path) -> Option<FileId> {
        self.paths.iter().position(|known| known == path).map(|at| FileId(at as u32))
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
            Some(known) => Arc::clone(known.get_or_init(read)),
            None => read(),
        }
    }

    /// A place, with the text that was compiled.
    pub fn location(&self, at: Span) -> Location {
        Location { path: self.path(at.file()).to_path_buf(), text: self.text(at.file()), bytes: at.range() }
    }

    /// The names at a byte of a file: those that hold it, or else those that end there.
    pub fn names_at(&self, file: FileId, byte: usize) -> Vec<Occurrence> {
        let byte = byte as u32;
        let all = &self.ide.occurrences;
        let from = all.partition_point(|o| (o.at.file(), o.at.start()) < (file, byte.saturating_sub(256)));
        let near = || all[from..].iter().take_while(|o| o.at.file() == file && o.at.start() <= byte);
        let inside: Vec<Occurrence> = near().filter(|o| byte < o.at.end()).copied().collect();
        if inside.is_empty() { near().filter(|o| o.at.end() == byte).copied().collect() } else { inside }
    }

    /// What the name of an occurrence is.
    pub fn name(&self, o: &Occurrence) -> &str {
        self.ide.compilation.sources.slice(o.at)
    }

    /// What an occurrence names.
    pub fn key(&self, o: &Occurrence) -> Key {
        let declared = (self.path(o.declared.file()).to_path_buf(), o.declared.start());
        let name = self.name(o).to_string();
        Key { kind: o.kind, name, declared: Some(declared).filter(|_| o.kind != NameKind::Tag) }
    }

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

    /// A behaviour of the program.
    pub fn behavior(&self, name: &str) -> Option<Behavior> {
        let files = self.ide.compilation.sources.iter();
        let programs = files.filter(|(_, file)| file.path.extension().is_some_and(|e| e == "hyped"));
        programs.into_iter().find_map(|(id, file)| {
            let (tree, _) = syntax::parse(id, file.text());
            tree.items.into_iter().find_map(|item| match item {
                Item::Behavior(behavior) if behavior.name.text == name => Some(*behavior),
                _ => None,
            })
        })
    }

    /// The text of the `///` lines above a place.
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

    /// The line of a place, without what opens a block.
    pub fn line(&self, at: Span) -> String {
        let text = self.ide.compilation.sources.file(at.file()).text();
        let start = text.get(..at.range().start).and_then(|t| t.rfind('\n')).map_or(0, |at| at + 1);
        let line = text.get(start..).and_then(|t| t.lines().next()).unwrap_or_default();
        let line = line.split("//").next().unwrap_or(line).trim();
        line.strip_suffix('{').unwrap_or(line).trim_end().to_string()
    }
}
