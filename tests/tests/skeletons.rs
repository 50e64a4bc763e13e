//! `lockstep new scenario` and `check --graph` as users call them.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use tests::program::{names, repository, run};

#[test]
fn a_new_scenario_connects_what_fits_and_passes_the_check() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("first.scn").display().to_string();
    let units = ["trajectory", "wind", "quadcopter_controller", "quadcopter"];
    let said = run(&repository(), &[&["new", "scenario"], &units[..], &["--out", &out]].concat());
    assert_eq!((said.code, said.out.trim()), (Some(0), &*out), "{}", said.err);
    let script = fs::read_to_string(&out).unwrap();
    assert!(
        script
            .lines()
            .any(|line| line.starts_with("quadcopter.state") && line.ends_with("-> quadcopter_controller.state")),
        "{script}"
    );
    assert!(script.lines().any(|line| line.starts_with("# quadcopter.state -> wind.vehicle")), "{script}");
    assert!(script.contains("\n# assert ") && script.contains("\n# record "), "{script}");
    assert_eq!(run(&repository(), &["check", &out]).code, Some(0), "{script}");
    assert_eq!(run(&repository(), &["fmt", "--check", &out]).code, Some(0), "{script}");
    // What is there is never written over, and without a file the script is printed.
    assert_eq!(run(&repository(), &["new", "scenario", "wind", "--out", &out]).code, Some(2));
    assert_eq!(fs::read_to_string(&out).unwrap(), script);
    assert_eq!(run(&repository(), &[&["new", "scenario"], &units[..]].concat()).out, script);
    assert_eq!(names(folder.path()), ["first.scn"]);
}

#[test]
fn a_unit_that_is_named_twice_has_two_names_and_an_unknown_one_is_an_error() {
    let said = run(&repository(), &["new", "scenario", "wind", "wind"]);
    assert!(said.out.contains("fmu wind   = \"wind\"\nfmu wind_2 = \"wind\"\n"), "{}{}", said.out, said.err);
    let said = run(&repository(), &["new", "scenario", "windd"]);
    assert_eq!((said.code, &*said.out), (Some(2), ""));
    assert!(said.err.contains("did you mean `wind`?"), "{}", said.err);
}

#[test]
fn a_graph_shows_every_unit_and_is_the_same_each_time() {
    let folder = tempfile::tempdir().unwrap();
    let [first, second] = ["a.svg", "b.svg"].map(|name| folder.path().join(name).display().to_string());
    for out in [&first, &second] {
        let said = run(&repository(), &["check", "scenarios/first_flight.scn", "--graph", out]);
        assert_eq!(said.code, Some(0), "{}{}", said.out, said.err);
    }
    let picture = fs::read_to_string(&first).unwrap();
    for text in [">quad<", ">wave 1, every 5 ms<", "rotor_speed =&gt; rotor_speed", "velocity -&gt; wind"] {
        assert!(picture.contains(text), "{text}");
    }
    assert_eq!(picture, fs::read_to_string(&second).unwrap());
}

#[test]
fn a_graph_is_of_one_script_and_an_svg() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("a.svg").display().to_string();
    let script = "scenarios/breeze.scn";
    for arguments in [&["check", script, "--graph", "a.png"][..], &["check", script, script, "--graph", &out]] {
        let said = run(&repository(), arguments);
        assert_eq!(said.code, Some(2), "{}", said.out);
        assert!(said.err.contains("--graph") && said.err.contains("help: "), "{}", said.err);
    }
    fs::write(folder.path().join("a.scn"), "step 5\n").unwrap();
    let broken = folder.path().join("a.scn").display().to_string();
    assert_eq!(run(&repository(), &["check", &broken, "--graph", &out]).code, Some(2));
    assert_eq!(names(folder.path()), ["a.scn"]);
}
