//! Files of level editors as trees of nodes with their places, whether they are XML or JSON. The readers of Tiled's and
//! LDtk's levels go through these trees.

use std::borrow::Cow;
use std::ops::Range;

use serde::Deserialize;
use serde::de::{IgnoredAny, MapAccess, Visitor};
use serde_json::value::RawValue;

/// How deep nodes may be nested.
const MAX_DEPTH: usize = 64;
/// The most nodes of one file.
const MAX_NODES: usize = 1_000_000;

/// What is wrong with a file, and the bytes where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Trouble {
    pub at: Range<usize>,
    /// None if it is said already.
    pub why: Option<String>,
}

impl Trouble {
    pub fn new(at: Range<usize>, why: impl Into<String>) -> Self {
        Trouble { at, why: Some(why.into()) }
    }

    /// A file that is named here could not be read, which is said already.
    pub fn missing(at: Range<usize>) -> Self {
        Trouble { at, why: None }
    }
}

/// A value that is a text, a number or a truth value.
#[derive(Debug)]
pub(super) struct Scalar<'t> {
    /// What it says, without quotes.
    pub text: Cow<'t, str>,
    /// Where it stands.
    pub at: Range<usize>,
}

/// An element of XML, or an object of JSON.
#[derive(Debug)]
pub(super) struct Node<'t> {
    /// The element's name, or the key under which the object stands, alone or in an array.
    pub name: Cow<'t, str>,
    /// Where it stands.
    pub at: Range<usize>,
    /// Attributes; members that are neither objects nor arrays.
    attributes: Vec<(Cow<'t, str>, Scalar<'t>)>,
    /// Elements inside; members that are objects, or arrays of them.
    children: Vec<Node<'t>>,
    /// The text inside of an element, or an array of scalars with its brackets, as written.
    pub text: &'t str,
    /// Where that text begins.
    pub text_at: usize,
    /// Whether it is an array of scalars, or an empty one.
    is_list: bool,
}

impl<'t> Node<'t> {
    /// Reads a file: XML if it begins with `<`, else JSON.
    pub fn read(text: &'t str) -> Result<Self, Trouble> {
        if text.trim_start().starts_with('<') { xml(text) } else { json(text) }
    }

    /// An attribute.
    pub fn get(&self, name: &str) -> Option<&Scalar<'t>> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value)
    }

    /// The text of an attribute; nothing if there is none.
    pub fn text_of(&self, name: &str) -> &str {
        self.get(name).map_or("", |value| &value.text)
    }

    /// Whether an attribute says that something is so.
    pub fn is(&self, name: &str) -> bool {
        matches!(self.text_of(name), "true" | "1")
    }

    /// An attribute that is a number.
    pub fn number(&self, name: &str) -> Result<Option<f64>, Trouble> {
        let Some(value) = self.get(name) else { return Ok(None) };
        match value.text.trim().parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(Some(number)),
            _ => Err(Trouble::new(value.at.clone(), format!("`{name}` is no number"))),
        }
    }

    /// An attribute that is a whole number from 0.
    pub fn count(&self, name: &str) -> Result<Option<u32>, Trouble> {
        let Some(value) = self.get(name) else { return Ok(None) };
        let count = value.text.trim().parse::<u32>().ok();
        count.map(Some).ok_or_else(|| Trouble::new(value.at.clone(), format!("`{name}` is no whole number from 0")))
    }

    /// An attribute that must be there.
    pub fn needed<T>(&self, name: &str, value: Result<Option<T>, Trouble>) -> Result<T, Trouble> {
        value?.ok_or_else(|| Trouble::new(self.head(), format!("`{name}` is missing")))
    }

    /// The elements or objects inside that have one of these names.
    pub fn children<'n>(&'n self, names: &'n [&'n str]) -> impl Iterator<Item = &'n Node<'t>> {
        self.children.iter().filter(move |child| !child.is_list && names.iter().any(|name| *name == child.name))
    }

    /// The first element, object or array of scalars of a name.
    pub fn child(&self, name: &str) -> Option<&Node<'t>> {
        self.children.iter().find(|child| child.name == name)
    }

    /// Where the node begins: findings of a whole node show its first bytes alone.
    pub fn head(&self) -> Range<usize> {
        let name = if self.text_at > self.at.start || !self.name.is_empty() { self.name.len() } else { 0 };
        self.at.start..self.at.end.min(self.at.start + 1 + name)
    }
}

// ---- XML ------------------------------------------------------------------------------------------------------------

fn xml(text: &str) -> Result<Node<'_>, Trouble> {
    // Old maps name their document type. Entities of one's own could make a small file endless.
    let allow_dtd = !text.contains("<!ENTITY");
    let options = roxmltree::ParsingOptions { nodes_limit: MAX_NODES as u32, allow_dtd, ..Default::default() };
    let document = roxmltree::Document::parse_with_options(text, options).map_err(|error| {
        let place = error.pos();
        let line: usize = text.split_inclusive('\n').take(place.row.saturating_sub(1) as usize).map(str::len).sum();
        let rest = text.get(line..).unwrap_or("");
        let column: usize = rest.chars().take(place.col.saturating_sub(1) as usize).map(char::len_utf8).sum();
        let why = error.to_string();
        // The place is shown with the finding.
        let why = why.rsplit_once(" at ").map_or(why.as_str(), |(why, _)| why);
        Trouble::new(character(text, line + column), format!("the XML is broken: {why}"))
    })?;
    element(text, document.root_element(), 0)
}

fn element<'t>(text: &'t str, from: roxmltree::Node<'_, 't>, depth: usize) -> Result<Node<'t>, Trouble> {
    let at = from.range();
    if depth > MAX_DEPTH {
        return Err(Trouble::new(at.start..at.start, "too many elements in each other"));
    }
    let attribute = |a: roxmltree::Attribute<'_, 't>| {
        let scalar = Scalar { text: Cow::Owned(a.value().to_string()), at: a.range_value() };
        (Cow::Owned(a.name().to_string()), scalar)
    };
    let inside = from.children().filter(|child| child.is_text()).map(|child| child.range());
    let text_at = inside.max_by_key(ExactSizeIterator::len).unwrap_or(at.start..at.start);
    let children = from.children().filter(roxmltree::Node::is_element);
    Ok(Node {
        name: Cow::Owned(from.tag_name().name().to_string()),
        at,
        attributes: from.attributes().map(attribute).collect(),
        children: children.map(|child| element(text, child, depth + 1)).collect::<Result<_, _>>()?,
        text: text.get(text_at.clone()).unwrap_or(""),
        text_at: text_at.start,
        is_list: false,
    })
}

// ---- JSON -----------------------------------------------------------------------------------------------------------

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

/// Members that may be large and that no reader asks for.
const UNREAD: &[&str] = &["autoLayerTiles", "gridTiles", "autoRuleGroups", "__neighbours", "toc", "__tile", "wangsets"];

struct JsonReader<'t> {
    text: &'t str,
    nodes: usize,
}

fn json(text: &str) -> Result<Node<'_>, Trouble> {
    if let Err(error) = serde_json::from_str::<IgnoredAny>(text) {
        let line: usize = text.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
        let why = error.to_string();
        let why = why.split(" at line ").next().unwrap_or("");
        return Err(Trouble::new(character(text, line + error.column().saturating_sub(1)), format!("no JSON: {why}")));
    }
    if !text.trim_start().starts_with('{') {
        return Err(Trouble::new(character(text, 0), "an object is expected: `{ … }`"));
    }
    JsonReader { text, nodes: 0 }.object(String::new(), text.trim(), 0)
}

impl<'t> JsonReader<'t> {
    /// Where a part of the text stands in it.
    fn place(&self, part: &str) -> Range<usize> {
        let start = (part.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize);
        start..start + part.len()
    }

    fn object(&mut self, name: String, raw: &'t str, depth: usize) -> Result<Node<'t>, Trouble> {
        let at = self.place(raw);
        self.nodes += 1;
        if depth > MAX_DEPTH || self.nodes > MAX_NODES {
            return Err(Trouble::new(at.start..at.start, "too many objects, or too many in each other"));
        }
        let broken = |_| Trouble::new(at.start..at.start, "this object cannot be read");
        let Members(members) = serde_json::from_str(raw).map_err(broken)?;
        let (mut attributes, mut children) = (Vec::new(), Vec::new());
        for (key, value) in members {
            let value = value.get();
            if UNREAD.contains(&key.as_str()) {
                continue;
            }
            match value.as_bytes().first() {
                Some(b'{') => children.push(self.object(key, value, depth + 1)?),
                Some(b'[') if value[1..].trim_start().starts_with('{') => {
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

/// The bytes of the character at or before a byte.
fn character(text: &str, byte: usize) -> Range<usize> {
    let mut start = byte.min(text.len());
    while !text.is_char_boundary(start) {
        start -= 1;
    }
    start..start + text[start..].chars().next().map_or(0, char::len_utf8)
}
