//! Names in unused behaviours: a behaviour has a meaning only where it is used, so each unused one is put into a
//! separate entity, which is checked only for its names.

use crate::source::{SourceMap, Span};
use crate::syntax::ast::{Behavior, Entity, File, Initial, Item, Member, Mode, Name};
use crate::syntax::expand;
use crate::syntax::occurrence::{NameKind, Occurrence, Occurrences, Role};

use super::{Level, check};

/// Occurrences of names in behaviours that `known`, the sorted occurrences of the checked program, does not cover.
/// `files` are the program's trees. `x` and `y` are declared by the name of their behaviour.
pub fn names_of_unused(files: Vec<File>, sources: &mut SourceMap, known: &[Occurrence]) -> Vec<Occurrence> {
    let mut unused: Vec<(Span, Span)> = Vec::new();
    let mut trees: Vec<File> = Vec::new();
    for file in files {
        let mut items: Vec<Item> = Vec::new();
        for item in file.items.into_iter().filter(|item| !matches!(item, Item::World(_) | Item::Import(_))) {
            if let Item::Behavior(behavior) = &item
                && !is_resolved(behavior.span, known)
            {
                unused.push((behavior.span, behavior.name.span));
                items.push(Item::Entity(standalone_entity(behavior).into()));
            }
            items.push(item);
        }
        trees.push(File { items, texts: Vec::new(), ..file });
    }
    if unused.is_empty() {
        return Vec::new();
    }
    let mut noted = Occurrences::kept();
    let _ = expand(&mut trees, sources, &mut noted);
    let (checked, _) = check(trees, sources, Level::default(), noted);
    let noted = checked.occurrences;
    let is_news = |o: &Occurrence| {
        let inside = unused.iter().any(|(whole, name)| whole.contains(o.at) && o.at != *name);
        inside && known.binary_search_by(|known| known.at.cmp(&o.at)).is_err()
    };
    noted.sorted(sources).into_iter().filter(is_news).collect()
}

/// Whether some name in a behaviour is resolved; its parameters always are.
fn is_resolved(whole: Span, known: &[Occurrence]) -> bool {
    let from = known.partition_point(|o| (o.at.file(), o.at.start()) < (whole.file(), whole.start()));
    let inside = known.iter().skip(from).take_while(|o| whole.contains(o.at));
    inside.into_iter().any(|o| o.role != Role::Declared && o.kind != NameKind::Argument)
}

/// An entity with the members of a behaviour: inside a mode, if some of them require one.
fn standalone_entity(behavior: &Behavior) -> Entity {
    let mut members = behavior.members.clone();
    let has_groups = members.iter().any(|m| matches!(m, Member::Group(_)));
    let is_of_a_mode = |m: &Member| matches!(m, Member::Edge(_) | Member::Entry(_) | Member::Follow(_));
    if !has_groups && members.iter().any(is_of_a_mode) {
        let (inner, outer) = members.into_iter().partition(|m| {
            let is_inner = match m {
                Member::Mode(mode) => mode.initial != Initial::Always,
                other => matches!(other, Member::Flow(_) | Member::Envelope(_) | Member::Use(_)),
            };
            is_inner || is_of_a_mode(m)
        });
        members = outer;
        let name = Name { text: "behavior".into(), span: behavior.name.span };
        let (initial, doc, span) = (Initial::No, None, behavior.span);
        members.push(Member::Mode(Mode { initial, name, members: inner, doc, span }.into()));
    }
    // Not a valid entity name.
    let name = Name { text: format!("behavior {}", behavior.name.text).into(), span: behavior.name.span };
    Entity { name, members, reads_start: behavior.reads_start, doc: None, span: behavior.span }
}
