//! The functions by which a unit's state is saved and restored, as pointers into a library.

use super::functions::optional;
use fmi2::c::{Component, FmuState, RawStatus};
use fmi2::calls::Call;
use libloading::os::unix as loader;
use std::ffi::c_char;

/// All of these functions; a unit declares in its description whether they may be used.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StateFunctions {
    pub get: unsafe extern "C-unwind" fn(Component, *mut FmuState) -> RawStatus,
    pub set: unsafe extern "C-unwind" fn(Component, FmuState) -> RawStatus,
    pub free: unsafe extern "C-unwind" fn(Component, *mut FmuState) -> RawStatus,
    pub serialized_size: unsafe extern "C-unwind" fn(Component, FmuState, *mut usize) -> RawStatus,
    pub serialize: unsafe extern "C-unwind" fn(Component, FmuState, *mut c_char, usize) -> RawStatus,
    pub deserialize: unsafe extern "C-unwind" fn(Component, *const c_char, usize, *mut FmuState) -> RawStatus,
}

impl StateFunctions {
    /// The functions of a library, or the one that it lacks.
    pub fn of(library: &loader::Library) -> Result<Self, Call> {
        // SAFETY: the standard defines the type of each symbol; it is the type of the field that the symbol is stored
        // in.
        unsafe {
            Ok(Self {
                get: optional(library, Call::GetFmuState).ok_or(Call::GetFmuState)?,
                set: optional(library, Call::SetFmuState).ok_or(Call::SetFmuState)?,
                free: optional(library, Call::FreeFmuState).ok_or(Call::FreeFmuState)?,
                serialized_size: optional(library, Call::SerializedFmuStateSize).ok_or(Call::SerializedFmuStateSize)?,
                serialize: optional(library, Call::SerializeFmuState).ok_or(Call::SerializeFmuState)?,
                deserialize: optional(library, Call::DeSerializeFmuState).ok_or(Call::DeSerializeFmuState)?,
            })
        }
    }
}
