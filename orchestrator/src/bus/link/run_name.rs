//! The name of a run in keys.

use std::hash::{BuildHasher, Hasher, RandomState};

/// 16 random hex digits that tell runs apart in keys and logs. The name is not a secret and appears in no result.
#[must_use]
pub fn run_name() -> String {
    // `RandomState` gets its keys from the system. No seed is needed, as no result depends on the name.
    format!("{:016x}", RandomState::new().build_hasher().finish())
}

#[test]
fn a_name_is_16_hex_digits_and_differs_each_time() {
    let names = [run_name(), run_name()];
    assert!(names.iter().all(|name| name.len() == 16 && name.bytes().all(|digit| digit.is_ascii_hexdigit())));
    assert_ne!(names[0], names[1]);
}
