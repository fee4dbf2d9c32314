//! Facts about files of other systems that are imported.

use super::{did_you_mean, list};
use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::Span;

/// The most characters of a text of the file that are shown.
const SHOWN: usize = 120;

/// A text of the file for a message: on one line, and not longer than can be read.
fn shown(text: &str) -> String {
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match words.char_indices().nth(SHOWN) {
        Some((at, _)) => format!("{}…", &words[..at]),
        None => words,
    }
}

/// A file that cannot be taken apart.
pub struct NotWellFormed {
    /// What is wrong with it.
    pub what: String,
    /// Where.
    pub at: Span,
    /// A way out.
    pub help: Option<String>,
}

impl Fact for NotWellFormed {
    fn into_diagnostic(self) -> Diagnostic {
        let d = Diagnostic::new(Code::NotWellFormed, shown(&self.what)).at(self.at, "here");
        self.help.into_iter().fold(d, Diagnostic::help)
    }
}

/// A part of an entity file that does not follow its form.
pub struct BadForm {
    /// In what respect.
    pub misfit: Misfit,
    /// Where.
    pub at: Span,
}

/// How something does not follow the form.
pub enum Misfit {
    /// The outermost element is another one.
    Root {
        /// Its name.
        name: String,
    },
    /// An attribute that the element does not have.
    Attribute {
        /// Its name.
        name: String,
        /// The element.
        owner: &'static str,
        /// One of its attributes that is spelt nearly so.
        near: Option<String>,
    },
    /// An attribute is not given.
    NoAttribute {
        /// Its name.
        name: &'static str,
        /// The element.
        owner: &'static str,
    },
    /// An element that cannot be in the other one.
    Element {
        /// Its name.
        name: String,
        /// What it is in.
        owner: &'static str,
        /// One that may be there and is spelt nearly so.
        near: Option<String>,
        /// Whether it may be elsewhere.
        elsewhere: bool,
    },
    /// An element is not there.
    NoElement {
        /// Its name.
        name: &'static str,
        /// Where it is missing.
        owner: &'static str,
    },
    /// A second element where there may be one.
    Twice {
        /// Its name.
        name: String,
        /// What it is in.
        owner: &'static str,
    },
    /// Text between elements.
    Text {
        /// What it is in.
        owner: &'static str,
    },
    /// A word that is none of those possible.
    Word {
        /// The word.
        found: String,
        /// Those possible.
        known: &'static [&'static str],
    },
    /// A name that nothing declares.
    Unknown {
        /// What was looked for: `mode`.
        kind: &'static str,
        /// The name.
        name: String,
        /// One that is spelt nearly so.
        near: Option<String>,
    },
    /// A name that fits several modes.
    Ambiguous {
        /// The name.
        name: String,
        /// The paths of those modes.
        paths: Vec<String>,
    },
    /// A second declaration of a name.
    Declared {
        /// What is declared.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// An expression that cannot be read.
    Expression {
        /// Why.
        why: String,
    },
}

impl Fact for BadForm {
    fn into_diagnostic(self) -> Diagnostic {
        let form = |message: String| Diagnostic::new(Code::BadForm, message);
        let at = self.at;
        let name = |text: &String| shown(text);
        match &self.misfit {
            Misfit::Root { name: found } => form(format!("an entity is an `<automaton>`, not a `<{}>`", name(found)))
                .at(at, "the outermost element")
                .help("import the files that are called `NAME.char.xml`"),
            Misfit::Attribute { name: found, owner, near } => {
                let hint = did_you_mean(near.as_ref());
                form(format!("`<{owner}>` has no attribute `{}`{hint}", name(found))).at(at, "it is not looked at")
            }
            Misfit::NoAttribute { name, owner } => form(format!("`<{owner}>` has no `{name}`"))
                .at(at, "without it, this is left out")
                .help(format!("add `{name}=\"…\"`")),
            Misfit::Element { name: found, owner, near, elsewhere } => {
                let found = name(found);
                let message = if *elsewhere {
                    format!("`<{found}>` is not allowed in `<{owner}>`")
                } else {
                    format!("there is no `<{found}>` in the form of entities{}", did_you_mean(near.as_ref()))
                };
                form(message).at(at, "left out")
            }
            Misfit::NoElement { name, owner } => form(format!("`<{owner}>` holds no `<{name}>`"))
                .at(at, "without it, this is left out")
                .help(format!("add a `<{name}>`")),
            Misfit::Twice { name, owner } => form(format!("a second `<{name}>` in one `<{owner}>`"))
                .at(at, "only one is allowed there: all of it is left out")
                .help("put both in one, or take one out"),
            Misfit::Text { owner } => {
                form(format!("text is in `<{owner}>`")).at(at, "left out").help("make a comment of it: `<!-- … -->`")
            }
            Misfit::Word { found, known } => {
                let words: Vec<String> = known.iter().map(|w| format!("`{w}`")).collect();
                form(format!("`{}` is none of the words that are allowed here", name(found)))
                    .at(at, "not known")
                    .help(format!("write {}", list(&words, "or")))
            }
            Misfit::Unknown { kind, name: found, near } => {
                form(format!("no {kind} named `{}`{}", name(found), did_you_mean(near.as_ref()))).at(at, "not declared")
            }
            Misfit::Ambiguous { name: found, paths } => {
                let paths: Vec<String> = paths.iter().map(|p| format!("`{}`", name(p))).collect();
                form(format!("`{}` can be several modes", name(found)))
                    .at(at, "which one?")
                    .help(format!("write {}", list(&paths, "or")))
            }
            Misfit::Declared { kind, name: found } => form(format!("a second {kind} named `{}`", name(found)))
                .at(at, "left out: the first one counts")
                .help(if matches!(*kind, "flow" | "update") { "keep one of them" } else { "give it another name" }),
            Misfit::Expression { why } => form(format!("this expression cannot be read: {why}")).at(at, "here"),
        }
    }
}

/// Something that has a meaning there and none here.
pub struct NotCarriedOver {
    /// What it is.
    pub what: String,
    /// Why it cannot be carried over.
    pub why: String,
    /// Where.
    pub at: Span,
    /// A way out.
    pub help: String,
}

impl Fact for NotCarriedOver {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::NotCarriedOver, format!("{} cannot be carried over", shown(&self.what)))
            .at(self.at, self.why)
            .help(self.help)
    }
}

/// A name that cannot stay as it is.
pub struct Renamed {
    /// What it names: `mode`.
    pub kind: &'static str,
    /// The name there.
    pub from: String,
    /// The name here.
    pub to: String,
    /// Why: `a word of the language`.
    pub why: &'static str,
    /// Where it is declared.
    pub at: Span,
}

impl Fact for Renamed {
    fn into_diagnostic(self) -> Diagnostic {
        let Renamed { kind, from, to, why, at } = self;
        Diagnostic::new(Code::Renamed, format!("the {kind} `{}` is called `{}`", shown(&from), shown(&to))).at(at, why)
    }
}

/// Something that has no effect there.
pub struct LeftOut {
    /// What it is.
    pub what: String,
    /// Why it has no effect.
    pub why: String,
    /// Where.
    pub at: Span,
}

impl Fact for LeftOut {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::LeftOut, format!("{} is left out", shown(&self.what))).at(self.at, self.why)
    }
}

/// Something that a file does not say, and that is taken for likely.
pub struct Assumed {
    /// What is assumed.
    pub what: String,
    /// Where it is not said.
    pub at: Span,
    /// What to do if it is not so.
    pub help: String,
}

impl Fact for Assumed {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::Assumed, self.what).at(self.at, "here").help(self.help)
    }
}

/// A whole number that has no bounds there.
pub struct Bounded {
    /// Its name.
    pub name: String,
    /// The least and the greatest value that it is given.
    pub range: (i64, i64),
    /// Where it is declared.
    pub at: Span,
}

impl Fact for Bounded {
    fn into_diagnostic(self) -> Diagnostic {
        let (low, high) = self.range;
        Diagnostic::new(Code::Bounded, format!("`{}` is given the range {low}..{high}", shown(&self.name)))
            .at(self.at, "a number without bounds")
            .note("its updates are kept in the range")
            .help("narrow it to what the game needs: searches then have less to cover")
    }
}
