//! Three missions with many units: their claims hold, each is lost where its margin is cut, and processes of their own or
//! another style change nothing. The scripts are in `dsl/corpus/parse/`; units that do not exist are stand-ins of
//! `tests/missions/`, beside the tables.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use serde_json::Value;
use std::fs;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use tests::program::{Said, names, repository, run};
use tests::stand_ins;

/// Files of results that say nothing about where and how the run was made.
const RESULTS: [&str; 5] = ["trace.csv", "trace.parquet", "signals.json", "events.csv", "verdict.json"];

/// How a claim is cut and lost.
struct Cut {
    claim: &'static str,
    from: &'static str,
    to: &'static str,
    lost: Lost,
}

/// What is known of the margin and the time of a lost claim.
enum Lost {
    /// A limit moved by this much, in the claim's unit: so does the margin, at the same time.
    Limit(f64),
    /// A window became shorter: the margin is negative, at a time between these (s).
    Window(RangeInclusive<f64>),
}

/// A mission.
struct Script {
    file: &'static str,
    /// Ticks, times, changes and conditions of its `at` windows.
    windows: &'static [&'static str],
    /// A claim, and its margin as the recorded values show it.
    margin: (&'static str, fn(&Records) -> f64),
    /// Its step and one twice as long, with which the first cut is also tried in processes of its own.
    coarse: [&'static str; 2],
    cuts: &'static [Cut],
}

const QUADCOPTER: Script = Script {
    file: "quadcopter_among_obstacles.scn",
    windows: &["6000,30,opened,30 s", "7600,38,closed,30 s", "9000,45,opened,45 s", "9400,47,closed,45 s"],
    margin: ("clear", |records| least(&records.column("world.clearance")) - 0.8),
    coarse: ["step 5 ms", "step 10 ms"],
    cuts: &[
        Cut { claim: "clear", from: "> 0.8 m", to: "> 1.8 m", lost: Lost::Limit(1.0) },
        Cut { claim: "arrive", from: "within 85 s", to: "within 50 s", lost: Lost::Window(50.0..=52.0) },
        Cut { claim: "tilt", from: "< 35 deg", to: "< 10 deg", lost: Lost::Limit(25.0) },
        Cut { claim: "recover", from: "within 4 s", to: "within 500 ms", lost: Lost::Window(40.0..=43.0) },
    ],
};

const AUV: Script = Script {
    file: "auv_with_range_finder.scn",
    windows: &["1200,60,opened,60 s", "1400,70,closed,60 s"],
    margin: ("safe", |records| least(&records.column("sea.clearance")) - 0.3),
    coarse: ["step 50 ms", "step 100 ms"],
    cuts: &[
        Cut { claim: "safe", from: "> 0.3 m", to: "> 3 m", lost: Lost::Limit(2.7) },
        Cut { claim: "reach", from: "within 220 s", to: "within 60 s", lost: Lost::Window(59.0..=60.0) },
        Cut { claim: "gentle", from: "< 30 deg/s", to: "< 15 deg/s", lost: Lost::Limit(15.0) },
    ],
};

const FORMATION: Script = Script {
    file: "formation.scn",
    windows: &["4000,40,opened,40 s", "5500,55,closed,40 s", "7000,70,opened,70 s", "7300,73,closed,70 s"],
    margin: ("dodges[2]", |records| least(&records.distance("wing[2].body.state.position", "mover.position[1]")) - 4.0),
    coarse: ["step 10 ms", "step 20 ms"],
    cuts: &[
        Cut { claim: "dodges[2]", from: "gap > 4 m", to: "gap > 6 m", lost: Lost::Limit(2.0) },
        Cut { claim: "regroup", from: "within 12 s", to: "within 4 s", lost: Lost::Window(73.0..=77.0) },
        Cut { claim: "apart", from: ") > 3 m", to: ") > 6 m", lost: Lost::Limit(3.0) },
        Cut { claim: "script", from: "< 1 cm", to: "< 0.2 cm", lost: Lost::Limit(0.8) },
    ],
};

fn fixtures() -> PathBuf {
    repository().join("tests/missions")
}

/// A folder with the script and its part, the tables, and the stand-ins that these name.
fn home(script: &Script) -> TempDir {
    let home = tempfile::tempdir().unwrap();
    fs::create_dir(home.path().join("units")).unwrap();
    fs::create_dir(home.path().join("ref")).unwrap();
    let text = ["uav.scn", script.file].map(|file| {
        let text = fs::read_to_string(repository().join("dsl/corpus/parse").join(file)).unwrap();
        fs::write(home.path().join(file), &text).unwrap();
        text
    });
    let text = text.concat();
    for file in names(&fixtures()).iter().chain([&"ref/crossing.csv".to_owned()]) {
        let source = fixtures().join(file);
        match source.extension().map(|extension| extension.to_str().unwrap()) {
            Some("csv") => drop(fs::copy(&source, home.path().join(file)).unwrap()),
            Some("c") if text.contains(&format!("\"{}\"", file.trim_end_matches(".c"))) => {
                stand_ins::pack(&source, &home.path().join("units"));
            }
            _ => {}
        }
    }
    home
}

/// Calls `lockstep` with the script, from the repository: so units that do exist are found, and built.
fn lockstep(home: &Path, script: &Script, command: &str, options: &[&str]) -> Said {
    let [units, file] = ["units", script.file].map(|name| home.join(name).display().to_string());
    run(&repository(), &[&[command, &file, "--units", &units][..], options].concat())
}

/// The results of a run with some options, which ends with an exit code.
fn ran(home: &Path, script: &Script, out: &str, options: &[&str], code: i32) -> PathBuf {
    let out = home.join(out);
    let said = lockstep(home, script, "run", &[&["--out", out.to_str().unwrap()], options].concat());
    assert_eq!(said.code, Some(code), "{} {options:?}\n{}{}", script.file, said.out, said.err);
    out
}

fn assert_same(first: &Path, second: &Path, files: &[&str]) {
    for file in files {
        let [first, second] = [first, second].map(|folder| fs::read(folder.join(file)).unwrap());
        assert!(first == second, "{file} differs");
    }
}

fn claims(results: &Path) -> Vec<Value> {
    let verdict: Value = serde_json::from_slice(&fs::read(results.join("verdict.json")).unwrap()).unwrap();
    verdict["claims"].as_array().unwrap().clone()
}

/// Runs the script as it is and with each cut.
fn holds_and_is_lost(script: &Script) {
    let home = home(script);
    let home = home.path();
    let text = fs::read_to_string(home.join(script.file)).unwrap();
    let whole = ran(home, script, "whole", &[], 0);
    assert_same(&whole, &ran(home, script, "isolated", &["--isolate"], 0), &RESULTS);
    let held = claims(&whole);
    assert!(held.iter().all(|claim| claim["verdict"] == "ok" && claim["untested"].is_null()), "{held:#?}");
    assert_as_recorded(script, &whole, &held);
    for (index, cut) in script.cuts.iter().enumerate() {
        assert_eq!(text.matches(cut.from).count(), 1, "{}", cut.from);
        let text = text.replace(cut.from, cut.to);
        fs::write(home.join(script.file), &text).unwrap();
        let results = ran(home, script, "cut", &[], 1);
        assert_same(&whole, &results, &["trace.csv", "events.csv"]);
        assert_lost(cut, &held, &claims(&results));
        if index == 0 {
            let [step, coarse] = script.coarse;
            fs::write(home.join(script.file), text.replace(step, coarse)).unwrap();
            let results = ran(home, script, "coarse", &[], 1);
            assert_eq!(failed(&claims(&results)), [cut.claim]);
            assert_same(&results, &ran(home, script, "isolated", &["--isolate"], 1), &RESULTS);
        }
    }
}

/// Checks the windows of the run, and a margin against rows between which its sample lies.
fn assert_as_recorded(script: &Script, results: &Path, held: &[Value]) {
    let events = fs::read_to_string(results.join("events.csv")).unwrap();
    let cells = events.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let timed = cells.filter(|cells| cells[4].ends_with(" s"));
    let windows: Vec<_> = timed.map(|cells| [&cells[..3], &cells[4..]].concat().join(",")).collect();
    assert_eq!(windows, script.windows);
    let (name, margin) = script.margin;
    let shown = margin(&Records::of(results));
    let margin = held.iter().find(|claim| claim["name"] == name).unwrap()["margin"].as_f64().unwrap();
    assert!((margin..margin + 0.01).contains(&shown), "{name}: {margin}, recorded is {shown}");
}

/// The names of claims that failed.
fn failed(claims: &[Value]) -> Vec<&str> {
    claims.iter().filter(|claim| claim["verdict"] == "failed").map(|claim| claim["name"].as_str().unwrap()).collect()
}

/// Checks that of all claims this one is lost, where it should be.
fn assert_lost(cut: &Cut, held: &[Value], claims: &[Value]) {
    assert_eq!(failed(claims), [cut.claim]);
    let place = claims.iter().position(|claim| claim["name"] == cut.claim).unwrap();
    let (held, claim) = (&held[place], &claims[place]);
    let [margin, at] = ["margin", "at_s"].map(|key| claim[key].as_f64().unwrap());
    assert!(margin < 0.0 && claim["because"].is_string(), "{claim:#?}");
    match &cut.lost {
        Lost::Limit(by) => {
            let moved = held["margin"].as_f64().unwrap() - margin;
            assert!((moved - by).abs() < 1e-9 && claim["at_s"] == held["at_s"], "{held:#?}\n{claim:#?}");
        }
        Lost::Window(times) => assert!(times.contains(&at), "{claim:#?}"),
    }
}

/// A trace.
struct Records(Vec<Vec<String>>);

impl Records {
    fn of(results: &Path) -> Self {
        let trace = fs::read_to_string(results.join("trace.csv")).unwrap();
        Self(trace.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect())
    }

    fn column(&self, name: &str) -> Vec<f64> {
        let place = self.0[0].iter().position(|column| column == name).unwrap();
        self.0[1..].iter().map(|row| row[place].parse().unwrap()).collect()
    }

    fn distance(&self, first: &str, second: &str) -> Vec<f64> {
        let mut squares = vec![0.0; self.0.len() - 1];
        for axis in ["x", "y", "z"] {
            let [first, second] = [first, second].map(|name| self.column(&format!("{name}.{axis}")));
            for (square, (first, second)) in squares.iter_mut().zip(first.iter().zip(second)) {
                *square += (first - second) * (first - second);
            }
        }
        squares.into_iter().map(f64::sqrt).collect()
    }
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

#[test]
fn the_quadcopter_holds_its_claims_and_loses_each_where_its_margin_is_cut() {
    holds_and_is_lost(&QUADCOPTER);
}

#[test]
fn the_auv_holds_its_claims_and_loses_each_where_its_margin_is_cut() {
    holds_and_is_lost(&AUV);
}

#[test]
fn the_formation_holds_its_claims_and_loses_each_where_its_margin_is_cut() {
    holds_and_is_lost(&FORMATION);
}

#[test]
fn a_run_without_one_of_the_disturbances_is_another_one() {
    for script in [QUADCOPTER, AUV, FORMATION] {
        let home = home(&script);
        let home = home.path();
        let whole = fs::read(ran(home, &script, "whole", &[], 0).join("trace.csv")).unwrap();
        let text = fs::read_to_string(home.join(script.file)).unwrap();
        for line in text.lines().filter(|line| line.starts_with("at ") || line.starts_with("while ")) {
            fs::write(home.join(script.file), text.replace(line, "")).unwrap();
            let out = home.join("without");
            let said = lockstep(home, &script, "run", &["--out", out.to_str().unwrap()]);
            assert!(matches!(said.code, Some(0 | 1)), "{line}\n{}{}", said.out, said.err);
            assert!(fs::read(out.join("trace.csv")).unwrap() != whole, "{line}");
        }
    }
}

#[test]
fn a_case_of_the_sweep_with_the_values_of_the_script_is_the_run_without_a_case() {
    for (script, case) in [(QUADCOPTER, "25"), (FORMATION, "25")] {
        let home = home(&script);
        let whole = ran(home.path(), &script, "whole", &[], 0);
        assert_same(&whole, &ran(home.path(), &script, "case", &["--case", case], 0), &["trace.csv", "events.csv"]);
    }
}

#[test]
fn formatted_scripts_keep_their_meaning() {
    for script in [QUADCOPTER, AUV, FORMATION] {
        let home = home(&script);
        let home = home.path();
        let files = ["uav.scn", script.file].map(|file| home.join(file).display().to_string());
        let meaning = |out: &str| {
            let checked = lockstep(home, &script, "check", &["-v"]);
            assert_eq!(checked.code, Some(0), "{}{}", checked.out, checked.err);
            // Warnings show the lines that they are about.
            let plan: Vec<_> = checked.out.lines().filter(|line| !line.contains(" | ")).map(str::to_owned).collect();
            (plan, ran(home, &script, out, &[], 0))
        };
        let (plan, results) = meaning("written");
        let text = |of: &str| fs::read_to_string(of).unwrap();
        let written = files.each_ref().map(|file| text(file));
        let format =
            |options: &[&str]| run(home, &[&["fmt"], options, &files.each_ref().map(|file| &**file)].concat()).code;
        assert_eq!((format(&["--check"]), format(&[]), format(&["--check"])), (Some(1), Some(0), Some(0)));
        let formatted = files.each_ref().map(|file| text(file));
        assert!(written.iter().zip(&formatted).all(|(written, formatted)| written != formatted));
        assert_eq!(format(&[]), Some(0));
        assert_eq!(formatted, files.each_ref().map(|file| text(file)), "a second time changes nothing");
        let (formatted_plan, formatted_results) = meaning("formatted");
        assert_eq!(formatted_plan, plan);
        assert_same(&results, &formatted_results, &RESULTS);
    }
}
