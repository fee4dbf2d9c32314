//! Facts about files of other systems that are imported.

use super::{did_you_mean, list};
use crate::diagnostic::{Code, Diagnostic, Fact};
use crate::source::Span;

/// Maximum number of characters of a text of the file in a message.
const SHOWN: usize = 120;

/// A text of the file for a message: on one line, shortened to [`SHOWN`] characters.
fn shown(text: &str) -> String {
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match words.char_indices().nth(SHOWN) {
        Some((at, _)) => format!("{}…", &words[..at]),
        None => words,
    }
}

/// A file that cannot be parsed.
pub struct NotWellFormed {
    /// The error.
    pub what: String,
    /// Where.
    pub at: Span,
    /// A suggestion.
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
    /// The difference.
    pub misfit: Misfit,
    /// Where.
    pub at: Span,
}

/// The way in which a file differs from the form.
pub enum Misfit {
    /// An unexpected root element.
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
        /// A similar attribute of the element.
        near: Option<String>,
    },
    /// A missing attribute.
    NoAttribute {
        /// Its name.
        name: &'static str,
        /// The element.
        owner: &'static str,
    },
    /// An element that the element around cannot hold.
    Element {
        /// Its name.
        name: String,
        /// The element around.
        owner: &'static str,
        /// A similar element that is allowed there.
        near: Option<String>,
        /// Whether it is allowed elsewhere.
        elsewhere: bool,
    },
    /// A missing element.
    NoElement {
        /// Its name.
        name: &'static str,
        /// The element that lacks it.
        owner: &'static str,
    },
    /// A second element where one is allowed.
    Twice {
        /// Its name.
        name: String,
        /// The element around.
        owner: &'static str,
    },
    /// Text between elements.
    Text {
        /// The element around.
        owner: &'static str,
    },
    /// A word that is not one of the keywords allowed here.
    Word {
        /// The word.
        found: String,
        /// The allowed ones.
        known: &'static [&'static str],
    },
    /// A name that nothing declares.
    Unknown {
        /// The kind of name: `mode`.
        kind: &'static str,
        /// The name.
        name: String,
        /// A similar name.
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
        /// The kind of declaration.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// An expression that cannot be parsed.
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

/// A feature of the imported format that this language does not have.
pub struct NotCarriedOver {
    /// What it is.
    pub what: String,
    /// The reason why it cannot be imported.
    pub why: String,
    /// Where.
    pub at: Span,
    /// A suggestion.
    pub help: String,
}

impl Fact for NotCarriedOver {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::NotCarriedOver, format!("{} cannot be carried over", shown(&self.what)))
            .at(self.at, self.why)
            .help(self.help)
    }
}

/// A name that must change.
pub struct Renamed {
    /// The kind of its declaration: `mode`.
    pub kind: &'static str,
    /// The name in the imported file.
    pub from: String,
    /// The name in the program.
    pub to: String,
    /// The reason: `a word of the language`.
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

/// An ignored part of the file: it has no effect in its system.
pub struct LeftOut {
    /// What it is.
    pub what: String,
    /// The reason.
    pub why: String,
    /// Where.
    pub at: Span,
}

impl Fact for LeftOut {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::LeftOut, format!("{} is left out", shown(&self.what))).at(self.at, self.why)
    }
}

/// A default for something that the file does not specify.
pub struct Assumed {
    /// The assumption.
    pub what: String,
    /// The place that lacks it.
    pub at: Span,
    /// The change to make if the assumption is wrong.
    pub help: String,
}

impl Fact for Assumed {
    fn into_diagnostic(self) -> Diagnostic {
        Diagnostic::new(Code::Assumed, self.what).at(self.at, "here").help(self.help)
    }
}

/// A discrete variable without bounds in the imported file.
pub struct Bounded {
    /// Its name.
    pub name: String,
    /// The smallest and the largest value assigned to it.
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
