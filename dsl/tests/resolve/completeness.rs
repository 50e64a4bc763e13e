//! Forgotten connections and names that are not used.

use super::fixtures::{all_shown, run_with};

/// A script with lines after its head.
fn script(lines: &str) -> String {
    format!("scenario \"Test\"\nstep 10 ms\nstop 60 s\n{lines}\n")
}

#[test]
fn inputs_that_nothing_drives_are_a_warning_for_each_group_with_a_line_to_paste() {
    insta::assert_snapshot!(all_shown(&script(
        "fmu quad = \"quadcopter\"\nfmu ctrl = \"quadcopter_controller\" { note = \"a\", unset = 0 m }\n\
         quad.state.position -> ctrl.state.position\n1 m -> ctrl.setpoint.x\nrecord quad.roll"
    )));
}

#[test]
fn the_line_to_paste_answers_the_warning() {
    let braces = "mode = \"idle\", armed = false, count = 0, setpoint = [0, 0] m, state.position = [0, 0, 0] m, \
                  note = \"none\", raw = 0, unset = 0 m";
    let answered = script(&format!("fmu ctrl = \"quadcopter_controller\" {{ {braces} }}\nrecord ctrl.thrust"));
    assert_eq!(all_shown(&answered), "");
    let bare = all_shown(&script("fmu ctrl = \"quadcopter_controller\"\nrecord ctrl.thrust"));
    assert_eq!(bare.matches("warning[W02]").count(), 8, "{bare}");
    for entry in braces.split(", ").filter(|entry| entry.contains('=') && !entry.contains('[')) {
        assert!(bare.contains(&format!("`{{ {entry} }}`")), "{entry}: {bare}");
    }
}

#[test]
fn inputs_of_one_name_are_listed_once() {
    let shown = all_shown(&script("fmu a = \"repeated\"\nrecord a.y"));
    assert!(shown.contains("nothing drives the 3 inputs `a.u`"), "{shown}");
    assert!(shown.contains("`{ u = 1, u.x = 3 }`"), "{shown}");
}

#[test]
fn a_value_during_the_run_is_a_value_too() {
    let lines = "fmu quad = \"quadcopter\" { rotor_speed = [0, 0] rad/s, moment = 0 N*m }\nrecord quad.roll";
    assert!(all_shown(&script(lines)).contains("nothing drives the 3 inputs `quad.wind`"));
    assert_eq!(all_shown(&script(&format!("{lines}\nat 3 s {{ set quad.wind = [1, 2, 3] m/s }}"))), "");
}

#[test]
fn instances_parameters_and_lets_without_use_are_warnings() {
    insta::assert_snapshot!(all_shown(&script(
        "param gust = 3 m/s\nparam mean = 2 m/s\nparam seed = 2\nlet a = [mean, mean, mean]\nlet b = a\n\
         fmu air = \"wind\" { mean = a }\nfmu quad = \"quadcopter\" { mass = 2 kg }\nrecord air.velocity"
    )));
}

#[test]
fn a_setting_of_the_command_line_is_no_use_of_a_parameter() {
    let outcome = run_with(&script("param gust = 3 m/s\nfmu air = \"wind\"\nrecord air.velocity"), &["gust = 4 m/s"]);
    let codes: Vec<_> = outcome.resolved.diagnostics.iter().map(|finding| finding.code).collect();
    assert_eq!(codes, ["W06"]);
}

#[test]
fn a_script_with_errors_has_no_warning_of_what_it_lacks() {
    let shown = all_shown(&script("let a = 3\nfmu quad = \"quadcopter\"\nrecord quad.rol"));
    assert_eq!((shown.matches("error[").count(), shown.matches("warning[").count()), (1, 0), "{shown}");
}
