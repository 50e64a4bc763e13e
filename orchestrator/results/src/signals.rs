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
    let column = |signal: &Signal<'_>| CsvColumn { name: signal.name.to_owned(), slot_type: signal.slot_type };
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
