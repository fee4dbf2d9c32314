//! Builds the syntax tree from pest's pairs: tests of worlds.

use pest::iterators::Pair;

use super::Rule;
use super::ast::{Expect, Expr, Moment, Name, Search, SearchKind, Seed, Test, TestInputs, TestItem, Without};
use super::build::Builder;
use super::part::{Part, Parts, parts};
use crate::source::Span;

/// The rules of the statements of tests.
const TEST_ITEMS: Parts<TestItem> = Parts {
    next: Rule::next_test_item,
    plain: Rule::next_test_item,
    build: |b, pair, end| Some((b.test_item(pair), end)),
};

impl Builder<'_> {
    /// `test "name" {`, with its block.
    pub(super) fn test(&mut self, pair: &Pair<'_, Rule>, end: usize) -> Part<Test> {
        let (start, inner) = (self.start_of(pair), parts(pair));
        let quoted = self.name(inner.first()?);
        // The name is what is between the quotes.
        let at = quoted.span.range();
        let name = Name { span: Span::new(quoted.span.file(), at.start + 1, at.end - 1), ..quoted };
        let broken = self.broken;
        let (items, end) = self.block(&TEST_ITEMS, end)?;
        Some((Some(Test { name, items, is_broken: self.broken > broken, span: self.span(start, end) }), end))
    }

    fn test_item(&mut self, pair: &Pair<'_, Rule>) -> Option<TestItem> {
        let (inner, span) = (parts(pair), self.span_of(pair));
        Some(match pair.as_rule() {
            Rule::given => {
                let is_file = pair.clone().into_inner().any(|part| part.as_rule() == Rule::word_from);
                TestItem::Inputs(TestInputs { text: self.name(inner.first()?), is_file, span }.into())
            }
            Rule::draws => TestItem::Seed(Seed { number: self.name(inner.first()?), span }.into()),
            Rule::expect => {
                let (predicate, moment) = (self.expression(inner.first()?)?, self.moment(inner.get(1)?)?);
                TestItem::Expect(Expect { predicate, moment, span }.into())
            }
            Rule::search => TestItem::Search(self.search(&inner, span)?.into()),
            _ => {
                self.bad(Rule::only_test_item, pair);
                return None;
            }
        })
    }

    fn moment(&mut self, pair: &Pair<'_, Rule>) -> Option<Moment> {
        let moment = parts(pair).into_iter().next()?;
        let time = |b: &mut Self| -> Option<Option<Expr>> {
            match parts(&moment).iter().find(|part| part.as_rule() == Rule::expression) {
                Some(time) => Some(Some(b.expression(time)?)),
                None => Some(None),
            }
        };
        Some(match moment.as_rule() {
            Rule::moment_at => Moment::At(time(self)?),
            Rule::moment_by => Moment::By(time(self)?),
            Rule::moment_always => Moment::Always,
            _ => Moment::Never,
        })
    }

    fn search(&mut self, inner: &[Pair<'_, Rule>], span: Span) -> Option<Search> {
        let kind = match inner.first()?.as_str().trim() {
            "reachable" => SearchKind::Reachable,
            "unreachable" => SearchKind::Unreachable,
            "unfound" => SearchKind::Unfound,
            _ => SearchKind::Never,
        };
        let of = |rule: Rule| inner.iter().find(|part| part.as_rule() == rule).map(parts);
        let predicate = self.expression(inner.get(1)?)?;
        let without = match of(Rule::without) {
            Some(parts) => {
                let is_needed = parts.first()?.as_rule() == Rule::kw_not;
                Some(Without { is_needed, predicate: self.expression(parts.last()?)? })
            }
            None => None,
        };
        let within = match of(Rule::deadline) {
            Some(parts) => Some(self.expression(parts.first()?)?),
            None => None,
        };
        Some(Search { kind, predicate, without, within, span })
    }
}
