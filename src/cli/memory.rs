//! Memory that is free goes back to the system: glibc keeps freed pages for itself, of which a server that runs for days
//! has no use. Other allocators give them back themselves.

/// Gives the free pages of all threads back.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
#[expect(unsafe_code, reason = "the only call that no safe library has")]
pub(super) fn release() {
    // SAFETY: it takes no pointers, and may be called at any time and by any thread.
    unsafe { libc::malloc_trim(0) };
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
pub(super) fn release() {}
