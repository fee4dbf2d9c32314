//! What things look like: a table of its own, beside the program's meaning. The simulator, the analysis and the planners
//! never read it; pictures, animations and the page of `hypedc play` do.

use serde::{Deserialize, Serialize};

use super::{EntityId, Program, SlotId, SpaceId, TagId, TagSet, WorldId};

/// What a thing looks like.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Look {
    /// A colour as `#rrggbb`, in lower case.
    Color(String),
    /// A picture: the path of a PNG file, relative to the folder of the program, with `/`.
    Picture(String),
}

impl Look {
    /// The red, green and blue of a colour; none for a picture.
    pub fn rgb(&self) -> Option<[u8; 3]> {
        let Look::Color(color) = self else { return None };
        let number = color
            .strip_prefix('#')
            .filter(|digits| digits.len() == 6 && digits.bytes().all(|digit| digit.is_ascii_hexdigit()));
        let number = number.and_then(|digits| u32::from_str_radix(digits, 16).ok())?;
        let [_, red, green, blue] = number.to_be_bytes();
        Some([red, green, blue])
    }

    /// The path of a picture; none for a colour.
    pub fn picture(&self) -> Option<&str> {
        match self {
            Look::Picture(path) => Some(path),
            Look::Color(_) => None,
        }
    }
}

/// What instances of an entity look like.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct EntityLook {
    /// The entity; no other entry has it.
    pub entity: EntityId,
    /// Their look.
    pub look: Look,
}

/// What tiles and free-standing geometry with a tag look like in a world.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct TagLook {
    /// The world.
    pub world: WorldId,
    /// The tag; no other entry of the world has it.
    pub tag: TagId,
    /// Their look.
    pub look: Look,
}

/// A tile of a level editor: a part of a picture.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct TilePicture {
    /// The index of the picture.
    pub picture: u16,
    /// The part: left, top, width and height, pixels.
    pub part: [u32; 4],
    /// How it is mirrored: 4 along the diagonal from the upper left corner, then 1 horizontally, then 2 vertically; or a
    /// sum of these.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub mirrored: u8,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(number: &u8) -> bool {
    *number == 0
}

/// What the cells of a map show in the level editor that it was made with.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct MapLook {
    /// The world.
    pub world: WorldId,
    /// The space with the map; no other entry of the world has it.
    pub space: SpaceId,
    /// The paths of pictures, as those of looks.
    pub pictures: Vec<String>,
    /// Parts of them.
    pub tiles: Vec<TilePicture>,
    /// What cells show, the lowest tile first: indices in `tiles`. The first one is nothing.
    pub stacks: Vec<Vec<u16>>,
    /// For each cell of the map, in its order, what it shows: an index in `stacks`.
    pub cells: Vec<u16>,
}

/// All looks of a program.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Looks {
    /// Those of entities.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub entities: Vec<EntityLook>,
    /// Those of tags, world by world in source order. Of several tags of a thing the first one here counts.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<TagLook>,
    /// What maps of level editors show.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub maps: Vec<MapLook>,
}

impl Looks {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.entities.is_empty() && self.tags.is_empty() && self.maps.is_empty()
    }

    /// The look of an entity.
    pub fn of_entity(&self, entity: EntityId) -> Option<&Look> {
        self.entities.iter().find(|entry| entry.entity == entity).map(|entry| &entry.look)
    }

    /// The look of something with some tags in a world.
    pub fn of_tags(&self, world: WorldId, tags: TagSet) -> Option<&Look> {
        let mut looks = self.tags.iter().filter(|entry| entry.world == world);
        looks.find(|entry| TagSet::of(entry.tag).meets(tags)).map(|entry| &entry.look)
    }

    /// What the map of a space shows.
    pub fn of_map(&self, world: WorldId, space: SpaceId) -> Option<&MapLook> {
        self.maps.iter().find(|entry| entry.world == world && entry.space == space)
    }

    /// The paths of the pictures of level editors' tiles, each once.
    pub fn tile_pictures(&self) -> Vec<&str> {
        let mut paths: Vec<&str> = self.maps.iter().flat_map(|map| &map.pictures).map(String::as_str).collect();
        paths.sort_unstable();
        paths.dedup();
        paths
    }

    /// The paths of the pictures that the text names, each once.
    pub fn pictures(&self) -> Vec<&str> {
        let looks = self.entities.iter().map(|entry| &entry.look).chain(self.tags.iter().map(|entry| &entry.look));
        let mut paths: Vec<&str> = looks.filter_map(Look::picture).collect();
        paths.sort_unstable();
        paths.dedup();
        paths
    }
}

impl Program {
    /// The look of the instance in a slot of a world: that of its entity, or that of a tag of one of its colliders.
    pub fn look_of(&self, world: WorldId, slot: SlotId) -> Option<&Look> {
        let entity = self.worlds[world].slots[slot].entity;
        let tags = self.entities[entity].colliders.iter().map(|collider| collider.tags);
        let tags = tags.fold(TagSet::default(), TagSet::with);
        self.looks.of_entity(entity).or_else(|| self.looks.of_tags(world, tags))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_are_read_and_nothing_else_is() {
        let rgb = |text: &str| Look::Color(text.into()).rgb();
        assert_eq!(rgb("#e04030"), Some([0xe0, 0x40, 0x30]));
        for wrong in ["e04030", "#e0403", "#e04030ff", "#gggggg", "", "#+12345"] {
            assert_eq!(rgb(wrong), None, "{wrong}");
        }
        assert_eq!(Look::Picture("#e04030".into()).rgb(), None);
    }
}
