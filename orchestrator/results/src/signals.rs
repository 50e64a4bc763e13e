//! `signals.json`: what each column of the trace is, so that a reader needs no unit and no script.

use super::csv::CsvColumn;
use serde::Serialize;
use std::collections::BTreeMap;

/// How a slot of a row is read: the bits of a Real, or a number widened to 64 bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlotType {
    /// A number with binary fraction.
    Real,
    /// A whole number, also that of an enumeration's item.
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
    /// The FMU's words.
    pub description: Option<&'a str>,
    /// The names of an enumeration's numbers.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub items: BTreeMap<i32, &'a str>,
    /// How its slots are read.
    #[serde(skip)]
    pub slot_type: SlotType,
}

impl Signal<'_> {
    /// What there is to say besides the name, as keys and texts.
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

/// The columns as `trace.csv` needs them: it has the time anyway.
#[must_use]
pub fn csv_columns(signals: &[Signal<'_>]) -> Vec<CsvColumn> {
    let column = |signal: &Signal<'_>| CsvColumn { name: signal.name.to_owned(), slot_type: signal.slot_type };
    signals.iter().skip(1).map(column).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A column that says no more than it must.
    pub(crate) fn signal(name: &str, slot_type: SlotType) -> Signal<'_> {
        Signal { name, unit: None, instance: None, causality: "output", description: None, slot_type, ..time() }
    }
}
