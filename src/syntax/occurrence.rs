//! Occurrences of names and their meanings, for editors. The stages that resolve names record each declaration and each
//! use, also in programs with errors, so nothing is resolved twice.

use crate::source::{SourceMap, Span};

/// The kind of a named thing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum NameKind {
    /// `const`
    Constant,
    /// `entity`
    Entity,
    /// `behavior`
    Behavior,
    /// A parameter of a `behavior`.
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
    /// `condition`
    Condition,
    /// `signal`
    Signal,
    /// The number of a signal.
    SignalNumber,
    /// `ref`
    Reference,
    /// An instance bound by `as`.
    Touched,
    /// `button`
    Button,
    /// `axis`
    Axis,
    /// `chance`
    Chance,
    /// A tag of colliders and tiles; declared wherever something carries it.
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

/// The role of an occurrence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Role {
    /// It is declared.
    Declared,
    /// Its value is set, or it is driven.
    Written,
    /// Anything else.
    Read,
}

/// An occurrence of a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Occurrence {
    /// The place.
    pub at: Span,
    /// The kind of the named thing.
    pub kind: NameKind,
    /// The span of the name in its declaration. `x` and `y` are declared by the name of their entity; a tag is its own
    /// declaration.
    pub declared: Span,
    /// Its role.
    pub role: Role,
}

/// All occurrences of a program, if they are requested.
#[derive(Debug, Clone, Default)]
pub struct Occurrences {
    /// `None` if not requested: a large text has many names.
    list: Option<Vec<Occurrence>>,
}

impl Occurrences {
    /// Records occurrences; the default does not.
    pub fn kept() -> Self {
        Occurrences { list: Some(Vec::new()) }
    }

    /// Whether occurrences are recorded.
    pub fn are_kept(&self) -> bool {
        self.list.is_some()
    }

    fn note(&mut self, occurrence: Occurrence) {
        if let Some(list) = &mut self.list {
            list.push(occurrence);
        }
    }

    /// Records a declaration.
    pub fn declare(&mut self, kind: NameKind, at: Span) {
        self.note(Occurrence { at, kind, declared: at, role: Role::Declared });
    }

    /// Records a use.
    pub fn read(&mut self, kind: NameKind, at: Span, declared: Span) {
        self.note(Occurrence { at, kind, declared, role: Role::Read });
    }

    /// Records an assignment.
    pub fn write(&mut self, kind: NameKind, at: Span, declared: Span) {
        self.note(Occurrence { at, kind, declared, role: Role::Written });
    }

    /// Sorted by span, without duplicates. Occurrences in copies made by `use` are mapped to the original text.
    pub fn sorted(self, sources: &SourceMap) -> Vec<Occurrence> {
        let traced =
            |o: Occurrence| Occurrence { at: sources.trace(o.at).0, declared: sources.trace(o.declared).0, ..o };
        let mut list: Vec<Occurrence> = self.list.into_iter().flatten().map(traced).collect();
        // Each item has its own in order already: a sort that merges them.
        list.sort();
        list.dedup();
        list
    }
}
