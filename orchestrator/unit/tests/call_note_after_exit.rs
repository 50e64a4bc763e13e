//! The call note that remains on the board when a unit ends its process: it names instance, call and tick.
#![allow(clippy::unwrap_used, reason = "a test ends where something is not as it should be")]

use fmi2::calls::Call;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tests::foreign::Foreign;
use unit::archive::{read_description, unpack};
use unit::board::{Board, BoardLayout};
use unit::failure::Doing;
use unit::handles::Handles;
use unit::instance::{Instance, Setting};
use unit::library::Library;

/// The environment variable that names the folder to the child process.
const FOLDER: &str = "CALL_NOTE_TEST_FOLDER";
const LAYOUT: BoardLayout = BoardLayout { notes: 1, columns: 1, claims: 0 };

/// The test that the child process runs: where `FOLDER` is set, it is `short_run`.
const OF_CHILD: &str = "the_note_names_instance_call_and_tick_however_the_process_ends";

/// What the child process does, a short run with a board.
fn short_run(folder: &Path) {
    let board = Arc::new(Board::open(&folder.join("board")).unwrap());
    let (description, _) = read_description(&folder.join("foreign.fmu")).unwrap();
    let library = Library::load(&folder.join("unpacked"), &description, &board.note(0), 5).unwrap();
    let log_board = Arc::clone(&board);
    let sink = Arc::new(move |message: unit::logger::LogMessage| {
        log_board.push_message(message.text.as_bytes());
    });
    let note = board.note(0);
    let setting = Setting { name: "tank", index: 5, note: note.clone(), sink, logging_on: true, calls: None };
    let mut tank = Instance::instantiate(&Arc::new(library), setting).unwrap();
    let at = |tick: u64| note.at(tick, tick as f64 * 0.1);
    tank.setup_experiment(&at(0)).unwrap();
    tank.enter_initialization_mode(&at(0)).unwrap();
    tank.exit_initialization_mode(&at(0)).unwrap();
    for tick in 0..20 {
        let now = at(tick);
        let mut level = [0.0];
        tank.set_real(&now, &Handles::from([0]), &[1.0]).unwrap();
        tank.get_real(&now, &Handles::from([2]), &mut level).unwrap();
        board.write_row(tick, |row| row.set(0, f64::to_bits(level[0])));
        tank.do_step(&now, 0.1).unwrap();
    }
    tank.terminate(&at(20)).unwrap();
    tank.free();
}

fn start(folder: &Path) -> Child {
    Command::new(std::env::current_exe().unwrap())
        .args(["--exact", OF_CHILD, "--nocapture"])
        .env(FOLDER, folder)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// Runs a unit in a child process until the unit ends that process; a call that hangs is killed. Returns the exit
/// status and the board as it was left.
fn run_to_end(call: &str, how: &str, hangs: bool) -> (ExitStatus, Board) {
    let defines = [format!("MISBEHAVE_CALL={call}"), format!("MISBEHAVE_HOW={how}"), "MISBEHAVE_FROM_S=1.0".into()];
    let defines: Vec<_> = defines.iter().map(String::as_str).collect();
    let define_count = if ["GET", "SET", "STEP"].contains(&call) { 3 } else { 2 };
    let (folder, fmu) = Foreign { defines: &defines[..define_count], ..Foreign::default() }.build();
    unpack(&fmu, &folder.path().join("unpacked")).unwrap();
    let board = Board::create(&folder.path().join("board"), &LAYOUT).unwrap();
    let mut child = start(folder.path());
    let deadline = Instant::now() + Duration::from_secs(20);
    while hangs && board.note(0).read().is_none_or(|call| call.tick < 10) && Instant::now() < deadline {
        std::thread::sleep(Duration::from_millis(5));
    }
    if hangs {
        // Time for the call itself: the note is written just before it.
        std::thread::sleep(Duration::from_millis(50));
        child.kill().unwrap();
    }
    (child.wait().unwrap(), board)
}

#[test]
fn the_note_names_instance_call_and_tick_however_the_process_ends() {
    if let Some(folder) = std::env::var_os(FOLDER) {
        return short_run(Path::new(&folder));
    }
    for (call, how, signal, code, doing, tick) in [
        ("LOAD", "CRASH", Some(11), None, Doing::Load, 0),
        ("INSTANTIATE", "ABORT", Some(6), None, Doing::Call(Call::Instantiate), 0),
        ("SETUP", "EXIT_3", None, Some(3), Doing::Call(Call::SetupExperiment), 0),
        ("ENTER", "EXIT_0", None, Some(0), Doing::Call(Call::EnterInitializationMode), 0),
        ("EXIT", "OVERFLOW_STACK", Some(6), None, Doing::Call(Call::ExitInitializationMode), 0),
        ("GET", "EXIT_0", None, Some(0), Doing::Call(Call::GetReal), 10),
        ("SET", "ABORT", Some(6), None, Doing::Call(Call::SetReal), 10),
        ("STEP", "CRASH", Some(11), None, Doing::Call(Call::DoStep), 10),
        ("STEP", "HANG", Some(9), None, Doing::Call(Call::DoStep), 10),
        ("STEP", "SPIN", Some(9), None, Doing::Call(Call::DoStep), 10),
        ("TERMINATE", "CRASH", Some(11), None, Doing::Call(Call::Terminate), 20),
        ("FREE", "EXIT_0", None, Some(0), Doing::Call(Call::FreeInstance), 20),
    ] {
        let (status, board) = run_to_end(call, how, ["HANG", "SPIN"].contains(&how));
        let note = board.note(0).read().map(|call| (call.instance, call.doing, call.tick));
        assert_eq!((status.signal(), status.code()), (signal, code), "{call} {how}");
        assert_eq!(note, Some((5, doing, tick)), "{call} {how}");
        let mut rows = 0;
        board.pop_rows(|_, _| rows += 1);
        // The row of tick 10 is pushed between the get and the step.
        let expected = if call == "GET" || call == "SET" { tick } else { (tick + u64::from(tick > 0)).min(20) };
        assert_eq!(rows, expected, "{call} {how}");
    }
}

#[test]
fn a_run_without_a_crash_finishes_and_its_log_messages_arrive() {
    let (status, board) = run_to_end("NEVER", "CRASH", false);
    assert!(status.success());
    assert_eq!(board.note(0).read(), None);
    let mut texts = Vec::new();
    board.pop_messages(|message| texts.push(String::from_utf8_lossy(message).into_owned()));
    assert_eq!((texts.len(), texts[20].as_str()), (22, "step 20 of tank: y = 1.756847"));
}
