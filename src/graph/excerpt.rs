//! Excerpts of the source for labels: on one line, without comments, not too long.

use crate::source::{code_on_one_line, outside_quotes, without_comments};

/// The guard and the updates of `when GUARD -> TARGET { UPDATES }`.
pub(super) fn edge(text: &str) -> (String, Vec<String>) {
    let text = without_comments(text);
    let text = text.trim();
    let text = text.strip_prefix("when").unwrap_or(text);
    let guard_end = outside_quotes(text).find(|&(at, c)| c == '{' || text[at..].starts_with("->"));
    let guard = guard_end.and_then(|(at, _)| text.get(..at)).unwrap_or(text);
    let open = outside_quotes(text).find(|&(_, c)| c == '{').map(|(at, _)| at + 1);
    let updates = open.and_then(|at| text.get(at..)).map(|rest| rest.trim_end().trim_end_matches('}')).unwrap_or("");
    (code_on_one_line(guard), statements(updates))
}

/// The updates of a block, separated by line ends or `;`.
fn statements(block: &str) -> Vec<String> {
    let mut depth = 0i32;
    let mut cuts = vec![0];
    for (at, c) in outside_quotes(block) {
        match c {
            '(' => depth += 1,
            ')' => depth -= 1,
            ';' | '\n' if depth == 0 => cuts.push(at + 1),
            _ => {}
        }
    }
    cuts.push(block.len() + 1);
    let mut out: Vec<String> = Vec::new();
    for pair in cuts.windows(2) {
        let [from, to] = pair else { continue };
        let piece = code_on_one_line(block.get(*from..to - 1).unwrap_or(""));
        let begins = [":=", "+=", "-="].iter().any(|sign| piece.contains(sign))
            || piece.starts_with("spawn ")
            || piece.starts_with("destroy ");
        match out.last_mut() {
            // A long update continues on the next line.
            Some(last) if !begins && !piece.is_empty() => last.push_str(&format!(" {piece}")),
            _ if !piece.is_empty() => out.push(piece),
            _ => {}
        }
    }
    out
}

/// The beginning of a text, at most `most` characters; `…` marks an omission.
pub(super) fn short(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_string();
    }
    let kept: String = text.chars().take(most.saturating_sub(1)).collect();
    kept.trim_end().to_string() + "…"
}

/// A text in lines of limited length, broken between words; a longer word is cut.
pub(super) fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let word = short(word, width);
        if let Some(last) = lines.last_mut() {
            if last.is_empty() {
                *last = word;
            } else if last.chars().count() + 1 + word.chars().count() <= width {
                *last = format!("{last} {word}");
            } else {
                lines.push(word);
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_fall_apart_into_guard_and_updates() {
        let text = "when touching(\"a { // -> b\")\n    and x > 0 // why\n    -> b { x := 1; y := min(\n1, 2)\nz := x\n + 1\nspawn B }";
        let (guard, updates) = edge(text);
        assert_eq!(guard, "touching(\"a { // -> b\") and x > 0");
        assert_eq!(updates, ["x := 1", "y := min( 1, 2)", "z := x + 1", "spawn B"]);
        assert_eq!(edge("when a -> b"), ("a".to_string(), vec![]));
        assert_eq!(edge("when a { destroy self }"), ("a".to_string(), vec!["destroy self".to_string()]));
    }

    #[test]
    fn long_texts_are_cut_or_wrapped() {
        assert_eq!(short("abcdef", 4), "abc…");
        assert_eq!(wrapped("ab cd ef ghijkl", 5), ["ab cd", "ef", "ghij…"]);
    }
}
