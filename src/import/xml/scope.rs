//! The symbol table of an import: values, inputs and modes of an entity, and their uses.

use std::collections::BTreeMap;

use super::expression::{self, Expr, ParseError};
use super::guard::GuardContext;
use super::modes::Modes;
use super::names::Names;
use super::read::{Element, Value};
use crate::diagnostic::catalogue::import::{BadForm, LeftOut, Misfit, NotCarriedOver};
use crate::diagnostic::{Diagnostics, similar};
use crate::source::Span;

/// The kind of a value here.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Param,
    Continuous,
    /// A discrete variable that is not always whole: a continuous one that nothing drives.
    Undriven,
    /// A whole number in a range.
    Discrete {
        low: i64,
        high: i64,
    },
}

/// A parameter or variable.
pub(super) struct Named {
    pub kind: Kind,
    /// Its name here, once it is used.
    pub here: Option<String>,
    /// Where it is declared.
    pub at: Span,
}

/// The names of an entity.
pub(super) struct Scope<'a, 't, 'd> {
    pub diagnostics: &'d mut Diagnostics,
    pub modes: Modes<'a, 't>,
    /// Values by their names in the file.
    pub values: BTreeMap<&'a str, Named>,
    value_names: Names,
    /// The buttons in the order of first use: the name in the file, and here.
    pub buttons: Vec<(String, String)>,
    button_names: Names,
    /// Whether `x` and `y` are read as axes.
    pub axes: [bool; 2],
    /// Whether a second player was reported.
    players_reported: bool,
    /// Whether the last statement has no effect in the imported system.
    pub idle: bool,
}

/// The names of the axes here.
pub(super) const AXES: [&str; 2] = ["horizontal", "vertical"];

impl<'a, 't, 'd> Scope<'a, 't, 'd> {
    /// The initial scope of an entity: only the position is known.
    pub fn new(automaton: Element<'a, 't>, diagnostics: &'d mut Diagnostics) -> Self {
        let modes = Modes::of(automaton, diagnostics);
        let axis = |name: &str| {
            let mut axes = automaton.node.descendants().filter(|n| n.has_tag_name("axis"));
            axes.any(|n| n.attribute("name").is_some_and(|found| found.trim() == name))
        };
        let axes = [axis("x"), axis("y")];
        let position = |name: &str| Named { kind: Kind::Continuous, here: Some(name.into()), at: automaton.tag() };
        Scope {
            diagnostics,
            modes,
            values: BTreeMap::from([("x", position("x")), ("y", position("y"))]),
            value_names: Names::without(&["x", "y", AXES[0], AXES[1]]),
            buttons: Vec::new(),
            button_names: Names::without(&AXES),
            axes,
            players_reported: false,
            idle: false,
        }
    }

    /// Reports a part without a counterpart.
    pub fn cannot(&mut self, what: String, why: &str, at: Span, help: &str) {
        self.diagnostics.report(NotCarriedOver { what, why: why.into(), at, help: help.into() });
    }

    /// Reports a part without effect in the imported system.
    pub fn left_out(&mut self, what: impl Into<String>, why: &str, at: Span) {
        self.diagnostics.report(LeftOut { what: what.into(), why: why.into(), at });
    }

    /// Reports a statement without any effect in the imported system.
    pub fn idle(&mut self, what: impl Into<String>, why: &str, at: Span) {
        self.left_out(what, why, at);
        self.idle = true;
    }

    /// Whether a condition's owner may read something that changes within a step; reports it if not.
    pub fn known_to(&mut self, context: GuardContext, e: Element<'_, '_>, what: &str) -> Option<()> {
        if context != GuardContext::Collider {
            return Some(());
        }
        let help = "let an edge ask, and ask for its mode here";
        self.cannot(format!("{what} in the guard of a collider"), "not known before colliders are", e.tag(), help);
        None
    }

    /// Reports player numbers: an entity reads one player's inputs, and the world chooses which.
    pub fn player(&mut self, e: Element<'_, '_>) {
        let Some(player) = e.value("player").filter(|p| !matches!(p.text, "p1" | "player1")) else { return };
        if !std::mem::replace(&mut self.players_reported, true) {
            self.left_out(
                "the player of an input",
                "not looked at there; here a world says whose an entity is",
                player.at,
            );
        }
    }

    /// The axis of this entity and the comparison with 0 that replace a button that is an end of the axis.
    pub fn end_of_axis(&self, button: &str) -> Option<(&'static str, &'static str)> {
        let (axis, sign) = match button {
            "left" => (0, "<"),
            "right" => (0, ">"),
            "down" => (1, "<"),
            "up" => (1, ">"),
            _ => return None,
        };
        self.axes.get(axis).copied().unwrap_or_default().then(|| (AXES[axis], sign))
    }

    /// A button's name here.
    pub fn button(&mut self, name: Value<'_>) -> String {
        if let Some((_, here)) = self.buttons.iter().find(|(there, _)| there == name.text) {
            return here.clone();
        }
        let here = self.button_names.give("button", name.text, name.at, self.diagnostics);
        self.buttons.push((name.text.to_string(), here.clone()));
        here
    }

    /// A tag as source text; reports one that cannot be written.
    pub fn tag(&mut self, value: Value<'_>, written: Option<String>) -> Option<String> {
        if written.is_none() {
            self.cannot("a type of this name".into(), "not a tag", value.at, "give it a name without quotes in it");
        }
        written
    }

    /// A value's name here, with the same number of primes; none if there is no such value.
    pub fn name(&mut self, text: &str) -> Option<String> {
        let base = text.trim_end_matches('\'');
        let primes = text.len() - base.len();
        let (name, named) = self.values.iter_mut().find(|(name, _)| **name == base)?;
        if primes > 2 || (primes > 0 && named.kind != Kind::Continuous) {
            return None;
        }
        let kind = if named.kind == Kind::Param { "parameter" } else { "variable" };
        let here = match &named.here {
            Some(here) => here.clone(),
            None => self.value_names.give(kind, name, named.at, self.diagnostics),
        };
        named.here = Some(here.clone());
        Some(here + &"'".repeat(primes))
    }

    /// Parses the expression of an attribute and resolves its names; reports errors.
    pub fn expression(&mut self, value: Value<'_>) -> Option<Expr> {
        let known = |text: &str| self.values.contains_key(text.trim_end_matches('\''));
        let misfit = match expression::read(value.text, known) {
            Ok(read) => match read.renamed(&mut |name| self.name(&name).ok_or(name)) {
                Ok(expression) => return Some(expression),
                Err(name) => {
                    let near = similar(name.trim_end_matches('\''), self.values.keys().copied());
                    Misfit::Unknown { kind: "value", name, near }
                }
            },
            Err(ParseError::Foreign(what)) => {
                self.cannot(what, "nothing like it is in the language", value.at, "work it out beforehand");
                return None;
            }
            Err(ParseError::Bad(why)) => Misfit::Expression { why },
        };
        self.diagnostics.report(BadForm { misfit, at: value.at });
        None
    }

    /// The initial value of a declaration: made of numbers and of parameters declared before it.
    pub fn first_value(&mut self, value: Value<'_>, declared: Span) -> Option<Expr> {
        let mut unknown = None;
        if let Ok(read) = expression::read(value.text, |text| self.values.contains_key(text)) {
            read.visit(&mut |part| {
                if let Expr::Name(name) = part {
                    let before = |v: &Named| v.kind == Kind::Param && v.at.start() < declared.start();
                    if !self.values.get(name.as_str()).is_some_and(before) {
                        unknown = Some(name.clone());
                    }
                }
            });
        }
        let Some(name) = unknown else { return self.expression(value) };
        let misfit = Misfit::Unknown { kind: "parameter above this", name, near: None };
        self.diagnostics.report(BadForm { misfit, at: value.at });
        None
    }

    /// A variable that is driven or updated, or a derivative of one; reports other names.
    pub fn variable(&mut self, value: Value<'_>, continuous: bool) -> Option<String> {
        let kind = self.values.get(value.text.trim_end_matches('\'')).map(|v| v.kind);
        if continuous && matches!(kind, Some(Kind::Discrete { .. } | Kind::Undriven)) {
            let help = "let edges update it, or make it a `<variable>`";
            self.cannot("a discrete variable that flows".into(), "only updates change it", value.at, help);
            return None;
        }
        let found = if kind == Some(Kind::Param) { None } else { self.name(value.text) };
        if found.is_none() {
            let variables = self.values.iter().filter(|(_, v)| v.kind != Kind::Param).map(|(name, _)| *name);
            let near = similar(value.text, variables);
            let misfit = Misfit::Unknown { kind: "variable", name: value.text.to_string(), near };
            self.diagnostics.report(BadForm { misfit, at: value.at });
        }
        found
    }
}
