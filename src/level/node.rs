//! Files of level editors as trees of nodes with their places, whether they are XML or JSON. The readers of Tiled's and
//! LDtk's levels go through these trees.

use std::borrow::Cow;
use std::ops::Range;

use serde::Deserialize;
use serde::de::{IgnoredAny, MapAccess, Visitor};
use serde_json::value::RawValue;

#[cfg(feature = "tiled")]
use super::xml::read as xml;

/// Maximum nesting depth of nodes.
pub(super) const MAX_DEPTH: usize = 64;
/// Maximum number of nodes of a file.
pub(super) const MAX_NODES: usize = 1_000_000;

/// An error in a level file, and its bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct LevelError {
    pub at: Range<usize>,
    /// The message; none if it is reported already.
    pub why: Option<String>,
}

impl LevelError {
    pub fn new(at: Range<usize>, why: impl Into<String>) -> Self {
        LevelError { at, why: Some(why.into()) }
    }

    /// A file that is named here and could not be read, which is reported already.
    pub fn missing(at: Range<usize>) -> Self {
        LevelError { at, why: None }
    }
}

/// A scalar value: a text, a number or a truth value.
#[derive(Debug)]
pub(super) struct Scalar<'t> {
    /// The value as text, without quotes.
    pub text: Cow<'t, str>,
    /// The bytes of it.
    pub at: Range<usize>,
}

/// An element of XML, or an object of JSON.
#[derive(Debug)]
pub(super) struct Node<'t> {
    /// The element's name, or the key under which the object is, alone or in an array.
    pub name: Cow<'t, str>,
    /// The bytes of it.
    pub at: Range<usize>,
    /// Attributes in XML; scalar members in JSON.
    pub attributes: Vec<(Cow<'t, str>, Scalar<'t>)>,
    /// Child elements in XML; members that are objects, or arrays of them, in JSON.
    pub children: Vec<Node<'t>>,
    /// The text inside an element, or an array of scalars with its brackets, as written.
    pub text: &'t str,
    /// The byte where that text begins.
    pub text_at: usize,
    /// Whether it is an array of scalars, an empty one, or one of [`LISTS`].
    pub is_list: bool,
}

impl<'t> Node<'t> {
    /// Reads a file: XML if it begins with `<`, else JSON.
    pub fn read(text: &'t str) -> Result<Self, LevelError> {
        match text.trim_start().starts_with('<') {
            true => xml(text),
            false => json(text),
        }
    }

    /// An attribute.
    pub fn get(&self, name: &str) -> Option<&Scalar<'t>> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value)
    }

    /// The text of an attribute; empty if there is none.
    pub fn text_of(&self, name: &str) -> &str {
        self.get(name).map_or("", |value| &value.text)
    }

    /// Whether an attribute is true.
    pub fn is(&self, name: &str) -> bool {
        matches!(self.text_of(name), "true" | "1")
    }

    /// An attribute that is a number.
    pub fn number(&self, name: &str) -> Result<Option<f64>, LevelError> {
        let Some(value) = self.get(name) else { return Ok(None) };
        match value.text.trim().parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(Some(number)),
            _ => Err(LevelError::new(value.at.clone(), format!("`{name}` is no number"))),
        }
    }

    /// An attribute that is a non-negative whole number.
    pub fn count(&self, name: &str) -> Result<Option<u32>, LevelError> {
        let Some(value) = self.get(name) else { return Ok(None) };
        let count = value.text.trim().parse::<u32>().ok();
        count.map(Some).ok_or_else(|| LevelError::new(value.at.clone(), format!("`{name}` is no whole number from 0")))
    }

    /// A required attribute.
    pub fn needed<T>(&self, name: &str, value: Result<Option<T>, LevelError>) -> Result<T, LevelError> {
        value?.ok_or_else(|| LevelError::new(self.head(), format!("`{name}` is missing")))
    }

    /// The children that have one of these names.
    pub fn children<'n>(&'n self, names: &'n [&'n str]) -> impl Iterator<Item = &'n Node<'t>> {
        self.children.iter().filter(move |child| !child.is_list && names.iter().any(|name| *name == child.name))
    }

    /// The first child with a name: an element, an object or an array of scalars.
    pub fn child(&self, name: &str) -> Option<&Node<'t>> {
        self.children.iter().find(|child| child.name == name)
    }

    /// The first bytes of the node: findings about a whole node show only these.
    pub fn head(&self) -> Range<usize> {
        let name = if self.text_at > self.at.start || !self.name.is_empty() { self.name.len() } else { 0 };
        self.at.start..self.at.end.min(self.at.start + 1 + name)
    }
}

#[cfg(not(feature = "tiled"))]
fn xml(text: &str) -> Result<Node<'_>, LevelError> {
    let why = "this build of `hypedc` reads no XML (feature `tiled`): choose JSON in the editor";
    Err(LevelError::new(character(text, text.len() - text.trim_start().len()), why))
}

/// The members of an object, each as written.
struct Members<'t>(Vec<(String, &'t RawValue)>);

impl<'de: 't, 't> Deserialize<'de> for Members<'t> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;
        impl<'de> Visitor<'de> for Reader {
            type Value = Vec<(String, &'de RawValue)>;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut members = Vec::new();
                while let Some(member) = map.next_entry()? {
                    members.push(member);
                }
                Ok(members)
            }
        }
        deserializer.deserialize_map(Reader).map(Members)
    }
}

/// Members that may be large and that no reader needs.
const UNREAD: &[&str] = &["autoRuleGroups", "__neighbours", "toc", "__tile", "wangsets"];

/// Members that are kept as they are written: they have an object for each cell.
const LISTS: &[&str] = &["autoLayerTiles", "gridTiles"];

struct JsonReader<'t> {
    text: &'t str,
    nodes: usize,
}

fn json(text: &str) -> Result<Node<'_>, LevelError> {
    if let Err(error) = serde_json::from_str::<IgnoredAny>(text) {
        let line: usize = text.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
        let why = error.to_string();
        let why = why.split(" at line ").next().unwrap_or("");
        return Err(LevelError::new(
            character(text, line + error.column().saturating_sub(1)),
            format!("no JSON: {why}"),
        ));
    }
    if !text.trim_start().starts_with('{') {
        return Err(LevelError::new(character(text, 0), "an object is expected: `{ … }`"));
    }
    JsonReader { text, nodes: 0 }.object(String::new(), text.trim(), 0)
}

impl<'t> JsonReader<'t> {
    /// The bytes of a part of the text.
    fn place(&self, part: &str) -> Range<usize> {
        let start = (part.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize);
        start..start + part.len()
    }

    fn object(&mut self, name: String, raw: &'t str, depth: usize) -> Result<Node<'t>, LevelError> {
        let at = self.place(raw);
        self.nodes += 1;
        if depth > MAX_DEPTH || self.nodes > MAX_NODES {
            return Err(LevelError::new(at.start..at.start, "too many objects, or too many in each other"));
        }
        let broken = |_| LevelError::new(at.start..at.start, "this object cannot be read");
        let Members(members) = serde_json::from_str(raw).map_err(broken)?;
        let (mut attributes, mut children) = (Vec::new(), Vec::new());
        for (key, value) in members {
            let value = value.get();
            if UNREAD.contains(&key.as_str()) {
                continue;
            }
            match value.as_bytes().first() {
                Some(b'{') => children.push(self.object(key, value, depth + 1)?),
                Some(b'[') if value[1..].trim_start().starts_with('{') && !LISTS.contains(&key.as_str()) => {
                    let parts: Vec<&'t RawValue> = serde_json::from_str(value).map_err(broken)?;
                    for part in parts.into_iter().map(RawValue::get).filter(|part| part.starts_with('{')) {
                        children.push(self.object(key.clone(), part, depth + 1)?);
                    }
                }
                Some(b'[') => {
                    self.nodes += 1;
                    let at = self.place(value);
                    let (name, text_at) = (Cow::Owned(key), at.start);
                    children.push(Node {
                        name,
                        at,
                        attributes: vec![],
                        children: vec![],
                        text: value,
                        text_at,
                        is_list: true,
                    });
                }
                Some(b'n') | None => {}
                Some(b'"') => {
                    let text = Cow::Owned(serde_json::from_str::<String>(value).map_err(broken)?);
                    attributes.push((Cow::Owned(key), Scalar { text, at: self.place(value) }));
                }
                Some(_) => {
                    attributes.push((Cow::Owned(key), Scalar { text: Cow::Borrowed(value), at: self.place(value) }));
                }
            }
        }
        Ok(Node {
            name: Cow::Owned(name),
            at: at.clone(),
            attributes,
            children,
            text: "",
            text_at: at.start,
            is_list: false,
        })
    }
}

/// The bytes of the character that contains a byte.
pub(super) fn character(text: &str, byte: usize) -> Range<usize> {
    let mut start = byte.min(text.len());
    while !text.is_char_boundary(start) {
        start -= 1;
    }
    start..start + text[start..].chars().next().map_or(0, char::len_utf8)
}
