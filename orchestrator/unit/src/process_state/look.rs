//! What has to be looked at after every call: one word, so that a call usually costs one load more.

use fmi2::c::RawStatus;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};

/// Floating-point control is compared after every call, not only after each step.
const EACH_CALL: RawStatus = 1;
/// This process is a copy (`fork`) of one that has loaded units.
const COPY: RawStatus = 2;

/// Until the first step every call is compared.
static LOOK: AtomicI32 = AtomicI32::new(EACH_CALL);
/// Whether a call has changed floating-point control.
static CHANGED: AtomicBool = AtomicBool::new(false);

/// Not zero if something has to be looked at after a call; of the type of a status, so that both are checked at once.
#[inline]
pub(crate) fn look() -> RawStatus {
    LOOK.load(Ordering::Relaxed)
}

/// Whether this process is a copy, in which a call has returned a second time.
pub(crate) fn is_copy() -> bool {
    look() & COPY != 0
}

/// Whether floating-point control is compared after every call.
pub(crate) fn compares_each_call() -> bool {
    look() & EACH_CALL != 0
}

/// A call has changed floating-point control: from now on every call is compared.
pub(crate) fn compare_each_call() {
    CHANGED.store(true, Ordering::Relaxed);
    LOOK.fetch_or(EACH_CALL, Ordering::Relaxed);
}

/// The first step is next: unless a call has changed floating-point control before, it is compared after each step only.
pub fn compare_each_step() {
    if !CHANGED.load(Ordering::Relaxed) {
        LOOK.fetch_and(!EACH_CALL, Ordering::Relaxed);
    }
}

extern "C" fn in_copy() {
    LOOK.fetch_or(COPY, Ordering::Relaxed);
}

/// Notices from now on that a unit copies its process. A copy that starts a program, as that of `system` does, never
/// returns to a caller.
pub(crate) fn notice_copies() {
    static REGISTERED: Once = Once::new();
    REGISTERED.call_once(|| {
        // SAFETY: the handler only changes an atomic, and code of this program is never unloaded. If there is no memory for the
        // handler, copies are not noticed here.
        unsafe { libc::pthread_atfork(None, None, Some(in_copy)) };
    });
}
