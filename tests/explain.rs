//! The pages of `hypedc explain` are correct: each wrong example has the finding, each right one runs without findings.
//!
//! The form of a page is described in `src/diagnostic/page.rs`. Everything is tried with the command itself, in a folder
//! that holds the files of the page.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use hypedc::diagnostic::Code;
use hypedc::diagnostic::page::{Example, Page, Part, Side};
use hypedc::diagnostic::words::{MEANINGS, Meaning};
use hypedc::source::FileId;
use hypedc::syntax::parse;

const PAGES: &str = "src/diagnostic/catalogue/pages";

/// The default name of an example.
const PROGRAM: &str = "program.hyped";

/// Number of steps of a world.
const STEPS: &str = "100";

fn hypedc(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hypedc")).args(arguments).current_dir(folder).output().unwrap()
}

/// The whole output of a command.
fn said(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// The codes of the errors, or of the warnings, in the output of a command.
fn codes(said: &str, word: &str) -> Vec<String> {
    let start = format!("{word}[");
    said.split(&start).skip(1).map(|rest| rest.split(']').next().unwrap().to_string()).collect()
}

/// The bytes of an example.
fn bytes(example: &Example<'_>) -> Vec<u8> {
    let mut text = example.lines.join("\n") + "\n";
    for dots in example.settings("dots") {
        let times = example.setting("times").unwrap().parse().unwrap();
        text = text.replacen('…', &dots.repeat(times), 1);
    }
    match example.setting("encoding") {
        None => text.into_bytes(),
        Some("latin-1") => text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect(),
        Some(other) => panic!("no encoding `{other}`"),
    }
}

/// A folder with the files of one side of a page.
fn folder(code: Code, page: &Page<'_>, side: Side) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("explain").join(format!("{code}-{side:?}"));
    let _ = std::fs::remove_dir_all(&folder);
    for example in page.examples().filter(|e| e.side.is_none_or(|s| s == side) && e.language != "sh") {
        let path = folder.join(example.setting("file").unwrap_or(PROGRAM));
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes(example)).unwrap();
    }
    folder
}

/// The words of a command line, single quotes taken off.
fn words(command: &str) -> Vec<&str> {
    let parts = command.split('\'').enumerate();
    parts.flat_map(|(i, part)| if i % 2 == 1 { vec![part] } else { part.split_whitespace().collect() }).collect()
}

/// The output for an example: of the check, and of the runs that the page specifies.
fn outputs(example: &Example<'_>, folder: &Path) -> Vec<Output> {
    if example.language == "sh" {
        let commands = example.lines.iter().map(|line| line.strip_prefix("hypedc ").unwrap());
        return commands.map(|command| hypedc(folder, &words(command))).collect();
    }
    let mut found = vec![hypedc(folder, &["check", "--format", "short", PROGRAM])];
    let inputs = example.setting("inputs");
    if inputs.is_some() {
        // A warning may predict a run-time error.
        assert!(found[0].status.success(), "{}", said(&found[0]));
    }
    if inputs.is_some() || example.side == Some(Side::Right) {
        let worlds = example.lines.iter().filter_map(|line| line.strip_prefix("world ")?.split_whitespace().next());
        for world in worlds {
            let script = inputs.unwrap_or("-");
            found.push(hypedc(folder, &["sim", PROGRAM, "--world", world, "--inputs", script, "--frames", STEPS]));
        }
    }
    found
}

/// The example of a side that is tried; the others are files that it reads.
fn tried<'p, 'a>(page: &'p Page<'a>, side: Side) -> &'p Example<'a> {
    let mut found = page.examples().filter(|e| e.side == Some(side) && e.setting("file").is_none());
    let first = found.next().unwrap_or_else(|| panic!("{}: no {side:?} example", page.title));
    assert!(found.next().is_none(), "{}: two {side:?} examples", page.title);
    first
}

#[test]
fn pages_have_their_form() {
    let mut files: Vec<String> =
        std::fs::read_dir(PAGES).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    files.sort();
    let expected: Vec<String> = Code::ALL.iter().map(|code| format!("{code}.md")).collect();
    assert_eq!(files, expected, "one page for each code");
    for code in Code::ALL {
        let page = Page::of(*code);
        assert_eq!(page.title, format!("{code}: {}", code.title()));
        let mut prose: Vec<&str> = Vec::new();
        let mut seen = Vec::new();
        for part in &page.parts {
            match part {
                Part::Prose(lines) => {
                    assert!(seen.is_empty(), "{code}: prose stands before the examples");
                    prose.extend(lines);
                }
                Part::Example(example) => seen.push(example),
            }
        }
        assert!((3..=12).contains(&prose.len()), "{code}: {} lines of prose", prose.len());
        for line in code.page().lines() {
            assert!(line.chars().count() <= 80, "{code}: a long line: {line}");
        }
        let text = prose.iter().map(|line| line.to_lowercase()).collect::<Vec<_>>().join(" ");
        assert_eq!(text.matches('`').count() % 2, 0, "{code}: a backquote has no partner");
        for word in text.split(|c: char| !c.is_alphanumeric()) {
            assert!(!matches!(word, "you" | "your"), "{code}: the page speaks of what is, not to someone");
        }
        for example in seen {
            assert!(["hyped", "text", "json", "sh"].contains(&example.language), "{code}: `{}`", example.language);
            assert!(example.side.is_some() || example.setting("file").is_some(), "{code}: a block of no use");
            let known = ["file", "inputs", "dots", "times", "encoding"];
            assert!(example.keys().all(|key| known.contains(&key)), "{code}: {:?}", example.keys().collect::<Vec<_>>());
        }
    }
}

#[test]
fn wrong_examples_show_their_code() {
    let mut trouble = String::new();
    for code in Code::ALL {
        let page = Page::of(*code);
        let example = tried(&page, Side::Wrong);
        let outputs = outputs(example, &folder(*code, &page, Side::Wrong));
        let said: String = outputs.iter().map(said).collect();
        let (errors, warnings) = (codes(&said, "error"), codes(&said, "warning"));
        let found = errors.iter().chain(&warnings).any(|c| c == code.text());
        if !found || errors.iter().any(|c| c != code.text()) {
            trouble.push_str(&format!("{code}, wrong:\n{said}\n"));
        }
    }
    assert!(trouble.is_empty(), "{trouble}");
}

#[test]
fn right_examples_run_without_a_word() {
    let mut trouble = String::new();
    for code in Code::ALL {
        let page = Page::of(*code);
        let example = tried(&page, Side::Right);
        for output in outputs(example, &folder(*code, &page, Side::Right)) {
            let said = said(&output);
            let silent = output.stderr.is_empty() && codes(&said, "error").is_empty();
            if !output.status.success() || !silent || !codes(&said, "warning").is_empty() {
                trouble.push_str(&format!("{code}, right:\n{said}\n"));
            }
        }
    }
    assert!(trouble.is_empty(), "{trouble}");
}

#[test]
fn the_command_shows_pages_and_lists_codes() {
    let here = Path::new(".");
    let shown = |arguments: &[&str]| {
        let output = hypedc(here, arguments);
        assert!(output.status.success() && output.stderr.is_empty(), "{}", said(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    insta::assert_snapshot!("page", shown(&["explain", "E0302"]));
    insta::assert_snapshot!("list", shown(&["explain"]));
    let [one, other] = ["E0302", "w0601"].map(|code| shown(&["explain", code]));
    assert_eq!(shown(&["explain", "e0302", "W0601"]), format!("{one}\n{other}"));
}

#[test]
fn the_command_explains_words() {
    let shown = |arguments: &[&str]| {
        let output = hypedc(Path::new("."), arguments);
        assert!(output.status.success() && output.stderr.is_empty(), "{}", said(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    insta::assert_snapshot!("words", shown(&["explain", "touching", "clamp", "near", "kinematic"]));
    let output = hypedc(Path::new("."), &["explain", "toching"]);
    assert_eq!(output.status.code(), Some(2));
    let error = said(&output);
    assert!(error.contains("no code and no word of the language is `toching`; did you mean `touching`?"), "{error}");
}

#[test]
fn an_unknown_code_is_no_question() {
    let output = hypedc(Path::new("."), &["explain", "E0392", "E0302"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stdout).starts_with("E0302: "), "the known one is shown all the same");
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(error.contains("no code `E0392`; did you mean `E0302`?"), "{error}");
    let output = hypedc(Path::new("."), &["explain", "gravity"]);
    assert_eq!((output.status.code(), output.stdout.as_slice()), (Some(2), &[][..]));
    assert!(said(&output).contains("`hypedc explain` lists all codes"), "{}", said(&output));
}

#[test]
fn a_check_with_findings_ends_with_the_way_to_its_page() {
    let hint = |arguments: &[&str]| {
        let output = hypedc(Path::new("."), arguments);
        String::from_utf8(output.stderr).unwrap().lines().last().unwrap_or_default().to_string()
    };
    let wrong = "tests/ui/dimension_conflict.hyped";
    assert_eq!(hint(&["check", wrong, "tests/ui/step.hyped"]), "for more on an error: hypedc explain E0302");
    assert_eq!(hint(&["check", wrong, "--format", "short"]), "");
    assert_eq!(hint(&["check", "tests/ui/idle_edge.hyped"]), "for more on a warning: hypedc explain W0401");
    assert_eq!(hint(&["check", wrong, "tests/ui/idle_edge.hyped"]), "for more on an error: hypedc explain E0302");
}

#[test]
fn examples_of_words_fit_the_grammar_and_hold_their_word() {
    let around = [
        "|",
        "entity A { | }",
        "entity A { mode m { | } }",
        "entity A { envelope x' by a { | } }",
        "world W { | }",
        "world W { space s { | } }",
    ];
    for Meaning { word, example, .. } in MEANINGS {
        // Some lines of an example are alternatives, so that each is parsed alone.
        let parts: Vec<&str> = if example.contains(['{', '"']) { vec![example] } else { example.lines().collect() };
        for part in parts {
            let fits = |outer: &&str| !parse(FileId(0), &outer.replace('|', part)).1.has_errors();
            assert!(around.iter().any(fits), "{word}: {part}");
        }
        let words: Vec<&str> = example.split(|c: char| !c.is_alphanumeric()).collect();
        assert!(words.contains(word), "{word} is not in its example");
    }
}
