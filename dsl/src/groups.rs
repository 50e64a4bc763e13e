//! Names of single variables, replaced by the names of the groups that they make up.

use std::collections::BTreeMap;

/// The names of variables without the members that all of them end in; each keeps its first part.
///
/// `state.position.x` and `vehicle.position.x` become `state` and `vehicle`.
#[must_use]
pub fn without_shared_members(names: &[&str]) -> Vec<String> {
    let mut parts: Vec<Vec<&str>> = names.iter().map(|name| parts(name)).collect();
    while parts.iter().all(|parts| parts.len() > 1) && parts.iter().all(|other| other.last() == parts[0].last()) {
        for parts in &mut parts {
            parts.pop();
        }
    }
    parts.into_iter().map(|parts| parts.concat()).collect()
}

/// Names by their first part, those with members with a count: `state (13), contact`.
#[must_use]
pub fn groups<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let mut groups: Vec<(&str, &str, usize)> = Vec::new();
    let mut places = BTreeMap::new();
    for name in names {
        let first = parts(name)[0];
        let place = *places.entry(first).or_insert(groups.len());
        match groups.get_mut(place) {
            Some((_, _, count)) => *count += 1,
            None => groups.push((first, name, 1)),
        }
    }
    let texts = groups.into_iter().map(|(group, name, count)| match count {
        1 => name.to_owned(),
        _ => format!("{group} ({count})"),
    });
    texts.collect::<Vec<_>>().join(", ")
}

/// `a.b[1,2].'c.d'` as `a`, `.b`, `[1,2]`, `.'c.d'`; a quoted part stays whole.
#[must_use]
pub fn parts(name: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let (mut begin, mut quoted) = (0, false);
    for (at, letter) in name.char_indices() {
        match letter {
            '\'' => quoted = !quoted,
            '.' | '[' if !quoted && at > begin => {
                parts.push(&name[begin..at]);
                begin = at;
            }
            _ => {}
        }
    }
    parts.push(&name[begin..]);
    parts
}

#[test]
fn members_and_indices_are_parts_and_quoted_dots_are_none() {
    assert_eq!(parts("a.b[1,2].'c.d'"), ["a", ".b", "[1,2]", ".'c.d'"]);
    assert_eq!(parts("level"), ["level"]);
}

#[test]
fn what_all_names_end_in_is_left_out_down_to_the_first_part() {
    assert_eq!(without_shared_members(&["state.position.x", "vehicle.position.x"]), ["state", "vehicle"]);
    assert_eq!(without_shared_members(&["velocity.x", "wind.x"]), ["velocity", "wind"]);
    assert_eq!(without_shared_members(&["state.position.x", "x"]), ["state.position.x", "x"]);
    assert_eq!(without_shared_members(&["state.position.x", "state.position.x"]), ["state", "state"]);
}

#[test]
fn groups_count_their_members() {
    assert_eq!(groups(["state.x", "state.y", "contact", "rate.z"]), "state (2), contact, rate.z");
}
