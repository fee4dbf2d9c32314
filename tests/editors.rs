//! One source for the keywords: the grammars for editors have exactly those of `grammar/hyped.pest` and the built-in
//! functions. The tests in `editors/` check where they apply.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeSet;

use serde_json::Value;

type Words = BTreeSet<String>;

fn read(path: &str) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// The texts between double quotes, in a text with backslash escapes. `unescape` keeps only the escaped character, as
/// in a string's value; letters such as the `n` of a line break are dropped.
fn quoted(text: &str, unescape: bool) -> Vec<String> {
    let mut found = Vec::new();
    let mut open: Option<String> = None;
    let mut chars = text.chars();
    while let Some(c) = chars.next() {
        match (&mut open, c) {
            (Some(string), '\\') => {
                let next = chars.next().expect("something after a backslash");
                if !unescape {
                    string.extend(['\\', next]);
                } else if !next.is_alphanumeric() {
                    string.push(next);
                }
            }
            (Some(_), '"') => found.extend(open.take()),
            (Some(string), _) => string.push(c),
            (None, '"') => open = Some(String::new()),
            (None, _) => {}
        }
    }
    found
}

fn words(list: impl IntoIterator<Item = String>) -> Words {
    list.into_iter().collect()
}

fn is_word(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic()) && text.chars().all(|c| c.is_ascii_alphanumeric())
}

/// The bodies of the grammar's rules whose names have a prefix.
fn rules(beginning: &str) -> Words {
    let grammar = read("grammar/hyped.pest");
    words(grammar.lines().filter(|line| line.starts_with(beginning)).flat_map(|line| quoted(line, false)))
}

/// The reserved words, the contextual keywords, and the units after numbers.
fn reserved() -> Words {
    rules("kw_")
}

fn contextual() -> Words {
    rules("word_")
}

fn units() -> Words {
    rules("unit ")
}

/// The built-in functions, which are not in the grammar: from the message about a misspelt one.
fn functions() -> Words {
    let checker = read("src/sema/call.rs");
    let (_, list) = checker.split_once("FUNCTIONS: &[&str] = &[").expect("the checker's list of functions");
    words(quoted(list.split_once(']').unwrap().0, false))
}

fn all(sets: &[Words]) -> Words {
    sets.iter().flatten().cloned().collect()
}

/// The words in a regular expression: runs of letters and digits, but for classes and what backslashes make of a letter.
/// `long` are the characters that make an escape longer by one: `\zs`, `\_s`.
fn words_of_pattern(pattern: &str, long: &[char], found: &mut Words) {
    let mut rest = pattern;
    let mut word = String::new();
    while let Some(c) = rest.chars().next() {
        let mut length = c.len_utf8();
        let class = rest.starts_with("[:").then(|| rest.find(":]")).flatten();
        if let Some(end) = class {
            length = end + 2;
        } else if c == '\\' {
            let escape = rest[length..].chars().next().expect("something after a backslash");
            length += escape.len_utf8();
            if escape == 'p' && rest[length..].starts_with('{') {
                length += rest[length..].find('}').unwrap() + 1;
            } else if long.contains(&escape) {
                length += rest[length..].chars().next().unwrap().len_utf8();
            }
        } else if c.is_ascii_alphabetic() || c.is_ascii_digit() && !word.is_empty() {
            word.push(c);
            rest = &rest[length..];
            continue;
        }
        found.extend((!word.is_empty()).then(|| std::mem::take(&mut word)));
        rest = &rest[length..];
    }
    found.extend((!word.is_empty()).then_some(word));
}

/// Fails with the missing and the superfluous words.
fn same(editor: &str, found: &Words, expected: &Words) {
    let missing: Vec<_> = expected.difference(found).collect();
    let unknown: Vec<_> = found.difference(expected).collect();
    assert!(missing.is_empty(), "{editor} lacks {missing:?} of the grammar");
    assert!(unknown.is_empty(), "{editor} has {unknown:?}, which the grammar does not have");
}

#[test]
fn the_grammar_says_what_its_words_are() {
    let grammar = read("grammar/hyped.pest");
    let (_, list) = grammar.split_once("reserved = @{").unwrap();
    let listed = words(quoted(list.split_once('}').unwrap().0, false));
    same("the list of reserved words", &listed, &reserved());
    assert!(reserved().is_disjoint(&contextual()), "a word is reserved or it is not");
    for sets in [reserved(), contextual(), units(), functions()] {
        assert!(sets.len() >= 3 && sets.iter().all(|w| is_word(w)), "{sets:?}");
    }
}

/// All objects in a JSON value.
fn objects<'v>(value: &'v Value, visit: &mut impl FnMut(&'v serde_json::Map<String, Value>)) {
    match value {
        Value::Object(map) => {
            visit(map);
            map.values().for_each(|v| objects(v, visit));
        }
        Value::Array(list) => list.iter().for_each(|v| objects(v, visit)),
        _ => {}
    }
}

/// The literal words in a rule of tree-sitter's.
fn literals(rule: &Value) -> Words {
    let mut found = Words::new();
    objects(rule, &mut |map| {
        if map.get("type").is_some_and(|t| t == "STRING") {
            found.extend(map["value"].as_str().filter(|text| is_word(text)).map(str::to_string));
        }
    });
    found
}

#[test]
fn tree_sitter_has_the_words() {
    let grammar: Value = serde_json::from_str(&read("editors/tree-sitter-hyped/src/grammar.json")).unwrap();
    let expected = all(&[reserved(), contextual(), units()]);
    same("the tree-sitter grammar", &literals(&grammar["rules"]), &expected);
    same("the tree-sitter grammar's list of reserved words", &literals(&grammar["reserved"]), &reserved());

    // A rule of one word is highlighted by its name, all other words by themselves.
    let highlights = read("editors/tree-sitter-hyped/queries/highlights.scm");
    let mut painted: Words = words(quoted(&highlights, false).into_iter().filter(|w| is_word(w)));
    for (name, rule) in grammar["rules"].as_object().unwrap() {
        if rule["type"] == "STRING" && highlights.contains(&format!("({name})")) {
            painted.extend(literals(rule));
        }
    }
    same("highlights.scm", &painted, &all(&[reserved(), contextual(), functions()]));
}

#[test]
fn zed_has_the_queries_of_tree_sitter() {
    for name in ["highlights.scm", "injections.scm"] {
        let original = read(&format!("editors/tree-sitter-hyped/queries/{name}"));
        let copy = read(&format!("editors/zed/languages/hyped/{name}"));
        assert!(copy == original, "Zed's {name} is no copy of tree-sitter's");
    }
}

#[test]
fn text_mate_has_the_words() {
    let grammar: Value = serde_json::from_str(&read("editors/vscode/syntaxes/hyped.tmLanguage.json")).unwrap();
    let mut found = Words::new();
    objects(&grammar, &mut |map| {
        for key in ["match", "begin", "end"] {
            if let Some(pattern) = map.get(key).and_then(Value::as_str) {
                words_of_pattern(pattern, &[], &mut found);
            }
        }
    });
    same("the TextMate grammar", &found, &all(&[reserved(), contextual(), units(), functions()]));
}

/// The text between a delimiter (the first character) and the next one that is not escaped.
fn delimited(text: &str) -> &str {
    let delimiter = text.chars().next().unwrap();
    let mut escaped = false;
    let end = text[1..].find(|c| {
        let ends = c == delimiter && !escaped;
        escaped = c == '\\' && !escaped;
        ends
    });
    &text[1..][..end.unwrap_or_else(|| panic!("{text} has no end"))]
}

#[test]
fn vim_has_the_words() {
    let mut found = Words::new();
    for line in read("editors/vim/syntax/hyped.vim").lines() {
        if let Some(keywords) = line.strip_prefix("syn keyword ").filter(|rest| !rest.starts_with("hypedTodo ")) {
            let options = ["contained", "skipwhite", "skipempty"];
            let listed = keywords.split_whitespace().skip(1).filter(|w| !w.contains('=') && !options.contains(w));
            found.extend(listed.map(str::to_string));
        } else if let Some(rest) = line.strip_prefix("syn match ") {
            let pattern = delimited(rest.split_once(' ').unwrap().1);
            words_of_pattern(pattern, &['z', '_'], &mut found);
        } else if line.starts_with("syn region ") {
            for key in [" start=", " skip=", " end="] {
                for (at, _) in line.match_indices(key) {
                    words_of_pattern(delimited(&line[at + key.len()..]), &['z', '_'], &mut found);
                }
            }
        }
    }
    same("Vim's syntax file", &found, &all(&[reserved(), contextual(), units(), functions()]));
}

#[test]
fn emacs_has_the_words() {
    let mode = read("editors/emacs/hyped-mode.el");
    let (_, section) = mode.split_once(";; ---- words: ").expect("the beginning of the words");
    let (section, _) = section.split_once(";; ---- end of words ").expect("the end of the words");
    let code: String = section.lines().filter(|line| !line.starts_with(";;")).map(|line| format!("{line}\n")).collect();
    let mut found = Words::new();
    for pattern in quoted(&code, true) {
        words_of_pattern(&pattern, &['_'], &mut found);
    }
    same("the mode for Emacs", &found, &all(&[reserved(), contextual(), functions()]));
}

/// The words of the grammar's rules of tests: what stands in a `test` block, expressions apart.
fn test_words() -> Words {
    let grammar = read("grammar/hyped.pest");
    let (_, section) = grammar.split_once("// ---- tests of a world").expect("the rules of tests");
    let (section, _) = section.split_once("// ---- expressions").expect("the rules of expressions");
    let names: Words = words(section.split(|c: char| !c.is_alphanumeric() && c != '_').map(str::to_string));
    let is_of_tests = |line: &&str| {
        let name = line.split_once(" =").map_or("", |(name, _)| name);
        name.starts_with("word_") && name != "word_test" && names.contains(name)
    };
    words(grammar.lines().filter(is_of_tests).flat_map(|line| quoted(line, false)))
}

/// In a `test` block, editors highlight the words of tests: each has patterns for such blocks, with exactly these words.
#[test]
fn editors_know_the_words_of_tests() {
    let expected = test_words();
    assert!(expected.len() >= 14 && expected.contains("unfound") && expected.contains("seed"), "{expected:?}");

    let grammar: Value = serde_json::from_str(&read("editors/vscode/syntaxes/hyped.tmLanguage.json")).unwrap();
    let mut found = Words::new();
    objects(&grammar["repository"]["claims"], &mut |map| {
        if let Some(pattern) = map.get("match").and_then(Value::as_str) {
            words_of_pattern(pattern, &[], &mut found);
        }
    });
    same("the TextMate grammar's `claims`", &found, &expected);
    let mut blocks = 0;
    objects(&grammar, &mut |map| blocks += usize::from(map.get("include").is_some_and(|rule| rule == "#claims")));
    assert!(blocks > 0, "no block of the TextMate grammar has claims");

    let mut found = Words::new();
    let vim = read("editors/vim/syntax/hyped.vim");
    for line in vim
        .lines()
        .filter(|line| ["hypedClaim", "hypedMoment"].iter().any(|name| line.starts_with(&format!("syn match {name} "))))
    {
        words_of_pattern(delimited(line.splitn(4, ' ').nth(3).unwrap()), &['z', '_'], &mut found);
    }
    same("Vim's `hypedClaim` and `hypedMoment`", &found, &expected);
    let region = vim.lines().find(|line| line.starts_with("syn region hypedTest "));
    assert!(region.is_some_and(|line| line.contains("hypedClaim") && line.contains("hypedMoment")), "{region:?}");

    let mode = read("editors/emacs/hyped-mode.el");
    let mut found = Words::new();
    for line in mode.lines().filter(|line| line.trim_start().starts_with("(claims ")) {
        quoted(line, true).iter().for_each(|pattern| words_of_pattern(pattern, &['_'], &mut found));
    }
    same("Emacs' `claims`", &found, &expected);
    assert!(mode.contains("(\"test\" . claims)"), "Emacs finds no `test` blocks");
}
