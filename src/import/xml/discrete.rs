//! Discrete variables. In the imported system they are numbers without bounds; here whole numbers in a range. The
//! chosen range contains all values that the entity mentions, and updates are clamped to it. One that is not always
//! whole becomes a variable that nothing drives, which is equivalent.

use super::expression::{self, Expr};
use super::guard::Guard;
use super::read::Element;
use super::scope::Kind;

/// The range of a discrete variable by its declaration and updates, or its conversion to a variable.
pub(super) fn kind(automaton: Element<'_, '_>, declared: Element<'_, '_>) -> Kind {
    let whole: Vec<&str> = automaton.all("dvariable").filter_map(|d| d.value("name")).map(|v| v.text).collect();
    let name = declared.value("name").map_or("", |v| v.text);
    let read = |e: Element<'_, '_>, attribute| {
        let text = e.value(attribute)?.text;
        expression::read(text, |t| whole.contains(&t)).ok()
    };
    let Some(first) = read(declared, "value").and_then(|e| e.constant()) else { return Kind::Undriven };
    let mut written = vec![first];
    let (mut falls, mut is_whole) = (false, true);
    for node in automaton.node.descendants().filter(|n| n.is_element()) {
        let e = automaton.at(node);
        let of_it = |attribute| e.value(attribute).is_some_and(|v| v.text == name);
        let expression = match e.name() {
            "update" if of_it("var") => read(e, "value"),
            "compare" if of_it("left") => read(e, "right").filter(|other| other.constant().is_some()),
            "compare" if of_it("right") => read(e, "left").filter(|other| other.constant().is_some()),
            _ => continue,
        };
        let updates = e.name() == "update";
        match expression {
            Some(expression) => expression.visit(&mut |part| match part {
                Expr::Number(_) => written.extend(part.constant()),
                Expr::Negative(_) | Expr::Binary('-', ..) => falls = true,
                Expr::Name(other) => is_whole &= !updates || whole.contains(&other.as_str()),
                Expr::Binary('/', ..) => is_whole = false,
                Expr::Call(function, _) => is_whole &= matches!(*function, "min" | "max" | "abs" | "sign"),
                Expr::Binary(..) => {}
            }),
            None => is_whole &= !updates,
        }
    }
    is_whole &= written.iter().all(|n| n.fract() == 0.0 && n.abs() < 1e9);
    if !is_whole {
        return Kind::Undriven;
    }
    let greatest = written.iter().map(|n| n.abs()).fold(0.0, |most: f64, n| if n > most { n } else { most });
    let mut high = 99;
    while (high as f64) < greatest {
        high = high * 10 + 9;
    }
    // A variable that is decremented only under a sufficient lower bound never falls below 0.
    let low = if first < 0.0 || (falls && !stays(automaton, name)) { -high } else { 0 };
    Kind::Discrete { low, high }
}

/// Whether the guards of all decrements of a variable keep it from falling below 0.
fn stays(automaton: Element<'_, '_>, name: &str) -> bool {
    let mut updates = automaton.node.descendants().filter(|n| n.has_tag_name("update"));
    updates.all(|node| {
        let update = automaton.at(node);
        let Some(value) = update.value("value").filter(|_| update.value("var").is_some_and(|v| v.text == name)) else {
            return true;
        };
        let guard = node.parent().map(|edge| automaton.at(edge)).and_then(|edge| edge.first("guard"));
        match expression::read(value.text, |_| false) {
            Ok(Expr::Binary('-', left, amount)) if *left == Expr::Name(name.into()) => {
                let mut least = guard.map(required).unwrap_or_default().into_iter().filter_map(|c| {
                    let limit = expression::read(c.value("right")?.text, |_| false).ok()?.constant()?;
                    match (c.value("left")?.text == name, c.value("op")?.text) {
                        (true, ">") => Some(limit.floor() + 1.0),
                        (true, ">=" | "=") => Some(limit.ceil()),
                        _ => None,
                    }
                });
                amount.constant().is_some_and(|n| least.any(|at_least| at_least >= n))
            }
            Ok(other) => {
                let mut falls = false;
                other.visit(&mut |part| falls |= matches!(part, Expr::Negative(_) | Expr::Binary('-', ..)));
                !falls
            }
            Err(_) => true,
        }
    })
}

/// The comparisons that a condition requires.
fn required<'a, 't>(condition: Element<'a, 't>) -> Vec<Element<'a, 't>> {
    let inner = condition.all("and").flat_map(required);
    condition.all("compare").chain(inner).collect()
}

/// The new value of a discrete variable as text, clamped to its range unless the guard does so.
pub(super) fn kept(name: &str, value: &Expr, (low, high): (i64, i64), guard: &Guard) -> String {
    let text = value.text();
    if value.constant().is_some() {
        return text;
    }
    match value {
        Expr::Name(_) => {}
        Expr::Binary(sign @ ('+' | '-'), left, amount) if **left == Expr::Name(name.into()) => {
            let amount = amount.constant().map(|n| if *sign == '-' { -n } else { n });
            match amount {
                Some(n) if n > 0.0 => return format!("min({text}, {high})"),
                Some(n) if guard.least(name).is_some_and(|least| least + n >= low as f64) => return text,
                Some(_) => return format!("max({text}, {low})"),
                None => {}
            }
        }
        _ => {}
    }
    format!("clamp({text}, {low}, {high})")
}
