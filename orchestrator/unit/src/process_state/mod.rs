//! What a unit may change in its process, although it should not: compared, restored and named.
//!
//! Other units and Lockstep's own arithmetic would compute other numbers than if the unit had a process of its own.

mod changes;
pub(crate) mod floating_point;
mod look;

pub use changes::Changes;
pub use look::compare_each_step;
pub(crate) use look::{compare_each_call, compares_each_call, is_copy, look, notice_copies};

use std::env;
use std::ffi::{CStr, CString};
use std::path::PathBuf;
use std::ptr;

/// Locale and working directory of the process, and the locale of this thread.
struct Surroundings {
    locale: CString,
    thread_locale: libc::locale_t,
    folder: Option<PathBuf>,
}

impl Surroundings {
    fn now() -> Self {
        // SAFETY: without a name `setlocale` only returns the present locale, a text that is valid until the next change;
        // without a locale `uselocale` only returns that of this thread.
        let (locale, thread_locale) = unsafe {
            let locale = libc::setlocale(libc::LC_ALL, ptr::null());
            let locale = if locale.is_null() { c"C" } else { CStr::from_ptr(locale) };
            (locale.to_owned(), libc::uselocale(ptr::null_mut()))
        };
        Self { locale, thread_locale, folder: env::current_dir().ok() }
    }

    /// Restores what is not as it was.
    fn restore(self) -> Changes {
        let now = Self::now();
        let mut changes = Changes::NONE;
        if (&now.locale, now.thread_locale) != (&self.locale, self.thread_locale) {
            changes |= Changes::LOCALE;
            // SAFETY: both were returned by these functions; foreign code that frees the locale of a thread which it did not
            // make is wrong already.
            unsafe {
                libc::setlocale(libc::LC_ALL, self.locale.as_ptr());
                libc::uselocale(self.thread_locale);
            }
        }
        if let Some(folder) = self.folder
            && now.folder.as_ref() != Some(&folder)
        {
            changes |= Changes::FOLDER;
            // If the folder was removed meanwhile it cannot be restored.
            env::set_current_dir(folder).ok();
        }
        changes
    }
}

/// Restores floating-point control if it was changed; every call is compared then.
#[must_use]
#[inline]
pub fn restored_floating_point() -> Changes {
    if !floating_point::has_changed() {
        return Changes::NONE;
    }
    compare_each_call();
    floating_point::restore()
}

/// Runs foreign code, then restores floating-point control, locale and working directory. Says what was changed.
pub(crate) fn preserved<T>(foreign: impl FnOnce() -> T) -> (T, Changes) {
    let before = Surroundings::now();
    let result = foreign();
    (result, restored_floating_point() | before.restore())
}

#[cfg(target_arch = "x86_64")]
#[test]
fn what_foreign_code_changes_is_restored_and_named() {
    assert_eq!(preserved(|| 7), (7, Changes::NONE));
    let ((), changes) = preserved(floating_point::tests::disturb);
    assert!(!floating_point::has_changed());
    assert_eq!(changes.to_string(), "the rounding mode and flush-to-zero");
    let ((), changes) = preserved(|| {
        // SAFETY: the name is a valid text; the locale exists in every C library. Other tests of this process do not format
        // numbers by it.
        unsafe { libc::setlocale(libc::LC_CTYPE, c"C.UTF-8".as_ptr()) };
    });
    assert_eq!(changes.to_string(), "the locale");
    assert_eq!(preserved(|| ()).1, Changes::NONE);
}
