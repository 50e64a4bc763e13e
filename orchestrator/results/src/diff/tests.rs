//! Tests of what two traces have in common.

use super::*;

/// A table of `name [unit]`s and rows of numbers; an empty cell is `_`.
fn table(header: &str, rows: &[&str]) -> Table {
    let column = |(index, name): (usize, &str)| {
        let (name, unit) = name.split_once(' ').map_or((name, None), |(name, unit)| (name, Some(unit.to_owned())));
        let value = |row: &&str| row.split(',').nth(index).unwrap().parse().ok();
        Column {
            name: name.to_owned(),
            unit,
            is_discrete: name == "mode",
            values: rows.iter().map(value).collect(),
            ..Column::default()
        }
    };
    Table { columns: header.split(',').enumerate().map(column).collect(), partial: false }
}

fn compared(a: &Table, b: &Table, limit: Limit) -> (bool, String) {
    let difference = Difference::between([a, b], |_| limit);
    (difference.is_none(), difference.report(["a", "b"], "1 mm"))
}

#[test]
fn equal_traces_have_no_difference() {
    let a = table("time,q.x,mode", &["0,1,_", "0.1,NaN,2"]);
    assert_eq!(compared(&a, &a, Limit::Exact), (true, "identical: 2 rows, every cell\n".to_owned()));
}

#[test]
fn the_earliest_row_counts_then_the_order_of_columns_and_all_have_their_units() {
    let a = table("time,q.x m,q.y m,q.z rad", &["0,1,1,1", "0.1,2,2,2", "0.2,3,3,3"]);
    let b = table("time,q.x m,q.y m,q.z rad", &["0,1,1,1", "0.1,2,2.5,7", "0.2,4,3,_"]);
    assert_eq!(
        compared(&a, &b, Limit::Exact),
        (
            false,
            "first difference at 0.1 s (row 1) in q.y: 2 m and 2.5 m, 5.000e-1 m apart\n  \
             q.x: 1 row, at most 1.000e0 m apart\n  q.y: 1 row, at most 5.000e-1 m apart\n  \
             q.z: 2 rows, at most one is no number\n"
                .to_owned()
        )
    );
}

#[test]
fn a_trace_that_begins_later_is_equal_where_both_have_rows() {
    let whole = table("time,q.x m", &["0,1", "0.1,2", "0.2,3", "0.3,4"]);
    let continued = table("time,q.x m", &["0.2,3", "0.3,4"]);
    let report =
        "equal where they overlap: 2 rows from 0.2 s to 0.3 s, every cell\nonly in a: 2 rows from 0 s to 0.1 s\n";
    assert_eq!(compared(&whole, &continued, Limit::Exact), (true, report.to_owned()));
    let (is_equal, report) = compared(&continued, &whole, Limit::Exact);
    assert!(is_equal && report.ends_with("\nonly in b: 2 rows from 0 s to 0.1 s\n"), "{report}");
    let other = table("time,q.x m", &["0.2,3", "0.3,5"]);
    let report = "first difference at 0.3 s (rows 3 and 1) in q.x: 4 m and 5 m, 1.000e0 m apart\n  \
                  q.x: 1 row, at most 1.000e0 m apart\nonly in a: 2 rows from 0 s to 0.1 s\n";
    assert_eq!(compared(&whole, &other, Limit::Exact), (false, report.to_owned()));
}

#[test]
fn a_trace_that_ends_earlier_lacks_rows_or_has_no_time_in_common_is_another_one() {
    let whole = table("time,q.x", &["0,1", "0.1,2", "0.2,3"]);
    let short = table("time,q.x", &["0,1", "0.1,2"]);
    assert_eq!(compared(&whole, &short, Limit::Exact), (false, "only in a: 1 row at 0.2 s\n".to_owned()));
    let coarse = table("time,q.x", &["0,1", "0.2,3"]);
    assert_eq!(compared(&coarse, &whole, Limit::Exact), (false, "only in b: 1 row at 0.1 s\n".to_owned()));
    let later = table("time,q.x", &["5,1", "6,2"]);
    let report =
        "only in a: 3 rows from 0 s to 0.2 s\nonly in b: 2 rows from 5 s to 6 s\nthey have no time in common\n";
    assert_eq!(compared(&whole, &later, Limit::Exact), (false, report.to_owned()));
}

#[test]
fn columns_of_one_trace_and_other_units_of_measure_are_differences() {
    let a = table("time,q.x m,q.y m", &["0,1,2"]);
    let b = table("time,q.x mm,q.z", &["0,1000,2"]);
    let report = "q.x is in m in a, and in mm in b\nonly in a: q.y\nonly in b: q.z\n";
    assert_eq!(compared(&a, &b, Limit::Exact), (false, report.to_owned()));
}

#[test]
fn values_within_a_limit_are_equal_but_for_discrete_ones_and_those_that_are_not_finite() {
    let a = table("time,q.x m,mode", &["0,1000,1", "0.1,-2,1"]);
    let near = table("time,q.x m,mode", &["0,1000.0005,1", "0.1,-2,1"]);
    let report = "equal within 1 mm: 2 rows, at most 5.000e-4 m apart in q.x\n".to_owned();
    assert_eq!(compared(&a, &near, Limit::Absolute(1e-3)), (true, report.clone()));
    assert_eq!(compared(&a, &near, Limit::Relative(1e-6)), (true, report));
    assert!(!compared(&a, &near, Limit::Absolute(1e-4)).0 && !compared(&a, &near, Limit::Relative(1e-7)).0);
    let other_mode = table("time,q.x m,mode", &["0,1000,2", "0.1,-2,1"]);
    assert!(!compared(&a, &other_mode, Limit::Relative(10.0)).0);
    let endless = |sign| table("time,q.x m", &[&format!("0,{sign}inf")]);
    assert!(!compared(&endless(""), &endless("-"), Limit::Relative(10.0)).0);
}
