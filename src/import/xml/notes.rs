//! Comments and their subjects: a comment on the line of a tag is about that tag; one that is deeper than the element
//! before it, about that element; one before all elements, with a blank line after it, about the parent; any other
//! about the element after it.

use roxmltree::Node;

use super::read::Element;

/// The elements in another one, with their comments.
pub(super) struct Notes<'a, 't> {
    /// Comments on the line of the opening tag, or separate ones at the beginning.
    pub opening: Vec<String>,
    pub children: Vec<Noted<'a, 't>>,
    /// Comments after the last element.
    pub closing: Vec<String>,
}

/// An element with its comments.
pub(super) struct Noted<'a, 't> {
    pub element: Element<'a, 't>,
    /// Comments before it.
    pub above: Vec<String>,
    /// Comments on its last line.
    pub beside: Vec<String>,
}

/// The elements in another one, with their comments.
pub(super) fn notes<'a, 't>(e: Element<'a, 't>) -> Notes<'a, 't> {
    let text = e.node.document().input_text();
    let mut notes = Notes { opening: Vec::new(), children: Vec::new(), closing: Vec::new() };
    // Whether a line ended since the last element or the opening tag.
    let mut same_line = true;
    let mut waiting: Vec<String> = Vec::new();
    for node in e.node.children() {
        if node.is_element() {
            let above = std::mem::take(&mut waiting);
            notes.children.push(Noted { element: e.at(node), above, beside: Vec::new() });
            same_line = true;
        } else if node.is_comment() {
            let lines = lines(node);
            match notes.children.last_mut() {
                Some(last) if same_line || indent(text, node) > indent(text, last.element.node) => {
                    last.beside.extend(lines);
                }
                None if same_line => notes.opening.extend(lines),
                _ => waiting.extend(lines),
            }
        } else {
            let breaks = text.get(node.range()).map_or(0, |t| t.matches('\n').count());
            same_line &= breaks == 0;
            // A comment separate from everything after it is about the whole.
            if breaks > 1 && notes.children.is_empty() {
                notes.opening.append(&mut waiting);
            }
        }
    }
    notes.closing = waiting;
    notes
}

/// The comments anywhere inside of an element.
pub(super) fn inside(e: Element<'_, '_>) -> Vec<String> {
    e.node.descendants().filter(Node::is_comment).flat_map(lines).collect()
}

/// The indentation of a node; none if it is not the first on its line.
fn indent(text: &str, node: Node<'_, '_>) -> Option<usize> {
    let before = text.get(..node.range().start)?;
    let line = &before[before.rfind('\n').map_or(0, |at| at + 1)..];
    line.trim().is_empty().then(|| line.chars().count())
}

/// The lines of a comment, without comment marks of other languages at its beginning. Markup that was commented out has
/// none.
fn lines(node: Node<'_, '_>) -> Vec<String> {
    let text = node.text().unwrap_or_default().trim();
    if text.starts_with('<') && text.ends_with('>') {
        return Vec::new();
    }
    let lines = text.lines().flat_map(|line| line.split('\r'));
    let words = lines.map(|line| line.trim_start_matches(['#', '/', ' ', '\t']).split_whitespace());
    words.map(|words| words.collect::<Vec<_>>().join(" ")).filter(|line| !line.is_empty()).collect()
}
