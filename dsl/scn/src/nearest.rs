//! The name that was probably meant.

/// The candidate with the fewest edits from what was written; `None` where nothing is near enough to be a misspelling.
#[must_use]
pub fn nearest<'n>(written: &str, candidates: impl IntoIterator<Item = &'n str>) -> Option<&'n str> {
    let most_edits = (written.chars().count() / 3).max(1);
    let letters = Letters::of(written);
    let candidates = candidates.into_iter().filter(|name| letters.fewest_edits(&Letters::of(name)) <= most_edits);
    let nearest = candidates.map(|name| (distance(written, name), name)).min()?;
    (nearest.0 <= most_edits).then_some(nearest.1)
}

/// Insertions, deletions, replacements and exchanges of neighbours, each one edit; a change of case is not an edit.
fn distance(left: &str, right: &str) -> usize {
    strsim::osa_distance(&left.to_ascii_lowercase(), &right.to_ascii_lowercase())
}

/// How often each letter occurs in a name, which is quicker to compare than the name: letters that differ by 64 count as
/// one, and so do upper and lower case.
struct Letters([u8; 64]);

impl Letters {
    fn of(name: &str) -> Self {
        let mut counts = [0_u8; 64];
        for letter in name.chars() {
            let place = &mut counts[u32::from(letter.to_ascii_lowercase()) as usize % 64];
            *place = place.saturating_add(1);
        }
        Self(counts)
    }

    /// A number of edits that the distance never falls below: an edit adds at most one letter and removes at most one.
    fn fewest_edits(&self, other: &Self) -> usize {
        let pairs = || self.0.iter().zip(other.0);
        let more: usize = pairs().map(|(own, other)| usize::from(own.saturating_sub(other))).sum();
        let fewer: usize = pairs().map(|(own, other)| usize::from(other.saturating_sub(*own))).sum();
        more.max(fewer)
    }
}

/// `a`, `a and b`, `a, b and c`, each in back quotes.
#[must_use]
pub fn listed<'n>(names: impl IntoIterator<Item = &'n str>) -> String {
    let quoted: Vec<_> = names.into_iter().map(|name| format!("`{name}`")).collect();
    match quoted.as_slice() {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

#[test]
fn a_misspelling_of_one_letter_finds_the_name() {
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

#[test]
fn counted_letters_never_say_more_than_the_distance() {
    let names = ["quad", "squads", "Quda", "position", "psoition", "größe", "grösse", "", "a[1].x", "a[12].x"];
    for left in names {
        for right in names {
            let fewest = Letters::of(left).fewest_edits(&Letters::of(right));
            assert!(fewest <= distance(left, right), "`{left}` and `{right}`");
        }
    }
}
