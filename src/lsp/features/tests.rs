//! What can be run in a text: worlds with their goals, `never`s and tests.

use std::ops::Range;

use crate::lsp::text::document_text::Text;
use crate::syntax;
use crate::syntax::ast::{Item, MapSource, SpaceItem, WorldItem};

/// A name that is declared in a text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct Named {
    pub name: String,
    /// From the name to the end of the declaration.
    pub whole: Range<usize>,
    /// The name.
    pub bytes: Range<usize>,
}

/// A world, and what can be asked about it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct RunnableWorld {
    pub world: Named,
    /// Whether a map is left open: it needs a level.
    pub is_open: bool,
    pub goals: Vec<Named>,
    pub nevers: Vec<Named>,
    pub tests: Vec<Named>,
}

/// The worlds of a text, in order.
pub(in crate::lsp) fn runnable_worlds(text: &Text) -> Vec<RunnableWorld> {
    let worlds =
        text.tree().items.iter().filter_map(|item| if let Item::World(world) = item { Some(world) } else { None });
    let runnable = |world: &syntax::ast::World| {
        let named = |name: &syntax::ast::Name, end: usize| Named {
            name: name.text.to_string(),
            whole: name.span.range().start..end.max(name.span.range().end),
            bytes: name.span.range(),
        };
        let mut found = RunnableWorld {
            world: named(&world.name, world.span.range().end),
            is_open: false,
            goals: Vec::new(),
            nevers: Vec::new(),
            tests: Vec::new(),
        };
        for item in &world.items {
            match item {
                WorldItem::Goal(goal) => found.goals.push(named(&goal.name, goal.predicate.span.range().end)),
                WorldItem::Never(never) => found.nevers.push(named(&never.name, never.predicate.span.range().end)),
                WorldItem::Test(test) => found.tests.push(named(&test.name, test.span.range().end)),
                WorldItem::Space(space) => {
                    let is_open =
                        |map: &syntax::ast::Map| matches!(map.source, MapSource::Open(_) | MapSource::OpenLegend(_));
                    let maps =
                        space.items.iter().filter_map(|i| if let SpaceItem::Map(map) = i { Some(map) } else { None });
                    found.is_open |= maps.into_iter().any(|map| is_open(map));
                }
                _ => {}
            }
        }
        found
    };
    worlds.map(|world| runnable(world)).collect()
}
