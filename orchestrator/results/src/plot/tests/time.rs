//! Panels over time: what is chosen, axes, limits, bands.

use super::super::choice::Choice;
use super::super::trace::Kind;
use super::runs::{battery, column, comparison, hover, mission, run};
use super::*;
use crate::comparison::Comparison;

#[test]
fn a_hover_has_axes_that_can_be_read() {
    let drawing = picture("hover", &[hover()], &Selection::default());
    assert!(has(&drawing, "A quadcopter hovers") && has(&drawing, "7 of 7 signals"), "{:?}", texts(&drawing));
    assert!(has(&drawing, "stays: 9.95 to 10.05") && limits(&drawing).len() == 2);
    // The panel of the height, the only one with limits, goes from 9.95 to 10.05.
    assert!(has(&drawing, "9.95") && has(&drawing, "10.00") && has(&drawing, "10.05"));
    assert!(has(&drawing, "false") && has(&drawing, "true"), "a Boolean has both its values");
    assert!(["2", "3", "4"].iter().all(|tick| has(&drawing, tick)), "an Integer has whole numbers only");
    for width in [LEAST_WIDTH, 480.0, 1600.0] {
        picture(&format!("hover-{width}"), &[hover()], &Selection { width: Some(width), ..Selection::default() });
    }
}

#[test]
fn a_limit_is_a_line_with_the_first_failure_and_the_worst_sample() {
    let drawing = picture("battery", &[battery()], &Selection::default());
    let lines = limits(&drawing);
    assert_eq!(lines.len(), 1, "{lines:?}");
    assert!(lines[0].1 - lines[0].0 > 800.0, "it holds over the whole run");
    for text in ["lasts: above 0.2", "fails first at 16.7 s", "worst 0.04 at 20 s", "0 of 1 claim holds, failed: lasts"]
    {
        assert!(has(&drawing, text), "{text} is not in {:?}", texts(&drawing));
    }
    assert_eq!(rings(&drawing), 2, "one in the panel, one in its legend");
    let zoomed = Selection { from_s: Some(2.0), to_s: Some(10.0), ..Selection::default() };
    let drawing = picture("battery-zoomed", &[battery()], &zoomed);
    assert!(has(&drawing, "2 s to 10 s") && rings(&drawing) == 0, "what happened later is not shown");
}

#[test]
fn a_limit_far_from_all_values_is_named_only() {
    let high = comparison(column("a.x"), None, Some(1000.0));
    let run = run("far", "").with("a.x", "m", |t| t / 20.0).claim("low", "ok", (None, 20.0), &[high]);
    let drawing = picture("far", &[run], &Selection::default());
    assert!(has(&drawing, "low: below 1000 (outside)") && limits(&drawing).is_empty());
    assert!(has(&drawing, "1.0") && !has(&drawing, "1000"));
}

#[test]
fn a_limit_of_a_part_of_the_run_is_a_line_over_that_part() {
    let early = Comparison { from_s: 5.0, to_s: Some(10.0), ..comparison(column("a.x"), None, Some(0.9)) };
    let run = run("part", "").with("a.x", "m", |t| t / 20.0).claim("low", "ok", (None, 10.0), &[early]);
    let drawing = picture("part", &[run], &Selection::default());
    let lines = limits(&drawing);
    let (from, to, _) = lines[0];
    assert!((0.2..0.3).contains(&((to - from) / drawing.width)), "{lines:?}");
}

#[test]
fn an_enumeration_is_stairs_between_the_names_of_its_items() {
    let drawing = picture("enumeration", &[mission()], &Selection::default());
    for text in ["idle", "take_off", "cruise", "return_to_home", "landed", "false", "true"] {
        assert!(has(&drawing, text), "{text} is not in {:?}", texts(&drawing));
    }
    let stairs = drawing.picture.elements.iter().find_map(|element| match element {
        Element::Lines(pieces, stroke) if *stroke == Stroke::of_curve(0, 1.5) => Some(&pieces[0]),
        _ => None,
    });
    let is_stairs = |pair: &[(f64, f64)]| pair[0].0 == pair[1].0 || pair[0].1 == pair[1].1;
    assert!(stairs.unwrap().windows(2).all(is_stairs), "{stairs:?}");
}

#[test]
fn windows_and_modes_are_bands_over_all_panels() {
    let modes = Selection { modes: vec!["nav.mode".to_owned()], ..selecting(&["nav.height"]) };
    let drawing = picture("modes", &[mission()], &modes);
    for text in ["at 6 s: bias", "when nav.height > 11 m: set, freeze", "while nav.armed: noise", "nav.mode", "cruise"]
    {
        assert!(has(&drawing, text), "{text} is not in {:?}", texts(&drawing));
    }
    let areas = |opacity: f64| {
        let is_one = |element: &&Element| matches!(element, Element::Area(_, _, shown) if *shown == opacity);
        drawing.picture.elements.iter().filter(is_one).count()
    };
    assert_eq!((areas(0.16), areas(0.06)), (3, 3), "each window has a bar and a band in the one panel");
    assert_eq!((areas(0.35), areas(0.12)), (5, 5), "each span of the mode too");
    let real = Selection { modes: vec!["nav.height".to_owned()], ..Selection::default() };
    let error = draw(vec![mission()], &real).unwrap_err();
    assert_eq!(
        error.to_string(),
        "cannot draw `nav.height`: a mode is an enumeration, an Integer or a Boolean, this is a Real"
    );
    let missing = Selection { modes: vec!["nav.mod".to_owned()], ..Selection::default() };
    assert_eq!(draw(vec![mission()], &missing).unwrap_err(), PlotError::Unknown("nav.mod".to_owned()));
}

#[test]
fn what_claims_are_about_comes_first_of_many_signals() {
    let many = (0..200).fold(run("many", "Many signals"), |run, index| {
        run.with(&format!("unit{index}.output"), "m", move |t| t * f64::from(index))
    });
    let claimed = many.claim("late", "ok", (None, 20.0), &[comparison(column("unit150.output"), None, Some(4e3))]);
    let runs = [claimed];
    let choice = Choice::new(&runs, &Selection::default()).unwrap();
    let names: Vec<_> = choice.panels.iter().map(|panel| panel.curves[0].name.as_str()).collect();
    assert_eq!(names, ["unit150.output", "unit1.output", "unit2.output", "unit3.output"]);
    let drawing = picture("many", &runs, &Selection::default());
    assert!(has(&drawing, "4 of 200 signals"), "{:?}", texts(&drawing));
}

#[test]
fn a_long_legend_wraps() {
    let names: Vec<_> = (0..9).map(|index| format!("formation.vehicle[{index}].controller.yaw_demand")).collect();
    let run = names.iter().fold(run("long", "Long names"), |run, name| run.with(name, "rad", |t| t));
    let drawing = picture("long", &[run], &selecting(&[&names.join(",")]));
    let shown = drawing.picture.texts().into_iter().filter(|(_, text)| text.starts_with("formation"));
    let lines: std::collections::BTreeSet<_> = shown.map(|(bounds, _)| bounds[1].to_bits()).collect();
    assert!(lines.len() >= 3, "{lines:?}");
}

#[test]
fn angles_are_drawn_in_degrees_and_units_stand_at_the_axes() {
    let runs = [run("turn", "").with("quad.roll", "rad", |t| t / 20.0)];
    let choice = Choice::new(&runs, &Selection::default()).unwrap();
    assert_eq!((choice.panels[0].unit.as_str(), choice.panels[0].kind), ("deg", Kind::Real));
    let last = choice.panels[0].curves[0].of_runs[0].last().unwrap().1;
    assert!((last - 57.295_779_513).abs() < 1e-6);
    let drawing = picture("turn", &runs, &Selection::default());
    assert!(has(&drawing, "[deg]") && has(&drawing, "time [s]") && has(&drawing, "turn"));
}

#[test]
fn values_beyond_any_scale_leave_a_picture_that_can_be_read() {
    let odd = [f64::MAX, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, -1e300, 1e-300, 5e-324, 1e16 + 2.0, 0.0];
    let at = |offset: usize| move |t: f64| odd[(t as usize + offset) % odd.len()];
    let run = (0..9).fold(run("odd", "Odd values"), |run, offset| run.with(&format!("a{offset}.b"), "m", at(offset)));
    let run = run.with("steady.far", "m", |t| 1e9 + 1e-3 * t).with("steady.zero", "m", |_| 0.0);
    let run = run.with("never.known", "m", |_| f64::NAN).with("tiny.noise", "m", |t| 1e-9 * (t % 1.0));
    for names in ["a0.b", "a1.b,a2.b,a3.b", "steady.far", "steady.zero", "never.known", "tiny.noise"] {
        picture("odd", std::slice::from_ref(&run), &selecting(&[names]));
    }
    let moving = runs::run("odd", "").along("a.position", move |t| [at(4)(t), 1e12 * t, 0.0]);
    picture("odd-path", &[moving], &Selection::default());
}

#[test]
fn a_second_run_is_laid_over_the_first() {
    let mut other = battery();
    other.name = "battery, cold".to_owned();
    other.table.columns[1].values.iter_mut().flatten().for_each(|level| *level *= 0.9);
    let drawing = picture("compared", &[battery(), other], &selecting(&["battery.level"]));
    assert!(has(&drawing, "thin: battery") && has(&drawing, "broad: battery, cold"));
    let strokes = [Stroke::of_curve(0, 1.5), Stroke::of_curve(0, 1.5).of_other(1)];
    for stroke in strokes {
        let is_curve = |element: &Element| matches!(element, Element::Lines(_, shown) if *shown == stroke);
        assert!(drawing.picture.elements.iter().any(is_curve), "{stroke:?}");
    }
    assert!(strokes[1].width > 2.0 * strokes[0].width, "they differ in grey too");
}

#[test]
fn what_cannot_be_drawn_is_an_error() {
    let error = |selection: &Selection| draw(vec![battery()], selection).unwrap_err().to_string();
    assert_eq!(error(&selecting(&["battery.levl"])), "no column or group `battery.levl` was recorded");
    let late = Selection { from_s: Some(100.0), ..Selection::default() };
    let message = "no row of battery lies between --from and --to; it has rows from 0 s to 20 s";
    assert_eq!(error(&late), message);
    let narrow = Selection { width: Some(10.0), ..Selection::default() };
    assert!(error(&narrow).starts_with("a picture is 320 to 20000 pixels wide"));
    assert_eq!(draw(vec![run("empty", "")], &Selection::default()).unwrap_err(), PlotError::Empty);
    let huge = draw(vec![battery()], &Selection::default()).unwrap().png(1e4);
    assert_eq!(huge.unwrap_err(), PlotError::Size);
}
