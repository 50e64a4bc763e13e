//! The name of a run in keys.

use std::hash::{BuildHasher, Hasher, RandomState};

/// 16 random hex digits, for people and logs. It is no secret and stands in no result.
#[must_use]
pub fn run_name() -> String {
    // Its keys come from the system's random source.
    format!("{:016x}", RandomState::new().build_hasher().finish())
}

#[test]
fn a_name_is_16_hex_digits_and_another_one_each_time() {
    let names = [run_name(), run_name()];
    assert!(names.iter().all(|name| name.len() == 16 && name.bytes().all(|digit| digit.is_ascii_hexdigit())));
    assert_ne!(names[0], names[1]);
}
