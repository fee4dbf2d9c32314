//! Verifies every id, range and offset of a program, so that consumers can index without checks: the output of `lower`
//! is valid by construction, but a file may contain anything. Each struct is destructured without `..`, so that a new
//! field does not compile until it is checked.

mod code;
mod entity;
mod world;

use std::fmt;

use super::{EntityLook, Id, IdRange, IdVec, Look, Looks, MAX_TAGS, MapLook, Program, TagLook, TagSet, TilePicture};
use code::Code;

/// An error in a program, with its location.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Invalid {
    /// The entry: `entities[2].edges[5].guard`.
    pub at: String,
    /// What is wrong with it.
    pub why: String,
}

impl fmt::Display for Invalid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.at, self.why)
    }
}

impl std::error::Error for Invalid {}

impl Invalid {
    fn new(why: impl Into<String>) -> Self {
        Invalid { at: String::new(), why: why.into() }
    }

    /// Prefixes the location.
    fn within(mut self, around: &str) -> Self {
        let joint = if self.at.is_empty() || self.at.starts_with('[') { "" } else { "." };
        self.at = format!("{around}{joint}{}", self.at);
        self
    }
}

type Checked = Result<(), Invalid>;

/// Checks whether a program can be run.
///
/// [`Invalid`]: the first error found.
pub fn verify(program: &Program) -> Checked {
    let Program { tags, exprs, entities, worlds, looks, spans } = program;
    ensure(tags.len() <= MAX_TAGS, "there are more tags than fit a set").at("tags")?;
    same(spans.tags.len(), tags.len()).at("spans.tags")?;
    same(spans.exprs.len(), exprs.len()).at("spans.exprs")?;
    same(spans.entities.len(), entities.len()).at("spans.entities")?;
    same(spans.worlds.len(), worlds.len()).at("spans.worlds")?;
    let code = Code::new(program)?;
    each("entities", entities, |id, entity| entity::verify(program, &code, id, entity))?;
    code::check_code_ranges(program)?;
    each("worlds", worlds, |id, world| world::verify(program, &code, id, world))?;
    verify_looks(program, looks).at("looks")
}

fn verify_looks(program: &Program, Looks { entities, tags, maps }: &Looks) -> Checked {
    each_of("maps", maps, |map| map_look(program, map))?;
    each_of("entities", entities, |EntityLook { entity, look: of }| {
        exists(*entity, &program.entities)?;
        look(of)
    })?;
    each_of("tags", tags, |TagLook { world, tag, look: of }| {
        exists(*world, &program.worlds)?;
        exists(*tag, &program.tags)?;
        look(of)
    })
}

fn look(look: &Look) -> Checked {
    match look {
        Look::Color(_) => ensure(look.rgb().is_some(), "a colour is not `#` and six hexadecimal digits"),
        Look::Picture(path) => picture(path),
    }
}

fn picture(path: &str) -> Checked {
    ensure(!path.is_empty() && !path.starts_with('/'), "a picture has no relative path")
}

fn map_look(program: &Program, MapLook { world, space, pictures, tiles, stacks, cells }: &MapLook) -> Checked {
    exists(*world, &program.worlds)?;
    exists(*space, &program.worlds[*world].spaces)?;
    let map = program.worlds[*world].spaces[*space].map.as_ref();
    same(cells.len(), map.map_or(0, |map| map.cells.len())).at("cells")?;
    each_of("pictures", pictures, |path| picture(path))?;
    let is_tile = |tile: &TilePicture| usize::from(tile.picture) < pictures.len() && tile.mirrored < 8;
    ensure(tiles.iter().all(is_tile), "a tile has no picture, or is mirrored in no way")?;
    let is_of = |count: usize| move |index: &u16| usize::from(*index) < count;
    ensure(stacks.iter().flatten().all(is_of(tiles.len())), "a stack has a tile that there is not")?;
    ensure(cells.iter().all(is_of(stacks.len())), "a cell shows a stack that there is not")
}

/// Adds the location to a failed check.
trait At {
    /// Adds the location.
    fn at(self, place: &str) -> Checked;
}

impl At for Checked {
    fn at(self, place: &str) -> Checked {
        self.map_err(|invalid| invalid.within(place))
    }
}

fn ensure(holds: bool, why: &str) -> Checked {
    if holds { Ok(()) } else { Err(Invalid::new(why)) }
}

fn same(count: usize, wanted: usize) -> Checked {
    if count == wanted { Ok(()) } else { Err(Invalid::new(format!("{count} entries where there must be {wanted}"))) }
}

/// Checks that a table has an id.
fn exists<I: Id + fmt::Debug, T>(id: I, table: &IdVec<I, T>) -> Checked {
    exists_among(id, table.len())
}

fn exists_among<I: Id + fmt::Debug>(id: I, count: usize) -> Checked {
    if id.index() < count { Ok(()) } else { Err(Invalid::new(format!("there is no {id:?}, only {count}"))) }
}

fn all_exist<'i, I: Id + fmt::Debug + 'i, T>(ids: impl IntoIterator<Item = &'i I>, table: &IdVec<I, T>) -> Checked {
    ids.into_iter().enumerate().try_for_each(|(at, id)| exists(*id, table).at(&format!("[{at}]")))
}

/// Checks that a range is not empty and in a table.
fn range<I: Id + Ord + fmt::Debug, T>(range: IdRange<I>, table: &IdVec<I, T>) -> Checked {
    ensure(!range.is_empty(), "the range is empty")?;
    ensure(range.to.index() <= table.len(), "the range goes beyond the table")
}

fn each<I: Id, T>(name: &str, table: &IdVec<I, T>, check: impl FnMut(I, &T) -> Checked) -> Checked {
    each_pair(name, table.pairs(), check)
}

fn each_pair<'p, I: Id, T: 'p>(
    name: &str,
    mut pairs: impl Iterator<Item = (I, &'p T)>,
    mut check: impl FnMut(I, &'p T) -> Checked,
) -> Checked {
    pairs.try_for_each(|(id, entry)| check(id, entry).at(&format!("{name}[{}]", id.index())))
}

fn each_of<T>(name: &str, list: &[T], mut check: impl FnMut(&T) -> Checked) -> Checked {
    list.iter().enumerate().try_for_each(|(at, entry)| check(entry).at(&format!("{name}[{at}]")))
}

/// Checks that a set holds only tags of the program; the set of all tags stands for any.
fn tags(set: TagSet, program: &Program) -> Checked {
    let known = program.tags.ids().collect::<TagSet>();
    ensure(set == TagSet::ALL || set.0 & !known.0 == 0, "a tag of the set is not among the program's")
}

fn finite(numbers: &[f64]) -> Checked {
    ensure(numbers.iter().all(|number| number.is_finite()), "a number is not finite")
}
