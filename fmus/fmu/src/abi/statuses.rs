//! The functions that return the status of the last step.
#![allow(unsafe_code, reason = "pointers of the importer")]

use super::{Component, Instance, RawStatus, Refusal, Status, c, enter};
use fmi2::calls::Call;

/// Writes the value, or returns the refusal if there is none.
unsafe fn answer<T>(place: *mut T, kind: c::StatusKind, value: Option<T>) -> Result<Status, Refusal> {
    let value = value.ok_or(Refusal::NoSuchStatus { kind })?;
    // SAFETY: the contract of `abi`: null or valid for writing the value.
    *unsafe { place.as_mut() }.ok_or(Refusal::Null { argument: "value" })? = value;
    Ok(Status::Ok)
}

/// `fmi2GetStatus`: no step is ever pending.
pub unsafe fn status(component: Component, kind: c::StatusKind, value: *mut RawStatus) -> RawStatus {
    // SAFETY: the contract of `abi`.
    unsafe { enter(component, Call::GetStatus, |_| answer(value, kind, None)) }
}

/// `fmi2GetRealStatus`: the last successful time.
pub unsafe fn real_status(component: Component, kind: c::StatusKind, value: *mut f64) -> RawStatus {
    let work = |instance: &mut Instance| {
        let last_s = (kind == c::LAST_SUCCESSFUL_TIME).then(|| instance.progress.now.as_s());
        // SAFETY: the contract of `abi`.
        unsafe { answer(value, kind, last_s) }
    };
    // SAFETY: the contract of `abi`.
    unsafe { enter(component, Call::GetRealStatus, work) }
}

/// `fmi2GetIntegerStatus`: the standard defines no status of this type.
pub unsafe fn integer_status(component: Component, kind: c::StatusKind, value: *mut i32) -> RawStatus {
    // SAFETY: the contract of `abi`.
    unsafe { enter(component, Call::GetIntegerStatus, |_| answer(value, kind, None)) }
}

/// `fmi2GetBooleanStatus`: whether the unit has terminated.
pub unsafe fn boolean_status(component: Component, kind: c::StatusKind, value: *mut c::Boolean) -> RawStatus {
    let work = |instance: &mut Instance| {
        let ended = (kind == c::TERMINATED).then_some(c::Boolean::from(instance.progress.ended));
        // SAFETY: the contract of `abi`.
        unsafe { answer(value, kind, ended) }
    };
    // SAFETY: the contract of `abi`.
    unsafe { enter(component, Call::GetBooleanStatus, work) }
}

/// `fmi2GetStringStatus`: no step is ever pending.
pub unsafe fn string_status(component: Component, kind: c::StatusKind, value: *mut c::Str) -> RawStatus {
    // SAFETY: the contract of `abi`.
    unsafe { enter(component, Call::GetStringStatus, |_| answer(value, kind, None)) }
}
