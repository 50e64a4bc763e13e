//! From `fmi2Instantiate` to `fmi2FreeInstance`.

use super::{Instance, LogTap, Rest, Strings};
use crate::board::{Note, Now};
use crate::call_log::{CallLog, Calls, Teller};
use crate::failure::{Cause, Doing, Failure};
use crate::library::{Functions, Library, preserved};
use crate::logger::{Environment, LOGGER, LogSink, Registration};
use fmi2::c::{Boolean, CO_SIMULATION, CallbackFunctions, Component, FALSE};
use fmi2::calls::Call;
use std::ffi::{CStr, CString};
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// What an instance is and whom it reports to.
pub struct Setting<'a> {
    /// The name in the script.
    pub name: &'a str,
    /// The index in the scenario.
    pub index: usize,
    /// The note of the thread that calls it.
    pub note: Note,
    /// Where its messages go.
    pub sink: LogSink,
    /// Whether the unit should tell everything, not only what is wrong.
    pub logging_on: bool,
    /// Where its calls are told, if they are.
    pub calls: Option<CallLog>,
}

impl Instance {
    /// Makes an instance.
    ///
    /// # Errors
    /// The unit makes none, or may be instantiated only once in a process and was.
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
            let text = "the unit can be instantiated only once in a process (canBeInstantiatedOnlyOncePerProcess)";
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
        let teller = calls.map(|log| Teller { log, note: note.clone(), names: Arc::clone(&library.names) });
        let now = note.at(0, 0.0);
        now.enter(index, Doing::Call(Call::Instantiate));
        if let Some(teller) = &teller {
            teller.begin(Call::Instantiate, || format!("{name:?}, loggingOn = {logging_on}"));
        }
        let component = call_instantiate(library, &c_name, &callbacks, logging_on);
        if let Some(teller) = &teller {
            teller.end(|| if component.is_null() { "NULL" } else { "an instance" }.to_owned());
        }
        drop(now);
        if component.is_null() {
            return Err(failure(Cause::NoInstance));
        }
        library.instances.fetch_add(1, Ordering::AcqRel);
        let unit = Calls { functions: library.functions, states: library.states, component };
        let Calls { functions, states, component } = teller.map_or(unit, |teller| teller.interpose(unit));
        let Functions { set_real, do_step, get_real, .. } = functions;
        let rest = Rest {
            functions,
            states,
            note,
            name: name.to_owned(),
            library: Arc::clone(library),
            _callbacks: callbacks,
            _registration: registration,
            log: LogTap { sink, warned: false },
            strings: Strings::default(),
        };
        Ok(Self { component, index, set_real, do_step, get_real, rest: Box::new(rest) })
    }

    /// Says when the run begins. Its end and a tolerance stay open.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn setup_experiment(&mut self, start: &Now<'_>) -> Result<(), Failure> {
        self.checked(start, Call::SetupExperiment, |functions, component| {
            // SAFETY: plain numbers.
            unsafe { (functions.setup_experiment)(component, FALSE, 0.0, start.time_s, FALSE, 0.0) }
        })
    }

    /// Begins initialization.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn enter_initialization_mode(&mut self, now: &Now<'_>) -> Result<(), Failure> {
        self.checked(now, Call::EnterInitializationMode, |functions, component| {
            // SAFETY: the component is this library's.
            unsafe { (functions.enter_initialization_mode)(component) }
        })
    }

    /// Ends initialization.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn exit_initialization_mode(&mut self, now: &Now<'_>) -> Result<(), Failure> {
        self.checked(now, Call::ExitInitializationMode, |functions, component| {
            // SAFETY: the component is this library's.
            unsafe { (functions.exit_initialization_mode)(component) }
        })
    }

    /// Ends the run for this instance. After a `fmi2Fatal` of any instance of its library nothing is called.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn terminate(&mut self, now: &Now<'_>) -> Result<(), Failure> {
        if self.rest.library.is_dead() {
            return Ok(());
        }
        self.checked(now, Call::Terminate, |functions, component| {
            // SAFETY: the component is this library's.
            unsafe { (functions.terminate)(component) }
        })
    }

    /// Frees the instance, as dropping it does.
    pub fn free(self) {}
}

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
        // SAFETY: the texts and the callbacks outlive the call, and whoever keeps the instance keeps the callbacks.
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
        // SAFETY: the component is this library's, and nobody has it after this.
        unsafe { (self.rest.functions.free_instance)(self.component) };
        self.rest.library.instances.fetch_sub(1, Ordering::AcqRel);
    }
}
