//! Measures two operations in turn and prints the results as a table.

use std::error::Error;
use std::time::Duration;

/// The result of a comparison.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Median, in seconds.
    pub ours_s: f64,
    /// Median, in seconds.
    pub peer_s: f64,
    /// Median of the ratios of neighbouring measurements; a temporary load of the machine affects both of a pair alike.
    pub ratio: f64,
}

impl Row {
    /// The same for one of so many equal parts.
    pub fn each(self, parts: u64) -> Self {
        let parts = parts as f64;
        Self { ours_s: self.ours_s / parts, peer_s: self.peer_s / parts, ..self }
    }
}

/// Measures both in turn, once more than `blocks` times: the first time warms up.
pub fn alternate(
    blocks: usize,
    mut ours: impl FnMut() -> Result<Duration, Box<dyn Error>>,
    mut peer: impl FnMut() -> Result<Duration, Box<dyn Error>>,
) -> Result<Row, Box<dyn Error>> {
    let mut pairs = Vec::new();
    for _ in 0..=blocks {
        pairs.push((ours()?.as_secs_f64(), peer()?.as_secs_f64()));
    }
    let median = |of: &dyn Fn(&(f64, f64)) -> f64| {
        let mut values: Vec<_> = pairs[1..].iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let (ours_s, peer_s) = (median(&|pair| pair.0), median(&|pair| pair.1));
    Ok(Row { ours_s, peer_s, ratio: median(&|pair| pair.0 / pair.1) })
}

/// Rows under one heading, printed as they are measured: those whose name contains the argument after `--` of the command.
pub struct Table {
    filter: String,
}

impl Table {
    /// Prints the heading.
    pub fn begin(title: &str) -> Self {
        println!("{title:<58} {:>10} {:>10} {:>7} {:>6}", "ours", "peer", "ratio", "limit");
        // cargo adds options of its own.
        let filter = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
        Self { filter: filter.unwrap_or_default() }
    }

    /// Measures and prints a row if it is selected; `limit` is the largest ratio that is acceptable.
    pub fn row(
        &self,
        name: &str,
        limit: Option<f64>,
        measure: impl FnOnce() -> Result<Row, Box<dyn Error>>,
    ) -> Result<Option<Row>, Box<dyn Error>> {
        if !name.contains(&self.filter) {
            return Ok(None);
        }
        let row = measure()?;
        let limit = limit.map_or_else(String::new, |limit| limit.to_string());
        println!("{name:<58} {:>10} {:>10} {:>7.3} {limit:>6}", text(row.ours_s), text(row.peer_s), row.ratio);
        Ok(Some(row))
    }
}

fn text(duration_s: f64) -> String {
    match duration_s {
        ..1e-6 => format!("{:.1} ns", duration_s * 1e9),
        ..1e-3 => format!("{:.1} µs", duration_s * 1e6),
        ..1.0 => format!("{:.1} ms", duration_s * 1e3),
        _ => format!("{duration_s:.2} s"),
    }
}
