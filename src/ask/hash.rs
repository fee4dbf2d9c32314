//! Hashes of programs.

use sha2::{Digest, Sha256};

use crate::ir::Program;
use crate::json::{self, Layout};

/// A hash of a program's meaning, in hexadecimal digits.
pub fn program_sha256(program: &Program) -> String {
    let json = json::bytes(&program.meaning(), Layout::Compact).unwrap_or_default();
    sha256(&json)
}

/// The SHA-256 of some bytes, in hexadecimal digits.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}
