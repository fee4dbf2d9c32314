//! The schema of an entity file: the elements and their attributes. Violations are reported here, once; later stages
//! skip them.

use super::read::Element;
use crate::diagnostic::catalogue::import::{BadForm, Misfit};
use crate::diagnostic::{Diagnostics, similar};

/// The allowed contents of an element.
struct Form {
    name: &'static str,
    required: &'static [&'static str],
    optional: &'static [&'static str],
    /// Children that may occur any number of times.
    many: &'static [&'static str],
    /// Children that may occur once.
    once: &'static [&'static str],
    /// Children that must occur.
    needed: &'static [&'static str],
}

const NONE: Form = Form { name: "", required: &[], optional: &[], many: &[], once: &[], needed: &[] };

const GUARDS: &[&str] =
    &["and", "or", "not", "button", "compare", "in_mode", "true", "false", "timer", "colliding", "joint_transition"];

const FORMS: &[Form] = &[
    Form {
        name: "automaton",
        required: &["name"],
        many: &["param", "variable", "dvariable", "collider", "flow", "group"],
        ..NONE
    },
    Form { name: "param", required: &["name", "value"], optional: &["type"], ..NONE },
    Form { name: "variable", required: &["name", "value"], optional: &["type"], ..NONE },
    Form { name: "dvariable", required: &["name", "value"], optional: &["type"], ..NONE },
    Form { name: "flow", required: &["var", "value"], ..NONE },
    Form {
        name: "collider",
        optional: &["static"],
        many: &["type", "rect"],
        once: &["guard"],
        needed: &["type", "rect"],
        ..NONE
    },
    Form { name: "type", required: &["name"], ..NONE },
    Form { name: "rect", required: &["x", "y", "w", "h"], ..NONE },
    Form { name: "group", optional: &["name"], many: &["mode"], needed: &["mode"], ..NONE },
    Form { name: "mode", required: &["name"], many: &["flow", "envelope", "group", "edge", "follow_link"], ..NONE },
    Form { name: "edge", required: &["target"], many: &["update"], once: &["guard"], ..NONE },
    Form { name: "follow_link", many: &["update"], once: &["guard"], ..NONE },
    Form { name: "update", required: &["var", "value"], ..NONE },
    Form { name: "guard", many: GUARDS, ..NONE },
    Form { name: "and", many: GUARDS, ..NONE },
    Form { name: "or", many: GUARDS, ..NONE },
    Form { name: "not", many: GUARDS, ..NONE },
    Form { name: "button", required: &["name", "status"], optional: &["player"], ..NONE },
    Form { name: "compare", required: &["left", "op", "right"], ..NONE },
    Form { name: "in_mode", required: &["mode"], ..NONE },
    Form { name: "joint_transition", required: &["mode"], optional: &["direction"], ..NONE },
    Form { name: "true", ..NONE },
    Form { name: "false", ..NONE },
    Form { name: "timer", required: &["limit"], ..NONE },
    Form { name: "colliding", optional: &["type", "normal", "othertype"], ..NONE },
    Form {
        name: "envelope",
        required: &["ways"],
        many: &["control", "axis"],
        once: &["guard", "attack", "decay", "sustain", "release"],
        needed: &["control", "axis", "attack", "sustain"],
        ..NONE
    },
    Form { name: "control", required: &["var"], ..NONE },
    Form { name: "axis", required: &["name"], optional: &["player"], ..NONE },
    Form { name: "attack", required: &["acc"], ..NONE },
    Form { name: "decay", ..NONE },
    Form { name: "sustain", required: &["level"], ..NONE },
    Form { name: "release", optional: &["hold", "acc", "level"], ..NONE },
];

/// Whether an element is part of a condition.
pub(super) fn is_guard(name: &str) -> bool {
    GUARDS.contains(&name)
}

/// Reports all violations. Returns whether the file is an entity at all.
pub(super) fn check(root: Element<'_, '_>, diagnostics: &mut Diagnostics) -> bool {
    if root.name() != "automaton" {
        let misfit = Misfit::Root { name: root.name().to_string() };
        diagnostics.report(BadForm { misfit, at: root.tag() });
        return false;
    }
    // `read` limits the nesting of elements.
    element(root, diagnostics);
    root.value("name").is_some()
}

/// Whether a statement is complete and has no unknown parts: otherwise all of it is ignored.
pub(super) fn fits(e: Element<'_, '_>) -> bool {
    let Some(form) = FORMS.iter().find(|f| f.name == e.name()) else { return false };
    let known = |name: &str| form.many.iter().chain(form.once).any(|k| *k == name);
    form.required.iter().all(|name| e.value(name).is_some())
        && form.needed.iter().all(|name| e.first(name).is_some())
        && form.once.iter().all(|name| e.all(name).count() <= 1)
        && e.children().all(|child| known(child.name()) && fits(child))
}

fn element(e: Element<'_, '_>, diagnostics: &mut Diagnostics) {
    let Some(form) = FORMS.iter().find(|f| f.name == e.name()) else { return };
    let mut report = |misfit: Misfit, at| diagnostics.report(BadForm { misfit, at });
    let owner = form.name;
    for attribute in e.node.attributes() {
        let known = || form.required.iter().chain(form.optional).copied();
        if !known().any(|name| name == attribute.name()) {
            let name = attribute.name().to_string();
            let near = similar(&name, known());
            report(Misfit::Attribute { name, owner, near }, e.span(attribute.range_qname()));
        }
    }
    for name in form.required.iter().filter(|name| e.value(name).is_none()) {
        report(Misfit::NoAttribute { name, owner }, e.tag());
    }
    for name in form.needed.iter().filter(|name| e.first(name).is_none()) {
        report(Misfit::NoElement { name, owner }, e.tag());
    }
    for text in e.node.children().filter(|n| n.is_text() && !n.text().unwrap_or_default().trim().is_empty()) {
        let all = e.node.document().input_text().get(text.range()).unwrap_or_default();
        let start = text.range().start + (all.len() - all.trim_start().len());
        let end = text.range().start + all.trim_end().len();
        report(Misfit::Text { owner }, e.span(start..end.max(start)));
    }
    let mut seen: Vec<&str> = Vec::new();
    for child in e.children() {
        let name = child.name();
        let known = || form.many.iter().chain(form.once).copied();
        if !known().any(|k| k == name) {
            let near = similar(name, known());
            let elsewhere = FORMS.iter().any(|f| f.name == name);
            report(Misfit::Element { name: name.to_string(), owner, near, elsewhere }, child.tag());
        } else if form.once.contains(&name) && seen.contains(&name) {
            report(Misfit::Twice { name: name.to_string(), owner }, child.tag());
        }
        seen.push(name);
    }
    for child in e.children().filter(|c| form.many.iter().chain(form.once).any(|k| *k == c.name())) {
        element(child, diagnostics);
    }
}
