//! Paths in space: order, scale, marks.

use super::super::choice::{Choice, Panel};
use super::super::paths::marks;
use super::runs::{run, two_vehicles};
use super::*;

fn flight() -> Run {
    run("flight", "A flight")
        .along("path.setpoint.position", |t| [t, t / 2.0, 5.0])
        .with("path.leg", "", |t| (t / 6.0).floor())
        .of_kind("Integer", &[])
        .along("quad.state.position", |t| [t, t / 2.0 + 0.3, 5.0])
        .with("quad.thrust", "N", |t| t)
}

#[test]
fn without_a_choice_paths_come_first_and_positions_before_setpoints() {
    let choice = Choice::new(&[flight()], &Selection::default()).unwrap();
    assert_eq!(choice.paths, ["quad.state.position", "path.setpoint.position"]);
    let curves: Vec<Vec<_>> =
        choice.panels.iter().map(|p| p.curves.iter().map(|c| c.name.as_str()).collect()).collect();
    assert_eq!(curves, [vec!["path.leg"], vec!["quad.thrust"]]);
    assert_eq!(choice.shown, (8, 8));
}

#[test]
fn a_mark_stands_at_the_start_at_each_change_and_at_the_end() {
    let marks = marks(&flight(), "path.leg").unwrap();
    let texts: Vec<_> = marks.iter().map(|mark| (mark.at_s, mark.letter.as_str())).collect();
    assert_eq!(texts, [(0.0, "A"), (6.0, "B"), (12.0, "C"), (18.0, "D"), (20.0, "E")]);
    let selection = Selection { mark: Some("path.leg".to_owned()), ..Selection::default() };
    let drawing = picture("marks", &[flight()], &selection);
    assert!(["A", "B", "C", "D", "E"].iter().all(|letter| has(&drawing, letter)));
}

#[test]
fn several_vehicles_have_lines_of_their_own_and_their_distance_a_panel() {
    let drawing = picture("two", &[two_vehicles()], &Selection::default());
    let paths = ["wing[1].state.position", "wing[2].state.position"];
    assert!(paths.iter().all(|name| has(&drawing, name)), "{:?}", texts(&drawing));
    assert!(has(&drawing, "dist(wing[1].state.position, wing[2].state.position) < 9 m"));
    assert!(has(&drawing, "together: below 9") && has(&drawing, "fails first at 8 s"));
    let strokes: Vec<_> = [2.2, 1.6].iter().enumerate().map(|(index, width)| Stroke::of_curve(index, *width)).collect();
    assert_ne!(strokes[0].dash, strokes[1].dash, "they differ in grey too");
    for stroke in strokes {
        let is_path = |element: &Element| matches!(element, Element::Lines(_, shown) if *shown == stroke);
        assert!(drawing.picture.elements.iter().any(is_path), "{stroke:?}");
    }
    let rolls = two_vehicles().with("wing[1].roll", "rad", |t| t).with("wing[2].roll", "rad", |t| -t);
    let apart = rolls.claims[0].comparisons[0].clone();
    let apart = crate::comparison::Comparison { high: None, low: Some(2.0), ..apart };
    let rolls = [rolls.claim("apart", "ok", (None, 0.0), &[apart])];
    let choice = Choice::new(&rolls, &Selection::default()).unwrap();
    assert_eq!(choice.panels[0].limits.len(), 2, "two claims about one quantity share a panel");
    let drawing = picture("two-claims", &rolls, &Selection::default());
    assert!(
        has(&drawing, "together fails first at 8 s") && has(&drawing, "apart worst 8 at 0 s"),
        "{:?}",
        texts(&drawing)
    );
    let has_both =
        |panel: &Panel| panel.curves.iter().map(|curve| curve.name.as_str()).eq(["wing[1].roll", "wing[2].roll"]);
    assert!(choice.panels.iter().any(has_both), "the same signal of both vehicles shares a panel");
    for (name, view, width) in [("above", ViewFrom::Above, 960.0), ("small", ViewFrom::Oblique, 420.0)] {
        let selection = Selection { view, width: Some(width), ..Selection::default() };
        picture(&format!("two-{name}"), &[two_vehicles()], &selection);
    }
}

#[test]
fn a_second_run_lies_below_the_first_in_space_too() {
    let mut other = flight();
    other.name = "windy".to_owned();
    other.table.columns[5].values.iter_mut().flatten().for_each(|y| *y += 2.0);
    picture("flights", &[flight(), other], &Selection::default());
}
