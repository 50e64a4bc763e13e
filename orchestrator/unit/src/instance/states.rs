//! Saves an instance's state as bytes and restores it, by the standard's functions.

use super::Instance;
use crate::board::Now;
use crate::failure::{Cause, Failure};
use crate::library::StateFunctions;
use fmi2::c::{Component, FmuState};
use fmi2::calls::Call;
use std::ptr;

/// A larger state is taken for an error of the unit, instead of allocating that much memory.
const LARGEST_STATE: usize = 1 << 30;

/// A state in the memory of its instance, which must get it back by [`Instance::forget`].
#[derive(Debug)]
pub struct KeptState {
    state: FmuState,
    /// The instance that it is a state of.
    of: Component,
}

impl Instance {
    /// Keeps the present state in memory.
    ///
    /// # Errors
    /// The unit refuses or lacks a function.
    pub fn keep(&mut self, now: &Now<'_>) -> Result<KeptState, Failure> {
        let functions = self.state_functions(now)?;
        let mut state = ptr::null_mut();
        self.checked(now, Call::GetFmuState, |_, component| {
            // SAFETY: the pointer is valid; the handle is NULL, by which the standard asks for a new state.
            unsafe { (functions.get)(component, &raw mut state) }
        })?;
        Ok(KeptState { state, of: self.component })
    }

    /// Takes the instance back to a state that it keeps.
    ///
    /// # Errors
    /// The unit refuses or lacks a function.
    pub fn return_to(&mut self, now: &Now<'_>, kept: &KeptState) -> Result<(), Failure> {
        assert_eq!(kept.of, self.component, "a state returns to its own instance");
        let functions = self.state_functions(now)?;
        self.checked(now, Call::SetFmuState, |_, component| {
            // SAFETY: the state is this instance's, and `forget` has not freed it.
            unsafe { (functions.set)(component, kept.state) }
        })
    }

    /// Frees a state that the instance keeps.
    ///
    /// # Errors
    /// The unit refuses or lacks a function.
    pub fn forget(&mut self, now: &Now<'_>, mut kept: KeptState) -> Result<(), Failure> {
        assert_eq!(kept.of, self.component, "a state returns to its own instance");
        let functions = self.state_functions(now)?;
        self.checked(now, Call::FreeFmuState, |_, component| {
            // SAFETY: the state is this instance's, and it is not used after this call.
            unsafe { (functions.free)(component, &raw mut kept.state) }
        })
    }

    /// The present state, serialized by the unit.
    ///
    /// # Errors
    /// The unit refuses, lacks a function, or returns a size above the limit.
    pub fn save(&mut self, now: &Now<'_>) -> Result<Vec<u8>, Failure> {
        self.preserving_all(now, "the saving of its state", |instance| instance.saved(now))
    }

    fn saved(&mut self, now: &Now<'_>) -> Result<Vec<u8>, Failure> {
        let functions = self.state_functions(now)?;
        let kept = self.keep(now)?;
        let state = kept.state;
        let mut size = 0;
        self.checked(now, Call::SerializedFmuStateSize, |_, component| {
            // SAFETY: the state is this instance's, and the pointer is valid and of the right type.
            unsafe { (functions.serialized_size)(component, state, &raw mut size) }
        })?;
        if size > LARGEST_STATE {
            let text = format!("its state takes {size} bytes; at most {LARGEST_STATE} are saved");
            return Err(self.failure(now, Call::SerializedFmuStateSize, Cause::Other(text)));
        }
        let mut bytes = vec![0_u8; size];
        self.checked(now, Call::SerializeFmuState, |_, component| {
            // SAFETY: the state is this instance's, and the buffer has `size` bytes.
            unsafe { (functions.serialize)(component, state, bytes.as_mut_ptr().cast(), size) }
        })?;
        self.forget(now, kept)?;
        Ok(bytes)
    }

    /// Restores a state that this unit serialized, in this process or in another.
    ///
    /// # Errors
    /// The unit refuses or lacks a function.
    pub fn restore(&mut self, now: &Now<'_>, bytes: &[u8]) -> Result<(), Failure> {
        self.preserving_all(now, "the restoring of its state", |instance| instance.restored(now, bytes))
    }

    fn restored(&mut self, now: &Now<'_>, bytes: &[u8]) -> Result<(), Failure> {
        let functions = self.state_functions(now)?;
        let mut state = ptr::null_mut();
        self.checked(now, Call::DeSerializeFmuState, |_, component| {
            // SAFETY: the unit reads at most the given number of bytes, and writes the handle.
            unsafe { (functions.deserialize)(component, bytes.as_ptr().cast(), bytes.len(), &raw mut state) }
        })?;
        let kept = KeptState { state, of: self.component };
        self.return_to(now, &kept)?;
        self.forget(now, kept)
    }

    fn state_functions(&self, now: &Now<'_>) -> Result<StateFunctions, Failure> {
        self.rest.states.map_err(|call| {
            let text = format!("its library lacks the function `{}` of its modelDescription.xml", call.name());
            self.failure(now, call, Cause::Other(text))
        })
    }
}
