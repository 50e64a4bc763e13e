//! Saved states behind handles. A handle is compared with those that the instance returned, and never dereferenced.
#![allow(unsafe_code, reason = "pointers of the importer")]

use super::{Component, Instance, RawStatus, Refusal, Status, enter, values};
use fmi2::c::FmuState;
use fmi2::calls::Call;
use std::ffi::c_char;

impl Instance {
    fn handle(&self, index: usize) -> FmuState {
        std::ptr::from_ref(&*self.saved[index]).cast_mut().cast()
    }

    /// The index of the saved state behind a handle.
    fn saved_at(&self, handle: FmuState) -> Result<usize, Refusal> {
        (0..self.saved.len()).find(|&index| self.handle(index) == handle).ok_or(Refusal::UnknownState)
    }
}

/// The value at a pointer argument, which must not be null.
unsafe fn place<'a, T>(pointer: *mut T, argument: &'static str) -> Result<&'a mut T, Refusal> {
    // SAFETY: the contract of this file.
    unsafe { pointer.as_mut() }.ok_or(Refusal::Null { argument })
}

/// `fmi2GetFMUstate`: the state of a handle that is not null is overwritten.
pub unsafe fn get_state(component: Component, handle: *mut FmuState) -> RawStatus {
    let work = |instance: &mut Instance| {
        // SAFETY: the contract of this file.
        let handle = unsafe { place(handle, "FMUstate") }?;
        let into = if handle.is_null() { None } else { Some(instance.saved_at(*handle)?) };
        let index = instance.save(into);
        *handle = instance.handle(index);
        Ok(Status::Ok)
    };
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::GetFmuState, work) }
}

/// `fmi2SetFMUstate`
pub unsafe fn set_state(component: Component, handle: FmuState) -> RawStatus {
    let work = |instance: &mut Instance| {
        let index = instance.saved_at(handle)?;
        instance.restore(index)
    };
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::SetFmuState, work) }
}

/// `fmi2FreeFMUstate`: a null handle is not an error.
pub unsafe fn free_state(component: Component, handle: *mut FmuState) -> RawStatus {
    let work = |instance: &mut Instance| {
        // SAFETY: the contract of this file.
        let Some(handle) = (unsafe { handle.as_mut() }) else { return Ok(Status::Ok) };
        if !handle.is_null() {
            let index = instance.saved_at(*handle)?;
            drop(instance.saved.swap_remove(index));
            *handle = std::ptr::null_mut();
        }
        Ok(Status::Ok)
    };
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::FreeFmuState, work) }
}

/// `fmi2SerializedFMUstateSize`
pub unsafe fn serialized_state_size(component: Component, handle: FmuState, size: *mut usize) -> RawStatus {
    let work = |instance: &mut Instance| {
        let index = instance.saved_at(handle)?;
        // SAFETY: the contract of this file.
        *unsafe { place(size, "size") }? = instance.to_bytes(index)?.len();
        Ok(Status::Ok)
    };
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::SerializedFmuStateSize, work) }
}

/// `fmi2SerializeFMUstate`
pub unsafe fn serialize_state(component: Component, handle: FmuState, buffer: *mut c_char, size: usize) -> RawStatus {
    let work = |instance: &mut Instance| {
        let index = instance.saved_at(handle)?;
        let bytes = instance.to_bytes(index)?;
        let needed = bytes.len();
        if needed > size {
            return Err(Refusal::BufferTooSmall { size, needed });
        }
        // SAFETY: the contract of this file.
        for (place, byte) in unsafe { super::places(buffer.cast::<u8>(), size) }?.iter_mut().zip(bytes) {
            place.write(byte);
        }
        Ok(Status::Ok)
    };
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::SerializeFmuState, work) }
}

/// `fmi2DeSerializeFMUstate`: the state of a handle of this instance is overwritten; any other handle is ignored,
/// because some importers pass uninitialized ones.
pub unsafe fn deserialize_state(
    component: Component,
    buffer: *const c_char,
    size: usize,
    handle: *mut FmuState,
) -> RawStatus {
    let work = |instance: &mut Instance| {
        // SAFETY: the contract of this file.
        let (bytes, handle) =
            unsafe { (values(buffer.cast::<u8>(), size, "serializedState")?, place(handle, "FMUstate")?) };
        let index = instance.read_bytes(bytes, instance.saved_at(*handle).ok())?;
        *handle = instance.handle(index);
        Ok(Status::Ok)
    };
    // SAFETY: the contract of this file.
    unsafe { enter(component, Call::DeSerializeFmuState, work) }
}
