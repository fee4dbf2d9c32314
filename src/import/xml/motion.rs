//! The members of a mode: flows, envelopes, edges, followed links.

use super::discrete::kept;
use super::guard::{self, Guard, GuardContext};
use super::read::{Element, Value};
use super::scope::{AXES, Kind, Scope};
use super::write::Statement;
use crate::diagnostic::catalogue::import::{BadForm, Misfit};
use crate::format::WIDTH;

/// The variable of a name with primes.
fn base(variable: &str) -> &str {
    variable.trim_end_matches('\'')
}

/// The variables that an envelope drives.
fn driven<'a>(envelope: Element<'a, '_>) -> Vec<&'a str> {
    envelope.all("control").filter_map(|c| c.value("var")).map(|v| base(v.text)).collect()
}

/// A flow of a mode; none if it has no effect or cannot be imported, which is reported.
pub(super) fn flow(e: Element<'_, '_>, mode: Element<'_, '_>, scope: &mut Scope<'_, '_, '_>) -> Option<Statement> {
    let (var, value) = (e.value("var")?, e.value("value")?);
    if mode.all("envelope").any(|envelope| driven(envelope).contains(&base(var.text))) {
        scope.idle(format!("the flow of `{}`", var.text), "an envelope of the mode replaces it", e.tag());
        return None;
    }
    let mut before = mode.all("flow").take_while(|other| other.node != e.node).filter_map(|other| other.value("var"));
    if let Some(other) = before.find(|other| base(other.text) == base(var.text)) {
        if other.text == var.text {
            let misfit = Misfit::Declared { kind: "flow", name: var.text.to_string() };
            scope.diagnostics.report(BadForm { misfit, at: var.at });
        } else {
            let what = format!("a second flow of `{}`", base(var.text));
            scope.cannot(what, "which one counts there is chance", var.at, "keep the one that is meant");
        }
        return None;
    }
    let (var, value) = (scope.variable(var, true), scope.expression(value));
    Some(Statement::new(format!("{} = {}", var?, value?.text())))
}

/// An envelope of a mode.
pub(super) fn envelope(
    e: Element<'_, '_>,
    (mode, id): (Element<'_, '_>, usize),
    scope: &mut Scope<'_, '_, '_>,
) -> Option<Statement> {
    let mine = driven(e);
    let later: Vec<&str> = mode.all("envelope").skip_while(|o| o.node != e.node).skip(1).flat_map(driven).collect();
    if mine.iter().any(|v| later.contains(v)) {
        if mine.iter().all(|v| later.contains(v)) {
            scope.idle("an envelope", "a later one of the mode replaces it", e.tag());
        } else {
            let help = "let each variable be driven by one envelope";
            scope.cannot("an envelope that another one replaces in part".into(), "replaced in part", e.tag(), help);
        }
        return None;
    }
    let links = e.value("ways")?;
    let count = match links.text.parse::<u32>() {
        Ok(2) => 1,
        Ok(3..=64) => 2,
        Ok(_) => {
            let help = "an envelope has two ways, or from three to 64";
            scope.cannot(format!("an envelope with `ways=\"{}\"`", links.text), "not possible here", links.at, help);
            return None;
        }
        Err(_) => {
            let misfit = Misfit::Expression { why: "a whole number is needed".into() };
            scope.diagnostics.report(BadForm { misfit, at: links.at });
            return None;
        }
    };
    let controls = of_count(e, "control", count, scope);
    let axes = of_count(e, "axis", count, scope);
    let mut variables = Vec::new();
    for control in controls? {
        variables.push(scope.variable(control.value("var")?, true)?);
    }
    let mut inputs = Vec::new();
    for axis in axes? {
        scope.player(axis);
        inputs.push(axis_name(axis.value("name")?, scope)?);
    }
    if let [first, second] = variables.as_slice()
        && base(first) == base(second)
    {
        scope.cannot("an envelope of one variable by two axes".into(), "driven twice", e.tag(), "give each its own");
        return None;
    }
    let while_driven = guard::of(e, GuardContext::Mode(id), scope);
    let attack = scope.expression(e.first("attack")?.value("acc")?);
    let sustain = scope.expression(e.first("sustain")?.value("level")?);
    let mut parts = vec![format!("attack accel {}", attack?.text()), format!("sustain {}", sustain?.text())];
    parts.extend(release(e, scope)?);
    if let Some(decay) = e.first("decay") {
        scope.left_out("the decay of an envelope", "it has no effect there", decay.tag());
    }
    match while_driven? {
        Guard::Constant(true) => {}
        guard => parts.push(format!("while {}", guard.text())),
    }
    let list = |names: &[String]| if names.len() == 1 { names.concat() } else { format!("({})", names.join(", ")) };
    let directions =
        if count == 2 { format!(" directions {}", links.text.trim_start_matches(['+', '0'])) } else { String::new() };
    let header = format!("envelope {} by {}{directions}", list(&variables), list(&inputs));
    Some(Statement::block(header, parts.into_iter().map(Statement::new).collect()))
}

/// The elements of a kind in an envelope; reports a wrong number.
fn of_count<'a, 't>(
    e: Element<'a, 't>,
    name: &'static str,
    count: usize,
    scope: &mut Scope<'_, '_, '_>,
) -> Option<Vec<Element<'a, 't>>> {
    let found: Vec<Element<'a, 't>> = e.all(name).collect();
    if let Some(extra) = found.get(count) {
        let misfit = Misfit::Twice { name: name.to_string(), owner: "envelope" };
        scope.diagnostics.report(BadForm { misfit, at: extra.tag() });
    } else if !found.is_empty() && found.len() < count {
        let help = "more than two ways need two `<control>` and two `<axis>`";
        scope.cannot(format!("an envelope with one `<{name}>`"), "there are two directions", e.tag(), help);
    }
    (found.len() == count).then_some(found)
}

fn axis_name(name: Value<'_>, scope: &mut Scope<'_, '_, '_>) -> Option<String> {
    let index = ["x", "y"].iter().position(|known| *known == name.text);
    if index.is_none() {
        let misfit = Misfit::Word { found: name.text.to_string(), known: &["x", "y"] };
        scope.diagnostics.report(BadForm { misfit, at: name.at });
    }
    Some(AXES.get(index?)?.to_string())
}

/// The release part of an envelope; empty if it is the default: at once, to 0.
fn release(e: Element<'_, '_>, scope: &mut Scope<'_, '_, '_>) -> Option<Option<String>> {
    let Some(release) = e.first("release") else { return Some(None) };
    if release.value("hold").is_some() {
        return Some(Some("release hold".into()));
    }
    let mut text = "release".to_string();
    if let Some(acc) = release.value("acc") {
        text.push_str(&format!(" accel {}", scope.expression(acc)?.text()));
    }
    if let Some(level) = release.value("level") {
        let level = scope.expression(level)?;
        if level.constant() != Some(0.0) {
            text.push_str(&format!(" to {}", level.text()));
        }
    }
    Some((text != "release").then_some(text))
}

/// An edge of a mode.
pub(super) fn edge(e: Element<'_, '_>, mode: usize, scope: &mut Scope<'_, '_, '_>) -> Option<Statement> {
    let guard = guard::of(e, GuardContext::Mode(mode), scope);
    let updates = guard.as_ref().map(|guard| updates(e, guard, scope));
    let target = e.value("target")?;
    let to = scope.modes.find(target, Some(mode), scope.diagnostics)?;
    let root = |id: usize| scope.modes.all.get(id).map(|m| m.root);
    if root(to) != root(mode) {
        let help = "let an edge of that group ask for this: `in`, `entering`, `exiting`";
        scope.cannot("an edge into another group".into(), "it leads to a mode of its own group", target.at, help);
        return None;
    }
    let header = format!("when {} -> {}", guard?.text(), scope.modes.reference(to));
    Some(with_updates(header, updates??))
}

/// The `follow links` of a mode.
pub(super) fn follow(e: Element<'_, '_>, mode: usize, scope: &mut Scope<'_, '_, '_>) -> Option<Statement> {
    let guard = guard::of(e, GuardContext::Mode(mode), scope)?;
    let updates = updates(e, &guard, scope)?;
    Some(with_updates(format!("follow links{}", guard.when()), updates))
}

/// The updates in an element, in order.
fn updates(e: Element<'_, '_>, guard: &Guard, scope: &mut Scope<'_, '_, '_>) -> Option<Vec<String>> {
    let mut updates: Vec<Option<String>> = Vec::new();
    let mut seen: Vec<&str> = Vec::new();
    for update in e.all("update") {
        let (var, value) = (update.value("var")?, update.value("value")?);
        if seen.contains(&var.text) {
            let misfit = Misfit::Declared { kind: "update", name: var.text.to_string() };
            scope.diagnostics.report(BadForm { misfit, at: var.at });
            return None;
        }
        seen.push(var.text);
        let (name, value) = (scope.variable(var, false), scope.expression(value));
        let kind = scope.values.get(var.text).map(|v| v.kind);
        updates.push(name.zip(value).map(|(name, value)| match kind {
            Some(Kind::Discrete { low, high }) => {
                format!("{name} := {}", kept(&name, &value, (low, high), guard))
            }
            _ => format!("{name} := {}", value.text()),
        }));
    }
    updates.into_iter().collect()
}

/// A statement with updates: on its line if they are short.
fn with_updates(header: String, updates: Vec<String>) -> Statement {
    let line = format!("{header} {{ {} }}", updates.join("; "));
    match updates.len() {
        0 => Statement::new(header),
        // Eight levels of indentation.
        _ if line.len() + 32 <= WIDTH => Statement::new(line),
        _ => Statement::block(header, updates.into_iter().map(Statement::new).collect()),
    }
}
