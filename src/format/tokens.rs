//! The tokens of a text, from the grammar's pairs: which of them belong together, and where blanks are between them.

use pest::Token as Event;
use pest::iterators::Pairs;

use crate::syntax::Rule;

/// The kind of a token in the layout.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A word, a number, an operator.
    Word,
    /// `(`, or `{` of a domain.
    Open,
    /// `)`, or `}` of a domain.
    Close,
    /// `,`
    Comma,
    /// `{` of a block.
    BlockOpen,
    /// `}` of a block.
    BlockClose,
    /// An inline map, from quote to quote.
    Map,
}

/// A token.
#[derive(Debug, Clone, Copy)]
pub(super) struct Token<'t> {
    /// As written.
    pub text: &'t str,
    /// Its first byte.
    pub start: usize,
    /// Its rule in the grammar.
    pub rule: Rule,
    /// Its kind in the layout.
    pub kind: Kind,
    /// Whether a blank is before it if it does not begin a line.
    pub space: bool,
    /// Whether a statement begins with it.
    pub starts: bool,
    /// Of an opening bracket: where it is closed.
    pub partner: usize,
    /// Of an opening bracket: whether commas are inside.
    pub listed: bool,
}

impl Token<'_> {
    /// One past its last byte.
    pub fn end(&self) -> usize {
        self.start + self.text.len()
    }

    /// Whether a line break beside it is before it.
    pub fn leads(&self) -> bool {
        matches!(self.rule, Rule::kw_and | Rule::kw_or | Rule::arrow)
    }
}

/// The tokens of a text; none if some of it does not fit the grammar.
pub(super) fn tokens<'t>(text: &'t str, pairs: Pairs<'t, Rule>) -> Option<Vec<Token<'t>>> {
    let mut tokenizer =
        Tokenizer { text, tokens: Vec::new(), rules: Vec::new(), brackets: Vec::new(), starts: false, step: 0 };
    // The start of the last pair without inner pairs so far.
    let mut leaf = None;
    // The start of the current token, and the depth of its pairs.
    let mut whole: Option<(usize, usize)> = None;
    for event in pairs.tokens() {
        match event {
            Event::Start { rule, pos } => {
                if is_bad(rule) {
                    return None;
                } else if let Some((_, depth)) = &mut whole {
                    *depth += 1;
                } else if is_whole(rule) {
                    whole = Some((pos.pos(), 0));
                } else {
                    tokenizer.begin(rule);
                    leaf = Some(pos.pos());
                }
            }
            Event::End { rule, pos } => match &mut whole {
                Some((_, depth)) if *depth > 0 => *depth -= 1,
                Some((start, _)) => {
                    tokenizer.push(rule, *start, pos.pos());
                    (whole, leaf) = (None, None);
                }
                None => {
                    tokenizer.rules.pop();
                    if let Some(start) = leaf.take() {
                        tokenizer.push(rule, start, pos.pos());
                    }
                    if rule == Rule::step {
                        tokenizer.fraction();
                    }
                }
            },
        }
    }
    Some(tokenizer.tokens)
}

/// Whether a rule matches text that fits no other rule.
fn is_bad(rule: Rule) -> bool {
    matches!(
        rule,
        Rule::bad_item
            | Rule::bad_member
            | Rule::bad_update
            | Rule::bad_ramp
            | Rule::bad_world_item
            | Rule::bad_tile
            | Rule::bad_kind
            | Rule::bad_space_item
            | Rule::bad_setting
            | Rule::bad_test_item
    )
}

/// Whether a rule is one token with all its contents.
fn is_whole(rule: Rule) -> bool {
    matches!(
        rule,
        Rule::path
            | Rule::address
            | Rule::variable
            | Rule::number
            | Rule::text
            | Rule::tile_char
            | Rule::callee
            | Rule::map_text
            | Rule::name
    )
}

/// Whether a rule holds statements.
fn is_block(rule: Rule) -> bool {
    matches!(
        rule,
        Rule::file
            | Rule::block
            | Rule::updates
            | Rule::ramps
            | Rule::world_block
            | Rule::tile_block
            | Rule::kind_block
            | Rule::space_block
            | Rule::test_block
            | Rule::settings
    )
}

struct Tokenizer<'t> {
    text: &'t str,
    tokens: Vec<Token<'t>>,
    /// The pairs around, from the outside in.
    rules: Vec<Rule>,
    /// The brackets that are open.
    brackets: Vec<usize>,
    /// The next token begins a statement.
    starts: bool,
    /// Where the last `step` is.
    step: usize,
}

impl<'t> Tokenizer<'t> {
    fn begin(&mut self, rule: Rule) {
        let in_block = self.rules.last().is_some_and(|&r| is_block(r));
        self.starts |= in_block && !matches!(rule, Rule::open_brace | Rule::close_brace | Rule::EOI);
        if rule == Rule::step {
            self.step = self.tokens.len();
        }
        self.rules.push(rule);
    }

    fn push(&mut self, rule: Rule, start: usize, end: usize) {
        // The pairs of some symbols extend over adjacent blanks and comments.
        let (start, end) = match rule {
            Rule::end | Rule::EOI => return,
            Rule::colon | Rule::open_paren => (start, start + 1),
            Rule::close_paren => (end - 1, end),
            _ => (start, end),
        };
        let text = self.text.get(start..end).unwrap_or("").trim_end();
        if text.is_empty() {
            return;
        }
        let parent = self.rules.last().copied().unwrap_or(Rule::file);
        let kind = match rule {
            Rule::open_paren => Kind::Open,
            Rule::close_paren => Kind::Close,
            Rule::open_brace if parent == Rule::set_domain => Kind::Open,
            Rule::close_brace if parent == Rule::set_domain => Kind::Close,
            Rule::open_brace => Kind::BlockOpen,
            Rule::close_brace => Kind::BlockClose,
            Rule::comma => Kind::Comma,
            Rule::map_text => Kind::Map,
            _ => Kind::Word,
        };
        let space = self.tokens.last().is_some_and(|before| !is_tight(before, rule, kind, parent));
        let starts = std::mem::take(&mut self.starts);
        let here = self.tokens.len();
        match kind {
            Kind::Open | Kind::BlockOpen => self.brackets.push(here),
            Kind::Close | Kind::BlockClose => {
                if let Some(open) = self.brackets.pop().and_then(|open| self.tokens.get_mut(open)) {
                    open.partner = here;
                }
            }
            Kind::Comma => {
                if let Some(open) = self.brackets.last().and_then(|&open| self.tokens.get_mut(open)) {
                    open.listed = true;
                }
            }
            Kind::Word | Kind::Map => {}
        }
        self.tokens.push(Token { text, start, rule, kind, space, starts, partner: here, listed: false });
    }

    /// A step that is a fraction of two numbers is written without blanks: `1/60`.
    fn fraction(&mut self) {
        if let Some([_, above, by, below]) = self.tokens.get_mut(self.step..)
            && (above.rule, by.rule, below.rule) == (Rule::number, Rule::divided, Rule::number)
        {
            (by.space, below.space) = (false, false);
        }
    }
}

/// Whether no blank is between a token and the next.
fn is_tight(before: &Token<'_>, rule: Rule, kind: Kind, parent: Rule) -> bool {
    let opens = before.kind == Kind::Open;
    let binds =
        matches!(before.rule, Rule::negative | Rule::dash | Rule::range | Rule::caret | Rule::dimension_operator);
    let bound = match rule {
        Rule::comma
        | Rule::colon
        | Rule::dash
        | Rule::range
        | Rule::caret
        | Rule::exponent
        | Rule::dimension_operator => true,
        Rule::open_paren => match parent {
            Rule::call | Rule::shape | Rule::formals | Rule::actuals | Rule::signal_number | Rule::sent => true,
            Rule::rectangle => before.rule == Rule::word_rect,
            _ => false,
        },
        _ => kind == Kind::Close,
    };
    opens || binds || bound
}
