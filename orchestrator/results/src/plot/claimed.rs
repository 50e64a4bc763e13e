//! What claims limit: the lines, the first sample that fails and the worst one.

use super::run::{Claim, Run};
use super::scale::rounded;
use super::trace::Samples;
use crate::comparison::{Comparison, Quantity};

/// A limit of a claim in the unit of its panel.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Limit {
    /// The claim's name.
    pub claim: String,
    /// The claim's name with the limit in words.
    pub text: String,
    pub low: Option<f64>,
    pub high: Option<f64>,
    /// When it counts.
    pub from_s: f64,
    pub to_s: Option<f64>,
    /// The curve of the panel that it limits.
    pub curve: usize,
    /// The sample that fails first.
    pub first_s: Option<f64>,
    /// The sample with the least margin; the best one where one is enough.
    pub worst_s: Option<f64>,
    pub once: bool,
}

/// The column that alone is compared.
pub(super) fn column_of(comparison: &Comparison) -> Option<&str> {
    match &comparison.quantity {
        Quantity::Column { column } => Some(column),
        _ => None,
    }
}

/// The limits of all claims about these columns, in a unit that is `1 / factor` of theirs.
pub(super) fn limits_of_columns(run: &Run, names: &[&str], factor: f64) -> Vec<Limit> {
    let mut limits = Vec::new();
    for (claim, known) in run.claims.iter().enumerate() {
        for (index, comparison) in known.comparisons.iter().enumerate() {
            let curve = column_of(comparison).and_then(|name| names.iter().position(|other| *other == name));
            if let Some((curve, limit)) = curve.zip(limit(run, claim, index, factor)) {
                limits.push(Limit { curve, ..limit });
            }
        }
    }
    limits
}

/// The limit of one comparison.
pub(super) fn limit(run: &Run, claim: usize, index: usize, factor: f64) -> Option<Limit> {
    let claim = run.claims.get(claim)?;
    let comparison = claim.comparisons.get(index)?;
    let (low, high) = (comparison.low.map(|low| low * factor), comparison.high.map(|high| high * factor));
    let is_worst = claim.part == Some(comparison.part) && worst(run, claim) == Some(index);
    let first_s = claim.first_s.filter(|_| is_worst);
    Some(Limit {
        claim: claim.name.clone(),
        text: text(&claim.name, low, high)?,
        low,
        high,
        from_s: comparison.from_s,
        to_s: comparison.to_s,
        curve: 0,
        once: comparison.once,
        first_s,
        worst_s: claim.at_s.filter(|_| is_worst),
    })
}

fn text(name: &str, low: Option<f64>, high: Option<f64>) -> Option<String> {
    Some(match (low, high) {
        (Some(low), Some(high)) if low == -high => format!("{name}: within ±{}", rounded(high)),
        (Some(low), Some(high)) => format!("{name}: {} to {}", rounded(low), rounded(high)),
        (Some(low), None) => format!("{name}: above {}", rounded(low)),
        (None, Some(high)) => format!("{name}: below {}", rounded(high)),
        (None, None) => return None,
    })
}

/// The comparison of the worst part that is nearest to its limits, or farthest beyond them, at the worst time.
fn worst(run: &Run, claim: &Claim) -> Option<usize> {
    let (at_s, part) = (claim.at_s?, claim.part?);
    let margin = |comparison: &Comparison| {
        let value = value_at(&samples(run, &comparison.quantity), at_s)?;
        let below = comparison.high.map_or(f64::INFINITY, |high| high - value);
        let above = comparison.low.map_or(f64::INFINITY, |low| value - low);
        Some(below.min(above))
    };
    let of_part = claim.comparisons.iter().enumerate().filter(|(_, comparison)| comparison.part == part);
    let margins = of_part.filter_map(|(index, comparison)| Some((index, margin(comparison)?)));
    margins.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(index, _)| index)
}

/// The last sample at or before a time.
pub(super) fn value_at(samples: &[(f64, f64)], at_s: f64) -> Option<f64> {
    let index = samples.partition_point(|(time_s, _)| *time_s <= at_s + 1e-9);
    samples.get(index.checked_sub(1)?).map(|(_, value)| *value)
}

/// A quantity at each row at which all its columns have a value.
pub(super) fn samples(run: &Run, quantity: &Quantity) -> Samples {
    let columns: Vec<_> =
        quantity.columns().into_iter().filter_map(|name| Some((name, run.table.column(name)?))).collect();
    let value = |row: usize, time_s: f64| {
        let column = |name: &str| {
            let known = columns.iter().find(|(known, _)| *known == name);
            known.and_then(|(_, column)| column.values.get(row).copied().flatten()).unwrap_or(f64::NAN)
        };
        quantity.value(time_s, &column)
    };
    let rows = run.table.time_s().into_iter().enumerate().map(|(row, time_s)| (time_s, value(row, time_s)));
    rows.filter(|(_, value)| value.is_finite()).collect()
}

/// The curve's name: the comparison as written.
pub(super) fn quantity_text(comparison: &Comparison) -> String {
    match (comparison.text.is_empty(), comparison.is_margin) {
        (true, _) => comparison.quantity.columns().join(", "),
        (false, true) => format!("margin of {}", comparison.text),
        (false, false) => comparison.text.clone(),
    }
}
