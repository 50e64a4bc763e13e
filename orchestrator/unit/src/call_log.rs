//! `--log-fmi-calls`: logs each call of an instance, once before it is made and once after it has returned.
//!
//! An instance whose calls are logged gets a table of the functions below instead of the unit's, and a pointer to a
//! `Logged` as its component. Other instances keep the unit's functions, so that logging costs them nothing. A line
//! is written in two pieces, so that a call that never returns is in the log without a result:
//!
//! ```text
//! 0.005 s  fmi2SetReal(mean.x = 3.5, mean.y = 0) -> fmi2OK
//! ```

mod states;

use super::board::{Board, Note};
use super::library::{Functions, StateFunctions};
use super::variable_names::VariableNames;
use crate::time::seconds;
use fmi2::c::{
    Boolean, Component, FALSE, LAST_SUCCESSFUL_TIME, RawStatus, Status, StatusKind, Str, TERMINATED, TRUE,
    ValueReference,
};
use fmi2::calls::Call;
use fmi2::description::BaseType;
use std::ffi::CStr;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::slice;
use std::sync::Arc;

/// The largest number of bytes of a call log in one message.
pub const LONGEST_PIECE: usize = Board::LONGEST_MESSAGE / 16;

/// Receives pieces of lines.
pub type CallSink = Arc<dyn Fn(&str) + Send + Sync>;

/// Where and how the calls of one instance are logged.
pub struct CallLog {
    /// Receives the log.
    pub sink: CallSink,
    /// The communication step, to compute the time from the tick.
    pub step_ns: u64,
}

/// Writes the log of the calls of one instance.
pub(super) struct CallWriter {
    pub log: CallLog,
    pub note: Note,
    pub names: Arc<VariableNames>,
}

/// What the functions below get as their component: the unit's functions and component, and the log.
struct Logged {
    writer: CallWriter,
    functions: Functions,
    states: Result<StateFunctions, Call>,
    component: Component,
}

/// A unit's functions and its handle of an instance.
#[derive(Clone, Copy)]
pub(super) struct Calls {
    pub functions: Functions,
    pub states: Result<StateFunctions, Call>,
    pub component: Component,
}

impl CallWriter {
    /// Writes that a call begins.
    pub fn begin(&self, call: Call, arguments: impl FnOnce() -> String) {
        let time_s = seconds(self.note.tick(), self.log.step_ns);
        self.write(|| format!("{} s  {}({})", shortest_decimal(time_s), call.name(), arguments()));
    }

    /// Writes the result of the call.
    pub fn end(&self, result: impl FnOnce() -> String) {
        self.write(|| format!(" -> {}\n", result()));
    }

    fn write(&self, piece: impl FnOnce() -> String) {
        // A panic must not unwind through the `extern "C"` functions below. The panic hook has reported it already.
        let _ = catch_unwind(AssertUnwindSafe(|| (self.log.sink)(&piece())));
    }

    /// The functions and the component by which the instance is to call its unit, until the instance is freed.
    pub fn interpose(self, unit: Calls) -> Calls {
        let Calls { functions, states, component } = unit;
        let logged = Box::into_raw(Box::new(Logged { writer: self, functions, states, component }));
        let table = Functions {
            free_instance,
            setup_experiment,
            enter_initialization_mode,
            exit_initialization_mode,
            terminate,
            get_real,
            get_integer,
            get_boolean,
            get_string,
            set_real,
            set_integer,
            set_boolean,
            set_string,
            do_step,
            // Only tests of a unit reset it, and they log no calls.
            reset: None,
            get_real_status: functions.get_real_status.and(Some(get_real_status)),
            get_boolean_status: functions.get_boolean_status.and(Some(get_boolean_status)),
            ..functions
        };
        Calls { functions: table, states: states.map(|_| states::TABLE), component: logged.cast() }
    }
}

impl Logged {
    /// # Safety
    /// The component is one that [`CallWriter::interpose`] made, and its instance is not freed.
    unsafe fn of<'a>(component: Component) -> &'a Self {
        // SAFETY: guaranteed by the caller: the component points to a `Logged` that `free_instance` has not freed yet.
        unsafe { &*component.cast() }
    }

    /// Makes a call and logs it; `results` gives the values that it returned if it succeeded.
    fn call(
        &self,
        call: Call,
        arguments: impl FnOnce() -> String,
        foreign: impl FnOnce(&Functions, Component) -> RawStatus,
        results: impl FnOnce() -> String,
    ) -> RawStatus {
        self.writer.begin(call, arguments);
        let status = foreign(&self.functions, self.component);
        self.writer.end(|| match Status::from_raw(status) {
            Some(known @ (Status::Ok | Status::Warning)) => [known.name(), &results()].concat(),
            Some(known) => known.name().to_owned(),
            None => format!("{status}, which is no status of FMI 2.0"),
        });
        status
    }

    fn name(&self, base_type: BaseType, reference: ValueReference) -> &str {
        self.writer.names.get(base_type, reference).unwrap_or("a variable that the description does not have")
    }

    /// `mean.x, mean.y`
    fn names(&self, base_type: BaseType, references: &[ValueReference]) -> String {
        let names: Vec<_> = references.iter().map(|&reference| self.name(base_type, reference)).collect();
        names.join(", ")
    }

    /// `mean.x = 3.5, mean.y = 0`
    ///
    /// # Safety
    /// `text` may be called with each of the values.
    unsafe fn values<T: Copy>(
        &self,
        base_type: BaseType,
        references: &[ValueReference],
        values: &[T],
        text: unsafe fn(T) -> String,
    ) -> String {
        let pair = |(&reference, &value): (&ValueReference, &T)| {
            // SAFETY: guaranteed by the caller.
            format!("{} = {}", self.name(base_type, reference), unsafe { text(value) })
        };
        references.iter().zip(values).map(pair).collect::<Vec<_>>().join(", ")
    }
}

/// `fmi2GetXXX` and `fmi2SetXXX` of one base type.
macro_rules! accessors {
    ($value:ty, $base_type:ident, $text:expr, $get:ident = $get_call:ident, $set:ident = $set_call:ident) => {
        unsafe extern "C-unwind" fn $get(
            component: Component,
            references: *const ValueReference,
            count: usize,
            values: *mut $value,
        ) -> RawStatus {
            // SAFETY: `Instance` calls with its own component and with slices of `count` elements.
            let (logged, read) = unsafe { (Logged::of(component), slice::from_raw_parts(references, count)) };
            // SAFETY: the arguments are passed on unchanged, with the unit's own component.
            let call = |functions: &Functions, unit| unsafe { (functions.$get)(unit, references, count, values) };
            logged.call(
                Call::$get_call,
                || logged.names(BaseType::$base_type, read),
                call,
                || {
                    // SAFETY: `values` has `count` elements, which the unit has written.
                    let texts = unsafe {
                        logged.values(BaseType::$base_type, read, slice::from_raw_parts(values, count), $text)
                    };
                    format!(", {texts}")
                },
            )
        }

        unsafe extern "C-unwind" fn $set(
            component: Component,
            references: *const ValueReference,
            count: usize,
            values: *const $value,
        ) -> RawStatus {
            // SAFETY: `Instance` calls with its own component and with slices of `count` elements.
            let (logged, read) = unsafe { (Logged::of(component), slice::from_raw_parts(references, count)) };
            let arguments = || {
                // SAFETY: `values` has `count` elements, which belong to `Instance`.
                unsafe { logged.values(BaseType::$base_type, read, slice::from_raw_parts(values, count), $text) }
            };
            // SAFETY: the arguments are passed on unchanged, with the unit's own component.
            let call = |functions: &Functions, unit| unsafe { (functions.$set)(unit, references, count, values) };
            logged.call(Call::$set_call, arguments, call, String::new)
        }
    };
}

accessors!(f64, Real, shortest_decimal, get_real = GetReal, set_real = SetReal);
accessors!(i32, Integer, |value| value.to_string(), get_integer = GetInteger, set_integer = SetInteger);
accessors!(Boolean, Boolean, boolean, get_boolean = GetBoolean, set_boolean = SetBoolean);
accessors!(Str, String, string, get_string = GetString, set_string = SetString);

/// Any number other than zero is true; a number other than one is shown.
fn boolean(value: Boolean) -> String {
    match value {
        FALSE => "fmi2False".to_owned(),
        TRUE => "fmi2True".to_owned(),
        other => format!("{other} (fmi2True)"),
    }
}

/// # Safety
/// The text is NULL or ends in a zero byte.
unsafe fn string(text: Str) -> String {
    if text.is_null() {
        return "NULL".to_owned();
    }
    // SAFETY: guaranteed by the caller.
    format!("{:?}", unsafe { CStr::from_ptr(text) }.to_string_lossy())
}

/// A function whose only argument is the instance.
macro_rules! plain {
    ($function:ident = $call:ident) => {
        unsafe extern "C-unwind" fn $function(component: Component) -> RawStatus {
            // SAFETY: `Instance` calls with its own component.
            let logged = unsafe { Logged::of(component) };
            // SAFETY: the unit gets its own component.
            let call = |functions: &Functions, unit| unsafe { (functions.$function)(unit) };
            logged.call(Call::$call, String::new, call, String::new)
        }
    };
}

plain!(enter_initialization_mode = EnterInitializationMode);
plain!(exit_initialization_mode = ExitInitializationMode);
plain!(terminate = Terminate);

unsafe extern "C-unwind" fn setup_experiment(
    component: Component,
    with_tolerance: Boolean,
    tolerance: f64,
    start_s: f64,
    with_stop: Boolean,
    stop_s: f64,
) -> RawStatus {
    // SAFETY: `Instance` calls with its own component.
    let logged = unsafe { Logged::of(component) };
    let call = |functions: &Functions, unit| {
        // SAFETY: the unit gets its own component and plain numbers.
        unsafe { (functions.setup_experiment)(unit, with_tolerance, tolerance, start_s, with_stop, stop_s) }
    };
    let arguments = || {
        let [tolerance, start, stop] = [tolerance, start_s, stop_s].map(shortest_decimal);
        let [with_tolerance, with_stop] = [with_tolerance, with_stop].map(boolean);
        format!(
            "toleranceDefined = {with_tolerance}, tolerance = {tolerance}, startTime = {start}, \
             stopTimeDefined = {with_stop}, stopTime = {stop}"
        )
    };
    logged.call(Call::SetupExperiment, arguments, call, String::new)
}

unsafe extern "C-unwind" fn do_step(component: Component, time_s: f64, step_s: f64, no_way_back: Boolean) -> RawStatus {
    // SAFETY: `Instance` calls with its own component.
    let logged = unsafe { Logged::of(component) };
    // SAFETY: the unit gets its own component and plain numbers.
    let call = |functions: &Functions, unit| unsafe { (functions.do_step)(unit, time_s, step_s, no_way_back) };
    let arguments = || {
        let ([time, step], no_way_back) = ([time_s, step_s].map(shortest_decimal), boolean(no_way_back));
        format!(
            "currentCommunicationPoint = {time}, communicationStepSize = {step}, \
             noSetFMUStatePriorToCurrentPoint = {no_way_back}"
        )
    };
    logged.call(Call::DoStep, arguments, call, String::new)
}

/// A status function, which is called after a discarded step.
macro_rules! status {
    ($function:ident = $call:ident, $value:ty, $text:expr) => {
        unsafe extern "C-unwind" fn $function(component: Component, kind: StatusKind, value: *mut $value) -> RawStatus {
            // SAFETY: `Instance` calls with its own component.
            let logged = unsafe { Logged::of(component) };
            let call = |functions: &Functions, unit| match functions.$function {
                // SAFETY: the arguments are passed on unchanged, with the unit's own component.
                Some(function) => unsafe { function(unit, kind, value) },
                None => unreachable!("only what the unit has is in the table"),
            };
            // SAFETY: `Instance` passes a pointer to an initialized value.
            logged.call(Call::$call, || kind_name(kind), call, || format!(", {}", $text(unsafe { *value })))
        }
    };
}

status!(get_real_status = GetRealStatus, f64, shortest_decimal);
status!(get_boolean_status = GetBooleanStatus, Boolean, boolean);

fn kind_name(kind: StatusKind) -> String {
    match kind {
        LAST_SUCCESSFUL_TIME => "fmi2LastSuccessfulTime".to_owned(),
        TERMINATED => "fmi2Terminated".to_owned(),
        other => other.to_string(),
    }
}

unsafe extern "C-unwind" fn free_instance(component: Component) {
    // SAFETY: `interpose` made the component from a box, and `Instance` calls this once, as its last call.
    let logged = unsafe { Box::<Logged>::from_raw(component.cast()) };
    logged.writer.begin(Call::FreeInstance, String::new);
    // SAFETY: the unit gets its own component, for the last time.
    unsafe { (logged.functions.free_instance)(logged.component) };
    logged.writer.end(|| "returned".to_owned());
}

/// The shortest decimal that reads back to the same number, without `.0`.
fn shortest_decimal(value: f64) -> String {
    let mut buffer = zmij::Buffer::new();
    let text = buffer.format(value);
    text.strip_suffix(".0").unwrap_or(text).to_owned()
}
