//! What a unit requires of its process: one instance per process runs with a process for each instance.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use tests::foreign::Generic;
use tests::program::run;

const SCRIPT: &str = "scenario \"Two of one unit\"\nstep 10 ms\nstop 100 ms\nfmu one = \"single.fmu\"\n\
    fmu two = \"copy.fmu\"\n1 -> one.u\none.y -> two.u\nrecord two.y\n";

#[test]
fn a_unit_for_one_instance_per_process_runs_twice_with_isolate_only() {
    let folder = tempfile::tempdir().unwrap();
    let unit = Generic {
        capabilities: "canBeInstantiatedOnlyOncePerProcess=\"true\"",
        variables: "<ScalarVariable name=\"u\" valueReference=\"0\" causality=\"input\"><Real start=\"1\"/></ScalarVariable>\
            <ScalarVariable name=\"y\" valueReference=\"1\" causality=\"output\"><Real/></ScalarVariable>",
        code: &[(
            "STEP_CODE",
            "static int instances; if (STEPS == 1) instances++; R[1] += instances == 1 ? R[0] : 1000;",
        )],
        ..Generic::default()
    };
    let archive = unit.pack(folder.path(), "single");
    fs::copy(archive, folder.path().join("copy.fmu")).unwrap();
    let same = SCRIPT.replace("copy.fmu", "single.fmu");
    for (script, second) in [(SCRIPT, "copy.fmu"), (same.as_str(), "single.fmu")] {
        fs::write(folder.path().join("a.scn"), script).unwrap();
        for command in ["run", "check"] {
            let said = run(folder.path(), &[command, "a.scn"]);
            let text = said.out + &said.err;
            let message =
                format!("unit `{second}` can be instantiated only once per process, and this run is one process");
            assert!(text.contains(&message) && text.contains("process of its own: `--isolate`"), "{text}");
            assert_eq!(said.code, Some(2), "{text}");
            let said = run(folder.path(), &[command, "a.scn", "--isolate"]);
            assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
        }
        let trace = fs::read_to_string(folder.path().join("runs/a/trace.csv")).unwrap();
        assert_eq!(trace.lines().last(), Some("0.1,45"), "{trace}");
    }
}
