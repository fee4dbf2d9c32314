//! Parser of the pages that explain codes: `catalogue/pages/E0302.md` as prose and examples.
//!
//! A page begins with `# CODE: TITLE`, then comes prose, then examples. An example is a fenced block; what follows on the
//! line of its fence says what it is and how it is tested:
//!
//! - ` ```hyped wrong `: a program in which this error is found and no other; ` ```hyped right `: the same, repaired, in
//!   which nothing is found, and whose worlds run 100 steps;
//! - `file="other.hyped"`: the block is a file of this name; of both sides, unless it says `wrong` or `right`;
//! - `inputs="jump -*60"`: the code is found when the program is run with these inputs;
//! - ` ```sh wrong `: commands in a folder that holds the page's files; the code is among what they find;
//! - `dots=" + 1" times="300"`: `…` stands for 300 times this text; with several `dots`, for one after the other;
//! - `encoding="latin-1"`: the file is saved like this, and not as UTF-8.

use super::Code;

/// A page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Page<'a> {
    /// The heading, without its `#`.
    pub title: &'a str,
    /// The parts below it, in order.
    pub parts: Vec<Part<'a>>,
}

/// A piece of a page.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Part<'a> {
    /// The lines of a paragraph.
    Prose(Vec<&'a str>),
    /// A fenced block.
    Example(Example<'a>),
}

/// The side of an example.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The mistake.
    Wrong,
    /// The repaired program.
    Right,
}

/// A fenced block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Example<'a> {
    /// Its language: `hyped`.
    pub language: &'a str,
    /// Its side; none if it belongs to both.
    pub side: Option<Side>,
    /// Its lines.
    pub lines: Vec<&'a str>,
    settings: Vec<(&'a str, &'a str)>,
}

impl<'a> Example<'a> {
    /// The first value of a setting.
    pub fn setting(&self, key: &str) -> Option<&'a str> {
        self.settings(key).next()
    }

    /// All values of a setting.
    pub fn settings(&self, key: &str) -> impl Iterator<Item = &'a str> {
        self.settings.iter().filter(move |(k, _)| *k == key).map(|(_, value)| *value)
    }

    /// The names of all settings.
    pub fn keys(&self) -> impl Iterator<Item = &'a str> {
        self.settings.iter().map(|(key, _)| *key)
    }

    fn new(fence: &'a str, lines: Vec<&'a str>) -> Self {
        let (mut words, mut settings) = (Vec::new(), Vec::new());
        // Every second part is between quotes, its key before them.
        let mut parts = fence.split('"');
        while let Some(part) = parts.next() {
            words.extend(part.split_whitespace());
            if let Some(value) = parts.next() {
                settings.push((words.pop().unwrap_or_default().trim_end_matches('='), value));
            }
        }
        let side = match words.get(1) {
            Some(&"wrong") => Some(Side::Wrong),
            Some(&"right") => Some(Side::Right),
            _ => None,
        };
        Example { language: words.first().copied().unwrap_or_default(), side, lines, settings }
    }
}

impl<'a> Page<'a> {
    /// Parses a text.
    pub fn new(text: &'a str) -> Self {
        let mut lines = text.lines();
        let title = lines.next().unwrap_or_default().trim_start_matches("# ");
        let (mut parts, mut prose) = (Vec::new(), Vec::new());
        while let Some(line) = lines.next() {
            let fence = line.strip_prefix("```");
            if (line.is_empty() || fence.is_some()) && !prose.is_empty() {
                parts.push(Part::Prose(std::mem::take(&mut prose)));
            }
            if let Some(fence) = fence {
                let block = lines.by_ref().take_while(|line| *line != "```").collect();
                parts.push(Part::Example(Example::new(fence, block)));
            } else if !line.is_empty() {
                prose.push(line);
            }
        }
        if !prose.is_empty() {
            parts.push(Part::Prose(prose));
        }
        Page { title, parts }
    }

    /// The page of a code.
    pub fn of(code: Code) -> Page<'static> {
        Page::new(code.page())
    }

    /// The examples.
    pub fn examples(&self) -> impl Iterator<Item = &Example<'a>> {
        self.parts.iter().filter_map(|part| match part {
            Part::Example(example) => Some(example),
            Part::Prose(_) => None,
        })
    }
}
