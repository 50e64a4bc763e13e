//! Measures two things in turn, and prints what came of it.

use std::error::Error;
use std::time::Duration;

/// What a comparison came to.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Median, in seconds.
    pub ours_s: f64,
    /// Median, in seconds.
    pub peer_s: f64,
    /// Median of the ratios of neighbours, which a machine that is busy for a while disturbs least.
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

/// Rows under one heading, printed as they come: those whose name holds the word that follows `--` on the command line.
pub struct Table {
    word: String,
}

impl Table {
    /// Prints the heading.
    pub fn begin(title: &str) -> Self {
        println!("{title:<58} {:>10} {:>10} {:>7} {:>6}", "ours", "peer", "ratio", "limit");
        // cargo adds options of its own.
        let word = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
        Self { word: word.unwrap_or_default() }
    }

    /// Measures and prints a row, if it is wanted; a limit is what the ratio may be at most.
    pub fn row(
        &self,
        name: &str,
        limit: Option<f64>,
        measure: impl FnOnce() -> Result<Row, Box<dyn Error>>,
    ) -> Result<Option<Row>, Box<dyn Error>> {
        if !name.contains(&self.word) {
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
