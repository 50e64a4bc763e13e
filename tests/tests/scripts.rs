//! The exact messages for an invalid script, unit file or command line.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::Write as _;
use std::path::Path;
use tempfile::TempDir;
use tests::foreign::{Foreign, Generic};
use tests::program::{PLACEMENTS, Said, repository, run};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

const HEAD: &str = "scenario \"A script\"\nstep 100 ms\nstop 1 s\n";

const FIVE_MISTAKES: &str = "scenario \"Five mistakes of meaning\"
step 5 ms
stop 10 s

fmu air  = \"wind\"
fmu path = \"trajectory\"
fmu quad = \"quadcopter\" { mas = 1 kg }

path.setpoint.position -> air.mean
air.velocty            -> quad.wind

at 5.0123 s { set air.turbulence = 2 m/s }

assert calm: always air.speed < 3 m
";

/// A folder with `foreign.fmu` and a script.
fn with_script(text: &str) -> TempDir {
    let (folder, _) = Foreign::default().build();
    fs::write(folder.path().join("a.scn"), text).unwrap();
    folder
}

/// The messages of a refused command, which must not write results.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let Said { code, out, err } = run(folder, arguments);
    assert_eq!((code, out.as_str()), (Some(2), ""), "{arguments:?}: {err}");
    assert!(!folder.join("runs").exists(), "{arguments:?}");
    err
}

/// The messages of several refused commands, each after its command line.
fn all_refused<'a>(folder: &Path, commands: impl IntoIterator<Item = &'a [&'a str]>) -> String {
    let mut messages = String::new();
    for arguments in commands {
        write!(messages, "$ lockstep {}\n{}\n", arguments.join(" "), refused(folder, arguments)).unwrap();
    }
    messages
}

#[test]
fn five_semantic_errors_are_reported_at_once_by_check_and_by_run() {
    let folder = tempfile::tempdir().unwrap();
    let script = folder.path().join("five.scn");
    fs::write(&script, FIVE_MISTAKES).unwrap();
    let script = script.to_str().unwrap();
    let checked = run(&repository(), &["check", script]);
    assert_eq!(checked.code, Some(2), "{}", checked.err);
    insta::assert_snapshot!(checked.out.replace(script, "five.scn"));
    let ran = run(&repository(), &["run", script]);
    let findings = checked.out.trim_end().rsplit_once("\n\n").map(|(findings, _)| findings);
    assert!(ran.code == Some(2) && ran.out.is_empty());
    assert!(findings.is_some_and(|findings| ran.err.contains(findings)), "{}", ran.err);
}

#[test]
fn an_empty_script_is_refused_with_what_it_needs() {
    let folder = with_script("");
    insta::assert_snapshot!(refused(folder.path(), &["run", "a.scn"]));
}

#[test]
fn missing_units_are_reported_with_the_nearest_name() {
    let lines = "fmu a = \"foriegn.fmu\"\nfmu b = \"parts/foreign.fmu\"\nfmu c = \"quadcopter\"\n";
    let folder = with_script(&format!("{HEAD}{lines}"));
    let mut messages = refused(folder.path(), &["run", "a.scn"]);
    fs::rename(folder.path().join("foreign.fmu"), folder.path().join("quadcopter.fmu")).unwrap();
    fs::write(folder.path().join("a.scn"), format!("{HEAD}fmu a = \"quadcoptr\"\n")).unwrap();
    write!(messages, "\n{}", refused(folder.path(), &["run", "a.scn", "--units", "."])).unwrap();
    insta::assert_snapshot!(messages);
}

#[test]
fn invalid_settings_are_reported_with_the_position_in_them() {
    let folder = with_script(&format!("{HEAD}param gust = 3 m/s\nfmu probe = \"foreign.fmu\"\n"));
    let settings =
        ["gus = 3 m/s", "gust = 3 m", "gust = true", "gust = [1, 2] m/s", "gust 3", "gust =", "gust = 3 m / s"];
    let commands = settings.map(|setting| ["run", "a.scn", "--set", setting]);
    insta::assert_snapshot!(all_refused(folder.path(), commands.iter().map(<[_; 4]>::as_slice)));
}

#[test]
fn an_invalid_command_line_is_refused() {
    let folder = with_script(&format!("{HEAD}fmu probe = \"foreign.fmu\"\n"));
    let commands: [&[&str]; 6] = [
        &["run"],
        &["run", "b.scn"],
        &["run", "a.scn", "--recrod", "none"],
        &["run", "a.scn", "--record", "some"],
        &["run", "a.scn", "--step-timeout", "soon"],
        &["fly", "a.scn"],
    ];
    insta::assert_snapshot!(all_refused(folder.path(), commands));
}

/// An archive with these entries.
fn archive(path: &Path, entries: &[(&str, &str)]) {
    let mut archive = ZipWriter::new(File::create(path).unwrap());
    for (name, text) in entries {
        archive.start_file(*name, SimpleFileOptions::default()).unwrap();
        archive.write_all(text.as_bytes()).unwrap();
    }
    archive.finish().unwrap();
}

#[test]
fn files_that_are_not_units_are_refused_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let description = fs::read_to_string(repository().join("tests/foreign/modelDescription.xml")).unwrap();
    let of_fmi_3 = description.replace("fmiVersion=\"2.0\"", "fmiVersion=\"3.0\"");
    let exchange = description
        .replace("CoSimulation", "ModelExchange")
        .replace(" canHandleVariableCommunicationStepSize=\"true\"", "");
    let cut = &description[..description.len() / 2];
    let at = |name| folder.path().join(name);
    fs::write(at("words.fmu"), "this is no archive").unwrap();
    fs::write(at("empty.fmu"), "").unwrap();
    archive(&at("outside.fmu"), &[("modelDescription.xml", &description), ("../evil", "")]);
    archive(&at("absolute.fmu"), &[("modelDescription.xml", &description), ("/etc/evil", "")]);
    archive(&at("nameless.fmu"), &[("binaries/linux64/foreign.so", "")]);
    archive(&at("cut.fmu"), &[("modelDescription.xml", cut)]);
    archive(&at("newer.fmu"), &[("modelDescription.xml", &of_fmi_3)]);
    archive(&at("elsewhere.fmu"), &[("modelDescription.xml", &description), ("binaries/win64/foreign.dll", "")]);
    archive(&at("exchange.fmu"), &[("modelDescription.xml", &exchange)]);
    let neither = description
        .replace("<CoSimulation modelIdentifier=\"foreign\" canHandleVariableCommunicationStepSize=\"true\"/>", "");
    archive(&at("sources.fmu"), &[("modelDescription.xml", &description), ("sources/foreign.c", "")]);
    archive(&at("neither.fmu"), &[("modelDescription.xml", &neither)]);
    let names = [
        "words",
        "empty",
        "outside",
        "absolute",
        "nameless",
        "cut",
        "newer",
        "elsewhere",
        "exchange",
        "sources",
        "neither",
    ];
    let mut messages = String::new();
    for name in names {
        fs::write(at("a.scn"), format!("{HEAD}fmu probe = \"{name}.fmu\"\n")).unwrap();
        let said = refused(folder.path(), &["run", "a.scn"]);
        let checked = run(folder.path(), &["check", "a.scn"]);
        assert_eq!((checked.code, checked.out), (Some(2), format!("{said}\na.scn: 1 error\n")));
        writeln!(messages, "{said}").unwrap();
    }
    insta::assert_snapshot!(messages);
}

#[test]
fn requirements_of_a_library_on_its_process_are_reported_before_the_run() {
    let flag = "canHandleVariableCommunicationStepSize=\"true\"";
    let flags = format!("{flag} canBeInstantiatedOnlyOncePerProcess=\"true\" needsExecutionTool=\"true\"");
    let (folder, _) = Foreign { description: &[(flag, &flags)], ..Foreign::default() }.build();
    let unit = |name| format!("fmu {name} = \"foreign.fmu\" {{ u = 0, enabled = true }}\n");
    fs::write(folder.path().join("a.scn"), [HEAD, &unit("one"), &unit("two"), "record one.y, two.y\n"].concat())
        .unwrap();
    insta::assert_snapshot!(refused(folder.path(), &["run", "a.scn"]));
    fs::write(folder.path().join("a.scn"), [HEAD, &unit("one"), "record one.y\n"].concat()).unwrap();
    let said = run(folder.path(), &["run", "a.scn"]);
    assert_eq!((said.code, said.err.matches("warning[W05]").count()), (Some(0), 1), "{}", said.err);
}

#[test]
fn wrong_files_are_reported_by_check_and_run_all_at_once_each_at_its_place() {
    let folder = with_script(&format!(
        "{HEAD}fmu a = \"foreign.fmu\" {{ label = file(\"../x.py\") }}\nfmu b = \"foreign.fmu\" {{ label = file(\"nope.csv\") }}\n\
         fmu c = \"foreign.fmu\" {{ label = file(\".\"), gain = 3 }}\nfmu d = \"foreign.fmu\" {{ label = file(\"a.scn\") }}\n\
         record a.z\n"
    ));
    let said = refused(folder.path(), &["run", "a.scn"]);
    insta::assert_snapshot!(said);
    assert_eq!(run(folder.path(), &["check", "a.scn"]).out, format!("{said}\na.scn: 4 errors\n"));
}

#[test]
fn a_unit_may_end_in_capital_letters() {
    let folder = with_script(&format!("{HEAD}fmu a = \"A B.FMU\" {{ u = 1, enabled = false }}\nrecord a.y\n"));
    fs::rename(folder.path().join("foreign.fmu"), folder.path().join("A B.FMU")).unwrap();
    let checked = run(folder.path(), &["check", "a.scn", "A B.FMU"]);
    assert_eq!((checked.code, checked.out.matches(": ok").count()), (Some(0), 2), "{}", checked.out);
    assert_eq!(run(folder.path(), &["run", "a.scn"]).code, Some(0));
    assert_eq!(run(folder.path(), &["simulate", "A B.FMU"]).code, Some(0));
    let described = run(folder.path(), &["describe", "A B.FMU"]).out;
    assert!(described.ends_with("fmu A_B = \"A B.FMU\"\n"), "{described}");
}

#[test]
fn a_text_reaches_its_unit_with_quotes_and_line_breaks() {
    let folder = tempfile::tempdir().unwrap();
    let unit = Generic {
        variables: "<ScalarVariable name=\"text\" valueReference=\"0\" causality=\"parameter\" variability=\"fixed\">\
                    <String start=\"\"/></ScalarVariable>\
                    <ScalarVariable name=\"der(y)\" valueReference=\"0\" causality=\"output\" initial=\"exact\">\
                    <Real start=\"0\"/></ScalarVariable>",
        ..Generic::default()
    };
    unit.pack(folder.path(), "probe");
    let text = r#"fmu probe = "probe.fmu" { text = "say \"hi\"\nC:\\d" }"#;
    fs::write(folder.path().join("a.scn"), format!("{HEAD}{text}\nrecord probe.'der(y)'\n")).unwrap();
    for placement in PLACEMENTS {
        let said = run(folder.path(), &[&["run", "a.scn", "--log-fmi-calls", "probe"], placement].concat());
        assert_eq!(said.code, Some(0), "{}", said.err);
        let calls = fs::read_to_string(folder.path().join("runs/a/fmi-calls.probe.log")).unwrap();
        assert!(calls.contains(r#"fmi2SetString(text = "say \"hi\"\nC:\\d")"#), "{calls}");
    }
    let described = run(folder.path(), &["describe", "probe.fmu"]).out;
    assert!(described.contains("  'der(y)'  Real"), "{described}");
}
