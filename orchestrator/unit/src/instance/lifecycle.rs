//! The life of an instance, from `fmi2Instantiate` to `fmi2FreeInstance`.

use super::after_call::Warnings;
use super::{Instance, Rest, Strings};
use crate::board::{Note, Now};
use crate::call_log::{CallLog, CallWriter, Calls};
use crate::failure::{Cause, Doing, Failure};
use crate::library::{Functions, Library};
use crate::logger::{Environment, LOGGER, LogSink, Registration};
use crate::process_state::{is_copy, preserved};
use fmi2::c::{Boolean, CO_SIMULATION, CallbackFunctions, Component, FALSE, RawStatus};
use fmi2::calls::Call;
use std::ffi::{CStr, CString};
use std::fmt::Display;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// The identity of an instance and the receivers of its messages.
pub struct Setting<'a> {
    /// The name in the script.
    pub name: &'a str,
    /// The index in the scenario.
    pub index: usize,
    /// The note of the thread that calls the instance.
    pub note: Note,
    /// Receives its log messages.
    pub sink: LogSink,
    /// `loggingOn`: whether the unit should log debug messages too.
    pub logging_on: bool,
    /// Receives a log of its calls; `None` if they are not logged.
    pub calls: Option<CallLog>,
}

impl Instance {
    /// Instantiates a unit.
    ///
    /// # Errors
    /// The unit returns NULL, or it may be instantiated only once in a process and an instance exists.
    pub fn instantiate(library: &Arc<Library>, setting: Setting<'_>) -> Result<Self, Failure> {
        let Setting { name, index, note, sink, logging_on, calls } = setting;
        let failure = |cause| Failure {
            instance: Some(name.to_owned()),
            doing: Doing::Call(Call::Instantiate),
            time_s: Some(0.0),
            cause,
        };
        let refused = |text: &str| failure(Cause::Other(text.to_owned()));
        let c_name = CString::new(name).map_err(|_| refused("the instance's name holds a zero character"))?;
        if library.only_once && library.instances.load(Ordering::Acquire) > 0 {
            let text = "the unit can be instantiated only once per process (canBeInstantiatedOnlyOncePerProcess)";
            return Err(refused(text));
        }
        let registration = register(library, index, name, &note, &sink);
        let callbacks = callbacks(&registration);
        let call_writer = calls.map(|log| CallWriter { log, note: note.clone(), names: Arc::clone(&library.names) });
        let now = note.at(0, 0.0);
        let doing = Doing::Call(Call::Instantiate);
        if let Some(call_writer) = &call_writer {
            call_writer.begin(Call::Instantiate, || format!("{name:?}, loggingOn = {logging_on}"));
        }
        let mut warnings = Warnings::new(index, sink);
        library.report_changes(|by, changes| warnings.changed(&now, by, changes));
        let foreign = || call_instantiate(library, &c_name, &callbacks, logging_on);
        let (component, changes) = now.call(index, doing, || preserved(foreign));
        if is_copy() {
            note.end_copy(now.tick, index, doing);
        }
        warnings.changed(&now, doing, changes);
        if let Some(call_writer) = &call_writer {
            call_writer.end(|| if component.is_null() { "NULL" } else { "an instance" }.to_owned());
        }
        drop(now);
        if component.is_null() {
            return Err(failure(Cause::NoInstance));
        }
        library.instances.fetch_add(1, Ordering::AcqRel);
        let unit = Calls { functions: library.functions, states: library.states, component };
        let Calls { functions, states, component } =
            call_writer.map_or(unit, |call_writer| call_writer.interpose(unit));
        let Functions { set_real, do_step, get_real, .. } = functions;
        let rest = Rest {
            functions,
            states,
            note,
            name: name.to_owned(),
            library: Arc::clone(library),
            _callbacks: callbacks,
            _registration: registration,
            warnings,
            strings: Strings::default(),
        };
        Ok(Self { component, index, set_real, do_step, get_real, rest: Box::new(rest) })
    }

    /// Sets the start time. Stop time and tolerance are left undefined.
    ///
    /// # Errors
    /// The unit returns neither `fmi2OK` nor `fmi2Warning`.
    pub fn setup_experiment(&mut self, start: &Now<'_>) -> Result<(), Failure> {
        self.preserving(start, Call::SetupExperiment, |functions, component| {
            // SAFETY: the component is this library's, and the other arguments are plain numbers.
            unsafe { (functions.setup_experiment)(component, FALSE, 0.0, start.time_s, FALSE, 0.0) }
        })
    }

    /// Enters initialization mode.
    ///
    /// # Errors
    /// The unit returns neither `fmi2OK` nor `fmi2Warning`.
    pub fn enter_initialization_mode(&mut self, now: &Now<'_>) -> Result<(), Failure> {
        self.preserving(now, Call::EnterInitializationMode, |functions, component| {
            // SAFETY: the component is this library's.
            unsafe { (functions.enter_initialization_mode)(component) }
        })
    }

    /// Exits initialization mode.
    ///
    /// # Errors
    /// The unit returns neither `fmi2OK` nor `fmi2Warning`.
    pub fn exit_initialization_mode(&mut self, now: &Now<'_>) -> Result<(), Failure> {
        self.preserving(now, Call::ExitInitializationMode, |functions, component| {
            // SAFETY: the component is this library's.
            unsafe { (functions.exit_initialization_mode)(component) }
        })
    }

    /// A checked call after which locale and working directory are restored too.
    fn preserving(
        &mut self,
        now: &Now<'_>,
        call: Call,
        foreign: impl FnOnce(&Functions, Component) -> RawStatus,
    ) -> Result<(), Failure> {
        self.preserving_all(now, Doing::Call(call), |instance| instance.checked(now, call, foreign))
    }

    /// The same after several calls.
    pub(super) fn preserving_all<T>(
        &mut self,
        now: &Now<'_>,
        doing: impl Display,
        foreign: impl FnOnce(&mut Self) -> T,
    ) -> T {
        let (result, changes) = preserved(|| foreign(self));
        self.rest.warnings.changed(now, doing, changes);
        result
    }

    /// Takes the instance back to where it was after `fmi2Instantiate`.
    ///
    /// # Errors
    /// The unit returns neither `fmi2OK` nor `fmi2Warning`, or its library has no such function.
    pub fn reset(&mut self, now: &Now<'_>) -> Result<(), Failure> {
        let Some(reset) = self.rest.functions.reset else {
            let text = "its library lacks this function, which the standard demands";
            return Err(self.failure(now, Call::Reset, Cause::Other(text.to_owned())));
        };
        self.preserving(now, Call::Reset, |_, component| {
            // SAFETY: the component is this library's.
            unsafe { reset(component) }
        })
    }

    /// Terminates the instance. After `fmi2Fatal` of any instance of the library this does nothing.
    ///
    /// # Errors
    /// The unit returns neither `fmi2OK` nor `fmi2Warning`.
    pub fn terminate(&mut self, now: &Now<'_>) -> Result<(), Failure> {
        if self.rest.library.is_dead() {
            return Ok(());
        }
        self.preserving(now, Call::Terminate, |functions, component| {
            // SAFETY: the component is this library's.
            unsafe { (functions.terminate)(component) }
        })
    }

    /// Frees the instance; the same as dropping it.
    pub fn free(self) {}
}

/// Makes the logger know an instance.
fn register(library: &Library, instance: usize, name: &str, note: &Note, sink: &LogSink) -> Registration {
    let (name, names) = (name.to_owned(), Arc::clone(&library.names));
    Registration::new(Environment { instance, name, note: note.clone(), names, sink: Arc::clone(sink) })
}

/// The callbacks. The memory functions are those of the C library, so that a unit may release with `free` what it got
/// here.
fn callbacks(registration: &Registration) -> Box<CallbackFunctions> {
    Box::new(CallbackFunctions {
        logger: Some(LOGGER),
        allocate_memory: Some(libc::calloc),
        free_memory: Some(libc::free),
        step_finished: None,
        component_environment: registration.handle(),
    })
}

fn call_instantiate(library: &Library, name: &CStr, callbacks: &CallbackFunctions, logging_on: bool) -> Component {
    let (guid, resources) = (library.guid.as_ptr(), library.resources.as_ptr());
    let (visible, logging) = (FALSE, Boolean::from(logging_on));
    // SAFETY: the strings and the callbacks outlive the call, and `Instance` keeps the callbacks as long as the component.
    unsafe {
        (library.functions.instantiate)(name.as_ptr(), CO_SIMULATION, guid, resources, callbacks, visible, logging)
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        self.rest.warnings.unrepeated();
        if self.rest.library.is_dead() {
            return;
        }
        let note = self.rest.note.clone();
        let (now, doing) = (note.at(note.tick(), f64::NAN), Doing::Call(Call::FreeInstance));
        // SAFETY: the component is this library's, and it is not used after this call.
        let free = || unsafe { (self.rest.functions.free_instance)(self.component) };
        let ((), changes) = now.call(self.index, doing, || preserved(free));
        if is_copy() {
            note.end_copy(now.tick, self.index, doing);
        }
        self.rest.warnings.changed(&now, doing, changes);
        self.rest.library.instances.fetch_sub(1, Ordering::AcqRel);
    }
}
