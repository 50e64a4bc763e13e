//! What the program asks of the system for itself.

use std::ffi::c_int;
use std::ptr;

/// Makes writes beyond the limit of a file's size (`ulimit -f`) fail like those to a full disk. Otherwise SIGXFSZ would end
/// the process. The processes that this one starts inherit it.
pub fn survive_file_size_limit() {
    // SAFETY: takes plain numbers; no handler runs in this process.
    unsafe { libc::signal(libc::SIGXFSZ, libc::SIG_IGN) };
}

/// Whether this process ignores a signal: `nohup` starts programs so that they ignore SIGHUP.
#[must_use]
pub fn is_ignored(signal: c_int) -> bool {
    // SAFETY: all bits zero are a valid `sigaction`.
    let mut action: libc::sigaction = unsafe { std::mem::zeroed() };
    // SAFETY: without a new action the call writes the present one to `action`, and changes nothing.
    unsafe { libc::sigaction(signal, ptr::null(), &raw mut action) == 0 && action.sa_sigaction == libc::SIG_IGN }
}
