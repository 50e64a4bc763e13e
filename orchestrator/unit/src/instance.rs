//! One instance of a unit: the calls of FMI 2.0, each noted on the board, each status checked.
//!
//! Next on the walk of a number: `fmus/<unit>/src/lib.rs`, behind the function pointers.

mod after_call;
mod lifecycle;
mod states;
mod strings;

pub use lifecycle::Setting;
pub use states::KeptState;

use super::board::{Note, Now};
use super::handles::Handles;
use super::library::{DoStep, Functions, Get, Library, Set, StateFunctions};
use super::logger::Registration;
use crate::failure::{Cause, Doing, Failure};
use crate::process_state::{floating_point, look};
use after_call::Warnings;
use fmi2::c::{
    Boolean, CallbackFunctions, Component, FALSE, LAST_SUCCESSFUL_TIME, RawStatus, Status, TERMINATED, TRUE,
};
use fmi2::calls::Call;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use strings::Strings;

/// How a step ended that did not fail.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepResult {
    /// The unit reached the end of the step.
    Done,
    /// The unit wants the run to end (`fmi2Discard` with `fmi2Terminated`).
    Terminated {
        /// The time that it reached; the start of the step if it does not report one.
        last_successful_time_s: f64,
    },
}

/// One instance of a unit, freed when dropped. Any thread may call it, but only one at a time.
#[derive(Debug)]
pub struct Instance {
    component: Component,
    index: usize,
    /// The functions that nearly every step calls are kept here and not behind `rest`: a loop over many instances then
    /// loads few cache lines for each.
    set_real: Set<f64>,
    do_step: DoStep,
    get_real: Get<f64>,
    rest: Box<Rest>,
}

/// What is needed only by some calls.
#[derive(Debug)]
struct Rest {
    functions: Functions,
    /// The functions that save and restore states, or the first one that the library lacks.
    states: Result<StateFunctions, Call>,
    note: Note,
    name: String,
    library: Arc<Library>,
    /// Boxed, because many units keep the address of this struct.
    _callbacks: Box<CallbackFunctions>,
    _registration: Registration,
    warnings: Warnings,
    strings: Strings,
}

// SAFETY: the standard allows any thread to call a unit if the calls of one instance do not overlap, which `&mut self`
// ensures; the raw pointers inside are used in these calls only.
unsafe impl Send for Instance {}

impl Instance {
    /// The name in the script.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.rest.name
    }

    /// Whether an instance of this library returned `fmi2Fatal`: no function of it may be called any more.
    #[must_use]
    pub fn is_dead(&self) -> bool {
        self.rest.library.is_dead()
    }

    /// The unit's functions, for benchmarks that measure the cost of the bare calls.
    #[must_use]
    pub fn functions(&self) -> &Functions {
        &self.rest.functions
    }

    /// The unit's handle of this instance, for calls of [`Instance::functions`].
    #[must_use]
    pub fn component(&self) -> Component {
        self.component
    }

    /// The handles of variables by their indices in the description; `None` if the unit has no such variable.
    #[must_use]
    pub fn handles(&self, variables: impl IntoIterator<Item = usize>) -> Option<Handles> {
        self.rest.library.handles.handles(variables)
    }

    /// Sets Real variables.
    ///
    /// # Errors
    /// The unit returns neither `fmi2OK` nor `fmi2Warning`.
    #[inline(always)]
    pub fn set_real(&mut self, now: &Now<'_>, handles: &Handles, values: &[f64]) -> Result<(), Failure> {
        let set_real = self.set_real;
        self.values(now, Call::SetReal, handles.len(), values.len(), |_, component, count| {
            // SAFETY: both slices have `count` elements, and the unit only reads them.
            unsafe { set_real(component, handles.as_ptr(), count, values.as_ptr()) }
        })
    }

    /// Sets Integer variables, including enumerations.
    ///
    /// # Errors
    /// The unit returns neither `fmi2OK` nor `fmi2Warning`.
    #[inline]
    pub fn set_integer(&mut self, now: &Now<'_>, handles: &Handles, values: &[i32]) -> Result<(), Failure> {
        self.values(now, Call::SetInteger, handles.len(), values.len(), |functions, component, count| {
            // SAFETY: both slices have `count` elements, and the unit only reads them.
            unsafe { (functions.set_integer)(component, handles.as_ptr(), count, values.as_ptr()) }
        })
    }

    /// Sets Boolean variables, 0 or 1.
    ///
    /// # Errors
    /// The unit returns neither `fmi2OK` nor `fmi2Warning`.
    #[inline]
    pub fn set_boolean(&mut self, now: &Now<'_>, handles: &Handles, values: &[Boolean]) -> Result<(), Failure> {
        self.values(now, Call::SetBoolean, handles.len(), values.len(), |functions, component, count| {
            // SAFETY: both slices have `count` elements, and the unit only reads them.
            unsafe { (functions.set_boolean)(component, handles.as_ptr(), count, values.as_ptr()) }
        })
    }

    /// Reads Real variables. The values may be infinite or NaN: the caller checks them.
    ///
    /// # Errors
    /// The unit returns neither `fmi2OK` nor `fmi2Warning`.
    #[inline(always)]
    pub fn get_real(&mut self, now: &Now<'_>, handles: &Handles, values: &mut [f64]) -> Result<(), Failure> {
        let get_real = self.get_real;
        self.values(now, Call::GetReal, handles.len(), values.len(), |_, component, count| {
            // SAFETY: both slices have `count` elements; the unit reads the first and writes the second.
            unsafe { get_real(component, handles.as_ptr(), count, values.as_mut_ptr()) }
        })
    }

    /// Reads Integer variables, including enumerations.
    ///
    /// # Errors
    /// The unit returns neither `fmi2OK` nor `fmi2Warning`.
    #[inline]
    pub fn get_integer(&mut self, now: &Now<'_>, handles: &Handles, values: &mut [i32]) -> Result<(), Failure> {
        self.values(now, Call::GetInteger, handles.len(), values.len(), |functions, component, count| {
            // SAFETY: both slices have `count` elements; the unit reads the first and writes the second.
            unsafe { (functions.get_integer)(component, handles.as_ptr(), count, values.as_mut_ptr()) }
        })
    }

    /// Reads Boolean variables as 0 or 1, even if the unit uses another number for true.
    ///
    /// # Errors
    /// The unit returns neither `fmi2OK` nor `fmi2Warning`.
    #[inline]
    pub fn get_boolean(&mut self, now: &Now<'_>, handles: &Handles, values: &mut [Boolean]) -> Result<(), Failure> {
        self.values(now, Call::GetBoolean, handles.len(), values.len(), |functions, component, count| {
            // SAFETY: both slices have `count` elements; the unit reads the first and writes the second.
            unsafe { (functions.get_boolean)(component, handles.as_ptr(), count, values.as_mut_ptr()) }
        })?;
        for value in values {
            *value = Boolean::from(*value != FALSE);
        }
        Ok(())
    }

    /// Sets String variables.
    ///
    /// # Errors
    /// The unit returns neither `fmi2OK` nor `fmi2Warning`.
    pub fn set_string(&mut self, now: &Now<'_>, handles: &Handles, values: &[String]) -> Result<(), Failure> {
        let mut strings = std::mem::take(&mut self.rest.strings);
        let texts = strings.for_unit(values);
        let result = self.values(now, Call::SetString, handles.len(), texts.len(), |functions, component, count| {
            // SAFETY: both slices have `count` elements, and the unit only reads them and the strings that they point
            // to.
            unsafe { (functions.set_string)(component, handles.as_ptr(), count, texts.as_ptr()) }
        });
        self.rest.strings = strings;
        result
    }

    /// Reads String variables. Bytes that are not UTF-8 are replaced; NULL becomes the empty string.
    ///
    /// # Errors
    /// The unit returns neither `fmi2OK` nor `fmi2Warning`.
    pub fn get_string(&mut self, now: &Now<'_>, handles: &Handles, values: &mut [String]) -> Result<(), Failure> {
        let mut strings = std::mem::take(&mut self.rest.strings);
        let texts = strings.of_unit(values.len());
        let result = self.values(now, Call::GetString, handles.len(), texts.len(), |functions, component, count| {
            // SAFETY: both slices have `count` elements; the unit reads the first and writes the second.
            unsafe { (functions.get_string)(component, handles.as_ptr(), count, texts.as_mut_ptr()) }
        });
        if result.is_ok() {
            // SAFETY: by the standard the strings are valid until the next call of the unit, and end in a zero byte.
            unsafe { strings.copy_to(values) };
        }
        self.rest.strings = strings;
        result
    }

    /// Does one step that begins at `now`.
    ///
    /// # Errors
    /// The unit neither reaches the end of the step nor asks for the run to end.
    #[inline(always)]
    pub fn do_step(&mut self, now: &Now<'_>, step_s: f64) -> Result<StepResult, Failure> {
        // No state before this time will be restored.
        self.step(now, step_s, TRUE)
    }

    /// As [`Instance::do_step`], where the instance may return to a state that it had before.
    ///
    /// # Errors
    /// The unit neither reaches the end of the step nor asks for the run to end.
    pub fn do_step_that_may_be_undone(&mut self, now: &Now<'_>, step_s: f64) -> Result<StepResult, Failure> {
        self.step(now, step_s, FALSE)
    }

    #[inline(always)]
    fn step(&mut self, now: &Now<'_>, step_s: f64, no_state_before: Boolean) -> Result<StepResult, Failure> {
        let do_step = self.do_step;
        let status = now.call(self.index, Doing::Call(Call::DoStep), || {
            // SAFETY: the arguments are plain numbers.
            unsafe { do_step(self.component, now.time_s, step_s, no_state_before) }
        });
        if status | look() == Status::Ok as RawStatus && !floating_point::acts_otherwise() {
            Ok(StepResult::Done)
        } else {
            self.after_step(now, step_s, status)
        }
    }

    /// The result of a step that did not return `fmi2OK`, or after which there is something to look at.
    #[cold]
    fn after_step(&mut self, now: &Now<'_>, step_s: f64, status: RawStatus) -> Result<StepResult, Failure> {
        self.look_after(now, Call::DoStep);
        match Status::from_raw(status) {
            Some(Status::Discard) => self.discarded(now, step_s),
            Some(Status::Pending) => {
                let text = "fmi2DoStep returned fmi2Pending, but nobody asked for an asynchronous step";
                Err(self.failure(now, Call::DoStep, Cause::Other(text.to_owned())))
            }
            _ => self.check_status(now, Call::DoStep, status).map(|()| StepResult::Done),
        }
    }

    /// A discarded step: asks whether the unit wants the run to end, and which time it reached.
    fn discarded(&mut self, now: &Now<'_>, step_s: f64) -> Result<StepResult, Failure> {
        let mut terminated = FALSE;
        let mut reached_s = f64::NAN;
        if let Some(get_status) = self.rest.functions.get_boolean_status {
            self.unchecked(now, Call::GetBooleanStatus, |_, component| {
                // SAFETY: the pointer is valid and has the type that belongs to this status kind.
                unsafe { get_status(component, TERMINATED, &raw mut terminated) }
            });
        }
        if let Some(get_status) = self.rest.functions.get_real_status {
            self.unchecked(now, Call::GetRealStatus, |_, component| {
                // SAFETY: the pointer is valid and has the type that belongs to this status kind.
                unsafe { get_status(component, LAST_SUCCESSFUL_TIME, &raw mut reached_s) }
            });
        }
        if terminated != FALSE {
            let last_successful_time_s = if reached_s.is_finite() { reached_s } else { now.time_s };
            return Ok(StepResult::Terminated { last_successful_time_s });
        }
        let mut text = format!("fmi2DoStep returned fmi2Discard: the unit did not take the step of {step_s} s");
        if reached_s.is_finite() {
            text.push_str(&format!(" and came as far as {reached_s} s"));
        }
        Err(self.failure(now, Call::DoStep, Cause::Other(text)))
    }

    /// A call that gets or sets one value for each reference. Without references no call is made.
    #[inline(always)]
    fn values(
        &mut self,
        now: &Now<'_>,
        call: Call,
        references: usize,
        values: usize,
        foreign: impl FnOnce(&Functions, Component, usize) -> RawStatus,
    ) -> Result<(), Failure> {
        assert_eq!(references, values, "as many values as references");
        if references == 0 {
            return Ok(());
        }
        self.checked(now, call, |functions, component| foreign(functions, component, references))
    }

    /// A call whose status is checked.
    #[inline(always)]
    fn checked(
        &mut self,
        now: &Now<'_>,
        call: Call,
        foreign: impl FnOnce(&Functions, Component) -> RawStatus,
    ) -> Result<(), Failure> {
        let status = now.call(self.index, Doing::Call(call), || foreign(&self.rest.functions, self.component));
        if status | look() == Status::Ok as RawStatus { Ok(()) } else { self.after_call(now, call, status) }
    }

    /// The result of a call that did not return `fmi2OK`, or after which there is something to look at.
    #[cold]
    fn after_call(&mut self, now: &Now<'_>, call: Call, status: RawStatus) -> Result<(), Failure> {
        self.look_after(now, call);
        self.check_status(now, call, status)
    }

    /// A call whose status is of no account.
    fn unchecked(&mut self, now: &Now<'_>, call: Call, foreign: impl FnOnce(&Functions, Component) -> RawStatus) {
        now.call(self.index, Doing::Call(call), || foreign(&self.rest.functions, self.component));
        self.look_after(now, call);
    }

    /// Checks a status.
    fn check_status(&mut self, now: &Now<'_>, call: Call, status: RawStatus) -> Result<(), Failure> {
        match Status::from_raw(status) {
            Some(Status::Ok) => return Ok(()),
            Some(Status::Warning) => {
                self.rest.warnings.status(now, call);
                return Ok(());
            }
            // Release: a thread that sees the flag also sees all that this call did.
            Some(Status::Fatal) => self.rest.library.fatal.store(true, Ordering::Release),
            _ => {}
        }
        Err(self.failure(now, call, Cause::Status(status)))
    }

    /// Logs a warning about this instance beside its own messages.
    pub fn log_warning(&self, now: &Now<'_>, text: String) {
        self.rest.warnings.warn((now.tick, now.counts_at), text);
    }

    fn failure(&self, now: &Now<'_>, call: Call, cause: Cause) -> Failure {
        Failure { instance: Some(self.rest.name.clone()), doing: Doing::Call(call), time_s: Some(now.time_s), cause }
    }
}
