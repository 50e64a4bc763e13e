//! The logger callback on platforms whose variable arguments cannot be read yet: a message is its format.

use super::deliver;
use fmi2::c::{CallbackLogger, ComponentEnvironment, RawStatus, Str};
use std::ffi::{CStr, c_void};
use std::sync::atomic::{AtomicBool, Ordering};

/// The function that units get as `logger`.
// SAFETY: on these platforms the named arguments of a variadic function are passed like those of any other function,
// and the variable ones are never read.
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
    static REPORTED: AtomicBool = AtomicBool::new(false);
    let text = || {
        if message.is_null() {
            return Vec::new();
        }
        // SAFETY: guaranteed by the caller.
        let mut text = unsafe { CStr::from_ptr(message) }.to_bytes().to_vec();
        if text.contains(&b'%') && !REPORTED.swap(true, Ordering::Relaxed) {
            text.extend(b" (on this platform messages are shown without their printf arguments)");
        }
        text
    };
    // SAFETY: guaranteed by the caller.
    unsafe { deliver(environment, name, status, category, text) }
}
