//! Results of a run: its files, its exit code, and the use of the files by `plot` and `diff`.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::fs;
use std::path::Path;
use std::process::Stdio;
use tempfile::TempDir;
use tests::foreign::Foreign;
use tests::program::{Said, command, repository, run};

const SCRIPT: &str = "scenario \"A unit follows a ramp\"\nstep 100 ms\nstop 300 ms\nparam slope = 1\n\
                      fmu probe = \"foreign.fmu\"\nslope * time / 1 s -> probe.u\n\
                      at 200 ms { set probe.enabled = true }\n";
const LOW: &str = "assert low: always probe.y < 5 m\n";
const LOST: &str = "assert lost: always probe.y < 1 cm\n";
const RECORD: &str = "record probe.y, probe.enabled, probe.'phase, all'\n";

/// Replacements in the description: a unit of length, an enumeration, and a name with a comma.
const DESCRIPTION: [(&str, &str); 5] = [
    ("variableNamingConvention=\"structured\"", "variableNamingConvention=\"flat\""),
    (
        "<LogCategories>",
        "<UnitDefinitions><Unit name=\"m\"><BaseUnit m=\"1\"/></Unit></UnitDefinitions>\n  <TypeDefinitions>\
         <SimpleType name=\"Phase\"><Enumeration><Item name=\"rest\" value=\"0\"/><Item name=\"climb\" value=\"1\"/>\
         <Item name=\"cruise\" value=\"2\"/><Item name=\"land\" value=\"3\"/></Enumeration></SimpleType>\
         </TypeDefinitions>\n  <LogCategories>",
    ),
    (
        "name=\"y\" valueReference=\"2\" causality=\"output\" variability=\"continuous\" initial=\"exact\">\n      \
         <Real start",
        "name=\"y\" valueReference=\"2\" causality=\"output\" variability=\"continuous\" initial=\"exact\" \
         description=\"How far it came\">\n      <Real unit=\"m\" start",
    ),
    ("name=\"count\"", "name=\"phase, all\""),
    ("<Integer start", "<Enumeration declaredType=\"Phase\" start"),
];

/// A folder with the unit and `ramp.scn`.
fn with_script(defines: &[&str], lines: &str) -> TempDir {
    let (folder, _) = Foreign { defines, description: &DESCRIPTION, ..Foreign::default() }.build();
    fs::write(folder.path().join("ramp.scn"), format!("{SCRIPT}{lines}")).unwrap();
    folder
}

/// Runs the script, expects this exit code, and returns the standard output.
fn ramp(folder: &TempDir, arguments: &[&str], code: i32) -> String {
    let said = run(folder.path(), &[&["run", "ramp.scn"], arguments].concat());
    assert_eq!(said.code, Some(code), "{}{}", said.out, said.err);
    said.out
}

fn text(folder: &TempDir, file: &str) -> String {
    fs::read_to_string(folder.path().join(file)).unwrap()
}

fn read_json(folder: &TempDir, file: &str) -> Value {
    serde_json::from_str(&text(folder, file)).unwrap()
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn sha256(folder: &TempDir, file: &str) -> String {
    Sha256::digest(fs::read(folder.path().join(file)).unwrap()).iter().map(|byte| format!("{byte:02x}")).collect()
}

#[test]
fn a_trace_has_time_first_numbers_for_all_types_and_quotes_around_commas() {
    let folder = with_script(&[], RECORD);
    ramp(&folder, &[], 0);
    assert_eq!(
        text(&folder, "runs/ramp/trace.csv"),
        "time,probe.y,probe.enabled,\"probe.phase, all\"\n0,0,0,0\n0.1,0,0,1\n\
         0.2,0.020000000000000004,1,2\n0.3,0.05800000000000001,1,3\n"
    );
}

#[test]
fn each_column_has_its_unit_instance_causality_and_description() {
    let folder = with_script(&[], RECORD);
    ramp(&folder, &[], 0);
    let signals = read_json(&folder, "runs/ramp/signals.json");
    let names: Vec<_> = signals.as_array().unwrap().iter().map(|signal| &signal["name"]).collect();
    assert_eq!(names, ["time", "probe.y", "probe.enabled", "probe.phase, all"]);
    let attributes = |index: usize| {
        ["unit", "instance", "variable", "type", "causality", "description"].map(|key| signals[index][key].as_str())
    };
    let (probe, input, output) = (Some("probe"), Some("input"), Some("output"));
    assert_eq!(attributes(0), [Some("s"), None, None, Some("Real"), Some("independent"), Some("Simulated time")]);
    assert_eq!(attributes(1), [Some("m"), probe, Some("y"), Some("Real"), output, Some("How far it came")]);
    assert_eq!(attributes(2), [None, probe, Some("enabled"), Some("Boolean"), input, None]);
    assert_eq!(attributes(3), [None, probe, Some("phase, all"), Some("Enumeration"), output, None]);
    assert_eq!(signals[3]["items"], json!({"0": "rest", "1": "climb", "2": "cruise", "3": "land"}));
}

#[test]
fn without_a_record_line_all_connected_or_claimed_variables_are_recorded() {
    let folder = with_script(&[], LOW);
    ramp(&folder, &[], 0);
    let trace = text(&folder, "runs/ramp/trace.csv");
    assert_eq!(trace.lines().next(), Some("time,probe.u,probe.y"), "{trace}");
}

#[test]
fn with_json_the_output_is_the_verdict_only() {
    let folder = with_script(&[], &format!("{LOW}{LOST}"));
    let out = ramp(&folder, &["--json", "--set", "slope = 2"], 1);
    assert_eq!(out, text(&folder, "runs/ramp/verdict.json"));
    let verdict: Value = serde_json::from_str(&out).unwrap();
    let set = json!({"name": "slope", "value": "2", "set": true});
    assert!(verdict["parameters"].as_array().unwrap().contains(&set), "{out}");
    assert_eq!((&verdict["script"], &verdict["end"]), (&json!("ramp.scn"), &json!("stop time")));
    assert_eq!(verdict["time_s"], 0.3);
    let claim = |i: usize| ["name", "verdict", "margin", "unit", "at_s"].map(|key| verdict["claims"][i][key].clone());
    assert_eq!(json!(claim(0)), json!(["low", "ok", 5.0 - 0.11600000000000002, "m", 0.3]));
    assert_eq!(json!(claim(1)), json!(["lost", "failed", (0.01 - 0.11600000000000002) / 0.01, "cm", 0.3]));
}

#[test]
fn run_json_has_the_hashes_of_script_and_units_the_version_and_the_end() {
    let folder = with_script(&[], RECORD);
    ramp(&folder, &[], 0);
    let record = read_json(&folder, "runs/ramp/run.json");
    assert_eq!(record["state"], "finished");
    assert_eq!(record["lockstep"], env!("CARGO_PKG_VERSION"));
    assert_eq!(record["script"], json!({"name": "ramp.scn", "sha256": sha256(&folder, "ramp.scn")}));
    assert_eq!(record["units"], json!([{"name": "foreign.fmu", "sha256": sha256(&folder, "foreign.fmu")}]));
    assert_eq!((&record["simulated_s"], &record["broken"]), (&json!(0.3), &Value::Null));
    assert!(record["wall_s"].as_f64().is_some_and(|wall_s| wall_s > 0.0));
}

#[test]
fn with_record_none_claims_are_judged_and_no_rows_are_written() {
    let folder = with_script(&[], &format!("{LOW}{RECORD}"));
    let out = ramp(&folder, &["--record", "none"], 0);
    assert!(out.contains("ok  low") && !out.contains("lockstep plot"), "{out}");
    assert_eq!(files(&folder.path().join("runs/ramp")), ["events.csv", "run.json", "verdict.json"]);
}

#[test]
fn out_names_the_folder_and_an_earlier_run_in_it_is_replaced() {
    let folder = with_script(&[], RECORD);
    ramp(&folder, &["--out", "deep/down/here"], 0);
    let here = folder.path().join("deep/down/here");
    assert_eq!(files(&here), ["events.csv", "run.json", "signals.json", "trace.csv", "trace.parquet", "verdict.json"]);
    assert!(!folder.path().join("runs").exists());
    fs::write(here.join("notes.txt"), "mine").unwrap();
    ramp(&folder, &["--out", "deep/down/here", "--record", "none"], 0);
    assert_eq!(
        files(&here),
        ["events.csv", "notes.txt", "run.json", "verdict.json"],
        "no row of the earlier run is left"
    );
}

#[test]
fn the_exit_code_reflects_the_verdicts_of_the_claims() {
    let lasting = "assert lasts: always within 200..300 ms probe.y < 5 m\n";
    let done = ["MISBEHAVE_CALL=STEP", "MISBEHAVE_HOW=TERMINATED", "MISBEHAVE_FROM_S=0.05"];
    for (defines, lines, code, message) in [
        (&[][..], "", 0, "No claims in this script: nothing was judged."),
        (&[][..], LOW, 0, "The claim holds."),
        (&[][..], LOST, 1, "1 of 1 claims failed."),
        (&done[..], lasting, 4, "1 of 1 claims could not be judged."),
    ] {
        let folder = with_script(defines, lines);
        let out = ramp(&folder, &[], code);
        assert!(out.contains(message), "{code}: {out}");
    }
}

#[test]
fn fail_fast_ends_the_run_at_the_first_failed_claim() {
    let folder = with_script(&[], &format!("{LOW}{LOST}"));
    let out = ramp(&folder, &["--fail-fast"], 1);
    assert!(out.starts_with("ramp.scn  0.2 s of 0.3 s, claim `lost` lost, in "), "{out}");
    assert_eq!(text(&folder, "runs/ramp/trace.csv").lines().last(), Some("0.2,0.1,0.020000000000000004"));
    assert_eq!(read_json(&folder, "runs/ramp/verdict.json")["end"], "claim `lost` lost");
}

#[test]
fn the_commands_at_the_end_of_a_run_work_as_printed() {
    let folder = with_script(&[], RECORD);
    ramp(&folder, &["--out", "other"], 0);
    let out = ramp(&folder, &[], 0);
    let lines: Vec<_> = out.lines().skip_while(|line| *line != "runs/ramp").skip(1).collect();
    let [plot, diff] = lines[..] else { panic!("{out}") };
    let as_typed = |line: &str| {
        let line = line.replace("OTHER", "other");
        run(folder.path(), &line.split_whitespace().skip(1).collect::<Vec<_>>())
    };
    let drawn = as_typed(plot);
    assert_eq!((drawn.code, drawn.out.as_str()), (Some(0), "runs/ramp/plot.svg\n"), "{}", drawn.err);
    let compared = as_typed(diff);
    assert_eq!((compared.code, compared.out.as_str()), (Some(0), "identical: 4 rows, every cell\n"));
}

#[test]
fn a_plot_is_an_svg_and_an_unknown_signal_is_reported_with_the_nearest_name() {
    let folder = with_script(&[], RECORD);
    ramp(&folder, &[], 0);
    let drawn = run(folder.path(), &["plot", "runs/ramp", "probe.y", "--out", "y.svg"]);
    assert_eq!((drawn.code, drawn.out.as_str()), (Some(0), "y.svg\n"), "{}", drawn.err);
    let picture = text(&folder, "y.svg");
    let document = roxmltree::Document::parse(&picture).unwrap();
    assert_eq!(document.root_element().tag_name().name(), "svg");
    assert!(document.descendants().any(|node| node.text().is_some_and(|text| text.contains("probe.y"))), "{picture}");
    let wrong = run(folder.path(), &["plot", "runs/ramp", "prob.y"]);
    assert_eq!(wrong.code, Some(2));
    assert_eq!(
        wrong.err,
        "error: no column or group `prob.y` was recorded; did you mean `probe.y`?\n\
         help: recorded are: time, probe.y, probe.enabled, probe.phase, all\n"
    );
    let nothing = run(folder.path(), &["plot", "runs"]);
    assert_eq!(nothing.code, Some(2));
    assert!(nothing.err.starts_with("error: runs is neither a run's folder nor a trace.csv\n"), "{}", nothing.err);
}

#[test]
fn diff_reports_the_first_tick_and_port_that_differ_and_by_how_much() {
    let folder = with_script(&[], RECORD);
    ramp(&folder, &["--out", "slow"], 0);
    ramp(&folder, &["--out", "fast", "--set", "slope = 2"], 0);
    let differ = run(folder.path(), &["diff", "slow", "fast"]);
    assert_eq!(differ.code, Some(1));
    assert_eq!(
        differ.out,
        "first difference at 0.2 s (row 2) in probe.y: 0.020000000000000004 m and 0.04000000000000001 m, \
         2.000e-2 m apart\n  probe.y: 2 rows, at most 5.800e-2 m apart\n"
    );
    fs::write(folder.path().join("ragged.csv"), "time,probe.y\n0\n").unwrap();
    for (other, message) in
        [("none", "none is neither a run's folder"), ("ragged.csv", "ragged.csv:2:1: expected 2 values")]
    {
        let unreadable = run(folder.path(), &["diff", "slow", other]);
        assert_eq!((unreadable.code, unreadable.out.as_str()), (Some(2), ""));
        assert!(unreadable.err.starts_with(&format!("error: {message}")), "{}", unreadable.err);
    }
}

#[test]
fn a_failed_write_to_standard_output_is_an_error() {
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let ended = command(&repository(), &["describe"]).stdout(full).stderr(Stdio::piped()).output().unwrap();
    let said = Said::from(ended);
    assert_eq!(said.code, Some(2), "{}", said.err);
    assert!(said.err.starts_with("error: cannot write to standard output: "), "{}", said.err);
}
