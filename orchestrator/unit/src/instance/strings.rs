//! Texts on their way to a unit and back, in memory that is kept from call to call.

use fmi2::c::Str;
use std::ffi::CStr;
use std::ptr;

/// Texts with closing zeros, and pointers to texts.
#[derive(Debug, Default)]
pub(super) struct Strings {
    bytes: Vec<u8>,
    pointers: Vec<Str>,
}

// SAFETY: between calls the pointers are leftovers that nobody follows.
unsafe impl Send for Strings {}

impl Strings {
    /// The texts as C has them. A text ends at its first zero character, if it has one.
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

    /// Room for as many pointers of a unit, all NULL.
    pub fn of_unit(&mut self, count: usize) -> &mut [Str] {
        self.pointers.clear();
        self.pointers.resize(count, ptr::null());
        &mut self.pointers
    }

    /// Copies the texts that a unit put behind [`Strings::of_unit`].
    ///
    /// # Safety
    /// Each of the pointers is NULL or leads to a living text that ends in a zero byte.
    pub unsafe fn copy_to(&self, texts: &mut [String]) {
        for (text, &pointer) in texts.iter_mut().zip(&self.pointers) {
            text.clear();
            if !pointer.is_null() {
                // SAFETY: the caller says so.
                text.push_str(&unsafe { CStr::from_ptr(pointer) }.to_string_lossy());
            }
        }
    }
}

#[test]
fn texts_come_back_as_they_went() {
    let mut strings = Strings::default();
    let sent = ["", "grüß", "a\0b"].map(String::from);
    let pointers = strings.for_unit(&sent).to_vec();
    let mut received = vec!["old".to_owned(); 4];
    let mut room = Strings::default();
    room.of_unit(4)[..3].copy_from_slice(&pointers);
    // SAFETY: `strings` holds the texts, and the fourth pointer is NULL.
    unsafe { room.copy_to(&mut received) };
    assert_eq!(received, ["", "grüß", "a", ""]);
}
