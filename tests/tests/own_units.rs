//! Units of the user's own: two in one folder, built with the same dependencies, found by scripts, and packed for old systems.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;
use tests::program::{Said, lockstep, unit_builds};

const BOTH: &str = "scenario \"Two units of one's own\"\nstep 10 ms\nstop 2 s\n\
                    fmu fast = \"my_lag\" { time_constant = 0.1 s }\nfmu slow = \"my_filter\" { time_constant = 0.5 s }\n\
                    let wanted = 1 m * sin(1 rad/s * time)\n\
                    wanted -> fast.target\nfast.value -> slow.target\n\
                    assert follows: finally slow.value > 0.5 m\n";

/// Runs a program as a user does whose units are built in the tests' folder.
fn started(program: &Path, folder: &Path, arguments: &[&str]) -> Said {
    let mut command = Command::new(program);
    command.args(arguments).current_dir(folder).stdin(Stdio::null());
    command.env_remove("CARGO_TARGET_DIR").env("XDG_CACHE_HOME", unit_builds());
    Said::from(command.output().unwrap())
}

fn done(folder: &Path, arguments: &[&str]) -> Said {
    let said = started(&lockstep(), folder, arguments);
    assert_eq!(said.code, Some(0), "{arguments:?}\n{}{}", said.out, said.err);
    said
}

/// A workspace with the units `my_lag` and `my_filter`, and a script beside it that uses both.
fn workspace() -> tempfile::TempDir {
    let home = tempfile::tempdir().unwrap();
    for unit in ["my_lag", "my_filter"] {
        done(home.path(), &["new", "unit", unit]);
    }
    fs::write(home.path().join("both.scn"), BOTH).unwrap();
    home
}

#[test]
fn two_units_in_one_folder_are_tested_run_and_plotted() {
    let home = workspace();
    let manifest = fs::read_to_string(home.path().join("Cargo.toml")).unwrap();
    assert!(manifest.contains("members = [\"my_filter\", \"my_lag\"]"), "{manifest}");
    let tested = started(Path::new("cargo"), home.path(), &["test", "--offline"]);
    assert_eq!(tested.code, Some(0), "{}{}", tested.out, tested.err);
    assert_eq!(tested.out.matches("test two_half_steps_are_one_step ... ok").count(), 2, "{}", tested.out);
    let run = done(home.path(), &["run", "both.scn"]);
    assert!(run.err.contains("building unit `my_filter`"), "{}", run.err);
    let compiled: Vec<_> = run.err.lines().filter(|line| line.trim_start().starts_with("Compiling")).collect();
    assert!(
        !compiled.is_empty() && compiled.iter().all(|line| line.contains("my_")),
        "the tests built the dependencies: {compiled:?}"
    );
    let hint = format!("  {} plot runs/both\n", lockstep().display());
    assert!(run.out.contains(&hint), "a program that was started by its path: {}", run.out);
    done(home.path(), &["plot", "runs/both"]);
    assert!(fs::read_to_string(home.path().join("runs/both/plot.svg")).unwrap().contains("slow.value"));
}

#[test]
fn a_script_uses_units_of_two_workspaces_and_builds_only_what_the_user_named() {
    let home = workspace();
    let elsewhere = tempfile::tempdir().unwrap();
    fs::write(elsewhere.path().join("both.scn"), BOTH).unwrap();
    let named = home.path().to_str().unwrap();
    let script = ["run", "both.scn"];
    let said = started(&lockstep(), elsewhere.path(), &script);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("there is no unit `my_lag`"), "{}", said.err);
    let said = started(&lockstep(), elsewhere.path(), &["run", &format!("{named}/both.scn")]);
    assert_eq!(said.code, Some(2), "a script from elsewhere does not build");
    assert!(said.err.contains("is not packed") && said.err.contains(&format!("--units {named}")), "{}", said.err);
    done(elsewhere.path(), &["run", "both.scn", "--units", named]);
    let mut of_environment = Command::new(lockstep());
    of_environment
        .args(["run", "both.scn", "--out", "again"])
        .current_dir(elsewhere.path())
        .env("LOCKSTEP_UNITS", named);
    assert!(of_environment.status().unwrap().success(), "what is packed by now is found");
}

#[test]
fn units_of_the_same_name_in_two_workspaces_are_not_taken_for_each_other() {
    let [one, other] = [(); 2].map(|()| {
        let home = tempfile::tempdir().unwrap();
        done(home.path(), &["new", "unit", "twin"]);
        home
    });
    let source = other.path().join("twin/src/lib.rs");
    let changed = fs::read_to_string(&source).unwrap().replace("Where the value starts", "Where it begins");
    fs::write(&source, changed).unwrap();
    let (one, other) = (one.path(), other.path());
    for from in [[one, other], [one.parent().unwrap(); 2]] {
        for ((home, words), from) in [(one, "Where the value starts"), (other, "Where it begins")].into_iter().zip(from)
        {
            // From the folder above, by a relative path.
            let unit = home.strip_prefix(from).unwrap().join("twin");
            done(from, &["pack", unit.to_str().unwrap()]);
            let page = done(home, &["describe", "target/fmus/twin.fmu"]).out;
            assert!(page.contains(words), "{page}");
        }
    }
}

#[test]
fn a_library_of_an_earlier_build_does_not_pass_for_one_that_is_missing() {
    let home = tempfile::tempdir().unwrap();
    done(home.path(), &["new", "unit", "bare"]);
    done(home.path(), &["pack", "bare"]);
    let manifest = home.path().join("bare/Cargo.toml");
    let without = fs::read_to_string(&manifest).unwrap().replace("crate-type = [\"cdylib\"]\n", "");
    fs::write(&manifest, without).unwrap();
    let said = started(&lockstep(), home.path(), &["pack", "bare"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("unit `bare` built no library"), "{}", said.err);
}

#[test]
fn a_packed_unit_that_is_older_than_its_sources_is_used_with_a_warning() {
    let home = workspace();
    for unit in ["my_lag", "my_filter"] {
        done(home.path(), &["pack", unit]);
    }
    let source = home.path().join("my_lag/src/lib.rs");
    let later =
        fs::metadata(home.path().join("target/fmus/my_lag.fmu")).unwrap().modified().unwrap() + Duration::from_secs(5);
    fs::File::options().write(true).open(&source).unwrap().set_modified(later).unwrap();
    let elsewhere = tempfile::tempdir().unwrap();
    let script = home.path().join("both.scn");
    let said = done(elsewhere.path(), &["run", script.to_str().unwrap()]);
    let warnings: Vec<_> = said.err.lines().filter(|line| line.contains("older than its sources")).collect();
    assert!(matches!(warnings[..], [line] if line.starts_with("warning: the packed unit `my_lag`")), "{}", said.err);
}

#[test]
fn a_unit_that_needs_a_newer_glibc_is_named_with_the_function_and_ours_need_none() {
    let home = tempfile::tempdir().unwrap();
    done(home.path(), &["new", "unit", "modern"]);
    let said = done(home.path(), &["pack", "modern"]);
    assert!(!said.err.contains("glibc"), "{}", said.err);
    let source = home.path().join("modern/src/lib.rs");
    let calling = fs::read_to_string(&source).unwrap()
        + "\nunsafe extern \"C\" { fn closefrom(lowest: i32); }\n\
           /// Closes files.\n#[unsafe(no_mangle)]\npub extern \"C\" fn close_all() { unsafe { closefrom(1_000_000) } }\n";
    fs::write(&source, calling).unwrap();
    let said = done(home.path(), &["pack", "modern"]);
    assert!(said.err.contains("unit `modern` needs `closefrom` of glibc 2.34: it does not load"), "{}", said.err);
}

#[test]
fn without_cargo_the_error_says_where_rust_comes_from() {
    let home = workspace();
    let mut command = Command::new(lockstep());
    command.args(["run", "both.scn"]).current_dir(home.path()).env("PATH", "").env_remove("CARGO");
    let said = Said::from(command.output().unwrap());
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("cannot start cargo") && said.err.contains("https://rustup.rs"), "{}", said.err);
}
