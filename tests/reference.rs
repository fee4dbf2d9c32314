//! The language reference is true: every example of `grammar/README.md` compiles, runs, and does what the page says.
//!
//! A fenced block that begins with ` ```hyped ` is an example; what follows on that line says how it is tested:
//!
//! - `entity`, `mode`, `world`: the block is put into the wrapper of that name, which stands in the page itself;
//! - `wrapper`: the block is such a wrapper; `error E0302`: compiling the block finds exactly this;
//! - `file="a.hyped"`: the block is a file that other examples can read, as is a block of any other language;
//! - `inputs="right*40"`: what the player does, else nothing for 120 steps; `ends="hero.x > 10"`: what holds then;
//!   `stops="E0603"`: the run ends early with this error;
//! - `map="a.txt"`: the level that the command line would give, `legend="a.json"` and `tile="16x16"` how it is read.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::support::script_of;
use hypedc::compile::{Compilation, LevelFile, check_with};
use hypedc::diagnostic::{Code, render};
use hypedc::ir::{Program, WorldId};
use hypedc::sim::Simulator;
use hypedc::source::{Files, ReadError};

const PAGE: &str = "grammar/README.md";

/// The line of a wrapper that an example takes the place of.
const HERE: &str = "// the example";

/// A fenced block.
struct Block {
    /// Where its fence stands in the page.
    line: usize,
    /// The words after the fence.
    words: Vec<String>,
    /// `key="value"` after the fence.
    settings: Vec<(String, String)>,
    text: String,
}

impl Block {
    fn is(&self, word: &str) -> bool {
        self.words.iter().skip(1).any(|w| w == word)
    }

    fn is_program(&self) -> bool {
        self.words.first().is_some_and(|w| w == "hyped") && !self.is("wrapper")
    }

    fn setting(&self, key: &str) -> Option<&str> {
        self.all(key).next()
    }

    fn all(&self, key: &str) -> impl Iterator<Item = &str> {
        self.settings.iter().filter(move |(k, _)| k == key).map(|(_, v)| v.as_str())
    }
}

fn page() -> String {
    std::fs::read_to_string(PAGE).unwrap()
}

fn blocks(page: &str) -> Vec<Block> {
    let mut found = Vec::new();
    let mut lines = page.lines().enumerate();
    while let Some((index, line)) = lines.next() {
        let Some(info) = line.strip_prefix("```") else { continue };
        let (words, settings) = information(info);
        let text: Vec<&str> = lines.by_ref().map(|(_, line)| line).take_while(|line| *line != "```").collect();
        found.push(Block { line: index + 1, words, settings, text: text.join("\n") + "\n" });
    }
    found
}

/// The words and the settings after a fence; values stand between quotes.
fn information(info: &str) -> (Vec<String>, Vec<(String, String)>) {
    let (mut words, mut settings): (Vec<String>, Vec<(String, String)>) = (Vec::new(), Vec::new());
    for (index, part) in info.split('"').enumerate() {
        if index % 2 == 1 {
            // The key stands before the quote.
            let key = words.pop().unwrap();
            settings.push((key.strip_suffix('=').unwrap().to_string(), part.to_string()));
        } else {
            words.extend(part.split_whitespace().map(str::to_string));
        }
    }
    (words, settings)
}

/// What an example becomes.
fn whole(block: &Block, all: &[Block]) -> String {
    let mut text = block.text.clone();
    // The wrapper of a mode's members is itself put into that of an entity's.
    let wrappers = match ["entity", "mode", "world"].into_iter().find(|kind| block.is(kind)) {
        None => [].as_slice(),
        Some("mode") => ["mode", "entity"].as_slice(),
        Some("entity") => ["entity"].as_slice(),
        Some(_) => ["world"].as_slice(),
    };
    for kind in wrappers {
        let wrapper = all.iter().find(|b| b.is("wrapper") && b.is(kind)).unwrap();
        let lines: Vec<&str> = wrapper.text.lines().collect();
        text = wrap(&lines, &text);
    }
    // The condition at the end is a goal of the world, which comes last.
    let ends: Vec<String> =
        block.all("ends").enumerate().map(|(i, predicate)| format!("goal claim_{i}: {predicate}\n")).collect();
    if ends.is_empty() {
        return text;
    }
    let (body, _) = text.trim_end().rsplit_once('}').unwrap();
    format!("{body}\n{}}}\n", ends.concat())
}

/// The lines of a wrapper, but for what the example does not need, with the example in its place.
fn wrap(lines: &[&str], example: &str) -> String {
    let chunks = chunks(lines);
    let kept = |chunk: &[&str]| !declares(example, &words(chunk[0]));
    // What is named decides over inputs, entities and modes; the rest of the wrapper names things, too.
    let mut named: BTreeSet<String> = words(example).into_iter().collect();
    for chunk in chunks.iter().filter(|c| name_of(c[0]).is_none() && !is_here(c[0]) && kept(c)) {
        named.extend(chunk.iter().flat_map(|l| words(l)));
    }
    let mut out = String::new();
    for chunk in chunks {
        if is_here(chunk[0]) {
            out.push_str(example);
        } else if chunk.iter().any(|l| is_here(l)) {
            let inner = wrap(&chunk[1..chunk.len() - 1], example);
            out.push_str(&format!("{}\n{inner}{}\n", chunk[0], chunk[chunk.len() - 1]));
        } else if kept(chunk) && name_of(chunk[0]).is_none_or(|name| named.contains(&name)) {
            out.push_str(&(chunk.join("\n") + "\n"));
        }
    }
    out
}

fn is_here(line: &str) -> bool {
    line.trim() == HERE
}

/// Lines with the blocks that they open.
fn chunks<'l, 't>(lines: &'l [&'t str]) -> Vec<&'l [&'t str]> {
    let mut found = Vec::new();
    let mut rest = lines;
    while let Some((line, after)) = rest.split_first() {
        let mut length = 1;
        if line.trim_end().ends_with('{') {
            let close = format!("{}}}", &line[..line.len() - line.trim_start().len()]);
            length += 1 + after.iter().position(|l| *l == close).unwrap();
        }
        let (chunk, others) = rest.split_at(length);
        found.push(chunk);
        rest = others;
    }
    found
}

/// The name of an input, an entity or a mode that a line of a wrapper declares.
fn name_of(line: &str) -> Option<String> {
    let mut words = words(line).into_iter();
    let first = words.next()?;
    words.next().filter(|_| matches!(first.as_str(), "button" | "axis" | "entity" | "mode"))
}

/// Whether an example brings what a line of a wrapper would: an input, an entity or a mode of the same name, or
/// anything else that begins with the same word.
fn declares(example: &str, line: &[String]) -> bool {
    let Some(first) = line.first() else { return false };
    example.lines().any(|l| {
        let found = words(l);
        let found: Vec<&String> = found.iter().filter(|w| *w != "kinematic").collect();
        match first.as_str() {
            "button" | "axis" | "entity" | "mode" => {
                found.first() == Some(&first) && line.get(1).is_some_and(|name| found[1..].contains(&name))
            }
            _ => found.first() == Some(&first),
        }
    })
}

/// The words of a program, comments and quoted text left out.
fn words(text: &str) -> Vec<String> {
    let mut code = String::new();
    for line in text.lines() {
        let line = line.split("//").next().unwrap_or_default();
        for (index, part) in line.split('"').enumerate() {
            code.push_str(if index % 2 == 0 { part } else { " " });
        }
        code.push('\n');
    }
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    code.split(|c: char| !is_part(c)).filter(|w| !w.is_empty()).map(str::to_string).collect()
}

/// An example and the files of the page.
struct PageFiles<'a> {
    main: &'a str,
    others: BTreeMap<PathBuf, &'a str>,
}

impl Files for PageFiles<'_> {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        if path == Path::new("example.hyped") {
            return Ok(self.main.to_string());
        }
        match self.others.get(path) {
            Some(text) => Ok((*text).to_string()),
            None => Err(ReadError::Unreadable(format!("the page has no file {}", path.display()))),
        }
    }
}

fn compiled(text: &str, block: &Block, all: &[Block]) -> Compilation {
    let others = all.iter().filter_map(|b| Some((PathBuf::from(b.setting("file")?), b.text.as_str()))).collect();
    let side = |text: &str| text.parse::<f64>().unwrap();
    let tile = block.setting("tile").and_then(|t| t.split_once('x')).map(|(w, h)| (side(w), side(h)));
    let file = |key: &str| block.setting(key).map(Path::new);
    let level = LevelFile { map: file("map"), legend: file("legend"), tile };
    check_with(Path::new("example.hyped"), level, &PageFiles { main: text, others })
}

/// Runs a world to the end of the inputs, or to where a player leaves the bounds; gives the code of the error that ended it early, if one did, and the claims that do not hold then.
fn run(program: &Arc<Program>, world: WorldId, inputs: Option<&str>) -> (Option<Code>, Vec<String>) {
    let script = script_of(program, world, inputs.unwrap_or("-*120"));
    let sim = Simulator::new(program, world);
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    for (step, input) in (1..).zip(script.inputs()) {
        if sim.left_bounds(&state).is_some() {
            break;
        }
        if sim.step(&mut state, &sim.draw(0, step, input), &mut scratch).is_err() {
            return (Some(Code::Fault), Vec::new());
        }
    }
    let claims = program.worlds[world].goals.pairs().filter(|(_, goal)| goal.name.starts_with("claim_"));
    let broken = claims.filter(|(id, _)| !sim.goal(&state, *id).unwrap());
    (None, broken.map(|(_, goal)| goal.name.clone()).collect())
}

/// What is wrong with an example, if anything is.
fn trouble(block: &Block, all: &[Block]) -> Option<String> {
    let text = whole(block, all);
    let compilation = compiled(&text, block, all);
    let found: Vec<Code> = compilation.diagnostics.iter().map(|d| d.code).collect();
    let mut expected: Vec<&str> = Vec::new();
    let mut words = block.words.iter();
    while let Some(word) = words.next() {
        if word == "error" || word == "warning" {
            expected.extend(words.next().map(String::as_str));
        }
    }
    let shown = || render::human(&compilation.sources, compilation.diagnostics.iter(), false);
    if found.iter().map(|c| c.text()).ne(expected.iter().copied()) {
        return Some(format!("{} is expected\n{}\n{text}", expected.join(" "), shown()));
    }
    let program = compilation.program.as_ref()?;
    for world in program.worlds.ids() {
        let (stopped, broken) = run(program, world, block.setting("inputs"));
        if stopped.map(Code::text) != block.setting("stops") {
            return Some(format!("it stops with {stopped:?}\n{text}"));
        }
        if !broken.is_empty() {
            return Some(format!("what does not hold at the end: {}\n{text}", broken.join(", ")));
        }
    }
    None
}

#[test]
fn every_example_compiles_and_does_what_is_said() {
    let page = page();
    let all = blocks(&page);
    let mut found = Vec::new();
    let mut count = 0;
    for block in all.iter().filter(|b| b.is_program()) {
        count += 1;
        if let Some(trouble) = trouble(block, &all) {
            found.push(format!("{PAGE}:{}: {trouble}", block.line));
        }
    }
    assert!(found.is_empty(), "{} of {count} examples:\n{}", found.len(), found.join("\n"));
    assert!(count > 50, "only {count} examples were found");
}

#[test]
fn every_word_of_the_grammar_is_in_an_example() {
    let page = page();
    let used: BTreeSet<String> =
        blocks(&page).iter().filter(|b| b.is_program() && !b.is("error")).flat_map(|b| words(&b.text)).collect();
    let grammar = std::fs::read_to_string("grammar/hyped.pest").unwrap();
    let rules = grammar.lines().filter(|l| l.starts_with("kw_") || l.starts_with("word_"));
    let missing: Vec<&str> = rules.filter_map(|l| l.split('"').nth(1)).filter(|w| !used.contains(*w)).collect();
    assert!(missing.is_empty(), "no example shows {missing:?}");
}

/// The table of codes is that of the catalogue: `UPDATE=1 cargo test --test language reference` rewrites it.
#[test]
fn every_code_is_listed_and_no_other() {
    const TABLE: &str = "\n| code | meaning |\n|---|---|\n";
    let page = page();
    let (before, rest) = page.split_once(TABLE).unwrap();
    assert!(before.rsplit("\n## ").next().unwrap().starts_with("All codes\n"));
    let after = rest.find("\n\n").map_or("", |end| &rest[end + 1..]);
    let rows: String = Code::ALL.iter().map(|code| format!("| `{code}` | {} |\n", code.title())).collect();
    let generated = format!("{before}{TABLE}{rows}{after}");
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(PAGE, &generated).unwrap();
    } else {
        assert!(page == generated, "`UPDATE=1 cargo test --test language reference` writes the table of codes");
    }
    let known: BTreeSet<&str> = Code::ALL.iter().map(|c| c.text()).collect();
    for word in words(&page) {
        let is_code = word.len() == 5 && word.starts_with(['E', 'W']) && word[1..].bytes().all(|b| b.is_ascii_digit());
        assert!(!is_code || known.contains(word.as_str()), "{PAGE} speaks of {word}, which is no code");
    }
}

#[test]
fn every_link_leads_to_a_heading() {
    let page = page();
    let mut anchors = BTreeSet::new();
    let mut is_code = false;
    for line in page.lines() {
        is_code ^= line.starts_with("```");
        if let Some(heading) = line.strip_prefix('#').filter(|_| !is_code) {
            let heading = heading.trim_start_matches('#').trim().to_lowercase();
            let kept = heading.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
            let anchor: String = kept.map(|c| if c == ' ' { '-' } else { c }).collect();
            assert!(anchors.insert(anchor.clone()), "two headings are called {anchor}");
        }
    }
    let links: Vec<&str> = page.match_indices("](#").map(|(at, _)| page[at + 3..].split(')').next().unwrap()).collect();
    assert!(links.len() >= anchors.len() / 2, "the page has a table of contents");
    for link in links {
        assert!(anchors.contains(link), "#{link} leads nowhere");
    }
}
