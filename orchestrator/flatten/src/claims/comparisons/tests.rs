//! Tests of what is written of a claim's comparisons, from the text of a script.

use super::comparisons;
use crate::listing::tests::{TANK, resolved};
use results::comparison::{Comparison, Quantity};

/// The comparisons of the claim in the last line of a script, with what it records.
fn of(record: &str, claim: &str) -> Vec<Comparison> {
    let lines = "fmu tank = \"tank\" { inflow = [0, 0] m, fine = 0 mm, mode = 0 }\nlet low = tank.level.x - 1 m\n";
    let script = format!("scenario \"A tank\"\nstep 10 ms\nstop 2 s\n{lines}record {record}\nassert c: {claim}\n");
    let output =
        r#"<ScalarVariable name="drops" valueReference="7" causality="output"><Real unit="mm"/></ScalarVariable>"#;
    let description = TANK.replace("</ModelVariables>", &format!("{output}</ModelVariables>"));
    let unknown = r#"<Unknown index="7" dependencies="1 2"/>"#;
    let description = description.replace(unknown, &format!("{unknown}{}", unknown.replace('7', "8")));
    let (scenario, _) = resolved(&script, &description);
    comparisons(&scenario.claims[0], &scenario)
}

const ALL: &str = "tank.level, tank.spill, tank.drops, low";

/// Quantity, lower and upper limit of each comparison.
fn limits(claim: &str) -> Vec<(String, Option<f64>, Option<f64>)> {
    let of = of(ALL, claim).into_iter();
    of.map(|it| (serde_json::to_string(&it.quantity).unwrap(), it.low, it.high)).collect()
}

fn column(name: &str) -> String {
    format!("{{\"column\":\"{name}\"}}")
}

#[test]
fn a_column_alone_is_limited_in_its_own_unit() {
    assert_eq!(limits("always tank.spill < 3 m"), [(column("tank.spill"), None, Some(3.0))]);
    assert_eq!(limits("always 1 m < tank.spill < 3 m").len(), 2);
    assert_eq!(limits("always tank.drops > 0.25 m"), [(column("tank.drops"), Some(250.0), None)]);
    assert_eq!(limits("not eventually tank.spill > 3 m"), [(column("tank.spill"), None, Some(3.0))]);
    assert_eq!(limits("always tank.spill == 2 m ± 0.5 m"), [(column("tank.spill"), Some(1.5), Some(2.5))]);
    assert_eq!(limits("always low < 3 m"), [(column("low"), None, Some(3.0))]);
}

#[test]
fn a_largest_magnitude_limits_each_argument_on_both_sides() {
    let both = [column("tank.level.x"), column("tank.level.y")].map(|name| (name, Some(-2.0), Some(2.0)));
    assert_eq!(limits("always max(abs(tank.level.x), abs(tank.level.y)) < 2 m"), both);
}

#[test]
fn what_is_computed_from_several_columns_is_written_out() {
    let found = of(ALL, "always abs(tank.level.x - tank.level.y) + tank.spill < 50 cm");
    let [comparison] = found.as_slice() else { panic!("{found:?}") };
    assert_eq!(comparison.quantity.columns(), ["tank.level.x", "tank.level.y", "tank.spill"]);
    assert_eq!((comparison.unit.as_deref(), comparison.high, comparison.low), (Some("cm"), Some(50.0), None));
    let value = comparison.quantity.value(0.0, &|name| if name == "tank.level.y" { 0.4 } else { 0.1 });
    assert!((value - 40.0).abs() < 1e-9, "{value}");
    assert_eq!(comparison.text, "abs(tank.level.x - tank.level.y) + tank.spill < 50 cm");
    let found = of(ALL, "always tank.level.x < tank.level.y");
    assert_eq!((found[0].low, found[0].high, found[0].is_margin), (Some(0.0), None, true));
}

#[test]
fn a_comparison_has_the_time_at_which_it_counts_and_the_part_of_its_claim() {
    let found = of(ALL, "(always within 0.5..1 s tank.spill < 3 m) and eventually tank.level.x > 1 m");
    let times: Vec<_> = found.iter().map(|it| (it.part, it.from_s, it.to_s, it.once)).collect();
    assert_eq!(times, [(0, 0.5, Some(1.0), false), (1, 0.0, None, true)]);
    let found = of(ALL, "always (tank.level.x > 1 m implies tank.spill < 3 m)");
    let parts: Vec<_> = found.iter().map(|it| (it.part, it.quantity.columns())).collect();
    assert_eq!(parts, [(1, vec!["tank.spill"])], "a gate limits nothing");
    assert_eq!(of(ALL, "finally tank.spill < 3 m")[0].from_s, 2.0);
}

#[test]
fn what_is_not_recorded_or_sums_up_samples_has_no_comparison() {
    assert_eq!(of("tank.level.y", "always tank.spill < 3 m"), []);
    assert_eq!(of(ALL, "finally rms(tank.spill) < 3 m"), []);
    let found = of("tank.level.y", "always (tank.spill < 3 m and tank.level.y < 3 m)");
    assert_eq!(
        found.iter().map(|it| (it.part, &it.quantity)).collect::<Vec<_>>(),
        [(1, &Quantity::Column { column: "tank.level.y".to_owned() })]
    );
}
