//! A minimal importer for tests: an instance of the probe with its log.

use crate::probe::{exported as fmi, guid};
use fmi2::c::{CallbackFunctions, CallbackLogger, RawStatus};
use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr::null_mut;
use std::sync::Mutex;

pub const OK: i32 = 0;
pub const WARNING: i32 = 1;
pub const DISCARD: i32 = 2;
pub const ERROR: i32 = 3;

/// A message of the unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    pub instance: String,
    pub status: RawStatus,
    pub category: String,
    pub text: String,
}

type Messages = Mutex<Vec<Message>>;

/// An instance that frees itself.
pub struct Importer {
    pub component: *mut c_void,
    messages: Box<Messages>,
}

unsafe extern "C" fn log(
    environment: *mut c_void,
    instance: *const c_char,
    status: RawStatus,
    category: *const c_char,
    text: *const c_char,
) {
    // SAFETY: the environment is that of `callbacks`; the strings are the unit's.
    let (messages, [instance, category, text]) = unsafe {
        let read = |text: *const c_char| CStr::from_ptr(text).to_str().expect("UTF-8").to_owned();
        (&*environment.cast::<Messages>(), [instance, category, text].map(read))
    };
    messages.lock().expect("no panic").push(Message { instance, status, category, text });
}

pub fn callbacks(messages: &Messages) -> CallbackFunctions {
    // SAFETY: the unit passes no arguments after the format, so that both function types have the same calling
    // convention on every platform we build for.
    let logger = unsafe {
        std::mem::transmute::<
            unsafe extern "C" fn(*mut c_void, *const c_char, RawStatus, *const c_char, *const c_char),
            CallbackLogger,
        >(log)
    };
    CallbackFunctions {
        logger: Some(logger),
        allocate_memory: None,
        free_memory: None,
        step_finished: None,
        component_environment: std::ptr::from_ref(messages).cast_mut().cast(),
    }
}

/// The arguments of `fmi2Instantiate`.
pub struct Request<'a> {
    pub name: Option<&'a CStr>,
    pub kind: i32,
    pub guid: Option<&'a CStr>,
    pub logging_on: i32,
}

impl Importer {
    pub fn new() -> Self {
        Self::with_logging(0)
    }

    pub fn with_logging(logging_on: i32) -> Self {
        let guid = CString::new(guid()).expect("no zero");
        let request = Request { name: Some(c"one"), kind: 1, guid: Some(&guid), logging_on };
        let (importer, messages) = Self::request(&request);
        importer.unwrap_or_else(|| panic!("not instantiated: {messages:?}"))
    }

    /// The instance, if there is one, and the messages of the unit.
    pub fn request(request: &Request) -> (Option<Self>, Vec<Message>) {
        let messages = Box::new(Messages::default());
        let callbacks = callbacks(&messages);
        let pointer = |text: Option<&CStr>| text.map_or(std::ptr::null(), CStr::as_ptr);
        // SAFETY: strings and callbacks live until the call returns, the messages as long as the instance.
        let component = unsafe {
            let (name, guid) = (pointer(request.name), pointer(request.guid));
            fmi::fmi2Instantiate(
                name,
                request.kind,
                guid,
                std::ptr::null(),
                &raw const callbacks,
                0,
                request.logging_on,
            )
        };
        let importer = Self { component, messages };
        let messages = importer.messages();
        ((!component.is_null()).then_some(importer), messages)
    }

    /// The messages of the unit since the last call.
    pub fn messages(&self) -> Vec<Message> {
        std::mem::take(&mut *self.messages.lock().expect("no panic"))
    }

    /// The text of the only message since the last call.
    pub fn only_message(&self) -> String {
        let messages = self.messages();
        assert_eq!(messages.len(), 1, "{messages:?}");
        messages[0].text.clone()
    }

    pub fn set_up(&self, start_s: f64, stop_s: Option<f64>) -> i32 {
        let stop_defined = i32::from(stop_s.is_some());
        // SAFETY: a live component.
        unsafe { fmi::fmi2SetupExperiment(self.component, 0, 0.0, start_s, stop_defined, stop_s.unwrap_or(f64::NAN)) }
    }

    pub fn enter(&self) -> i32 {
        // SAFETY: a live component.
        unsafe { fmi::fmi2EnterInitializationMode(self.component) }
    }

    pub fn exit(&self) -> i32 {
        // SAFETY: a live component.
        unsafe { fmi::fmi2ExitInitializationMode(self.component) }
    }

    /// The instance, ready for the first step.
    pub fn started(self) -> Self {
        assert_eq!((self.set_up(0.0, None), self.enter(), self.exit()), (OK, OK, OK));
        self
    }

    pub fn step(&self, point_s: f64, length_s: f64) -> i32 {
        // SAFETY: a live component.
        unsafe { fmi::fmi2DoStep(self.component, point_s, length_s, 1) }
    }

    pub fn reset(&self) -> i32 {
        // SAFETY: a live component.
        unsafe { fmi::fmi2Reset(self.component) }
    }

    pub fn terminate(&self) -> i32 {
        // SAFETY: a live component.
        unsafe { fmi::fmi2Terminate(self.component) }
    }

    pub fn set_real(&self, port: u32, value: f64) -> i32 {
        // SAFETY: a live component, one value.
        unsafe { fmi::fmi2SetReal(self.component, &raw const port, 1, &raw const value) }
    }

    pub fn real(&self, port: u32) -> f64 {
        let mut value = f64::NAN;
        // SAFETY: a live component, one value.
        assert!(unsafe { fmi::fmi2GetReal(self.component, &raw const port, 1, &raw mut value) } <= WARNING);
        value
    }

    pub fn set_integer(&self, port: u32, value: i32) -> i32 {
        // SAFETY: a live component, one value.
        unsafe { fmi::fmi2SetInteger(self.component, &raw const port, 1, &raw const value) }
    }

    pub fn integer(&self, port: u32) -> i32 {
        let mut value = i32::MIN;
        // SAFETY: a live component, one value.
        assert!(unsafe { fmi::fmi2GetInteger(self.component, &raw const port, 1, &raw mut value) } <= WARNING);
        value
    }

    pub fn save(&self, handle: &mut *mut c_void) -> i32 {
        // SAFETY: a live component, a valid pointer to the handle.
        unsafe { fmi::fmi2GetFMUstate(self.component, handle) }
    }

    pub fn saved(&self) -> *mut c_void {
        let mut handle = null_mut();
        assert_eq!(self.save(&mut handle), OK);
        handle
    }

    pub fn restore(&self, handle: *mut c_void) -> i32 {
        // SAFETY: a live component; the unit does not dereference unknown handles.
        unsafe { fmi::fmi2SetFMUstate(self.component, handle) }
    }

    pub fn free_state(&self, handle: &mut *mut c_void) -> i32 {
        // SAFETY: a live component, a valid pointer to the handle.
        unsafe { fmi::fmi2FreeFMUstate(self.component, handle) }
    }

    pub fn written(&self, handle: *mut c_void) -> Vec<u8> {
        let mut size = 0;
        // SAFETY: a live component, a buffer of the size that it returned.
        unsafe {
            assert_eq!(fmi::fmi2SerializedFMUstateSize(self.component, handle, &raw mut size), OK);
            let mut bytes = vec![0; size];
            assert_eq!(fmi::fmi2SerializeFMUstate(self.component, handle, bytes.as_mut_ptr().cast(), size), OK);
            bytes
        }
    }

    pub fn read(&self, bytes: &[u8], handle: &mut *mut c_void) -> i32 {
        // SAFETY: a live component, the bytes, a valid pointer to the handle.
        unsafe { fmi::fmi2DeSerializeFMUstate(self.component, bytes.as_ptr().cast(), bytes.len(), handle) }
    }
}

impl Drop for Importer {
    fn drop(&mut self) {
        // SAFETY: a live component, freed once; null is ignored.
        unsafe { fmi::fmi2FreeInstance(self.component) };
    }
}
