//! The vocabulary of the language: keywords, functions and their signatures, and the keywords and snippets that can
//! start a statement.

use crate::syntax::opening_keywords;

use super::cursor::Block;
use super::meanings::meaning;

/// Names in the grammar that have a predefined meaning in some positions.
const SPECIAL: &[&str] = &["left", "right", "above", "below", "rect", "circle", "empty"];

/// Whether a word is a keyword, given that it is no name of the program.
pub(in crate::lsp) fn is_keyword(word: &str) -> bool {
    // Outside of `16 x 16`, `x` is a variable.
    word != "x" && meaning(word).is_some() || SPECIAL.contains(&word)
}

/// The names of all functions.
pub(in crate::lsp) const FUNCTIONS: &[&str] = &[
    "min", "max", "abs", "sign", "clamp", "floor", "ceil", "round", "sqrt", "sin", "cos", "atan2", "mod", "if",
    "pressed", "held", "released", "touching", "timer", "entering", "exiting", "lost", "near", "inside", "rect",
    "circle",
];

/// A signature of a function.
pub(in crate::lsp) struct Signature {
    pub name: &'static str,
    pub parameters: &'static [&'static str],
    pub doc: &'static str,
}

/// The signatures of all functions; overloads of a function are adjacent.
pub(in crate::lsp) const SIGNATURES: &[Signature] = &[
    Signature { name: "min", parameters: &["a", "b"], doc: "The smaller of two numbers." },
    Signature { name: "max", parameters: &["a", "b"], doc: "The larger of two numbers." },
    Signature { name: "abs", parameters: &["a"], doc: "The size of a number, without its sign." },
    Signature { name: "sign", parameters: &["a"], doc: "-1, 0 or 1." },
    Signature { name: "clamp", parameters: &["value", "low", "high"], doc: "The nearest number between two." },
    Signature { name: "floor", parameters: &["a"], doc: "The next whole number below." },
    Signature { name: "ceil", parameters: &["a"], doc: "The next whole number above." },
    Signature { name: "round", parameters: &["a"], doc: "The nearest whole number, half away from zero." },
    Signature { name: "sqrt", parameters: &["a"], doc: "The square root; of a negative number it stops the step." },
    Signature { name: "sin", parameters: &["angle"], doc: "The sine of an angle in radians." },
    Signature { name: "cos", parameters: &["angle"], doc: "The cosine of an angle in radians." },
    Signature { name: "atan2", parameters: &["y", "x"], doc: "The angle of a direction, in radians." },
    Signature {
        name: "mod",
        parameters: &["a", "b"],
        doc: "`a` less the whole multiple of `b` below it: from 0 to before `b`.",
    },
    Signature { name: "if", parameters: &["condition", "a", "b"], doc: "`a` if the condition holds, else `b`." },
    Signature { name: "pressed", parameters: &["button"], doc: "The button went down at this step." },
    Signature { name: "held", parameters: &["button"], doc: "The button is down." },
    Signature { name: "released", parameters: &["button"], doc: "The button went up at this step." },
    Signature { name: "touching", parameters: &["tag"], doc: "A collider touches something with the tag." },
    Signature {
        name: "touching",
        parameters: &["tag", "side"],
        doc: "On a side of this instance's collider: `left`, `right`, `above` or `below`.",
    },
    Signature {
        name: "touching",
        parameters: &["own tag", "tag"],
        doc: "Only colliders of this instance with this tag.",
    },
    Signature { name: "touching", parameters: &["own tag", "tag", "side"], doc: "Only on one of its sides." },
    Signature {
        name: "timer",
        parameters: &["mode"],
        doc: "Seconds since the mode was entered; 0 while it is not active.",
    },
    Signature { name: "entering", parameters: &["mode"], doc: "A mode of another group is entered in this step." },
    Signature { name: "exiting", parameters: &["mode"], doc: "A mode of another group is left in this step." },
    Signature { name: "lost", parameters: &["reference"], doc: "The reference is `none`." },
    Signature {
        name: "near",
        parameters: &["instance", "(x, y)", "radius"],
        doc: "The distance of the instance to a point, or to another instance, is at most the radius; px.",
    },
    Signature { name: "inside", parameters: &["instance", "space"], doc: "The instance is in the space." },
    Signature {
        name: "rect",
        parameters: &["x", "y", "width", "height"],
        doc: "A rectangle: its lower-left corner, relative to the position, and its sides; px.",
    },
    Signature {
        name: "circle",
        parameters: &["x", "y", "radius"],
        doc: "A circle: its centre, relative to the position, and its radius; px.",
    },
];

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
    "collider",
    "kinematic",
    "clamp",
    "invariant",
    "group",
    "mode",
    "initial",
    "envelope",
    "use",
];
const IN_MODES: &[&str] = &["mode", "initial", "when", "else", "envelope", "follow", "spawn", "destroy", "use"];

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
        Some(Block::Tiles | Block::Settings | Block::Kinds | Block::Other) => (&[], &[]),
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
    snippet("group …", "group ${1:name} {\n    $0\n}", "modes that run beside others"),
    snippet("collider …", "collider ${1:body}: rect(${2:0, 0, 16, 16})", "a shape with tags"),
    snippet("discrete …", "discrete ${1:name}: int ${2:0}..${3:9} = ${4:0}", "a whole number"),
];

const WORLD_ITEMS: &[Snippet] = &[
    snippet("goal …", "goal ${1:name}: ${2:predicate}", "what `hypedc reach` looks for"),
    snippet("never …", "never ${1:name}: ${2:predicate}", "what must not happen"),
    snippet("collide …", "collide ${1:body} with ${2:wall}: block", "what a contact does"),
    snippet("space …", "space ${1:main} {\n    $0\n}", "a room"),
];

const SPACE_ITEMS: &[Snippet] =
    &[snippet("place …", "place ${1:name}: ${2:Entity} at (${3:0}, ${4:0})", "an instance")];

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn members_begin_with_the_words_of_the_grammar() {
        let offered: BTreeSet<&str> = IN_ENTITIES.iter().chain(IN_MODES).copied().collect();
        assert_eq!(offered, opening_keywords("good_member").iter().copied().collect());
    }
}
