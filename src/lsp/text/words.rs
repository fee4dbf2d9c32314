//! The vocabulary of the language: the keywords and snippets that can start a statement.

use crate::diagnostic::words::meaning;
use crate::syntax::opening_keywords;

use super::cursor::Block;

/// Names in the grammar that have a predefined meaning in some positions.
const SPECIAL: &[&str] = &["left", "right", "above", "below", "rect", "circle", "empty"];

/// Whether a word is a keyword, given that it is no name of the program.
pub(in crate::lsp) fn is_keyword(word: &str) -> bool {
    // Outside of `16 x 16`, `x` is a variable.
    word != "x" && meaning(word).is_some() || SPECIAL.contains(&word)
}

/// A completion text with placeholders.
pub(in crate::lsp) struct Snippet {
    pub label: &'static str,
    pub text: &'static str,
    pub detail: &'static str,
}

const fn snippet(label: &'static str, text: &'static str, detail: &'static str) -> Snippet {
    Snippet { label, text, detail }
}

const WHEN: Snippet = snippet("when …", "when ${1:guard} -> ${2:mode}", "an edge to another mode");
const MODE: Snippet = snippet("mode …", "mode ${1:name} {\n    $0\n}", "a mode");
const CONDITION: Snippet = snippet("condition …", "condition ${1:name} = ${2:guard}", "a name for a guard");
const ENVELOPE: Snippet = snippet(
    "envelope …",
    "envelope ${1:x'} by ${2:axis} {\n    attack accel ${3:400}\n    sustain ${4:100}\n    release accel ${5:400}\n}",
    "attack, decay, sustain, release",
);

/// The keywords that can start a member of an entity, and of a mode. The grammar accepts all of them in both.
const IN_ENTITIES: &[&str] = &[
    "param",
    "continuous",
    "discrete",
    "ref",
    "button",
    "axis",
    "chance",
    "collider",
    "kinematic",
    "clamp",
    "invariant",
    "condition",
    "signal",
    "group",
    "mode",
    "initial",
    "always",
    "envelope",
    "use",
    "look",
];
const IN_MODES: &[&str] =
    &["mode", "initial", "condition", "when", "else", "envelope", "follow", "spawn", "destroy", "send", "use"];

/// The keywords and snippets that can start a statement in a block, or at the top level.
pub(in crate::lsp) fn statement_starts(block: Option<Block>) -> (&'static [&'static str], &'static [Snippet]) {
    match block {
        None => (opening_keywords("good_item"), ITEMS),
        Some(Block::Entity | Block::Behavior) => (IN_ENTITIES, MEMBERS),
        Some(Block::Group) => (opening_keywords("mode"), &[MODE]),
        Some(Block::Mode) => (IN_MODES, &[WHEN, MODE, ENVELOPE]),
        Some(Block::Updates) => (opening_keywords("good_update"), &[]),
        Some(Block::Envelope) => (opening_keywords("good_ramp"), &[]),
        Some(Block::World) => (opening_keywords("good_world_item"), WORLD_ITEMS),
        Some(Block::Space) => (opening_keywords("good_space_item"), SPACE_ITEMS),
        Some(Block::Test) => (opening_keywords("good_test_item"), TEST_ITEMS),
        Some(Block::Tiles | Block::Settings | Block::Kinds | Block::Other) => (&[], &[]),
    }
}

/// The usual order of the statements of a block, by their first words; an empty word stands for an assignment.
pub(in crate::lsp) fn usual_order(block: Option<Block>) -> &'static [&'static str] {
    match block {
        None => &["import", "const", "behavior", "entity", "world"],
        Some(Block::Entity | Block::Behavior) => &[
            "look",
            "param",
            "axis",
            "button",
            "ref",
            "continuous",
            "discrete",
            "chance",
            "signal",
            "kinematic",
            "collider",
            "clamp",
            "invariant",
            "condition",
            "use",
            "",
            "envelope",
            "mode",
            "initial",
            "group",
            "always",
            "when",
            "else",
            "follow",
        ],
        Some(Block::World) => {
            &["step", "collide", "limit", "look", "tiles", "space", "player", "condition", "goal", "never", "test"]
        }
        Some(Block::Space) => &["bounds", "wrap", "map", "rect", "place", "link"],
        Some(Block::Mode) => &[
            "condition",
            "use",
            "",
            "envelope",
            "follow",
            "when",
            "else",
            "mode",
            "initial",
            "spawn",
            "destroy",
            "send",
        ],
        Some(Block::Group) => &["mode", "initial"],
        Some(Block::Envelope) => &["attack", "decay", "sustain", "release", "while"],
        Some(Block::Test) => &["inputs", "chance", "expect", "reachable", "unreachable", "never", "unfound"],
        Some(Block::Updates | Block::Tiles | Block::Settings | Block::Kinds | Block::Other) => &[],
    }
}

const ITEMS: &[Snippet] = &[
    snippet("entity …", "entity ${1:Name} {\n    $0\n}", "an entity"),
    snippet(
        "world …",
        "world ${1:Name} {\n    step 1/60\n\n    space main {\n        $0\n    }\n}",
        "a world with a space",
    ),
    snippet("import …", "import \"${1:file.hyped}\"", "what another file declares"),
];

const MEMBERS: &[Snippet] = &[
    MODE,
    ENVELOPE,
    snippet("always …", "always {\n    when ${1:guard} { $0 }\n}", "edges whatever modes are active"),
    snippet("group …", "group ${1:name} {\n    $0\n}", "modes that run beside others"),
    snippet("collider …", "collider ${1:body}: rect(${2:0, 0, 16, 16})", "a shape with tags"),
    CONDITION,
    snippet("chance …", "chance ${1:name}: ${2:1}..${3:6}", "a whole number that each step draws"),
    snippet("discrete …", "discrete ${1:name}: int ${2:0}..${3:9} = ${4:0}", "a whole number"),
];

const WORLD_ITEMS: &[Snippet] = &[
    snippet("goal …", "goal ${1:name}: ${2:predicate}", "what `hypedc reach` looks for"),
    snippet("never …", "never ${1:name}: ${2:predicate}", "what must not happen"),
    snippet("collide …", "collide ${1:body} with ${2:wall}: block", "what a contact does"),
    snippet("space …", "space ${1:main} {\n    $0\n}", "a room"),
    snippet("test …", "test \"${1:it works}\" {\n    $0\n}", "what `hypedc test` checks"),
];

const TEST_ITEMS: &[Snippet] = &[
    snippet("inputs …", "inputs \"${1:right*60}\"", "what players do in the run of the test"),
    snippet("expect … at", "expect ${1:predicate} at ${2:1s}", "what holds at a time of the run"),
    snippet("expect … always", "expect ${1:predicate} always", "what holds in the whole run"),
    snippet("reachable … within", "reachable ${1:goal} within ${2:20s}", "a way is found"),
    snippet(
        "unreachable … without",
        "unreachable ${1:goal} without ${2:predicate}",
        "it is proven that there is no way",
    ),
];

const SPACE_ITEMS: &[Snippet] =
    &[snippet("place …", "place ${1:name}: ${2:Entity} at (${3:0}, ${4:0})", "an instance")];

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::diagnostic::words::{MEANINGS, SIGNATURES};
    use crate::sema::FUNCTIONS;
    use crate::syntax::keywords;

    #[test]
    fn members_begin_with_the_words_of_the_grammar() {
        let offered: BTreeSet<&str> = IN_ENTITIES.iter().chain(IN_MODES).copied().collect();
        assert_eq!(offered, opening_keywords("good_member").iter().copied().collect());
    }

    #[test]
    fn every_keyword_has_a_meaning() {
        let all: Vec<&str> = keywords().iter().map(|keyword| keyword.word).collect();
        let without: Vec<&&str> = all.iter().filter(|word| meaning(word).is_none()).collect();
        assert!(without.is_empty(), "no text for {without:?}");
        let unknown: Vec<&str> = MEANINGS.iter().map(|m| m.word).filter(|word| !all.contains(word)).collect();
        assert!(unknown.is_empty(), "no words of the grammar: {unknown:?}");
    }

    #[test]
    fn every_function_has_a_signature() {
        let described: BTreeSet<&str> = SIGNATURES.iter().map(|signature| signature.name).collect();
        // Shapes are written like functions.
        assert_eq!(described, FUNCTIONS.iter().copied().chain(["rect", "circle"]).collect());
    }
}
