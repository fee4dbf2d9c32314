//! Where names occur and what they mean: what an editor asks for. The stages that resolve names note each declaration and
//! each use as they meet it, also in programs with errors; nothing is resolved twice.

use crate::source::{SourceMap, Span};

/// What a name names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum NameKind {
    /// `const`
    Constant,
    /// `entity`
    Entity,
    /// `behavior`
    Behavior,
    /// What is in the parentheses of a `behavior`.
    Argument,
    /// `world`
    World,
    /// `group`
    Group,
    /// `mode`
    Mode,
    /// `param`
    Parameter,
    /// `continuous`, and `x` and `y`
    Variable,
    /// `discrete`
    Discrete,
    /// One of a discrete variable's names.
    Value,
    /// `ref`
    Reference,
    /// What a guard touches, named by `as`.
    Touched,
    /// `button`
    Button,
    /// `axis`
    Axis,
    /// What colliders and tiles count as; declared wherever something carries it.
    Tag,
    /// `space`
    Space,
    /// `tiles`
    TileSet,
    /// `place`, or a named instance of a tile
    Instance,
    /// `goal`
    Goal,
    /// `never`
    Never,
}

/// What is done with a name where it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Role {
    /// It is declared.
    Declared,
    /// Its value is set, or it is driven.
    Written,
    /// Anything else.
    Read,
}

/// A name at a place.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Occurrence {
    /// The place.
    pub at: Span,
    /// What it names.
    pub kind: NameKind,
    /// The name in its declaration. `x` and `y` are declared by the name of their entity; a tag by itself, wherever it
    /// is.
    pub declared: Span,
    /// What is done with it.
    pub role: Role,
}

/// All names of a program, if anybody wants to know.
#[derive(Debug, Clone, Default)]
pub struct Occurrences {
    /// None if no caller does: a large text has many names.
    list: Option<Vec<Occurrence>>,
}

impl Occurrences {
    /// To be kept, unlike by default.
    pub fn kept() -> Self {
        Occurrences { list: Some(Vec::new()) }
    }

    /// Whether anybody wants to know.
    pub fn are_kept(&self) -> bool {
        self.list.is_some()
    }

    fn note(&mut self, occurrence: Occurrence) {
        if let Some(list) = &mut self.list {
            list.push(occurrence);
        }
    }

    /// Notes a declaration.
    pub fn declare(&mut self, kind: NameKind, at: Span) {
        self.note(Occurrence { at, kind, declared: at, role: Role::Declared });
    }

    /// Notes a use.
    pub fn read(&mut self, kind: NameKind, at: Span, declared: Span) {
        self.note(Occurrence { at, kind, declared, role: Role::Read });
    }

    /// Notes that a value is set.
    pub fn write(&mut self, kind: NameKind, at: Span, declared: Span) {
        self.note(Occurrence { at, kind, declared, role: Role::Written });
    }

    /// In order of their places, each once. What is in copies made by `use` is noted of the text itself.
    pub fn sorted(self, sources: &SourceMap) -> Vec<Occurrence> {
        let traced =
            |o: Occurrence| Occurrence { at: sources.trace(o.at).0, declared: sources.trace(o.declared).0, ..o };
        let mut list: Vec<Occurrence> = self.list.into_iter().flatten().map(traced).collect();
        list.sort_unstable();
        list.dedup();
        list
    }
}
