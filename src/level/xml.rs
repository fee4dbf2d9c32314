//! Reader of XML files as trees of nodes.

use std::borrow::Cow;

use super::node::{LevelError, MAX_DEPTH, MAX_NODES, Node, Scalar, character};

/// Reads an XML file of a level editor.
pub(super) fn read(text: &str) -> Result<Node<'_>, LevelError> {
    // Old maps have a document type. Entity definitions could expand a small file without limit.
    let allow_dtd = !text.contains("<!ENTITY");
    let options = roxmltree::ParsingOptions { nodes_limit: MAX_NODES as u32, allow_dtd, ..Default::default() };
    let document = roxmltree::Document::parse_with_options(text, options).map_err(|error| {
        let place = error.pos();
        let line: usize = text.split_inclusive('\n').take(place.row.saturating_sub(1) as usize).map(str::len).sum();
        let rest = text.get(line..).unwrap_or("");
        let column: usize = rest.chars().take(place.col.saturating_sub(1) as usize).map(char::len_utf8).sum();
        let why = error.to_string();
        // The finding shows the place.
        let why = why.rsplit_once(" at ").map_or(why.as_str(), |(why, _)| why);
        LevelError::new(character(text, line + column), format!("the XML is broken: {why}"))
    })?;
    element(text, document.root_element(), 0)
}

fn element<'t>(text: &'t str, from: roxmltree::Node<'_, 't>, depth: usize) -> Result<Node<'t>, LevelError> {
    let at = from.range();
    if depth > MAX_DEPTH {
        return Err(LevelError::new(at.start..at.start, "too many elements in each other"));
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
