//! Legends of the Video Game Level Corpus (Summerville, Snodgrass, Mateas and Ontañón, *The VGLC*, 2016): JSON that
//! gives each character of a level its tags.

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::world::BadLegend;
use crate::source::{FileId, SourceFile, Span};

#[derive(Deserialize)]
struct Json {
    tiles: BTreeMap<String, Vec<String>>,
}

/// The tags of each character, in the order of the characters; none if the text is no legend.
pub fn legend(file: &SourceFile, id: FileId, diagnostics: &mut Diagnostics) -> Option<Vec<(char, Vec<String>)>> {
    let text = file.text();
    let json: Json = match serde_json::from_str(text) {
        Ok(json) => json,
        Err(error) => {
            let line = file.line_range(error.line().saturating_sub(1)).unwrap_or(0..text.len());
            let at = (line.start + error.column().saturating_sub(1)).min(text.len());
            let why = error.to_string();
            let why = why.split(" at line ").next().unwrap_or("").to_string();
            diagnostics.report(BadLegend { at: Span::new(id, at, (at + 1).min(text.len())), why });
            return None;
        }
    };
    let mut out = Vec::new();
    for (key, tags) in json.tiles {
        let mut characters = key.chars();
        match (characters.next(), characters.next()) {
            (Some(only), None) => out.push((only, tags)),
            _ => {
                let at = text.find(&format!("\"{key}\"")).unwrap_or(0);
                let why = format!("`{key}` is not one character");
                diagnostics.report(BadLegend { at: Span::new(id, at, at + key.len() + 2), why });
                return None;
            }
        }
    }
    Some(out)
}
