//! What the library of the bus says went wrong, in words for people.

/// What the library says, without the places in its source that stand at the end of each of its errors.
pub fn without_source_places(text: &str) -> String {
    let mut parts = text.split(" at ");
    let mut kept = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let place = part.split_once(".rs:").filter(|(path, _)| !path.contains(' '));
        let rest = place.and_then(|(_, rest)| rest.trim_start_matches(|c: char| c.is_ascii_digit()).strip_prefix('.'));
        match rest {
            Some(rest) => kept.push_str(rest),
            None => {
                kept.push_str(" at ");
                kept.push_str(part);
            }
        }
    }
    kept
}

#[test]
fn a_place_in_source_goes_and_any_other_at_stays() {
    let text = "Cannot listen at [a at /x/y/tcp.rs:61.] at /x/y/unicast.rs:338. - Caused by b at /x/z.rs:1.";
    assert_eq!(without_source_places(text), "Cannot listen at [a] - Caused by b");
    assert_eq!(without_source_places("look at this .rs:1. file"), "look at this .rs:1. file");
}
