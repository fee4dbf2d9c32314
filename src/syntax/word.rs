//! What the grammar takes for a name, and what for a word of its own; for the stages that make names or read them from
//! elsewhere.

use pest::Parser;

use super::{Grammar, MAX_WORD, Rule};

/// Whether a whole text fits a rule.
fn fits(rule: Rule, text: &str) -> bool {
    let found = Grammar::parse(rule, text).ok().and_then(|mut pairs| pairs.next());
    found.is_some_and(|pair| pair.as_str().len() == text.len())
}

/// Whether a text can be a name as it stands: not a word that the grammar keeps for itself, and not too long.
pub fn is_name(text: &str) -> bool {
    text.len() <= MAX_WORD && fits(Rule::name, text)
}

/// Whether the grammar keeps a word for itself: it is never a name.
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
