//! Creation and end of an instance, and the description that the packager reads.
#![allow(unsafe_code, reason = "pointers of the importer")]

use super::{AssertUnwindSafe, Instance, catch_unwind};
use crate::body::Body;
use crate::instance::panic_text;
use crate::library::Library;
use crate::log::Log;
use fmi2::c::{self, CallbackFunctions, Component, Status};
use std::ffi::{CStr, CString};

/// `fmi2Instantiate`: on an error null, after a message if there is a logger.
///
/// Everything that the importer passes is copied. Resources are not used, so that their location may be null.
pub unsafe fn instantiate(
    library: &'static Library,
    name: c::Str,
    kind: c::FmuType,
    guid: c::Str,
    callbacks: *const CallbackFunctions,
    logging_on: c::Boolean,
) -> Component {
    // SAFETY: the contract of this file: callbacks and strings are null or valid during the call.
    let (callbacks, name, guid) = unsafe { (callbacks.as_ref(), text(name), text(guid)) };
    let Some((CallbackFunctions { component_environment, .. }, logger)) =
        callbacks.and_then(|callbacks| Some((callbacks, callbacks.logger?)))
    else {
        return std::ptr::null_mut();
    };
    // SAFETY: the importer's callbacks stay valid for the instance's life.
    let mut log = unsafe { Log::new(logger, *component_environment, name.clone().unwrap_or_default()) };
    if logging_on != c::FALSE {
        log.want_all(true);
    }
    let made = catch_unwind(AssertUnwindSafe(|| {
        // Held, so that the description is built once for this call.
        let described = library.described();
        match why_not(&described.description.guid, name.as_deref(), kind, guid.as_deref()) {
            Some(reason) => Err(reason),
            None => Ok(Body::new(library)),
        }
    }));
    match made.unwrap_or_else(|panic| Err(panic_text(&*panic))) {
        Ok(body) => Box::into_raw(Box::new(Instance::new(library, body, log))).cast(),
        Err(reason) => {
            log.send(Status::Error, &format!("fmi2Instantiate: {reason}"));
            std::ptr::null_mut()
        }
    }
}

unsafe fn text(pointer: c::Str) -> Option<CString> {
    // SAFETY: not null, and the contract of this file.
    (!pointer.is_null()).then(|| unsafe { CStr::from_ptr(pointer) }.to_owned())
}

/// The reason why an instance cannot be created, if any.
fn why_not(own: &str, name: Option<&CStr>, kind: c::FmuType, guid: Option<&CStr>) -> Option<String> {
    let given = guid.map(|guid| guid.to_string_lossy().into_owned());
    if name.is_none_or(|name| name.to_bytes().trim_ascii().is_empty()) {
        return Some("the instance has no name".to_owned());
    }
    if kind != c::CO_SIMULATION {
        return Some("the unit is for co-simulation only".to_owned());
    }
    match given {
        None => Some("no GUID is given".to_owned()),
        Some(given) if given != own => Some(format!(
            "the model description with GUID {given} does not belong to this library, whose GUID is {own}"
        )),
        Some(_) => None,
    }
}

/// `fmi2FreeInstance`
pub unsafe fn free(component: Component) {
    if component.is_null() {
        return;
    }
    // SAFETY: the contract of this file: the handle came from `instantiate` and is freed once.
    let instance = unsafe { Box::from_raw(component.cast::<Instance>()) };
    // A panic of the unit while it is dropped must not end the importer.
    drop(catch_unwind(AssertUnwindSafe(|| drop(instance))));
}

/// `modelDescription.xml` of the library, UTF-8 without a zero byte at its end; it is never freed. Only the packager calls
/// this, once.
pub unsafe fn description(library: &'static Library, length: *mut usize) -> *const u8 {
    let Ok(xml) = catch_unwind(AssertUnwindSafe(|| library.xml().leak())) else { return std::ptr::null() };
    // SAFETY: null or valid for writing the length.
    if let Some(length) = unsafe { length.as_mut() } {
        *length = xml.len();
    }
    xml.as_ptr()
}
