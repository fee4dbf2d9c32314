//! Parsing a text again that differs little from an earlier one, as in an editor. Entities, behaviours and worlds whose
//! text is the same are taken from the earlier tree, and only moved; most of the time of a compilation is the parser's.
//!
//! An item is taken if it had no mistake, and its text is the same both as it was written and as the parser saw it,
//! without comments and with no brace added inside. It ends with its closing brace, so nothing after it matters. The
//! comment above it is read anew.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use crate::diagnostic::Diagnostics;
use crate::source::FileId;

use super::ast::{File, Item};
use super::build::{self, Builder};
use super::moved::{Moved, Shift};
use super::scan;

/// A parsed text, with what is needed to parse a similar one.
#[derive(Debug)]
pub struct Parsed {
    /// The tree: the readable parts.
    pub file: File,
    /// What is said about the others.
    pub diagnostics: Diagnostics,
    source: String,
    /// The text that the parser saw.
    mended: String,
    kept: Vec<Kept>,
}

impl Parsed {
    /// The text that was parsed.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// The number of items that were taken from an earlier text.
    pub fn taken(&self) -> usize {
        self.kept.iter().filter(|kept| kept.is_taken).count()
    }
}

/// An item that can be taken.
#[derive(Debug)]
pub(super) struct Kept {
    /// Its place in the tree's list.
    pub index: usize,
    /// Its place in the source.
    pub source: Range<usize>,
    /// Its place in the text that the parser saw.
    pub mended: Range<usize>,
    /// Whether it was taken from an earlier text.
    pub is_taken: bool,
}

/// Parses a text. The result is the same with and without an earlier one; with one, it takes less time.
pub fn reparse(id: FileId, source: &str, before: Option<&Parsed>) -> Parsed {
    let mut diagnostics = Diagnostics::new();
    let mut scanned = scan::scan(id, source, &mut diagnostics);
    let mended = scanned.text.take();
    let earlier = before.map(Earlier::of);
    let (file, kept) = build::file(id, source, (&scanned, mended.as_deref()), earlier.as_ref(), &mut diagnostics);
    Parsed { file, diagnostics, source: source.to_string(), mended: mended.unwrap_or_default(), kept }
}

/// The items of an earlier text, by their first lines.
pub(super) struct Earlier<'a> {
    parsed: &'a Parsed,
    by_head: BTreeMap<&'a str, Vec<&'a Kept>>,
}

/// The first line of a text.
fn head(text: &str) -> &str {
    text.split('\n').next().unwrap_or_default()
}

impl<'a> Earlier<'a> {
    fn of(parsed: &'a Parsed) -> Self {
        let mut by_head: BTreeMap<&str, Vec<&Kept>> = BTreeMap::new();
        for kept in &parsed.kept {
            let text = parsed.mended.get(kept.mended.clone()).unwrap_or_default();
            by_head.entry(head(text)).or_default().push(kept);
        }
        Earlier { parsed, by_head }
    }

    /// The item that begins at a byte of the text of a builder, moved there, with its place.
    pub fn item(&self, builder: &Builder<'_>, at: usize) -> Option<(Item, Kept)> {
        let (rest, start) = (builder.text.get(at..)?, builder.position(at));
        for kept in self.by_head.get(head(rest))? {
            let old = self.parsed.mended.get(kept.mended.clone())?;
            let (mended, source) = (at..at + old.len(), start..start + kept.source.len());
            let is_same = rest.starts_with(old)
                && builder.position(mended.end) == source.end
                && builder.source.get(source.clone()) == self.parsed.source.get(kept.source.clone());
            if is_same && let Some(item) = self.parsed.file.items.get(kept.index) {
                let mut item = item.clone();
                let shift = Shift { file: builder.file, by: start as isize - kept.source.start as isize };
                if shift.by != 0 || builder.file != self.parsed.file.id {
                    item.moved(shift);
                }
                let doc = builder.doc(builder.span(mended.start, mended.end));
                match &mut item {
                    Item::Entity(of) if of.doc != doc => Arc::make_mut(of).doc = doc,
                    Item::Behavior(of) if of.doc != doc => Arc::make_mut(of).doc = doc,
                    Item::World(of) if of.doc != doc => Arc::make_mut(of).doc = doc,
                    Item::Entity(_) | Item::Behavior(_) | Item::World(_) => {}
                    Item::Import(_) | Item::Constant(_) => return None,
                }
                return Some((item, Kept { index: 0, source, mended, is_taken: true }));
            }
        }
        None
    }
}
