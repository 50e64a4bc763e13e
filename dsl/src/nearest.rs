//! The name that was probably meant.

/// The candidate with the fewest edits from what was written; `None` where nothing is near enough to be a slip.
#[must_use]
pub fn nearest<'n>(written: &str, candidates: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    let length = written.chars().count();
    let nearest = candidates.into_iter().map(|name| (distance(written, name), name)).min()?;
    (nearest.0 <= (length / 3).max(1)).then_some(nearest.1)
}

/// Insertions, deletions, replacements and exchanges of neighbours, each one edit; a change of case is none.
fn distance(left: &str, right: &str) -> usize {
    strsim::osa_distance(&left.to_ascii_lowercase(), &right.to_ascii_lowercase())
}

/// `a`, `a and b`, `a, b and c`, each in back quotes.
pub(crate) fn listed<'n>(names: impl IntoIterator<Item = &'n str>) -> String {
    let quoted: Vec<_> = names.into_iter().map(|name| format!("`{name}`")).collect();
    match quoted.as_slice() {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

#[test]
fn a_slip_of_one_letter_finds_the_name() {
    let names = ["position", "velocity", "mass"];
    assert_eq!(nearest("positon", names), Some("position"));
    assert_eq!(nearest("psoition", names), Some("position"));
    assert_eq!(nearest("Mass", names), Some("mass"));
}

#[test]
fn a_word_of_its_own_finds_nothing() {
    assert_eq!(nearest("temperature", ["position", "mass"]), None);
}

#[test]
fn an_exchange_of_neighbours_is_one_edit() {
    assert_eq!(distance("quda", "quad"), 1);
    assert_eq!(distance("quad", "squads"), 2);
}
