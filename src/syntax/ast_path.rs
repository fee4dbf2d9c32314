//! Names in the syntax tree. Most of a large text consists of names, so a single name takes no extra memory: its span
//! follows from the whole.

use std::ops::Deref;

use crate::source::Span;

use super::ast::{Expr, ExprKind, Name, Word};

/// A variable with its number of primes: `x`, `x'`, `x''`.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// The variable.
    pub text: Word,
    /// Number of primes after it.
    pub primes: u32,
    /// With the primes.
    pub span: Span,
}

impl Variable {
    /// The variable without its primes.
    pub fn name(&self) -> Name {
        let mut span = self.span;
        // In a level editor, primes may be escaped; then only the whole span is known.
        if span.range().len() == self.text.len() + self.primes as usize {
            span = span.ending(span.end() - self.primes);
        }
        Name { text: self.text.clone(), span }
    }

    /// As a path of one name.
    pub fn path(&self) -> PathRef<'static> {
        PathRef { segments: Segments::One([self.name()]), primes: self.primes, span: self.span }
    }
}

/// A name with dots, primes, or spans that differ from the whole because of `use`.
#[derive(Debug, Clone, PartialEq)]
pub struct Dotted {
    /// The names between the dots.
    pub segments: Box<[Name]>,
    /// Primes after the last.
    pub primes: u32,
    /// The whole.
    pub span: Span,
}

/// Whether a name with a dot is a coordinate of where an instance was placed: `start.x`, `start.y`.
pub fn is_start(first: &Name, second: &Name) -> bool {
    *first.text == *"start" && matches!(&*second.text, "x" | "y")
}

/// A name that may be dotted: `size.small`, `hero.x'`.
#[derive(Debug, Clone, PartialEq)]
pub enum Path {
    /// One name, its primes, and where both are.
    Name(Word, u8, Span),
    /// Any other.
    Dotted(Box<Dotted>),
}

impl Path {
    /// A path in its smallest form.
    pub fn new(segments: Vec<Name>, primes: u32, span: Span) -> Self {
        if let ([name], Ok(few)) = (segments.as_slice(), u8::try_from(primes))
            && without(span, few) == name.span
        {
            return Path::Name(name.text.clone(), few, span);
        }
        Path::Dotted(Dotted { segments: segments.into(), primes, span }.into())
    }

    /// The whole.
    pub fn span(&self) -> Span {
        match self {
            Path::Name(_, _, span) => *span,
            Path::Dotted(dotted) => dotted.span,
        }
    }

    /// A view of the path.
    pub fn view(&self) -> PathRef<'_> {
        match self {
            Path::Name(text, primes, span) => PathRef::single(text, *primes, *span),
            Path::Dotted(dotted) => PathRef::dotted(dotted),
        }
    }
}

impl From<Path> for ExprKind {
    fn from(path: Path) -> Self {
        match path {
            Path::Name(text, primes, _) => ExprKind::Name(text, primes),
            Path::Dotted(dotted) => ExprKind::Path(dotted),
        }
    }
}

impl Expr {
    /// The path, if it is one.
    pub fn path(&self) -> Option<PathRef<'_>> {
        match &self.kind {
            ExprKind::Name(text, primes) => Some(PathRef::single(text, *primes, self.span)),
            ExprKind::Path(dotted) => Some(PathRef::dotted(dotted)),
            _ => None,
        }
    }

    /// The name, if it is one without dots and primes.
    pub fn name(&self) -> Option<Name> {
        self.path()?.name()
    }
}

/// A uniform view of a path.
#[derive(Debug)]
pub struct PathRef<'a> {
    /// The names between the dots.
    pub segments: Segments<'a>,
    /// Primes after the last.
    pub primes: u32,
    /// The whole.
    pub span: Span,
}

impl<'a> PathRef<'a> {
    fn single(text: &Word, primes: u8, span: Span) -> Self {
        let name = Name { text: text.clone(), span: without(span, primes) };
        PathRef { segments: Segments::One([name]), primes: primes.into(), span }
    }

    fn dotted(dotted: &'a Dotted) -> Self {
        PathRef { segments: Segments::Many(&dotted.segments), primes: dotted.primes, span: dotted.span }
    }

    /// Its only name, if it has no dots and no primes.
    pub fn name(&self) -> Option<Name> {
        match &*self.segments {
            [name] if self.primes == 0 => Some(name.clone()),
            _ => None,
        }
    }
}

/// The names of a path.
#[derive(Debug)]
pub enum Segments<'a> {
    /// One name, created for the view.
    One([Name; 1]),
    /// The names in the tree.
    Many(&'a [Name]),
}

impl Deref for Segments<'_> {
    type Target = [Name];
    fn deref(&self) -> &[Name] {
        match self {
            Segments::One(name) => name,
            Segments::Many(names) => names,
        }
    }
}

/// The span of a name without the primes at its end.
fn without(span: Span, primes: u8) -> Span {
    span.ending(span.end().saturating_sub(primes.into()))
}
