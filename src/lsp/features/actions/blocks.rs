//! Where statements and blocks are in a text that has balanced brackets: what is removed with a statement, and where a
//! new one goes.

use std::ops::Range;

use pest::iterators::Pair;

use crate::diagnostic::suggestion::BlockKind;
use crate::source::FileId;
use crate::syntax::{self, Rule};

use crate::lsp::text::cursor::Block;
use crate::lsp::text::words::usual_order;

/// The statements, and parts of statements, that can be removed alone.
const STATEMENTS: &[Rule] = &[
    Rule::import,
    Rule::constant,
    Rule::entity,
    Rule::behavior,
    Rule::world,
    Rule::parameter,
    Rule::continuous,
    Rule::discrete,
    Rule::reference,
    Rule::buttons,
    Rule::axes,
    Rule::chance,
    Rule::collider,
    Rule::clamp,
    Rule::invariant,
    Rule::condition,
    Rule::signals,
    Rule::look,
    Rule::group,
    Rule::mode,
    Rule::always,
    Rule::assignment,
    Rule::edge,
    Rule::spawn,
    Rule::destroy,
    Rule::send,
    Rule::update,
    Rule::put,
    Rule::follow,
    Rule::envelope,
    Rule::attack,
    Rule::decay,
    Rule::sustain,
    Rule::release,
    Rule::driven_while,
    Rule::step,
    Rule::collide,
    Rule::tiles,
    Rule::tile,
    Rule::kind,
    Rule::limit,
    Rule::tag_look,
    Rule::space,
    Rule::player,
    Rule::goal,
    Rule::never,
    Rule::test,
    Rule::map,
    Rule::place,
    Rule::link,
    Rule::solid,
    Rule::bounds,
    Rule::wrap,
    Rule::setting,
    Rule::given,
    Rule::draws,
    Rule::expect,
    Rule::search,
];

/// Parts of statements that are removed with the blanks before them.
const PARTS: &[Rule] = &[Rule::tile_name, Rule::slope, Rule::breakable, Rule::deadline, Rule::without];

/// A statement or a part of one.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub rule: Rule,
    pub bytes: Range<usize>,
}

impl Node {
    fn of(pair: &Pair<'_, Rule>) -> Node {
        let start = pair.as_span().start();
        Node { rule: pair.as_rule(), bytes: start..start + pair.as_str().trim_end().len() }
    }
}

/// The grammar's view of a text.
pub(super) struct Blocks<'t> {
    pub code: &'t str,
    /// All pairs, outer ones first.
    nodes: Vec<Node>,
}

impl<'t> Blocks<'t> {
    /// `None` if the brackets of the text are not balanced.
    pub fn of(code: &'t str) -> Option<Self> {
        let nodes = syntax::pairs(FileId(0), code)?.flatten().map(|pair| Node::of(&pair)).collect();
        Some(Blocks { code, nodes })
    }

    /// The nodes around a range, innermost first.
    pub fn around<'s>(&'s self, at: &Range<usize>) -> impl Iterator<Item = &'s Node> + Clone + use<'s, 't> {
        let (start, end) = (at.start, at.end);
        self.nodes.iter().rev().filter(move |node| node.bytes.start <= start && end <= node.bytes.end)
    }

    /// The nodes in a range.
    pub fn inside<'s>(&'s self, at: &Range<usize>) -> impl Iterator<Item = &'s Node> + Clone + use<'s, 't> {
        let (from, end) = (self.nodes.partition_point(|node| node.bytes.start < at.start), at.end);
        self.nodes.iter().skip(from).filter(move |node| node.bytes.end <= end)
    }

    /// The nodes directly in a node.
    pub fn children(&self, node: &Node) -> Vec<&Node> {
        let index = self.nodes.iter().position(|other| std::ptr::eq(other, node)).unwrap_or(self.nodes.len());
        let mut out: Vec<&Node> = Vec::new();
        let after = self.nodes.iter().skip(index + 1).take_while(|other| other.bytes.start < node.bytes.end);
        for other in after.filter(|other| other.bytes.end <= node.bytes.end) {
            if out.last().is_none_or(|last| last.bytes.end <= other.bytes.start) {
                out.push(other);
            }
        }
        out
    }

    /// The innermost node around a range with one of some rules.
    pub fn innermost(&self, at: &Range<usize>, rules: &[Rule]) -> Option<&Node> {
        self.around(at).find(|node| rules.contains(&node.rule))
    }

    /// The innermost statement around a range.
    pub fn statement(&self, at: &Range<usize>) -> Option<&Node> {
        self.innermost(at, STATEMENTS)
    }

    /// The statements directly in a range.
    pub fn statements(&self, inside: &Range<usize>) -> Vec<&Node> {
        let mut out: Vec<&Node> = Vec::new();
        for node in self.inside(inside).filter(|node| STATEMENTS.contains(&node.rule) && node.bytes != *inside) {
            if out.last().is_none_or(|last| last.bytes.end <= node.bytes.start) {
                out.push(node);
            }
        }
        out
    }

    /// What is removed together with what is at a range: a statement with its line, an element of a list with its
    /// comma.
    pub fn removed(&self, at: &Range<usize>) -> Option<Range<usize>> {
        // The guard of `initial` decides where a mode begins: it is no reason to remove the mode.
        let stop = |node: &&Node| STATEMENTS.contains(&node.rule) || PARTS.contains(&node.rule);
        let node = self.around(at).take_while(|node| node.rule != Rule::initial).find(stop)?;
        if PARTS.contains(&node.rule) {
            let before = self.code.get(..node.bytes.start)?.trim_end_matches([' ', '\t']).len();
            return Some(before..node.bytes.end);
        }
        let element = match node.rule {
            Rule::buttons | Rule::axes => Rule::name,
            Rule::signals => Rule::signal,
            _ => return self.lines(&node.bytes),
        };
        let elements: Vec<&Node> = self.inside(&node.bytes).filter(|n| n.rule == element).collect();
        let index = elements.iter().position(|n| n.bytes.start <= at.start && at.end <= n.bytes.end);
        match (elements.len(), index?) {
            (1, _) => self.lines(&node.bytes),
            (_, 0) => Some(elements[0].bytes.start..elements.get(1)?.bytes.start),
            (_, index) => Some(elements.get(index - 1)?.bytes.end..elements[index].bytes.end),
        }
    }

    /// A statement with its line and the documentation above it, if the line has nothing else; with its `;` otherwise.
    pub fn lines(&self, bytes: &Range<usize>) -> Option<Range<usize>> {
        let mut start = self.line_start(bytes.start);
        let before = self.code.get(start..bytes.start)?;
        let after = self.code.get(bytes.end..)?;
        let rest = after.find('\n').map_or(after, |end| &after[..end]);
        if !before.trim().is_empty() || !rest.trim().is_empty() {
            let separator = after.trim_start_matches([' ', '\t']);
            let is_followed = separator.starts_with(';');
            let blanks = after.len() - separator.len();
            let cut = if is_followed { blanks + 1 } else { 0 };
            let lead = self.code.get(..bytes.start)?.trim_end_matches([' ', '\t']);
            // The last of several statements goes with the `;` before it.
            let start = if is_followed || !lead.ends_with(';') { bytes.start } else { lead.len() - 1 };
            return Some(start..bytes.end + cut);
        }
        while let Some(above) = self.code.get(..start)?.strip_suffix('\n') {
            let line = above.rfind('\n').map_or(0, |at| at + 1);
            if !above.get(line..)?.trim_start().starts_with("///") {
                break;
            }
            start = line;
        }
        let end = bytes.end + (rest.len() + 1).min(after.len());
        // Between two blank lines nothing remains: one of them goes, too.
        let is_blank = |line: Option<&str>| line.is_none_or(|line| line.trim().is_empty());
        let above = self.code.get(..start)?.lines().next_back();
        let below = self.code.get(end..)?;
        let blank_below = below.find('\n').filter(|at| below[..*at].trim().is_empty()).map_or(0, |at| at + 1);
        let opens = above.is_some_and(|line| line.trim_end().ends_with('{'));
        Some(start..if is_blank(above) || opens { end + blank_below } else { end })
    }

    pub fn line_start(&self, byte: usize) -> usize {
        self.code.get(..byte).and_then(|before| before.rfind('\n')).map_or(0, |at| at + 1)
    }

    /// The blanks at the beginning of the line of an offset.
    pub fn indent(&self, byte: usize) -> &'t str {
        let line = self.code.get(self.line_start(byte)..).unwrap_or_default();
        &line[..line.len() - line.trim_start_matches([' ', '\t']).len()]
    }

    /// The insertion of a statement into the block of a kind around a range: the replaced range and its new text.
    pub fn insertion(&self, to: BlockKind, near: &Range<usize>, statement: &str) -> Option<(Range<usize>, String)> {
        let rules: &[Rule] = match to {
            BlockKind::Entity => &[Rule::entity, Rule::behavior],
            BlockKind::Mode => &[Rule::mode, Rule::always],
            BlockKind::World => &[Rule::world],
            BlockKind::Space => &[Rule::space],
            BlockKind::Tiles => &[Rule::tiles, Rule::map],
            BlockKind::Map => &[Rule::map],
            BlockKind::Test => &[Rule::test],
        };
        let owner = self.innermost(near, rules)?;
        self.insertion_in(owner, statement)
    }

    /// The insertion of a statement into the block of a node.
    pub fn insertion_in(&self, owner: &Node, statement: &str) -> Option<(Range<usize>, String)> {
        let blocks = [
            Rule::block,
            Rule::world_block,
            Rule::space_block,
            Rule::tile_block,
            Rule::kind_block,
            Rule::test_block,
            Rule::updates,
        ];
        let outer = self.indent(owner.bytes.start);
        let inner = format!("{outer}    ");
        let indented = statement.replace('\n', &format!("\n{inner}"));
        let Some(block) = self.inside(&owner.bytes).find(|node| blocks.contains(&node.rule)) else {
            // A map without a block.
            let is_map = owner.rule == Rule::map;
            return is_map.then(|| (owner.bytes.end..owner.bytes.end, format!(" {{\n{inner}{indented}\n{outer}}}")));
        };
        let open = block.bytes.start + self.code.get(block.bytes.clone())?.find('{')? + 1;
        let close = block.bytes.end.checked_sub(1)?;
        let inside = self.code.get(open..close)?;
        if inside.trim().is_empty() {
            return Some((open..close, format!("\n{inner}{indented}\n{outer}")));
        }
        let others = self.statements(&block.bytes);
        if !inside.contains('\n') {
            let end = open + inside.trim_end().len();
            return Some((end..end, format!("; {indented}")));
        }
        let word = first_word(statement);
        let rank = rank(owner.rule, word);
        let last = others.iter().rev().find(|node| self.rank(owner.rule, node) <= rank);
        let Some(last) = last else {
            let first = others.first().map(|node| first_word(self.code.get(node.bytes.clone()).unwrap_or_default()));
            let gap = if first.is_some_and(|first| is_same(first, word)) { "" } else { "\n" };
            return Some((open..open, format!("\n{inner}{indented}{gap}")));
        };
        let text = self.code.get(last.bytes.clone())?;
        let is_apart = statement.contains('\n') || text.contains('\n') || !is_same(first_word(text), word);
        let rest = self.code.get(last.bytes.end..)?;
        let end = last.bytes.end + rest.find(['\n', '}']).unwrap_or(rest.len());
        let indent = self.indent(last.bytes.start);
        let indented = statement.replace('\n', &format!("\n{indent}"));
        Some((end..end, format!("{}{indent}{indented}", if is_apart { "\n\n" } else { "\n" })))
    }

    fn rank(&self, owner: Rule, node: &Node) -> usize {
        rank(owner, first_word(self.code.get(node.bytes.clone()).unwrap_or_default()))
    }
}

/// The first word of a statement.
fn first_word(statement: &str) -> &str {
    statement.split(|c: char| !(c.is_alphanumeric() || c == '_')).next().unwrap_or_default()
}

/// Whether two statements belong together.
fn is_same(a: &str, b: &str) -> bool {
    let is_tile = |word: &str| word.is_empty();
    a == b || is_tile(a) && is_tile(b)
}

/// The place of a statement in the usual order of a block.
fn rank(owner: Rule, word: &str) -> usize {
    let block = match owner {
        Rule::entity => Block::Entity,
        Rule::behavior => Block::Behavior,
        Rule::world => Block::World,
        Rule::space => Block::Space,
        Rule::mode | Rule::always => Block::Mode,
        Rule::test => Block::Test,
        _ => Block::Other,
    };
    let order = usual_order(Some(block));
    let assignment = order.iter().position(|known| known.is_empty()).unwrap_or(order.len());
    order.iter().position(|known| *known == word).unwrap_or(assignment)
}
