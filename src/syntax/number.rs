//! The numbers of a program that can be set from outside: each `const`, and each `param` of an entity. The command line
//! replaces their values in the tree, the page of a play session their literals in the text.

use std::sync::Arc;

use crate::source::Span;

use super::ast::{Constant, Expr, ExprKind, File, Item, Member};

/// A number that can be set.
#[derive(Debug, Clone, PartialEq)]
pub struct Number {
    /// The entity; none of a `const`.
    pub entity: Option<String>,
    /// Its name.
    pub name: String,
    /// Its value in the unit in which it is written; none if it is not a literal.
    pub literal: Option<f64>,
    /// The place of its value.
    pub span: Span,
}

impl Number {
    fn of(entity: Option<&str>, constant: &Constant) -> Number {
        Number {
            entity: entity.map(str::to_string),
            name: constant.name.text.to_string(),
            literal: literal(&constant.value),
            span: constant.value.span,
        }
    }

    /// `Hero.speed` of a parameter, `gravity` of a constant.
    pub fn path(&self) -> String {
        match &self.entity {
            Some(entity) => format!("{entity}.{}", self.name),
            None => self.name.clone(),
        }
    }
}

/// The numbers of a file, in the order of its text.
pub fn numbers(file: &File) -> Vec<Number> {
    let mut all = Vec::new();
    for item in &file.items {
        match item {
            Item::Constant(constant) => all.push(Number::of(None, constant)),
            Item::Entity(entity) => {
                for member in &entity.members {
                    if let Member::Parameter(parameter) = member {
                        all.push(Number::of(Some(&entity.name.text), parameter));
                    }
                }
            }
            Item::Import(_) | Item::Behavior(_) | Item::World(_) => {}
        }
    }
    all
}

/// Replaces the value of each number of a file with this [path](Number::path). Returns whether there is one.
pub(crate) fn set_number(file: &mut File, path: &str, value: &Expr) -> bool {
    let mut is_found = false;
    let (entity, name) = path.split_once('.').map_or((None, path), |(entity, name)| (Some(entity), name));
    let mut set = |constant: &mut Constant| {
        if &*constant.name.text == name {
            constant.value = value.clone();
            is_found = true;
        }
    };
    for item in &mut file.items {
        match (item, entity) {
            (Item::Constant(constant), None) => set(Arc::make_mut(constant)),
            (Item::Entity(of), Some(entity)) if &*of.name.text == entity => {
                for member in &mut Arc::make_mut(of).members {
                    if let Member::Parameter(parameter) = member {
                        set(parameter);
                    }
                }
            }
            _ => {}
        }
    }
    is_found
}

/// The unit that is written after a number, with the space before it.
pub fn unit_of(literal: &str) -> &str {
    literal.trim_start_matches(|c: char| c == '-' || c == '.' || c.is_ascii_digit())
}

/// The value of a literal in the unit in which it is written.
fn literal(expression: &Expr) -> Option<f64> {
    match &expression.kind {
        ExprKind::Number(value, _) => Some(*value),
        // `- 5` has a space that a new text would not have.
        ExprKind::Negate(inner) => match inner.kind {
            ExprKind::Number(..) if inner.span.start() == expression.span.start() + 1 => literal(inner).map(|n| -n),
            _ => None,
        },
        _ => None,
    }
}
