//! Times of steps as importers compute them.

use crate::importer::{DISCARD, ERROR, Importer, OK, WARNING};
use crate::probe::{exported as fmi, port};

#[test]
fn a_step_does_not_depend_on_how_its_ends_were_computed() {
    let importer = Importer::new().started();
    for n in 0..20_000 {
        let n = f64::from(n);
        assert_eq!(importer.step(n * 0.005, (n + 1.0) * 0.005 - n * 0.005), OK, "step {n}");
        assert_eq!(importer.real(port::STEP_LENGTH).to_bits(), 0.005_f64.to_bits(), "step {n}");
    }
}

#[test]
fn an_importer_may_sum_its_steps_or_make_sixty_a_second() {
    let importer = Importer::new().started();
    let (h, mut sum_s) = (1.0 / 60.0, 0.0);
    for _ in 0..100_000 {
        assert_eq!(importer.step(sum_s, h), OK, "{:?}", importer.messages());
        sum_s += h;
    }
}

#[test]
fn a_step_begins_where_the_last_one_ended() {
    for point_s in [0.0, 0.0999, 0.2, f64::NAN, f64::INFINITY] {
        let importer = Importer::new().started();
        assert_eq!((importer.step(0.0, 0.1), importer.step(point_s, 0.1)), (OK, ERROR));
        assert!(
            importer
                .only_message()
                .ends_with(&format!("the step begins at {point_s} s, but the time of the unit is 0.1 s"))
        );
    }
}

#[test]
fn a_step_has_a_positive_length() {
    for length_s in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let importer = Importer::new().started();
        assert_eq!(importer.step(0.0, length_s), ERROR);
        assert!(importer.only_message().contains("the length of a step must be positive"));
    }
}

#[test]
fn no_step_ends_after_the_stop_time_except_for_rounding() {
    let importer = Importer::new();
    assert_eq!((importer.set_up(0.0, Some(0.3)), importer.enter(), importer.exit()), (OK, OK, OK));
    assert_eq!((importer.step(0.0, 0.1), importer.step(0.1, 0.1), importer.step(0.2, 0.1)), (OK, OK, OK));
    assert_eq!(importer.step(0.3, 0.1), ERROR);
    assert_eq!(importer.only_message(), "fmi2DoStep: the step ends at 0.4 s, after the stop time 0.3 s");
}

#[test]
fn a_run_may_start_later_than_zero() {
    let importer = Importer::new();
    assert_eq!((importer.set_up(20.0, None), importer.enter(), importer.exit()), (OK, OK, OK));
    assert_eq!(importer.step(20.0, 0.1), OK);
}

#[test]
fn a_run_that_was_not_set_up_starts_at_zero_with_a_warning() {
    let importer = Importer::new();
    assert_eq!((importer.enter(), importer.exit(), importer.step(0.0, 0.1)), (WARNING, OK, OK));
    assert!(importer.only_message().contains("starts at 0 s"));
}

#[test]
fn an_experiment_is_set_up_once_and_with_valid_times() {
    let importer = Importer::new();
    assert_eq!((importer.set_up(0.0, None), importer.set_up(0.0, None)), (OK, ERROR));
    for (start_s, stop_s) in [(f64::NAN, None), (0.0, Some(-1.0)), (0.0, Some(f64::NAN))] {
        assert_eq!(Importer::new().set_up(start_s, stop_s), ERROR);
    }
}

/// Last successful time, and whether the unit has terminated.
fn after(importer: &Importer) -> (f64, i32) {
    let (mut time_s, mut ended) = (f64::NAN, -1);
    // SAFETY: a live component, a valid pointer for each value.
    unsafe {
        assert_eq!(fmi::fmi2GetRealStatus(importer.component, 2, &raw mut time_s), OK);
        assert_eq!(fmi::fmi2GetBooleanStatus(importer.component, 3, &raw mut ended), OK);
    }
    (time_s, ended)
}

#[test]
fn a_discarded_step_reports_its_last_successful_time() {
    let importer = Importer::new().started();
    assert_eq!(importer.set_integer(port::DEED, 3), OK);
    assert_eq!((importer.step(0.0, 0.1), after(&importer)), (DISCARD, (0.05, 0)));
    assert_eq!(importer.only_message(), "fmi2DoStep: the step from 0 s to 0.1 s was made until 0.05 s only");
}

#[test]
fn a_unit_that_terminates_reports_the_time() {
    let importer = Importer::new().started();
    assert_eq!(importer.set_integer(port::DEED, 4), OK);
    assert_eq!((importer.step(0.0, 0.1), after(&importer), importer.terminate()), (DISCARD, (0.1, 1), OK));
}

#[test]
fn a_fault_is_an_error_with_its_reason() {
    let importer = Importer::new().started();
    assert_eq!(importer.set_integer(port::DEED, 5), OK);
    assert_eq!(importer.step(0.0, 0.1), ERROR);
    assert_eq!(importer.only_message(), "fmi2DoStep: the step of 0.1 s from 0 s failed: told to");
}
