//! The start values of an instance: those of the script and of its inputs are set, those of its library are compared with
//! its description.

use crate::run::worker::scattered::{get_slots, set_slots};
use dsl::scenario::{Preset, Value};
use flatten::values::{Slot, ValueType, Values, start_value};
use flatten::wiring::VariableSlot;
use fmi2::description::{Causality, ModelDescription, Variable};
use results::shortest_decimal;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use unit::board::Now;
use unit::failure::Failure;
use unit::instance::Instance;

/// Reals that differ by a larger part are different: units may compute with a value between two calls.
const RELATIVE_TOLERANCE: f64 = 1e-9;
/// The most variables that one warning names.
const MOST_NAMED: usize = 5;

/// The start values of an instance.
#[derive(Clone, Debug, Default)]
pub struct StartValues {
    values: Values,
    /// What the script's braces set, in their order.
    presets: Vec<VariableSlot>,
    /// Inputs and parameters that the script leaves at the start values of the description.
    declared: Vec<VariableSlot>,
    /// What is set in initialization mode: presets, where the standard allows it, and declared start values of inputs.
    initial: Vec<VariableSlot>,
    /// How messages show each variable.
    labels: BTreeMap<usize, Label>,
}

/// How messages show a variable.
#[derive(Clone, Debug)]
struct Label {
    name: String,
    unit: Option<String>,
}

impl StartValues {
    /// The start values of an instance with these presets; `file("…")` is relative to the folder.
    #[must_use]
    pub fn new(presets: &[Preset], description: &ModelDescription, folder: &Path) -> Self {
        let mut of = Self::default();
        let mut places: BTreeMap<usize, Slot> = BTreeMap::new();
        for Preset { variable: index, value } in presets {
            let variable = &description.variables[*index];
            let slot = *places.entry(*index).or_insert_with(|| {
                let slot = of.add(*index, variable, description);
                of.presets.push(slot);
                if variable.is_settable_in_initialization() {
                    of.initial.push(slot);
                }
                slot.slot
            });
            match value {
                Value::File(file) => {
                    of.values.texts[slot.index] = folder.join(&file.path).to_string_lossy().into_owned()
                }
                value => of.values.store(slot, value),
            }
        }
        for (index, variable) in description.variables.iter().enumerate() {
            let is_input = variable.causality == Causality::Input;
            let starts = variable.has_start() && (is_input || variable.causality == Causality::Parameter);
            if starts && !places.contains_key(&index) {
                let slot = of.add(index, variable, description);
                of.values.store(slot.slot, &start_value(variable));
                of.declared.push(slot);
                if is_input {
                    of.initial.push(slot);
                }
            }
        }
        of
    }

    fn add(&mut self, index: usize, variable: &Variable, description: &ModelDescription) -> VariableSlot {
        let unit = description.unit_of(variable).map(str::to_owned);
        self.labels.insert(index, Label { name: variable.name.clone(), unit });
        VariableSlot { slot: self.values.add(ValueType::of(variable)), variable: index }
    }

    /// Sets the presets, before initialization mode, each in a batch of its own, which `begin` begins.
    ///
    /// # Errors
    /// The unit refuses.
    pub fn set_presets<'n>(&self, instance: &mut Instance, begin: impl Fn() -> Now<'n>) -> Result<(), Failure> {
        self.presets.iter().try_for_each(|&slot| set_slots(instance, &begin(), &[slot], &self.values))
    }

    /// In initialization mode: warns of a library that starts with other values than its description, then sets inputs and,
    /// once more, the presets, since some units forget them when they enter initialization mode.
    ///
    /// # Errors
    /// The unit refuses to be set, or a call fails in another way than by a status.
    pub fn initialize(&self, instance: &mut Instance, now: &Now<'_>) -> Result<(), Failure> {
        let differing = self.differing(instance, now, &self.declared)?;
        if let Some(list) = list(&differing, |held, declared| format!("{held}, declared {declared}")) {
            let text = format!(
                "its library and its modelDescription.xml differ in start values: {list} (parameters keep the value of \
                 the library, inputs get the declared one)"
            );
            instance.log_warning(now, text);
        }
        set_slots(instance, now, &self.initial, &self.values)
    }

    /// These variables were set to something else since.
    pub fn are_replaced(&mut self, slots: &[VariableSlot]) {
        let replaced: BTreeSet<_> = slots.iter().map(|slot| slot.variable).collect();
        self.initial.retain(|slot| !replaced.contains(&slot.variable));
    }

    /// After initialization: warns of a unit that holds other values than those that were set.
    ///
    /// # Errors
    /// A call fails in another way than by a status.
    pub fn compare_held(&self, instance: &mut Instance, now: &Now<'_>) -> Result<(), Failure> {
        let differing = self.differing(instance, now, &self.initial)?;
        if let Some(list) = list(&differing, |held, set| format!("{held}, was set to {set}")) {
            instance.log_warning(now, format!("it does not hold the start values that were set: {list}"));
        }
        Ok(())
    }

    /// The names of variables that the unit holds with another value than that here, with both values.
    fn differing(
        &self,
        instance: &mut Instance,
        now: &Now<'_>,
        slots: &[VariableSlot],
    ) -> Result<Vec<(String, [String; 2])>, Failure> {
        let mut held = self.values.clone();
        let mut differing = Vec::new();
        for base in [ValueType::Real, ValueType::Integer, ValueType::Boolean, ValueType::Text] {
            let of_type: Vec<_> = slots.iter().filter(|slot| slot.slot.base == base).copied().collect();
            match get_slots(instance, now, &of_type, &mut held) {
                Ok(()) => {
                    let others = of_type.iter().filter(|slot| differ(&held, &self.values, slot.slot));
                    differing.extend(others.map(|slot| {
                        let label = &self.labels[&slot.variable];
                        (label.name.clone(), [&held, &self.values].map(|values| label.text(values, slot.slot)))
                    }));
                }
                // No other tool needs these values, so a unit that refuses to give them still runs.
                Err(failure) if failure.is_refusal() => {
                    instance.log_warning(now, format!("its start values cannot be compared: {failure}"));
                }
                Err(failure) => return Err(failure),
            }
        }
        Ok(differing)
    }
}

impl Label {
    fn text(&self, values: &Values, slot: Slot) -> String {
        let value = value_text(values, slot);
        self.unit.as_ref().map_or_else(|| value.clone(), |unit| format!("{value} {unit}"))
    }
}

/// A value as messages show it, without its unit of measure.
pub(super) fn value_text(values: &Values, Slot { base, index }: Slot) -> String {
    match base {
        ValueType::Real => shortest_decimal(values.reals[index]),
        ValueType::Integer => values.integers[index].to_string(),
        ValueType::Boolean => (values.booleans[index] != 0).to_string(),
        ValueType::Text => format!("{:?}", values.texts[index]),
    }
}

fn differ(held: &Values, given: &Values, Slot { base, index }: Slot) -> bool {
    match base {
        ValueType::Real => {
            let (held, given) = (held.reals[index], given.reals[index]);
            // Also where one of them is NaN, but not where both are.
            let equal = held == given || (held.is_nan() && given.is_nan());
            let near = (held - given).abs() <= RELATIVE_TOLERANCE * held.abs().max(given.abs());
            !(equal || (near && held.is_finite() && given.is_finite()))
        }
        ValueType::Integer => held.integers[index] != given.integers[index],
        ValueType::Boolean => held.booleans[index] != given.booleans[index],
        ValueType::Text => held.texts[index] != given.texts[index],
    }
}

/// `a is 1, declared 2; b is …`; `None` if nothing differs.
fn list(differing: &[(String, [String; 2])], both: impl Fn(&str, &str) -> String) -> Option<String> {
    let named = differing.iter().take(MOST_NAMED);
    let mut parts: Vec<_> = named.map(|(name, [held, given])| format!("{name} is {}", both(held, given))).collect();
    if let Some(more) = differing.len().checked_sub(MOST_NAMED).filter(|&more| more > 0) {
        parts.push(format!("and {more} more"));
    }
    (!parts.is_empty()).then(|| parts.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reals_differ_by_more_than_rounding() {
        let values = |real: f64| Values { reals: vec![real], ..Values::default() };
        let real = Slot { base: ValueType::Real, index: 0 };
        let differ = |held, given| differ(&values(held), &values(given), real);
        assert!(!differ(0.1 + 0.2, 0.3) && !differ(f64::NAN, f64::NAN) && !differ(-0.0, 0.0));
        assert!(!differ(f64::INFINITY, f64::INFINITY));
        assert!(differ(69.0, 0.0) && differ(1.0, f64::NAN) && differ(f64::INFINITY, 1.0) && differ(1.0, 1.000_001));
    }

    #[test]
    fn a_warning_names_some_variables_and_counts_the_others() {
        let differing: Vec<_> = (0..7).map(|k| (format!("k{k}"), [k.to_string(), "9".to_owned()])).collect();
        let both = |held: &str, set: &str| format!("{held}, was set to {set}");
        assert_eq!(list(&differing[..1], both).as_deref(), Some("k0 is 0, was set to 9"));
        assert!(list(&differing, both).is_some_and(|text| text.ends_with("k4 is 4, was set to 9; and 2 more")));
        assert_eq!(list(&[], both), None);
    }
}
