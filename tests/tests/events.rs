//! Windows, faults and early ends of runs, as a user sees them, in both placements.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;
use tempfile::TempDir;
use tests::foreign::{Generic, STATES};
use tests::program::{PLACEMENTS, run};

const SCRIPT: &str = "scenario \"Conditions and faults\"
step 10 ms
stop 200 ms
stop when a.y >= 15 held 20 ms
fmu a = \"node.fmu\"
fmu b = \"node.fmu\"
fmu c = \"node.fmu\" every 20 ms
a.y    -> b.u
a.n    -> b.m
a.odd  -> b.flag
a.said -> b.heard
a.y    => c.u
at 20 ms lasting 30 ms { fault b.m: delay 20 ms }
while 4 <= a.y < 7 { fault b.u: bias 100, fault b.heard: freeze }
when a.odd lasting 10 ms { fault b.flag: freeze }
when a.y > 8 held 10 ms { set b.u = -1 }
at 100 ms lasting 60 ms { fault c.u: noise 0.5, loss 50 % }
assert quick: eventually a.y > 3
record a.y, b.u, b.m, b.flag, c.u, b.length
";

/// A unit that counts its steps in values of each type, and says how long the text is that it got.
fn node() -> TempDir {
    let variable = |(name, reference, kind): (&str, u32, &str)| {
        let causality = if reference == 0 { "input" } else { "output" };
        let (variability, start) = match (kind, reference) {
            ("Real", 0) => ("continuous", " start=\"0\""),
            ("Real", _) => ("continuous", ""),
            ("Boolean", 0) => ("discrete", " start=\"false\""),
            ("String", 0) => ("discrete", " start=\"\""),
            (_, 0) => ("discrete", " start=\"0\""),
            _ => ("discrete", ""),
        };
        format!(
            "<ScalarVariable name=\"{name}\" valueReference=\"{reference}\" causality=\"{causality}\" \
             variability=\"{variability}\"><{kind}{start}/></ScalarVariable>"
        )
    };
    let variables = [
        ("u", 0, "Real"),
        ("m", 0, "Integer"),
        ("flag", 0, "Boolean"),
        ("heard", 0, "String"),
        ("y", 1, "Real"),
        ("n", 1, "Integer"),
        ("odd", 1, "Boolean"),
        ("said", 1, "String"),
        ("length", 2, "Integer"),
    ];
    let variables: String = variables.into_iter().map(variable).collect();
    let step = "R[1] = STEPS; I[1] = STEPS; B[1] = STEPS % 2; I[2] = strlen(S[0]);\
                memset(S[1], 0, LENGTH); memset(S[1], 'x', STEPS);";
    let code = [("STEP_CODE", step), ("WITH_STATES", "1")];
    Generic { variables: &variables, capabilities: STATES, code: &code, ..Generic::default() }.build("node")
}

fn read(folder: &Path, file: &str) -> String {
    fs::read_to_string(folder.join("runs").join(file)).unwrap()
}

fn column(trace: &str, column: usize) -> Vec<&str> {
    trace.lines().skip(1).map(|row| row.split(',').nth(column).unwrap()).collect()
}

#[test]
fn events_are_results_with_the_same_bytes_in_both_placements_and_after_a_checkpoint() {
    let folder = node();
    let home = folder.path();
    fs::write(home.join("s.scn"), SCRIPT).unwrap();
    let saves = ["--save-at", "40ms", "at40", "--save-at", "120ms", "at120"];
    for (placement, out) in PLACEMENTS.into_iter().zip(["runs/together", "runs/apart"]) {
        let said = run(home, &[&["run", "s.scn", "--out", out][..], &saves, placement].concat());
        assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
        assert!(said.out.contains("0.17 s of 0.2 s, stop when a.y >= 15 held 20 ms, in "), "{}", said.out);
    }
    for file in ["trace.csv", "trace.parquet", "events.csv", "verdict.json"] {
        let bytes = |of: &str| fs::read(home.join("runs").join(of).join(file)).unwrap();
        assert!(bytes("together") == bytes("apart"), "{file}");
    }
    let (events, trace) = (read(home, "together/events.csv"), read(home, "together/trace.csv"));
    let but_odd: Vec<_> = events.lines().filter(|line| !line.contains("a.odd")).collect();
    assert_eq!(
        but_odd,
        [
            "tick,time,change,statement,condition",
            "2,0.02,opened,s.scn:13,20 ms",
            "4,0.04,opened,s.scn:14,4 <= a.y < 7",
            "5,0.05,closed,s.scn:13,20 ms",
            "7,0.07,closed,s.scn:14,4 <= a.y < 7",
            "10,0.1,opened,s.scn:16,a.y > 8 held 10 ms",
            "10,0.1,opened,s.scn:17,100 ms",
            "16,0.16,closed,s.scn:17,100 ms",
        ]
    );
    assert_eq!(column(&trace, 2)[..12], ["0", "1", "2", "3", "104", "105", "106", "7", "8", "9", "-1", "-1"]);
    assert_eq!(column(&trace, 3)[..7], ["0", "1", "0", "1", "2", "5", "6"]);
    assert!(column(&trace, 4).iter().all(|flag| *flag == "0"), "{trace}");
    assert_eq!(column(&trace, 6)[..9], ["0", "0", "1", "2", "3", "3", "3", "3", "7"], "the text that it got is frozen");
    let verdict: serde_json::Value = serde_json::from_str(&read(home, "together/verdict.json")).unwrap();
    assert_eq!(verdict["events"].as_array().unwrap().len(), events.lines().count() - 1);
    let second = serde_json::json!({
        "tick": 1, "time_s": 0.01, "change": "opened", "statement": "s.scn:15", "condition": "a.odd",
        "trigger": "when", "does": ["freeze"]
    });
    assert_eq!(verdict["events"][0], second);
    for (checkpoint, rows) in [("at40", 5), ("at120", 13)] {
        for placement in PLACEMENTS {
            let arguments = ["run", "s.scn", "--out", "runs/rest", "--from", checkpoint];
            let said = run(home, &[&arguments[..], placement].concat());
            assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
            let rest = read(home, "rest/trace.csv");
            assert!(rest.lines().skip(1).eq(trace.lines().skip(1 + rows)), "{checkpoint}: {rest}");
            for file in ["events.csv", "verdict.json"] {
                let [whole, rest] = ["together", "rest"].map(|of| read(home, &format!("{of}/{file}")));
                assert_eq!(rest, whole, "{checkpoint}: {file}");
            }
        }
    }
}

#[test]
fn two_windows_over_one_port_break_the_run_with_both_statements() {
    let folder = node();
    let script = "scenario \"s\"\nstep 10 ms\nstop 200 ms\nfmu a = \"node.fmu\"\nfmu b = \"node.fmu\"\na.y -> b.u\n\
        while a.y > 3 { fault b.u: bias 1 }\nwhen a.y > 5 lasting 20 ms { set b.u = 0 }\nrecord b.u\n";
    fs::write(folder.path().join("s.scn"), script).unwrap();
    for placement in PLACEMENTS {
        let said = run(folder.path(), &[&["run", "s.scn"], placement].concat());
        let error = "error: the run: the windows of s.scn:7 and s.scn:8 act on `b.u` at one time, at 0.06 s";
        assert!(said.code == Some(3) && said.err.contains(error), "{:?} {}", said.code, said.err);
        let events = fs::read_to_string(folder.path().join("runs/s/events.csv")).unwrap();
        assert_eq!(events, "tick,time,change,statement,condition\n4,0.04,opened,s.scn:7,a.y > 3\n");
    }
}
