//! Tables of names: declaration with a check for duplicates, look-up with "did you mean".

use std::collections::BTreeMap;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::names::{DuplicateName, UnknownName};
use crate::ir::Id;
use crate::source::Span;
use crate::syntax::ast::{Name, Word};

/// The names of one name space, in order of declaration.
#[derive(Debug, Clone)]
pub(super) struct Table<T> {
    kind: &'static str,
    entries: Vec<(Name, T)>,
    /// An index, if there are many names.
    #[expect(clippy::box_collection, reason = "most tables are small, and a program has many of them")]
    index: Option<Box<BTreeMap<Word, u32>>>,
}

/// Number of names above which an index is used.
const FEW: usize = 8;

impl<I: Id> Table<I> {
    /// The names of a table's entries, all distinct, with their ids.
    pub fn of<'a>(kind: &'static str, names: impl ExactSizeIterator<Item = &'a Name>) -> Self {
        let mut table = Table::new(kind);
        table.entries.reserve_exact(names.len());
        names.enumerate().for_each(|(index, name)| table.push(name, I::from_index(index)));
        table
    }
}

impl<T> Table<T> {
    pub fn new(kind: &'static str) -> Self {
        Table { kind, entries: Vec::new(), index: None }
    }

    /// Adds a name; the first of two equal names wins.
    pub fn declare(&mut self, name: &Name, value: T, diagnostics: &mut Diagnostics) -> bool {
        if let Some(first) = self.find(&name.text) {
            diagnostics.report(DuplicateName {
                kind: self.kind,
                name: name.text.to_string(),
                first: self.entries[first].0.span,
                second: name.span,
            });
            return false;
        }
        self.push(name, value);
        true
    }

    /// Adds a name that is new.
    fn push(&mut self, name: &Name, value: T) {
        if self.entries.len() == self.entries.capacity() {
            self.entries.reserve_exact(2.max(self.entries.len() / 4));
        }
        self.entries.push((name.clone(), value));
        let first = if self.entries.len() == FEW + 1 { 0 } else { self.entries.len() - 1 };
        if self.entries.len() > FEW {
            let new = self.entries.iter().enumerate().skip(first);
            self.index.get_or_insert_default().extend(new.map(|(at, (name, _))| (name.text.clone(), at as u32)));
        }
    }

    fn find(&self, name: &str) -> Option<usize> {
        if self.entries.len() > FEW {
            return self.index.as_ref()?.get(name).map(|&at| at as usize);
        }
        self.entries.iter().position(|(known, _)| known.text == *name)
    }

    pub fn get(&self, name: &str) -> Option<&T> {
        self.find(name).map(|i| &self.entries[i].1)
    }

    /// The declared name, and its value.
    pub fn entry(&self, name: &str) -> Option<(&Name, &T)> {
        self.find(name).map(|i| (&self.entries[i].0, &self.entries[i].1))
    }

    pub fn names(&self) -> impl Iterator<Item = Candidate<'_>> {
        self.entries.iter().map(|(name, _)| Candidate::from(name))
    }
}

/// A candidate for "did you mean".
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate<'a> {
    pub text: &'a str,
    /// Where it is declared; `None` for names of the language.
    pub at: Option<Span>,
}

impl<'a> From<&'a Name> for Candidate<'a> {
    fn from(name: &'a Name) -> Self {
        Candidate { text: &name.text, at: Some(name.span) }
    }
}

impl<'a> From<&'a str> for Candidate<'a> {
    fn from(text: &'a str) -> Self {
        Candidate { text, at: None }
    }
}

/// An unknown name of some kind, with the nearest known one.
pub(super) fn unknown<'a>(
    kind: &'static str,
    name: &str,
    at: Span,
    known: impl IntoIterator<Item = impl Into<Candidate<'a>>>,
) -> UnknownName {
    UnknownName::new(kind, name, at, known.into_iter().map(Into::into).map(|k: Candidate<'a>| (k.text, k.at)))
}
