//! The words of the language with their descriptions, for hovers and for `hypedc explain`: keywords, and functions with
//! the atoms of guards.

mod functions;
mod keywords;

pub use functions::{SIGNATURES, Signature};
pub use keywords::{KNOWN_NAMES, MEANINGS, Meaning, meaning};

/// What there is to say of a word.
#[derive(Debug, Clone)]
pub struct Explained {
    /// The word.
    pub word: &'static str,
    /// The ways to call it, if it is a function.
    pub calls: Vec<&'static Signature>,
    /// Its description, if it is a keyword or a name that every program has.
    pub meaning: Option<&'static Meaning>,
}

/// What there is to say of a word of the language; none of another word.
pub fn explained(word: &str) -> Option<Explained> {
    let calls: Vec<&Signature> = SIGNATURES.iter().filter(|signature| signature.name == word).collect();
    let meaning = meaning(word).or_else(|| KNOWN_NAMES.iter().find(|known| known.word == word));
    let word = meaning.map(|meaning| meaning.word).or(calls.first().map(|call| call.name))?;
    Some(Explained { word, calls, meaning })
}

/// All words: keywords, names that every program has, functions.
pub fn all() -> impl Iterator<Item = &'static str> {
    let keywords = MEANINGS.iter().chain(KNOWN_NAMES).map(|meaning| meaning.word);
    keywords.chain(SIGNATURES.iter().map(|signature| signature.name))
}
