//! Strings passed to a unit and back, in buffers that are reused from call to call.

use fmi2::c::Str;
use std::ffi::CStr;
use std::ptr;

/// Zero-terminated strings, and pointers to strings.
#[derive(Debug, Default)]
pub(super) struct Strings {
    bytes: Vec<u8>,
    pointers: Vec<Str>,
}

// SAFETY: the pointers are dereferenced only during a call; between calls they are unused.
unsafe impl Send for Strings {}

impl Strings {
    /// The strings as C has them. A string ends at its first zero character, if it contains one.
    pub fn for_unit(&mut self, texts: &[String]) -> &[Str] {
        let until_zero = |text: &String| text.find('\0').unwrap_or(text.len());
        self.bytes.clear();
        for text in texts {
            self.bytes.extend_from_slice(&text.as_bytes()[..until_zero(text)]);
            self.bytes.push(0);
        }
        self.pointers.clear();
        let mut rest = self.bytes.as_slice();
        for text in texts {
            self.pointers.push(rest.as_ptr().cast());
            rest = &rest[until_zero(text) + 1..];
        }
        &self.pointers
    }

    /// An array for `count` pointers that a unit writes, all NULL.
    pub fn of_unit(&mut self, count: usize) -> &mut [Str] {
        self.pointers.clear();
        self.pointers.resize(count, ptr::null());
        &mut self.pointers
    }

    /// Copies the strings whose pointers a unit wrote into the array of [`Strings::of_unit`].
    ///
    /// # Safety
    /// Each of the pointers is NULL or points to a valid string that ends in a zero byte.
    pub unsafe fn copy_to(&self, texts: &mut [String]) {
        for (text, &pointer) in texts.iter_mut().zip(&self.pointers) {
            text.clear();
            if !pointer.is_null() {
                // SAFETY: guaranteed by the caller.
                text.push_str(&unsafe { CStr::from_ptr(pointer) }.to_string_lossy());
            }
        }
    }
}

#[test]
fn strings_are_the_same_after_a_round_trip() {
    let mut strings = Strings::default();
    let sent = ["", "grüß", "a\0b"].map(String::from);
    let pointers = strings.for_unit(&sent).to_vec();
    let mut received = vec!["old".to_owned(); 4];
    let mut room = Strings::default();
    room.of_unit(4)[..3].copy_from_slice(&pointers);
    // SAFETY: `strings` owns the texts, and the fourth pointer is NULL.
    unsafe { room.copy_to(&mut received) };
    assert_eq!(received, ["", "grüß", "a", ""]);
}
