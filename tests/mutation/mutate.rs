//! Small changes of a program's text that resemble typos.

use std::ops::Range;

use rand::RngExt;
use rand_pcg::Pcg64;

macro_rules! kinds {
    ($($variant:ident $name:literal)*) => {
        /// What is changed.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Kind { $($variant),* }

        impl Kind {
            pub const ALL: &[Kind] = &[$(Kind::$variant),*];

            pub fn name(self) -> &'static str {
                match self { $(Kind::$variant => $name),* }
            }
        }
    };
}

kinds! {
    DeleteToken "delete a token"
    InsertToken "insert a token"
    SwapTokens "swap two tokens"
    Misspell "misspell a name"
    OtherName "write another name"
    Derivative "velocity for acceleration"
    DropBrace "drop a brace"
    Retarget "retarget an edge"
    RemoveCollide "remove a `collide` line"
    RemoveLine "remove a line"
    RepeatLine "repeat a line"
    Comparison "turn a comparison"
    Number "change a number"
}

/// A changed program.
pub struct Mutant {
    pub text: String,
    /// The line of the change, from 1.
    pub line: usize,
    /// The change in words.
    pub what: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Class {
    Word,
    Number,
    Text,
    Punctuation,
}

#[derive(Debug, Clone)]
struct Token {
    class: Class,
    range: Range<usize>,
}

/// The tokens of a program, comments and maps left out.
fn tokens(text: &str) -> Vec<Token> {
    let bytes = text.as_bytes();
    let mut out = Vec::new();
    let mut at = 0;
    let run = |from: usize, test: &dyn Fn(u8) -> bool| bytes[from..].iter().take_while(|b| test(**b)).count();
    while at < bytes.len() {
        let byte = bytes[at];
        let (class, length) = match byte {
            b' ' | b'\t' | b'\n' | b'\r' | b';' => (None, 1),
            b'/' if bytes[at..].starts_with(b"//") => (None, run(at, &|b| b != b'\n')),
            b'"' => {
                let length = (2 + run(at + 1, &|b| b != b'"')).min(bytes.len() - at);
                let is_map = text[at..at + length].contains('\n');
                ((!is_map).then_some(Class::Text), length)
            }
            b'\'' if bytes.get(at + 2) == Some(&b'\'') => (Some(Class::Text), 3),
            b'\'' => (Some(Class::Punctuation), run(at, &|b| b == b'\'')),
            b'0'..=b'9' => (Some(Class::Number), run(at, &|b| b.is_ascii_alphanumeric())),
            _ if byte.is_ascii_alphabetic() || byte == b'_' => {
                (Some(Class::Word), run(at, &|b| b.is_ascii_alphanumeric() || b == b'_'))
            }
            _ if !byte.is_ascii() => (None, run(at, &|b| !b.is_ascii())),
            _ => {
                let two = [":=", "->", "==", "!=", "<=", ">=", ".."];
                let is_two = two.iter().any(|t| bytes[at..].starts_with(t.as_bytes()));
                (Some(Class::Punctuation), if is_two { 2 } else { 1 })
            }
        };
        if let Some(class) = class {
            out.push(Token { class, range: at..at + length });
        }
        at += length;
    }
    out
}

/// Words of the language.
const WORDS: &[&str] = &[
    "entity",
    "world",
    "mode",
    "group",
    "when",
    "and",
    "or",
    "not",
    "param",
    "const",
    "continuous",
    "discrete",
    "ref",
    "button",
    "axis",
    "chance",
    "collider",
    "kinematic",
    "rect",
    "circle",
    "envelope",
    "by",
    "attack",
    "decay",
    "sustain",
    "release",
    "accel",
    "over",
    "instant",
    "hold",
    "to",
    "for",
    "while",
    "fixed",
    "initial",
    "collide",
    "with",
    "block",
    "sense",
    "carry",
    "bounce",
    "from",
    "above",
    "below",
    "left",
    "right",
    "tiles",
    "empty",
    "spawn",
    "destroy",
    "send",
    "as",
    "space",
    "map",
    "place",
    "at",
    "link",
    "goal",
    "never",
    "player",
    "limit",
    "step",
    "import",
    "behavior",
    "use",
    "clamp",
    "invariant",
    "condition",
    "slope",
    "breakable",
    "restore",
    "after",
    "signal",
    "look",
    "test",
    "inputs",
    "expect",
    "reachable",
    "unreachable",
    "unfound",
    "without",
    "seed",
    "end",
    "timer",
    "pressed",
    "held",
    "released",
    "touching",
    "in",
    "is",
    "none",
    "lost",
    "any",
    "all",
    "true",
    "false",
    "int",
    "bool",
    "follow",
    "links",
    "bounds",
    "wrap",
    "near",
    "nearest",
    "within",
    "x",
    "y",
    "keep",
    "velocity",
    "entering",
    "exiting",
    "directions",
    "vglc",
    "legend",
    "tile",
    "level",
    "min",
    "max",
    "abs",
    "sign",
    "floor",
    "ceil",
    "round",
    "sqrt",
    "sin",
    "cos",
    "atan2",
    "mod",
    "if",
];

/// A mutant of a kind; none if there is nothing to change.
pub fn mutant(text: &str, kind: Kind, rng: &mut Pcg64) -> Option<Mutant> {
    let tokens = tokens(text);
    let said = |token: &Token| text[token.range.clone()].to_string();
    let is_name = |token: &&Token| token.class == Class::Word && !WORDS.contains(&said(token).as_str());
    let pick = |from: &[&Token], rng: &mut Pcg64| -> Option<Token> {
        (!from.is_empty()).then(|| from[rng.random_range(0..from.len())].clone())
    };
    let all: Vec<&Token> = tokens.iter().collect();
    let of = |test: &dyn Fn(&str) -> bool| -> Vec<&Token> { tokens.iter().filter(|t| test(&said(t))).collect() };
    let put = |range: Range<usize>, new: &str| {
        let line = text[..range.start].matches('\n').count() + 1;
        let what = format!("`{}` -> `{new}`", &text[range.clone()]);
        let changed = format!("{}{new}{}", &text[..range.start], &text[range.end..]);
        (changed != text).then_some(Mutant { text: changed, line, what })
    };
    match kind {
        Kind::DeleteToken => put(pick(&all, rng)?.range, ""),
        Kind::InsertToken => {
            let (before, new) = (pick(&all, rng)?, pick(&all, rng)?);
            let at = before.range.start;
            put(at..at, &format!("{} ", said(&new)))
        }
        Kind::SwapTokens => {
            let first = rng.random_range(0..tokens.len() - 1);
            let (a, b) = (&tokens[first], &tokens[first + 1]);
            let between = &text[a.range.end..b.range.start];
            let fits = !between.contains(['\n', '/']) && said(a) != said(b);
            if fits { put(a.range.start..b.range.end, &format!("{}{between}{}", said(b), said(a))) } else { None }
        }
        Kind::Misspell => {
            let names: Vec<&Token> = tokens.iter().filter(|t| is_name(t) && t.range.len() >= 3).collect();
            let token = pick(&names, rng)?;
            let mut word: Vec<char> = said(&token).chars().collect();
            let at = rng.random_range(1..word.len());
            match rng.random_range(0..3) {
                0 => drop(word.remove(at)),
                1 => word.insert(at, word[at - 1]),
                _ => word.swap(at - 1, at),
            }
            put(token.range, &word.into_iter().collect::<String>())
        }
        Kind::OtherName => {
            let names: Vec<&Token> = tokens.iter().filter(is_name).collect();
            let (token, other) = (pick(&names, rng)?, pick(&names, rng)?);
            put(token.range, &said(&other))
        }
        Kind::Derivative => {
            let token = pick(&of(&|t| t == "'" || t == "''"), rng)?;
            let new = if said(&token) == "'" { "''" } else { "'" };
            put(token.range, new)
        }
        Kind::DropBrace => put(pick(&of(&|t| t == "{" || t == "}"), rng)?.range, ""),
        Kind::Retarget => {
            let after = |arrow: &str| {
                let pairs = tokens.windows(2).filter(|w| said(&w[0]) == arrow);
                pairs.map(|w| &w[1]).collect::<Vec<&Token>>()
            };
            let (target, other) = (pick(&after("->"), rng)?, pick(&after("mode"), rng)?);
            put(target.range, &said(&other))
        }
        Kind::RemoveCollide | Kind::RemoveLine | Kind::RepeatLine => {
            let starts = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1));
            let lines: Vec<Range<usize>> = starts
                .map(|start| start..start + text[start..].find('\n').map_or(text.len() - start, |n| n + 1))
                .collect();
            let holds = |line: &&Range<usize>| tokens.iter().any(|t| line.contains(&t.range.start));
            let fits = |line: &&Range<usize>| {
                holds(line)
                    && (kind != Kind::RemoveCollide || text[(*line).clone()].trim_start().starts_with("collide "))
            };
            let lines: Vec<&Range<usize>> = lines.iter().filter(fits).collect();
            if lines.is_empty() {
                return None;
            }
            let line = lines[rng.random_range(0..lines.len())].clone();
            let new = if kind == Kind::RepeatLine { text[line.clone()].repeat(2) } else { String::new() };
            put(line, &new)
        }
        Kind::Comparison => {
            let token = pick(&of(&|t| matches!(t, "<" | ">" | "<=" | ">=" | "==" | "!=")), rng)?;
            let new = match said(&token).as_str() {
                "<" => ">",
                ">" => "<",
                "<=" => ">=",
                ">=" => "<=",
                "==" => "!=",
                _ => "==",
            };
            put(token.range, new)
        }
        Kind::Number => {
            let numbers: Vec<&Token> = tokens.iter().filter(|t| t.class == Class::Number).collect();
            let token = pick(&numbers, rng)?;
            let new = match rng.random_range(0..4) {
                0 => format!("{}0", said(&token)),
                1 => "0".to_string(),
                2 => format!("-{}", said(&token)),
                _ => format!("{}px", said(&token)),
            };
            put(token.range, &new)
        }
    }
}
