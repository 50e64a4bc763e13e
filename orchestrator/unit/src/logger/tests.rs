//! The logger as a unit in C calls it: with variable arguments, through the function pointer that units get.

use super::*;
use crate::board::{Board, BoardLayout, Note};
use crate::variable_names::VariableNames;
use std::ffi::{CString, c_void};
use std::ptr;
use std::sync::Mutex;

struct CapturedLog {
    registration: Registration,
    messages: Arc<Mutex<Vec<LogMessage>>>,
}

fn note() -> Note {
    Board::private(&BoardLayout { notes: 1, columns: 0, claims: 0 }).unwrap().note(0)
}

fn capture(name: &str) -> CapturedLog {
    let messages = Arc::new(Mutex::new(Vec::new()));
    let sink = Arc::clone(&messages);
    let registration = Registration::new(Environment {
        instance: 4,
        name: name.to_owned(),
        note: note(),
        names: Arc::new(VariableNames::default()),
        sink: Arc::new(move |message| sink.lock().unwrap().push(message)),
    });
    CapturedLog { registration, messages }
}

impl CapturedLog {
    fn text(&self) -> String {
        self.messages.lock().unwrap().pop().unwrap().text
    }
}

/// Calls the logger variadically, as C does.
macro_rules! log {
    ($captured:expr, $format:expr $(, $argument:expr)*) => {{
        let handle = $captured.registration.handle();
        // SAFETY: the formats below fit their arguments.
        unsafe { LOGGER(handle, c"unit".as_ptr(), 0, c"logAll".as_ptr(), $format.as_ptr() $(, $argument)*) };
    }};
}

#[test]
fn printf_arguments_of_every_kind_arrive() {
    let captured = capture("printf");
    log!(captured, c"plain\n");
    assert_eq!(captured.text(), "plain");
    log!(captured, c"%d %ld %s %c %5.2f|%-6x|", -3_i32, 1_i64 << 40, c"text".as_ptr(), 65_i32, 2.345_f64, 255_i32);
    assert_eq!(captured.text(), "-3 1099511627776 text A  2.35|ff    |");
    log!(
        captured,
        c"%g %g %g %g %g %g %g %g %g %g %d %d",
        1.0_f64,
        2.0_f64,
        3.0_f64,
        4.0_f64,
        5.0_f64,
        6.0_f64,
        7.0_f64,
        8.0_f64,
        9.0_f64,
        10.0_f64,
        11_i32,
        12_i32
    );
    assert_eq!(captured.text(), "1 2 3 4 5 6 7 8 9 10 11 12");
    log!(captured, c"%d %d %d %g %s", 1_i32, 2_i32, 3_i32, 0.5_f64, c"end".as_ptr());
    assert_eq!(captured.text(), "1 2 3 0.5 end");
}

#[test]
fn long_messages_arrive_complete_and_very_long_ones_are_cut() {
    let captured = capture("long");
    let long = CString::new("x".repeat(6000)).unwrap();
    log!(captured, c"<%s>", long.as_ptr());
    assert_eq!(captured.text(), format!("<{}>", "x".repeat(6000)));
    let very_long = CString::new("é".repeat(70_000)).unwrap();
    log!(captured, c"%s", very_long.as_ptr());
    let text = captured.text();
    assert!(text.starts_with(&"é".repeat(LONGEST_TEXT / 2)) && text.ends_with(CUT), "{}", text.len());
    log!(captured, c"%.900000d", 1_i32);
    assert_eq!(captured.text().trim_start_matches('0'), CUT);
}

#[test]
fn very_long_messages_fit_on_the_board() {
    let captured = capture("category");
    let very_long = CString::new("\u{e9}".repeat(2 << 20)).unwrap();
    // SAFETY: the format reads no arguments.
    unsafe { LOGGER(captured.registration.handle(), c"unit".as_ptr(), 0, very_long.as_ptr(), very_long.as_ptr()) };
    let message = captured.messages.lock().unwrap().pop().unwrap();
    assert!(message.category.ends_with(CUT) && message.text.ends_with(CUT), "{}", message.category.len());
    let warning = LogMessage::warning(0, (0, 0), very_long.into_string().unwrap());
    for message in [message, warning] {
        assert!(postcard::to_stdvec(&message).unwrap().len() <= Board::LONGEST_MESSAGE);
    }
}

#[test]
fn a_format_that_writes_to_memory_is_refused() {
    let captured = capture("hostile");
    let mut written = 0_i32;
    log!(captured, c"abc%n", &raw mut written);
    assert_eq!((captured.text().as_str(), written), ("abc%n (format refused: %n)", 0));
}

#[test]
fn a_width_among_the_arguments_is_read_as_c_reads_it() {
    let captured = capture("widths");
    log!(captured, c"%*d|%-*d|%.*f|%.*s|", 4_i32, 1_i32, -3_i32, 2_i32, 2_i32, 0.5_f64, 3_i32, c"texts".as_ptr());
    assert_eq!(captured.text(), "   1|2  |0.50|tex|");
    let wide = 2_000_000_000_i32;
    for format in [c"%*d", c"%-*d", c"%.*d"] {
        log!(captured, format, wide, 1_i32);
        assert!(captured.text().ends_with(" (format refused: a width beyond a million)"));
    }
    // The width is the seventh integer, so it is on the stack, behind reals in registers.
    log!(captured, c"%d%g%d%g%d%*d", 1_i32, 0.5_f64, 2_i32, 0.5_f64, 3_i32, wide, 4_i32);
    assert!(captured.text().ends_with("(format refused: a width beyond a million)"));
    log!(captured, c"%d%g%d%g%d%*d", wide, 0.5_f64, 2_i32, 0.5_f64, 3_i32, 4_i32, wide);
    assert_eq!(captured.text(), "20000000000.520.532000000000");
}

#[test]
fn nulls_unknown_statuses_and_broken_utf8_become_a_message() {
    let captured = capture("odd");
    let handle = captured.registration.handle();
    // SAFETY: the logger accepts NULL for any text.
    unsafe { LOGGER(handle, ptr::null(), 42, ptr::null(), ptr::null()) };
    // SAFETY: the format reads no arguments.
    unsafe { LOGGER(handle, ptr::null(), -1, ptr::null(), c"\xff ok".as_ptr()) };
    let messages = captured.messages.lock().unwrap();
    let fields: Vec<_> =
        messages.iter().map(|m| (m.instance, m.status, m.category.as_str(), m.text.as_str())).collect();
    assert_eq!(fields, [(Some(4), 42, "", ""), (Some(4), -1, "", "\u{fffd} ok")]);
}

#[test]
fn a_message_with_a_wrong_environment_is_assigned_by_the_instances_name() {
    let captured = capture("lost and found");
    let on_the_stack = 0_u8;
    let foreign = (&raw const on_the_stack).cast_mut().cast::<c_void>();
    // SAFETY: the environment is only compared, never dereferenced.
    unsafe { LOGGER(foreign, c"lost and found".as_ptr(), 0, ptr::null(), c"here".as_ptr()) };
    assert_eq!(captured.messages.lock().unwrap()[0].instance, Some(4));
    drop(captured.registration);
    // SAFETY: as above. The instance is freed, so its sink gets no message.
    unsafe { LOGGER(foreign, c"lost and found".as_ptr(), 0, ptr::null(), c"nobody".as_ptr()) };
    assert!(captured.messages.lock().unwrap().iter().all(|message| message.text != "nobody"));
}

#[test]
fn a_panicking_sink_does_not_reach_the_unit() {
    let registration = Registration::new(Environment {
        instance: 0,
        name: "panics".to_owned(),
        note: note(),
        names: Arc::new(VariableNames::default()),
        sink: Arc::new(|_| panic!("expected by this test")),
    });
    // SAFETY: the format reads no arguments.
    unsafe { LOGGER(registration.handle(), ptr::null(), 0, ptr::null(), c"text".as_ptr()) };
}
