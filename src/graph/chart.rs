//! The statechart graph, and its construction from a program.

use super::excerpt;
use crate::ir::{self, Actions, Choice, EntityId, EntitySpans, Id, ModeId, Place, Program, RefValue};
use crate::source::{SourceMap, code_on_one_line};

/// The statechart of an entity.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Chart {
    /// The entity's name.
    pub entity: String,
    /// Concurrent groups; none for an entity without modes.
    pub regions: Vec<Region>,
    /// All modes, each after the modes around it.
    pub modes: Vec<Mode>,
    /// Edges with a target, in source order.
    pub edges: Vec<Edge>,
}

/// A group.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Region {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Its outermost modes, as indices in [`Chart::modes`].
    pub modes: Vec<usize>,
    /// Their initial mode.
    pub initial: Initial,
}

/// The initial one of sibling modes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Initial {
    /// Modes that are initial if their guard holds.
    pub choices: Vec<(String, usize)>,
    /// The initial mode otherwise.
    pub mode: usize,
}

/// A mode.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mode {
    /// Its own name.
    pub name: String,
    /// Its full path.
    pub path: String,
    /// The mode around it.
    pub parent: Option<usize>,
    /// Modes directly inside.
    pub children: Vec<usize>,
    /// Their initial mode; none of a leaf mode.
    pub initial: Option<Initial>,
    /// Whether something reads the time since its entry.
    pub timed: bool,
    /// Its entry actions.
    pub entry: Vec<String>,
    /// Edges without a target, and `follow links`.
    pub internal: Vec<Action>,
}

/// An internal action of a mode.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Action {
    /// Its index among the edges of the entity; none of `follow links`.
    pub edge: Option<usize>,
    /// Its guard.
    pub guard: String,
    /// Its updates.
    pub updates: Vec<String>,
}

/// An edge with a target.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Edge {
    /// Its index among the edges of the entity.
    pub id: usize,
    /// The mode that holds it.
    pub source: usize,
    /// Its target mode.
    pub target: usize,
    /// Its priority among the edges that are tried while its mode is active, from 1: the first whose guard holds is
    /// taken.
    pub order: usize,
    /// Its guard.
    pub guard: String,
    /// Its updates.
    pub updates: Vec<String>,
}

/// Builds the statechart of an entity of a program.
pub fn chart(program: &Program, sources: &SourceMap, id: EntityId) -> Chart {
    let reader = Reader { program, sources, entity: &program.entities[id], spans: &program.spans.entities[id] };
    let entity = reader.entity;
    let outermost = |group: &ir::Group| {
        let (from, to) = (group.modes.from.0, group.modes.to.0);
        (from..to).map(ModeId).filter(|m| entity.modes[*m].parent.is_none()).map(|m| m.0 as usize).collect::<Vec<_>>()
    };
    let regions = entity.groups.iter().map(|group| Region {
        name: group.name.clone(),
        modes: outermost(group),
        initial: reader.initial(&group.choices, group.first),
    });
    let edges = entity.edges.pairs().filter_map(|(id, edge)| {
        let (guard, updates) = excerpt::edge(reader.sources.slice(reader.spans.edges[id]));
        // The modes around an edge's mode are active with it, so its priority is the same in all leaf modes.
        let leaf = &entity.leaves[entity.modes[edge.source].leaves.from];
        let order = leaf.edges.iter().position(|e| *e == id).map_or(0, |at| at + 1);
        Some(Edge {
            id: id.0 as usize,
            source: edge.source.0 as usize,
            target: edge.target?.0 as usize,
            order,
            guard,
            updates,
        })
    });
    Chart {
        entity: entity.name.to_string(),
        regions: regions.filter(|r| !r.modes.is_empty()).collect(),
        modes: entity.modes.ids().map(|mode| reader.mode(mode)).collect(),
        edges: edges.collect(),
    }
}

struct Reader<'a> {
    program: &'a Program,
    sources: &'a SourceMap,
    entity: &'a ir::Entity,
    spans: &'a EntitySpans,
}

impl Reader<'_> {
    fn mode(&self, id: ModeId) -> Mode {
        let (entity, mode) = (self.entity, &self.entity.modes[id]);
        let children = entity.modes.pairs().filter(|(_, m)| m.parent == Some(id)).map(|(child, _)| child.0 as usize);
        let stays = entity.edges.pairs().filter(|(_, e)| e.source == id && e.target.is_none());
        let mut internal: Vec<Action> = stays
            .map(|(edge, _)| {
                let (guard, updates) = excerpt::edge(self.sources.slice(self.spans.edges[edge]));
                Action { edge: Some(edge.index()), guard, updates }
            })
            .collect();
        internal.extend(self.follows(id));
        Mode {
            name: mode.path.rsplit('.').next().unwrap_or(&mode.path).to_string(),
            path: mode.path.clone(),
            parent: mode.parent.map(|parent| parent.0 as usize),
            children: children.collect(),
            initial: mode.inner.map(|inner| self.initial(&mode.choices, inner)),
            timed: entity.timers.iter().any(|timer| timer.mode == id),
            entry: self.entry(&mode.entry),
            internal,
        }
    }

    fn initial(&self, choices: &[Choice], mode: ModeId) -> Initial {
        let choices = choices.iter().map(|choice| (self.expr(choice.guard), choice.mode.0 as usize));
        Initial { choices: choices.collect(), mode: mode.0 as usize }
    }

    /// The `follow links` of a mode: those that all of its leaf modes and no other leaf mode share.
    fn follows(&self, id: ModeId) -> Vec<Action> {
        let entity = self.entity;
        let owner = |follow| {
            let mut having =
                entity.leaves.pairs().filter(|(_, leaf)| leaf.follows.contains(&follow)).map(|(leaf, _)| leaf);
            let first = having.next()?;
            let after = having.next_back().unwrap_or(first).0 + 1;
            entity
                .modes
                .ids()
                .find(|mode| (entity.modes[*mode].leaves.from, entity.modes[*mode].leaves.to.0) == (first, after))
        };
        let own = entity.follows.ids().filter(|follow| owner(*follow) == Some(id));
        own.map(|follow| {
            let text = self.sources.slice(self.spans.follows[follow]);
            let (guard, updates) = excerpt::edge(text);
            Action { edge: None, guard, updates }
        })
        .collect()
    }

    fn entry(&self, actions: &Actions) -> Vec<String> {
        let entity = self.entity;
        let updates = actions.updates.iter().map(|update| {
            let place = match update.place {
                Place::Var(var, degree) => entity.variable_text(var, degree),
                Place::Discrete(discrete) => entity.discretes[discrete].name.clone(),
                Place::Ref(reference) => entity.refs[reference].name.clone(),
            };
            let value = self.expr(update.value);
            // The value of `x += 1` is the whole of it.
            let rest = value.strip_prefix(&place).map(str::trim_start);
            let is_whole = rest.is_some_and(|rest| rest.starts_with("+=") || rest.starts_with("-="));
            if is_whole { value } else { format!("{place} := {value}") }
        });
        let spawns = actions.spawns.iter().map(|&spawn| code_on_one_line(self.sources.slice(self.spans.spawns[spawn])));
        let destroys = actions.destroys.iter().map(|what| match what {
            RefValue::Of(ir::Subject::Ref(reference)) => format!("destroy {}", entity.refs[*reference].name),
            _ => "destroy self".to_string(),
        });
        updates.chain(spawns).chain(destroys).collect()
    }

    fn expr(&self, id: ir::ExprId) -> String {
        code_on_one_line(self.sources.slice(self.program.spans.exprs[id]))
    }
}
