//! Conversion of an automaton to an entity: its declarations in the usual order, then its modes.

use super::discrete;
use super::form::fits;
use super::guard::{self, GuardContext};
use super::motion::{edge, envelope, flow, follow};
use super::names::{self, Names, tag};
use super::notes::{self, Noted, Notes};
use super::read::Element;
use super::scope::{AXES, Kind, Named, Scope};
use super::write::Statement;
use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::import::{BadForm, Bounded, Misfit};

/// Converts an automaton to an entity.
pub(super) fn entity(automaton: Element<'_, '_>, taken: &mut Names, diagnostics: &mut Diagnostics) -> Statement {
    let (text, at) = automaton.value("name").map_or(("", automaton.tag()), |v| (v.text, v.at));
    let name = names::entity(text, at, taken, diagnostics);
    let mut scope = Scope::new(automaton, diagnostics);
    let Notes { opening, children, closing } = notes::notes(automaton);
    let before = automaton.node.prev_siblings().skip(1).filter(|n| n.is_comment());
    let mut above: Vec<String> = before.flat_map(|n| notes::inside(automaton.at(n))).collect();
    above.reverse();
    above.extend(opening);

    declare(automaton, &mut scope);
    let (mut colliders, mut modes) = (Vec::new(), Vec::new());
    for Noted { element, above, beside } in &children {
        match element.name() {
            "collider" => colliders.extend(collider(*element, &mut scope, above.clone(), beside.clone())),
            "group" => {
                let root = scope.modes.roots.iter().position(|r| r.element.node == element.node);
                modes.extend(root.map(|root| group(root, &mut scope, (above, beside))).unwrap_or_default());
            }
            "flow" => {
                scope.left_out("a flow of the whole entity", "it has no effect there", element.tag());
            }
            _ => {}
        }
    }
    // Uses are known now; a parameter may read those above it.
    let mut params = Vec::new();
    let mut variables = Vec::new();
    for noted in children.iter().rev() {
        match noted.element.name() {
            "param" => params.extend(param(noted, &mut scope)),
            "variable" | "dvariable" => variables.extend(variable(noted, &mut scope)),
            _ => {}
        }
    }
    if let Some(Named { here: Some(here), .. }) = scope.values.get("gravity")
        && !automaton.all("param").any(|p| p.value("name").is_some_and(|v| v.text == "gravity"))
    {
        params.push(Statement::new(format!("param {here} = 0")));
    }
    params.reverse();
    variables.reverse();
    let mut sections = vec![params, variables, inputs(&scope), colliders];
    modes.extend(closing.into_iter().map(Statement::comment));
    sections.push(modes);
    let mut members = Vec::new();
    for mut section in sections {
        if let Some(first) = section.first_mut() {
            first.apart = true;
        }
        members.extend(section);
    }
    Statement { documented: true, ..Statement::block(format!("entity {name}"), members) }.with(above, Vec::new())
}

/// Declares the values of an automaton in the scope.
fn declare<'a>(automaton: Element<'a, '_>, scope: &mut Scope<'a, '_, '_>) {
    for e in automaton.children() {
        let kind = match e.name() {
            "param" => Kind::Param,
            "variable" => Kind::Continuous,
            "dvariable" => discrete::kind(automaton, e),
            _ => continue,
        };
        let (Some(name), Some(_)) = (e.value("name"), e.value("value")) else { continue };
        if kind == Kind::Continuous && matches!(name.text.trim_end_matches('\''), "x" | "y") {
            let help = "give it where a world places the entity: `place … { y' = 100 }`";
            scope.cannot(format!("a first value of `{}`", name.text), "part of every entity", name.at, help);
            continue;
        }
        if kind == Kind::Continuous && name.text.ends_with('\'') {
            let help = "give it where a world places the entity: `place … { charge' = 1 }`";
            scope.cannot(format!("a first value of `{}`", name.text), "not a variable by itself", name.at, help);
            continue;
        }
        if scope.values.contains_key(name.text) {
            let kind = if kind == Kind::Param { "parameter" } else { "variable" };
            let misfit = Misfit::Declared { kind, name: name.text.to_string() };
            scope.diagnostics.report(BadForm { misfit, at: name.at });
            continue;
        }
        scope.values.insert(name.text, Named { kind, here: None, at: name.at });
    }
    // Built into every automaton.
    scope.values.entry("gravity").or_insert(Named { kind: Kind::Param, here: None, at: automaton.tag() });
}

/// The name of a declaration, if it is not overridden and is used; reports an unused one.
fn used(e: Element<'_, '_>, what: &str, scope: &mut Scope<'_, '_, '_>) -> Option<String> {
    let name = e.value("name")?;
    let named = scope.values.get(name.text).filter(|named| named.at == name.at)?;
    if named.here.is_none() {
        scope.left_out(format!("the {what} `{}`", name.text), "nothing reads it", name.at);
    }
    scope.values.get(name.text)?.here.clone()
}

fn param(noted: &Noted<'_, '_>, scope: &mut Scope<'_, '_, '_>) -> Option<Statement> {
    let (e, at) = (noted.element, noted.element.value("name")?.at);
    let name = used(e, "parameter", scope)?;
    let value = scope.first_value(e.value("value")?, at).filter(|_| fits(e));
    let made = value.map(|value| Statement::new(format!("param {name} = {}", value.text())));
    Some(made.unwrap_or_else(|| gap(e)).with(noted.above.clone(), noted.beside.clone()))
}

fn variable(noted: &Noted<'_, '_>, scope: &mut Scope<'_, '_, '_>) -> Option<Statement> {
    let e = noted.element;
    let there = e.value("name")?;
    let name = used(e, "variable", scope)?;
    let value = scope.first_value(e.value("value")?, there.at).filter(|_| fits(e)).map(|value| value.text());
    let made = match (value, scope.values.get(there.text)?.kind) {
        (Some(value), Kind::Discrete { low, high }) => {
            scope.diagnostics.report(Bounded { name: name.clone(), range: (low, high), at: there.at });
            Statement::new(format!("discrete {name}: int {low}..{high} = {value}"))
        }
        (Some(value), _) => Statement::new(format!("continuous {name} = {value}")),
        (None, _) => gap(e),
    };
    Some(made.with(noted.above.clone(), noted.beside.clone()))
}

/// The buttons and axes that are read.
fn inputs(scope: &Scope<'_, '_, '_>) -> Vec<Statement> {
    let axes = AXES.into_iter().zip(scope.axes).filter(|(_, read)| *read).map(|(name, _)| name.to_string());
    let lines = [("axis", axes.collect()), ("button", scope.buttons.iter().map(|(_, here)| here.clone()).collect())];
    let line = |(word, names): (&str, Vec<String>)| {
        (!names.is_empty()).then(|| Statement::new(format!("{word} {}", names.join(", "))))
    };
    lines.into_iter().filter_map(line).collect()
}

/// A comment in place of an omitted part.
fn gap(e: Element<'_, '_>) -> Statement {
    let named = |what: &str, attribute: &str| match e.value(attribute) {
        // A value may contain line breaks.
        Some(value) => format!("{what} `{}`", value.text.split_whitespace().collect::<Vec<_>>().join(" ")),
        None => what.split(" to").next().unwrap_or(what).trim_end_matches(" of").to_string(),
    };
    let what = match e.name() {
        "param" => named("the parameter", "name"),
        "variable" | "dvariable" => named("the variable", "name"),
        "flow" => named("the flow of", "var"),
        "edge" => named("an edge to", "target"),
        "follow_link" => "`follow links`".to_string(),
        "group" => named("the group", "name"),
        "envelope" => "an envelope".to_string(),
        _ => "a collider".to_string(),
    };
    Statement::comment(format!("Left out by the import: {what}."))
}

fn collider(
    e: Element<'_, '_>,
    scope: &mut Scope<'_, '_, '_>,
    mut above: Vec<String>,
    beside: Vec<String>,
) -> Vec<Statement> {
    above.extend(notes::inside(e));
    let statement = shape(e, scope).filter(|_| fits(e)).unwrap_or_else(|| gap(e));
    vec![statement.with(above, beside)]
}

fn shape(e: Element<'_, '_>, scope: &mut Scope<'_, '_, '_>) -> Option<Statement> {
    let is_static = match e.value("static") {
        Some(value) if !matches!(value.text, "true" | "false") => {
            let misfit = Misfit::Word { found: value.text.to_string(), known: &["true", "false"] };
            scope.diagnostics.report(BadForm { misfit, at: value.at });
            return None;
        }
        value => value.is_some_and(|v| v.text == "true"),
    };
    let mut tags: Vec<String> = Vec::new();
    for name in e.all("type") {
        let name = name.value("name")?;
        let tag = scope.tag(name, tag(name.text))?;
        if !tags.contains(&tag) {
            tags.push(tag);
        }
    }
    let guard = guard::of(e, GuardContext::Collider, scope);
    let mut rects = e.all("rect");
    let rect = rects.next()?;
    for other in rects {
        scope.left_out("a second rectangle of a collider", "only the first one is looked at there", other.tag());
    }
    let mut numbers = Vec::new();
    for name in ["x", "y", "w", "h"] {
        numbers.push(scope.expression(rect.value(name)?)?);
    }
    let [x, y, width, height] = <[_; 4]>::try_from(numbers).ok()?;
    // Converts the upper-left corner to the lower-left one.
    let y = y.minus(height.clone());
    let kinematic = if is_static { "kinematic " } else { "" };
    let numbers = [x, y, width, height].map(|n| n.text()).join(", ");
    if tags.is_empty() {
        return None;
    }
    Some(Statement::new(format!("{kinematic}collider {}: rect({numbers}){}", tags.join(", "), guard?.when())))
}

/// The statements of a root group: its modes, in a `group` block if it has a name.
fn group(root: usize, scope: &mut Scope<'_, '_, '_>, (above, beside): (&[String], &[String])) -> Vec<Statement> {
    let Some(found) = scope.modes.roots.get(root) else { return Vec::new() };
    let (name, element, ids) = (found.name.clone(), found.element, found.modes.clone());
    let mut inside = modes(element, &ids, scope);
    match name {
        Some(name) => {
            vec![Statement::block(format!("group {name}"), inside).with(above.to_vec(), beside.to_vec())]
        }
        None => {
            if let Some(first) = inside.first_mut() {
                let mut all = above.to_vec();
                all.extend(beside.to_vec());
                all.append(&mut first.above);
                first.above = all;
            }
            inside
        }
    }
}

/// The modes of a group, with the group's comments.
fn modes(group: Element<'_, '_>, ids: &[usize], scope: &mut Scope<'_, '_, '_>) -> Vec<Statement> {
    let notes = notes::notes(group);
    let mut statements = Vec::new();
    let mut opening = notes.opening;
    for noted in notes.children {
        let id = ids
            .iter()
            .copied()
            .find(|&id| scope.modes.all.get(id).is_some_and(|m| m.element.node == noted.element.node));
        if let Some(id) = id {
            let mut above = std::mem::take(&mut opening);
            above.extend(noted.above);
            statements.push(mode(id, scope).with(above, noted.beside));
        }
    }
    statements.extend(notes.closing.into_iter().map(Statement::comment));
    statements
}

/// A mode. The nesting of elements bounds the recursion.
fn mode(id: usize, scope: &mut Scope<'_, '_, '_>) -> Statement {
    let Some(mode) = scope.modes.all.get(id) else { return Statement::default() };
    let (name, element, inner) = (mode.name().to_string(), mode.element, mode.inner.clone());
    let Notes { opening, children, closing } = notes::notes(element);
    let (mut flows, mut links, mut envelopes, mut edges, mut nested) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for Noted { element: e, mut above, beside } in children {
        scope.idle = false;
        let (list, made) = match e.name() {
            "flow" => (&mut flows, flow(e, element, scope)),
            "follow_link" => (&mut links, follow(e, id, scope)),
            "envelope" => (&mut envelopes, envelope(e, (element, id), scope)),
            "edge" => (&mut edges, edge(e, id, scope)),
            "group" => {
                if let Some((group, ids)) = inner.as_ref().filter(|(group, _)| group.node == e.node) {
                    let mut inside = modes(*group, ids, scope);
                    if let Some(first) = inside.first_mut() {
                        above.extend(beside);
                        above.append(&mut first.above);
                        first.above = above;
                    }
                    nested.extend(inside);
                } else {
                    nested.push(gap(e).with(above, beside));
                }
                continue;
            }
            _ => continue,
        };
        above.extend(notes::inside(e));
        match made.filter(|_| fits(e)) {
            Some(statement) => list.push(statement.with(above, beside)),
            // A part without effect needs no comment.
            None if !scope.idle => list.push(gap(e).with(above, beside)),
            None => {}
        }
    }
    if let Some(first) = nested.first_mut() {
        first.apart = true;
    }
    let mut members = flows;
    members.extend(links.into_iter().chain(envelopes).chain(edges).chain(nested));
    members.extend(closing.into_iter().map(Statement::comment));
    Statement { beside: opening, ..Statement::block(format!("mode {name}"), members) }
}
