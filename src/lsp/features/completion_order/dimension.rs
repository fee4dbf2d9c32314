//! The dimension of what is written at a cursor, and of the names that can be: by the program, or by what they are
//! called.

use crate::lsp::features::completion_items::CompletionCollector;
use crate::lsp::features::hover::per_second;
use crate::lsp::text::cursor::{Block, CursorContext};
use crate::sema::checked::Entity;

/// Parts of names that tell a dimension.
const HINTS: &[(&str, &str)] = &[
    ("accel", "px/s^2"),
    ("gravity", "px/s^2"),
    ("drag", "px/s^2"),
    ("friction", "px/s^2"),
    ("speed", "px/s"),
    ("velocity", "px/s"),
    ("limit", "px/s"),
    ("time", "s"),
    ("delay", "s"),
    ("duration", "s"),
    ("cooldown", "s"),
    ("range", "px"),
    ("radius", "px"),
    ("width", "px"),
    ("height", "px"),
    ("distance", "px"),
    ("reach", "px"),
];

/// What tells dimensions at a cursor.
#[derive(Clone, Copy)]
pub(super) struct Dimensions<'a> {
    pub of: &'a CompletionCollector<'a>,
    pub cursor: &'a CursorContext<'a>,
    /// The entity around the cursor.
    pub own: Option<&'a Entity>,
}

impl Dimensions<'_> {
    /// The dimension of a name, by the program or by what it is called.
    pub(super) fn dimension(&self, name: &str) -> Option<String> {
        let own = self.own?;
        if own.discretes.iter().any(|d| d.name.text == name) {
            return Some("1".into());
        }
        if matches!(name, "x" | "y") {
            return Some("px".into());
        }
        self.of.checked().find_map(|checked| {
            let (id, entity) = checked.entities.pairs().find(|(_, e)| e.name.text == own.name.text)?;
            let param =
                entity.params.find(|p| p.name.text == name).and_then(|p| checked.dimensions.params.get(&(id, p)));
            let var = || entity.vars.find(|v| v.name.text == name).and_then(|v| checked.dimensions.vars.get(&(id, v)));
            param.or_else(var).cloned()
        })
    }

    /// The dimension of a variable with primes.
    fn of_variable(&self, name: &str, primes: usize) -> Option<String> {
        Some(per_second(&self.dimension(name)?, primes))
    }

    /// The dimension of what is written at the cursor: that of what it is assigned to, compared or added with.
    pub(super) fn wanted_dimension(&self) -> Option<String> {
        let words = &self.cursor.statement;
        let first = words.first().copied().unwrap_or_default();
        let end = words.len();
        // The name before an index, with its primes.
        let variable = |end: usize| {
            let primes = match words.get(end.checked_sub(1)?).copied()? {
                "'" => 1,
                "''" => 2,
                _ => 0,
            };
            let name = words.get(end.checked_sub(1 + usize::from(primes > 0))?).copied()?;
            if name == "timer" { Some("s".to_string()) } else { self.of_variable(name, primes) }
        };
        let mut last = end.checked_sub(1)?;
        // A sign does not matter.
        while words.get(last) == Some(&"-") && last > 0 && is_operator(words.get(last - 1).copied().unwrap_or_default())
        {
            last -= 1;
        }
        match words.get(last).copied()? {
            "=" | ":=" | "+=" | "-=" | "<" | "<=" | ">" | ">=" | "==" | "!=" => variable(last),
            "+" | "-" => variable(last).or_else(|| self.assigned_dimension()),
            "in" | ".." if first == "clamp" => variable(words.iter().position(|w| *w == "in")?),
            "accel" => self.enveloped(1),
            "sustain" | "to" => self.enveloped(0),
            "over" | "for" => Some("s".into()),
            // `near(self, prey, sight)`
            "," if self.cursor.calls.last().is_some_and(|call| call.name == "near" && call.argument > 1) => {
                Some("px".into())
            }
            "(" | ","
                if self.cursor.calls.last().is_some_and(|call| matches!(call.name, "min" | "max" | "clamp" | "if")) =>
            {
                self.assigned_dimension()
            }
            _ => None,
        }
    }

    /// The dimension of what the statement assigns.
    fn assigned_dimension(&self) -> Option<String> {
        let words = &self.cursor.statement;
        let operator = words.iter().position(|w| matches!(*w, "=" | ":="))?;
        let primes = match words.get(operator.checked_sub(1)?).copied()? {
            "'" => 1,
            "''" => 2,
            _ => 0,
        };
        self.of_variable(words.first()?, primes)
    }

    /// The dimension of what the envelope around drives, with more primes.
    fn enveloped(&self, more: usize) -> Option<String> {
        let block = self.cursor.blocks.iter().rev().find(|block| block.block == Block::Envelope)?;
        let head = self.of.code.get(block.start..)?.lines().next()?;
        let variable = head.strip_prefix("envelope")?.trim_start().trim_start_matches('(');
        let name: String = variable.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        let primes = variable.get(name.len()..)?.bytes().take_while(|b| *b == b'\'').count();
        self.of_variable(&name, primes + more)
    }
}

fn is_operator(word: &str) -> bool {
    matches!(
        word,
        "=" | ":="
            | "+="
            | "-="
            | "<"
            | "<="
            | ">"
            | ">="
            | "=="
            | "!="
            | "in"
            | ".."
            | "accel"
            | "sustain"
            | "to"
            | "("
            | ","
    )
}

/// The dimension that a name tells.
pub(super) fn hint(name: &str) -> Option<&'static str> {
    HINTS.iter().find(|(part, _)| name.contains(part)).map(|(_, dimension)| *dimension)
}
