//! Equivalent versions of a world: what is proven of them should be the same.

use super::frame::Frame;
use super::generate::{program, words};

/// A transformation that keeps the meaning of a world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Otherwise {
    /// Mirrored.
    Mirrored,
    /// Moved by whole tiles to the right and up.
    Shifted,
    /// All names are replaced.
    Renamed,
    /// Entities in reverse order.
    Reordered,
    /// One more instance, far away from all others.
    Watched,
}

impl Otherwise {
    pub const ALL: [Otherwise; 5] =
        [Otherwise::Mirrored, Otherwise::Shifted, Otherwise::Renamed, Otherwise::Reordered, Otherwise::Watched];

    /// The transformed program of these choices; none if the meaning would change.
    pub fn written(self, choices: &[u16]) -> Option<String> {
        let text = program(choices, Frame::default());
        let names_files = ["from \"", "vglc", "tiled", "ldtk", "map level"].iter().any(|w| text.contains(w));
        let measures = text.contains("main.width");
        // Of two borders that are one place, only the lower one is between them, and what is far away is brought in.
        let wraps = text.contains("\nwrap ");
        match self {
            Otherwise::Mirrored | Otherwise::Shifted if names_files || measures || wraps => None,
            Otherwise::Watched if wraps => None,
            Otherwise::Mirrored => Some(program(choices, Frame { is_mirrored: true, tiles: (0, 0) })),
            Otherwise::Shifted => Some(program(choices, Frame { is_mirrored: false, tiles: (2, 1) })),
            Otherwise::Renamed => Some(renamed(&text)),
            Otherwise::Reordered => Some(reordered(&text)),
            // An unbound reference could refer to that one.
            Otherwise::Watched if words(&text).any(|w| matches!(w, "friend" | "seen")) => None,
            Otherwise::Watched => {
                let with =
                    text.replace("world W {", "entity Bystander { collider bystander: rect(0, 0, 16, 16) }\nworld W {");
                Some(with.replace("space main {", "space main {\nplace bystander: Bystander at (100000, 100000)"))
            }
        }
    }
}

/// Names that can be replaced, except those of goals; tags also name tiles and occur in files.
fn is_own(word: &str) -> bool {
    const OWN: [&str; 22] = [
        "A", "B", "C", "size", "speed", "force", "delay", "turn", "q", "heat", "count", "flag", "colour", "red",
        "green", "blue", "friend", "foe_a", "foe_b", "foe_c", "seen", "boss",
    ];
    let is_numbered = |first: char| word.strip_prefix(first).is_some_and(|rest| rest.parse::<u32>().is_ok());
    OWN.contains(&word) || ['m', 'i', 'g', 'p'].into_iter().any(is_numbered)
}

fn renamed(text: &str) -> String {
    let mut out = String::new();
    let mut word = String::new();
    for c in text.chars().chain(['\n']) {
        if c.is_alphanumeric() || c == '_' {
            word.push(c);
            continue;
        }
        out.push_str(&word);
        if is_own(&word) {
            out.push_str("_z");
        }
        word.clear();
        out.push(c);
    }
    out
}

/// The entities from the last to the first; everything else stays.
fn reordered(text: &str) -> String {
    let (mut entities, mut rest): (Vec<String>, String) = (Vec::new(), String::new());
    let mut is_in = false;
    for line in text.lines() {
        if line.starts_with("entity ") {
            is_in = true;
            entities.push(String::new());
        } else if line.starts_with("world ") {
            is_in = false;
        }
        let to = match (is_in, entities.last_mut()) {
            (true, Some(entity)) => entity,
            _ => &mut rest,
        };
        to.push_str(line);
        to.push('\n');
    }
    entities.reverse();
    entities.concat() + &rest
}
