//! Tests of what is read as a table.

use super::*;

fn folder_with(file: &str, text: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join(file), text).unwrap();
    folder
}

fn read(text: &str) -> Result<Table, String> {
    let folder = folder_with("trace.csv", text);
    Table::read(folder.path()).map_err(|error| {
        let text = error.to_string();
        let help = error.help.map(|help| format!("; help: {help}")).unwrap_or_default();
        text.rsplit_once('/').map_or(text.clone(), |(_, rest)| rest.to_owned()) + &help
    })
}

#[test]
fn a_trace_is_read_with_its_quoted_names() {
    let table = read("time,\"m[1,2]\",\"say \"\"x\"\"\"\n0,1,\n0.1,2,3\n").unwrap();
    assert_eq!(table.names().collect::<Vec<_>>(), ["time", "m[1,2]", "say \"x\""]);
    assert_eq!(table.columns[1].values, [Some(1.0), Some(2.0)]);
    assert_eq!(table.columns[2].values, [None, Some(3.0)]);
    assert!(table.columns[2].numbers()[0].is_nan() && !table.partial);
}

#[test]
fn time_is_converted_to_seconds_and_a_heading_may_have_a_unit() {
    for (heading, times) in [("Time", "0\n1.5"), ("time [ms]", "0\n1500"), ("\"time [min]\"", "0\n0.025")] {
        let rows: String = times.lines().map(|time| format!("{time},2\n")).collect();
        let table = read(&format!("{heading},v [km/h]\n{rows}")).unwrap();
        assert_eq!(table.time_s(), [0.0, 1.5], "{heading}");
        assert_eq!((table.columns[1].name.as_str(), table.columns[1].unit.as_deref()), ("v", Some("km/h")));
    }
    assert_eq!(read("time;m [1,2]\n0;1\n").unwrap().columns[1].name, "m [1,2]");
}

#[test]
fn a_partial_trace_is_used_and_its_incomplete_last_line_is_dropped() {
    let folder = folder_with("trace.csv.partial", "time,a\n0,1\n0.1");
    let table = Table::read(folder.path()).unwrap();
    assert_eq!((table.time_s().len(), table.partial), (1, true));
    assert_eq!(read("time,a\n0,1\n0.1,2").unwrap().time_s().len(), 2, "a whole file needs no line break at its end");
}

proptest::proptest! {
    #[test]
    fn any_text_is_read_as_a_table_or_an_error(text in "(time)?[,;\"#\r\n0-9.a-z \\PC]{0,80}\n?") {
        let folder = folder_with("trace.csv", &text);
        if let Ok(table) = Table::read(folder.path()) {
            for column in &table.columns {
                proptest::prop_assert_eq!(column.values.len(), table.time_s().len());
            }
        }
        proptest::prop_assert_eq!(notes(folder.path()), []);
    }
}

#[test]
fn a_folder_without_rows_says_why() {
    let reason = |file: &str| {
        let folder = folder_with(file, "");
        let text = Table::read(folder.path()).unwrap_err().to_string();
        text.replace(&folder.path().display().to_string(), "a")
    };
    assert_eq!(reason("run.json"), "the run of a recorded nothing");
    assert_eq!(reason("a.txt"), "a is neither a run's folder nor a trace.csv");
    let incomplete = "the run of a did not come to its end, and its trace.parquet is incomplete";
    assert_eq!(reason("trace.parquet.partial"), incomplete);
}

#[test]
fn a_file_that_is_not_a_table_is_an_error_with_its_place() {
    let name_it = "; help: name the column of the time `time`, or with a unit of time, for example `time [ms]`";
    let commented = "; help: a line that begins with # is a comment: write the names of the columns without it";
    for (text, message) in [
        ("", "trace.csv:1:1: the file is empty".to_owned()),
        ("# time,a\n", "trace.csv:1:1: the file is empty".to_owned()),
        ("a,time\n0,1\n", format!("trace.csv:1:1: the first column is `a`, and must be `time`{name_it}")),
        ("#time,a\n0,1\n", format!("trace.csv:2:1: the first column is `0`, and must be `time`{commented}")),
        ("time [m],a\n", "trace.csv:1:1: `m` is not a unit of time; help: write `time [s]`, or ms, us, ns, min, h".to_owned()),
        ("time,a,a\n", "trace.csv:1:8: `a` has a column already".to_owned()),
        ("time,time\n", "trace.csv:1:6: `time` has a column already".to_owned()),
        ("time,,a\n", "trace.csv:1:6: column 2 has no name".to_owned()),
        ("time,a\n0,1\n0.1\n", "trace.csv:3:1: expected 2 values as in the header, found 1".to_owned()),
        ("time,a\n0,1\n0.1,x\n", "trace.csv:3:5: `x` is not a number".to_owned()),
        ("time;a\n0;1,5\n", "trace.csv:2:3: `1,5` has a comma; a number is written with a point, `1.5`".to_owned()),
        (
            "time,a\n0,5,1,5\n",
            "trace.csv:2:5: expected 2 values as in the header, found 4; help: numbers are written with a point, not with a comma".to_owned(),
        ),
        ("time,a\n1,1\n0,1\n", "trace.csv:3:1: time 0 comes after 1; it must not fall".to_owned()),
        ("time,a\n,1\n", "trace.csv:2:1: the cell is empty, and `time` needs a value in each row".to_owned()),
        ("time,a\ninf,1\n", "trace.csv:2:1: `inf` is not a time".to_owned()),
    ] {
        assert_eq!(read(text).unwrap_err(), message, "{text:?}");
    }
}

#[test]
fn columns_are_described_by_the_signals_file_in_the_same_folder() {
    let folder = folder_with(
        "signals.json",
        r#"[{"name": "a.b", "unit": "m", "type": "Real", "causality": "output"},
            {"name": "mode [1]", "unit": null, "type": "Enumeration", "items": {"1": "Fill", "2": "Drain"}}]"#,
    );
    fs::write(folder.path().join("trace.csv"), "time,a.b,mode [1],on\n0,1,Drain,TRUE\n").unwrap();
    for path in [folder.path().to_owned(), folder.path().join("trace.csv")] {
        let table = Table::read(&path).unwrap();
        let columns: Vec<_> =
            table.columns.iter().map(|c| (&*c.name, c.unit.as_deref(), c.is_discrete, c.values[0])).collect();
        let expected = [
            ("time", Some("s"), false, Some(0.0)),
            ("a.b", Some("m"), false, Some(1.0)),
            ("mode [1]", None, true, Some(2.0)),
            ("on", None, false, Some(1.0)),
        ];
        assert_eq!(columns, expected);
    }
    assert_eq!(notes(Path::new("/no/such/run")), []);
}
