//! Ends the process when an exception or the end of its thread leaves a call: no frame of this program may be unwound by
//! either, and the note on the board must still name the call.

use std::process::abort;
use std::thread::panicking;

struct Guard<F: FnMut()>(F);

impl<F: FnMut()> Drop for Guard<F> {
    fn drop(&mut self) {
        // A panic is a mistake of this program, which its hook has reported.
        if !panicking() {
            (self.0)();
            abort();
        }
    }
}

/// Runs foreign code; if it unwinds, calls `report` and aborts.
#[inline]
pub(crate) fn fatal_if_unwound<T>(report: impl FnMut(), foreign: impl FnOnce() -> T) -> T {
    let guard = Guard(report);
    let result = foreign();
    std::mem::forget(guard);
    result
}
