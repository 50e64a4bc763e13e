//! Tests of the call table: every pair against a table written by hand, and the sequence of states of a run.

use super::*;

/// `+` yes, `*` debug values, `w` with a warning, `.` no; the columns are the states in the order of [`State::ALL`]:
/// not instantiated, Instantiated, iNitialization mode, step Complete, in Progress, Failed, canceled (X), Terminated,
/// Error, fatal (!).
const GOLDEN: &str = "
                             -INCPFXTE!
fmi2GetTypesPlatform         +++++++++.
fmi2GetVersion               +++++++++.
fmi2SetDebugLogging          .++++++++.
fmi2Instantiate              +.........
fmi2FreeInstance             ++++.++++.
fmi2SetupExperiment          .+........
fmi2EnterInitializationMode  .+........
fmi2ExitInitializationMode   ..+.......
fmi2Terminate                ...+.+....
fmi2Reset                    .+++.++++.
fmi2GetReal                  .w++.**+*.
fmi2GetInteger               .w++.**+*.
fmi2GetBoolean               .w++.**+*.
fmi2GetString                .w++.**+*.
fmi2SetReal                  .+++......
fmi2SetInteger               .+++......
fmi2SetBoolean               .+++......
fmi2SetString                .+++......
fmi2GetFMUstate              .+++.**+*.
fmi2SetFMUstate              .+++.++++.
fmi2FreeFMUstate             .+++.++++.
fmi2SerializedFMUstateSize   .+++.++++.
fmi2SerializeFMUstate        .+++.++++.
fmi2DeSerializeFMUstate      .+++.++++.
fmi2GetDirectionalDerivative ..++.**+*.
fmi2SetRealInputDerivatives  .+++......
fmi2GetRealOutputDerivatives ...+.**+*.
fmi2DoStep                   ...+......
fmi2CancelStep               ....+.....
fmi2GetStatus                ...+++.+..
fmi2GetRealStatus            ...+++.+..
fmi2GetIntegerStatus         ...+++.+..
fmi2GetBooleanStatus         ...+++.+..
fmi2GetStringStatus          ...+++.+..
";

#[test]
fn every_pair_of_call_and_state_agrees_with_the_table_written_by_hand() {
    let mut walked = "\n                             -INCPFXTE!\n".to_owned();
    for call in Call::ALL {
        let row = State::ALL.map(|state| match permitted(call, state) {
            Permission::Always => '+',
            Permission::DebugValues => '*',
            Permission::WithWarning => 'w',
            Permission::No => '.',
        });
        walked += &format!("{:28} {}\n", call.name(), String::from_iter(row));
    }
    assert_eq!(walked, GOLDEN);
}

#[test]
fn the_number_of_a_call_is_its_index_and_converts_back_to_it() {
    for (place, call) in Call::ALL.into_iter().enumerate() {
        assert_eq!(call as usize, place + 1);
        assert_eq!(Call::from_number(call as u8), Some(call));
    }
    assert_eq!((Call::from_number(0), Call::from_number(35)), (None, None));
}

#[test]
fn names_of_states_and_calls_are_all_different() {
    let mut names: Vec<_> = Call::ALL.iter().map(|call| call.name()).chain(State::ALL.map(State::name)).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count);
}

#[test]
fn fewer_variables_are_settable_as_the_run_proceeds() {
    use Initial::{Approx, Calculated, Exact};
    let states = [State::Instantiated, State::InitializationMode, State::StepComplete, State::Terminated];
    let rows = [
        (Causality::Input, Variability::Continuous, None, "yyy-"),
        (Causality::Input, Variability::Discrete, None, "yyy-"),
        (Causality::Parameter, Variability::Fixed, Some(Exact), "yy--"),
        (Causality::Parameter, Variability::Tunable, Some(Exact), "yyy-"),
        (Causality::CalculatedParameter, Variability::Tunable, Some(Calculated), "----"),
        (Causality::CalculatedParameter, Variability::Fixed, Some(Approx), "y---"),
        (Causality::Output, Variability::Continuous, Some(Exact), "yy--"),
        (Causality::Output, Variability::Continuous, Some(Approx), "y---"),
        (Causality::Output, Variability::Continuous, Some(Calculated), "----"),
        (Causality::Output, Variability::Constant, Some(Exact), "----"),
        (Causality::Local, Variability::Discrete, Some(Exact), "yy--"),
        (Causality::Independent, Variability::Continuous, None, "----"),
    ];
    for (causality, variability, initial, expected) in rows {
        let found = states.map(|state| match settable(state, causality, variability, initial) {
            Permission::Always => 'y',
            _ => '-',
        });
        assert_eq!(String::from_iter(found), expected, "{causality:?} {variability:?} {initial:?}");
    }
}

#[test]
fn a_run_passes_through_its_states_from_instantiate_to_free() {
    let walk = [
        (Call::Instantiate, Status::Ok, State::Instantiated),
        (Call::SetupExperiment, Status::Ok, State::Instantiated),
        (Call::EnterInitializationMode, Status::Warning, State::InitializationMode),
        (Call::ExitInitializationMode, Status::Ok, State::StepComplete),
        (Call::DoStep, Status::Ok, State::StepComplete),
        (Call::SetReal, Status::Discard, State::StepComplete),
        (Call::DoStep, Status::Discard, State::StepFailed),
        (Call::GetBooleanStatus, Status::Ok, State::StepFailed),
        (Call::Reset, Status::Ok, State::Instantiated),
        (Call::EnterInitializationMode, Status::Error, State::Error),
        (Call::GetReal, Status::Ok, State::Error),
        (Call::Reset, Status::Ok, State::Instantiated),
        (Call::EnterInitializationMode, Status::Ok, State::InitializationMode),
        (Call::ExitInitializationMode, Status::Ok, State::StepComplete),
        (Call::DoStep, Status::Pending, State::StepInProgress),
        (Call::CancelStep, Status::Ok, State::StepCanceled),
        (Call::Reset, Status::Ok, State::Instantiated),
        (Call::EnterInitializationMode, Status::Ok, State::InitializationMode),
        (Call::ExitInitializationMode, Status::Ok, State::StepComplete),
        (Call::Terminate, Status::Ok, State::Terminated),
        (Call::FreeInstance, Status::Ok, State::NotInstantiated),
    ];
    let mut state = State::NotInstantiated;
    for (call, status, expected) in walk {
        assert_ne!(permitted(call, state), Permission::No, "{} in {}", call.name(), state.name());
        state = next(state, call, status);
        assert_eq!(state, expected, "after {}", call.name());
    }
    assert_eq!(next(State::StepComplete, Call::GetReal, Status::Fatal), State::Fatal);
    assert_eq!(next(State::NotInstantiated, Call::Instantiate, Status::Error), State::NotInstantiated);
}
