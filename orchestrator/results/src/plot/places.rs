//! Positions of a group, found by the names and units of its ports: with a radius they are circles, else points.

use super::PlotError;
use super::run::Run;
use super::trace::is_place;
use super::view::Point;
use std::collections::BTreeMap;

/// One position of a group, with what else the group says of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Place {
    /// At the last row.
    pub at: Point,
    /// At the first row.
    pub first: Point,
    pub radius_m: Option<f64>,
    /// The extent upwards; `at` is in the middle of it.
    pub height_m: Option<f64>,
}

/// A port below the group: the index of its element, its name without index and leaf, and its leaf.
struct Member<'a> {
    column: &'a str,
    index: usize,
    stem: String,
    leaf: String,
}

/// Names of positions, the first are preferred to others.
const POSITIONS: [&str; 5] = ["position", "point", "center", "centre", ""];

/// The positions below a group that have x and y in metres, in the order of their indices; as many as `count` of the group
/// says, if it has one.
pub(super) fn places(run: &Run, group: &str) -> Result<Vec<Place>, PlotError> {
    let columns = run.members(group);
    if columns.is_empty() {
        return Err(PlotError::Unknown(group.to_owned()));
    }
    let members: Vec<_> = columns.iter().map(|column| member(column, group)).collect();
    let in_metres = |member: &&Member<'_>| run.unit(member.column) == "m";
    let stems: Vec<_> = members
        .iter()
        .filter(in_metres)
        .filter(|member| member.leaf == "x")
        .map(|member| member.stem.as_str())
        .collect();
    let rank = |stem: &&&str| POSITIONS.iter().position(|name| name == *stem).unwrap_or(POSITIONS.len());
    let Some(stem) = stems.iter().min_by_key(rank).copied() else {
        let reason = format!("it has no x and y in metres; it has {}", few(&columns));
        return Err(PlotError::Unfit { name: group.to_owned(), reason });
    };
    let count = run.last(&format!("{group}.count")).map_or(usize::MAX, |count| count.max(0.0) as usize);
    let mut found: BTreeMap<usize, BTreeMap<&str, &str>> = BTreeMap::new();
    for member in members.iter().filter(in_metres) {
        let is_coordinate = member.stem == stem && ["x", "y", "z"].contains(&member.leaf.as_str());
        if is_coordinate || ["radius", "height"].contains(&member.leaf.as_str()) {
            found.entry(member.index).or_default().insert(&member.leaf, member.column);
        }
    }
    let place = |leaves: &BTreeMap<&str, &str>| {
        let at = |value: fn(&Run, &str) -> Option<f64>, leaf: &str| {
            leaves.get(leaf).and_then(|name| value(run, name)).filter(is_place)
        };
        let point = |value: fn(&Run, &str) -> Option<f64>| {
            Some([at(value, "x")?, at(value, "y")?, at(value, "z").unwrap_or(0.0)])
        };
        let (radius_m, height_m) = (at(Run::last, "radius"), at(Run::last, "height"));
        Some(Place { at: point(Run::last)?, first: point(Run::first)?, radius_m, height_m })
    };
    Ok(found.values().filter_map(place).take(count).collect())
}

/// The positions with a radius above zero.
pub(super) fn circles(run: &Run, group: &str) -> Result<Vec<Place>, PlotError> {
    let places = places(run, group)?;
    if !places.iter().any(|place| place.radius_m.is_some()) && !places.is_empty() {
        let reason = format!("its positions have no `radius` in metres; it has {}", few(&run.members(group)));
        return Err(PlotError::Unfit { name: group.to_owned(), reason });
    }
    Ok(places.into_iter().filter(|place| place.radius_m.is_some_and(|radius| radius > 0.0)).collect())
}

fn member<'a>(column: &'a str, group: &str) -> Member<'a> {
    let rest = column.get(group.len()..).unwrap_or_default();
    let (mut plain, mut index, mut digits) = (String::new(), 0, None);
    for letter in rest.chars() {
        match (letter, &mut digits) {
            ('[', _) => digits = Some(String::new()),
            (']', Some(number)) => {
                index = number.parse().unwrap_or(0);
                digits = None;
            }
            (letter, Some(number)) => number.push(letter),
            (letter, None) => plain.push(letter),
        }
    }
    let plain = plain.trim_matches('.');
    let (stem, leaf) = plain.rsplit_once('.').unwrap_or(("", plain));
    Member { column, index, stem: stem.to_owned(), leaf: leaf.to_owned() }
}

/// Some of the names.
pub(super) fn few(names: &[&str]) -> String {
    let more = if names.len() > 6 { format!(" and {} more", names.len() - 6) } else { String::new() };
    names[..names.len().min(6)].join(", ") + &more
}
