//! The tree of modes: the names of each in the file and here, and the resolution of references.

use super::names::Names;
use super::read::{Element, Value};
use crate::diagnostic::catalogue::import::{BadForm, Misfit, NotCarriedOver};
use crate::diagnostic::{Diagnostics, similar};

/// A mode.
pub(super) struct Mode<'a, 't> {
    pub element: Element<'a, 't>,
    /// The names of groups and modes from the root to it, in the file.
    there: Vec<&'a str>,
    /// Its path here.
    here: Vec<String>,
    /// The mode around it.
    pub parent: Option<usize>,
    /// The root group it is in.
    pub root: usize,
    /// The group of its inner modes, and these modes.
    pub inner: Option<(Element<'a, 't>, Vec<usize>)>,
}

impl Mode<'_, '_> {
    /// Its name here.
    pub fn name(&self) -> &str {
        self.here.last().map_or("", String::as_str)
    }
}

/// A root group.
pub(super) struct Root<'a, 't> {
    pub element: Element<'a, 't>,
    /// Its name here; none if its modes are directly in the entity.
    pub name: Option<String>,
    pub modes: Vec<usize>,
}

/// All modes of an entity.
pub(super) struct Modes<'a, 't> {
    pub roots: Vec<Root<'a, 't>>,
    pub all: Vec<Mode<'a, 't>>,
}

impl<'a, 't> Modes<'a, 't> {
    /// The modes of an automaton.
    pub fn of(automaton: Element<'a, 't>, diagnostics: &mut Diagnostics) -> Self {
        let mut modes = Modes { roots: Vec::new(), all: Vec::new() };
        let groups: Vec<Element<'a, 't>> = automaton.all("group").collect();
        let owner = automaton.value("name").map_or("", |v| v.text);
        let mut names = Names::default();
        for (root, element) in groups.iter().copied().enumerate() {
            let named = element.value("name");
            let alone = groups.len() == 1 && named.is_none_or(|v| v.text == owner);
            let name = (!alone).then(|| {
                let (text, at) = named.map_or(("modes", element.tag()), |v| (v.text, v.at));
                names.give("group", text, at, diagnostics)
            });
            let group = named.map_or("", |v| v.text);
            let here: Vec<String> = name.iter().cloned().collect();
            let inside = modes.group(element, (&[group], &here), None, root, diagnostics);
            modes.roots.push(Root { element, name, modes: inside });
        }
        modes.name_apart(owner, &mut names, diagnostics);
        modes
    }

    /// Keeps the only group if without it a mode's path would also match a deeper mode.
    fn name_apart(&mut self, owner: &str, names: &mut Names, diagnostics: &mut Diagnostics) {
        let [root] = self.roots.as_mut_slice() else { return };
        let fits_many = |mode: &Mode<'_, '_>| self.all.iter().filter(|m| m.here.ends_with(&mode.here)).count() > 1;
        if root.name.is_some() || !self.all.iter().any(fits_many) {
            return;
        }
        let (text, at) = root.element.value("name").map_or((owner, root.element.tag()), |v| (v.text, v.at));
        let name = names.give("group", text, at, diagnostics);
        self.all.iter_mut().for_each(|mode| mode.here.insert(0, name.clone()));
        root.name = Some(name);
    }

    /// Adds the modes of a group. The nesting of elements bounds the recursion.
    fn group(
        &mut self,
        group: Element<'a, 't>,
        (there, here): (&[&'a str], &[String]),
        parent: Option<usize>,
        root: usize,
        diagnostics: &mut Diagnostics,
    ) -> Vec<usize> {
        let mut inside = Vec::new();
        let mut names = Names::default();
        let mut known = std::collections::BTreeSet::new();
        for element in group.all("mode") {
            let Some(Value { text, at }) = element.value("name") else { continue };
            if !known.insert(text) {
                let misfit = Misfit::Declared { kind: "mode", name: text.to_string() };
                diagnostics.report(BadForm { misfit, at });
                continue;
            }
            let name = names.give("mode", text, at, diagnostics);
            let there = [there, &[text]].concat();
            let here = [here, &[name]].concat();
            let id = self.all.len();
            inside.push(id);
            self.all.push(Mode { element, there: there.clone(), here: here.clone(), parent, root, inner: None });
            let mut groups = element.all("group");
            if let Some(first) = groups.next() {
                let there = [&there[..], &[first.value("name").map_or("", |v| v.text)]].concat();
                let inner = self.group(first, (&there, &here), Some(id), root, diagnostics);
                if let Some(mode) = self.all.get_mut(id) {
                    mode.inner = Some((first, inner));
                }
            }
            for other in groups {
                diagnostics.report(NotCarriedOver {
                    what: "a second group in a mode".into(),
                    why: "modes in a mode exclude each other".into(),
                    at: other.tag(),
                    help: "make it a group of the entity: its modes ask `in` for the mode around them".into(),
                });
            }
        }
        inside
    }

    /// The mode of a reference: of several, one in the group of the referring mode, then one inside that mode, then one
    /// in its root group.
    pub fn find(&self, reference: Value<'_>, from: Option<usize>, diagnostics: &mut Diagnostics) -> Option<usize> {
        let words: Vec<&str> = reference.text.split('.').collect();
        let fits = |mode: &Mode<'_, '_>| {
            if mode.there.last() != words.last() {
                return false;
            }
            let alone: Vec<&str> = mode.there.iter().skip(1).step_by(2).copied().collect();
            mode.there.ends_with(&words) || alone.ends_with(&words)
        };
        let found: Vec<usize> = (0..self.all.len()).filter(|&id| self.all.get(id).is_some_and(fits)).collect();
        if let [only] = found.as_slice() {
            return Some(*only);
        }
        let near = |wanted: &dyn Fn(&Mode<'_, '_>) -> bool| {
            let mut near = found.iter().copied().filter(|&id| self.all.get(id).is_some_and(wanted));
            near.next().filter(|_| near.next().is_none())
        };
        let asking = from.and_then(|id| self.all.get(id));
        let nearest = near(&|m| m.there == words)
            .or_else(|| asking.and_then(|a| near(&|m| m.parent == a.parent && m.root == a.root)))
            .or_else(|| near(&|m| m.parent.is_some() && m.parent == from))
            .or_else(|| asking.and_then(|a| near(&|m| m.root == a.root)));
        if nearest.is_none() {
            let misfit = if found.is_empty() {
                let names = self.all.iter().filter_map(|m| m.there.last().copied());
                let near = similar(words.last().copied().unwrap_or_default(), names);
                Misfit::Unknown { kind: "mode", name: reference.text.to_string(), near }
            } else {
                let paths = found.iter().filter_map(|&id| self.all.get(id)).map(|m| m.there.join("."));
                Misfit::Ambiguous { name: reference.text.to_string(), paths: paths.take(8).collect() }
            };
            diagnostics.report(BadForm { misfit, at: reference.at });
        }
        nearest
    }

    /// The shortest unambiguous reference to a mode.
    pub fn reference(&self, target: usize) -> String {
        let Some(mode) = self.all.get(target) else { return String::new() };
        let mut ends = (0..mode.here.len()).rev().map(|from| &mode.here[from..]);
        let only = ends.find(|end| self.all.iter().filter(|m| m.here.ends_with(end)).count() == 1);
        only.unwrap_or(&mode.here).join(".")
    }
}
