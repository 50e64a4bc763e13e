//! What `record` records.

use super::fixtures::{flight, run_with, scenario, shown};
use dsl::scenario::{ColumnSource, Scenario};

fn columns(scenario: &Scenario) -> Vec<String> {
    let shown = |column: &dsl::scenario::Column| {
        let source = match &column.source {
            ColumnSource::Port(_) => String::new(),
            ColumnSource::Real { unit, .. } => format!(" in {unit:?}"),
            ColumnSource::Condition(_) => " 0 or 1".to_owned(),
        };
        let from = if column.from_tick == 0 { String::new() } else { format!(" from {}", column.from_tick) };
        format!("{}{source} every {}{from}", column.name, column.every)
    };
    scenario.columns.iter().map(shown).collect()
}

#[test]
fn record_has_periods_globs_indices_and_values() {
    let lines = "let error = dist(quad.state.position, ctrl.setpoint_is)
let near = quad.height < 3 m
let tilt = quad.roll * 2
let both = [quad.roll, ctrl.error]
record quad.state.position.{x, z}, quad.rotor_speed[*] every 20 ms
record near, tilt, both[2], both every 30 ms
record ctrl.rotor_speed, quad.roll";
    let lines = lines.replace("dist(quad.state.position, ctrl.setpoint_is)", "quad.height - ctrl.error");
    insta::assert_snapshot!(columns(&scenario(&flight(&(lines + "\nrecord error every 40 ms")))).join("\n"));
}

#[test]
fn a_running_value_with_a_start_has_no_cell_before_it() {
    let lines = "let settled = rms(quad.height, 2 s) / 2
let both = [highest(quad.height, 1 s), quad.roll]
let low = rms(quad.height, 2 s) < 1 m
record settled every 20 ms
record both, low";
    let expected = [
        "settled in \"m\" every 2 from 200",
        "both[1] in \"ft\" every 1 from 100",
        "both[2] in \"deg\" every 1",
        "low 0 or 1 every 1",
    ];
    assert_eq!(columns(&scenario(&flight(lines))), expected);
}

#[test]
fn a_whole_unit_is_its_inputs_and_outputs_and_a_part_has_its_units() {
    let lines = "record wind.*, ctrl.state.*\nfor i in 1..2 { use pair[i] = \"pair.scn\" }\n\
                 record pair[2].more[*].air.*, pair[*].left.double every 1 s";
    let outcome = run_with(&flight(lines), &[]);
    insta::assert_snapshot!(columns(&outcome.resolved.scenario.expect("no error")).join("\n"));
}

#[test]
fn parts_of_a_value_have_names_of_their_own() {
    let lines = "let place = quad.state.position
for i in 1..2 {
  let gaps = [quad.roll, quad.roll * i]
  record gaps[2]
}
use lead = \"uav.scn\"
record place.{x, z}, place.y, lead.ways[2], lead.ways[1]";
    let outcome = run_with(&flight(lines), &[]);
    let scenario = outcome.resolved.scenario.expect("no error");
    let names: Vec<_> = scenario.columns.iter().map(|column| column.name.as_str()).collect();
    let of_rounds = ["gaps[1][2]", "gaps[2][2]"];
    assert_eq!(names, [&of_rounds[..], &["place.x", "place.z", "place.y", "lead.ways[2]", "lead.ways[1]"]].concat());
}

#[test]
fn elements_of_all_instances_are_judged_together_in_order_of_their_index() {
    let lines = "for i in 9..11 { fmu far[i] = \"quadcopter\" }
assert all_low: always max(far[*].state.position.z) < 3 m
assert landed: always any(far[*].landed)
record far[*].roll";
    let scenario = scenario(&flight(lines));
    let names: Vec<_> = scenario.columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!(names, ["far[9].roll", "far[10].roll", "far[11].roll"]);
}

#[test]
fn what_cannot_be_recorded_is_reported_at_its_place() {
    let lines = "param gust = 3 m/s
let ahead = eventually quad.landed
let text = ctrl.said
record gust, ahead, text, ctrl.said, quad.roll every 15 ms
record wing[*].x, quad.roll[*], quad.roll every 30 ms
record quad.roll every 20 ms
assert a: always wind.velocity[*] > 3 m/s";
    insta::assert_snapshot!(shown(&flight(lines)));
}
