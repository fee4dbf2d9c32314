//! Envelopes: attack, decay, sustain and release of a driven variable.

use crate::diagnostic::catalogue::names::UnknownName;
use crate::diagnostic::catalogue::structure::BadEnvelope;
use crate::ir::{AxisId, ModeId, VarId};
use crate::source::Span;
use crate::syntax::ast::{self, ExprKind, RampKind};
use crate::syntax::occurrence::NameKind;

use super::Checker;
use super::checked::{By, Drive, DriveBy, Entity, Envelope, Rate, Release, Term, TermKind};
use super::expression::Scope;
use super::names::unknown;

/// Maximum number of directions.
const MAX_DIRECTIONS: u32 = 64;

/// The parts of an envelope found so far.
#[derive(Default)]
struct Parts {
    attack: Option<Rate>,
    peak: Option<Term>,
    decay: Option<(Rate, Span)>,
    sustain: Option<(Term, Span)>,
    sustain_for: Option<(Term, Span)>,
    release: Option<Release>,
    driven_while: Option<(Term, Span)>,
}

impl Checker<'_> {
    /// Checks an envelope and adds it to its mode, or to the entity.
    pub(super) fn envelope(&mut self, e: &ast::Envelope, scope: &Scope<'_>, entity: &mut Entity, mode: Option<ModeId>) {
        let Some(envelope) = self.read_envelope(e, scope, mode) else {
            return;
        };
        let (vars, degree) = (envelope.vars.clone(), envelope.degree);
        let id = entity.envelopes.push(envelope);
        for var in vars {
            let drive = Drive { var, degree, by: DriveBy::Envelope(id), span: e.span };
            match mode {
                Some(mode) => entity.modes[mode].drives.push(drive),
                None => entity.drives.push(drive),
            }
        }
    }

    fn bad(&mut self, at: Span, why: impl Into<String>, help: Option<&str>) {
        let help = help.map(str::to_string);
        self.diagnostics.report(BadEnvelope { at, why: why.into(), other: None, help });
    }

    fn read_envelope(&mut self, e: &ast::Envelope, scope: &Scope<'_>, mode: Option<ModeId>) -> Option<Envelope> {
        let driven = self.driven(e, scope);
        let by = self.driver(e, scope, mode);
        let parts = self.ramps(e, scope);
        let (vars, degree) = driven?;
        let (by, parts) = (by?, parts?);
        let Parts { attack, peak, decay, sustain, sustain_for, release, driven_while } = parts;
        let attack = attack.unwrap_or(Rate::Instant);
        let release = release.unwrap_or(Release::To(Rate::Instant, None));
        let decay_rate = decay.as_ref().map_or(Rate::Instant, |(rate, _)| rate.clone());
        if matches!(by, By::Clock(_)) {
            for (span, why) in [
                (decay.map(|(_, s)| s), "a `fixed` envelope has no `decay`"),
                (sustain.map(|(_, s)| s), "a `fixed` envelope sustains its peak: `sustain for TIME`"),
                (driven_while.map(|(_, s)| s), "a `fixed` envelope runs by the clock, without `while`"),
            ] {
                if let Some(span) = span {
                    self.bad(span, why, None);
                    return None;
                }
            }
            if matches!(release, Release::Hold) {
                self.bad(e.span, "a `fixed` envelope is released to a level, it cannot hold", None);
                return None;
            }
            let Some(peak) = peak else {
                self.bad(e.span, "this envelope has no peak", Some("write `attack over TIME to PEAK`"));
                return None;
            };
            return Some(Envelope {
                vars,
                degree,
                by,
                attack,
                peak: None,
                decay: Rate::Instant,
                sustain: peak,
                sustain_for: sustain_for.map(|(term, _)| term),
                release,
                driven_while: None,
                span: e.span,
            });
        }
        if let Some((_, span)) = sustain_for {
            self.bad(span, "only a `fixed` envelope sustains for a time", Some("write `sustain LEVEL`"));
            return None;
        }
        if let (Some((_, span)), None) = (&decay, &peak) {
            self.bad(*span, "there is no peak to decay from", Some("write `attack … to PEAK`"));
            return None;
        }
        let Some((sustain, _)) = sustain else {
            self.bad(e.span, "this envelope has no level to sustain", Some("add `sustain LEVEL`"));
            return None;
        };
        Some(Envelope {
            vars,
            degree,
            by,
            attack,
            peak,
            decay: decay_rate,
            sustain,
            sustain_for: None,
            release,
            driven_while: driven_while.map(|(term, _)| term),
            span: e.span,
        })
    }

    /// The variables and their degree.
    fn driven(&mut self, e: &ast::Envelope, scope: &Scope<'_>) -> Option<(Vec<VarId>, u8)> {
        let found: Vec<Option<(VarId, u8)>> = e.controlled.iter().map(|v| self.controlled(v, scope)).collect();
        let found: Vec<(VarId, u8)> = found.into_iter().collect::<Option<_>>()?;
        let (_, degree) = *found.first()?;
        for (index, (variable, (var, own))) in e.controlled.iter().zip(&found).enumerate() {
            if *own != degree {
                self.bad(variable.span, "the variables of an envelope are of one degree", None);
                return None;
            }
            if found[..index].iter().any(|(v, _)| v == var) {
                self.bad(variable.span, "an envelope names a variable twice", None);
                return None;
            }
        }
        Some((found.into_iter().map(|(var, _)| var).collect(), degree))
    }

    /// What drives the envelope.
    fn driver(&mut self, e: &ast::Envelope, scope: &Scope<'_>, mode: Option<ModeId>) -> Option<By> {
        let count = e.controlled.len();
        let Some(by) = &e.by else {
            let Some(mode) = mode else {
                self.bad(e.span, "a `fixed` envelope runs by the clock of a mode", Some("put it into a mode"));
                return None;
            };
            if count != 1 {
                self.bad(e.span, "a `fixed` envelope drives one variable", None);
                return None;
            }
            return Some(By::Clock(mode));
        };
        let axes: Vec<&ast::Expr> = match &by.kind {
            ExprKind::Call(call) if call.function.text == "held" && call.binding.is_none() => {
                let ast::Call { function, arguments, .. } = &**call;
                if count != 1 || e.directions.is_some() {
                    self.bad(e.span, "a button drives one variable, in one direction", None);
                    return None;
                }
                let term = self.button(function, arguments, by.span, scope)?;
                return match term.kind {
                    TermKind::Button(_, button) => Some(By::Button(button)),
                    _ => None,
                };
            }
            ExprKind::Point(both) => both.iter().collect(),
            ExprKind::Paren(inner) => vec![&**inner],
            _ => vec![by],
        };
        let found: Vec<Option<AxisId>> = axes.iter().map(|a| self.axis(a, scope)).collect();
        let found: Vec<AxisId> = found.into_iter().collect::<Option<_>>()?;
        if found.len() != count {
            let help = "`envelope (x', y') by (horizontal, vertical) directions 4 { … }`";
            self.bad(by.span, "an envelope has as many axes as variables", Some(help));
            return None;
        }
        if let ([axis], None) = (found.as_slice(), &e.directions) {
            return Some(By::Axis(*axis));
        }
        let ways = match &e.directions {
            None => None,
            Some(word) if word.text == "any" => None,
            Some(word) => match word.text.parse::<u32>() {
                Ok(2) if count == 1 => return found.first().map(|a| By::Axis(*a)),
                Ok(ways) if (2..=MAX_DIRECTIONS).contains(&ways) && count > 1 => Some(ways),
                _ => {
                    self.bad(word.span, "directions are 4, 8, another number from 2 to 64, or `any`", None);
                    return None;
                }
            },
        };
        if count == 1 {
            self.bad(e.span, "one variable has two directions, `directions 2`", None);
            return None;
        }
        if found.first() == found.last() {
            self.bad(by.span, "an envelope names an axis twice", None);
            return None;
        }
        Some(By::Axes(found, ways))
    }

    /// The ramps, each at most once.
    fn ramps(&mut self, e: &ast::Envelope, scope: &Scope<'_>) -> Option<Parts> {
        let mut parts = Parts::default();
        let mut record_use: Vec<(&'static str, Span)> = Vec::new();
        let mut complete = e.complete;
        for ramp in &e.ramps {
            let name = match &ramp.kind {
                RampKind::Attack(..) => "attack",
                RampKind::Decay(_) => "decay",
                RampKind::Sustain(_) | RampKind::SustainFor(_) => "sustain",
                RampKind::Release(..) | RampKind::ReleaseHold => "release",
                RampKind::While(_) => "while",
            };
            if let Some((_, first)) = record_use.iter().find(|(n, _)| *n == name) {
                self.diagnostics.report(BadEnvelope {
                    at: ramp.span,
                    why: format!("an envelope has two `{name}` parts"),
                    other: Some(*first),
                    help: None,
                });
                continue;
            }
            record_use.push((name, ramp.span));
            complete &= self.ramp(ramp, scope, &mut parts).is_some();
        }
        complete.then_some(parts)
    }

    fn ramp(&mut self, ramp: &ast::Ramp, scope: &Scope<'_>, parts: &mut Parts) -> Option<()> {
        match &ramp.kind {
            RampKind::Attack(rate, peak) => {
                let rate = self.rate(rate, scope);
                if let Some(peak) = peak {
                    parts.peak = Some(self.number(peak, scope)?);
                }
                parts.attack = Some(rate?);
            }
            RampKind::Decay(rate) => parts.decay = Some((self.rate(rate, scope)?, ramp.span)),
            RampKind::Sustain(level) => parts.sustain = Some((self.number(level, scope)?, ramp.span)),
            RampKind::SustainFor(time) => parts.sustain_for = Some((self.number(time, scope)?, ramp.span)),
            RampKind::ReleaseHold => parts.release = Some(Release::Hold),
            RampKind::Release(rate, level) => {
                let rate = match rate {
                    Some(rate) => self.rate(rate, scope),
                    None => Some(Rate::Instant),
                };
                let level = level.as_ref().map(|l| self.number(l, scope));
                let level = match level {
                    Some(level) => Some(level?),
                    None => None,
                };
                parts.release = Some(Release::To(rate?, level));
            }
            RampKind::While(guard) => parts.driven_while = Some((self.guard(guard, scope)?, ramp.span)),
        }
        Some(())
    }

    fn rate(&mut self, rate: &ast::Rate, scope: &Scope<'_>) -> Option<Rate> {
        Some(match rate {
            ast::Rate::Instant => Rate::Instant,
            ast::Rate::Accel(e) => Rate::Accel(self.number(e, scope)?),
            ast::Rate::Over(e) => Rate::Over(self.number(e, scope)?),
        })
    }

    fn axis(&mut self, by: &ast::Expr, scope: &Scope<'_>) -> Option<AxisId> {
        let names = scope.names?;
        let fact: UnknownName = match &by.name() {
            Some(name) => {
                if let Some((declared, &axis)) = names.axes.entry(&name.text) {
                    self.record_use(NameKind::Axis, name.span, declared.span);
                    return Some(axis);
                }
                unknown("axis", &name.text, name.span, names.axes.names())
            }
            None => {
                let help = "write an axis, two axes in parentheses, `held(BUTTON)`, or `fixed`";
                self.bad(by.span, "this cannot drive an envelope", Some(help));
                return None;
            }
        };
        self.report_unknown(fact);
        None
    }
}
