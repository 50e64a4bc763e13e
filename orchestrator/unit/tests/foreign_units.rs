//! Loading, logging, stepping and misbehaviour of a unit in C that does not use the export layer.
#![allow(clippy::unwrap_used, reason = "a test ends where something is not as it should be")]

use fmi2::calls::Call;
use std::sync::{Arc, Mutex};
use tempfile::TempDir;
use tests::foreign::Foreign;
use unit::archive::{Unpacked, unpack};
use unit::board::{Board, BoardLayout, Note, Now};
use unit::failure::{Cause, Doing, Failure};
use unit::handles::Handles;
use unit::instance::{Instance, Setting, StepResult};
use unit::library::Library;
use unit::logger::LogMessage;

const STEP_S: f64 = 0.5;
const U: u32 = 0;
const GAIN: u32 = 1;
const Y: u32 = 2;

/// An unpacked unit and what the tests need to load it.
struct Bench {
    _folder: TempDir,
    unpacked: Unpacked,
    note: Note,
    messages: Arc<Mutex<Vec<LogMessage>>>,
}

impl Bench {
    fn new(foreign: &Foreign) -> Self {
        let (folder, fmu) = foreign.build();
        let unpacked = unpack(&fmu, &folder.path().join("unpacked")).unwrap();
        let note = Board::private(&BoardLayout { notes: 1, columns: 0, claims: 0 }).unwrap().note(0);
        Self { _folder: folder, unpacked, note, messages: Arc::default() }
    }

    fn misbehaving(call: &str, how: &str) -> Self {
        let defines = [format!("MISBEHAVE_CALL={call}"), format!("MISBEHAVE_HOW={how}")];
        Self::new(&Foreign { defines: &[&defines[0], &defines[1]], ..Foreign::default() })
    }

    fn load(&self) -> Result<Arc<Library>, String> {
        let loaded = Library::load(&self.unpacked.folder, &self.unpacked.description, &self.note, 3);
        // The folder's name differs from run to run.
        let folder = self.unpacked.folder.display().to_string();
        loaded.map(Arc::new).map_err(|error| error.to_string().replace(&folder, "…"))
    }

    fn instantiate(&self, library: &Arc<Library>) -> Result<Instance, Failure> {
        let messages = Arc::clone(&self.messages);
        let sink = Arc::new(move |message| messages.lock().unwrap().push(message));
        Instance::instantiate(
            library,
            Setting { name: "tank", index: 3, note: self.note.clone(), sink, logging_on: true, calls: None },
        )
    }

    /// An instance that is ready to step.
    fn start(&self) -> Result<Instance, Failure> {
        let mut instance = self.instantiate(&self.load().unwrap())?;
        instance.setup_experiment(&self.at(0))?;
        instance.enter_initialization_mode(&self.at(0))?;
        instance.exit_initialization_mode(&self.at(0))?;
        Ok(instance)
    }

    fn at(&self, tick: u64) -> Now<'_> {
        self.note.at(tick, tick as f64 * STEP_S)
    }

    fn texts(&self) -> Vec<String> {
        self.messages.lock().unwrap().iter().map(|message| message.text.clone()).collect()
    }
}

#[test]
fn a_unit_in_c_runs_and_its_log_messages_arrive_with_their_printf_arguments() {
    let bench = Bench::new(&Foreign::default());
    let mut tank = bench.start().unwrap();
    tank.set_real(&bench.at(0), &Handles::from([U, GAIN]), &[3.0, 4.0]).unwrap();
    tank.set_string(&bench.at(0), &Handles::from([0]), &["grüß Gott".to_owned()]).unwrap();
    tank.set_boolean(&bench.at(0), &Handles::from([0]), &[1]).unwrap();
    assert_eq!(tank.do_step(&bench.at(0), STEP_S), Ok(StepResult::Done));
    assert_eq!(tank.do_step(&bench.at(1), STEP_S), Ok(StepResult::Done));
    let (mut reals, mut count, mut enabled, mut label) = ([0.0; 3], [0], [0], [String::new()]);
    tank.get_real(&bench.at(2), &Handles::from([Y, GAIN, U]), &mut reals).unwrap();
    tank.get_integer(&bench.at(2), &Handles::from([0]), &mut count).unwrap();
    tank.get_boolean(&bench.at(2), &Handles::from([0]), &mut enabled).unwrap();
    tank.get_string(&bench.at(2), &Handles::from([0]), &mut label).unwrap();
    assert_eq!((reals, count, enabled, label[0].as_str()), ([9.0, 4.0, 3.0], [2], [1], "grüß Gott"));
    tank.terminate(&bench.at(2)).unwrap();
    tank.free();
    let texts = [
        "type 1, resources in file:///",
        "step 1 of tank: y = 6.000000",
        "step 2 of tank: y = 9.000000",
        "done after 2 steps: 1 2 3 4 5 6 7 8 9 | grüß Gott",
    ];
    assert_eq!(bench.texts(), texts);
    let messages = bench.messages.lock().unwrap();
    let places: Vec<_> = messages.iter().map(|message| (message.instance, message.tick, message.status)).collect();
    assert_eq!(places, [(Some(3), 0, 0), (Some(3), 0, 0), (Some(3), 1, 0), (Some(3), 2, 0)]);
    assert!(messages.iter().all(|message| message.category == "logAll"));
}

#[test]
fn several_instances_of_one_library_do_not_disturb_each_other() {
    let bench = Bench::new(&Foreign::default());
    let library = bench.load().unwrap();
    let steps: Vec<_> = (1..=4).map(|i| (bench.instantiate(&library).unwrap(), f64::from(i))).collect();
    std::thread::scope(|scope| {
        for (mut instance, input) in steps {
            let bench = &bench;
            scope.spawn(move || {
                instance.set_real(&bench.at(0), &Handles::from([U]), &[input]).unwrap();
                for tick in 0..100 {
                    instance.do_step(&bench.at(tick), STEP_S).unwrap();
                }
                let mut level = [0.0];
                instance.get_real(&bench.at(100), &Handles::from([Y]), &mut level).unwrap();
                assert!((level[0] - 2.0 * input).abs() < 1e-12);
            });
        }
    });
}

#[test]
fn a_note_names_the_call_while_a_unit_logs_in_it() {
    let bench = Bench::new(&Foreign::default());
    let library = bench.load().unwrap();
    let (note, calls) = (bench.note.clone(), Arc::new(Mutex::new(Vec::new())));
    let seen = Arc::clone(&calls);
    let sink = Arc::new(move |_| seen.lock().unwrap().push(note.read().unwrap()));
    let setting = Setting { name: "tank", index: 3, note: bench.note.clone(), sink, logging_on: true, calls: None };
    let mut tank = Instance::instantiate(&library, setting).unwrap();
    tank.do_step(&bench.at(7), STEP_S).unwrap();
    let calls: Vec<_> = calls.lock().unwrap().iter().map(|call| (call.tick, call.instance, call.doing)).collect();
    assert_eq!(calls, [(0, 3, Doing::Call(Call::Instantiate)), (7, 3, Doing::Call(Call::DoStep))]);
    assert_eq!(bench.note.read(), None);
}

#[test]
fn statuses_that_end_a_run_name_instance_call_and_time() {
    for (how, status) in [("ERROR_STATUS", 3), ("FATAL", 4), ("STATUS_42", 42)] {
        let bench = Bench::misbehaving("STEP", how);
        let mut tank = bench.start().unwrap();
        let failure = tank.do_step(&bench.at(5), STEP_S).unwrap_err();
        let expected = Failure {
            instance: Some("tank".to_owned()),
            doing: Doing::Call(Call::DoStep),
            time_s: Some(2.5),
            cause: Cause::Status(status),
        };
        assert_eq!(failure, expected);
        assert_eq!(bench.texts()[1], format!("asked to return {status} at 2.500 s"));
        drop(tank);
    }
}

#[test]
fn every_call_before_the_first_step_may_fail() {
    for (name, call) in [
        ("SETUP", Call::SetupExperiment),
        ("ENTER", Call::EnterInitializationMode),
        ("EXIT", Call::ExitInitializationMode),
    ] {
        let failure = Bench::misbehaving(name, "ERROR_STATUS").start().unwrap_err();
        assert_eq!((failure.doing, failure.cause), (Doing::Call(call), Cause::Status(3)));
    }
    let failure = Bench::misbehaving("INSTANTIATE", "NO_INSTANCE").start().unwrap_err();
    assert_eq!((failure.doing, failure.cause), (Doing::Call(Call::Instantiate), Cause::NoInstance));
}

#[test]
fn after_fatal_nothing_of_the_library_is_called() {
    // A call of `fmi2FreeInstance` would end this process.
    let bench = Bench::new(&Foreign { defines: &["MISBEHAVE_CALL=STEP", "MISBEHAVE_HOW=FATAL"], ..Foreign::default() });
    let library = bench.load().unwrap();
    let (mut one, mut other) = (bench.instantiate(&library).unwrap(), bench.instantiate(&library).unwrap());
    assert!(!library.is_dead());
    one.do_step(&bench.at(0), STEP_S).unwrap_err();
    assert!(library.is_dead());
    let before = bench.texts().len();
    assert_eq!(other.terminate(&bench.at(0)), Ok(()));
    drop((one, other));
    assert_eq!(bench.texts().len(), before);
}

#[test]
fn a_warning_is_logged_once_and_the_run_continues() {
    let bench = Bench::misbehaving("SET", "WARNING");
    let mut tank = bench.start().unwrap();
    for tick in 0..3 {
        tank.set_real(&bench.at(tick), &Handles::from([U]), &[1.0]).unwrap();
    }
    let is_warning = |text: &String| text.starts_with("fmi2SetReal returned fmi2Warning");
    assert_eq!(bench.texts().iter().filter(|text| is_warning(text)).count(), 1);
}

#[test]
fn a_discarded_step_ends_the_run_normally_if_the_unit_terminated_and_is_a_failure_otherwise() {
    let step = |bench: &Bench| bench.start().unwrap().do_step(&bench.at(4), STEP_S);
    let cause = |bench: &Bench| step(bench).unwrap_err().cause;
    let terminated = step(&Bench::misbehaving("STEP", "TERMINATED"));
    assert_eq!(terminated, Ok(StepResult::Terminated { last_successful_time_s: 2.25 }));
    let text = "fmi2DoStep returned fmi2Discard: the unit did not take the step of 0.5 s and came as far as 2.25 s";
    assert_eq!(cause(&Bench::misbehaving("STEP", "DISCARD")), Cause::Other(text.to_owned()));
    let without_status = Bench::new(&Foreign {
        defines: &["MISBEHAVE_CALL=STEP", "MISBEHAVE_HOW=TERMINATED", "WITHOUT_STATUS"],
        ..Foreign::default()
    });
    let text = "fmi2DoStep returned fmi2Discard: the unit did not take the step of 0.5 s";
    assert_eq!(cause(&without_status), Cause::Other(text.to_owned()));
    let cause = cause(&Bench::misbehaving("STEP", "PENDING"));
    assert!(matches!(cause, Cause::Other(text) if text.contains("fmi2Pending")));
}

#[test]
fn a_nan_is_returned_to_the_caller_without_an_error() {
    let bench = Bench::misbehaving("STEP", "NOT_A_NUMBER");
    let mut tank = bench.start().unwrap();
    tank.do_step(&bench.at(0), STEP_S).unwrap();
    let mut level = [0.0];
    tank.get_real(&bench.at(1), &Handles::from([Y]), &mut level).unwrap();
    assert!(level[0].is_nan());
}

#[test]
fn a_wrong_guid_prevents_instantiation_and_the_unit_logs_the_reason() {
    let bench = Bench::new(&Foreign { description: &[("guid=\"{5f1ed1f0", "guid=\"{0000")], ..Foreign::default() });
    let failure = bench.instantiate(&bench.load().unwrap()).unwrap_err();
    assert_eq!(failure.cause, Cause::NoInstance);
    let messages = bench.messages.lock().unwrap();
    assert_eq!(
        (messages[0].instance, messages[0].status, messages[0].category.as_str()),
        (Some(3), 3, "logStatusError")
    );
    assert!(messages[0].text.starts_with("the guid is {0000-c0de"), "{}", messages[0].text);
}

#[test]
fn a_unit_that_allows_one_instance_gets_one_at_a_time() {
    let bench = Bench::new(&Foreign {
        description: &[(
            "canHandleVariableCommunicationStepSize",
            "canBeInstantiatedOnlyOncePerProcess=\"true\" canHandleVariableCommunicationStepSize",
        )],
        ..Foreign::default()
    });
    let library = bench.load().unwrap();
    let first = bench.instantiate(&library).unwrap();
    let Cause::Other(text) = bench.instantiate(&library).unwrap_err().cause else { panic!("another cause") };
    assert!(text.contains("only once"), "{text}");
    drop(first);
    bench.instantiate(&library).unwrap();
}

#[test]
fn the_reason_why_a_library_cannot_be_used_is_reported() {
    let without = |defines| Bench::new(&Foreign { defines, ..Foreign::default() }).load().unwrap_err();
    let library = "…/binaries/linux64/foreign.so";
    assert_eq!(without(&["WITHOUT_SET_STRING"]), format!("{library} lacks the function `fmi2SetString` of FMI 2.0"));
    assert_eq!(
        without(&["NEEDS_SYMBOL"]),
        format!("{library} needs the symbol `nobody_has_this_function`, which no loaded library has")
    );
    assert_eq!(
        without(&["VERSION=\"3.0\""]),
        format!("{library}: fmi2GetVersion should answer `2.0`, but answers `3.0`")
    );
    assert_eq!(
        without(&["TYPES_PLATFORM=NULL"]),
        format!("{library}: fmi2GetTypesPlatform should answer `default`, but answers `NULL`")
    );
    let other_platform = Bench::new(&Foreign { platform: "win64", ..Foreign::default() }).load().unwrap_err();
    assert_eq!(
        other_platform,
        "the unit has no library for this platform: `binaries/linux64/foreign.so` is not there, only \
         `binaries/win64/foreign.so`"
    );
}
