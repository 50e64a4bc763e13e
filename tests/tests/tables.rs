//! Tables over time: what `simulate --input`, `plot` and `diff` read, and how `diff` compares.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::fs;
use std::path::Path;
use tempfile::TempDir;
use tests::foreign::{Generic, STATES};
use tests::program::{Said, run};

const VARIABLES: &str = r#"
<ScalarVariable name="u" valueReference="0" causality="input"><Real unit="m/s" start="0"/></ScalarVariable>
<ScalarVariable name="on" valueReference="0" causality="input" variability="discrete"><Boolean start="false"/></ScalarVariable>
<ScalarVariable name="mode" valueReference="0" causality="input" variability="discrete"><Enumeration declaredType="Mode" start="1"/></ScalarVariable>
<ScalarVariable name="y" valueReference="1" causality="output" initial="exact"><Real unit="m" start="0"/></ScalarVariable>"#;

const DEFINITIONS: &str = r#"<UnitDefinitions>
<Unit name="m"><BaseUnit m="1"/></Unit><Unit name="m/s"><BaseUnit m="1" s="-1"/></Unit></UnitDefinitions>
<TypeDefinitions><SimpleType name="Mode"><Enumeration>
<Item name="Fill" value="1"/><Item name="Drain" value="2"/></Enumeration></SimpleType></TypeDefinitions>"#;

/// A folder with `tank.fmu`, whose output is the integral of its input.
fn with_tank() -> TempDir {
    let unit = Generic {
        variables: VARIABLES,
        definitions: DEFINITIONS,
        capabilities: STATES,
        code: &[("STEP_CODE", "R[1] += H * R[0];"), ("WITH_STATES", "1")],
        ..Generic::default()
    };
    unit.build("tank")
}

fn simulate(folder: &Path, input: &str) -> Said {
    let path = folder.join("in.csv");
    fs::write(&path, input).unwrap();
    run(folder, &["simulate", "tank.fmu", "--stop", "1s", "--step", "500ms", "--input", "in.csv", "--out", "out"])
}

#[test]
fn tables_of_spreadsheets_drive_a_unit_as_plain_ones_do() {
    let folder = with_tank();
    for input in [
        "time,u,on,mode\n0,1,0,1\n1,3,1,2\n",
        "time [ms],u [m/s],on,mode\n0,1,false,Fill\n1000,3,true,Drain\n",
        "\u{feff}# by hand\r\nTime;u [km/h];on;mode\r\n0;3.6;FALSE;Fill\r\n1;10.8;TRUE;Drain\r\n;;;\r\n",
        "sep=;\n\"time\";\"u\";\"on\";\"mode\"\n0;1;False;1\n\n1;3;True;2",
    ] {
        let said = simulate(folder.path(), input);
        assert_eq!(said.code, Some(0), "{input:?}: {}", said.err);
        let trace = fs::read_to_string(folder.path().join("out/trace.csv")).unwrap();
        assert_eq!(trace, "time,y,u,on,mode\n0,0,1,0,1\n0.5,0.5,2,0,1\n1,1.5,2,0,1\n", "{input:?}");
    }
}

#[test]
fn what_is_wrong_with_a_table_is_said_alike_by_all_that_read_tables() {
    let folder = with_tank();
    for (input, reason) in [
        ("u,on\n0,1\n", "in.csv:1:1: the first column is `u`, and must be `time`\nhelp: name the column of the time"),
        ("# time,u\n0,1\n", "in.csv:2:1: the first column is `0`, and must be `time`\nhelp: a line that begins with #"),
        ("time [m],u\n0,1\n", "in.csv:1:1: `m` is not a unit of time\nhelp: write `time [s]`"),
        ("time;u\n0;1,5\n", "in.csv:2:3: `1,5` has a comma; a number is written with a point, `1.5`\n"),
        (
            "time,u\n0,5,1,5\n",
            "in.csv:2:5: expected 2 values as in the header, found 4\nhelp: numbers are written with",
        ),
        ("time,u\n0,1\n1,x\n", "in.csv:3:3: `x` is not a number\n"),
        ("time,u\n1,1\n0,1\n", "in.csv:3:1: time 0 comes after 1; it must not fall\n"),
        ("time,u,u\n0,1,1\n", "in.csv:1:8: `u` has a column already\n"),
        ("time,u\n0,\"1\n", "in.csv:2:3: this quote is not closed\n"),
        ("PK\u{3}\u{4}...", "cannot read in.csv: this is a spreadsheet or another archive, not a text\nhelp: save"),
    ] {
        let said = simulate(folder.path(), input);
        assert!(said.code == Some(2) && said.err.starts_with(&format!("error: {reason}")), "{}", said.err);
        for arguments in [["plot", "in.csv"].as_slice(), &["diff", "in.csv", "in.csv"]] {
            let other = run(folder.path(), arguments);
            assert_eq!(other.code, Some(2), "{arguments:?} {}", other.err);
            let first = |text: &str| text.lines().next().map(str::to_owned);
            assert_eq!(first(&other.err), first(&said.err), "{arguments:?}");
        }
    }
    fs::write(folder.path().join("latin.csv"), b"time,u\n0,\xb5\n").unwrap();
    let said = run(folder.path(), &["diff", "latin.csv", "latin.csv"]);
    assert!(said.err.starts_with("error: cannot read latin.csv: line 2 is not in UTF-8"), "{}", said.err);
}

#[test]
fn an_output_called_time_has_a_quoted_column_in_every_format() {
    let variables = r#"<ScalarVariable name="time" valueReference="0" causality="output" initial="exact">
        <Real start="0"/></ScalarVariable>
        <ScalarVariable name="u" valueReference="1" causality="input"><Real start="0"/></ScalarVariable>"#;
    let unit = Generic { variables, code: &[("STEP_CODE", "R[0] = 100 + T;")], ..Generic::default() };
    let folder = unit.build("clock");
    let said = run(folder.path(), &["simulate", "clock.fmu", "--stop", "1", "--step", "0.5", "--out", "out"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let trace = fs::read_to_string(folder.path().join("out/trace.csv")).unwrap();
    assert_eq!(trace, "time,'time',u\n0,0,0\n0.5,100,0\n1,100.5,0\n");
    let signals = fs::read_to_string(folder.path().join("out/signals.json")).unwrap();
    assert!(signals.contains(r#""name": "'time'""#) && signals.contains(r#""variable": "time""#), "{signals}");
    let compared = run(folder.path(), &["diff", "out", "out/trace.parquet"]);
    assert_eq!((compared.code, compared.out.as_str()), (Some(0), "identical: 3 rows, every cell\n"));
}

const SCRIPT: &str = "scenario \"A tank fills\"\nstep 100 ms\nstop 2 s\nparam inflow = 1 m/s\nfmu tank = \"tank.fmu\"\n\
                      inflow -> tank.u\nrecord tank.y, tank.u\n";

/// A folder in which `whole` is a run of the script, and `script` runs it again.
fn with_runs() -> TempDir {
    let folder = with_tank();
    fs::write(folder.path().join("a.scn"), SCRIPT).unwrap();
    script(&folder, "whole", &["--save-at", "1.5s", "saved"]);
    folder
}

fn script(folder: &TempDir, out: &str, arguments: &[&str]) {
    let said = run(folder.path(), &[&["run", "a.scn", "--out", out], arguments].concat());
    assert_eq!(said.code, Some(0), "{}", said.err);
}

#[test]
fn a_whole_run_and_a_continued_one_are_equal_where_they_overlap() {
    let folder = with_runs();
    script(&folder, "rest", &["--from", "saved"]);
    let diff = |a: &str, b: &str| run(folder.path(), &["diff", a, b]);
    let said = diff("whole", "rest");
    let rows = fs::read_to_string(folder.path().join("rest/trace.csv")).unwrap().lines().count() - 1;
    let only = 21 - rows;
    assert_eq!(said.code, Some(0), "{}", said.out);
    assert!(said.out.starts_with(&format!("equal where they overlap: {rows} rows from 1.")), "{}", said.out);
    assert!(
        said.out.ends_with(&format!(" to 2 s, every cell\nonly in whole: {only} rows from 0 s to 1.{} s\n", only - 11)),
        "{}",
        said.out
    );
    assert_eq!(diff("rest", "whole").code, Some(0));
    let cut = fs::read_to_string(folder.path().join("whole/trace.csv")).unwrap();
    let cut: Vec<_> = cut.lines().take(10).collect();
    fs::write(folder.path().join("cut.csv"), cut.join("\n")).unwrap();
    let said = diff("whole", "cut.csv");
    assert_eq!((said.code, said.out.as_str()), (Some(1), "only in whole: 12 rows from 0.9 s to 2 s\n"));
}

#[test]
fn diff_takes_a_tolerance_with_a_unit_of_measure_or_a_part_of_each_value() {
    let folder = with_runs();
    script(&folder, "near", &["--set", "inflow = 1.0001 m/s"]);
    let diff = |tolerance: &[&str]| {
        let said = run(folder.path(), &[&["diff", "whole", "near"], tolerance].concat());
        (said.code, said.out + &said.err)
    };
    let (code, out) = diff(&[]);
    assert!(code == Some(1) && out.contains(" in tank.u: 1 m/s and 1.0001 m/s, 1.000e-4 m/s apart\n"), "{out}");
    for tolerance in [["--tolerance", "1e-3"].as_slice(), &["--tolerance", "1mm", "--tolerance", "1mm/s"]] {
        let (code, out) = diff(tolerance);
        assert!(
            code == Some(0)
                && out.starts_with("equal within ")
                && out.contains(": 21 rows, at most 2.000e-4 m apart in tank.y"),
            "{out}"
        );
    }
    let (code, out) = diff(&["--tolerance", "1mm"]);
    assert!(code == Some(1) && out.contains("tank.u: 21 rows") && !out.contains("tank.y"), "{out}");
    assert_eq!(diff(&["--tolerance", "1e-5"]).0, Some(1));
    let (code, out) = diff(&["--tolerance", "1 kg"]);
    assert!(
        code == Some(2) && out.starts_with("error: --tolerance 1 kg: no column is in such a unit of measure"),
        "{out}"
    );
}

#[test]
fn diff_reads_parquet_and_compares_rows_of_equal_time() {
    let folder = with_runs();
    let said = run(folder.path(), &["diff", "whole/trace.parquet", "whole"]);
    assert_eq!((said.code, said.out.as_str()), (Some(0), "identical: 21 rows, every cell\n"), "{}", said.err);
    fs::remove_file(folder.path().join("whole/trace.csv")).unwrap();
    let drawn = run(folder.path(), &["plot", "whole", "tank.y"]);
    assert_eq!(drawn.code, Some(0), "{}", drawn.err);
    fs::write(folder.path().join("ms.csv"), "time [ms];tank.y;tank.u\n200;0.2;1\n500;0.5;1\n550;0.5;1\n").unwrap();
    let said = run(folder.path(), &["diff", "whole", "ms.csv", "--tolerance", "1e-9"]);
    assert_eq!(
        (said.code, said.out.as_str()),
        (Some(1), "only in whole: 19 rows between 0 s and 2 s\nonly in ms.csv: 1 row at 0.55 s\n"),
        "{}",
        said.err
    );
    fs::write(folder.path().join("torn.parquet"), "PAR1torn").unwrap();
    let said = run(folder.path(), &["diff", "torn.parquet", "whole"]);
    assert!(said.code == Some(2) && said.err.starts_with("error: cannot read torn.parquet: "), "{}", said.err);
}
