//! The parts of blocks and files one by one: pest is called for each, so that its stack and its lists stay small, and a
//! part that does not end is read again as one without a block.

use pest::Parser;
use pest::error::InputLocation;
use pest::iterators::Pair;

use super::ast::Item;
use super::build::Builder;
use super::part::{ITEMS, Parts};
use super::reparse::{Earlier, Kept};
use super::{Grammar, Rule};

/// What comes next in a block.
enum Next<T> {
    /// A part, perhaps unreadable, and its end.
    Part(Option<T>, usize),
    /// The end of the block.
    End(usize),
    /// Nothing that a rule matches.
    Stuck,
    /// A part whose block does not end.
    Unclosed,
}

/// Adds a part: lists grow by small steps, as there are many short ones.
fn push<T>(built: &mut Vec<T>, part: Option<T>) {
    if built.len() == built.capacity() {
        built.reserve_exact(2.max(built.len() / 4));
    }
    built.extend(part);
}

impl<'a> Builder<'a> {
    /// The byte after separators: the parser would record every line end in its input.
    fn after_separators(&self, at: usize) -> Option<usize> {
        let rest = self.text.get(at..)?;
        Some(at + (rest.len() - rest.trim_start_matches([' ', '\t', '\r', '\n', ';']).len()))
    }

    /// Parses the next part by a rule, from a byte of the repaired text; returns its pair and its end.
    pub(super) fn next(&mut self, rule: Rule, at: usize) -> Option<(Pair<'a, Rule>, usize)> {
        let at = self.after_separators(at)?;
        match Grammar::parse(rule, self.text.get(at..)?) {
            Ok(mut pairs) => {
                let part = pairs.next()?;
                self.base = at;
                let end = at + part.as_span().end();
                Some((part.into_inner().next()?, end))
            }
            Err(error) => {
                let (InputLocation::Pos(reached) | InputLocation::Span((reached, _))) = error.location;
                self.stuck = at + reached;
                None
            }
        }
    }

    /// The items of the file. `None` if one does not end; then no part counts as broken. Adds those that a later parse can
    /// take.
    pub(super) fn items(&mut self, earlier: Option<&Earlier<'_>>, kept: &mut Vec<Kept>) -> Option<Vec<Item>> {
        let (known, errors) = (self.diagnostics.iter().len(), self.errors);
        let (mut built, mut at) = (Vec::new(), 0);
        loop {
            at = self.after_separators(at)?;
            if let Some((item, place)) = earlier.and_then(|earlier| earlier.item(self, at)) {
                at = place.mended.end;
                kept.push(Kept { index: built.len(), ..place });
                push(&mut built, Some(item));
                continue;
            }
            let mistakes = (self.diagnostics.iter().len(), self.broken);
            match self.next_part(&ITEMS, at) {
                Next::Part(item, end) => {
                    let is_block = matches!(item, Some(Item::Entity(_) | Item::Behavior(_) | Item::World(_)));
                    let (mended, source) = (at..end, self.position(at)..self.position(end));
                    if is_block
                        && mistakes == (self.diagnostics.iter().len(), self.broken)
                        && mended.len() == source.len()
                        && self.text.get(..end).is_some_and(|text| text.ends_with('}'))
                    {
                        kept.push(Kept { index: built.len(), source, mended, is_taken: false });
                    }
                    push(&mut built, item);
                    at = end;
                }
                Next::End(_) => {
                    built.shrink_to_fit();
                    return Some(built);
                }
                Next::Stuck => {
                    self.diagnostics.take_back(known);
                    self.errors = errors;
                    return None;
                }
                Next::Unclosed => return None,
            }
        }
    }

    /// The parts of a block from a byte on, and the end of the block. `None` if it does not end; then no part counts as
    /// broken.
    pub fn block<T>(&mut self, parts: &Parts<T>, mut at: usize) -> Option<(Vec<T>, usize)> {
        let (known, errors) = (self.diagnostics.iter().len(), self.errors);
        let mut built = Vec::new();
        loop {
            match self.next_part(parts, at) {
                Next::Part(part, end) => {
                    push(&mut built, part);
                    at = end;
                }
                Next::End(end) => {
                    built.shrink_to_fit();
                    return Some((built, end));
                }
                Next::Stuck => {
                    self.diagnostics.take_back(known);
                    self.errors = errors;
                    return None;
                }
                Next::Unclosed => return None,
            }
        }
    }

    /// The next part of a block.
    fn next_part<T>(&mut self, parts: &Parts<T>, at: usize) -> Next<T> {
        let Some((pair, end)) = self.next(parts.next, at) else { return Next::Stuck };
        if matches!(pair.as_rule(), Rule::close_brace | Rule::EOI) {
            return Next::End(end);
        }
        if let Some((part, end)) = (parts.build)(self, &pair, end) {
            return Next::Part(part, end);
        }
        let plain = self.next(parts.plain, at).and_then(|(pair, end)| (parts.build)(self, &pair, end));
        plain.map_or(Next::Unclosed, |(part, end)| Next::Part(part, end))
    }
}
