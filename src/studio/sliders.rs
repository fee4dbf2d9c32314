//! The numbers of a program that can be changed while it runs: a `param` or a `const` whose value is a literal. A change
//! replaces that literal in the text, and nothing else.

use std::path::{Path, PathBuf};

use crate::ordered::Ordered;
use crate::source::{FileId, Files, SourceMap};
use crate::syntax::{self, Number, Unshared};
use crate::why::place;

use super::protocol::Slider;

/// The numbers of a program, in the order of its text. `written` are its files without numbers that were set.
pub(super) fn sliders(root: &Path, files: &dyn Files, written: &dyn Files) -> Vec<Slider> {
    let (now, before) = (Numbers::read(root, files), Numbers::read(root, written));
    let slider = |(number, value): &(Number, f64)| {
        let same = |(other, _): &&(Number, f64)| other.entity == number.entity && other.name == number.name;
        Slider {
            entity: number.entity.clone(),
            name: number.name.clone(),
            value: *value,
            written: before.all.iter().find(same).map_or(*value, |(_, value)| *value),
            unit: now.unit(number),
            place: place(&now.sources, number.span),
        }
    };
    now.all.iter().map(slider).collect()
}

/// The file and the text after a number is set, and whether there is such a number.
pub(super) fn set(root: &Path, files: &dyn Files, slider: usize, value: f64) -> Option<(PathBuf, String)> {
    let numbers = Numbers::read(root, files);
    let (number, _) = numbers.all.get(slider)?;
    numbers.set(number, value)
}

/// As [`set`], by the path of the number.
pub(super) fn set_named(root: &Path, files: &dyn Files, path: &str, value: f64) -> Option<(PathBuf, String)> {
    let numbers = Numbers::read(root, files);
    let (number, _) = numbers.all.iter().find(|(number, _)| number.path() == path)?;
    numbers.set(number, value)
}

/// All numbers of a program that are written as literals, with their values.
struct Numbers {
    sources: SourceMap,
    all: Vec<(Number, f64)>,
}

impl Numbers {
    fn read(root: &Path, files: &dyn Files) -> Numbers {
        let mut sources = SourceMap::new();
        let (trees, _) = syntax::load(root, (files, &Unshared), &mut sources);
        let literals = trees.iter().flat_map(syntax::numbers).filter_map(|number| {
            let value = number.literal?;
            Some((number, value))
        });
        let mut all: Vec<(Number, f64)> = literals.collect();
        let order: Vec<FileId> = trees.iter().map(|tree| tree.id).collect();
        all.order_by_key(|(number, _)| (order.iter().position(|id| *id == number.span.file()), number.span.start()));
        Numbers { sources, all }
    }

    /// The file and the text after a number is set.
    fn set(&self, number: &Number, value: f64) -> Option<(PathBuf, String)> {
        let file = self.sources.file(number.span.file());
        let mut text = file.text().to_string();
        let range = number.span.range();
        let unit = self.unit(number);
        text.get(range.clone()).filter(|_| value.is_finite())?;
        text.replace_range(range, &format!("{value}{unit}"));
        Some((file.path.clone(), text))
    }

    /// The unit that is written after a number, with the space before it.
    fn unit(&self, number: &Number) -> String {
        syntax::unit_of(self.sources.slice(number.span)).to_string()
    }
}
