//! Builds the syntax tree from pest's pairs: envelopes and their ramps.

use pest::iterators::Pair;

use super::Rule;
use super::ast::{Envelope, Expr, Ramp, RampKind, Rate};
use super::build::Builder;
use super::part::parts;

impl Builder<'_> {
    pub(super) fn envelope(&mut self, pair: &Pair<'_, Rule>) -> Option<Envelope> {
        let mut out = Envelope {
            controlled: Vec::new(),
            by: None,
            directions: None,
            ramps: Vec::new(),
            complete: true,
            span: self.span_of(pair),
        };
        for part in parts(pair) {
            match part.as_rule() {
                Rule::controlled => {
                    out.controlled = parts(&part).iter().map(|v| self.variable(v)).collect::<Option<_>>()?;
                }
                Rule::expression => out.by = Some(self.expression(&part)?),
                Rule::directions => out.directions = parts(&part).first().map(|d| self.name(d)),
                Rule::ramps => {
                    for ramp in parts(&part) {
                        match ramp.as_rule() {
                            Rule::bad_ramp => {
                                out.complete = false;
                                self.bad(Rule::only_ramp, &ramp);
                            }
                            _ => out.ramps.extend(self.ramp(&ramp)),
                        }
                    }
                }
                _ => {}
            }
        }
        Some(out)
    }

    fn ramp(&mut self, pair: &Pair<'_, Rule>) -> Option<Ramp> {
        let inner = parts(pair);
        let first = inner.first()?;
        let kind = match pair.as_rule() {
            Rule::attack => RampKind::Attack(self.rate(first)?, self.level(inner.get(1))),
            Rule::decay => RampKind::Decay(self.rate(first)?),
            Rule::sustain if first.as_rule() == Rule::sustain_for => {
                RampKind::SustainFor(self.expression(parts(first).first()?)?)
            }
            Rule::sustain => RampKind::Sustain(self.expression(first)?),
            Rule::release => match first.as_rule() {
                Rule::hold => RampKind::ReleaseHold,
                Rule::level => RampKind::Release(None, self.level(Some(first))),
                _ => RampKind::Release(Some(self.rate(first)?), self.level(inner.get(1))),
            },
            Rule::driven_while => RampKind::While(self.expression(first)?),
            _ => return None,
        };
        Some(Ramp { kind, span: self.span_of(pair) })
    }

    fn rate(&mut self, pair: &Pair<'_, Rule>) -> Option<Rate> {
        let rate = parts(pair).into_iter().next()?;
        let value = parts(&rate);
        Some(match rate.as_rule() {
            Rule::accel => Rate::Accel(self.expression(value.first()?)?),
            Rule::over => Rate::Over(self.expression(value.first()?)?),
            _ => Rate::Instant,
        })
    }

    fn level(&mut self, pair: Option<&Pair<'_, Rule>>) -> Option<Expr> {
        self.expression(parts(pair?).first()?)
    }
}
