//! The life of an instance, from `fmi2Instantiate` to `fmi2FreeInstance`.

use super::{Instance, Rest, StatusLog, Strings};
use crate::board::{Note, Now};
use crate::call_log::{CallLog, CallWriter, Calls};
use crate::failure::{Cause, Doing, Failure};
use crate::library::{Functions, Library, preserved};
use crate::logger::{Environment, LOGGER, LogSink, Registration};
use fmi2::c::{Boolean, CO_SIMULATION, CallbackFunctions, Component, FALSE};
use fmi2::calls::Call;
use std::ffi::{CStr, CString};
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
        let c_name = CString::new(name)
            .map_err(|_| failure(Cause::Other("the instance's name holds a zero character".to_owned())))?;
        if library.only_once && library.instances.load(Ordering::Acquire) > 0 {
            let text = "the unit can be instantiated only once per process (canBeInstantiatedOnlyOncePerProcess)";
            return Err(failure(Cause::Other(text.to_owned())));
        }
        let registration = Registration::new(Environment {
            instance: index,
            name: name.to_owned(),
            note: note.clone(),
            names: Arc::clone(&library.names),
            sink: Arc::clone(&sink),
        });
        let callbacks = callbacks(&registration);
        let call_writer = calls.map(|log| CallWriter { log, note: note.clone(), names: Arc::clone(&library.names) });
        let now = note.at(0, 0.0);
        now.enter(index, Doing::Call(Call::Instantiate));
        if let Some(call_writer) = &call_writer {
            call_writer.begin(Call::Instantiate, || format!("{name:?}, loggingOn = {logging_on}"));
        }
        let component = call_instantiate(library, &c_name, &callbacks, logging_on);
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
            status_log: StatusLog { sink, warned: false },
            strings: Strings::default(),
        };
        Ok(Self { component, index, set_real, do_step, get_real, rest: Box::new(rest) })
    }

    /// Sets the start time. Stop time and tolerance are left undefined.
    ///
    /// # Errors
    /// The unit returns neither `fmi2OK` nor `fmi2Warning`.
    pub fn setup_experiment(&mut self, start: &Now<'_>) -> Result<(), Failure> {
        self.checked(start, Call::SetupExperiment, |functions, component| {
            // SAFETY: the component is this library's, and the other arguments are plain numbers.
            unsafe { (functions.setup_experiment)(component, FALSE, 0.0, start.time_s, FALSE, 0.0) }
        })
    }

    /// Enters initialization mode.
    ///
    /// # Errors
    /// The unit returns neither `fmi2OK` nor `fmi2Warning`.
    pub fn enter_initialization_mode(&mut self, now: &Now<'_>) -> Result<(), Failure> {
        self.checked(now, Call::EnterInitializationMode, |functions, component| {
            // SAFETY: the component is this library's.
            unsafe { (functions.enter_initialization_mode)(component) }
        })
    }

    /// Exits initialization mode.
    ///
    /// # Errors
    /// The unit returns neither `fmi2OK` nor `fmi2Warning`.
    pub fn exit_initialization_mode(&mut self, now: &Now<'_>) -> Result<(), Failure> {
        self.checked(now, Call::ExitInitializationMode, |functions, component| {
            // SAFETY: the component is this library's.
            unsafe { (functions.exit_initialization_mode)(component) }
        })
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
        self.checked(now, Call::Reset, |_, component| {
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
        self.checked(now, Call::Terminate, |functions, component| {
            // SAFETY: the component is this library's.
            unsafe { (functions.terminate)(component) }
        })
    }

    /// Frees the instance; the same as dropping it.
    pub fn free(self) {}
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
    preserved(|| {
        // SAFETY: the strings and the callbacks outlive the call, and `Instance` keeps the callbacks as long as the
        // component.
        unsafe {
            (library.functions.instantiate)(name.as_ptr(), CO_SIMULATION, guid, resources, callbacks, visible, logging)
        }
    })
}

impl Drop for Instance {
    fn drop(&mut self) {
        if self.rest.library.is_dead() {
            return;
        }
        let now = self.rest.note.at(self.rest.note.tick(), f64::NAN);
        now.enter(self.index, Doing::Call(Call::FreeInstance));
        // SAFETY: the component is this library's, and it is not used after this call.
        unsafe { (self.rest.functions.free_instance)(self.component) };
        self.rest.library.instances.fetch_sub(1, Ordering::AcqRel);
    }
}
