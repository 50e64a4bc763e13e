//! The entry of the logger where variable arguments cannot be read yet: messages keep their bare format.

use super::deliver;
use fmi2::c::{CallbackLogger, ComponentEnvironment, RawStatus, Str};
use std::ffi::{CStr, c_void};
use std::sync::atomic::{AtomicBool, Ordering};

/// What units get as `logger`.
// SAFETY: the named arguments of a variadic function travel like those of any other, and the rest is never looked at.
pub const LOGGER: CallbackLogger = unsafe { std::mem::transmute(handle as *const c_void) };

/// # Safety
/// The texts are NULL or end in a zero byte.
unsafe extern "C" fn handle(
    environment: ComponentEnvironment,
    name: Str,
    status: RawStatus,
    category: Str,
    message: Str,
) {
    static TOLD: AtomicBool = AtomicBool::new(false);
    let text = || {
        if message.is_null() {
            return Vec::new();
        }
        // SAFETY: the caller says so.
        let mut text = unsafe { CStr::from_ptr(message) }.to_bytes().to_vec();
        if text.contains(&b'%') && !TOLD.swap(true, Ordering::Relaxed) {
            text.extend(b" (on this platform messages are shown without their printf arguments)");
        }
        text
    };
    // SAFETY: the caller says so.
    unsafe { deliver(environment, name, status, category, text) }
}
