//! Explains syntax errors: a part that matched no rule is parsed again with the expected rule, and pest's furthest
//! failure becomes a diagnostic.

use std::borrow::Cow;
use std::ops::Range;

use pest::Parser;
use pest::error::{ErrorVariant, InputLocation};

use crate::diagnostic::catalogue::syntax::Unexpected;
use crate::diagnostic::{only_similar, similar};
use crate::source::Span;

use super::keyword::{keyword, opening_keywords};
use super::likely_fix::{Failure, likely_fix};
use super::{Grammar, Rule};

/// Explains why `text[from..to]` does not parse as `rule`; `span` maps bytes of `text` to source spans.
pub(super) fn explain(
    rule: Rule,
    text: &str,
    from: usize,
    to: usize,
    span: &dyn Fn(usize, usize) -> Span,
) -> Unexpected {
    let slice = text.get(from..to).unwrap_or("");
    let trimmed = slice.trim_end();
    let (offset, expected) = match Grammar::parse(rule, trimmed) {
        Ok(_) => (0, Vec::new()),
        Err(error) => {
            let at = match error.location {
                InputLocation::Pos(at) | InputLocation::Span((at, _)) => at,
            };
            let expected = match error.variant {
                ErrorVariant::ParsingError { positives, .. } => words(&positives),
                ErrorVariant::CustomError { .. } => Vec::new(),
            };
            (at.min(trimmed.len()), expected)
        }
    };
    // Skip white space before the wrong token.
    let tail = trimmed.get(offset..).unwrap_or("");
    let at = from + offset + (tail.len() - tail.trim_start().len());
    let found = if offset < trimmed.len() { token_at(text, at) } else { "" };
    let end_of_statement = found.is_empty();
    let at_span = if end_of_statement {
        let last = from + trimmed.char_indices().next_back().map_or(0, |(i, _)| i);
        span(last, from + trimmed.len())
    } else {
        span(at, at + found.len())
    };
    let failed =
        Failure { rule, slice: trimmed, at: at.saturating_sub(from).min(trimmed.len()), found, expected: &expected };
    let fix = likely_fix(&failed, opening_words(rule));
    let help = fix.as_ref().map(|fix| fix.help.clone());
    let is_first = fix.as_ref().is_some_and(|fix| fix.is_first);
    let meant = fix.and_then(|fix| fix.replacement).filter(|(range, text)| is_certain(&failed, range, text));
    let meant = meant.map(|(range, text)| (span(from + range.start, from + range.end), text));
    if is_first {
        let first = token_at(text, from);
        let found = Some(first.to_string());
        return Unexpected { at: span(from, from + first.len()), found, expected: Vec::new(), help, meant };
    }
    Unexpected { at: at_span, found: (!end_of_statement).then(|| found.to_string()), expected, help, meant }
}

/// Whether a fix is certain: with it the statement parses, or at least parses further.
fn is_certain(failed: &Failure<'_>, range: &Range<usize>, text: &str) -> bool {
    let (rule, slice) = (failed.rule, failed.slice);
    let (Some(before), Some(was), Some(after)) =
        (slice.get(..range.start), slice.get(range.clone()), slice.get(range.end..))
    else {
        return false;
    };
    // With several similar words, the intended one is unknown.
    let words = || opening_words(rule).iter().copied();
    if range.start == 0 && similar(was, words()).is_some() && only_similar(was, words()).is_none() {
        return false;
    }
    if text == "//" {
        return before.trim().is_empty() || reads_to(rule, before).is_none();
    }
    reads_to(rule, &format!("{before}{text}{after}")).is_none_or(|to| range.start > 0 && to > range.start + text.len())
}

/// The position up to which a part parses as a rule; `None` if all of it does.
fn reads_to(rule: Rule, slice: &str) -> Option<usize> {
    Grammar::parse(rule, slice).err().map(|error| match error.location {
        InputLocation::Pos(at) | InputLocation::Span((at, _)) => at,
    })
}

/// The words that can start a rule.
fn opening_words(rule: Rule) -> &'static [&'static str] {
    opening_keywords(match rule {
        Rule::only_item => "good_item",
        Rule::only_member => "good_member",
        Rule::only_update => "good_update",
        Rule::only_world_item => "good_world_item",
        Rule::only_space_item => "good_space_item",
        Rule::only_ramp => "good_ramp",
        Rule::only_test_item => "good_test_item",
        _ => return &[],
    })
}

/// The token that starts at `at`, empty at the end of a line or of the text.
fn token_at(text: &str, at: usize) -> &str {
    let rest = text.get(at..).unwrap_or("");
    let first = match rest.chars().next() {
        None | Some('\n' | '\r') => return "",
        Some(c) => c,
    };
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let length = if is_word(first) {
        rest.find(|c| !is_word(c)).unwrap_or(rest.len())
    } else {
        // Includes tokens of other languages, so that they are not split.
        ["->", ":=", "==", "!=", "<=", ">=", "''", "..", "&&", "||", "=>", "+=", "-=", "*=", "/=", "++", "--"]
            .iter()
            .find(|t| rest.starts_with(**t))
            .map_or(first.len_utf8(), |t| t.len())
    };
    rest.get(..length).unwrap_or("")
}

/// Names of the rules expected at an error, by importance, without duplicates.
fn words(rules: &[Rule]) -> Vec<String> {
    let mut words: Vec<Cow<'static, str>> = Vec::new();
    let mut add = |word: Cow<'static, str>| {
        if !words.contains(&word) {
            words.push(word);
        }
    };
    let has = |rule: Rule| rules.contains(&rule);
    let is_number = |rule: &Rule| matches!(rule, Rule::number | Rule::digits);
    // Where only a number fits, an expression does not.
    let starts_expression = has(Rule::expression)
        || has(Rule::primary)
        || rules.iter().any(is_number) && rules.iter().any(|rule| !is_number(rule) && starts_an_expression(*rule));
    let is_operator = |rule: &Rule| {
        use Rule::{
            above, at_least, at_most, below, divided, dot, equal, kw_and, kw_is, kw_or, minus, plus, primes, relation,
            relation_in, relation_is, relation_touching, times, unequal, unit, word_touching,
        };
        matches!(
            rule,
            plus | minus
                | times
                | divided
                | equal
                | unequal
                | at_most
                | at_least
                | below
                | above
                | kw_and
                | kw_or
                | relation
                | relation_in
                | relation_is
                | relation_touching
                | kw_is
                | word_touching
                | primes
                | unit
                | dot
        )
    };
    let in_list = has(Rule::comma) || has(Rule::close_paren) || (has(Rule::plus) && !starts_expression);
    for rule in rules {
        // After a name a call or an offset is possible, but rarely intended.
        if in_list && matches!(rule, Rule::open_paren | Rule::moved | Rule::word_at) {
            continue;
        }
        if starts_expression && starts_an_expression(*rule) {
            add("an expression".into());
        } else if is_operator(rule) || (*rule == Rule::kw_in && has(Rule::kw_is)) {
            continue;
        } else if let Some(word) = word(*rule) {
            add(word);
        }
    }
    if rules.iter().any(is_operator) && !starts_expression {
        add("an operator".into());
    }
    words.into_iter().map(Cow::into_owned).collect()
}

fn starts_an_expression(rule: Rule) -> bool {
    use Rule::{
        any_instance, argument, call, callee, digits, expression, in_mode, kw_clamp, kw_false, kw_if, kw_in, kw_none,
        kw_not, kw_self, kw_timer, kw_true, name, nearest, negative, number, open_paren, paren, path, primary, text,
        word_all, word_any, word_nearest,
    };
    matches!(
        rule,
        expression
            | number
            | digits
            | primary
            | call
            | callee
            | in_mode
            | any_instance
            | nearest
            | word_nearest
            | kw_timer
            | path
            | paren
            | text
            | kw_true
            | kw_false
            | kw_none
            | kw_self
            | kw_if
            | kw_clamp
            | kw_in
            | kw_not
            | negative
            | name
            | open_paren
            | word_any
            | word_all
            | argument
    )
}

/// The name of a rule in messages.
fn word(rule: Rule) -> Option<Cow<'static, str>> {
    use Rule as R;
    let word = match rule {
        R::EOI | R::end => "the end of the statement",
        R::name | R::variable | R::path => "a name",
        R::tag | R::tags => "a tag",
        R::text => "a text in quotes",
        R::map_text => "a map (`\"` at the end of the line, the rows, `\"` on a line of its own)",
        R::number | R::digits => "a number",
        R::open_brace
        | R::block
        | R::world_block
        | R::space_block
        | R::tile_block
        | R::kind_block
        | R::ramps
        | R::test_block => "`{`",
        R::close_brace => "`}`",
        R::open_paren | R::point | R::position => "`(`",
        R::close_paren => "`)`",
        R::comma => "`,`",
        R::colon | R::annotation => "`:`",
        R::assign => "`=`",
        R::becomes => "`:=`",
        R::increase => "`+=`",
        R::decrease => "`-=`",
        R::arrow | R::target => "`->`",
        R::range => "`..`",
        R::domain | R::int_domain | R::set_domain | R::bool_domain => "`int LOW..HIGH`, `bool` or `{a, b, c}`",
        R::shape => "a shape such as `rect(x, y, width, height)`",
        R::rate => "`accel`, `over` or `instant`",
        R::response => "`block` or `sense`",
        R::tile_char => "a tile's character in quotes such as `'#'`",
        R::settings | R::updates => "`{`",
        R::rectangle => "`(x, y, width, height)`",
        R::formals | R::actuals => "`(`",
        R::within => "`in LOW..HIGH`",
        R::dash => "`-`",
        R::wrap_way => "`horizontal` or `vertical`",
        R::dimension => "a dimension such as `px/s`",
        R::moment => "`at TIME`, `by TIME`, `at end`, `by end`, `always` or `never`",
        rule => return statement_word(rule).map(|word| format!("`{word}`").into()),
    };
    Some(word.into())
}

/// The keyword of a rule, or the first keyword of a statement.
fn statement_word(rule: Rule) -> Option<&'static str> {
    use Rule as R;
    let is_statement = matches!(
        rule,
        R::import
            | R::constant
            | R::entity
            | R::behavior
            | R::world
            | R::parameter
            | R::edge
            | R::destroy
            | R::send
            | R::decay
            | R::attack
            | R::sustain
            | R::release
            | R::driven_while
            | R::step
            | R::collide
            | R::tiles
            | R::space
            | R::limit
            | R::player
            | R::goal
            | R::condition
            | R::signals
            | R::chance
            | R::never
            | R::map
            | R::place
            | R::solid
            | R::bounds
            | R::wrap
            | R::link
            | R::legend
            | R::test
            | R::given
            | R::expect
    );
    match rule {
        R::mode => Some("mode"),
        R::spawn => Some("spawn"),
        R::kw_mode | R::kw_when | R::kw_collider | R::kw_spawn | R::kw_destroy | R::kw_self => keyword(rule),
        R::word_by | R::word_with | R::word_at | R::word_x | R::word_links | R::word_tile | R::word_after => {
            keyword(rule)
        }
        R::word_end | R::word_seed | R::word_from => keyword(rule),
        R::without => Some("without"),
        R::deadline => Some("within"),
        R::slope => Some("slope"),
        R::breakable => Some("breakable"),
        _ if is_statement => opening_keywords(&format!("{rule:?}")).first().copied(),
        _ => None,
    }
}
