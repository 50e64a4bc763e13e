//! A panic of a unit does not reach the importer.

use crate::importer::{ERROR, Importer, OK, callbacks};
use crate::probe::{UNLUCKY_M_S, port};
use fmu::{Context, Fault, Fmu, Library, Model, Outcome, Package, Step};
use serde::{Deserialize, Serialize};
use std::cell::Cell;
use std::ffi::CString;
use std::sync::Mutex;

fn panicked() -> Importer {
    let importer = Importer::new().started();
    assert_eq!((importer.set_integer(port::DEED, 6), importer.set_real(port::SPEED, UNLUCKY_M_S)), (OK, OK));
    assert_eq!(importer.step(0.0, 0.1), ERROR);
    assert_eq!(importer.only_message(), "fmi2DoStep: the unit panicked (a bug in the unit): told to panic");
    importer
}

#[test]
fn after_a_panic_values_can_be_read_but_not_set_or_stepped() {
    let importer = panicked();
    assert_eq!(importer.real(port::SPEED), UNLUCKY_M_S);
    assert_eq!((importer.set_real(port::SPEED, 2.0), importer.step(0.1, 0.1)), (ERROR, ERROR));
    let texts: Vec<_> = importer.messages().into_iter().map(|message| message.text).collect();
    assert_eq!(
        texts,
        ["fmi2SetReal", "fmi2DoStep"]
            .map(|call| format!("{call}: the unit panicked before; it can be read, reset and freed"))
    );
}

#[test]
fn a_reset_restores_a_panicked_instance() {
    let importer = panicked();
    assert_eq!(importer.reset(), OK);
    let importer = importer.started();
    assert_eq!((importer.step(0.0, 0.1), importer.integer(port::DEED)), (OK, 1));
}

#[test]
fn a_panic_in_one_instance_does_not_affect_others() {
    let other = Importer::new().started();
    let _panicked = panicked();
    assert_eq!(other.step(0.0, 0.1), OK);
}

thread_local! {
    static IS_DEFECT: Cell<bool> = const { Cell::new(false) };
}

/// Hidden state whose creation panics on demand.
#[derive(Clone, Serialize, Deserialize)]
struct Fuse;

impl Default for Fuse {
    fn default() -> Self {
        assert!(!IS_DEFECT.get(), "the fuse has blown");
        Self
    }
}

/// Which needs a fuse.
#[derive(Fmu, Clone, Serialize, Deserialize)]
struct Lamp {
    /// Whether it shines
    #[output(exact = 0.0, unit = "1")]
    light: f64,
    fuse: Fuse,
}

impl Model for Lamp {
    fn init(&mut self, _: &mut Context) -> Result<(), Fault> {
        Ok(())
    }

    fn step(&mut self, _: Step, _: &mut Context) -> Result<Outcome, Fault> {
        Ok(Outcome::Done)
    }
}

static LAMP: Library =
    Library::of::<Lamp>(Package { identifier: "lamp", version: "1.0.0", authors: "", license: "MIT" });

#[test]
fn a_unit_that_panics_on_creation_logs_why_there_is_no_instance() {
    let xml = LAMP.xml();
    let guid = xml.split("guid=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("a GUID");
    let guid = CString::new(guid).expect("no zero");
    IS_DEFECT.set(true);
    let messages = Mutex::default();
    let callbacks = callbacks(&messages);
    // SAFETY: the strings and callbacks live until the call returns, and no instance is created.
    let component = unsafe { fmu::abi::instantiate(&LAMP, c"one".as_ptr(), 1, guid.as_ptr(), &raw const callbacks, 0) };
    assert!(component.is_null());
    let texts: Vec<_> = messages.into_inner().expect("no panic").into_iter().map(|message| message.text).collect();
    assert_eq!(texts, ["fmi2Instantiate: the fuse has blown"]);
}
