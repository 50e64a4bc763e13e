//! Every call in every state: status and log category, compared with `walk.txt`.
//!
//! The file contains section 4.2.4 of the standard for the states that an instance can reach (steps are synchronous),
//! and the decisions of this project beyond it: values may be read and inputs set before initialization, an experiment
//! that was not set up is a warning, and after a panic an instance can only be read, reset and freed.

use crate::importer::{ERROR, Importer, OK};
use crate::probe::{UNLUCKY_M_S, exported as fmi, port};
use fmi2::calls::Call;
use std::ffi::c_void;
use std::fmt::Write;
use std::ptr::{null, null_mut};

/// Brings an instance to a state.
type Bring = fn() -> Importer;

/// The states that an instance can be brought to, and how.
const STATES: [(&str, Bring); 7] = [
    ("instantiated", Importer::new),
    ("initializationMode", || {
        let importer = Importer::new();
        assert_eq!((importer.set_up(0.0, None), importer.enter()), (OK, OK));
        importer
    }),
    ("stepComplete", || Importer::new().started()),
    ("stepFailed", || after_a_step(3)),
    ("terminated", || {
        let importer = Importer::new().started();
        assert_eq!(importer.terminate(), OK);
        importer
    }),
    ("error", || after_a_step(5)),
    ("panicked", || after_a_step(6)),
];

/// An instance whose first step was made with this item of `Deed`.
fn after_a_step(deed: i32) -> Importer {
    let importer = Importer::new().started();
    assert_eq!((importer.set_integer(port::DEED, deed), importer.set_real(port::SPEED, UNLUCKY_M_S)), (OK, OK));
    assert!(importer.step(0.0, 0.1) > OK);
    importer
}

/// The calls that take an instance and return a status.
fn tested_calls() -> impl Iterator<Item = Call> {
    let apart = [Call::GetTypesPlatform, Call::GetVersion, Call::Instantiate, Call::FreeInstance];
    Call::ALL.into_iter().filter(move |call| !apart.contains(call))
}

/// Makes a call that can fail because of the state only; `saved` is a state that the instance saved just before.
fn make(call: Call, importer: &Importer, saved: *mut c_void) -> i32 {
    let (c, vr) = (importer.component, [0_u32; 1]);
    let (mut real, mut integer, mut text, mut handle, mut size) = ([1.0], [1], [c"x".as_ptr()], saved, 0_usize);
    let (vr, mut bytes) = (vr.as_ptr(), [0_u8; 4096]);
    // SAFETY: a live component; pointers to as many values as the count.
    unsafe {
        match call {
            Call::SetDebugLogging => fmi::fmi2SetDebugLogging(c, 0, 0, null()),
            Call::SetupExperiment => importer.set_up(0.0, None),
            Call::EnterInitializationMode => importer.enter(),
            Call::ExitInitializationMode => importer.exit(),
            Call::Terminate => importer.terminate(),
            Call::Reset => importer.reset(),
            Call::GetReal => fmi::fmi2GetReal(c, vr, 1, real.as_mut_ptr()),
            Call::GetInteger => fmi::fmi2GetInteger(c, vr, 1, integer.as_mut_ptr()),
            Call::GetBoolean => fmi::fmi2GetBoolean(c, vr, 1, integer.as_mut_ptr()),
            Call::GetString => fmi::fmi2GetString(c, vr, 1, text.as_mut_ptr()),
            Call::SetReal => fmi::fmi2SetReal(c, vr, 1, real.as_ptr()),
            Call::SetInteger => fmi::fmi2SetInteger(c, vr, 1, integer.as_ptr()),
            Call::SetBoolean => fmi::fmi2SetBoolean(c, vr, 1, integer.as_ptr()),
            Call::SetString => fmi::fmi2SetString(c, vr, 1, text.as_ptr()),
            Call::GetFmuState => fmi::fmi2GetFMUstate(c, &raw mut handle),
            Call::SetFmuState => fmi::fmi2SetFMUstate(c, handle),
            Call::FreeFmuState => fmi::fmi2FreeFMUstate(c, &raw mut handle),
            Call::SerializedFmuStateSize => fmi::fmi2SerializedFMUstateSize(c, handle, &raw mut size),
            Call::SerializeFmuState => fmi::fmi2SerializeFMUstate(c, handle, bytes.as_mut_ptr().cast(), bytes.len()),
            Call::DeSerializeFmuState => {
                let bytes = crate::states::written_by_another();
                importer.read(&bytes, &mut handle)
            }
            Call::GetDirectionalDerivative => {
                fmi::fmi2GetDirectionalDerivative(c, vr, 1, vr, 1, real.as_ptr(), real.as_mut_ptr())
            }
            Call::SetRealInputDerivatives => {
                fmi::fmi2SetRealInputDerivatives(c, vr, 1, integer.as_ptr(), real.as_ptr())
            }
            Call::GetRealOutputDerivatives => {
                fmi::fmi2GetRealOutputDerivatives(c, vr, 1, integer.as_ptr(), real.as_mut_ptr())
            }
            Call::DoStep => importer.step(0.0, 0.1),
            Call::CancelStep => fmi::fmi2CancelStep(c),
            Call::GetStatus => fmi::fmi2GetStatus(c, 0, integer.as_mut_ptr()),
            Call::GetRealStatus => fmi::fmi2GetRealStatus(c, 2, real.as_mut_ptr()),
            Call::GetIntegerStatus => fmi::fmi2GetIntegerStatus(c, 0, integer.as_mut_ptr()),
            Call::GetBooleanStatus => fmi::fmi2GetBooleanStatus(c, 3, integer.as_mut_ptr()),
            Call::GetStringStatus => fmi::fmi2GetStringStatus(c, 1, text.as_mut_ptr()),
            Call::GetTypesPlatform | Call::GetVersion | Call::Instantiate | Call::FreeInstance => ERROR,
        }
    }
}

/// The table of results as text: a line for each call, a column for each state.
fn walk(make: fn(Call, &Importer, *mut c_void) -> i32) -> String {
    let mut table = format!("{:30}", "");
    for (state, _) in STATES {
        let _ = write!(table, "{state:26}");
    }
    for call in tested_calls() {
        let _ = write!(table, "\n{:30}", call.name());
        for (_, bring) in STATES {
            let importer = bring();
            let mut handle = null_mut();
            // After a panic nothing can be saved, and the handle stays null.
            importer.save(&mut handle);
            importer.messages();
            let status = make(call, &importer, handle);
            let categories: Vec<String> = importer.messages().into_iter().map(|message| message.category).collect();
            let status = ["OK", "Warning", "Discard", "Error", "Fatal", "Pending"][status as usize];
            let _ = write!(table, "{:26}", [&[status.to_owned()], categories.as_slice()].concat().join(" "));
        }
    }
    let lines: Vec<&str> = table.lines().map(str::trim_end).collect();
    lines.join("\n") + "\n"
}

#[test]
fn every_call_in_every_state_returns_the_expected_status() {
    let found = walk(make);
    let expected = include_str!("walk.txt");
    assert!(found == expected, "the walk goes otherwise; it now reads\n{found}");
}

#[test]
fn the_table_detects_a_call_that_does_something_else() {
    let planted = walk(|call, importer, saved| match call {
        Call::SetString => make(Call::GetString, importer, saved),
        _ => make(call, importer, saved),
    });
    let expected = include_str!("walk.txt");
    let different: Vec<_> =
        planted.lines().zip(expected.lines()).filter(|(found, expected)| found != expected).collect();
    assert!(different.iter().any(|(found, _)| found.starts_with("fmi2SetString")), "{different:?}");
}
