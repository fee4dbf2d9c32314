//! From tokens to lines: what begins a line, and how far the line is indented. One pass over the tokens, with stacks of
//! open blocks and lists.

use crate::syntax::Rule;

use super::gap::{Comment, Gap, gap};
use super::lines::{Line, Lines, Piece, Slot};
use super::split::{Split, split};
use super::tokens::{Kind, Token};
use super::{INDENT, WIDTH};

/// Distance of tab stops, in columns.
const TAB: usize = 4;

/// The lines of a text.
pub(super) fn lines<'t>(text: &'t str, tokens: &[Token<'t>]) -> Lines<'t> {
    let mut layout = Layout {
        text,
        tokens,
        cursor: Cursor::default(),
        places: Vec::new(),
        out: Lines::default(),
        blocks: vec![Block { id: 0, indent: 0, one_line: false }],
        lists: Vec::new(),
        statement: 0,
        width: 0,
        opened: true,
        split: Split::Nowhere,
        known_blocks: 0,
    };
    layout.find_places();
    layout.run();
    layout.out
}

/// A block that is open.
#[derive(Clone, Copy)]
struct Block {
    id: usize,
    /// The indentation of its statements.
    indent: usize,
    one_line: bool,
}

/// A list that is open.
struct List {
    /// The indentation of the line with its bracket.
    indent: usize,
    /// Whether its bracket ends that line.
    broken: bool,
    /// Whether it has commas.
    listed: bool,
}

/// A line and a column of the text, both from 0.
#[derive(Clone, Copy, Default)]
pub(super) struct Place {
    pub line: usize,
    column: usize,
}

/// Converts byte offsets in ascending order to places.
#[derive(Default)]
struct Cursor {
    at: usize,
    place: Place,
}

impl Cursor {
    /// The place at an offset; tabs on the way lead to multiples of `tab`.
    fn advance(&mut self, text: &str, to: usize, tab: usize) -> Place {
        for c in text.get(self.at..to).unwrap_or("").chars() {
            match c {
                '\n' => self.place = Place { line: self.place.line + 1, column: 0 },
                '\t' => self.place.column = (self.place.column / tab + 1) * tab,
                _ => self.place.column += 1,
            }
        }
        self.at = to;
        self.place
    }
}

struct Layout<'t, 'k> {
    text: &'t str,
    tokens: &'k [Token<'t>],
    cursor: Cursor,
    /// The first and last place of each token.
    places: Vec<(Place, Place)>,
    out: Lines<'t>,
    blocks: Vec<Block>,
    lists: Vec<List>,
    /// The indentation of the statement.
    statement: usize,
    /// The width of the last line so far.
    width: usize,
    /// Whether the innermost block is still empty.
    opened: bool,
    split: Split,
    known_blocks: usize,
}

impl<'t> Layout<'t, '_> {
    fn find_places(&mut self) {
        self.places = Vec::with_capacity(self.tokens.len());
        for token in self.tokens {
            let start = self.cursor.advance(self.text, token.start, TAB);
            // Within a token, a tab is one column of its width.
            let end = self.cursor.advance(self.text, token.end(), 1);
            self.places.push((start, end));
        }
    }

    fn gap(&self, index: usize) -> Gap<'t> {
        let start = index.checked_sub(1).and_then(|i| self.tokens.get(i)).map_or(0, Token::end);
        gap(self.text, start, self.tokens.get(index).map_or(self.text.len(), |t| t.start))
    }

    fn run(&mut self) {
        // Comments and line breaks before a comma move after it.
        let mut carried = Gap::default();
        for (index, token) in self.tokens.iter().enumerate() {
            let mut gap = self.gap(index);
            if token.kind == Kind::Comma {
                carried.newline |= gap.newline;
                carried.comments.append(&mut gap.comments);
                self.piece(index);
                continue;
            }
            if !carried.comments.is_empty() {
                gap.comments.iter_mut().for_each(|c| c.trailing = false);
                carried.comments.append(&mut gap.comments);
                gap.comments = std::mem::take(&mut carried.comments);
            }
            gap.newline |= std::mem::take(&mut carried.newline);
            match token.kind {
                _ if token.starts => self.start(index, &gap),
                Kind::BlockOpen => self.open_block(index, &gap),
                Kind::BlockClose => self.close_block(index, &gap),
                _ => self.inside(index, &gap),
            }
            match token.kind {
                Kind::Open => {
                    let indent = self.out.lines.last().map_or(0, |l| l.indent);
                    self.lists.push(List { indent, broken: false, listed: token.listed });
                }
                Kind::Close => drop(self.lists.pop()),
                Kind::Map => self.map(token),
                _ => {}
            }
        }
        let gap = self.gap(self.tokens.len());
        self.comments(&gap.comments, 0, true);
    }

    // ---- lines and pieces -----------------------------------------------------------------------------------

    fn line(&mut self, indent: usize, blank: bool) -> &mut Line {
        let next = self.out.pieces.len();
        let line = Line { indent, pieces: next..next, blank, comment: false, block: None, source: (0, 0) };
        self.width = indent;
        self.out.lines.push(line);
        let last = self.out.lines.len() - 1;
        &mut self.out.lines[last]
    }

    fn push(&mut self, piece: Piece<'t>, line: usize) {
        let Some(last) = self.out.lines.last_mut() else { return };
        let first = last.pieces.is_empty();
        if first {
            last.source.0 = line;
        }
        last.source.1 = line;
        last.pieces.end += 1;
        self.width += piece.width + usize::from(piece.space && !first);
        self.out.pieces.push(piece);
    }

    /// Adds a token to the last line.
    fn piece(&mut self, index: usize) {
        let token = &self.tokens[index];
        let place = self.places[index].0;
        let before = index.checked_sub(1).map(|i| (self.tokens[i].end(), self.places[i].1));
        let blanks = before.filter(|(_, end)| end.line == place.line).map(|(end, at)| {
            let between = self.text.get(end..token.start).unwrap_or("");
            // After a `;` blanks are counted from there.
            between.rfind(';').map_or(place.column - at.column, |semicolon| between.len() - semicolon - 1)
        });
        let (text, width) = match token.kind {
            Kind::Map => ("\"", 1),
            _ => (token.text, token.text.chars().count()),
        };
        let slot = slot(token.rule);
        self.push(Piece { text, width, space: token.space, slot, column: place.column, blanks, pad: 0 }, place.line);
    }

    /// Comments before a piece with this indentation; comments on separate lines get the same.
    fn comments(&mut self, comments: &[Comment<'t>], indent: usize, blanks: bool) {
        for comment in comments {
            let first = std::mem::take(&mut self.opened);
            let width = comment.text.chars().count();
            let mut piece =
                Piece { text: comment.text, width, space: true, slot: Slot::Comment, column: 0, blanks: None, pad: 0 };
            let mut source = 0;
            if comment.trailing {
                let before = self.tokens.partition_point(|t| t.start < comment.start);
                if let Some(index) = before.checked_sub(1) {
                    let (end, at) = (self.tokens[index].end(), self.places[index].1);
                    let between = self.text.get(end..comment.start).unwrap_or("").len();
                    (piece.column, piece.blanks, source) = (at.column + between, Some(between), at.line);
                }
            } else {
                self.line(indent, blanks && comment.blank && !first).comment = true;
            }
            self.push(piece, source);
        }
    }

    // ---- statements and blocks ------------------------------------------------------------------------------

    fn block(&self) -> Block {
        self.blocks.last().copied().unwrap_or(Block { id: 0, indent: 0, one_line: false })
    }

    /// The first token of a statement.
    fn start(&mut self, index: usize, gap: &Gap<'t>) {
        let block = self.block();
        self.lists.clear();
        if block.one_line {
            self.separate(index);
            self.piece(index);
        } else {
            let first = self.opened && gap.comments.is_empty();
            self.comments(&gap.comments, block.indent, true);
            self.line(block.indent, gap.blank && !first).block = Some(block.id);
            self.piece(index);
            self.statement = block.indent;
            let stays = |offset| self.break_stays(index + offset);
            self.split = split(&self.tokens[index..], &self.places[index..], block.indent, stays);
        }
        self.opened = false;
    }

    /// Ends the statement before the one that begins here, in the same line.
    fn separate(&mut self, index: usize) {
        let before = index.checked_sub(1).map(|i| self.tokens[i].kind);
        if !matches!(before, Some(Kind::BlockOpen | Kind::BlockClose) | None) {
            let line = self.out.lines.last().map_or(0, |l| l.source.1);
            let slot = Slot::Mark(Rule::separator);
            self.push(Piece { text: ";", width: 1, space: false, slot, column: 0, blanks: None, pad: 0 }, line);
        }
    }

    fn open_block(&mut self, index: usize, gap: &Gap<'t>) {
        let around = self.block();
        self.comments(&gap.comments, self.statement, false);
        let goes_on = self.out.lines.last().is_some_and(|l| l.indent > self.statement);
        let own_line = !gap.comments.is_empty() || goes_on;
        let close = self.tokens[index].partner;
        let empty = close == index + 1 && self.gap(close).comments.is_empty();
        let written_so = self.places[index].0.line == self.places[close].0.line;
        let one_line = empty || around.one_line || (written_so && !own_line && self.fits(index, close));
        if own_line {
            self.line(self.statement, false);
        }
        self.piece(index);
        self.known_blocks += 1;
        self.blocks.push(Block { id: self.known_blocks, indent: self.statement + INDENT, one_line });
        self.opened = true;
    }

    fn close_block(&mut self, index: usize, gap: &Gap<'t>) {
        let block = self.block();
        if !block.one_line {
            self.comments(&gap.comments, block.indent, true);
            self.line(block.indent.saturating_sub(INDENT), false);
        }
        self.piece(index);
        self.blocks.pop();
        self.opened = false;
        self.statement = self.block().indent;
    }

    /// Whether the last line has room for the tokens from one to another.
    fn fits(&self, from: usize, to: usize) -> bool {
        let mut width = self.width;
        for (before, token) in self.tokens[from..=to].iter().enumerate().map(|(i, t)| (from + i, t)) {
            let after_brace = matches!(self.tokens[before.saturating_sub(1)].kind, Kind::BlockOpen | Kind::BlockClose);
            width += token.text.chars().count() + usize::from(token.space);
            width += usize::from(token.starts && !after_brace);
            if width > WIDTH {
                return false;
            }
        }
        true
    }

    // ---- inside a statement ---------------------------------------------------------------------------------

    /// Whether the author's line break before a token inside a statement is kept there or next to it.
    fn break_stays(&self, index: usize) -> bool {
        let (gap, token) = (self.gap(index), &self.tokens[index]);
        let opens = index.checked_sub(1).is_some_and(|i| self.tokens[i].kind == Kind::Open);
        let stays = token.kind == Kind::Comma || token.space || opens;
        gap.newline && (!gap.comments.is_empty() || (stays && token.kind != Kind::Close))
    }

    /// A token inside a statement.
    fn inside(&mut self, index: usize, gap: &Gap<'t>) {
        let token = &self.tokens[index];
        let before = index.checked_sub(1).map(|i| &self.tokens[i]);
        let commented = !gap.comments.is_empty();
        let opens = before.is_some_and(|b| b.kind == Kind::Open);
        let breaks = gap.newline || commented;
        if let Some(list) = self.lists.last_mut().filter(|_| opens) {
            list.broken = breaks;
        }
        let breaks = if token.kind == Kind::Close {
            commented || self.lists.last().is_some_and(|l| l.broken)
        } else if opens || commented {
            breaks
        } else if token.leads() {
            let after = self.gap(index + 1);
            let follows = after.newline && after.comments.is_empty();
            breaks || follows || (self.lists.is_empty() && self.split.is_before(token.rule))
        } else {
            breaks && token.space && !before.is_some_and(Token::leads)
        };
        if breaks {
            let after_item = before.is_some_and(|b| matches!(b.kind, Kind::Open | Kind::Comma));
            let (content, indent) = match self.lists.last() {
                None => (self.statement + INDENT, self.statement + INDENT),
                Some(list) if token.kind == Kind::Close => (list.indent + INDENT, list.indent),
                Some(list) => {
                    let deeper = list.broken && list.listed && !after_item;
                    let indent = list.indent + INDENT + if deeper { INDENT } else { 0 };
                    (indent, indent)
                }
            };
            self.comments(&gap.comments, content, false);
            self.line(indent, false);
        }
        self.piece(index);
    }

    /// The rows of a map and its closing quote. The opening one is the last piece.
    fn map(&mut self, token: &Token<'t>) {
        let indent = self.out.lines.last().map_or(0, |l| l.indent);
        let inner = token.text.trim_matches('"');
        let mut rows = inner.split('\n').map(|row| row.trim_matches([' ', '\t', '\r']));
        if let Some(comment) = rows.next().filter(|c| !c.is_empty()) {
            self.push(Piece { space: true, ..verbatim(comment.trim_end()) }, 0);
        }
        // The blanks before the closing quote are no row.
        let mut held: Option<&str> = None;
        for row in rows {
            if let Some(row) = held.replace(row) {
                self.row(indent, row);
            }
        }
        self.line(indent, false);
        let last = self.tokens.partition_point(|t| t.start <= token.start).saturating_sub(1);
        self.push(verbatim("\""), self.places[last].1.line);
    }

    fn row(&mut self, indent: usize, row: &'t str) {
        self.line(indent + INDENT, false);
        if !row.is_empty() {
            self.push(verbatim(row), 0);
        }
    }
}

/// A piece that is never aligned.
fn verbatim(text: &str) -> Piece<'_> {
    let slot = Slot::Mark(Rule::map_cells);
    Piece { text, width: text.chars().count(), space: false, slot, column: 0, blanks: None, pad: 0 }
}

fn slot(rule: Rule) -> Slot {
    match rule {
        Rule::negative => Slot::Sign,
        Rule::number
        | Rule::path
        | Rule::variable
        | Rule::name
        | Rule::text
        | Rule::callee
        | Rule::open_paren
        | Rule::kw_true
        | Rule::kw_false
        | Rule::kw_none
        | Rule::kw_self
        | Rule::kw_timer
        | Rule::kw_not
        | Rule::kw_in
        | Rule::word_any
        | Rule::word_all
        | Rule::word_nearest => Slot::Value,
        _ => Slot::Mark(rule),
    }
}
