//! What is told while a request is answered: how far a search is, and the message of a panic.

/// What a report is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A search: the text is an answer as JSON.
    Search = 0,
    /// A panic: the text is its message.
    Panic = 1,
}

/// A report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Report {
    /// What it is about.
    pub kind: Kind,
    /// Its text.
    pub text: String,
}

#[cfg(target_arch = "wasm32")]
#[allow(unsafe_code, reason = "the import of the module; its arguments are numbers")]
#[link(wasm_import_module = "host")]
unsafe extern "C" {
    /// Takes a report: its kind, and address and length of its text, which it does not keep.
    safe fn report(kind: u32, text: *const u8, bytes: usize);
}

/// Without a page nobody listens.
#[cfg(not(target_arch = "wasm32"))]
fn report(_: u32, _: *const u8, _: usize) {}

/// Tells the page.
pub(crate) fn to_page(of: &Report) {
    report(of.kind as u32, of.text.as_ptr(), of.text.len());
}
