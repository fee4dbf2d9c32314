//! The documentation is true: `README.md` and the pages of the book in `docs/`.
//!
//! A fenced block of a page is tested according to the words after its fence:
//!
//! - `console`: a session. Each line `$ hypedc …` is run, and what it prints (standard output, then standard error) is
//!   compared with the lines below it. `> FILE` at its end writes standard output to a file. `$ echo $?` is the exit
//!   code of the command before. A line `…` stands for any number of lines, `…` inside a line for any text; seconds that
//!   were measured are not compared.
//! - `file="NAME"`, in any language: the block is that file. A file of `examples/` must be shown as it is.
//!
//! The sessions of a page run one after the other in a folder of their own that begins with a copy of `examples/`. A
//! picture `NAME.svg` or `NAME.gif` that they leave there is the file of that name in `docs/pictures`.
//!
//! `UPDATE=1 cargo test --test language docs` rewrites outputs and pictures; it keeps each line with `…` that still
//! fits, and fails where one had to go.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::support::{declares, files};
use hypedc::reach::Planner;

const README: &str = "README.md";
const SUMMARY: &str = "docs/SUMMARY.md";
const PICTURES: &str = "docs/pictures";
const REFERENCE: &str = "docs/reference.md";

/// Pages that are not in the book.
const BESIDE: [&str; 4] = ["grammar/README.md", "editors/README.md", "CONTRIBUTING.md", "CHANGELOG.md"];

/// Maximum length of the README, in lines, and of a line of prose of any page, in characters.
const MAX_README: usize = 150;
const MAX_LINE: usize = 120;

/// The wildcard for any number of lines of an output, or for any text inside a line.
const ANY: &str = "…";

fn is_updating() -> bool {
    std::env::var_os("UPDATE").is_some()
}

/// The README and the pages of the book.
fn pages() -> Vec<PathBuf> {
    let mut pages = vec![PathBuf::from(README)];
    pages.extend(files("docs", "md").into_iter().filter(|page| !page.starts_with("docs/book")));
    assert!(pages.len() > 20, "{pages:?}");
    pages
}

fn read(path: impl AsRef<Path>) -> String {
    std::fs::read_to_string(path.as_ref()).unwrap_or_else(|e| panic!("{}: {e}", path.as_ref().display()))
}

/// The cache of the commands that run in a folder. It stands beside it, so that none of them sees it.
fn cache(folder: &Path) -> PathBuf {
    let name = folder.file_name().unwrap_or_default();
    PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("docs-cache").join(name)
}

fn hypedc(folder: &Path, arguments: &[String]) -> (String, String, i32) {
    let output = Command::new(env!("CARGO_BIN_EXE_hypedc"))
        .args(arguments)
        .current_dir(folder)
        .env("XDG_CACHE_HOME", cache(folder))
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (text(output.stdout), text(output.stderr), output.status.code().unwrap())
}

/// A page in parts: lines of prose, and fenced blocks.
enum Part<'a> {
    Line(&'a str),
    Block { fence: &'a str, lines: Vec<&'a str> },
}

fn parts(text: &str) -> Vec<Part<'_>> {
    let mut parts = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        parts.push(match line.strip_prefix("```") {
            None => Part::Line(line),
            Some(fence) => Part::Block { fence, lines: lines.by_ref().take_while(|line| *line != "```").collect() },
        });
    }
    parts
}

/// The value of `file="…"` after a fence.
fn file_of(fence: &str) -> Option<&str> {
    fence.split_once("file=\"")?.1.split('"').next()
}

/// The words of a command line, with the quotes around them taken off.
fn words(command: &str) -> Vec<String> {
    let (mut words, mut word, mut open) = (Vec::new(), None::<String>, None);
    for c in command.chars() {
        match (open, c) {
            (None, '\'' | '"') => {
                open = Some(c);
                word.get_or_insert_default();
            }
            (Some(quote), c) if c == quote => open = None,
            (None, c) if c.is_whitespace() => words.extend(word.take()),
            (_, c) => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    words
}

/// A line without values that differ between runs: measured seconds.
fn comparable(line: &str, is_timed: bool) -> String {
    if let (Some(from), Some(to)) = (line.find(" tree"), line.find(" s; "))
        && from < to
    {
        return format!("{}{}", &line[..from], &line[to..]);
    }
    if let Some((before, _)) = line.split_once("; finished in ") {
        return before.to_string();
    }
    if !is_timed {
        return line.to_string();
    }
    // The columns of a table of levels, and the sum below it.
    let is_number = |word: &str| word.parse::<f64>().is_ok() && word.contains('.');
    line.split_whitespace().map(|word| if is_number(word) { "#" } else { word }).collect::<Vec<_>>().join(" ")
}

/// Whether an output matches a page.
fn is_as_shown(found: &[&str], shown: &[&str]) -> bool {
    let is_timed = found.iter().any(|line| line.starts_with("level ") && line.ends_with("seconds"));
    let line = |line: &&str| comparable(line, is_timed);
    let (found, shown): (Vec<_>, Vec<_>) = (found.iter().map(line).collect(), shown.iter().map(line).collect());
    fits(&found, &shown)
}

fn fits(found: &[String], shown: &[String]) -> bool {
    match shown.split_first() {
        None => found.is_empty(),
        Some((first, rest)) if first.trim() == ANY => (0..=found.len()).any(|skipped| fits(&found[skipped..], rest)),
        Some((first, rest)) => found.first().is_some_and(|line| line_fits(line, first)) && fits(&found[1..], rest),
    }
}

fn line_fits(found: &str, shown: &str) -> bool {
    match shown.split_once(ANY) {
        None => found == shown,
        Some((before, after)) => found.strip_prefix(before).is_some_and(|rest| {
            let mut ends = rest.char_indices().map(|(at, _)| at).chain([rest.len()]);
            ends.any(|at| line_fits(&rest[at..], after))
        }),
    }
}

/// An output as a page shows it from now on, with as many lines of `shown` as still fit, in their order; and the lines
/// with wildcards that fit nothing any more.
fn rewritten<'a>(found: &[&'a str], shown: &[&'a str]) -> (Vec<&'a str>, Vec<&'a str>) {
    // kept[i][j]: the most lines that fit, of found[i..] and shown[j..].
    let mut kept = vec![vec![0; shown.len() + 1]; found.len() + 1];
    for (i, line) in found.iter().enumerate().rev() {
        for (j, pattern) in shown.iter().enumerate().rev() {
            let skipped = kept[i + 1][j].max(kept[i][j + 1]);
            kept[i][j] = if line_fits(line, pattern) { skipped.max(1 + kept[i + 1][j + 1]) } else { skipped };
        }
    }
    let (mut i, mut j, mut lines, mut lost) = (0, 0, Vec::new(), Vec::new());
    while i < found.len() || j < shown.len() {
        let (has_found, has_shown) = (i < found.len(), j < shown.len());
        if has_found && has_shown && line_fits(found[i], shown[j]) && kept[i][j] == 1 + kept[i + 1][j + 1] {
            lines.push(shown[j]);
            (i, j) = (i + 1, j + 1);
        } else if has_found && (!has_shown || kept[i][j] == kept[i + 1][j]) {
            lines.push(found[i]);
            i += 1;
        } else {
            lost.extend(Some(shown[j]).filter(|line| line.contains(ANY)));
            j += 1;
        }
    }
    (lines, lost)
}

/// The state of a page's sessions.
struct Sandbox {
    folder: PathBuf,
    /// The exit code of the last command.
    code: i32,
    commands: Vec<String>,
}

impl Sandbox {
    /// A new folder with a copy of the examples. Nothing is cached: ways of an older build would be other ones.
    fn new(page: &Path) -> Self {
        let name = page.with_extension("").to_str().unwrap().replace(['/', '\\'], "-");
        let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("docs").join(name);
        let _ = std::fs::remove_dir_all(&folder);
        let _ = std::fs::remove_dir_all(cache(&folder));
        copy("examples", &folder.join("examples"));
        Sandbox { folder, code: 0, commands: Vec::new() }
    }

    fn write(&self, name: &str, text: &str) {
        let path = self.folder.join(name);
        if name.starts_with("examples/") {
            assert_eq!(read(&path), text, "{name}");
            return;
        }
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    /// The output of a line of a session.
    fn run(&mut self, command: &str) -> String {
        if command == "echo $?" {
            return format!("{}\n", self.code);
        }
        let rest = command.strip_prefix("hypedc ").unwrap_or_else(|| panic!("only `hypedc` is run, not {command}"));
        let mut words = words(rest);
        let file = words.iter().position(|word| word == ">").map(|at| words.split_off(at).swap_remove(1));
        let (out, errors, code) = hypedc(&self.folder, &words);
        self.code = code;
        self.commands.push(command.to_string());
        match file {
            Some(file) => {
                std::fs::write(self.folder.join(file), out).unwrap();
                errors
            }
            None => out + &errors,
        }
    }

    /// The pictures that the sessions left.
    fn pictures(&self) -> Vec<PathBuf> {
        let all = std::fs::read_dir(&self.folder).unwrap().map(|entry| entry.unwrap().path());
        all.filter(|path| path.extension().is_some_and(|e| e == "svg" || e == "gif")).collect()
    }
}

fn copy(from: impl AsRef<Path>, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let path = entry.unwrap().path();
        let to = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy(&path, &to);
        } else {
            std::fs::copy(&path, to).unwrap();
        }
    }
}

/// The result of a page's sessions.
#[derive(Default)]
struct Played {
    sessions: usize,
    pictures: BTreeSet<String>,
    trouble: String,
}

/// Runs the sessions of a page.
fn play(page: &Path) -> Played {
    let text = read(page);
    let mut played = Played::default();
    let mut sandbox = Sandbox::new(page);
    let mut shown_files = Vec::new();
    let mut lost_wildcards = String::new();
    let mut anew = String::new();
    for part in parts(&text) {
        let (fence, lines) = match part {
            Part::Line(line) => {
                anew.push_str(&format!("{line}\n"));
                continue;
            }
            Part::Block { fence, lines } => (fence, lines),
        };
        anew.push_str(&format!("```{fence}\n"));
        if let Some(name) = file_of(fence) {
            sandbox.write(name, &(lines.join("\n") + "\n"));
            shown_files.push(name.to_string());
        }
        if fence != "console" {
            assert!(!fence.starts_with("hyped") || file_of(fence).is_some(), "{}: {fence}", page.display());
            anew.extend(lines.iter().map(|line| format!("{line}\n")));
        } else {
            played.sessions += 1;
            assert!(lines[0].starts_with("$ "), "{}: {}", page.display(), lines[0]);
            for chunk in lines.chunk_by(|_, line| !line.starts_with("$ ")) {
                let (command, shown) = (chunk[0].strip_prefix("$ ").unwrap(), &chunk[1..]);
                let found = sandbox.run(command);
                let found: Vec<&str> = found.lines().collect();
                let is_right = is_as_shown(&found, shown);
                if !is_right {
                    let (path, found, shown) = (page.display(), found.join("\n"), shown.join("\n"));
                    played.trouble.push_str(&format!("{path}: $ {command}\nprints\n{found}\nand not\n{shown}\n\n"));
                }
                let (kept, lost) = if is_right { (shown.to_vec(), Vec::new()) } else { rewritten(&found, shown) };
                lost_wildcards.extend(lost.iter().map(|line| format!("{}: lost: {line}\n", page.display())));
                anew.push_str(&format!("$ {command}\n"));
                anew.extend(kept.iter().map(|line| format!("{line}\n")));
            }
        }
        anew.push_str("```\n");
    }
    for file in shown_files.iter().filter(|file| file.ends_with(".hyped")) {
        let is_used = sandbox.commands.iter().any(|command| command.contains(file.as_str()));
        let is_imported = text.contains(&format!("import \"{file}\""));
        assert!(is_used || is_imported, "{}: nothing is done with {file}", page.display());
    }
    for picture in sandbox.pictures() {
        let name = picture.file_name().unwrap().to_str().unwrap().to_string();
        let kept = Path::new(PICTURES).join(&name);
        if is_updating() {
            std::fs::create_dir_all(PICTURES).unwrap();
            std::fs::copy(&picture, kept).unwrap();
        } else if std::fs::read(&kept).ok() != std::fs::read(&picture).ok() {
            played.trouble.push_str(&format!("{}: {} is not what is drawn\n", page.display(), kept.display()));
        }
        played.pictures.insert(name);
    }
    if is_updating() {
        std::fs::write(page, anew).unwrap();
        played.trouble = lost_wildcards;
    }
    played
}

#[path = "../benches/results/tables.rs"]
#[allow(dead_code, reason = "the bench measures what this module reads")]
mod tables;

#[test]
fn a_table_is_made_of_results_alone() {
    let about = serde_json::json!({ "machine": "a machine", "date": "2020-01-02", "hypedc": "0.0.0", "commit": "abc" });
    let ask = |command: &str| {
        let (is_minimal, seed) = (command.contains("--minimize"), if command.contains("--seed 3 ") { 3 } else { 1 });
        serde_json::json!({ "goals": [{
            "verdict": if seed == 3 { "not-found" } else { "reached" }, "nodes": 1000 * seed, "seconds": 0.25,
            "seconds_of_play": if is_minimal { 20.0 } else { 60.0 }, "whole_seconds": 2.0, "other": "left out"
        }] })
    };
    let (_, table) = tables::TABLES.iter().find(|(name, _)| *name == "levels").unwrap();
    let mut measured = tables::Results::measured(about, ask);
    let first = table(&mut measured);
    assert!(first.contains("| `smb`, 1-1 | 9 of 10 | 1,000 | 0.25 | 0.25 | 60 | 20 | 2 |\n"), "{first}");
    let text = measured.text();
    assert!(!text.contains("left out"));
    let mut kept = tables::Results::of_file(&text);
    assert_eq!((table(&mut kept), kept.text()), (first.clone(), text));
    let page = tables::with_table("a\n<!-- measured: levels -->\nold\n<!-- end -->\nb\n", "levels", &first, &kept);
    let said = "Measured on 2020-01-02 with hypedc 0.0.0 (abc) on a machine.";
    assert_eq!(page, format!("a\n<!-- measured: levels -->\n\n{first}\n{said}\n\n<!-- end -->\nb\n"));
}

#[test]
fn measured_tables_are_those_of_the_files_of_results() {
    let files = tables::TABLES.iter().filter(|(name, _)| Path::new(&tables::path_of(name)).exists());
    for (name, table) in files {
        let mut results = tables::Results::of_file(&std::fs::read_to_string(tables::path_of(name)).unwrap());
        let page = std::fs::read_to_string(tables::PAGE).unwrap();
        let table = table(&mut results);
        let new = tables::with_table(&page, name, &table, &results);
        if std::env::var_os("UPDATE").is_some() {
            std::fs::write(tables::PAGE, new).unwrap();
        } else {
            assert!(new == page, "the table {name} of {} is another one: UPDATE=1 writes it", tables::PAGE);
        }
    }
}

#[test]
fn sessions_print_what_is_shown() {
    let pages = pages();
    let next = AtomicUsize::new(0);
    let all = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(page) = pages.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let played = play(page);
                    all.lock().unwrap().push(played);
                }
            });
        }
    });
    let all = all.into_inner().unwrap();
    let trouble: String = all.iter().map(|played| played.trouble.as_str()).collect();
    assert!(trouble.is_empty(), "{trouble}`UPDATE=1 cargo test --test language docs` writes them anew");
    assert!(all.iter().map(|played| played.sessions).sum::<usize>() >= 20);
    let drawn: BTreeSet<String> = all.into_iter().flat_map(|played| played.pictures).collect();
    let kept = ["svg", "gif"].map(|extension| files(PICTURES, extension)).concat();
    let kept: BTreeSet<String> = kept.iter().map(|p| p.file_name().unwrap().to_str().unwrap().to_string()).collect();
    assert_eq!(drawn, kept, "each picture in {PICTURES} is drawn by a session");
}

/// The examples for continuous integration are laid out as YAML is, and call commands with arguments that they have.
#[test]
fn pipelines_call_what_there_is() {
    let is_known = |command: &str| hypedc(Path::new("."), &words(&format!("{command} --help"))).2 == 0;
    assert!(!is_known("reach game.hyped --basline old.jsonl"), "`--help` does not hide a mistake");
    let text = read("docs/continuous-integration.md");
    let mut called = BTreeSet::new();
    for part in parts(&text) {
        let Part::Block { fence, lines } = part else { continue };
        for line in lines.iter().filter(|_| fence.starts_with("yaml")) {
            let content = line.trim_start();
            assert!((line.len() - content.len()).is_multiple_of(2) && !line.contains('\t'), "{line}");
            let command = content.trim_start_matches("- ").trim_start_matches("run: ");
            let Some(command) = command.strip_prefix("hypedc ") else { continue };
            let command = command.split(['>', '|']).next().unwrap();
            assert!(is_known(command), "{line}");
            called.insert(command.split(' ').next().unwrap().to_string());
        }
    }
    assert_eq!(called.into_iter().collect::<Vec<_>>(), ["check", "diff", "fmt", "reach", "test"]);
}

#[test]
fn the_readme_is_short_and_has_the_two_commands() {
    let text = read(README);
    assert!(text.lines().count() <= MAX_README, "{} lines", text.lines().count());
    for command in ["cargo run --release -- reach examples/paper/test1.hyped", "cargo test"] {
        assert!(text.lines().any(|line| line.starts_with(command)), "{command}");
    }
}

#[test]
fn lines_of_prose_are_short() {
    let mut all = pages();
    all.extend(["CONTRIBUTING.md", "CHANGELOG.md"].map(PathBuf::from));
    let mut long = String::new();
    for page in all {
        for part in parts(&read(&page)) {
            let Part::Line(line) = part else { continue };
            let is_free = line.starts_with('|') || line.starts_with("![");
            if !is_free && line.chars().count() > MAX_LINE {
                long.push_str(&format!("{}: {line}\n", page.display()));
            }
        }
    }
    assert!(long.is_empty(), "lines of more than {MAX_LINE} characters:\n{long}");
}

/// The targets of the links of a page, without those of blocks and to other hosts.
fn links(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for part in parts(text) {
        let Part::Line(line) = part else { continue };
        // Code is no link.
        let prose: String = line.split('`').step_by(2).collect();
        found.extend(prose.split("](").skip(1).map(|rest| rest.split(')').next().unwrap().to_string()));
    }
    found.retain(|link| !link.contains("://"));
    found
}

/// What a page includes is part of it.
fn whole(page: &Path) -> String {
    let text = read(page);
    let mut out = String::new();
    for line in text.lines() {
        match line.strip_prefix("{{#include ").and_then(|rest| rest.strip_suffix("}}")) {
            Some(path) => out.push_str(&read(page.parent().unwrap().join(path))),
            None => out.push_str(&format!("{line}\n")),
        }
    }
    out
}

/// The anchors of a page, as code hosts and mdBook make them of its headings.
fn anchors(page: &Path) -> BTreeSet<String> {
    let headings = whole(page);
    let headings = parts(&headings).into_iter().filter_map(|part| match part {
        Part::Line(line) if line.starts_with('#') => Some(line.trim_start_matches('#').trim().to_lowercase()),
        _ => None,
    });
    let anchor = |heading: String| -> String {
        let kept = heading.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
        kept.map(|c| if c == ' ' { '-' } else { c }).collect()
    };
    headings.map(anchor).collect()
}

#[test]
fn links_lead_somewhere() {
    let mut all = pages();
    all.extend(BESIDE.map(PathBuf::from));
    let (mut count, mut trouble) = (0, String::new());
    for page in all {
        for link in links(&whole(&page)) {
            count += 1;
            let at = format!("{}: {link}", page.display());
            let (path, anchor) = link.split_once('#').map_or((link.as_str(), None), |(path, a)| (path, Some(a)));
            let target = match path {
                "" => page.clone(),
                path => page.parent().unwrap().join(path),
            };
            if !target.exists() {
                trouble.push_str(&format!("{at}: there is no such file\n"));
                continue;
            }
            if anchor.is_some_and(|anchor| !anchors(&target).contains(anchor)) {
                trouble.push_str(&format!("{at}: there is no such heading\n"));
            }
            // The book contains only `docs/`: a link out of it is broken there.
            let docs = Path::new("docs").canonicalize().unwrap();
            if page.starts_with("docs") && !target.canonicalize().unwrap().starts_with(docs) {
                trouble.push_str(&format!("{at} leads out of the book\n"));
            }
        }
    }
    assert!(trouble.is_empty(), "{trouble}");
    assert!(count > 60, "{count}");
}

#[test]
fn the_book_holds_every_page_once() {
    let mut listed: Vec<PathBuf> = links(&read(SUMMARY)).iter().map(|link| Path::new("docs").join(link)).collect();
    let mut there = pages();
    there.retain(|page| page != Path::new(README) && page != Path::new(SUMMARY));
    listed.sort();
    there.sort();
    assert_eq!(listed, there);
    assert!(whole(Path::new(REFERENCE)).contains(&read("grammar/README.md")));
}

/// The names of the commands or the options in a help text.
fn listed_in(help: &str, heading: &str) -> Vec<String> {
    let block = help.split_once(heading).map_or("", |(_, rest)| rest.split("\n\n").next().unwrap());
    block.lines().filter_map(|line| line.strip_prefix("  ")?.split_whitespace().next()).map(str::to_string).collect()
}

#[test]
fn each_command_has_its_page_and_each_option_stands_there() {
    let help = |arguments: &[&str]| {
        let arguments: Vec<String> = arguments.iter().chain(&["--help"]).map(ToString::to_string).collect();
        hypedc(Path::new("."), &arguments).0
    };
    let commands = listed_in(&help(&[]), "Commands:\n");
    let commands: Vec<&str> = commands.iter().map(String::as_str).filter(|name| *name != "help").collect();
    let mut pages: Vec<PathBuf> = commands.iter().map(|name| format!("docs/commands/{name}.md").into()).collect();
    pages.push("docs/commands/README.md".into());
    pages.sort();
    assert_eq!(files("docs/commands", "md"), pages);
    let readme = read(README);
    let mut options = BTreeMap::new();
    for name in commands {
        let page = read(format!("docs/commands/{name}.md"));
        assert!(page.starts_with(&format!("# `hypedc {name}`\n")), "{name}");
        assert!(readme.contains(&format!("| [`{name}`](docs/commands/{name}.md) |")), "{name} is not in the README");
        let inner = listed_in(&help(&[name]), "Commands:\n");
        let mut helps = vec![help(&[name])];
        helps.extend(inner.iter().filter(|inner| *inner != "help").map(|inner| help(&[name, inner])));
        for option in helps.iter().flat_map(|help| help.split(|c: char| c.is_whitespace() || "[]<>(),`".contains(c))) {
            let option = option.trim_end_matches(['.', ';', ':']);
            if option.starts_with("--") && option != "--help" && option != "--version" {
                assert!(page.contains(option), "docs/commands/{name}.md does not name {option}");
                *options.entry(name).or_insert(0) += 1;
            }
        }
    }
    assert!(options["reach"] > 30, "{options:?}");
}

#[test]
fn each_planner_is_described() {
    let page = read("docs/planners.md");
    for planner in Planner::ALL {
        assert!(page.contains(&format!("\n| `{}` | ", planner.name())), "{}", planner.name());
    }
}

/// The words in the quotes after `const NAME =` in the book's highlighter.
fn words_of(script: &str, name: &str) -> BTreeSet<String> {
    let (_, rest) = script.split_once(&format!("const {name} =")).unwrap();
    let quoted = rest.split(';').next().unwrap().split('"').skip(1).step_by(2);
    quoted.flat_map(str::split_whitespace).map(str::to_string).collect()
}

#[test]
fn the_book_colours_the_words_of_the_grammar() {
    let (script, grammar) = (read("docs/hyped.js"), read("grammar/hyped.pest"));
    for (name, prefix) in [("reserved", "kw_"), ("contextual", "word_")] {
        let rules = grammar.lines().filter(|line| line.starts_with(prefix));
        let mut words: BTreeSet<String> = rules.filter_map(|line| Some(line.split('"').nth(1)?.to_string())).collect();
        // The sign between width and height; else it is a variable.
        words.remove("x");
        assert_eq!(words_of(&script, name), words, "docs/hyped.js, {name}");
    }
}

/// Names come before the file in which they are declared.
#[test]
fn the_places_of_rules_exist() {
    let text = read("docs/architecture.md");
    let section = text.split_once("## Where a rule is\n").unwrap().1.split("\n## ").next().unwrap();
    let mut places = 0;
    for row in section.lines().filter(|line| line.starts_with("| ") && line.contains("`src/")) {
        let mut names: Vec<&str> = Vec::new();
        for word in row.rsplit_once(" | ").unwrap().1.split('`').skip(1).step_by(2) {
            if !word.starts_with("src/") {
                names.push(word.rsplit("::").next().unwrap());
                continue;
            }
            let code = read(word);
            for name in names.drain(..) {
                assert!(declares(&code, &["fn", "pub"], name), "{word} declares no `{name}`: {row}");
            }
            places += 1;
        }
        assert!(names.is_empty(), "{row}: in which file?");
    }
    assert!(places > 10, "{places}");
}
