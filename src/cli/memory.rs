//! Memory that is free goes back to the system: the allocator of the binary keeps freed pages for a while, of which a
//! server that runs for days has no use.

/// Gives the free pages of this thread, and of those that have ended, back.
#[expect(unsafe_code, reason = "the only call that no safe library has")]
pub(super) fn release() {
    // SAFETY: it takes no pointers, and may be called at any time and by any thread.
    unsafe { libmimalloc_sys::mi_collect(true) };
}
