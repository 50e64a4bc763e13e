//! The functions that save and restore states, each with a log entry before and after the call.

use super::Logged;
use crate::library::StateFunctions;
use fmi2::c::{Component, FmuState, RawStatus};
use fmi2::calls::Call;
use std::ffi::c_char;

/// The functions that an instance calls instead of the unit's.
pub(super) const TABLE: StateFunctions = StateFunctions { get, set, free, serialized_size, serialize, deserialize };

impl Logged {
    /// Makes a call and logs it.
    ///
    /// # Safety
    /// As for [`Logged::of`], and `foreign` makes a call that the standard allows at this time.
    unsafe fn state_call(
        component: Component,
        call: Call,
        arguments: impl FnOnce() -> String,
        foreign: impl FnOnce(&StateFunctions, Component) -> RawStatus,
        results: impl FnOnce() -> String,
    ) -> RawStatus {
        // SAFETY: guaranteed by the caller.
        let logged = unsafe { Self::of(component) };
        let call_unit = |_: &_, unit| match &logged.states {
            Ok(states) => foreign(states, unit),
            Err(_) => unreachable!("the table is only there if the unit has all of these functions"),
        };
        logged.call(call, arguments, call_unit, results)
    }
}

unsafe extern "C-unwind" fn get(component: Component, state: *mut FmuState) -> RawStatus {
    // SAFETY: `Instance` calls with its own component, and the unit gets the arguments unchanged.
    unsafe {
        Logged::state_call(component, Call::GetFmuState, String::new, |unit, to| (unit.get)(to, state), String::new)
    }
}

unsafe extern "C-unwind" fn set(component: Component, state: FmuState) -> RawStatus {
    // SAFETY: as in `get`.
    unsafe {
        Logged::state_call(component, Call::SetFmuState, String::new, |unit, to| (unit.set)(to, state), String::new)
    }
}

unsafe extern "C-unwind" fn free(component: Component, state: *mut FmuState) -> RawStatus {
    // SAFETY: as in `get`.
    unsafe {
        Logged::state_call(component, Call::FreeFmuState, String::new, |unit, to| (unit.free)(to, state), String::new)
    }
}

unsafe extern "C-unwind" fn serialized_size(component: Component, state: FmuState, size: *mut usize) -> RawStatus {
    // SAFETY: as in `get`; `Instance` passes a pointer to an initialized value.
    unsafe {
        let foreign = |unit: &StateFunctions, to| (unit.serialized_size)(to, state, size);
        Logged::state_call(component, Call::SerializedFmuStateSize, String::new, foreign, || format!(", {}", *size))
    }
}

unsafe extern "C-unwind" fn serialize(
    component: Component,
    state: FmuState,
    bytes: *mut c_char,
    size: usize,
) -> RawStatus {
    // SAFETY: as in `get`.
    unsafe {
        let foreign = |unit: &StateFunctions, to| (unit.serialize)(to, state, bytes, size);
        Logged::state_call(component, Call::SerializeFmuState, || format!("size = {size}"), foreign, String::new)
    }
}

unsafe extern "C-unwind" fn deserialize(
    component: Component,
    bytes: *const c_char,
    size: usize,
    state: *mut FmuState,
) -> RawStatus {
    // SAFETY: as in `get`.
    unsafe {
        let foreign = |unit: &StateFunctions, to| (unit.deserialize)(to, bytes, size, state);
        Logged::state_call(component, Call::DeSerializeFmuState, || format!("size = {size}"), foreign, String::new)
    }
}
