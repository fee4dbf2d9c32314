//! Importer of entity definitions of the 2017 HyPED system (XML). It preserves their semantics, not their appearance:
//! parts that that system ignores are omitted, and reported.
//!
//! ```text
//!  text ──read──▶ elements ──form──▶ known elements ──modes, names──▶ scope ──guard, expression──▶ members ──write──▶ text
//! ```
//!
//! - An `automaton` becomes an entity, its name in capitals: `plat_h` is `PlatH`.
//! - Groups in modes vanish, their modes are in the mode: `movement.air.aerial.falling` is `movement.air.falling`.
//!   An entity's only group vanishes, too, if its name is the entity's.
//! - Rectangles hang from their upper-left corner there and from the lower-left one here: `y - h`.
//! - Members are in the usual order, for none of them depends on it: flows, `follow links`, envelopes, edges, modes.
//! - Comments stay with their subject. Markup that was commented out is dropped.
//! - A part that cannot be imported is omitted as a whole statement, never in part, and a comment says so.

mod discrete;
mod entity;
mod expression;
mod form;
mod guard;
mod modes;
mod motion;
mod names;
mod notes;
mod read;
mod scope;
mod write;

use super::Import;
use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::import::NotCarriedOver;
use crate::format::format;
use crate::source::{FileId, Span};

/// The names of the entities of one program.
#[derive(Default)]
pub struct Entities(names::Names);

/// Imports the entity of an XML text into a program with the entities `beside`; adds its name to theirs.
pub fn import(file: FileId, text: &str, beside: &mut Entities) -> Import {
    let mut diagnostics = Diagnostics::new();
    let document = match read::document(file, text) {
        Ok(document) => document,
        Err(fact) => {
            diagnostics.report(fact);
            return Import { text: None, diagnostics };
        }
    };
    let root = read::Element::new(file, document.root_element());
    let text = form::check(root, &mut diagnostics)
        .then(|| entity::entity(root, &mut beside.0, &mut diagnostics))
        .and_then(|entity| laid_out(root.tag(), &write::text(&entity), &mut diagnostics));
    diagnostics.sort();
    Import { text, diagnostics }
}

/// The canonical layout of a text; none if it exceeds a limit of the language.
fn laid_out(root: Span, text: &str, diagnostics: &mut Diagnostics) -> Option<String> {
    let laid_out = format(FileId(0), text);
    if laid_out.is_err() {
        diagnostics.report(NotCarriedOver {
            what: "an entity of this size".into(),
            why: "nested too deep, or an expression too long".into(),
            at: root,
            help: "see the limits of the language reference, and split what is too large".into(),
        });
    }
    laid_out.ok()
}
