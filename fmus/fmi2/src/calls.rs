//! The calls allowed in each state: section 4.2.4 of the standard as one table, plus what an exporter also accepts.

use crate::c::Status;
use crate::description::{Causality, Initial, Variability};
use serde::{Deserialize, Serialize};

/// The functions of FMI 2.0 for co-simulation. The number of each is stable, because a board may store it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[repr(u8)]
pub enum Call {
    /// `fmi2GetTypesPlatform`: needs no instance.
    GetTypesPlatform = 1,
    /// `fmi2GetVersion`: needs no instance.
    GetVersion = 2,
    /// `fmi2SetDebugLogging`
    SetDebugLogging = 3,
    /// `fmi2Instantiate`
    Instantiate = 4,
    /// `fmi2FreeInstance`
    FreeInstance = 5,
    /// `fmi2SetupExperiment`: once, before initialization.
    SetupExperiment = 6,
    /// `fmi2EnterInitializationMode`
    EnterInitializationMode = 7,
    /// `fmi2ExitInitializationMode`
    ExitInitializationMode = 8,
    /// `fmi2Terminate`
    Terminate = 9,
    /// `fmi2Reset`
    Reset = 10,
    /// `fmi2GetReal`
    GetReal = 11,
    /// `fmi2GetInteger`
    GetInteger = 12,
    /// `fmi2GetBoolean`
    GetBoolean = 13,
    /// `fmi2GetString`
    GetString = 14,
    /// `fmi2SetReal`; [`settable`] says for which variables.
    SetReal = 15,
    /// `fmi2SetInteger`; [`settable`] says for which variables.
    SetInteger = 16,
    /// `fmi2SetBoolean`; [`settable`] says for which variables.
    SetBoolean = 17,
    /// `fmi2SetString`; [`settable`] says for which variables.
    SetString = 18,
    /// `fmi2GetFMUstate`
    GetFmuState = 19,
    /// `fmi2SetFMUstate`
    SetFmuState = 20,
    /// `fmi2FreeFMUstate`
    FreeFmuState = 21,
    /// `fmi2SerializedFMUstateSize`
    SerializedFmuStateSize = 22,
    /// `fmi2SerializeFMUstate`
    SerializeFmuState = 23,
    /// `fmi2DeSerializeFMUstate`
    DeSerializeFmuState = 24,
    /// `fmi2GetDirectionalDerivative`
    GetDirectionalDerivative = 25,
    /// `fmi2SetRealInputDerivatives`
    SetRealInputDerivatives = 26,
    /// `fmi2GetRealOutputDerivatives`
    GetRealOutputDerivatives = 27,
    /// `fmi2DoStep`
    DoStep = 28,
    /// `fmi2CancelStep`: only while an asynchronous step runs.
    CancelStep = 29,
    /// `fmi2GetStatus`
    GetStatus = 30,
    /// `fmi2GetRealStatus`
    GetRealStatus = 31,
    /// `fmi2GetIntegerStatus`
    GetIntegerStatus = 32,
    /// `fmi2GetBooleanStatus`
    GetBooleanStatus = 33,
    /// `fmi2GetStringStatus`
    GetStringStatus = 34,
}

impl Call {
    /// All calls, in the order of their numbers.
    pub const ALL: [Self; 34] = [
        Self::GetTypesPlatform,
        Self::GetVersion,
        Self::SetDebugLogging,
        Self::Instantiate,
        Self::FreeInstance,
        Self::SetupExperiment,
        Self::EnterInitializationMode,
        Self::ExitInitializationMode,
        Self::Terminate,
        Self::Reset,
        Self::GetReal,
        Self::GetInteger,
        Self::GetBoolean,
        Self::GetString,
        Self::SetReal,
        Self::SetInteger,
        Self::SetBoolean,
        Self::SetString,
        Self::GetFmuState,
        Self::SetFmuState,
        Self::FreeFmuState,
        Self::SerializedFmuStateSize,
        Self::SerializeFmuState,
        Self::DeSerializeFmuState,
        Self::GetDirectionalDerivative,
        Self::SetRealInputDerivatives,
        Self::GetRealOutputDerivatives,
        Self::DoStep,
        Self::CancelStep,
        Self::GetStatus,
        Self::GetRealStatus,
        Self::GetIntegerStatus,
        Self::GetBooleanStatus,
        Self::GetStringStatus,
    ];

    /// The call with this number, or `None` if there is none.
    #[must_use]
    pub fn from_number(number: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|&call| call as u8 == number)
    }

    /// The function's name in C.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::GetTypesPlatform => "fmi2GetTypesPlatform",
            Self::GetVersion => "fmi2GetVersion",
            Self::SetDebugLogging => "fmi2SetDebugLogging",
            Self::Instantiate => "fmi2Instantiate",
            Self::FreeInstance => "fmi2FreeInstance",
            Self::SetupExperiment => "fmi2SetupExperiment",
            Self::EnterInitializationMode => "fmi2EnterInitializationMode",
            Self::ExitInitializationMode => "fmi2ExitInitializationMode",
            Self::Terminate => "fmi2Terminate",
            Self::Reset => "fmi2Reset",
            Self::GetReal => "fmi2GetReal",
            Self::GetInteger => "fmi2GetInteger",
            Self::GetBoolean => "fmi2GetBoolean",
            Self::GetString => "fmi2GetString",
            Self::SetReal => "fmi2SetReal",
            Self::SetInteger => "fmi2SetInteger",
            Self::SetBoolean => "fmi2SetBoolean",
            Self::SetString => "fmi2SetString",
            Self::GetFmuState => "fmi2GetFMUstate",
            Self::SetFmuState => "fmi2SetFMUstate",
            Self::FreeFmuState => "fmi2FreeFMUstate",
            Self::SerializedFmuStateSize => "fmi2SerializedFMUstateSize",
            Self::SerializeFmuState => "fmi2SerializeFMUstate",
            Self::DeSerializeFmuState => "fmi2DeSerializeFMUstate",
            Self::GetDirectionalDerivative => "fmi2GetDirectionalDerivative",
            Self::SetRealInputDerivatives => "fmi2SetRealInputDerivatives",
            Self::GetRealOutputDerivatives => "fmi2GetRealOutputDerivatives",
            Self::DoStep => "fmi2DoStep",
            Self::CancelStep => "fmi2CancelStep",
            Self::GetStatus => "fmi2GetStatus",
            Self::GetRealStatus => "fmi2GetRealStatus",
            Self::GetIntegerStatus => "fmi2GetIntegerStatus",
            Self::GetBooleanStatus => "fmi2GetBooleanStatus",
            Self::GetStringStatus => "fmi2GetStringStatus",
        }
    }
}

/// State of an instance in the state machine of co-simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum State {
    /// There is no instance: not yet created, or already freed.
    NotInstantiated,
    /// Instantiated or reset; start values are set and the experiment is set up.
    Instantiated,
    /// Between the two calls around initialization mode.
    InitializationMode,
    /// The last step is complete (or there was none yet) and the next may begin.
    StepComplete,
    /// An asynchronous step is in progress.
    StepInProgress,
    /// The last step was discarded.
    StepFailed,
    /// The last step, an asynchronous one, was cancelled.
    StepCanceled,
    /// The run is over; results can still be read.
    Terminated,
    /// A call returned `fmi2Error`: values are for debugging only; a reset or a restored state leaves this state.
    Error,
    /// A call returned `fmi2Fatal`: no instance of this library may be called again.
    Fatal,
}

impl State {
    /// All states, in the order of a run.
    pub const ALL: [Self; 10] = [
        Self::NotInstantiated,
        Self::Instantiated,
        Self::InitializationMode,
        Self::StepComplete,
        Self::StepInProgress,
        Self::StepFailed,
        Self::StepCanceled,
        Self::Terminated,
        Self::Error,
        Self::Fatal,
    ];

    /// The state's name in the figure of the standard.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::NotInstantiated => "not instantiated",
            Self::Instantiated => "instantiated",
            Self::InitializationMode => "initializationMode",
            Self::StepComplete => "stepComplete",
            Self::StepInProgress => "stepInProgress",
            Self::StepFailed => "stepFailed",
            Self::StepCanceled => "stepCanceled",
            Self::Terminated => "terminated",
            Self::Error => "error",
            Self::Fatal => "fatal",
        }
    }
}

/// Whether a call may be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Permission {
    /// The standard allows it.
    Always,
    /// The standard allows it, but the values it returns are for debugging only.
    DebugValues,
    /// The standard forbids it, but importers do it: an exporter executes it and logs a warning, an importer avoids it.
    WithWarning,
    /// The standard forbids it: an exporter returns `fmi2Error` and logs the reason.
    No,
}

/// Whether the call may be made in the state.
///
/// Three rules need more than the state: `fmi2SetupExperiment` is called at most once before initialization, and
/// without it an exporter starts at 0 with a warning; a set call obeys [`settable`] for each variable; and freeing a
/// null instance has no effect, therefore [`Call::FreeInstance`] is allowed where there is no instance.
#[must_use]
pub fn permitted(call: Call, state: State) -> Permission {
    use Call as C;
    use Permission::{Always, No};
    use State as S;
    match (call, state) {
        (_, S::Fatal) => No,
        (C::GetTypesPlatform | C::GetVersion, _) => Always,
        (C::Instantiate | C::FreeInstance, S::NotInstantiated) => Always,
        (_, S::NotInstantiated) | (C::Instantiate, _) => No,

        (C::SetDebugLogging, _) => Always,
        (C::FreeInstance | C::Reset, S::StepInProgress) => No,
        (C::FreeInstance | C::Reset, _) => Always,
        (C::SetupExperiment | C::EnterInitializationMode, S::Instantiated) => Always,
        (C::ExitInitializationMode, S::InitializationMode) => Always,
        (C::Terminate, S::StepComplete | S::StepFailed) => Always,
        (C::DoStep, S::StepComplete) => Always,
        (C::CancelStep, S::StepInProgress) => Always,
        (
            C::GetStatus | C::GetRealStatus | C::GetIntegerStatus | C::GetBooleanStatus | C::GetStringStatus,
            S::StepComplete | S::StepInProgress | S::StepFailed | S::Terminated,
        ) => Always,
        _ => permitted_on_values(call, state),
    }
}

/// The rows of the table for calls that read or write values or whole states of an existing instance.
fn permitted_on_values(call: Call, state: State) -> Permission {
    use Permission::{Always, DebugValues, No, WithWarning};
    use State as S;
    let suspect = matches!(state, S::StepFailed | S::StepCanceled | S::Error);
    let after_a_step = suspect || matches!(state, S::StepComplete | S::Terminated);
    let (allowed, answers_values) = match call {
        // Importers read start values before initialization.
        Call::GetReal | Call::GetInteger | Call::GetBoolean | Call::GetString if state == S::Instantiated => {
            return WithWarning;
        }
        Call::GetReal | Call::GetInteger | Call::GetBoolean | Call::GetString | Call::GetDirectionalDerivative => {
            (after_a_step || state == S::InitializationMode, true)
        }
        Call::GetRealOutputDerivatives => (after_a_step, true),
        Call::SetReal | Call::SetInteger | Call::SetBoolean | Call::SetString | Call::SetRealInputDerivatives => {
            (matches!(state, S::Instantiated | S::InitializationMode | S::StepComplete), false)
        }
        Call::GetFmuState => (state != S::StepInProgress, true),
        Call::SetFmuState
        | Call::FreeFmuState
        | Call::SerializedFmuStateSize
        | Call::SerializeFmuState
        | Call::DeSerializeFmuState => (state != S::StepInProgress, false),
        _ => (false, false),
    };
    match (allowed, answers_values && suspect) {
        (true, false) => Always,
        (true, true) => DebugValues,
        (false, _) => No,
    }
}

/// Whether a variable may be set in the state; `initial` is the attribute or, if absent, the standard's default.
///
/// Before initialization the standard allows start values only; inputs are settable too, since importers set their
/// first values there.
#[must_use]
pub fn settable(state: State, causality: Causality, variability: Variability, initial: Option<Initial>) -> Permission {
    let input = causality == Causality::Input;
    let allowed = match state {
        _ if variability == Variability::Constant => false,
        State::Instantiated => input || matches!(initial, Some(Initial::Exact | Initial::Approx)),
        State::InitializationMode => input || initial == Some(Initial::Exact),
        State::StepComplete => input || (causality == Causality::Parameter && variability == Variability::Tunable),
        _ => false,
    };
    if allowed { Permission::Always } else { Permission::No }
}

/// The state after a permitted call that returned this status.
///
/// Two cases are outside the table and are the caller's: the state in which a restored state was saved, and the result
/// of
/// `fmi2GetStatus` for a step in progress.
#[must_use]
#[inline]
pub fn next(state: State, call: Call, status: Status) -> State {
    match (call, status) {
        (_, Status::Fatal) => State::Fatal,
        (Call::FreeInstance, _) => State::NotInstantiated,
        (Call::Instantiate, Status::Ok | Status::Warning) => State::Instantiated,
        (Call::Instantiate, _) => state,
        (_, Status::Error) => State::Error,
        (Call::EnterInitializationMode, Status::Ok | Status::Warning) => State::InitializationMode,
        (Call::ExitInitializationMode, Status::Ok | Status::Warning) => State::StepComplete,
        (Call::Terminate, Status::Ok | Status::Warning) => State::Terminated,
        (Call::Reset, Status::Ok | Status::Warning) => State::Instantiated,
        (Call::CancelStep, Status::Ok | Status::Warning) => State::StepCanceled,
        (Call::DoStep, Status::Ok | Status::Warning) => State::StepComplete,
        (Call::DoStep, Status::Discard) => State::StepFailed,
        (Call::DoStep, Status::Pending) => State::StepInProgress,
        _ => state,
    }
}

#[cfg(test)]
mod tests;
