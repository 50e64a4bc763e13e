//! Creation of instances, their messages, and their independence of each other.

use crate::importer::{DISCARD, ERROR, Importer, OK, Request, WARNING};
use crate::probe::{exported as fmi, guid, port};
use std::ffi::{CStr, CString};
use std::ptr::{null, null_mut};

#[test]
fn an_instance_needs_a_name_the_right_guid_and_co_simulation() {
    let own = CString::new(guid()).expect("no zero");
    let request = |name, kind, guid| {
        let (importer, messages) = Importer::request(&Request { name, kind, guid, logging_on: 0 });
        assert!(importer.is_none());
        assert_eq!((messages.len(), messages[0].category.as_str()), (1, "logStatusError"));
        messages[0].text.clone()
    };
    let own = Some(own.as_c_str());
    assert_eq!(request(None, 1, own), "fmi2Instantiate: the instance has no name");
    assert_eq!(request(Some(c"  "), 1, own), "fmi2Instantiate: the instance has no name");
    assert_eq!(request(Some(c"one"), 0, own), "fmi2Instantiate: the unit is for co-simulation only");
    assert_eq!(request(Some(c"one"), 1, None), "fmi2Instantiate: no GUID is given");
    assert!(request(Some(c"one"), 1, Some(c"other")).contains("GUID other does not belong to this library"));
}

#[test]
fn without_callbacks_there_is_no_instance_and_no_crash() {
    // SAFETY: null pointers are checked.
    let component = unsafe { fmi::fmi2Instantiate(c"one".as_ptr(), 1, null(), null(), null(), 0, 0) };
    assert_eq!(component, null_mut());
    // SAFETY: null is checked.
    unsafe {
        fmi::fmi2FreeInstance(component);
        assert_eq!(fmi::fmi2DoStep(component, 0.0, 0.1, 1), ERROR);
    }
}

#[test]
fn the_platform_and_version_need_no_instance() {
    // SAFETY: static texts.
    let texts = unsafe { [CStr::from_ptr(fmi::fmi2GetTypesPlatform()), CStr::from_ptr(fmi::fmi2GetVersion())] };
    assert_eq!(texts, [c"default", c"2.0"]);
}

/// Status, category and text of the messages of a step with a warning.
fn warned(importer: &Importer) -> Vec<(i32, String, String)> {
    assert_eq!(importer.set_integer(port::DEED, 2), OK);
    assert_eq!(importer.step(0.0, 0.1), WARNING);
    let messages = importer.messages().into_iter();
    messages.map(|message| (message.status, message.category, message.text)).collect()
}

#[test]
fn percent_and_hash_are_escaped_for_the_printf_format() {
    let warning = (WARNING, "logStatusWarning".to_owned(), "100%% of ##1".to_owned());
    assert_eq!(warned(&Importer::new().started()), [warning]);
}

#[test]
fn events_are_logged_if_enabled() {
    let categories: Vec<_> = warned(&Importer::with_logging(1).started()).into_iter().map(|(_, c, _)| c).collect();
    assert_eq!(categories, ["logEvents", "logStatusWarning"]);
}

#[test]
fn categories_are_turned_on_and_off_by_name_but_failures_are_always_logged() {
    let importer = Importer::new().started();
    let want = |on, names: &[*const std::ffi::c_char]| {
        // SAFETY: a live component, as many names as the count.
        unsafe { fmi::fmi2SetDebugLogging(importer.component, on, names.len(), names.as_ptr()) }
    };
    assert_eq!((want(1, &[c"logEvents".as_ptr()]), want(0, &[c"logStatusWarning".as_ptr()])), (OK, OK));
    assert_eq!(warned(&importer).len(), 1, "the event only");
    assert_eq!(want(0, &[]), OK);
    assert_eq!(importer.set_real(port::SPEED, f64::NAN), DISCARD);
    assert!(importer.only_message().contains("`speed`"));
}

#[test]
fn a_category_that_does_not_exist_is_a_warning() {
    let importer = Importer::new();
    let name = c"logDreams".as_ptr();
    // SAFETY: a live component, one name.
    assert_eq!(unsafe { fmi::fmi2SetDebugLogging(importer.component, 1, 1, &raw const name) }, WARNING);
    assert_eq!(importer.only_message(), "there is no log category `logDreams`");
}

#[test]
fn instances_in_threads_are_independent() {
    let run = |speed: f64| {
        let importer = Importer::new().started();
        assert_eq!(importer.set_real(port::SPEED, speed), OK);
        for n in 0..1000 {
            assert_eq!(importer.step(f64::from(n) * 0.01, 0.01), OK);
        }
        importer.real(port::POSITION_X).to_bits()
    };
    let alone: Vec<_> = [1.0, 2.0, 3.0, 4.0].map(run).to_vec();
    let together = std::thread::scope(|scope| {
        let threads = [1.0, 2.0, 3.0, 4.0].map(|speed| scope.spawn(move || run(speed)));
        threads.map(|thread| thread.join().expect("no panic")).to_vec()
    });
    assert_eq!(together, alone);
}
