//! Quantities between units: differences, names of units of measure, and what they are worth.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::path::Path;
use tests::foreign::Generic;
use tests::program::{PLACEMENTS, Said, run};

const TEMPERATURES: &str = r#"<UnitDefinitions>
    <Unit name="K"><BaseUnit K="1"/></Unit> <Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit>
    <Unit name="degF"><BaseUnit K="1" factor="0.5555555555555556" offset="255.3722222222222"/></Unit>
  </UnitDefinitions>
  <TypeDefinitions>
    <SimpleType name="Rise"><Real unit="degC" relativeQuantity="true"/></SimpleType>
  </TypeDefinitions>"#;

const SOURCE: &str = r#"
    <ScalarVariable name="rise" valueReference="0" causality="output" initial="exact"><Real declaredType="Rise" start="10"/></ScalarVariable>
    <ScalarVariable name="temp" valueReference="1" causality="output" initial="exact"><Real unit="degC" start="10"/></ScalarVariable>"#;

const SINK: &str = r#"
    <ScalarVariable name="riseK" valueReference="0" causality="input"><Real unit="K" relativeQuantity="true" start="0"/></ScalarVariable>
    <ScalarVariable name="riseF" valueReference="1" causality="input"><Real unit="degF" relativeQuantity="true" start="0"/></ScalarVariable>
    <ScalarVariable name="tempK" valueReference="2" causality="input"><Real unit="K" start="0"/></ScalarVariable>
    <ScalarVariable name="dT" valueReference="3" causality="parameter" variability="tunable" initial="exact"><Real declaredType="Rise" start="0"/></ScalarVariable>
    <ScalarVariable name="point" valueReference="4" causality="parameter" variability="fixed" initial="exact"><Real declaredType="Rise" relativeQuantity="false" start="0"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="5" causality="output" initial="exact"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="z" valueReference="6" causality="output" initial="exact"><Real start="0"/></ScalarVariable>"#;

fn pack_temperatures(folder: &Path) {
    let source = [("INSTANTIATE_CODE", "R[0]=R[1]=10;")];
    let sink = [("STEP_CODE", "R[5]=R[3];R[6]=R[4];")];
    Generic { definitions: TEMPERATURES, variables: SOURCE, code: &source, ..Generic::default() }
        .pack(folder, "source");
    Generic { definitions: TEMPERATURES, variables: SINK, code: &sink, ..Generic::default() }.pack(folder, "sink");
}

fn script(folder: &Path, lines: &str) {
    std::fs::write(folder.join("a.scn"), format!("scenario \"Quantities\"\nstep 1 s\nstop 2 s\n{lines}\n")).unwrap();
}

/// The last row of the trace in `out`.
fn last_row(folder: &Path) -> String {
    let trace = std::fs::read_to_string(folder.join("out/trace.csv")).unwrap();
    trace.lines().last().unwrap_or_default().to_owned()
}

fn lockstep(folder: &Path, arguments: &[&str], placement: &[&str]) -> Said {
    run(folder, &[arguments, placement].concat())
}

#[test]
fn an_offset_applies_to_no_difference() {
    let folder = tempfile::tempdir().unwrap();
    pack_temperatures(folder.path());
    let lines = "fmu src = \"source.fmu\"\nfmu dst = \"sink.fmu\" { dT = 5 K, point = 5 K }\nsrc.rise -> dst.riseK, dst.riseF\n\
                 src.temp -> dst.tempK\nat 1 s { set dst.dT = 9 degF }\nassert small: always src.rise < 12 K\n\
                 record dst.riseK, dst.riseF, dst.tempK, dst.y, dst.z";
    script(folder.path(), lines);
    for placement in PLACEMENTS {
        let said = lockstep(folder.path(), &["run", "a.scn", "--out", "out"], placement);
        assert_eq!(
            (said.code, last_row(folder.path()).as_str()),
            (Some(0), "2,10,18,283.15,5,-268.15"),
            "{}",
            said.err
        );
        let trace = std::fs::read_to_string(folder.path().join("out/trace.csv")).unwrap();
        assert_eq!(trace.lines().nth(2).unwrap(), "1,10,18,283.15,5,-268.15");
    }
    let said = run(
        folder.path(),
        &["simulate", "sink.fmu", "--set", "dT = 5 K", "--step", "1", "--stop", "1", "--out", "out"],
    );
    assert_eq!((said.code, last_row(folder.path()).as_str()), (Some(0), "1,5,0,0,0,0"), "{}", said.err);
}

#[test]
fn a_difference_does_not_connect_to_a_point_on_a_scale() {
    let folder = tempfile::tempdir().unwrap();
    pack_temperatures(folder.path());
    script(folder.path(), "fmu src = \"source.fmu\"\nfmu dst = \"sink.fmu\"\nsrc.rise -> dst.tempK");
    for command in ["check", "run"] {
        let said = run(folder.path(), &[command, "a.scn"]);
        assert!(
            said.code == Some(2) && (said.out + &said.err).contains("error[E32]: `dst.tempK`"),
            "{command}: {}",
            said.err
        );
    }
}

#[test]
fn a_literal_means_what_the_unit_that_takes_it_defines() {
    let folder = tempfile::tempdir().unwrap();
    let variables = r#"
        <ScalarVariable name="v" valueReference="0" causality="parameter" variability="fixed" initial="exact"><Real unit="gal" start="1"/></ScalarVariable>
        <ScalarVariable name="w" valueReference="1" causality="output" initial="exact"><Real unit="gal" start="1"/></ScalarVariable>"#;
    for (name, factor) in [("us", "0.003785411784"), ("uk", "0.00454609")] {
        let definitions = &format!(
            "<UnitDefinitions><Unit name=\"gal\"><BaseUnit m=\"3\" factor=\"{factor}\"/></Unit></UnitDefinitions>"
        );
        let code = [("INSTANTIATE_CODE", "R[0]=R[1]=1;"), ("STEP_CODE", "R[1]=R[0];")];
        Generic { definitions, variables, code: &code, ..Generic::default() }.pack(folder.path(), name);
    }
    for order in [["us", "uk"], ["uk", "us"]] {
        let units = order.map(|name| format!("fmu {name} = \"{name}.fmu\" {{ v = 10 'gal' }}\n")).concat();
        let lines = units + "assert full: eventually uk.w > 9 'gal'\nrecord us.w, uk.w";
        script(folder.path(), &lines);
        for placement in PLACEMENTS {
            let said = lockstep(folder.path(), &["run", "a.scn", "--out", "out"], placement);
            assert_eq!((said.code, last_row(folder.path()).as_str()), (Some(0), "2,10,10"), "{}", said.err);
        }
    }
    let said = run(
        folder.path(),
        &["simulate", "uk.fmu", "--set", "v = 10 'gal'", "--step", "1", "--stop", "1", "--out", "out"],
    );
    assert_eq!((said.code, last_row(folder.path()).as_str()), (Some(0), "1,10"), "{}", said.err);
}

#[test]
fn a_declared_name_without_definition_is_warned_of_and_takes_numbers_of_that_name() {
    let folder = tempfile::tempdir().unwrap();
    let variables = r#"
        <ScalarVariable name="v" valueReference="0" causality="input"><Real unit="km/h" start="0"/></ScalarVariable>
        <ScalarVariable name="o" valueReference="1" causality="output" initial="exact"><Real unit="m/s" start="5"/></ScalarVariable>"#;
    let code = [("INSTANTIATE_CODE", "R[1]=5;")];
    Generic { variables, code: &code, ..Generic::default() }.pack(folder.path(), "bare");
    let start = "fmu a = \"bare.fmu\" { v = 10 km/h }\nfmu b = \"bare.fmu\"\nrecord a.v, b.v\n";
    script(folder.path(), &format!("{start}a.o -> b.v"));
    let said = run(folder.path(), &["run", "a.scn", "--out", "out"]);
    let warning = "warning[W01]: `a.o` is in m/s and `b.v` in km/h, and `m/s` and `km/h` have no definition";
    assert!(
        said.code == Some(0) && said.err.contains(warning) && said.err.matches("warning[W").count() == 1,
        "{}",
        said.err
    );
    assert_eq!(last_row(folder.path()), "2,10,5");
    script(folder.path(), &format!("{start}(a.o as m/s) in km/h -> b.v"));
    let said = run(folder.path(), &["run", "a.scn", "--out", "out"]);
    assert!(said.code == Some(0) && !said.err.contains("warning[W"), "{}", said.err);
    assert_eq!(last_row(folder.path()), "2,10,18");
}

const LIMITED: &str = r#"
    <ScalarVariable name="u" valueReference="0" causality="input"><Real min="-1" max="3" start="0"/></ScalarVariable>
    <ScalarVariable name="mode" valueReference="0" causality="input" variability="discrete"><Enumeration declaredType="Mode" start="1"/></ScalarVariable>
    <ScalarVariable name="part" valueReference="1" causality="parameter" variability="tunable" initial="exact"><Real declaredType="Part" start="1"/></ScalarVariable>
    <ScalarVariable name="x" valueReference="2" causality="output" initial="exact"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="n" valueReference="1" causality="output" variability="discrete" initial="exact"><Integer start="1"/></ScalarVariable>"#;

fn pack_limited(folder: &Path) {
    let definitions = r#"<TypeDefinitions>
        <SimpleType name="Part"><Real min="0" max="10"/></SimpleType>
        <SimpleType name="Mode"><Enumeration><Item name="on" value="1"/><Item name="off" value="-3"/></Enumeration></SimpleType>
      </TypeDefinitions>"#;
    let code = [("INSTANTIATE_CODE", "I[0]=I[1]=1;R[1]=1;"), ("STEP_CODE", "R[2]+=2;I[1]=STEPS<2?1:2;")];
    Generic { definitions, variables: LIMITED, code: &code, ..Generic::default() }.pack(folder, "limited");
}

#[test]
fn a_value_that_the_description_does_not_allow_is_an_error_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    pack_limited(folder.path());
    std::fs::write(folder.path().join("in.csv"), "time,u\n0,0\n1,4\n").unwrap();
    std::fs::write(folder.path().join("mode.csv"), "time,mode\n0,5\n").unwrap();
    let lines = [
        "fmu a = \"limited.fmu\" { part = 100 }",
        "fmu a = \"limited.fmu\"\nat 1 s { set a.part = -50 }",
        "fmu a = \"limited.fmu\"\n4 -> a.u",
        "param p = 11\nfmu a = \"limited.fmu\" { part = p }",
    ];
    for lines in lines {
        script(folder.path(), lines);
        let said = run(folder.path(), &["check", "a.scn"]);
        assert!(said.code == Some(2) && said.out.contains("its description says m"), "{}\n{}", said.out, said.err);
    }
    script(folder.path(), "param p = 1\nfmu a = \"limited.fmu\" { part = p }");
    let said = run(folder.path(), &["run", "a.scn", "--set", "p = 11"]);
    assert!(said.code == Some(2) && said.err.contains("`a.part` cannot be 11"), "{}", said.err);
    let simulations: [(&[&str], &str); 4] = [
        (&["--set", "part = 100"], "`part` cannot be 100"),
        (&["--set", "mode = 5"], "`mode` cannot be 5"),
        (&["--input", "in.csv"], "in.csv:1:6: `u` cannot be 4 at 1 s"),
        (&["--input", "mode.csv"], "mode.csv:1:6: `mode` cannot be 5 at 0 s"),
    ];
    for (options, expected) in simulations {
        let said = run(folder.path(), &[&["simulate", "limited.fmu", "--step", "1", "--stop", "1"], options].concat());
        assert!(said.code == Some(2) && said.err.contains(expected), "{options:?}: {}", said.err);
    }
}

#[test]
fn a_value_that_comes_during_the_run_is_warned_of_once() {
    let folder = tempfile::tempdir().unwrap();
    pack_limited(folder.path());
    let lines = "fmu a = \"limited.fmu\"\nfmu b = \"limited.fmu\"\nfmu c = \"limited.fmu\"\na.x -> b.u\na.n => b.mode\n\
                 a.x - 5 -> c.u\nat 1 s { set c.part = a.x * 8 }\nrecord b.u, b.mode, c.part";
    script(folder.path(), lines);
    let text = std::fs::read_to_string(folder.path().join("a.scn")).unwrap().replace("stop 2 s", "stop 4 s");
    std::fs::write(folder.path().join("a.scn"), text).unwrap();
    for placement in PLACEMENTS {
        let said = lockstep(folder.path(), &["run", "a.scn", "--out", "out"], placement);
        assert_eq!((said.code, last_row(folder.path()).as_str()), (Some(0), "4,6,2,48"), "{}", said.err);
        let warnings: Vec<_> = said.err.lines().filter(|line| line.contains("description says")).collect();
        let expected = [
            "0 s  c  warning  `c.u` gets -5, and its description says min -1 and max 3 (reported once)",
            "1 s  b  warning  `b.mode` gets 2, and its description says the items 1, -3 (reported once)",
            "1 s  c  warning  `c.part` gets 16, and its description says min 0 and max 10 (reported once)",
            "2 s  b  warning  `b.u` gets 4, and its description says min -1 and max 3 (reported once)",
        ];
        assert_eq!(warnings, expected, "{}", said.err);
    }
}
