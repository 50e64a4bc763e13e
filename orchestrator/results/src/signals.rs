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
    /// When it has a value.
    #[serde(skip)]
    pub due: Due,
}

/// The ticks at which a column has a value; in the rows of other ticks it is empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Due {
    /// The period in ticks: a value at each multiple of it.
    pub every: u64,
    /// The first tick that counts.
    pub from_tick: u64,
}

impl Due {
    /// Every tick.
    pub const ALWAYS: Self = Self { every: 1, from_tick: 0 };

    #[inline]
    pub(crate) fn contains(self, tick: u64) -> bool {
        // Most columns are always due, and a division for each of their values would be the largest part of its cost.
        (self.every == 1 || tick.is_multiple_of(self.every)) && tick >= self.from_tick
    }
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
        due: Due::ALWAYS,
    }
}

/// The ticks at which a trace has a row: the multiples of the periods of its columns, all if it has none but the time.
#[derive(Clone, Debug)]
pub struct DueRows {
    periods: Vec<u64>,
}

impl DueRows {
    /// The rows of these columns.
    pub fn new(columns: impl Iterator<Item = Due>) -> Self {
        let mut periods: Vec<_> = columns.map(|due| due.every).collect();
        periods.sort_unstable();
        periods.dedup();
        Self { periods }
    }

    /// Whether this tick has a row.
    #[must_use]
    #[inline]
    pub fn contain(&self, tick: u64) -> bool {
        self.periods.is_empty() || self.periods.iter().any(|&every| every == 1 || tick.is_multiple_of(every))
    }
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
        let Signal { name, slot_type, due, .. } = *signal;
        CsvColumn { name: name.to_owned(), slot_type, due }
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
