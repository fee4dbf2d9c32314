//! The files of a program in memory, by name: what `import`s and maps name is looked up beside the file that names it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use hypedc::source::{Files, ReadError, decode, normalize};

/// Texts by their names.
#[derive(Debug, Clone, Default)]
pub(crate) struct Memory(Arc<BTreeMap<PathBuf, String>>);

impl Memory {
    pub fn new(texts: BTreeMap<String, String>) -> Memory {
        Memory(Arc::new(texts.into_iter().map(|(name, text)| (normalize(Path::new(&name)), text)).collect()))
    }

    /// The programs in a folder.
    pub fn programs(&self, folder: &Path) -> Vec<PathBuf> {
        let is_program = |path: &&PathBuf| path.starts_with(folder) && path.extension().is_some_and(|e| e == "hyped");
        self.0.keys().filter(is_program).cloned().collect()
    }
}

impl Files for Memory {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        match self.0.get(&normalize(path)) {
            Some(text) => decode(text.clone().into_bytes()),
            None => Err(ReadError::Unreadable("no such file".to_string())),
        }
    }

    fn identity(&self, path: &Path) -> PathBuf {
        normalize(path)
    }
}
