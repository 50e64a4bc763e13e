//! One instance: its state in the state machine, and the calls that change it.

use crate::body::Body;
use crate::library::Library;
use crate::log::Log;
use crate::model::{Context, Outcome};
use crate::refusal::Refusal;
use crate::saved::Saved;
use crate::step::{Step, Time};
use fmi2::c::Status;
use fmi2::calls::{self, Call, Permission, State};
use std::any::Any;
use std::ffi::CString;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Tolerances, relative to the time and to the step length, for the distance of a step's start from the end of the
/// previous step.
const TIME_TOLERANCE: f64 = 1e-9;
const STEP_TOLERANCE: f64 = 1e-6;

/// One instance of a unit.
pub(crate) struct Instance {
    pub(crate) library: &'static Library,
    pub(crate) log: Log,
    pub(crate) body: Body,
    pub(crate) progress: Progress,
    /// Set after a panic, when the state of the unit may be inconsistent.
    poisoned: bool,
    #[expect(clippy::vec_box, reason = "the address of a saved state is its handle")]
    pub(crate) saved: Vec<Box<Saved>>,
    /// The C text of each String, valid until the next get of the same String.
    pub(crate) texts: Vec<CString>,
}

/// The part of a saved state outside the unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Progress {
    pub(crate) state: State,
    /// Start and stop time, once the experiment is set up.
    pub(crate) experiment: Option<(f64, Option<f64>)>,
    pub(crate) now: Time,
    /// Whether the unit has terminated.
    pub(crate) ended: bool,
    /// Whether a value was set that the outputs do not reflect yet.
    pub(crate) stale: bool,
}

impl Progress {
    const AT_START: Self =
        Self { state: State::Instantiated, experiment: None, now: Time::Nanoseconds(0), ended: false, stale: false };
}

impl Instance {
    pub(crate) fn new(library: &'static Library, body: Body, log: Log) -> Self {
        let texts = vec![CString::default(); body.slots().strings.len()];
        Self { library, log, body, progress: Progress::AT_START, poisoned: false, saved: Vec::new(), texts }
    }

    /// Makes one call: checks the state table, catches panics, logs errors, and enters the next state.
    pub(crate) fn call(&mut self, call: Call, work: impl FnOnce(&mut Self) -> Result<Status, Refusal>) -> Status {
        let permission = self.permission(call);
        let answer = match permission {
            Permission::No => Err(self.why_not()),
            _ => catch_unwind(AssertUnwindSafe(|| work(self))).unwrap_or_else(|panic| Err(self.poison(&*panic))),
        };
        let status = match answer {
            Ok(status) if permission == Permission::WithWarning => status.max(self.warn_of(call)),
            Ok(status) => status,
            Err(refusal) => {
                self.log.send(refusal.status(), &refusal.message(call));
                refusal.status()
            }
        };
        self.progress.state = calls::next(self.progress.state, call, status);
        status
    }

    #[inline]
    fn permission(&self, call: Call) -> Permission {
        let left_after_a_panic = matches!(
            call,
            Call::GetReal
                | Call::GetInteger
                | Call::GetBoolean
                | Call::GetString
                | Call::SetDebugLogging
                | Call::FreeFmuState
                | Call::Reset
                | Call::FreeInstance
        );
        if self.poisoned && !left_after_a_panic {
            return Permission::No;
        }
        self.body.described().permissions[self.progress.state as usize][call as usize]
    }

    fn why_not(&self) -> Refusal {
        if self.poisoned { Refusal::Poisoned } else { Refusal::NotAllowed { state: self.progress.state } }
    }

    fn poison(&mut self, panic: &(dyn Any + Send)) -> Refusal {
        self.poisoned = true;
        self.progress.stale = false;
        Refusal::Panic { text: panic_text(panic) }
    }

    fn warn_of(&self, call: Call) -> Status {
        let message =
            format!("{}: not allowed in state `{}`, done all the same", call.name(), self.progress.state.name());
        self.log.send(Status::Warning, &message);
        Status::Warning
    }

    /// `fmi2SetupExperiment`
    pub(crate) fn set_up(&mut self, start_s: f64, stop_s: Option<f64>) -> Result<Status, Refusal> {
        if self.progress.experiment.is_some() {
            return Err(Refusal::SetUpBefore);
        }
        // The comparison also rejects a stop time that is NaN.
        if !start_s.is_finite() || !stop_s.is_none_or(|stop_s| stop_s >= start_s) {
            return Err(Refusal::Experiment { start_s, stop_s });
        }
        self.progress.experiment = Some((start_s, stop_s));
        self.progress.now = Time::from_s(start_s);
        Ok(Status::Ok)
    }

    /// `fmi2EnterInitializationMode`
    pub(crate) fn enter_initialization(&mut self) -> Result<Status, Refusal> {
        self.progress.stale = true;
        if self.progress.experiment.is_some() {
            return Ok(Status::Ok);
        }
        self.progress.experiment = Some((0.0, None));
        self.log.send(Status::Warning, "the experiment was not set up: the run starts at 0 s");
        Ok(Status::Warning)
    }

    /// Updates the outputs after a set call.
    #[inline]
    pub(crate) fn refresh(&mut self) -> Result<Status, Refusal> {
        if self.progress.stale { self.update() } else { Ok(Status::Ok) }
    }

    fn update(&mut self) -> Result<Status, Refusal> {
        match self.progress.state {
            State::InitializationMode => self.initialize(),
            State::StepComplete | State::Terminated => {
                let time_s = self.progress.now.as_s();
                self.body.outputs(time_s).map_err(|fault| Refusal::Outputs { time_s, fault })?;
                self.progress.stale = false;
                Ok(Status::Ok)
            }
            _ => Ok(Status::Ok),
        }
    }

    fn initialize(&mut self) -> Result<Status, Refusal> {
        let mut context = self.context();
        let started = self.body.init(&mut context);
        let status = self.send_messages(context);
        started.map_err(|fault| Refusal::Start { fault })?;
        self.progress.stale = false;
        Ok(status)
    }

    /// `fmi2DoStep`
    pub(crate) fn step(&mut self, point_s: f64, length_s: f64) -> Result<Status, Refusal> {
        if !(length_s > 0.0 && length_s.is_finite()) {
            return Err(Refusal::StepLength { length_s });
        }
        let start = self.start_of_step(point_s, length_s)?;
        let length = Time::from_s(length_s);
        let step = Step::new(start, length);
        self.check_stop(&step)?;
        let mut context = self.context();
        self.progress.stale = false;
        let outcome = self.body.unit_mut().step(step, &mut context);
        let status = self.send_messages(context);
        let failed = |fault| Refusal::Step { start_s: step.start_s(), length_s, fault };
        let outcome = outcome.map_err(failed)?;
        let (start_s, end_s) = (step.start_s(), step.end_s());
        self.progress.now = match outcome {
            Outcome::Done => start.plus(length),
            Outcome::AcceptedUntil(found_s) | Outcome::Terminated(found_s) if (start_s..=end_s).contains(&found_s) => {
                Time::from_s(found_s)
            }
            Outcome::AcceptedUntil(found_s) | Outcome::Terminated(found_s) => {
                return Err(Refusal::OutsideStep { start_s, end_s, found_s });
            }
        };
        self.body.outputs(self.progress.now.as_s()).map_err(failed)?;
        match outcome {
            Outcome::Done => Ok(status),
            Outcome::AcceptedUntil(until_s) => Err(Refusal::Discarded { start_s, end_s, until_s }),
            Outcome::Terminated(at_s) => {
                self.progress.ended = true;
                Err(Refusal::Ended { at_s })
            }
        }
    }

    /// The start of the step: the unit's current time, if the importer's point agrees with it within the tolerance.
    fn start_of_step(&self, point_s: f64, length_s: f64) -> Result<Time, Refusal> {
        let expected_s = self.progress.now.as_s();
        let tolerance_s = TIME_TOLERANCE * expected_s.abs() + STEP_TOLERANCE * length_s;
        let distance_s = (point_s - expected_s).abs();
        if distance_s.is_nan() || distance_s > tolerance_s {
            return Err(Refusal::CommunicationPoint { expected_s, found_s: point_s });
        }
        Ok(match self.progress.now {
            Time::Nanoseconds(_) => self.progress.now,
            // The importer computes its points from a count of steps; a sum of lengths here would drift from them.
            Time::Seconds(_) => Time::from_s(point_s),
        })
    }

    fn check_stop(&self, step: &Step) -> Result<(), Refusal> {
        let Some((_, Some(stop_s))) = self.progress.experiment else { return Ok(()) };
        let tolerance_s = TIME_TOLERANCE * stop_s.abs() + STEP_TOLERANCE * step.length_s();
        let end_s = step.end_s();
        if end_s > stop_s + tolerance_s { Err(Refusal::BeyondStop { end_s, stop_s }) } else { Ok(()) }
    }

    /// `fmi2Reset`
    pub(crate) fn reset(&mut self) -> Result<Status, Refusal> {
        self.body = Body::new(self.library);
        self.progress = Progress::AT_START;
        self.poisoned = false;
        Ok(Status::Ok)
    }

    fn context(&self) -> Context {
        let start_s = self.progress.experiment.map_or(0.0, |(start_s, _)| start_s);
        Context { start_s, events_wanted: self.log.wants_events(), ..Context::default() }
    }

    /// Sends the messages of the model to the importer.
    fn send_messages(&self, context: Context) -> Status {
        for event in &context.events {
            self.log.send(Status::Ok, event);
        }
        for warning in &context.warnings {
            self.log.send(Status::Warning, warning);
        }
        if context.warnings.is_empty() { Status::Ok } else { Status::Warning }
    }
}

/// The message of a panic.
pub(crate) fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied().or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    text.unwrap_or("no reason given").to_owned()
}
