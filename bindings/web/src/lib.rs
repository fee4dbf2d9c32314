//! The engine for WebAssembly: requests as JSON in, answers as JSON out, through memory. There are no threads, files or
//! clocks; the only import, `report`, takes what is told while a request is answered.
//!
//! A caller writes the UTF-8 of a request where [`reserve`] says, calls [`answer`] and reads its answer at [`output`].

mod files;
mod host;
mod language;
mod random;
mod report;

use std::cell::RefCell;

pub use host::Host;
pub use report::{Kind, Report};

thread_local! {
    static HOST: RefCell<Host> = RefCell::new(Host::new(report::to_page));
    static INPUT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static OUTPUT: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Makes room for a request of a number of bytes, and returns its address.
#[allow(unsafe_code, reason = "the linker keeps the name")]
#[unsafe(no_mangle)]
pub extern "C" fn reserve(bytes: usize) -> *mut u8 {
    INPUT.with_borrow_mut(|input| {
        input.clear();
        input.resize(bytes, 0);
        input.as_mut_ptr()
    })
}

/// Answers the request that was written. Returns the number of bytes of the answer.
#[allow(unsafe_code, reason = "the linker keeps the name")]
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> usize {
    let request = INPUT.take();
    let answer = HOST.with_borrow_mut(|host| match std::str::from_utf8(&request) {
        Ok(request) => host.answer(request),
        Err(_) => host::refused("the request is not UTF-8"),
    });
    let bytes = answer.len();
    OUTPUT.set(answer);
    bytes
}

/// The address of the last answer.
#[allow(unsafe_code, reason = "the linker keeps the name")]
#[unsafe(no_mangle)]
pub extern "C" fn output() -> *const u8 {
    OUTPUT.with_borrow(|output| output.as_ptr())
}

/// Prepares the engine: a panic tells its message before it traps.
#[allow(unsafe_code, reason = "the linker keeps the name")]
#[unsafe(no_mangle)]
pub extern "C" fn start() {
    std::panic::set_hook(Box::new(|panic| report::to_page(&Report { kind: Kind::Panic, text: panic.to_string() })));
}
