//! The C types of `fmi2TypesPlatform.h`, `fmi2FunctionTypes.h` and the function pointers of co-simulation.

use std::ffi::{c_char, c_int, c_uint, c_void};

/// `fmi2Component`: the unit's handle of one instance.
pub type Component = *mut c_void;
/// `fmi2ComponentEnvironment`: the importer's handle, passed back in callbacks.
pub type ComponentEnvironment = *mut c_void;
/// `fmi2FMUstate`: the unit's handle of one saved state.
pub type FmuState = *mut c_void;
/// `fmi2ValueReference`.
pub type ValueReference = c_uint;
/// `fmi2Boolean`: any value except zero is true.
pub type Boolean = c_int;
/// `fmi2String`: UTF-8, zero-terminated.
pub type Str = *const c_char;

/// `fmi2True`.
pub const TRUE: Boolean = 1;
/// `fmi2False`.
pub const FALSE: Boolean = 0;

/// `fmi2Status` as it crosses the C interface: a plain integer, since a foreign unit may return any value.
pub type RawStatus = c_int;

/// `fmi2Status`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(i32)]
pub enum Status {
    /// `fmi2OK`
    Ok = 0,
    /// `fmi2Warning`
    Warning = 1,
    /// `fmi2Discard`
    Discard = 2,
    /// `fmi2Error`
    Error = 3,
    /// `fmi2Fatal`
    Fatal = 4,
    /// `fmi2Pending`
    Pending = 5,
}

impl Status {
    /// The status of a raw value, or `None` if the standard does not define the value.
    #[must_use]
    pub fn from_raw(raw: RawStatus) -> Option<Self> {
        Some(match raw {
            0 => Self::Ok,
            1 => Self::Warning,
            2 => Self::Discard,
            3 => Self::Error,
            4 => Self::Fatal,
            5 => Self::Pending,
            _ => return None,
        })
    }

    /// The name in the standard's header, `fmi2OK` and so on.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ok => "fmi2OK",
            Self::Warning => "fmi2Warning",
            Self::Discard => "fmi2Discard",
            Self::Error => "fmi2Error",
            Self::Fatal => "fmi2Fatal",
            Self::Pending => "fmi2Pending",
        }
    }
}

/// `fmi2Type`.
pub type FmuType = c_int;
/// `fmi2ModelExchange`.
pub const MODEL_EXCHANGE: FmuType = 0;
/// `fmi2CoSimulation`.
pub const CO_SIMULATION: FmuType = 1;

/// `fmi2StatusKind`.
pub type StatusKind = c_int;
/// `fmi2DoStepStatus`.
pub const DO_STEP_STATUS: StatusKind = 0;
/// `fmi2PendingStatus`.
pub const PENDING_STATUS: StatusKind = 1;
/// `fmi2LastSuccessfulTime`.
pub const LAST_SUCCESSFUL_TIME: StatusKind = 2;
/// `fmi2Terminated`.
pub const TERMINATED: StatusKind = 3;

/// `fmi2CallbackLogger`: a variadic function, printf arguments after the message.
pub type CallbackLogger = unsafe extern "C" fn(ComponentEnvironment, Str, RawStatus, Str, Str, ...);
/// `fmi2CallbackAllocateMemory`.
pub type CallbackAllocateMemory = unsafe extern "C" fn(usize, usize) -> *mut c_void;
/// `fmi2CallbackFreeMemory`.
pub type CallbackFreeMemory = unsafe extern "C" fn(*mut c_void);
/// `fmi2StepFinished`.
pub type StepFinished = unsafe extern "C" fn(ComponentEnvironment, RawStatus);

/// `fmi2CallbackFunctions`.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct CallbackFunctions {
    /// Called for each message of the unit.
    pub logger: Option<CallbackLogger>,
    /// `calloc`.
    pub allocate_memory: Option<CallbackAllocateMemory>,
    /// `free`.
    pub free_memory: Option<CallbackFreeMemory>,
    /// `fmi2StepFinished`, for asynchronous steps; may be absent.
    pub step_finished: Option<StepFinished>,
    /// Passed back in `logger` and `step_finished`.
    pub component_environment: ComponentEnvironment,
}
