//! Error texts of zenoh, made readable for users.

/// The text of an error without the source locations (` at FILE.rs:LINE.`) that zenoh appends at each level.
pub fn without_source_places(text: &str) -> String {
    let mut parts = text.split(" at ");
    let mut kept = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let location = part.split_once(".rs:").filter(|(path, _)| !path.contains(' '));
        let rest =
            location.and_then(|(_, rest)| rest.trim_start_matches(|c: char| c.is_ascii_digit()).strip_prefix('.'));
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
fn source_locations_are_removed_and_any_other_at_stays() {
    let text = "Cannot listen at [a at /x/y/tcp.rs:61.] at /x/y/unicast.rs:338. - Caused by b at /x/z.rs:1.";
    assert_eq!(without_source_places(text), "Cannot listen at [a] - Caused by b");
    assert_eq!(without_source_places("look at this .rs:1. file"), "look at this .rs:1. file");
}
