//! Warnings before a run: forgotten connections, names without use, and `--strict`.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;
use tempfile::TempDir;
use tests::foreign::Generic;
use tests::program::{PLACEMENTS, Said, run};

const HEAD: &str = "scenario \"A script\"\nstep 100 ms\nstop 1 s\n";

/// The messages of a refused command, which must not write results.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let Said { code, out, err } = run(folder, arguments);
    assert_eq!((code, out.as_str()), (Some(2), ""), "{arguments:?}: {err}");
    assert!(!folder.join("runs").exists(), "{arguments:?}");
    err
}

/// A folder with a unit that has two inputs, the name of one of which needs quotes.
fn with_gust() -> TempDir {
    let input = |name: &str, reference: u32, start: &str| {
        format!(
            "<ScalarVariable name=\"{name}\" valueReference=\"{reference}\" causality=\"input\">\
             <Real unit=\"m/s\" start=\"{start}\"/></ScalarVariable>"
        )
    };
    let variables = input("gust.x", 0, "1")
        + &input("gust.der(x)", 1, "-2.5")
        + "<ScalarVariable name=\"y\" valueReference=\"2\" causality=\"output\" initial=\"exact\"><Real start=\"0\"/></ScalarVariable>";
    let unit = Generic {
        definitions: "<UnitDefinitions><Unit name=\"m/s\"><BaseUnit m=\"1\" s=\"-1\"/></Unit></UnitDefinitions>",
        variables: &variables,
        code: &[("INSTANTIATE_CODE", "R[0] = 1; R[1] = -2.5;")],
        ..Generic::default()
    };
    unit.build("plane")
}

#[test]
fn a_forgotten_connection_is_a_warning_that_the_line_of_its_help_answers() {
    let folder = with_gust();
    let write = |lines: &str| fs::write(folder.path().join("a.scn"), [HEAD, lines].concat()).unwrap();
    write("fmu plane = \"plane.fmu\"\nrecord plane.y\n");
    let checked = run(folder.path(), &["check", "a.scn", "-v"]);
    insta::assert_snapshot!(checked.out);
    let strict = run(folder.path(), &["check", "a.scn", "--strict"]);
    assert!(strict.code == Some(2) && strict.out.ends_with("a.scn: 2 warnings\n"), "{}", strict.out);
    for placement in PLACEMENTS {
        let said = run(folder.path(), &[&["run", "a.scn"], placement].concat());
        assert_eq!((said.code, said.err.matches("warning[W02]").count()), (Some(0), 2), "{}", said.err);
        fs::remove_dir_all(folder.path().join("runs")).unwrap();
        let refused = refused(folder.path(), &[&["run", "a.scn", "--strict"], placement].concat());
        assert!(refused.ends_with("error: a.scn does not run with --strict because of its 2 warnings\n"), "{refused}");
    }
    write("fmu plane = \"plane.fmu\" { gust.x = 1 m/s, gust.'der(x)' = -2.5 m/s }\nrecord plane.y\n");
    assert_eq!(run(folder.path(), &["check", "a.scn", "--strict"]).out, "a.scn: ok  1 unit, 0 connections, 0 claims\n");
    assert_eq!(run(folder.path(), &["run", "a.scn", "--strict"]).code, Some(0));
    let alone = run(folder.path(), &["simulate", "plane.fmu"]);
    assert!(alone.code == Some(0) && !alone.err.contains("warning"), "{}", alone.err);
}

#[test]
fn what_is_not_used_is_a_warning() {
    let folder = with_gust();
    let values = "{ gust.x = 1 m/s, gust.'der(x)' = -2.5 m/s }";
    let text =
        format!("{HEAD}param p = 1\nlet l = 2\nfmu a = \"plane.fmu\" {values}\nfmu b = \"plane.fmu\"\nrecord a.y\n");
    fs::write(folder.path().join("a.scn"), text).unwrap();
    let checked = run(folder.path(), &["check", "a.scn", "--set", "p = 2"]);
    let found: Vec<_> = checked.out.lines().filter(|line| line.starts_with("warning")).collect();
    assert_eq!(found, ["p", "l", "b"].map(|name| format!("warning[W06]: `{name}` is not used")), "{}", checked.out);
}
