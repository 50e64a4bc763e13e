//! The C interface behind the exported functions: pointers are converted to references and slices here only.
//!
//! # Safety
//!
//! Every function relies on the caller's obligations in the standard: a component is null or was returned by
//! [`instantiate`] of this library and not freed, no other call on it is in progress, and pointers point to as many
//! values as the count gives. Null pointers, zero counts and handles of saved states are checked.
#![allow(unsafe_code, reason = "pointers of the importer")]
#![allow(clippy::missing_safety_doc, reason = "one contract for all functions, at the head of the file")]

use crate::instance::Instance;
use crate::log::Category;
use crate::refusal::Refusal;
use fmi2::c::{self, Component, RawStatus, Status};
use fmi2::calls::Call;
use std::ffi::{CStr, c_char};
use std::mem::MaybeUninit;
use std::panic::{AssertUnwindSafe, catch_unwind};

mod instantiate;
mod states;
mod statuses;

pub use instantiate::{description, free, instantiate};
pub use states::{deserialize_state, free_state, get_state, serialize_state, serialized_state_size, set_state};
pub use statuses::{boolean_status, integer_status, real_status, status, string_status};

/// Makes a call on the instance behind the handle; without an instance there is no logger for a message.
#[inline]
unsafe fn enter(
    component: Component,
    call: Call,
    work: impl FnOnce(&mut Instance) -> Result<Status, Refusal>,
) -> RawStatus {
    // SAFETY: the contract of this file.
    match unsafe { component.cast::<Instance>().as_mut() } {
        Some(instance) => instance.call(call, work) as RawStatus,
        None => Status::Error as RawStatus,
    }
}

/// The values at a pointer; none if the count is 0, even if the pointer is null.
#[inline]
unsafe fn values<'a, T>(pointer: *const T, count: usize, argument: &'static str) -> Result<&'a [T], Refusal> {
    match (count, pointer.is_null()) {
        (0, _) => Ok(&[]),
        (_, true) => Err(Refusal::Null { argument }),
        // SAFETY: the contract of this file.
        _ => Ok(unsafe { std::slice::from_raw_parts(pointer, count) }),
    }
}

/// The locations at a pointer; none if the count is 0, even if the pointer is null.
#[inline]
unsafe fn places<'a, T>(pointer: *mut T, count: usize) -> Result<&'a mut [MaybeUninit<T>], Refusal> {
    match (count, pointer.is_null()) {
        (0, _) => Ok(&mut []),
        (_, true) => Err(Refusal::Null { argument: "value" }),
        // SAFETY: the contract of this file.
        _ => Ok(unsafe { std::slice::from_raw_parts_mut(pointer.cast(), count) }),
    }
}

/// `fmi2GetTypesPlatform`
#[must_use]
pub fn types_platform() -> *const c_char {
    c"default".as_ptr()
}

/// `fmi2GetVersion`
#[must_use]
pub fn version() -> *const c_char {
    c"2.0".as_ptr()
}

/// `fmi2SetDebugLogging`: an empty list of categories means all categories.
pub unsafe fn set_debug_logging(
    component: Component,
    on: c::Boolean,
    count: usize,
    categories: *const c::Str,
) -> RawStatus {
    let work = |instance: &mut Instance| {
        let on = on != c::FALSE;
        if count == 0 {
            instance.log.want_all(on);
        }
        // SAFETY: the contract of this file.
        for &name in unsafe { values(categories, count, "categories") }? {
            if name.is_null() {
                return Err(Refusal::Null { argument: "categories" });
            }
            // SAFETY: not null, and the contract of this file.
            let name = unsafe { CStr::from_ptr(name) }.to_string_lossy();
            match Category::ALL.iter().find(|category| category.name() == name) {
                Some(&category) => instance.log.want(category, on),
                None => {
                    instance.log.send(Status::Warning, &format!("there is no log category `{name}`"));
                    return Ok(Status::Warning);
                }
            }
        }
        Ok(Status::Ok)
    };
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::SetDebugLogging, work) }
}

/// `fmi2SetupExperiment`; the units do not use the tolerance.
pub unsafe fn set_up_experiment(
    component: Component,
    start_s: f64,
    stop_defined: c::Boolean,
    stop_s: f64,
) -> RawStatus {
    let stop_s = (stop_defined != c::FALSE).then_some(stop_s);
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::SetupExperiment, |instance| instance.set_up(start_s, stop_s)) }
}

/// `fmi2EnterInitializationMode`
pub unsafe fn enter_initialization_mode(component: Component) -> RawStatus {
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::EnterInitializationMode, Instance::enter_initialization) }
}

/// `fmi2ExitInitializationMode`
pub unsafe fn exit_initialization_mode(component: Component) -> RawStatus {
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::ExitInitializationMode, Instance::refresh) }
}

/// `fmi2Terminate`
pub unsafe fn terminate(component: Component) -> RawStatus {
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::Terminate, |_| Ok(Status::Ok)) }
}

/// `fmi2Reset`
pub unsafe fn reset(component: Component) -> RawStatus {
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::Reset, Instance::reset) }
}

/// `fmi2DoStep`
pub unsafe fn do_step(component: Component, point_s: f64, length_s: f64) -> RawStatus {
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::DoStep, |instance| instance.step(point_s, length_s)) }
}

/// A call that the capability flags exclude.
pub unsafe fn not_supported(component: Component, call: Call, capability: &'static str) -> RawStatus {
    // SAFETY: the contract of this file.
    unsafe { enter(component, call, |_| Err(Refusal::NotSupported { capability })) }
}

/// `fmi2GetReal`
pub unsafe fn get_real(component: Component, references: *const u32, count: usize, value: *mut f64) -> RawStatus {
    let work = |instance: &mut Instance| {
        // SAFETY: the contract of this file.
        let (references, places) = unsafe { (values(references, count, "vr")?, places(value, count)?) };
        instance.get_reals(references, places)
    };
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::GetReal, work) }
}

/// `fmi2GetInteger`
pub unsafe fn get_integer(component: Component, references: *const u32, count: usize, value: *mut i32) -> RawStatus {
    let work = |instance: &mut Instance| {
        // SAFETY: the contract of this file.
        let (references, places) = unsafe { (values(references, count, "vr")?, places(value, count)?) };
        instance.get_integers(references, places)
    };
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::GetInteger, work) }
}

/// `fmi2GetBoolean`
pub unsafe fn get_boolean(
    component: Component,
    references: *const u32,
    count: usize,
    value: *mut c::Boolean,
) -> RawStatus {
    let work = |instance: &mut Instance| {
        // SAFETY: the contract of this file.
        let (references, places) = unsafe { (values(references, count, "vr")?, places(value, count)?) };
        instance.get_booleans(references, places)
    };
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::GetBoolean, work) }
}

/// `fmi2GetString`
pub unsafe fn get_string(component: Component, references: *const u32, count: usize, value: *mut c::Str) -> RawStatus {
    let work = |instance: &mut Instance| {
        // SAFETY: the contract of this file.
        let (references, places) = unsafe { (values(references, count, "vr")?, places(value, count)?) };
        instance.get_strings(references, places)
    };
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::GetString, work) }
}

/// `fmi2SetReal`
pub unsafe fn set_real(component: Component, references: *const u32, count: usize, value: *const f64) -> RawStatus {
    let work = |instance: &mut Instance| {
        // SAFETY: the contract of this file.
        let (references, value) = unsafe { (values(references, count, "vr")?, values(value, count, "value")?) };
        instance.set_reals(references, value)
    };
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::SetReal, work) }
}

/// `fmi2SetInteger`
pub unsafe fn set_integer(component: Component, references: *const u32, count: usize, value: *const i32) -> RawStatus {
    let work = |instance: &mut Instance| {
        // SAFETY: the contract of this file.
        let (references, value) = unsafe { (values(references, count, "vr")?, values(value, count, "value")?) };
        instance.set_integers(references, value)
    };
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::SetInteger, work) }
}

/// `fmi2SetBoolean`
pub unsafe fn set_boolean(
    component: Component,
    references: *const u32,
    count: usize,
    value: *const c::Boolean,
) -> RawStatus {
    let work = |instance: &mut Instance| {
        // SAFETY: the contract of this file.
        let (references, value) = unsafe { (values(references, count, "vr")?, values(value, count, "value")?) };
        instance.set_booleans(references, value)
    };
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::SetBoolean, work) }
}

/// `fmi2SetString`
pub unsafe fn set_string(
    component: Component,
    references: *const u32,
    count: usize,
    value: *const c::Str,
) -> RawStatus {
    let work = |instance: &mut Instance| {
        // SAFETY: the contract of this file.
        let (references, value) = unsafe { (values(references, count, "vr")?, values(value, count, "value")?) };
        if value.iter().any(|text| text.is_null()) {
            return Err(Refusal::Null { argument: "value" });
        }
        // SAFETY: not null, and the contract of this file.
        let texts: Vec<&CStr> = value.iter().map(|&text| unsafe { CStr::from_ptr(text) }).collect();
        instance.set_strings(references, &texts)
    };
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::SetString, work) }
}
