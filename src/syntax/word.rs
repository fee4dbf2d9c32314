//! Names and reserved words of the grammar, for stages that create names or read them from elsewhere; and interned
//! words.

use std::borrow::Borrow;
use std::fmt;
use std::ops::Deref;
use std::path::Path;
use std::sync::Arc;

use serde::{Serialize, Serializer};

use pest::Parser;

use super::{Grammar, MAX_WORD, Rule};

/// Whether a whole text fits a rule.
fn fits(rule: Rule, text: &str) -> bool {
    let found = Grammar::parse(rule, text).ok().and_then(|mut pairs| pairs.next());
    found.is_some_and(|pair| pair.as_str().len() == text.len())
}

/// Whether a text is a valid name: not reserved, and not too long.
pub fn is_name(text: &str) -> bool {
    text.len() <= MAX_WORD && fits(Rule::name, text)
}

/// Whether a word is reserved: never a name.
pub fn is_reserved(text: &str) -> bool {
    fits(Rule::reserved, text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_words_are_those_of_the_grammar() {
        for name in ["a", "_", "x2", "größe", "models", "goal"] {
            assert!(is_name(name) && !is_reserved(name), "{name}");
        }
        for word in ["mode", "true", "const"] {
            assert!(!is_name(word) && is_reserved(word), "{word}");
        }
        for neither in ["", " a", "a ", "a b", "2d", "a'", "mode ", "-"] {
            assert!(!is_name(neither) && !is_reserved(neither), "{neither:?}");
        }
        assert!(is_name(&"a".repeat(MAX_WORD)) && !is_name(&"a".repeat(MAX_WORD + 1)));
    }
}

/// An interned word: copies share the text. A tree has many more copies than distinct words, so each copy is one
/// pointer.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Word(Arc<Box<str>>);

impl Word {
    /// The text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl Deref for Word {
    type Target = str;
    fn deref(&self) -> &str {
        &self.0
    }
}

impl Borrow<str> for Word {
    fn borrow(&self) -> &str {
        &self.0
    }
}

impl AsRef<Path> for Word {
    fn as_ref(&self) -> &Path {
        Path::new(self.as_str())
    }
}

impl<S: Into<Box<str>>> From<S> for Word {
    fn from(text: S) -> Self {
        Word(Arc::new(text.into()))
    }
}

impl PartialEq<str> for Word {
    fn eq(&self, other: &str) -> bool {
        **self.0 == *other
    }
}

impl PartialEq<&str> for Word {
    fn eq(&self, other: &&str) -> bool {
        **self.0 == **other
    }
}

impl PartialEq<String> for Word {
    fn eq(&self, other: &String) -> bool {
        **self.0 == **other
    }
}

impl PartialEq<Word> for String {
    fn eq(&self, other: &Word) -> bool {
        **self == **other.0
    }
}

impl PartialEq<Word> for &str {
    fn eq(&self, other: &Word) -> bool {
        **self == **other.0
    }
}

impl fmt::Debug for Word {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl fmt::Display for Word {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl Serialize for Word {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.0)
    }
}
