//! The end of a process in which units may still be running.

/// Ends this process at once. Unlike `exit`, `_exit` runs no exit handlers: a unit's handler must not run while another
/// thread is still inside that unit.
pub fn at_once(code: i32) -> ! {
    // SAFETY: takes a plain number and does not return.
    unsafe { libc::_exit(code) }
}
