//! Renames of files and folders: the paths in programs that lead to them, and from them, follow.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::actions::create::relative;
use super::navigate::document_links;
use crate::lsp::location::{Edit, Location};
use crate::lsp::view::View;

/// The edits that let the paths in all programs lead to the same files after some files or folders are renamed.
pub(in crate::lsp) fn followed(view: &View, renames: &[(PathBuf, PathBuf)]) -> Vec<Edit> {
    let moved = |path: &Path| {
        let new = renames.iter().find_map(|(old, new)| {
            let rest = path.strip_prefix(old).ok()?;
            Some(if rest.as_os_str().is_empty() { new.clone() } else { new.join(rest) })
        });
        new.unwrap_or_else(|| path.to_path_buf())
    };
    let mut seen: BTreeSet<PathBuf> = BTreeSet::new();
    let mut edits = Vec::new();
    for state in view.programs.values() {
        let snapshot = &*state.current;
        for (file, source) in snapshot.ide.compilation.sources.iter() {
            let path = snapshot.path(file);
            let is_program = source.path.extension().is_some_and(|e| e == "hyped");
            if !is_program || !seen.insert(path.to_path_buf()) {
                continue;
            }
            let Some(text) = view.text(path) else { continue };
            let from = moved(path);
            for link in document_links(path, &text) {
                let target = moved(&link.target);
                let stays = target == link.target && from.parent() == path.parent();
                let Some(new_text) = relative(&from, &target).filter(|_| !stays) else { continue };
                if text.code().get(link.bytes.clone()) != Some(new_text.as_str()) {
                    let at =
                        Location { path: path.to_path_buf(), text: std::sync::Arc::clone(&text), bytes: link.bytes };
                    edits.push(Edit { at, new_text });
                }
            }
        }
    }
    edits
}
