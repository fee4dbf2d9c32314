//! What the editor of the playground asks and what it is answered. All offsets count UTF-16 code units from the start of
//! the text, as browsers do.

use serde::{Deserialize, Serialize};

/// A request.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(tag = "ask", rename_all = "snake_case")]
pub enum Request {
    /// Opens a document or replaces its text, compiles, and answers its findings.
    Document {
        /// Its path.
        path: String,
        /// Its text; lines end with `\n`.
        text: String,
    },
    /// As `document` of the text that is known, with the findings of the analysis of values. Takes longer.
    Analyze {
        /// The path of a program.
        path: String,
    },
    /// The words of the language.
    Keywords,
    /// What can be written at a position.
    Completion {
        /// The document.
        path: String,
        /// The position.
        at: usize,
    },
    /// What is known about the word at a position.
    Hover {
        /// The document.
        path: String,
        /// The position.
        at: usize,
    },
    /// The function whose arguments are at a position.
    Signature {
        /// The document.
        path: String,
        /// The position.
        at: usize,
    },
    /// Where the name at a position is declared.
    Definition {
        /// The document.
        path: String,
        /// The position.
        at: usize,
    },
    /// The edits that format a document.
    Format {
        /// The document.
        path: String,
    },
    /// The outline of a document.
    Symbols {
        /// The document.
        path: String,
    },
    /// The tokens of a document.
    Tokens {
        /// The document.
        path: String,
    },
}

/// An answer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "answer", rename_all = "snake_case")]
pub enum Answer {
    /// Findings, in the order of their places.
    Findings {
        /// All of them, those in imported files included.
        findings: Vec<Finding>,
    },
    /// The words of the language.
    Keywords {
        /// Keywords of the grammar.
        keywords: Vec<String>,
        /// Functions of the language.
        functions: Vec<String>,
    },
    /// What can be written.
    Completion {
        /// Start of what an item replaces.
        from: usize,
        /// Its end.
        to: usize,
        /// The items, best first.
        items: Vec<Completion>,
        /// Whether one of the first is likely. A list that nobody asked for is worth opening only then.
        likely: bool,
    },
    /// What is known about a word.
    Hover {
        /// Its start.
        from: usize,
        /// Its end.
        to: usize,
        /// The text, in Markdown.
        markdown: String,
    },
    /// The signatures of a function.
    Signatures {
        /// At least one.
        signatures: Vec<Signature>,
        /// Index of the one that fits.
        active: usize,
        /// Index of the argument.
        argument: usize,
    },
    /// A declaration.
    Definition {
        /// Its file.
        path: String,
        /// Its start.
        from: usize,
        /// Its end.
        to: usize,
    },
    /// Edits of the document; their ranges do not overlap, and refer to its text before all of them.
    Edits {
        /// All edits, in order.
        edits: Vec<Edit>,
    },
    /// The outline.
    Symbols {
        /// The parts of the file, in order.
        symbols: Vec<Symbol>,
    },
    /// Tokens in order.
    Tokens {
        /// The kinds.
        kinds: Vec<String>,
        /// Start, end, index of the kind.
        tokens: Vec<[usize; 3]>,
    },
    /// There is nothing to tell.
    Nothing,
}

/// A finding.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// The file.
    pub path: String,
    /// The start of its place.
    pub from: usize,
    /// The end of its place.
    pub to: usize,
    /// `error` or `warning`.
    pub severity: String,
    /// Its code.
    pub code: String,
    /// Its message, with helps and notes in lines of their own.
    pub message: String,
    /// Whether the place has no effect.
    pub is_unnecessary: bool,
    /// A certain repair.
    pub fix: Option<Fix>,
}

/// A repair.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Fix {
    /// What it does.
    pub title: String,
    /// How.
    pub edits: Vec<Edit>,
}

/// A replacement.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Edit {
    /// The start of what is replaced.
    pub from: usize,
    /// Its end.
    pub to: usize,
    /// The new text.
    pub text: String,
}

/// What can be written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Completion {
    /// The name.
    pub label: String,
    /// Its kind: `mode`, `keyword`, …
    pub kind: String,
    /// A few words; may be empty.
    pub detail: String,
    /// Items that fit better have lower ranks.
    pub rank: u8,
    /// A text with placeholders such as `$1` in place of the label.
    pub snippet: Option<String>,
}

/// A signature of a function.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Signature {
    /// The name.
    pub name: String,
    /// The names of its parameters.
    pub parameters: Vec<String>,
    /// What it does; may be empty.
    pub doc: String,
}

/// A part of a file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Symbol {
    /// Its name.
    pub name: String,
    /// A few words.
    pub detail: Option<String>,
    /// Its start.
    pub from: usize,
    /// Its end.
    pub to: usize,
    /// The start of its name.
    pub name_from: usize,
    /// The end of its name.
    pub name_to: usize,
    /// Its parts.
    pub children: Vec<Symbol>,
}
