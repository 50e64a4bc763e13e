//! The functions of FMI 2.0 for co-simulation that a run calls, as pointers into a library.

use crate::error::UnitError;
use fmi2::c::{Boolean, CallbackFunctions, Component, FmuType, RawStatus, StatusKind, Str, ValueReference};
use fmi2::calls::Call;
use libloading::os::unix as loader;
use std::path::Path;

/// `fmi2GetXXX` for one base type.
pub type Get<T> = unsafe extern "C-unwind" fn(Component, *const ValueReference, usize, *mut T) -> RawStatus;
/// `fmi2SetXXX` for one base type.
pub type Set<T> = unsafe extern "C-unwind" fn(Component, *const ValueReference, usize, *const T) -> RawStatus;
/// `fmi2DoStep`.
pub type DoStep = unsafe extern "C-unwind" fn(Component, f64, f64, Boolean) -> RawStatus;
/// A function whose only argument is the instance.
pub type OfComponent = unsafe extern "C-unwind" fn(Component) -> RawStatus;
/// A function without arguments that returns a string.
pub type GetText = unsafe extern "C-unwind" fn() -> Str;

/// The functions as raw pointers. A call that does not go through [`Instance`](crate::instance::Instance) is not noted
/// on the board.
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs, reason = "each is the function of the standard of the same name")]
pub struct Functions {
    pub get_types_platform: GetText,
    pub get_version: GetText,
    pub instantiate:
        unsafe extern "C-unwind" fn(Str, FmuType, Str, Str, *const CallbackFunctions, Boolean, Boolean) -> Component,
    pub free_instance: unsafe extern "C-unwind" fn(Component),
    pub setup_experiment: unsafe extern "C-unwind" fn(Component, Boolean, f64, f64, Boolean, f64) -> RawStatus,
    pub enter_initialization_mode: OfComponent,
    pub exit_initialization_mode: OfComponent,
    pub terminate: OfComponent,
    pub get_real: Get<f64>,
    pub get_integer: Get<i32>,
    pub get_boolean: Get<Boolean>,
    pub get_string: Get<Str>,
    pub set_real: Set<f64>,
    pub set_integer: Set<i32>,
    pub set_boolean: Set<Boolean>,
    pub set_string: Set<Str>,
    pub do_step: DoStep,
    /// Called only to test a unit; some units do not export it.
    pub reset: Option<OfComponent>,
    /// Called only after a discarded step; some units do not export it.
    pub get_real_status: Option<unsafe extern "C-unwind" fn(Component, StatusKind, *mut f64) -> RawStatus>,
    /// Called only after a discarded step; some units do not export it.
    pub get_boolean_status: Option<unsafe extern "C-unwind" fn(Component, StatusKind, *mut Boolean) -> RawStatus>,
}

impl Functions {
    pub(super) fn of(library: &loader::Library, path: &Path) -> Result<Self, UnitError> {
        // SAFETY: the standard defines the type of each symbol; it is the type of the field that the symbol is stored
        // in.
        unsafe {
            Ok(Self {
                get_types_platform: required(library, path, Call::GetTypesPlatform)?,
                get_version: required(library, path, Call::GetVersion)?,
                instantiate: required(library, path, Call::Instantiate)?,
                free_instance: required(library, path, Call::FreeInstance)?,
                setup_experiment: required(library, path, Call::SetupExperiment)?,
                enter_initialization_mode: required(library, path, Call::EnterInitializationMode)?,
                exit_initialization_mode: required(library, path, Call::ExitInitializationMode)?,
                terminate: required(library, path, Call::Terminate)?,
                get_real: required(library, path, Call::GetReal)?,
                get_integer: required(library, path, Call::GetInteger)?,
                get_boolean: required(library, path, Call::GetBoolean)?,
                get_string: required(library, path, Call::GetString)?,
                set_real: required(library, path, Call::SetReal)?,
                set_integer: required(library, path, Call::SetInteger)?,
                set_boolean: required(library, path, Call::SetBoolean)?,
                set_string: required(library, path, Call::SetString)?,
                do_step: required(library, path, Call::DoStep)?,
                reset: optional(library, Call::Reset),
                get_real_status: optional(library, Call::GetRealStatus),
                get_boolean_status: optional(library, Call::GetBooleanStatus),
            })
        }
    }
}

/// # Safety
/// `T` is the type of a pointer to the call's function.
unsafe fn required<T: Copy>(library: &loader::Library, path: &Path, call: Call) -> Result<T, UnitError> {
    // SAFETY: guaranteed by the caller.
    unsafe { optional(library, call) }
        .ok_or_else(|| UnitError::NoFunction { library: path.to_path_buf(), symbol: call.name() })
}

/// # Safety
/// `T` is the type of a pointer to the call's function.
pub(super) unsafe fn optional<T: Copy>(library: &loader::Library, call: Call) -> Option<T> {
    // SAFETY: the type is guaranteed by the caller; a symbol whose value is NULL counts as absent.
    let symbol = unsafe { library.get::<Option<T>>(call.name()) }.ok()?;
    *symbol
}
