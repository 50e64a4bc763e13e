//! Restores what a unit may change in its process while it is loaded or instantiated, although it should not.

use std::env;
use std::ffi::c_int;

/// `fenv_t`, larger than that of any platform: it has 32 bytes on x86-64, 8 or 16 elsewhere.
#[repr(C, align(16))]
struct FloatingPointEnvironment([u8; 64]);

unsafe extern "C" {
    fn fegetenv(environment: *mut FloatingPointEnvironment) -> c_int;
    fn fesetenv(environment: *const FloatingPointEnvironment) -> c_int;
}

/// Runs foreign code, then restores rounding mode, floating-point exception masks and working directory. A changed
/// rounding mode would change the results of all other code on this thread.
pub fn preserved<T>(foreign: impl FnOnce() -> T) -> T {
    let folder = env::current_dir();
    let mut floating_point = FloatingPointEnvironment([0; 64]);
    // SAFETY: the C library writes at most the size of its own type, which fits.
    let saved = unsafe { fegetenv(&raw mut floating_point) } == 0;
    let result = foreign();
    if saved {
        // SAFETY: this is what `fegetenv` stored on this thread.
        unsafe { fesetenv(&raw const floating_point) };
    }
    if let Ok(folder) = folder
        && env::current_dir().ok().as_ref() != Some(&folder)
    {
        // If the folder was removed meanwhile it cannot be restored.
        env::set_current_dir(folder).ok();
    }
    result
}

#[test]
fn the_rounding_mode_is_restored() {
    unsafe extern "C" {
        fn fesetround(mode: c_int) -> c_int;
        fn fegetround() -> c_int;
    }
    // SAFETY: both functions take and return plain numbers and affect this thread only.
    let round = || unsafe { fegetround() };
    let before = round();
    let within = preserved(|| {
        // SAFETY: as for `round`; 0x400 rounds down on x86-64 and is refused elsewhere.
        unsafe { fesetround(0x400) };
        round()
    });
    assert!(within != before || cfg!(not(target_arch = "x86_64")));
    assert_eq!(round(), before);
}
