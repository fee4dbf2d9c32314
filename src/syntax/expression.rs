//! Builds expressions from pest's pairs, with pest's Pratt parser for precedence.
//!
//! From loose to tight: `or`, `and`, `not`, comparisons (which chain), `+ -`, `* /`, unary `-`.

use std::sync::LazyLock;

use pest::iterators::Pair;
use pest::pratt_parser::{Assoc, Op, PrattParser};

use super::Rule;
use super::ast::{BinaryOp, Call, CompareOp, Each, Expr, ExprKind, Nearest, Unit};
use super::build::Builder;
use super::part::parts;

static PRECEDENCE: LazyLock<PrattParser<Rule>> = LazyLock::new(|| {
    use Rule as R;
    PrattParser::new()
        .op(Op::infix(R::kw_or, Assoc::Left))
        .op(Op::infix(R::kw_and, Assoc::Left))
        .op(Op::prefix(R::kw_not))
        .op(Op::infix(R::equal, Assoc::Left)
            | Op::infix(R::unequal, Assoc::Left)
            | Op::infix(R::below, Assoc::Left)
            | Op::infix(R::at_most, Assoc::Left)
            | Op::infix(R::above, Assoc::Left)
            | Op::infix(R::at_least, Assoc::Left))
        .op(Op::infix(R::plus, Assoc::Left) | Op::infix(R::minus, Assoc::Left))
        .op(Op::infix(R::times, Assoc::Left) | Op::infix(R::divided, Assoc::Left))
        .op(Op::prefix(R::negative))
});

fn comparison(rule: Rule) -> Option<CompareOp> {
    Some(match rule {
        Rule::equal => CompareOp::Equal,
        Rule::unequal => CompareOp::Unequal,
        Rule::below => CompareOp::Less,
        Rule::at_most => CompareOp::AtMost,
        Rule::above => CompareOp::Greater,
        Rule::at_least => CompareOp::AtLeast,
        _ => return None,
    })
}

impl Builder<'_> {
    pub(super) fn expressions(&self, pairs: &[Pair<'_, Rule>]) -> Option<Vec<Expr>> {
        pairs.iter().map(|p| self.expression(p)).collect()
    }

    /// An `expression` pair.
    pub(super) fn expression(&self, pair: &Pair<'_, Rule>) -> Option<Expr> {
        let mut inner = pair.clone().into_inner();
        if pair.as_rule() == Rule::argument {
            let what = self.expression(&inner.next()?)?;
            let Some(moved) = inner.next() else { return Some(what) };
            let offset = self.expression(&moved.into_inner().last()?)?;
            let span = what.span.to(offset.span);
            return Some(Expr { kind: ExprKind::Moved(Box::new([what, offset])), span });
        }
        if inner.len() == 1 {
            return self.primary(&inner.next()?); // most expressions have no operator
        }
        PRECEDENCE
            .map_primary(|primary| self.primary(&primary))
            .map_prefix(|operator, operand| {
                let operand = operand?;
                let span = self.span_of(&operator).to(operand.span);
                let kind = match operator.as_rule() {
                    Rule::kw_not => ExprKind::Not(Box::new(operand)),
                    _ => ExprKind::Negate(Box::new(operand)),
                };
                Some(Expr { kind, span })
            })
            .map_infix(|left, operator, right| {
                let (left, right) = (left?, right?);
                let span = left.span.to(right.span);
                if let Some(op) = comparison(operator.as_rule()) {
                    // `a < b < c` is one chain; `(a < b) < c` is not, its left side is a `Paren`.
                    let kind = match left.kind {
                        ExprKind::Compare(before, sides) => {
                            let [first, second] = *sides;
                            ExprKind::Chain(Box::new((first, vec![(before, second), (op, right)])))
                        }
                        ExprKind::Chain(mut chain) => {
                            chain.1.push((op, right));
                            ExprKind::Chain(chain)
                        }
                        _ => ExprKind::Compare(op, Box::new([left, right])),
                    };
                    return Some(Expr { kind, span });
                }
                let op = match operator.as_rule() {
                    Rule::kw_and => BinaryOp::And,
                    Rule::kw_or => BinaryOp::Or,
                    Rule::plus => BinaryOp::Add,
                    Rule::minus => BinaryOp::Subtract,
                    Rule::times => BinaryOp::Multiply,
                    _ => BinaryOp::Divide,
                };
                Some(Expr { kind: ExprKind::Binary(op, Box::new([left, right])), span })
            })
            .parse(inner)
    }

    /// A `primary` pair: an atom and perhaps `in`, `is` or `touching` after it.
    pub(super) fn primary(&self, pair: &Pair<'_, Rule>) -> Option<Expr> {
        let mut inner = pair.clone().into_inner();
        let atom = self.atom(&inner.next()?)?;
        let Some(relation) = inner.next() else {
            return Some(atom);
        };
        let relation = relation.into_inner().next()?;
        let span = atom.span.to(self.span_of(&relation));
        let object = relation.clone().into_inner().last()?;
        let kind = match relation.as_rule() {
            Rule::relation_in => ExprKind::In(Box::new((atom, self.path(&object)?))),
            Rule::relation_is => {
                let entity = (object.as_rule() != Rule::kw_none).then(|| self.name(&object));
                ExprKind::Is(Box::new((atom, entity)))
            }
            _ => ExprKind::Touching(Box::new((atom, self.name(&object)))),
        };
        Some(Expr { kind, span })
    }

    fn atom(&self, pair: &Pair<'_, Rule>) -> Option<Expr> {
        let span = self.span_of(pair);
        let inner = parts(pair);
        let kind = match pair.as_rule() {
            Rule::number => {
                let value = inner.first()?.as_str().parse::<f64>().ok()?;
                let unit = inner.get(1).map(|u| match u.as_str() {
                    "ms" => Unit::Milliseconds,
                    "frames" => Unit::Frames,
                    _ => Unit::Seconds,
                });
                ExprKind::Number(value, unit)
            }
            Rule::kw_true => ExprKind::Bool(true),
            Rule::kw_false => ExprKind::Bool(false),
            Rule::kw_none => ExprKind::NoneRef,
            Rule::kw_self => ExprKind::SelfRef,
            Rule::kw_timer => ExprKind::Timer,
            Rule::text => ExprKind::Text(self.name(pair).text.into()),
            Rule::path => self.path(pair)?.into(),
            Rule::in_mode => ExprKind::InMode(self.path(inner.last()?)?.into()),
            Rule::any_instance => {
                let path = self.path(inner.last()?)?;
                let is_all = pair.clone().into_inner().any(|p| p.as_rule() == Rule::word_all);
                let name = path.view().name();
                match name {
                    Some(entity) if is_all => ExprKind::All(entity.into()),
                    Some(entity) => ExprKind::Any(entity.into()),
                    None => ExprKind::Each(Each { is_all, path }.into()),
                }
            }
            Rule::nearest => {
                let entity = self.name(inner.iter().find(|part| part.as_rule() == Rule::name)?);
                let (mut mode, mut within, mut binding) = (None, None, None);
                for part in &inner {
                    match part.as_rule() {
                        Rule::relation_in => mode = Some(self.path(parts(part).last()?)?),
                        Rule::within_limit => within = Some(self.atom(parts(part).first()?)?),
                        Rule::binding => binding = parts(part).first().map(|b| self.name(b)),
                        _ => {}
                    }
                }
                ExprKind::Nearest(Nearest { entity, mode, within, binding }.into())
            }
            Rule::call => {
                let mut arguments = Vec::with_capacity(inner.len().saturating_sub(1));
                let mut binding = None;
                for part in inner.iter().skip(1) {
                    match part.as_rule() {
                        Rule::argument => arguments.push(self.expression(part)?),
                        Rule::binding => binding = parts(part).first().map(|b| self.name(b).into()),
                        _ => {}
                    }
                }
                ExprKind::Call(
                    Call { function: self.name(inner.first()?), arguments: arguments.into(), binding }.into(),
                )
            }
            Rule::paren => match inner.as_slice() {
                [only] => ExprKind::Paren(Box::new(self.expression(only)?)),
                [x, y] => ExprKind::Point(Box::new([self.expression(x)?, self.expression(y)?])),
                _ => return None,
            },
            _ => return None,
        };
        Some(Expr { kind, span })
    }
}
