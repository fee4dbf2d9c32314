//! XML text as elements with places. Input that is expensive to parse is rejected first: document types (and with them
//! entities), very many attributes, deep nesting.

use roxmltree::{Document, Error, Node, ParsingOptions};

use crate::diagnostic::catalogue::import::NotWellFormed;
use crate::source::{FileId, Span};

/// Maximum size of a text, in bytes; entity definitions have a few thousand.
const MAX_BYTES: usize = 1 << 20;
/// Maximum number of elements, comments and texts.
const MAX_NODES: u32 = 10_000;
/// Maximum nesting depth of elements.
const MAX_DEPTH: u32 = 64;
/// Maximum number of attributes of a tag: the parser compares each pair.
const MAX_ATTRIBUTES: usize = 64;
/// Maximum number of namespaces: each is copied to all inner elements.
const MAX_NAMESPACES: usize = 16;

/// Parses a document.
///
/// The syntax error or the exceeded limit, and its place.
pub(super) fn document(file: FileId, text: &str) -> Result<Document<'_>, NotWellFormed> {
    let refused = |at: std::ops::Range<usize>, what: String, help: &str| NotWellFormed {
        what,
        at: Span::new(file, at.start, at.end),
        help: Some(help.to_string()),
    };
    if text.len() > MAX_BYTES {
        let what = format!("the file is too large: {} KiB, at most {} KiB are read", text.len() >> 10, MAX_BYTES >> 10);
        return Err(refused(0..0, what, "a file holds one entity"));
    }
    if let Some(at) = tag_with_too_many_attributes(text) {
        let what = format!("a tag has more than {MAX_ATTRIBUTES} attributes");
        return Err(refused(at..at + 1, what, "no element of an entity has more than three"));
    }
    if text.matches("xmlns").count() > MAX_NAMESPACES {
        let at = text.find("xmlns").unwrap_or_default();
        return Err(refused(at..at + 5, "too many namespaces".into(), "entities need none"));
    }
    let document =
        Document::parse_with_options(text, ParsingOptions { nodes_limit: MAX_NODES, ..ParsingOptions::default() })
            .map_err(|error| not_well_formed(file, text, &error))?;
    let mut depths: Vec<u32> = Vec::new();
    for node in document.descendants() {
        // Parents come before their children.
        let depth = node.parent().and_then(|p| depths.get(p.id().get_usize())).map_or(0, |d| d + 1);
        if depth > MAX_DEPTH {
            let start = node.range().start;
            let what = format!("elements nest deeper than {MAX_DEPTH}");
            return Err(refused(start..start + 1, what, "no game needs as many modes inside of each other"));
        }
        depths.push(depth);
    }
    Ok(document)
}

/// The place of the first tag with too many attributes.
fn tag_with_too_many_attributes(text: &str) -> Option<usize> {
    let bytes = text.as_bytes();
    let mut at = 0;
    while let Some(start) = text.get(at..).and_then(|rest| rest.find('<')).map(|found| at + found) {
        let rest = text.get(start..)?;
        let over = |open: &str, close: &str| {
            rest.starts_with(open).then(|| rest.find(close).map_or(text.len(), |found| start + found + close.len()))
        };
        if let Some(end) = over("<!--", "-->").or_else(|| over("<![CDATA[", "]]>")).or_else(|| over("<?", "?>")) {
            at = end;
            continue;
        }
        let (mut quote, mut attributes) = (None, 0);
        at = start + 1;
        while let Some(&byte) = bytes.get(at) {
            at += 1;
            match (quote, byte) {
                (Some(open), _) if open == byte => quote = None,
                (Some(_), _) => {}
                (None, b'"' | b'\'') => {
                    quote = Some(byte);
                    attributes += 1;
                }
                (None, b'>') => break,
                (None, _) => {}
            }
        }
        if attributes > MAX_ATTRIBUTES {
            return Some(start);
        }
    }
    None
}

/// The parser's error as a finding.
fn not_well_formed(file: FileId, text: &str, error: &Error) -> NotWellFormed {
    let end = text.trim_end().len();
    let (start, what, help) = match error {
        Error::UnexpectedCloseTag(expected, found, _) => (
            None,
            format!("`</{found}>` closes nothing here: `<{expected}>` is open"),
            Some(format!("close `<{expected}>` first, or mend the name")),
        ),
        Error::UnclosedRootNode | Error::UnexpectedEndOfStream => {
            (Some(end), "the file ends while an element is open".to_string(), Some("is its end missing?".to_string()))
        }
        Error::NoRootNode => {
            (Some(end), "there is no element".into(), Some("an entity is an `<automaton name=\"…\">`".into()))
        }
        Error::DtdDetected => (
            text.find("<!DOCTYPE"),
            "the file has a document type".into(),
            Some("entities need none; it is refused, for its macros can grow without bounds".into()),
        ),
        Error::NodesLimitReached => (
            Some(0),
            format!("the file has more than {MAX_NODES} elements, comments and texts between them"),
            Some("a file holds one entity".into()),
        ),
        Error::UnknownEntityReference(name, _) => {
            (None, format!("nothing is known as `&{name};`"), Some("write `&amp;` for `&`, `&lt;` for `<`".into()))
        }
        Error::MalformedEntityReference(_) => {
            (None, "`&` is alone".into(), Some("write `&amp;` for `&` itself".into()))
        }
        Error::InvalidAttributeValue(_) => {
            (None, "`<` is in a value".into(), Some("write `&lt;` for `<` itself".into()))
        }
        Error::DuplicatedAttribute(name, _) => (None, format!("the attribute `{name}` is given twice"), None),
        Error::InvalidComment(_) => {
            (None, "a comment holds `--`".into(), Some("only its end, `-->`, may have these signs".into()))
        }
        Error::InvalidChar(b'"' | b'\'', b'<', _) => {
            (None, "`<` is in a value".into(), Some("write `&lt;` for `<` itself".into()))
        }
        Error::InvalidChar(needed, found, _) => {
            (None, format!("`{}` is needed here, not `{}`", char::from(*needed), char::from(*found)), None)
        }
        Error::InvalidChar2(needed, found, _) => {
            (None, format!("{needed} is needed here, not `{}`", char::from(*found)), None)
        }
        Error::InvalidString(needed, _) => (None, format!("`{needed}` is needed here"), None),
        Error::InvalidName(_) => (None, "a name is needed here".into(), None),
        Error::UnknownNamespace(prefix, _) => {
            (None, format!("the prefix `{prefix}:` is declared nowhere"), Some("entities need none".into()))
        }
        Error::UnknownToken(_) => (
            None,
            "this is allowed neither before nor after the outermost element".into(),
            Some("a file holds one `<automaton>`".into()),
        ),
        other => {
            // Its text includes the position as numbers; the finding shows the place.
            let said = other.to_string();
            (None, said.strip_suffix(&format!(" at {}", other.pos())).unwrap_or(&said).to_string(), None)
        }
    };
    let start = start.unwrap_or_else(|| byte_at(text, error.pos().row, error.pos().col));
    let end = text.get(start..).and_then(|rest| rest.chars().next()).map_or(start, |c| start + c.len_utf8());
    NotWellFormed { what, at: Span::new(file, start, end), help }
}

/// The byte of a line and a column, both from 1, the column in characters.
fn byte_at(text: &str, row: u32, column: u32) -> usize {
    let line: usize = text.split_inclusive('\n').take(row.saturating_sub(1) as usize).map(str::len).sum();
    let rest = text.get(line..).unwrap_or_default();
    line + rest.char_indices().nth(column.saturating_sub(1) as usize).map_or(rest.len(), |(at, _)| at)
}

/// An element, and the file that it is in.
#[derive(Clone, Copy)]
pub(super) struct Element<'a, 't> {
    file: FileId,
    /// The parser's node.
    pub node: Node<'a, 't>,
}

/// An attribute's value.
#[derive(Clone, Copy)]
pub(super) struct Value<'a> {
    /// Without blanks around it.
    pub text: &'a str,
    pub at: Span,
}

impl<'a, 't> Element<'a, 't> {
    pub fn new(file: FileId, node: Node<'a, 't>) -> Self {
        Element { file, node }
    }

    /// Another element of the same file.
    pub fn at(self, node: Node<'a, 't>) -> Self {
        Element { node, ..self }
    }

    /// Its name, without a namespace prefix.
    pub fn name(self) -> &'a str {
        self.node.tag_name().name()
    }

    /// The span of `<edge`.
    pub fn tag(self) -> Span {
        let start = self.node.range().start;
        let rest = self.node.document().input_text().get(start..).unwrap_or_default();
        let length = rest.find(|c: char| c.is_whitespace() || matches!(c, '/' | '>')).unwrap_or(rest.len());
        Span::new(self.file, start, start + length)
    }

    /// The bytes of something in the same file.
    pub fn span(self, bytes: std::ops::Range<usize>) -> Span {
        Span::new(self.file, bytes.start, bytes.end)
    }

    /// An attribute by its name.
    pub fn value(self, name: &str) -> Option<Value<'a>> {
        let attribute = self.node.attributes().find(|a| a.name() == name)?;
        Some(Value { text: attribute.value().trim(), at: self.span(attribute.range_value()) })
    }

    /// The child elements.
    pub fn children(self) -> impl Iterator<Item = Element<'a, 't>> {
        self.node.children().filter(Node::is_element).map(move |node| Element { file: self.file, node })
    }

    /// The child elements with a name.
    pub fn all(self, name: &'static str) -> impl Iterator<Item = Element<'a, 't>> {
        self.children().filter(move |e| e.name() == name)
    }

    /// The first child element with a name.
    pub fn first(self, name: &'static str) -> Option<Element<'a, 't>> {
        self.all(name).next()
    }
}
