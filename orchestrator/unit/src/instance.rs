//! One instance of a unit: the calls of FMI 2.0, each noted on the board, each answer judged.
//!
//! Next on the walk of a number: `fmus/<unit>/src/lib.rs`, on the other side of the function pointers.

mod lifecycle;
mod states;
mod strings;

pub use lifecycle::Setting;

use super::board::{Note, Now};
use super::library::{DoStep, Functions, Get, Library, Set, StateFunctions};
use super::logger::{LogMessage, LogSink, Registration};
use crate::failure::{Cause, Doing, Failure};
use fmi2::c::{
    Boolean, CallbackFunctions, Component, FALSE, LAST_SUCCESSFUL_TIME, RawStatus, Status, TERMINATED, TRUE,
};
use fmi2::calls::Call;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use strings::Strings;

/// How a step ended that was no failure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepResult {
    /// The unit came to the end of the step.
    Done,
    /// The unit says that it is done for good (`fmi2Discard` with `fmi2Terminated`).
    Terminated {
        /// How far it came; the step's beginning if it does not say.
        last_successful_time_s: f64,
    },
}

/// One instance of a unit, freed when dropped. Its functions may be called by any one thread at a time.
#[derive(Debug)]
pub struct Instance {
    component: Component,
    index: usize,
    /// What nearly every step calls, apart from the other functions: a loop over many instances reads little else.
    set_real: Set<f64>,
    do_step: DoStep,
    get_real: Get<f64>,
    rest: Box<Rest>,
}

/// What only some calls need.
#[derive(Debug)]
struct Rest {
    functions: Functions,
    /// Those that save and restore states, or the first that the unit lacks.
    states: Result<StateFunctions, Call>,
    note: Note,
    name: String,
    library: Arc<Library>,
    /// Many units keep the address, so it stays the same.
    _callbacks: Box<CallbackFunctions>,
    _registration: Registration,
    log: LogTap,
    strings: Strings,
}

// SAFETY: the standard lets any thread call a unit, as long as calls of one instance do not overlap, which `&mut self`
// sees to; nothing but those calls uses the raw pointers inside.
unsafe impl Send for Instance {}

/// The way from here into the log, for what a unit says by its status only.
struct LogTap {
    sink: LogSink,
    warned: bool,
}

impl std::fmt::Debug for LogTap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LogTap").field("warned", &self.warned).finish_non_exhaustive()
    }
}

impl Instance {
    /// The name in the script.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.rest.name
    }

    /// The unit's functions, for whoever measures what the calls alone cost.
    #[must_use]
    pub fn functions(&self) -> &Functions {
        &self.rest.functions
    }

    /// The unit's handle of this instance, to go with [`Instance::functions`].
    #[must_use]
    pub fn component(&self) -> Component {
        self.component
    }

    /// Sets Real variables.
    ///
    /// # Errors
    /// The unit refuses.
    #[inline]
    pub fn set_real(&mut self, now: &Now<'_>, references: &[u32], values: &[f64]) -> Result<(), Failure> {
        let set_real = self.set_real;
        self.values(now, Call::SetReal, references.len(), values.len(), |_, component, count| {
            // SAFETY: both slices have `count` elements, and the unit only reads them.
            unsafe { set_real(component, references.as_ptr(), count, values.as_ptr()) }
        })
    }

    /// Sets Integer variables, enumerations among them.
    ///
    /// # Errors
    /// The unit refuses.
    #[inline]
    pub fn set_integer(&mut self, now: &Now<'_>, references: &[u32], values: &[i32]) -> Result<(), Failure> {
        self.values(now, Call::SetInteger, references.len(), values.len(), |functions, component, count| {
            // SAFETY: both slices have `count` elements, and the unit only reads them.
            unsafe { (functions.set_integer)(component, references.as_ptr(), count, values.as_ptr()) }
        })
    }

    /// Sets Boolean variables, 0 or 1.
    ///
    /// # Errors
    /// The unit refuses.
    #[inline]
    pub fn set_boolean(&mut self, now: &Now<'_>, references: &[u32], values: &[Boolean]) -> Result<(), Failure> {
        self.values(now, Call::SetBoolean, references.len(), values.len(), |functions, component, count| {
            // SAFETY: both slices have `count` elements, and the unit only reads them.
            unsafe { (functions.set_boolean)(component, references.as_ptr(), count, values.as_ptr()) }
        })
    }

    /// Reads Real variables. What comes may be infinite or no number.
    ///
    /// # Errors
    /// The unit refuses.
    #[inline]
    pub fn get_real(&mut self, now: &Now<'_>, references: &[u32], values: &mut [f64]) -> Result<(), Failure> {
        let get_real = self.get_real;
        self.values(now, Call::GetReal, references.len(), values.len(), |_, component, count| {
            // SAFETY: both slices have `count` elements; the unit reads the first and writes the second.
            unsafe { get_real(component, references.as_ptr(), count, values.as_mut_ptr()) }
        })
    }

    /// Reads Integer variables, enumerations among them.
    ///
    /// # Errors
    /// The unit refuses.
    #[inline]
    pub fn get_integer(&mut self, now: &Now<'_>, references: &[u32], values: &mut [i32]) -> Result<(), Failure> {
        self.values(now, Call::GetInteger, references.len(), values.len(), |functions, component, count| {
            // SAFETY: both slices have `count` elements; the unit reads the first and writes the second.
            unsafe { (functions.get_integer)(component, references.as_ptr(), count, values.as_mut_ptr()) }
        })
    }

    /// Reads Boolean variables: 0 or 1, whatever the unit takes for true.
    ///
    /// # Errors
    /// The unit refuses.
    #[inline]
    pub fn get_boolean(&mut self, now: &Now<'_>, references: &[u32], values: &mut [Boolean]) -> Result<(), Failure> {
        self.values(now, Call::GetBoolean, references.len(), values.len(), |functions, component, count| {
            // SAFETY: both slices have `count` elements; the unit reads the first and writes the second.
            unsafe { (functions.get_boolean)(component, references.as_ptr(), count, values.as_mut_ptr()) }
        })?;
        for value in values {
            *value = Boolean::from(*value != FALSE);
        }
        Ok(())
    }

    /// Sets String variables.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn set_string(&mut self, now: &Now<'_>, references: &[u32], values: &[String]) -> Result<(), Failure> {
        let mut strings = std::mem::take(&mut self.rest.strings);
        let texts = strings.for_unit(values);
        let result = self.values(now, Call::SetString, references.len(), texts.len(), |functions, component, count| {
            // SAFETY: both slices have `count` elements, and the unit only reads them and the texts behind them.
            unsafe { (functions.set_string)(component, references.as_ptr(), count, texts.as_ptr()) }
        });
        self.rest.strings = strings;
        result
    }

    /// Reads String variables; what is no UTF-8 is replaced, NULL counts as empty.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn get_string(&mut self, now: &Now<'_>, references: &[u32], values: &mut [String]) -> Result<(), Failure> {
        let mut strings = std::mem::take(&mut self.rest.strings);
        let texts = strings.of_unit(values.len());
        let result = self.values(now, Call::GetString, references.len(), texts.len(), |functions, component, count| {
            // SAFETY: both slices have `count` elements; the unit reads the first and writes the second.
            unsafe { (functions.get_string)(component, references.as_ptr(), count, texts.as_mut_ptr()) }
        });
        if result.is_ok() {
            // SAFETY: the unit's texts live until its next call, and end in a zero byte.
            unsafe { strings.copy_to(values) };
        }
        self.rest.strings = strings;
        result
    }

    /// Takes one step from `now` on.
    ///
    /// # Errors
    /// The unit does not come to the end of the step and does not say that it is done for good either.
    #[inline]
    pub fn do_step(&mut self, now: &Now<'_>, step_s: f64) -> Result<StepResult, Failure> {
        let do_step = self.do_step;
        let status = self.raw(now, Call::DoStep, |_, component| {
            // SAFETY: plain numbers; the last says that no state before this point will be restored.
            unsafe { do_step(component, now.time_s, step_s, TRUE) }
        });
        if status == Status::Ok as RawStatus { Ok(StepResult::Done) } else { self.after_step(now, step_s, status) }
    }

    #[cold]
    fn after_step(&mut self, now: &Now<'_>, step_s: f64, status: RawStatus) -> Result<StepResult, Failure> {
        match Status::from_raw(status) {
            Some(Status::Discard) => self.discarded(now, step_s),
            Some(Status::Pending) => {
                let text = "fmi2DoStep returned fmi2Pending, but nobody asked for an asynchronous step";
                Err(self.failure(now, Call::DoStep, Cause::Other(text.to_owned())))
            }
            _ => self.judge(now, Call::DoStep, status).map(|()| StepResult::Done),
        }
    }

    /// A discarded step: asks whether the unit is done for good, and how far it came.
    fn discarded(&mut self, now: &Now<'_>, step_s: f64) -> Result<StepResult, Failure> {
        let mut terminated = FALSE;
        let mut reached_s = f64::NAN;
        if let Some(ask) = self.rest.functions.get_boolean_status {
            self.raw(now, Call::GetBooleanStatus, |_, component| {
                // SAFETY: the pointer is to a value of the right type.
                unsafe { ask(component, TERMINATED, &raw mut terminated) }
            });
        }
        if let Some(ask) = self.rest.functions.get_real_status {
            self.raw(now, Call::GetRealStatus, |_, component| {
                // SAFETY: the pointer is to a value of the right type.
                unsafe { ask(component, LAST_SUCCESSFUL_TIME, &raw mut reached_s) }
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

    /// A call that gets or sets as many values as there are references; none if there are none.
    #[inline]
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

    /// A call whose answer counts.
    #[inline]
    fn checked(
        &mut self,
        now: &Now<'_>,
        call: Call,
        foreign: impl FnOnce(&Functions, Component) -> RawStatus,
    ) -> Result<(), Failure> {
        let status = self.raw(now, call, foreign);
        if status == Status::Ok as RawStatus { Ok(()) } else { self.judge(now, call, status) }
    }

    /// A call that is noted.
    #[inline]
    fn raw(&self, now: &Now<'_>, call: Call, foreign: impl FnOnce(&Functions, Component) -> RawStatus) -> RawStatus {
        now.enter(self.index, Doing::Call(call));
        foreign(&self.rest.functions, self.component)
    }

    #[cold]
    fn judge(&mut self, now: &Now<'_>, call: Call, status: RawStatus) -> Result<(), Failure> {
        match Status::from_raw(status) {
            Some(Status::Ok) => return Ok(()),
            Some(Status::Warning) => {
                self.warn(now, call);
                return Ok(());
            }
            Some(Status::Fatal) => self.rest.library.fatal.store(true, Ordering::Release),
            _ => {}
        }
        Err(self.failure(now, call, Cause::Status(status)))
    }

    /// Says once that a call returned a warning: the unit's own messages say why, if it has any.
    fn warn(&mut self, now: &Now<'_>, call: Call) {
        if !std::mem::replace(&mut self.rest.log.warned, true) {
            let text = format!("{} returned fmi2Warning (told once; the run goes on)", call.name());
            let (status, category) = (Status::Warning as RawStatus, "logStatusWarning".to_owned());
            let (instance, tick, counts_at) = (Some(self.index), now.tick, now.counts_at);
            (self.rest.log.sink)(LogMessage { instance, tick, counts_at, status, category, text });
        }
    }

    fn failure(&self, now: &Now<'_>, call: Call, cause: Cause) -> Failure {
        Failure { instance: Some(self.rest.name.clone()), doing: Doing::Call(call), time_s: Some(now.time_s), cause }
    }
}
