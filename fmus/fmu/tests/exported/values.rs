//! Get and set calls: what is accepted, what is refused, and that a refusal changes nothing.

use crate::importer::{DISCARD, ERROR, Importer, OK, WARNING};
use crate::probe::{HUGE_M_S, exported as fmi, port};
use std::ffi::{CStr, c_char};
use std::ptr::{null, null_mut};

fn initializing() -> Importer {
    let importer = Importer::new();
    assert_eq!((importer.set_up(0.0, None), importer.enter()), (OK, OK));
    importer
}

#[test]
fn outputs_follow_inputs_and_parameters_in_initialization_mode() {
    let importer = initializing();
    assert_eq!(importer.real(port::SCALED), 2.0);
    assert_eq!((importer.set_real(port::SPEED, 3.0), importer.set_real(port::GAIN, 5.0)), (OK, OK));
    assert_eq!(importer.real(port::SCALED), 15.0);
    assert_eq!((importer.set_integer(port::COUNT[0], -5), importer.integer(port::SUM)), (OK, -1));
}

#[test]
fn outputs_follow_inputs_and_tunable_parameters_between_steps() {
    let importer = Importer::new().started();
    assert_eq!((importer.set_real(port::SPEED, 3.0), importer.set_real(port::OFFSET, 1.0)), (OK, OK));
    assert_eq!((importer.real(port::SCALED), importer.real(port::POSITION_X)), (7.0, 0.0));
    assert_eq!((importer.step(0.0, 0.1), importer.real(port::SCALED)), (OK, 7.0));
    assert_eq!((importer.set_real(port::SPEED, 4.0), importer.real(port::SCALED)), (OK, 9.0));
}

#[test]
fn outputs_that_cannot_be_computed_are_an_error_of_the_call_that_reads_them() {
    let importer = Importer::new().started();
    assert_eq!((importer.step(0.0, 0.1), importer.set_real(port::SPEED, HUGE_M_S)), (OK, OK));
    let mut value = 0.0;
    // SAFETY: a live component, one value.
    let status = unsafe { fmi::fmi2GetReal(importer.component, &raw const port::SCALED, 1, &raw mut value) };
    assert_eq!(status, ERROR);
    assert_eq!(importer.only_message(), "fmi2GetReal: there are no outputs at 0.1 s: too fast for an output");
}

#[test]
fn an_output_that_is_not_finite_ends_the_step_with_its_name() {
    let importer = Importer::new().started();
    assert_eq!((importer.set_real(port::SPEED, f64::MAX), importer.step(0.0, 0.1)), (OK, ERROR));
    assert_eq!(importer.only_message(), "fmi2DoStep: the step of 0.1 s from 0 s failed: `scaled` became inf");
}

#[test]
fn start_values_are_readable_before_the_run_with_a_warning() {
    let importer = Importer::new();
    let mut value = 0.0;
    // SAFETY: a live component, one value.
    let status = unsafe { fmi::fmi2GetReal(importer.component, &raw const port::GAIN, 1, &raw mut value) };
    assert_eq!((status, value), (WARNING, 2.0));
    assert!(importer.only_message().contains("`instantiated`"));
}

#[test]
fn a_value_that_is_not_finite_is_refused_by_name_and_the_old_value_stays() {
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let importer = initializing();
        assert_eq!((importer.set_real(port::SPEED, value), importer.real(port::SPEED)), (DISCARD, 1.0));
        assert_eq!((importer.set_real(port::SPEED, 2.0), importer.exit()), (OK, OK), "the instance goes on");
        assert_eq!(
            importer.only_message(),
            format!("fmi2SetReal: `speed` cannot be {value}: only finite numbers are accepted; nothing was set")
        );
    }
}

#[test]
fn a_value_outside_its_bounds_is_refused_by_name() {
    let importer = initializing();
    assert_eq!((importer.set_real(port::GAIN, 0.0), importer.set_real(port::GAIN, 10.0)), (OK, OK));
    assert_eq!((importer.set_real(port::GAIN, 10.5), importer.real(port::GAIN)), (DISCARD, 10.0));
    assert_eq!(
        importer.only_message(),
        "fmi2SetReal: `gain` cannot be 10.5: it must be between 0 and 10; nothing was set"
    );
    let importer = initializing();
    assert_eq!((importer.set_integer(port::COUNT[1], 6), importer.integer(port::COUNT[1])), (DISCARD, 4));
    assert!(importer.only_message().contains("`count[2]` cannot be 6: it must be between -5 and 5"));
    let importer = initializing();
    assert_eq!((importer.set_integer(port::DEED, 7), importer.integer(port::DEED)), (DISCARD, 1));
    assert!(importer.only_message().contains("`deed` is an enumeration without an item of value 7"));
}

#[test]
fn a_call_with_one_invalid_value_sets_none() {
    let importer = initializing();
    let (ports, values) = ([port::SPEED, port::GAIN], [5.0, f64::NAN]);
    // SAFETY: a live component, two values.
    assert_eq!(unsafe { fmi::fmi2SetReal(importer.component, ports.as_ptr(), 2, values.as_ptr()) }, DISCARD);
    assert_eq!(importer.real(port::SPEED), 1.0);
    let (ports, values) = ([port::SPEED, 99], [5.0, 6.0]);
    assert_eq!(importer.reset(), OK);
    importer.messages();
    // SAFETY: a live component, two values.
    assert_eq!(unsafe { fmi::fmi2SetReal(importer.component, ports.as_ptr(), 2, values.as_ptr()) }, ERROR);
    assert!(importer.only_message().contains("no Real with value reference 99; the unit has 8, counted from 0"));
    assert_eq!(importer.real(port::SPEED), 1.0);
}

#[test]
fn only_inputs_and_tunable_parameters_are_set_between_steps() {
    for (name, port) in [("gain", port::GAIN), ("position.x", port::POSITION_X), ("scaled", port::SCALED)] {
        let importer = Importer::new().started();
        assert_eq!((importer.set_real(port::OFFSET, 1.0), importer.set_real(port, 1.0)), (OK, ERROR));
        assert_eq!(
            importer.only_message(),
            format!("fmi2SetReal: `{name}` cannot be set in state `stepComplete`; nothing was set")
        );
    }
}

#[test]
fn the_start_of_a_state_is_set_before_the_run_and_a_computed_port_never() {
    let importer = initializing();
    assert_eq!((importer.set_real(port::POSITION_X, 9.0), importer.exit()), (OK, OK));
    assert_eq!((importer.step(0.0, 0.1), importer.real(port::POSITION_X)), (OK, 9.1));
    let importer = initializing();
    assert_eq!(importer.set_real(port::SCALED, 9.0), ERROR);
}

#[test]
fn pointers_may_be_null_only_if_the_count_is_zero() {
    let importer = initializing();
    // SAFETY: a live component; null pointers are checked.
    unsafe {
        assert_eq!(fmi::fmi2GetReal(importer.component, null(), 0, null_mut()), OK);
        assert_eq!(fmi::fmi2SetString(importer.component, null(), 0, null()), OK);
        assert_eq!(fmi::fmi2SetReal(importer.component, &raw const port::SPEED, 1, null()), ERROR);
    }
    assert_eq!(importer.only_message(), "fmi2SetReal: `value` is a null pointer");
}

#[test]
fn any_boolean_except_zero_is_true() {
    let importer = initializing();
    for (given, expected) in [(0, 1), (1, 0), (-7, 0)] {
        let mut inverse = 5;
        // SAFETY: a live component, one value each.
        unsafe {
            assert_eq!(fmi::fmi2SetBoolean(importer.component, &raw const port::SWITCH, 1, &raw const given), OK);
            assert_eq!(fmi::fmi2GetBoolean(importer.component, &raw const port::INVERSE, 1, &raw mut inverse), OK);
        }
        assert_eq!(inverse, expected);
    }
}

#[test]
fn texts_are_copied_and_stay_readable_while_others_are_read() {
    let importer = initializing();
    let set = |text: *const c_char| {
        // SAFETY: a live component, one value.
        unsafe { fmi::fmi2SetString(importer.component, &raw const port::TEXT, 1, &raw const text) }
    };
    let get = |port: u32| {
        let mut text = null();
        // SAFETY: a live component, one value.
        assert_eq!(unsafe { fmi::fmi2GetString(importer.component, &raw const port, 1, &raw mut text) }, OK);
        text
    };
    assert_eq!(set(c"100 % grün #1".as_ptr()), OK);
    let (text, echo) = (get(port::TEXT), get(port::ECHO));
    // SAFETY: both are valid until the next get of the same String.
    let texts = unsafe { [CStr::from_ptr(text), CStr::from_ptr(echo)] };
    assert_eq!(texts, [c"100 % grün #1"; 2]);
    assert_eq!(set(c"\xff\xfe".as_ptr()), ERROR);
    assert!(importer.only_message().contains("the text for `text` is not UTF-8"));
}
