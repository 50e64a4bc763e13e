//! Messages to the importer: which categories go out, and the call of its logger.
#![allow(unsafe_code, reason = "the importer's logger is a C function")]

use fmi2::c::{CallbackLogger, ComponentEnvironment, Status};
use std::ffi::{CStr, CString};

/// The log categories of the standard that units use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Category {
    /// What the unit tells about its events; off until it is asked for.
    Events = 1,
    /// Why a call answered `fmi2Warning`; on until it is turned off.
    StatusWarning = 2,
    /// Why a call answered `fmi2Discard`; always on.
    StatusDiscard = 4,
    /// Why a call answered `fmi2Error`; always on.
    StatusError = 8,
    /// Stands for all others in `fmi2SetDebugLogging`.
    All = 15,
}

impl Category {
    pub(crate) const ALL: [Self; 5] =
        [Self::Events, Self::StatusWarning, Self::StatusDiscard, Self::StatusError, Self::All];
    /// Those that no one can turn off: a call that fails says why.
    const ALWAYS: u8 = Self::StatusDiscard as u8 | Self::StatusError as u8;

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Events => "logEvents",
            Self::StatusWarning => "logStatusWarning",
            Self::StatusDiscard => "logStatusDiscard",
            Self::StatusError => "logStatusError",
            Self::All => "logAll",
        }
    }

    fn c_name(self) -> &'static CStr {
        match self {
            Self::Events => c"logEvents",
            Self::StatusWarning => c"logStatusWarning",
            Self::StatusDiscard => c"logStatusDiscard",
            Self::StatusError => c"logStatusError",
            Self::All => c"logAll",
        }
    }

    /// The category that goes with a status.
    fn of(status: Status) -> Self {
        match status {
            Status::Ok | Status::Pending => Self::Events,
            Status::Warning => Self::StatusWarning,
            Status::Discard => Self::StatusDiscard,
            Status::Error | Status::Fatal => Self::StatusError,
        }
    }
}

/// Where an instance sends its messages.
#[derive(Debug)]
pub(crate) struct Log {
    logger: CallbackLogger,
    environment: ComponentEnvironment,
    /// The instance's own copy: importers drop theirs after `fmi2Instantiate`.
    instance: CString,
    wanted: u8,
}

impl Log {
    /// # Safety
    ///
    /// The logger is the importer's and may be called with this environment as long as the log lives.
    pub(crate) unsafe fn new(logger: CallbackLogger, environment: ComponentEnvironment, instance: CString) -> Self {
        Self { logger, environment, instance, wanted: Category::ALWAYS | Category::StatusWarning as u8 }
    }

    pub(crate) fn wants_events(&self) -> bool {
        self.wanted & Category::Events as u8 != 0
    }

    /// Turns all categories on or off, as far as they can be.
    pub(crate) fn want_all(&mut self, on: bool) {
        self.want(Category::All, on);
    }

    /// Turns a category on or off, as far as it can be.
    pub(crate) fn want(&mut self, category: Category, on: bool) {
        let others = self.wanted & !(category as u8);
        self.wanted = Category::ALWAYS | if on { others | category as u8 } else { others };
    }

    /// Sends a message under the category of its status, if that is wanted.
    pub(crate) fn send(&self, status: Status, message: &str) {
        let category = Category::of(status);
        if self.wanted & category as u8 == 0 {
            return;
        }
        // The logger takes a printf format in which `#` begins a variable reference; we send ready text.
        let text = message.replace('\0', "").replace('%', "%%").replace('#', "##");
        let Ok(text) = CString::new(text) else { unreachable!("all zero bytes were taken out") };
        // SAFETY: promised at `new`; the strings live until the logger returns, and the format asks for no arguments.
        unsafe {
            (self.logger)(
                self.environment,
                self.instance.as_ptr(),
                status as i32,
                category.c_name().as_ptr(),
                text.as_ptr(),
            );
        }
    }
}
