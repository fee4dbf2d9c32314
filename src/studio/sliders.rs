//! The numbers of a program that can be changed while it runs: a `param` or a `const` whose value is a literal. A change
//! replaces that literal in the text, and nothing else.

use std::path::{Path, PathBuf};

use crate::source::{FileId, Files, SourceMap, Span};
use crate::syntax;
use crate::syntax::ast::{Constant, Expr, ExprKind, File, Item, Member};

use super::project::place;
use super::protocol::Slider;

/// A number of the text, with the bytes of its literal.
struct Literal {
    entity: Option<String>,
    name: String,
    value: f64,
    span: Span,
}

/// The numbers of a program, in the order of its text. `written` are its files without numbers that were set.
pub(super) fn sliders(root: &Path, files: &dyn Files, written: &dyn Files) -> Vec<Slider> {
    let (now, before) = (Numbers::read(root, files), Numbers::read(root, written));
    let slider = |literal: &Literal| {
        let same = |other: &&Literal| other.entity == literal.entity && other.name == literal.name;
        Slider {
            entity: literal.entity.clone(),
            name: literal.name.clone(),
            value: literal.value,
            written: before.all.iter().find(same).map_or(literal.value, |other| other.value),
            unit: now.unit(literal),
            place: place(&now.sources, literal.span),
        }
    };
    now.all.iter().map(slider).collect()
}

/// The file and the text after a number is set, and whether there is such a number.
pub(super) fn set(root: &Path, files: &dyn Files, slider: usize, value: f64) -> Option<(PathBuf, String)> {
    let numbers = Numbers::read(root, files);
    let literal = numbers.all.get(slider).filter(|_| value.is_finite())?;
    let file = numbers.sources.file(literal.span.file());
    let mut text = file.text().to_string();
    let range = literal.span.range();
    let unit = numbers.unit(literal);
    text.get(range.clone())?;
    text.replace_range(range, &format!("{value}{unit}"));
    Some((file.path.clone(), text))
}

/// All numbers of a program.
struct Numbers {
    sources: SourceMap,
    all: Vec<Literal>,
}

impl Numbers {
    fn read(root: &Path, files: &dyn Files) -> Numbers {
        let mut sources = SourceMap::new();
        let (trees, _) = syntax::load(root, files, &mut sources);
        let mut all: Vec<Literal> = trees.iter().flat_map(of_file).collect();
        let order: Vec<FileId> = trees.iter().map(|tree| tree.id).collect();
        all.sort_by_key(|literal| (order.iter().position(|id| *id == literal.span.file()), literal.span.start()));
        Numbers { sources, all }
    }

    /// The unit that is written after a number, with the space before it.
    fn unit(&self, literal: &Literal) -> String {
        let text = self.sources.slice(literal.span);
        text.trim_start_matches(|c: char| c == '-' || c == '.' || c.is_ascii_digit()).to_string()
    }
}

fn of_file(file: &File) -> Vec<Literal> {
    let mut all = Vec::new();
    for item in &file.items {
        match item {
            Item::Constant(constant) => all.extend(literal(None, constant)),
            Item::Entity(entity) => {
                for member in &entity.members {
                    if let Member::Parameter(parameter) = member {
                        all.extend(literal(Some(entity.name.text.to_string()), parameter));
                    }
                }
            }
            Item::Import(_) | Item::Behavior(_) | Item::World(_) => {}
        }
    }
    all
}

fn literal(entity: Option<String>, constant: &Constant) -> Option<Literal> {
    let value = number(&constant.value)?;
    Some(Literal { entity, name: constant.name.text.to_string(), value, span: constant.value.span })
}

/// The value of a literal in the unit in which it is written.
fn number(expression: &Expr) -> Option<f64> {
    match &expression.kind {
        ExprKind::Number(value, _) => Some(*value),
        // `- 5` has a space that the new text would not have.
        ExprKind::Negate(inner) => match inner.kind {
            ExprKind::Number(..) if inner.span.start() == expression.span.start() + 1 => number(inner).map(|n| -n),
            _ => None,
        },
        _ => None,
    }
}
