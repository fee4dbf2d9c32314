//! Loads a file and all its imports. Paths are relative to the importing file; a file is read once, however often it is
//! imported; a cycle is an error. The traversal has an explicit stack, so long chains cannot overflow the call stack.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::file::{ImportCycle, TooMany, Unreadable};
use crate::source::{FileId, Files, ReadError, SourceMap, Span};

use super::ast::{File, Item, MapSource};

/// Maximum number of files of a program.
pub const MAX_FILES: usize = 10_000;

/// A file whose imports are being read.
struct Open {
    file: File,
    path: PathBuf,
    identity: PathBuf,
    imports: std::vec::IntoIter<(PathBuf, Span)>,
}

/// Parses the files of a program.
pub trait Trees {
    /// As [`parse`](super::parse), of a file with a path.
    fn parse(&self, path: &Path, id: FileId, text: &str) -> (File, Diagnostics);
}

/// Each file is parsed when it is read.
pub struct Unshared;

impl Trees for Unshared {
    fn parse(&self, _: &Path, id: FileId, text: &str) -> (File, Diagnostics) {
        super::parse(id, text)
    }
}

/// Reads and parses `root` and its direct and indirect imports. Files come in order of dependency: the root first,
/// every file before its imports.
pub fn load(
    root: &Path,
    (files, trees): (&dyn Files, &dyn Trees),
    sources: &mut SourceMap,
) -> (Vec<File>, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let mut done: Vec<File> = Vec::new();
    let mut known: BTreeMap<PathBuf, FileId> = BTreeMap::new();
    let mut stack: Vec<Open> = Vec::new();
    stack.extend(open(root, None, (files, trees), sources, &mut known, &mut diagnostics));
    while let Some(top) = stack.last_mut() {
        let Some((path, at)) = top.imports.next() else {
            done.extend(stack.pop().map(|finished| finished.file));
            continue;
        };
        let identity = files.identity(&path);
        let cycle = stack.iter().position(|o| o.identity == identity);
        if let Some(first) = cycle {
            let mut chain: Vec<PathBuf> = stack[first..].iter().map(|o| o.path.clone()).collect();
            chain.push(path);
            diagnostics.report(ImportCycle { import: at, files: chain });
        } else if !known.contains_key(&identity) {
            if known.len() >= MAX_FILES {
                let count = known.len() as u64 + 1;
                diagnostics.report(TooMany { what: "files".into(), count, limit: MAX_FILES as u64, at });
                continue;
            }
            match open(&path, Some(at), (files, trees), sources, &mut known, &mut diagnostics) {
                Some(next) => stack.push(next),
                // Its declarations are unknown, which is already reported.
                None => {
                    if let Some(top) = stack.last_mut() {
                        top.file.is_broken = true;
                        top.file.poisoned_names.insert("*".into());
                    }
                }
            }
        }
    }
    done.reverse();
    (done, diagnostics)
}

/// Reads the levels and legends of the maps of a file.
fn texts(
    file: &File,
    folder: &Path,
    files: &dyn Files,
    sources: &mut SourceMap,
    diagnostics: &mut Diagnostics,
) -> Vec<(Span, FileId)> {
    let named = file.maps().flat_map(|map| match &map.source {
        MapSource::Inline(..) | MapSource::Open(_) | MapSource::OpenAll(_) => vec![],
        MapSource::Text(_, path) | MapSource::Tiled(path, _) | MapSource::Ldtk(path, ..) => vec![path],
        MapSource::Vglc(path, legend) => vec![path, &legend.path],
        MapSource::OpenLegend(legend) => vec![&legend.path],
    });
    let mut known: BTreeMap<PathBuf, Result<FileId, ReadError>> = BTreeMap::new();
    let mut out = Vec::new();
    for name in named {
        let path = folder.join(&*name.text);
        if sources.is_full() && !known.contains_key(&path) {
            diagnostics.report(TooMany::sources(name.span));
            break;
        }
        let read = known.entry(path.clone()).or_insert_with(|| files.read(&path).map(|text| sources.add(&path, text)));
        match read {
            Ok(id) => out.push((name.span, *id)),
            Err(error) => diagnostics.report(Unreadable { path, import: Some(name.span), error: error.clone() }),
        }
    }
    out
}

fn open(
    path: &Path,
    import: Option<Span>,
    (files, trees): (&dyn Files, &dyn Trees),
    sources: &mut SourceMap,
    known: &mut BTreeMap<PathBuf, FileId>,
    diagnostics: &mut Diagnostics,
) -> Option<Open> {
    let text = match files.read(path) {
        Ok(text) => text,
        Err(error) => {
            diagnostics.report(Unreadable { path: path.to_path_buf(), import, error });
            return None;
        }
    };
    let id = sources.add(path, text);
    let identity = files.identity(path);
    known.insert(identity.clone(), id);
    let (mut file, found) = trees.parse(path, id, sources.file(id).text());
    diagnostics.append(found);
    let folder = path.parent().unwrap_or(Path::new(""));
    file.texts = texts(&file, folder, files, sources, diagnostics);
    let imports: Vec<(PathBuf, Span)> = file
        .items
        .iter()
        .filter_map(|item| match item {
            Item::Import(import) => Some((folder.join(&*import.path.text), import.path.span)),
            _ => None,
        })
        .collect();
    Some(Open { file, path: path.to_path_buf(), identity, imports: imports.into_iter() })
}
