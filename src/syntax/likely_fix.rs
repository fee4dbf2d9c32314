//! Typos and syntax of other languages: guesses the intended token, so that a syntax error has a fix. `message` accepts
//! a fix as certain if the statement then parses.

use std::ops::Range;

use crate::diagnostic::similar;

use super::Rule;
use super::foreign::foreign;
use super::foreign_statement::{foreign_statement, statements};

/// The point where a part stopped matching its rule.
pub(super) struct Failure<'a> {
    /// The rule.
    pub rule: Rule,
    /// The part, without trailing white space.
    pub slice: &'a str,
    /// The offset of the unexpected token in it.
    pub at: usize,
    /// The token; empty at the end.
    pub found: &'a str,
    /// Descriptions of the expected tokens.
    pub expected: &'a [String],
}

/// A likely fix.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct LikelyFix {
    /// The advice.
    pub help: String,
    /// The range of the part to replace, and the replacement, if they are known.
    pub replacement: Option<(Range<usize>, String)>,
    /// Whether the first word is wrong, although more could be parsed.
    pub is_first: bool,
}

impl LikelyFix {
    pub(super) fn new(help: impl Into<String>) -> Self {
        LikelyFix { help: help.into(), replacement: None, is_first: false }
    }

    pub(super) fn replacement(help: impl Into<String>, range: Range<usize>, text: impl Into<String>) -> Self {
        LikelyFix { help: help.into(), replacement: Some((range, text.into())), is_first: false }
    }
}

/// Functions whose argument is in parentheses.
const CALLS: [&str; 9] = ["pressed", "held", "released", "touching", "entering", "exiting", "lost", "inside", "timer"];

/// Keywords of other languages, the equivalent (`None` if it takes more than a word), and the advice.
type ForeignWords = (&'static [&'static str], Option<&'static str>, &'static str);

const NO_FUNCTIONS: &str = "there are no functions; what several entities share is a `behavior`, taken with `use`";

const NAMED_GUARD: &str = "a name for a guard is a `condition NAME = GUARD`";

const MEMBERS: &[ForeignWords] = &[
    (&["state", "phase"], Some("mode"), "a state of an entity is a `mode`"),
    (
        &["if", "on", "transition", "edge", "rule", "event"],
        Some("when"),
        "an edge is written `when GUARD -> MODE { UPDATES }`",
    ),
    (
        &["var", "let", "float", "double", "real", "number", "int", "integer", "bool", "boolean", "enum", "local"],
        None,
        "an entity declares what stays as `param speed = 60`, what flows as `continuous z = 0`, what counts or switches \
         as `discrete n: int 0..9 = 0`",
    ),
    (&["const", "constant", "attribute", "property"], Some("param"), "a constant of an entity is a `param`"),
    (&["start", "begin", "init", "default"], None, "`initial mode NAME { … }` is the mode that an entity begins in"),
    (&["hitbox", "hurtbox", "shape", "box"], Some("collider"), "what touches others is a `collider TAG: rect(…)`"),
    (
        &["input", "inputs", "key", "action"],
        None,
        "what a player presses is a `button`, what a player moves between -1 and 1 an `axis`",
    ),
    (
        &["elif", "elseif", "otherwise"],
        None,
        "edges are tried from the top; for another case write another `when` after the first, for all others `else`",
    ),
    (&["wait", "after", "delay", "every"], None, "`timer` counts the seconds in a mode: `when timer >= 2 -> MODE`"),
    (&["function", "func", "fn", "def", "method", "extends", "template"], None, NO_FUNCTIONS),
    (&["parallel", "concurrent", "region"], Some("group"), "modes that run beside others are in a `group`"),
    (&["predicate", "guard", "macro", "define", "alias"], Some("condition"), NAMED_GUARD),
    (&["collide"], None, "worlds rule contacts: `collide TAG with TAG: block` belongs in a `world`"),
];

const ITEMS: &[ForeignWords] = &[
    (&["collide", "tiles", "space", "goal", "never", "player", "step"], None, "this belongs in a `world NAME { … }`"),
    (
        &["class", "object", "actor", "struct", "automaton", "character", "agent", "prefab"],
        Some("entity"),
        "what has modes and flows is an `entity`",
    ),
    (&["level", "scene", "game", "stage"], Some("world"), "spaces with entities in them make a `world`"),
    (&["include", "require", "using", "from"], Some("import"), "other files are included with `import \"file.hyped\"`"),
    (&["constant", "define", "let", "var"], Some("const"), "a number with a name is a `const`"),
    (&["function", "func", "fn", "def", "method"], None, NO_FUNCTIONS),
    (&["trait", "mixin", "template", "component"], Some("behavior"), "what several entities share is a `behavior`"),
];

const UPDATES: &[ForeignWords] = &[
    (
        &["let", "var", "local", "const", "int", "float", "double", "number", "bool"],
        None,
        "an update sets a variable that the entity declares: `x := 1`",
    ),
    (&["set", "assign"], None, "an update is written `x := 1`"),
    (
        &["if", "when", "while", "for", "else"],
        None,
        "an update has no condition of its own: write another `when`, or a value such as `x := if(y > 0, 1, 2)`",
    ),
];

const WORLD_ITEMS: &[ForeignWords] = &[
    (&["room", "scene", "stage", "area"], Some("space"), "a room of a world is a `space`"),
    (&["timestep", "dt", "tick", "fps"], None, "`step 1/60` says how long a step is, s"),
    (&["tileset", "legend"], Some("tiles"), "what the characters of maps mean is in `tiles NAME 16 x 16 { … }`"),
    (&["win", "reach", "target"], Some("goal"), "what is to be brought about is a `goal NAME: PREDICATE`"),
    (&["lose", "avoid", "assert", "forbid"], Some("never"), "what must not come about is a `never NAME: PREDICATE`"),
    (&["collision", "collisions", "contact"], Some("collide"), "contacts are ruled by `collide TAG with TAG: block`"),
    (
        &["gravity", "friction", "physics", "velocity"],
        None,
        "what moves is said by flows in entities: `y'' = -400` is a fall, px/s each second",
    ),
    (&["predicate", "guard", "macro", "define", "alias"], Some("condition"), NAMED_GUARD),
    (&["map", "place", "rect", "bounds", "link", "wrap"], None, "this belongs in a space: `space main { … }`"),
];

const SPACE_ITEMS: &[ForeignWords] = &[
    (&["spawn", "instance", "object", "put", "add"], None, "an instance is placed by `place hero: Hero at (0, 0)`"),
    (&["door", "portal", "exit", "warp"], None, "`link rect(…) -> SPACE at rect(…)` leads into another space"),
    (&["wall", "solid", "platform", "box"], None, "what never moves is `rect TAG (x, y, width, height)`, or a tile"),
    (&["goal", "never", "player", "collide", "tiles", "step"], None, "this belongs in the world, outside of spaces"),
];

const RAMPS: &[ForeignWords] = &[(&["peak", "hold"], Some("sustain"), "a level that is kept is a `sustain`")];

/// The most likely fix.
pub(super) fn likely_fix(failed: &Failure<'_>, opening: &[&'static str]) -> Option<LikelyFix> {
    foreign_statement(failed)
        .or_else(|| foreign(failed))
        .or_else(|| comment(failed))
        .or_else(|| condition(failed))
        .or_else(|| update(failed))
        .or_else(|| edge(failed))
        .or_else(|| unit(failed))
        .or_else(|| call(failed))
        .or_else(|| comma(failed))
        .or_else(|| equality(failed))
        .or_else(|| response(failed))
        .or_else(|| block(failed))
        .or_else(|| opener(failed, opening))
        .or_else(|| statements(failed, opening))
}

impl<'a> Failure<'a> {
    pub(super) fn rest(&self) -> &'a str {
        self.slice.get(self.at..).unwrap_or_default()
    }

    pub(super) fn before(&self) -> &'a str {
        self.slice.get(..self.at).unwrap_or_default()
    }

    pub(super) fn expects(&self, word: &str) -> bool {
        self.expected.iter().any(|expected| expected == word)
    }

    /// Replaces some bytes by a word, with spaces around it.
    fn spaced(&self, length: usize, word: &str) -> (Range<usize>, String) {
        let space = |c: Option<char>| if c.is_none_or(char::is_whitespace) { "" } else { " " };
        let after = self.rest().get(length..).and_then(|rest| rest.chars().next());
        let text = format!("{}{word}{}", space(self.before().chars().next_back()), space(after));
        (self.at..self.at + length, text)
    }

    /// Replaces all the rest, with a space before it.
    fn to_the_end(&self, text: &str) -> (Range<usize>, String) {
        let (Range { start, .. }, text) = self.spaced(0, text);
        (start..self.slice.len(), text.trim_end().to_string())
    }

    pub(super) fn first_word(&self) -> &'a str {
        word(self.slice)
    }
}

/// The first word of a text.
pub(super) fn word(text: &str) -> &str {
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len());
    text.get(..end).unwrap_or_default()
}

fn comment(failed: &Failure<'_>) -> Option<LikelyFix> {
    let help = "a comment begins with `//` and goes to the end of the line";
    let rest = failed.rest();
    match rest {
        _ if failed.at > 0 && !failed.expects("the end of the statement") => None,
        _ if ["#include", "#define", "#import"].iter().any(|word| rest.starts_with(word)) => Some(LikelyFix::new(
            "files are included with `import \"file.hyped\"`, numbers get names by `const NAME = 3`",
        )),
        _ if rest.starts_with('#') => Some(LikelyFix::replacement(help, failed.at..failed.at + 1, "//")),
        _ if rest.starts_with("--") => Some(LikelyFix::replacement(help, failed.at..failed.at + 2, "//")),
        _ if rest.starts_with("/*") => Some(LikelyFix::new(help)),
        _ => None,
    }
}

/// Logical operators of C.
fn condition(failed: &Failure<'_>) -> Option<LikelyFix> {
    let rest = failed.rest();
    let put = |signs: &str, word: &str, help: &str| {
        let (range, text) = failed.spaced(signs.len(), word);
        Some(LikelyFix::replacement(help, range, text))
    };
    let joined = "conditions are joined by `and` and `or`";
    match () {
        () if rest.starts_with("&&") => put("&&", "and", joined),
        () if rest.starts_with("||") => put("||", "or", joined),
        () if rest.starts_with('&') => put("&", "and", joined),
        () if rest.starts_with('|') => put("|", "or", joined),
        () if rest.starts_with('!') && !rest.starts_with("!=") && failed.expects("an expression") => {
            put("!", "not", "the opposite of a condition is `not …`")
        }
        () => None,
    }
}

/// Assignments of C.
fn update(failed: &Failure<'_>) -> Option<LikelyFix> {
    if !failed.expects("`:=`") {
        return None;
    }
    let (target, rest) = (failed.before().trim(), failed.rest());
    let sign = rest.chars().next().filter(|c| "+-*/".contains(*c));
    let value = sign.and_then(|sign| {
        if ["++", "--"].contains(&rest) { Some("1") } else { rest.strip_prefix(&*format!("{sign}=")).map(str::trim) }
    });
    if let (Some(sign), Some(value)) = (sign, value.filter(|value| !value.is_empty())) {
        if failed.rule != Rule::only_update {
            let help = "while a mode lasts, `y' = …` says what flows; `:=` belongs in the `{ }` of an edge";
            return Some(LikelyFix::new(help));
        }
        let is_sum = value.trim_start_matches('-').contains(['+', '-', '*', '/', ' ']);
        let (text, help) = if "+-".contains(sign) {
            let text = format!("{sign}= {value}");
            let help = format!("an update by one is `{target} {text}`");
            (text, help)
        } else {
            let value = if is_sum { format!("({value})") } else { value.to_string() };
            let text = format!(":= {target} {sign} {value}");
            let help = format!("an update names the new value: `{target} {text}`");
            (text, help)
        };
        let (range, text) = failed.to_the_end(&text);
        return Some(LikelyFix::replacement(help, range, text));
    }
    (failed.found == "=").then(|| {
        let help = "inside `{ }` of an edge an update is written with `:=`";
        LikelyFix::replacement(help, failed.at..failed.at + 1, ":=")
    })
}

/// An edge with wrong connecting words.
fn edge(failed: &Failure<'_>) -> Option<LikelyFix> {
    let rest = failed.rest();
    if failed.expects("`->`") {
        let help = "the target of an edge follows `->`";
        let length = match rest {
            _ if rest.starts_with("=>") => 2,
            _ if ["goto", "then", "to", "do"].contains(&failed.found) => failed.found.len(),
            _ => 0,
        };
        if length > 0 {
            let (range, text) = failed.spaced(length, "->");
            return Some(LikelyFix::replacement(help, range, text));
        }
    }
    let is_edge = failed.first_word() == "when" && failed.before().contains("->") && failed.expects("`{`");
    let updates =
        ["do ", "then ", ",", ":", "/", "with "].iter().find_map(|sign| rest.strip_prefix(sign)).unwrap_or(rest);
    let updates = updates.trim();
    (is_edge && !updates.starts_with('{') && updates.contains('=')).then(|| {
        let help = "updates are in braces after the mode: `-> MODE { x := 1 }`";
        let (range, text) = failed.to_the_end(&format!("{{ {updates} }}"));
        LikelyFix::replacement(help, range, text)
    })
}

/// A contact of which nothing comes.
fn response(failed: &Failure<'_>) -> Option<LikelyFix> {
    let is_unsaid = failed.first_word() == "collide" && failed.expects("`:`") && failed.before().contains(" with ");
    (is_unsaid && failed.found.is_empty())
        .then(|| LikelyFix::new("what comes of it is said at the end: `: block` stops, `: sense` only tells guards"))
}

/// A unit separated from its number, or an unknown unit.
fn unit(failed: &Failure<'_>) -> Option<LikelyFix> {
    // `2sec` is one token, `2px` two.
    let digits = failed.found.bytes().take_while(u8::is_ascii_digit).count();
    let number = failed.slice.get(..failed.at + digits)?.trim_end();
    if !number.ends_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let (first, last) = (number.len(), failed.at + failed.found.len());
    let is_apart = first < failed.at;
    match failed.found.get(digits..)? {
        "px" | "pixel" | "pixels" | "tiles" | "m" | "units" => {
            // A following `(` must not become a factor.
            let rest = failed.slice.get(last..).unwrap_or_default();
            let help = "lengths are in px: their numbers have no unit";
            Some(if rest.starts_with('/') {
                LikelyFix::new(help)
            } else {
                LikelyFix::replacement(help, first..last, "")
            })
        }
        "s" | "sec" | "secs" | "second" | "seconds" if failed.first_word() == "step" => {
            Some(LikelyFix::replacement("a step is in seconds, without a unit", first..last, ""))
        }
        "s" | "ms" | "frames" if is_apart => {
            let digits = number.rfind(|c: char| !(c.is_ascii_digit() || c == '.')).map_or(0, |at| at + 1);
            let text = format!("{}{}", number.get(digits..)?, failed.found);
            Some(LikelyFix::replacement(format!("a unit directly follows its number: `{text}`"), first..failed.at, ""))
        }
        "sec" | "secs" | "second" | "seconds" => {
            Some(LikelyFix::replacement("seconds are written `2s`", first..last, "s"))
        }
        "frame" => Some(LikelyFix::replacement("a time in steps is written `2frames`", first..last, "frames")),
        _ => None,
    }
}

/// An argument without parentheses.
fn call(failed: &Failure<'_>) -> Option<LikelyFix> {
    let before = failed.before().trim_end();
    let callee = *CALLS.iter().find(|callee| {
        before.strip_suffix(**callee).is_some_and(|rest| !rest.ends_with(|c: char| c.is_alphanumeric() || c == '_'))
    })?;
    let mut arguments = Vec::new();
    let mut rest = failed.rest();
    let mut end = failed.at;
    while let first @ 1.. = word(rest).len() {
        let found = rest.get(..first)?;
        if ["and", "or", "in", "is", "not"].contains(&found) || found.starts_with(|c: char| c.is_ascii_digit()) {
            break;
        }
        arguments.push(found);
        end = failed.slice.len() - rest.len() + first;
        rest = rest.get(first..)?.trim_start_matches(' ');
    }
    if arguments.is_empty() || arguments.len() > 3 {
        return None;
    }
    let text = format!("({})", arguments.join(", "));
    let help = format!("the argument is in parentheses: `{callee}{text}`");
    Some(LikelyFix::replacement(help, before.len()..end, text))
}

/// Arguments without commas.
fn comma(failed: &Failure<'_>) -> Option<LikelyFix> {
    let is_name = failed.found.starts_with(|c: char| c.is_alphanumeric() || c == '_');
    let is_list = failed.expects("`,`") && failed.expects("`)`") && !["and", "or", "in", "is"].contains(&failed.found);
    (is_name && is_list).then(|| {
        let gap = failed.before().trim_end().len()..failed.at;
        LikelyFix::replacement("arguments are separated by commas", gap, ", ")
    })
}

fn equality(failed: &Failure<'_>) -> Option<LikelyFix> {
    // Outside a condition, a second `=` may start something else.
    let is_condition = ["when", "invariant", "condition", "goal", "never"].contains(&failed.first_word());
    (failed.found == "=" && failed.expects("an operator")).then(|| LikelyFix {
        help: "two values are compared with `==`".into(),
        replacement: is_condition.then(|| (failed.at..failed.at + 1, "==".to_string())),
        is_first: false,
    })
}

/// A block opened by a colon, as in Python.
fn block(failed: &Failure<'_>) -> Option<LikelyFix> {
    let rest = failed.rest().strip_prefix(':').filter(|_| failed.expects("`{`"))?;
    let help = "a block is in braces: `{ … }`, without `:`";
    let is_braced = rest.trim_start().starts_with('{');
    let replacement = is_braced.then(|| (failed.at..failed.at + 1, String::new()));
    Some(LikelyFix { help: help.into(), replacement, is_first: false })
}

/// A first word that is similar to a keyword of the rule, or has an equivalent here.
fn opener(failed: &Failure<'_>, opening: &[&'static str]) -> Option<LikelyFix> {
    let first = failed.first_word();
    if first == "initial" && failed.rule == Rule::only_member && failed.expects("`mode`") {
        return Some(LikelyFix::new("the mode that an entity begins in is marked in place: `initial mode NAME { … }`"));
    }
    let habits: &[ForeignWords] = match failed.rule {
        Rule::only_item => ITEMS,
        Rule::only_member => MEMBERS,
        Rule::only_update => UPDATES,
        Rule::only_world_item => WORLD_ITEMS,
        Rule::only_space_item => SPACE_ITEMS,
        Rule::only_ramp => RAMPS,
        _ => &[],
    };
    let follows = failed.at == 0 || failed.before().trim_end() == first;
    if first.is_empty() || opening.contains(&first) || !follows {
        return None;
    }
    if let Some((_, word, help)) = habits.iter().find(|(words, ..)| words.contains(&first)) {
        let replacement = word.map(|word| (0..first.len(), word.to_string()));
        return Some(LikelyFix { help: (*help).into(), replacement, is_first: true });
    }
    let word = similar(first, opening.iter().copied())?;
    let replacement = Some((0..first.len(), word.to_string()));
    Some(LikelyFix { help: format!("did you mean `{word}`?"), replacement, is_first: true })
}
