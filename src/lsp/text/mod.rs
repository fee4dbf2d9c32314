//! Analysis of texts that may not parse: positions, tokens, the context of a cursor. Independent of programs and of the
//! protocol.

pub(super) mod alignment;
pub(super) mod cursor;
pub(super) mod document_text;
pub(super) mod lexer;
pub(super) mod operands;
pub(super) mod words;
