//! What the importer may ask about the last step.
#![allow(unsafe_code, reason = "pointers of the importer")]

use super::{Component, Instance, RawStatus, Refusal, Status, c, enter};
use fmi2::calls::Call;

/// Writes the answer, or says that there is none.
unsafe fn answer<T>(place: *mut T, kind: c::StatusKind, value: Option<T>) -> Result<Status, Refusal> {
    let value = value.ok_or(Refusal::NoSuchStatus { kind })?;
    // SAFETY: the contract of `abi`: null or a place for the answer.
    *unsafe { place.as_mut() }.ok_or(Refusal::Null { argument: "value" })? = value;
    Ok(Status::Ok)
}

/// `fmi2GetStatus`: no step is ever pending.
pub unsafe fn status(component: Component, kind: c::StatusKind, value: *mut RawStatus) -> RawStatus {
    // SAFETY: the contract of `abi`.
    unsafe { enter(component, Call::GetStatus, |_| answer(value, kind, None)) }
}

/// `fmi2GetRealStatus`: the time up to which the last step came.
pub unsafe fn real_status(component: Component, kind: c::StatusKind, value: *mut f64) -> RawStatus {
    let work = |instance: &mut Instance| {
        let last_s = (kind == c::LAST_SUCCESSFUL_TIME).then(|| instance.progress.now.as_s());
        // SAFETY: the contract of `abi`.
        unsafe { answer(value, kind, last_s) }
    };
    // SAFETY: the contract of `abi`.
    unsafe { enter(component, Call::GetRealStatus, work) }
}

/// `fmi2GetIntegerStatus`: the standard knows none.
pub unsafe fn integer_status(component: Component, kind: c::StatusKind, value: *mut i32) -> RawStatus {
    // SAFETY: the contract of `abi`.
    unsafe { enter(component, Call::GetIntegerStatus, |_| answer(value, kind, None)) }
}

/// `fmi2GetBooleanStatus`: whether the unit has come to its end.
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
