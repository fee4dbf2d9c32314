//! Refactorings that write a condition as its negation: `not (a and b)` as `not a or not b`, the two cases of `when` and
//! `else` exchanged, the two values of an `if` exchanged.

use std::ops::Range;
use std::path::Path;

use crate::syntax::Rule;

use super::blocks::{Blocks, Node};
use super::draft::Draft;
use super::{ActionKind, Candidate};

/// The rewritings at a range.
pub(super) fn candidates(path: &Path, blocks: &Blocks<'_>, bytes: &Range<usize>) -> Vec<Candidate> {
    let rewriting = Rewriting { path, blocks };
    [rewriting.push_in(bytes), rewriting.exchange_edges(bytes), rewriting.exchange_values(bytes)]
        .into_iter()
        .flatten()
        .collect()
}

struct Rewriting<'a> {
    path: &'a Path,
    blocks: &'a Blocks<'a>,
}

/// The operators of comparisons, each with its opposite.
const OPPOSITES: [(Rule, &str); 6] = [
    (Rule::equal, "!="),
    (Rule::unequal, "=="),
    (Rule::below, ">="),
    (Rule::at_least, "<"),
    (Rule::above, "<="),
    (Rule::at_most, ">"),
];

impl Rewriting<'_> {
    fn text(&self, at: &Range<usize>) -> &str {
        self.blocks.code.get(at.clone()).unwrap_or_default()
    }

    fn candidate(&self, title: &str, edits: Vec<(Range<usize>, String)>) -> Candidate {
        let mut draft = Draft::default();
        for (at, new) in edits {
            draft.edit(self.path, at, new);
        }
        Candidate { title: title.into(), kind: ActionKind::Rewrite, keeps_program: false, draft }
    }

    /// `not (a and b)` as `not a or not b`
    fn push_in(&self, bytes: &Range<usize>) -> Option<Candidate> {
        let paren = self.blocks.innermost(bytes, &[Rule::paren]).or_else(|| {
            // The cursor is at the `not`.
            let not = self.blocks.innermost(bytes, &[Rule::kw_not])?;
            let rest = self.blocks.code.get(not.bytes.end..)?;
            let start = not.bytes.end + (rest.len() - rest.trim_start().len());
            self.blocks.around(&(start..start + 1)).find(|node| node.rule == Rule::paren && node.bytes.start == start)
        })?;
        let before = self.blocks.code.get(..paren.bytes.start)?.trim_end();
        let not = before.strip_suffix("not").filter(|rest| rest.ends_with(|c: char| !c.is_alphanumeric() && c != '_'))?;
        let inside = self.blocks.inside(&paren.bytes).find(|node| node.rule == Rule::expression)?;
        let negated = self.negated(inside)?;
        let at = not.len()..paren.bytes.end;
        // Beside another operator it stays in parentheses.
        let around = self.blocks.around(&at).find(|node| node.rule == Rule::expression)?;
        let is_alone = self.text(&around.bytes).trim().len() == at.len();
        let new = if is_alone { negated } else { format!("({negated})") };
        Some(self.candidate("move the `not` inside", vec![(at, new)]))
    }

    /// The cases of `when a -> b` and `else -> c` exchanged.
    fn exchange_edges(&self, bytes: &Range<usize>) -> Option<Candidate> {
        let edge = self.blocks.innermost(bytes, &[Rule::edge])?;
        let block = self.blocks.innermost(&edge.bytes, &[Rule::block])?;
        let all = self.blocks.statements(&block.bytes);
        let index = all.iter().position(|node| node.bytes == edge.bytes)?;
        let is_else = |node: &Node| node.rule == Rule::edge && self.text(&node.bytes).starts_with("else");
        let (when, other) = match is_else(edge) {
            true => (*all.get(index.checked_sub(1)?)?, edge),
            false => (edge, *all.get(index + 1)?),
        };
        if when.rule != Rule::edge || is_else(when) || !is_else(other) {
            return None;
        }
        let guard = self.blocks.inside(&when.bytes).find(|node| node.rule == Rule::expression)?;
        let guard_end = guard.bytes.start + self.text(&guard.bytes).trim_end().len();
        let negated = self.negated(guard)?;
        let (rest, other_rest) = (guard_end..when.bytes.end, other.bytes.start + "else".len()..other.bytes.end);
        let edits = vec![
            (guard.bytes.start..guard_end, negated),
            (rest.clone(), self.text(&other_rest).to_string()),
            (other_rest, self.text(&rest).to_string()),
        ];
        Some(self.candidate("exchange `when` and `else`", edits))
    }

    /// `if(c, a, b)` as `if(not c, b, a)`
    fn exchange_values(&self, bytes: &Range<usize>) -> Option<Candidate> {
        let call = self.blocks.innermost(bytes, &[Rule::call])?;
        self.text(&call.bytes).strip_prefix("if")?.trim_start().strip_prefix('(')?;
        let arguments: Vec<&Node> = self.arguments(call);
        let [condition, a, b] = arguments[..] else { return None };
        let inside = self.blocks.inside(&condition.bytes).find(|node| node.rule == Rule::expression)?;
        let edits = vec![
            (condition.bytes.clone(), self.negated(inside)?),
            (a.bytes.clone(), self.text(&b.bytes).to_string()),
            (b.bytes.clone(), self.text(&a.bytes).to_string()),
        ];
        Some(self.candidate("exchange the values of `if`", edits))
    }

    /// The arguments of a call, without those of calls inside of it.
    fn arguments(&self, call: &Node) -> Vec<&Node> {
        let mut out: Vec<&Node> = Vec::new();
        for node in self.blocks.inside(&call.bytes).filter(|node| node.rule == Rule::argument) {
            if out.last().is_none_or(|last| last.bytes.end <= node.bytes.start) {
                out.push(node);
            }
        }
        out
    }

    /// The negation of an expression; `None` if it binds a name, which a negation does not, or holds a comment.
    fn negated(&self, expression: &Node) -> Option<String> {
        let binds = self.blocks.inside(&expression.bytes).any(|node| node.rule == Rule::binding);
        if binds || self.text(&expression.bytes).contains("//") {
            return None;
        }
        let parts = self.parts(expression);
        Some(self.negated_parts(&parts))
    }

    /// The operands and operators directly in an expression.
    fn parts(&self, expression: &Node) -> Vec<&Node> {
        let mut out: Vec<&Node> = Vec::new();
        for node in self.blocks.inside(&expression.bytes).filter(|node| node.rule != Rule::expression) {
            if out.last().is_none_or(|last| last.bytes.end <= node.bytes.start) {
                out.push(node);
            }
        }
        out
    }

    fn whole(&self, parts: &[&Node]) -> Range<usize> {
        let start = parts.first().map_or(0, |node| node.bytes.start);
        start..parts.last().map_or(start, |node| node.bytes.end)
    }

    fn negated_parts(&self, parts: &[&Node]) -> String {
        let text = || self.text(&self.whole(parts)).trim();
        for (operator, other) in [(Rule::kw_or, "and"), (Rule::kw_and, "or")] {
            let operands: Vec<&[&Node]> = parts.split(|node| node.rule == operator).collect();
            if operands.len() < 2 {
                continue;
            }
            let negated = operands.into_iter().map(|operand| {
                let negated = self.negated_parts(operand);
                // A negated `and` is an `or`, which binds less than the `and` around.
                let is_or = other == "and" && operand.iter().any(|node| node.rule == Rule::kw_and);
                if is_or { format!("({negated})") } else { negated }
            });
            return negated.collect::<Vec<_>>().join(&format!(" {other} "));
        }
        if let [not, rest @ ..] = parts
            && not.rule == Rule::kw_not
        {
            let inner = self.text(&self.whole(rest)).trim();
            let is_one = rest.len() == 1 && inner.starts_with('(') && inner.ends_with(')');
            return if is_one { self.without_parentheses(rest[0]) } else { inner.to_string() };
        }
        let comparisons: Vec<usize> = (0..parts.len()).filter(|at| opposite(parts[*at].rule).is_some()).collect();
        match (comparisons.as_slice(), parts) {
            ([at], _) => {
                let (left, right) = (self.whole(&parts[..*at]), self.whole(&parts[at + 1..]));
                let operator = opposite(parts[*at].rule).unwrap_or_default();
                format!("{} {operator} {}", self.text(&left).trim(), self.text(&right).trim())
            }
            ([], [only]) => match text() {
                "true" => "false".into(),
                "false" => "true".into(),
                text if text.starts_with('(') => match self.inside_of(only) {
                    Some(inside) => self.negated_parts(&self.parts(inside)),
                    None => format!("not {text}"),
                },
                text => format!("not {text}"),
            },
            _ => format!("not ({})", text()),
        }
    }

    /// The expression in parentheses.
    fn inside_of(&self, primary: &Node) -> Option<&Node> {
        let paren = self.blocks.inside(&primary.bytes).find(|node| node.rule == Rule::paren)?;
        self.blocks.inside(&paren.bytes).find(|node| node.rule == Rule::expression)
    }

    /// An operand without its parentheses, if it is one comparison or one name.
    fn without_parentheses(&self, primary: &Node) -> String {
        let text = self.text(&primary.bytes).trim();
        let Some(inside) = self.inside_of(primary) else { return text.to_string() };
        let joins = self.parts(inside).iter().any(|node| matches!(node.rule, Rule::kw_and | Rule::kw_or));
        if joins { text.to_string() } else { self.text(&inside.bytes).trim().to_string() }
    }
}

fn opposite(rule: Rule) -> Option<&'static str> {
    OPPOSITES.iter().find(|(known, _)| *known == rule).map(|(_, opposite)| *opposite)
}
