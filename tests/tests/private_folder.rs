//! The private folder of a run: no other user can enter it, and none is left over.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;
use tests::flight::{Flight, signal, until};
use tests::foreign::{Generic, OUTPUT};
use tests::program::{PLACEMENTS, command, lockstep, names, run};

const SLOW: &str = "scenario \"A unit works for days\"\nstep 1 s\nstop 100000 s\nfmu a = \"a.fmu\"\nrecord a.y\n";

/// A folder with a unit, a script that takes days and one that takes a moment.
fn folder_with_unit() -> TempDir {
    let code = [("STEP_CODE", "usleep(20000);")];
    let folder = Generic { variables: OUTPUT, code: &code, ..Generic::default() }.build("a");
    fs::write(folder.path().join("slow.scn"), SLOW).unwrap();
    fs::write(folder.path().join("quick.scn"), SLOW.replace("100000 s", "2 s")).unwrap();
    folder
}

/// Runs the slow script with an umask until it steps.
fn under_way(folder: &Path, umask: &str, placement: &str) -> Flight {
    let mut shell = Command::new("sh");
    let line = format!("umask {umask}; exec \"$0\" run slow.scn --out {umask}{placement} {placement}");
    shell.args(["-c", &line]).arg(lockstep()).current_dir(folder);
    let program = Flight::of(shell);
    let trace = folder.join(format!("{umask}{placement}/trace.csv.partial"));
    until("a row", || fs::read_to_string(&trace).is_ok_and(|text| text.lines().count() > 1));
    program
}

/// Whether this process may act as any user.
fn is_root(home: &Path) -> bool {
    fs::metadata(home).unwrap().uid() == 0
}

/// Tries as another user to list a folder, to reach the socket of a worker and to replace a unit; returns what was possible.
fn attempt_of_another_user(home: &Path) -> String {
    let attempts = "echo tried; ls \"$1\" && echo listed; mv \"$1/unit0\" \"$1/stolen\" && echo moved; \
                    cp /bin/true \"$1/unit0/binaries\" && echo replaced; test -S \"$1/0.sock\" && echo reached; true";
    let mut other = Command::new("setpriv");
    other.args(["--reuid=65534", "--regid=65534", "--clear-groups", "sh", "-c", attempts, "sh"]).arg(home);
    String::from_utf8(other.output().unwrap().stdout).unwrap()
}

#[test]
fn no_other_user_can_enter_the_private_folder_whatever_the_umask() {
    let folder = folder_with_unit();
    for (umask, placement) in [("000", ""), ("000", "--isolate"), ("022", "--isolate"), ("277", "")] {
        if umask == "277" && !is_root(folder.path()) {
            // It takes the results' folder from its own user too.
            continue;
        }
        let program = under_way(folder.path(), umask, placement);
        let [home] = <[PathBuf; 1]>::try_from(program.temporary_folders()).unwrap();
        assert_eq!(fs::metadata(&home).unwrap().mode() & 0o7777, 0o700, "umask {umask} {placement}");
        if is_root(&home) {
            for above in home.ancestors().skip(1).take_while(|above| above.starts_with(std::env::temp_dir())) {
                fs::set_permissions(above, fs::Permissions::from_mode(0o1777)).unwrap();
            }
            assert_eq!(attempt_of_another_user(&home), "tried\n", "umask {umask} {placement}");
        }
    }
}

#[test]
fn a_folder_in_which_all_users_may_rename_private_folders_is_warned_of() {
    let folder = folder_with_unit();
    let open = folder.path().join("open");
    fs::create_dir(&open).unwrap();
    for (mode, warns) in [(0o777, true), (0o1777, false), (0o755, false)] {
        fs::set_permissions(&open, fs::Permissions::from_mode(mode)).unwrap();
        let said = command(folder.path(), &["run", "quick.scn"]).env("TMPDIR", &open).output().unwrap();
        let text = String::from_utf8(said.stderr).unwrap();
        assert_eq!(text.contains("warning: other users can replace the units of this run"), warns, "{mode:o}: {text}");
    }
}

#[test]
fn a_run_removes_what_a_killed_one_has_left_and_nothing_else() {
    let folder = folder_with_unit();
    let temporary = folder.path().join("tmp");
    fs::create_dir(&temporary).unwrap();
    let killed = temporary.join("lockstep-killed");
    fs::create_dir_all(killed.join("unit0")).unwrap();
    fs::write(killed.join("lockstep.lock"), "").unwrap();
    // Folders of the user, whose names begin in the same way.
    fs::create_dir_all(temporary.join("lockstep-notes/unit0")).unwrap();
    std::os::unix::fs::symlink(folder.path(), temporary.join("lockstep-link")).unwrap();
    fs::write(folder.path().join("lockstep.lock"), "").unwrap();
    let mut shell = Command::new("sh");
    shell.args(["-c", "export TMPDIR=\"$PWD/tmp\"; exec \"$0\" run slow.scn --out other"]).arg(lockstep());
    shell.current_dir(folder.path());
    let mut other = Flight::of(shell);
    until("the private folder of another run", || {
        folder.path().join("other/trace.csv.partial").is_file() && !killed.exists()
    });
    let of_other = names(&temporary);
    assert_eq!(of_other.len(), 3, "{of_other:?}");
    let said = command(folder.path(), &["run", "quick.scn"]).env("TMPDIR", &temporary).output().unwrap();
    assert!(said.status.success(), "{said:?}");
    assert_eq!(names(&temporary), of_other, "the other run has its folder");
    signal("TERM", other.id());
    assert_eq!(other.end().code, Some(130));
    assert_eq!(names(&temporary), ["lockstep-link", "lockstep-notes"]);
    assert!(folder.path().join("a.fmu").is_file());
}

#[test]
fn a_relative_folder_for_temporary_files_serves_both_placements() {
    let folder = folder_with_unit();
    fs::create_dir(folder.path().join("tmp")).unwrap();
    for placement in PLACEMENTS {
        let arguments = [&["run", "quick.scn"], placement].concat();
        let said = command(folder.path(), &arguments).env("TMPDIR", "tmp").output().unwrap();
        assert!(said.status.success(), "{said:?}");
        assert_eq!(fs::read_dir(folder.path().join("tmp")).unwrap().count(), 0);
    }
    assert_eq!(run(folder.path(), &["run", "quick.scn"]).code, Some(0));
}
