//! Envelopes: attack, sustain and release, with what is missing filled in.

use crate::diagnostic::catalogue::names::UnknownName;
use crate::diagnostic::catalogue::structure::BadEnvelope;
use crate::diagnostic::catalogue::syntax::NotSupported;
use crate::source::Span;
use crate::syntax::ast::{self, ExprKind, RampKind};

use super::Checker;
use super::checked::{Drive, DriveBy, Entity, Envelope, Rate, Release};
use super::expression::Scope;
use super::ids::{AxisId, ModeId};
use super::names::unknown;

impl Checker<'_> {
    /// Checks an envelope and adds it to its mode, or to the entity.
    pub(super) fn envelope(&mut self, e: &ast::Envelope, scope: &Scope<'_>, entity: &mut Entity, mode: Option<ModeId>) {
        let Some(envelope) = self.two_way(e, scope) else {
            return;
        };
        let (var, degree) = (envelope.var, envelope.degree);
        let id = entity.envelopes.push(envelope);
        let drive = Drive { var, degree, by: DriveBy::Envelope(id), span: e.span };
        match mode {
            Some(mode) => entity.modes[mode].drives.push(drive),
            None => entity.drives.push(drive),
        }
    }

    fn two_way(&mut self, e: &ast::Envelope, scope: &Scope<'_>) -> Option<Envelope> {
        let unsupported = |this: &mut Self, at: Span, what: &str| {
            this.diagnostics.report(NotSupported { at, what: what.into() });
        };
        let [variable] = e.controlled.as_slice() else {
            unsupported(self, e.span, "an envelope of several variables");
            return None;
        };
        let Some(by) = &e.by else {
            unsupported(self, e.span, "a `fixed` envelope");
            return None;
        };
        if e.directions.is_some() {
            unsupported(self, e.span, "an envelope of several directions");
            return None;
        }
        let target = self.controlled(variable, scope);
        let axis = self.axis(by, scope);
        let (mut attack, mut sustain, mut release, mut driven_while) = (None, None, None, None);
        let mut seen: Vec<(&'static str, Span)> = Vec::new();
        let mut complete = e.complete;
        for ramp in &e.ramps {
            let name = match &ramp.kind {
                RampKind::Attack(..) => "attack",
                RampKind::Sustain(_) | RampKind::SustainFor(_) => "sustain",
                RampKind::Release(..) | RampKind::ReleaseHold => "release",
                RampKind::While(_) => "while",
            };
            if let Some((_, first)) = seen.iter().find(|(n, _)| *n == name) {
                self.diagnostics.report(BadEnvelope {
                    at: ramp.span,
                    why: format!("an envelope has two `{name}` parts"),
                    other: Some(*first),
                    help: None,
                });
                continue;
            }
            seen.push((name, ramp.span));
            match &ramp.kind {
                RampKind::Attack(rate, peak) => {
                    if peak.is_some() {
                        unsupported(self, ramp.span, "an attack to a peak");
                        complete = false;
                    }
                    attack = self.rate(rate, scope);
                    complete &= attack.is_some();
                }
                RampKind::Sustain(level) => {
                    sustain = self.number(level, scope);
                    complete &= sustain.is_some();
                }
                RampKind::SustainFor(_) => {
                    unsupported(self, ramp.span, "`sustain for`");
                    complete = false;
                }
                RampKind::ReleaseHold => release = Some(Release::Hold),
                RampKind::Release(rate, level) => {
                    let rate = match rate {
                        Some(rate) => self.rate(rate, scope),
                        None => Some(Rate::Instant),
                    };
                    let level = level.as_ref().map(|l| self.number(l, scope));
                    release = match (rate, level) {
                        (Some(rate), None) => Some(Release::To(rate, None)),
                        (Some(rate), Some(Some(level))) => Some(Release::To(rate, Some(level))),
                        _ => None,
                    };
                    complete &= release.is_some();
                }
                RampKind::While(guard) => {
                    driven_while = self.guard(guard, scope);
                    complete &= driven_while.is_some();
                }
            }
        }
        if sustain.is_none() && complete {
            self.diagnostics.report(BadEnvelope {
                at: e.span,
                why: "this envelope has no level to sustain".into(),
                other: None,
                help: Some("add `sustain LEVEL`".into()),
            });
        }
        let (var, degree) = target?;
        if !complete {
            return None;
        }
        Some(Envelope {
            var,
            degree,
            axis: axis?,
            attack: attack.unwrap_or(Rate::Instant),
            sustain: sustain?,
            release: release.unwrap_or(Release::To(Rate::Instant, None)),
            driven_while,
            span: e.span,
        })
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
        let fact: UnknownName = match &by.kind {
            ExprKind::Path(path) if path.segments.len() == 1 && path.primes == 0 => {
                let name = path.segments.first()?;
                if let Some(&axis) = names.axes.get(&name.text) {
                    return Some(axis);
                }
                unknown("axis", &name.text, name.span, names.axes.names())
            }
            _ => {
                self.diagnostics.report(NotSupported { at: by.span, what: "an envelope by a button".into() });
                return None;
            }
        };
        self.report_unknown(fact);
        None
    }
}
