//! A test that is written into the text of a program: the end of a world's block gets it, and nothing else changes.

use crate::source::FileId;
use crate::syntax::{self, ast::Item};

/// Maximum number of columns of a line of inputs.
const WIDTH: usize = 100;

/// A test to write: inputs, and a predicate that holds after them.
#[derive(Debug, Clone, Copy)]
pub struct Recorded<'a> {
    /// The world.
    pub world: &'a str,
    /// The name of the test.
    pub test: &'a str,
    /// The input script.
    pub inputs: &'a str,
    /// The seed of what nature draws.
    pub seed: Option<u64>,
    /// The predicate, or the name of a goal.
    pub predicate: &'a str,
}

/// The text with the test at the end of its world; `None` if the text has no such world, or a name or a script that no
/// text in quotes can hold.
pub fn insert_test(text: &str, test: &Recorded<'_>) -> Option<String> {
    if [test.test, test.inputs].iter().any(|quoted| quoted.contains(['"', '\n', '\r'])) || test.test.trim().is_empty() {
        return None;
    }
    let (tree, _) = syntax::parse(FileId(0), text);
    let world = tree.items.iter().find_map(|item| match item {
        Item::World(world) if world.name.text == test.world => Some(world),
        _ => None,
    })?;
    let brace = world.span.range().end.checked_sub(1).filter(|at| text.get(*at..=*at) == Some("}"))?;
    let end = if text.split_inclusive('\n').next().is_some_and(|line| line.ends_with("\r\n")) { "\r\n" } else { "\n" };
    let before = text.get(..brace)?.trim_end_matches([' ', '\t']);
    let is_own_line = before.ends_with('\n');
    let at = if is_own_line { before.len() } else { brace };
    let last = before.lines().next_back().unwrap_or_default().trim();
    let mut lines = Vec::new();
    if is_own_line && !last.is_empty() && !last.ends_with('{') {
        lines.push(String::new());
    }
    lines.push(format!("    test \"{}\" {{", test.test));
    lines.extend(test.seed.map(|seed| format!("        chance seed {seed}")));
    lines.extend(input_lines(test.inputs));
    lines.push(format!("        expect {} at end", test.predicate));
    lines.push("    }".to_string());
    let mut out = text.get(..at)?.to_string();
    if !is_own_line {
        out.push_str(end);
    }
    for line in lines {
        out.push_str(&line);
        out.push_str(end);
    }
    out.push_str(text.get(at..)?);
    Some(out)
}

/// The script as lines of a test.
fn input_lines(script: &str) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    for word in script.split_whitespace() {
        if !line.is_empty() && line.len() + 1 + word.len() > WIDTH {
            lines.push(std::mem::take(&mut line));
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(word);
    }
    lines.extend((!line.is_empty()).then_some(line));
    lines.iter().map(|line| format!("        inputs \"{line}\"")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEST: Recorded<'_> =
        Recorded { world: "W", test: "it arrives", inputs: "right*40 -*3", seed: None, predicate: "exit" };

    #[test]
    fn a_test_is_the_last_part_of_its_world() {
        let text = "world V {\n}\n\nworld W {\n    step 1/60\n}\n";
        let expected = "world V {\n}\n\nworld W {\n    step 1/60\n\n    test \"it arrives\" {\n        \
                        inputs \"right*40 -*3\"\n        expect exit at end\n    }\n}\n";
        assert_eq!(insert_test(text, &TEST).as_deref(), Some(expected));
        assert_eq!(insert_test(text, &Recorded { world: "X", ..TEST }), None);
        assert_eq!(insert_test(text, &Recorded { test: "a \"b\"", ..TEST }), None);
        let windows = text.replace('\n', "\r\n");
        assert_eq!(insert_test(&windows, &TEST), Some(expected.replace('\n', "\r\n")));
    }

    #[test]
    fn long_scripts_have_several_lines() {
        let script = "right*40 jump*12 ".repeat(20);
        let lines = input_lines(&script);
        assert!(lines.len() > 2 && lines.iter().all(|line| line.len() <= 120), "{lines:?}");
        let joined: Vec<&str> = lines.iter().filter_map(|line| line.split('"').nth(1)).collect();
        assert_eq!(joined.join(" "), script.trim_end());
    }
}
