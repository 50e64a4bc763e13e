//! `sweep`: its cases, and what they make of a script.

use std::fmt::Write;

use super::fixtures::{Outcome, all_shown, flight, run_case, run_with, scenario, shown};
use dsl::scenario::{Case, Scenario, Sweep};

const SWEEP: &str = "param gust = 4 m/s
param start = [0, 0, 1] m
param method = \"ant\"
param calm = false
param drift = 0 m/s
wind.velocity -> quad.wind
quad.state -> ctrl.state
gust + drift -> ctrl.raw
calm -> ctrl.armed
let place = start
let note = method
record place
sweep {
  gust in [2 m/s, 40 km/h]
  start in [[0, 0, 1] m, [5, 0, 2] m]
  seed in 3..5
  method ~ choice(\"ant\", \"bee\")
  calm ~ choice([true, false])
  drift ~ normal(0 m/s, 0.5 m/s)
}";

/// The parameters of a case, as `name = value`.
fn parameters(script: &str, settings: &[&str], case: u64) -> Vec<String> {
    let outcome = run_case(script, settings, case);
    let Some(scenario) = &outcome.resolved.scenario else { panic!("{}", outcome.shown()) };
    scenario.parameters.iter().map(|it| format!("{} = {}", it.name, it.value)).collect()
}

#[test]
fn the_first_axis_is_the_slowest_and_each_case_draws_its_own_values() {
    let script = flight(SWEEP);
    let mut shown = String::new();
    for case in 0..12 {
        writeln!(shown, "{case}: {}", parameters(&script, &[], case).join(", ")).unwrap();
    }
    insta::assert_snapshot!(shown);
}

#[test]
fn without_a_case_parameters_have_their_own_values() {
    let scenario = without_case(SWEEP);
    assert_eq!(scenario.sweep, Some(Sweep { cases: 12, case: None }));
    assert!(scenario.parameters.iter().any(|it| it.name == "seed" && it.value == "1"));
    assert_eq!(scenario.parameters[0].value, "4 m/s");
}

fn without_case(lines: &str) -> Scenario {
    run_with(&flight(lines), &[]).resolved.scenario.expect("no error")
}

#[test]
fn draws_depend_on_case_name_and_the_seed_of_the_command_line_alone() {
    let script = |axes: &str| {
        flight(&format!("param a = 0 m\nparam b = 0 m\nlet c = a + b\nrecord quad.roll\nsweep {{ {axes} }}"))
    };
    let one = parameters(&script("seed in 1..9, a ~ uniform(1 m, 2 m), b ~ uniform(1 m, 2 m)"), &[], 4);
    let other = parameters(&script("b ~ uniform(1 m, 2 m), a ~ uniform(1 m, 2 m), seed in 11..19"), &[], 4);
    assert_eq!((&one[..2], one[2].as_str(), other[2].as_str()), (&other[..2], "seed = 5", "seed = 15"));
    assert_ne!(one[0].strip_prefix("a"), one[1].strip_prefix("b"), "axes have draws of their own");
    let set = script("seed in 1..9, a ~ uniform(1 m, 2 m), b ~ uniform(1 m, 2 m)");
    let outcome = run_case(&set, &["seed = 7"], 4).resolved.scenario.expect("no error");
    let seed = &outcome.parameters[2];
    assert_eq!((seed.value.as_str(), seed.set), ("5", false), "the case gives `seed` its value");
    assert_ne!(outcome.parameters[0].value, one[0].trim_start_matches("a = "), "and the draws have another seed");
    assert_eq!(outcome.sweep.and_then(|sweep| sweep.case), Some(Case { number: 4, draw_seed: Some(7) }));
}

#[test]
fn a_drawn_value_can_be_set_again_to_the_same_bits() {
    let lines = "param a = 0 deg\nfmu other = \"quadcopter_controller\" { tilt_max = a }\nrecord other.thrust\n\
                 sweep { seed in 1..9, a ~ normal(5 deg, 1 deg) }";
    let script = flight(lines);
    let drawn = parameters(&script, &[], 3)[0].clone();
    let value = |outcome: Outcome| outcome.resolved.scenario.map(|it| it.instances[3].presets.clone());
    let (case, again) = (value(run_case(&script, &[], 3)), value(run_with(&script, &[&drawn])));
    assert!(case.is_some() && case == again, "{drawn}: {case:?}, {again:?}");
}

#[test]
fn a_swept_number_of_rounds_makes_other_units() {
    let script = "scenario \"Test\"\nstep 10 ms\nstop 1 s\nparam n = 1\n\
                  for i in 1..n { fmu quad[i] = \"quadcopter\" { mass = 2 kg } }\n\
                  record quad[1].roll\nsweep { n in [1, 3], seed in 1..2 }";
    let units = |case| run_case(script, &[], case).resolved.scenario.expect("no error").instances.len();
    assert_eq!([0, 1, 2, 3].map(units), [1, 1, 3, 3]);
    assert_eq!(scenario(script).instances.len(), 1);
}

#[test]
fn an_axis_takes_units_of_measure_that_a_unit_defines() {
    let script = flight("param load = 1 N*m\nload -> quad.moment\nsweep { load in 2..4 'N.m' }");
    let outcome = run_case(&script, &[], 2);
    let text = outcome.resolved.scenario.as_ref().map(|it| it.parameters[0].value.clone());
    assert_eq!(text.as_deref(), Some("4 'N.m'"), "{}", outcome.shown());
}

#[test]
fn what_is_wrong_with_a_sweep_is_reported_at_its_place() {
    let with = |axes: &str| {
        let lines = format!("param gust = 4 m/s\nparam near = gust\nlet far = 2 * gust\nsweep {{ {axes} }}");
        shown(&flight(&lines))
    };
    let wrong = [
        "gsut in [2, 4] m/s",
        "gust in [2, 4] m",
        "gust in 2..4, gust in [1, 2] m/s",
        "gust in [] m/s",
        "gust in 4..2 m/s",
        "gust in [quad.state.position.x / 1 s]",
        "near in [far, 3 m/s], gust in 2..4 m/s",
        "near in [near, 3 m/s]",
        "gust in 3 m/s",
        "gust in normal(0 m/s, 1 m/s)",
        "seed in 1..3, gust ~ 3 m/s",
        "seed in 1..3, gust ~ normal(0 m/s)",
        "seed in 1..3, gust ~ normal(0 m/s, -1 m/s)",
        "seed in 1..3, gust ~ normal(0 m/s, 1 m)",
        "seed in 1..3, gust ~ uniform(2 m/s, 1 m/s)",
        "seed in 1..3, gust ~ choice()",
        "seed in 1..3, gust ~ choice(1 m/s, 2 m)",
        "gust ~ normal(0 m/s, 1 m/s)",
        "gust in -1000000000..1000000000 m/s, near in -1000000000..1000000000 m/s",
    ];
    let mut all = String::new();
    for axes in wrong {
        writeln!(all, "== {axes}\n{}", with(axes)).unwrap();
    }
    insta::assert_snapshot!(all);
}

#[test]
fn a_distribution_outside_of_a_sweep_is_refused_with_what_may_be_meant() {
    insta::assert_snapshot!(shown(&flight("let a = normal(0 m, 1 m)\nsweep { seed in 1..2 }\nsweep { seed in 1..2 }")));
}

#[test]
fn a_case_that_there_is_not_or_that_is_set_too_is_refused() {
    let script = flight("param gust = 4 m/s\ngust / 1 s -> ctrl.raw\nsweep { gust in 1..3 m/s }");
    let cases = [
        run_case(&script, &[], 3),
        run_case(&script, &["gust = 2 m/s"], 2),
        run_case(&flight("quad.state -> ctrl.state"), &[], 0),
        run_case(&flight("sweep { seed in 1..3 }"), &["seed = 2"], 0),
    ];
    insta::assert_snapshot!(cases.map(Outcome::shown).join("\n"));
}

#[test]
fn a_swept_parameter_that_nothing_uses_is_warned_of() {
    let unused = all_shown(&flight("param gust = 4 m/s\nsweep { gust in 1..3 m/s, seed in 1..2 }"));
    let lines: Vec<_> =
        unused.lines().filter(|line| line.contains("is not used") && !line.contains("`wind`")).collect();
    assert!(lines.iter().any(|line| line.ends_with("`gust` is not used")), "{unused}");
    assert!(lines.iter().any(|line| line.ends_with("`seed` is not used")), "{unused}");
    let used = all_shown(&flight("fmu other = \"quadcopter_controller\" { seed = seed }\nsweep { seed in 1..2 }"));
    assert!(!used.contains("`seed` is not used"), "{used}");
}
