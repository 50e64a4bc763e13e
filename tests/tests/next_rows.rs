//! Checkpoints keep the next rows, and a run that continues otherwise than the saved one went on ends.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use tests::foreign::{CLAIMS_STATES, Foreign, Generic, STATES};
use tests::program::{PLACEMENTS, run};

/// `a` follows `b`, which saves all but a counter that shows from its eighth step on.
const INCOMPLETE: &str = "scenario \"s\"\nstep 10 ms\nstop 1 s\nfmu a = \"b.fmu\"\nfmu b = \"b.fmu\"\n\
                          assert low: always b.count < 1000\n";

#[test]
fn a_run_whose_unit_does_not_come_back_as_it_was_saved_ends_with_instance_output_and_both_values() {
    let variables = r#"<ScalarVariable name="y" valueReference="0" causality="output"><Real/></ScalarVariable>
        <ScalarVariable name="count" valueReference="0" causality="output" variability="discrete"><Integer/></ScalarVariable>"#;
    // START is no part of the state that the unit saves.
    let step = "START += 1; I[0] = STEPS < 8 || unit->name[0] == 'a' ? 0 : START;";
    let code = [("STEP_CODE", step), ("WITH_STATES", "1")];
    let folder = Generic { variables, capabilities: STATES, code: &code, ..Generic::default() }.build("b");
    fs::write(folder.path().join("s.scn"), INCOMPLETE).unwrap();
    let said = run(folder.path(), &["run", "s.scn", "--save-at", "50ms", "at50"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert_eq!(said.err.matches("saved at50 at 0.05 s").count(), 1, "{}", said.err);
    for placement in [&[][..], &["--isolate"], &["--record", "none"]] {
        let said = run(folder.path(), &[&["run", "s.scn", "--from", "at50"], placement].concat());
        let error = "error: `b` did not come back as it was saved: count is 2, was 8, at 0.08 s";
        assert_eq!(said.code, Some(3), "{}", said.err);
        assert!(said.err.contains(error) && said.err.contains("run from the start"), "{}", said.err);
    }
}

#[test]
fn a_checkpoint_of_a_run_that_crashes_at_once_is_kept() {
    let defines = ["WITH_STATES", "MISBEHAVE_CALL=STEP", "MISBEHAVE_HOW=CRASH", "MISBEHAVE_FROM_S=0.25"];
    let (folder, _) = Foreign { defines: &defines, description: &[CLAIMS_STATES], ..Foreign::default() }.build();
    let script = "scenario \"s\"\nstep 100 ms\nstop 1 s\nfmu a = \"foreign.fmu\"\nrecord a.y\n";
    fs::write(folder.path().join("s.scn"), script).unwrap();
    for placement in PLACEMENTS {
        let said = run(folder.path(), &[&["run", "s.scn", "--save-at", "200ms", "saved"], placement].concat());
        assert!(said.code == Some(3) && said.err.contains("saved saved at 0.2 s"), "{}", said.err);
        let said = run(folder.path(), &["run", "s.scn", "--from", "saved"]);
        assert!(said.code == Some(3) && said.err.contains("fmi2DoStep at 0.3 s"), "{}", said.err);
        fs::remove_file(folder.path().join("saved")).unwrap();
    }
}
