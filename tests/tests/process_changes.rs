//! Units that change their process: what other units and Lockstep compute stays what it is with `--isolate`, and a warning
//! names the call.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;
use tempfile::TempDir;
use tests::foreign::{Generic, PLATFORM};
use tests::program::{PLACEMENTS, Said, run};

/// A unit of one input (reference 0) and two outputs (1 and 2).
const VARIABLES: &str = "<ScalarVariable name=\"u\" valueReference=\"0\" causality=\"input\"><Real start=\"0\"/></ScalarVariable>\
    <ScalarVariable name=\"y\" valueReference=\"1\" causality=\"output\"><Real/></ScalarVariable>\
    <ScalarVariable name=\"z\" valueReference=\"2\" causality=\"output\"><Real/></ScalarVariable>";

/// Two units, of which the first does what it should not, and an expression that Lockstep computes.
const SCRIPT: &str = "scenario \"Two units\"\nstep 100 ms\nstop 600 ms\nfmu a = \"a.fmu\"\nfmu b = \"b.fmu\"\n\
    0.1 * time / (1 s) -> a.u\n0.1 * 3 + 0.1 * time / (1 s) -> b.u\nrecord a.y, b.u, b.y, b.z\n";

/// The macros of `generic.c` with code for a call, and the calls; those up to the end of the initialization come first.
const CALLS: [(&str, &str); 9] = [
    ("INSTANTIATE_CODE", "fmi2Instantiate"),
    ("SETUP_CODE", "fmi2SetupExperiment"),
    ("ENTER_CODE", "fmi2EnterInitializationMode"),
    ("EXIT_CODE", "fmi2ExitInitializationMode"),
    ("SET_CODE", "fmi2SetReal"),
    ("STEP_CODE", "fmi2DoStep"),
    ("GET_CODE", "fmi2GetReal"),
    ("TERMINATE_CODE", "fmi2Terminate"),
    ("FREE_CODE", "fmi2FreeInstance"),
];

/// `b` computes a number that is smaller than any normal one, and one that has to be rounded, in each of its calls.
const SENSITIVE: &str = "volatile double small = 1e-308, tenth = 0.1; R[1] = small / 16; R[2] = tenth * 3;";

/// The second unit, which is the same in all tests.
static B: LazyLock<TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let code = [("STEP_CODE", SENSITIVE), ("GET_CODE", SENSITIVE)];
    Generic { variables: VARIABLES, code: &code, ..Generic::default() }.pack(folder.path(), "b");
    folder
});

fn pack(folder: &Path, code: &[(&str, &str)]) {
    Generic { variables: VARIABLES, code, ..Generic::default() }.pack(folder, "a");
    fs::copy(B.path().join("b.fmu"), folder.join("b.fmu")).unwrap();
    fs::write(folder.join("two.scn"), SCRIPT).unwrap();
}

/// Runs the script in one process and with `--isolate`; both have the same rows.
fn both(folder: &Path) -> [Said; 2] {
    let run_in = |out: &str, more: &[&str]| run(folder, &[&["run", "two.scn", "--out", out], more].concat());
    let ran = [run_in("together", &[]), run_in("isolated", &["--isolate"])];
    for said in &ran {
        assert_eq!(said.code, Some(0), "{}", said.err);
    }
    let rows = ["together", "isolated"].map(|out| fs::read_to_string(folder.join(out).join("trace.csv")).unwrap());
    assert_eq!(rows[0], rows[1]);
    assert!(rows[0].ends_with("0.6,0,0.35000000000000003,6.25e-310,0.30000000000000004\n"), "{}", rows[0]);
    ran
}

fn warnings(said: &Said) -> Vec<&str> {
    said.err.lines().filter(|line| line.contains("  warning  ") || line.starts_with("warning: ")).collect()
}

/// Rounds down and flushes to zero, also in the x87 unit.
const DISTURB: &str = "_mm_setcsr(_mm_getcsr() | 0x8040); fesetround(0x400);";

/// What the code of these tests needs.
const HEADERS: &str = "#include <fenv.h>\n#include <locale.h>\n#include <pthread.h>\n#include <signal.h>\n#include <stdlib.h>\n\
    #include <unistd.h>\n#include <unwind.h>\n\
    #ifdef __x86_64__\n#include <xmmintrin.h>\n#endif\n\
    static void *stop_later(void *none) { usleep(50000); raise(SIGSTOP); return none; }\n";

/// The code with a header file that it needs.
fn with_headers<'a>(folder: &Path, code: &[(&'a str, String)]) -> Vec<(&'a str, String)> {
    let header = folder.join("headers.h");
    fs::write(&header, HEADERS).unwrap();
    let mut all = vec![("INCLUDES", format!("\"{}\"", header.display()))];
    all.extend_from_slice(code);
    all
}

fn pack_with_headers(folder: &Path, code: &[(&str, String)]) {
    let code = with_headers(folder, code);
    let code: Vec<_> = code.iter().map(|(name, code)| (*name, code.as_str())).collect();
    pack(folder, &code);
}

#[test]
#[cfg(target_arch = "x86_64")]
fn floating_point_control_is_restored_after_each_call_and_one_warning_names_the_call() {
    for (place, call) in CALLS.into_iter().filter(|(place, _)| *place != "FREE_CODE") {
        for from_step in [0, 3] {
            if from_step > 0 && !["GET_CODE", "SET_CODE", "STEP_CODE"].contains(&place) {
                continue;
            }
            let folder = tempfile::tempdir().unwrap();
            pack_with_headers(folder.path(), &[(place, format!("if (STEPS >= {from_step}) {{ {DISTURB} }}"))]);
            for said in both(folder.path()) {
                let expected = format!("a  warning  {call} changed the rounding mode and flush-to-zero of its process");
                let warnings = warnings(&said);
                assert!(warnings.len() == 1 && warnings[0].contains(&expected), "{place} {from_step}: {}", said.err);
            }
        }
    }
}

#[test]
#[cfg(target_arch = "x86_64")]
fn a_change_that_happens_once_is_reported_too() {
    for (place, by) in [
        ("SET_CODE", "fmi2DoStep or the setting of values before it changed"),
        ("STEP_CODE", "fmi2DoStep or the setting of values before it changed"),
        ("GET_CODE", "the reading of outputs, of this or a later instance, changed"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let once = format!("static int done; if (STEPS == 3 && !done++) {{ {DISTURB} }}");
        pack_with_headers(folder.path(), &[(place, once)]);
        for said in both(folder.path()) {
            let warnings = warnings(&said);
            assert!(warnings.len() == 1 && warnings[0].contains(by), "{place}: {}", said.err);
        }
    }
}

#[test]
fn locale_and_working_directory_are_restored_after_loading_and_initialization() {
    let disturb = "if (chdir(\"/\")) abort(); setlocale(LC_ALL, \"C.UTF-8\");";
    for (place, call) in CALLS[..4].iter().copied().chain([("LOADING", "the loading of its library")]) {
        let folder = tempfile::tempdir().unwrap();
        let looks = "if (strcmp(setlocale(LC_ALL, NULL), \"C\")) SAY(1, \"another locale\");";
        let report = "char here[1000]; if (!strcmp(getcwd(here, 1000), \"/\")) SAY(1, \"another folder\");";
        let mut code = vec![("STEP_CODE", [looks, report].concat())];
        if place != "LOADING" {
            code.push((place, disturb.to_owned()));
        }
        let code = with_headers(folder.path(), &code);
        if place == "LOADING" {
            let header = folder.path().join("headers.h");
            let constructor = format!("__attribute__((constructor)) static void on_load(void) {{ {disturb} }}\n");
            let text = fs::read_to_string(&header).unwrap();
            fs::write(&header, text + &constructor).unwrap();
        }
        let code: Vec<_> = code.iter().map(|(name, code)| (*name, code.as_str())).collect();
        pack(folder.path(), &code);
        for said in both(folder.path()) {
            let expected = format!("a  warning  {call} changed the locale and the working directory of its process");
            let warnings = warnings(&said);
            assert!(warnings.len() == 1 && warnings[0].contains(&expected), "{place}: {}", said.err);
        }
    }
}

/// Packs a unit that needs `libshared.so`, whose function returns a number.
fn pack_with_library(folder: &Path, name: &str, number: u32) {
    let scratch = tempfile::tempdir().unwrap();
    let (source, library) = (scratch.path().join("shared.c"), scratch.path().join("libshared.so"));
    fs::write(&source, format!("double number(void) {{ return {number}; }}\n")).unwrap();
    let mut compiler = Command::new("cc");
    compiler.args(["-shared", "-fPIC", "-Wl,-soname,libshared.so", "-o"]).args([&library, &source]);
    assert!(compiler.status().unwrap().success());
    let code = [("STEP_CODE", "extern double number(void); R[1] = number();")];
    Generic { variables: VARIABLES, code: &code, beside: Some(&library), ..Generic::default() }.pack(folder, name);
}

#[test]
#[cfg(target_os = "linux")]
fn a_library_that_a_unit_gets_from_another_unit_is_named_with_both_files() {
    for (number_of_b, conflicts) in [(1, 0), (2, 1)] {
        let folder = tempfile::tempdir().unwrap();
        pack_with_library(folder.path(), "a", 1);
        pack_with_library(folder.path(), "b", number_of_b);
        fs::write(folder.path().join("two.scn"), SCRIPT).unwrap();
        let (together, isolated) =
            (run(folder.path(), &["run", "two.scn"]), run(folder.path(), &["run", "two.scn", "--isolate"]));
        assert_eq!((together.code, isolated.code), (Some(0), Some(0)), "{}{}", together.err, isolated.err);
        assert_eq!((warnings(&together).len(), warnings(&isolated).len()), (conflicts, 0), "{}", together.err);
        let place = format!("binaries/{PLATFORM}/libshared.so");
        let expected = format!("b  warning  it uses {place} of unit `a.fmu` instead of {place} of unit `b.fmu`: ");
        let named = warnings(&together).iter().all(|line| line.contains(&expected) && line.contains("--isolate"));
        assert!(named, "{}", together.err);
    }
}

#[test]
fn a_unit_that_copies_its_process_and_returns_twice_is_named_and_ends_the_run() {
    for (place, call) in CALLS.into_iter().filter(|(place, _)| *place != "FREE_CODE") {
        let folder = tempfile::tempdir().unwrap();
        pack_with_headers(folder.path(), &[(place, "static int done; if (!done++) fork();".to_owned())]);
        let time = if place == "TERMINATE_CODE" { "0.6" } else { "0" };
        for placement in PLACEMENTS {
            let said = run(folder.path(), &[&["run", "two.scn"], placement].concat());
            let expected = format!("error: `a` copied its process (fork), and both returned from {call} at {time} s\n");
            assert!(said.code == Some(3) && said.err.contains(&expected), "{call} {placement:?}: {}", said.err);
        }
    }
}

#[test]
fn an_exception_or_the_end_of_the_thread_in_any_call_is_named() {
    let raise = "static struct _Unwind_Exception exception; _Unwind_RaiseException(&exception); abort();";
    for (place, call) in CALLS {
        let of_thread = (place == "STEP_CODE").then_some("pthread_exit(0);");
        for code in [raise].into_iter().chain(of_thread) {
            let folder = tempfile::tempdir().unwrap();
            pack_with_headers(folder.path(), &[(place, code.to_owned())]);
            for placement in PLACEMENTS {
                let said = run(folder.path(), &[&["run", "two.scn"], placement].concat());
                let expected =
                    format!("error: `a` left {call} by an exception or the end of its thread (pthread_exit)");
                assert!(said.code == Some(3) && said.err.contains(&expected), "{call} {placement:?}: {}", said.err);
            }
        }
    }
}

#[test]
fn after_fmi2_fatal_the_run_ends_and_nothing_of_the_library_is_called() {
    let step = "static int dead; if (dead) SAY(1, \"called after fmi2Fatal\"); \
                if (!strcmp(unit->name, \"bad\") && T >= 1) { dead = 1; status = FATAL; }";
    let code =
        [("STEP_CODE", step), ("TERMINATE_CODE", "SAY(1, \"terminated\");"), ("FREE_CODE", "SAY(1, \"freed\");")];
    let folder = tempfile::tempdir().unwrap();
    Generic { variables: VARIABLES, code: &code, ..Generic::default() }.pack(folder.path(), "a");
    let script = "scenario \"Fatal\"\nstep 100 ms\nstop 3 s\nfmu bad = \"a.fmu\" every 1 s\nfmu good = \"a.fmu\"\n\
                  good.y -> bad.u\nbad.y -> good.u\nrecord good.y\n";
    fs::write(folder.path().join("fatal.scn"), script).unwrap();
    let said = run(folder.path(), &["run", "fatal.scn", "--out", "out"]);
    assert_eq!(said.code, Some(3), "{}", said.err);
    assert!(said.err.contains("error: `bad`: fmi2DoStep returned fmi2Fatal at 1 s\n"), "{}", said.err);
    assert_eq!(warnings(&said), [""; 0]);
    assert_eq!(fs::read_to_string(folder.path().join("out/trace.csv")).unwrap().lines().count(), 12);
    let said = run(folder.path(), &["run", "fatal.scn", "--isolate"]);
    assert!(
        said.code == Some(3) && said.err.contains("error: `bad`: fmi2DoStep returned fmi2Fatal at 1 s\n"),
        "{}",
        said.err
    );
}

#[test]
fn a_stepping_process_that_is_stopped_ends_the_run_in_a_call_and_between_calls() {
    let later = "pthread_t thread; if (STEPS == 2) pthread_create(&thread, NULL, stop_later, NULL);";
    for (code, expected) in [
        (
            "if (STEPS == 2) raise(SIGSTOP);",
            "error: `a`: its process has been stopped (SIGSTOP) for 1 s, in fmi2DoStep, at 0.1 s",
        ),
        (later, "error: the stepping process has been stopped (SIGSTOP) for 1 s, between calls, at 0.1 s"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        pack_with_headers(folder.path(), &[("STEP_CODE", code.to_owned())]);
        let said = run(folder.path(), &["run", "two.scn", "--pace", "0.5"]);
        assert!(said.code == Some(3) && said.err.contains(expected), "{}", said.err);
    }
}
