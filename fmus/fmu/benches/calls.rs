//! Measures one get, one set and one doStep of a unit, through the function pointers that an importer calls.
#![allow(unsafe_code, reason = "an importer calls C functions")]

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use fmi2::c::{CallbackFunctions, CallbackLogger};
use fmu::{Context, Fault, Fmu, Model, Outcome, Step};
use serde::{Deserialize, Serialize};
use std::ffi::{CString, c_char, c_void};

/// Copies 30 numbers to its outputs.
#[derive(Fmu, Clone, Serialize, Deserialize)]
struct Relay {
    /// Numbers
    #[input(unit = "1")]
    given: [f64; 30],
    /// The same numbers
    #[output(unit = "1", depends(given))]
    taken: [f64; 30],
}

impl Model for Relay {
    fn init(&mut self, _: &mut Context) -> Result<(), Fault> {
        self.taken = self.given;
        Ok(())
    }

    fn step(&mut self, _: Step, _: &mut Context) -> Result<Outcome, Fault> {
        self.taken[0] = self.given[0];
        Ok(Outcome::Done)
    }
}

fmu::export!(Relay);

unsafe extern "C" fn silent(_: *mut c_void, _: *const c_char, _: i32, _: *const c_char, _: *const c_char) {}

/// An instance ready for its first step; it is not freed before the end of the benchmark.
fn instance() -> *mut c_void {
    // SAFETY: the unit passes no arguments after the format, so that both function types have the same calling
    // convention.
    let logger = unsafe {
        std::mem::transmute::<
            unsafe extern "C" fn(*mut c_void, *const c_char, i32, *const c_char, *const c_char),
            CallbackLogger,
        >(silent)
    };
    let callbacks = CallbackFunctions {
        logger: Some(logger),
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        component_environment: std::ptr::null_mut(),
    };
    let xml = LIBRARY.xml();
    let guid = xml.split("guid=\"").nth(1).and_then(|rest| rest.split('"').next());
    let guid = CString::new(guid.unwrap_or_default()).unwrap_or_default();
    // SAFETY: strings and callbacks live until the call returns; the component is alive.
    unsafe {
        let (name, resources) = (c"one".as_ptr(), std::ptr::null());
        let component = exported::fmi2Instantiate(name, 1, guid.as_ptr(), resources, &raw const callbacks, 0, 0);
        exported::fmi2SetupExperiment(component, 0, 0.0, 0.0, 0, 0.0);
        exported::fmi2EnterInitializationMode(component);
        assert_eq!(exported::fmi2ExitInitializationMode(component), 0);
        component
    }
}

/// Steps in one measurement.
const STEPS: u32 = 1000;

/// Measures a set and a get of `ports` ports around each step.
#[divan::bench(args = [1, 30])]
fn set_step_get(bencher: Bencher, ports: usize) {
    let component = instance();
    let references: Vec<u32> = (0..60).collect();
    let (given, mut taken) = ([1.0; 30], [0.0; 30]);
    let (set, get) = (references.as_ptr(), references[30..].as_ptr());
    let (set_real, do_step, get_real) = black_box((
        exported::fmi2SetReal as unsafe extern "C" fn(_, _, _, _) -> _,
        exported::fmi2DoStep as unsafe extern "C" fn(_, _, _, _) -> _,
        exported::fmi2GetReal as unsafe extern "C" fn(_, _, _, _) -> _,
    ));
    let mut n = 0_u32;
    bencher.counter(ItemsCount::new(STEPS)).bench_local(|| {
        for _ in 0..STEPS {
            // SAFETY: a live component, at least as many values as ports.
            let statuses = unsafe {
                [
                    set_real(component, set, ports, given.as_ptr()),
                    do_step(component, f64::from(n) * 0.001, 0.001, 1),
                    get_real(component, get, ports, taken.as_mut_ptr()),
                ]
            };
            assert_eq!(statuses, [0; 3]);
            n += 1;
        }
    });
}

fn main() {
    divan::main();
}
