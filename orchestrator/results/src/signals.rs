//! `signals.json`: the description of each column of the trace, so that a reader needs neither unit nor script.

use super::csv::CsvColumn;
use serde::Serialize;
use std::collections::BTreeMap;

/// The type of a slot of a row: the bits of a Real, or a number widened to 64 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlotType {
    /// A floating-point number.
    Real,
    /// An integer, also the value of an enumeration.
    Integer,
    /// 0 or 1.
    Boolean,
}

/// One column of the trace.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Signal<'a> {
    /// The name in the trace's header.
    pub name: &'a str,
    /// Its unit of measure, as its FMU names it.
    pub unit: Option<&'a str>,
    /// The instance; `None` for `time`.
    pub instance: Option<&'a str>,
    /// The variable's name in its FMU; `None` for `time`.
    pub variable: Option<&'a str>,
    /// `Real`, `Integer`, `Boolean` or `Enumeration`.
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// `output`, `input`, …
    pub causality: &'static str,
    /// The description in its FMU.
    pub description: Option<&'a str>,
    /// The names of an enumeration's values.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub items: BTreeMap<i32, &'a str>,
    /// The type of its slots.
    #[serde(skip)]
    pub slot_type: SlotType,
    /// Its period in ticks: it is due at the multiples of it, and empty in the rows of other ticks.
    #[serde(skip)]
    pub every: u64,
}

impl Signal<'_> {
    /// All properties but the name, as keys and texts; those without a value are left out.
    #[must_use]
    pub fn facts(&self) -> Vec<(&'static str, String)> {
        let items = (!self.items.is_empty()).then(|| serde_json::json!(self.items).to_string());
        let facts = [
            ("unit", self.unit),
            ("instance", self.instance),
            ("variable", self.variable),
            ("type", Some(self.kind)),
            ("causality", Some(self.causality)),
            ("description", self.description),
            ("items", items.as_deref()),
        ];
        facts.into_iter().filter_map(|(key, fact)| Some((key, fact?.to_owned()))).collect()
    }
}

/// The column of the time, the first of every trace.
#[must_use]
pub fn time() -> Signal<'static> {
    Signal {
        name: "time",
        unit: Some("s"),
        instance: None,
        variable: None,
        kind: "Real",
        causality: "independent",
        description: Some("Simulated time"),
        items: BTreeMap::new(),
        slot_type: SlotType::Real,
        every: 1,
    }
}

/// The ticks at which a trace has a row: those at which one of its columns is due, all if it has none but the time.
#[derive(Clone, Debug)]
pub struct DueRows {
    periods: Vec<u64>,
}

impl DueRows {
    /// The rows of columns with these periods in ticks.
    pub fn new(periods: impl Iterator<Item = u64>) -> Self {
        let mut periods: Vec<_> = periods.collect();
        periods.sort_unstable();
        periods.dedup();
        Self { periods }
    }

    /// Whether this tick has a row.
    #[must_use]
    #[inline]
    pub fn contain(&self, tick: u64) -> bool {
        self.periods.is_empty() || self.periods.iter().any(|&every| is_due(tick, every))
    }
}

/// Whether a column with this period is due at a tick.
#[inline]
pub(crate) fn is_due(tick: u64, every: u64) -> bool {
    // Most columns are always due, and a division for each of their values would be the largest part of its cost.
    every == 1 || tick.is_multiple_of(every)
}

/// The text of the file.
#[must_use]
pub fn json(signals: &[Signal<'_>]) -> String {
    super::json_text(&signals)
}

/// The columns as the writer of `trace.csv` needs them: without the time, which it always writes.
#[must_use]
pub fn csv_columns(signals: &[Signal<'_>]) -> Vec<CsvColumn> {
    let column = |signal: &Signal<'_>| {
        let Signal { name, slot_type, every, .. } = *signal;
        CsvColumn { name: name.to_owned(), slot_type, every }
    };
    signals.iter().skip(1).map(column).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A column with the required properties only.
    pub(crate) fn signal(name: &str, slot_type: SlotType) -> Signal<'_> {
        Signal { name, unit: None, instance: None, causality: "output", description: None, slot_type, ..time() }
    }
}
