//! Tests of what a picture shows.

use super::*;
use crate::table::Column;

fn trace() -> Table {
    let units = [
        ("time", Some("s")),
        ("path.setpoint.position.x", Some("m")),
        ("path.setpoint.position.y", Some("m")),
        ("path.setpoint.position.z", Some("m")),
        ("path.leg", None),
        ("quad.state.position.x", Some("m")),
        ("quad.state.position.y", Some("m")),
        ("quad.state.position.z", Some("m")),
        ("quad.roll", Some("rad")),
        ("quad.pitch", Some("rad")),
        ("quad.thrust", Some("N")),
    ];
    let value = |i: usize, k: u32| f64::from(if i == 4 { k / 4 } else { i as u32 * k });
    let column = |(i, (name, unit)): (usize, &(&str, Option<&str>))| Column {
        name: (*name).to_owned(),
        unit: unit.map(str::to_owned),
        values: (0..10).map(|k| Some(value(i, k))).collect(),
        ..Column::default()
    };
    Table { columns: units.iter().enumerate().map(column).collect(), partial: false }
}

#[test]
fn without_a_choice_paths_come_first_and_positions_before_setpoints() {
    let table = trace();
    let (paths, panels) = Trace { table: &table }.default_choice();
    let names: Vec<_> = paths.iter().map(|path| path.name.as_str()).collect();
    assert_eq!(names, ["quad.state.position", "path.setpoint.position"]);
    let curves: Vec<Vec<_>> = panels.iter().map(|p| p.curves.iter().map(|c| c.name.as_str()).collect()).collect();
    assert_eq!(curves, [vec!["path.leg"], vec!["quad.roll", "quad.pitch"], vec!["quad.thrust"]]);
}

#[test]
fn angles_are_drawn_in_degrees() {
    let table = trace();
    let panel = Trace { table: &table }.panel(&["quad.roll"]);
    assert_eq!(panel.unit, "deg");
    assert!((panel.curves[0].values[1] - 8.0 * 57.295_779_513).abs() < 1e-6);
}

#[test]
fn a_mark_stands_at_the_start_at_each_change_and_at_the_end() {
    let table = trace();
    let marks = Trace { table: &table }.marks("path.leg").unwrap();
    let texts: Vec<_> = marks.iter().map(|mark| (mark.index, mark.text.as_str())).collect();
    assert_eq!(texts, [(0, "A"), (4, "B"), (8, "C"), (9, "D")]);
}

#[test]
fn a_name_that_was_not_recorded_is_an_error() {
    let table = trace();
    let selection = Selection { signals: vec!["quad.rol".to_owned()], mark: None };
    let error = draw("t", &table, &selection).unwrap_err();
    assert_eq!(error.to_string(), "no column or group `quad.rol` was recorded");
}

#[test]
fn a_picture_is_closed_and_names_its_curves() {
    let table = trace();
    let svg = draw("A run", &table, &Selection::default()).unwrap();
    assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
    for name in ["A run", "quad.state.position", "path.setpoint.position", "quad.thrust", "time, s"] {
        assert!(svg.contains(name), "{name}");
    }
}
