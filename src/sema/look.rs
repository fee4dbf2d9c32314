//! `look`: a colour or a picture. Only the form is checked here, and nothing that runs depends on it.

use std::path::{Component, Path, PathBuf};

use crate::diagnostic::catalogue::look::{BadLook, WhyNoLook};
use crate::ir::{EntityId, EntityLook, Id, Look, MapLook, SpaceId, WorldId};
use crate::level::TileArt;
use crate::source::{FileId, normalize};
use crate::syntax::ast::{self, Appearance, Name, WorldItem};

use super::Checker;
use super::names::Table;

impl Checker<'_> {
    /// Checks the look of an entity; `known` holds the one that it has already.
    pub(super) fn entity_look(&mut self, look: &ast::Look, (id, name): (EntityId, &Name), known: &mut Table<()>) {
        let checked = self.look(&look.appearance);
        let name = Name { text: name.text.clone(), span: look.span };
        if known.declare(&name, (), &mut self.diagnostics)
            && let Some(look) = checked
        {
            self.checked.entity_looks.push(EntityLook { entity: id, look });
        }
    }

    /// Checks the looks of tags in a world.
    pub(super) fn tag_looks(&mut self, syntax: &ast::World) -> Vec<(Name, Look)> {
        let mut known: Table<()> = Table::new("the look of");
        let mut looks = Vec::new();
        for item in &syntax.items {
            let WorldItem::Look(line) = item else { continue };
            let look = self.look(&line.appearance);
            for tag in &line.tags {
                self.record_tag(tag, false);
                if known.declare(tag, (), &mut self.diagnostics)
                    && let Some(look) = &look
                {
                    looks.push((tag.clone(), look.clone()));
                }
            }
        }
        looks
    }

    /// What a map shows; none if its pictures have no path from the folder of the program.
    pub(super) fn map_look(&self, art: TileArt, space: SpaceId) -> Option<MapLook> {
        let folder = self.sources.file(self.root).path.parent().map(Path::to_path_buf).unwrap_or_default();
        let named =
            |path: &PathBuf| (path.is_absolute() == folder.is_absolute()).then(|| relative(&folder, &normalize(path)));
        let pictures = art.pictures.iter().map(named).collect::<Option<Vec<String>>>()?;
        let TileArt { tiles, stacks, cells, .. } = art;
        Some(MapLook { world: WorldId::from_index(0), space, pictures, tiles, stacks, cells })
    }

    fn look(&mut self, appearance: &Appearance) -> Option<Look> {
        let (look, written) = match appearance {
            Appearance::Color(color) => (self::color(&color.text), color),
            Appearance::Picture(path) => (self.picture(path), path),
        };
        match look {
            Ok(look) => Some(look),
            Err(why) => {
                self.diagnostics.report(BadLook { at: written.span, written: written.text.to_string(), why });
                None
            }
        }
    }

    /// A path as written is relative to the file that it is written in; a look's is relative to the program.
    fn picture(&mut self, path: &Name) -> Result<Look, WhyNoLook> {
        let text = path.text.as_str();
        let is_inside = |part: Component<'_>| matches!(part, Component::Normal(_) | Component::CurDir);
        let is_absolute = text.starts_with(['/', '\\']) || text.contains(':');
        if is_absolute || text.contains('\\') || !Path::new(text).components().all(is_inside) {
            return Err(WhyNoLook::OutsideFolder);
        }
        let extension = Path::new(text).extension().and_then(|extension| extension.to_str());
        if !extension.is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
            return Err(WhyNoLook::NoPng);
        }
        let folder = |id: FileId| self.sources.file(id).path.parent().map(Path::to_path_buf).unwrap_or_default();
        let file = folder(path.span.file()).join(text);
        let look = Look::Picture(relative(&folder(self.root), &file));
        // A behaviour's is met wherever it is used.
        if self.checked.pictures.iter().all(|(known, _)| known.span != path.span) {
            self.checked.pictures.push((path.clone(), file));
        }
        Ok(look)
    }
}

/// `#rgb` or `#rrggbb`, as `#rrggbb` in lower case.
fn color(text: &str) -> Result<Look, WhyNoLook> {
    let digits = text.trim_start_matches('#');
    if !digits.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return Err(WhyNoLook::NoDigits);
    }
    let full: String = match digits.len() {
        3 => digits.chars().flat_map(|digit| [digit, digit]).collect(),
        6 => digits.to_string(),
        count => return Err(WhyNoLook::Length(count)),
    };
    Ok(Look::Color(format!("#{}", full.to_ascii_lowercase())))
}

/// A path relative to a folder, with `/`.
fn relative(folder: &Path, path: &Path) -> String {
    let plain = |path: &Path| -> Vec<String> {
        let parts = path.components().filter(|part| *part != Component::CurDir);
        parts.map(|part| part.as_os_str().to_string_lossy().into_owned()).collect()
    };
    let (folder, path): (Vec<String>, Vec<String>) = (plain(folder), plain(path));
    let shared = folder.iter().zip(&path).take_while(|(a, b)| a == b).count();
    let up = folder.iter().skip(shared).map(|_| "..".to_string());
    let parts: Vec<String> = up.chain(path.into_iter().skip(shared)).collect();
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_have_three_or_six_digits() {
        let rgb = |text: &str| color(text).ok().and_then(|look| look.rgb());
        assert_eq!(rgb("#E04030"), Some([0xe0, 0x40, 0x30]));
        assert_eq!(rgb("#fa0"), Some([0xff, 0xaa, 0x00]));
        for wrong in ["#", "#ff", "#fffff", "#redred"] {
            assert_eq!(rgb(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn paths_are_relative_to_the_program() {
        let from = |folder: &str, path: &str| relative(Path::new(folder), Path::new(path));
        assert_eq!(from("games", "games/parts/./slime.png"), "parts/slime.png");
        assert_eq!(from("games/one", "games/shared/slime.png"), "../shared/slime.png");
        assert_eq!(from("", "slime.png"), "slime.png");
    }
}
