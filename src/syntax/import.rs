//! Reading a file and all that it imports. Paths are relative to the importing file; a file is read once, however
//! often it is imported; a cycle is an error. The walk keeps its own stack, so a long chain cannot overflow ours.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::file::{ImportCycle, TooMany, Unreadable};
use crate::source::{FileId, Files, SourceMap, Span};

use super::ast::{Broken, File, Item};

/// The most files that one program may be made of.
pub const MAX_FILES: usize = 10_000;

/// A file whose imports are being read.
struct Open {
    file: File,
    path: PathBuf,
    identity: PathBuf,
    imports: std::vec::IntoIter<(PathBuf, Span)>,
}

/// Reads and parses `root` and what it imports, directly or not. Files come in the order in which they depend on
/// each other: the root first, every file before those that it imports.
pub fn load(root: &Path, files: &dyn Files, sources: &mut SourceMap) -> (Vec<File>, Diagnostics) {
    let mut diagnostics = Diagnostics::new();
    let mut done: Vec<File> = Vec::new();
    let mut known: BTreeMap<PathBuf, FileId> = BTreeMap::new();
    let mut stack: Vec<Open> = Vec::new();
    stack.extend(open(root, None, files, sources, &mut known, &mut diagnostics));
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
            match open(&path, Some(at), files, sources, &mut known, &mut diagnostics) {
                Some(next) => stack.push(next),
                // Whatever it declares is not known, and that is explained already.
                None => {
                    if let Some(top) = stack.last_mut() {
                        top.file.broken.push(Broken { span: at, names: vec!["*".into()] });
                    }
                }
            }
        }
    }
    done.reverse();
    (done, diagnostics)
}

fn open(
    path: &Path,
    import: Option<Span>,
    files: &dyn Files,
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
    let (file, found) = super::parse(id, sources.file(id).text());
    diagnostics.append(found);
    let folder = path.parent().unwrap_or(Path::new(""));
    let imports: Vec<(PathBuf, Span)> = file
        .items
        .iter()
        .filter_map(|item| match item {
            Item::Import(import) => Some((folder.join(&import.path.text), import.path.span)),
            _ => None,
        })
        .collect();
    Some(Open { file, path: path.to_path_buf(), identity, imports: imports.into_iter() })
}
