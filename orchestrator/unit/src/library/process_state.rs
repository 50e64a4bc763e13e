//! What a unit may change about its process while it is loaded or instantiated, and should not.

use std::env;
use std::ffi::c_int;

/// `fenv_t`, with room to spare: 32 bytes on x86-64, 8 or 16 elsewhere.
#[repr(C, align(16))]
struct FloatingPointEnvironment([u8; 64]);

unsafe extern "C" {
    fn fegetenv(environment: *mut FloatingPointEnvironment) -> c_int;
    fn fesetenv(environment: *const FloatingPointEnvironment) -> c_int;
}

/// Runs foreign code, then puts rounding mode, exception masks and working directory back.
pub fn preserved<T>(foreign: impl FnOnce() -> T) -> T {
    let folder = env::current_dir();
    let mut floating_point = FloatingPointEnvironment([0; 64]);
    // SAFETY: the C library fills in at most as many bytes as its own type has.
    let known = unsafe { fegetenv(&raw mut floating_point) } == 0;
    let result = foreign();
    if known {
        // SAFETY: exactly what `fegetenv` gave on this thread.
        unsafe { fesetenv(&raw const floating_point) };
    }
    if let Ok(folder) = folder
        && env::current_dir().ok().as_ref() != Some(&folder)
    {
        // If it is gone meanwhile there is nothing to go back to.
        env::set_current_dir(folder).ok();
    }
    result
}

#[test]
fn rounding_is_put_back() {
    unsafe extern "C" {
        fn fesetround(mode: c_int) -> c_int;
        fn fegetround() -> c_int;
    }
    // SAFETY: both functions take and give plain numbers and concern this thread only.
    let round = || unsafe { fegetround() };
    let before = round();
    let within = preserved(|| {
        // SAFETY: as above; 0x400 rounds down on x86-64 and is refused elsewhere.
        unsafe { fesetround(0x400) };
        round()
    });
    assert!(within != before || cfg!(not(target_arch = "x86_64")));
    assert_eq!(round(), before);
}
