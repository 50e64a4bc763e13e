//! Messages to the importer: the enabled categories, and the call of its logger.
#![allow(unsafe_code, reason = "the importer's logger is a C function")]

use fmi2::c::{CallbackLogger, ComponentEnvironment, Status};
use std::ffi::{CStr, CString};

/// The log categories of the standard that units use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Category {
    /// Messages of the unit about its events; off by default.
    Events = 1,
    /// Why a call returned `fmi2Warning`; on by default.
    StatusWarning = 2,
    /// Why a call returned `fmi2Discard`; always on.
    StatusDiscard = 4,
    /// Why a call returned `fmi2Error`; always on.
    StatusError = 8,
    /// Represents all others in `fmi2SetDebugLogging`.
    All = 15,
}

impl Category {
    pub(crate) const ALL: [Self; 5] =
        [Self::Events, Self::StatusWarning, Self::StatusDiscard, Self::StatusError, Self::All];
    /// The categories that cannot be turned off, because a failed call must log its reason.
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

/// The destination of an instance's messages.
#[derive(Debug)]
pub(crate) struct Log {
    logger: CallbackLogger,
    environment: ComponentEnvironment,
    /// A copy of the instance name, because importers may free theirs after `fmi2Instantiate`.
    instance: CString,
    wanted: u8,
}

impl Log {
    /// # Safety
    ///
    /// The logger may be called with this environment as long as the log lives.
    pub(crate) unsafe fn new(logger: CallbackLogger, environment: ComponentEnvironment, instance: CString) -> Self {
        Self { logger, environment, instance, wanted: Category::ALWAYS | Category::StatusWarning as u8 }
    }

    pub(crate) fn wants_events(&self) -> bool {
        self.wanted & Category::Events as u8 != 0
    }

    /// Turns all categories on, or off except those that are always on.
    pub(crate) fn want_all(&mut self, on: bool) {
        self.want(Category::All, on);
    }

    /// Turns a category on, or off unless it is always on.
    pub(crate) fn want(&mut self, category: Category, on: bool) {
        let others = self.wanted & !(category as u8);
        self.wanted = Category::ALWAYS | if on { others | category as u8 } else { others };
    }

    /// Sends a message in the category of its status, if that is enabled.
    pub(crate) fn send(&self, status: Status, message: &str) {
        let category = Category::of(status);
        if self.wanted & category as u8 == 0 {
            return;
        }
        // The logger takes a printf format in which `#` begins a variable reference; the message is plain text.
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
