//! What values, conversions, connections and windows mean.

use super::fixtures::{flight, scenario, scenario_with};
use dsl::scenario::{BooleanExpression, Drive, Port, RealExpression, Trigger, Value};

/// The driver of one connection, written on a line of its own.
fn drive(line: &str) -> Drive {
    scenario(&flight(line)).connections.remove(0).source
}

/// The start values of an instance `two`.
fn presets(unit: &str, braces: &str) -> Vec<(usize, Value)> {
    let scenario = scenario(&flight(&format!("fmu two = \"{unit}\" {{ {braces} }}")));
    scenario.instances[3].presets.iter().map(|preset| (preset.variable, preset.value.clone())).collect()
}

#[test]
fn ports_of_one_unit_are_copied_and_others_converted() {
    assert_eq!(drive("wind.velocity.y -> quad.wind.x"), Drive::Copy(Port { instance: 0, variable: 6 }));
    let signal = Box::new(RealExpression::Signal(Port { instance: 1, variable: 17 }));
    assert_eq!(
        drive("quad.height -> ctrl.setpoint.x"),
        Drive::Real(RealExpression::Affine { of: signal, factor: 0.3048, offset: 0.0 })
    );
}

#[test]
fn what_declares_no_unit_passes_as_it_is() {
    assert_eq!(drive("quad.height -> ctrl.raw"), Drive::Copy(Port { instance: 1, variable: 17 }));
    assert_eq!(drive("ctrl.bare -> ctrl.setpoint.x"), Drive::Copy(Port { instance: 2, variable: 21 }));
    let widened = RealExpression::Signal(Port { instance: 2, variable: 23 });
    assert_eq!(drive("ctrl.events -> ctrl.setpoint.x"), Drive::Real(widened));
}

#[test]
fn angles_count_as_numbers_in_computations() {
    assert!(matches!(drive("ctrl.error / 1 m -> ctrl.raw"), Drive::Real(RealExpression::Divide(..))));
    assert!(matches!(drive("quad.roll * 3 N*m -> quad.moment"), Drive::Real(RealExpression::Multiply(..))));
}

#[test]
fn time_alone_drives_an_input() {
    let Drive::Real(RealExpression::Multiply(factor, sine)) = drive("2 m/s * sin(2 rad/s * time) -> quad.wind.x")
    else {
        panic!("a product")
    };
    assert_eq!(*factor, RealExpression::Constant(2.0));
    assert!(matches!(*sine, RealExpression::Call(dsl::scenario::Function::Sin, _)));
}

#[test]
fn vectors_add_by_element_and_scale_by_a_number() {
    let scenario = scenario(&flight("wind.velocity + 2 * [1, 2, 3] m/s -> quad.wind"));
    let signal = |variable| Box::new(RealExpression::Signal(Port { instance: 0, variable }));
    let sum =
        |variable, value| Drive::Real(RealExpression::Add(signal(variable), Box::new(RealExpression::Constant(value))));
    let drives: Vec<_> = scenario.connections.into_iter().map(|connection| connection.source).collect();
    assert_eq!(drives, [sum(5, 2.0), sum(6, 4.0), sum(7, 6.0)]);
}

#[test]
fn picked_members_match_by_order() {
    let scenario = scenario(&flight("quad.state.position.{z, x} -> ctrl.setpoint.{x, y}"));
    let copies: Vec<_> = scenario.connections.into_iter().map(|connection| connection.source).collect();
    assert_eq!(
        copies,
        [Drive::Copy(Port { instance: 1, variable: 14 }), Drive::Copy(Port { instance: 1, variable: 12 })]
    );
}

#[test]
fn a_comparison_drives_a_boolean_input_and_a_text_an_enumeration() {
    assert!(matches!(
        drive("quad.height > 3 ft -> ctrl.armed"),
        Drive::Boolean(BooleanExpression::Margin(margin)) if margin.strict
    ));
    assert_eq!(drive("\"land\" -> ctrl.mode"), Drive::Integer(5));
    assert_eq!(drive("ctrl.now -> ctrl.mode"), Drive::Copy(Port { instance: 2, variable: 24 }));
    assert_eq!(drive("\"dusk\" -> ctrl.note"), Drive::String("dusk".to_owned()));
    assert_eq!(drive("3 -> ctrl.count"), Drive::Integer(3));
}

#[test]
fn start_values_come_in_the_variables_own_unit_to_the_bit() {
    assert_eq!(
        presets("quadcopter", "mass = 900 g, position0 = [0, 0, 1.5] m, drag = 1/3"),
        [
            (6, Value::Real(900.0 / 1000.0)),
            (7, Value::Real(0.0)),
            (8, Value::Real(0.0)),
            (9, Value::Real(1.5)),
            (10, Value::Real(1.0 / 3.0))
        ]
    );
}

#[test]
fn start_values_of_all_types_are_taken() {
    let braces = "levels = 7, method = \"hover\", map = file(\"yard.csv\"), armed = true, note = \"x\", unset = 0 m, seed = seed + 1";
    assert_eq!(
        presets("quadcopter_controller", braces),
        [
            (13, Value::Integer(7)),
            (14, Value::Integer(2)),
            (15, Value::File(dsl::source::FileRef { from: 0, path: "yard.csv".to_owned() })),
            (6, Value::Boolean(true)),
            (8, Value::String("x".to_owned())),
            (10, Value::Real(0.0)),
            (16, Value::Integer(2))
        ]
    );
}

#[test]
fn parameters_can_be_typed_again() {
    let lines =
        "param gust = 4 m/s\nparam to = [1, 2] ft\nparam twice = 2 * gust\nparam name = \"a\"\nparam on_air = true";
    let parameters = scenario_with(&flight(lines), &["gust = 30 kn", "to = [1 m, 20 cm]"]).parameters;
    let shown_parts: Vec<_> = parameters.iter().map(|p| (p.name.as_str(), p.value.as_str(), p.set)).collect();
    assert_eq!(
        shown_parts,
        [
            ("gust", "30 kn", true),
            ("to", "[1 m, 20 cm]", true),
            ("twice", "30.866666666666667 m/s", false),
            ("name", "\"a\"", false),
            ("on_air", "true", false),
            ("seed", "1", false)
        ]
    );
}

#[test]
fn a_seed_from_the_command_line_reaches_the_units() {
    let script = flight("fmu gust = \"wind\" { seed = seed }");
    let scenario = scenario_with(&script, &["seed = 7"]);
    assert_eq!(scenario.instances[3].presets[0].value, Value::Integer(7));
    assert_eq!((scenario.parameters[0].value.as_str(), scenario.parameters[0].set), ("7", true));
}

#[test]
fn windows_open_and_close_on_ticks() {
    let lines =
        "at 2 s lasting 500 ms { set quad.wind.x = 3 m/s, set quad.drag = 20 % }\nat 3 s { set quad.wind.x = 1 m/s }";
    let events = scenario(&flight(lines)).events;
    let times: Vec<_> = events.iter().map(|event| (event.trigger, event.lasting)).collect();
    assert_eq!(times, [(Trigger::At(200), Some(50)), (Trigger::At(300), None)]);
    let sets: Vec<_> = events[0].sets().collect();
    assert_eq!(sets[0].value, Drive::Real(RealExpression::Constant(3.0)));
    assert_eq!(sets[1].target, Port { instance: 1, variable: 10 });
}

#[test]
fn a_window_over_a_set_that_stays_is_fine() {
    let lines =
        "at 1 s { set quad.drag = 0.2 }\nat 2 s lasting 1 s { set quad.drag = 0.3 }\nat 3 s { set quad.drag = 0.4 }";
    assert_eq!(scenario(&flight(lines)).events.len(), 3);
}

#[test]
fn waves_follow_the_direct_arrows_and_periods_count_ticks() {
    let lines = "fmu slow = \"quadcopter\" every 50 ms
ctrl.rotor_speed => slow.rotor_speed
slow.height => ctrl.setpoint.x
wind.velocity => quad.wind";
    let scenario = super::fixtures::run_with(&flight(lines), &[]).resolved;
    assert_eq!(scenario.diagnostics[0].code, "E06");
    let lines = lines.replace("slow.height =>", "slow.height ->");
    let instances = super::fixtures::scenario(&flight(&lines)).instances;
    let shown_parts: Vec<_> = instances.iter().map(|i| (i.name.as_str(), i.every, i.wave)).collect();
    assert_eq!(shown_parts, [("wind", 1, 0), ("quad", 1, 1), ("ctrl", 1, 0), ("slow", 5, 1)]);
}

#[test]
fn lets_name_signals_and_elements_of_lists() {
    let lines = "let p = quad.state.position\nlet goals = [[1, 2, 3], [4, 5, 6]] m\nlet n = 2";
    assert_eq!(drive(&format!("{lines}\np.y -> ctrl.setpoint.x")), Drive::Copy(Port { instance: 1, variable: 13 }));
    let goal = Drive::Real(RealExpression::Constant(6.0));
    assert_eq!(drive(&format!("{lines}\ngoals[n][3] -> ctrl.setpoint.x")), goal);
}
