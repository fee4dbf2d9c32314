//! Texts that may be broken: positions, words, where a cursor is. Nothing here knows of programs or of the protocol.

pub(super) mod alignment;
pub(super) mod document_text;
pub(super) mod following;
pub(super) mod lexer;
pub(super) mod meanings;
pub(super) mod place;
pub(super) mod words;
