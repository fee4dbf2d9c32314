//! Legends of the Video Game Level Corpus (Summerville, Snodgrass, Mateas and Ontañón, *The VGLC*, 2016): JSON that
//! gives each character of a level its tags.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::world::BadLegend;
use crate::source::{FileId, SourceFile, Span};

#[derive(Deserialize)]
struct Json {
    tiles: BTreeMap<Symbol, Vec<String>>,
}

/// A key of a legend: one character.
#[derive(PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(try_from = "String")]
struct Symbol(char);

impl TryFrom<String> for Symbol {
    type Error = String;

    fn try_from(key: String) -> Result<Self, String> {
        let mut characters = key.chars();
        match (characters.next(), characters.next()) {
            (Some(only), None) => Ok(Symbol(only)),
            _ => Err(format!("`{key}` is not one character")),
        }
    }
}

/// Maximum number of keys that are listed for a file that is no legend.
const MAX_KEYS: usize = 6;

/// The tags of each character, in the order of the characters; none if the text is no legend.
pub fn legend(file: &SourceFile, id: FileId, diagnostics: &mut Diagnostics) -> Option<Vec<(char, Vec<String>)>> {
    let text = file.text();
    match serde_json::from_str::<Json>(text) {
        Ok(json) => Some(json.tiles.into_iter().map(|(Symbol(symbol), tags)| (symbol, tags)).collect()),
        Err(error) => {
            let (start, end) = place(file, &error);
            let why = error.to_string();
            let mut why = why.split(" at line ").next().unwrap_or("").to_string();
            if let Ok(keys) = serde_json::from_str::<BTreeMap<String, IgnoredAny>>(text)
                && !keys.contains_key("tiles")
            {
                let keys: Vec<String> = keys.keys().take(MAX_KEYS).map(|key| format!("`{key}`")).collect();
                why = match keys.as_slice() {
                    [] => "it is empty".to_string(),
                    _ => format!("it has no `tiles`, but {}", keys.join(", ")),
                };
            }
            diagnostics.report(BadLegend { at: Span::new(id, start, end), why });
            None
        }
    }
}

/// The bytes of the character that an error is about; of the whole string if the error is in a string.
fn place(file: &SourceFile, error: &serde_json::Error) -> (usize, usize) {
    let text = file.text();
    let line = file.line_range(error.line().saturating_sub(1)).unwrap_or(0..text.len());
    let mut start = (line.start + error.column().saturating_sub(1)).min(text.len());
    while !text.is_char_boundary(start) {
        start -= 1;
    }
    let (before, after) = text.split_at(start);
    let end = start + after.chars().next().map_or(0, char::len_utf8);
    // `serde_json` reports the end of a string.
    let opening = before.rfind('"').filter(|_| error.is_data() && after.starts_with('"'));
    (opening.unwrap_or(start), end)
}
