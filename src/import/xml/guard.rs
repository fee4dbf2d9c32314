//! Conditions: from their elements to the shortest text of a guard.

use super::expression::Expr;
use super::form::is_guard;
use super::names::tag;
use super::read::{Element, Value};
use super::scope::Scope;
use crate::diagnostic::catalogue::import::{BadForm, Misfit};

/// A condition.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Guard {
    Constant(bool),
    /// A predicate: `held(jump)`.
    Atom(String),
    /// A comparison: two values and the operator.
    Compare(Expr, &'static str, Expr),
    Not(Box<Guard>),
    All(Vec<Guard>),
    Any(Vec<Guard>),
}

/// The owner of a condition.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum GuardContext {
    /// A member of this mode.
    Mode(usize),
    /// A collider, which knows neither inputs nor contacts nor timers.
    Collider,
}

/// The comparisons by their names in the file, and their negations.
const COMPARISONS: &[(&str, &str, &str)] =
    &[("=", "==", "!="), ("==", "==", "!="), ("!=", "!=", "=="), ("<", "<", ">="), ("<=", "<=", ">")];
const GREATER: &[(&str, &str, &str)] = &[(">", ">", "<="), (">=", ">=", "<")];

/// The condition of an element with an optional `<guard>`: without one it always holds. None if it cannot be imported,
/// which is reported.
pub(super) fn of(owner: Element<'_, '_>, context: GuardContext, scope: &mut Scope<'_, '_, '_>) -> Option<Guard> {
    match owner.first("guard") {
        Some(guard) => condition(guard, context, scope),
        None => Some(Guard::Constant(true)),
    }
}

fn condition(e: Element<'_, '_>, context: GuardContext, scope: &mut Scope<'_, '_, '_>) -> Option<Guard> {
    match e.name() {
        "guard" | "and" => Some(all(parts(e, context, scope)?)),
        "or" => Some(any(parts(e, context, scope)?)),
        "not" => Some(not(all(parts(e, context, scope)?))),
        "true" => Some(Guard::Constant(true)),
        "false" => Some(Guard::Constant(false)),
        "compare" => {
            let (left, right) = (scope.expression(e.value("left")?), scope.expression(e.value("right")?));
            let sign = word(e.value("op")?, &["=", ">=", ">", "<=", "<"], scope, |op| {
                COMPARISONS.iter().chain(GREATER).find(|(there, ..)| *there == op).map(|(_, here, _)| *here)
            });
            Some(Guard::Compare(left?, sign?, right?))
        }
        "in_mode" => {
            let from = if let GuardContext::Mode(mode) = context { Some(mode) } else { None };
            let mode = scope.modes.find(e.value("mode")?, from, scope.diagnostics)?;
            Some(Guard::Atom(format!("in {}", scope.modes.reference(mode))))
        }
        "button" => button(e, context, scope),
        "timer" => {
            let limit = scope.expression(e.value("limit")?)?;
            scope.known_to(context, e, "a timer")?;
            Some(Guard::Compare(Expr::Name("timer".into()), ">=", limit))
        }
        "colliding" => colliding(e, context, scope),
        "joint_transition" => joint_transition(e, context, scope),
        // `form` has reported it.
        _ => None,
    }
}

/// The conditions in an element.
fn parts(e: Element<'_, '_>, context: GuardContext, scope: &mut Scope<'_, '_, '_>) -> Option<Vec<Guard>> {
    // All are visited, so that all mistakes are reported.
    let parts: Vec<Option<Guard>> = e.children().map(|c| condition(c, context, scope)).collect();
    if e.children().all(|c| is_guard(c.name())) { parts.into_iter().collect() } else { None }
}

/// The meaning of a keyword; reports an unknown one.
fn word<T>(
    value: Value<'_>,
    known: &'static [&'static str],
    scope: &mut Scope<'_, '_, '_>,
    meaning: impl Fn(&str) -> Option<T>,
) -> Option<T> {
    let found = meaning(value.text);
    if found.is_none() {
        let misfit = Misfit::Word { found: value.text.to_string(), known };
        scope.diagnostics.report(BadForm { misfit, at: value.at });
    }
    found
}

fn button(e: Element<'_, '_>, context: GuardContext, scope: &mut Scope<'_, '_, '_>) -> Option<Guard> {
    const STATES: &[&str] = &["on", "off", "pressed", "released"];
    let (name, status) = (e.value("name")?, e.value("status")?);
    let status = word(status, STATES, scope, |s| STATES.iter().copied().find(|known| *known == s))?;
    scope.known_to(context, e, "a button")?;
    scope.player(e);
    // If the entity also reads the axis that the button is an end of, the query uses the axis: here, an input that is
    // both would be the button alone.
    if let Some((axis, sign)) = scope.end_of_axis(name.text) {
        let (axis, zero) = (Expr::Name(axis.into()), Expr::whole(0));
        return match (status, sign) {
            ("on", sign) => Some(Guard::Compare(axis, sign, zero)),
            ("off", sign) => Some(not(Guard::Compare(axis, sign, zero))),
            _ => {
                let what = format!("`{status}` of a button that is an end of an axis");
                scope.cannot(what, "the entity reads the axis, too", e.tag(), "ask for another button");
                None
            }
        };
    }
    let button = scope.button(name);
    Some(match status {
        "on" => Guard::Atom(format!("held({button})")),
        "off" => not(Guard::Atom(format!("held({button})"))),
        other => Guard::Atom(format!("{other}({button})")),
    })
}

fn colliding(e: Element<'_, '_>, context: GuardContext, scope: &mut Scope<'_, '_, '_>) -> Option<Guard> {
    let side = match e.value("normal") {
        Some(normal) => Some(word(normal, &["top", "bottom", "left", "right"], scope, |n| {
            let sides = [("top", "above"), ("bottom", "below"), ("left", "left"), ("right", "right")];
            sides.into_iter().find(|(there, _)| *there == n).map(|(_, here)| here)
        })?),
        None => None,
    };
    scope.known_to(context, e, "a contact")?;
    let Some(other) = e.value("othertype") else {
        let help = "name what is touched: `othertype=\"…\"`; several are an `<or>`";
        scope.cannot("a contact with whatever it is".into(), "it names no `othertype`", e.tag(), help);
        return None;
    };
    let mut words = Vec::new();
    for value in e.value("type").into_iter().chain([other]) {
        words.push(scope.tag(value, tag(value.text))?);
    }
    let sides = ["left", "right", "above", "below"];
    if side.is_none() && words.len() == 2 && sides.contains(&other.text) {
        let help = "give what is touched another type";
        scope.cannot(format!("a contact with `{}`", other.text), "it would be read as a side", other.at, help);
        return None;
    }
    words.extend(side.map(str::to_string));
    Some(Guard::Atom(format!("touching({})", words.join(", "))))
}

fn joint_transition(e: Element<'_, '_>, context: GuardContext, scope: &mut Scope<'_, '_, '_>) -> Option<Guard> {
    scope.known_to(context, e, "a joint transition")?;
    let function = match e.value("direction") {
        None => "entering",
        Some(direction) => word(direction, &["enter", "exit"], scope, |d| match d {
            "enter" => Some("entering"),
            "exit" => Some("exiting"),
            _ => None,
        })?,
    };
    let GuardContext::Mode(from) = context else { return None };
    let mode = scope.modes.find(e.value("mode")?, Some(from), scope.diagnostics)?;
    let root = |id: usize| scope.modes.all.get(id).map(|m| m.root);
    if root(mode) == root(from) {
        let help = "put what both do on the edge itself";
        scope.cannot("a joint transition with the own group".into(), "in the same group", e.tag(), help);
        return None;
    }
    Some(Guard::Atom(format!("{function}({})", scope.modes.reference(mode))))
}

/// The conjunction of some conditions.
fn all(parts: Vec<Guard>) -> Guard {
    let mut flat = Vec::new();
    for part in parts {
        match part {
            Guard::All(inner) => flat.extend(inner),
            Guard::Constant(true) => {}
            other => flat.push(other),
        }
    }
    single(flat, true, Guard::All)
}

/// The disjunction of some conditions.
fn any(parts: Vec<Guard>) -> Guard {
    let mut flat = Vec::new();
    for part in parts {
        match part {
            Guard::Any(inner) => flat.extend(inner),
            Guard::Constant(false) => {}
            other => flat.push(other),
        }
    }
    single(flat, false, Guard::Any)
}

fn single(mut parts: Vec<Guard>, of_none: bool, of_many: fn(Vec<Guard>) -> Guard) -> Guard {
    match parts.len() {
        0 => Guard::Constant(of_none),
        1 => parts.swap_remove(0),
        _ => of_many(parts),
    }
}

/// The negation.
fn not(guard: Guard) -> Guard {
    match guard {
        Guard::Constant(value) => Guard::Constant(!value),
        Guard::Not(inner) => *inner,
        Guard::Compare(left, sign, right) => {
            let opposite = COMPARISONS.iter().chain(GREATER).find(|(_, here, _)| *here == sign);
            Guard::Compare(left, opposite.map_or(sign, |(.., opposite)| *opposite), right)
        }
        other => Guard::Not(Box::new(other)),
    }
}

impl Guard {
    /// Its text.
    pub fn text(&self) -> String {
        self.tighter(0)
    }

    /// Its text inside an operator of a precedence: 1 `or`, 2 `and`, 3 `not`.
    fn tighter(&self, around: u8) -> String {
        let joined = |parts: &[Guard], own: u8, word: &str| {
            let text = parts.iter().map(|p| p.tighter(own)).collect::<Vec<_>>().join(word);
            if own < around { format!("({text})") } else { text }
        };
        match self {
            Guard::Constant(value) => value.to_string(),
            Guard::Atom(text) => text.clone(),
            Guard::Compare(left, sign, right) => format!("{} {sign} {}", left.text(), right.text()),
            Guard::Not(inner) => format!("not {}", inner.tighter(3)),
            Guard::All(parts) => joined(parts, 2, " and "),
            Guard::Any(parts) => joined(parts, 1, " or "),
        }
    }

    /// ` when GUARD`; empty if it always holds.
    pub fn when(&self) -> String {
        if *self == Guard::Constant(true) { String::new() } else { format!(" when {}", self.text()) }
    }

    /// The lower bound of a value while this holds, if a part of it implies one.
    pub fn least(&self, name: &str) -> Option<f64> {
        match self {
            Guard::Compare(Expr::Name(found), sign, limit) if found == name => match (*sign, limit.constant()?) {
                // Values are whole.
                (">", limit) => Some(limit.floor() + 1.0),
                (">=" | "==", limit) => Some(limit.ceil()),
                _ => None,
            },
            Guard::All(parts) => parts.iter().filter_map(|p| p.least(name)).reduce(|a, b| if b > a { b } else { a }),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn atom(name: &str) -> Guard {
        Guard::Atom(name.into())
    }

    #[test]
    fn parentheses_stand_only_where_they_are_needed() {
        let either = any(vec![atom("a"), atom("b")]);
        assert_eq!(all(vec![either.clone(), atom("c")]).text(), "(a or b) and c");
        assert_eq!(any(vec![all(vec![atom("a"), atom("b")]), atom("c")]).text(), "a and b or c");
        assert_eq!(not(either.clone()).text(), "not (a or b)");
        assert_eq!(any(vec![either, all(vec![atom("c")])]).text(), "a or b or c");
        assert_eq!(not(not(atom("a"))).text(), "a");
    }

    #[test]
    fn opposites_of_comparisons_are_comparisons() {
        for (_, here, opposite) in COMPARISONS.iter().chain(GREATER) {
            let compare = |sign| Guard::Compare(Expr::Name("x".into()), sign, Expr::whole(1));
            assert_eq!(not(compare(here)), compare(opposite));
            assert_eq!(not(compare(opposite)), compare(here));
        }
    }

    #[test]
    fn a_part_bounds_a_value() {
        let above = Guard::Compare(Expr::Name("keys".into()), ">", Expr::whole(0));
        assert_eq!(all(vec![atom("a"), above.clone()]).least("keys"), Some(1.0));
        assert_eq!(any(vec![atom("a"), above]).least("keys"), None);
        assert_eq!(atom("a").least("keys"), None);
    }
}
