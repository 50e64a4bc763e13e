//! Whole scripts: one that means something, and one with five mistakes.

use super::fixtures::{flight, scenario, shown};
use dsl::scenario::{Drive, InitialStep, Port};

const PLAIN: &str = "
quad.state -> ctrl.state
ctrl.rotor_speed => quad.rotor_speed
wind.velocity -> quad.wind
assert low: always quad.state.position.z < 30 m
record quad.state.position, quad.roll
";

#[test]
fn a_plain_script_has_instances_waves_copies_claims_and_columns() {
    let scenario = scenario(&flight(PLAIN));
    assert_eq!((scenario.title.as_str(), scenario.step_ns, scenario.stop_tick), ("Test", 10_000_000, 6_000));
    let instances: Vec<_> = scenario.instances.iter().map(|i| (i.name.as_str(), i.every, i.wave)).collect();
    assert_eq!(instances, [("wind", 1, 0), ("quad", 1, 1), ("ctrl", 1, 0)]);
    assert_eq!(scenario.connections.len(), 8);
    let wind = &scenario.connections[0];
    assert_eq!(wind.target, Port { instance: 1, variable: 0 });
    assert_eq!(wind.source, Drive::Copy(Port { instance: 0, variable: 5 }));
    assert!(!wind.direct);
    assert!(scenario.connections[3].direct);
    assert_eq!(
        (scenario.claims[0].line, scenario.claims[0].text.as_str()),
        (11, "always quad.state.position.z < 30 m")
    );
    let columns: Vec<_> = scenario.columns.iter().map(|column| column.name.as_str()).collect();
    assert_eq!(columns, ["quad.state.position.x", "quad.state.position.y", "quad.state.position.z", "quad.roll"]);
    let seed = &scenario.parameters[0];
    assert_eq!((seed.name.as_str(), seed.value.as_str(), seed.set), ("seed", "1", false));
}

#[test]
fn a_unit_is_listed_once_in_order_of_first_use() {
    let scenario = scenario(&flight("fmu twin = \"quadcopter\"\nfmu gust = \"wind\" { seed = 2 }"));
    let units: Vec<_> = scenario.units.iter().map(|unit| unit.name.as_str()).collect();
    assert_eq!(units, ["wind", "quadcopter", "quadcopter_controller"]);
    let unit_of: Vec<_> = scenario.instances.iter().map(|instance| instance.unit).collect();
    assert_eq!(unit_of, [0, 1, 2, 1, 0]);
}

#[test]
fn initialization_sets_what_a_source_depends_on_before_it_is_read() {
    let scenario = scenario(&flight(PLAIN));
    assert_eq!(
        scenario.initialization,
        [
            InitialStep::Get { instance: 0, variables: vec![5, 6, 7] },
            InitialStep::Get { instance: 1, variables: vec![12, 13, 14] },
            InitialStep::Set { instance: 2, connections: vec![5, 6, 7] },
            InitialStep::Get { instance: 2, variables: vec![18, 19] },
            InitialStep::Set { instance: 1, connections: vec![0, 1, 2, 3, 4] },
        ]
    );
}

#[test]
fn a_script_with_five_mistakes_shows_five_errors() {
    let lines = "quad.hieght -> ctrl.setpoint.x
ctrl.thrust => quad.moment
quad.state -> wind.velocity
assert late: eventually within 70 s quad.roll < 5 deg
at 12.345 s lasting 1 s { set quad.drag = 0.3 }";
    insta::assert_snapshot!(shown(&flight(lines)), @r#"
    error[E01]: `quad` has no variable `hieght`
     --> test.scn:7:6
      |
    7 | quad.hieght -> ctrl.setpoint.x
      |      ^^^^^^
      |
      = help: did you mean `height`? All 19: lockstep describe quadcopter

    error[E02]: cannot connect a force to a torque
     --> test.scn:8:1
      |
    8 | ctrl.thrust => quad.moment
      | ^^^^^^^^^^^    ----------- takes N*m  (kg m^2/s^2, quadcopter)
      | |
      | gives N  (kg m/s^2, quadcopter_controller)
      |
      = help: compute it on the left, for example `ctrl.thrust * 0.2 m => quad.moment`

    error[E04]: `wind.velocity` is an output and cannot be a target
     --> test.scn:9:15
      |
    9 | quad.state -> wind.velocity
      |               ^^^^^^^^^^^^^
      |
      = help: an arrow ends in an input

    error[E09]: `late` looks 70 s ahead, the run ends at 60 s
      --> test.scn:10:8
       |
     3 | stop 60 s
       |      ---- the end
    ...
    10 | assert late: eventually within 70 s quad.roll < 5 deg
       |        ^^^^
       |
       = help: shorten the claim or write `stop 70 s`

    error[E08]: 12.345 s does not fall on the 10 ms grid
      --> test.scn:11:4
       |
     2 | step 10 ms
       |      ----- the grid
    ...
    11 | at 12.345 s lasting 1 s { set quad.drag = 0.3 }
       |    ^^^^^^^^
       |
       = help: 12.34 s, 12.35 s, or `step 5 ms`
    "#);
}

const WORDS: [&str; 44] = [
    "quad.state",
    "ctrl.state",
    "quad.roll",
    "quad.height",
    "wind.velocity",
    "quad.wind",
    "ctrl.now",
    "\"hover\"",
    "time",
    "seed",
    "a",
    "b",
    "3 m",
    "20 degC",
    "2",
    "0",
    "1e300",
    "[1, 2, 3] m/s",
    "->",
    "=>",
    "<",
    "==",
    "±",
    "+",
    "*",
    "/",
    "-",
    "(",
    ")",
    "in deg",
    "as m",
    "and",
    "or",
    "not",
    "always",
    "eventually within 3 s",
    "hold for 20 ms",
    "max(a, b)",
    "norm(b)",
    "rises(a)",
    ".x",
    "[1]",
    ".{x, y}",
    "quad.landed",
];

proptest::proptest! {
    /// For any line, the resolver returns either a scenario or an error.
    #[test]
    fn any_words_give_a_scenario_or_an_error(
        start in proptest::sample::select(&["let a =", "let b =", "assert c:", "", "param a =", "step", "record", "at"][..]),
        second in proptest::sample::select(&["let a =", "let b =", "assert c:", ""][..]),
        words in proptest::collection::vec(proptest::sample::select(&WORDS[..]), 1..9),
        others in proptest::collection::vec(proptest::sample::select(&WORDS[..]), 1..9),
    ) {
        let lines = format!("{start} {}\n{second} {}", words.join(" "), others.join(" "));
        if let Some(outcome) = super::fixtures::try_run(&flight(&lines)) {
            let is_error = |diagnostic: &dsl::diagnostic::Diagnostic| diagnostic.code.starts_with('E');
            let failed = outcome.resolved.diagnostics.iter().any(is_error);
            proptest::prop_assert_eq!(outcome.resolved.scenario.is_none(), failed);
        }
    }
}

#[test]
fn names_that_double_each_other_end_in_an_error() {
    let lines: Vec<_> = (1..40).map(|n| format!("let a{n} = a{} + a{}", n - 1, n - 1)).collect();
    insta::assert_snapshot!(shown(&flight(&format!("let a0 = quad.roll\n{}", lines.join("\n")))), @r#"
    error[E39]: the value of `a11` is too large
      --> test.scn:18:5
       |
    18 | let a11 = a10 + a10
       |     ^^^ it has too many parts
       |
       = help: compute it in fewer steps, or inside a unit
    "#);
}

#[test]
fn a_long_chain_of_names_ends_in_an_error() {
    let deep = "-(".repeat(100) + "a" + &")".repeat(100);
    let lines: Vec<_> = (0..200).map(|n| format!("let a{n} = {}", deep.replace('a', &format!("a{}", n + 1)))).collect();
    let resolved = super::fixtures::run_with(&flight(&format!("{}\nlet a200 = 1", lines.join("\n"))), &[]).resolved;
    assert!(resolved.diagnostics.iter().all(|diagnostic| diagnostic.code == "E39"));
    assert_eq!(resolved.scenario, None);
}
