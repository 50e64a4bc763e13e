//! Runs that are saved and continued give the same rows and verdict as an uninterrupted run.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fmt::Write as _;
use std::fs::{self, File};
use std::path::Path;
use tempfile::TempDir;
use tests::foreign::{CLAIMS_STATES, Foreign};
use tests::program::{Said, repository, run};
use zip::{ZipArchive, ZipWriter};

/// Periods of 1 to 6 ticks, both kinds of connection, windows that are open across saves, claims of all kinds.
const MIXED: &str = "scenario \"All that a checkpoint has to keep\"
step 10 ms
stop 120 ms
param gust = 4 m/s
fmu path = \"trajectory\" every 20 ms
fmu air  = \"wind\" every 30 ms { mean = [3, 2, 0] m/s, turbulence = 3.5 m/s, seed = seed }
fmu ctrl = \"quadcopter_controller\" every 20 ms
fmu quad = \"quadcopter\" { seed = seed }
fmu calm = \"wind\" every 60 ms { seed = 7 }
quad.state       -> ctrl.state, air.vehicle, calm.vehicle
quad.contact     -> ctrl.contact
path.setpoint    => ctrl.setpoint
air.velocity     -> quad.wind
calm.speed       -> ctrl.wind_speed
ctrl.rotor_speed => quad.rotor_speed
at 20 ms lasting 50 ms { set quad.wind = [1, 0, 0] * (gust + 1 m/s^2 * time) }
at 90 ms { set air.turbulence = 1 m/s }
assert near:  always dist(quad.state.position, path.setpoint.position) < 0.8 m
assert soon:  eventually within 60 ms quad.thrust > 1 N
assert again: always within 20..80 ms (eventually within 30 ms quad.state.velocity.z > 0 m/s)
assert then:  always (eventually (quad.state.position.x > 1 um or path.leg == 1))
assert blown: eventually rises(quad.thrust > 1 N)
record quad.state, quad.thrust, path.setpoint.position, air.velocity, calm.speed, ctrl.rotor_speed, quad.wind
";

/// Runs a script with the repository's units; its results are in `out`.
fn run_script(script: &str, out: &Path, more: &[&str]) -> Said {
    let out = out.to_str().unwrap();
    run(&repository(), &[&["run", script, "--out", out], more].concat())
}

fn read(folder: &Path, file: &str) -> String {
    fs::read_to_string(folder.join(file)).unwrap()
}

/// Continues a run and compares its results with those of the whole run, except for the first rows.
fn continues(script: &str, home: &Path, checkpoint: &str, rows_before: usize) {
    continues_as(script, home, checkpoint, rows_before, &[]);
}

fn continues_as(script: &str, home: &Path, checkpoint: &str, rows_before: usize, more: &[&str]) {
    let (whole, rest) = (home.join("whole"), home.join("rest"));
    let said = run_script(script, &rest, &[&["--from", home.join(checkpoint).to_str().unwrap()], more].concat());
    assert!(said.code.is_some_and(|code| code < 2), "{checkpoint}: {}", said.err);
    let trace = read(&whole, "trace.csv");
    let (header, rows) = trace.split_once('\n').unwrap();
    let later: Vec<_> = rows.split_inclusive('\n').skip(rows_before).collect();
    assert!(!later.is_empty());
    assert!(read(&rest, "trace.csv") == format!("{header}\n{}", later.concat()), "{checkpoint}: rows differ");
    for file in ["verdict.json", "signals.json"] {
        assert_eq!(read(&rest, file), read(&whole, file), "{checkpoint}: {file}");
    }
}

#[test]
fn a_scenario_that_was_saved_at_40_s_continues_to_the_same_end() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("at40");
    let save = ["--save-at", "40s", file.to_str().unwrap()];
    let said = run_script("scenarios/first_flight.scn", &home.path().join("whole"), &save);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(said.err.contains(&format!("saved {} at 40 s\n", file.display())), "{}", said.err);
    continues("scenarios/first_flight.scn", home.path(), "at40", 8001);
    let record: serde_json::Value = serde_json::from_str(&read(&home.path().join("rest"), "run.json")).unwrap();
    assert_eq!(record["from"]["checkpoint"]["name"].as_str(), file.to_str());
    assert_eq!(record["from"]["time_s"].as_f64(), Some(40.0));
    let golden = read(&repository(), "tests/golden/first_flight.csv");
    let saved = fs::read(home.path().join("whole/trace.csv")).unwrap();
    let hash = <sha2::Sha256 as sha2::Digest>::digest(saved).iter().fold(String::new(), |mut text, byte| {
        write!(text, "{byte:02x}").unwrap();
        text
    });
    assert!(golden.starts_with(&format!("# sha256 {hash},")), "a run that is saved leaves the rows of one that is not");
}

#[test]
fn a_run_continues_from_each_of_its_ticks() {
    let home = tempfile::tempdir().unwrap();
    let script = home.path().join("mixed.scn");
    fs::write(&script, MIXED).unwrap();
    let script = script.to_str().unwrap();
    let files: Vec<_> = (0..12).map(|tick| home.path().join(format!("at{tick}")).display().to_string()).collect();
    let times: Vec<_> = (0..12).map(|tick| format!("{} ms", tick * 10)).collect();
    let saves: Vec<_> =
        times.iter().zip(&files).flat_map(|(time, file)| ["--save-at", time.as_str(), file.as_str()]).collect();
    let unsaved = run_script(script, &home.path().join("unsaved"), &[]);
    assert!(unsaved.code.is_some_and(|code| code < 2), "{}", unsaved.err);
    assert_eq!(run_script(script, &home.path().join("whole"), &saves).code, unsaved.code);
    for file in ["trace.csv", "verdict.json"] {
        let [saved, unsaved] = ["whole", "unsaved"].map(|run| read(&home.path().join(run), file));
        assert!(saved == unsaved, "{file} of a run that is saved");
    }
    for tick in 0..12 {
        continues(script, home.path(), &format!("at{tick}"), tick + 1);
    }
}

#[test]
fn a_checkpoint_is_the_same_in_every_placement_and_continues_in_every_other() {
    let home = tempfile::tempdir().unwrap();
    let script = home.path().join("mixed.scn");
    fs::write(&script, MIXED).unwrap();
    let script = script.to_str().unwrap();
    for (out, more) in [("whole", &[][..]), ("isolated", &["--isolate"])] {
        let file = |tick: usize| home.path().join(format!("{out}{tick}")).display().to_string();
        let files = [0, 3, 7].map(file);
        let saves = ["--save-at", "0s", &files[0], "--save-at", "30ms", &files[1], "--save-at", "70ms", &files[2]];
        let said = run_script(script, &home.path().join(out), &[&saves, more].concat());
        assert!(said.code.is_some_and(|code| code < 2), "{out}: {}", said.err);
    }
    for tick in [0, 3, 7] {
        let [together, isolated] = ["whole", "isolated"].map(|out| fs::read(home.path().join(format!("{out}{tick}"))));
        assert!(together.unwrap() == isolated.unwrap(), "saved at tick {tick}");
        continues_as(script, home.path(), &format!("whole{tick}"), tick + 1, &["--isolate"]);
    }
}

/// Twenty ticks of a run of so many rows, always the same ones, spread over all of it.
fn seeded_ticks(rows: usize) -> Vec<usize> {
    let mut ticks: Vec<_> = (1..=20).map(|i: usize| i.wrapping_mul(0x9e37_79b9_7f4a_7c15) % (rows - 1)).collect();
    ticks.sort_unstable();
    ticks.dedup();
    ticks
}

#[test]
fn every_scenario_continues_from_twenty_ticks_in_both_placements() {
    for scenario in fs::read_dir(repository().join("scenarios")).unwrap() {
        let path = scenario.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "scn") {
            continue;
        }
        let (script, home) = (path.to_str().unwrap(), tempfile::tempdir().unwrap());
        let first = run_script(script, &home.path().join("first"), &[]);
        assert!(first.code.is_some_and(|code| code < 2), "{script}: {}", first.err);
        let trace = read(&home.path().join("first"), "trace.csv");
        let second_row = trace.lines().nth(2).unwrap().split(',').next().unwrap();
        let step_ns = second_row.parse::<f64>().unwrap() * 1e9;
        let ticks = seeded_ticks(trace.lines().count() - 1);
        assert!(ticks.len() > 15, "{script}: {ticks:?}");
        for (out, more) in [("whole", &[][..]), ("isolated", &["--isolate"])] {
            let time = |tick: usize| format!("{}ns", (tick as f64 * step_ns).round());
            let file = |tick: usize| home.path().join(format!("{out}{tick}")).display().to_string();
            let saves: Vec<_> =
                ticks.iter().flat_map(|&tick| ["--save-at".to_owned(), time(tick), file(tick)]).collect();
            let saves: Vec<_> = saves.iter().map(String::as_str).chain(more.iter().copied()).collect();
            let said = run_script(script, &home.path().join(out), &saves);
            assert_eq!(said.code, first.code, "{script}: {}", said.err);
        }
        for &tick in &ticks {
            let [together, isolated] = ["whole", "isolated"].map(|out| home.path().join(format!("{out}{tick}")));
            assert!(fs::read(together).unwrap() == fs::read(isolated).unwrap(), "{script}: checkpoints of tick {tick}");
            continues(script, home.path(), &format!("isolated{tick}"), tick + 1);
        }
        // A worker for each instance takes longer, so only the later half of the ticks.
        for &tick in &ticks[ticks.len() / 2..] {
            continues_as(script, home.path(), &format!("whole{tick}"), tick + 1, &["--isolate"]);
        }
    }
}

#[test]
fn a_continued_run_saves_the_same_checkpoint_as_the_whole_run() {
    let home = tempfile::tempdir().unwrap();
    let at = |name: &str| home.path().join(name).display().to_string();
    let [early, late, again] = ["early", "late", "again"].map(at);
    let script = "scenarios/breeze.scn";
    let saves = ["--save-at", "10s", &early, "--save-at", "20.01s", &late];
    assert_eq!(run_script(script, &home.path().join("whole"), &saves).code, Some(0));
    let said = run_script(script, &home.path().join("rest"), &["--from", &early, "--save-at", "20.01s", &again]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(fs::read(late).unwrap() == fs::read(again).unwrap());
}

#[test]
fn a_run_that_ends_before_its_save_time_warns_and_leaves_no_file() {
    let home = tempfile::tempdir().unwrap();
    let file = home.path().join("late");
    let slow = ["--set", "speed = 4 m/s", "--set", "gustiness = 12 m/s", "--fail-fast"];
    let save = ["--save-at", "83s", file.to_str().unwrap()];
    let said = run_script("scenarios/breeze.scn", &home.path().join("run"), &[&slow[..], &save].concat());
    assert_eq!(said.code, Some(1), "{}", said.err);
    let warning = said.err.lines().find(|line| line.starts_with("warning: ")).unwrap();
    let text = warning.replace(file.to_str().unwrap(), "late");
    assert!(text.starts_with("warning: late was not saved: the run ended at "), "{text}");
    assert!(text.ends_with(" s and was to be saved at 83 s"), "{text}");
    let left: Vec<_> = fs::read_dir(home.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, ["run"]);
}

/// The command and the messages of a refused run, which must leave no file; paths are relative to the folder.
fn refused(folder: &TempDir, arguments: &[&str]) -> String {
    let home = folder.path().to_str().unwrap();
    let script = folder.path().join("a.scn");
    let out = folder.path().join("run");
    let said = run_script(script.to_str().unwrap(), &out, arguments);
    assert_eq!((said.code, said.out.as_str()), (Some(2), ""), "{arguments:?}: {}", said.err);
    assert!(!out.exists(), "{arguments:?}");
    let relative = |text: &str| text.replace(&format!("{home}/"), "");
    format!("$ lockstep run a.scn {}\n{}\n", relative(&arguments.join(" ")), relative(&said.err))
}

const SHORT: &str = "scenario \"A short run\"\nparam dt = 10 ms\nparam speed = 5 m/s\nstep dt\nstop 1 s\n\
                     fmu path = \"trajectory\" { speed = speed }\nrecord path.setpoint.position\n";

/// A folder with a script, and the path of a checkpoint of its run at half a second.
fn saved() -> (TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("a.scn");
    fs::write(&script, SHORT).unwrap();
    let at = folder.path().join("at").display().to_string();
    let out = folder.path().join("saved");
    let said = run_script(script.to_str().unwrap(), &out, &["--save-at", "500ms", &at]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    (folder, at)
}

#[test]
fn a_time_at_which_nothing_can_be_saved_is_refused_with_its_neighbours() {
    let (folder, at) = saved();
    let to = folder.path().join("to").display().to_string();
    let nowhere = folder.path().join("no/where").display().to_string();
    let home = folder.path().join("saved").display().to_string();
    let commands: [&[&str]; 10] = [
        &["--save-at", "123 ms", &to],
        &["--save-at", "1 ns", &to],
        &["--save-at", "1s", &to],
        &["--save-at", "2min", &to],
        &["--save-at", "soon", &to],
        &["--save-at", "5", &to],
        &["--save-at", "1s"],
        &["--save-at", "100ms", &nowhere],
        &["--save-at", "100ms", &home],
        &["--from", &at, "--save-at", "500ms", &to],
    ];
    insta::assert_snapshot!(commands.map(|arguments| refused(&folder, arguments)).concat());
}

/// Writes the same unit as an archive with other bytes.
fn repacked(from: &Path, to: &Path) {
    let mut unit = ZipArchive::new(File::open(from).unwrap()).unwrap();
    let mut other = ZipWriter::new(File::create(to).unwrap());
    for index in 0..unit.len() {
        other.raw_copy_file(unit.by_index_raw(index).unwrap()).unwrap();
    }
    other.add_directory("documentation/more", zip::write::SimpleFileOptions::default()).unwrap();
    other.finish().unwrap();
}

#[test]
fn differences_from_the_saved_run_are_reported() {
    let (folder, at) = saved();
    let script = folder.path().join("a.scn");
    let missing = folder.path().join("missing").display().to_string();
    let trace = folder.path().join("saved/trace.csv").display().to_string();
    let mut text = refused(&folder, &["--from", &at, "--set", "speed = 6 m/s"]);
    text += &refused(&folder, &["--from", &at, "--set", "dt = 5 ms", "--set", "seed = 2"]);
    text += &refused(&folder, &["--from", &missing]);
    text += &refused(&folder, &["--from", &trace]);
    let packed = run(&repository(), &["pack", "trajectory"]);
    let units = folder.path().join("units");
    fs::create_dir(&units).unwrap();
    repacked(Path::new(packed.out.trim()), &units.join("trajectory.fmu"));
    let said = refused(&folder, &["--from", &at, "--units", units.to_str().unwrap()]);
    let hash = |text: &str| text.split("sha256 ").skip(1).map(|rest| rest[..12].to_owned()).collect::<Vec<_>>();
    let [was, is] = &hash(&said)[..] else { panic!("{said}") };
    assert_ne!(was, is);
    text += &said.replace(was, "(was)").replace(is, "(is)");
    fs::write(&script, SHORT.replace("A short run", "Another run")).unwrap();
    let said = refused(&folder, &["--from", &at]);
    let [was, is] = &hash(&said)[..] else { panic!("{said}") };
    text += &said.replace(was, "(was)").replace(is, "(is)");
    insta::assert_snapshot!(text);
}

#[test]
fn a_file_that_is_cut_or_changed_is_refused() {
    let (folder, at) = saved();
    let whole = fs::read(&at).unwrap();
    let cuts = [0, 7, 8, 11, 12, 40, 52, whole.len() / 2, whole.len() - 1].map(|length| whole[..length].to_vec());
    let flips = [0, 9, 13, 30, 52, 60, whole.len() / 2, whole.len() - 1].map(|byte| {
        let mut flipped = whole.clone();
        flipped[byte] ^= 0x10;
        flipped
    });
    let longer = [&whole[..], b"\0"].concat();
    for bytes in cuts.iter().chain(&flips).chain([&longer]) {
        fs::write(&at, bytes).unwrap();
        let said = refused(&folder, &["--from", &at]);
        assert!(said.contains("error: cannot continue from at: "), "{said}");
    }
}

#[test]
fn units_that_cannot_save_their_state_are_named_at_once_before_the_run() {
    let flag = "canHandleVariableCommunicationStepSize=\"true\"";
    let half = format!("{flag} canGetAndSetFMUstate=\"true\"");
    let (folder, _) = Foreign::default().build();
    let (other, fmu) = Foreign { description: &[(flag, &half)], ..Foreign::default() }.build();
    fs::copy(fmu, folder.path().join("half.fmu")).unwrap();
    drop(other);
    let values = "{ u = 0, enabled = true }";
    let script = format!(
        "scenario \"Units without states\"\nstep 100 ms\nstop 1 s\nfmu path = \"trajectory\"\n\
         fmu a = \"foreign.fmu\" {values}\nfmu b = \"half.fmu\" {values}\nfmu c = \"foreign.fmu\" {values}\n\
         record path.leg, a.y, b.y, c.y\n"
    );
    fs::write(folder.path().join("a.scn"), script).unwrap();
    let to = folder.path().join("to").display().to_string();
    let text = refused(&folder, &["--save-at", "500ms", &to]) + &refused(&folder, &["--from", &to]);
    insta::assert_snapshot!(text);
}

/// A folder with a script and a unit in C that declares that it saves its state.
fn foreign(defines: &[&str]) -> TempDir {
    let (folder, _) = Foreign { defines, description: &[CLAIMS_STATES], ..Foreign::default() }.build();
    let script = "scenario \"A foreign unit\"\nstep 100 ms\nstop 1 s\nfmu a = \"foreign.fmu\" { label = \"mine\" }\n\
                  fmu b = \"foreign.fmu\" every 300 ms { enabled = false }\n1 + time / 1 s -> a.u\na.y -> b.u\n\
                  at 300 ms lasting 300 ms { set a.enabled = true }\n\
                  assert up: always within 0..300 ms (eventually within 700 ms b.y > 0.1)\n\
                  record a.y, a.count, a.enabled, b.y\n";
    fs::write(folder.path().join("a.scn"), script).unwrap();
    folder
}

#[test]
fn a_foreign_unit_is_saved_and_continued_with_the_functions_of_the_standard() {
    let folder = foreign(&["WITH_STATES"]);
    let script = folder.path().join("a.scn");
    let script = script.to_str().unwrap();
    for tick in 0..10 {
        let file = folder.path().join("at").display().to_string();
        let said = run_script(script, &folder.path().join("whole"), &["--save-at", &format!("{tick}00ms"), &file]);
        assert_eq!(said.code, Some(0), "{}", said.err);
        continues(script, folder.path(), "at", tick + 1);
    }
}

#[test]
fn a_unit_that_cannot_save_its_state_as_declared_breaks_the_run_and_is_named() {
    for (define, message) in [
        ("STEP_TAKES_US=0", "fmi2GetFMUstate returned fmi2Error at 0.5 s"),
        ("WITHOUT_STATES", "its library lacks the function `fmi2GetFMUstate` of its modelDescription.xml, at 0.5 s"),
    ] {
        let folder = foreign(&[define]);
        let said = run(folder.path(), &["run", "a.scn", "--save-at", "500ms", "to"]);
        assert_eq!(said.code, Some(3), "{}", said.err);
        assert!(said.err.contains(&format!("error: `a`: {message}\n")), "{}", said.err);
        assert!(said.err.contains("warning: to was not saved: the run broke at 0.5 s"), "{}", said.err);
        assert!(!folder.path().join("to").exists());
    }
}
