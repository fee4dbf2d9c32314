//! Refactorings that write a condition as its negation: `not (a and b)` as `not a or not b`, the two cases of `when` and
//! `else` exchanged, the two values of an `if` exchanged. Each negation is verified for all answers to its questions.

use std::ops::Range;
use std::path::Path;

use crate::source::FileId;
use crate::syntax::ast::{BinaryOp, CompareOp, Expr, ExprKind};
use crate::syntax::{self, Rule};

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
        let not =
            before.strip_suffix("not").filter(|rest| rest.ends_with(|c: char| !c.is_alphanumeric() && c != '_'))?;
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
        self.blocks.children(call).into_iter().filter(|node| node.rule == Rule::argument).collect()
    }

    /// The negation of an expression; `None` if it binds a name, which a negation does not, or holds a comment.
    fn negated(&self, expression: &Node) -> Option<String> {
        let binds = self.blocks.inside(&expression.bytes).any(|node| node.rule == Rule::binding);
        if binds || self.text(&expression.bytes).contains("//") {
            return None;
        }
        let negated = self.negated_parts(&self.blocks.children(expression));
        is_negation(self.text(&expression.bytes).trim(), &negated).then_some(negated)
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
                    Some(inside) => self.negated_parts(&self.blocks.children(inside)),
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
        let joins = self.blocks.children(inside).iter().any(|node| matches!(node.rule, Rule::kw_and | Rule::kw_or));
        if joins { text.to_string() } else { self.text(&inside.bytes).trim().to_string() }
    }
}

/// Maximum number of different questions in an expression that is negated.
const MAX_ATOMS: usize = 10;

/// Whether one text is the negation of another for all answers to the questions in them.
fn is_negation(text: &str, negated: &str) -> bool {
    let parsed = |text| syntax::parse_predicate(FileId(0), text).0;
    let (Some(a), Some(b)) = (parsed(text), parsed(negated)) else { return false };
    let mut atoms: Vec<String> = Vec::new();
    collect_atoms(&a, text, &mut atoms);
    collect_atoms(&b, negated, &mut atoms);
    let all = 1_u32.checked_shl(atoms.len() as u32).unwrap_or(0);
    atoms.len() <= MAX_ATOMS
        && (0..all).all(|answers| value(&a, text, &atoms, answers) != value(&b, negated, &atoms, answers))
}

/// A question without an operator that joins others, and whether its answer is the opposite one.
fn atom(e: &Expr, text: &str) -> (String, bool) {
    let shown = |e: &Expr| {
        let words = text.get(e.span.range()).unwrap_or_default().split_whitespace();
        words.collect::<Vec<_>>().join(" ")
    };
    match &e.kind {
        ExprKind::Compare(operator, sides) => {
            let (operator, is_opposite) = match operator {
                CompareOp::Less => ("<", false),
                CompareOp::AtLeast => ("<", true),
                CompareOp::AtMost => ("<=", false),
                CompareOp::Greater => ("<=", true),
                CompareOp::Equal => ("==", false),
                CompareOp::Unequal => ("==", true),
            };
            (format!("{} {operator} {}", shown(&sides[0]), shown(&sides[1])), is_opposite)
        }
        _ => (shown(e), false),
    }
}

fn collect_atoms(e: &Expr, text: &str, atoms: &mut Vec<String>) {
    match &e.kind {
        ExprKind::Paren(inner) | ExprKind::Not(inner) => collect_atoms(inner, text, atoms),
        ExprKind::Binary(BinaryOp::And | BinaryOp::Or, sides) => {
            sides.iter().for_each(|side| collect_atoms(side, text, atoms));
        }
        ExprKind::Bool(_) => {}
        _ => {
            let (atom, _) = atom(e, text);
            if !atoms.contains(&atom) {
                atoms.push(atom);
            }
        }
    }
}

/// The value of an expression for answers to its questions, one bit each.
fn value(e: &Expr, text: &str, atoms: &[String], answers: u32) -> bool {
    let of = |e: &Expr| value(e, text, atoms, answers);
    match &e.kind {
        ExprKind::Paren(inner) => of(inner),
        ExprKind::Not(inner) => !of(inner),
        ExprKind::Binary(BinaryOp::And, sides) => of(&sides[0]) && of(&sides[1]),
        ExprKind::Binary(BinaryOp::Or, sides) => of(&sides[0]) || of(&sides[1]),
        ExprKind::Bool(value) => *value,
        _ => {
            let (atom, is_opposite) = atom(e, text);
            let at = atoms.iter().position(|known| *known == atom).unwrap_or_default();
            (answers >> at & 1 == 1) != is_opposite
        }
    }
}

fn opposite(rule: Rule) -> Option<&'static str> {
    OPPOSITES.iter().find(|(known, _)| *known == rule).map(|(_, opposite)| *opposite)
}
